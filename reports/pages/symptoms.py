"""What users see go wrong, in their words, and the section that answers."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Symptom:
    """`seen` as a user would say it, a short `answer`, and the page that has the rest, under `heading` if not empty."""

    seen: str
    answer: str
    page: str
    heading: str


SYMPTOMS: tuple[Symptom, ...] = (
    Symptom(
        "My closed loop opens, or is off at every step (MuJoCo).",
        "A loop's pin is a spring. Make it stiffer with `solref` and `solimp`; a smaller step does not help.",
        "four_bar",
        "Why the engine's pin is not the ideal one",
    ),
    Symptom(
        "My joints drift apart, or give like rubber (pymunk).",
        "Set `error_bias = 0` on each constraint, and more iterations.",
        "four_bar",
        "Why the engine's pin is not the ideal one",
    ),
    Symptom(
        "A smaller step makes it worse.",
        "Either two errors cancelled at the larger one, or there are too few iterations.",
        "four_bar",
        "Worse as the step shrinks",
    ),
    Symptom(
        "How many iterations do I need?",
        "That depends on the masses as well as on the number of bodies.",
        "person",
        "A heavy trunk on light shanks, with too few sweeps",
    ),
    Symptom(
        "My frictionless pendulum slows down (pymunk).",
        "A smaller step helps in proportion, `error_bias = 0` at once.",
        "pendulum",
        "",
    ),
    Symptom(
        "A heavy body on a light chain: the chain stretches.",
        "A map of mass ratios and steps says what still works.",
        "atlas",
        "A pendulum of three links with a heavy tip",
    ),
    Symptom(
        "How do I drive a crank at a given speed?",
        "As a kinematic body, or with a large armature; neither by a servo nor by overwriting its angle.",
        "four_bar",
        "Five ways to drive a crank",
    ),
    Symptom(
        "I need a skate, a blade or a wheel that can't slip sideways (pymunk).",
        "There is none; five constructions, with code and errors.",
        "skate",
        "How do I put an ideal skate into pymunk?",
    ),
    Symptom(
        "I need a constraint on velocities (MuJoCo).",
        "There is none; tendons and rows that come near, with code and errors.",
        "skate",
        "How do I put an ideal skate into MuJoCo?",
    ),
    Symptom(
        "My wheel or blade creeps down a slope.",
        "MuJoCo's friction always creeps; how fast depends on its regularisation.",
        "skate",
        "At rest across a slope",
    ),
    Symptom(
        "There is no slip, but the path is wrong.",
        "Slip alone proves nothing: a naive skate has none.",
        "skate",
        "No slip at all, and a wholly wrong motion",
    ),
    Symptom(
        "My car or cart drives, but not where it should.",
        "Two wheels of one axle, trailers and casters, each against the exact motion.",
        "wheels",
        "How a vehicle can still move",
    ),
    Symptom(
        "My groove joint comes apart (pymunk).",
        "A `GrooveJoint` is right only at a centre of mass, or where the grooved body can't turn.",
        "slider_crank",
        "The rod's end in a groove",
    ),
    Symptom(
        "My linkage flips into the other assembly.",
        "Where all bars lie in line the motion has two ways to go on.",
        "n_four_bar",
        "Through the singular position, as shipped",
    ),
    Symptom(
        "Gears, cams or ellipses roll wrongly.",
        "An engine's contact leaves out the motion of the contact itself; polygons roll over corners.",
        "rolling",
        "Polygons",
    ),
    Symptom(
        "The joint forces look wrong.",
        "They may be, although the motion is right; compare two steps and two numbers of iterations.",
        "person",
        "Reactions",
    ),
    Symptom(
        "My chain of hundreds of bodies is too slow.",
        "Trees of coordinates cost more than free bodies beyond a hundred links or so.",
        "scaling",
        "Cost of a step",
    ),
)
