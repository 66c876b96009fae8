"""The page of a person who sways on one foot, and who falls from one foot or from two feet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from engines import ConvergenceOrder, pymunk
from engines.registry import VARIANTS
from reference.scenes.person import OneFoot, SwayingOnOneFoot, TwoFeet, modes_upright
from reports.model.page import Failure, Material, Observation
from reports.pages.common import MAIN_METHODS, cells, described, refusals, scene_page, sweeps
from reports.plots.mechanisms import Points, Strip, stroboscope
from reports.plots.theme import svg

LONGER_SWAY = SwayingOnOneFoot(duration=0.6, horizon=0.6)


def growth(material: Material) -> list[Observation]:
    """The modes of small motions about the upright pose on one foot."""
    squares, _ = modes_upright(SwayingOnOneFoot())
    observations = []
    for square in squares:
        rate = math.sqrt(abs(square))
        mode = f"swings at {rate:.3g} rad/s" if square < 0 else f"grows by e in {1 / rate:.3g} s"
        observations.append(Observation("the reference, linearised", "upright on one foot", mode))
    return observations


IMPOSSIBLE_STANCES: dict[str, float] = {"stance": 2.0, "hip_y": 0.95, "knees": 0, "height": 0.0}


def impossible(material: Material) -> list[Observation]:
    return refusals(
        {f"{name} = {n!r}": partial(replace, TwoFeet(), **{name: n}) for name, n in IMPOSSIBLE_STANCES.items()}
    )


PERSONS = (SwayingOnOneFoot(), OneFoot(), TwoFeet())


def ends(person: OneFoot) -> dict[str, Points]:
    """Body -> free end in the body's frame [m]. The free ends are the shoulder and the ankle of the lifted foot."""
    ahead = person.lengths - person._behind
    return {"trunk": ((float(ahead[2]), 0.0),), "right shank": ((float(ahead[4]), 0.0),)}


def figures(material: Material) -> dict[str, str]:
    sway, one_foot, two_feet = SwayingOnOneFoot(duration=0.5), OneFoot(), TwoFeet()
    strips = (
        Strip(sway, "Swaying on one foot until the knee buckles", 6, ends=ends(sway), spread=0.7, floor=True),
        Strip(one_foot, "Falling from one foot", 6, ends=ends(one_foot), spread=0.8, floor=True),
        Strip(two_feet, "Falling from two feet", 6, ends=ends(two_feet), spread=1.0, floor=True),
    )
    return {"stroboscope": svg(stroboscope(strips, columns=1), "A person swaying and falling, as a film")}


def context(material: Material) -> Mapping[str, Any]:
    """`freedoms`: degrees of freedom by scene. `knee`: time constant of the knee's growing mode [s]."""
    freedoms = {scene.name: scene.mechanism().degrees_of_freedom()[0] for scene in PERSONS}
    knee = float(modes_upright(SwayingOnOneFoot())[0][-1]) ** -0.5
    return {"freedoms": freedoms, "knee": knee}


# The extrapolated method has the order 5 in these scenes.
OBSERVED_ORDERS = {
    (scene, "pymunk extended"): ConvergenceOrder(5, reaction=4, differences=8, amplified=17.0)
    for scene in ("person_swaying", "person_one_foot", "person_two_feet")
}

PAGE = scene_page(
    "person",
    title="A person on one foot and on two",
    lesson="Five segments without muscles: an open chain on one foot, a loop on two. The knee buckles.",
    scenes=PERSONS,
    advised="person_two_feet",
    engines=VARIANTS,
    failures=described(
        __file__,
        Failure("Standing still", cells=cells(LONGER_SWAY, MAIN_METHODS, (1, 10, 100)), observations=growth),
        Failure(
            "A heavy trunk on light shanks, with too few sweeps",
            cells=cells(OneFoot(), (pymunk.DEFAULT,), (1, 10))
            + cells(OneFoot(), map(sweeps, (5, 10, 20, 100)), (1, 3, 10, 30, 100)),
        ),
        Failure("Stances that can't be", observations=impossible),
        swayed=SwayingOnOneFoot().duration,
    ),
    figures=figures,
    context=context,
    orders=OBSERVED_ORDERS,
)
