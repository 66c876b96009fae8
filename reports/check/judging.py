"""The ideal motion of a model, the accuracy of this motion, and errors of runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.lagrange import TRUTH, Judge, Lagrange
from engines.lagrange.dynamics import Dynamics, constrained_acceleration
from engines.reading import Reading, RowRegularisation, left_out
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.plane import COMPLEX_STEP
from reference.reactions import undetermined
from reference.trajectory import Trajectory, energy
from reports.check.one_freedom import has_one_freedom, motion_along_curve

Array = NDArray[np.float64]
Method = Callable[[Mechanism], Trajectory]
DIVERGED = 1e12  # A state with a larger component [m, rad, m/s or rad/s] has diverged.
SOFT_TOLERANCE = 1e-10  # Relative tolerance, far below the truncation errors of engines and far above rounding.


def accelerations(
    mechanism: Mechanism, pose: Array, twist: Array, t: float, give: RowRegularisation | None = None
) -> Array:
    """Accelerations (bodies, 3) [m/s^2, rad/s^2] with ideal joints, or with soft joints if `give` is not None."""
    if give is None or not mechanism.row_count:
        return constrained_acceleration(mechanism, pose, twist)[0]
    return soft_accelerations(mechanism, pose, twist, mechanism.joint_rows.gap(pose, np.asarray(t)), give)


def soft_accelerations(mechanism: Mechanism, pose: Array, twist: Array, gap: Array, give: RowRegularisation) -> Array:
    """Accelerations (bodies, 3) [m/s^2, rad/s^2] with soft joints, whose gaps (rows,) [m, rad] are given.

    Soft rows satisfy J a = b - damping slip - stiffness gap - compliance F. The bias b is that of the mechanism, or
    `give.initial_bias` unless this is NaN.
    """
    # One complex evaluation of the rows also gives their derivative along the motion, as in `Mechanism.bias`.
    along = mechanism.joint_rows.dense(pose + 1j * COMPLEX_STEP * twist)
    rows, velocity = np.real(along), twist.reshape(-1)
    bias = np.where(np.isnan(give.initial_bias), -(np.imag(along) / COMPLEX_STEP) @ velocity, give.initial_bias)
    target = bias - give.damping * (rows @ velocity - mechanism.rate) - give.stiffness * np.nan_to_num(gap)
    return constrained_acceleration(mechanism, pose, twist, target, give.compliance, rows)[0]


def soft_motion(
    mechanism: Mechanism,
    give: Callable[[Array, Array], RowRegularisation],
    t: Array,
    tolerance: float = SOFT_TOLERANCE,
    twist: Array | None = None,
) -> Array:
    """Poses (times, bodies, 3) of a motion with soft joints. Poses are NaN after the integration has failed. `give`
    returns the regularisation of the rows from the gap and the pose. twist: initial velocities (bodies, 3), by default
    those of the mechanism. The method is LSODA, since the equations are stiff."""
    from scipy.integrate import solve_ivp

    count = mechanism.pose.size
    lengths = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    allowed = tolerance * np.concatenate([lengths, lengths / mechanism.time_scale])

    def rates(at: float, state: Array) -> Array:
        if not np.abs(state).max() < DIVERGED:  # NaN makes LSODA repeat the step with a smaller size.
            return np.full_like(state, np.nan)
        pose, twist = state[:count].reshape(-1, 3), state[count:].reshape(-1, 3)
        gap = np.nan_to_num(mechanism.joint_rows.gap(pose, np.asarray(at)))
        change = soft_accelerations(mechanism, pose, twist, gap, give(gap, pose))
        return np.concatenate([state[count:], change.reshape(-1)])

    start = np.concatenate([mechanism.pose.reshape(-1), (mechanism.twist if twist is None else twist).reshape(-1)])
    solution: Any = solve_ivp(rates, (0.0, float(t[-1])), start, "LSODA", t_eval=t, rtol=tolerance, atol=allowed)
    out = np.full((len(t), *mechanism.pose.shape), np.nan)
    out[: solution.y.shape[1]] = solution.y[:count].T.reshape(-1, *mechanism.pose.shape)
    return out


LOOSER_JUDGE = Lagrange(tolerance=1e-10)  # A second run, whose difference estimates the error of the reference motion.
JUDGE_SHARE = 0.1  # Largest estimated error of the reference motion, relative to the user's tolerance.
# Relative errors of a step along the configuration curve of a mechanism with one freedom. The second run estimates the
# error of the first run.
CURVE_TOLERANCES = 1e-12, 1e-11
DISTURBANCE = 1e-7  # Initial disturbance relative to length and speed, small enough for linear growth.
LINEAR_LIMIT = 1e-2  # A disturbance above this size, relative to length and speed, does not grow linearly.
DISTURBANCES = ((1, DISTURBANCE), (2, DISTURBANCE / 10))  # (seed, size). In a chaotic motion both grow exponentially.
REMAINING_SHARE = 1e-3  # If projection leaves less than this share of a disturbance, the joints do not allow it.
# A disturbance of a regular motion grows about linearly in time. Growth that is faster by this factor is exponential.
EXPONENTIAL_GROWTH = 100.0


@dataclass(frozen=True, eq=False)
class IdealMotion:
    """The ideal motion, and its sensitivity to the initial state."""

    trajectory: Trajectory
    looser: Trajectory  # The same motion with a larger tolerance. The difference of both motions estimates the error.
    growth: Array  # Growth factor (times,) of a small disturbance of the initial state.
    horizon: float  # Time [s] after which small disturbances grow exponentially; the duration if they do not.
    cut: bool = False  # Whether the motion ends early because the estimated error becomes too large.

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


def reference_motion(
    mechanism: Mechanism, samples: int, spacing: float, tolerance: float = np.inf, judge: Judge = TRUTH
) -> IdealMotion:
    """The motion with ideal joints, until the estimated error exceeds the share JUDGE_SHARE of the tolerance. Raises
    InvalidMechanism if the integration fails, or if the first sample after the start is inaccurate."""
    single_run = Lagrange(tolerance=judge.tolerance, compiled=judge.compiled)

    def by_multipliers(other: Mechanism) -> Trajectory:
        """The judge's motion, without its error estimate if one run is enough."""
        motion = single_run.build(other, spacing)(samples, 1)
        return motion if np.isfinite(motion.pose).all() else judge.build(other, spacing)(samples, 1)

    run: Method = by_multipliers
    motion, looser = judge.build(mechanism, spacing)(samples, 1), None
    accurate = _is_accurate(mechanism, motion, tolerance)
    if not accurate.all() and has_one_freedom(mechanism):
        along, beside = (motion_along_curve(mechanism, motion.t, size) for size in CURVE_TOLERANCES)
        along = replace(along, estimate=np.abs(along.pose - beside.pose))
        accurate_along = _is_accurate(mechanism, along, tolerance)
        if accurate_along.all():
            motion, looser, accurate = along, beside, accurate_along
            run = partial(motion_along_curve, t=motion.t, tolerance=CURVE_TOLERANCES[0])
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
        return replace(reference_motion(mechanism, last, spacing, judge=judge), cut=True)
    looser = looser or replace(LOOSER_JUDGE, compiled=judge.compiled).build(mechanism, spacing)(samples, 1)
    growths = [_growth(mechanism, motion, looser, run, *disturbance) for disturbance in DISTURBANCES]
    expected = EXPONENTIAL_GROWTH * (1 + motion.t / mechanism.time_scale)
    sizes = [size for _, size in DISTURBANCES]
    begins = [_first_exponential(growth, expected, size) for growth, size in zip(growths, sizes, strict=True)]
    parts = all(begin < len(motion.t) for begin in begins) and not has_one_freedom(mechanism)
    horizon = float(motion.t[min(begins) if parts else -1])
    return IdealMotion(motion, looser, np.max(growths, axis=0), horizon)


def _is_accurate(mechanism: Mechanism, motion: Trajectory, tolerance: float) -> NDArray[np.bool_]:
    off = pose_distance(mechanism, motion.pose + np.asarray(motion.estimate), motion.pose)
    if mechanism.row_count:
        gap = np.abs(np.nan_to_num(mechanism.joint_rows.gap(motion.pose, motion.t)))
        off = np.maximum(off, (gap / np.where(mechanism.is_angular, 1.0, mechanism.length_scale)).max(axis=1))
    return off < JUDGE_SHARE * tolerance


def _first_exponential(growth: Array, expected: Array, size: float) -> int:
    """Index of the first sample with more than the expected growth, or the number of samples without such a sample.
    Growth that ends before the last sample counts only if the disturbance has exceeded LINEAR_LIMIT."""
    beyond = growth > expected
    stays = beyond[-1] or np.any(beyond & (growth * size > LINEAR_LIMIT))
    return int(np.argmax(beyond)) if stays else len(beyond)


def pose_distance(mechanism: Mechanism, pose: Array, other: Array) -> Array:
    """Largest difference (times,) of angles [rad] or of positions / length between two motions (times, bodies, 3)."""
    difference = np.abs(pose - other)
    places = np.hypot(difference[..., 0], difference[..., 1]) / mechanism.length_scale
    return np.maximum(places, difference[..., 2]).max(axis=1)


def _growth(
    mechanism: Mechanism, motion: Trajectory, looser: Trajectory, run: Method, seed: int, nudge: float
) -> Array:
    """Growth factor (times,) of a random initial disturbance, or 1 if the reference's error can explain the growth."""
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
    except InvalidMechanism:  # The disturbed mechanism can't be assembled or integrated.
        return none

    def size(other: Trajectory) -> Array:
        moved, faster = other.pose - motion.pose, mechanism.time_scale * (other.twist - motion.twist)
        return np.sqrt(np.sum((moved / unit) ** 2 + (faster / unit) ** 2, axis=(1, 2)))

    apart_by = np.nan_to_num(size(disturbed), nan=np.inf)
    if not apart_by[0] > REMAINING_SHARE * nudge:
        return none
    # Near a singular position the error of the reference motion grows too, which does not count.
    return np.where(apart_by > size(looser), apart_by, apart_by[0]) / apart_by[0]


START_AGREEMENT = 1e-6  # Largest difference of initial accelerations, relative to the largest acceleration.
ZERO_SHARE = 1e-9  # Smaller speeds and forces, relative to the mechanism's speed or largest force, count as zero.
ERROR_UNITS = {"angle": "rad", "position": "m", "reaction": "of the largest", "energy": "of the largest kinetic"}


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors of a run at its samples. NaN means that the run has diverged, or that the value is not compared."""

    t: Array
    of: dict[str, Array]  # Key of ERROR_UNITS -> errors (times,).
    whole: Array  # `pose_distance` (times,) from the ideal motion. The maximum is compared with the tolerance.
    finished: bool

    @property
    def largest(self) -> float:
        """The maximum of `whole`, or infinity for a run that diverged."""
        return float(np.nanmax(self.whole)) if self.finished else float("inf")

    @property
    def worst(self) -> dict[str, float]:
        return {name: float(np.fmax.reduce(values)) for name, values in self.of.items()}

    @property
    def over_time(self) -> dict[str, list[float]]:
        return {"t": self.t.tolist(), **{name: values.tolist() for name, values in self.of.items()}}


def measure_errors(mechanism: Mechanism, truth: Trajectory, run: Trajectory, jumps: bool = False) -> Errors:
    """Errors of a run at the samples of the reference motion. jumps: whether the joints do not allow the initial
    velocities. The ideal motion changes these velocities by an impulse at t = 0, but a run needs one or more steps. So
    forces and energy at the first two samples are not compared."""
    difference = run.pose - truth.pose
    angle = np.abs(difference[..., 2]).max(axis=1)
    position = np.hypot(difference[..., 0], difference[..., 1]).max(axis=1)
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1))
    span = float(kinetic.max())
    fast = mechanism.length_scale / mechanism.time_scale
    # The drift is relative to the kinetic energy, so it is not defined for a mechanism at rest.
    moves = span > 0.5 * float(mechanism.inertias[:, 0].max()) * (ZERO_SHARE * fast) ** 2
    drift = np.abs(energy(mechanism, run) - energy(mechanism, truth)) / span if moves else np.full_like(angle, np.nan)
    reaction = _reaction(mechanism, truth, run)
    if jumps:
        reaction[:2], drift[:2] = np.nan, np.nan
    of = {"angle": angle, "position": position, "reaction": reaction, "energy": drift}
    return Errors(run.t, of, pose_distance(mechanism, run.pose, truth.pose), bool(np.isfinite(run.pose).all()))


def _reaction(mechanism: Mechanism, truth: Trajectory, run: Trajectory) -> Array:
    """The largest relative error (times,) of the unique joint reactions, or NaN if the run has no reactions. Force
    errors are relative to the largest ideal force, and moment errors to the largest ideal moment. If all ideal forces
    or moments are only rounding, errors are relative to the largest acting force, or for moments to this force times
    the length. The force of a joint is compared as a vector, so the error does not depend on the axes."""
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
            # fmax ignores NaN. The engine does not report some forces, such as that of a prescribed crank.
            out = np.fmax(out, np.fmax.reduce(off, axis=0))
    return out


@dataclass(frozen=True)
class Opening:
    """The largest constraint violation, with its row, gap [m or rad] and time [s]."""

    row: str
    gap: float
    unit: str
    t: float


def find_opening(mechanism: Mechanism, run: Trajectory) -> Opening | None:
    """The largest constraint violation of a run, or None without constraints."""
    if not mechanism.row_count:
        return None
    gap = np.abs(mechanism.gap(run.pose, run.t))
    scaled = np.nan_to_num(np.where(mechanism.is_angular, gap, gap / mechanism.length_scale))
    sample, row = np.unravel_index(int(np.argmax(scaled)), scaled.shape)
    unit = "rad" if mechanism.is_angular[row] else "m"
    return Opening(mechanism.row_names[row], float(gap[sample, row]), unit, float(run.t[sample]))


def refuse_disagreement(reading: Reading) -> float:
    """Relative difference of the accelerations at t = 0 between the engine and the judge. The judge uses the declared
    softness of the engine. Raises Unsupported if the difference exceeds START_AGREEMENT. The message names an element
    of the model if the accelerations agree without this element."""
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
