"""Stepping a pymunk model, copying its states out cheaply, and reading poses, twists and reactions from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import BodyFields, Buffer, get_space_bodies

from engines import OneShot, Size
from engines.extrapolated import UNCONVERGED
from engines.pymunk.contraction import Sweeping
from engines.pymunk.model import Model
from engines.sampling import reactions, sampled
from reference.checks import Count, validated
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

VELOCITIES = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
STATES = BodyFields.POSITION | BodyFields.ANGLE | VELOCITIES
# C grows an array a little before it is full, and ours are not its own to grow.
SPARE = 64
UNSETTLED = 1e-5  # of the slowest mode after the sweeps of the first reaction: beyond, it is told


class Recorder:
    """Copies the bodies of a space, in C, to the end of an array that is allocated before.

    `lib.cpSpaceEachBody(space, visitor, states)`, or with `velocities`, copies one record.
    """

    def __init__(self, space: pymunk.Space, bodies: tuple[pymunk.Body, ...], states: int, velocities: int) -> None:
        visited = visited_bodies(space)
        self._order = [visited.index(body.id) for body in bodies]
        self._count = len(visited)
        length = (6 * states + 3 * velocities) * self._count
        room = np.full(length + SPARE, np.nan)
        self.values = room[:length]
        floats = ffi.from_buffer("double[]", room)
        integers = ffi.new("pmIntArray *")
        target = ffi.new("pmFloatArray *", {"num": 0, "max": len(floats), "arr": floats})
        self._owned = (floats, integers, target)  # C holds bare pointers to these
        self.visitor = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self.states, self.velocities = (
            ffi.new("pmBatchedData *", {"intArray": integers, "floatArray": target, "fields": fields.value})
            for fields in (STATES, VELOCITIES)
        )

    def read(self, samples: int, with_velocities: bool) -> tuple[Array, Array]:
        """States (samples + 1, bodies, 6) and the velocities one step before each (samples, bodies, 3).

        In the array stands a state, then for every sample, if `with_velocities`, velocities and a state, else a state.
        """
        first, rest = np.split(self.values, [6 * self._count])
        rest = rest.reshape(samples, -1)
        split = 3 * self._count if with_velocities else 0
        states = np.concatenate([first[None], rest[:, split:]]).reshape(samples + 1, self._count, 6)
        before = rest[:, :split].reshape(samples, self._count, 3) if with_velocities else states[:-1, :, 3:]
        return states[:, self._order], before[:, self._order]


def visited_bodies(space: pymunk.Space) -> list[int]:
    """The ids of a space's bodies in the order in which C visits them, which is not the order of adding."""
    buffer = Buffer()
    get_space_bodies(space, BodyFields.BODY_ID, buffer)
    return list(memoryview(buffer.int_buf()).cast("P"))


@dataclass(frozen=True)
class Recording:
    """What the engine held at the samples, in the mechanism's order and frame."""

    pose: Array  # (times, bodies, 3) at t
    after: Array  # (times, bodies, 3) the engine's velocities with p(t): those of t, or of t + dt/2 in a leapfrog
    before: Array  # (times - 1, bodies, 3) its velocities a step earlier, from the second sample on
    stepping: float  # s
    stopped: str = ""  # why the stepping ended early, if it did: from there on everything is NaN


def record(
    model: Model,
    dt: float,
    samples: int,
    every: int,
    raw: bool,
    settling: Sequence[int] = (),
) -> Recording:
    """Step samples * every times and keep every `every`-th state, with the velocities of the step before it.

    `settling`: the iterations of the first steps.
    """
    velocities = every > 1
    recorder = Recorder(model.space, model.bodies, samples + 1, samples if velocities else 0)
    visit_each, pointer = lib.cpSpaceEachBody, model.space._space
    step, space = model.stepper(raw)
    dt /= model.unit
    visitor, before, after = recorder.visitor, recorder.velocities, recorder.states
    stopped = ""
    own = model.space.iterations
    first = [own, *reversed(settling)] if settling else []  # the last one stays

    def advance(count: int) -> bool:
        nonlocal stopped
        try:
            for _ in range(count):
                if first:
                    lib.cpSpaceSetIterations(pointer, first.pop())
                step(space, dt)
        except (ValueError, ArithmeticError) as reason:  # a joint that our code places has no place any more
            stopped = f"ours: stopped, as a joint could no longer be placed ({reason})"
        return bool(stopped)

    stepping = sampled(
        [every] * samples,
        advance,
        lambda _: visit_each(pointer, visitor, after),
        (lambda _: visit_each(pointer, visitor, before)) if velocities else None,
    )
    states, earlier = recorder.read(samples, velocities)
    with np.errstate(all="ignore"):  # a motion that blew up is a result
        states[..., 3:] /= model.unit
        earlier = earlier / model.unit if velocities else states[:-1, :, 3:]
        return Recording(*_of_mass_centres(model, states, earlier), stepping, stopped)


def _of_mass_centres(model: Model, states: Array, earlier: Array) -> tuple[Array, Array, Array]:
    """Move poses and velocities from the engine's origins to the centres of mass: cranks have theirs at the pin."""
    pose, after, before = states[..., :3].copy(), states[..., 3:].copy(), earlier.copy()
    for index in np.flatnonzero(np.any(model.origins != 0, axis=1)):
        x, y = -model.origins[index]
        for velocity, angle in (
            (after[:, index], pose[:, index, 2]),
            (before[:, index], pose[1:, index, 2]),
        ):
            velocity[:, 0] -= velocity[:, 2] * (np.sin(angle) * x + np.cos(angle) * y)
            velocity[:, 1] += velocity[:, 2] * (np.cos(angle) * x - np.sin(angle) * y)
        angle = pose[:, index, 2]
        pose[:, index, 0] += np.cos(angle) * x - np.sin(angle) * y
        pose[:, index, 1] += np.sin(angle) * x + np.cos(angle) * y
    return pose, after, before


def accelerations(model: Model, recording: Recording, dt: float) -> Array:
    """Accelerations (times - 1, bodies, 3) of the centres of mass at the samples after the first."""
    out = (recording.after[1:] - recording.before) / dt
    for index in np.flatnonzero(np.any(model.origins != 0, axis=1)):
        # A crank's rate is constant, and its centre turns about the pin.
        x, y = -model.origins[index]
        angle, rate = recording.pose[1:, index, 2], recording.after[1:, index, 2]
        out[:, index, 0] = -(rate**2) * (np.cos(angle) * x - np.sin(angle) * y)
        out[:, index, 1] = -(rate**2) * (np.sin(angle) * x + np.cos(angle) * y)
        out[:, index, 2] = 0
    return out


def loads(model: Model) -> tuple[Array, tuple[float, float]]:
    """Masses and inertias (bodies, 3) [kg, kg, kg m^2] and gravity [m/s^2] that the engine's objects hold.

    NaN where it needs none, as the motion is prescribed: of a kinematic body, and the inertia of one that can't turn.
    """
    inertias = np.full((len(model.bodies), 3), np.nan)
    for own, body in zip(inertias, model.bodies, strict=True):
        if body.body_type == pymunk.Body.DYNAMIC:
            own[:] = body.mass, body.mass, body.moment if np.isfinite(body.moment) else np.nan
    x, y = model.space.gravity
    return inertias, (x / model.unit / model.unit, y / model.unit / model.unit)  # a unit squared may overflow


class PymunkRun(OneShot):
    """One model, ready to be stepped once; see `engines.Run`."""

    def __init__(
        self,
        mechanism: Mechanism,
        dt: float,
        make: Callable[[Sweeping], Model],
        swept: Callable[[float], Sweeping],
        leapfrog: bool,
        settled: int,
    ) -> None:
        """`make` builds the model, `swept` tells how it is swept in a motion of so many seconds.

        `settled`: see `Sweeping.settling`.
        """
        self._mechanism, self._dt, self._make, self._swept = mechanism, dt, make, swept
        self._leapfrog, self._settled = leapfrog, settled
        self.size: Size = make(swept(0.0)).size

    def _started(self, sweeping: Sweeping) -> Model:
        """The model, half a kick ahead if it is a leapfrog."""
        model = self._make(sweeping)
        if self._leapfrog:
            if self._settled:
                model.space.iterations = max(sweeping.converged, sweeping.iterations)
            model.kick(self._dt / model.unit / 2)
            model.space.iterations = sweeping.iterations
        return model

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        return self.watched(samples, every, 1)

    @validated
    def watched(self, samples: Count, every: Count, each: Count) -> Trajectory:
        """The same, with reactions at every `each`-th sample alone, and NaN at the others."""
        self._mechanism.require_room(samples)
        self.begin()
        sweeping = self._swept(samples * every * self._dt)  # no part of stepping: a plan serves all runs of a mechanism
        model, settling = self._started(sweeping), sweeping.settling(self._settled)
        recording = record(model, self._dt, samples, every, raw=self._leapfrog, settling=settling)
        pose, twist = recording.pose.copy(), recording.after.copy()
        pose[0], twist[0] = self._mechanism.pose, self._mechanism.twist
        with np.errstate(all="ignore"):
            if self._leapfrog:
                twist[1:] = (recording.before + recording.after[1:]) / 2
            acceleration = accelerations(model, recording, self._dt)
        reaction = np.full((samples + 1, self._mechanism.row_count), np.nan)
        reaction[0] = self._start_reaction(sweeping)
        told = slice(each, None, each)
        reaction[told] = reactions(
            self._mechanism, recording.pose[told], twist[told], acceleration[each - 1 :: each], *loads(model)
        )
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        warnings = tuple(filter(None, (self._unconverged(sweeping), recording.stopped)))
        return Trajectory(t, pose, twist, reaction, stepping=recording.stepping, warnings=warnings)

    def _start_reaction(self, sweeping: Sweeping) -> Array:
        """The reactions (rows,) at t = 0, where no step lies behind, from a twin that takes the first steps apart.

        The twin makes enough sweeps that the cold start of the impulses does not matter. The force of its first step
        will not do: it closes a gap for the first time, and so has up to half of the centripetal part too much; what is
        left of this falls by one order of dt a step. As a user reads it, the third step's force stands here, first
        order in dt. In a leapfrog the third and the fourth are extrapolated to zero: second order.
        """
        model = self._started(replace(sweeping, iterations=sweeping.converged, gain=1.0))
        recording = record(model, self._dt, samples=4, every=1, raw=self._leapfrog)
        with np.errstate(all="ignore"):
            acceleration = accelerations(model, recording, self._dt)
            held = loads(model)
            twist = (recording.before + recording.after[1:]) / 2 if self._leapfrog else recording.after[1:]
            third, fourth = reactions(self._mechanism, recording.pose[3:], twist[2:], acceleration[2:], *held)
            return 4 * third - 3 * fourth if self._leapfrog else third

    def _unconverged(self, sweeping: Sweeping) -> str:
        """What is to be said of the sweeps."""
        if sweeping.gain < 1:
            return f"{UNCONVERGED}, {sweeping.iterations} sweeps leave {sweeping.left:.0%} of the slowest mode"
        if sweeping.unsettled > UNSETTLED:
            return (
                "ours: the reactions at the start are not converged, "
                f"{sweeping.unsettled:.0e} of the slowest mode is left"
            )
        return ""
