"""Parallel parking with one skate (box 18.3): any pose from any other by turns about C and slides along i'."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Count, InvalidMechanism, Positive, Valid, validated
from reference.joints import Triple

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Move(Valid):
    """First turn about C [rad], then slide along the skate [m]; either may be zero or negative."""

    turn: float = 0.0
    slide: float = 0.0


@validated
def park(start: Triple, goal: Triple, backwards: bool = True) -> tuple[Move, Move]:
    """Turn, slide, turn from one pose of the skate (x, y, theta) to any other, theta's whole turns included.

    With `backwards` the skate may slide the other way, so that the first turn is never beyond a quarter.
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
    """The poses (moves + 1, 3) at the start and after every move."""
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
def trace(start: Triple, moves: tuple[Move, ...], samples: Count = 16) -> Array:
    """The poses along the way (points, 3), every turn and slide in `samples` parts, to be drawn; no part skids."""
    parts = [np.array([start], dtype=float)]
    along = np.linspace(0.0, 1.0, samples + 1)[1:, None]
    for before, move in zip(stops(start, moves), moves, strict=False):
        turned = before + np.array([0.0, 0.0, move.turn])
        ahead = np.array([math.cos(turned[2]), math.sin(turned[2]), 0.0])
        if move.turn:
            parts.append(before + along * (turned - before))
        if move.slide:
            parts.append(turned + along * move.slide * ahead)
    return np.concatenate(parts)


@validated
def commutator(turn: float, slide: float) -> tuple[Move, ...]:
    """Turn, slide, turn back, slide back: what is undone one by one does not undo the whole."""
    return Move(turn, slide), Move(-turn, -slide)


@validated
def commutator_displacement(turn: ArrayLike, slide: ArrayLike) -> Array:
    """The commutator's exact net displacement of C (..., 2) in the start's frame [m]: slide (cos turn - 1, sin turn).

    Divided by turn * slide it tends to (0, 1) as the turn shrinks, with an error of (-turn/2, -turn^2/6): straight
    sideways, the bracket of turning and sliding, which is just the velocity that the skate forbids.
    """
    turn, slide = np.asarray(turn, dtype=float), np.asarray(slide, dtype=float)
    return np.stack([-2 * slide * np.sin(turn / 2) ** 2, slide * np.sin(turn)], axis=-1)


@validated
def sidestep(distance: float, room: Positive, most_turn: Positive) -> tuple[Move, ...]:
    """Straight sideways by `distance` [m] (left, or right if negative), never turned more than `most_turn` [rad] nor
    further along than `room` [m], and no net turn or advance.

    The symmetric manoeuvre turn, slide, twice the turn back, slide back, turn moves C by exactly (0, 2 slide sin turn);
    it is repeated as often as the room asks, and the turn fits the distance. Raises InvalidMechanism for no room.
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
