"""Tests of the store: rows are read unchanged; a damaged, locked or foreign file is refused or renamed."""

from __future__ import annotations

import json
import math
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from reports.model.cells import Cell
from reports.model.ending import FileTrouble
from reports.model.measure import blank
from reports.model.outcomes import Outcome
from reports.run import store as store_module
from reports.run.store import Store
from tests import ROOT
from tests.rows import row as by_hand
from tests.toys import Disc, Toy

CELLS = [Cell(Disc(), Toy(), every) for every in range(1, 41)]


def row(cell: Cell):
    """A row of a cell with different numbers for each cell; its long sentence makes the file have many pages."""
    return replace(blank(cell, Outcome.FINISHED, "a sentence " * 40), angle=1e-3 * cell.every, flips=cell.every)


def filled(path, cells=CELLS):
    with Store(path) as store:
        for cell in cells:
            store.put(row(cell))
    return path


def stored(path):
    with Store.read(path) as store:
        return store.get(CELLS)


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_stored_rows_are_returned_unchanged_and_the_last_row_of_a_cell_is_used(tmp_path):
    path = filled(tmp_path / "new" / "folder" / "cells.sqlite", CELLS[:3])
    put = by_hand(key=CELLS[0].key, energy=math.nan, gap=math.inf)
    with Store(path) as store:
        assert store.notice == ""
        store.put(put)
        store.save_references(["second", "first"])
        store.save_references(["third", "second"])
        result = store.get(CELLS[::-1])
        assert list(result) == CELLS[2::-1]
        assert math.isnan(result[CELLS[0]].energy)
        assert replace(result[CELLS[0]], energy=0.0) == replace(put, energy=0.0)
        experiment = replace(CELLS[0], purpose="failure")  # this cell uses the row of the sweep
        assert [item.purpose for item in store.get([experiment]).values()] == ["failure"]
    with Store.read(path) as store:
        assert store.load_references() == ("second", "first", "third")


def test_reading_writes_no_file_and_includes_the_rows_of_a_run_in_progress(tmp_path):
    path = tmp_path / "cells.sqlite"
    with Store(path) as running:
        running.put(row(CELLS[0]))
        earlier = names(tmp_path)
        assert set(stored(path)) == {CELLS[0]}
        running.put(row(CELLS[1]))
        assert set(stored(path)) == set(CELLS[:2])
        assert names(tmp_path) == earlier
    assert names(tmp_path) == {"cells.sqlite"}


def rewritten(path, text):
    with closing(sqlite3.connect(path)) as connection, connection:
        value = "cast(? as text)" if isinstance(text, bytes) else "?"  # the bytes are not valid text
        connection.execute(f"update results set row = {value} where key = ?", (text, CELLS[0].key))


def altered(**changes):
    """The JSON of a row with changed values; a value of None is left out."""
    values = {**row(CELLS[0]).as_dict(), **changes}
    return json.dumps({name: value for name, value in values.items() if value is not None})


@pytest.mark.parametrize("text", [b"\xff\xfe\x00", altered()[:-20], altered(colour=1), altered(outcome="melted")])
def test_an_unreadable_row_counts_as_missing_and_can_be_replaced(tmp_path, text):
    path = filled(tmp_path / "cells.sqlite", CELLS[:3])
    rewritten(path, text)
    with Store(path) as store:
        assert set(store.get(CELLS)) == set(CELLS[1:3])
        store.put(row(CELLS[0]))
        assert set(store.get(CELLS)) == set(CELLS[:3])


@pytest.mark.parametrize("kind", ["middle", "text", "empty, with rows beside it"])
def test_a_damaged_store_is_renamed_and_the_run_continues(tmp_path, kind):
    path = filled(tmp_path / "cells.sqlite")
    data, random = path.read_bytes(), np.random.default_rng(2).bytes(5000)
    middle = len(data) // 2
    old = {"middle": data[:middle] + random + data[middle + 5000 :], "text": b"these are no results\n" * 500}.get(
        kind, b""
    )
    path.write_bytes(old)
    if not old:
        path.with_name(path.name + "-wal").write_bytes(b"rows")
    with pytest.raises(FileTrouble, match=r"damaged .*crosscheck run puts it aside"), Store.read(path):
        pass
    assert path.read_bytes() == old  # reading repairs nothing
    with Store(path) as store:
        assert store.get(CELLS) == {}
        assert "it is now cells.sqlite.damaged-1, and all that it held runs again" in store.notice
        store.put(row(CELLS[0]))
    assert (tmp_path / "cells.sqlite.damaged-1").read_bytes() == old
    if not old:
        assert (tmp_path / "cells.sqlite.damaged-1-wal").read_bytes() == b"rows"
    path.write_text("a second one\n" * 100)
    with Store(path) as store:
        assert "damaged-2" in store.notice


@pytest.mark.parametrize(
    ("statement", "telling"),
    [
        ("pragma user_version=7", "newer version"),
        ("create table moz_places (id integer)", "another program"),
        ("", "file"),
    ],
)
def test_another_file_in_place_of_a_store_is_refused_and_not_changed(tmp_path, statement, telling):
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
        with pytest.raises(FileTrouble, match=telling) as reported, use(path):
            pass
        assert "--results" in str(reported.value)
    assert names(tmp_path) == {"cells.sqlite"}
    assert path.is_dir() if old is None else path.read_bytes() == old


def test_a_store_locked_by_another_process_is_refused_in_a_sentence_and_keeps_its_rows(tmp_path, monkeypatch):
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
from reports.run.store import Store
from tests.reports.test_store import CELLS, row

# Limit of the size of each file; reaching it looks like a full disk to the program.
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))
folder = Path(sys.argv[1])
try:
    with Store(folder / "cells.sqlite") as store:
        for count, cell in enumerate(CELLS):
            store.put(row(cell))
except FileTrouble as trouble:
    print(count, trouble)
"""


def test_a_full_disk_keeps_the_rows_that_are_there(tmp_path):
    pytest.importorskip("resource")
    text = [sys.executable, "-c", FULL_DISK, tmp_path]
    line = subprocess.run(text, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    count = int(line.split()[0])
    assert 0 < count < len(CELLS)
    assert "what it holds is kept" in line
    assert set(stored(tmp_path / "cells.sqlite")) == set(CELLS[:count])
    assert names(tmp_path) <= {"cells.sqlite", "cells.sqlite-wal", "cells.sqlite-shm"}


def test_a_store_that_was_removed_during_a_run_is_reported_at_the_next_row(tmp_path):
    path = tmp_path / "results" / "cells.sqlite"
    with Store(path) as store:
        store.put(row(CELLS[0]))
        shutil.rmtree(path.parent)
        Store(path).__exit__(None, None, None)  # a new file with the same name
        with pytest.raises(FileTrouble, match="was removed or replaced while it was written"):
            store.put(row(CELLS[1]))
