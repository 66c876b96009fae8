"""Runs of a MuJoCo model. The timed loop records states, and reactions are computed after the loop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import OneShot, Size
from engines.constraint_error import FORCES, closing, displaced_reaction, examined_times, reaction_doubts
from engines.contract import unresolved
from engines.mujoco.joints.roll import roll_warnings
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.releases import release_warnings
from engines.mujoco.solver_check import solver_residual
from engines.mujoco.step_doubling import ORDER, Counts, StepDoubling
from engines.sampling import sampled
from reference.checks import Count, validated
from reference.reactions import RANK_TOLERANCE
from reference.trajectory import RunWarning, Trajectory

Array = NDArray[np.float64]

# Largest gap without a warning, relative to the mechanism's length. A larger gap is no integration error.
MAX_GAP = 1e-3
# Largest residual of a converged solver, relative to the accelerations.
MAX_RESIDUAL = 1e-5
# Number of instants, in addition to the samples, at which the error is estimated. A motion with fewer double steps has
# fewer instants.
ESTIMATE_INSTANTS = 1000
# A motion is at rest if accelerations relative to the largest earlier acceleration are smaller than this. Accelerations
# of a motion at rest are rounding.
AT_REST = 1e-9
# Smallest displacement that can cause a warning about reactions, relative to the mechanism's length.
MIN_DISPLACEMENT = FORCES * RANK_TOLERANCE
# Factor on the displacement that closes the joints, since regularisation also changes free motion.
RELEASED_MOTION = 1.5


def residual_warning(residual: float) -> RunWarning:
    text = f"ours: the solver missed the accelerations by {residual:.1g} of themselves"
    return RunWarning(text, "residual", "adapter")


@dataclass
class WarningLog:
    data: Any = None
    messages: dict[str, None] = field(default_factory=dict)
    reset_at: float | None = None  # s

    def record(self, message: str) -> None:
        """Record a warning. MuJoCo calls this before it resets a state, when `data.time` belongs to the failed step."""
        text = " ".join(str(message).split(" Time = ")[0].split())
        self.messages.setdefault(text)
        if "value in Q" in text and self.reset_at is None and self.data is not None:
            self.reset_at = float(self.data.time)


@contextmanager
def logged_warnings(data: Any = None) -> Iterator[WarningLog]:
    """Record MuJoCo's warnings, which it would otherwise write to a file in the working directory."""
    log = WarningLog(data)
    previous = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(log.record)
    try:
        yield log
    finally:
        mujoco.set_mju_user_warning(previous)


@dataclass(eq=False)
class MuJoCoRun(OneShot):
    model: MuJoCoModel
    data: Any  # mujoco.MjData, which every step changes
    size: Size
    # Builds a run with another step [s] for the error estimate, or None if there is no estimate.
    with_step: Callable[[float], MuJoCoRun] | None = None

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Make samples * every steps. Raises ValueError for invalid counts, and RuntimeError at the second call.

        The error is also estimated at ESTIMATE_INSTANTS instants that do not depend on the samples. `stepping` is the
        CPU time of all runs.
        """
        self.model.mechanism.require_room(samples)
        self.begin()
        sample_counts = np.arange(samples + 1) * every
        if self.with_step is None:
            return self._trajectory(sample_counts, sample_counts)
        # Double steps end after every second step. A sample after an odd count therefore needs the two adjacent even
        # counts.
        half = (samples * every + 1) // 2
        watched = 2 * np.unique(np.linspace(0, half, min(half, ESTIMATE_INSTANTS) + 1).round().astype(int))
        odd = sample_counts % 2
        counts = np.unique([*sample_counts, *watched, *(sample_counts - odd), *(sample_counts + odd)])
        run = self._trajectory(counts, sample_counts)
        run = self._with_estimate(run, counts, np.searchsorted(counts, watched))
        at = np.searchsorted(counts, sample_counts)
        return replace(run, **{name: getattr(run, name)[at] for name in ("t", "pose", "twist", "reaction", "estimate")})

    def _trajectory(self, counts: Counts, reaction_counts: Counts) -> Trajectory:
        step, model = self._dt, self.model
        t = counts.astype(float) * step
        with logged_warnings(self.data) as log, model.callback_installed():
            position, velocity, clock, stepping = self._step(counts)
            # After a reset the clock is late. MuJoCo also warns about resets, but only once for each kind of warning.
            is_late = np.abs(clock - t) > step / 2
            reset_at = log.reset_at
            if reset_at is None and is_late.any():
                reset_at = float(t[int(np.argmax(is_late))])
            is_valid = ~is_late & np.all(np.isfinite(position) & np.isfinite(velocity), axis=1)
            if reset_at is not None:
                is_valid &= t <= reset_at
            warnings = [RunWarning(message) for message in log.messages]
            evaluated = is_valid & np.isin(counts, reaction_counts)
            acceleration, residual = self._accelerations(position, velocity, t, evaluated)
        pose, twist, change = model.tree.motion(*(x[:, model.address] for x in (position, velocity, acceleration)))
        reaction = np.full((len(t), model.mechanism.row_count), np.nan)
        is_known = np.all(np.isfinite(change), axis=(1, 2))
        states = pose[is_known], twist[is_known]
        reaction[is_known] = model.mechanism.reaction(
            states[0], change[is_known], *model.inertias_and_gravity(), states[1]
        )
        pose[~is_valid], twist[~is_valid] = np.nan, np.nan
        warnings += self._own_warnings(pose[is_valid], t[is_valid], residual)
        warnings += release_warnings()
        warnings += roll_warnings(model.mechanism, step, t[is_known], *states, reaction[is_known])
        return Trajectory(t, pose, twist, reaction, stepping, tuple(warnings), reset_at)

    def _difference(self, pose: Array, counts: Counts, ratio: float) -> tuple[Array, float]:
        """The difference between a run with `ratio` times the step and `pose` (times, bodies, 3), and the CPU time [s].

        `counts` (times,) are the steps of the other run before each pose. The difference is NaN after a failure. Rows
        of the other run have ratio^4 times the compliance, so the difference includes the error of the compliance.
        """
        assert self.with_step is not None  # only a run with an estimate calls this
        run = self.with_step(self._dt * ratio)
        for name in ("body_invweight0", "dof_invweight0", "tendon_invweight0"):
            getattr(run.model.compiled, name)[:] = ratio**ORDER * getattr(self.model.compiled, name)
        with logged_warnings(run.data) as log, run.model.callback_installed():
            position, velocity, clock, stepping = run._step(counts)
        columns = (x[:, run.model.address] for x in (position, velocity, velocity))
        difference = run.model.tree.motion(*columns)[0] - pose
        reset_at = np.inf if log.reset_at is None else log.reset_at
        t = counts * run._dt
        difference[(np.abs(clock - t) > run._dt / 2) | (t >= reset_at)] = np.nan
        return difference, stepping

    def _with_estimate(self, run: Trajectory, counts: Counts, watched: Counts) -> Trajectory:
        """The run with its error estimate, and the time from which the estimate exceeds CLAIM.

        `counts` (times,) are the steps before each pose. `watched` are indices in `counts` at which the order is
        checked. If the difference from a run with double steps exceeds CLAIM, two runs cannot confirm the order, and a
        third run has half steps. See `engines.mujoco.step_doubling`.
        """
        is_even = counts % 2 == 0
        double, stepping = self._difference(run.pose[is_even], counts[is_even] // 2, 2.0)
        doubling = StepDoubling(counts, watched, self.model.mechanism.pose_unit, double)
        stepping += run.stepping
        if doubling.needs_half:
            half, more = self._difference(run.pose, 2 * counts, 0.5)
            doubling, stepping = replace(doubling, half=half), stepping + more
        error, correction = doubling.estimate()
        # If a gap is equal in all runs, extrapolation does not remove it.
        extrapolated = run.pose[watched] + correction[watched]
        released = RELEASED_MOTION * closing(self.model.mechanism, run.t[watched], extrapolated, run.t)
        error = error + np.maximum.accumulate(np.abs(released))
        warnings = [*run.warnings, *self._reaction_warnings(run, released, correction)]
        steps, unresolved_at = doubling.unresolved_from(error), None
        if steps is not None:
            unresolved_at = steps * self._dt
            warnings.append(unresolved(unresolved_at, "its own estimate is not below its claim"))
        return replace(run, stepping=stepping, warnings=tuple(warnings), estimate=error, unresolved_at=unresolved_at)

    def _reaction_warnings(self, run: Trajectory, *displacements: Array) -> list[RunWarning]:
        mechanism = self.model.mechanism
        is_valid = np.isfinite(run.reaction).any(axis=1) & np.isfinite(displacements).all(axis=(0, 2, 3))
        matters = np.any(np.abs(displacements) > MIN_DISPLACEMENT * mechanism.pose_unit, axis=(0, 2, 3))
        at = examined_times(mechanism, np.logical_and(is_valid, matters))
        if not len(at):
            return []
        pose, reaction = run.pose[at], run.reaction[at]
        errors = [
            displaced_reaction(mechanism, pose, reaction, displacement[at]) - reaction for displacement in displacements
        ]
        return reaction_doubts(mechanism, pose, run.twist[at], reaction, np.abs(errors).max(axis=0))

    @property
    def _dt(self) -> float:
        return self.model.compiled.opt.timestep

    def _step(self, counts: Counts) -> tuple[Array, Array, Array, float]:
        """MuJoCo's positions, velocities and clock after `counts` (times,) steps, and the CPU time [s] of the loop.

        The first count must be 0.
        """
        compiled, data = self.model.compiled, self.data
        position, velocity = np.empty((len(counts), compiled.nq)), np.empty((len(counts), compiled.nv))
        clock = np.empty(len(counts))
        qpos, qvel, step = data.qpos, data.qvel, mujoco.mj_step
        before_step = self.model.hooks.before_step

        def advance(count: int) -> None:
            if not before_step:
                step(compiled, data, nstep=count)
                return
            for _ in range(count):
                before_step(compiled, data)
                step(compiled, data)

        def record(sample: int) -> None:
            position[sample], velocity[sample], clock[sample] = qpos, qvel, data.time

        return position, velocity, clock, sampled(np.diff(counts).tolist(), advance, record)

    def _accelerations(
        self, position: Array, velocity: Array, t: Array, evaluated: NDArray[np.bool_]
    ) -> tuple[Array, float]:
        """The accelerations by MuJoCo at the `evaluated` times, and the largest residual of the solver.

        The residual is not evaluated for a motion at rest, since the accelerations are then rounding.
        """
        compiled, data = self.model.compiled, self.data
        acceleration, residual = np.full_like(velocity, np.nan), 0.0
        mechanism = self.model.mechanism
        largest = min(mechanism.length_scale, 1.0) / mechanism.time_scale**2
        for sample in np.flatnonzero(evaluated):
            data.qpos[:], data.qvel[:], data.time = position[sample], velocity[sample], t[sample]
            if self.model.hooks.before_step:
                self.model.hooks.before_step(compiled, data)
            mujoco.mj_forward(compiled, data)
            acceleration[sample] = data.qacc
            data.qacc_warmstart[:] = data.qacc
            size = float(np.abs(data.qacc).max())
            largest = max(largest, size)
            if not size < AT_REST * largest:
                residual = max(residual, solver_residual(compiled, data))
        return acceleration, residual

    def _own_warnings(self, pose: Array, t: Array, residual: float) -> list[RunWarning]:
        mechanism, warnings = self.model.mechanism, []
        gap = np.nan_to_num(np.abs(mechanism.gap(pose, t))) if len(t) else np.zeros((0, 0))
        if gap.size:
            sample, row = np.unravel_index(int(np.argmax(gap)), gap.shape)
            if gap[sample, row] > MAX_GAP * mechanism.length_scale:
                name = mechanism.row_names[row]
                text = f"ours: row {name!r} is open by {gap[sample, row]:.2g} at {t[sample]:.4g} s"
                warnings.append(RunWarning(text, "gap", "adapter", float(t[sample])))
        if not residual <= MAX_RESIDUAL:
            warnings.append(residual_warning(residual))
        return warnings
