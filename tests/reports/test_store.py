"""The store: what is in it survives; a file that is damaged, locked or somebody else's is one sentence or put aside."""

from __future__ import annotations

import json
import math
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing, contextmanager, suppress
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
from tests import ROOT
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
        experiment = replace(CELLS[0], purpose="failure")  # it takes the row of the sweep
        assert [each.purpose for each in store.get([experiment]).values()] == ["failure"]


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


def damage(kind, path):
    data = path.read_bytes()
    match kind:
        case "garbage at the head":
            path.write_bytes(np.random.default_rng(1).bytes(100) + data[100:])
        case "garbage in the middle":
            middle = len(data) // 2
            path.write_bytes(data[:middle] + np.random.default_rng(2).bytes(5000) + data[middle + 5000 :])
        case "zeros at the end":
            path.write_bytes(data[:-9000] + bytes(9000))
        case "a text":
            path.write_text("these are no results\n" * 500)
        case "empty, with rows beside it":
            path.write_bytes(b"")
            path.with_name(path.name + "-wal").write_bytes(b"rows")
        case _:
            path.write_bytes(data[: int(kind)])


KINDS = [
    "garbage at the head",
    "garbage in the middle",
    "zeros at the end",
    "a text",
    "-9000",
    "empty, with rows beside it",
    *map(str, TRUNCATIONS),
]


@pytest.mark.parametrize("kind", KINDS)
def test_a_store_damaged_anywhere_is_put_aside_and_the_run_goes_on(tmp_path, kind):
    path = filled(tmp_path / "cells.sqlite")
    damage(kind, path)
    old = path.read_bytes()
    with pytest.raises(FileTrouble, match=r"damaged .*crosscheck run puts it aside"), Store.read(path):
        pass
    assert path.read_bytes() == old  # reading mends nothing
    with Store(path) as store:
        assert store.get(CELLS) == {}
        assert "it is now cells.sqlite.damaged-1, and all that it held runs again" in store.notice
        store.put(row(CELLS[0]))
    if kind == "empty, with rows beside it":
        assert (tmp_path / "cells.sqlite.damaged-1-wal").read_bytes() == b"rows"
    assert (tmp_path / "cells.sqlite.damaged-1").read_bytes() == old
    assert names(tmp_path) - {"cells.sqlite.damaged-1-wal"} == {"cells.sqlite", "cells.sqlite.damaged-1"}
    with Store(path) as store:
        assert store.notice == ""
        assert set(store.get(CELLS)) == {CELLS[0]}
    path.write_text("a second one\n" * 100)
    with Store(path) as store:
        assert "damaged-2" in store.notice
    assert (tmp_path / "cells.sqlite.damaged-1").read_bytes() == old


def scribbled(path, seed, count):
    """So many random bytes at a random place of a file; often of the first or the last page."""
    rng = np.random.default_rng(seed)
    data = bytearray(path.read_bytes())
    ends = [0, len(data) - count, rng.integers(0, min(8192, len(data) - count)), rng.integers(0, len(data) - count)]
    place = int(ends[seed % 4])
    data[place : place + count] = rng.bytes(count)
    path.write_bytes(data)


@pytest.mark.parametrize("count", [40, *(pytest.param(count, marks=pytest.mark.slow) for count in (1, 500))])
def test_random_bytes_anywhere_end_in_no_traceback_and_no_wrong_row(tmp_path, count):
    """What is left is right, or put aside, or refused with a sentence that says what to do; a run then goes on."""
    whole = filled(tmp_path / "whole.sqlite")
    path = tmp_path / "cells.sqlite"
    for seed in range(20):
        shutil.copyfile(whole, path)
        scribbled(path, seed, count)
        with suppress(FileTrouble), Store.read(path) as store:
            assert all(repr(found) == repr(row(cell)) for cell, found in store.get(CELLS).items())
        try:
            with Store(path) as store:
                assert all(repr(found) == repr(row(cell)) for cell, found in store.get(CELLS).items())
                store.put(row(CELLS[0]))
                assert CELLS[0] in store.get(CELLS[:1])
                assert all(isinstance(words, str) for words in store.remembered())
        except FileTrouble as trouble:
            told = str(trouble)  # of a byte of a table's name or of the version: it could be another program's
        else:
            told = "--results"
        assert "--results" in told


@pytest.mark.parametrize(
    ("statement", "telling"),
    [
        ("pragma user_version=7", "newer version"),
        ("create table results (key text, value text)", "another program"),
        ("create table moz_places (id integer)", "another program"),
        ("", "file"),
    ],
)
def test_what_is_no_store_of_ours_is_left_alone_with_a_sentence(tmp_path, statement, telling):
    path = tmp_path / "cells.sqlite"
    if statement.startswith("pragma"):
        filled(path, CELLS[:2])
    if statement:
        with closing(sqlite3.connect(path)) as connection, connection:
            connection.execute(statement)
    else:
        path.mkdir()
    old = path.read_bytes() if statement else None
    for use in (Store, Store.read):
        with pytest.raises(FileTrouble, match=telling) as told, use(path):
            pass
        assert "--results" in str(told.value)
    assert names(tmp_path) == {"cells.sqlite"}
    assert path.is_dir() if old is None else path.read_bytes() == old


@pytest.mark.parametrize("version", [0, 1])
def test_a_store_of_the_first_versions_is_taken_over(tmp_path, version):
    path = filled(tmp_path / "cells.sqlite", CELLS[:2])
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("drop table given")
        connection.execute(f"pragma user_version={version}")
    with Store.read(path) as store:
        assert (set(store.get(CELLS)), store.remembered()) == (set(CELLS[:2]), ())
    with Store(path) as store:
        assert set(store.get(CELLS)) == set(CELLS[:2])
        store.remember(["words"])
        assert store.remembered() == ("words",)
    with closing(sqlite3.connect(path)) as connection:
        assert connection.execute("pragma user_version").fetchone() == (2,)


def test_a_store_that_another_process_locks_is_a_sentence_and_keeps_its_rows(tmp_path, monkeypatch):
    monkeypatch.setattr(store_module, "WAIT", 0.1)
    path = filled(tmp_path / "cells.sqlite", CELLS[:2])
    with closing(sqlite3.connect(path, isolation_level=None)) as other, Store(path) as store:
        other.execute("begin immediate")
        with pytest.raises(FileTrouble, match="another process"):
            store.put(row(CELLS[2]))
        other.execute("rollback")
        store.put(row(CELLS[3]))
    with closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("pragma locking_mode=exclusive")
        other.execute("begin exclusive")
        with pytest.raises(FileTrouble, match="another process"), Store(path):
            pass
        assert set(stored(path)) == {*CELLS[:2], CELLS[3]}


FULL_DISK = """
import resource, sys
from pathlib import Path
from reports.model.ending import FileTrouble
from reports.run.files import write_whole
from reports.run.store import Store
from tests import ROOT
from tests.reports.test_store import CELLS, row

folder = Path(sys.argv[1])
# No file may grow beyond this: to a program that is a full disk, for each file alone.
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
put = 0
try:
    with Store(folder / "cells.sqlite") as store:
        for cell in CELLS:
            store.put(row(cell))
            put += 1
except FileTrouble as trouble:
    print(put, trouble)
try:
    write_whole({folder / "a.md": "new", folder / "b.md": "new" * 100_000}, "make room")
except FileTrouble as trouble:
    print(trouble)
"""


def test_a_full_disk_keeps_the_rows_and_the_pages_that_are_there(tmp_path):
    pytest.importorskip("resource")
    for name in ("a.md", "b.md"):
        (tmp_path / name).write_text("old")
    ended = subprocess.run(
        [sys.executable, "-c", FULL_DISK, tmp_path],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    first, second = ended.stdout.splitlines()
    count = int(first.split()[0])
    assert 0 < count < len(CELLS)
    assert "what it holds is kept" in first
    assert set(stored(tmp_path / "cells.sqlite")) == set(CELLS[:count])
    assert "b.md can't be written" in second
    assert second.endswith("make room")
    assert [(tmp_path / name).read_text() for name in ("a.md", "b.md")] == ["old", "old"]
    assert names(tmp_path) <= {"a.md", "b.md", "cells.sqlite", "cells.sqlite-wal", "cells.sqlite-shm"}


def test_a_kill_while_a_damaged_file_is_put_aside_loses_no_rows_beside_it(tmp_path, monkeypatch):
    """SQLite deletes the rows that lie beside a main file that is gone: so that goes last."""
    path, rename = tmp_path / "results.sqlite", Path.rename
    path.write_bytes(b"no database " * 100)
    path.with_name(f"{path.name}-wal").write_bytes(b"rows")

    def killed_after(place: Path, target: str) -> None:
        rename(place, target)
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "rename", killed_after)
    with pytest.raises(KeyboardInterrupt):
        store_module._put_aside(path)
    assert path.exists()


@pytest.mark.parametrize("replaced", [False, True])
def test_a_store_that_was_removed_while_it_was_written_says_so_at_the_next_row(tmp_path, replaced):
    path = tmp_path / "results" / "cells.sqlite"
    with Store(path) as store:
        store.put(row(CELLS[0]))
        shutil.rmtree(path.parent)
        if replaced:
            Store(path).__exit__(None, None, None)
        with pytest.raises(FileTrouble, match="was removed or replaced while it was written"):
            store.put(row(CELLS[1]))
