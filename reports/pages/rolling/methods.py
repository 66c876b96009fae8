"""The methods that roll, contacts and constraints apart; and how their discs part from a hill and chatter on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from reference.scene import Scene
from reference.scenes.rolling.scenes import RollingOnCircle
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.page import Material, Observation
from reports.write.experiments import observe
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

CONTACTS: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
CONSTRAINTS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, mujoco.EXTENDED)


def cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)


ROLLER = 0  # the only body's index


def hill_cells(engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """Whole motions on the hill, beyond where they may be compared."""
    return tuple(Cell(RollingOnCircle(), engine, every) for engine in engines for every in (10, 100))


STIFF = tuple(method for method in mujoco_methods.ROLLS if "stiff" in method.variant)


PARTINGS = hill_cells((pymunk.TUNED, mujoco.TUNED, mujoco.EXTENDED))


CHATTERING = hill_cells((*CONTACTS, *STIFF))


def parting(cell: Cell, found: Trajectory) -> tuple[float, float]:
    """How far a body is from the ideal motion [m]: largest up to the last comparable sample, and at the end."""
    truth = cell.scene.motion(found.t)
    apart = np.linalg.norm((found.pose - truth.pose)[:, ROLLER, :2], axis=-1)
    within = found.t <= cell.scene.comparable_until * (1 + 1e-12)
    return float(apart[within].max()), float(apart[-1])


def partings(material: Material) -> list[Observation]:
    """How far contact is from the ideal motion before and after the instant at which ideal rolling ends."""

    def told(cell: Cell, run: Trajectory) -> str:
        before, after = parting(cell, run)
        until = cell.scene.comparable_until
        return f"off by {number(before)} m up to {until:.3f} s, by {number(after)} m at {cell.scene.duration:g} s"

    return observed(material, PARTINGS, told)


def after_parting(material: Material) -> dict[str, Any]:
    """`least`: how many times a contact's error at the end is its largest before they part, in the best of the runs;
    `slips`, `hops`: when a real contact does so [s].
    """
    scene = RollingOnCircle()
    contacts = [cell for cell in PARTINGS if cell.engine in CONTACTS]
    found = [parting(cell, run) for cell, run in material.motions(contacts).items()]
    least = np.min([after / before for before, after in found]) if found else UNMEASURED
    return {"least": least, "slips": scene.comparable_until, "hops": scene.hop}


def observed(material: Material, cells: Iterable[Cell], told: Callable[[Cell, Trajectory], str]) -> list[Observation]:
    """A line for each cell whose motion was kept."""
    found: list[Observation] = []
    for cell in cells:
        found += observe(material, cell, f"step {number(cell.step)} s", partial(told, cell))
    return found


def absent_contact(cell: Cell, found: Trajectory) -> float:
    """The share of samples before the slip at which a contact carries nothing, though it must carry N (one roller)."""
    # The first sample has no step before it.
    within = (found.t <= cell.scene.comparable_until) & (found.t > 0)
    mechanism = cell.scene.mechanism()
    weight = mechanism.bodies[ROLLER].mass * float(np.hypot(*mechanism.gravity))
    return float(np.mean(np.abs(found.reaction[within, 1]) < 1e-3 * weight))


def chatter(material: Material) -> list[Observation]:
    """How often the contact on the hill is absent while it should press."""
    return observed(
        material, CHATTERING, lambda cell, run: f"absent in {100 * absent_contact(cell, run):.0f} % of samples"
    )
