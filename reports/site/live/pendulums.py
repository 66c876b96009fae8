"""Pendulums that can be run in the page: scenes, the places of their sliders, and buttons that break them."""

from __future__ import annotations

from dataclasses import replace

from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reports.site.live.sliders import COARSE, Live, Slider, Trap

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
