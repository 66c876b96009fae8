"""A mechanism as two flat arrays, which compiled code reads: the same types for each, so nothing is compiled twice.

Whole numbers say who is joined with whom. Real numbers say how long and heavy everything is, and after them there is
room to work in. A header of the whole numbers says where each of them begins: the constants below are its places.
Arrays of arrays were tried: compiling took ten times as long.

Bodies are counted as in `Mechanism.bodies`, and the ground is the body after the last. Rows stand in the order of
Cuthill and McKee, reversed, in which the row system J M^-1 J^T has a narrow envelope: O(bodies) numbers for a chain.
Only rows on one body meet there, so its entries are a list of products, made here once.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

PIN, SLOT, SKATE, ROLL, DRIVE, ROD, GEAR, WELD, COUPLING = range(9)
KINDS: dict[type, int] = {
    **{Pin: PIN, Slot: SLOT, Skate: SKATE, Roll: ROLL, Drive: DRIVE},
    **{Rod: ROD, Gear: GEAR, Weld: WELD, Coupling: COUPLING},
}
SPRING, DAMPER, TORSION_SPRING, TORSION_DAMPER, TORQUE, FORCE, COUPLED = range(7)
FORCE_KINDS: dict[type, int] = {
    **{Spring: SPRING, Damper: DAMPER, TorsionSpring: TORSION_SPRING, TorsionDamper: TORSION_DAMPER},
    **{Torque: TORQUE, Force: FORCE, CoupledForce: COUPLED},
}
ON_LINE, ON_ROUND, TABLE, NOT_TABULATED = range(4)  # forms of rolling pairs
MOST_ROWS = 400  # beyond, their rank takes longer than the run

MARCH, CONTROL, REACT = range(3)  # what compiled code is asked for

# Records, in whole numbers. A body is the place of its x among the columns, 3 for each, an end that of its 3 numbers.
JOINT = 5  # kind, first body, second body, first row, which of the rolls
FORCED = 3  # of a force element: kind, first body, second body; of a coupled one the first of its summands, how many
# Of a coupling or a coupled force: its row (-1: of a force), two bodies, the ends of each, whether it slides.
SUMMAND = 6
EXTRA = 3  # a further end of a row that has more than two: the row, the body, the end
ROW = 5  # first body, second body, whether it limits a position, first column of its envelope, where that begins
ROLL_RECORD = 4  # form; of the window of a table its first cell, how many cells, where they begin
# Records, in real numbers.
PARAMETERS = 7  # of a joint: its point on the first body, on the second [m], its angle or length, rate or ratio, offset
FORCE_PARAMETERS = 6  # of a force: its point on the first body, on the second [m], and two that its kind makes sense of
CONSTANTS = 7  # complex ones, of a rolling pair
CELL = 20  # complex numbers, of a table
SUMMAND_PARAMETERS = 7  # factor; its points on the first and on the second body [m]; a line's angle; off the gap
TERM = 4  # entry of the envelope; two ends of rows, and the body on which they meet: the entry gets their product
STAGES = 16  # of the largest tableau, with those for dense output

# How many; whether rows are dependent; whether some are soft, 1 by springs and dampers, 2 by a compliance too; which
# rows are asked for; how many forces, summands of couplings (those of forces stand after them), and further ends.
(JOINTS, ROWS, COLUMNS, TERMS, HOLONOMIC_ROWS, DEPENDENT, SOFT, WHICH, FORCES, SUMMANDS, EXTRAS) = range(11)
(JOINT_AT, ROW_AT, TERM_AT, FORCE_AT, SUMMAND_AT, EXTRA_AT, ROLL_AT) = range(11, 18)  # records among the whole numbers
# What a mechanism is made of: 1/kg, 1/kg, 1/(kg m^2) of every column, m/s^2, parameters, the rates of rows, the units
# of a pose and of a twist, constants of rolls, the softness of rows and what part of their bias they lack, parameters
# of forces and of summands, the start.
_NUMBERS = range(18, 33)
(MOBILITY, GRAVITY, PARAMETER_AT, RATE, POSE_UNIT, TWIST_UNIT, ROLL_NUMBERS) = _NUMBERS[:7]
(STIFFNESS, DAMPING, COMPLIANCE, LACKING, FORCE_NUMBERS, SUMMAND_NUMBERS, START_POSE, START_TWIST) = _NUMBERS[7:]
# Room to work in: cosine and sine of every body; ends of rows, 6 for each, and further ones; gap, bias, right side, its
# residual, inverse pivot, reaction and inverse inertia felt of every row; the factor; and columns: M^-1 J^T reaction,
# the state, that of a stage, that after a step, and velocities and accelerations of all stages.
_ROOM = range(33, 53)
(TURNED, ENDS, GAP, BIAS, RIGHT, LEFT, PIVOT, REACTION, FELT, MATRIX, CHANGE, POSE, TWIST) = _ROOM[:13]
(STAGE_POSE, STAGE_TWIST, NEW_POSE, NEW_TWIST, VELOCITY, ACCELERATION, STATUS) = _ROOM[13:]
HEADER = 53

# What a call leaves behind, among the real numbers from STATUS on: the smallest pivot; the roll and the angle without a
# cell; accepted steps; the time at which steps became too small or too many, and when the motion became stiff, NaN if
# never; and how much rounding alone may have changed the speeds, in parts of the mechanism's own; the last factor's
# smallest pivot; the first time at which a projection left joints open, NaN if none did.
SMALLEST, WANTED_ROLL, WANTED_ANGLE, STEPS, STOPPED, STIFF, ROUNDED, PIVOTED, UNCLOSED = range(9)
STATUSES = 9


@dataclass(frozen=True)
class Arrays:
    """One mechanism for compiled code; see the module."""

    whole: Integers
    real: Floats
    rows: Integers  # (rows,) where each row of the mechanism stands among those of the row system

    @property
    def rolls(self) -> Integers:
        """(rolls, ROLL_RECORD) a view of their records."""
        return self.whole[self.whole[ROLL_AT] :].reshape(-1, ROLL_RECORD)


def arrays_of(mechanism: Mechanism) -> Arrays:
    """The arrays of a mechanism."""
    joints, bodies = mechanism.joints, len(mechanism.bodies)
    index: dict[str | None, int] = {body.name: i for i, body in enumerate(mechanism.bodies)} | {None: bodies}
    ends = np.array([(index[joint.first], index[joint.second]) for joint in joints], dtype=np.int64)
    ends = ends.reshape(-1, 2)
    size = np.array([joint.size for joint in joints], dtype=np.int64)
    begin = _places(ends, size, bodies)
    place = np.array([row for at, count in zip(begin, size, strict=True) for row in range(at, at + count)], dtype=int)
    owner = np.empty(len(place), dtype=np.int64)
    owner[place] = np.repeat(np.arange(len(joints)), size)
    ends_of_rows = ends[owner]
    summands, extras = _summands(mechanism, index, place)
    forced = _forced(mechanism, index)
    for row, pair in _two_ends(mechanism, index, place).items():
        ends_of_rows[row] = pair
    start, offset, terms = _products(ends_of_rows, extras, bodies)
    holonomic = np.array([joint.holonomic for joint in joints], dtype=np.int64)[owner]
    rolls = [joint.rolling for joint in joints if isinstance(joint, Roll)]
    which = np.cumsum([isinstance(joint, Roll) for joint in joints]) - 1
    kind = np.array([KINDS[type(joint)] for joint in joints], dtype=np.int64)
    records = (
        np.column_stack([kind, 3 * ends, begin, which]),
        np.column_stack([3 * ends_of_rows, holonomic, start, offset[:-1]]),
        terms,
        forced,
        summands,
        extras * [1, 3, 1],
        np.array([(form_of(rolling)[0], 0, 0, 0) for rolling in rolls], dtype=np.int64),
    )
    columns, rows = 3 * bodies + 3, len(place)
    dependent, forces = int(_dependent(mechanism)), len(mechanism.forces)
    held = int(np.sum(summands[:, 0] >= 0))
    counts = (len(joints), rows, columns, len(terms), int(holonomic.sum()), dependent, 0, 0, forces, held, len(extras))
    numbers = _numbers(mechanism, place)
    room = [
        2 * bodies + 2,
        6 * rows + 3 * len(extras) + 3,
        *[rows] * 7,
        int(offset[-1]),
        *[columns] * 7,
        *[STAGES * columns] * 2,
        STATUSES,
    ]
    header = (
        *counts,
        *itertools.accumulate((record.size for record in records[:-1]), initial=HEADER),
        *itertools.accumulate((*map(len, numbers), *room[:-1]), initial=0),
    )
    real = np.concatenate([*numbers, np.zeros(sum(room))])
    real[header[TURNED] : header[TURNED] + 2 * bodies + 2 : 2] = 1.0  # the ground's stay so
    real[header[STATUS] :] = 1.0, -1.0, 0.0, 0.0, np.nan, np.nan, 0.0, 0.0, np.nan
    whole = np.concatenate(
        [np.array(header, dtype=np.int64), *(record.reshape(-1).astype(np.int64) for record in records)]
    )
    return Arrays(whole, real, place)


def _numbers(mechanism: Mechanism, place: Integers) -> tuple[Floats, ...]:
    """What a mechanism is made of, in the order of _NUMBERS; no row is soft."""
    rate = np.zeros(mechanism.row_count)
    rate[place] = mechanism.rate
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies) + 1)
    rolls = [form_of(joint.rolling)[1] for joint in mechanism.joints if isinstance(joint, Roll)]
    ground = np.zeros(3)
    return (
        np.append(1 / mechanism.inertias, ground),
        np.array(mechanism.gravity, dtype=float),
        np.array([_parameters(joint, PARAMETERS) for joint in mechanism.joints], dtype=float).reshape(-1),
        rate,
        unit,
        unit / mechanism.time_scale,
        np.array(rolls, dtype=float).reshape(len(rolls) * 2 * CONSTANTS),
        *(np.zeros_like(rate),) * 4,
        np.array([_parameters(force, FORCE_PARAMETERS) for force in mechanism.forces], dtype=float).reshape(-1),
        np.array(_summand_parameters(mechanism), dtype=float).reshape(-1),
        np.append(mechanism.pose, ground),
        np.append(mechanism.twist, ground),
    )


def _dependent(mechanism: Mechanism) -> bool:
    """Whether some rows follow from others at the start: two wheels on one axle, a parallelogram's third crank.

    Not asked where it would take seconds: the factorisation itself finds dependent rows.
    """
    rows = mechanism.row_count
    if rows > 3 * len(mechanism.bodies):
        return True
    if rows == 0 or rows > MOST_ROWS:
        return False
    return rank(mechanism.rows(mechanism.pose), mechanism.length_scale) < rows


# The numbers of a joint and of a force after its two points, by their fields; "" is zero.
_FIELDS: dict[type, tuple[str, ...]] = {
    **{Slot: ("line_angle",), Skate: ("angle",), Rod: ("length",), Weld: ("angle",)},
    **{Drive: ("", "turning_rate", "offset"), Gear: ("", "ratio", "phase")},
    **{Spring: ("stiffness", "rest_length"), Damper: ("damping",), Torque: ("torque",)},
    **{TorsionSpring: ("stiffness", "rest_angle"), TorsionDamper: ("damping",)},
}


def _parameters(member: Joint | ForceElement, count: int) -> tuple[float, ...]:
    """The numbers of a joint or a force (count,): points on both bodies, then those of its fields."""
    if isinstance(member, Roll | Coupling):
        return (0.0,) * count
    if isinstance(member, CoupledForce):
        return (member.force, member.stiffness, member.damping, member.rest, 0.0, 0.0)
    points = (*getattr(member, "first_point", (0.0, 0.0)), *getattr(member, "second_point", (0.0, 0.0)))
    own = _FIELDS.get(type(member), ())
    numbers = member.force if isinstance(member, Force) else [getattr(member, name) if name else 0.0 for name in own]
    return (*points, *numbers, *(0.0,) * (count - 4 - len(numbers)))


def _places(ends: Integers, size: Integers, bodies: int) -> Integers:
    """(joints,) where the first row of every joint stands, such that joints on one body are near each other."""
    count = len(ends)
    if not count:
        return np.zeros(0, dtype=np.int64)
    member, joint = ends.reshape(-1), np.repeat(np.arange(count), 2)
    moving = member < bodies
    on = coo_array((np.ones(moving.sum()), (joint[moving], member[moving])), shape=(count, bodies)).tocsr()
    order = reverse_cuthill_mckee((on @ on.T).tocsr(), symmetric_mode=True)
    begin = np.empty(count, dtype=np.int64)
    begin[order] = np.cumsum(size[order]) - size[order]
    return begin


def _coupled_rows(mechanism: Mechanism, place: Integers) -> list[tuple[Coupling, int]]:
    """The couplings, and where their rows stand in the row system."""
    begin = np.cumsum([0, *(joint.size for joint in mechanism.joints)])
    numbered = zip(mechanism.joints, begin[:-1], strict=True)
    return [(joint, int(place[row])) for joint, row in numbered if isinstance(joint, Coupling)]


def _moved(terms: tuple[Term, ...], index: Mapping[str | None, int]) -> list[int]:
    """The bodies that a sum of terms depends on, without the ground."""
    return list(dict.fromkeys(index[name] for term in terms for name in (term.first, term.second) if name is not None))


def _two_ends(mechanism: Mechanism, index: Mapping[str | None, int], place: Integers) -> dict[int, tuple[int, int]]:
    """The first two bodies of each coupling's row, the ground for a lacking one."""
    ends = {row: (*_moved(joint.terms, index), *[index[None]] * 2) for joint, row in _coupled_rows(mechanism, place)}
    return {row: (bodies[0], bodies[1]) for row, bodies in ends.items()}


def _summands(mechanism: Mechanism, index: Mapping[str | None, int], place: Integers) -> tuple[Integers, Integers]:
    """Records of all terms, those of couplings first, and of further ends (row, body, end)."""
    coupled = _coupled_rows(mechanism, place)
    own = [_moved(joint.terms, index) for joint, _ in coupled]
    count = sum(max(0, len(bodies) - 2) for bodies in own)
    begin = 6 * len(place)
    nowhere = begin + 3 * count  # what the ground's end is written to
    extras, out = list[tuple[int, int, int]](), list[tuple[int, ...]]()
    for (joint, row), bodies in zip(coupled, own, strict=True):
        ends = {bodies[k]: 6 * row + 3 * k for k in range(min(2, len(bodies)))}
        for body in bodies[2:]:
            ends[body] = begin + 3 * len(extras)
            extras.append((row, body, ends[body]))
        for term in joint.terms:
            pair = index[term.first], index[term.second]
            out.append((row, *(3 * body for body in pair), *(ends.get(body, nowhere) for body in pair), term.sliding))
    for force in mechanism.forces:
        if isinstance(force, CoupledForce):
            out += [(-1, 3 * index[t.first], 3 * index[t.second], 0, 0, t.sliding) for t in force.terms]
    return _records(out, SUMMAND), _records(extras, EXTRA)


def _records(rows: Sequence[tuple[int, ...]], width: int) -> Integers:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


def _summand_parameters(mechanism: Mechanism) -> list[tuple[float, ...]]:
    """In the order of `_summands`."""
    held = [joint for joint in mechanism.joints if isinstance(joint, Coupling)]
    pulling = [force for force in mechanism.forces if isinstance(force, CoupledForce)]
    offsets = [offset for joint in held for offset in (joint.offset, *(0.0,) * (len(joint.terms) - 1))]
    terms = [term for each in (*held, *pulling) for term in each.terms]
    offsets += [0.0] * (len(terms) - len(offsets))
    return [
        (term.factor, *term.first_point, *term.second_point, term.line_angle, offset)
        for term, offset in zip(terms, offsets, strict=True)
    ]


def _forced(mechanism: Mechanism, index: Mapping[str | None, int]) -> Integers:
    begin = sum(len(joint.terms) for joint in mechanism.joints if isinstance(joint, Coupling))
    out: list[tuple[int, ...]] = []
    for force in mechanism.forces:
        if isinstance(force, CoupledForce):
            out.append((COUPLED, begin, len(force.terms)))
            begin += len(force.terms)
        else:
            out.append((FORCE_KINDS[type(force)], 3 * index[force.first], 3 * index[force.second]))
    return _records(out, FORCED)


def _products(bodies: Integers, extras: Integers, count: int) -> tuple[Integers, Integers, Integers]:
    """Of rows between these bodies (rows, 2), `count` of which move: first columns, where rows begin, and TERMs.

    extras (n, EXTRA): further ends of rows.
    """
    ends: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for row, pair in enumerate(bodies.tolist()):
        for side, body in enumerate(pair):
            if body < count:
                ends[body].append((row, 6 * row + 3 * side))
    for row, body, end in extras.tolist():
        ends[body].append((row, end))
    for own in ends:
        own.sort()
    start = np.arange(len(bodies))
    for own in ends:
        for row, _ in own:
            start[row] = min(start[row], own[0][0])
    offset = np.append(0, np.cumsum(np.arange(len(bodies)) - start + 1))
    terms = [
        (offset[row] + column - start[row], end, other, 3 * body)
        for body, own in enumerate(ends)
        for i, (row, end) in enumerate(own)
        for column, other in own[: i + 1]
    ]
    return start, offset, np.array(terms, dtype=np.int64).reshape(-1, TERM)


def form_of(rolling: Rolling) -> tuple[int, tuple[float, ...]]:
    """(the form, its constants) of a pair: see `rows.py` in the folder `compiled` for what each stands for."""
    try:
        fast = rolled(rolling)
    except (ValueError, ArithmeticError):  # curves that can't touch everywhere around the start
        return NOT_TABULATED, _constants(())
    match fast:
        case RoundOnLine():
            return ON_LINE, _constants(fast.constants)
        case RoundOnRound():
            return ON_ROUND, _constants(fast.constants)
        case Table() if not fast.exact_only:
            return TABLE, _constants((fast.width,))
    return NOT_TABULATED, _constants(())


def _constants(values: tuple[complex, ...]) -> tuple[float, ...]:
    """Complex numbers as two each, real ones too, filled up with zeros."""
    parts = [part for value in values for part in (complex(value).real, complex(value).imag)]
    return tuple(parts + [0.0] * (2 * CONSTANTS - len(parts)))
