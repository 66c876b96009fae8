"""Rolling: the known roulettes, velocity and acceleration against 40 digits, the joint Roll, and what is refused."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import mpmath as mp
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola

# Poses are a few roundings of lengths near 1 m, times the turns.
ROUNDING = 1e-13


def unit(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def test_a_point_of_a_wheels_rim_draws_a_cycloid_to_minus_x():
    theta = np.linspace(-20, 20, 101)
    rolling = Rolling.at_angle(Circle(0.5), Line())
    cycloid = np.stack([-0.5 * (theta - np.sin(theta)), 0.5 * (1 - np.cos(theta))], axis=-1)
    np.testing.assert_allclose(rolling.position(theta, (0.0, -0.5)), cycloid, atol=ROUNDING)


def cycloid_of(body, ground, distance, turning, theta):
    """Centre and traced point when the centre's polar angle is theta / turning, at a signed distance."""
    rolling = Rolling.at_arcs(body, ground)
    polar = (theta - rolling.theta) / turning
    centre = distance * unit(polar)
    start = unit(np.asarray(rolling.theta)) * body.radius
    wheel = np.stack(
        [
            np.cos(theta - rolling.theta) * start[0] - np.sin(theta - rolling.theta) * start[1],
            np.sin(theta - rolling.theta) * start[0] + np.cos(theta - rolling.theta) * start[1],
        ],
        axis=-1,
    )
    return rolling.position(theta, (body.radius, 0.0)), centre + wheel


@pytest.mark.parametrize(
    ("body", "ground", "distance", "turning"),
    [
        (Circle(0.3), Circle(1.0), 1.3, 1.3 / 0.3),  # epicycloid
        (Circle(0.3), Ring(1.0), 0.7, -0.7 / 0.3),  # hypocycloid
        (Ring(1.0), Circle(0.3), -0.7, 0.7 / 1.0),  # pericycloid
    ],
    ids=["epicycloid", "hypocycloid", "pericycloid"],
)
def test_circles_on_circles_draw_epi_hypo_and_pericycloids(body, ground, distance, turning):
    drawn, exact = cycloid_of(body, ground, distance, turning, np.linspace(-15, 15, 200))
    np.testing.assert_allclose(drawn, exact, atol=ROUNDING)


def test_the_check_catches_a_ring_taken_as_a_disc():
    drawn, exact = cycloid_of(Circle(0.3), Circle(1.0), 0.7, -0.7 / 0.3, np.linspace(-15, 15, 200))
    assert np.abs(drawn - exact).max() > 0.5


def test_the_chapters_rate_for_a_hypocycloid():
    # Erratum 4: 3/7 with a ring's negative curvature, 0.2308 with a positive one.
    assert float(Rolling.at_arcs(Circle(0.3), Ring(1.0)).contact(1.0).rate) == pytest.approx(3 / 7, abs=1e-15)


def test_the_heights_of_an_ellipses_foci_multiply_to_the_square_of_its_minor_axis():
    ellipse, theta = Ellipse(0.5, 0.3), np.linspace(-30, 30, 500)
    rolling = Rolling.at_angle(ellipse, Line(), 0.4)
    heights = [rolling.position(theta, focus)[:, 1] for focus in ellipse.foci]
    np.testing.assert_allclose(heights[0] * heights[1], 0.3**2, rtol=ROUNDING)


def test_the_focus_of_an_ellipse_on_its_twin_runs_on_a_circle():
    ellipse, theta = Ellipse(0.5, 0.3), np.linspace(-20, 20, 300)
    rolling = Rolling.at_arcs(ellipse, ellipse, 0.0, ellipse.length / 2)
    for own, other in (ellipse.foci, ellipse.foci[::-1]):
        distance = np.linalg.norm(rolling.position(theta, own) - np.asarray(own), axis=-1)
        np.testing.assert_allclose(distance, 2 * 0.5, rtol=ROUNDING)
        assert np.ptp(np.linalg.norm(rolling.position(theta, own) - np.asarray(other), axis=-1)) > 0.1


def test_the_focus_of_a_parabola_on_a_line_draws_a_catenary():
    theta = np.linspace(-1.4, 1.4, 101)
    x, y = Rolling.at_angle(Parabola(0.3), Line()).position(theta, (0.0, 0.3)).T
    np.testing.assert_allclose(y, 0.3 * np.cosh(x / 0.3), rtol=ROUNDING)


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


def exact_rolling(a, b, radius, sense, rolling):
    """theta -> centre in 40 digits, for an ellipse on flat ground (radius None), a disc (+1) or a ring (-1)."""
    a, b = mp.mpf(a), mp.mpf(b)
    theta_start, body_start = mp.mpf(rolling.theta), mp.mpf(rolling.body_arc)

    def arc(u):
        return b * mp.ellipe(u, 1 - (a / b) ** 2)

    def direction(u):
        return u + mp.pi / 2 + mp.atan2((a - b) * mp.sin(u) * mp.cos(u), a * mp.sin(u) ** 2 + b * mp.cos(u) ** 2)

    def ground(s):
        if radius is None:
            return (-s, mp.mpf(0)), mp.pi
        polar = sense * (rolling.ground_arc + s) / mp.mpf(radius)
        return (radius * mp.cos(polar), radius * mp.sin(polar)), polar + sense * mp.pi / 2

    start = mp.findroot(lambda u: arc(u) - body_start, float(rolling.body.parameter(rolling.body_arc)))

    def rotation(u):
        s = body_start - arc(u)
        return theta_start + (ground(s)[1] - ground(mp.mpf(0))[1]) - (direction(u) - direction(start))

    def centre(theta, guess):
        u = mp.findroot(lambda v: rotation(v) - theta, guess)
        (x, y), _ = ground(body_start - arc(u))
        px, py = a * mp.cos(u), b * mp.sin(u)
        return x - mp.cos(theta) * px + mp.sin(theta) * py, y - mp.sin(theta) * px - mp.cos(theta) * py

    return centre


@pytest.mark.parametrize(
    ("ground", "radius", "sense"),
    [(Line(), None, 0), (Circle(0.9), 0.9, 1), (Ring(1.7), 1.7, -1)],
    ids=["line", "disc", "ring"],
)
def test_pose_velocity_and_acceleration_are_those_of_40_digits(ground, radius, sense):
    rng = np.random.default_rng(7)
    rolling = Rolling.at_angle(Ellipse(0.5, 0.3), ground, 0.6)
    with mp.workdps(40):
        centre = exact_rolling(0.5, 0.3, radius, sense, rolling)
        for theta, rate, growth in rng.uniform([-9, -3, -3], [9, 3, 3], (3, 3)):
            guess = mp.mpf(float(rolling.body.parameter(rolling.contact(theta).body_arc)))
            exact = [centre(mp.mpf(theta), guess)]

            @cache  # both coordinates are asked for at the same times
            def motion(t, theta=theta, rate=rate, growth=growth, guess=guess):
                return centre(mp.mpf(theta) + rate * t + growth * t * t / 2, guess)

            exact += [[mp.diff(lambda t, i=i: motion(t)[i], 0, order) for i in (0, 1)] for order in (1, 2)]
            found = (
                rolling.position(theta),
                rolling.velocity(theta, rate),
                rolling.acceleration(theta, rate, growth),
            )
            for order, (ours, theirs) in enumerate(zip(found, exact, strict=True)):
                # Rounding of the contact, times 1 / (sum of curvatures), of the order of 1 m, and rates squared.
                np.testing.assert_allclose(ours, [float(v) for v in theirs], rtol=0, atol=2e-14 * 4**order)
            wrong = rolling.pinned_acceleration(theta, rate, growth) - rolling.rolling_acceleration(theta, rate)
            # The wrong direction of e_n is off by twice the rolling term.
            assert np.linalg.norm(wrong - [float(v) for v in exact[2]]) > rate**2 * 0.1


SPIRAL = LogSpiral(0.5, 0.3)


@pytest.mark.parametrize(
    ("body", "ground"),
    [
        (SPIRAL, Line()),
        (SPIRAL, Circle(1.0)),
        (Circle(0.3), SPIRAL),
        (Ellipse(0.5, 0.3), SPIRAL),
        (SPIRAL, LogSpiral(0.7, 0.2)),
        (SPIRAL, Ring(3.0)),
    ],
)
def test_a_logarithmic_spiral_rolls_on_every_curve_and_under_every_curve(body, ground):
    rolling = Rolling.at_arcs(body, ground, 1.0, 1.0)
    theta = rolling.theta + np.array([-3.0, -0.1, 0.0, 1.0, 6.0])
    contact = rolling.contact(theta)
    assert contact.ground_arc + contact.body_arc == pytest.approx(np.full(5, 2.0), abs=1e-12)
    # The tangents are opposite and the material of both is on the left: what touching means.
    mismatch = ground.angle(contact.ground_arc) + math.pi - theta - body.angle(contact.body_arc)
    assert np.abs(np.remainder(mismatch + math.pi, 2 * math.pi) - math.pi).max() < 1e-12
    step = 1e-5
    slope = (rolling.position(theta + step) - rolling.position(theta - step)) / (2 * step)
    assert slope == pytest.approx(rolling.velocity(theta, np.ones(5)), abs=1e-7)


def test_a_spiral_winds_round_its_pole_without_end():
    assert Rolling.at_arcs(SPIRAL, Line(), 0.0, 1.0).limits == (-math.inf, math.inf)
    assert Rolling.at_arcs(Circle(0.3), SPIRAL, 1.0, 0.0).limits == (-math.inf, math.inf)
    # A logarithmic spiral on a line carries its pole along a straight line: the classical roulette.
    rolling = Rolling.at_arcs(SPIRAL, Line(), 0.0, 1.0)
    path = rolling.position(rolling.theta + np.linspace(-2.0, 8.0, 7))
    along, across = np.diff(path, axis=0).T
    assert across / along == pytest.approx(np.full(6, across[0] / along[0]), rel=1e-9)


@pytest.mark.parametrize("body_arc", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
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
