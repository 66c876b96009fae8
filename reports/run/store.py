"""Results kept as they arrive, in one SQLite file: a run that was killed goes on where it stopped.

Each is a text: JSON, and a digest by which a text out of a damaged file can be trusted.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import shutil
import sqlite3
import zlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import fields, replace
from functools import lru_cache
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

import numpy as np

from reports.model.cells import Cell
from reports.model.ending import FileTrouble
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Array, Task
from reports.run.files import folder_for, temporary_folder

# The file's `user_version`; 0 in a new one and in those of the first versions. Up to 1 nothing was remembered.
SCHEMA = 2
TABLES = {"results": ("key", "row"), "given": ("words",)}
BESIDE = ("-wal", "-shm")  # what SQLite keeps beside a file: the first holds rows until they move into it
WAIT = 30.0  # s for another process that is writing
ELSEWHERE = "give another folder with --results"

# SQLite's own codes (the low byte), with what to do.
REMEDIES = {
    sqlite3.SQLITE_BUSY: "another process is using it; wait for its end, or " + ELSEWHERE,
    sqlite3.SQLITE_LOCKED: "another process is using it; wait for its end, or " + ELSEWHERE,
    sqlite3.SQLITE_FULL: "what it holds is kept; make room on the disk, then run again",
    sqlite3.SQLITE_IOERR: "what it holds is kept; see whether the disk is full or failing, then run again",
    sqlite3.SQLITE_READONLY: "it can't be written; " + ELSEWHERE,
    sqlite3.SQLITE_CANTOPEN: "it must be a file that can be read and written; " + ELSEWHERE,
    sqlite3.SQLITE_PERM: "it must be a file that can be read and written; " + ELSEWHERE,
}
# SQLITE_ERROR: what is asked of it is right, so that the file's own schema must be wrong.
DAMAGE = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_ERROR, sqlite3.SQLITE_TOOBIG)
PUT_ASIDE = "crosscheck run puts it aside and begins anew"

TYPES = {field.name: {"str": str, "int": int, "float": (int, float)}[str(field.type)] for field in fields(Measurement)}

Keyed = TypeVar("Keyed", Cell, Task)


class Damaged(Exception):
    """What shows that a store is damaged."""


class Store:
    """Measurements by the key of their cell, answers by that of their task.

    A context manager. What is put outlives this program, however it ends, when `put` returns; should the machine itself
    stop at once, the last of it may be missing, and runs again.

    A damaged file is put aside, with what lies beside it, and a new one begun; `notice` says so (empty otherwise).
    Where the text of a row alone is damaged, that row is missing. `copied`: the file that is read, which is a copy of
    `path` in a store that is only read.
    Raises FileTrouble, here and in every method, where the file can't be used.
    """

    def __init__(self, path: Path) -> None:
        self.path = self.copied = path
        self.notice = ""
        folder_for(path.parent, ELSEWHERE)
        with _sentences(path):
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
        """A store that is only read, where there is one: from a copy, so that nothing is written beside it.

        Raises FileTrouble where there is none or it can't be read.
        """
        with temporary_folder() as folder:
            copy = folder / "copy.sqlite"
            store = cls.__new__(cls)
            store.path, store.notice, store.copied = path, "", copy
            with _sentences(path):
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

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # Closing moves rows into the main file; should the disk be full, they stay beside it, where they are found.
        with suppress(sqlite3.Error):
            self._connection.close()

    def put(self, row: Measurement) -> None:
        """Store a row, replacing an older one of the same cell."""
        self._put(row.key, text_of_row(row))

    def put_answer(self, task: Task, answer: Answer) -> None:
        """Store the answer to a task, replacing an older one."""
        self._put(task.key, text_of_answer(task.key, answer))

    def _put(self, key: str, text: str) -> None:
        with _sentences(self.path), self._connection:
            self._connection.execute("insert or replace into results values (?, ?)", (key, text))
        self._require_file()

    def _require_file(self) -> None:
        """Raises FileTrouble where the file was removed or replaced: SQLite writes on, into a file without a name."""
        with suppress(OSError):
            if os.path.samestat(self._file, self.path.stat()):
                return
        raise FileTrouble(f"{self.path} was removed or replaced while it was written; run again, or {ELSEWHERE}")

    def remember(self, words: Iterable[str]) -> None:
        """Keep words that find a scene or an engine again which is not registered, so that a report shows it too."""
        with _sentences(self.path), self._connection:
            self._connection.executemany("insert or ignore into given values (?)", [(each,) for each in words])

    def remembered(self) -> tuple[str, ...]:
        """What `remember` was given, in that order."""
        with _sentences(self.path):
            return tuple(words for (words,) in self._connection.execute("select words from given order by rowid"))

    def get(self, cells: Iterable[Cell]) -> dict[Cell, Measurement]:
        """The stored rows of these cells.

        Cells that were never run, whose sources changed since, or whose row can't be read are left out.
        """
        rows = ((cell, row_of(cell.key, text)) for cell, text in self._texts(cells))
        return {cell: replace(row, purpose=cell.purpose) for cell, row in rows if row is not None}

    def answers(self, tasks: Iterable[Task]) -> dict[Task, Answer]:
        """The stored answers to these tasks; those not run, stale or unreadable are left out, as with rows."""
        answers = ((task, answer_of(task.key, text)) for task, text in self._texts(tasks))
        return {task: answer for task, answer in answers if answer is not None}

    def _texts(self, keyed: Iterable[Keyed]) -> Iterator[tuple[Keyed, str]]:
        """What is stored under the keys of these cells or tasks."""
        with _sentences(self.path):
            for one in keyed:
                found = self._connection.execute("select row from results where key = ?", (one.key,)).fetchone()
                if found:
                    yield one, found[0]


@contextmanager
def _sentences(path: Path) -> Iterator[None]:
    """What goes wrong with this file inside comes out as a FileTrouble with what to do."""
    try:
        yield
    except sqlite3.Error as error:
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        remedy = REMEDIES.get(code, ELSEWHERE)
        if code in DAMAGE:
            remedy = PUT_ASIDE
        raise FileTrouble(f"{path}: {error}: {remedy}") from None
    except OSError as error:
        raise FileTrouble(f"{path}: {error.strerror or error}: {ELSEWHERE}") from None


def _connected(path: Path) -> sqlite3.Connection:
    """A connection to a store, made if there is none. Raises Damaged, FileTrouble and what SQLite raises."""
    beside = path.with_name(path.name + "-wal")
    if path.is_file() and not path.stat().st_size and beside.is_file() and beside.stat().st_size:
        raise Damaged("it is empty, while rows lie beside it")  # SQLite would delete them
    connection = sqlite3.connect(path, timeout=WAIT)
    connection.text_factory = _decoded
    try:
        # To wait for the disk at every row took 5 to 10 ms of each, in which no worker is given anything.
        connection.execute("pragma synchronous=normal")
        wrong = connection.execute("pragma integrity_check(1)").fetchone()[0]
        if wrong != "ok":
            raise Damaged(" ".join(wrong.split()))
        version = connection.execute("pragma user_version").fetchone()[0]
        tables = {name for (name,) in connection.execute("select name from sqlite_master where type = 'table'")}
        columns = {
            name: tuple(line[1] for line in connection.execute(f"pragma table_info({name})"))
            for name in TABLES.keys() & tables
        }
        if version > SCHEMA:
            raise FileTrouble(
                f"{path} was written by a newer version of this program (schema {version}, known here: {SCHEMA}); "
                f"update it, or {ELSEWHERE}"
            )
        if tables and ("results" not in tables or not tables <= TABLES.keys() or not columns.items() <= TABLES.items()):
            raise FileTrouble(f"{path} is an SQLite file of another program, with other tables; {ELSEWHERE}")
        if version < SCHEMA or not tables:
            connection.execute("pragma journal_mode=wal")
            connection.execute("create table if not exists results (key text primary key, row text not null)")
            connection.execute("create table if not exists given (words text primary key)")
            connection.execute(f"pragma user_version={SCHEMA}")
    except BaseException as error:
        connection.close()
        if isinstance(error, UnicodeError):  # SQLite's own message, with what stands in the file
            raise Damaged("its tables have names that can't be read") from None
        if isinstance(error, sqlite3.DatabaseError) and getattr(error, "sqlite_errorcode", 0) & 0xFF in DAMAGE:
            raise Damaged(str(error)) from None
        raise
    return connection


def _decoded(raw: bytes) -> str:
    """A text of the file. One that is damaged must not raise: its digest tells that it is."""
    return raw.decode(errors="replace")


def _copy(path: Path, copy: Path) -> None:
    """Copy a store and the rows beside it, as they were at one moment. Raises FileTrouble, and OSError."""
    for _ in range(100):
        before = path.stat()
        shutil.copyfile(path, copy)
        # Rows are only ever added to what lies beside, so the part that is complete counts; when they move into the
        # main file while it is being copied, its time or size changes.
        with suppress(FileNotFoundError):
            shutil.copyfile(f"{path}-wal", f"{copy}-wal")
        after = path.stat()
        if (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size):
            return
    raise FileTrouble(f"{path} changes all the time; read it when the run that writes it has ended")


def _put_aside(path: Path) -> Path:
    """Give a file, and what lies beside it, a name that is free; the new name."""
    number = 1
    while any(path.with_name(f"{path.name}.damaged-{number}{end}").exists() for end in ("", *BESIDE)):
        number += 1
    aside = path.with_name(f"{path.name}.damaged-{number}")
    # The main file last: were it gone first and this ended by a kill, SQLite would delete the rows that lie beside.
    for end in (*BESIDE, ""):
        with suppress(FileNotFoundError):
            path.with_name(path.name + end).rename(f"{aside}{end}")
    return aside


def text_of_row(row: Measurement) -> str:
    return _signed(json.dumps(row.as_dict()))


@lru_cache(maxsize=8192)  # a command asks for a row more than once: what is missing, a table, several pages
def row_of(key: str, stored: Any) -> Measurement | None:
    """The row of this key; None unless it is whole and has the fields that rows have now."""
    try:
        values = json.loads(_trusted(stored))
        whole = (
            values["key"] == key
            and values.keys() == TYPES.keys()
            and all(isinstance(value, TYPES[name]) for name, value in values.items())
        )
        return Measurement(**{**values, "outcome": Outcome(values["outcome"])}) if whole else None
    except (ValueError, TypeError, KeyError):
        return None


def text_of_answer(key: str, answer: Answer) -> str:
    values = {name: value if isinstance(value, str) else _packed(value) for name, value in answer.values.items()}
    told = {"key": key, "outcome": answer.outcome, "sentence": answer.sentence, "limit": answer.limit}
    return _signed(json.dumps(told | {"values": values}))


def answer_of(key: str, stored: Any) -> Answer | None:
    """The answer to the task of this key; None unless it is whole."""
    try:
        told = json.loads(_trusted(stored))
        if told["key"] != key:
            return None
        values = {name: value if isinstance(value, str) else _unpacked(value) for name, value in told["values"].items()}
        return Answer(Outcome(told["outcome"]), told["sentence"], values, told["limit"])
    except (ValueError, TypeError, KeyError, AttributeError, zlib.error):
        return None


def _packed(array: Array) -> dict[str, Any]:
    data = np.asarray(array, dtype="<f8")
    return {"shape": data.shape, "float64": base64.b64encode(zlib.compress(data.tobytes())).decode()}


def _unpacked(value: dict[str, Any]) -> Array:
    data = zlib.decompress(base64.b64decode(value["float64"], validate=True))
    return np.frombuffer(data, dtype="<f8").reshape(value["shape"]).astype(float)


def digest(text: str) -> str:
    return hashlib.sha256(text.encode(errors="replace")).hexdigest()[:16]


def _signed(text: str) -> str:
    return f"{digest(text)} {text}"


def _trusted(stored: Any) -> str:
    """The JSON of a stored text. Raises ValueError unless its digest fits."""
    told, _, text = str(stored).partition(" ")
    if told != digest(text):
        raise ValueError("the digest does not fit")
    return text
