"""The wheels' page: vehicles that coast on ideal wheels, and what towed and free wheels do."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from engines.registry import VARIANTS
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reports.charts.plane_panels import paths
from reports.charts.theme import svg
from reports.grid.cells import Cell
from reports.grid.tasks import Motion
from reports.pages.page import Material, Page
from reports.pages.skate.methods import known
from reports.pages.skate.page import counted
from reports.pages.wheels import pictures as wheels_pictures
from reports.pages.wheels.expectations import KNOWN
from reports.pages.wheels.experiments import FAILURES

NAME = "wheels"
SCENES = (CarAndTrailer(), Cart())

OVERLAID: dict[str, tuple[str, Any]] = {
    "pymunk default": ("first", "--"),
    "pymunk tuned": ("first", "-"),
    "mujoco default": ("second", "--"),
    "mujoco tuned": ("second", ":"),
}


COASTING = tuple(
    (title, scene, {name: Cell(scene, engine, 1) for name, engine in known(OVERLAID).items()})
    for title, scene in (
        ("car and trailer, 5 s, steps of 1e-2 s", CarAndTrailer()),
        ("cart with two casters, 3 s", Cart()),
    )
)


def figures(material: Material) -> dict[str, str]:
    """Both vehicles coasting, tows, casters, and the trailer that folds."""
    panels = []
    for title, scene, cells in COASTING:
        made = material.motions(cells.values())
        truth = scene.motion(np.linspace(0, scene.duration, scene.samples + 1)).pose
        found = {name: (made[cell].pose, *OVERLAID[name]) for name, cell in cells.items() if cell in made}
        panels.append(wheels_pictures.coasting(truth, found, title))
    return {
        "coasting": svg(paths(panels, columns=2), "Paths of the centres of mass, in truth and in several methods"),
        "tows": svg(wheels_pictures.tows(), "A towed wheel: the tractrix, and tows round circles"),
        "casters": svg(wheels_pictures.casters(), "Casters that trail, and that swing round"),
        "reversing": svg(wheels_pictures.reversing(), "A reversing trailer folds"),
    }


def words(material: Material) -> Mapping[str, Any]:
    """`counted`: the freedoms' table."""
    shown = (*SCENES, CarAndTrailer(redundant=True), Cart(redundant=True))
    doubled = ("car_and_trailer, both wheels of each axle", "cart, both wheels of the fixed axle")
    return {"counted": counted(shown, (*(scene.name for scene in SCENES), *doubled))}


PAGE = Page(
    name=NAME,
    title="Ideal wheels",
    lesson="Cars, trailers and carts consist of pins and skates. Here they coast in the ways that their wheels allow.",
    scenes=SCENES,
    engines=VARIANTS,
    failures=FAILURES,
    quantity="position",
    figures=figures,
    words=words,
    known=KNOWN,
    tasks=tuple(Motion(cell) for _, _, cells in COASTING for cell in cells.values()),
)
