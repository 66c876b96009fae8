"""Linkages of uniform bars, defined by the points at which the bars are pinned."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from reference.checks import InvalidMechanism, short_repr
from reference.joints import Pin, Vector
from reference.mechanism import Body, Mechanism


def linkage(
    points: Mapping[str, tuple[float, float]],
    bars: Mapping[str, Sequence[str]],
    ground: Sequence[str],
    gravity: Vector = (0.0, -9.81),
    density: float = 1.0,
) -> Mechanism:
    """Bars between named points [m], pinned to each other at common points and to the ground at the points of `ground`.

    bars: a mapping from bars to the names of both end points, ("A", "B") or "AB"; density [kg/m]; gravity [m/s^2]. The
    linkage starts at rest. If more than two bars meet at a point, every other bar is pinned to the first bar. Raises
    InvalidMechanism.
    """
    bodies, joints = list[Body](), list[Pin]()
    first: dict[str, tuple[str | None, Vector]] = {name: (None, _place(points, name)) for name in ground}
    for bar, ends in bars.items():
        if len(ends) != 2 or ends[0] == ends[1]:
            raise InvalidMechanism(f"bar {bar!r}: its ends are {ends!r}; give the names of two different points")
        (x, y), (other_x, other_y) = (_place(points, end) for end in ends)
        length, angle = math.hypot(other_x - x, other_y - y), math.atan2(other_y - y, other_x - x)
        if not length > 0:
            raise InvalidMechanism(f"bar {bar!r}: {ends[0]!r} and {ends[1]!r} are at the same point")
        mass, centre = density * length, ((x + other_x) / 2, (y + other_y) / 2)
        bodies.append(Body(bar, mass, mass * length**2 / 12, (*centre, angle), (0.0, 0.0, 0.0)))
        for end, side in zip(ends, (-length / 2, length / 2), strict=True):
            base, base_point = first.setdefault(end, (bar, (side, 0.0)))
            if (base, base_point) != (bar, (side, 0.0)):
                count = sum(joint.name.split(" ")[0] == end for joint in joints)
                joints.append(Pin(f"{end} {count + 1}" if count else end, base, bar, base_point, (side, 0.0)))
    return Mechanism(tuple(bodies), tuple(joints), gravity)


def _place(points: Mapping[str, tuple[float, float]], name: str) -> Vector:
    if name not in points:
        raise InvalidMechanism(f"no point is called {name!r}; there are {', '.join(points)}")
    try:
        x, y = map(float, points[name])
    except (TypeError, ValueError):
        message = f"point {name!r} is {short_repr(points[name])}; it must be two numbers, x and y [m]"
        raise InvalidMechanism(message) from None
    return x, y
