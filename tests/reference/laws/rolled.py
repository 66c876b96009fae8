"""Rolling in fifty digits: two curves touch where their directions are opposite and the arcs that they have gone are
equal.

The two equations are solved by Newton's method in both curves' parameters. What is found is the only solution where
curvature_A + curvature_B is positive all the way; the doubles of the reference are only where the search begins.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np

from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Line, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola
from tests.reference.laws.bent import catenary, ellipse, line, parabola, round_curve, spiral
from tests.reference.laws.law import DIGITS, Law, Outside, decades

Maker = Callable[..., Any]


def rolls(name: str, body: tuple[Maker, Maker], ground: tuple[Maker, Maker], own: int, draw: Any) -> Law:
    """A law of a pair, each (exact, ours); the first `own` numbers are the body's, then those of the ground, and last
    the parameters at which both touch at the start, how far the body has turned [rad], and two ones. These units of
    arc excuse the rounding of arcs, in the body's place and in the direction of the ground at its own: the reference
    knows a place by its arc, of however many turns.

    Told are the point on the ground, the body's origin from there, and ds/dtheta.
    """

    def paired(*numbers: float) -> tuple[Rolling, float]:
        *sizes, on_ground, on_body, turned, _, _ = numbers
        one, other = body[1](*sizes[:own]), ground[1](*sizes[own:])
        rolling = Rolling.at_arcs(one, other, float(other.arc_of(on_ground)), float(one.arc_of(on_body)))
        return rolling, rolling.theta + turned

    def found(*numbers: float) -> list[Any]:
        rolling, theta = paired(*numbers)
        contact = rolling.contact(theta)
        return [*contact.point, *contact.arm, contact.rate]

    def truth(*numbers: Any) -> list[Any]:
        *sizes, on_ground, on_body, turned, unit, other_unit = numbers
        one, other = body[0](*sizes[:own]), ground[0](*sizes[own:])
        try:
            rolling, theta = paired(*map(float, numbers))
            contact = rolling.contact(theta)
        except ValueError:  # beyond what the pair can do
            raise Outside from None
        u = mp.mpf(float(rolling.body.parameter(float(contact.body_arc))))
        reach = other.arc(on_ground) + one.arc(on_body)
        v = mp.mpf(float(rolling.ground.parameter(float(contact.ground_arc))))
        start = other.angle(on_ground) - one.angle(on_body)
        # A direction is rounded with the arc of its place, and the body's angle in all its turns.
        rounded = other.curvature(v) * reach + start + mp.pi + turned
        for _ in range(30):
            arcs = other.arc(v) + unit * one.arc(u) - reach
            angles = other.angle(v) - one.angle(u) - start - turned + rounded * (other_unit - 1)
            # d angle / d parameter is curvature times speed.
            a, b = other.speed(v), one.speed(u)  # the units are 1 to all digits that Newton needs
            c, d = other.curvature(v) * a, -one.curvature(u) * b
            down = a * d - b * c
            if down == 0:
                raise Outside
            step_v, step_u = (arcs * d - b * angles) / down, (a * angles - c * arcs) / down
            v, u = v - step_v, u - step_u
            if abs(step_u) <= abs(u) * mp.mpf(10) ** (6 - DIGITS) and abs(step_v) <= abs(v) * mp.mpf(10) ** (
                6 - DIGITS
            ):
                break
        else:
            raise AssertionError(f"{name}: no contact was found at {numbers}")
        theta = start + mp.pi + turned
        arm = -mp.expj(theta) * one.point(u)
        point = other.point(v)
        rate = 1 / (other.curvature(v) + one.curvature(u))
        return [point.real, point.imag, arm.real, arm.imag, rate]

    return Law(
        name, draw, found, truth, vectors=(slice(0, 2), slice(2, 4)), quick=0 if "ellipse" in name else 4, many=100
    )


def drawn(*parts: Callable[[np.random.Generator, float], tuple[float, ...]], most: float = 20.0) -> Any:
    """Sizes and places of both curves, in one unit of length; then a rotation of up to `most` [rad], or a small one."""

    def draw(rng: np.random.Generator) -> tuple[float, ...]:
        unit = decades(rng)
        turned = most * float(rng.uniform(-1, 1)) * (1.0 if rng.random() < 0.5 else decades(rng, -9, 0))
        return (*(number for part in parts for number in part(rng, unit)), turned, 1.0, 1.0)

    return draw


def oval(rng: np.random.Generator, unit: float) -> tuple[float, ...]:
    a = unit * decades(rng, -1, 1)
    return a, a * decades(rng, -1.5, 1.5)


def disc(rng: np.random.Generator, unit: float) -> tuple[float, ...]:
    """Radius and centre [m]."""
    return unit * decades(rng, -1, 1), unit * float(rng.normal()), unit * float(rng.normal())


def open_curve(rng: np.random.Generator, unit: float) -> tuple[float, ...]:
    return (unit * decades(rng, -1, 1),)


def spiralling(rng: np.random.Generator, unit: float) -> tuple[float, ...]:
    return unit, decades(rng, -1, 0.5)


def disc_in_hole(rng: np.random.Generator, unit: float) -> tuple[float, ...]:
    """The disc, and then the hole, at times of nearly its size."""
    return unit, 0.0, 0.0, unit * (1 + decades(rng, -6, 1)), 0.0, 0.0


def arcs(count: int) -> Callable[[np.random.Generator, float], tuple[float, ...]]:
    return lambda rng, unit: tuple(unit * float(rng.uniform(-9, 9)) for _ in range(count))


def angles(count: int, most: float = 9.0) -> Callable[[np.random.Generator, float], tuple[float, ...]]:
    return lambda rng, unit: tuple(float(rng.uniform(-most, most)) for _ in range(count))


ELLIPSE, LINE = (ellipse, Ellipse), (line, Line)
DISC = (round_curve(1), lambda radius, x, y: Circle(radius, (x, y)))
HOLE = (round_curve(-1), lambda radius, x, y: Ring(radius, (x, y)))
PARABOLA, CATENARY, SPIRAL = (parabola, Parabola), (catenary, Catenary), (spiral, LogSpiral)

ROLLS = (
    rolls("ellipse on a line", ELLIPSE, LINE, 2, drawn(oval, arcs(1), angles(1))),
    rolls("parabola on a line", PARABOLA, LINE, 1, drawn(open_curve, arcs(1), angles(1, 2.0), most=1.5)),
    rolls("spiral on a line", SPIRAL, LINE, 2, drawn(spiralling, arcs(1), angles(1), most=6.0)),
    rolls("disc in a hole", DISC, HOLE, 3, drawn(disc_in_hole, arcs(2))),
    rolls("disc on a disc", DISC, DISC, 3, drawn(disc, disc, arcs(2))),
    rolls("ellipse on a disc", ELLIPSE, DISC, 2, drawn(oval, disc, arcs(1), angles(1))),
    rolls("disc on an ellipse", DISC, ELLIPSE, 3, drawn(disc, oval, angles(1), arcs(1))),
    rolls("disc on a catenary", DISC, CATENARY, 3, drawn(disc, open_curve, arcs(2))),
    rolls("disc on a parabola", DISC, PARABOLA, 3, drawn(disc, open_curve, angles(1, 2.0), arcs(1))),
    rolls("ellipse on an ellipse", ELLIPSE, ELLIPSE, 2, drawn(oval, oval, angles(2))),
)
