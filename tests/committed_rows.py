"""The rows of the committed results, read back from their CSV files, so that pages can be written without a run."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from functools import cache
from typing import Any

from reports.cli.selection import shown_cells
from reports.model.cells import Cell
from reports.model.fingerprint import SHORT, digest
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.model.tasks import Answer, Task, answered
from tests import RESULTS

KINDS: Mapping[str, Any] = {"int": int, "float": float, "str": str}  # as strings


def _lines(name: str) -> list[dict[str, str]]:
    with (RESULTS / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


@cache
def _stored() -> dict[tuple[str, ...], list[dict[str, str]]]:
    lines: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for errors, timings in zip(_lines("errors.csv"), _lines("timings.csv"), strict=True):
        line = errors | timings
        key = (line["scene"], line["engine"], line["variant"], line["samples"], line["every"])
        lines.setdefault(key, []).append(line)
    return lines


def committed_rows(cells: Iterable[Cell]) -> dict[Cell, Measurement]:
    """A dictionary from cells to committed rows, without cells that have no row.

    Cells that differ only in the scene's numbers or the engine's settings are distinguished by digests. If the settings
    have changed since the publication, a row with equal numbers is used if it is the only row.
    """
    return {cell: row for cell in cells if (row := _row(cell)) is not None}


@cache
def page_rows(page: Page) -> Mapping[Cell, Measurement]:
    """The committed rows of a page's cells, cached, since cells' keys take time."""
    return committed_rows(shown_cells(page))


@cache
def answer_to(task: Task) -> Answer:
    """A task's result, cached in the process, since engines take time."""
    return answered(task)


def _lines_of(cell: Cell) -> list[dict[str, str]]:
    engine = cell.engine
    named = (cell.scene.name, engine.name, engine.variant, str(cell.sample_count), str(cell.every))
    return _stored().get(named, [])


def _line(cell: Cell) -> dict[str, str] | None:
    of_scene = [line for line in _lines_of(cell) if line["parameters"] == digest(repr(cell.scene), SHORT)]
    exact = [line for line in of_scene if line["settings"] == digest(repr(cell.engine), SHORT)]
    return exact[0] if exact else of_scene[0] if len(of_scene) == 1 else None


def _row(cell: Cell) -> Measurement | None:
    line = _line(cell)
    if line is None:
        return None
    numbers = {
        f.name: KINDS[str(f.type)](line[f.name])
        for f in fields(Measurement)
        if f.name in line and f.name not in ("purpose", "variant", "parameters", "settings", "step")
    }
    return replace(blank(cell), **numbers | {"outcome": Outcome(line["outcome"])})
