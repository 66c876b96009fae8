"""Lessons on skates: the sleigh, and a car with its trailer."""

from __future__ import annotations

from engines import mujoco, pymunk
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reports.site.lesson import Lesson, Step, Take
from reports.site.live import scenes

CENTRE = (("body", (0.0, 0.0)),)
SLEIGH = ChaplyginSleigh()
BODY = SLEIGH.mechanism().bodies[0].name
TRACE = ((BODY, (0.0, 0.0)),)
NAIVE = ("the centre's velocity set to zero", pymunk.DEFAULT)
SHIPPED = ("MuJoCo, a capsule with friction", mujoco.DEFAULT)
GROOVE = ("pymunk, a groove at the blade", pymunk.TUNED)
TENDON = ("MuJoCo, a tendon at the blade", mujoco.TUNED)

SKATE = Lesson(
    "skate",
    "The skate",
    "skate",
    {
        "naive": Take(SLEIGH, ((*NAIVE, 1),), traces=TRACE, centre=BODY),
        "friction": Take(SLEIGH, ((*SHIPPED, 1),), traces=TRACE, centre=BODY),
        "rows": Take(SLEIGH, ((*GROOVE, 1), (*TENDON, 1)), traces=TRACE, centre=BODY),
        "backwards": Take(SleighBackwards(), ((*NAIVE, 1), (*GROOVE, 1), (*TENDON, 1)), traces=TRACE),
    },
    (
        Step("rows", frozenset({"paths"}), ("skate", "What the row takes, and what it leaves")),
        Step("rows", frozenset({"reactions", "centre"})),
        Step("friction", frozenset({"paths"})),
        Step("rows", frozenset({"paths"}), ("skate", "How do I put an ideal skate into pymunk?")),
        Step(
            "naive",
            frozenset({"paths"}),
            ("skate", "Where methods fail"),
            (
                (
                    "The naive skate",
                    "naive",
                    "After each step the sideways velocity of the centre is set to zero. The blade is not at the "
                    "centre, so this is another body's motion. What is set to zero stays zero, and proves nothing.",
                ),
                (
                    "Run backwards",
                    "backwards",
                    "With the centre of mass behind the blade the smallest turning grows, until the sleigh has turned "
                    "round. A method that hides this instability is wrong.",
                ),
            ),
        ),
    ),
    live=scenes.SKATE,
)

CAR = CarAndTrailer()
PARTS = tuple((body.name, (0.0, 0.0)) for body in CAR.mechanism().bodies)
REVERSING = CarAndTrailer(steering=0.0, hitch=0.0, speed=-1.0, bend=0.05)
WHEELS = Lesson(
    "wheels",
    "A car and its trailer",
    "wheels",
    {
        "naive": Take(CAR, (("sideways velocity set to zero", pymunk.DEFAULT, 1),), traces=PARTS),
        "friction": Take(CAR, ((*SHIPPED, 1),), traces=PARTS),
        "rows": Take(CAR, ((*GROOVE, 1), (*TENDON, 1)), traces=PARTS, centre=PARTS[0][0]),
        "reversing": Take(REVERSING, ((*GROOVE, 1), (*TENDON, 1)), traces=PARTS),
    },
    (
        Step("rows", frozenset({"paths"}), ("wheels", "How a vehicle can still move")),
        Step("rows", frozenset({"centre"})),
        Step("rows", frozenset({"reactions"})),
        Step("friction", frozenset({"paths"}), ("wheels", "Errors and costs")),
        Step(
            "naive",
            frozenset({"paths"}),
            ("wheels", "Where methods fail"),
            (
                (
                    "The naive wheel",
                    "naive",
                    "The centre of the car is not above an axle. Without its sideways velocity, it moves as another "
                    "car would.",
                ),
                (
                    "Reverse with the trailer",
                    "reversing",
                    "A trailer that is pushed folds: a small angle grows until it jack-knifes. The reference shows "
                    "when.",
                ),
            ),
        ),
    ),
    live=scenes.WHEELS,
)
