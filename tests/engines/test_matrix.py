"""Tests of the accuracy of each construction of joints in pymunk and MuJoCo, with a table of errors and orders.

A row is compared with the exact motion of a scene, or with the exact solver if no scene has the mechanism.
`test_promised` tests the declared orders of all engines.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from engines import Engine, Unsupported, method_name, mujoco, pymunk
from engines.conformance.worlds import WORLDS
from engines.lagrange import TRUTH
from engines.mujoco import Hardened
from engines.mujoco.methods import ROLLS, SKATES, SLOTS
from engines.pymunk import methods
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line
from reference.rolling.kinematics import Rolling
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar, TenFourBars
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.person import OneFoot, TwoFeet
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank, FreeSliderCrank, SlottedLever
from reference.scenes.wheels.vehicles import CarAndTrailer
from reference.trajectory import Trajectory
from tests.mechanisms import four_bar, rolling_disc

SPACING = 1e-2  # s, between samples
FREE_COORDINATES = replace(mujoco.EXTENDED, variant="free coordinates", coordinates="free")
HALVES = replace(mujoco.EXTENDED, variant="halves", slots="halves")
FREE_HALVES = replace(FREE_COORDINATES, variant="free coordinates, halves", slots="halves")
TUNED_FREE = replace(mujoco.TUNED, variant="tuned, free coordinates", coordinates="free")
SOFT = replace(mujoco.EXTENDED, variant="shipped compliance", stiffness=Hardened(softening=1.0), estimates=False)
(BLADE,) = SKATES


# ------------------------------------------------------------------------------------- mechanisms that no scene has


def turned(by: float, x: float, y: float) -> np.ndarray:
    return np.array([math.cos(by) * x - math.sin(by) * y, math.sin(by) * x + math.cos(by) * y])


def across(arm: np.ndarray) -> np.ndarray:
    return np.array([-arm[1], arm[0]])


def placed(name: str, mass: float, inertia: float, centre: Any, angle: float, velocity: Any, rate: float) -> Body:
    x, y, along, up = map(float, (*centre, *velocity))
    return Body(name, mass, inertia, (x, y, angle), (along, up, rate))


def far_drive() -> Mechanism:
    """A four-bar with a drive between ground and coupler. The drive acts on the sum of two coordinates of a tree."""
    linkage = four_bar(crank_rate=10.0)
    return replace(linkage, joints=(*linkage.joints, Drive("far", None, "coupler", -5.0, linkage.bodies[1].pose[2])))


def blade_on_a_board() -> Mechanism:
    """A skate on a free board, without any other joint."""
    touch, ahead, rate = np.array([0.5, 0.0]), turned(0.4, 1.0, 0.0), 2.0
    velocity = [0.1, 0.0] + 0.5 * across(touch) + ahead + 0.5 * rate * across(ahead)
    sleigh = placed("sleigh", 2.0, 0.3, touch + 0.5 * ahead, 0.4, velocity, rate)
    board = Body("board", 3.0, 2.0, (0.0, 0.0, 0.2), (0.1, 0.0, 0.5))
    return Mechanism((board, sleigh), (Skate("skate", "board", "sleigh", (-0.5, 0.0)),))


def rod_in_a_slot() -> Mechanism:
    """A slider-crank without a slider. The end of the rod runs in the slot."""
    scene, linkage = DrivenSliderCrank(), DrivenSliderCrank().mechanism()
    guide = Slot("guide", None, "rod", (0.0, 0.0), 0.0, (scene.rod / 2, 0.0))
    return Mechanism(linkage.bodies[:2], (*linkage.joints[:2], guide, linkage.joints[5]), linkage.gravity)


def plate() -> Mechanism:
    """A plate under gravity with a slot. The point (0.3, 0.1) of the ground slides along the slot."""
    angle, rate, line, linkage = 0.5, 2.0, 0.7, (0.25, -0.1)
    offset = turned(angle, *linkage)
    velocity = 0.4 * turned(angle + line, 1.0, 0.0) - rate * across(offset)
    body = placed("plate", 0.8, 0.03, np.array([0.3, 0.1]) - offset, angle, velocity, rate)
    return Mechanism((body,), (Slot("slot", "plate", None, linkage, line, (0.3, 0.1)),), (0.0, -9.81))


TRAMMEL, BEAD = (
    next(world.mechanism for world in WORLDS if world.name == name) for name in ("trammel", "bead on a turning rod")
)

# --------------------------------------------------------------------------------------------------------- the table


@dataclass(frozen=True)
class Row:
    """The limits of the errors of a construction, and the orders of the errors.

    pose, twist: limits in m, rad and s.
    reaction: limit relative to the largest reaction or 1 N.
    every: number of steps for a sample.
    since: first sample whose reaction is checked.
    order: orders of pose, twist and reaction within `room`, measured with four times as many steps.
    floor: the least error of poses at any step.
    """

    engine: Engine
    subject: Scene | Mechanism
    every: int = 10
    pose: float = math.inf
    twist: float = math.inf
    reaction: float = math.inf
    order: tuple[float | None, ...] = ()
    room: float = 0.15
    floor: float = 0.0
    span: float = 0.5  # duration [s]
    since: int = 0

    def __str__(self) -> str:
        subject = self.subject
        numbers = "" if isinstance(subject, Mechanism) or subject == type(subject)() else " of other numbers"
        name = " ".join(body.name for body in subject.bodies) if isinstance(subject, Mechanism) else subject.name
        return f"{method_name(self.engine)}, {name}{numbers}, {self.every}"


def on(engine: Engine, subjects: Iterable[Scene | Mechanism], every: int = 10, **numbers: Any) -> list[Row]:
    return [Row(engine, subject, every, **numbers) for subject in subjects]


MOVING = four_bar(10.0)
FREE, DRIVEN, SLIDER, SLEIGH = FreeFourBar(), DrivenFourBar(), DrivenSliderCrank(), ChaplyginSleigh()
ROLLING = (RollingEllipse(), RollingDisc(), RollingInRing(), RollingOnCircle(), RollingCam(), RollingDownhill())
SLEIGHS = (*(ChaplyginSleigh(offset=offset) for offset in (0.5, -0.2, 0.0)), ChaplyginSleigh(turning_rate=-1.0))
CHAINS = (PointPendulum(), TenLinks(), NFourBar(), TenFourBars(), TwoFeet(), SLIDER, FreeSliderCrank())
OF_PYMUNK = (
    # With the default bias the gap has the order dt. At these steps the next order still contributes to the motion.
    Row(pymunk.DEFAULT, FREE, order=(1,), room=0.25),
    # The tuned motion has a delay of half a step, and velocities are recorded half a step early.
    Row(pymunk.TUNED, FREE, 25, pose=8e-3, order=(1, 2, 1)),
    Row(pymunk.LEAPFROG, FREE, order=(2, 2, 2)),
    # The discretisation error and the rounding of 8000 steps are below 1e-12. A force is a change of velocity over a
    # step of 1e-4 s, so its rounding is 1e4 times larger.
    *on(pymunk.EXTENDED, (FREE, DRIVEN, MOVING), pose=1e-11, twist=1e-9, reaction=1e-8),
    # The errors of the first steps have no expansion in the step, so the first reactions are not checked.
    *on(pymunk.EXTENDED, ROLLING, 3, pose=1e-11, reaction=1e-8, since=2),
    *on(methods.ROLL_PIVOT, ROLLING[:2], order=(2,), room=0.2),
    # The error is 3e-11. If the contact were predicted for a ground at rest, the error would be 7e-10.
    Row(pymunk.EXTENDED, EllipticGears(), pose=1e-10, span=2.0),
    Row(methods.SKATE_PROJECTED, SLEIGH, order=(1,), span=3.0),
    Row(methods.SKATE_GROOVE, SLEIGH, order=(1,), span=3.0),
    *on(pymunk.EXTENDED, SLEIGHS, 1, pose=1e-11, reaction=1e-8, span=3.0),
    # With other powers of the step, the error with five levels would be at least 1e-5.
    Row(replace(methods.SKATE_GROOVE_EXTRAPOLATED, powers=(2, 3, 4, 5)), SLEIGH, 1, floor=1e-7, span=3.0),
    # The first force is extrapolated in time from later steps, in addition to the extrapolation in the step.
    Row(pymunk.EXTENDED, CarAndTrailer(), 1, pose=1e-10, twist=1e-8, reaction=1e-4, since=1, span=5.0),
    Row(pymunk.EXTENDED, blade_on_a_board(), 1, pose=1e-9, twist=1e-8),
    Row(methods.SKATE_CENTRE, SLEIGH, floor=1.0, span=3.0),  # The skate has no effect on the motion.
    Row(methods.SKATE_CENTRE, ChaplyginSleigh(offset=0.0), 10, pose=2e-2, order=(1,), span=3.0),
    Row(methods.SKATE_POINT, SLEIGH, floor=1.0, span=3.0),  # without slip
    Row(pymunk.EXTENDED, SLIDER, pose=1e-11, twist=1e-9, reaction=1e-7),
    # cpGrooveJoint solves both directions and uses only one, which is correct only if the normal is a principal axis.
    Row(pymunk.LEAPFROG, rod_in_a_slot(), order=(2,)),
    Row(pymunk.EXTENDED, rod_in_a_slot(), pose=1e-10, reaction=1e-6),
    *on(pymunk.EXTENDED, (BEAD, TRAMMEL), 5, pose=1e-9, reaction=1e-5),
    Row(pymunk.EXTENDED, LinkPendulum(), 5, pose=6e-12, reaction=1e-6, span=1.0),
    # Heavy bodies on light bodies need more iterations, which the usual rule provides.
    Row(pymunk.LEAPFROG, OneFoot(), 3, pose=1e-3),
    Row(pymunk.Pymunk("five sweeps", iterations=5, error_bias=0.0, leapfrog=True), OneFoot(), floor=0.1),
)
OF_MUJOCO = (
    # With the default time constant of 0.02 s and impedance of 0.9 the error does not depend on the step.
    Row(mujoco.DEFAULT, FREE, 25, order=(0,), room=0.5, floor=1e-4),
    # With a time constant of five steps the error of the regularisation is proportional to dt^2.
    Row(mujoco.TUNED, FREE, pose=1e-6, order=(2,), room=0.5),
    # Five steps of 1e-2 s are longer than the time constant of the motion. The error at order 4 is then 1e-5.
    *on(mujoco.EXTENDED, (FREE, DRIVEN), 1, pose=1e-4, span=0.05),
    Row(mujoco.EXTENDED, FREE, 5, order=(4,), room=0.5),
    *on(mujoco.EXTENDED, (FREE, DRIVEN), 10, pose=1e-8, reaction=1e-6),
    Row(FREE_COORDINATES, FREE, pose=1e-7),
    Row(mujoco.EXTENDED, far_drive(), pose=1e-7, reaction=1e-6, span=0.05),
    *on(mujoco.EXTENDED, (EllipticGears(),), pose=1e-8, reaction=1e-4, span=1.0),
    Row(mujoco.DEFAULT, RollingEllipse(), order=(0,), room=0.3, floor=0.02, span=2.0),
    # The contact is not permanent, so the error varies by some tens of percent.
    Row(mujoco.TUNED, RollingEllipse(), 25, order=(1,), room=0.3, span=2.0),
    # The skate's direction has a delay of up to a step. The error is the displacement times the rotation in a step.
    Row(mujoco.TUNED, SLEIGH, order=(1,), span=3.0, pose=2e-2, reaction=5e-3, since=1),
    # The friction along the blade has MuJoCo's smallest coefficient, 1e-5.
    Row(BLADE, SLEIGH, 25, pose=5e-3, reaction=5e-3, since=1, floor=1e-4, span=3.0),
    # The slip is u w (speed times rate) times the time constant of friction, 0.02 s, at any step.
    Row(mujoco.DEFAULT, SLEIGH, order=(0,), floor=5e-3, pose=5e-2, reaction=0.1, since=10, span=3.0),
    Row(SOFT, SLEIGH, 5, order=(0,), floor=1e-6, span=3.0),
    Row(mujoco.EXTENDED, blade_on_a_board(), pose=1e-9),
    Row(mujoco.TUNED, blade_on_a_board(), pose=1e-2, floor=1e-6),
    *on(mujoco.EXTENDED, (SLIDER,), 25, pose=1e-10, reaction=1e-8),
    Row(TUNED_FREE, SLIDER, pose=1e-4),
    # The drive of the rod has the smallest compliance of all variants. The slot is a coordinate of the tree.
    Row(mujoco.TUNED, BEAD, pose=1e-8, twist=1e-7, reaction=1e-7, span=0.2),
    Row(FREE_HALVES, BEAD, pose=1e-9, reaction=1e-7, span=0.2),
    Row(TUNED_FREE, BEAD, pose=1e-6, order=(2,), room=0.3, span=0.2),  # The weld and the slot have gaps.
    *on(mujoco.TUNED, (TRAMMEL,), pose=1e-6, span=0.2),
    *on(HALVES, (TRAMMEL,), pose=1e-9, span=0.2),
    Row(HALVES, plate(), pose=1e-8, reaction=1e-2, span=0.2),
    *on(mujoco.EXTENDED, (TRAMMEL, plate()), pose=1e-8, reaction=1e-2, span=0.2),
    *on(SLOTS[0], (SlottedLever(),), order=(2,), room=0.3),  # The slot's spring depends on the step.
    # The rows are dependent at about 0.7 s, when all bars are in line.
    Row(mujoco.EXTENDED, NFourBar(), pose=1e-6, span=1.5),
    # After 10 ms the error at order 1 is a dt^2 / 2 for each step. In default loops the error comes from the
    # regularisation.
    *on(mujoco.DEFAULT, CHAINS, pose=5e-3, span=0.01),
    *on(FREE_COORDINATES, CHAINS, pose=1e-5, span=0.01),
)


@cache
def exact(subject: Scene | Mechanism, samples: int) -> Trajectory:
    if isinstance(subject, Mechanism):
        return TRUTH.build(subject, SPACING)(samples, 1)
    return subject.motion(SPACING * np.arange(samples + 1))


def errors(row: Row, every: int) -> list[float]:
    mechanism = row.subject if isinstance(row.subject, Mechanism) else row.subject.mechanism()
    end = row.span if isinstance(row.subject, Mechanism) else min(row.span, row.subject.duration)
    samples = max(1, math.floor(end / SPACING + 1e-9))
    run, right = row.engine.build(mechanism, SPACING / every)(samples, every), exact(row.subject, samples)
    off = [np.abs(getattr(run, name) - getattr(right, name)) for name in ("pose", "twist", "reaction")]
    reaction = np.abs(right.reaction[:, ~np.isnan(right.reaction).any(axis=0)])
    off[2] = off[2][row.since :] / max(reaction.max(initial=0.0), 1.0)
    return [float(np.nanmax(difference, initial=0.0)) for difference in off]


@pytest.mark.parametrize("row", [*OF_PYMUNK, *OF_MUJOCO], ids=str)
def test_a_construction_has_the_errors_and_orders_of_the_table(row: Row) -> None:
    coarse_errors = errors(row, row.every)
    for off, allowed in zip(coarse_errors, (row.pose, row.twist, row.reaction), strict=True):
        assert off < allowed
    assert coarse_errors[0] > row.floor
    if not row.order:
        return
    finer = errors(row, 4 * row.every)
    for coarse, fine, order in zip(coarse_errors, finer, row.order, strict=False):
        if order is not None:
            assert np.log2(coarse / fine) / 2 == pytest.approx(order, abs=row.room)
    assert finer[0] > row.floor


# ------------------------------------------------------------------------------------- limits of constructions


def disc_on_a_plank() -> Mechanism:
    disc, roll = rolling_disc(Rolling.at_arcs(Circle(0.1), Line()), first="plank")
    return Mechanism((Body("plank", 1.0, 1.0, (0.0, 0.0, 0.0)), disc), (roll,))


def twice_driven(*pins: Pin) -> Mechanism:
    drives = (Drive(name, None, "one", 1.0, 0.0) for name in ("first", "second"))
    return Mechanism((Body("one", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),), (*pins, *drives))


HUB = Pin("A", None, "one", (0.0, 0.0), (0.0, 0.0))
REFUSED = (
    *((engine, RollingInRing(), "a Ring is hollow") for engine in (pymunk.DEFAULT, pymunk.TUNED)),
    *((engine, RollingInRing(), "no hollow side") for engine in (mujoco.DEFAULT, mujoco.TUNED, *ROLLS)),
    *((engine, RollingCam(), "no shape like a cam") for engine in (mujoco.DEFAULT, mujoco.TUNED, *ROLLS)),
    (mujoco.DEFAULT, disc_on_a_plank(), "planes are fixed to the ground"),
    *(
        (engine, blade_on_a_board(), "needs a skate on the ground")
        for engine in (methods.SKATE_CENTRE, methods.SKATE_PROJECTED)
    ),
    *((engine, blade_on_a_board(), "runs on the body 'board'") for engine in (mujoco.DEFAULT, BLADE)),
    # A crank with two drives, and a body without a pin with two drives.
    *(
        (pymunk.TUNED, twice_driven(*pins), "'second' joins two bodies whose motion is already")
        for pins in ((HUB,), ())
    ),
    (mujoco.EXTENDED, twice_driven(HUB), "another drive turns already"),
    *(
        (replace(mujoco.EXTENDED, **{setting: value}), SLEIGH, "dense")
        for setting, value in (("jacobian", "auto"), ("jacobian", "sparse"), ("islands", True))
    ),
)


@pytest.mark.parametrize(("engine", "subject", "sentence"), REFUSED, ids=lambda value: getattr(value, "variant", None))
def test_limits_of_constructions_are_refused_in_a_sentence(engine, subject, sentence) -> None:
    with pytest.raises(Unsupported, match=sentence):
        engine.build(subject if isinstance(subject, Mechanism) else subject.mechanism(), 1e-3)
