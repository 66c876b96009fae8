"""Tests of start, joints, Newton's law, energy, units and accuracy of every scene's reference motion.

Accelerations are finite differences of twists, so the tests do not use the scenes' formulas.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from engines.lagrange import Lagrange
from reference.joints import Drive
from reference.mechanism import Mechanism
from reference.scene import PlacedScene, Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import DrivenFourBar, FourBarScene, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.person import TwoFeet
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.skates import ChaplyginSleigh, PinnedBody, SkateOnSlope, SleighBackwards
from reference.scenes.slider_crank import (
    DrivenSliderCrank,
    FreeSliderCrank,
    RodEndInSlot,
    SliderAtDeadCentre,
    SlottedLever,
)
from reference.scenes.wheels.vehicles import CarAndTrailer, Cart
from reference.trajectory import Trajectory, joint_gap, slip
from tests.mechanisms import SCENES_OF_LIMITS
from tests.present import present

# A triple-rocker whose crank reaches both limits within two seconds.
TRIPLE_ROCKER = FreeFourBar(crank=1.0, coupler=0.5, rocker=0.6, ground=(1.2, 0.1), start=0.2, duration=2.0)
TURNED = FreeFourBar(
    *(0.5, 0.9, 0.8, (-0.6, 0.7)), branch=-1, rate=-4.0, density=(1.0, 3.0, 0.5), start=1.0, gravity=(3.0, -8.0)
)
# These scenes have signs that the catalogue lacks, and no zeros, which could hide an error.
OTHERS: tuple[Scene, ...] = (
    *(TRIPLE_ROCKER, TURNED, DrivenFourBar(rate=-7.0, branch=-1, revolutions=0.5)),
    DrivenFourBar(1.0, 0.9, 1.1, (0.3, -0.4), revolutions=2.0, density=(1.0, 2.0, 3.0)),
    *(DrivenSliderCrank(offset=-0.3, branch=-1, rate=-4.0), FreeSliderCrank(offset=0.2, rate=3.0, branch=-1)),
    *(BarPendulum(angle=1.0, rate=-9.0, length=0.7, mass=3.0), LinkPendulum(links=3, tip=50.0, rate=1.0, duration=1.0)),
    *(NFourBar(loops=1), NFourBar(loops=3, length=0.7, mass=2.0, speed=-2.5)),
    *(ChaplyginSleigh(offset=-0.5), ChaplyginSleigh(speed=-1.0, turning_rate=-2.0), ChaplyginSleigh(speed=0.0)),
    *(ChaplyginSleigh(speed=0.0, turning_rate=-3.0, offset=-0.2), ChaplyginSleigh(turning_rate=0.0)),
    *(ChaplyginSleigh(offset=0.0), ChaplyginSleigh(offset=30.0, inertia=1e-3)),
    *(SkateOnSlope(turning_rate=0.5, speed=1.0, heading=0.3), SkateOnSlope(turning_rate=-4.0, speed=-0.5, heading=2.0)),
    SkateOnSlope(turning_rate=1e-6, speed=1.0, heading=0.3),
    *(ChaplyginSleigh(start=(1.0, -2.0, 5.0)), SleighBackwards(duration=5.0)),
    *(PinnedBody(turning_rate=12.0), PinnedBody(turning_rate=-12.0, angle=7.0), PinnedBody(point=(0.0, 0.0))),
    PinnedBody(point=(0.2, -0.3), pin=(1.0, 2.0), gravity=(3.0, 4.0), angle=-2.0),
    PinnedBody(angle=-math.pi / 2, turning_rate=0.0),
    *(CarAndTrailer(steering=0.0), CarAndTrailer(speed=-1.0, steering=-0.2, bend=0.1), CarAndTrailer(redundant=True)),
    CarAndTrailer(hitch=-0.3, bend=-2.0, steering=-0.9, pose=(1.0, 2.0, 4.0)),
    *(Cart(speed=-1.0, angles=(0.1, 0.2)), Cart(redundant=True)),
    *(EllipticGears(eccentricity=0.2, start_angle=-2.0), EllipticGears(eccentricity=0.75, start_angle=1.0)),
    *(RodEndInSlot(offset=0.3, branch=-1), SlottedLever(slant=-2.0, crank=0.79), SliderAtDeadCentre(angle=1e-2)),
    TwoFeet(knees=-1, stance=0.3, hip_x=0.1, trunk=0.2, mass=60.0, height=1.6, hip_y=0.72),
)
ALL = (*SCENES, *SCENES_OF_LIMITS, *OTHERS)
# A mapping from scenes' names to freedoms of configuration and of velocity. A chain has one freedom for each link.
FREEDOMS: dict[str, tuple[int, int]] = {
    **dict.fromkeys(("driven_four_bar", "parallelogram", "overdriven_four_bar", "driven_slider_crank"), (0, 0)),
    **dict.fromkeys(("sleigh", "sleigh_backwards", "skate_on_slope"), (3, 2)),
    **dict.fromkeys(("rod_end_in_slot", "slotted_lever"), (0, 0)),
    **{"car_and_trailer": (4, 1), "cart": (5, 2), "elliptic_gears": (0, 0), "held_by_skates": (3, 0)},
    **{"person_swaying": (5, 5), "person_one_foot": (5, 5), "person_two_feet": (3, 3)},
}
NEWTON = 1e-8  # Error of finite differences of twists, relative to the largest force.


def name_of(each: Scene) -> str:
    return each.name


each_scene = pytest.mark.parametrize("each", ALL, ids=name_of)


def until(each: Scene) -> float:
    """The end of the test [s], which is at most one second and before the ideal motion ends or is not valid."""
    stops = (getattr(each, "stopping_time", math.inf), getattr(each, "corner", math.inf))
    return min(each.duration, each.horizon, each.comparable_until, 1.0, *(0.9 * stop for stop in stops))


@cache
def known(each: Scene) -> tuple[Mechanism, Trajectory, np.ndarray, np.ndarray]:
    """Mechanism, motion at five times, and derivatives of its poses and twists by finite differences of order 8."""
    mechanism, middle = each.mechanism(), np.linspace(0.1, 0.8, 5) * until(each)
    motion = each.motion(middle)
    step = 0.005 / max(1 / min(mechanism.time_scale, until(each)), np.abs(motion.twist[..., 2]).max())
    weights = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840 / step
    near = each.motion((middle[:, None] + step * np.arange(-4, 5)).ravel())
    rates = (np.einsum("j,tj...->t...", weights, values.reshape(5, 9, -1, 3)) for values in (near.pose, near.twist))
    return mechanism, motion, *rates


def truth_error(each: Scene) -> Callable[[np.ndarray], np.ndarray] | None:
    """The function that bounds the error of an integrated reference motion, or None for a closed form."""
    return getattr(each, "truth_error", None) or getattr(getattr(each, "motion_law", None), "truth_error", None)


def fastest(mechanism: Mechanism, motion: Trajectory) -> float:
    """The largest of rotation rates, speeds over length, and the inverse of the mechanism's time scale [1/s]."""
    return max(float(np.abs(motion.twist / mechanism.pose_unit).max()), 1 / mechanism.time_scale)


def off_the_joints(mechanism: Mechanism, motion: Trajectory) -> float:
    """The largest gap and slip, relative to the motion's length and speed."""
    place = 1 + np.abs(motion.pose / mechanism.pose_unit).max()
    length = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    gap = np.nanmax(np.abs(joint_gap(mechanism, motion) / length), initial=0.0) / place
    return max(gap, np.abs(slip(mechanism, motion) / length).max(initial=0.0) / fastest(mechanism, motion))


def off_newton(mechanism: Mechanism, motion: Trajectory, change: np.ndarray) -> float:
    """The residual of M a = f + J^T r, relative to the largest force; undetermined reactions are fitted by least
    squares.
    """
    inertias = mechanism.inertias / mechanism.pose_unit
    free = mechanism.unconstrained(motion.pose, motion.twist)
    columns = np.swapaxes(mechanism.rows(motion.pose), -1, -2)
    pulls = np.einsum("tcr,tr->tc", columns, np.nan_to_num(motion.reaction))
    lacks = inertias * (change - free) - pulls.reshape(change.shape) / mechanism.pose_unit
    for now, column, reaction in zip(lacks, columns, motion.reaction, strict=True):
        left_open = column[:, np.isnan(reaction)] / np.tile(mechanism.pose_unit, len(now))[:, None]
        now -= (left_open @ np.linalg.lstsq(left_open, now.ravel())[0]).reshape(now.shape)
    usual = inertias * mechanism.pose_unit * fastest(mechanism, motion) ** 2
    return float(np.abs(lacks).max() / max(np.abs(inertias * free).max(), usual.max()))


@each_scene
def test_a_scenes_motion_starts_at_the_mechanisms_state_and_satisfies_its_joints(each: Scene) -> None:
    mechanism, motion, rate, _ = known(each)
    start = each.motion([0.0])
    # The reference motion may begin with a rounding of its coordinates.
    for found, own in ((start.pose[0], mechanism.pose), (start.twist[0], mechanism.twist)):
        assert np.abs(found - own).max() < 3e-14 * (1 + np.abs(own).max())
    assert off_the_joints(mechanism, motion) < 1e-13
    # The truncation error is (w h)^8 / 630, with w h = 0.005 for the fastest rotation; the rounding error is eps /
    # h.
    assert np.abs((rate - motion.twist) / mechanism.pose_unit).max() < 1e-10 * fastest(mechanism, motion)
    freedoms = FREEDOMS.get(each.name, (getattr(each, "links", 1),) * 2)
    assert mechanism.degrees_of_freedom() == freedoms
    assert set(np.abs(each.branch_of(motion.pose))) <= {0, 1}


@each_scene
def test_a_scenes_reactions_satisfy_newtons_law(each: Scene) -> None:
    mechanism, motion, _, change = known(each)
    assert off_newton(mechanism, motion, change) < NEWTON


def accelerations_of(each: Scene, t: np.ndarray) -> np.ndarray | None:
    """The accelerations from which the scene computes its reactions, or None without such accelerations."""
    if isinstance(each, FourBarScene):
        return each._bodies(each._angles(t))[2]  # pyright: ignore[reportAttributeAccessIssue]
    return each.placement(t)[2] if isinstance(each, PlacedScene) else None


@pytest.mark.parametrize("each", [each for each in ALL if isinstance(each, FourBarScene | PlacedScene)], ids=name_of)
def test_a_scenes_accelerations_are_derivatives_of_its_twists(each: Scene) -> None:
    mechanism, motion, _, change = known(each)
    off = np.abs((present(accelerations_of(each, motion.t)) - change) / mechanism.pose_unit).max()
    assert off < 1e-9 * max(np.abs(change / mechanism.pose_unit).max(), fastest(mechanism, motion) ** 2)


@pytest.mark.parametrize("each", [each for each in ALL if each.name != "n_four_bar_40"], ids=name_of)
def test_lagrange_multipliers_give_the_same_motion_as_the_scene(each: Scene) -> None:
    mechanism = each.mechanism()
    run = Lagrange(tolerance=1e-13).build(mechanism, until(each) / 8)(4, 1)
    exact = each.motion(run.t)
    met = np.all(np.isfinite(run.pose), axis=(1, 2))  # Lagrange's equations stop at a singular position
    assert met[1]
    # Reference and engine have a tolerance of 1e-13 per step; nearly straight knees amplify the difference.
    assert np.abs((run.pose - exact.pose) / mechanism.pose_unit)[met].max() < 1e-10
    reaction = np.nan_to_num(np.abs(run.reaction - exact.reaction))[met]
    assert reaction.max(initial=0.0) <= 1e-8 * np.nanmax(np.abs(exact.reaction[met]), initial=0.0)


# One scene of each name suffices, since the bound is computed by the same rule for all numbers.
@pytest.mark.parametrize("each", {each.name: each for each in ALL[::-1] if truth_error(each)}.values(), ids=name_of)
def test_the_error_bound_of_an_integrated_reference_motion_is_small(each: Scene) -> None:
    # The motion has several hundred steps with a tolerance of 1e-13. A deviation of a person's knee grows by a factor
    # of e in 0.03 s.
    last = min(each.horizon, each.duration, 0.9 * getattr(each, "corner", math.inf))
    stated = present(truth_error(each))(np.linspace(0.0, last, 9))
    assert stated.max() < (1e-9 if each.name == "person_swaying" else 1e-10)


@each_scene
def test_a_motion_does_not_depend_on_the_other_times_in_the_request(each: Scene) -> None:
    t = until(each) * np.array([0.0, 0.31, 0.62, 0.9])
    whole, mixed = each.motion(t), each.motion([*t[[2, 0, 3]], 0.5 * until(each)])
    for name, size in (("pose", 1e-13), ("twist", 1e-12)):
        one, other = getattr(whole, name)[[2, 0, 3]], getattr(mixed, name)[:3]
        assert np.abs(one - other).max() <= size * (1 + np.abs(one).max())


# A change of unit by a power of two changes no digit of products and sums. So any difference between the motions of a
# scene and of its copy in other units is caused by a constant that depends on a unit.
# A mapping from fields with a unit to the exponents of length, time and mass in the unit.
LENGTH, TIME, MASS = (1, 0, 0), (0, 1, 0), (0, 0, 1)
RATE, SPEED, PULL, INERTIA = (0, -1, 0), (1, -1, 0), (1, -2, 0), (2, 0, 1)
_METRES = (
    "crank coupler rocker ground rod offset length hitch wheelbase track centres centre front width trail points point "
    "pin along_x along_y radius eccentricity cosines sines gyration ring hill major hole side ground_arc stance hip_x "
    "hip_y height caster_centre lever distance "
    "pivot_a pivot_b pivot_c bar spring_point upper upper_end lower lower_end rest_length"
)
UNITS = {
    **dict.fromkeys(_METRES.split(), LENGTH),
    **dict.fromkeys(("duration", "horizon"), TIME),
    **dict.fromkeys(("rate", "turning_rate", "start_rate"), RATE),
    **dict.fromkeys(("mass", "masses", "crank_mass", "rod_mass", "slider_mass", "caster_mass", "lever_mass"), MASS),
    **dict.fromkeys(("inertia", "inertias", "slider_inertia", "caster_inertia"), INERTIA),
    **{"speed": SPEED, "gravity": PULL, "density": (-1, 0, 1), "stiffness": (0, -2, 1), "torque": (2, -2, 1)},
}
OTHER = {("elliptic_gears", "eccentricity"): (0, 0, 0)}
POSES = ("start", "pose")  # Fields whose values are x, y and angle.
# Units of length [m], time [s] and mass [kg]. Small multiples of the powers of two do not add up to zero, so that
# errors in two exponents cannot cancel.
SCALES = {"small": (2.0**-30, 2.0**-17, 2.0**23), "large": (2.0**30, 2.0**19, 2.0**-13)}


def scaled(value, factor):
    if isinstance(value, tuple):
        return tuple(scaled(part, factor) for part in value)
    return value * factor


def in_other_units(scene: Scene, unit: tuple[float, float, float]) -> Scene:
    """The scene with its numbers in these units of length [m], time [s] and mass [kg]."""
    changes = {}
    for field in fields(scene):  # pyright: ignore[reportArgumentType] (each scene's class is a dataclass)
        value = getattr(scene, field.name)
        if field.name in POSES and isinstance(value, tuple):
            changes[field.name] = (value[0] * unit[0], value[1] * unit[0], value[2])
            continue
        exponents = OTHER.get((scene.name, field.name), UNITS.get(field.name, (0, 0, 0)))
        if any(exponents):
            factor = math.prod(one**exponent for one, exponent in zip(unit, exponents, strict=True))
            changes[field.name] = scaled(value, factor)
    return replace(scene, **changes)  # pyright: ignore[reportArgumentType]


def off(found, expected):
    size = np.nanmax(np.abs(expected), initial=0.0)
    return float(np.nanmax(np.abs(found - expected), initial=0.0) / size) if size else float(np.nanmax(np.abs(found)))


def difference(scene: Scene, unit: tuple[float, float, float]) -> float:
    """The largest relative difference of poses, twists and reactions between the scene and the scene in other units."""
    other = in_other_units(scene, unit)
    until = min(scene.duration, scene.horizon, scene.comparable_until, getattr(scene, "corner", math.inf) / 2)
    times = until * np.array([0.0, 0.13, 0.5, 1.0])
    usual, found = scene.motion(times), other.motion(times * unit[1])
    place, turn = np.array([unit[0], unit[0], 1.0]), unit[1]
    assert np.array_equal(np.isnan(usual.reaction), np.isnan(found.reaction))
    parts = [
        off(found.pose[..., :2] / place[:2], usual.pose[..., :2]),
        off(found.pose[..., 2], usual.pose[..., 2]),
        off(found.twist[..., :2] / place[:2] * turn, usual.twist[..., :2]),
        off(found.twist[..., 2] * turn, usual.twist[..., 2]),
    ]
    force = unit[2] * unit[0] / turn**2
    turned = np.concatenate([[isinstance(joint, Drive)] * joint.size for joint in scene.mechanism().joints])
    for rows, size in ((~turned, force), (turned, force * unit[0])):
        if np.any(np.isfinite(usual.reaction[:, rows])):
            parts.append(off(found.reaction[:, rows] / size, usual.reaction[:, rows]))
    return max(parts)


# The overdriven crank is left out, since its motion ends.
LASTING = tuple(scene for scene in (*SCENES, *SCENES_OF_LIMITS) if scene.name != "overdriven_four_bar")
# Scenes whose reference motion takes a fifth of a second or more.
COSTLY = (
    *("free_four_bar", "spinning_four_bar", "cart", "free_slider_crank", "slider_at_dead_centre", "pendulum_2"),
    *("pendulum_10", "pendulum_100", "pendulum_n", "rolling_cam", "rolling_in_ring", "rolling_ellipse"),
    *("rolling_disc", "rolling_incline", "person_swaying", "person_one_foot", "person_two_feet", "n_four_bar_40"),
    "andrews",
)


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize(
    "scene",
    [pytest.param(each, marks=pytest.mark.slow if each.name in COSTLY else ()) for each in LASTING],
    ids=lambda scene: scene.name,
)
def test_the_motion_of_a_scene_does_not_depend_on_units(scene: Scene, scale: str) -> None:
    # The motions differ by rounding. Scenes in COSTLY are slow, and their rounding errors may grow tenfold up to
    # the horizon.
    allowed = 1e-11 if scene.name == "pendulum_100" else 1e-12  # Joint forces of long chains sum more roundings.
    assert difference(scene, SCALES[scale]) < allowed
