"""MuJoCo's shapes for the curves of a Roll: planes, spheres or cylinders, ellipsoids.

Each body's frame is parallel to the world's at t = 0 (see `engines.tree`), so a shape is turned by the body's
start angle. In the plane a sphere is a circle, and it touches in one point where a cylinder touches in two.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from cmath import rect
from typing import Any, Literal

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building
from engines.rolling_table import unplaced
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Ring
from reference.rolling.roll import Roll

RoundShape = Literal["sphere", "cylinder"]


def add_shapes(building: Building, roll: Roll, round_shape: RoundShape) -> tuple[str, str]:
    """Give both bodies of a roll their shapes; the names of the geoms, first and second. Raises Unsupported."""
    return (
        _add_shape(building, roll, roll.first, roll.rolling.ground, round_shape),
        _add_shape(building, roll, roll.second, roll.rolling.body, round_shape),
    )


def _add_shape(building: Building, roll: Roll, owner: str | None, curve: Curve, round_shape: RoundShape) -> str:
    curve, shift, angle = unplaced(curve)
    index = building.index(owner)
    body = building.spec.worldbody if index is None else building.spec.body(f"body {index}")
    start = 0.0 if index is None else building.mechanism.bodies[index].pose[2]
    name = f"{roll.name}: {'ground' if owner is None else owner}"

    def add(kind: Any, inside: complex, quaternion: list[float], size: list[float]) -> str:
        place = rect(1.0, start) * (shift + rect(1.0, angle) * inside)
        body.add_geom(
            name=name,
            type=kind,
            pos=[place.real, place.imag, 0.0],
            quat=quaternion,
            size=size,
            mass=0.0,
            contype=0,  # nothing collides by itself, only the pair that is named
            conaffinity=0,
        )
        return name

    half = (start + angle) / 2
    turned = [math.cos(half), 0.0, 0.0, math.sin(half)]
    match curve:
        case Line() if owner is None:
            # A plane's face is along its z axis: a quarter turn lays that out of the material, which is on the left.
            out, quarter = -1j * rect(1.0, curve.heading + angle), math.sqrt(0.5)
            upright = [quarter, -quarter * out.imag, quarter * out.real, 0.0]
            return add(mujoco.mjtGeom.mjGEOM_PLANE, complex(*curve.through), upright, [1.0, 1.0, 1.0])
        case Line():
            raise Unsupported(
                f"roll {roll.name!r}: {owner!r} has a straight side, and MuJoCo's planes are fixed to the ground"
            )
        case Circle():
            if round_shape == "cylinder":
                size = [curve.radius, curve.radius / 2, 0.0]
                return add(mujoco.mjtGeom.mjGEOM_CYLINDER, complex(*curve.centre), turned, size)
            return add(mujoco.mjtGeom.mjGEOM_SPHERE, complex(*curve.centre), turned, [curve.radius, 0.0, 0.0])
        case Ellipse():
            depth = min(curve.along_x, curve.along_y)
            return add(mujoco.mjtGeom.mjGEOM_ELLIPSOID, 0j, turned, [curve.along_x, curve.along_y, depth])
        case Ring():
            raise Unsupported(
                f"roll {roll.name!r}: MuJoCo's shapes have no hollow side, so nothing can roll inside a ring by contact"
            )
        case _:
            raise Unsupported(
                f"roll {roll.name!r}: MuJoCo has no shape like a {type(curve).__name__.lower()}; it has planes, "
                "circles and ellipses"
            )
