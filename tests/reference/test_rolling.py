"""Tests of curves, contacts, rows of a roll, and bodies that roll, slip and hop under gravity."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.numerics.roots import solve_increasing
from reference.plane import rotated
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary, Parabola, Traced
from reference.rolling.roll import Roll
from reference.scenes.rolling.body import GRAVITY, RollingBody
from reference.scenes.rolling.scenes import RollingDisc, RollingDownhill, RollingEllipse, RollingInRing, RollingOnCircle
from tests.present import present

CASES = {
    **{
        "line": Line(1.1, (0.2, 0.3)),
        "side": Side(2.0),
        "circle": Circle(0.4, (0.1, 0.2)),
        "ring": Ring(0.7, (0.1, 0.2)),
    },
    **{"ellipse": Ellipse(0.5, 0.3), "upright ellipse": Ellipse(0.3, 0.5), "parabola": Parabola(0.3)},
    **{"catenary": Catenary(0.4), "cam": Cam(0.4, (0.05, 0.02, 0.01), (0.0, 0.03))},
    "placed": Placed(Ellipse(0.5, 0.3), (1.0, 2.0), 0.7),
}


@pytest.mark.parametrize("case", CASES)
def test_tangent_and_curvature_are_derivatives_of_point_and_angle_by_arc_length(case):
    curve, step = CASES[case], 1e-3
    arc = np.linspace(0.1, 0.9, 9)
    weights, shifts = np.array([1, -8, 8, -1]) / 12 / step, np.array([-2, -1, 1, 2]) * step
    way = sum(weight * curve.point(arc + shift) for weight, shift in zip(weights, shifts, strict=True))
    turned = sum(weight * curve.angle(arc + shift) for weight, shift in zip(weights, shifts, strict=True))
    # The error is of fourth order in the ratio of the step to the smallest radius of curvature (about 0.1 m).
    along = np.stack([np.cos(curve.angle(arc)), np.sin(curve.angle(arc))], axis=-1)
    np.testing.assert_allclose(way, along, rtol=0, atol=1e-7)
    np.testing.assert_allclose(turned, curve.curvature(arc), rtol=1e-6, atol=1e-9)
    if case not in ("line", "side"):
        np.testing.assert_allclose(curve.arc(curve.angle(arc)), arc, rtol=1e-12)


@pytest.mark.parametrize("case", ["circle", "ring", "ellipse", "upright ellipse", "cam"])
def test_points_and_angles_of_closed_curves_are_continuous_over_many_turns(case):
    curve = CASES[case]
    arc = np.linspace(-7 * curve.length, 7 * curve.length, 5001)
    step = arc[1] - arc[0]
    steepest = max(map(abs, curve.curvature_range))
    assert np.abs(np.diff(curve.angle(arc))).max() <= 1.001 * steepest * step
    assert np.abs(np.diff(curve.point(arc), axis=0)).max() <= 1.001 * step
    np.testing.assert_allclose(curve.arc(curve.angle(arc)), arc, rtol=0, atol=1e-13)
    turned = curve.angle(arc + curve.length) - curve.angle(arc)
    np.testing.assert_allclose(turned, math.copysign(2 * np.pi, steepest * curve.curvature_range[0]), atol=1e-13)


def test_a_placed_curve_is_rotated_and_shifted_rigidly():
    placed, arc = CASES["placed"], np.linspace(-5, 5, 50)
    moved = np.array([1.0, 2.0]) + rotated(0.7, Ellipse(0.5, 0.3).point(arc))
    np.testing.assert_allclose(placed.point(arc), moved, atol=1e-15)


def test_a_curve_traced_through_points_of_an_ellipse_agrees_with_the_ellipse():
    u = np.linspace(0, 2, 200)
    traced, exact = Traced(u, np.stack([0.5 * np.cos(u), 0.3 * np.sin(u)], axis=-1)), Ellipse(0.5, 0.3)
    arc = np.linspace(0.01, traced.limits[1] - 0.01, 37)
    # The spline of degree 7 has an error of 0.01^8 in points and of 0.01^6 in the curvature.
    np.testing.assert_allclose(traced.point(arc), exact.point(arc), atol=1e-14)
    np.testing.assert_allclose(traced.angle(arc), exact.angle(arc), atol=1e-12)
    np.testing.assert_allclose(traced.curvature(arc), exact.curvature(arc), rtol=1e-9)
    np.testing.assert_allclose(traced.arc(traced.angle(arc)), arc, atol=1e-12)


def test_a_target_without_a_root_raises_arithmetic_error():
    with pytest.raises(ArithmeticError, match="no root"):
        solve_increasing(lambda x: (np.tanh(x), 1 / np.cosh(np.clip(x, -300, 300)) ** 2), [2.0], [0.0], 1.0)
    with pytest.raises(ArithmeticError, match="finite"):
        solve_increasing(lambda x: (x, np.ones_like(x)), [np.nan], [0.0], 1.0)


# Errors of poses are a few roundings of lengths near 1 m, times the number of turns.
ROUNDING = 1e-13


def test_the_contact_rate_of_a_hypocycloid_is_three_sevenths():
    # By erratum 4 the rate is 3/7 with the ring's negative curvature, and 0.2308 with a positive curvature.
    assert float(Rolling.at_arcs(Circle(0.3), Ring(1.0)).contact(1.0).rate) == pytest.approx(3 / 7, abs=1e-15)


def test_the_contact_of_a_disc_in_a_hole_of_nearly_its_size_is_accurate():
    rolling, clearance = Rolling.at_arcs(Circle(1.0), Ring(1.0 + 2.0**-20)), 2.0**-20
    # The contact goes round the hole 1 / clearance times as fast as the disc rotates.
    arc = float(rolling.contact(rolling.theta + 2.0**-10).ground_arc)
    assert arc == pytest.approx(2.0**-10 * (1 + clearance) / clearance, rel=1e-12)


def test_the_centre_of_a_square_on_a_catenary_moves_level_and_the_limits_are_its_corners():
    rolling = Rolling.at_arcs(Side(1.0), Placed(Catenary(0.5), turn=math.pi))
    quarter = math.pi / 4
    np.testing.assert_allclose(rolling.limits, [-quarter, quarter], rtol=1e-14)
    np.testing.assert_allclose(rolling.position(np.linspace(-quarter, quarter, 51))[:, 1], 0.0, atol=1e-15)
    with pytest.raises(InvalidMechanism, match="a curve ends"):
        rolling.pose(0.8)


def test_an_ellipse_in_a_tight_ring_rolls_until_the_curvatures_are_equal():
    shape, ring = Ellipse(0.5, 0.3), Ring(0.7)
    for start in (0.0, 0.1, -0.1):
        rolling = Rolling.at_arcs(shape, Placed(ring), 0.0, start)
        # On either side the rolling ends at the nearest point with the ring's curvature.
        ends = np.array(rolling._parameter_limits)
        assert shape.curvature_of(ends) == pytest.approx([1 / 0.7, 1 / 0.7], rel=1e-8)
        assert np.ptp(shape.arc_of(ends)) < shape.length / 2
        assert rolling.limits[0] < rolling.theta < rolling.limits[1]


PAIRS = {
    "cam on a slope": (Cam(0.4, (0.05, 0.0, 0.02), (0.0, 0.02)), Line(math.pi + 0.3)),
    "ellipse on a disc": (Ellipse(0.5, 0.3), Circle(1.0)),
    "ellipse in a ring": (Ellipse(0.5, 0.3), Ring(1.3)),
    "cam on an ellipse": (Cam(0.4, (0.1, 0.03)), Ellipse(1.0, 0.7)),
    "disc on an ellipse": (Circle(0.2), Ellipse(0.5, 0.4)),
    "ring round an ellipse": (Ring(2.0), Ellipse(0.5, 0.4)),
    "line on an ellipse": (Line(), Ellipse(0.5, 0.3)),
}


@pytest.mark.parametrize("pair", PAIRS)
def test_rolling_contacts_have_a_common_tangent_and_equal_arcs(pair):
    body, ground = PAIRS[pair]
    rolling = Rolling.at_arcs(body, ground, 0.2, 0.3)
    theta = rolling.theta + np.random.default_rng(3).uniform(-20, 20, 100)
    contact = rolling.contact(theta)
    np.testing.assert_allclose(contact.ground_arc + contact.body_arc, 0.5, atol=ROUNDING)
    touching = ground.angle(contact.ground_arc) + np.pi - theta - body.angle(contact.body_arc)
    touching = np.remainder(touching + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(touching, 0, atol=ROUNDING)
    place = rotated(theta, body.point(contact.body_arc))
    np.testing.assert_allclose(rolling.position(theta) + place, ground.point(contact.ground_arc), atol=ROUNDING)
    # Central differences with a step of 1e-3 rad have a rounding error of eps / step and a truncation error of
    # fourth order.
    step = 1e-3

    def slope(function):
        near, far = (function(theta + k * step) - function(theta - k * step) for k in (1, 2))
        return (8 * near - far) / (12 * step)

    ones = np.ones_like(theta)
    np.testing.assert_allclose(slope(rolling.position), rolling.velocity(theta, ones), atol=1e-8)
    np.testing.assert_allclose(slope(lambda th: rolling.contact(th).ground_arc), contact.rate, atol=1e-7)
    np.testing.assert_allclose(
        slope(lambda th: rolling.contact(th).point), contact.rate[:, None] * contact.tangent, atol=1e-7
    )
    np.testing.assert_allclose(
        slope(lambda th: rolling.velocity(th, ones)), rolling.acceleration(theta, ones, 0 * ones), atol=1e-6
    )


@pytest.mark.parametrize("pair", list(PAIRS)[::3])
def test_rows_of_a_roll_between_moving_bodies_are_derivatives_of_its_gap(pair):
    body, ground = PAIRS[pair]
    rolling = Rolling.at_arcs(body, ground, 0.2, 0.3)
    roll = Roll("roll", "first", "second", rolling)
    rng = np.random.default_rng(5)
    steps = 1e-100j * np.eye(6)
    for _ in range(2):
        first = rng.uniform(-2, 2, 3)
        x, y, angle = rolling.pose(rolling.theta + rng.uniform(-5, 5))
        cosine, sine = np.cos(first[2]), np.sin(first[2])
        second = np.array([first[0] + cosine * x - sine * y, first[1] + sine * x + cosine * y, first[2] + angle])
        np.testing.assert_allclose(roll.gap(first, second, 0.0), 0, atol=ROUNDING)
        derivative = [np.imag(roll.gap(first + step[:3], second + step[3:], 0.0)) / 1e-100 for step in steps]
        np.testing.assert_allclose(roll.rows(first, second), np.transpose(derivative), atol=1e-11)


def test_an_ellipse_on_the_incline_rolls_to_minus_x_and_gets_faster():
    scene = RollingDownhill()
    truth = scene.motion(np.array([0.0, scene.duration]))
    along, up = truth.pose[1, 0, :2] - truth.pose[0, 0, :2]
    assert along < -2
    # The descent differs from the slope by at most 0.1 m, half of the difference of the two axes.
    assert up == pytest.approx(math.tan(scene.slope) * along, abs=0.11)
    assert abs(truth.twist[1, 0, 2]) > abs(truth.twist[0, 0, 2])


def disc(radius, ground, rate, theta=0.0, **more):
    rolling = Rolling.at_angle(Circle(radius), ground, theta, **more)
    return RollingBody(rolling, 1.0, radius**2 / 2, rate)


def test_the_horizon_of_a_rolling_scene_ends_at_the_first_slip_or_hop():
    scene = RollingOnCircle()
    assert scene.horizon == scene.comparable_until < present(scene.hop) < scene.duration
    assert scene.motion_law.required_friction(scene.horizon)[0] == pytest.approx(scene.friction, rel=1e-9)
    # Friction does not prevent the hop, so the horizon ends at the hop for any friction.
    assert RollingOnCircle(friction=1e9).horizon == pytest.approx(scene.hop, rel=1e-6)
    assert RollingEllipse().horizon == RollingEllipse().duration
    assert RollingEllipse().comparable_until == math.inf
    # The ellipse needs a friction coefficient of 0.2993.
    assert RollingEllipse(friction=0.25).horizon < 1.0


def test_frequencies_of_small_oscillations_agree_with_closed_forms():
    a, b = 0.5, 0.3
    flat = RollingEllipse().motion_law
    # The stiffness is (radius of curvature at the flat side - height of the centre) m g.
    assert flat.small_frequency(0.0) ** 2 == pytest.approx(GRAVITY * (a * a / b - b) / ((a * a + b * b) / 4 + b * b))
    centred = RollingDisc(start_angle=-1.3)
    rest, near = math.pi / 2, 0.4 - 0.15
    assert centred.motion_law.small_frequency(rest) ** 2 == pytest.approx(GRAVITY * 0.15 / (0.4**2 / 2 + near**2))
    inside = disc(0.3, Ring(1.0), 0.0, math.pi / 2, ground_arc=math.pi / 2)
    # A disc of radius r in a hole of radius R has omega^2 = g / (1.5 (R - r)).
    assert inside.small_frequency(math.pi / 2) ** 2 == pytest.approx(GRAVITY / (1.5 * 0.7), rel=1e-12)


def watched(scene, looks=4001):
    """The sampling intervals in which the contact first has to pull, and first needs more friction than it has."""
    t = np.linspace(0, scene.duration, looks)
    tangent, normal = scene.motion_law.forces(t)
    rounding = 1e-11 * (1 + scene.friction) * np.abs([tangent, normal]).max()
    out = []
    for spare in (normal, scene.friction * normal - np.abs(tangent)):
        below = np.flatnonzero(spare < -rounding)
        out.append((t[max(0, below[0] - 1)], t[below[0]]) if below.size else None)
    return out


NANOMETRES = {"hill": 1e-9, "radius": 0.3e-9, "eccentricity": 0.05e-9, "gravity": (0.0, -GRAVITY * 1e-9)}
SLIPPING = (
    *(RollingOnCircle(), RollingEllipse(friction=0.25), RollingEllipse(start_rate=6.0), RollingOnCircle(**NANOMETRES)),
    *(RollingDisc(eccentricity=0.35, start_rate=-5.0, friction=0.03), RollingOnCircle(start_rate=1e-6, friction=20.0)),
)


@pytest.mark.parametrize("scene", SLIPPING)
def test_hop_and_slip_times_agree_with_sampled_forces(scene):
    slips = scene.motion_law.slip(scene.friction, scene.duration)
    for time, seen in zip((scene.hop, slips), watched(scene), strict=True):
        if seen is None:
            assert time is None
        else:
            assert seen[0] * (1 - 1e-12) <= present(time) <= seen[1]


@pytest.mark.parametrize("scene", [RollingEllipse(), RollingDisc(eccentricity=0.1), RollingInRing()])
def test_the_search_for_a_hop_ends_after_one_period_of_the_forces(scene):
    assert scene.motion_law.hop(1e9) is None
