"""Comparison of the judge with an independent solution, the witness, in random mechanisms.

The witness shares no code with `engines.lagrange` or `Mechanism.rows`, and integrates Newton's law with multipliers by
scipy. A row contains the relative velocities of two points for a unit rate of each coordinate, as in chapter 18. The
derivative of a row is computed by a complex step. Other tests check rolling contacts.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engines.lagrange import JUDGE_CLAIM, TRUTH
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.scales import time_scale
from reports.gate.judge import in_numpy, stepped
from reports.search.mechanisms import mechanism as random_mechanism
from reports.search.parts import ALL_KINDS

H = 1e-30  # Size of a complex step.
MOST_EVALUATIONS = {"DOP853": 3_000, "Radau": 60_000}  # Resolved motions need 500 and 30,000 evaluations.
WITNESSED_KINDS = tuple(kind for kind in ALL_KINDS if kind != "roll")


class BodyState(NamedTuple):
    """The position, angle and velocities of a body, as numbers or arrays."""

    x: Any
    y: Any
    angle: Any
    vx: Any
    vy: Any
    omega: Any


GROUND = BodyState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def at(body: BodyState, point: Any) -> tuple[Any, Any]:
    """The position [m] of a point of a body, in the frame of the world."""
    c, s = np.cos(body.angle), np.sin(body.angle)
    return body.x + c * point[0] - s * point[1], body.y + s * point[0] + c * point[1]


def moving(body: BodyState, place: tuple[Any, Any]) -> tuple[Any, Any]:
    """The velocity [m/s] of the material point of a body that is at a position in the frame of the world."""
    return body.vx - body.omega * (place[1] - body.y), body.vy + body.omega * (place[0] - body.x)


def slip(part: Any, first: BodyState, second: BodyState) -> list[Any]:
    """The relative velocity in each row of a joint, or between the ends of a force element."""
    turning = second.omega - first.omega
    match part:
        case Drive() | Torque() | TorsionSpring() | TorsionDamper():
            return [turning]
        case Gear():
            return [second.omega - part.ratio * first.omega]
        case Slot() | Skate():
            line = first.angle + part.line_angle if isinstance(part, Slot) else second.angle + part.angle
            ends = (at(second, part.second_point),) * 2
        case Force():
            vx, vy = moving(second, at(second, part.second_point))
            return [vx * part.force[0] + vy * part.force[1]]
        case _:
            line, ends = 0.0, (at(first, part.first_point), at(second, part.second_point))
    (ax, ay), (bx, by) = moving(first, ends[0]), moving(second, ends[1])
    vx, vy = bx - ax, by - ay
    match part:
        case Pin():
            return [vx, vy]
        case Weld():
            return [vx, vy, turning]
        case Slot() | Skate():
            return [np.cos(line) * vy - np.sin(line) * vx]
        case Rod() | Spring() | Damper():
            x, y = ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]
            return [(x * vx + y * vy) / np.sqrt(x * x + y * y)]
        case _:
            raise TypeError(part)


def pull(force: Any, first: BodyState, second: BodyState) -> Any:
    """The force or torque of a force element in the direction of its `slip`."""
    match force:
        case Spring():
            (ax, ay), (bx, by) = at(first, force.first_point), at(second, force.second_point)
            return force.stiffness * (force.rest_length - np.hypot(bx - ax, by - ay))
        case TorsionSpring():
            return force.stiffness * (force.rest_angle - second.angle + first.angle)
        case Damper() | TorsionDamper():
            return -force.damping * slip(force, first, second)[0]
        case Torque():
            return force.torque
        case Force():
            return 1.0
        case _:
            raise TypeError(force)


class Witness:
    """The equations of motion of one mechanism: M a = f + J^T r and J a = -(dJ/dt) v."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        index = {body.name: number for number, body in enumerate(mechanism.bodies)} | {None: -1}
        elements = (*mechanism.joints, *mechanism.forces)
        self.ends = {element.name: (index[element.first], index[element.second]) for element in elements}
        self.mass = np.array([[body.mass, body.mass, body.inertia] for body in mechanism.bodies]).reshape(-1)
        self.units = np.eye(len(self.mass)).reshape(-1, 3, len(self.mass))

    def between(self, pose: Any, twist: Any, element: Any) -> tuple[BodyState, BodyState]:
        """The states of the two bodies of a joint or force element.

        pose: (bodies, 3). twist: (bodies, 3), or (bodies, 3, n) for n motions at the same pose.
        """
        first, second = (GROUND if i < 0 else BodyState(*pose[i], *twist[i]) for i in self.ends[element.name])
        return first, second

    def rows(self, pose: Any) -> Any:
        """The Jacobian J (rows, coordinates). A column contains the slips of all joints for one unit velocity."""
        slips = [s for joint in self.mechanism.joints for s in slip(joint, *self.between(pose, self.units, joint))]
        return np.array([np.broadcast_to(s, len(self.mass)) for s in slips]).reshape(-1, len(self.mass))

    def solved(self, pose: Any, twist: Any) -> tuple[Any, Any]:
        """Accelerations (bodies, 3) and reactions (rows,)."""
        mechanism, n, rows = self.mechanism, len(self.mass), self.rows(pose)
        load = self.mass * np.tile([*mechanism.gravity, 0.0], len(mechanism.bodies))
        for force in mechanism.forces:
            strength = pull(force, *self.between(pose, twist, force))
            load = load + strength * slip(force, *self.between(pose, self.units, force))[0]
        later = pose + 1j * H * twist
        bias = [-np.imag(s) / H for joint in mechanism.joints for s in slip(joint, *self.between(later, twist, joint))]
        kkt = np.block([[np.diag(self.mass), -rows.T], [rows, np.zeros((len(rows), len(rows)))]])
        solution = np.linalg.solve(kkt, np.concatenate([load, bias]))
        return solution[:n].reshape(-1, 3), solution[n:]

    def motion(self, t: Any, method: str = "DOP853", tolerance: float = 1e-13) -> tuple[Any, Any]:
        """Poses and twists (times, bodies, 3), with fewer times if the integrator fails.

        Raises ArithmeticError after MOST_EVALUATIONS evaluations, since rounding then exceeds the tolerance.
        """
        evaluations = 0

        def rates(_: float, state: Any) -> Any:
            nonlocal evaluations
            evaluations += 1
            if evaluations > MOST_EVALUATIONS[method]:
                raise ArithmeticError("the witness needs too many evaluations")
            pose, twist = state.reshape(2, -1, 3)
            return np.concatenate([state[state.size // 2 :], self.solved(pose, twist)[0].reshape(-1)])

        start = np.concatenate([self.mechanism.pose.reshape(-1), self.mechanism.twist.reshape(-1)])
        done = solve_ivp(rates, (0.0, t[-1]), start, method, t, rtol=tolerance, atol=tolerance / 10)
        pose, twist = done.y.T.reshape(len(done.t), 2, -1, 3).swapaxes(0, 1)
        return pose, twist


WITNESS_SAMPLES, JUDGE_STEPS = 2, 40
WITNESS_SPAN = 0.4  # Duration of a motion in units of the mechanism's time scale.
WITNESSED_NUMBERS = (0, 2, 4, 5, 6, 7, 8, 9, 10, 13)  # These mechanisms have every kind of joint and force element.


@pytest.mark.parametrize("number", WITNESSED_NUMBERS)
def test_the_judge_agrees_with_newtons_law_in_random_mechanisms(number: int) -> None:
    mechanism = random_mechanism(31, number, WITNESSED_KINDS)
    witness, spacing = Witness(mechanism), WITNESS_SPAN * mechanism.time_scale / WITNESS_SAMPLES
    pose, twist = witness.motion(np.arange(WITNESS_SAMPLES + 1) * spacing)
    coarse = stepped(mechanism, WITNESS_SAMPLES, spacing, 4, JUDGE_STEPS)
    size = np.array([1.0, 1.0, mechanism.length_scale])
    unit = np.abs(pose - mechanism.pose).max() + mechanism.length_scale
    for judge in (stepped, in_numpy):
        fine = judge(mechanism, WITNESS_SAMPLES, spacing, 4, 2 * JUDGE_STEPS)
        # At order 4 the error at half the step is 1/15 of the change. The factor 1/3 allows for the next power.
        for name, expected, scale in (("pose", pose, 1.0), ("twist", twist, mechanism.time_scale)):
            allowed = np.abs((getattr(fine, name) - getattr(coarse, name)) * size).max() / 3
            error = np.abs((getattr(fine, name) - expected) * size).max()
            assert scale * error < scale * allowed + 1e-10 * unit, name
        for sample in range(WITNESS_SAMPLES + 1):
            acceleration, reaction = witness.solved(pose[sample], twist[sample])
            pushed = witness.rows(pose[sample]).T @ (fine.reaction[sample] - reaction)
            needed = np.abs(witness.mass * acceleration.reshape(-1)).max()
            weight = max(body.mass for body in mechanism.bodies) * np.max(np.abs(mechanism.gravity))
            most = needed + weight + np.abs(reaction).max()
            assert np.abs(pushed).max() < 1e-9 * most


class WitnessedCase(NamedTuple):
    """The comparison of a motion, in rad and in units of the mechanism. A difference is NaN if a motion ends early.

    resolved: whether the judge claims an error of at most JUDGE_CLAIM.
    difference: largest difference between judge and witness.
    doubt: largest difference between witnesses at two tolerances.
    """

    number: int
    resolved: bool
    difference: float
    doubt: float


def witnessed(mechanism: Mechanism, t: Any, method: str, tolerance: float) -> tuple[Any, Any]:
    """Poses and twists of the witness. The arrays are empty if the witness fails."""
    try:
        return Witness(mechanism).motion(t, method, tolerance)
    except ArithmeticError:
        return np.zeros((0, 0, 3)), np.zeros((0, 0, 3))


def compared(
    number: int, mechanism: Mechanism, span: float, method: str, tolerances: tuple[float, float]
) -> WitnessedCase:
    """The comparison of judge and witness over a duration `span` [s]. The last tolerance is the smallest."""
    t = np.linspace(0.0, span, WITNESS_SAMPLES + 1)
    with np.errstate(all="ignore"):
        judge = TRUTH.build(mechanism, t[1])(WITNESS_SAMPLES, 1)
        loose, tight = (witnessed(mechanism, t, method, tolerance) for tolerance in tolerances)
    size = mechanism.pose_unit

    def difference(first: Any, second: Any) -> float:
        if not len(first[0]) == len(second[0]) == len(t):
            return np.nan
        poses, rates = (np.abs(a - b).max(axis=(0, 1)) / size for a, b in zip(first, second, strict=True))
        return float(np.maximum(poses, mechanism.time_scale * rates).max())

    is_resolved = judge.unresolved_at is None
    return WitnessedCase(number, is_resolved, difference((judge.pose, judge.twist), tight), difference(loose, tight))


WITNESS_SEED = 291528136  # The seed follows from the hash of a commit, so nobody has selected it.
STIFF_NUMBERS = (59, 114, 237, 411)  # Springs make these mechanisms 10 to 3204 times faster.


def confirmed(cases: list[WitnessedCase]) -> list[WitnessedCase]:
    """Assert that the judge is correct in all cases where it claims an error and the witness is accurate enough.

    Return these cases.
    """
    comparable = [case for case in cases if case.resolved and case.doubt < JUDGE_CLAIM]
    wrong = [case for case in comparable if not case.difference < JUDGE_CLAIM + case.doubt]
    assert wrong == [], f"{len(wrong)} of {len(cases)}"
    return comparable


def test_the_judges_error_is_within_its_claim_in_random_mechanisms() -> None:
    mechanisms = [random_mechanism(WITNESS_SEED, number, WITNESSED_KINDS) for number in range(24)]
    spans = [WITNESS_SPAN * mechanism.time_scale for mechanism in mechanisms]
    cases = [compared(i, mechanisms[i], spans[i], "DOP853", (1e-12, 1e-13)) for i in range(24)]
    assert len(confirmed(cases)) >= 23


def test_the_judges_error_is_within_its_claim_in_stiff_mechanisms() -> None:
    # The duration is WITNESS_SPAN times the time scale of the mechanism without springs and dampers.
    cases = []
    for number in STIFF_NUMBERS:
        mechanism = random_mechanism(WITNESS_SEED, number, WITNESSED_KINDS)
        slow = time_scale(mechanism.length_scale, mechanism.gravity, mechanism.bodies, mechanism.joints)
        assert slow > 10 * mechanism.time_scale
        cases.append(compared(number, mechanism, WITNESS_SPAN * slow, "Radau", (1e-9, 1e-11)))
    assert len(confirmed(cases)) == len(STIFF_NUMBERS)


def test_the_witnessed_mechanisms_have_all_kinds_of_joints_and_forces() -> None:
    mechanisms = [random_mechanism(31, number, WITNESSED_KINDS) for number in WITNESSED_NUMBERS]
    parts = {type(part) for mechanism in mechanisms for part in (*mechanism.joints, *mechanism.forces)}
    forces = {Spring, Damper, TorsionSpring, TorsionDamper, Torque, Force}
    assert parts == {Pin, Slot, Skate, Drive, Rod, Gear, Weld} | forces
