"""The page of rolling: bodies that are not round, by contact and by constraint, two elliptic gears, and where methods
fail: contacts and constraints apart, how discs part from a hill and chatter on it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any

import numpy as np

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from engines.registry import VARIANTS
from reference.scene import Scene
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    DiscInHole,
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
    RollingScene,
    SquareOnCatenaries,
)
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.page import Failure, Material, Observation, Page
from reports.model.tasks import Motion
from reports.pages.common import PUBLIC, cells, described, deviations, refusals
from reports.pages.rolling import drawings
from reports.plots.theme import svg
from reports.write.experiments import observe_each
from reports.write.rows import Rows, lookups
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

CONSTRAINTS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, mujoco.EXTENDED)


ROLLER = 0  # the only body's index


def hill_cells(engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """Whole motions on the hill, beyond where they may be compared."""
    return tuple(Cell(RollingOnCircle(), engine, every) for engine in engines for every in (10, 100))


STIFF = tuple(method for method in mujoco_methods.ROLLS if "stiff" in method.variant)


PARTINGS = hill_cells((pymunk.TUNED, mujoco.TUNED, mujoco.EXTENDED))


CHATTERING = hill_cells((*PUBLIC, *STIFF))


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

    return observe_each(material, PARTINGS, told)


def after_parting(material: Material) -> dict[str, Any]:
    """`least`: how many times a contact's error at the end is its largest before they part, in the best of the runs;
    `slips`, `hops`: when a real contact does so [s].
    """
    scene = RollingOnCircle()
    contacts = [cell for cell in PARTINGS if cell.engine in PUBLIC]
    found = [parting(cell, run) for cell, run in material.motions(contacts).items()]
    least = np.min([after / before for before, after in found]) if found else UNMEASURED
    return {"least": least, "slips": scene.comparable_until, "hops": scene.hop}


def absent_contact(cell: Cell, found: Trajectory) -> float:
    """The share of samples before the slip at which a contact carries nothing, though it must carry N (one roller)."""
    # The first sample has no step before it.
    within = (found.t <= cell.scene.comparable_until) & (found.t > 0)
    mechanism = cell.scene.mechanism()
    weight = mechanism.bodies[ROLLER].mass * float(np.hypot(*mechanism.gravity))
    return float(np.mean(np.abs(found.reaction[within, 1]) < 1e-3 * weight))


def chatter(material: Material) -> list[Observation]:
    """How often the contact on the hill is absent while it should press."""
    return observe_each(
        material, CHATTERING, lambda cell, run: f"absent in {100 * absent_contact(cell, run):.0f} % of samples"
    )


def absence(material: Material) -> dict[str, Any]:
    """`absent`: the least share of samples without a contact, of all runs on the hill."""
    shares = [absent_contact(cell, run) for cell, run in material.motions(CHATTERING).items()]
    return {"absent": min(shares, default=UNMEASURED)}


TOO_LARGE = tuple(c for samples in (20, 10, 5) for c in cells(RollingDisc(), PUBLIC, (1,), samples))


def least_opening(material: Material) -> dict[str, Any]:
    """`least` [m]: the smallest gap of a contact at steps far too large."""
    rows = material.of(TOO_LARGE)
    return {"least": np.min([row.gap for row in rows]) if rows else UNMEASURED}


def refused(scene: RollingScene, setting: str) -> Callable[[Material], list[Observation]]:
    """The reference's sentence on a motion that can't be."""
    refusal = cache(lambda: refusals({setting: lambda: scene.motion([scene.duration])}))
    return lambda material: refusal()


FAILURES = described(
    __file__,
    *(
        Failure(f"A contact as shipped, under {body}", cells=cells(scene, (mujoco.DEFAULT,), (1, 10, 100, 1000)))
        for body, scene in (("an ellipse", RollingEllipse()), ("an eccentric disc", RollingDisc()))
    ),
    Failure("Softer and stiffer contacts"),
    Failure("Polygons"),
    *(
        Failure(
            f"Nearly conformal curves: a hole larger by {clearance:g} of its radius",
            cells=cells(DiscInHole(clearance=clearance), CONSTRAINTS, (1, 10, 100)),
            observations=refused(DiscInHole(clearance=1e-10), "clearance 1e-10") if clearance == 1e-3 else None,
        )
        for clearance in (0.1, 0.01, 1e-3)
    ),
    Failure(
        "A corner",
        cells=cells(SquareOnCatenaries(), (*CONSTRAINTS, Lagrange("rk4", "projection")), (1, 10)),
        observations=refused(SquareOnCatenaries(), "beyond the corner"),
    ),
    Failure(
        "Beyond the hop, and beyond the friction",
        cells=cells(RollingOnCircle(), (*PUBLIC, mujoco.EXTENDED), (10, 100)),
        tasks=tuple(map(Motion, PARTINGS)),
        observations=partings,
        context=after_parting,
    ),
    Failure("Chatter on curved ground", tasks=tuple(map(Motion, CHATTERING)), observations=chatter, context=absence),
    Failure("Steps far too large", cells=TOO_LARGE, context=least_opening),
    corner=f"{SquareOnCatenaries().corner:.4f}",
)


SCENES = (
    RollingEllipse(),
    RollingDisc(),
    RollingCam(),
    RollingDownhill(),
    RollingInRing(),
    RollingOnCircle(),
    EllipticGears(),
)
# Ideal constraints under Euler say nothing here that Runge-Kutta's don't, and finding a contact is what costs.
COMPARED = tuple(engine for engine in VARIANTS if engine.variant != "euler projection")
CONSTRUCTIONS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, *mujoco_methods.ROLLS)

HILL = RollingOnCircle()  # kept: it works out once until when it can be compared


def compared(scene: Scene, engine: Engine) -> bool:
    """All but exact multipliers where each contact is a search within a search: the tests hold those to the truth.
    What is compared beside the variants is compared on the ellipse alone.
    """
    if engine in CONSTRUCTIONS:
        return scene.name == RollingEllipse.name
    return not (engine.name == "lagrange" and scene.name in (EllipticGears.name, RollingInRing.name))


def figures(material: Material) -> dict[str, str]:
    """Drawings from the reference."""
    demanding = (RollingEllipse(), RollingOnCircle())
    return {
        "roulettes": svg(drawings.draw_roulettes(drawings.roulettes()), "Six bodies that roll, and what a point draws"),
        "contact": svg(drawings.draw_contact(), "An ellipse on a hill, on flat ground and in a hole"),
        "acceleration": svg(drawings.draw_acceleration(), "The acceleration's two parts"),
        "friction": svg(drawings.draw_friction(demanding), "Friction demanded and friction given"),
        "gears": svg(drawings.draw_gears(EllipticGears()), "Two elliptic gears and their rates"),
    }


def context(material: Material) -> Mapping[str, Any]:
    """Rows and sweeps by method, for sentences; `at` takes a method in one word, and a step."""
    rows = Rows(material.sweep(SCENES))

    def at(scene: str, method: str, step: float) -> Any:
        """The row of a method ("mujoco tuned") at about a step [s]."""
        return rows.of(scene, method).near(step)

    return {**lookups(material, SCENES), "at": at, "hill": HILL}


PAGE = Page(
    name="rolling",
    title="Rolling of bodies that are not round",
    lesson="The contact runs along both curves. That motion adds to accelerations, and MuJoCo's contacts leave it out.",
    scenes=SCENES,
    engines=(*COMPARED, *CONSTRUCTIONS),
    failures=FAILURES,
    compared=compared,
    figures=figures,
    context=context,
    known=deviations("rolling"),
)
