"""Where two curves touch, the rows of a roll, and pairs that can not roll."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.mechanism import Body, Mechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.contact import NEAR_CONFORMAL
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from tests.reference.test_rolling import ROUNDING, unit

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
def test_contact_is_common_tangent_and_equally_long_on_both(pair):
    body, ground = PAIRS[pair]
    rolling = Rolling.at_arcs(body, ground, 0.2, 0.3)
    theta = rolling.theta + np.random.default_rng(3).uniform(-20, 20, 100)
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


def test_a_contact_that_runs_the_wrong_way_on_the_body_slips():
    rolling = Rolling.at_angle(Ellipse(0.5, 0.3), Line())
    theta, step = 0.7, 1e-5

    def contact_slip(sense):
        """Speed per radian of the body's material at the contact, if body_arc = start + sense * advance."""

        def centre(th):
            contact = rolling.contact(th)
            advance = contact.ground_arc - rolling.ground_arc
            own = rolling.body.point(rolling.body_arc + sense * advance)
            cosine, sine = np.cos(th), np.sin(th)
            return contact.point - [cosine * own[0] - sine * own[1], sine * own[0] + cosine * own[1]]

        arm = rolling.contact(theta).point - centre(theta)
        velocity = (centre(theta + step) - centre(theta - step)) / (2 * step)
        return float(np.linalg.norm(velocity + np.array([-arm[1], arm[0]])))

    assert contact_slip(-1) < 1e-9
    assert contact_slip(+1) > 0.1


def test_bodies_lie_outside_the_grounds_material():
    theta = np.linspace(-12, 12, 60)
    for name, outside in (
        ("ellipse on a disc", lambda p: np.linalg.norm(p, axis=-1) - 1.0),
        ("ellipse in a ring", lambda p: 1.3 - np.linalg.norm(p, axis=-1)),
        ("cam on a slope", lambda p: p @ [-math.sin(0.3), math.cos(0.3)]),
    ):
        body, ground = PAIRS[name]
        x, y, angle = np.moveaxis(Rolling.at_arcs(body, ground, 0.2, 0.3).pose(theta), -1, 0)[..., None]
        rim = body.point(np.linspace(0, body.length, 2000))
        world = np.stack(
            [
                x + np.cos(angle) * rim[:, 0] - np.sin(angle) * rim[:, 1],
                y + np.sin(angle) * rim[:, 0] + np.cos(angle) * rim[:, 1],
            ],
            axis=-1,
        )
        depth = outside(world)
        assert depth.min() > -ROUNDING
        # It touches: the rim's 2000 points come within the square of their spacing, 1.5 mm, over the radius.
        assert depth.min(axis=-1).max() < 1e-5


def test_acceleration_is_as_if_pinned_plus_a_rolling_term_small_when_sharp_and_large_when_conformal():
    def term(body, ground):
        rolling = Rolling.at_arcs(body, ground)
        added = rolling.acceleration(1.0, 2.0, 0.5) - rolling.pinned_acceleration(1.0, 2.0, 0.5)
        return float(np.linalg.norm(added))

    sharp, plain, conformal = term(Circle(1e-3), Line()), term(Circle(0.5), Line()), term(Circle(0.99), Ring(1.0))
    assert sharp == pytest.approx(4 * 1e-3, rel=1e-9)
    assert plain == pytest.approx(4 * 0.5, rel=1e-12)
    assert conformal == pytest.approx(4 * 99, rel=1e-12)


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 1e-8])
def test_the_contact_loses_digits_in_proportion_to_conformality(gap):
    radius = 1 - gap
    rolling = Rolling.at_arcs(Circle(radius), Ring(1.0))
    contact = rolling.contact(rolling.theta + 0.5)
    with mp.workdps(40):
        exact = mp.mpf(0.5) * mp.mpf(radius) / (1 - mp.mpf(radius))
    assert float(contact.conformality) == pytest.approx(gap, rel=1e-6)
    # One rounding of the curvature, over their difference: what NEAR_CONFORMAL's comment promises.
    assert abs(float(contact.ground_arc - exact)) < 4 * 2.2e-16 / gap * float(exact)


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
