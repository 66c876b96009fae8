"""The ideal motion of a model, its accuracy, and errors of runs relative to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from engines import Unsupported
from engines.lagrange import TRUTH, Lagrange
from engines.lagrange.dynamics import Dynamics, constrained_acceleration
from engines.reading import Reading, RowRegularisation, left_out
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.rows import undetermined
from reference.trajectory import Trajectory, energy
from reports.check.one_freedom import has_one_freedom, motion_along_curve

Array = NDArray[np.float64]
DIVERGED = 1e12  # m, rad, m/s or rad/s: a state with a larger component has diverged.
SOFT_TOLERANCE = 1e-10  # Relative; well below the truncation error of an engine and well above rounding.


def accelerations(
    mechanism: Mechanism, pose: Array, twist: Array, t: float, give: RowRegularisation | None = None
) -> Array:
    """Accelerations (bodies, 3) [m/s^2, rad/s^2]; the joints are ideal, or soft with the regularisation `give`.

    Soft rows: J a = bias - damping slip - stiffness gap - compliance F, with `give.initial_bias` in place of the bias.
    """
    if give is None or not mechanism.row_count:
        return constrained_acceleration(mechanism, pose, twist)[0]
    bias = mechanism.bias(pose, twist)
    slip = mechanism.rows(pose) @ twist.reshape(-1) - mechanism.rate
    gap = np.nan_to_num(mechanism.joint_rows.gap(pose, np.asarray(t)))
    target = np.where(np.isnan(give.initial_bias), bias, give.initial_bias) - give.damping * slip - give.stiffness * gap
    return constrained_acceleration(mechanism, pose, twist, target, give.compliance)[0]


def soft_motion(
    mechanism: Mechanism,
    give: Callable[[Array, Array], RowRegularisation],
    t: Array,
    tolerance: float = SOFT_TOLERANCE,
    twist: Array | None = None,
) -> Array:
    """Poses (times, bodies, 3) of soft joints; NaN after the time at which the integration fails.

    give(gap, pose): the regularisation of the rows. twist (bodies, 3): initial velocities, the mechanism's if None.
    LSODA integrates, since the equations are stiff.
    """
    count = mechanism.pose.size
    lengths = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    allowed = tolerance * np.concatenate([lengths, lengths / mechanism.time_scale])

    def rates(at: float, state: Array) -> Array:
        if not np.abs(state).max() < DIVERGED:  # NaN makes LSODA repeat the step with a smaller size
            return np.full_like(state, np.nan)
        pose, twist = state[:count].reshape(-1, 3), state[count:].reshape(-1, 3)
        gap = np.nan_to_num(mechanism.joint_rows.gap(pose, np.asarray(at)))
        change = accelerations(mechanism, pose, twist, at, give(gap, pose))
        return np.concatenate([state[count:], change.reshape(-1)])

    start = np.concatenate([mechanism.pose.reshape(-1), (mechanism.twist if twist is None else twist).reshape(-1)])
    solution: Any = solve_ivp(rates, (0.0, float(t[-1])), start, "LSODA", t_eval=t, rtol=tolerance, atol=allowed)
    out = np.full((len(t), *mechanism.pose.shape), np.nan)
    out[: solution.y.shape[1]] = solution.y[:count].T.reshape(-1, *mechanism.pose.shape)
    return out


LOOSER_JUDGE = Lagrange(tolerance=1e-10)  # Its difference from the reference motion estimates the error of that motion.
JUDGE_SHARE = 0.1  # Largest estimated error of the reference motion, relative to the user's tolerance.
ALONG_CURVE_TOLERANCE = 1e-12  # Relative error of a step along the curve of one freedom.
LOOSER_CURVE_TOLERANCE = 1e-11  # Of a second run along the curve, whose difference estimates the error.
DISTURBANCE = 1e-7  # Relative to length and speed: its growth is linear, and it is well above the judge's error.
LINEAR_LIMIT = 1e-2  # Relative to length and speed: a larger disturbance does not grow linearly.
DISTURBANCES = ((1, DISTURBANCE), (2, DISTURBANCE / 10))  # (seed, size): chaos is reported if both grow exponentially.
REMAINING_SHARE = 1e-3  # Of a disturbance: if the projection onto the joints leaves less, the joints do not allow it.
# A disturbance of a regular motion grows about linearly in time. Growth by this factor more counts as exponential.
EXPONENTIAL_GROWTH = 100.0


@dataclass(frozen=True, eq=False)
class IdealMotion:
    """The ideal motion and its sensitivity to the initial state."""

    trajectory: Trajectory
    looser: Trajectory  # The same motion with a larger tolerance; the difference estimates the error.
    growth: Array  # (times,) growth factor of a small disturbance of the initial state.
    horizon: float  # s; two small disturbances grow exponentially after this time; the duration if they do not.
    cut: bool = False  # Whether the motion ends early, since the estimated error becomes too large.

    @property
    def grown(self) -> float:
        return float(self.growth[-1])

    @property
    def tenfold(self) -> float:
        """Mean time [s] in which a small disturbance grows tenfold; infinite if it does not grow."""
        small = self.growth * DISTURBANCE < LINEAR_LIMIT
        last = len(small) - 1 if small.all() else max(int(np.argmin(small)) - 1, 0)
        tens = float(np.log10(max(self.growth[last], 1.0)))
        return float(self.trajectory.t[last]) / tens if tens > 0 else float("inf")


def reference_motion(mechanism: Mechanism, samples: int, spacing: float, tolerance: float = np.inf) -> IdealMotion:
    """The motion of ideal joints, truncated where its estimated error exceeds JUDGE_SHARE of the tolerance.

    Raises InvalidMechanism if the integration fails, or if already the first sample after the start is inaccurate.
    """

    def by_multipliers(other: Mechanism) -> Trajectory:
        return TRUTH.build(other, spacing)(samples, 1)

    run: Callable[[Mechanism], Trajectory] = by_multipliers
    motion, looser = run(mechanism), None
    accurate = _is_accurate(mechanism, motion, tolerance)
    if not accurate.all() and has_one_freedom(mechanism):
        along, beside = (
            motion_along_curve(mechanism, motion.t, size) for size in (ALONG_CURVE_TOLERANCE, LOOSER_CURVE_TOLERANCE)
        )
        along = replace(along, estimate=np.abs(along.pose - beside.pose))
        accurate_along = _is_accurate(mechanism, along, tolerance)
        if accurate_along.all():
            motion, looser, accurate = along, beside, accurate_along
            run = partial(motion_along_curve, t=motion.t, tolerance=ALONG_CURVE_TOLERANCE)
    sound = np.isfinite(motion.pose).all(axis=(1, 2))
    if not sound.all():
        raise InvalidMechanism(
            f"the ideal motion can't be followed beyond {motion.t[int(np.argmin(sound))]:.4g} s: the joints are in a "
            f"singular position or the forces grow without bound; give a shorter --duration"
        )
    if not accurate.all():
        if (last := int(np.argmin(accurate)) - 1) < 1:
            raise InvalidMechanism(
                f"the judge does not know the ideal motion to a tenth of the tolerance {tolerance:g} beyond "
                f"{motion.t[max(last, 0)]:.4g} s: the joints are near a singular position; give a larger --tolerance"
            )
        return replace(reference_motion(mechanism, last, spacing), cut=True)
    looser = looser or LOOSER_JUDGE.build(mechanism, spacing)(samples, 1)
    growths = [_growth(mechanism, motion, looser, run, *disturbance) for disturbance in DISTURBANCES]
    expected = EXPONENTIAL_GROWTH * (1 + motion.t / mechanism.time_scale)
    begins = [
        _first_exponential(growth, expected, size) for growth, (_, size) in zip(growths, DISTURBANCES, strict=True)
    ]
    parts = all(begin < len(motion.t) for begin in begins) and not has_one_freedom(mechanism)
    horizon = float(motion.t[min(begins) if parts else -1])
    return IdealMotion(motion, looser, np.max(growths, axis=0), horizon)


def _is_accurate(mechanism: Mechanism, motion: Trajectory, tolerance: float) -> NDArray[np.bool_]:
    """Whether the estimated error and the gaps of the joints are below JUDGE_SHARE of the tolerance (times,)."""
    off = pose_distance(mechanism, motion.pose + np.asarray(motion.estimate), motion.pose)
    if mechanism.row_count:
        gap = np.abs(np.nan_to_num(mechanism.joint_rows.gap(motion.pose, motion.t)))
        off = np.maximum(off, (gap / np.where(mechanism.is_angular, 1.0, mechanism.length_scale)).max(axis=1))
    return off < JUDGE_SHARE * tolerance


def _first_exponential(growth: Array, expected: Array, size: float) -> int:
    """Index of the first sample at which a disturbance exceeds the expected growth; the number of samples if none.

    Growth that has receded by the end counts only if the disturbance exceeded LINEAR_LIMIT meanwhile.
    """
    beyond = growth > expected
    stays = beyond[-1] or np.any(beyond & (growth * size > LINEAR_LIMIT))
    return int(np.argmax(beyond)) if stays else len(beyond)


def pose_distance(mechanism: Mechanism, pose: Array, other: Array) -> Array:
    """Largest difference (times,) of two poses (times, bodies, 3): of angles [rad] and of positions / length."""
    difference = np.abs(pose - other)
    places = np.hypot(difference[..., 0], difference[..., 1]) / mechanism.length_scale
    return np.maximum(places, difference[..., 2]).max(axis=1)


def _growth(
    mechanism: Mechanism,
    motion: Trajectory,
    looser: Trajectory,
    run: Callable[[Mechanism], Trajectory],
    seed: int,
    nudge: float,
) -> Array:
    """Growth factor (times,) of a random initial disturbance; 1 where the reference's own error could explain it."""
    dynamics, random = Dynamics(mechanism), np.random.default_rng(seed)
    unit = mechanism.pose_unit
    none = np.ones(len(motion.t))
    pose = mechanism.pose + nudge * unit * random.uniform(-1, 1, mechanism.pose.shape)
    twist = mechanism.twist + nudge / mechanism.time_scale * unit * random.uniform(-1, 1, mechanism.twist.shape)
    pose, twist = dynamics.project(pose, twist, 0.0)
    if not (np.isfinite(pose).all() and np.isfinite(twist).all()):
        return none
    states = zip(mechanism.bodies, pose.tolist(), twist.tolist(), strict=True)
    bodies = tuple(replace(body, pose=tuple(at), twist=tuple(rate)) for body, at, rate in states)
    try:
        disturbed = run(replace(mechanism, bodies=bodies))
    except InvalidMechanism:  # the disturbed mechanism can't be assembled or integrated
        return none

    def size(other: Trajectory) -> Array:
        moved, faster = other.pose - motion.pose, mechanism.time_scale * (other.twist - motion.twist)
        return np.sqrt(np.sum((moved / unit) ** 2 + (faster / unit) ** 2, axis=(1, 2)))

    apart_by = np.nan_to_num(size(disturbed), nan=np.inf)
    if not apart_by[0] > REMAINING_SHARE * nudge:
        return none
    # Near a singular position the error of the reference motion grows too; it does not count as a disturbance.
    return np.where(apart_by > size(looser), apart_by, apart_by[0]) / apart_by[0]


START_AGREEMENT = 1e-6  # Relative to the largest acceleration; it allows for rounding with badly scaled masses.
# Accuracy of the reference motion, relative to the mechanism's speed and largest force; smaller values count as zero.
ZERO_SHARE = 1e-9
ERROR_UNITS = {"angle": "rad", "position": "m", "reaction": "of the largest", "energy": "of the largest kinetic"}


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of a run at its samples (times,); NaN after the run has diverged, and for values that are not compared."""

    t: Array
    of: dict[str, Array]  # Keys of ERROR_UNITS -> (times,).
    whole: Array  # `pose_distance` from the ideal motion; its maximum is compared with the tolerance.
    finished: bool

    @property
    def largest(self) -> float:
        """The largest `whole`; infinite for a run that gave up."""
        return float(np.nanmax(self.whole)) if self.finished else float("inf")

    @property
    def worst(self) -> dict[str, float]:
        return {name: float(np.fmax.reduce(values)) for name, values in self.of.items()}

    @property
    def over_time(self) -> dict[str, list[float]]:
        return {"t": self.t.tolist(), **{name: values.tolist() for name, values in self.of.items()}}


def measure_errors(mechanism: Mechanism, truth: Trajectory, run: Trajectory, jumps: bool = False) -> Errors:
    """Errors of a run at the samples of the reference motion.

    jumps: the run starts with velocities that its joints do not allow. The ideal motion changes them by an impulse at
    t = 0, but a run needs one or more steps. So forces and energy at the first two samples are not compared.
    """
    difference = run.pose - truth.pose
    angle = np.abs(difference[..., 2]).max(axis=1)
    position = np.hypot(difference[..., 0], difference[..., 1]).max(axis=1)
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1))
    span = float(kinetic.max())
    fast = mechanism.length_scale / mechanism.time_scale
    # A mechanism that is at rest except for rounding has no kinetic energy to which a loss could be related.
    moves = span > 0.5 * float(mechanism.inertias[:, 0].max()) * (ZERO_SHARE * fast) ** 2
    drift = np.abs(energy(mechanism, run) - energy(mechanism, truth)) / span if moves else np.full_like(angle, np.nan)
    reaction = _reaction(mechanism, truth, run)
    if jumps:
        reaction[:2], drift[:2] = np.nan, np.nan
    of = {"angle": angle, "position": position, "reaction": reaction, "energy": drift}
    finished = bool(np.isfinite(run.pose).all())
    return Errors(run.t, of, pose_distance(mechanism, run.pose, truth.pose), finished)


def _reaction(mechanism: Mechanism, truth: Trajectory, run: Trajectory) -> Array:
    """The largest relative error (times,) of the unique joint reactions; NaN where the run has none.

    Forces and moments are two kinds, each relative to its largest ideal reaction, or to the largest acting force (times
    the length for moments) if all ideal reactions of the kind are rounding. The force of a joint is compared as a
    vector, so that the error does not depend on the axes.
    """
    out = np.full(len(run.t), np.nan)
    if not mechanism.row_count:
        return out
    determined = ~undetermined(mechanism.rows(mechanism.pose), mechanism.length_scale)
    turning, length = mechanism.is_angular, mechanism.length_scale
    joint_of_row = np.repeat(np.arange(len(mechanism.joints)), [joint.size for joint in mechanism.joints])
    acting = mechanism.inertias * mechanism.unconstrained(truth.pose, truth.twist)
    forces = [acting[..., :2], acting[..., 2] / length]
    forces += [truth.reaction[:, determined] / np.where(turning[determined], length, 1.0)]
    largest_force = max(float(np.abs(force).max()) for force in forces if force.size)
    for of_kind, arm in ((turning & determined, length), (~turning & determined, 1.0)):
        rows = [np.flatnonzero(of_kind & (joint_of_row == joint)) for joint in np.unique(joint_of_row[of_kind])]
        if not rows:
            continue
        scale = max(float(np.linalg.norm(truth.reaction[:, row], axis=1).max()) for row in rows)
        scale = scale if scale > ZERO_SHARE * largest_force * arm else largest_force * arm
        if scale > 0:
            off = [np.linalg.norm(run.reaction[:, row] - truth.reaction[:, row], axis=1) / scale for row in rows]
            # fmax ignores NaN, the force of a joint that the engine does not report, such as a prescribed crank.
            out = np.fmax(out, np.fmax.reduce(off, axis=0))
    return out


@dataclass(frozen=True)
class Opening:
    """The largest constraint violation: row, gap [m or rad] and time [s]."""

    row: str
    gap: float
    unit: str
    t: float


def find_opening(mechanism: Mechanism, run: Trajectory) -> Opening | None:
    """The largest constraint violation of a run; None without constraints."""
    if not mechanism.row_count:
        return None
    gap = np.abs(mechanism.gap(run.pose, run.t))
    scaled = np.nan_to_num(np.where(mechanism.is_angular, gap, gap / mechanism.length_scale))
    sample, row = np.unravel_index(int(np.argmax(scaled)), scaled.shape)
    unit = "rad" if mechanism.is_angular[row] else "m"
    return Opening(mechanism.row_names[row], float(gap[sample, row]), unit, float(run.t[sample]))


def refuse_disagreement(reading: Reading) -> float:
    """Relative difference of the accelerations at t = 0 between the engine and the judge.

    The judge includes the engine's declared softness. Raises Unsupported if the difference exceeds START_AGREEMENT; the
    message names an element of the model if removing it restores agreement.
    """
    mechanism, model = reading.mechanism, reading.model
    give = model.regularisation(np.zeros(mechanism.row_count), mechanism.pose) if model.has_soft_joints else None
    expected = accelerations(mechanism, mechanism.pose, mechanism.twist, 0.0, give)
    computed = model.start()
    off = _acceleration_difference(mechanism, computed, expected)
    if off <= START_AGREEMENT:
        return off
    for element in model.elements:
        if _acceleration_difference(mechanism, model.without(element), expected) <= START_AGREEMENT:
            raise Unsupported(
                f"at t = 0 the accelerations differ from those of the ideal mechanism by {off:.1g} of themselves, and "
                f"agree without '{element}': it acts at the start, and in no ideal joint; {left_out(element)}"
            )
    for element, reason in model.suspects.items():
        raise Unsupported(f"{element}: {reason}; at t = 0 the accelerations are wrong by {off:.1g} of themselves")
    size = np.abs(computed - expected) * [1.0, 1.0, mechanism.length_scale]
    body = mechanism.bodies[int(size.max(axis=1).argmax())].name
    raise Unsupported(
        f"at t = 0 the accelerations of {model.engine} differ from those of the ideal mechanism by {off:.1g} of "
        f"themselves, most of all at {body!r}, and no single kind of element explains it"
    )


def _acceleration_difference(mechanism: Mechanism, found: Array, expected: Array) -> float:
    unit = np.array([1.0, 1.0, mechanism.length_scale])
    size = max(float(np.abs(expected * unit).max()), mechanism.length_scale / mechanism.time_scale**2)
    return float(np.abs((found - expected) * unit).max()) / size
