"""Lessons on an ellipse, a disc and a cam that roll on the ground, and on two elliptic gears."""

from __future__ import annotations

import math
from dataclasses import replace

from engines import pymunk
from engines.pymunk.joints.roll import ContactSettings
from engines.pymunk.methods import ROLL_FACETED
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingDisc, RollingEllipse
from reports.site.lesson import BOTH, CENTRE, FORCES, Claim, Experiment, Guess, Lesson, LessonQuantity
from reports.site.lessons.linkages import CENTRODES, ENERGY
from reports.site.live.sliders import DOCUMENTED, SHIPPED, Live, Slider

ROLLER = (("roller", (0.0, 0.0)),)
HUNDRED = (20, 50, 100, 200, 500, 1000, 2000)
START_RATE = Slider("start_rate", "turning rate at the start [rad/s]", (2.0, 3.0, 4.0, 5.0))
FEW, MANY = "a polygon of 8 corners", "a polygon of 512 corners"
CORNERS = (
    (SHIPPED, pymunk.DEFAULT),
    (DOCUMENTED, pymunk.TUNED),
    (FEW, replace(pymunk.DEFAULT, contact=ContactSettings(vertices=8))),
    (MANY, ROLL_FACETED[-1]),
)

ROLLING = Lesson(
    "rolling",
    "Rolling: the ellipse and the cam",
    "rolling",
    (
        Live(
            "an ellipse",
            RollingEllipse(),
            HUNDRED,
            100,
            3,
            (Slider("along_y", "short half axis [m]", (0.2, 0.3, 0.4, 0.5)), START_RATE),
            munk=CORNERS,
            traces=ROLLER,
            centre="roller",
        ),
        Live(
            "a disc",
            RollingDisc(),
            HUNDRED,
            100,
            3,
            (Slider("eccentricity", "centre of mass beside the middle [m]", (0.05, 0.15, 0.25)), START_RATE),
            traces=ROLLER,
            centre="roller",
        ),
        Live("a cam", RollingCam(), HUNDRED, 100, 3, (START_RATE,), munk=CORNERS, traces=ROLLER, centre="roller"),
    ),
    (
        Experiment("a cam", overlays=CENTRE, section="The contact"),
        Experiment(
            "an ellipse",
            after={"along_y": 0.2},
            claims=(Claim("exact", 1.7, 2.0, "friction"), Claim("exact", 0.5, 0.6, "friction", is_value=True)),
            causes=(({"along_y": 0.3, "start_rate": 5.0}, Claim("exact", 0.2, 0.27, "friction", is_value=True)),),
            overlays=("friction",),
            section="Friction demanded, friction given",
            guesses=tuple(Guess(times={"exact": times}, of="friction") for times in (0.5, 1.0, 1.8)),
            quantities=(LessonQuantity("friction", "rolling requires a coefficient of"),),
        ),
        Experiment(
            "an ellipse",
            after={"steps": 2000},
            claims=(
                Claim("munk", 0.7, 1.3),
                Claim("mujoco", 0.7, 2.0),
                Claim("munk", -math.inf, -0.1, "energy", is_value=True),
            ),
            causes=(({"munk": MANY}, Claim("munk", most=0.25)), ({"munk": MANY}, Claim("munk", 0, 0.25, "energy"))),
            section="Errors that no smaller step removes",
            guesses=tuple(Guess(times={"munk": times, "mujoco": times}) for times in (0.1, 1.0, 1e-3)),
            quantities=(ENERGY,),
        ),
        Experiment(
            "a disc",
            after={"steps": 2000},
            claims=(Claim("munk", 0.05, 0.15),),
            section="Roulettes",
            guesses=tuple(Guess(times={"munk": times}) for times in (1.0, 0.1, 10.0)),
        ),
        Experiment(
            "an ellipse",
            {"munk": MANY, "steps": 2000},
            {"munk": FEW},
            (Claim("munk", least=10), Claim("munk", least=10, of="energy")),
            section="Where methods fail",
            guesses=tuple(Guess(times={"munk": times}) for times in (1.0, 2.0, 11.0)),
            quantities=(ENERGY,),
        ),
    ),
)

GEARS = Lesson(
    "gears",
    "Elliptic gears",
    "rolling",
    (
        Live(
            "two gears",
            EllipticGears(),
            (50, 100, 200, 400, 1000, 2000),
            100,
            5,
            (Slider("eccentricity", "eccentricity [1]", (0.0, 0.2, 0.5, 0.7)),),
            munk=CORNERS,
            centre="second",
        ),
    ),
    (
        Experiment(
            "two gears",
            after={"eccentricity": 0.7},
            claims=(
                Claim("exact", 1.3, 3.0, "rates"),
                Claim("exact", most=1e-5, of="contact", is_value=True),
                Claim("munk", most=1.0),
            ),
            overlays=FORCES,
            section="Elliptic gears",
            guesses=(Guess(times={"exact": 0.0}, of="rates"), Guess(), Guess()),
            quantities=(
                LessonQuantity("rates", "the second gear turns at", ("second",)),
                LessonQuantity("contact", "the sum of the distances changes by"),
            ),
        ),
        Experiment(
            "two gears",
            after=BOTH,
            claims=(Claim("munk", most=0.1), Claim("mujoco", most=0.1)),
            causes=(({"steps": 400}, Claim("munk", least=100)),),
            overlays=FORCES,
            guesses=(
                Guess(),
                Guess(times={"munk": 1.0, "mujoco": 1.0}),
                Guess(times={"munk": 1.0}),
            ),
        ),
        Experiment(
            "two gears",
            BOTH,
            {"munk": FEW},
            (Claim("munk", least=10), Claim("munk", least=0.1, of="rates", is_value=True)),
            overlays=FORCES,
            section="The contact",
            guesses=(Guess(times={"munk": 0.0}, of="rates"), Guess(), Guess(times={"munk": 1.0})),
            quantities=(LessonQuantity("rates", "the second gear turns at", ("second",)),),
        ),
    ),
)

CAM = Lesson(
    "cam",
    "A cam by rolling",
    "centrodes",
    (CENTRODES.scene("rolling"), ROLLING.scene("a cam")),
    (
        Experiment("rolling", overlays=CENTRE, section="The coupler of the four-bar"),
        Experiment("rolling", overlays=CENTRE),
        Experiment("rolling", overlays=CENTRE, widget="cam"),
        Experiment(
            "a cam",
            {"munk": MANY, "steps": 2000},
            {"munk": FEW},
            (Claim("munk", least=10), Claim("munk", least=10, of="energy")),
            overlays=CENTRE,
            guesses=(Guess(times={"munk": 1.0}), Guess(times={"munk": 2.0}), Guess()),
            quantities=(ENERGY,),
        ),
    ),
)
