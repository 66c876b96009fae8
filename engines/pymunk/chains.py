"""How many sweeps a chain of joints needs, and how much of a gap they may close in a step: one rule for all mechanisms.

A sweep passes an impulse on from joint to joint. What it leaves falls by a factor 1 - O(1/J^2) in a sweep, as in any
relaxation over J points in a row, so J^2 sweeps do for any chain what a few do for a short one. With fewer, closing all
of a gap in every step feeds energy in until the motion explodes; in proportion to the sweeps that are missing, less of
it may be closed. Both numbers, and that the proportion is right, are measured on pendulums of 10 and 100 links.
"""

from __future__ import annotations

from collections import deque
from math import ceil

from reference.mechanism import Mechanism

ENOUGH = 0.3  # sweeps for a squared joint: 30 for ten links
FEWEST, MOST = 5, 300  # beyond 300 a step of a hundred links costs more than a smaller step brings


def longest_chain(mechanism: Mechanism) -> int:
    """How many joints lie between the ground and the body that is farthest from it; from the best body if none is held.

    Joints of several bodies with the ground start many chains at once; of two ways to a body the shorter counts,
    because an impulse takes both.
    """
    neighbours: dict[str | None, set[str | None]] = {body.name: set() for body in mechanism.bodies} | {None: set()}
    for joint in mechanism.joints:
        neighbours[joint.first].add(joint.second)
        neighbours[joint.second].add(joint.first)
    deepest, left = 1, [body.name for body in mechanism.bodies]
    held = _depths(neighbours, None)
    deepest = max(deepest, *held.values())
    left = [name for name in left if name not in held]
    while left:
        reached = _depths(neighbours, left[0])
        end = max(reached, key=lambda name: reached[name])
        deepest = max(deepest, ceil(max(_depths(neighbours, end).values()) / 2))
        left = [name for name in left if name not in reached]
    return deepest


def _depths(neighbours: dict[str | None, set[str | None]], start: str | None) -> dict[str | None, int]:
    depths, waiting = {start: 0}, deque([start])
    while waiting:
        here = waiting.popleft()
        for name in sorted(neighbours[here], key=str):
            if name not in depths:
                depths[name] = depths[here] + 1
                waiting.append(name)
    return depths


def sweeps(chain: int) -> int:
    """Iterations for a longest chain of that many joints."""
    return min(MOST, max(FEWEST, ceil(ENOUGH * chain**2)))


def gain(chain: int, iterations: int) -> float:
    """The fraction of a gap that may be closed in a step: 1 with enough sweeps."""
    return min(1.0, iterations / (ENOUGH * chain**2))
