"""The page of the slider-crank and of constructions of its slot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from engines.lagrange import Lagrange
from engines.mujoco.methods import SLOTS
from engines.registry import VARIANTS
from reference.scenes.slider_crank import (
    DrivenSliderCrank,
    FreeSliderCrank,
    RodEndInSlot,
    SliderAtDeadCentre,
    SlottedLever,
)
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Task, Values
from reports.pages.common import MAIN_METHODS, cells, described, read_answers, refusals, scene_page
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

LEFT_BY = 1.0  # rad; a crank with a larger angle has left its dead centre
LEAVING_SAMPLES = 3001


@dataclass(frozen=True)
class Leaving(Task):
    """A task with the time at which a crank has left its dead centre. `angle`: initial distance [rad]."""

    angle: float

    seconds: ClassVar[float] = 0.4  # measured
    words: ClassVar[str] = "leaving a dead centre from {0.angle:g} rad"

    def run(self) -> Values:
        """`when`: the first sampled time [s] at which the crank's angle is larger than LEFT_BY."""
        scene = SliderAtDeadCentre(angle=self.angle)
        t = [scene.duration * i / (LEAVING_SAMPLES - 1) for i in range(LEAVING_SAMPLES)]
        has_left = scene.motion(t).pose[:, 0, 2] > LEFT_BY
        return {"when": np.asarray(t[int(np.argmax(has_left))] if has_left.any() else np.nan)}


LEAVING = tuple(map(Leaving, (1e-2, 1e-4, 1e-6)))


def delay(material: Material) -> dict[str, Any]:
    """`later`: the difference [s] between the times of the last two tasks in LEAVING. `nearer`: logarithm of the ratio
    of both initial distances."""
    far, near = (material.finished(task) for task in LEAVING[-2:])
    later = near.number("when") - far.number("when") if far and near else UNMEASURED
    return {"later": later, "nearer": math.log(LEAVING[-2].angle / LEAVING[-1].angle)}


def leaving(material: Material) -> list[Observation]:
    """The times at which the crank has left its dead centre in the reference motion, by initial distance."""
    settings = [(task, f"{number(task.angle)} rad aside") for task in LEAVING]
    describe = "a radian away after {:.3f} s".format
    return read_answers(material, "the reference", settings, lambda answer: describe(answer.number("when")))


def out_of_reach(material: Material) -> list[Observation]:
    shape = DrivenSliderCrank().shape
    offsets = (shape.rod - shape.crank, 1.0)
    return refusals({f"offset {offset:.3g} m": partial(replace, shape, offset=offset) for offset in offsets})


def figures(material: Material) -> dict[str, str]:
    driven = DrivenSliderCrank()
    offset = DrivenSliderCrank(offset=0.4, crank=0.4)
    strips = (
        Strip(driven, "Driven", 9),
        Strip(FreeSliderCrank(), "Let go", 7, end=0.6),
        Strip(offset, "Slot 0.4 m above the pivot", 9),
        Strip(DrivenSliderCrank(branch=-1), "The other branch", 9),
    )
    return {"stroboscope": svg(stroboscope(strips), "Slider-cranks in motion")}


def context(material: Material) -> Mapping[str, Any]:
    """Dead centres [°] and stroke [m] of the driven scene."""
    shape = DrivenSliderCrank().shape
    stretched, folded = shape.dead_centres()
    return {"stretched": math.degrees(stretched), "in_line_again": math.degrees(folded), "stroke": shape.stroke()}


PAGE = scene_page(
    "slider_crank",
    title="The slider-crank",
    lesson="A slot and three pins: a loop that slides, and a groove that is always right only at a centre of mass.",
    scenes=(DrivenSliderCrank(), FreeSliderCrank()),
    advised="free_slider_crank",
    engines=VARIANTS,
    failures=described(
        __file__,
        Failure("The rod's end in a groove", cells=cells(RodEndInSlot(), MAIN_METHODS, (1, 10, 100))),
        Failure("A groove in a moving lever", cells=cells(SlottedLever(), (*MAIN_METHODS, *SLOTS), (1, 10, 100))),
        Failure(
            "A slider that has to start the crank, next to its dead centre",
            cells=cells(SliderAtDeadCentre(), (*MAIN_METHODS, Lagrange("rk4", "projection")), (1, 10)),
            tasks=LEAVING,
            context=delay,
            observations=leaving,
        ),
        Failure("A slider in its dead centre", cells=cells(SliderAtDeadCentre(angle=0.0), MAIN_METHODS, (1, 10))),
        Failure("A slot out of reach", observations=out_of_reach),
    ),
    figures=figures,
    context=context,
)
