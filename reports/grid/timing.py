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
# s: not repeated from here on. The first of runs of 0.2 to 0.5 s took 1.00 times as long as the later ones (median of
# ten; single runs scatter by more), of 0.1 to 0.2 s 1.04 times. They are two fifths of all stepping of the full grid.
LONG = 0.2


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
