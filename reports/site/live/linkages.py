"""Linkages that can be run in the page: scenes, the places of their sliders, and buttons that break them."""

from __future__ import annotations

from dataclasses import replace

from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reports.site.live.sliders import COARSE, ONE_SWEEP, Live, Slider, Trap

RATIOS = (0.01, 0.1, 1.0, 10.0, 100.0)
DENSITIES = tuple(1.0 if ratio == 1 else (1.0, ratio, 1.0) for ratio in RATIOS)
DENSITY = Slider("density", "the coupler's density to that of the others", DENSITIES, tuple(map("{:g}".format, RATIOS)))
COUPLER = FreeFourBar().coupler
CHAPTER = f"{COUPLER:.3f}, the chapter's"
COUPLERS = (0.53, COUPLER, 0.65, 0.75, 0.9)  # m: every crank can turn fully with every one of them
REVOLUTION = (15, 30, 60, 120, 300, 600, 1200)
HUNDRED = (25, 50, 100, 200, 500, 1000, 2000)

FOUR_BAR = (
    Live(
        "driven",
        DrivenFourBar(),
        REVOLUTION,
        60,
        3,
        (
            Slider("crank", "crank [m]", (0.2, 0.3, 0.4, 0.42, 0.45)),
            Slider("coupler", "coupler [m]", COUPLERS, ("0.53", CHAPTER, "0.65", "0.75", "0.9")),
            DENSITY,
        ),
        tempo=True,
        traps=(
            COARSE,
            Trap(
                "Break it: heavy on light",
                {"density": 4, "iterations": 1, "bias": 3},
                "The coupler is a hundred times as dense as the other bars. The motion is driven, so nothing should "
                "change. Two sweeps over the joints leave much of the impulse undone.",
            ),
            ONE_SWEEP,
        ),
        traces=(("coupler", (0.0, 0.0)),),
    ),
    Live(
        "let go",
        FreeFourBar(),
        HUNDRED,
        50,
        3,
        (
            Slider("crank", "crank [m]", (0.3, 0.4, 0.45)),
            Slider("coupler", "coupler [m]", (COUPLER, 0.65, 0.75), (CHAPTER, "0.65", "0.75")),
            replace(DENSITY, values=DENSITIES[::2], texts=("0.01", "1", "100")),
        ),
        traps=(COARSE, ONE_SWEEP),
        traces=(("coupler", (0.0, 0.0)),),
    ),
)

ROD = (("rod", (0.0, 0.0)),)
SLIDER_CRANK = (
    Live(
        "driven",
        DrivenSliderCrank(),
        REVOLUTION,
        60,
        3,
        (
            Slider("crank", "crank [m]", (0.15, 0.3, 0.45, 0.6)),
            Slider("rod", "rod [m]", (0.8, 1.0, 1.4)),
            Slider("slider_mass", "mass of the slider [kg]", (0.05, 0.5, 5.0, 50.0)),
        ),
        tempo=True,
        traps=(
            COARSE,
            Trap(
                "Break it: heavy on light",
                {"slider_mass": 3, "iterations": 1, "bias": 3},
                "The slider is as heavy as fifty rods. The motion is driven, so nothing should change. Two sweeps over "
                "the joints leave much of the impulse undone.",
            ),
            ONE_SWEEP,
        ),
        traces=ROD,
    ),
    Live(
        "let go",
        FreeSliderCrank(),
        (50, 100, 200, 400, 1000, 2000, 4000),
        50,
        3,
        (
            Slider("crank", "crank [m]", (0.15, 0.3, 0.45, 0.6)),
            Slider("slider_mass", "mass of the slider [kg]", (0.05, 0.5, 5.0)),
        ),
        traps=(COARSE, ONE_SWEEP),
        traces=ROD,
    ),
)
