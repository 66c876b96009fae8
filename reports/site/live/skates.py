"""Skates and wheels that can be run in the page: scenes, the places of their sliders, and buttons that break them."""

from __future__ import annotations

from dataclasses import replace

from engines import mujoco, pymunk
from engines.pymunk.methods import SKATE_GROOVE
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reports.site.live.sliders import COARSE, Live, Slider, Trap

SLEIGH = ChaplyginSleigh()
NAIVE = (
    ("the centre's sideways velocity set to zero", pymunk.DEFAULT),
    ("a groove under the blade, aimed in each step", SKATE_GROOVE),
)
TOUCHING = (
    ("a capsule that touches the ground, with friction across", mujoco.DEFAULT),
    ("a thin wheel that touches the ground", replace(mujoco.DEFAULT, skates="wheel")),
)
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
        mujoco=(TOUCHING[0],),
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
        mujoco=(TOUCHING[0],),
        traps=(COARSE,),
        traces=tuple((body.name, (0.0, 0.0)) for body in CAR.mechanism().bodies),
    ),
)
