"""Rolling as constraints in MuJoCo: two rows written in a callback, or a joint equality whose polynomial is rewritten.

Both hold the body's origin where rolling puts it at its rotation, P(theta) of `engines.rolling_table`.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from cmath import rect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Binder, Building, Hooks
from engines.mujoco.written_rows import Row, State, WrittenJoint, equality_rows
from engines.rolling_table import Rolled, rolled
from engines.tree import Link
from reference.checks import Valid
from reference.rolling.roll import Roll


@dataclass(frozen=True)
class RollRows(Valid):
    """Two rows a roll, exact in every stage: any curve on any other, and two bodies that both move."""

    def add(self, building: Building, rolls: Sequence[Roll]) -> None:
        """Add rows that a callback writes."""
        stiffness, damping = building.stiffness.gains(building.mechanism, building.dt)
        for roll in rolls:
            link, table = _free_on_ground(building, roll), rolled(roll.rolling)
            if link is not None:
                names = _add_equalities(building, roll, link)
                building.binders.append(_own_rows(table, names, link, building, stiffness, damping))
                building.rewritten = True
                continue
            law = roll_rows(table, stiffness, damping)
            building.written.append(WrittenJoint(building.index(roll.first), building.index(roll.second), 2, law))


def _free_on_ground(building: Building, roll: Roll) -> Link | None:
    """The link of a body that moves freely and rolls on the ground: the common case, which has short rows."""
    index = building.index(roll.second)
    link = next((link for link in building.tree.links if link.body == index), None)
    return link if roll.first is None and link is not None and link.kind == "free" else None


def _add_equalities(building: Building, roll: Roll, link: Link, against: str = "") -> tuple[str, str]:
    """A joint equality each for x and y, alone or against another coordinate; their names."""
    names = (f"{roll.name}: x", f"{roll.name}: y")
    for name, column in zip(names, link.columns, strict=False):
        building.spec.add_equality(
            name=name,
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=f"coordinate {column}",
            name2=against,
            solref=list(building.stiffness.reference(building.mechanism, building.dt)),
            solimp=list(building.stiffness.impedance),
        )
    building.size += roll.size
    return names


def _own_rows(
    table: Rolled, names: Sequence[str], link: Link, building: Building, stiffness: float, damping: float
) -> Binder:
    """Rows (1, 0, -X') and (0, 1, -Y') in a body's own x, y, angle.

    The equality that reserves a row has the 1 in it already, so that two numbers a row are written and no more. It is
    one of x or y alone: against the rotation it would be softer by that coordinate's inertia.
    """
    start_x, start_y, start = building.mechanism.bodies[link.body].pose

    def bind(compiled: Any, address: Sequence[int]) -> Hooks:
        x, y, rotation = (address[column] for column in link.columns)
        rows = row_x, row_y = [equality_rows(compiled, compiled.equality(name).id) for name in names]
        turning_x, turning_y = (row * compiled.nv + rotation for row in rows)
        place_at = table.place

        def write(_model: Any, data: Any) -> None:
            position, velocity = data.qpos.tolist(), data.qvel.tolist()
            omega = velocity[rotation]
            place, once, twice = place_at(start + position[rotation])
            dx, dy, square = once.real, once.imag, omega * omega
            jacobian, reference = data.efc_J, data.efc_aref
            jacobian[turning_x] = -dx
            jacobian[turning_y] = -dy
            reference[row_x] = (
                square * twice.real
                - damping * (velocity[x] - dx * omega)
                - stiffness * (start_x + position[x] - place.real)
            )
            reference[row_y] = (
                square * twice.imag
                - damping * (velocity[y] - dy * omega)
                - stiffness * (start_y + position[y] - place.imag)
            )

        return Hooks(control=(write,))

    return bind


def roll_rows(table: Rolled, stiffness: float, damping: float) -> Callable[[float, State, State], Sequence[Row]]:
    """The rows of z_2 - z_1 - e^(i phi_1) P(phi_2 - phi_1) = 0, in x and in y, and J a = -(dJ/dt) v - b J v - k gap.

    The same two conditions as those of `reference.rolling.roll` along tangent and normal, in directions that rest.
    """
    place_at = table.place

    def rows(_t: float, first: State, second: State) -> Sequence[Row]:
        x1, y1, angle1, vx1, vy1, omega1 = first
        x2, y2, angle2, vx2, vy2, omega2 = second
        place, once, twice = place_at(angle2 - angle1)
        way = rect(1.0, angle1)
        place, once, twice = way * place, way * once, way * twice
        carried = 1j * place - once  # d(e^(i phi_1) P) / d phi_1
        rate = omega2 - omega1
        changing = twice * (rate * rate) + 2j * omega1 * rate * once - omega1 * omega1 * place
        slip = complex(vx2 - vx1, vy2 - vy1) - carried * omega1 - once * omega2
        right = changing - damping * slip - stiffness * (complex(x2 - x1, y2 - y1) - place)
        return (
            (-1.0, 0.0, -carried.real, 1.0, 0.0, -once.real, right.real),
            (0.0, -1.0, -carried.imag, 0.0, 1.0, -once.imag, right.imag),
        )

    return rows


@dataclass(frozen=True)
class RollEquality(Valid):
    """A joint equality a coordinate, x and y as polynomials of the rotation, developed anew before every step.

    Public fields only, but MuJoCo's joint equalities lack the velocity term (measured in 4.0.1; `connect` and `weld`
    have it since 3.7.0), so that this is of the first order.
    """

    def add(self, building: Building, rolls: Sequence[Roll]) -> None:
        """Add the equalities. Raises Unsupported unless a free body rolls on the ground."""
        laws = []
        for roll in rolls:
            link = _free_on_ground(building, roll)
            if link is None:
                raise Unsupported(
                    f"roll {roll.name!r}: MuJoCo's joint equality makes a coordinate a polynomial of one other, which "
                    "rolling is only for a free body on the ground"
                )
            names = _add_equalities(building, roll, link, f"coordinate {link.rotation}")
            laws.append((rolled(roll.rolling), names, link.columns[-1], building.mechanism.bodies[link.body].pose))

        def bind(compiled: Any, address: Sequence[int]) -> Hooks:
            def rewriting(table: Rolled, names: Sequence[str], rotation: int, pose: Sequence[float]) -> Any:
                row_x, row_y = (compiled.equality(name).id for name in names)
                where, (start_x, start_y, start) = address[rotation], pose
                coefficients = compiled.eq_data

                def rewrite(_model: Any, data: Any) -> None:
                    u = float(data.qpos[where])
                    place, once, twice = table.place(start + u)
                    half = twice / 2
                    # MuJoCo's polynomial is in the rotation since the start, not since now.
                    constant = place - once * u + half * u * u - complex(start_x, start_y)
                    slope = once - twice * u
                    coefficients[row_x, :3] = constant.real, slope.real, half.real
                    coefficients[row_y, :3] = constant.imag, slope.imag, half.imag

                return rewrite

            return Hooks(before=tuple(rewriting(*law) for law in laws))

        building.binders.append(bind)
