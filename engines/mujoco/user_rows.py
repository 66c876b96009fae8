"""Rows of ours in MuJoCo's solver: what they are, and how they are written in every stage of the integrator.

MuJoCo has no joint for a skate or for rolling, but its solver takes any row J a = right. A placeholder (an equality of
a tendon) reserves the row; `mjcb_control`, which runs after the references are computed and before the solve, in all
four stages of RK4 (mj_forwardSkip in MuJoCo's engine_forward.c), overwrites its part of `efc_J` and `efc_aref`. It
needs the dense Jacobian, no islands, and a primal solver (Newton or CG): the dual one has built its matrix from the
placeholder by then.

`write_rows` goes from the tree's coordinates to the bodies, evaluates the law of each joint, and transforms its row
back to the coordinates. It is plain arithmetic on MuJoCo's own arrays, which numba compiles where it is installed;
otherwise Python does the same on lists. Only where rolling puts a body is looked up before, in Python.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.construction import Building, Callback, WrittenJoint
from engines.tree import Tree

try:
    from numba import njit
except ImportError:
    njit = None

Array = NDArray[np.float64]
# x, y, angle, vx, vy, omega of a body [m, m, rad, and per s]; the ground's are all zero. Angles are never wrapped.
State = tuple[float, float, float, float, float, float]
# The first body's x, y, angle, the second body's, and the value of J a: -(dJ/dt) v and any stabilisation.
Row = tuple[float, float, float, float, float, float, float]

PLACEHOLDER = "written row {}"
LAWS = ("skate", "slot", "rod", "roll")
SKATE, SLOT, _, ROLL = range(len(LAWS))
# A plan is one array: how many links and joints there are, the first row in MuJoCo's arrays, how far ahead [s] of the
# present pose rows are asked for; then links, joints, and room for the links' motions. Of a link: its parent, the
# columns of its slides and its rotation (minus one for none), the body's start, and its arm, anchor and direction in
# the tree. Of a joint: its law, its two bodies, and what the law asks for.
HEADER, LINK, JOINT = 4, 13, 11
# Of a moving link: x, y, by how much it has turned, their rates, the acceleration of its centre of mass where no
# coordinate accelerates, the point about which its rotation turns it, the direction of its slide, and its angle.
MOVING, FREE = 13, -1


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    if njit is None:
        return function
    try:
        return njit(error_model="numpy", cache=True)(function)
    except RuntimeError:  # no folder that can be written to: each process compiles
        return njit(error_model="numpy")(function)


@_compiled
def skate_row(numbers: Any, first: State, second: State) -> Row:
    """Of a point on the second body [m], the blade's angle there [rad] and the damping of slip [1/s]."""
    point_x, point_y, blade, damping = numbers[0], numbers[1], numbers[2], numbers[3]
    x1, y1, _, vx1, vy1, omega1 = first
    x2, y2, angle, vx2, vy2, omega2 = second
    cosine, sine = math.cos(angle), math.sin(angle)
    own_x, own_y = cosine * point_x - sine * point_y, sine * point_x + cosine * point_y
    ahead_x, ahead_y = math.cos(angle + blade), math.sin(angle + blade)
    vx2, vy2 = vx2 - omega2 * own_y, vy2 + omega2 * own_x  # of the blade's point
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


@_compiled
def _points(numbers: Any, first: State, second: State) -> tuple[float, ...]:
    """Of a point on either body: its arms on both, in the world, and the second one's velocity beyond the first's."""
    _, _, angle1, vx1, vy1, omega1 = first
    _, _, angle2, vx2, vy2, omega2 = second
    cosine, sine = math.cos(angle1), math.sin(angle1)
    own_x1, own_y1 = cosine * numbers[0] - sine * numbers[1], sine * numbers[0] + cosine * numbers[1]
    cosine, sine = math.cos(angle2), math.sin(angle2)
    own_x2, own_y2 = cosine * numbers[2] - sine * numbers[3], sine * numbers[2] + cosine * numbers[3]
    rate_x = vx2 - omega2 * own_y2 - vx1 + omega1 * own_y1
    rate_y = vy2 + omega2 * own_x2 - vy1 - omega1 * own_x1
    return own_x1, own_y1, own_x2, own_y2, rate_x, rate_y


@_compiled
def slot_row(numbers: Any, first: State, second: State) -> Row:
    """Of a point on either body [m], the line's angle [rad], stiffness [1/s^2] and damping [1/s]."""
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


@_compiled
def rod_row(numbers: Any, first: State, second: State) -> Row:
    """Of a point on either body [m], the length [m], stiffness [1/s^2] and damping [1/s]."""
    own_x1, own_y1, own_x2, own_y2, rate_x, rate_y = _points(numbers, first, second)
    length, stiffness, damping = numbers[4], numbers[5], numbers[6]
    x, y = second[0] + own_x2 - first[0] - own_x1, second[1] + own_y2 - first[1] - own_y1
    now = math.sqrt(x * x + y * y)
    x, y = x / now, y / now
    slip, across = x * rate_x + y * rate_y, x * rate_y - y * rate_x
    square1, square2 = first[5] * first[5], second[5] * second[5]
    changing = x * (square1 * own_x1 - square2 * own_x2) + y * (square1 * own_y1 - square2 * own_y2)
    changing += across * across / now
    return (
        -x, -y, x * own_y1 - y * own_x1,
        x, y, y * own_x2 - x * own_y2,
        -changing - damping * slip - stiffness * (now - length),
    )  # fmt: skip


@_compiled
def roll_rows(numbers: Any, first: State, second: State) -> tuple[Row, Row]:
    """Of z_2 - z_1 - e^(i phi_1) P(phi_2 - phi_1) = 0, in x and in y: of stiffness, damping, and P, P', P''.

    The same two conditions as those of `reference.rolling.roll` along tangent and normal, in directions that rest.
    """
    stiffness, damping = numbers[0], numbers[1]
    x1, y1, angle1, vx1, vy1, omega1 = first
    x2, y2, _, vx2, vy2, omega2 = second
    way = complex(math.cos(angle1), math.sin(angle1))
    place, once = way * complex(numbers[2], numbers[3]), way * complex(numbers[4], numbers[5])
    twice = way * complex(numbers[6], numbers[7])
    carried = 1j * place - once  # d(e^(i phi_1) P) / d phi_1
    rate = omega2 - omega1
    changing = twice * (rate * rate) + 2j * omega1 * rate * once - omega1 * omega1 * place
    slip = complex(vx2 - vx1, vy2 - vy1) - carried * omega1 - once * omega2
    right = changing - damping * slip - stiffness * (complex(x2 - x1, y2 - y1) - place)
    return (
        (-1.0, 0.0, -carried.real, 1.0, 0.0, -once.real, right.real),
        (0.0, -1.0, -carried.imag, 0.0, 1.0, -once.imag, right.imag),
    )


@_compiled
def _move(plan: Any, at: int, moving: int, to: int, q: Any, v: Any) -> None:
    """Where the link at `at` is at q + ahead v, and how it moves, into `to`; its parent's motion is there already."""
    parent, slide, rotation, ahead = int(plan[at]), int(plan[at + 1]), int(plan[at + 3]), plan[3]
    turn, spin = (0.0, 0.0) if rotation < 0 else (q[rotation] + ahead * v[rotation], v[rotation])
    along, speed = (0.0, 0.0) if slide < 0 else (q[slide] + ahead * v[slide], v[slide])
    ax, ay, dx, dy = 0.0, 0.0, 0.0, 0.0
    if parent == FREE:
        across = int(plan[at + 2])
        x, y = plan[at + 4] + along, plan[at + 5] + q[across] + ahead * v[across]
        pivot_x, pivot_y, turned, vx, vy, omega = x, y, turn, speed, v[across], spin
    else:
        base = moving + MOVING * parent
        turned, omega = plan[base + 2], plan[base + 5]
        cosine, sine = math.cos(turned), math.sin(turned)
        dx, dy = cosine * plan[at + 11] - sine * plan[at + 12], sine * plan[at + 11] + cosine * plan[at + 12]
        arm_x = cosine * plan[at + 7] - sine * plan[at + 8] + along * dx
        arm_y = sine * plan[at + 7] + cosine * plan[at + 8] + along * dy
        coriolis, square = 2 * omega * speed, omega * omega
        vx, vy = plan[base + 3] + speed * dx - omega * arm_y, plan[base + 4] + speed * dy + omega * arm_x
        ax, ay = plan[base + 6] - coriolis * dy - square * arm_x, plan[base + 7] + coriolis * dx - square * arm_y
        pivot_x, pivot_y = plan[base] + arm_x, plan[base + 1] + arm_y
        turned, omega = turned + turn, omega + spin
        cosine, sine = math.cos(turned), math.sin(turned)
        own_x = cosine * plan[at + 9] - sine * plan[at + 10]
        own_y = sine * plan[at + 9] + cosine * plan[at + 10]
        square = omega * omega
        x, y, vx, vy = pivot_x - own_x, pivot_y - own_y, vx + omega * own_y, vy - omega * own_x
        ax, ay = ax + square * own_x, ay + square * own_y
    plan[to], plan[to + 1], plan[to + 2], plan[to + 3], plan[to + 4], plan[to + 5] = x, y, turned, vx, vy, omega
    plan[to + 6], plan[to + 7], plan[to + 8], plan[to + 9] = ax, ay, pivot_x, pivot_y
    plan[to + 10], plan[to + 11], plan[to + 12] = dx, dy, plan[at + 6] + turned


@_compiled
def _take(plan: Any, moving: int, ends: tuple[int, int], row: Row, jacobian: Any, line: int, width: int) -> float:
    """Write a row of two bodies as one of the tree's coordinates, from this place on; what J a is to be there."""
    links, right = int(plan[0]), row[6]
    for column in range(line, line + width):
        jacobian[column] = 0.0
    for end in range(2):
        own = ends[end]
        along_x, along_y, turning = row[3 * end], row[3 * end + 1], row[3 * end + 2]
        m = moving + MOVING * own
        x, y = plan[m], plan[m + 1]
        right -= along_x * plan[m + 6] + along_y * plan[m + 7]
        while FREE < own < links:  # the ground stands after the last
            at, m = HEADER + LINK * own, moving + MOVING * own
            own, slide, rotation = int(plan[at]), int(plan[at + 1]), int(plan[at + 3])
            if own == FREE:
                jacobian[line + slide] += along_x
                jacobian[line + int(plan[at + 2])] += along_y
            elif slide >= 0:
                jacobian[line + slide] += along_x * plan[m + 10] + along_y * plan[m + 11]
            if rotation >= 0:
                jacobian[line + rotation] += turning + along_y * (x - plan[m + 8]) - along_x * (y - plan[m + 9])
    return right


@_compiled
def write_rows(plan: Any, q: Any, v: Any, jacobian: Any, reference: Any) -> None:
    """Write all joints' rows into MuJoCo's arrays; NaN where one is no number, so that MuJoCo starts anew."""
    links, joints, first_row, width = int(plan[0]), int(plan[1]), int(plan[2]), len(v)
    all_joints = HEADER + LINK * links
    moving, row = all_joints + JOINT * joints, first_row
    if len(reference) <= first_row:
        return  # MuJoCo has no room for its rows, and says so
    for own in range(links):
        _move(plan, HEADER + LINK * own, moving, moving + MOVING * own, q, v)
    for at in range(all_joints, moving, JOINT):
        law, ends = int(plan[at]), (int(plan[at + 1]), int(plan[at + 2]))
        m, n = moving + MOVING * ends[0], moving + MOVING * ends[1]
        first = plan[m], plan[m + 1], plan[m + 12], plan[m + 3], plan[m + 4], plan[m + 5]
        second = plan[n], plan[n + 1], plan[n + 12], plan[n + 3], plan[n + 4], plan[n + 5]
        numbers = plan[at + 3 : at + JOINT]
        if law == ROLL:
            across, own_row = roll_rows(numbers, first, second)
            reference[row] = _take(plan, moving, ends, across, jacobian, row * width, width)
            row += 1
        elif law == SKATE:
            own_row = skate_row(numbers, first, second)
        elif law == SLOT:
            own_row = slot_row(numbers, first, second)
        else:
            own_row = rod_row(numbers, first, second)
        reference[row] = _take(plan, moving, ends, own_row, jacobian, row * width, width)
        row += 1
    total = 0.0
    for written in range(first_row, row):
        total += reference[written]
    if not math.isfinite(total):
        for place in range(first_row * width, row * width):
            jacobian[place] = 0.0
        for written in range(first_row, row):
            reference[written] = math.nan


class RowWriter:
    """Writes the rows of some joints, from `first_row` on, at the pose that the velocity leads to in `ahead` [s].

    `address`: where each coordinate of the tree stands in qpos and in qvel (width,).
    """

    def __init__(
        self, tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], first_row: int = 0, ahead: float = 0.0
    ) -> None:
        bodies, self.size = tree.mechanism.bodies, sum(joint.size for joint in joints)
        of_body = {link.body: own for own, link in enumerate(tree.links)}
        place = {None: len(tree.links)} | {bodies[body].name: own for body, own in of_body.items()}
        plan: list[float] = [len(tree.links), len(joints), first_row, ahead]
        for link in tree.links:
            columns = [float(address[column]) for column in link.columns]
            turning = columns.pop() if link.turns else -1.0
            slide, across, *_ = *columns, -1.0, -1.0
            parent = FREE if link.kind == "free" else place[None] if link.parent is None else of_body[link.parent]
            plan += [parent, slide, across, turning, *bodies[link.body].pose, *link.arm, *link.anchor, *link.direction]
        angle = {None: 0.0} | {body.name: body.pose[2] for body in bodies}
        rolls = []
        for joint in joints:
            if joint.rolled is not None:
                signs = [(address[column], sign) for column, sign in tree.turning(joint.first, joint.second).items()]
                rolls.append((len(plan) + 5, joint.rolled.place, angle[joint.second] - angle[joint.first], signs))
            plan += [LAWS.index(joint.law), place[joint.first], place[joint.second], *joint.numbers]
            plan += [0.0] * (JOINT - 3 - len(joint.numbers))
        self._plan = np.array([*plan, *[0.0] * (MOVING * (len(tree.links) + 1))])
        self._rolls = [(self._plan[at : at + 6].view(complex), *others) for at, *others in rolls]

    def write(self, q: Array, v: Array, jacobian: Array, reference: Array) -> None:
        """Write the rows at q + ahead v into efc_J and efc_aref."""
        for places, place_at, angle, turning in self._rolls:
            for column, sign in turning:
                angle += sign * q.item(column)
            places[0], places[1], places[2] = place_at(angle)
        if njit is not None:
            write_rows(self._plan, q, v, jacobian, reference)
            return
        # Python reads and writes lists faster than arrays.
        plan, own, right = self._plan.tolist(), [0.0] * (self.size * len(v)), [0.0] * self.size
        first_row, plan[2] = int(plan[2]), 0
        try:
            write_rows(plan, q.tolist(), v.tolist(), own, right)
        except (ValueError, OverflowError, ZeroDivisionError):  # of what numba makes an infinity or NaN
            own, right = [0.0] * len(own), [math.nan] * len(right)
        if len(reference):
            jacobian[first_row * len(v) :][: len(own)] = own
            reference[first_row:][: len(right)] = right

    def rows(self, q: Array, v: Array) -> tuple[Array, Array]:
        """J (rows, width) and J a (rows,) at q + ahead v, both (width,), of a writer from row 0 on."""
        jacobian, reference = np.zeros(self.size * len(v)), np.zeros(self.size)
        self.write(q, v, jacobian, reference)
        return jacobian.reshape(self.size, len(v)), reference


def add_placeholders(building: Building) -> None:
    """Reserve the joints' rows; to be called after every other equality, so that theirs come last.

    Tendons, because each has an inverse inertia of its own (`tendon_invweight0`) that can be written.
    """
    own = [building.chain(joint)[0] for joint in building.written for _ in range(joint.size)]
    for number, column in enumerate(own):
        name, impedance = PLACEHOLDER.format(number), list(building.stiffness.impedance)
        building.add_sum(name, {column: 1.0})
        tendon, kind = mujoco.mjtObj.mjOBJ_TENDON, mujoco.mjtEq.mjEQ_TENDON
        building.spec.add_equality(type=kind, objtype=tendon, name1=name, solimp=impedance)


def row_callback(
    compiled: Any, tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], softening: float
) -> Callback:
    """What writes the joints' rows, the model's last equalities, each as soft as its own inverse inertia says.

    The two of a joint are alike, by their mean: else how they give way would depend on the axes that they are along.
    """
    data = mujoco.MjData(compiled)
    mujoco.mj_fwdPosition(compiled, data)
    jacobian, _ = RowWriter(tree, address, joints).rows(data.qpos, data.qvel)
    moved = np.empty_like(jacobian)
    mujoco.mj_solveM(compiled, data, moved, jacobian)
    inverses, size = np.sum(jacobian * moved, axis=1), [joint.size for joint in joints]
    alike = np.repeat([part.mean() for part in np.split(inverses, np.cumsum(size)[:-1])], size)
    for number, inverse in enumerate(alike):
        compiled.tendon_invweight0[compiled.tendon(PLACEHOLDER.format(number)).id] = softening * inverse
    sizes = {int(mujoco.mjtEq.mjEQ_CONNECT): 3, int(mujoco.mjtEq.mjEQ_WELD): 6}
    first_row = sum(sizes.get(int(kind), 1) for kind in compiled.eq_type) - len(jacobian)
    write = RowWriter(tree, address, joints, first_row).write
    return lambda _model, data: write(data.qpos, data.qvel, data.efc_J, data.efc_aref)
