"""CPU time of building and of stepping: process time, the first run discarded, the minimum of several."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from reference.mechanism import Mechanism
from reports.grid.cells import Cell

Result = TypeVar("Result")

BUDGET = 0.05  # s spent on repeating one cell
MOST_RUNS = 5
LONG = 0.5  # s: warming up is nothing beside a run this long, so it is not repeated


def process_seconds(function: Callable[[], Result]) -> tuple[float, Result]:
    """(CPU seconds of this process, the result)."""
    start = time.process_time()
    result = function()
    return time.process_time() - start, result


def repeated_stepping(cell: Cell, mechanism: Mechanism, first: float, build: float) -> tuple[float, int, float]:
    """(least stepping time [s], runs it is the least of, least building time [s]) of a cell already run once."""
    if not first < LONG:
        return first, 1, build
    times: list[float] = []
    while not times or (len(times) < MOST_RUNS and sum(times) + first < BUDGET):
        seconds, run = process_seconds(lambda: cell.engine.build(mechanism, cell.step))
        build = min(build, seconds)
        times.append(run(cell.sample_count, cell.every).stepping)
    return min(times), len(times), build
