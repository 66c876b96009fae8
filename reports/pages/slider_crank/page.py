"""The slider-crank's page: driven and free, and what stands for its slot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from engines import pymunk
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
from reports.model.page import Failure, Material, Observation, Page
from reports.model.tasks import Task, Values
from reports.pages.common import ALL, cells, described, deviations, read_answers, refusals
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

FAR = 1.0  # rad
INSTANTS = 3001  # so that the time is known to a millisecond


@dataclass(frozen=True)
class Leaving(Task):
    """A slider that starts a crank, `angle` [rad] beside its dead centre."""

    angle: float

    seconds: ClassVar[float] = 0.4  # measured
    words: ClassVar[str] = "leaving a dead centre from {0.angle:g} rad"

    def run(self) -> Values:
        """`when`: the first of INSTANTS over the scene's duration at which the crank is further than FAR [s]."""
        scene = SliderAtDeadCentre(angle=self.angle)
        t = [scene.duration * i / (INSTANTS - 1) for i in range(INSTANTS)]
        far = scene.motion(t).pose[:, 0, 2] > FAR
        return {"when": np.asarray(t[int(np.argmax(far))] if far.any() else np.nan)}


GROOVE = (
    replace(pymunk.DEFAULT, variant="default, GrooveJoint at the rod's end", slot="groove"),
    replace(pymunk.TUNED, variant="tuned, GrooveJoint at the rod's end", slot="groove"),
)
GROOVES = cells(RodEndInSlot(), GROOVE, (1, 10, 100))
LEVER = (
    replace(pymunk.DEFAULT, variant="default, GrooveJoint in the lever", slot="groove"),
    replace(pymunk.TUNED, variant="tuned, GrooveJoint in the lever", slot="groove"),
)
LEVERS = cells(SlottedLever(), LEVER, (1, 10, 100))

LEAVING = tuple(map(Leaving, (1e-2, 1e-4, 1e-6)))


def delay(material: Material) -> dict[str, Any]:
    """`later` [s]: how much later the nearest start leaves than one a hundred times as far aside; `nearer`: log 100."""
    far, near = (material.finished(task) for task in LEAVING[-2:])
    later = near.number("when") - far.number("when") if far and near else UNMEASURED
    return {"later": later, "nearer": math.log(LEAVING[-2].angle / LEAVING[-1].angle)}


def leaving(material: Material) -> list[Observation]:
    """When the truth has left the dead centre by a radian, for starts nearer and nearer to it."""
    settings = [(task, f"{number(task.angle)} rad aside") for task in LEAVING]
    say = "a radian away after {:.3f} s".format
    return read_answers(material, "the reference", settings, lambda answer: say(answer.number("when")))


def out_of_reach(material: Material) -> list[Observation]:
    """The reference's sentences on slots that can't be reached."""
    shape = DrivenSliderCrank().shape
    offsets = (shape.rod - shape.crank, 1.0)
    return refusals({f"offset {offset:.3g} m": partial(replace, shape, offset=offset) for offset in offsets})


FAILURES = described(
    __file__,
    Failure("The rod's end in a groove", cells=GROOVES + cells(RodEndInSlot(), ALL, (1, 10, 100))),
    Failure("A groove in a moving lever", cells=LEVERS + cells(SlottedLever(), (*ALL, *SLOTS), (1, 10, 100))),
    Failure(
        "A slider that has to start the crank, next to its dead centre",
        cells=cells(SliderAtDeadCentre(), (*ALL, Lagrange("rk4", "projection")), (1, 10)),
        tasks=LEAVING,
        context=delay,
        observations=leaving,
    ),
    Failure("A slider in its dead centre", cells=cells(SliderAtDeadCentre(angle=0.0), ALL, (1, 10))),
    Failure("A slot out of reach", observations=out_of_reach),
)


SCENES = (DrivenSliderCrank(), FreeSliderCrank())


def figures(material: Material) -> dict[str, str]:
    """Stroboscopic pictures of the truth: in line, offset, and the other branch."""
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
    """Rows, and the dead centres and stroke of the scene from the formulas."""
    shape = DrivenSliderCrank().shape
    stretched, folded = shape.dead_centres()
    formulas = {"stretched": math.degrees(stretched), "in_line_again": math.degrees(folded), "stroke": shape.stroke()}
    return {**lookups(material, SCENES), **formulas}


PAGE = Page(
    name="slider_crank",
    title="The slider-crank",
    lesson="A slot and three pins: a loop that slides, and a groove that is always right only at a centre of mass.",
    scenes=SCENES,
    advised="free_slider_crank",
    engines=VARIANTS,
    failures=FAILURES,
    figures=figures,
    context=context,
    known=deviations("slider_crank"),
)
