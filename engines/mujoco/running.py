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
        self._begin(samples)
        sampled = np.arange(samples + 1) * every
        if self.other is None:
            return self._as_built(sampled, sampled)
        # After every second step, or WATCHED of these.
        half = (samples * every + 1) // 2
        watched = 2 * np.unique(np.linspace(0, half, min(half, WATCHED) + 1).round().astype(int))
        counts = np.union1d(sampled, watched)
        at_samples, at_watched = np.searchsorted(counts, sampled), np.searchsorted(counts, watched)
        found, apart = self._doubled(counts, sampled)
        return _at(self._estimated(found, apart, counts, at_watched), at_samples)

    def _begin(self, samples: int) -> None:
        self.model.mechanism.require_room(samples)
        if self.data.time > 0:
            raise RuntimeError("this model has been stepped already; build it again to repeat the run")

    def _as_built(self, counts: Counts, read: Counts) -> Trajectory:
        """The motion by the steps of the model, after so many of them; reactions are read after `read`, of these."""
        step = self._dt
        t = counts.astype(float) * step
        with listening(self.data) as complaints, self.model.hooked():
            position, velocity, clock, stepping = self._step(counts)
            # The clock falls behind when MuJoCo starts anew; the listener hears it, but only once per kind of trouble.
            behind = np.abs(clock - t) > step / 2
            reset_at = complaints.reset_at if complaints.reset_at is not None else _first(t, behind)
            sound = ~behind & np.all(np.isfinite(position) & np.isfinite(velocity), axis=1)
            if reset_at is not None:
                sound &= t <= reset_at
            warnings = list(complaints.said)
            acceleration, missed = self._accelerations(position, velocity, t, sound & np.isin(counts, read))
        pose, twist, change = self.model.tree.motion(*(self._ordered(x) for x in (position, velocity, acceleration)))
        reaction = np.full((len(t), self.model.mechanism.row_count), np.nan)
        told = np.all(np.isfinite(change), axis=(1, 2))
        reaction[told] = self.model.mechanism.reaction(pose[told], change[told], *self.model.loads(), twist[told])
        pose[~sound], twist[~sound] = np.nan, np.nan
        warnings += self._doubts(pose[sound], t[sound], missed)
        warnings += marks()
        warnings += roll_warnings(self.model.mechanism, step, t[told], pose[told], twist[told], reaction[told])
        return Trajectory(t, pose, twist, reaction, stepping, tuple(warnings), reset_at)

    def _doubled(self, counts: Counts, read: Counts) -> tuple[Trajectory, Array]:
        """The same, and the differences of a run of steps twice as long from its poses.

        That run is there after every second step. In between, the larger of the differences before and after counts.
        """
        before, after = counts - counts % 2, counts + counts % 2
        even = np.union1d(before, after)
        every = np.union1d(even, counts)
        found = self._as_built(every, read)
        apart, spent = self._apart(found.pose[np.searchsorted(every, even)], np.floor_divide(even, 2), 2.0)
        first, second = (apart[np.searchsorted(even, around)] for around in (before, after))
        apart = np.where(np.abs(first) > np.abs(second), first, second + 0 * first)  # NaN where either is
        return replace(_at(found, np.searchsorted(every, counts)), stepping=found.stepping + spent), apart

    def _apart(self, pose: Array, counts: Counts, ratio: float) -> tuple[Array, float]:
        """The differences of the poses after so many steps of another length from these (times, bodies, 3), and what
        those took.

        Its rows give way ratio^4 times as much, so that their error is told with that of the step. NaN where it is
        lost.
        """
        assert self.other is not None  # only a run with an estimate asks
        run = self.other(self._dt * ratio)
        for name in ("body_invweight0", "dof_invweight0", "tendon_invweight0"):
            getattr(run.model.compiled, name)[:] = ratio**ORDER * getattr(self.model.compiled, name)
        with listening(run.data) as complaints, run.model.hooked():
            position, velocity, clock, spent = run._step(counts)
        there, _, _ = run.model.tree.motion(*(run._ordered(x) for x in (position, velocity, velocity)))
        apart = there - pose
        reset_at = np.inf if complaints.reset_at is None else complaints.reset_at
        t = counts * run._dt
        apart[(np.abs(clock - t) > run._dt / 2) | (t >= reset_at)] = np.nan
        return apart, spent

    def _by_order(self, apart: Array) -> Array:
        """What steps twice as long say of the error: RK4's falls with the fourth power, and so does that of soft rows.

        What hard rows lose in rounding falls with nothing, so a small difference counts in full.
        """
        apart = np.abs(apart)
        return np.maximum(apart / (2**ORDER - 1), np.minimum(apart, ROUNDED * self._sizes))

    def _estimated(self, found: Trajectory, apart: Array, counts: Counts, watched: Counts) -> Trajectory:
        """With an estimate, and whether it is above what is claimed; by half steps too where double ones can't tell.

        Where double steps make more of a difference than is claimed, nobody knows whether the order is seen. Half steps
        make a difference that is q times as large, where RK4's q is 1/16. At q up to 1/8 the third order is seen at
        least: were steps halved on and on, and each difference at most half of the one before, the rest would add up to
        2 q of it at most. Else each is taken to be up to 2/3 of the one before, so that they add up to three: they fell
        so near a change point, where a plain half missed by a fifth. What was missed once may pass zero: q is that of
        the largest differences so far.
        """
        stepping, warnings = found.stepping, found.warnings
        estimate, better = self._by_order(apart), -apart / (2**ORDER - 1)
        coarse = self._largest_so_far(apart[watched])
        # From which step on it is above is known no better than the estimate is: from where double steps leave it open.
        closed = watched[: np.argmin([*self._within(apart[watched]), False])]
        unresolved_at = None
        if not coarse[-1] <= CLAIM:
            apart, spent = self._apart(found.pose, 2 * counts, 0.5)
            better = apart * 2**ORDER / (2**ORDER - 1)
            q = self._largest_so_far(apart[watched]) / np.where(coarse > 0, coarse, np.inf)
            factor = np.where(q <= 1 / 8, 1 + 2 * q, 3.0)  # 3 also where the run of double steps is lost
            estimate = np.abs(apart) * factor[np.searchsorted(counts[watched], counts, side="right") - 1, None, None]
            stepping += spent
        # Extrapolated poses still have the gaps that all runs leave alike.
        seen = found.pose[watched] + better[watched]
        moved = RELEASED * closing(self.model.mechanism, found.t[watched], seen, found.t)
        estimate = estimate + np.maximum.accumulate(np.abs(moved))
        warnings = (*warnings, *self._reaction_doubts(found, moved, better))
        if not self._within(estimate).all():
            above = found.t[np.argmin(self._within(estimate))]
            unresolved_at = float(min(above, (counts[closed[-1]] + 1) * self._dt)) if len(closed) else 0.0
            warnings = (
                *warnings,
                f"ours: unresolved from {unresolved_at:.4g} s on, its own estimate is not below its claim",
            )
        return replace(found, stepping=stepping, warnings=warnings, estimate=estimate, unresolved_at=unresolved_at)

    def _reaction_doubts(self, found: Trajectory, *moved: Array) -> list[str]:
        """What is to be said of reactions where poses may be displaced by these (times, bodies, 3)."""
        mechanism = self.model.mechanism
        sound = np.isfinite(found.reaction).any(axis=1) & np.isfinite(moved).all(axis=(0, 2, 3))
        felt = np.any(np.abs(moved) > UNFELT * self._sizes, axis=(0, 2, 3))
        told = some(mechanism, np.logical_and(sound, felt))
        if not len(told):
            return []
        pose, reaction = found.pose[told], found.reaction[told]
        errors = [displaced_reaction(mechanism, pose, reaction, each[told]) - reaction for each in moved]
        return reaction_doubts(mechanism, pose, found.twist[told], reaction, np.abs(errors).max(axis=0))

    def _within(self, apart: Array) -> NDArray[np.bool_]:
        """(times,) whether that is no more than what is claimed."""
        return np.max(np.abs(apart) / self._sizes, axis=(1, 2)) <= CLAIM

    def _largest_so_far(self, apart: Array) -> Array:
        """(times,) of a radian or of the mechanism's length; NaN from where one is lost."""
        return np.maximum.accumulate(np.max(np.abs(apart) / self._sizes, axis=(1, 2)))

    @property
    def _dt(self) -> float:
        return self.model.compiled.opt.timestep

    @property
    def _sizes(self) -> Array:
        """What differences of poses are measured by [m, m, rad]."""
        length = self.model.mechanism.length_scale
        return np.array([length, length, 1.0])

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

    def _ordered(self, values: Array) -> Array:
        return values[:, self.model.address]

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


def _at(found: Trajectory, places: Counts) -> Trajectory:
    """The motion at some of its times."""
    kept = {name: getattr(found, name)[places] for name in ("t", "pose", "twist", "reaction")}
    return replace(found, **kept, estimate=None if found.estimate is None else found.estimate[places])


def _first(t: Array, flags: NDArray[np.bool_]) -> float | None:
    return float(t[int(np.argmax(flags))]) if flags.any() else None
