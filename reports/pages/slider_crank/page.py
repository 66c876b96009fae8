"""The slider-crank's page: driven and free, and what stands for its slot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from engines.registry import VARIANTS
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reports.model.checks import Deviation
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.slider_crank.experiments import FAILURES
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups

NAME = "slider_crank"
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


def words(material: Material) -> Mapping[str, Any]:
    """Rows, and the dead centres and stroke of the scene from the formulas."""
    shape = DrivenSliderCrank().shape
    stretched, folded = shape.dead_centres()
    formulas = {"stretched": math.degrees(stretched), "in_line_again": math.degrees(folded), "stroke": shape.stroke()}
    return {**lookups(material, SCENES), **formulas}


# Where a method is known to fall short on the slider-crank, each with its reason.
EULER = "by design: a first-order method loses two turns of a free crank at the steps that are run here"
SOFT = "by design: as shipped a loop is a spring of 0.02 s, whatever the step; its softness is the error that stays"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("driven_slider_crank", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("free_slider_crank", "pymunk default", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
    ("free_slider_crank", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
}

PAGE = Page(
    name=NAME,
    title="The slider-crank",
    lesson="A slot and three pins: a loop that slides, and a groove that is always right only at a centre of mass.",
    scenes=SCENES,
    advised="free_slider_crank",
    engines=VARIANTS,
    failures=FAILURES,
    figures=figures,
    words=words,
    known=KNOWN,
)
