"""When a skate that friction holds slips: the exact force above the limit, and the engines."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.trajectory import Trajectory
from reports.grid.cells import Cell
from reports.pages.observing import observe
from reports.pages.page import Material, Observation
from reports.pages.skate.methods import limited
from reports.pages.skate.turning_round import BACKWARDS
from reports.text.unmeasured import UNMEASURED


def first_beyond(scene: ChaplyginSleigh, limit: float) -> float | None:
    """When the exact lateral force first exceeds a limit [N], to 1e-4 of the duration [s]; None if never."""
    t = np.linspace(0, scene.duration, 10_001)
    over = np.flatnonzero(np.abs(scene.lateral_force(t)) > limit)
    return float(t[over[0]]) if over.size else None


def slipping(material: Material) -> list[Observation]:
    """When the exact lateral force exceeds a friction's limit, and when engines with that limit slip."""
    found = []
    for limit, cells in LIMITED.items():
        exact = first_beyond(BACKWARDS, limit)
        when = f"exceeds it at {exact:.3f} s" if exact is not None else f"never: at most {PEAK:.4f} N"
        found.append(Observation("exact lateral force", f"{limit:g} N", when))
        for cell in cells:
            found += observe(material, cell, f"{limit:g} N", _slipped)
    return found


def _slipped(run: Trajectory) -> str:
    when = slips_at(run)
    if when is None:
        return "holds"
    return f"slips by {SLIPS:g} m/s at {when:.2f} s, at most {np.abs(slip_of(run)).max():.2g}"


def slip_of(run: Trajectory) -> np.ndarray:
    """The skate's sideways velocity (times,) [m/s]."""
    return BACKWARDS.mechanism().slip(run.pose, run.twist)[:, 0]


def slips_at(run: Trajectory) -> float | None:
    """When it slips by more than SLIPS first [s]; None if it holds."""
    over = np.flatnonzero(np.abs(slip_of(run)) > SLIPS)
    return float(run.t[over[0]]) if over.size else None


def delays(material: Material) -> dict[str, Any]:
    """`least`, `most` [s]: how long after the exact force passes a limit an engine with that limit slips."""
    found = []
    for limit, cells in LIMITED.items():
        exact = first_beyond(BACKWARDS, limit)
        slipped = map(slips_at, material.motions(cells).values())
        found += [when - exact for when in slipped if exact is not None and when is not None]
    return {"least": min(found, default=UNMEASURED), "most": max(found, default=UNMEASURED)}


PEAK = float(np.abs(BACKWARDS.lateral_force(np.linspace(0, BACKWARDS.duration, 10_001))).max())


# A friction's limit [N] -> runs with it.
LIMITED = {limit: tuple(Cell(BACKWARDS, engine, 10) for engine in limited(limit)) for limit in (0.1, 0.3, 0.5, 0.7)}


SLIPS = 2e-3  # m/s: above what either method lets pass at this step while it holds
