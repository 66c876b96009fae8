"""What other bodies teach: pendulums, a person, a skate, and an ellipse that rolls."""

from __future__ import annotations

import math
from collections.abc import Iterable

from reports.model.convergence import Verdict
from reports.model.measure import Measurement
from reports.model.usual_steps import is_step
from reports.pages.findings.finding import MILLISECOND, Finding
from reports.pages.findings.lookup import Rows, points
from reports.pages.findings.pictures import Line
from reports.write.unmeasured import number


def energy(rows: Rows) -> Finding:
    """The pendulum that slows down."""
    scene, shipped, closed, tree = "pendulum_1", "pymunk default", "pymunk tuned", "mujoco tuned"
    lost, kept, exact = (_at(MILLISECOND, rows.of(scene, method), "energy") for method in (shipped, closed, tree))
    return Finding(
        "energy",
        "A pendulum without friction slows down in pymunk as shipped, and one setting cures most of it",
        f"After {number(rows.seconds(scene))} s at 1 ms the energy is off by {number(100 * lost)} % of the largest "
        f"kinetic energy. With `error_bias = 0` on the pin it is off by {number(100 * kept)} %. In MuJoCo a pendulum "
        f"is a tree, whose hinges are exact: with RK4 the energy is off by {number(100 * exact)} %.",
        "pendulum",
        lost > 10 * kept > 1e3 * exact,
        (
            Line("pymunk as shipped", rows.of(scene, shipped)),
            Line("pymunk, error_bias = 0", rows.of(scene, closed)),
            Line("MuJoCo's tree, RK4", rows.of(scene, tree)),
        ),
        "energy",
    )


def _at(step: float, rows: Iterable[Measurement], quantity: str) -> float:
    """The error at a step [s], of a failed run too; NaN without one."""
    return next((error for other, error in points(rows, quantity) if is_step(other, step)), math.nan)


def person(count: int) -> tuple[str, str, str]:
    """Scene, method and purpose of the person whose joints are swept so often in a step."""
    return "person_one_foot", f"pymunk {count} sweeps, all of the gap", "failure"


def iterations(rows: Rows) -> Finding:
    """Ten iterations and twenty, on a person that falls, with all of each gap closed in a step."""
    coarse, fine = (rows.at(step, *person(10)) for step in (1e-2, MILLISECOND))
    right = rows.at(MILLISECOND, *person(20))
    return Finding(
        "iterations",
        "With too few iterations a smaller step makes pymunk worse",
        "A falling person is a chain of five unequal bodies. With all of each gap closed in every step "
        f"(`error_bias = 0`), pymunk's usual 10 iterations leave an error of {number(coarse.angle)} rad at 10 ms, and "
        f"of {number(fine.angle)} rad at 1 ms. 20 iterations leave {number(right.angle)} rad at 1 ms. Long chains and "
        "unequal masses need more iterations before they need smaller steps.",
        "person",
        fine.angle > 2 * coarse.angle and right.angle < fine.angle / 20,
        tuple(Line(f"{count} iterations", rows.of(*person(count))) for count in (5, 10, 20)),
        "angle",
    )


def forces(rows: Rows) -> Finding:
    """The same motion with 20 and with 100 iterations, but not the same reactions."""
    less, more = (rows.at(MILLISECOND, *person(count)) for count in (20, 100))
    return Finding(
        "forces",
        "The right motion does not mean the right forces",
        "Take the same falling person in pymunk at 1 ms. With 20 and with 100 iterations the motion is the same, "
        f"{number(less.angle)} rad off. But with 20 the joint forces are off by {number(100 * less.reaction)} % of "
        f"the largest, and with 100 by {number(100 * more.reaction)} %. Before you use a force, see whether it "
        "changes with the iterations and with the step.",
        "person",
        abs(less.angle - more.angle) < 0.02 * more.angle and less.reaction > 5 * more.reaction,
        tuple(Line(f"{count} iterations", rows.of(*person(count))) for count in (20, 100)),
        "reaction",
    )


def skate(rows: Rows) -> Finding:
    """The naive skate, which no step improves, and a groove."""
    scene, naive, groove = "sleigh", "pymunk default", "pymunk tuned"
    naively, better = rows.of(scene, naive), rows.at(MILLISECOND, scene, groove)
    least = min((error for _, error in points(naively, "position")), default=math.nan)
    return Finding(
        "skate",
        "A body whose sideways velocity is set to zero is no skate",
        "Neither engine has a skate or an ideal wheel. A common trick sets the sideways velocity of the body's centre "
        "to zero after each step. Where the blade is not below the centre, that is another mechanism: after "
        f"{number(rows.seconds(scene))} s it is off by {number(least)} m or more at every step. A groove of pymunk "
        f"that our code aims anew before each step is {number(better.position)} m off at 1 ms.",
        "skate",
        len(naively) >= 3 and least > 1.0 and better.position < 1e-3 * least,
        (
            Line("centre's velocity zeroed", naively),
            Line("groove, aimed anew each step", rows.of(scene, groove)),
        ),
        "position",
    )


def contact(rows: Rows) -> Finding:
    """An ellipse that rolls: as a polygon, as an ellipsoid, and by two rows."""
    scene, polygon, ellipsoid, written = "rolling_ellipse", "pymunk tuned", "mujoco default", "mujoco extended"
    corners, smooth = rows.sweep(scene, polygon), rows.sweep(scene, ellipsoid)
    exact = rows.at(MILLISECOND, scene, written)
    return Finding(
        "contact",
        "A body that is not round does not roll truly on an engine's contact",
        f"pymunk has no ellipses. However small the step, a rolling ellipse is {number(corners.plateau)} rad off as a "
        f"polygon of 512 corners in pymunk, and {number(smooth.plateau)} rad on MuJoCo's contact as shipped. Our code "
        f"can write two constraint rows into MuJoCo instead of the contact: then it is {number(exact.angle)} rad off "
        "at 1 ms.",
        "rolling",
        corners.verdict is smooth.verdict is Verdict.PLATEAU
        and exact.angle < 1e-6 * min(corners.plateau, smooth.plateau),
        (
            Line("pymunk, 512 corners", rows.of(scene, polygon)),
            Line("MuJoCo's contact as shipped", rows.of(scene, ellipsoid)),
            Line("MuJoCo with two rows of ours", rows.of(scene, written)),
        ),
        "angle",
    )
