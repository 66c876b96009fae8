"""The rows of the committed results, read back from their CSV files, so that pages can be written without a run."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any

from reports.cli.selection import shown_cells
from reports.grid.cells import Cell
from reports.grid.measure import Measurement, blank
from reports.grid.outcomes import Outcome
from reports.pages.page import Page
from reports.text.csv_files import digest

RESULTS = Path(__file__).parents[1] / "reports" / "results"
KINDS: Mapping[str, Any] = {"int": int, "float": float, "str": str}  # annotations are strings in that module


def _lines(name: str) -> list[dict[str, str]]:
    with (RESULTS / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


@cache
def _stored() -> dict[tuple[str, ...], list[dict[str, str]]]:
    """Errors and timings joined, by what names a cell apart from its numbers and settings."""
    found: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for errors, timings in zip(_lines("errors.csv"), _lines("timings.csv"), strict=True):
        line = errors | timings
        key = (line["scene"], line["engine"], line["variant"], line["purpose"], line["samples"], line["every"])
        found.setdefault(key, []).append(line)
    return found


@cache
def _said(description: str) -> frozenset[str]:
    """What a scene or an engine with its settings says of itself, setting by setting."""
    return frozenset(re.findall(r"\w+=[^,()]+", description))


@cache
def _described(name: str) -> frozenset[str]:
    return next(
        (_said(line["description"]) for line in _lines("descriptions.csv") if line["digest"] == name), frozenset()
    )


def committed_rows(cells: Iterable[Cell]) -> dict[Cell, Measurement]:
    """The committed row of each cell that has one.

    Several cells differ in the scene's numbers or the engine's settings alone: their digests tell them apart. Where
    the sources have changed since, no digest fits, and the row has to do whose numbers and settings are most alike.
    """
    return {cell: row for cell in cells if (row := _row(cell)) is not None}


@cache
def page_rows(page: Page) -> Mapping[Cell, Measurement]:
    """The committed rows of a page's cells: read once for all tests, because a cell's key takes its time."""
    return committed_rows(shown_cells(page))


def _row(cell: Cell) -> Measurement | None:
    start = blank(cell)
    named = (start.scene, start.engine, start.variant, start.purpose, str(start.samples), str(start.every))
    lines = _stored().get(named, [])
    if not lines:
        return None
    own = (digest(start.parameters), digest(start.settings))
    line = next((line for line in lines if (line["parameters"], line["settings"]) == own), None)
    if line is None:
        wanted = _said(start.parameters) | _said(start.settings)
        line = max(
            lines, key=lambda line: len(wanted & (_described(line["parameters"]) | _described(line["settings"])))
        )
    told = {
        f.name: KINDS[str(f.type)](line[f.name])
        for f in fields(Measurement)
        if f.name in line and f.name not in ("parameters", "settings", "step")
    }
    return replace(start, **told | {"outcome": Outcome(line["outcome"])})
