"""Rolling: the known roulettes, where two curves touch, the rows of a roll, and pairs that can't roll.

Contacts in fifty digits are asked by `laws`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.mechanism import Body, Mechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.contact import NEAR_CONFORMAL
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola
from reference.rolling.roll import Roll

# Poses are a few roundings of lengths near 1 m, times the turns.
ROUNDING = 1e-13


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def test_a_point_of_a_wheels_rim_draws_a_cycloid_to_minus_x():
    theta = np.linspace(-20, 20, 101)
    rolling = Rolling.at_angle(Circle(0.5), Line())
    cycloid = np.stack([-0.5 * (theta - np.sin(theta)), 0.5 * (1 - np.cos(theta))], axis=-1)
    np.testing.assert_allclose(rolling.position(theta, (0.0, -0.5)), cycloid, atol=ROUNDING)


def test_the_chapters_rate_for_a_hypocycloid():
    # Erratum 4: 3/7 with a ring's negative curvature, 0.2308 with a positive one.
    assert float(Rolling.at_arcs(Circle(0.3), Ring(1.0)).contact(1.0).rate) == pytest.approx(3 / 7, abs=1e-15)


def test_the_heights_of_an_ellipses_foci_multiply_to_the_square_of_its_minor_axis():
    ellipse, theta = Ellipse(0.5, 0.3), np.linspace(-30, 30, 500)
    rolling = Rolling.at_angle(ellipse, Line(), 0.4)
    heights = [rolling.position(theta, focus)[:, 1] for focus in ellipse.foci]
    np.testing.assert_allclose(heights[0] * heights[1], 0.3**2, rtol=ROUNDING)


def test_a_parabola_on_its_twin_draws_the_directrix_and_a_cissoid():
    theta = np.linspace(-2.6, 2.6, 101)
    rolling = Rolling.at_arcs(Parabola(0.3), Placed(Parabola(0.3), turn=math.pi))
    np.testing.assert_allclose(rolling.position(theta, (0.0, 0.3))[:, 1], 0.3, rtol=1e-12)
    x, y = rolling.position(theta).T
    np.testing.assert_allclose(y * (x**2 + y**2), 0.6 * x**2, rtol=1e-11, atol=1e-15)


def test_the_pole_of_a_spiral_runs_on_a_straight_line():
    rolling = Rolling.at_angle(LogSpiral(0.5, 0.3), Line(), 0.2)
    x, y = rolling.position(np.linspace(-6, 6, 101)).T
    # The contact is at arc r / cos(alpha) from where the spiral would end in its pole, tan(alpha) = 1 / growth; the
    # pole stands r sin(alpha) above the ground, r cos(alpha) nearer: on a line of slope cot(alpha).
    slope = 0.3
    meets = rolling.ground.point(rolling.ground_arc + rolling.body_arc)[0]
    np.testing.assert_allclose(y, slope * np.abs(x - meets), rtol=1e-12)


def test_a_square_rolls_level_on_catenaries_and_stops_at_its_corners():
    rolling = Rolling.at_arcs(Side(1.0), Placed(Catenary(0.5), turn=math.pi))
    quarter = math.pi / 4
    np.testing.assert_allclose(rolling.limits, [-quarter, quarter], rtol=1e-14)
    np.testing.assert_allclose(rolling.position(np.linspace(-quarter, quarter, 51))[:, 1], 0.0, atol=1e-15)
    with pytest.raises(InvalidMechanism, match="a curve ends"):
        rolling.pose(0.8)


@dataclass(frozen=True)
class PrincipalValueEllipse(Ellipse):
    """The wrong model: an arc length that forgets the turns."""

    def arc_of(self, p):
        return super().arc_of(np.remainder(np.asarray(p) + np.pi, 2 * np.pi) - np.pi)


def test_a_turn_advances_by_the_circumference_and_the_check_catches_a_principal_value():
    turns = np.arange(-4, 5)
    away = {}
    for kind in (Ellipse, PrincipalValueEllipse):
        rolling = Rolling.at_angle(kind(0.5, 0.3), Line(), 0.3)
        away[kind] = rolling.advance(0.3 + 2 * np.pi * turns) - turns * rolling.body.length
    assert np.abs(away[Ellipse]).max() < ROUNDING
    assert np.abs(away[PrincipalValueEllipse]).max() > 1


SPIRAL = LogSpiral(0.5, 0.3)


@pytest.mark.parametrize("body_arc", [0.0, 2.0, 5.0])
def test_a_ring_about_an_ellipse_is_refused_by_the_ellipses_length_wherever_the_rings_centre_of_mass_is(body_arc):
    ring = Placed(Ring(1.0), turn=0.4, shift=(0.3, 0.1))
    # It touches at an end of its long axis, which has room across a circle of 1 m up to 2 m.
    Rolling.at_arcs(ring, Ellipse(0.999, 0.5), 0.0, body_arc)
    with pytest.raises(InvalidMechanism, match=r"reaches 0\.002 m beyond"):
        Rolling.at_arcs(ring, Ellipse(1.001, 0.5), 0.0, body_arc)


def test_an_ellipse_in_a_tight_ring_rolls_until_its_flat_side_fits_both_ways():
    shape, ring = Ellipse(0.5, 0.3), Ring(0.7)
    for start in (0.0, 0.1, -0.1):
        rolling = Rolling.at_arcs(shape, Placed(ring), 0.0, start)
        # As bent as the ring, to NEAR_CONFORMAL, at the nearest place on either side.
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
    "disc on a spiral": (Circle(0.3), Placed(SPIRAL)),
    "spiral on a spiral": (SPIRAL, LogSpiral(0.7, 0.2)),
    "spiral in a ring": (SPIRAL, Ring(3.0)),
}


@pytest.mark.parametrize("pair", PAIRS)
def test_contact_is_common_tangent_and_equally_long_on_both(pair):
    body, ground = PAIRS[pair]
    rolling = Rolling.at_arcs(body, ground, 0.2, 0.3)
    theta = rolling.theta + np.random.default_rng(3).uniform(*((-0.5, 6) if "spiral" in pair else (-20, 20)), 100)
    contact = rolling.contact(theta)
    np.testing.assert_allclose(contact.ground_arc + contact.body_arc, 0.5, atol=ROUNDING)
    touching = ground.angle(contact.ground_arc) + np.pi - theta - body.angle(contact.body_arc)
    touching = np.remainder(touching + np.pi, 2 * np.pi) - np.pi
    np.testing.assert_allclose(touching, 0, atol=ROUNDING)
    own = body.point(contact.body_arc)
    place = np.stack(
        [
            unit(theta)[:, 0] * own[:, 0] - unit(theta)[:, 1] * own[:, 1],
            unit(theta)[:, 1] * own[:, 0] + unit(theta)[:, 0] * own[:, 1],
        ],
        axis=-1,
    )
    np.testing.assert_allclose(rolling.position(theta) + place, ground.point(contact.ground_arc), atol=ROUNDING)
    # By central differences of the fifth order in a step of 1e-3 rad: rounding / step, and the step's fourth power.
    step = 1e-3

    def slope(function):
        near, far = (function(theta + k * step) - function(theta - k * step) for k in (1, 2))
        return (8 * near - far) / (12 * step)

    ones = np.ones_like(theta)
    np.testing.assert_allclose(slope(rolling.position), rolling.velocity(theta, ones), atol=1e-8)
    np.testing.assert_allclose(slope(rolling.advance), contact.rate, atol=1e-7)
    np.testing.assert_allclose(
        slope(lambda th: rolling.contact(th).point), contact.rate[:, None] * contact.tangent, atol=1e-7
    )
    np.testing.assert_allclose(
        slope(lambda th: rolling.velocity(th, ones)), rolling.acceleration(theta, ones, 0 * ones), atol=1e-6
    )


def test_acceleration_is_as_if_pinned_plus_a_rolling_term_small_when_sharp_and_large_when_conformal():
    def term(body, ground):
        rolling = Rolling.at_arcs(body, ground)
        added = rolling.acceleration(1.0, 2.0, 0.5) - rolling.pinned_acceleration(1.0, 2.0, 0.5)
        return float(np.linalg.norm(added))

    sharp, plain, conformal = term(Circle(1e-3), Line()), term(Circle(0.5), Line()), term(Circle(0.99), Ring(1.0))
    assert sharp == pytest.approx(4 * 1e-3, rel=1e-9)
    assert plain == pytest.approx(4 * 0.5, rel=1e-12)
    assert conformal == pytest.approx(4 * 99, rel=1e-12)


REFUSED = {
    "a ring smaller than its roller": (lambda: Rolling.at_arcs(Circle(0.5), Ring(0.3)), "sum must be positive"),
    "a ring of its roller's size": (lambda: Rolling.at_arcs(Circle(1.0), Ring(1 + NEAR_CONFORMAL / 4)), "so closely"),
    "flat on flat": (lambda: Rolling.at_arcs(Side(1.0), Line()), "sum must be positive"),
    "an ellipse too long for its ring": (lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Ring(0.45), 0.0), "beyond it"),
    "an ellipse too long for a ring that was moved": (
        lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Placed(Ring(0.45, (0.2, 0.1)), (1.0, -2.0), 0.7), 0.7),
        "beyond it",
    ),
    "a ring too narrow to roll about an ellipse": (
        lambda: Rolling.at_arcs(Ring(0.45), Ellipse(0.5, 0.3)),
        "beyond it",
    ),
    "an ellipse that fits at the tip only": (
        lambda: Rolling.at_angle(Ellipse(0.5, 0.3), Ring(0.7)).contact(2.0),
        "can't turn to 2.0 rad",
    ),
    "curves that cross": (lambda: Rolling(Circle(0.5), Line(), 0.0, 0.0, 0.1), "cross at an angle"),
    "a start not finite": (lambda: Rolling.at_angle(Circle(0.5), Line(), math.nan), "finite"),
    "a rotation not finite": (lambda: Rolling.at_angle(Circle(0.5), Line()).pose(math.inf), "finite"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_can_not_roll_is_refused_with_the_place(case):
    make, reason = REFUSED[case]
    with pytest.raises(InvalidMechanism, match=reason):
        make()


def test_an_ellipse_in_a_narrow_ring_is_stopped_by_its_rim_before_curvature_stops_it():
    rolling = Rolling.at_angle(Ellipse(0.5, 0.3), Ring(0.7))
    stop = rolling.limits[1]
    # The place where the curvatures cancel, found from the ellipse's own formula: speed^3 = a b R.
    sine = math.sqrt(((0.5 * 0.3 * 0.7) ** (2 / 3) - 0.3**2) / (0.5**2 - 0.3**2))
    arc = rolling.body.arc_of(-math.asin(sine))
    expected = -float(arc) * -1 / 0.7 - (float(rolling.body.angle(arc)) - math.pi / 2)
    assert stop == pytest.approx(expected, abs=1e-6)
    assert np.all(np.isfinite(rolling.pose(0.1)))
    with pytest.raises(InvalidMechanism, match="beyond it"):
        rolling.contact(stop - 1e-3)
    with pytest.raises(InvalidMechanism, match="fit each other"):
        rolling.contact(stop + 1e-3)


def complex_derivative(function, pose):
    """d function / d pose (..., 6) of the two bodies' poses by complex steps."""
    columns = []
    for i in range(6):
        step = np.zeros(6, dtype=complex)
        step[i] = 1e-100j
        columns.append(function(pose[:3] + step[:3], pose[3:] + step[3:]).imag / 1e-100)
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("pair", PAIRS)
def test_the_rows_of_a_roll_are_the_derivative_of_its_gap_between_moving_bodies(pair):
    body, ground = PAIRS[pair]
    rolling = Rolling.at_arcs(body, ground, 0.2, 0.3)
    roll = Roll("roll", "first", "second", rolling)
    rng = np.random.default_rng(5)
    for _ in range(5):
        first = rng.uniform(-2, 2, 3)
        x, y, angle = rolling.pose(rolling.theta + rng.uniform(-5, 5))
        cosine, sine = np.cos(first[2]), np.sin(first[2])
        second = np.array([first[0] + cosine * x - sine * y, first[1] + sine * x + cosine * y, first[2] + angle])
        np.testing.assert_allclose(roll.gap(first, second, 0.0), 0, atol=ROUNDING)
        derivative = complex_derivative(lambda p, q: roll.gap(p, q, 0.0), np.concatenate([first, second]))
        np.testing.assert_allclose(roll.rows(first, second), derivative, atol=1e-11)


def test_a_mechanism_of_two_rollers_has_a_freedom_each_and_its_bias_is_the_chapters_acceleration():
    # The first stands on its flat side, so that weight and normal force are in line.
    rollings = [Rolling.at_angle(Ellipse(0.5, 0.3), Line()), Rolling.at_angle(Circle(0.4, (0.15, 0.0)), Circle(2.0))]
    rates, bodies = (3.0, -2.0), []
    for name, rolling, rate in zip("ab", rollings, rates, strict=True):
        velocity = rolling.velocity(rolling.theta, rate)
        bodies.append(Body(name, 1.0, 0.1, tuple(rolling.pose(rolling.theta)), (*velocity, rate)))
    joints = tuple(Roll(f"roll {name}", None, name, rolling) for name, rolling in zip("ab", rollings, strict=True))
    mechanism = Mechanism(tuple(bodies), joints, (0.0, -9.81))
    assert mechanism.degrees_of_freedom() == (2, 2)
    growth = (1.5, -0.7)
    acceleration = np.array(
        [
            [*rolling.acceleration(rolling.theta, rate, alpha), alpha]
            for rolling, rate, alpha in zip(rollings, rates, growth, strict=True)
        ]
    )
    bias = mechanism.bias(mechanism.pose, mechanism.twist)
    np.testing.assert_allclose(mechanism.rows(mechanism.pose) @ acceleration.ravel(), bias, atol=1e-13)
    # A normal force on the resting roller holds its weight up: the sign of the row.
    reaction = mechanism.reaction(mechanism.pose, np.zeros((2, 3)))
    np.testing.assert_allclose(reaction[:2], [0.0, 9.81], atol=1e-12)


def test_a_roll_that_starts_open_is_refused():
    rolling = Rolling.at_angle(Circle(0.5), Line())
    with pytest.raises(InvalidMechanism, match=r"roll normal.*open"):
        Mechanism((Body("wheel", 1.0, 1.0, (0.0, 0.501, 0.0)),), (Roll("roll", None, "wheel", rolling),))
