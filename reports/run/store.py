"""An SQLite file of results as JSON. Results are stored as they arrive, so a killed run can be continued."""

from __future__ import annotations

import base64
import json
import os
import shutil
import sqlite3
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from reports.model.cells import Cell
from reports.model.ending import FileTrouble
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Array, Task
from reports.run.files import folder_for, temporary_folder

SCHEMA = 2  # the file's `user_version`
TABLES = {"results": "(key text primary key, row text not null)", "given": "(words text primary key)"}
SQLITE_SUFFIXES = ("-wal", "-shm")  # SQLite's files beside the store. Recent rows are only in the -wal file.
WAIT = 30.0  # Longest time to wait for another process that is writing [s].
COPIES = 100  # Number of attempts to copy a store while another process writes it.
ELSEWHERE = "give another folder with --results"
PUT_ASIDE = "crosscheck run puts it aside and begins anew"
IN_USE = f"another process is using it; wait for its end, or {ELSEWHERE}"
# Low byte of SQLite's error code -> remedy for the user.
REMEDIES = {
    sqlite3.SQLITE_BUSY: IN_USE,
    sqlite3.SQLITE_LOCKED: IN_USE,
    sqlite3.SQLITE_FULL: "what it holds is kept; make room on the disk, then run again",
    sqlite3.SQLITE_IOERR: "what it holds is kept; see whether the disk is full or failing, then run again",
}
# SQLITE_ERROR means that the schema in the file is damaged, since all statements in this module are valid.
DAMAGE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_ERROR, sqlite3.SQLITE_TOOBIG)

Keyed = TypeVar("Keyed", Cell, Task)
Result = TypeVar("Result", Measurement, Answer)


class Damaged(Exception):
    """A store is damaged. The message is the reason."""


class Store:
    """A context manager that stores measurements by the key of the cell, and answers by the key of the task. A row
    survives the end of the program once `put` has returned. A damaged file is renamed and replaced by a new file, and
    `notice` has a sentence about this. The constructor and all methods raise FileTrouble if the file can't be used."""

    def __init__(self, path: Path) -> None:
        self.path, self.notice = path, ""
        folder_for(path.parent, ELSEWHERE)
        with _file_trouble(path):
            try:
                self._connection = _connected(path)
            except Damaged as why:
                aside = _put_aside(path)
                self._connection = _connected(path)
                self.notice = f"{path} is damaged ({why}): it is now {aside.name}, and all that it held runs again"
            self._file = path.stat()

    @classmethod
    @contextmanager
    def read(cls, path: Path) -> Iterator[Store]:
        """Open a copy of a store for reading, since SQLite would write files beside the store. Raises FileTrouble."""
        with temporary_folder() as folder:
            copy = folder / "copy.sqlite"
            store = cls.__new__(cls)
            store.path, store.notice = path, ""
            with _file_trouble(path):
                if path.is_dir():
                    raise FileTrouble(f"{path} is a folder, and should be a file; {ELSEWHERE}")
                _copy(path, copy)
                try:
                    store._connection = _connected(copy)
                except Damaged as why:
                    raise FileTrouble(f"{path} is damaged ({why}): {PUT_ASIDE}") from None
            with store:
                yield store

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(sqlite3.Error):  # if the disk is full, the last rows stay in the -wal file
            self._connection.close()

    def put(self, row: Measurement) -> None:
        self._put(row.key, json.dumps(asdict(row)))

    def put_answer(self, task: Task, answer: Answer) -> None:
        """Store the answer to a task and replace any older answer."""
        values = {name: value if isinstance(value, str) else _packed(value) for name, value in answer.values.items()}
        fields_of = {name: getattr(answer, name) for name in ("outcome", "sentence", "limit")}
        self._put(task.key, json.dumps({**fields_of, "values": values}))

    def _put(self, key: str, text: str) -> None:
        with _file_trouble(self.path), self._connection:
            self._connection.execute("insert or replace into results values (?, ?)", (key, text))
        with suppress(OSError):
            if os.path.samestat(self._file, self.path.stat()):
                return
        # SQLite would continue to write into the deleted file.
        raise FileTrouble(f"{self.path} was removed or replaced while it was written; run again, or {ELSEWHERE}")

    def save_references(self, words: Iterable[str]) -> None:
        """Store references to scenes and engines that are not registered. Reports need them."""
        with _file_trouble(self.path), self._connection:
            self._connection.executemany("insert or ignore into given values (?)", [(each,) for each in words])

    def load_references(self) -> tuple[str, ...]:
        with _file_trouble(self.path):
            return tuple(words for (words,) in self._connection.execute("select words from given order by rowid"))

    def get(self, cells: Iterable[Cell]) -> dict[Cell, Measurement]:
        """The stored rows of these cells. Missing, stale and unreadable rows are left out."""
        return {cell: replace(row, purpose=cell.purpose) for cell, row in self._read(cells, row_of)}

    def answers(self, tasks: Iterable[Task]) -> dict[Task, Answer]:
        """The stored answers to these tasks. Missing, stale and unreadable answers are left out."""
        return dict(self._read(tasks, answer_of))

    def _read(self, items: Iterable[Keyed], parse: Callable[[str], Result | None]) -> Iterator[tuple[Keyed, Result]]:
        with _file_trouble(self.path):
            for item in items:
                line = self._connection.execute("select row from results where key = ?", (item.key,)).fetchone()
                if line and (result := parse(line[0])) is not None:
                    yield item, result


@contextmanager
def _file_trouble(path: Path) -> Iterator[None]:
    """A context that raises FileTrouble with a remedy instead of errors of SQLite and of the system."""
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        remedy = PUT_ASIDE if code in DAMAGE else REMEDIES.get(code, ELSEWHERE)
        raise FileTrouble(f"{path}: {error}: {remedy}") from None
    except OSError as error:
        raise FileTrouble(f"{path}: {error.strerror or error}: {ELSEWHERE}") from None


def _connected(path: Path) -> sqlite3.Connection:
    beside = path.with_name(path.name + "-wal")
    if path.is_file() and not path.stat().st_size and beside.is_file() and beside.stat().st_size:
        raise Damaged("it is empty, while rows lie beside it")  # SQLite would delete these rows.
    connection = sqlite3.connect(path, timeout=WAIT)
    connection.text_factory = lambda raw: raw.decode(errors="replace")
    try:
        # With synchronous=full each row would wait 5 to 10 ms for the disk, and meanwhile no worker would get a job.
        connection.execute("pragma synchronous=normal")
        wrong = connection.execute("pragma integrity_check(1)").fetchone()[0]
        if wrong != "ok":
            raise Damaged(" ".join(wrong.split()))
        version = connection.execute("pragma user_version").fetchone()[0]
        tables = {name for (name,) in connection.execute("select name from sqlite_master where type = 'table'")}
        if version > SCHEMA:
            raise FileTrouble(
                f"{path} was written by a newer version of this program (schema {version}, known here: {SCHEMA}); "
                f"update it, or {ELSEWHERE}"
            )
        columns = [line[1] for line in connection.execute("pragma table_info(results)")]
        if tables and (columns != ["key", "row"] or not tables <= TABLES.keys()):
            raise FileTrouble(f"{path} is an SQLite file of another program, with other tables; {ELSEWHERE}")
        if version < SCHEMA or not tables:
            connection.execute("pragma journal_mode=wal")
            for name, columns in TABLES.items():
                connection.execute(f"create table if not exists {name} {columns}")
            connection.execute(f"pragma user_version={SCHEMA}")
    except BaseException as error:
        connection.close()
        if isinstance(error, sqlite3.DatabaseError) and getattr(error, "sqlite_errorcode", 0) & 0xFF in DAMAGE:
            raise Damaged(str(error)) from None
        raise
    return connection


def _copy(path: Path, copy: Path) -> None:
    """Copy a store and its -wal file as a consistent snapshot. Raises FileTrouble and OSError."""
    for _ in range(COPIES):
        before = path.stat()
        shutil.copyfile(path, copy)
        # SQLite only appends to the -wal file, and ignores an incomplete end. If SQLite moves rows from this file into
        # the store during the copy, the time or the size of the store changes.
        with suppress(FileNotFoundError):
            shutil.copyfile(f"{path}-wal", f"{copy}-wal")
        after = path.stat()
        if (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size):
            return
    raise FileTrouble(f"{path} changes all the time; read it when the run that writes it has ended")


def _put_aside(path: Path) -> Path:
    number = 1
    while any(path.with_name(f"{path.name}.damaged-{number}{end}").exists() for end in ("", *SQLITE_SUFFIXES)):
        number += 1
    aside = path.with_name(f"{path.name}.damaged-{number}")
    for end in (*SQLITE_SUFFIXES, ""):  # The store is last, since SQLite deletes a -wal file without a store.
        with suppress(FileNotFoundError):
            path.with_name(path.name + end).rename(f"{aside}{end}")
    return aside


@lru_cache(maxsize=8192)  # A command reads a row several times.
def row_of(text: str) -> Measurement | None:
    try:
        values = json.loads(text)
        return Measurement(**{**values, "outcome": Outcome(values["outcome"])})
    except (ValueError, TypeError, KeyError):
        return None


def answer_of(text: str) -> Answer | None:
    try:
        stored = json.loads(text)
        values = {name: v if isinstance(v, str) else _unpacked(v) for name, v in stored["values"].items()}
        return Answer(Outcome(stored["outcome"]), stored["sentence"], values, stored["limit"])
    except (ValueError, TypeError, KeyError, AttributeError, zlib.error):
        return None


def _packed(array: Array) -> dict[str, Any]:
    data = np.asarray(array, dtype="<f8")
    return {"shape": data.shape, "float64": base64.b64encode(zlib.compress(data.tobytes())).decode()}


def _unpacked(value: dict[str, Any]) -> Array:
    data = zlib.decompress(base64.b64decode(value["float64"], validate=True))
    return np.frombuffer(data, dtype="<f8").reshape(value["shape"]).astype(float)
