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
from reports.charts.theme import svg
from reports.pages.page import Material, Page
from reports.pages.rolling import charts as rolling_charts
from reports.pages.rolling import drawings as rolling_drawings
from reports.pages.rolling.expectations import KNOWN, ORDERS
from reports.pages.rolling.experiments import FAILURES, MAPS, polygon_cells, softness_cells
from reports.text.lookups import nearest_step, told
from reports.text.unmeasured import UNMEASURED, Known

NAME = "rolling"
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
BY_CONSTRAINT: tuple[Engine, ...] = (pymunk_methods.ROLL_STALE_PIVOT, pymunk_methods.ROLL_PIVOT)
ENGINES_HERE: tuple[Engine, ...] = (*COMPARED, *BY_CONSTRAINT, *mujoco_methods.ROLLS)

HILL = RollingOnCircle()  # kept: it works out once until when it can be compared


def compared(scene: Scene, engine: Engine) -> bool:
    """All but exact multipliers where each contact is a search within a search: the tests hold those to the truth."""
    return not (engine.name == "lagrange" and scene.name in (EllipticGears.name, RollingInRing.name))


def figures(material: Material) -> dict[str, str]:
    """Drawings from the reference, and the plateaus from the rows of two experiments."""
    found = {
        "roulettes": svg(
            rolling_drawings.draw_roulettes(rolling_drawings.roulettes()),
            "Six bodies that roll, and what a point draws",
        ),
        "contact": svg(rolling_drawings.draw_contact(), "An ellipse on a hill, on flat ground and in a hole"),
        "acceleration": svg(rolling_charts.draw_acceleration(), "The acceleration's two parts"),
        "friction": svg(
            rolling_charts.draw_friction((RollingEllipse(), RollingOnCircle())), "Friction demanded and friction given"
        ),
        "gears": svg(rolling_drawings.draw_gears(EllipticGears()), "Two elliptic gears and their rates"),
    }
    corners = [(corners, material.rows[cell]) for corners, cell in polygon_cells() if cell in material.rows]
    softness = [(constant, material.rows[cell]) for constant, cell in softness_cells() if cell in material.rows]
    if corners and softness:
        found["plateaus"] = svg(rolling_charts.draw_plateaus(corners, softness), "Errors that no step removes")
    return found


def words(material: Material) -> Mapping[str, Any]:
    """Rows and sweeps by method, for sentences; `at` takes a method in one word, and a step."""
    rows = material.sweep(SCENES)

    def at(scene: str, method: str, step: float) -> Any:
        """The row of a method ("mujoco tuned") at about a step [s]."""
        own = (row for row in rows if row.scene == scene and row.method == method)
        return nearest_step(own, step) or UNMEASURED

    polygons = Known(
        {(corners, cell.every): material.rows[cell] for corners, cell in polygon_cells() if cell in material.rows}
    )
    return {**told(material, SCENES), "at": at, "polygons": polygons, "hill": HILL}


PAGE = Page(
    name=NAME,
    title="Rolling of bodies that are not round",
    lesson="The contact runs along both curves. That motion adds to accelerations, and MuJoCo's contacts leave it out.",
    scenes=SCENES,
    engines=ENGINES_HERE,
    failures=FAILURES,
    maps=MAPS,
    compared=compared,
    figures=figures,
    words=words,
    orders=ORDERS,
    known=KNOWN,
)
