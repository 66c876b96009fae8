"""Adapters with one mistake each, around a right one: what the checks of `engines.conformance` have to find."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engines import Around, Engine, Run, Unsupported
from engines.pymunk import LEAPFROG
from reference.checks import Count, validated
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from tests.wrong.mistakes import Mistake

Build = Callable[[Mechanism, float], Any]


@dataclass(frozen=True)
class Wrong(Around):
    """A right engine whose `build` or whose run is spoiled as MISTAKES says of its variant."""

    variant: str
    engine: Engine = LEAPFROG
    name: str = "wrong"  # pyright: ignore[reportIncompatibleMethodOverride]

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return {**MISTAKES, **SMALL}[self.variant](self.engine, mechanism, dt)


class Spoiled:
    """A run whose trajectory is changed before it is given; `size` is that of the right one."""

    def __init__(self, run: Run, spoil: Callable[[Trajectory], Trajectory]) -> None:
        self._run, self._spoil = run, spoil
        self.size = run.size

    def __call__(self, samples: int, every: int) -> Trajectory:
        return self._spoil(self._run(samples, every))


def after(spoil: Callable[[Trajectory, Mechanism, float], Trajectory]) -> Callable[..., Any]:
    """The mistake of changing what a right run gives."""
    return lambda inner, mechanism, dt: Spoiled(inner.build(mechanism, dt), lambda given: spoil(given, mechanism, dt))


def moved(given: Trajectory, name: str, by: Any) -> Trajectory:
    """With something added to one array, from the second sample on."""
    values = getattr(given, name).copy()
    values[1:] += np.broadcast_to(by, values.shape)[1:]
    return replace(given, **{name: values})


class Careless:
    """A run that is what a function of (samples, every) says, whatever these are."""

    def __init__(self, size: Any, call: Callable[[int, int], Any]) -> None:
        self.size, self._call = size, call

    def __call__(self, samples: Any, every: Any) -> Any:
        return self._call(samples, every)


class Calls(Careless):
    """The same, for counts that can be."""

    @validated
    def __call__(self, samples: Count, every: Count) -> Any:
        return self._call(samples, every)


def key_error(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    known = {Pin: "pivot", Drive: "motor", Skate: "groove"}
    assert all(known[type(joint)] for joint in mechanism.joints)
    return inner.build(mechanism, dt)


def terse(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    if any(isinstance(joint, Slot) for joint in mechanism.joints):
        raise Unsupported("no slots")
    return inner.build(mechanism, dt)


def refuses_all(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    raise Unsupported("the package that would do this is not installed")


def needs_joints(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    assert mechanism.joints[0] is not None  # IndexError without any
    return inner.build(mechanism, dt)


def any_step(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return inner.build(mechanism, dt if isinstance(dt, float) and 0 < dt < np.inf else 0.01)


def any_count(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)
    return Careless(run.size, lambda samples, every: run(max(1, int(samples)), every))


def goes_on(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """A second call gives what comes after the first."""
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


def without_reactions(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, reaction=given.reaction[:, :0])


def without_size(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return Calls(None, inner.build(mechanism, dt))


def time_without_every(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)
    return Calls(run.size, lambda samples, every: replace(run(samples, every), t=np.arange(samples + 1) * dt))


def milliseconds(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, stepping=1e3 * given.stepping)


def negative_cost(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, stepping=-given.stepping)


def wall_clock(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        begin = time.perf_counter()
        time.sleep(0.002)
        given = run(samples, every)
        return replace(given, stepping=time.perf_counter() - begin)

    return Calls(run.size, call)


def second_first(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """The first sample is taken after the first step."""
    return told_by(inner, mechanism, dt, lambda now, following, before: following, True, ("pose", "twist", "reaction"))


def told_by(
    inner: Engine,
    mechanism: Mechanism,
    dt: float,
    tell: Callable[[Any, Any, Any], Any],
    first: bool,
    names: tuple[str, ...],
) -> Any:
    """Samples told by the states at them, a step later and a step before; the `first` sample too, or as it is."""
    run = inner.build(mechanism, dt)

    def call(samples: int, every: int) -> Trajectory:
        fine = run(samples * every + 1, 1)
        parts = {name: getattr(fine, name)[:-1:every].copy() for name in ("pose", "twist", "reaction")}
        for name in names:
            whole = getattr(fine, name)
            before = np.concatenate([whole[:1], whole])[: samples * every + 1 : every]
            told = tell(parts[name], whole[1::every], before)
            parts[name][0 if first else 1 :] = told[0 if first else 1 :]
        return replace(fine, t=np.arange(samples + 1) * every * dt, **parts)

    return Calls(run.size, call)


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


def other_sign(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, reaction=-given.reaction)


def double_force(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, reaction=2 * given.reaction)


def pose_half_a_step_late(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return moved(given, "pose", given.twist * dt / 2)


def twist_half_a_step_late(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return told_by(inner, mechanism, dt, lambda now, following, before: (now + following) / 2, False, ("twist",))


def twist_a_step_early(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return told_by(inner, mechanism, dt, lambda now, following, before: before, False, ("twist",))


def first_order_poses(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return moved(given, "pose", dt * given.t[:, None, None] ** 2)


def first_order_twists(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return moved(given, "twist", 5 * dt * given.t[:, None, None] ** 2)


def gravity_down(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    return inner.build(replace(mechanism, gravity=(0.0, -float(np.hypot(*mechanism.gravity)))), dt)


def walled(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    """A box of six metres stands around the origin."""
    beyond = np.where(np.abs(mechanism.pose[:, 0]) > 3.0, given.t[:, None] ** 2, 0.0)
    return moved(given, "pose", beyond[..., None])


def right_handed(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    joints = tuple(replace(j, angle=abs(j.angle)) if isinstance(j, Skate) else j for j in mechanism.joints)
    return inner.build(replace(mechanism, joints=joints), dt)


def ascii_only(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    assert all(body.name.encode("ascii") for body in mechanism.bodies)
    return inner.build(mechanism, dt)


def from_the_ground_up(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Bodies that a joint holds on the ground are told first."""
    grounded = {name for j in mechanism.joints if None in (j.first, j.second) for name in (j.first, j.second)}
    order = sorted(range(len(mechanism.bodies)), key=lambda i: mechanism.bodies[i].name not in grounded)
    return Spoiled(
        inner.build(mechanism, dt),
        lambda given: replace(given, pose=given.pose[:, order], twist=given.twist[:, order]),
    )


def pins_first(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Reactions of pins are told first."""
    kinds = [not isinstance(joint, Pin) for joint in mechanism.joints for _ in range(joint.size)]
    order = sorted(range(len(kinds)), key=kinds.__getitem__)
    return Spoiled(inner.build(mechanism, dt), lambda given: replace(given, reaction=given.reaction[:, order]))


def always_on_the_body(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Reactions of joints with the ground are told as forces on the body, whichever is named second."""
    signs = [-1.0 if joint.second is None else 1.0 for joint in mechanism.joints for _ in range(joint.size)]
    return Spoiled(inner.build(mechanism, dt), lambda given: replace(given, reaction=given.reaction * signs))


# Mistake -> how it builds; the check that is named like it in FOUND_BY has to find it.
MISTAKES: dict[str, Callable[..., Any]] = {
    "nothing": lambda inner, mechanism, dt: inner.build(mechanism, dt),
    "a kind of joint is looked up": key_error,
    "a refusal of two words": terse,
    "nothing is built": refuses_all,
    "the first joint is looked at": needs_joints,
    "forces are not looked at": lambda inner, mechanism, dt: inner.build(replace(mechanism, forces=()), dt),
    "a bad step is replaced": any_step,
    "a bad count is replaced": any_count,
    "a second call goes on": goes_on,
    "reactions are left out": after(without_reactions),
    "the size is not told": without_size,
    "time forgets the steps between samples": time_without_every,
    "the cost is in milliseconds": after(milliseconds),
    "the cost is negative": after(negative_cost),
    "the cost is of the wall's clock": wall_clock,
    "the state after the first step comes first": second_first,
    "the first velocity has had half a kick": after(kicked_start),
    "random noise": after(noisy),
    "the mechanism is written into": written_into,
    "steps between samples are one long step": one_long_step,
    "angles are wrapped": after(wrapped),
    "reactions have the other sign": after(other_sign),
    "reactions are twice as large": after(double_force),
    "poses are half a step late": after(pose_half_a_step_late),
    "velocities are half a step late": twist_half_a_step_late,
    "velocities are of the step before": twist_a_step_early,
    "poses are of first order": after(first_order_poses),
    "velocities are of first order": after(first_order_twists),
    "gravity points down": gravity_down,
    "there are walls": after(walled),
    "a blade's angle has no sign": right_handed,
    "names are ASCII": ascii_only,
    "bodies are told from the ground up": from_the_ground_up,
    "reactions of pins are told first": pins_first,
    "reactions are always of the body": always_on_the_body,
}


def numbers_off(kind: str, relative: float) -> Callable[..., Any]:
    """The mistake of a number that is off in every model: of the middle body, or of gravity."""

    def build(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
        owner = "" if kind == "gravity" else mechanism.bodies[len(mechanism.bodies) // 2].name
        return inner.build(Mistake(kind, owner).made(mechanism, relative), dt)

    return build


def driven_backwards(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    joints = tuple(
        replace(joint, turning_rate=-joint.turning_rate) if isinstance(joint, Drive) else joint
        for joint in mechanism.joints
    )
    bodies = tuple(replace(body, twist=tuple(-value for value in body.twist)) for body in mechanism.bodies)
    return inner.build(replace(mechanism, joints=joints, bodies=bodies), dt)


def times(name: str, factor: float) -> Callable[..., Any]:
    return after(lambda given, mechanism, dt: replace(given, **{name: factor * getattr(given, name)}))


def in_single_precision(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, pose=given.pose.astype(np.float32).astype(float))


def without_numbers(given: Trajectory, mechanism: Mechanism, dt: float) -> Trajectory:
    return replace(given, reaction=np.full_like(given.reaction, np.nan))


def longer_steps(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Steps that are 1 % longer than those asked for, told at the times of these."""
    return Spoiled(inner.build(mechanism, 1.01 * dt), lambda given: replace(given, t=given.t / 1.01))


# Mistakes of which some are smaller than what the questions of the conformance kit see: the gate of theory is asked.
SMALL: dict[str, Callable[..., Any]] = {
    "a mass is 1 % off": numbers_off("mass", 1e-2),
    "a mass is 0.1 % off": numbers_off("mass", 1e-3),
    "an inertia is 10 % off": numbers_off("inertia", 1e-1),
    "gravity is 9.80": numbers_off("gravity", 9.80 / 9.81 - 1),
    "steps are 1 % longer": longer_steps,
    "the drive turns the other way": driven_backwards,
    "velocities are 1.001 times as large": times("twist", 1.001),
    "poses are of single precision": after(in_single_precision),
    "reactions are 1.01 times as large": times("reaction", 1.01),
    "reactions are 1.1 times as large": times("reaction", 1.1),
    "reactions are no numbers": after(without_numbers),
}

HALF_A_STEP_LATE = Wrong("velocities are half a step late")
NO_ENGINES: tuple[Wrong, ...] = ()
