"""The store: what is in it survives; whatever happens to its file is one sentence, or a new file beside the old one."""

from __future__ import annotations

import json
import math
import os
import shutil
import sqlite3
import tempfile
from contextlib import closing, contextmanager
from dataclasses import fields, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from reports.model.cells import Cell
from reports.model.ending import FileTrouble
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Outcome
from reports.run import store as store_module
from reports.run.store import Store
from tests.rows import row as by_hand
from tests.toys import Disc, Toy

CELLS = [Cell(Disc(), Toy(), every) for every in range(1, 61)]
TRUNCATIONS = np.random.default_rng(13).integers(1, 80_000, 5)


def row(cell: Cell):
    """Rows as they are after a run, each with numbers of its own, long enough that the file has many pages."""
    return replace(blank(cell, Outcome.FINISHED, "a sentence " * 40), angle=1e-3 * cell.every, flips=cell.every)


def filled(path, cells=CELLS):
    if cells is CELLS:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(all_of_them())
        return path
    with Store(path) as store:
        for cell in cells:
            store.put(row(cell))
    return path


@cache
def all_of_them():
    """The file with all cells: made once, since each row waits for the disk."""
    with tempfile.TemporaryDirectory() as folder:
        return filled(Path(folder) / "cells.sqlite", CELLS[:]).read_bytes()


def stored(path):
    with Store.read(path) as store:
        return store.get(CELLS)


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_what_is_put_is_got_in_the_order_asked_for_and_the_last_one_counts(tmp_path):
    path = filled(tmp_path / "new" / "folder" / "cells.sqlite")
    with Store(path) as store:
        assert store.notice == ""
        store.put(replace(row(CELLS[0]), angle=0.25))
        found = store.get(CELLS[::-1])
        assert list(found) == CELLS[::-1]
        assert found[CELLS[0]].angle == 0.25
        assert all(found[cell].flips == cell.every for cell in CELLS)


def test_every_field_of_a_row_comes_back(tmp_path):
    put = by_hand(key=CELLS[0].key, energy=math.nan, gap=math.inf)
    with Store(tmp_path / "cells.sqlite") as store:
        store.put(put)
    [told] = stored(tmp_path / "cells.sqlite").values()
    assert math.isnan(told.energy)
    assert replace(told, energy=0.0) == replace(put, energy=0.0)
    kinds = {"str": str, "int": int, "float": float}
    assert all(isinstance(getattr(told, f.name), kinds[str(f.type)]) for f in fields(Measurement))


def test_reading_leaves_no_trace_and_sees_what_a_run_that_goes_on_has_stored(tmp_path):
    path = tmp_path / "cells.sqlite"
    with Store(path) as running:
        running.put(row(CELLS[0]))
        before = names(tmp_path)
        assert set(stored(path)) == {CELLS[0]}
        running.put(row(CELLS[1]))
        assert set(stored(path)) == set(CELLS[:2])
        assert names(tmp_path) == before
    assert set(stored(path)) == set(CELLS[:2])
    assert names(tmp_path) == {"cells.sqlite"}


@contextmanager
def without_privileges():
    """As root every file can be written: then as nobody, for a while."""
    if os.geteuid() == 0:
        os.seteuid(65534)
        try:
            yield
        finally:
            os.seteuid(0)
    else:
        yield


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="permissions are another thing on Windows")
def test_a_store_in_a_folder_that_can_not_be_written_is_read_and_not_run_into():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = filled(folder / "cells.sqlite")
        path.chmod(0o444)
        folder.chmod(0o555)
        try:
            with without_privileges():
                assert len(stored(path)) == len(CELLS)
                for target in (path, folder / "other.sqlite", folder / "below" / "cells.sqlite"):
                    with pytest.raises(FileTrouble, match="--results"), Store(target) as store:
                        store.put(row(CELLS[0]))
            assert names(folder) == {"cells.sqlite"}
        finally:
            folder.chmod(0o755)


def test_rows_beside_the_main_file_are_read_too_and_without_them_those_in_it(tmp_path):
    """As after a kill: SQLite moves rows into the main file when it is closed, or when there are many."""
    path = filled(tmp_path / "cells.sqlite", CELLS[:3])
    with Store(path) as store:
        for cell in CELLS[3:5]:
            store.put(row(cell))
        for end in ("", "-wal", "-shm"):
            shutil.copyfile(f"{path}{end}", f"{tmp_path / 'killed.sqlite'}{end}")
        shutil.copyfile(path, tmp_path / "alone.sqlite")
    assert set(stored(tmp_path / "alone.sqlite")) == set(CELLS[:3])
    assert set(stored(tmp_path / "killed.sqlite")) == set(CELLS[:5])
    with Store(tmp_path / "killed.sqlite") as store:
        assert set(store.get(CELLS)) == set(CELLS[:5])


def rewritten(path, cell, change):
    """Change the stored text of a cell."""
    with closing(sqlite3.connect(path)) as connection, connection:
        [text] = connection.execute("select row from results where key = ?", (cell.key,)).fetchone()
        new = change(text)
        value = "cast(? as text)" if isinstance(new, bytes) else "?"  # bytes that are no text, where a text should be
        connection.execute(f"update results set row = {value} where key = ?", (new, cell.key))


def altered(**changes):
    """The text of a row whose values are changed (None takes one away), with the right digest."""

    def change(text):
        values = {**json.loads(text.partition(" ")[2]), **changes}
        new = json.dumps({name: value for name, value in values.items() if value is not None})
        return f"{store_module.digest(new)} {new}"

    return change


ROWS = {
    "no text": lambda text: b"\xff\xfe\x00",
    "a number": lambda text: 7,
    "cut off": lambda text: text[:-20],
    "no JSON": lambda text: f"{store_module.digest('{')} {{",
    "a list": lambda text: f"{store_module.digest('[1]')} [1]",
    "a digit changed": lambda text: text.replace("7.5", "7.6"),
    "a field of a newer version": altered(colour=3.0),
    "a field of a newer version missing": altered(slip=None),
    "a word for a number": altered(angle="large"),
    "an outcome of a newer version": altered(outcome="melted"),
    "another cell's": altered(key="0" * 32),
}


@pytest.mark.parametrize("kind", ROWS)
def test_a_row_that_can_not_be_read_is_missing_and_can_be_put_again(tmp_path, kind):
    path = filled(tmp_path / "cells.sqlite", CELLS[:3])
    rewritten(path, CELLS[0], altered(angle=7.5))
    assert stored(path)[CELLS[0]].angle == 7.5  # rewriting alone makes no row unreadable
    rewritten(path, CELLS[0], ROWS[kind])
    assert set(stored(path)) == set(CELLS[1:3])
    with Store(path) as store:
        assert store.notice == ""
        assert set(store.get(CELLS)) == set(CELLS[1:3])
        store.put(row(CELLS[0]))
        assert set(store.get(CELLS)) == set(CELLS[:3])


def test_words_are_remembered_once_and_in_their_order(tmp_path):
    path = filled(tmp_path / "cells.sqlite", CELLS[:1])
    with Store(path) as store:
        store.remember(["second", "first"])
        store.remember(["third", "second"])
    with Store.read(path) as store:
        assert store.remembered() == ("second", "first", "third")
