"""Stepping a model and recording its states in the timed loop; accelerations, reactions and warnings are read later."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Size
from engines.constraint_error import FORCES, closing, displaced_reaction, reaction_doubts, some
from engines.mujoco.joints.roll import roll_warnings
from engines.mujoco.model import Model
from engines.mujoco.releases import marks
from engines.mujoco.solver_check import unsolved
from engines.sampling import sampled
from reference.checks import Count, validated
from reference.rows import RANK_TOLERANCE
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
Counts = NDArray[np.int_]  # of steps since the start, rising, or places in such an array

ORDER = 4  # of RK4, and so of every run with an estimate
# A joint that opens by more than this part of the mechanism's length is no longer an error of integration: we say so.
TORN = 1e-3
# A solver that misses the accelerations by more than this part of them has not converged, whatever it reports.
UNSOLVED = 1e-5
# Of a radian or of the mechanism's length: what rounding may make of two runs.
ROUNDED = 1e-8
# Instants at which an estimate is made beside the samples: all where half of the steps are fewer, as in most runs.
WATCHED = 1000
AT_REST = 1e-9  # of the largest acceleration so far, or of one that would be usual
# Displacements below this part of the mechanism's length change no independent row by a thousandth of its smallest.
UNFELT = FORCES * RANK_TOLERANCE
# How many times the displacement that closes joints counts as the error by regularisation: free motion feels it too.
RELEASED = 1.5


@dataclass
class _Complaints:
    """What MuJoCo says while it runs, each sentence once, and when it first reset itself [s]."""

    data: Any = None
    said: dict[str, None] = field(default_factory=dict)
    reset_at: float | None = None

    def hear(self, message: str) -> None:
        # Called before the reset, so the time is still that of the step which failed.
        text = " ".join(str(message).split(" Time = ")[0].split())
        self.said.setdefault(text)
        if "value in Q" in text and self.reset_at is None and self.data is not None:
            self.reset_at = float(self.data.time)


@contextmanager
def listening(data: Any = None) -> Iterator[_Complaints]:
    """Hear MuJoCo's warnings, which it would otherwise write into a file in the working directory."""
    complaints = _Complaints(data)
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(complaints.hear)
    try:
        yield complaints
    finally:
        mujoco.set_mju_user_warning(before)


@dataclass(frozen=True)
class MuJoCoRun:
    """A built model at its start; call it once with (samples, every) for a Trajectory."""

    model: Model
    data: Any  # mujoco.MjData, which stepping changes
    size: Size
    # Builds the same with another step [s], for an estimate of the error of RK4: None for none.
    other: Callable[[float], MuJoCoRun] | None = None

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Step samples * every times. Raises ValueError for bad counts, RuntimeError if it has run already.

        The sampling is no part of the method: an estimate is made at WATCHED instants beside the samples, and these
        decide whether the estimate needs a third run. `stepping` counts all runs.
        """
        self.model.mechanism.require_room(samples)
        if self.data.time > 0:
            raise RuntimeError("this model has been stepped already; build it again to repeat the run")
        sampled = np.arange(samples + 1) * every
        if self.other is None:
            return self._as_built(sampled, sampled)
        # Double steps end after every second step. Estimates are made there, or at WATCHED of them, and beside samples.
        half = (samples * every + 1) // 2
        watched = 2 * np.unique(np.linspace(0, half, min(half, WATCHED) + 1).round().astype(int))
        counts = np.unique([*sampled, *watched, *(sampled - sampled % 2), *(sampled + sampled % 2)])
        run = self._estimated(self._as_built(counts, sampled), counts, np.searchsorted(counts, watched))
        at = np.searchsorted(counts, sampled)
        return replace(run, **{name: getattr(run, name)[at] for name in ("t", "pose", "twist", "reaction", "estimate")})

    def _as_built(self, counts: Counts, read: Counts) -> Trajectory:
        """The motion by the steps of the model, after so many of them; reactions are read after `read`, of these."""
        step, model = self._dt, self.model
        t = counts.astype(float) * step
        with listening(self.data) as complaints, model.hooked():
            position, velocity, clock, stepping = self._step(counts)
            # The clock falls behind when MuJoCo starts anew; the listener hears it, but only once per kind of trouble.
            behind = np.abs(clock - t) > step / 2
            reset_at = complaints.reset_at
            if reset_at is None and behind.any():
                reset_at = float(t[int(np.argmax(behind))])
            sound = ~behind & np.all(np.isfinite(position) & np.isfinite(velocity), axis=1)
            if reset_at is not None:
                sound &= t <= reset_at
            warnings = list(complaints.said)
            acceleration, missed = self._accelerations(position, velocity, t, sound & np.isin(counts, read))
        pose, twist, change = model.tree.motion(*(x[:, model.address] for x in (position, velocity, acceleration)))
        reaction = np.full((len(t), model.mechanism.row_count), np.nan)
        is_read = np.all(np.isfinite(change), axis=(1, 2))
        seen = pose[is_read], twist[is_read]
        reaction[is_read] = model.mechanism.reaction(seen[0], change[is_read], *model.loads(), seen[1])
        pose[~sound], twist[~sound] = np.nan, np.nan
        warnings += self._doubts(pose[sound], t[sound], missed)
        warnings += marks()
        warnings += roll_warnings(model.mechanism, step, t[is_read], *seen, reaction[is_read])
        return Trajectory(t, pose, twist, reaction, stepping, tuple(warnings), reset_at)

    def _apart(self, pose: Array, counts: Counts, ratio: float) -> tuple[Array, float]:
        """The differences of the poses after so many steps of another length from these (times, bodies, 3), and the CPU
        seconds of those steps.

        Rows of the other run have ratio^4 times the compliance, so that the difference has their error beside that of
        the step. NaN where it is lost.
        """
        assert self.other is not None  # only a run with an estimate asks
        run = self.other(self._dt * ratio)
        for name in ("body_invweight0", "dof_invweight0", "tendon_invweight0"):
            getattr(run.model.compiled, name)[:] = ratio**ORDER * getattr(self.model.compiled, name)
        with listening(run.data) as complaints, run.model.hooked():
            position, velocity, clock, spent = run._step(counts)
        columns = (x[:, run.model.address] for x in (position, velocity, velocity))
        apart = run.model.tree.motion(*columns)[0] - pose
        reset_at = np.inf if complaints.reset_at is None else complaints.reset_at
        t = counts * run._dt
        apart[(np.abs(clock - t) > run._dt / 2) | (t >= reset_at)] = np.nan
        return apart, spent

    def _estimated(self, run: Trajectory, counts: Counts, watched: Counts) -> Trajectory:
        """The run (after `counts` steps) with its estimate, and from when on that is above CLAIM.

        The error of RK4 falls with the fourth power of the step, and so does that of soft rows. The rounding errors of
        hard rows do not fall, so a small difference counts in full. If the difference to the run with double steps
        exceeds CLAIM, two runs cannot confirm the order, and a third run with half steps is made. Its difference is q
        times as large, where RK4's q is 1/16. At q up to 1/8 the third order is seen at least: were steps halved on and
        on, and each difference at most half of the one before, the rest would add up to 2 q of it at most. Otherwise
        each is taken to be up to 2/3 of the one before, so that they add up to three times the first: they fell so near
        a change point, where a plain half missed by a fifth. An error may pass zero: q is that of the largest
        differences so far.
        """
        even = counts[counts % 2 == 0]
        apart, spent = self._apart(run.pose[counts % 2 == 0], even // 2, 2.0)
        # After an odd number of steps the larger of the differences before and after counts; NaN where either is.
        first, second = (apart[np.searchsorted(even, around)] for around in (counts - counts % 2, counts + counts % 2))
        apart = np.where(np.abs(first) > np.abs(second), first, second + 0 * first)
        estimate, better = np.abs(apart) / (2**ORDER - 1), -apart / (2**ORDER - 1)
        estimate = np.maximum(estimate, np.minimum(np.abs(apart), ROUNDED * self.model.mechanism.pose_unit))
        coarse, unresolved_at = np.maximum.accumulate(self._relative(apart[watched])), None
        # When the estimate rises above CLAIM is known no better than from where double steps leave it open.
        closed = watched[: np.argmin([*(self._relative(apart[watched]) <= CLAIM), False])]
        if not coarse[-1] <= CLAIM:
            apart, more = self._apart(run.pose, 2 * counts, 0.5)
            better, spent = apart * 2**ORDER / (2**ORDER - 1), spent + more
            fine = np.maximum.accumulate(self._relative(apart[watched]))
            q = fine / np.where(coarse > 0, coarse, np.inf)
            factor = np.where(q <= 1 / 8, 1 + 2 * q, 3.0)  # 3 also where the run of double steps is lost
            estimate = np.abs(apart) * factor[np.searchsorted(counts[watched], counts, side="right") - 1, None, None]
        # Extrapolated poses still have the gaps that all runs leave alike.
        moved = RELEASED * closing(self.model.mechanism, run.t[watched], run.pose[watched] + better[watched], run.t)
        estimate = estimate + np.maximum.accumulate(np.abs(moved))
        warnings = [*run.warnings, *self._reaction_doubts(run, moved, better)]
        above = np.flatnonzero(~(self._relative(estimate) <= CLAIM))
        if len(above):
            at = run.t[above[0]]
            unresolved_at = float(min(at, (counts[closed[-1]] + 1) * self._dt)) if len(closed) else 0.0
            words = f"unresolved from {unresolved_at:.4g} s on, its own estimate is not below its claim"
            warnings.append(f"ours: {words}")
        spent += run.stepping
        return replace(run, stepping=spent, warnings=tuple(warnings), estimate=estimate, unresolved_at=unresolved_at)

    def _reaction_doubts(self, run: Trajectory, *moved: Array) -> list[str]:
        """The warning for reactions that are uncertain where poses may be displaced by these (times, bodies, 3)."""
        mechanism = self.model.mechanism
        sound = np.isfinite(run.reaction).any(axis=1) & np.isfinite(moved).all(axis=(0, 2, 3))
        is_felt = np.any(np.abs(moved) > UNFELT * self.model.mechanism.pose_unit, axis=(0, 2, 3))
        at = some(mechanism, np.logical_and(sound, is_felt))
        if not len(at):
            return []
        pose, reaction = run.pose[at], run.reaction[at]
        errors = [displaced_reaction(mechanism, pose, reaction, displacement[at]) - reaction for displacement in moved]
        return reaction_doubts(mechanism, pose, run.twist[at], reaction, np.abs(errors).max(axis=0))

    def _relative(self, apart: Array) -> Array:
        """(times,) the largest difference of poses as a part of a radian or of the mechanism's length."""
        return np.max(np.abs(apart) / self.model.mechanism.pose_unit, axis=(1, 2))

    @property
    def _dt(self) -> float:
        return self.model.compiled.opt.timestep

    def _step(self, counts: Counts) -> tuple[Array, Array, Array, float]:
        """Positions, velocities and clock after so many steps (times, ...), the first after none, as MuJoCo orders
        them, and the loop's CPU seconds.
        """
        compiled, data = self.model.compiled, self.data
        position, velocity = np.empty((len(counts), compiled.nq)), np.empty((len(counts), compiled.nv))
        clock = np.empty(len(counts))
        now_position, now_velocity, step = data.qpos, data.qvel, mujoco.mj_step
        overwrite = self.model.drive == "overwrite" and self.model.driven
        before = self.model.hooks.before

        def advance(count: int) -> None:
            if not (before or overwrite):
                step(compiled, data, nstep=count)
                return
            for _ in range(count):
                if before:
                    before(compiled, data)
                step(compiled, data)
                if overwrite:
                    self._overwrite()

        def record(sample: int) -> None:
            position[sample], velocity[sample], clock[sample] = now_position, now_velocity, data.time

        return position, velocity, clock, sampled(np.diff(counts).tolist(), advance, record)

    def _overwrite(self) -> None:
        for driven in self.model.driven:
            place = self.model.address[driven.column]
            self.data.qpos[place] = driven.rate * self.data.time
            self.data.qvel[place] = driven.rate

    def _accelerations(
        self, position: Array, velocity: Array, t: Array, sound: NDArray[np.bool_]
    ) -> tuple[Array, float]:
        """Accelerations at the samples by the engine's own solver, and by how much it failed to solve, at worst."""
        compiled, data = self.model.compiled, self.data
        acceleration, worst = np.full_like(velocity, np.nan), 0.0
        mechanism = self.model.mechanism
        largest = min(mechanism.length_scale, 1.0) / mechanism.time_scale**2
        for sample in np.flatnonzero(sound):
            data.qpos[:], data.qvel[:], data.time = position[sample], velocity[sample], t[sample]
            if self.model.hooks.before:
                self.model.hooks.before(compiled, data)
            mujoco.mj_forward(compiled, data)
            acceleration[sample] = data.qacc
            data.qacc_warmstart[:] = data.qacc
            size = float(np.abs(data.qacc).max())
            largest = max(largest, size)
            # Where a motion has come to rest, what is left of its accelerations is rounding, and so is the miss.
            if not size < AT_REST * largest:
                worst = max(worst, unsolved(compiled, data))
        return acceleration, worst

    def _doubts(self, pose: Array, t: Array, missed: float) -> list[str]:
        """What we noticed and MuJoCo did not say."""
        mechanism, doubts = self.model.mechanism, []
        if len(t):
            gap = np.nan_to_num(np.abs(mechanism.gap(pose, t)))
            sample, row = np.unravel_index(int(np.argmax(gap)), gap.shape) if gap.size else (0, 0)
            if gap.size and gap[sample, row] > TORN * mechanism.length_scale:
                name = mechanism.row_names[row]
                doubts.append(f"ours: row {name!r} is open by {gap[sample, row]:.2g} at {t[sample]:.4g} s")
        if not missed <= UNSOLVED:
            doubts.append(f"ours: the solver missed the accelerations by {missed:.1g} of themselves")
        return doubts
