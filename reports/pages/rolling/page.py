"""The page of rolling: bodies that are not round, by contact and by constraint, and two elliptic gears."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from engines import Engine
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from engines.registry import VARIANTS
from reference.scene import Scene
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reports.model.page import Material, Page
from reports.pages.common import deviations
from reports.pages.rolling import drawings
from reports.pages.rolling.experiments import FAILURES, polygon_cells
from reports.plots.theme import svg
from reports.write.rows import Rows, lookups
from reports.write.unmeasured import Known

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


def words(material: Material) -> Mapping[str, Any]:
    """Rows and sweeps by method, for sentences; `at` takes a method in one word, and a step."""
    rows = Rows(material.sweep(SCENES))

    def at(scene: str, method: str, step: float) -> Any:
        """The row of a method ("mujoco tuned") at about a step [s]."""
        return rows.of(scene, method).near(step)

    polygons = Known(
        {(corners, cell.every): material.rows[cell] for corners, cell in polygon_cells() if cell in material.rows}
    )
    return {**lookups(material, SCENES), "at": at, "polygons": polygons, "hill": HILL}


PAGE = Page(
    name="rolling",
    title="Rolling of bodies that are not round",
    lesson="The contact runs along both curves. That motion adds to accelerations, and MuJoCo's contacts leave it out.",
    scenes=SCENES,
    engines=(*COMPARED, *CONSTRUCTIONS),
    failures=FAILURES,
    compared=compared,
    figures=figures,
    words=words,
    known=deviations("rolling"),
)
