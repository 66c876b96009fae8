"""Lessons on rolling: an ellipse and a cam on the ground, and two elliptic gears."""

from __future__ import annotations

from engines import mujoco, pymunk
from engines.pymunk.methods import ROLL_FACETED, ROLL_PIVOT
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingCam, RollingDisc, RollingEllipse
from reports.site.lesson import Lesson, Step, Take
from reports.site.live import scenes

CENTRE = (("roller", (0.0, 0.0)),)
SHIPPED = (("pymunk, a polygon of 64 corners", pymunk.DEFAULT, 1), ("MuJoCo, contact as shipped", mujoco.DEFAULT, 1))
ROWS = (("pymunk, a pin moved to the contact", ROLL_PIVOT, 1), ("MuJoCo, rows written by us", mujoco.EXTENDED, 1))
CORNERS = tuple((engine.variant.removeprefix("roll: contact, "), engine, 10) for engine in ROLL_FACETED[:2])

ROLLING = Lesson(
    "rolling",
    "Rolling: the ellipse and the cam",
    "rolling",
    {
        "ellipse": Take(RollingEllipse(), SHIPPED, traces=CENTRE, centre="roller"),
        "cam": Take(RollingCam(), SHIPPED, traces=CENTRE, centre="roller"),
        "rows": Take(RollingEllipse(), ROWS, traces=CENTRE, centre="roller"),
        "polygon": Take(RollingEllipse(), CORNERS, traces=CENTRE),
        "large": Take(RollingDisc(), SHIPPED, samples=20, traces=CENTRE),
    },
    (
        Step("ellipse", frozenset({"paths"}), ("rolling", "Roulettes")),
        Step("cam", frozenset({"paths", "centre"}), ("rolling", "The contact")),
        Step("ellipse", frozenset({"reactions"}), ("rolling", "Friction demanded, friction given")),
        Step("rows", frozenset({"paths"}), ("rolling", "Errors that no step removes")),
        Step(
            "polygon",
            frozenset({"paths"}),
            ("rolling", "Where methods fail"),
            (
                (
                    "The polygon wheel",
                    "polygon",
                    "An ellipse has no corners. A polygon falls from corner to corner and loses energy each time: the "
                    "engine computes another body, and a smaller step computes that body better.",
                ),
                (
                    "Steps of a tenth of a second",
                    "large",
                    "The disc stays on the ground and rolls on. Steps this large are wrong, and a warning would help.",
                ),
            ),
        ),
    ),
    live=scenes.ROLLING,
)

GEARS = Lesson(
    "gears",
    "Elliptic gears",
    "rolling",
    {
        "mesh": Take(EllipticGears(), ROWS, centre="second"),
        "round": Take(EllipticGears(eccentricity=0.2), ROWS, centre="second"),
        "long": Take(EllipticGears(eccentricity=0.7), ROWS, centre="second"),
    },
    (
        Step("mesh", frozenset(), ("rolling", "Elliptic gears")),
        Step("round", frozenset()),
        Step("mesh", frozenset({"centre"})),
        Step("mesh", frozenset({"gaps"}), ("rolling", "The contact")),
        Step(
            "long",
            frozenset(),
            None,
            (
                (
                    "A longer ellipse",
                    "long",
                    "With an eccentricity of 0.7 the second gear turns from 0.18 to 5.7 times as fast as the first. "
                    "The gears still roll on each other at every instant.",
                ),
            ),
        ),
    ),
    live=scenes.GEARS,
)
