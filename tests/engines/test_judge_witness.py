"""A witness beside the judge: random mechanisms in the coordinates of a spanning tree, by scipy's DOP853 and Radau.

It shares no code with `engines.lagrange`, nor with the rows that the judge takes from the mechanism: from that it reads
names and numbers. A body hangs on an earlier one by a pin, a slot or a weld, whose coordinates are an angle, an angle
and a distance, or none; a body that hangs on nothing has three. The other joints are cut, and held by multipliers.
Velocities are those of points of rigid bodies, as in chapter 18; derivatives are complex steps through them. Rolling
contacts are left out: there the scenes' closed forms are the witness.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engines.lagrange import HELD, TRUTH
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.scales import time_scale
from reports.gate.judge import in_numpy, stepped
from reports.search.mechanisms import mechanism as random_mechanism
from reports.search.parts import EVERY

H = 1e-30  # of a complex step
MOST_ASKED = {"DOP853": 3_000, "Radau": 30_000}  # accelerations; others take 500, and 16,000
GROUND = (np.zeros(3), np.zeros(3))
KINDS = tuple(kind for kind in EVERY if kind != "roll")


def arm(angle: Any, point: Any) -> Any:
    """A point of a body's frame, turned into the world [m]."""
    return np.array(
        [np.cos(angle) * point[0] - np.sin(angle) * point[1], np.sin(angle) * point[0] + np.cos(angle) * point[1]]
    )


def place(body: Any, point: Any) -> Any:
    return body[0][:2] + arm(body[0][2], point)


def moving(body: Any, at: Any) -> Any:
    """The velocity [m/s] of a body's material at a place of the world."""
    x, y = at - body[0][:2]
    return body[1][:2] + body[1][2] * np.array([-y, x])


def slip(part: Any, first: Any, second: Any) -> Any:
    """How fast a joint's rows, or the ends of a force element, move against each other (rows,)."""
    match part:
        case Pin() | Weld():
            points = moving(second, place(second, part.second_point)) - moving(first, place(first, part.first_point))
            return np.array([*points, second[1][2] - first[1][2]]) if isinstance(part, Weld) else points
        case Drive() | Torque() | TorsionSpring() | TorsionDamper():
            return np.array([second[1][2] - first[1][2]])
        case Gear():
            return np.array([second[1][2] - part.ratio * first[1][2]])
        case Slot() | Skate():
            line = first[0][2] + part.line_angle if isinstance(part, Slot) else second[0][2] + part.angle
            at = place(second, part.second_point)
            return np.array([(moving(second, at) - moving(first, at)) @ np.array([-np.sin(line), np.cos(line)])])
        case Rod() | Spring() | Damper():
            ends = place(first, part.first_point), place(second, part.second_point)
            along = (ends[1] - ends[0]) / np.sqrt(np.sum((ends[1] - ends[0]) ** 2))
            return np.array([(moving(second, ends[1]) - moving(first, ends[0])) @ along])
        case Force():
            return np.array([moving(second, place(second, part.second_point)) @ np.array(part.force)])
    raise TypeError(part)


def pull(force: Any, first: Any, second: Any) -> Any:
    """What a force element does along its `slip`."""
    match force:
        case Spring():
            apart = place(second, force.second_point) - place(first, force.first_point)
            return force.stiffness * (force.rest_length - np.sqrt(np.sum(apart**2)))
        case TorsionSpring():
            return force.stiffness * (force.rest_angle - second[0][2] + first[0][2])
        case Damper() | TorsionDamper():
            return -force.damping * slip(force, first, second)[0]
        case Torque():
            return force.torque
    return 1.0


class Tree:
    """A mechanism's bodies on their spanning tree, and the joints that are cut."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.index = {body.name: number for number, body in enumerate(mechanism.bodies)}
        self.hung: list[tuple[int, Any, int]] = []  # body, joint or None, first coordinate
        self.start: list[float] = []
        cut, waiting = list(mechanism.joints), set(range(len(mechanism.bodies)))
        bodies = [(np.array(body.pose), np.array(body.twist)) for body in mechanism.bodies]
        while waiting:
            joint = next((each for each in cut if self._hangs(each, waiting)), None)
            body = self.index[self._lower(joint, waiting)] if joint else min(waiting)
            waiting.discard(body)
            cut = [each for each in cut if each is not joint]
            self.hung.append((body, joint, len(self.start) // 2))
            pose, twist = bodies[body]
            match joint:
                case None:
                    self.start += [v for pair in zip(pose, twist, strict=True) for v in pair]
                case Pin():
                    self.start += [pose[2], twist[2]]
                case Slot():
                    parent = self.of(bodies, joint.first)
                    line = parent[0][2] + joint.line_angle
                    along, at = np.array([np.cos(line), np.sin(line)]), place(bodies[body], joint.second_point)
                    speed = (moving(bodies[body], at) - moving(parent, at)) @ along
                    self.start += [(at - place(parent, joint.first_point)) @ along, speed, pose[2], twist[2]]
        self.cut = tuple(cut)

    def of(self, bodies: Any, name: str | None) -> Any:
        return GROUND if name is None else bodies[self.index[name]]

    def _lower(self, joint: Any, waiting: set[int]) -> str:
        """The body that hangs by a joint on one that stands already."""
        return joint.second if joint.second is not None and self.index[joint.second] in waiting else joint.first

    def _hangs(self, joint: Any, waiting: set[int]) -> bool:
        free = [name is not None and self.index[name] in waiting for name in (joint.first, joint.second)]
        return free == [False, True] if isinstance(joint, Slot) else sum(free) == 1 and isinstance(joint, Pin | Weld)

    def bodies(self, q: Any, v: Any) -> list[Any]:
        """Pose and twist of every body from the coordinates and their rates."""
        out: list[Any] = [None] * len(self.index)
        for body, joint, i in self.hung:
            if joint is None:
                out[body] = (q[i : i + 3], v[i : i + 3])
                continue
            downward = joint.second is not None and self.index[joint.second] == body
            parent = self.of(out, joint.first if downward else joint.second)
            on_parent, own = (
                (joint.first_point, joint.second_point) if downward else (joint.second_point, joint.first_point)
            )
            at = place(parent, on_parent)
            match joint:
                case Pin():
                    angle, rate, speed = q[i], v[i], moving(parent, at)
                case Weld():
                    sign = 1 if downward else -1
                    angle, rate, speed = parent[0][2] + sign * joint.angle, parent[1][2], moving(parent, at)
                case _:
                    line = parent[0][2] + joint.line_angle
                    along = np.array([np.cos(line), np.sin(line)])
                    at = at + q[i] * along
                    angle, rate, speed = q[i + 1], v[i + 1], moving(parent, at) + v[i] * along
            x, y = arm(angle, own)
            pose = np.array([at[0] - x, at[1] - y, angle])
            out[body] = (pose, np.array([speed[0] + rate * y, speed[1] - rate * x, rate]))
        return out

    def slips(self, bodies: Any, parts: Any) -> Any:
        return np.concatenate(
            [np.zeros(0), *(slip(part, self.of(bodies, part.first), self.of(bodies, part.second)) for part in parts)]
        )

    def acceleration(self, q: Any, v: Any) -> tuple[Any, Any]:
        """Accelerations of the coordinates, and of the bodies (bodies, 3)."""
        mechanism, n = self.mechanism, len(q)
        now, units = self.bodies(q, v), [self.bodies(q, unit) for unit in np.eye(n)]
        later = self.bodies(q + 1j * H * v, v.astype(complex))
        ways = np.array([[twist for _, twist in bodies] for bodies in units]).reshape(n, -1).T
        rest = np.imag([twist for _, twist in later]).reshape(-1) / H  # of the bodies, with none of q's
        mass = np.array([[body.mass, body.mass, body.inertia] for body in mechanism.bodies]).reshape(-1)
        load = mass * np.tile([*mechanism.gravity, 0.0], len(mechanism.bodies)) - mass * rest
        right = ways.T @ load
        for force in mechanism.forces:
            strength = pull(force, self.of(now, force.first), self.of(now, force.second))
            right = right + strength * np.array([self.slips(bodies, [force])[0] for bodies in units])
        rows = np.array([self.slips(bodies, self.cut) for bodies in units]).T.reshape(-1, n)
        bias = -self.slips(later, self.cut).imag / H
        whole = np.block([[ways.T @ (mass[:, None] * ways), -rows.T], [rows, np.zeros((len(rows), len(rows)))]])
        found = np.linalg.solve(whole, np.concatenate([right, bias]))[:n] if n else np.zeros(0)
        return found, (ways @ found + rest).reshape(-1, 3)

    def motion(self, t: Any, method: str = "DOP853", tolerance: float = 1e-13) -> tuple[Any, Any, Any]:
        """Poses, twists and accelerations (times, bodies, 3); fewer times where the method gives up.

        Raises ArithmeticError where it asks for more than MOST_ASKED accelerations: rounding is above its tolerance.
        """
        asked = 0

        def rates(_: float, state: Any) -> Any:
            nonlocal asked
            asked += 1
            if asked > MOST_ASKED[method]:
                raise ArithmeticError("the witness does not come to its end")
            return np.concatenate([state[1::2], self.acceleration(state[::2], state[1::2])[0]])[order]

        n = len(self.start) // 2
        order = np.arange(2 * n).reshape(2, n).T.reshape(-1)
        done = solve_ivp(rates, (0.0, t[-1]), self.start, method, t, rtol=tolerance, atol=tolerance / 10)
        states = [(y[::2], y[1::2]) for y in done.y.T]
        bodies = [self.bodies(*state) for state in states]
        pose, twist = (np.array([[body[which] for body in each] for each in bodies]) for which in (0, 1))
        return pose, twist, np.array([self.acceleration(*state)[1] for state in states])


def wrenches(tree: Tree, pose: Any, twist: Any, reaction: Any) -> Any:
    """What reactions (rows,) and force elements do to the bodies (bodies, 3), by their virtual power."""
    mechanism, out = tree.mechanism, np.zeros_like(pose)
    now = list(zip(pose, twist, strict=True))
    for index in np.ndindex(pose.shape):
        unit = np.zeros_like(pose)
        unit[index] = 1.0
        bodies = list(zip(pose, unit, strict=True))
        power = reaction @ tree.slips(bodies, mechanism.joints)
        for force in mechanism.forces:
            strength = pull(force, tree.of(now, force.first), tree.of(now, force.second))
            power += strength * tree.slips(bodies, [force])[0]
        out[index] = power
    return out


PULLING = (Spring, Damper, TorsionSpring, TorsionDamper)
SAMPLES, SPAN, EVERY_STEP = 2, 0.4, 40  # and parts of the mechanism's own time scale
CASES = (0, 2, 4, 5, 6, 7, 8, 9, 10, 13)  # every kind of joint and force, trees and cut loops


@pytest.mark.parametrize("number", CASES)
def test_the_judge_moves_random_mechanisms_as_equations_in_the_coordinates_of_a_tree_do(number: int) -> None:
    mechanism = random_mechanism(31, number, KINDS)
    tree, spacing = Tree(mechanism), SPAN * mechanism.time_scale / SAMPLES
    pose, twist, acceleration = tree.motion(np.arange(SAMPLES + 1) * spacing)
    coarse = stepped(mechanism, SAMPLES, spacing, 4, EVERY_STEP)
    size = np.array([1.0, 1.0, mechanism.length_scale])
    unit = np.abs(pose - mechanism.pose).max() + mechanism.length_scale
    for judge in (stepped, in_numpy):
        fine = judge(mechanism, SAMPLES, spacing, 4, 2 * EVERY_STEP)
        # Half the step leaves a fifteenth of the change at fourth order; a third leaves room for the next power.
        for name, expected, scale in (("pose", pose, 1.0), ("twist", twist, mechanism.time_scale)):
            left = np.abs((getattr(fine, name) - getattr(coarse, name)) * size).max() / 3
            apart = np.abs((getattr(fine, name) - expected) * size).max()
            assert scale * apart < scale * left + 1e-10 * unit, name
        mass, fall = mechanism.inertias, np.array([*mechanism.gravity, 0.0])
        for sample in range(SAMPLES + 1):
            carried = wrenches(tree, pose[sample], twist[sample], fine.reaction[sample])
            needed = mass * (acceleration[sample] - fall)
            most = np.abs(needed).max() + np.abs(mass * fall).max() + np.abs(fine.reaction[sample]).max()
            assert np.abs(carried - needed).max() < 1e-9 * most


class Compared(NamedTuple):
    """In radians and parts of the mechanism's length, velocities in its time: by how much judge and witness are
    `apart`, and the witness from itself at another tolerance; NaN where one of them stops. `resolved`: whether the
    judge claims to hold HELD.
    """

    number: int
    resolved: bool
    apart: float
    doubt: float


def witnessed(mechanism: Mechanism, t: Any, method: str, tolerance: float) -> tuple[Any, Any]:
    """Poses and twists of the witness; none where it does not come to its end."""
    try:
        return Tree(mechanism).motion(t, method, tolerance)[:2]
    except ArithmeticError:
        return np.zeros((0, 0, 3)), np.zeros((0, 0, 3))


def compared(number: int, mechanism: Mechanism, span: float, method: str, tolerances: tuple[float, float]) -> Compared:
    """Over a `span` [s], by the witness's method at two tolerances, the tighter one last."""
    t = np.linspace(0.0, span, SAMPLES + 1)
    with np.errstate(all="ignore"):
        judge = TRUTH.build(mechanism, t[1])(SAMPLES, 1)
        loose, tight = (witnessed(mechanism, t, method, tolerance) for tolerance in tolerances)
    size = mechanism.pose_unit

    def apart(one: Any, other: Any) -> float:
        if not len(one[0]) == len(other[0]) == len(t):
            return np.nan
        places, rates = (np.abs(mine - yours).max(axis=(0, 1)) / size for mine, yours in zip(one, other, strict=True))
        return float(np.maximum(places, mechanism.time_scale * rates).max())

    here = (judge.pose, judge.twist)
    return Compared(number, judge.unresolved_at is None, apart(here, tight), apart(loose, tight))


SEED = 291528136  # the first eight digits of a commit's hash, so that nobody chose it
STIFF_CASES = (59, 114, 237, 411)  # 10 to 3,204 times faster than gravity and their start, and cheap


def held(found: list[Compared]) -> list[Compared]:
    """Those that can be compared: the judge claims them, and the witness knows them better than the claim."""
    both = [one for one in found if one.resolved and one.doubt < HELD]
    wrong = [one for one in both if not one.apart < HELD + one.doubt]
    assert wrong == [], f"{len(wrong)} of {len(found)}"
    return both


def test_the_judge_holds_what_it_claims_in_random_mechanisms() -> None:
    drawn = [(number, random_mechanism(SEED, number, KINDS)) for number in range(24)]
    found = [compared(number, own, SPAN * own.time_scale, "DOP853", (1e-12, 1e-13)) for number, own in drawn]
    assert len(held(found)) >= 23


def test_the_judge_holds_what_it_claims_of_a_stiff_mechanism_far_beyond_its_own_time() -> None:
    """Over SPAN of what it would take without springs and dampers."""
    found = []
    for number in STIFF_CASES:
        own = random_mechanism(SEED, number, KINDS)
        slow = time_scale(own.length_scale, own.gravity, own.bodies, own.joints)
        assert slow > 10 * own.time_scale
        found.append(compared(number, own, SPAN * slow, "Radau", (1e-9, 1e-11)))
    assert len(held(found)) == len(STIFF_CASES)


def test_the_mechanisms_have_every_kind_and_trees_with_cut_loops() -> None:
    drawn = [random_mechanism(31, number, KINDS) for number in CASES]
    parts = {type(part) for mechanism in drawn for part in (*mechanism.joints, *mechanism.forces)}
    assert parts == {Pin, Slot, Skate, Drive, Rod, Gear, Weld} | {*PULLING, Torque, Force}
    trees = [Tree(mechanism) for mechanism in drawn]
    assert sum(len(tree.cut) > 0 for tree in trees) > 4
    assert {type(joint) for tree in trees for _, joint, _ in tree.hung} == {type(None), Pin, Slot, Weld}
