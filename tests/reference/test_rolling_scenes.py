"""Rolling under gravity: energy, exact multipliers, closed forms of hop, slip and small swings, elliptic gears."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines.lagrange import TRUTH
from reference.checks import InvalidMechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Line, Ring
from reference.rolling.kinematics import Rolling
from reference.scenes.rolling.body import GRAVITY, RollingBody
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.trajectory import energy, joint_gap, slip
from tests.present import present

SCENES = [RollingEllipse(), RollingDisc(), RollingCam(), RollingDownhill(), RollingInRing(), RollingOnCircle()]


def by_name(scenes):
    return pytest.mark.parametrize("scene", scenes, ids=[scene.name for scene in scenes])


def times(scene):
    return np.linspace(0, scene.duration, scene.samples + 1)


def test_the_incline_falls_to_minus_x_so_that_the_ellipse_goes_faster():
    scene = RollingDownhill()
    truth = scene.motion(np.array([0.0, scene.duration]))
    along, up = truth.pose[1, 0, :2] - truth.pose[0, 0, :2]
    assert along < -2
    # It sinks by the slope, but for the 0.1 m by which its half axes differ.
    assert up == pytest.approx(math.tan(scene.slope) * along, abs=0.11)
    assert abs(truth.twist[1, 0, 2]) > abs(truth.twist[0, 0, 2])


@by_name(SCENES)
def test_the_truth_keeps_energy_contact_and_newtons_law(scene):
    mechanism, t = scene.mechanism(), times(scene)
    truth = scene.motion(t)
    assert mechanism.degrees_of_freedom() == (1, 1)
    # Two hundred samples' rounding of about 10 J.
    np.testing.assert_allclose(energy(mechanism, truth), energy(mechanism, truth)[0], rtol=0, atol=5e-12)
    np.testing.assert_allclose(joint_gap(mechanism, truth), 0, atol=1e-13)
    np.testing.assert_allclose(slip(mechanism, truth), 0, atol=1e-13)
    law = scene.motion_law
    theta, rate = law.states(t)
    alpha = law.angular_acceleration(theta, rate)
    acceleration = np.concatenate([law.rolling.acceleration(theta, rate, alpha), alpha[:, None]], axis=-1)
    np.testing.assert_allclose(mechanism.reaction(truth.pose, acceleration[:, None, :]), truth.reaction, atol=1e-12)
    # Euler's law about the centre of mass was not used: torque of the contact's force = I alpha.
    arm, contact = law.rolling.contact(theta).arm, law.rolling.contact(theta)
    force = truth.reaction[:, :1] * contact.tangent + truth.reaction[:, 1:] * contact.normal
    torque = -(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
    np.testing.assert_allclose(torque, law.inertia * alpha, atol=1e-12)


@by_name(SCENES)
def test_the_truths_own_error_is_below_a_picoradian_a_radian_turned(scene):
    # What a coarser tolerance, up to 3e-12 a step over up to 60 steps, changes.
    assert scene.motion_law.truth_error(times(scene)).max() < 2e-11


@by_name(SCENES)
def test_exact_multipliers_on_the_mechanism_give_the_same_motion(scene):
    spacing = 0.05
    run = TRUTH.build(scene.mechanism(), spacing)(10, 1)
    truth = scene.motion(run.t)
    # Both integrate at 1e-13 a step; the free directions of the multiplier form drift by a few of those.
    np.testing.assert_allclose(run.pose, truth.pose, rtol=0, atol=2e-11)
    np.testing.assert_allclose(run.twist, truth.twist, rtol=0, atol=1e-10)
    np.testing.assert_allclose(run.reaction, truth.reaction, rtol=0, atol=1e-9)


def test_the_ellipses_known_extremes():
    # Measured with two engines independently: smallest normal force 8.15 N, largest friction needed 0.30.
    law = RollingEllipse().motion_law
    t = np.linspace(0, 2, 2001)
    assert law.forces(t)[1].min() == pytest.approx(8.15, abs=5e-3)
    assert law.required_friction(t).max() == pytest.approx(0.30, abs=5e-3)


def disc(radius, ground, rate, theta=0.0, **more):
    rolling = Rolling.at_angle(Circle(radius), ground, theta, **more)
    return RollingBody(rolling, 1.0, radius**2 / 2, rate)


def test_a_round_disc_downhill_accelerates_by_two_thirds_and_needs_a_third_of_the_slope():
    slope = 0.3
    law = disc(0.4, Line(math.pi + slope), 0.0)
    t = np.linspace(0, 2, 21)
    theta, _ = law.states(t)
    np.testing.assert_allclose(theta, GRAVITY * math.sin(slope) / (1.5 * 0.4) * t**2 / 2, atol=1e-11)
    np.testing.assert_allclose(law.required_friction(t), math.tan(slope) / 3, rtol=1e-11)
    # Along e_t, downhill: friction holds back.
    np.testing.assert_allclose(law.forces(t)[0], -GRAVITY * math.sin(slope) / 3, rtol=1e-11)
    assert law.slip(0.99 * math.tan(slope) / 3, 2.0) == 0.0
    assert law.slip(1.01 * math.tan(slope) / 3, 2.0) is None


def test_a_round_disc_leaves_a_round_hill_where_the_textbook_says():
    hill, radius, rate = 1.0, 0.25, 0.6
    law = disc(radius, Circle(hill), rate, ground_arc=hill * math.pi / 2)
    instant = law.hop(3.0)
    assert instant is not None
    x, y = law.rolling.position(law.states(instant)[0])[0]
    # Energy 3/4 m v^2 and m v^2 / (R + r) = m g cos(angle) from the top: 4/7 from rest.
    start = 0.75 * (radius * rate) ** 2 / (GRAVITY * (hill + radius))
    assert y / math.hypot(x, y) == pytest.approx((1 + start) / 1.75, abs=1e-12)
    assert law.forces(instant)[1] == pytest.approx(0.0, abs=1e-10)
    assert np.all(law.forces(np.linspace(0, instant - 1e-6, 50))[1] > 0)
    # It slips before it hops, whatever the friction, and the later the larger it is.
    slips = [present(law.slip(mu, 3.0)) for mu in (0.2, 0.5, 2.0, 50.0)]
    assert slips == sorted(slips)
    assert slips[-1] < instant
    for mu, at in zip((0.2, 0.5, 2.0), slips, strict=False):
        assert law.required_friction(at)[0] == pytest.approx(mu, rel=1e-9)


def test_a_scene_that_slips_and_hops_ends_its_horizon_there():
    scene = RollingOnCircle()
    assert scene.horizon == scene.comparable_until < present(scene.hop) < scene.duration
    assert scene.motion_law.required_friction(scene.horizon)[0] == pytest.approx(scene.friction, rel=1e-9)
    # However rough, it holds no longer than to the hop.
    assert RollingOnCircle(friction=1e9).horizon == pytest.approx(scene.hop, rel=1e-6)
    assert RollingEllipse().horizon == RollingEllipse().duration
    assert RollingEllipse().comparable_until == math.inf
    # The ellipse asks for 0.2993 at most.
    assert RollingEllipse(friction=0.25).horizon < 1.0


def test_a_contact_that_must_pull_needs_infinite_friction():
    scene = RollingOnCircle()
    beyond = np.linspace(present(scene.hop) * (1 + 1e-6), scene.duration, 20)
    law = scene.motion_law
    pulling = law.forces(beyond)[1] < 0
    assert pulling.any()
    assert np.all(law.required_friction(beyond)[pulling] == math.inf)


def test_small_oscillations_have_the_closed_frequencies():
    a, b = 0.5, 0.3
    flat = RollingEllipse().motion_law
    # Radius of curvature at the flat side less the height of the centre, over the inertia about the contact.
    assert flat.small_frequency(0.0) ** 2 == pytest.approx(GRAVITY * (a * a / b - b) / ((a * a + b * b) / 4 + b * b))
    centred = RollingDisc(start_angle=-1.3)
    rest = centred.motion_law.equilibrium(math.pi / 2)
    assert rest == pytest.approx(math.pi / 2, abs=1e-14)
    near = 0.4 - 0.15
    assert centred.motion_law.small_frequency(rest) ** 2 == pytest.approx(GRAVITY * 0.15 / (0.4**2 / 2 + near**2))
    inside = disc(0.3, Ring(1.0), 0.0, math.pi / 2, ground_arc=math.pi / 2)
    # A disc in a bowl: g / (1.5 (R - r)) of the centre's swing, the same for any coordinate.
    assert inside.small_frequency(math.pi / 2) ** 2 == pytest.approx(GRAVITY / (1.5 * 0.7), rel=1e-12)


@pytest.mark.parametrize(
    ("body", "ground", "near"),
    [(Ellipse(0.5, 0.3), Line(), 0.0), (Cam(0.4, (0.05, 0.0, 0.02)), Line(math.pi + 0.02), 1.6)],
    ids=["ellipse", "cam on a slope"],
)
def test_a_small_swing_takes_the_small_frequencys_time(body, ground, near):
    rest = RollingBody(Rolling.at_angle(body, ground, near), 1.0, 0.08, 0.0).equilibrium(near)
    amplitude = 1e-4
    law = RollingBody(Rolling.at_angle(body, ground, rest + amplitude), 1.0, 0.08, 0.0)
    period = 2 * math.pi / law.small_frequency(rest)
    # Anharmonic terms change the period by the square of the amplitude, and so the swing by its third power.
    np.testing.assert_allclose(law.states([period / 2, period])[0] - rest, [-amplitude, amplitude], atol=2e-8)


def test_the_top_of_an_ellipse_is_no_place_to_oscillate():
    law = RollingEllipse().motion_law
    with pytest.raises(InvalidMechanism, match="rests on a top"):
        law.small_frequency(math.pi / 2)
    with pytest.raises(InvalidMechanism, match="can't rest there"):
        law.equilibrium(0.8, within=0.3)


def test_elliptic_gears_roll_on_each_other_as_their_closed_form_says():
    rng = np.random.default_rng(6)
    for eccentricity in rng.uniform(0.05, 0.8, 4):
        scene = EllipticGears(eccentricity=eccentricity, start_angle=rng.uniform(-3, 3), duration=6.0)
        mechanism, t = scene.mechanism(), times(scene)
        truth = scene.motion(t)
        assert np.ptp(truth.pose[:, 0, 2]) > 2 * np.pi
        # The search on the curves knows nothing of tan(theta / 2); it loses 1 / (1 - e) at the sharp ends.
        np.testing.assert_allclose(joint_gap(mechanism, truth), 0, atol=2e-14 / (1 - eccentricity) ** 2)
        np.testing.assert_allclose(slip(mechanism, truth), 0, atol=2e-13 / (1 - eccentricity) ** 2)
        pose, twist, acceleration = scene.kinematics(t)
        left = (mechanism.rows(pose) @ acceleration.reshape(len(t), -1, 1))[..., 0]
        np.testing.assert_allclose(left, mechanism.bias(pose, twist), atol=1e-11 / (1 - eccentricity) ** 3)


def test_the_check_catches_gears_pinned_a_thousandth_too_far():
    scene = EllipticGears()
    mechanism, truth = scene.mechanism(), scene.motion(np.linspace(0, 2, 50))
    pose = truth.pose + np.array([[0, 0, 0], [1e-3, 0, 0]])
    assert np.abs(joint_gap(mechanism, replace(truth, pose=pose))).max() > 9e-4


def test_gears_leave_open_only_the_force_along_the_line_of_their_pins():
    scene = EllipticGears()
    mechanism, truth = scene.mechanism(), scene.motion(times(scene))
    open_rows = {name for name, r in zip(mechanism.row_names, truth.reaction.T, strict=True) if np.isnan(r).all()}
    assert open_rows == {"first pin x", "second pin x", "mesh tangent", "mesh normal"}
    known = [name not in open_rows for name in mechanism.row_names]
    assert np.isfinite(truth.reaction[:, known]).all()
    torque = truth.reaction[:, mechanism.row_names.index("motor torque")]
    # The motor's power is the rate of kinetic energy: ideal joints do no work.
    _, twist, acceleration = scene.kinematics(truth.t)
    power = np.sum(mechanism.inertias * twist * acceleration, axis=(-2, -1))
    np.testing.assert_allclose(scene.turning_rate * torque, power, atol=1e-13)


BAD = {
    "a cam that isn't convex": lambda: RollingCam(cosines=(0.0, 0.0, 0.1)).mechanism(),
    "a ring too small": lambda: RollingInRing(ring=0.5).mechanism(),
    "no mass": lambda: RollingEllipse(mass=0.0).mechanism(),
    "a rate not finite": lambda: RollingEllipse(start_rate=math.inf).mechanism(),
    "an angle not finite": lambda: RollingDisc(start_angle=math.nan).motion([0.0]),
    "a time before the start": lambda: RollingEllipse().motion([-1.0]),
    "a time not finite": lambda: RollingEllipse().motion([math.nan]),
    "friction of zero": lambda: RollingEllipse().motion_law.slip(0.0, 1.0),
    "gears that are parabolas": lambda: EllipticGears(eccentricity=1.0),
    "gears of no size": lambda: EllipticGears(major=0.0),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_numbers_are_refused(case):
    with pytest.raises(InvalidMechanism):
        BAD[case]()


# ----------------------------------------------------------------------------------------------- the first instant


def watched(scene, looks=4001):
    """By looking, at so many instants: when the contact would first pull, and first needs more than its friction."""
    t = np.linspace(0, scene.duration, looks)
    tangent, normal = scene.motion_law.forces(t)
    rounding = 1e-11 * (1 + scene.friction) * np.abs([tangent, normal]).max()
    out = []
    for spare in (normal, scene.friction * normal - np.abs(tangent)):
        below = np.flatnonzero(spare < -rounding)
        out.append((t[max(0, below[0] - 1)], t[below[0]]) if below.size else None)
    return out


def some_scene(seed):
    """Any start: at rest, next to a balance, fast; in any unit of length and of time."""
    rng = random.Random(seed)
    length, time = 10 ** rng.choice([0.0, -9.0, 9.0]), 10 ** rng.choice([0.0, -9.0, 9.0])
    given: dict[str, Any] = {
        "start_rate": rng.choice([0.0, 1e-6, 1e-3, rng.uniform(-6, 6)]) / time,
        "start_angle": rng.choice([0.0, rng.uniform(-3, 3)]),
        "gravity": (0.0, -GRAVITY * length / time**2),
        "friction": 10 ** rng.uniform(-2, 1.5),
        "duration": 3 * time,
    }
    if rng.random() < 0.6:
        sizes: dict[str, Any] = {"hill": rng.uniform(0.3, 3) * length, "radius": rng.uniform(0.1, 1) * length}
        return RollingOnCircle(**given, **sizes, eccentricity=rng.choice([0.0, rng.uniform(0, 0.09)]) * length)
    if rng.random() < 0.5:
        return RollingDisc(**given, radius=0.4 * length, eccentricity=rng.uniform(0, 0.39) * length)
    return RollingEllipse(**given, along_x=0.5 * length, along_y=rng.uniform(0.3, 0.7) * length)


@pytest.mark.parametrize("seed", range(24))
def test_hops_and_slips_are_the_first_that_looking_finds(seed):
    scene = some_scene(seed)
    law = scene.motion_law
    slips = law.slip(scene.friction, scene.duration)
    for told, seen in zip((scene.hop, slips), watched(scene), strict=True):
        if seen is None:
            assert told is None
        else:
            assert seen[0] * (1 - 1e-12) <= present(told) <= seen[1]


def test_a_disc_that_hardly_moves_on_a_hill_hops_where_one_from_rest_does():
    scene = RollingOnCircle(eccentricity=0.0, start_rate=1e-3, duration=6.0)
    law = scene.motion_law
    x, y = law.rolling.position(law.states(present(scene.hop))[0])[0]
    # Energy 3/4 m v^2 and m v^2 / (R + r) = m g cos(angle): 4/7, and the start's own 1e-9 of it.
    assert y / math.hypot(x, y) == pytest.approx(4 / 7, abs=1e-8)
    assert scene.comparable_until < present(scene.hop)
    # It has hopped long before, and nobody has to follow it for an hour.
    assert law.hop(3600.0) == pytest.approx(scene.hop, rel=1e-9)


def test_a_contact_that_lets_go_for_a_thousandth_of_a_second_is_seen():
    at: dict[str, Any] = {"eccentricity": 0.2, "start_angle": 0.5}
    rates = [5.0, 12.0]  # between them it begins to jump; then the rate at which it jumps for a moment is bracketed
    for _ in range(30):
        middle = 0.5 * (rates[0] + rates[1])
        rates[RollingDisc(**at, start_rate=middle).hop is not None] = middle
    for rate in rates:
        law, t = RollingDisc(**at, start_rate=rate).motion_law, np.linspace(0, 2.0, 2001)
        for _ in range(2):  # nearer and nearer to where the contact presses least
            place = t[int(np.argmin(law.forces(t)[1]))]
            t = np.clip(place + (t[1] - t[0]) * np.linspace(-2, 2, 201), 0, 2.0)
        assert law.forces(t)[1].min() == pytest.approx(0.0, abs=1e-6)


def test_a_hop_does_not_depend_on_how_far_the_motion_is_known():
    scene = RollingDisc(start_rate=-5.0, start_angle=2.0, eccentricity=0.2, friction=0.12)
    before = scene.motion_law.slip(scene.friction, 2.0)
    scene.motion_law.states([10.0])
    assert present(scene.motion_law.slip(scene.friction, 2.0)) == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("scene", [RollingEllipse(), RollingDisc(eccentricity=0.1), RollingInRing()])
def test_a_body_that_has_shown_all_its_forces_is_not_followed_for_ever(scene):
    assert scene.motion_law.hop(1e9) is None
