"""What can be run in the page: scenes, the places of their sliders, and buttons that break them."""

from __future__ import annotations

from dataclasses import replace

from engines import mujoco, pymunk
from engines.pymunk.joints.roll import Contact
from engines.pymunk.methods import SKATE_GROOVE
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingDisc, RollingEllipse
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
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


TIP = ((0.5, 0.0), (-0.5, 0.0))
HEAVY_TIP = Trap(
    "Break it: heavy on light",
    {"tip": 3, "iterations": 1, "bias": 3},
    "The last link is a hundred times as heavy as the one above. It should swing nearly as if alone; two sweeps over "
    "the joints do not hold it.",
)
SWEPT = Trap(
    "Break it: one sweep",
    {"iterations": 0, "bias": 3, "steps": 6},
    "One sweep over the joints of a chain carries an impulse from one joint to the next only.",
)
PENDULUM = (
    Live(
        "one link",
        BarPendulum(duration=4.0),
        (50, 100, 200, 400, 1000, 2000, 4000),
        100,
        3,
        (Slider("angle", "start angle [rad]", (0.5, 1.0, 2.0, 3.0)), Slider("length", "length [m]", (0.5, 1.0, 2.0))),
        traps=(COARSE,),
        ends={"link 1": TIP},
    ),
    Live(
        "two links",
        LinkPendulum(),
        (25, 125, 250, 500, 1250, 2500, 5000),
        125,
        3,
        (
            Slider("tip", "mass of the last link to the other's", (0.1, 1.0, 10.0, 100.0)),
            Slider("angle", "start angle [rad]", (0.5, 1.0, LinkPendulum().angle)),
        ),
        traps=(COARSE, HEAVY_TIP, SWEPT),
        ends={"link 2": TIP},
        traces=(("link 2", (0.5, 0.0)),),
    ),
    Live(
        "ten links",
        TenLinks(),
        (75, 150, 300, 600, 1500, 3000),
        75,
        2,
        traps=(COARSE, replace(SWEPT, places={**SWEPT.places, "steps": 5})),
        ends={"link 10": TIP},
    ),
)


CORNERS = tuple(
    (f"a polygon of {corners} corners", replace(pymunk.DEFAULT, contact=Contact(vertices=corners)))
    for corners in (64, 8, 16, 128)
)
ROLLER = (("roller", (0.0, 0.0)),)
START_RATE = Slider("start_rate", "turning rate at the start [rad/s]", (2.0, 3.0, 4.0, 5.0))
ROLLING = (
    Live(
        "an ellipse",
        RollingEllipse(),
        (20, 50, 100, 200, 500, 1000, 2000),
        100,
        3,
        (Slider("along_y", "short half axis [m]", (0.2, 0.3, 0.4, 0.5)), START_RATE),
        munk=CORNERS,
        traps=(
            COARSE,
            Trap(
                "Break it: the polygon wheel",
                {"munk": 1, "steps": 6},
                "Eight corners for an ellipse. The polygon falls from corner to corner and loses energy each time; a "
                "smaller step computes this other body better.",
            ),
        ),
        traces=ROLLER,
    ),
    Live(
        "a disc",
        RollingDisc(),
        (20, 50, 100, 200, 500, 1000, 2000),
        100,
        3,
        (Slider("eccentricity", "centre of mass beside the middle [m]", (0.05, 0.15, 0.25)), START_RATE),
        traps=(COARSE,),
        traces=ROLLER,
    ),
    Live(
        "a cam",
        RollingCam(),
        (20, 50, 100, 200, 500, 1000, 2000),
        100,
        3,
        (START_RATE,),
        munk=CORNERS,
        traps=(COARSE,),
        traces=ROLLER,
    ),
)

GEARS = (
    Live(
        "two gears",
        EllipticGears(),
        (50, 100, 200, 400, 1000, 2000),
        100,
        2,
        (Slider("eccentricity", "eccentricity [1]", (0.0, 0.2, 0.5, 0.7)),),
        tempo=True,
        munk=CORNERS,
        traps=(COARSE, replace(ROLLING[0].traps[1], words="Break it: gears of eight corners", places={"munk": 1})),
    ),
)


SLEIGH = ChaplyginSleigh()
NAIVE = (
    ("the centre's sideways velocity set to zero", pymunk.DEFAULT),
    ("a groove under the blade, aimed in each step", SKATE_GROOVE),
)
TOUCHING = (("a capsule that touches the ground, with friction across", mujoco.DEFAULT),)
SKATE = (
    Live(
        "the sleigh",
        SLEIGH,
        (25, 75, 150, 300, 750, 1500, 3000),
        75,
        3,
        (
            Slider("offset", "centre of mass ahead of the blade [m]", (-0.3, 0.1, 0.3, 0.5, 0.8)),
            Slider("turning_rate", "turning rate at the start [rad/s]", (0.5, 1.0, 2.0, 4.0)),
        ),
        munk=NAIVE,
        mujoco=TOUCHING,
        traps=(
            COARSE,
            Trap(
                "Break it: the naive skate",
                {"munk": 0, "steps": 6, "offset": 4},
                "The blade is far from the centre, whose sideways velocity is set to zero. What is set to zero stays "
                "zero, and the motion is another body's, at every step. Move “how pymunk holds the blade” to the "
                "groove: the error falls with the step.",
            ),
        ),
        traces=((SLEIGH.mechanism().bodies[0].name, (0.0, 0.0)),),
    ),
)

CAR = CarAndTrailer()
WHEELS = (
    Live(
        "forwards",
        CAR,
        (25, 125, 250, 500, 1250, 2500, 5000),
        125,
        3,
        (
            Slider("steering", "steering [rad]", (0.0, 0.2, 0.4, 0.6)),
            Slider("bend", "bend of the trailer at the start [rad]", (0.3, 0.8, 1.2)),
        ),
        munk=(NAIVE[0],),
        mujoco=TOUCHING,
        traps=(COARSE,),
        traces=tuple((body.name, (0.0, 0.0)) for body in CAR.mechanism().bodies),
    ),
    Live(
        "backwards",
        CarAndTrailer(steering=0.0, hitch=0.0, speed=-1.0, bend=0.05),
        (25, 125, 250, 500, 1250, 2500, 5000),
        125,
        3,
        (Slider("bend", "bend of the trailer at the start [rad]", (0.0125, 0.025, 0.05, 0.1, 0.2)),),
        munk=(NAIVE[0],),
        mujoco=TOUCHING,
        traps=(COARSE,),
        traces=tuple((body.name, (0.0, 0.0)) for body in CAR.mechanism().bodies),
    ),
)
