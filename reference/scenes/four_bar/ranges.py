"""What angles a four-bar reaches: limits of the crank, extremes of the transmission angle, Grashof's classes."""

from __future__ import annotations

import math

from reference.scenes.four_bar.closed_form import Constants, difference

Interval = tuple[float, float]


def crank_limits(c: Constants) -> tuple[Interval, ...] | None:
    """The intervals (low, high) of theta [rad] in which the loop closes, up to whole turns; None if all do."""
    # theta' = 2 atan(sqrt(ratio)) where U or W vanishes; exact differences keep the digits near a change point.
    outer = 2 * math.atan2(math.sqrt(c.outer_near), math.sqrt(-c.outer_far)) if c.outer_far < 0 else None
    inner = 2 * math.atan2(math.sqrt(-c.inner_near), math.sqrt(c.inner_far)) if c.inner_near < 0 else None
    if outer is None and inner is None:
        return None
    if inner is None:
        assert outer is not None
        return ((c.heading - outer, c.heading + outer),)
    if outer is None:
        return ((c.heading + inner, c.heading + 2 * math.pi - inner),)
    return ((c.heading - outer, c.heading - inner), (c.heading + inner, c.heading + outer))


def transmission_extremes(c: Constants) -> tuple[float, float]:
    """The smallest and largest transmission angle [rad] over all reachable crank angles; 0 or pi: a limit."""
    # tan^2 of the half angle is W / U, and grows with the distance from B to D.
    low = 2 * math.atan2(math.sqrt(max(c.inner_near, 0)), math.sqrt(c.outer_near))
    high = 2 * math.atan2(math.sqrt(c.inner_far), math.sqrt(max(c.outer_far, 0)))
    return low, high


def grashof(crank: float, coupler: float, rocker: float, ground: float) -> str:
    """The class by name, from the shortest bar s, the longest l and the others p, q; lengths [m].

    s + l > p + q: triple-rocker (no bar turns fully). Equal up to the rounding of the lengths: change-point. Below:
    double-crank if the ground is shortest, double-rocker if the coupler is, crank-rocker if a side bar is; when that is
    the rocker, it is the rocker that turns and the crank that swings.
    """
    bars = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    shortest, *_ = ranked = sorted(bars, key=bars.__getitem__)
    s, p, q, longest = (bars[name] for name in ranked)
    excess = difference(s, longest, -p, -q)
    if excess > 0:
        return "triple-rocker"
    if excess == 0:
        return "change-point"
    return {"ground": "double-crank", "coupler": "double-rocker"}.get(shortest, "crank-rocker")
