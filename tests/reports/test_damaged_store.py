"""A store that is damaged, locked, somebody else's or in a full folder keeps what can be read."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
from contextlib import closing, suppress

import numpy as np
import pytest

from reports.model.ending import FileTrouble
from reports.run import store as store_module
from reports.run.store import Store
from tests import ROOT
from tests.reports.test_store import CELLS, TRUNCATIONS, filled, names, row, stored


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


@pytest.mark.parametrize("count", [1, 40, 500])
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


def test_a_results_folder_that_is_a_file_or_lies_below_one_is_a_sentence(tmp_path):
    (tmp_path / "file").write_text("a file")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(FileTrouble, match=r"can't be a folder.*--results"), Store(folder / "cells.sqlite"):
            pass
    assert (tmp_path / "file").read_text() == "a file"


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
