"""The page of rolling bodies that are not round, and of two elliptic gears."""

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
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Motion
from reports.pages.common import PUBLIC, cells, described, refusals, scene_page
from reports.pages.rolling import drawings
from reports.plots.theme import svg
from reports.write.experiments import observe_each
from reports.write.rows import Rows
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

ROLL_CONSTRAINTS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, mujoco.EXTENDED)


def hill_cells(engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """Motions on the hill, which continue after the last comparable instant."""
    return tuple(Cell(RollingOnCircle(), engine, every) for engine in engines for every in (10, 100))


BEYOND_FRICTION = hill_cells((pymunk.TUNED, mujoco.TUNED, mujoco.EXTENDED))
STIFF_CONTACTS = tuple(method for method in mujoco_methods.ROLLS if "stiff" in method.variant)
CHATTERING = hill_cells((*PUBLIC, *STIFF_CONTACTS))


def position_errors(cell: Cell, run: Trajectory) -> tuple[float, float]:
    """The largest position error [m] while the motion can be compared, and the position error [m] at the end."""
    truth = cell.scene.motion(run.t)
    error = np.linalg.norm((run.pose - truth.pose)[:, 0, :2], axis=-1)
    comparable = run.t <= cell.scene.comparable_until * (1 + 1e-12)
    return float(error[comparable].max()), float(error[-1])


def beyond_friction(material: Material) -> list[Observation]:
    def describe(cell: Cell, run: Trajectory) -> str:
        earlier, last = position_errors(cell, run)
        until = cell.scene.comparable_until
        return f"error {number(earlier)} m up to {until:.3f} s, {number(last)} m at {cell.scene.duration:g} s"

    return observe_each(material, BEYOND_FRICTION, describe)


def after_friction(material: Material) -> dict[str, Any]:
    """`least`: the smallest ratio of the error at the end to the largest comparable error, in runs with a contact.
    `slips`, `hops`: the instants at which a real contact slips and hops [s]."""
    scene = RollingOnCircle()
    contacts = [cell for cell in BEYOND_FRICTION if cell.engine in PUBLIC]
    errors = [position_errors(cell, run) for cell, run in material.motions(contacts).items()]
    least = np.min([last / earlier for earlier, last in errors]) if errors else UNMEASURED
    return {"least": least, "slips": scene.comparable_until, "hops": scene.hop}


def absent_contact(cell: Cell, run: Trajectory) -> float:
    """The share of samples without a normal force, before the contact slips. The sample at t = 0 is left out."""
    rolling = (run.t <= cell.scene.comparable_until) & (run.t > 0)
    mechanism = cell.scene.mechanism()
    weight = mechanism.bodies[0].mass * float(np.hypot(*mechanism.gravity))
    return float(np.mean(np.abs(run.reaction[rolling, 1]) < 1e-3 * weight))


def absence(material: Material) -> dict[str, Any]:
    """`absent`: the smallest `absent_contact` of all runs of CHATTERING."""
    shares = [absent_contact(cell, run) for cell, run in material.motions(CHATTERING).items()]
    return {"absent": min(shares, default=UNMEASURED)}


TOO_LARGE = tuple(c for samples in (20, 10, 5) for c in cells(RollingDisc(), PUBLIC, (1,), samples))


def least_opening(material: Material) -> dict[str, Any]:
    """`least`: the smallest gap [m] in runs of TOO_LARGE."""
    rows = material.of(TOO_LARGE)
    return {"least": np.min([row.gap for row in rows]) if rows else UNMEASURED}


def refused(scene: RollingScene, setting: str) -> Callable[[Material], list[Observation]]:
    refusal = cache(lambda: refusals({setting: lambda: scene.motion([scene.duration])}))
    return lambda material: refusal()


ROLLING_SCENES = (
    RollingEllipse(),
    RollingDisc(),
    RollingCam(),
    RollingDownhill(),
    RollingInRing(),
    RollingOnCircle(),
    EllipticGears(),
)
# The exact solver with Euler steps is left out, because it costs as much as with Runge-Kutta steps.
COMPARED_ENGINES = tuple(engine for engine in VARIANTS if engine.variant != "euler projection")
ROLL_CONSTRUCTIONS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, *mujoco_methods.ROLLS)

HILL_SCENE = RollingOnCircle()  # the scene is shared, because it caches its last comparable instant


def compared(scene: Scene, engine: Engine) -> bool:
    """Whether a method is run in a scene. ROLL_CONSTRUCTIONS are run on the ellipse only. The exact solver is left out
    in two scenes, where it is slow."""
    if engine in ROLL_CONSTRUCTIONS:
        return scene.name == RollingEllipse.name
    return not (engine.name == "lagrange" and scene.name in (EllipticGears.name, RollingInRing.name))


def figures(material: Material) -> dict[str, str]:
    demanding = (RollingEllipse(), RollingOnCircle())
    return {
        "roulettes": svg(drawings.draw_roulettes(drawings.roulettes()), "Six bodies that roll, and what a point draws"),
        "contact": svg(drawings.draw_contact(), "An ellipse on a hill, on flat ground and in a hole"),
        "acceleration": svg(drawings.draw_acceleration(), "The acceleration's two parts"),
        "friction": svg(drawings.draw_friction(demanding), "Friction demanded and friction given"),
        "gears": svg(drawings.draw_gears(EllipticGears()), "Two elliptic gears and their rates"),
    }


def context(material: Material) -> Mapping[str, Any]:
    """`at(scene, method, step)`: the method's row with the step nearest to `step` [s]."""
    rows = Rows(material.sweep(ROLLING_SCENES))

    def at(scene: str, method: str, step: float) -> Any:
        return rows.of(scene, method).near(step)

    return {"at": at, "hill": HILL_SCENE}


PAGE = scene_page(
    "rolling",
    title="Rolling of bodies that are not round",
    lesson="The contact runs along both curves. That motion adds to accelerations, and MuJoCo's contacts leave it out.",
    scenes=ROLLING_SCENES,
    engines=(*COMPARED_ENGINES, *ROLL_CONSTRUCTIONS),
    failures=described(
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
                cells=cells(DiscInHole(clearance=clearance), ROLL_CONSTRAINTS, (1, 10, 100)),
                observations=refused(DiscInHole(clearance=1e-10), "clearance 1e-10") if clearance == 1e-3 else None,
            )
            for clearance in (0.1, 0.01, 1e-3)
        ),
        Failure(
            "A corner",
            cells=cells(SquareOnCatenaries(), (*ROLL_CONSTRAINTS, Lagrange("rk4", "projection")), (1, 10)),
            observations=refused(SquareOnCatenaries(), "beyond the corner"),
        ),
        Failure(
            "Beyond the hop, and beyond the friction",
            cells=cells(RollingOnCircle(), (*PUBLIC, mujoco.EXTENDED), (10, 100)),
            tasks=tuple(map(Motion, BEYOND_FRICTION)),
            observations=beyond_friction,
            context=after_friction,
        ),
        Failure(
            "Chatter on curved ground",
            tasks=tuple(map(Motion, CHATTERING)),
            observations=lambda material: observe_each(
                material, CHATTERING, lambda cell, run: f"absent in {100 * absent_contact(cell, run):.0f} % of samples"
            ),
            context=absence,
        ),
        Failure("Steps far too large", cells=TOO_LARGE, context=least_opening),
        corner=lambda: f"{SquareOnCatenaries().corner:.4f}",
    ),
    compared=compared,
    figures=figures,
    context=context,
)
