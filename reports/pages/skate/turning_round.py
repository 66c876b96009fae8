"""A sleigh that is pushed backwards turns round: how fast the turning grows, and when."""

from __future__ import annotations

import numpy as np

from reference.scenes.skates.sleigh import SleighBackwards
from reports.grid.cells import Cell
from reports.pages.observing import observe
from reports.pages.page import Material, Observation
from reports.pages.skate.methods import CONSTRUCTIONS, ORDINARY
from reports.text.tables import number

# Between these rates [rad/s] a turning on the straight run grows as the linearised motion says: far above where it
# starts, and its square is still below a thousandth of that of the largest rate.
GROWING = (2e-3, 4e-2)


def growth_of(t: np.ndarray, rate: np.ndarray) -> float:
    """The slope of log |turning rate| over time [1/s] between the rates of GROWING; NaN when it never gets there."""
    size = np.abs(rate)
    late = int(np.argmax(size > GROWING[1])) if np.any(size > GROWING[1]) else 0
    chosen = (np.arange(len(t)) < late) & (size > GROWING[0])
    if chosen.sum() < 3:
        return float("nan")
    return float(np.polyfit(t[chosen], np.log(size[chosen]), 1)[0])


def turned_at(t: np.ndarray, rate: np.ndarray) -> float:
    """When it turns fastest [s], which is when the exact sleigh slides neither way."""
    return float(t[int(np.argmax(np.abs(rate)))])


BACKWARDS = SleighBackwards()


TURNING_ROUND = tuple(Cell(BACKWARDS, engine, 1) for engine in (*ORDINARY, *CONSTRUCTIONS))


def backwards(material: Material) -> list[Observation]:
    """The growth of a small turning and the time of turning round, in each method."""
    t = np.linspace(0, BACKWARDS.duration, BACKWARDS.samples + 1)
    truth = BACKWARDS.motion(t).twist[:, 0, 2]
    found = [
        Observation("linearised exact motion", "", rf"grows as $e^{{{BACKWARDS.growth_rate():.4g}\,t}}$"),
        Observation("exact motion", "", _grown(t, truth)),
    ]
    for cell in TURNING_ROUND:
        setting = f"step {number(cell.step)} s"
        found += observe(material, cell, setting, lambda run: _grown(run.t, run.twist[:, 0, 2]))
    return found


def _grown(t: np.ndarray, rate: np.ndarray) -> str:
    grows = growth_of(t, rate)
    if np.isnan(grows):
        return f"does not turn round: at most {number(float(np.abs(rate).max()))} rad/s"
    return f"{grows:.4f} per second; fastest, {np.abs(rate).max():.3f} rad/s, at {turned_at(t, rate):.2f} s"
