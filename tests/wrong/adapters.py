"""Engines with one mistake, which `engines.conformance` and the gates must find."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from engines import Engine, EngineWrapper, NotDeclared, Regularisation
from engines.pymunk import LEAPFROG
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from tests.wrong.builds import (
    Build,
    Calls,
    Spoiled,
    after,
    always_on_the_body,
    any_count,
    any_step,
    before,
    from_neighbours,
    from_the_ground_up,
    goes_on,
    kicked_start,
    moved,
    noisy,
    one_long_step,
    pins_first,
    refusing,
    right,
    right_handed,
    time_without_every,
    times,
    unsupported,
    wall_clock,
    walled,
    wrapped,
    written_into,
)
from tests.wrong.mistakes import Mistake


@dataclass(frozen=True)
class Wrong(EngineWrapper):
    """A correct engine with the mistake that `variant` names, in a run or in a declaration."""

    variant: str
    engine: Engine = LEAPFROG
    name: str = "wrong"  # pyright: ignore[reportIncompatibleMethodOverride]

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        building = {**MISTAKES, **SMALL_MISTAKES}.get(self.variant, ("", right))[1]
        return building(self.engine, mechanism, dt)


def answer_of(member: str) -> Callable[..., Any]:
    """The member of the correct engine, or the wrong function that the variant names."""

    def answer(self: Wrong, *arguments: Any) -> Any:
        _, wrong, function = ANSWERS.get(self.variant, ("", "", None))
        return function(*arguments) if function and wrong == member else getattr(self.engine, member)(*arguments)

    return answer


for member in ("order", "step_cost", "enforcement", "regularisation", "inner_steps"):
    setattr(Wrong, member, answer_of(member))


HALF_STEP_LATE = "velocities are half a step late"
# A mapping from mistakes to the first check that finds the mistake and the function that builds the wrong run.
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
        after(lambda run, m, dt: replace(run, reaction=run.reaction[:, :0])),
    ),
    "the size is not told": ("tells_the_size_of_its_model", lambda inner, m, dt: Calls(None, inner.build(m, dt))),
    "time forgets the steps between samples": ("samples_at_the_right_times", time_without_every),
    "the cost is in milliseconds": ("tells_the_cpu_time_of_stepping", times("stepping", 1e3)),
    "the cost is negative": ("tells_the_cpu_time_of_stepping", times("stepping", -1.0)),
    "the cost is of the wall's clock": ("tells_the_cpu_time_of_stepping", wall_clock),
    "the state after the first step comes first": (
        "first_pose_is_the_start",
        from_neighbours(lambda now, later, earlier: later, True, "pose", "twist", "reaction"),
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
        after(lambda run, m, dt: moved(run, "pose", run.twist * dt / 2)),
    ),
    HALF_STEP_LATE: (
        "twists_stand_at_their_instants",
        from_neighbours(lambda now, later, earlier: (now + later) / 2, False, "twist"),
    ),
    "velocities are of the step before": (
        "twists_stand_at_their_instants",
        from_neighbours(lambda now, later, earlier: earlier, False, "twist"),
    ),
    "poses are of first order": (
        "poses_have_their_order",
        after(lambda run, m, dt: moved(run, "pose", dt * run.t[:, None, None] ** 2)),
    ),
    "velocities are of first order": (
        "twists_have_their_order",
        after(lambda run, m, dt: moved(run, "twist", 5 * dt * run.t[:, None, None] ** 2)),
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
    """Make one number of every model wrong, in the middle body or in gravity."""

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
    """Make steps that are 1 % too long, and return the times of correct steps."""
    return Spoiled(inner.build(mechanism, 1.01 * dt), lambda run: replace(run, t=run.t / 1.01))


# Mistakes for the gate of theory, of which some are too small for the conformance checks.
SMALL_MISTAKES: dict[str, tuple[str, Build]] = {
    "a mass is 1 % off": ("", numbers_off("mass", 1e-2)),
    "a mass is 0.1 % off": ("", numbers_off("mass", 1e-3)),
    "an inertia is 10 % off": ("", numbers_off("inertia", 1e-1)),
    "gravity is 9.80": ("", numbers_off("gravity", 9.80 / 9.81 - 1)),
    "steps are 1 % longer": ("", longer_steps),
    "the drive turns the other way": ("", before(driven_backwards)),
    "velocities are 1.001 times as large": ("", times("twist", 1.001)),
    "poses are of single precision": (
        "",
        after(lambda run, m, dt: replace(run, pose=run.pose.astype(np.float32).astype(float))),
    ),
    "reactions are 1.01 times as large": ("", times("reaction", 1.01)),
    "reactions are 1.1 times as large": ("", times("reaction", 1.1)),
    "reactions are no numbers": ("", times("reaction", np.nan)),
}
# A mapping from mistakes to the check that finds the mistake, the engine's member and the wrong function.
ANSWERS: dict[str, tuple[str, str, Callable[..., Any]]] = {
    "the order is a number": ("promises_an_order", "order", lambda mechanism: 2),
    "an order is refused in a word": ("promises_an_order", "order", lambda mechanism: NotDeclared("no")),
    "a step costs nothing": ("tells_what_a_step_costs", "step_cost", lambda mechanism: 0.0),
    "a step's cost is measured": (
        "tells_what_a_step_costs",
        "step_cost",
        lambda mechanism: 1e-6 + 1e-9 * time.perf_counter(),
    ),
    "who holds a skate is told in another word": (
        "tells_who_holds_a_joint",
        "enforcement",
        lambda joint, mechanism: "us" if isinstance(joint, Skate) else "engine",
    ),
    "softness counts joints": (
        "tells_how_joints_give_way",
        "regularisation",
        lambda mechanism, dt: Regularisation(1.0, 1.0, 0.0, (True,) * len(mechanism.joints)),
    ),
    "runs are counted instead of their steps": ("tells_the_steps_of_its_runs", "inner_steps", lambda mechanism: 5),
}


@dataclass(frozen=True)
class TwoLines(Wrong):
    family: str = "two\nlines"  # pyright: ignore[reportIncompatibleMethodOverride]


@dataclass
class Changeable(EngineWrapper):
    """An engine that is not frozen."""

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
    """An engine whose class is local, so that it can't be pickled."""

    @dataclass(frozen=True)
    class Local(Wrong):
        pass

    return Local("nothing")


@dataclass(frozen=True)
class Forgetful(Wrong):
    """An engine with an attribute that is no field, so that pickling loses it."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_factor", 0.5)

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update({**state, "_factor": 1.0})

    def build(self, mechanism: Mechanism, dt: float) -> Any:
        return self.engine.build(replace(mechanism, gravity=(0.0, vars(self)["_factor"] * mechanism.gravity[1])), dt)


@dataclass(frozen=True)
class Imported(Wrong):
    packages: tuple[str, ...] = ("_pymunk_cffi_backend",)  # pyright: ignore[reportIncompatibleMethodOverride]


# A mapping from mistakes to the check that finds the mistake and the wrong engine.
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
HALF_A_STEP_LATE = Wrong(HALF_STEP_LATE)
NO_ENGINES: tuple[Wrong, ...] = ()
