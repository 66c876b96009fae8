"""User rows: constraint rows that our code writes into MuJoCo's solver in every stage of the integrator.

MuJoCo has no joint for a skate or for rolling, but its solver accepts any row J a = right. An equality of a tendon
reserves the row, and the callback `mjcb_control` overwrites the row in `efc_J` and `efc_aref`. In all four stages of
RK4, MuJoCo calls the callback after it computes the reference accelerations and before the solver (mj_forwardSkip in
engine_forward.c). User rows need the dense Jacobian and no islands. User rows also need a primal solver (Newton or CG),
since the dual solver builds its matrix before the callback.

`write_rows` computes the motion of the bodies from the tree coordinates, evaluates the rows of each joint, and
transforms the rows to tree coordinates. Without numba, Python evaluates the same functions on lists. Before
`write_rows`, Python evaluates the positions of rolling bodies. All functions that numba compiles are in this file,
since numba's cache does not detect changes in other files.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.builder import PLACEHOLDER, Callback, UserRowJoint
from engines.tree import Tree

try:
    from numba import njit
except ImportError:
    njit = None

Array = NDArray[np.float64]
# x, y, angle, vx, vy, omega of a body [m, m, rad, and per s], with unwrapped angles; zero for the ground.
State = tuple[float, float, float, float, float, float]
# Factors of the accelerations (x, y, angle) of the first body and of the second body, and the value of J a.
Row = tuple[float, float, float, float, float, float, float]

ROW_KINDS = ("skate", "slot", "rod", "roll")
SKATE, SLOT, _, ROLL = range(len(ROW_KINDS))
# A plan is an array. The array contains a header, LINK numbers for each link, JOINT numbers for each joint, and MOTION
# numbers for each link and the ground. The following names are indices in these parts.
LINK_COUNT, JOINT_COUNT, FIRST_ROW, AHEAD, HEADER = range(5)  # AHEAD [s]: the pose is predicted for this time.
# SLIDE, ACROSS and ROTATION are columns, or -1. START_X, START_Y and START_ANGLE are the pose at t = 0.
PARENT, SLIDE, ACROSS, ROTATION, START_X, START_Y, START_ANGLE = range(7)
ARM_X, ARM_Y, ANCHOR_X, ANCHOR_Y, DIRECTION_X, DIRECTION_Y, LINK = range(7, 14)
KIND, FIRST, SECOND, NUMBERS, JOINT = 0, 1, 2, 3, 11
# TURNED is the rotation since t = 0, about PIVOT. AX and AY are accelerations for zero accelerations of the
# coordinates. ALONG is the direction of the slide.
X, Y, TURNED, VX, VY, OMEGA, AX, AY, PIVOT_X, PIVOT_Y, ALONG_X, ALONG_Y, ANGLE, MOTION = range(14)
NO_PARENT = -1  # parent index of a free link


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    if njit is None:
        return function
    try:
        return njit(error_model="numpy", cache=True)(function)
    except RuntimeError:  # the cache needs a writable folder
        return njit(error_model="numpy")(function)


@compiled
def _rotated(angle: float, x: float, y: float) -> tuple[float, float]:
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


@compiled
def skate_row(numbers: Any, first: State, second: State) -> Row:
    """The row of a skate; `numbers`: point [m] and angle [rad] in the second body, damping of slip [1/s]."""
    point_x, point_y, blade, damping = numbers[0], numbers[1], numbers[2], numbers[3]
    x1, y1, _, vx1, vy1, omega1 = first
    x2, y2, angle, vx2, vy2, omega2 = second
    own_x, own_y = _rotated(angle, point_x, point_y)
    ahead_x, ahead_y = math.cos(angle + blade), math.sin(angle + blade)
    vx2, vy2 = vx2 - omega2 * own_y, vy2 + omega2 * own_x  # velocity of the blade's point
    arm_x, arm_y = x2 + own_x - x1, y2 + own_y - y1
    rate_x, rate_y = vx2 - vx1 + omega1 * arm_y, vy2 - vy1 - omega1 * arm_x
    slip = ahead_x * rate_y - ahead_y * rate_x
    square = omega2 * omega2
    gain_x = omega1 * (vy2 - vy1) - square * own_x
    gain_y = -omega1 * (vx2 - vx1) - square * own_y
    changing = ahead_x * gain_y - ahead_y * gain_x - omega2 * (ahead_x * rate_x + ahead_y * rate_y)
    return (
        ahead_y, -ahead_x, -arm_y * ahead_y - arm_x * ahead_x,
        -ahead_y, ahead_x, own_x * ahead_x + own_y * ahead_y,
        -changing - damping * slip,
    )  # fmt: skip


@compiled
def _points(numbers: Any, first: State, second: State) -> tuple[float, ...]:
    """The arms of the two points in world directions, and the points' relative velocity."""
    _, _, angle1, vx1, vy1, omega1 = first
    _, _, angle2, vx2, vy2, omega2 = second
    own_x1, own_y1 = _rotated(angle1, numbers[0], numbers[1])
    own_x2, own_y2 = _rotated(angle2, numbers[2], numbers[3])
    rate_x = vx2 - omega2 * own_y2 - vx1 + omega1 * own_y1
    rate_y = vy2 + omega2 * own_x2 - vy1 - omega1 * own_x1
    return own_x1, own_y1, own_x2, own_y2, rate_x, rate_y


@compiled
def slot_row(numbers: Any, first: State, second: State) -> Row:
    """The row of a slot; `numbers`: two points [m], line angle [rad], stiffness [1/s^2], damping [1/s]."""
    own_x1, own_y1, own_x2, own_y2, rate_x, rate_y = _points(numbers, first, second)
    line, stiffness, damping = numbers[4], numbers[5], numbers[6]
    omega1, omega2 = first[5], second[5]
    along_x, along_y = math.cos(first[2] + line), math.sin(first[2] + line)
    arm_x, arm_y = second[0] + own_x2 - first[0], second[1] + own_y2 - first[1]
    across_x, across_y = arm_x - own_x1, arm_y - own_y1
    gap = along_x * across_y - along_y * across_x
    slip = along_x * rate_y - along_y * rate_x - omega1 * (along_x * across_x + along_y * across_y)
    square1, square2 = omega1 * omega1, omega2 * omega2
    moved_x, moved_y = square1 * own_x1 - square2 * own_x2, square1 * own_y1 - square2 * own_y2
    changing = along_x * moved_y - along_y * moved_x - square1 * gap
    changing -= 2 * omega1 * (along_x * rate_x + along_y * rate_y)
    return (
        along_y, -along_x, -along_x * arm_x - along_y * arm_y,
        -along_y, along_x, along_y * own_y2 + along_x * own_x2,
        -changing - damping * slip - stiffness * gap,
    )  # fmt: skip


@compiled
def rod_row(numbers: Any, first: State, second: State) -> Row:
    """The row of a rod; `numbers`: two points [m], length [m], stiffness [1/s^2], damping [1/s]."""
    own_x1, own_y1, own_x2, own_y2, rate_x, rate_y = _points(numbers, first, second)
    length, stiffness, damping = numbers[4], numbers[5], numbers[6]
    x, y = second[0] + own_x2 - first[0] - own_x1, second[1] + own_y2 - first[1] - own_y1
    distance = math.sqrt(x * x + y * y)
    x, y = x / distance, y / distance
    slip, across = x * rate_x + y * rate_y, x * rate_y - y * rate_x
    square1, square2 = first[5] * first[5], second[5] * second[5]
    changing = x * (square1 * own_x1 - square2 * own_x2) + y * (square1 * own_y1 - square2 * own_y2)
    changing += across * across / distance
    return (
        -x, -y, x * own_y1 - y * own_x1,
        x, y, y * own_x2 - x * own_y2,
        -changing - damping * slip - stiffness * (distance - length),
    )  # fmt: skip


@compiled
def roll_rows(numbers: Any, first: State, second: State) -> tuple[Row, Row]:
    """The rows in x and y of z_2 - z_1 - e^(i phi_1) P(phi_2 - phi_1) = 0.

    `numbers`: stiffness [1/s^2], damping [1/s], and P, P', P'' [m, m/rad, m/rad^2]. `reference.rolling.roll` has
    equivalent rows along the tangent and the normal.
    """
    stiffness, damping = numbers[0], numbers[1]
    x1, y1, angle1, vx1, vy1, omega1 = first
    x2, y2, _, vx2, vy2, omega2 = second
    heading = complex(math.cos(angle1), math.sin(angle1))
    place, once = heading * complex(numbers[2], numbers[3]), heading * complex(numbers[4], numbers[5])
    twice = heading * complex(numbers[6], numbers[7])
    carried = 1j * place - once  # d(e^(i phi_1) P) / d phi_1
    rate = omega2 - omega1
    changing = twice * (rate * rate) + 2j * omega1 * rate * once - omega1 * omega1 * place
    slip = complex(vx2 - vx1, vy2 - vy1) - carried * omega1 - once * omega2
    right = changing - damping * slip - stiffness * (complex(x2 - x1, y2 - y1) - place)
    return (
        (-1.0, 0.0, -carried.real, 1.0, 0.0, -once.real, right.real),
        (0.0, -1.0, -carried.imag, 0.0, 1.0, -once.imag, right.imag),
    )


@compiled
def _move(plan: Any, at: int, moving: int, to: int, q: Any, v: Any) -> None:
    """Write the motion of the link at index `at`, for coordinates q + ahead v, to index `to`. Parents come first."""
    parent, slide, rotation = int(plan[at + PARENT]), int(plan[at + SLIDE]), int(plan[at + ROTATION])
    ahead = plan[AHEAD]
    turn, spin = (0.0, 0.0) if rotation < 0 else (q[rotation] + ahead * v[rotation], v[rotation])
    shift, speed = (0.0, 0.0) if slide < 0 else (q[slide] + ahead * v[slide], v[slide])
    ax, ay, dx, dy = 0.0, 0.0, 0.0, 0.0
    if parent == NO_PARENT:
        across = int(plan[at + ACROSS])
        x, y = plan[at + START_X] + shift, plan[at + START_Y] + q[across] + ahead * v[across]
        pivot_x, pivot_y, turned, vx, vy, omega = x, y, turn, speed, v[across], spin
    else:
        m = moving + MOTION * parent
        turned, omega = plan[m + TURNED], plan[m + OMEGA]
        dx, dy = _rotated(turned, plan[at + DIRECTION_X], plan[at + DIRECTION_Y])
        arm_x, arm_y = _rotated(turned, plan[at + ARM_X], plan[at + ARM_Y])
        arm_x, arm_y = arm_x + shift * dx, arm_y + shift * dy
        coriolis, square = 2 * omega * speed, omega * omega
        vx, vy = plan[m + VX] + speed * dx - omega * arm_y, plan[m + VY] + speed * dy + omega * arm_x
        ax, ay = plan[m + AX] - coriolis * dy - square * arm_x, plan[m + AY] + coriolis * dx - square * arm_y
        pivot_x, pivot_y = plan[m + X] + arm_x, plan[m + Y] + arm_y
        turned, omega = turned + turn, omega + spin
        own_x, own_y = _rotated(turned, plan[at + ANCHOR_X], plan[at + ANCHOR_Y])
        square = omega * omega
        x, y, vx, vy = pivot_x - own_x, pivot_y - own_y, vx + omega * own_y, vy - omega * own_x
        ax, ay = ax + square * own_x, ay + square * own_y
    plan[to + X], plan[to + Y], plan[to + TURNED], plan[to + ANGLE] = x, y, turned, plan[at + START_ANGLE] + turned
    plan[to + VX], plan[to + VY], plan[to + OMEGA], plan[to + AX], plan[to + AY] = vx, vy, omega, ax, ay
    plan[to + PIVOT_X], plan[to + PIVOT_Y], plan[to + ALONG_X], plan[to + ALONG_Y] = pivot_x, pivot_y, dx, dy


@compiled
def _write_row(plan: Any, moving: int, ends: tuple[int, int], row: Row, jacobian: Any, line: int, width: int) -> float:
    """Write the row of a joint in tree coordinates from index `line` on, and return the value of J a."""
    links, right = int(plan[LINK_COUNT]), row[6]
    for column in range(line, line + width):
        jacobian[column] = 0.0
    for end in range(2):
        link = ends[end]
        row_x, row_y, row_angle = row[3 * end], row[3 * end + 1], row[3 * end + 2]
        m = moving + MOTION * link
        x, y = plan[m + X], plan[m + Y]
        right -= row_x * plan[m + AX] + row_y * plan[m + AY]
        while NO_PARENT < link < links:  # the index of the ground is `links`
            at, m = HEADER + LINK * link, moving + MOTION * link
            link, slide, rotation = int(plan[at + PARENT]), int(plan[at + SLIDE]), int(plan[at + ROTATION])
            if link == NO_PARENT:
                jacobian[line + slide] += row_x
                jacobian[line + int(plan[at + ACROSS])] += row_y
            elif slide >= 0:
                jacobian[line + slide] += row_x * plan[m + ALONG_X] + row_y * plan[m + ALONG_Y]
            if rotation >= 0:
                jacobian[line + rotation] += (
                    row_angle + row_y * (x - plan[m + PIVOT_X]) - row_x * (y - plan[m + PIVOT_Y])
                )
    return right


@compiled
def _state(plan: Any, m: int) -> State:
    return plan[m + X], plan[m + Y], plan[m + ANGLE], plan[m + VX], plan[m + VY], plan[m + OMEGA]


@compiled
def write_rows(plan: Any, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
    """Write the rows of all joints into MuJoCo's arrays; if a value is not finite, write NaN so that MuJoCo resets."""
    links, first_row, width = int(plan[LINK_COUNT]), int(plan[FIRST_ROW]), len(v)
    all_joints = HEADER + LINK * links
    moving, row = all_joints + JOINT * int(plan[JOINT_COUNT]), first_row
    if len(reference) <= first_row:
        return  # MuJoCo has no memory for the rows and has already warned
    for link in range(links):
        _move(plan, HEADER + LINK * link, moving, moving + MOTION * link, q, v)
    for at in range(all_joints, moving, JOINT):
        kind, ends = int(plan[at + KIND]), (int(plan[at + FIRST]), int(plan[at + SECOND]))
        first, second = _state(plan, moving + MOTION * ends[0]), _state(plan, moving + MOTION * ends[1])
        numbers = plan[at + NUMBERS : at + JOINT]
        if kind == ROLL:
            across, joint_row = roll_rows(numbers, first, second)
            reference[row] = _write_row(plan, moving, ends, across, jacobian, row * width, width)
            row += 1
        elif kind == SKATE:
            joint_row = skate_row(numbers, first, second)
        elif kind == SLOT:
            joint_row = slot_row(numbers, first, second)
        else:
            joint_row = rod_row(numbers, first, second)
        reference[row] = _write_row(plan, moving, ends, joint_row, jacobian, row * width, width)
        row += 1
    total = 0.0
    for written in range(first_row, row):
        total += reference[written]
    if not math.isfinite(total):
        for entry in range(first_row * width, row * width):
            jacobian[entry] = 0.0
        for written in range(first_row, row):
            reference[written] = math.nan


class RowWriter:
    """Writes the rows of joints from `first_row` on, at the pose that the velocity predicts after `ahead` [s].

    `address`: indices of the tree coordinates in qpos and qvel.
    """

    def __init__(
        self, tree: Tree, address: Sequence[int], joints: Sequence[UserRowJoint], first_row: int = 0, ahead: float = 0.0
    ) -> None:
        bodies, self.size = tree.mechanism.bodies, sum(joint.size for joint in joints)
        link_of = {link.body: number for number, link in enumerate(tree.links)}
        index = {None: len(tree.links)} | {bodies[body].name: number for body, number in link_of.items()}
        plan: list[float] = [len(tree.links), len(joints), first_row, ahead]
        for link in tree.links:
            columns = [float(address[column]) for column in link.columns]
            rotation = columns.pop() if link.turns else -1.0
            slide, across, *_ = *columns, -1.0, -1.0
            parent = NO_PARENT if link.kind == "free" else index[None] if link.parent is None else link_of[link.parent]
            plan += [parent, slide, across, rotation, *bodies[link.body].pose, *link.arm, *link.anchor, *link.direction]
        angle = {None: 0.0} | {body.name: body.pose[2] for body in bodies}
        rolls = []
        for joint in joints:
            if joint.rolled is not None:
                signs = [(address[column], sign) for column, sign in tree.turning(joint.first, joint.second).items()]
                rolls.append(
                    (len(plan) + NUMBERS + 2, joint.rolled.place, angle[joint.second] - angle[joint.first], signs)
                )
            plan += [ROW_KINDS.index(joint.kind), index[joint.first], index[joint.second], *joint.numbers]
            plan += [0.0] * (JOINT - NUMBERS - len(joint.numbers))
        self._plan = np.array([*plan, *[0.0] * (MOTION * (len(tree.links) + 1))])
        self._rolls = [(self._plan[at : at + 6].view(complex), *others) for at, *others in rolls]

    def write(self, q: Array, v: Array, jacobian: Array, reference: Array) -> None:
        """Write the rows for the coordinates q + ahead v into efc_J and efc_aref."""
        for places, place_at, angle, turning in self._rolls:
            for column, sign in turning:
                angle += sign * q.item(column)
            places[0], places[1], places[2] = place_at(angle)
        if njit is not None:
            write_rows(self._plan, q, v, jacobian, reference)
            return
        # In Python, lists are faster than arrays.
        plan, rows, right = self._plan.tolist(), [0.0] * (self.size * len(v)), [0.0] * self.size
        first_row, plan[FIRST_ROW] = int(plan[FIRST_ROW]), 0
        try:
            write_rows(plan, q.tolist(), v.tolist(), rows, right)
        except (ValueError, OverflowError, ZeroDivisionError):  # numba returns infinity or NaN instead
            rows, right = [0.0] * len(rows), [math.nan] * len(right)
        if len(reference):
            jacobian[first_row * len(v) :][: len(rows)] = rows
            reference[first_row:][: len(right)] = right

    def rows(self, q: Array, v: Array) -> tuple[Array, Array]:
        """J (rows, width) and J a (rows,) for the coordinates q + ahead v (width,). `first_row` must be 0."""
        jacobian, reference = np.zeros(self.size * len(v)), np.zeros(self.size)
        self.write(q, v, jacobian, reference)
        return jacobian.reshape(self.size, len(v)), reference


def row_callback(
    compiled: Any, tree: Tree, address: Sequence[int], joints: Sequence[UserRowJoint], softening: float
) -> Callback:
    """The callback that writes the rows of joints in place of the model's last equalities.

    The compliance of a row is `softening` times the inverse inertia. The two rows of a roll use the mean of the two
    inverse inertias, so that the compliance does not depend on the directions of the axes.
    """
    data = mujoco.MjData(compiled)
    mujoco.mj_fwdPosition(compiled, data)
    jacobian, _ = RowWriter(tree, address, joints).rows(data.qpos, data.qvel)
    moved = np.empty_like(jacobian)
    mujoco.mj_solveM(compiled, data, moved, jacobian)
    inverses, sizes = np.sum(jacobian * moved, axis=1), [joint.size for joint in joints]
    means = np.repeat([part.mean() for part in np.split(inverses, np.cumsum(sizes)[:-1])], sizes)
    for number, inverse in enumerate(means):
        compiled.tendon_invweight0[compiled.tendon(f"{PLACEHOLDER} {number}").id] = softening * inverse
    rows_of = {int(mujoco.mjtEq.mjEQ_CONNECT): 3, int(mujoco.mjtEq.mjEQ_WELD): 6}
    first_row = sum(rows_of.get(int(kind), 1) for kind in compiled.eq_type) - len(jacobian)
    write = RowWriter(tree, address, joints, first_row).write
    return lambda _model, data: write(data.qpos, data.qvel, data.efc_J, data.efc_aref)
