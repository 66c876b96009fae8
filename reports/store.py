"""Results kept as they arrive, in one SQLite file: a run that was killed goes on where it stopped."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

from reports.cells import Cell
from reports.measure import Measurement


class Store:
    """Measurements by the key of their cell. A context manager; every `put` is on disk when it returns."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._connection = sqlite3.connect(path, timeout=30)
        self._connection.execute("pragma journal_mode=wal")
        with self._connection:
            self._connection.execute("create table if not exists results (key text primary key, row text not null)")

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.close()

    def put(self, row: Measurement) -> None:
        """Store a row, replacing an older one of the same cell."""
        text = json.dumps(row.as_dict())
        with self._connection:
            self._connection.execute("insert or replace into results values (?, ?)", (row.key, text))

    def get(self, cells: Iterable[Cell]) -> dict[Cell, Measurement]:
        """The stored rows of these cells; cells that were never run, or whose sources changed since, are left out."""
        found: dict[Cell, Measurement] = {}
        for cell in cells:
            answer = self._connection.execute("select row from results where key = ?", (cell.key,)).fetchone()
            if answer:
                found[cell] = Measurement(**json.loads(answer[0]))
        return found

    def forget(self, cells: Iterable[Cell]) -> None:
        """Remove the rows of these cells."""
        with self._connection:
            self._connection.executemany("delete from results where key = ?", [(cell.key,) for cell in cells])
