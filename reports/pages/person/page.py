"""The person's page: swaying on one foot, falling from one foot and from two."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from engines import ConvergenceOrder, pymunk
from engines.registry import VARIANTS
from reference.scenes.person import OneFoot, SwayingOnOneFoot, TwoFeet, modes_upright
from reports.model.page import Failure, Material, Observation, Page
from reports.pages.common import ALL, cells, described, deviations, refusals, sweeps
from reports.plots.mechanisms import Points, Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups

LONGER = SwayingOnOneFoot(duration=0.6, horizon=0.6)


def growth(material: Material) -> list[Observation]:
    """The modes of standing upright on one foot."""
    squares, _ = modes_upright(SwayingOnOneFoot())
    found = []
    for square in squares:
        rate = math.sqrt(abs(square))
        said = f"swings at {rate:.3g} rad/s" if square < 0 else f"grows by e in {1 / rate:.3g} s"
        found.append(Observation("the reference, linearised", "upright on one foot", said))
    return found


WRONG: dict[str, float] = {"stance": 2.0, "hip_y": 0.95, "knees": 0, "height": 0.0}


def impossible(material: Material) -> list[Observation]:
    """The reference's sentences on stances that can't be."""
    return refusals({f"{name} = {n!r}": partial(replace, TwoFeet(), **{name: n}) for name, n in WRONG.items()})


FAILURES = described(
    __file__,
    Failure("Standing still", cells=cells(LONGER, ALL, (1, 10, 100)), observations=growth),
    Failure(
        "A heavy trunk on light shanks, with too few sweeps",
        cells=cells(OneFoot(), (pymunk.DEFAULT,), (1, 10))
        + cells(OneFoot(), map(sweeps, (5, 10, 20, 100)), (1, 3, 10, 30, 100)),
    ),
    Failure("Stances that can't be", observations=impossible),
    swayed=SwayingOnOneFoot().duration,
)


SCENES = (SwayingOnOneFoot(), OneFoot(), TwoFeet())


def ends(person: OneFoot) -> dict[str, Points]:
    """The shoulder, and the ankle of a lifted foot: ends that have no joint, in their bodies' frames [m]."""
    away = person.lengths - person._behind
    return {"trunk": ((float(away[2]), 0.0),), "right shank": ((float(away[4]), 0.0),)}


def figures(material: Material) -> dict[str, str]:
    """Films of the truth, with the floor."""
    sway, one, two = SwayingOnOneFoot(duration=0.5), OneFoot(), TwoFeet()
    strips = (
        Strip(sway, "Swaying on one foot until the knee buckles", 6, ends=ends(sway), spread=0.7, floor=True),
        Strip(one, "Falling from one foot", 6, ends=ends(one), spread=0.8, floor=True),
        Strip(two, "Falling from two feet", 6, ends=ends(two), spread=1.0, floor=True),
    )
    return {"stroboscope": svg(stroboscope(strips, columns=1), "A person swaying and falling, as a film")}


def context(material: Material) -> Mapping[str, Any]:
    """Rows, and freedoms by rank."""
    freedoms = {scene.name: scene.mechanism().degrees_of_freedom()[0] for scene in SCENES}
    knee = float(modes_upright(SwayingOnOneFoot())[0][-1]) ** -0.5
    return {**lookups(material, SCENES), "freedoms": freedoms, "knee": knee}


# Observed on all three: an error of the fifth power is left.
ORDERS = {
    (scene, "pymunk extended"): ConvergenceOrder(5, reaction=4, differences=8, amplified=17.0)
    for scene in ("person_swaying", "person_one_foot", "person_two_feet")
}

PAGE = Page(
    name="person",
    title="A person on one foot and on two",
    lesson="Five segments without muscles: an open chain on one foot, a loop on two. The knee buckles.",
    scenes=SCENES,
    advised="person_two_feet",
    engines=VARIANTS,
    failures=FAILURES,
    figures=figures,
    context=context,
    orders=ORDERS,
    known=deviations("person"),
)
