"""Functions that build a wrong run with a correct engine."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from engines import Engine, Run, Unsupported
from reference.checks import Count, validated
from reference.joints import Pin, Skate
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Build = Callable[[Engine, Mechanism, float], Any]


class Spoiled:
    """A run of the same `size` as a correct run, whose trajectory is changed."""

    def __init__(self, run: Run, spoil: Callable[[Trajectory], Trajectory]) -> None:
        self._run, self._spoil = run, spoil
        self.size = run.size

    def __call__(self, samples: int, every: int) -> Trajectory:
        return self._spoil(self._run(samples, every))


class Careless:
    """A run that calls a function of (samples, every) without checks of these counts."""

    def __init__(self, size: Any, call: Callable[[int, int], Any]) -> None:
        self.size, self._call = size, call

    def __call__(self, samples: Any, every: Any) -> Any:
        return self._call(samples, every)


class Calls(Careless):
    """A run that calls a function of (samples, every) and refuses wrong counts."""

    @validated
    def __call__(self, samples: Count, every: Count) -> Any:
        return self._call(samples, every)


def right(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return inner.build(mechanism, dt)


def after(spoil: Callable[[Trajectory, Mechanism, float], Trajectory]) -> Build:
    """Change the trajectory of a correct run."""
    return lambda inner, mechanism, dt: Spoiled(inner.build(mechanism, dt), lambda run: spoil(run, mechanism, dt))


def before(change: Callable[[Mechanism], Mechanism]) -> Build:
    """Build another mechanism."""
    return lambda inner, mechanism, dt: inner.build(change(mechanism), dt)


def moved(trajectory: Trajectory, name: str, by: Any) -> Trajectory:
    """The trajectory with `by` added to one array after the first sample."""
    values = getattr(trajectory, name).copy()
    values[1:] += np.broadcast_to(by, values.shape)[1:]
    return replace(trajectory, **{name: values})


def times(name: str, factor: float) -> Build:
    return after(lambda run, m, dt: replace(run, **{name: factor * getattr(run, name)}))


def refusing(raise_if: Callable[[Mechanism], Any]) -> Build:
    """Build a run unless `raise_if` raises an error for the mechanism."""

    def build(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
        raise_if(mechanism)
        return inner.build(mechanism, dt)

    return build


def unsupported(reason: str, *kinds: type) -> Callable[[Mechanism], None]:
    """Refuse mechanisms with joints of these kinds."""

    def check(mechanism: Mechanism) -> None:
        if any(isinstance(joint, kinds) for joint in mechanism.joints):
            raise Unsupported(reason)

    return check


def any_step(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return inner.build(mechanism, dt if isinstance(dt, float) and 0 < dt < np.inf else 0.01)


def any_count(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)
    return Careless(run.size, lambda samples, every: run(max(1, int(samples)), every))


def goes_on(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Let a second call of a run continue the motion of the first call."""
    done = 0

    def call(samples: int, every: int) -> Trajectory:
        nonlocal done
        run = inner.build(mechanism, dt)(done + samples, every)
        arrays = {name: getattr(run, name)[done:] for name in ("pose", "twist", "reaction")}
        done += samples
        return replace(run, t=run.t[: samples + 1], **arrays)

    return Calls(inner.build(mechanism, dt).size, call)


def time_without_every(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)
    return Calls(run.size, lambda samples, every: replace(run(samples, every), t=np.arange(samples + 1) * dt))


def wall_clock(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        begin = time.perf_counter()
        time.sleep(0.002)
        trajectory = run(samples, every)
        return replace(trajectory, stepping=time.perf_counter() - begin)

    return Calls(run.size, call)


def from_neighbours(combine: Callable[[Any, Any, Any], Any], first: bool, *names: str) -> Build:
    """Combine the arrays at a sample, one step later and one step earlier.

    If `first`, the first sample is wrong too.
    """

    def build(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
        run = inner.build(mechanism, dt)

        def call(samples: int, every: int) -> Trajectory:
            fine = run(samples * every + 1, 1)
            parts = {name: getattr(fine, name)[:-1:every].copy() for name in ("pose", "twist", "reaction")}
            for name in names:
                states = getattr(fine, name)
                earlier = np.concatenate([states[:1], states])[: samples * every + 1 : every]
                wrong = combine(parts[name], states[1::every], earlier)
                parts[name][0 if first else 1 :] = wrong[0 if first else 1 :]
            return replace(fine, t=np.arange(samples + 1) * every * dt, **parts)

        return Calls(run.size, call)

    return build


def kicked_start(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    twist = trajectory.twist.copy()
    twist[0, :, 1] += mechanism.gravity[1] * dt / 2
    return replace(trajectory, twist=twist)


NOISE_GENERATOR = np.random.default_rng(1)


def noisy(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return moved(trajectory, "pose", 1e-12 * NOISE_GENERATOR.standard_normal(trajectory.pose.shape))


def written_into(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        trajectory = run(samples, every)
        mechanism.twist.flags.writeable = True
        mechanism.twist[:] = trajectory.twist[-1]
        return trajectory

    return Calls(run.size, call)


def one_long_step(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    runs = [inner.build(mechanism, dt)]
    return Calls(runs[0].size, lambda samples, every: runs.pop() and inner.build(mechanism, dt * every)(samples, 1))


def wrapped(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    turned = trajectory.pose[..., 2] - trajectory.pose[0, :, 2]
    pose = trajectory.pose.copy()
    pose[..., 2] = trajectory.pose[0, :, 2] + np.arctan2(np.sin(turned), np.cos(turned))
    return replace(trajectory, pose=pose)


def walled(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """Move bodies that start at |x| > 3 m, as walls around the origin would."""
    beyond = np.where(np.abs(mechanism.pose[:, 0]) > 3.0, trajectory.t[:, None] ** 2, 0.0)
    return moved(trajectory, "pose", beyond[..., None])


def right_handed(mechanism: Mechanism) -> Mechanism:
    joints = tuple(replace(j, angle=abs(j.angle)) if isinstance(j, Skate) else j for j in mechanism.joints)
    return replace(mechanism, joints=joints)


def from_the_ground_up(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """Reorder the bodies so that bodies with a joint to the ground come first."""
    grounded = {name for j in mechanism.joints if None in (j.first, j.second) for name in (j.first, j.second)}
    order = sorted(range(len(mechanism.bodies)), key=lambda i: mechanism.bodies[i].name not in grounded)
    return replace(trajectory, pose=trajectory.pose[:, order], twist=trajectory.twist[:, order])


def pins_first(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    other = [not isinstance(joint, Pin) for joint in mechanism.joints for _ in range(joint.size)]
    return replace(trajectory, reaction=trajectory.reaction[:, sorted(range(len(other)), key=other.__getitem__)])


def always_on_the_body(trajectory: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """Return reactions of joints with the ground as forces on the body, also if the ground is second."""
    signs = [-1.0 if joint.second is None else 1.0 for joint in mechanism.joints for _ in range(joint.size)]
    return replace(trajectory, reaction=trajectory.reaction * signs)
