"""A mechanism as arrays of records, the data of the compiled functions: their types are the same for every mechanism.

Bodies are numbered as in `Mechanism.bodies`; the ground is the body after the last. Vectors of coordinates have three
entries for each body, and three zeros for the ground. Rows stand in reversed Cuthill-McKee order, in which the
system J M^-1 J^T has a narrow envelope: O(bodies) entries for a chain. Entries of the envelope are sums of products of
two ends of rows on one body; the list of these products is made here once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from engines.rolling_table import RoundOnLine, RoundOnRound, Table, rolled
from reference.couplings import Coupling, Term
from reference.forces import CoupledForce, Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.rows import rank

Reals = NDArray[np.float64]
Integers = NDArray[np.int64]
Records = NDArray[np.void]

PIN, SLOT, SKATE, ROLL, DRIVE, ROD, GEAR, WELD, COUPLING = range(9)
JOINT_KINDS: dict[type, int] = {
    **{Pin: PIN, Slot: SLOT, Skate: SKATE, Roll: ROLL, Drive: DRIVE},
    **{Rod: ROD, Gear: GEAR, Weld: WELD, Coupling: COUPLING},
}
SPRING, DAMPER, TORSION_SPRING, TORSION_DAMPER, TORQUE, FORCE, COUPLED_FORCE = range(7)
FORCE_KINDS: dict[type, int] = {
    **{Spring: SPRING, Damper: DAMPER, TorsionSpring: TORSION_SPRING, TorsionDamper: TORSION_DAMPER},
    **{Torque: TORQUE, Force: FORCE, CoupledForce: COUPLED_FORCE},
}
ON_LINE, ON_ROUND, TABULATED, NOT_TABULATED = range(4)  # forms of rolling pairs
IDEAL, SPRINGS, COMPLIANT = range(3)  # rows: all ideal; some with springs and dampers; some with a compliance too
ALL_ROWS, HOLONOMIC_ROWS, RIGID_ROWS = range(3)  # the rows for which the row system is solved

MOST_RANKED_ROWS = 400  # the rank of more rows would take longer than a run
CELL_SIZE = 20  # complex numbers in a cell of a table of `engines.rolling_table`
MOST_STAGES = 16  # of the largest tableau, with those for dense output


def _record(integers: str, reals: str = "", complexes: str = "", unsigned: str = "") -> np.dtype[np.void]:
    names = ((integers, np.int64), (reals, np.float64), (complexes, np.complex128), (unsigned, np.uintp))
    return np.dtype([(name, kind) for text, kind in names for name in text.split()])


POINTS = "first_x first_y second_x second_y "  # of the two bodies, in their own frames [m]
# Units are those of the fields of `reference.joints`, `reference.forces` and `reference.couplings`.
CONSTANTS = _record("dependent regularised holonomic_rows", "gravity_x gravity_y")
BODY = _record("", "inverse_mass inverse_inertia x y angle cos sin vx vy omega")  # the state is written by `set_bodies`
JOINT = _record("kind first second row roll", POINTS + "angle length ratio offset rate")
FORCE_ELEMENT = _record("kind first second first_term term_count", POINTS + "x y stiffness rest damping load")
TERM = _record("row first second first_end second_end sliding", "factor " + POINTS + "line_angle offset")
# `column` is the first of the envelope; the entry of a column is matrix[begin + column].
ROW = _record("first second holonomic column begin")
EQUATION = _record("", "gap bias rate stiffness damping compliance without_bias inverse_inertia")  # of a row
END = _record("", "x y turn")  # derivatives of a row by the coordinates of one body
FURTHER_END = _record("row body end")  # of rows with more than two bodies
PRODUCT = _record("", unsigned="entry end other body")
# Constants of the closed forms in `engines.rolling_table`; of a table its cells that are at hand.
ROLLING = _record(
    "form first second first_cell cell_count cell_begin", "start angle turning width", "origin along radius middle"
)
STATUS = _record(
    "missing_roll accepted_steps selection",
    "missing_angle smallest_pivot factor_pivot stopped_at stiff_from rounding open_from",
)


class System(NamedTuple):
    """A mechanism, the room for its row system, and the status of its evaluation."""

    constants: Any  # a CONSTANTS record
    status: Any  # a STATUS record, see `new_status`
    bodies: Records  # (bodies + 1,)
    joints: Records
    forces: Records
    terms: Records  # those of couplings, then those of coupled forces
    rolls: Records
    cells: NDArray[np.complex128]  # (cells, CELL_SIZE) of all tables
    rows: Records
    equations: Records  # (rows,)
    ends: Records  # two for each row, further ones, and one for the ground's
    further_ends: Records
    products: Records
    matrix: Reals  # J M^-1 J^T in its envelope; then its factor
    inverse_pivots: Reals  # (rows,)
    right: Reals  # (rows,) right side
    reaction: Reals  # (rows,)
    residual: Reals  # (rows,)
    change: Reals  # (coordinates,) M^-1 J^T reaction


class StepStorage(NamedTuple):
    """Units and states (coordinates,) of a step, and the velocities and accelerations of its stages."""

    pose_unit: Reals
    twist_unit: Reals
    pose: Reals
    twist: Reals
    stage_pose: Reals
    stage_twist: Reals
    new_pose: Reals
    new_twist: Reals
    acceleration: Reals
    velocities: Reals  # (MOST_STAGES, coordinates)
    accelerations: Reals


def new_status() -> Any:
    """The status before the first call: no contact is missing, no event has happened."""
    status = np.zeros(1, STATUS)[0]
    status["missing_roll"], status["smallest_pivot"] = -1, 1.0
    status["stopped_at"] = status["stiff_from"] = status["open_from"] = np.nan
    return status


def new_storage(mechanism: Mechanism) -> StepStorage:
    """The storage of steps of a mechanism; all states are zero."""
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies) + 1)
    names = ("pose", "twist", "stage_pose", "stage_twist", "new_pose", "new_twist", "acceleration")
    states = {name: np.zeros_like(unit) for name in names}
    velocities, accelerations = np.zeros((2, MOST_STAGES, len(unit)))
    return StepStorage(unit, unit / mechanism.time_scale, **states, velocities=velocities, accelerations=accelerations)


def system_of(mechanism: Mechanism) -> tuple[System, Integers]:
    """The system of a mechanism without cells of tables, and the position (rows,) of each of its rows in the system."""
    joints, index = mechanism.joints, {body.name: i for i, body in enumerate(mechanism.bodies)}
    numbers: dict[str | None, int] = index | {None: len(index)}
    first_rows = _first_rows(joints, numbers)
    sizes = [joint.size for joint in joints]
    positions = np.array(
        [row for first, size in zip(first_rows, sizes, strict=True) for row in range(first, first + size)], dtype=int
    )
    terms, further_ends = _terms(mechanism, numbers, positions)
    rows, holonomic = _rows(joints, numbers, positions)
    products, entries = _envelope(rows, further_ends, len(index))
    equations = np.zeros(len(rows), EQUATION)
    equations["rate"][positions] = mechanism.rate
    constants = np.zeros(1, CONSTANTS)[0]
    constants["dependent"], constants["holonomic_rows"] = _has_dependent_rows(mechanism), sum(holonomic)
    constants["gravity_x"], constants["gravity_y"] = mechanism.gravity
    system = System(
        constants=constants,
        status=new_status(),
        bodies=_bodies(mechanism),
        joints=_joints(joints, numbers, first_rows),
        forces=_forces(mechanism, numbers, terms),
        terms=terms,
        rolls=_rolls(joints, numbers),
        cells=np.zeros((0, CELL_SIZE), dtype=complex),
        rows=rows,
        equations=equations,
        ends=np.zeros(2 * len(rows) + len(further_ends) + 1, END),
        further_ends=further_ends,
        products=products,
        matrix=np.zeros(entries),
        inverse_pivots=np.zeros(len(rows)),
        right=np.zeros(len(rows)),
        reaction=np.zeros(len(rows)),
        residual=np.zeros(len(rows)),
        change=np.zeros(3 * len(index) + 3),
    )
    return system, positions


Numbers = Mapping[str | None, int]  # of bodies by their names


def _table(record: np.dtype[np.void], rows: Sequence[Mapping[str, Any]]) -> Records:
    """Records with these fields; fields that are not given are zero."""
    table = np.zeros(len(rows), record)
    for position, row in enumerate(rows):
        for name, value in row.items():
            table[name][position] = value
    return table


def _bodies(mechanism: Mechanism) -> Records:
    bodies = np.zeros(len(mechanism.bodies) + 1, BODY)
    bodies["inverse_mass"][:-1] = [1 / body.mass for body in mechanism.bodies]
    bodies["inverse_inertia"][:-1] = [1 / body.inertia for body in mechanism.bodies]
    bodies["cos"] = 1.0
    return bodies


def _points(element: Any) -> dict[str, float]:
    (first_x, first_y) = getattr(element, "first_point", (0.0, 0.0))
    (second_x, second_y) = getattr(element, "second_point", (0.0, 0.0))
    return {"first_x": first_x, "first_y": first_y, "second_x": second_x, "second_y": second_y}


def _joint_parameters(joint: Joint) -> dict[str, float]:
    match joint:
        case Slot():
            return _points(joint) | {"angle": joint.line_angle}
        case Skate():
            return _points(joint) | {"angle": joint.angle}
        case Rod():
            return _points(joint) | {"length": joint.length}
        case Weld():
            return _points(joint) | {"ratio": 1.0, "offset": joint.angle}
        case Drive():
            return {"ratio": 1.0, "offset": joint.offset, "rate": joint.turning_rate}
        case Gear():
            return {"ratio": joint.ratio, "offset": joint.phase}
        case Pin():
            return _points(joint)
        case _:  # rolls and couplings have records of their own
            return {}


def _joints(joints: Sequence[Joint], numbers: Numbers, first_rows: Integers) -> Records:
    records, rolls = list[dict[str, Any]](), 0
    for joint, row in zip(joints, first_rows, strict=True):
        ends = {"kind": JOINT_KINDS[type(joint)], "first": numbers[joint.first], "second": numbers[joint.second]}
        records.append(ends | {"row": row, "roll": rolls} | _joint_parameters(joint))
        rolls += isinstance(joint, Roll)
    return _table(JOINT, records)


def _force_parameters(force: ForceElement) -> dict[str, float]:
    match force:
        case Spring():
            return _points(force) | {"stiffness": force.stiffness, "rest": force.rest_length}
        case Damper():
            return _points(force) | {"damping": force.damping}
        case Force():
            return _points(force) | {"x": force.force[0], "y": force.force[1]}
        case TorsionSpring():
            return {"stiffness": force.stiffness, "rest": force.rest_angle}
        case TorsionDamper():
            return {"damping": force.damping}
        case Torque():
            return {"load": force.torque}
        case CoupledForce():
            return {name: getattr(force, name) for name in ("stiffness", "rest", "damping")} | {"load": force.force}


def _forces(mechanism: Mechanism, numbers: Numbers, terms: Records) -> Records:
    records, first_term = list[dict[str, Any]](), int(np.sum(terms["row"] >= 0))
    for force in mechanism.forces:
        record: dict[str, Any] = {"kind": FORCE_KINDS[type(force)]}
        if isinstance(force, CoupledForce):
            record |= {"first_term": first_term, "term_count": len(force.terms)}
            first_term += len(force.terms)
        else:
            record |= {"first": numbers[force.first], "second": numbers[force.second]}
        records.append(record | _force_parameters(force))
    return _table(FORCE_ELEMENT, records)


def _first_rows(joints: Sequence[Joint], numbers: Numbers) -> Integers:
    """(joints,) the first row of each joint, such that joints on one body have rows near each other."""
    count, ground = len(joints), numbers[None]
    ends = [(joint, numbers[name]) for joint, own in enumerate(joints) for name in (own.first, own.second)]
    moving = np.array([end for end in ends if end[1] < ground], dtype=int).reshape(-1, 2)
    if not count:
        return np.zeros(0, dtype=np.int64)
    on_body = coo_array((np.ones(len(moving)), (moving[:, 0], moving[:, 1])), shape=(count, ground)).tocsr()
    order = reverse_cuthill_mckee((on_body @ on_body.T).tocsr(), symmetric_mode=True)
    size = np.array([joint.size for joint in joints])
    first_rows = np.empty(count, dtype=np.int64)
    first_rows[order] = np.cumsum(size[order]) - size[order]
    return first_rows


def _bodies_of(terms: tuple[Term, ...], numbers: Numbers) -> list[int]:
    """The moving bodies on which a sum of terms depends."""
    return list(
        dict.fromkeys(numbers[name] for term in terms for name in (term.first, term.second) if name is not None)
    )


def _rows(joints: Sequence[Joint], numbers: Numbers, positions: Integers) -> tuple[Records, list[bool]]:
    """The rows without their envelope."""
    owners = [joint for joint in joints for _ in range(joint.size)]
    rows = np.zeros(len(owners), ROW)
    for position, joint in zip(positions, owners, strict=True):
        first, second = numbers[joint.first], numbers[joint.second]
        if isinstance(joint, Coupling):
            first, second = (*_bodies_of(joint.terms, numbers), numbers[None], numbers[None])[:2]
        rows[position] = first, second, joint.holonomic, 0, 0
    return rows, [joint.holonomic for joint in owners]


def _terms(mechanism: Mechanism, numbers: Numbers, positions: Integers) -> tuple[Records, Records]:
    """The terms of couplings, then those of coupled forces; and the further ends of rows."""
    terms, further_ends = list[dict[str, Any]](), list[dict[str, Any]]()
    first_row = np.cumsum([0, *(joint.size for joint in mechanism.joints)])
    couplings = [
        (joint, int(positions[row]))
        for joint, row in zip(mechanism.joints, first_row[:-1], strict=True)
        if isinstance(joint, Coupling)
    ]
    lasting = 2 * len(positions) + sum(max(0, len(_bodies_of(joint.terms, numbers)) - 2) for joint, _ in couplings)
    for joint, row in couplings:
        bodies = _bodies_of(joint.terms, numbers)
        ends = {numbers[None]: lasting}
        for place, body in enumerate(bodies):
            ends[body] = 2 * row + place
            if place >= 2:
                ends[body] = 2 * len(positions) + len(further_ends)
                further_ends.append({"row": row, "body": body, "end": ends[body]})
        for place, term in enumerate(joint.terms):
            own = {"row": row, "offset": joint.offset if place == 0 else 0.0}
            own |= {"first_end": ends[numbers[term.first]], "second_end": ends[numbers[term.second]]}
            terms.append(_term(term, numbers) | own)
    for force in mechanism.forces:
        if isinstance(force, CoupledForce):
            terms += [_term(term, numbers) | {"row": -1} for term in force.terms]
    return _table(TERM, terms), _table(FURTHER_END, further_ends)


def _term(term: Term, numbers: Numbers) -> dict[str, Any]:
    ends = {"first": numbers[term.first], "second": numbers[term.second], "sliding": term.sliding}
    return _points(term) | ends | {"factor": term.factor, "line_angle": term.line_angle}


def _envelope(rows: Records, further_ends: Records, body_count: int) -> tuple[Records, int]:
    """The products of ends on one body, and the number of entries of the envelope, which is written to the rows."""
    on_body: list[list[tuple[int, int]]] = [[] for _ in range(body_count + 1)]  # (row, end)
    for row in range(len(rows)):
        on_body[rows["first"][row]].append((row, 2 * row))
        on_body[rows["second"][row]].append((row, 2 * row + 1))
    for further in further_ends:
        on_body[further["body"]].append((further["row"], further["end"]))
    moving = [sorted(ends) for ends in on_body[:-1]]
    column = np.arange(len(rows))
    for ends in moving:
        for row, _ in ends:
            column[row] = min(column[row], ends[0][0])
    widths = np.arange(len(rows)) - column + 1
    begin = np.cumsum(widths) - widths - column
    rows["column"], rows["begin"] = column, begin
    products = [
        (begin[row] + other_row, end, other, body)
        for body, ends in enumerate(moving)
        for i, (row, end) in enumerate(ends)
        for other_row, other in ends[: i + 1]
    ]
    return np.array(products, dtype=PRODUCT), int(widths.sum())


def _has_dependent_rows(mechanism: Mechanism) -> bool:
    """Whether some rows follow from others at the start: two wheels on one axle, a parallelogram's third crank.

    False if the rank would take seconds; the factorisation itself finds dependent rows.
    """
    rows = mechanism.row_count
    if rows > 3 * len(mechanism.bodies):
        return True
    if rows == 0 or rows > MOST_RANKED_ROWS:
        return False
    return rank(mechanism.rows(mechanism.pose), mechanism.length_scale) < rows


def _rolls(joints: Sequence[Joint], numbers: Numbers) -> Records:
    rolls = [joint for joint in joints if isinstance(joint, Roll)]
    return _table(
        ROLLING,
        [
            {"first": numbers[roll.first], "second": numbers[roll.second], **_rolling_constants(roll.rolling)}
            for roll in rolls
        ],
    )


def _rolling_constants(rolling: Rolling) -> dict[str, Any]:
    """The form of a pair and its constants, by the names of ROLLING."""
    try:
        fast = rolled(rolling)
    except (ValueError, ArithmeticError):  # the curves cannot touch everywhere around the start
        return {"form": NOT_TABULATED}
    match fast:
        case RoundOnLine():
            names = ("origin", "along", "middle", "start")
            return {"form": ON_LINE} | dict(zip(names, fast.constants, strict=True))
        case RoundOnRound():
            names = ("origin", "along", "radius", "middle", "start", "angle", "turning")
            return {"form": ON_ROUND} | dict(zip(names, fast.constants, strict=True))
        case Table() if not fast.exact_only:
            return {"form": TABULATED, "width": fast.width}
    return {"form": NOT_TABULATED}
