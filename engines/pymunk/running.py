"""Runs of a pymunk model: C code records states, from which poses, twists and reactions are computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import BodyFields, Buffer, get_space_bodies

from engines import OneShot, Size
from engines.pymunk.model import Model
from engines.sampling import reactions, sampled
from reference.checks import Count, validated
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

if TYPE_CHECKING:
    from engines.pymunk.engine import Pymunk
    from engines.pymunk.iterations import IterationPlan

Array = NDArray[np.float64]

VELOCITIES = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
STATES = BodyFields.POSITION | BodyFields.ANGLE | VELOCITIES
# Number of free entries at the end of the array. pymunk's C code would reallocate an array that is almost full, which
# numpy forbids.
SPARE = 64
# Largest residual of the slowest mode in the reactions at t = 0 without a warning.
MAX_START_RESIDUAL = 1e-5


class StateRecorder:
    """Copies states of bodies in C code to an array that is allocated in advance.

    `lib.cpSpaceEachBody(space, visitor, states)` appends the states of all bodies. With `velocities` in place of
    `states`, the call appends the velocities.
    """

    def __init__(self, model: Model, states: int, velocities: int) -> None:
        visited = _visited_bodies(model.space)
        self._order = [visited.index(body.id) for body in model.bodies]
        self._count = len(visited)
        length = (6 * states + 3 * velocities) * self._count
        room = np.full(length + SPARE, np.nan)
        self._values = room[:length]
        floats = ffi.from_buffer("double[]", room)
        integers = ffi.new("pmIntArray *")
        target = ffi.new("pmFloatArray *", {"num": 0, "max": len(floats), "arr": floats})
        self._owned = (floats, integers, target)  # keeps these objects alive for C code
        self.visitor = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self.states, self.velocities = (
            ffi.new("pmBatchedData *", {"intArray": integers, "floatArray": target, "fields": fields.value})
            for fields in (STATES, VELOCITIES)
        )

    def read(self, samples: int, with_velocities: bool) -> tuple[Array, Array]:
        """States (samples + 1, bodies, 6), and velocities (samples, bodies, 3) one step before each sample.

        The array contains the first state, and then for each later sample the previous velocities (if
        `with_velocities`) and the state.
        """
        first, rest = np.split(self._values, [6 * self._count])
        rest = rest.reshape(samples, -1)
        split = 3 * self._count if with_velocities else 0
        states = np.concatenate([first[None], rest[:, split:]]).reshape(samples + 1, self._count, 6)
        before = rest[:, :split].reshape(samples, self._count, 3) if with_velocities else states[:-1, :, 3:]
        return states[:, self._order], before[:, self._order]


def _visited_bodies(space: pymunk.Space) -> list[int]:
    """The ids of a space's bodies in the order of C code, which differs from the order of addition."""
    buffer = Buffer()
    get_space_bodies(space, BodyFields.BODY_ID, buffer)
    return list(memoryview(buffer.int_buf()).cast("P"))


@dataclass(frozen=True)
class Recording:
    """Poses and velocities of the centres of mass at the samples, in the mechanism's order.

    The engine stores velocities together with the positions at t. The velocities belong to t, or to t + dt/2 in a
    leapfrog.
    """

    pose: Array  # (times, bodies, 3) at t.
    after: Array  # Velocities (times, bodies, 3) that the engine stores with the positions at t.
    before: Array  # Velocities (times - 1, bodies, 3) one step before each sample after the first.
    stepping: float  # CPU time [s].
    stopped: RunWarning | None = None  # Why stepping ended early; later values are NaN.


def record(model: Model, dt: float, samples: int, every: int, raw: bool, startup: Sequence[int] = ()) -> Recording:
    """Make samples * every steps; record the states at samples, and the velocities one step before each sample.

    `startup`: iterations of the first steps.
    """
    with_velocities = every > 1
    recorder = StateRecorder(model, samples + 1, samples if with_velocities else 0)
    visit_each, pointer = lib.cpSpaceEachBody, model.space._space
    step, space = model.stepper(raw)
    dt /= model.unit
    visitor, before, after = recorder.visitor, recorder.velocities, recorder.states
    stopped: RunWarning | None = None
    # The list is in reverse order, since `pop` takes the last entry.
    iterations = [model.space.iterations, *reversed(startup)] if startup else []

    def advance(count: int) -> bool:
        nonlocal stopped
        try:
            for _ in range(count):
                if iterations:
                    lib.cpSpaceSetIterations(pointer, iterations.pop())
                step(space, dt)
        except (ValueError, ArithmeticError) as reason:  # an update could not place its joint
            text = f"ours: stopped, as a joint could no longer be placed ({reason})"
            stopped = RunWarning(text, "lost", "adapter")
        return stopped is not None

    stepping = sampled(
        [every] * samples,
        advance,
        lambda _: visit_each(pointer, visitor, after),
        (lambda _: visit_each(pointer, visitor, before)) if with_velocities else None,
    )
    states, earlier = recorder.read(samples, with_velocities)
    with np.errstate(all="ignore"):  # an unstable motion may overflow
        states[..., 3:] /= model.unit
        earlier = earlier / model.unit if with_velocities else states[:-1, :, 3:]
        return Recording(*_at_mass_centres(model, states, earlier), stepping, stopped)


def _at_mass_centres(model: Model, states: Array, earlier: Array) -> tuple[Array, Array, Array]:
    pose, after, before = states[..., :3].copy(), states[..., 3:].copy(), earlier.copy()
    for index in _cranks(model):
        x, y = -model.origins[index]
        for velocity, angle in ((after[:, index], pose[:, index, 2]), (before[:, index], pose[1:, index, 2])):
            velocity[:, 0] -= velocity[:, 2] * (np.sin(angle) * x + np.cos(angle) * y)
            velocity[:, 1] += velocity[:, 2] * (np.cos(angle) * x - np.sin(angle) * y)
        angle = pose[:, index, 2]
        pose[:, index, 0] += np.cos(angle) * x - np.sin(angle) * y
        pose[:, index, 1] += np.sin(angle) * x + np.cos(angle) * y
    return pose, after, before


def _cranks(model: Model) -> NDArray[np.intp]:
    return np.flatnonzero(np.any(model.origins != 0, axis=1))


def accelerations(model: Model, recording: Recording, dt: float) -> Array:
    """Accelerations (times - 1, bodies, 3) of the centres of mass at the samples after the first."""
    out = (recording.after[1:] - recording.before) / dt
    for index in _cranks(model):
        # The centre of mass of a crank turns about the pin at a constant rate.
        x, y = -model.origins[index]
        angle, rate = recording.pose[1:, index, 2], recording.after[1:, index, 2]
        out[:, index, 0] = -(rate**2) * (np.cos(angle) * x - np.sin(angle) * y)
        out[:, index, 1] = -(rate**2) * (np.sin(angle) * x + np.cos(angle) * y)
        out[:, index, 2] = 0
    return out


def inertias_and_gravity(model: Model) -> tuple[Array, tuple[float, float]]:
    """Masses and inertias (bodies, 3) [kg, kg, kg m^2] and gravity [m/s^2] in the space.

    Masses and inertias of a kinematic body are NaN. An infinite moment of inertia is replaced by NaN.
    """
    inertias = np.full((len(model.bodies), 3), np.nan)
    for row, body in zip(inertias, model.bodies, strict=True):
        if body.body_type == pymunk.Body.DYNAMIC:
            row[:] = body.mass, body.mass, body.moment if np.isfinite(body.moment) else np.nan
    x, y = model.space.gravity
    return inertias, (x / model.unit / model.unit, y / model.unit / model.unit)  # unit**2 may overflow or underflow


class PymunkRun(OneShot):
    def __init__(self, engine: Pymunk, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self.size: Size = engine.model(mechanism, dt).size

    def _started(self, plan: IterationPlan) -> Model:
        model = self._engine.model_with(self._mechanism, self._dt, plan)
        if self._engine.leapfrog:
            if self._engine.startup_steps:
                model.space.iterations = max(plan.converged, plan.iterations)
            model.kick(self._dt / model.unit / 2)
            model.space.iterations = plan.iterations
        return model

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        return self.watched(samples, every, 1)

    @validated
    def watched(self, samples: Count, every: Count, each: Count) -> Trajectory:
        """The trajectory of a run with reactions at every `each`-th sample; other reactions are NaN."""
        self._mechanism.require_room(samples)
        self.begin()
        # The plan is not part of the stepping time, since all runs of a mechanism use the same plan.
        plan = self._engine.plan(self._mechanism, samples * every * self._dt)
        model, startup = self._started(plan), plan.startup(self._engine.startup_steps)
        recording = record(model, self._dt, samples, every, raw=self._engine.leapfrog, startup=startup)
        pose, twist = recording.pose.copy(), recording.after.copy()
        pose[0], twist[0] = self._mechanism.pose, self._mechanism.twist
        with np.errstate(all="ignore"):
            if self._engine.leapfrog:
                twist[1:] = (recording.before + recording.after[1:]) / 2
            acceleration = accelerations(model, recording, self._dt)
        reaction = np.full((samples + 1, self._mechanism.row_count), np.nan)
        reaction[0] = self._start_reaction(plan)
        times = slice(each, None, each)
        reaction[times] = reactions(
            self._mechanism, pose[times], twist[times], acceleration[each - 1 :: each], *inertias_and_gravity(model)
        )
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        warnings = tuple(filter(None, (_convergence_warning(plan), recording.stopped)))
        return Trajectory(t, pose, twist, reaction, stepping=recording.stepping, warnings=warnings)

    def _start_reaction(self, plan: IterationPlan) -> Array:
        """The reactions (rows,) at t = 0, from the first steps of another model with converged iterations.

        The impulse of the first step contains a position correction of up to half the centripetal force. In each step
        this part decreases by a factor of order dt. Therefore the reaction of the third step is returned, with an error
        of order 1. In a leapfrog the third and fourth steps are extrapolated to t = 0, with an error of order 2.
        """
        model = self._started(replace(plan, iterations=plan.converged, gain=1.0))
        recording = record(model, self._dt, samples=4, every=1, raw=self._engine.leapfrog)
        with np.errstate(all="ignore"):
            acceleration = accelerations(model, recording, self._dt)
            loads = inertias_and_gravity(model)
            leapfrog = self._engine.leapfrog
            twist = (recording.before + recording.after[1:]) / 2 if leapfrog else recording.after[1:]
            third, fourth = reactions(self._mechanism, recording.pose[3:], twist[2:], acceleration[2:], *loads)
            return 4 * third - 3 * fourth if leapfrog else third


def _convergence_warning(plan: IterationPlan) -> RunWarning | None:
    if plan.gain < 1:
        text = f"ours: not converged, {plan.iterations} sweeps leave {plan.residual:.0%} of the slowest mode"
        return RunWarning(text, "unconverged", "adapter")
    if plan.converged_residual > MAX_START_RESIDUAL:
        left = f"{plan.converged_residual:.0e} of the slowest mode is left"
        text = f"ours: the reactions at the start are not converged, {left}"
        return RunWarning(text, "start reactions", "adapter")
    return None
