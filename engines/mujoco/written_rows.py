"""Constraint rows of one's own in MuJoCo: placeholders, rewritten before the solver in every stage of the integrator.

MuJoCo has no joint for a skate or for rolling, but its solver takes any row. A placeholder (an equality of a tendon)
reserves the row; `mjcb_control`, which runs after the references are computed and before the solve, in all four stages
of RK4 (mj_forwardSkip in MuJoCo's engine_forward.c), overwrites its part of `efc_J` and `efc_aref`. It needs the dense
Jacobian, no islands, and a primal solver (Newton or CG): the dual one has built its matrix from the placeholder by
then.

A row is written for the poses and twists of two bodies, J a = right, and is taken to the tree's coordinates here. Plain
floats throughout: on rows this small, arrays cost more than the arithmetic. Where numba is there, machine code does the
same (`engines.mujoco.row_callback`).
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from engines.mujoco.chain_motion import RESTING, ancestry, columns_of, kinematics
from engines.tree import Tree

# x, y, angle, vx, vy, omega of a body [m, m, rad, and per s]; the ground's are all zero. Angles are never wrapped.
State = tuple[float, float, float, float, float, float]
# The first body's x, y, angle, the second body's, and the value of J a: -(dJ/dt) v and any stabilisation.
Row = tuple[float, float, float, float, float, float, float]
GROUND: State = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

Rows = Callable[[float, list[float], list[float]], tuple[list[float], list[float]]]


@dataclass(frozen=True)
class Law:
    """What one row is at a time and for two bodies' states: `row(numbers, first, second)`, plain arithmetic.

    `engines.mujoco.native_rows` compiles the same function.
    """

    row: Callable[[Any, State, State], Row]
    numbers: tuple[float, ...]

    def __call__(self, _t: float, first: State, second: State) -> tuple[Row]:
        return (self.row(self.numbers, first, second),)


@dataclass(frozen=True)
class WrittenJoint:
    """A joint held by written rows: `rows(t, first, second)` gives `size` of them at time t [s], for bodies' states.

    `first` and `second` are indices of bodies, None for the ground.
    """

    first: int | None
    second: int | None
    size: int
    rows: Callable[[float, State, State], Sequence[Row]]


def add_placeholders(spec: Any, tree: Tree, joints: Sequence[WrittenJoint], impedance: Sequence[float]) -> None:
    """Reserve the joints' rows; to be called after every other equality, so that theirs come last.

    Tendons, because each has an inverse inertia of its own (`tendon_invweight0`) that `scale_placeholders` can write.
    """
    own = [chain(tree, joint)[0] for joint in joints for _ in range(joint.size)]
    for number, column in enumerate(own):
        name = _placeholder(number)
        spec.add_tendon(name=name).wrap_joint(f"coordinate {column}", 1.0)
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_TENDON,
            objtype=mujoco.mjtObj.mjOBJ_TENDON,
            name1=name,
            solimp=list(impedance),
        )


def scale_placeholders(compiled: Any, data: Any, rows: Rows, softening: float) -> None:
    """Make each row as soft as its own inverse inertia at the start says; the placeholder's knows nothing of it.

    `data`: a mujoco.MjData at the start, to work in.
    """
    mujoco.mj_fwdPosition(compiled, data)
    flat, reference = rows(0.0, data.qpos.tolist(), data.qvel.tolist())
    jacobian = np.array(flat).reshape(len(reference), compiled.nv)
    moved = np.empty_like(jacobian)
    mujoco.mj_solveM(compiled, data, moved, jacobian)
    for number, inverse in enumerate(np.sum(jacobian * moved, axis=1)):
        compiled.tendon_invweight0[compiled.tendon(_placeholder(number)).id] = softening * inverse


def _placeholder(number: int) -> str:
    return f"written row {number}"


def equality_rows(compiled: Any, before: int | None = None) -> int:
    """How many rows MuJoCo's solver has for the model's equalities, or for those `before` the one with this number."""
    sizes = {int(mujoco.mjtEq.mjEQ_CONNECT): 3, int(mujoco.mjtEq.mjEQ_WELD): 6}
    return sum(sizes.get(int(kind), 1) for kind in compiled.eq_type[:before])


def chain(tree: Tree, joint: WrittenJoint) -> list[int]:
    """The tree coordinates that can move the joint, ascending."""
    bodies = [body for body in (joint.first, joint.second) if body is not None]
    return sorted(column for index in ancestry(tree, bodies) for column in tree.links[index].columns)


def row_writer(tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], width: int) -> Rows:
    """The function (t, qpos, qvel) -> (efc_J flattened row by row, efc_aref) of the joints' rows.

    `address` is where each tree coordinate stands in qpos and in qvel, and `width` the length of qvel.
    """
    needed = ancestry(tree, [body for joint in joints for body in (joint.first, joint.second) if body is not None])
    place: dict[int | None, int] = {tree.links[index].body: own for own, index in enumerate(needed)}
    place[None] = -1  # the ground stands last, and rests
    steps = [kinematics(tree, index, address, place) for index in needed]
    bodies = tree.mechanism.pose.tolist()
    start = [RESTING] * (len(needed) + 1)
    plan = []
    for joint in joints:
        ends = []
        for body, offset in ((joint.first, 0), (joint.second, 3)):
            if body is not None:
                path = [place[tree.links[index].body] for index in ancestry(tree, [body])]
                ends.append((place[body], offset, path))
        plan.append((joint.rows, place[joint.first], place[joint.second], ends))
    columns = [columns_of(tree, index, address) for index in needed]
    angles = [bodies[tree.links[index].body][2] for index in needed]

    def rows(t: float, q: list[float], v: list[float]) -> tuple[list[float], list[float]]:
        moving = start.copy()
        for own, step in enumerate(steps):
            moving[own] = step(moving, q, v)
        states: list[State] = [
            (m[0], m[1], angle + m[2], m[3], m[4], m[5]) for m, angle in zip(moving, angles, strict=False)
        ]
        states.append(GROUND)
        jacobian: list[float] = []
        reference: list[float] = []
        for law, first, second, ends in plan:
            for row in law(t, states[first], states[second]):
                line = [0.0] * width
                right = row[6]
                for end, offset, path in ends:
                    along_x, along_y, turning = row[offset], row[offset + 1], row[offset + 2]
                    at = moving[end]
                    x, y = at[0], at[1]
                    right -= along_x * at[6] + along_y * at[7]
                    for own in path:
                        slide_x, slide_y, slide, rotation = columns[own]
                        m = moving[own]
                        if slide_x is not None:
                            line[slide_x] += along_x
                            line[slide_y] += along_y
                        elif slide is not None:
                            line[slide] += along_x * m[10] + along_y * m[11]
                        if rotation is not None:
                            line[rotation] += turning + along_y * (x - m[8]) - along_x * (y - m[9])
                jacobian += line
                reference.append(right)
        return jacobian, reference

    return rows


def writing(rows: Rows, first_row: int, width: int) -> Callable[[Any, Any], None]:
    """The callback for `mjcb_control` that writes the rows from `first_row` on into a model of `width` velocities."""
    begin = first_row * width

    def write(_model: Any, data: Any) -> None:
        try:
            jacobian, reference = rows(data.time, data.qpos.tolist(), data.qvel.tolist())
        except (ValueError, OverflowError, ZeroDivisionError):
            # A motion that has blown up: MuJoCo finds accelerations that aren't numbers, and resets itself.
            data.efc_aref[first_row:] = math.nan
            return
        data.efc_J[begin : begin + len(jacobian)] = jacobian
        data.efc_aref[first_row : first_row + len(reference)] = reference

    return write


def writing_free(
    tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], first_row: int, width: int
) -> Callable[[Any, Any], None] | None:
    """The same for free bodies on the ground, in half of the time: three numbers a row; None if there are others.

    What the placeholder has in a row stands in one of these three columns, so that all of the row is overwritten.
    """
    links = {link.body: link for link in tree.links}
    plan, row = [], first_row
    for joint in joints:
        link = None if joint.second is None else links[joint.second]
        if joint.first is not None or link is None or link.kind != "free":
            return None
        columns = [address[column] for column in link.columns]
        plan.append((joint.rows, row, *columns, *tree.mechanism.bodies[link.body].pose))
        row += joint.size

    def write(_model: Any, data: Any) -> None:
        q, v = data.qpos.tolist(), data.qvel.tolist()
        jacobian, reference = data.efc_J, data.efc_aref
        try:
            for law, row, x, y, turn, start_x, start_y, start in plan:
                state = (start_x + q[x], start_y + q[y], start + q[turn], v[x], v[y], v[turn])
                for own in law(data.time, GROUND, state):
                    begin = row * width
                    jacobian[begin + x] = own[3]
                    jacobian[begin + y] = own[4]
                    jacobian[begin + turn] = own[5]
                    reference[row] = own[6]
                    row += 1
        except (ValueError, OverflowError, ZeroDivisionError):
            reference[first_row:] = math.nan  # see `writing`

    return write


@contextmanager
def installed(
    control: Callable[[Any, Any], None] | None, passive: Callable[[Any, Any], None] | None = None
) -> Iterator[None]:
    """Callbacks in place, MuJoCo's global ones as they were afterwards, whatever happens.

    One that has a form in machine code, `native`, is called in that form.
    """
    before = mujoco.get_mjcb_control(), mujoco.get_mjcb_passive()
    mujoco.set_mjcb_control(getattr(control, "native", control))
    mujoco.set_mjcb_passive(passive)
    try:
        yield
    finally:
        mujoco.set_mjcb_control(before[0])
        mujoco.set_mjcb_passive(before[1])
