"""The records of a mechanism for compiled code.

The module `elimination` defines the order of the rows and the entries of the matrix J M^-1 J^T.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.lagrange.elimination import cuthill_mckee, envelope
from engines.lagrange.records import (
    BODY_RECORD,
    CELL_SIZE,
    CONSTANT_RECORD,
    END_RECORD,
    EQUATION_RECORD,
    FORCE_RECORD,
    FURTHER_END_RECORD,
    JOINT_RECORD,
    ROLLING_RECORD,
    ROW_RECORD,
    TERM_RECORD,
    ForceKind,
    JointKind,
    Records,
    RollingForm,
    System,
    new_status,
)
from engines.rolling_table import RoundOnLine, RoundOnRound, Table, rolled
from reference.couplings import Coupling, Term
from reference.forces import CoupledForce, Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.reactions import rank
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll

Integers = NDArray[np.int64]
Key = tuple[str, int, str]  # a number of a system: the name of a table, the number of a record, the name of its field
Numbers = Mapping[str | None, int]  # Numbers of bodies by name; the ground has the key None.
Fields = dict[str, str]  # Attributes of a joint or force by field of its record.

JOINT_FIELDS: dict[type, tuple[JointKind, Fields]] = {
    Pin: (JointKind.PIN, {}),
    Slot: (JointKind.SLOT, {"angle": "line_angle"}),
    Skate: (JointKind.SKATE, {"angle": "angle"}),
    Rod: (JointKind.ROD, {"length": "length"}),
    Weld: (JointKind.WELD, {"offset": "angle"}),
    Drive: (JointKind.DRIVE, {"offset": "offset", "rate": "turning_rate"}),
    Gear: (JointKind.GEAR, {"offset": "phase", "ratio": "ratio"}),
    Roll: (JointKind.ROLL, {}),
    Coupling: (JointKind.COUPLING, {}),
}
FORCE_FIELDS: dict[type, tuple[ForceKind, Fields]] = {
    Spring: (ForceKind.SPRING, {"stiffness": "stiffness", "rest": "rest_length"}),
    Damper: (ForceKind.DAMPER, {"damping": "damping"}),
    TorsionSpring: (ForceKind.TORSION_SPRING, {"stiffness": "stiffness", "rest": "rest_angle"}),
    TorsionDamper: (ForceKind.TORSION_DAMPER, {"damping": "damping"}),
    Torque: (ForceKind.TORQUE, {"load": "torque"}),
    Force: (ForceKind.FORCE, {}),
    CoupledForce: (
        ForceKind.COUPLED_FORCE,
        {"load": "force", "stiffness": "stiffness", "damping": "damping", "rest": "rest"},
    ),
}
MOST_RANKED_ROWS = 400  # the rank of more rows would take longer than a run


def system_of(mechanism: Mechanism) -> tuple[System, Integers]:
    """The system of a mechanism without cells of tables, and the rows of the system by row of the mechanism."""
    joints, body_count = mechanism.joints, len(mechanism.bodies)
    numbers = {body.name: number for number, body in enumerate(mechanism.bodies)} | {None: body_count}
    first_rows = _first_rows(joints, numbers)
    positions = np.array(
        [row for first, joint in zip(first_rows, joints, strict=True) for row in range(first, first + joint.size)], int
    )
    rows = _rows(joints, numbers, positions)
    terms, further_ends = _terms(mechanism, numbers, first_rows)
    products, columns = envelope(rows, further_ends, body_count)
    equations = np.zeros(len(rows), EQUATION_RECORD)
    equations["rate"][positions] = mechanism.rate
    gravity_x, gravity_y = mechanism.gravity
    constants = {
        "dependent": _has_dependent_rows(mechanism),
        "holonomic_rows": rows["holonomic"].sum(),
        "gravity_x": gravity_x,
        "gravity_y": gravity_y,
        "inverse_length": 1 / mechanism.length_scale,
    }
    system = System(
        constants=_table(CONSTANT_RECORD, [constants])[0],
        status=new_status(),
        bodies=_bodies(mechanism),
        joints=_joints(joints, numbers, first_rows),
        forces=_forces(mechanism, numbers),
        terms=terms,
        rolls=_rolls(joints, numbers),
        cells=np.zeros((0, CELL_SIZE), dtype=complex),
        rows=rows,
        equations=equations,
        ends=np.zeros(2 * len(rows) + len(further_ends) + 1, END_RECORD),
        further_ends=further_ends,
        products=products,
        matrix=np.zeros(len(columns)),
        columns=columns,
        inverse_pivots=np.zeros(len(rows)),
        right=np.zeros(len(rows)),
        reaction=np.zeros(len(rows)),
        residual=np.zeros(len(rows)),
        change=np.zeros(3 * body_count + 3),
    )
    return system, positions


def _table(record: np.dtype[np.void], values: Sequence[Mapping[str, Any]]) -> Records:
    table = np.zeros(len(values), record)
    for row, fields in zip(table, values, strict=True):
        for name, value in fields.items():
            row[name] = value
    return table


def _bodies(mechanism: Mechanism) -> Records:
    bodies = np.zeros(len(mechanism.bodies) + 1, BODY_RECORD)
    bodies["inverse_mass"][:-1], _, bodies["inverse_inertia"][:-1] = 1 / mechanism.inertias.T
    bodies["cos"] = 1.0
    return bodies


def _between(element: Any, numbers: Numbers) -> dict[str, Any]:
    first_x, first_y = getattr(element, "first_point", (0.0, 0.0))
    second_x, second_y = getattr(element, "second_point", (0.0, 0.0))
    points = {"first_x": first_x, "first_y": first_y, "second_x": second_x, "second_y": second_y}
    return points | {"first": numbers[element.first], "second": numbers[element.second]}


def _joints(joints: Sequence[Joint], numbers: Numbers, first_rows: Integers) -> Records:
    records, rolls = list[dict[str, Any]](), 0
    for joint, row in zip(joints, first_rows, strict=True):
        kind, fields = JOINT_FIELDS[type(joint)]
        values = {field: getattr(joint, attribute) for field, attribute in fields.items()}
        records.append(_between(joint, numbers) | {"kind": kind, "row": row, "roll": rolls, "ratio": 1.0} | values)
        rolls += isinstance(joint, Roll)
    return _table(JOINT_RECORD, records)


def _forces(mechanism: Mechanism, numbers: Numbers) -> Records:
    records = list[dict[str, Any]]()
    first_term = sum(len(joint.terms) for joint in mechanism.joints if isinstance(joint, Coupling))
    for force in mechanism.forces:
        kind, fields = FORCE_FIELDS[type(force)]
        values = {field: getattr(force, attribute) for field, attribute in fields.items()} | {"kind": kind}
        if isinstance(force, CoupledForce):
            values |= {"first_term": first_term, "term_count": len(force.terms)}
            first_term += len(force.terms)
        else:
            values |= _between(force, numbers)
        if isinstance(force, Force):
            values["x"], values["y"] = force.force
        records.append(values)
    return _table(FORCE_RECORD, records)


def _first_rows(joints: Sequence[Joint], numbers: Numbers) -> Integers:
    """The first row of each joint (joints,); rows of joints on the same body are near each other."""
    if not joints:
        return np.zeros(0, dtype=np.int64)
    ends = [(numbers[joint.first], numbers[joint.second]) for joint in joints]
    order = np.array(cuthill_mckee(ends, numbers[None]))[::-1]
    sizes = np.array([joint.size for joint in joints])
    first_rows = np.empty(len(joints), dtype=np.int64)
    first_rows[order] = np.cumsum(sizes[order]) - sizes[order]
    return first_rows


def _bodies_of(terms: Iterable[Term], numbers: Numbers) -> list[int]:
    names = [name for term in terms for name in (term.first, term.second) if name is not None]
    return [numbers[name] for name in dict.fromkeys(names)]


def _rows(joints: Sequence[Joint], numbers: Numbers, positions: Integers) -> Records:
    """The records of the rows without the envelope.

    The record of a coupling contains its first two bodies.
    """
    rows = np.zeros(len(positions), ROW_RECORD)
    owners = [joint for joint in joints for _ in range(joint.size)]
    for position, joint in zip(positions, owners, strict=True):
        first, second = numbers[joint.first], numbers[joint.second]
        if isinstance(joint, Coupling):
            first, second = (*_bodies_of(joint.terms, numbers), numbers[None], numbers[None])[:2]
        rows[position] = first, second, joint.holonomic, 0, 0
    return rows


def _terms(mechanism: Mechanism, numbers: Numbers, first_rows: Integers) -> tuple[Records, Records]:
    """The terms of couplings and of coupled forces, and the ends of rows with more than two bodies."""
    terms, further_ends = list[dict[str, Any]](), list[dict[str, Any]]()
    numbered = zip(mechanism.joints, first_rows.tolist(), strict=True)
    couplings = [(joint, row) for joint, row in numbered if isinstance(joint, Coupling)]
    for coupling, row in couplings:
        ends = dict[int, int]()
        for k, body in enumerate(_bodies_of(coupling.terms, numbers)):
            ends[body] = 2 * row + k if k < 2 else 2 * mechanism.row_count + len(further_ends)
            if k >= 2:
                further_ends.append({"row": row, "body": body, "end": ends[body]})
        # Index -1 is the unused last record, which receives the ends on the ground.
        for k, term in enumerate(coupling.terms):
            first_end, second_end = (ends.get(numbers[name], -1) for name in (term.first, term.second))
            offset = coupling.offset if k == 0 else 0.0
            own_row = {"row": row, "first_end": first_end, "second_end": second_end, "offset": offset}
            terms.append(_term(term, numbers) | own_row)
    for force in mechanism.forces:
        if isinstance(force, CoupledForce):
            terms += [_term(term, numbers) | {"row": -1} for term in force.terms]
    return _table(TERM_RECORD, terms), _table(FURTHER_END_RECORD, further_ends)


def _term(term: Term, numbers: Numbers) -> dict[str, Any]:
    values = {"sliding": term.sliding, "factor": term.factor, "line_angle": term.line_angle}
    return _between(term, numbers) | values


def _has_dependent_rows(mechanism: Mechanism) -> bool:
    """Whether rows are linearly dependent at t = 0, for example the rows of two wheels on one axle.

    The rank of more than MOST_RANKED_ROWS is not computed, since the factorisation also detects dependent rows. For so
    many rows, the result is whether there are more rows than coordinates.
    """
    rows = mechanism.row_count
    if rows > 3 * len(mechanism.bodies):
        return True
    if rows == 0 or rows > MOST_RANKED_ROWS:
        return False
    return rank(mechanism.rows(mechanism.pose), mechanism.length_scale) < rows


def _rolls(joints: Sequence[Joint], numbers: Numbers) -> Records:
    rolls = [joint for joint in joints if isinstance(joint, Roll)]
    ends = [{"first": numbers[roll.first], "second": numbers[roll.second]} for roll in rolls]
    constants = [_rolling_constants(roll.rolling) for roll in rolls]
    return _table(ROLLING_RECORD, [pair | values for pair, values in zip(ends, constants, strict=True)])


def _rolling_constants(rolling: Rolling) -> dict[str, Any]:
    """The form and constants of a rolling pair, by field of ROLLING_RECORD."""
    try:
        fast = rolled(rolling)
    except (ValueError, ArithmeticError):  # near the start some rotations have no contact
        return {"form": RollingForm.NOT_TABULATED}
    match fast:
        case RoundOnLine():
            names = ("origin", "along", "middle", "start")
            return {"form": RollingForm.ON_LINE} | dict(zip(names, fast.constants, strict=True))
        case RoundOnRound():
            names = ("origin", "along", "radius", "middle", "start", "angle", "turning")
            return {"form": RollingForm.ON_ROUND} | dict(zip(names, fast.constants, strict=True))
        case Table() if not fast.exact_only:
            return {"form": RollingForm.TABULATED, "width": fast.width}
        case _:
            return {"form": RollingForm.NOT_TABULATED}
