"""Rolling bodies and gears that can be run in the page: scenes, their sliders, and buttons that break them."""

from __future__ import annotations

from dataclasses import replace

from engines import pymunk
from engines.pymunk.joints.roll import Contact
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingDisc, RollingEllipse
from reports.site.live.sliders import COARSE, Live, Slider, Trap

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
