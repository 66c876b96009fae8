"""CPU time of building and of stepping: process time, the first run discarded, the minimum of several."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

from reference.mechanism import Mechanism
from reports.model.cells import Cell

Result = TypeVar("Result")

# CPU seconds after which a cell is not run once more, building and reading included. Of 63 cells of the quick grid the
# least of these runs was 0.7 % above the least of ten in the middle, and 3.3 % for one in ten; with 0.05 s, 0.6 and 3.
BUDGET = 0.03
MOST_RUNS = 5
# s: not repeated from here on. The first of runs of 0.2 to 0.5 s took 1.00 times as long as the later ones (median of
# ten; single runs scatter by more), of 0.1 to 0.2 s 1.04 times. They are two thirds of all stepping of the full grid.
LONG = 0.1


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
    begin = time.process_time()
    while not times or (len(times) < MOST_RUNS and time.process_time() - begin < BUDGET):
        seconds, run = process_seconds(lambda: cell.engine.build(mechanism, cell.step))
        build = min(build, seconds)
        times.append(run(cell.sample_count, cell.every).stepping)
    return min(times), len(times), build
