"""Section 18.5 on skates: uniqueness of the skate's row, its Coriolis-like term, and parallel parking (box 18.3).

A linear condition on a body's velocity that is the same at every position and direction is a u + b v + c theta' = 0
with constants a, b, c. Here u, v [m/s] is the velocity of the centre of mass along the body's axes. If (a, b) = 0, the
condition is theta' = 0, which is integrable. Otherwise the condition is a skate: a point P has no velocity along the
blade's left normal n = (a, b) / |(a, b)|. The points P satisfy dot(n, k x P) = c / |(a, b)|. The skate is not
integrable, since dot(w, curl w) = -(a^2 + b^2) < 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.chapter.integrability import Place, exterior_derivatives
from reference.checks import InvalidMechanism, Positive, Valid, validated
from reference.joints import Skate, Triple
from reference.numerics.calculus import derivative
from reference.validators import Array

BodyRow = tuple[float, float, float]  # (a, b, c) [1, 1, m]


@validated
def skate_of(row: BodyRow) -> Skate | None:
    """The skate with the row (a, b, c) in the body's axes, or None for a row that constrains only rotation (a = b = 0).

    Raises InvalidMechanism for a row of zeros.
    """
    a, b, c = row
    size = math.hypot(a, b)
    if size == 0:
        if c == 0:
            raise InvalidMechanism(f"skate: row is {row}; one of its three numbers must differ from zero")
        return None
    a, b, c = a / size, b / size, c / size
    return Skate("skate", None, "body", (c * b, -c * a), math.atan2(-a, b))


@validated
def one_form(row: BodyRow) -> Callable[[NDArray[Any]], NDArray[Any]]:
    """The row in world coordinates (x, y, theta): an analytic function from places (..., 3) to rows (..., 1, 3)."""
    a, b, c = row

    def rows(place: NDArray[Any]) -> NDArray[Any]:
        cosine, sine = np.cos(place[..., 2]), np.sin(place[..., 2])
        return np.stack([a * cosine - b * sine, a * sine + b * cosine, c + 0 * cosine], axis=-1)[..., None, :]

    return rows


@validated
def frobenius(row: BodyRow, place: Place) -> float:
    """w . curl w of the row's one-form at a place (x, y, theta), by a complex step: zero everywhere iff integrable."""
    (form,), (slope,) = one_form(row)(place), exterior_derivatives(one_form(row), place)
    return float(form @ np.array([slope[1, 2], slope[2, 0], slope[0, 1]]))


@validated
def coriolis_factors(speed: float, rate: float, angular_acceleration: float = 0.0) -> tuple[float, float]:
    """The factors of v theta' in the acceleration across v, for a skate's point and for a slider.

    The speed v [m/s] and the rate theta' [rad/s] are not zero. The skate's point moves at v along the body's axis i',
    and only i' rotates. A slider at the same position moves at v along i' of a rotating body: both i' and the arm
    rotate, and the arm grows. Both factors are numerical derivatives, so that no formula is assumed.
    """
    if speed == 0 or rate == 0:
        raise InvalidMechanism(f"coriolis_factors: speed is {speed}, rate is {rate}; neither may be zero")

    def along(t: Any) -> Any:
        angle = rate * t + angular_acceleration * t * t / 2
        return np.stack([np.cos(angle), np.sin(angle)])

    # At t = 0 the body's axis i' is the world's x axis, so the component across is y. Angles are small up to the time
    # `near` [s].
    near = 0.25 / max(abs(rate), math.sqrt(abs(angular_acceleration)))
    skate = derivative(lambda t: speed * along(t), 0.0, radius=near)
    slider = derivative(lambda t: speed * t * along(t), 0.0, order=2, radius=near)
    return float(skate[1] / (speed * rate)), float(slider[1] / (speed * rate))


@dataclass(frozen=True)
class Move(Valid):
    """A turn about C [rad], then a slide along the skate [m]; each may be zero or negative."""

    turn: float = 0.0
    slide: float = 0.0


@validated
def park(start: Triple, goal: Triple, backwards: bool = True) -> tuple[Move, Move]:
    """The moves turn, slide and turn between two poses (x, y, theta) of the skate; theta may have whole turns.

    With `backwards` the skate may slide backwards, so that the first turn is at most a quarter turn.
    """
    distance = math.hypot(goal[0] - start[0], goal[1] - start[1])
    turn = 0.0
    if distance > 0:
        turn = math.remainder(math.atan2(goal[1] - start[1], goal[0] - start[0]) - start[2], 2 * math.pi)
        if backwards and abs(turn) > math.pi / 2:
            turn, distance = math.remainder(turn + math.pi, 2 * math.pi), -distance
    return Move(turn, distance), Move(turn=goal[2] - start[2] - turn)


@validated
def stops(start: Triple, moves: tuple[Move, ...]) -> Array:
    pose = np.array(start, dtype=float)
    out = [pose]
    for move in moves:
        heading = pose[2] + move.turn
        pose = np.array(
            [pose[0] + move.slide * math.cos(heading), pose[1] + move.slide * math.sin(heading), heading], dtype=float
        )
        out.append(pose)
    return np.array(out)


@validated
def trace(start: Triple, moves: tuple[Move, ...]) -> Array:
    """The poses along the path (points, 3), with every turn and slide in 16 parts, for drawings."""
    parts = [np.array([start], dtype=float)]
    along = np.linspace(0.0, 1.0, 17)[1:, None]
    for pose, move in zip(stops(start, moves), moves, strict=False):
        turned = pose + np.array([0.0, 0.0, move.turn])
        ahead = np.array([math.cos(turned[2]), math.sin(turned[2]), 0.0])
        if move.turn:
            parts.append(pose + along * (turned - pose))
        if move.slide:
            parts.append(turned + along * move.slide * ahead)
    return np.concatenate(parts)


@validated
def commutator(turn: float, slide: float) -> tuple[Move, ...]:
    """Turn, slide, turn back, slide back: the skate does not return to its start."""
    return Move(turn, slide), Move(-turn, -slide)


@validated
def commutator_displacement(turn: ArrayLike, slide: ArrayLike) -> Array:
    """The commutator's exact net displacement of C (..., 2) in the start's frame [m]: slide (cos turn - 1, sin turn).

    For small turns the displacement is turn * slide * (-turn/2, 1 - turn^2/6). This sideways direction is the bracket
    of turning and sliding, and the velocity that the skate forbids.
    """
    turn, slide = np.asarray(turn, dtype=float), np.asarray(slide, dtype=float)
    return np.stack([-2 * slide * np.sin(turn / 2) ** 2, slide * np.sin(turn)], axis=-1)


@validated
def sidestep(distance: float, room: Positive, most_turn: Positive) -> tuple[Move, ...]:
    """Moves straight sideways by `distance` [m] (left, or right if negative), without net turn or advance.

    No turn is larger than `most_turn` [rad] and no slide longer than `room` [m]. The symmetric manoeuvre turn, slide,
    twice the turn back, slide back, turn moves C by exactly (0, 2 slide sin turn). The manoeuvre is repeated as often
    as the distance requires. Raises InvalidMechanism for a `most_turn` above a quarter turn.
    """
    if most_turn > math.pi / 2:
        raise InvalidMechanism(f"sidestep: most_turn is {most_turn!r} rad; it must be at most a quarter turn, pi/2")
    if distance == 0:
        return ()
    reach = 2 * room * math.sin(most_turn)
    times = max(1, math.ceil(abs(distance) / reach * (1 - 1e-12)))
    turn = math.copysign(math.asin(min(1.0, abs(distance) / times / (2 * room))), distance)
    moves: list[Move] = []
    for _ in range(times):
        moves += [Move(turn, room), Move(-2 * turn, -room), Move(turn)]
    return tuple(moves)
