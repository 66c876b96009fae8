"""The mistakes that an adapter can make, each a function that builds a wrong run around a right engine."""

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
    """A run whose trajectory is changed before it is given; `size` is that of the right one."""

    def __init__(self, run: Run, spoil: Callable[[Trajectory], Trajectory]) -> None:
        self._run, self._spoil = run, spoil
        self.size = run.size

    def __call__(self, samples: int, every: int) -> Trajectory:
        return self._spoil(self._run(samples, every))


class Careless:
    """A run that calls a function of (samples, every), whatever these are."""

    def __init__(self, size: Any, call: Callable[[int, int], Any]) -> None:
        self.size, self._call = size, call

    def __call__(self, samples: Any, every: Any) -> Any:
        return self._call(samples, every)


class Calls(Careless):
    """The same, for valid counts."""

    @validated
    def __call__(self, samples: Count, every: Count) -> Any:
        return self._call(samples, every)


def right(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return inner.build(mechanism, dt)


def after(spoil: Callable[[Trajectory, Mechanism, float], Trajectory]) -> Build:
    """The mistake of changing the trajectory of a right run."""
    return lambda inner, mechanism, dt: Spoiled(inner.build(mechanism, dt), lambda given: spoil(given, mechanism, dt))


def before(change: Callable[[Mechanism], Mechanism]) -> Build:
    """The mistake of building another mechanism."""
    return lambda inner, mechanism, dt: inner.build(change(mechanism), dt)


def moved(given: Trajectory, name: str, by: Any) -> Trajectory:
    """With something added to one array, from the second sample on."""
    values = getattr(given, name).copy()
    values[1:] += np.broadcast_to(by, values.shape)[1:]
    return replace(given, **{name: values})


def times(name: str, factor: float) -> Build:
    return after(lambda run, m, dt: replace(run, **{name: factor * getattr(run, name)}))


def refusing(raise_if: Callable[[Mechanism], Any]) -> Build:
    """The mistake of failing, by whatever `raise_if` raises, for some mechanisms."""

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
    """A second call continues after the first."""
    done = 0

    def call(samples: int, every: int) -> Trajectory:
        nonlocal done
        whole = inner.build(mechanism, dt)(done + samples, every)
        part = slice(done, None)
        done += samples
        return replace(
            whole, t=whole.t[: samples + 1], **{k: getattr(whole, k)[part] for k in ("pose", "twist", "reaction")}
        )

    return Calls(inner.build(mechanism, dt).size, call)


def time_without_every(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)
    return Calls(run.size, lambda samples, every: replace(run(samples, every), t=np.arange(samples + 1) * dt))


def wall_clock(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        begin = time.perf_counter()
        time.sleep(0.002)
        given = run(samples, every)
        return replace(given, stepping=time.perf_counter() - begin)

    return Calls(run.size, call)


def told_by(tell: Callable[[Any, Any, Any], Any], first: bool, *names: str) -> Build:
    """Samples made of the states at them, a step later and a step before; the `first` sample too, or right."""

    def build(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
        run = inner.build(mechanism, dt)

        def call(samples: int, every: int) -> Trajectory:
            fine = run(samples * every + 1, 1)
            parts = {name: getattr(fine, name)[:-1:every].copy() for name in ("pose", "twist", "reaction")}
            for name in names:
                whole = getattr(fine, name)
                earlier = np.concatenate([whole[:1], whole])[: samples * every + 1 : every]
                told = tell(parts[name], whole[1::every], earlier)
                parts[name][0 if first else 1 :] = told[0 if first else 1 :]
            return replace(fine, t=np.arange(samples + 1) * every * dt, **parts)

        return Calls(run.size, call)

    return build


def kicked_start(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    twist = given.twist.copy()
    twist[0, :, 1] += mechanism.gravity[1] * dt / 2
    return replace(given, twist=twist)


NOISE = np.random.default_rng(1)


def noisy(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return moved(given, "pose", 1e-12 * NOISE.standard_normal(given.pose.shape))


def written_into(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        given = run(samples, every)
        mechanism.twist.flags.writeable = True  # against numpy's own refusal
        mechanism.twist[:] = given.twist[-1]
        return given

    return Calls(run.size, call)


def one_long_step(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    kept = [inner.build(mechanism, dt)]
    return Calls(kept[0].size, lambda samples, every: kept.pop() and inner.build(mechanism, dt * every)(samples, 1))


def wrapped(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    turned = given.pose[..., 2] - given.pose[0, :, 2]
    pose = given.pose.copy()
    pose[..., 2] = given.pose[0, :, 2] + np.arctan2(np.sin(turned), np.cos(turned))
    return replace(given, pose=pose)


def walled(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """A box of six metres stands around the origin."""
    beyond = np.where(np.abs(mechanism.pose[:, 0]) > 3.0, given.t[:, None] ** 2, 0.0)
    return moved(given, "pose", beyond[..., None])


def right_handed(mechanism: Mechanism) -> Mechanism:
    joints = tuple(replace(j, angle=abs(j.angle)) if isinstance(j, Skate) else j for j in mechanism.joints)
    return replace(mechanism, joints=joints)


def from_the_ground_up(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """Bodies that a joint holds on the ground come first."""
    grounded = {name for j in mechanism.joints if None in (j.first, j.second) for name in (j.first, j.second)}
    order = sorted(range(len(mechanism.bodies)), key=lambda i: mechanism.bodies[i].name not in grounded)
    return replace(given, pose=given.pose[:, order], twist=given.twist[:, order])


def pins_first(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    kinds = [not isinstance(joint, Pin) for joint in mechanism.joints for _ in range(joint.size)]
    return replace(given, reaction=given.reaction[:, sorted(range(len(kinds)), key=kinds.__getitem__)])


def always_on_the_body(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """Reactions of joints with the ground are forces on the body, whichever is named second."""
    signs = [-1.0 if joint.second is None else 1.0 for joint in mechanism.joints for _ in range(joint.size)]
    return replace(given, reaction=given.reaction * signs)
