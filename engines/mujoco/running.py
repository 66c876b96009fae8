"""Stepping a model and recording its states in the timed loop; accelerations, reactions and warnings are read later."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Size
from engines.finer import Division, tells_itself
from engines.mujoco.construction import in_turn
from engines.mujoco.joints.roll.roll_warnings import roll_warnings
from engines.mujoco.model import Model
from engines.mujoco.releases import marks
from engines.mujoco.solver_check import unsolved
from engines.mujoco.theory import CLAIM, ORDER, claimed, seen_order
from reference.trajectory import Trajectory
from reference.validation import Count, validated

Array = NDArray[np.float64]

# A joint that opens by more than this part of the mechanism's length is no longer an error of integration: we say so.
TORN = 1e-3
# A solver that misses the accelerations by more than this part of them has not converged, whatever it reports.
UNSOLVED = 1e-5
# Of a radian or of the mechanism's length: what rounding may make of two runs.
ROUNDED = 1e-8
AT_REST = 1e-9  # of the largest acceleration so far, or of one that would be usual


@dataclass
class _Complaints:
    """What MuJoCo says while it runs, each sentence once, and when it first reset itself [s]."""

    data: Any
    said: dict[str, None] = field(default_factory=dict)
    reset_at: float | None = None

    def hear(self, message: str) -> None:
        # Called before the reset, so the time is still that of the step which failed.
        text = message.split(" Time = ")[0]
        self.said.setdefault(text)
        if "value in Q" in text and self.reset_at is None:
            self.reset_at = float(self.data.time)


@contextmanager
def _listening(data: Any) -> Iterator[_Complaints]:
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
    # Into how many steps each is to be divided in a motion of so many seconds: None for never.
    divided: Callable[[float], Division] | None = None

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Step samples * every times. Raises ValueError for bad counts, RuntimeError if it has run already.

        `stepping` counts what the answer needed: with the rough runs, and the run whose steps had to be divided.
        """
        self.model.mechanism.require_room(samples)
        if self.data.time > 0:
            raise RuntimeError("this model has been stepped already; build it again to repeat the run")
        step, found = self.model.compiled.opt.timestep, self._as_built(samples, every)
        if not self.divided or not self.other or tells_itself(found, self.model.mechanism, step, ORDER):
            return found
        needed = self.divided(samples * every * step)
        spent = found.stepping + needed.seconds
        if needed.steps > 1:
            found = self.other(step / needed.steps)(samples, every * needed.steps)
            spent += found.stepping
        return replace(found, stepping=spent)

    def _as_built(self, samples: int, every: int) -> Trajectory:
        """The motion by the steps of the model."""
        step = self.model.compiled.opt.timestep
        t = np.arange(samples + 1) * (every * step)
        with _listening(self.data) as complaints, self.model.hooked():
            position, velocity, clock, stepping = self._step(samples, every)
            # The clock falls behind when MuJoCo starts anew; the listener hears it, but only once per kind of trouble.
            behind = np.abs(clock - t) > step / 2
            reset_at = complaints.reset_at if complaints.reset_at is not None else _first(t, behind)
            sound = ~behind & np.all(np.isfinite(position) & np.isfinite(velocity), axis=1)
            if reset_at is not None:
                sound &= t <= reset_at
            warnings = list(complaints.said)
            acceleration, missed = self._accelerations(position, velocity, t, sound)
        pose, twist, change = self.model.tree.motion(*(self._ordered(x) for x in (position, velocity, acceleration)))
        reaction = np.full((samples + 1, self.model.mechanism.row_count), np.nan)
        read = np.all(np.isfinite(change), axis=(1, 2))
        reaction[read] = self.model.mechanism.reaction(pose[read], change[read], *self.model.loads(), twist[read])
        pose[~sound], twist[~sound] = np.nan, np.nan
        warnings += self._doubts(pose[sound], t[sound], missed)
        warnings += marks()
        warnings += roll_warnings(self.model.mechanism, step, t[read], pose[read], twist[read], reaction[read])
        estimate = self._estimate(samples, every, pose)
        unresolved_at = None if estimate is None else self._unresolved_at(t, estimate)
        if unresolved_at is not None:
            warnings.append(f"ours: unresolved from {unresolved_at:.4g} s on, its own estimate is not below its claim")
        elif estimate is not None and (lost := float(np.nanmax(estimate / self._sizes))) > CLAIM:
            warnings.append(f"ours: its own estimate is {lost:.1e} of a radian or of the mechanism's length")
        return Trajectory(t, pose, twist, reaction, stepping, tuple(warnings), reset_at, estimate, unresolved_at)

    def _estimate(self, samples: int, every: int, pose: Array) -> Array | None:
        """What a run of half as many steps says of the error of these poses; NaN where that run is lost.

        Richardson's: RK4's error falls with the fourth power of the step, and that of soft rows with their compliance.
        What hard rows lose in rounding falls with neither, and the order is not seen where steps are long: a small
        difference counts in full, and so does each with long steps. None where samples are one step apart.
        """
        if self.other is None or every < 2:
            return None
        fewer = every // 2
        ratio = every / fewer
        run = self.other(self.model.compiled.opt.timestep * ratio)
        for name in ("body_invweight0", "dof_invweight0", "tendon_invweight0"):
            # Rows that give way ratio^4 times as much: their error is then told with that of the step.
            getattr(run.model.compiled, name)[:] = ratio**4 * getattr(self.model.compiled, name)
        with _listening(run.data) as complaints, run.model.hooked():
            position, velocity, _, _ = run._step(samples, fewer)
        coarse, _, _ = run.model.tree.motion(*(run._ordered(x) for x in (position, velocity, velocity)))
        if complaints.reset_at is not None:
            return np.full_like(pose, np.nan)
        apart = np.abs(coarse - pose)
        order = seen_order(self.model.mechanism, self.model.compiled.opt.timestep)
        return np.maximum(apart / (ratio**order - 1), np.minimum(apart, ROUNDED * self._sizes))

    def _unresolved_at(self, t: Array, estimate: Array) -> float | None:
        """From when on [s] its estimate is not below what it claims."""
        largest = np.max(estimate / self._sizes, axis=(1, 2))
        return _first(t, ~(largest <= claimed(self.model.mechanism, self.model.compiled.opt.timestep, t)))

    @property
    def _sizes(self) -> Array:
        """What differences of poses are measured by [m, m, rad]."""
        length = self.model.mechanism.length_scale
        return np.array([length, length, 1.0])

    def _step(self, samples: int, every: int) -> tuple[Array, Array, Array, float]:
        """(samples + 1, ...) positions, velocities and clock, as MuJoCo orders them, and the loop's CPU seconds."""
        compiled, data = self.model.compiled, self.data
        position, velocity = np.empty((samples + 1, compiled.nq)), np.empty((samples + 1, compiled.nv))
        clock = np.empty(samples + 1)
        now_position, now_velocity, advance = data.qpos, data.qvel, mujoco.mj_step
        position[0], velocity[0], clock[0] = now_position, now_velocity, data.time
        overwrite = self.model.drive == "overwrite" and self.model.driven
        before = in_turn(self.model.hooks.before)
        begin = time.process_time()
        if before:
            for sample in range(1, samples + 1):
                for _ in range(every):
                    before(compiled, data)
                    advance(compiled, data)
                position[sample], velocity[sample], clock[sample] = now_position, now_velocity, data.time
        elif overwrite:
            for sample in range(1, samples + 1):
                for _ in range(every):
                    advance(compiled, data)
                    self._overwrite()
                position[sample], velocity[sample], clock[sample] = now_position, now_velocity, data.time
        else:
            for sample in range(1, samples + 1):
                advance(compiled, data, nstep=every)
                position[sample], velocity[sample], clock[sample] = now_position, now_velocity, data.time
        return position, velocity, clock, time.process_time() - begin

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
            for prepare in self.model.hooks.before:
                prepare(compiled, data)
            mujoco.mj_forward(compiled, data)
            acceleration[sample] = data.qacc
            if self.model.hooks.read:
                position[sample], velocity[sample], acceleration[sample] = self.model.hooks.read(compiled, data)
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


def _first(t: Array, flags: NDArray[np.bool_]) -> float | None:
    return float(t[int(np.argmax(flags))]) if flags.any() else None
