"""Lessons on the Chaplygin sleigh, and on a car with a trailer."""

from __future__ import annotations

from engines import pymunk
from engines.pymunk.methods import SKATE_CENTRE, SKATE_PROJECTED
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.wheels.vehicles import CarAndTrailer
from reports.site.lesson import BOTH, CENTRE, FORCES, Claim, Experiment, Guess, Lesson, LessonQuantity
from reports.site.live.sliders import DOCUMENTED, SHIPPED, Live, Slider

NAIVE, PROJECTED = "naive: the centre's sideways velocity set to zero", "our code: an impulse at the blade"
MUNK = (
    (SHIPPED, "pymunk as shipped has no joint for a skate"),
    (DOCUMENTED, pymunk.TUNED),
    (NAIVE, SKATE_CENTRE),
    (PROJECTED, SKATE_PROJECTED),
)
SLEIGH = ChaplyginSleigh()

SKATE = Lesson(
    "skate",
    "The skate",
    "skate",
    (
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
            munk=MUNK,
            centre=SLEIGH.mechanism().bodies[0].name,
        ),
    ),
    (
        Experiment("the sleigh", BOTH, overlays=FORCES + CENTRE, section="Degrees of freedom"),
        Experiment(
            "the sleigh",
            after={"steps": 3000},
            claims=(Claim("mujoco", 1.5, 2.5),),
            guesses=(Guess(times={"mujoco": 0.1}), Guess(times={"mujoco": 0.01}), Guess(times={"mujoco": 2.0})),
        ),
        Experiment(
            "the sleigh",
            BOTH,
            {"munk": NAIVE},
            (Claim("munk", least=100),),
            (({"steps": 3000}, Claim("munk", 0.9, 1.1)), ({"munk": PROJECTED}, Claim("munk", most=0.01))),
            guesses=(
                Guess(times={"munk": 1.0}),
                Guess({"munk": NAIVE, "steps": 3000}, claims=(Claim("munk", least=100),)),
                Guess(),
            ),
            section="Where methods fail",
        ),
        Experiment(
            "the sleigh",
            BOTH,
            {"steps": 3000},
            (Claim("munk", 0.05, 0.2),),
            guesses=(Guess(times={"munk": 1.0}), Guess(times={"munk": 0.1}), Guess(times={"munk": 0.01})),
            section="How do I put an ideal skate into pymunk?",
        ),
        Experiment("the sleigh", BOTH, overlays=FORCES, section="The only one, and no factor of 2", widget="errata"),
    ),
)

PARKING = Lesson(
    "parking",
    "Parallel parking",
    "skate",
    SKATE.scenes,
    (
        Experiment("the sleigh", BOTH, section="Degrees of freedom"),
        Experiment("the sleigh", BOTH, section="The only one, and no factor of 2"),
        Experiment("the sleigh", BOTH, widget="parking"),
        Experiment(
            "the sleigh",
            BOTH,
            {"munk": NAIVE},
            (Claim("munk", least=100),),
            guesses=(
                Guess(times={"munk": 1.0}),
                Guess({"munk": NAIVE, "steps": 3000}, claims=(Claim("munk", least=100),)),
                Guess(),
            ),
        ),
    ),
)

CAR = CarAndTrailer()
REVERSING = CarAndTrailer(steering=0.0, hitch=0.0, speed=-1.0, bend=0.05)
STEPS = (25, 125, 250, 500, 1250, 2500, 5000)
PARTS = tuple(body.name for body in CAR.mechanism().bodies)
WHEELS = Lesson(
    "wheels",
    "A car and its trailer",
    "wheels",
    (
        Live(
            "forwards",
            CAR,
            STEPS,
            125,
            3,
            (
                Slider("steering", "steering [rad]", (0.0, 0.2, 0.4, 0.6)),
                Slider("bend", "bend of the trailer at the start [rad]", (0.3, 0.8, 1.2)),
            ),
            munk=MUNK,
            centre=PARTS[0],
            axle=CAR.track / 2,
        ),
        Live(
            "backwards",
            REVERSING,
            STEPS,
            125,
            3,
            (Slider("bend", "bend of the trailer at the start [rad]", (0.0125, 0.025, 0.05, 0.1, 0.2)),),
            munk=MUNK,
            axle=CAR.track / 2,
        ),
    ),
    (
        Experiment("forwards", BOTH, overlays=FORCES + CENTRE, section="How a vehicle can still move"),
        Experiment(
            "forwards",
            after={"steps": 5000},
            claims=(Claim("mujoco", 1.0, 2.0),),
            guesses=(Guess(times={"mujoco": 0.1}), Guess(times={"mujoco": 1.4}), Guess(times={"mujoco": 1e-4})),
        ),
        Experiment(
            "forwards",
            BOTH,
            {"munk": NAIVE},
            (Claim("munk", least=10),),
            (({"steps": 5000}, Claim("munk", 0.8, 1.3)), ({"munk": PROJECTED}, Claim("munk", most=0.01))),
            guesses=(
                Guess(times={"munk": 1.0}),
                Guess(),
                Guess({"munk": NAIVE, "steering": 0.2}, claims=(Claim("munk", least=100),)),
            ),
            section="Where methods fail",
        ),
        Experiment(
            "backwards",
            {**BOTH, "bend": 0.05},
            {"bend": 0.2},
            (
                Claim("exact", 0.52, 0.57, "bend"),
                Claim("exact", 1.30, 1.34, "bend", is_value=True),
                Claim("munk", 1.27, 1.37, "bend", is_value=True),
            ),
            guesses=tuple(Guess(times=dict.fromkeys(("exact", "munk"), by), of="bend") for by in (0.25, 0.55, 1.0)),
            quantities=(LessonQuantity("bend", "the bend is 1 rad after", PARTS),),
        ),
    ),
)
