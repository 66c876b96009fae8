"""The store: what is in it survives; whatever happens to its file is one sentence, or a new file beside the old one."""

from __future__ import annotations

import json
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from reports.grid import store as store_module
from reports.grid import stored_text
from reports.grid.cells import Cell
from reports.grid.ending import FileTrouble
from reports.grid.measure import blank
from reports.grid.outcomes import Outcome
from reports.grid.store import Store
from tests.toys import Disc, Toy

ROOT = Path(__file__).resolve().parent.parent
CELLS = [Cell(Disc(), Toy(), every) for every in range(1, 61)]
TRUNCATIONS = np.random.default_rng(13).integers(1, 80_000, 12)


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


def test_what_is_put_is_got_and_the_last_one_counts(tmp_path):
    path = filled(tmp_path / "new" / "folder" / "cells.sqlite")
    with Store(path) as store:
        assert store.notice == ""
        store.put(replace(row(CELLS[0]), angle=0.25))
        found = store.get(CELLS)
        assert found[CELLS[0]].angle == 0.25
        assert all(found[cell].flips == cell.every for cell in CELLS)


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


def test_rows_beside_the_main_file_are_read_too(tmp_path):
    """As after a kill: SQLite moves rows into the main file when it is closed, or when there are many."""
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        for cell in CELLS[:5]:
            store.put(row(cell))
        for end in ("", "-wal", "-shm"):
            shutil.copyfile(f"{path}{end}", f"{tmp_path / 'killed.sqlite'}{end}")
    assert set(stored(tmp_path / "killed.sqlite")) == set(CELLS[:5])
    with Store(tmp_path / "killed.sqlite") as store:
        assert set(store.get(CELLS)) == set(CELLS[:5])


def test_without_what_lay_beside_it_a_store_has_the_rows_of_its_main_file(tmp_path):
    path = tmp_path / "cells.sqlite"
    filled(path, CELLS[:3])
    with Store(path) as store:
        store.put(row(CELLS[3]))
        shutil.copyfile(path, tmp_path / "alone.sqlite")
    assert set(stored(tmp_path / "alone.sqlite")) == set(CELLS[:3])


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


KINDS = {
    "garbage at the head": 0,
    "garbage in the middle": 20,
    "zeros at the end": 20,
    "a text": 0,
    "-9000": 40,
    "empty, with rows beside it": 0,
    **{str(length): 0 for length in TRUNCATIONS},
}


@pytest.mark.parametrize(("kind", "least"), KINDS.items())
def test_a_damaged_store_is_put_aside_its_readable_rows_are_kept_and_the_run_goes_on(tmp_path, kind, least):
    path = filled(tmp_path / "cells.sqlite")
    damage(kind, path)
    old = path.read_bytes()
    with pytest.raises(FileTrouble, match=r"damaged .*crosscheck run puts it aside"), Store.read(path):
        pass
    assert path.read_bytes() == old  # reading mends nothing
    with Store(path) as store:
        found = store.get(CELLS)
        assert len(found) >= least
        assert all(found[cell].flips == cell.every and found[cell].angle == 1e-3 * cell.every for cell in found)
        assert f"it is now cells.sqlite.damaged-1, {len(found)} of its rows" in store.notice
        store.put(row(CELLS[0]))
    if kind == "garbage in the middle":  # what lies before it and what lies behind it
        assert {2, 59} <= {cell.every for cell in found}
    if kind == "empty, with rows beside it":
        assert (tmp_path / "cells.sqlite.damaged-1-wal").read_bytes() == b"rows"
    assert (tmp_path / "cells.sqlite.damaged-1").read_bytes() == old
    assert names(tmp_path) - {"cells.sqlite.damaged-1-wal"} == {"cells.sqlite", "cells.sqlite.damaged-1"}
    with Store(path) as store:
        assert store.notice == ""
        assert set(store.get(CELLS)) == {*found, CELLS[0]}


def test_a_second_damaged_store_does_not_replace_the_first(tmp_path):
    for count in (1, 2):
        (tmp_path / "cells.sqlite").write_text(f"no results, {count}\n" * 100)
        with Store(tmp_path / "cells.sqlite") as store:
            assert f"damaged-{count}" in store.notice
    assert (tmp_path / "cells.sqlite.damaged-1").read_text().startswith("no results, 1")
    assert (tmp_path / "cells.sqlite.damaged-2").read_text().startswith("no results, 2")


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
        return f"{stored_text.digest(new)} {new}"

    return change


ROWS = {
    "no text": lambda text: b"\xff\xfe\x00",
    "a number": lambda text: 7,
    "cut off": lambda text: text[:-20],
    "no JSON": lambda text: f"{stored_text.digest('{')} {{",
    "a list": lambda text: f"{stored_text.digest('[1]')} [1]",
    "a digit changed": lambda text: text.replace("0.001", "0.002"),
    "a field of a newer version": altered(colour=3.0),
    "a field of a newer version missing": altered(slip=None),
    "a word for a number": altered(angle="large"),
    "an outcome of a newer version": altered(outcome="melted"),
    "another cell's": altered(key="0" * 32),
}


@pytest.mark.parametrize("kind", ROWS)
def test_a_row_that_can_not_be_read_is_missing_and_can_be_put_again(tmp_path, kind):
    path = filled(tmp_path / "cells.sqlite", CELLS[:3])
    rewritten(path, CELLS[0], ROWS[kind])
    assert set(stored(path)) == set(CELLS[1:3])
    with Store(path) as store:
        assert store.notice == ""
        assert set(store.get(CELLS)) == set(CELLS[1:3])
        store.put(row(CELLS[0]))
        assert set(store.get(CELLS)) == set(CELLS[:3])


def test_rewriting_alone_does_not_make_a_row_unreadable(tmp_path):
    path = filled(tmp_path / "cells.sqlite", CELLS[:1])
    rewritten(path, CELLS[0], altered(angle=7.5))
    assert stored(path)[CELLS[0]].angle == 7.5


def of_another_schema(path):
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("pragma user_version=7")


def with_other_columns(path):
    path.unlink()
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("create table results (key text, value text)")


def of_another_program(path):
    path.unlink()
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("create table moz_places (id integer)")


def a_folder(path):
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize(
    ("make", "telling"),
    [
        (of_another_schema, "newer version"),
        (with_other_columns, "another program"),
        (of_another_program, "another program"),
        (a_folder, "file"),
    ],
)
def test_what_is_no_store_of_ours_is_left_alone_with_a_sentence(tmp_path, make, telling):
    path = filled(tmp_path / "cells.sqlite", CELLS[:2])
    make(path)
    old = None if path.is_dir() else path.read_bytes()
    for use in (Store, Store.read):
        with pytest.raises(FileTrouble, match=telling) as told, use(path):
            pass
        assert "--results" in str(told.value)
    assert names(tmp_path) == {"cells.sqlite"}
    assert path.is_dir() or path.read_bytes() == old


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


def test_words_are_remembered_once_and_in_their_order(tmp_path):
    path = filled(tmp_path / "cells.sqlite", CELLS[:1])
    with Store(path) as store:
        store.remember(["second", "first"])
        store.remember(["third", "second"])
    with Store.read(path) as store:
        assert store.remembered() == ("second", "first", "third")


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
from reports.grid.ending import FileTrouble
from reports.grid.files import write_whole
from reports.grid.store import Store
from tests.test_store import CELLS, row

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
