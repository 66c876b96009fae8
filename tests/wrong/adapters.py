"""Engines with one mistake each, around a right one: what `engines.conformance` and the gates have to find."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from engines import Around, Engine, Run, Softness, Unpromised, Unsupported
from engines.pymunk import LEAPFROG
from reference.checks import Count, validated
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from tests.wrong.mistakes import Mistake

Build = Callable[[Engine, Mechanism, float], Any]


@dataclass(frozen=True)
class Wrong(Around):
    """A right engine with the mistake that its variant names: in what it builds, or in an answer about itself."""

    variant: str
    engine: Engine = LEAPFROG
    name: str = "wrong"  # pyright: ignore[reportIncompatibleMethodOverride]

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        building = {**MISTAKES, **SMALL}.get(self.variant, ("", right))[1]
        return building(self.engine, mechanism, dt)


def answer_of(member: str) -> Callable[..., Any]:
    """The method that gives the right engine's answer, or the mistake's."""

    def answer(self: Wrong, *arguments: Any) -> Any:
        _, wrong, given = ANSWERS.get(self.variant, ("", "", None))
        return given(*arguments) if given and wrong == member else getattr(self.engine, member)(*arguments)

    return answer


for MEMBER in ("order", "step_cost", "holder", "softness", "steps_of_runs"):
    setattr(Wrong, MEMBER, answer_of(MEMBER))


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
    return after(lambda given, mechanism, dt: replace(given, **{name: factor * getattr(given, name)}))


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


LATE = "velocities are half a step late"
# By the name of the mistake: the check that finds it before any other, and how the wrong engine builds.
MISTAKES: dict[str, tuple[str, Build]] = {
    "a kind of joint is looked up": (
        "builds_or_refuses",
        refusing(lambda own: [{Pin: 1, Drive: 1, Skate: 1}[type(joint)] for joint in own.joints]),
    ),
    "a refusal of two words": ("builds_or_refuses", refusing(unsupported("no slots", Slot))),
    "nothing is built": ("builds_at_least_one", refusing(unsupported("the package is not installed here", object))),
    "the first joint is looked at": ("refuses_odd_mechanisms", refusing(lambda own: own.joints[0])),
    "forces are not looked at": ("feels_forces_or_refuses_them", before(lambda own: replace(own, forces=()))),
    "a bad step is replaced": ("refuses_bad_steps", any_step),
    "a bad count is replaced": ("refuses_bad_counts", any_count),
    "a second call goes on": ("refuses_a_second_call", goes_on),
    "reactions are left out": (
        "has_the_right_shapes",
        after(lambda given, mechanism, dt: replace(given, reaction=given.reaction[:, :0])),
    ),
    "the size is not told": (
        "tells_the_size_of_its_model",
        lambda inner, mechanism, dt: Calls(None, inner.build(mechanism, dt)),
    ),
    "time forgets the steps between samples": ("samples_at_the_right_times", time_without_every),
    "the cost is in milliseconds": ("tells_the_cpu_time_of_stepping", times("stepping", 1e3)),
    "the cost is negative": ("tells_the_cpu_time_of_stepping", times("stepping", -1.0)),
    "the cost is of the wall's clock": ("tells_the_cpu_time_of_stepping", wall_clock),
    "the state after the first step comes first": (
        "first_pose_is_the_start",
        told_by(lambda now, following, earlier: following, True, "pose", "twist", "reaction"),
    ),
    "the first velocity has had half a kick": ("first_twist_is_the_start", after(kicked_start)),
    "random noise": ("gives_the_same_bits", after(noisy)),
    "the mechanism is written into": ("leaves_the_mechanism_alone", written_into),
    "steps between samples are one long step": ("sampling_changes_nothing", one_long_step),
    "angles are wrapped": ("does_not_wrap_angles", after(wrapped)),
    "reactions have the other sign": ("reactions_have_sign_and_size", times("reaction", -1.0)),
    "reactions are twice as large": ("reactions_have_sign_and_size", times("reaction", 2.0)),
    "poses are half a step late": (
        "poses_stand_at_their_instants",
        after(lambda given, mechanism, dt: moved(given, "pose", given.twist * dt / 2)),
    ),
    LATE: (
        "twists_stand_at_their_instants",
        told_by(lambda now, following, earlier: (now + following) / 2, False, "twist"),
    ),
    "velocities are of the step before": (
        "twists_stand_at_their_instants",
        told_by(lambda now, following, earlier: earlier, False, "twist"),
    ),
    "poses are of first order": (
        "poses_have_their_order",
        after(lambda given, mechanism, dt: moved(given, "pose", dt * given.t[:, None, None] ** 2)),
    ),
    "velocities are of first order": (
        "twists_have_their_order",
        after(lambda given, mechanism, dt: moved(given, "twist", 5 * dt * given.t[:, None, None] ** 2)),
    ),
    "gravity points down": (
        "same_if_turned",
        before(lambda own: replace(own, gravity=(0.0, -float(np.hypot(*own.gravity))))),
    ),
    "there are walls": ("same_if_shifted", after(walled)),
    "a blade's angle has no sign": ("same_if_mirrored", before(right_handed)),
    "names are ASCII": ("same_if_relabelled", refusing(lambda own: [body.name.encode("ascii") for body in own.bodies])),
    "bodies are told from the ground up": ("same_if_bodies_are_reordered", after(from_the_ground_up)),
    "reactions of pins are told first": ("same_if_joints_are_reordered", after(pins_first)),
    "reactions are always of the body": ("same_if_bodies_of_joints_are_swapped", after(always_on_the_body)),
}


def numbers_off(kind: str, relative: float) -> Build:
    """The mistake of a number that is off in every model: of the middle body, or of gravity."""

    def change(mechanism: Mechanism) -> Mechanism:
        owner = "" if kind == "gravity" else mechanism.bodies[len(mechanism.bodies) // 2].name
        return Mistake(kind, owner).made(mechanism, relative)

    return before(change)


def driven_backwards(mechanism: Mechanism) -> Mechanism:
    joints = tuple(
        replace(joint, turning_rate=-joint.turning_rate) if isinstance(joint, Drive) else joint
        for joint in mechanism.joints
    )
    bodies = tuple(replace(body, twist=tuple(-value for value in body.twist)) for body in mechanism.bodies)
    return replace(mechanism, joints=joints, bodies=bodies)


def longer_steps(inner: Engine, mechanism: Mechanism, dt: float) -> Any:
    """Steps that are 1 % longer than those asked for, at the times of these."""
    return Spoiled(inner.build(mechanism, 1.01 * dt), lambda given: replace(given, t=given.t / 1.01))


# Mistakes of which some are smaller than what the conformance checks see; the gate of theory is asked.
SMALL: dict[str, tuple[str, Build]] = {
    "a mass is 1 % off": ("", numbers_off("mass", 1e-2)),
    "a mass is 0.1 % off": ("", numbers_off("mass", 1e-3)),
    "an inertia is 10 % off": ("", numbers_off("inertia", 1e-1)),
    "gravity is 9.80": ("", numbers_off("gravity", 9.80 / 9.81 - 1)),
    "steps are 1 % longer": ("", longer_steps),
    "the drive turns the other way": ("", before(driven_backwards)),
    "velocities are 1.001 times as large": ("", times("twist", 1.001)),
    "poses are of single precision": (
        "",
        after(lambda given, mechanism, dt: replace(given, pose=given.pose.astype(np.float32).astype(float))),
    ),
    "reactions are 1.01 times as large": ("", times("reaction", 1.01)),
    "reactions are 1.1 times as large": ("", times("reaction", 1.1)),
    "reactions are no numbers": ("", times("reaction", np.nan)),
}
# By the name of the mistake: the check that finds it, the member of the engine, and its wrong answer.
ANSWERS: dict[str, tuple[str, str, Callable[..., Any]]] = {
    "the order is a number": ("promises_an_order", "order", lambda mechanism: 2),
    "an order is refused in a word": ("promises_an_order", "order", lambda mechanism: Unpromised("no")),
    "a step costs nothing": ("tells_what_a_step_costs", "step_cost", lambda mechanism: 0.0),
    "a step's cost is measured": (
        "tells_what_a_step_costs",
        "step_cost",
        lambda mechanism: 1e-6 + 1e-9 * time.perf_counter(),
    ),
    "who holds a skate is told in another word": (
        "tells_who_holds_a_joint",
        "holder",
        lambda joint, mechanism: "us" if isinstance(joint, Skate) else "engine",
    ),
    "softness counts joints": (
        "tells_how_joints_give_way",
        "softness",
        lambda mechanism, dt: Softness(1.0, 1.0, 0.0, (True,) * len(mechanism.joints)),
    ),
    "runs are counted instead of their steps": ("tells_the_steps_of_its_runs", "steps_of_runs", lambda mechanism: 5),
}


@dataclass(frozen=True)
class TwoLines(Wrong):
    family: str = "two\nlines"  # pyright: ignore[reportIncompatibleMethodOverride]


@dataclass
class Changeable(Around):
    """Not frozen."""

    variant: str = "changeable"
    engine: Engine = LEAPFROG
    name: str = "wrong"  # pyright: ignore[reportIncompatibleMethodOverride]

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return self.engine.build(mechanism, dt)

    __hash__ = object.__hash__


@dataclass(frozen=True)
class Hiding(Wrong):
    iterations: int = field(default=10, repr=False)


@dataclass(frozen=True)
class Listing(Wrong):
    levels: list[int] = field(default_factory=lambda: [1, 2])


def local() -> Any:
    """An engine of a class that no other process finds."""

    @dataclass(frozen=True)
    class Local(Wrong):
        pass

    return Local("nothing")


@dataclass(frozen=True)
class Forgetful(Wrong):
    """An attribute that is no field is lost by pickle."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_factor", 0.5)

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update({**state, "_factor": 1.0})

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return self.engine.build(replace(mechanism, gravity=(0.0, vars(self)["_factor"] * mechanism.gravity[1])), dt)


@dataclass(frozen=True)
class Imported(Wrong):
    packages: tuple[str, ...] = ("_pymunk_cffi_backend",)  # pyright: ignore[reportIncompatibleMethodOverride]


# By the name of the mistake: the check that finds it, and the wrong engine.
WRONG: dict[str, tuple[str, Any]] = {
    **{name: (check, Wrong(name)) for name, (check, *_) in {**MISTAKES, **ANSWERS}.items()},
    "the family has two lines": ("has_a_name", TwoLines("nothing")),
    "it can be changed": ("is_a_frozen_dataclass", Changeable()),
    "a setting is not shown": ("is_a_frozen_dataclass", Hiding("nothing")),
    "a setting is a list": ("can_be_hashed", Listing("nothing")),
    "its class is local": ("can_be_pickled", local()),
    "what is no field is lost": ("can_be_pickled", Forgetful("nothing")),
    "a package has another name": ("names_its_packages", Imported("nothing")),
}
HALF_A_STEP_LATE = Wrong(LATE)
NO_ENGINES: tuple[Wrong, ...] = ()
