"""Tests of skates, sleighs, tows, trains and casters, and of the integrability of their velocity rows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reference.chapter.integrability import (
    exterior_derivatives,
    freedoms_by_brackets,
    growth,
    is_integrable,
    mechanism_is_integrable,
    obstruction,
)
from reference.chapter.skates import (
    Move,
    commutator,
    commutator_displacement,
    coriolis_factors,
    frobenius,
    one_form,
    park,
    sidestep,
    skate_of,
    stops,
    trace,
)
from reference.checks import InvalidMechanism
from reference.joints import Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates import ChaplyginSleigh, PinnedBody, SleighBackwards
from reference.scenes.wheels.trailers import CarWithTrailers, Tow
from reference.scenes.wheels.vehicles import CarAndTrailer, Cart, Casters
from tests.mechanisms import four_bar
from tests.present import present


def test_a_skate_reaches_any_pose_by_turn_slide_and_turn():
    rng = np.random.default_rng(7)
    for start, goal in rng.uniform(-9, 9, (12, 2, 3)):
        for backwards in (True, False):
            moves = park(tuple(start), tuple(goal), backwards)
            assert np.abs(stops(tuple(start), moves)[-1] - goal).max() < 1e-13
            assert abs(moves[0].turn) <= (math.pi / 2 if backwards else math.pi)
    assert park((1.0, 2.0, 0.0), (1.0, 2.0, 3.0)) == (Move(), Move(turn=3.0))


def test_a_skate_never_moves_sideways_in_a_manoeuvre():
    path = trace((0.0, 0.0, 0.3), (*park((0.0, 0.0, 0.3), (1.0, 2.0, -1.0)), *sidestep(1.0, 0.7, 0.5)))
    moved, middle = np.diff(path, axis=0), 0.5 * (path[1:, 2] + path[:-1, 2])
    assert np.abs(-np.sin(middle) * moved[:, 0] + np.cos(middle) * moved[:, 1]).max() < 1e-14


def test_the_commutator_displacement_tends_to_the_product_of_turn_and_slide_sideways():
    displaced = stops((0.0, 0.0, 0.0), commutator(0.6, 0.5))[-1]
    assert np.abs(displaced - [*commutator_displacement(0.6, 0.5), 0.0]).max() < 1e-15
    turn = np.array([1e-1, 1e-2, 1e-3])
    rest = commutator_displacement(turn, turn) / turn[:, None] ** 2 - [0.0, 1.0]
    assert np.abs(rest[:, 0] / turn + 1 / 2).max() < 1e-3  # -turn/2 + turn^3/24.
    assert np.abs(rest[:, 1] / turn**2 + 1 / 6).max() < 1e-4  # -turn^2/6 + turn^4/120.


def test_a_sidestep_moves_exactly_sideways_within_its_limits():
    for distance in (2.3, -0.01, 1e-6):
        moves = sidestep(distance, 0.5, 0.4)
        assert np.abs(stops((0.0, 0.0, 0.0), moves)[-1] - [0.0, distance, 0.0]).max() < 1e-14
        assert np.abs(trace((0.0, 0.0, 0.0), moves)[:, 2]).max() <= 0.4 + 1e-12
    assert sidestep(0.0, 1.0, 1.0) == ()
    with pytest.raises(InvalidMechanism, match="room"):
        sidestep(1.0, 0.0, 1.0)


def test_a_fast_sleigh_moves_straight_after_its_settling_time():
    for sleigh in (ChaplyginSleigh(speed=1e5, duration=1e3), ChaplyginSleigh(offset=-1e-3, inertia=1e-9, duration=1e3)):
        long = sleigh.skate_pose([1e-2 + sleigh._settled, 1000.0])
        gone, settled = long[1] - long[0], long[1, 2]
        top = math.copysign(sleigh._top_speed * (1000 - 1e-2 - sleigh._settled), sleigh.offset)
        assert np.abs(gone[:2] - top * np.array([math.cos(settled), math.sin(settled)])).max() < 1e-14 * abs(top)
    # After the settling time the quadrature and the straight motion agree.
    sleigh = ChaplyginSleigh()
    later = sleigh._settled + 1.0
    assert abs(sleigh._moved(later) - sleigh.skate_pose(later)[0] @ [1, 1j, 0]) < 1e-13


def test_a_small_turning_rate_of_a_backward_sleigh_grows_exponentially_until_it_has_reversed():
    sleigh = SleighBackwards(turning_rate=1e-9)
    turning = sleigh.rates([1.0, 2.0])[1]
    assert math.log(turning[1] / turning[0]) == pytest.approx(sleigh.growth_rate(), rel=1e-14)
    assert ChaplyginSleigh().growth_rate() < 0
    speed = SleighBackwards().rates([0.0, 20.0])[0]
    assert speed[0] == pytest.approx(-1.0, abs=1e-6)
    assert speed[1] == pytest.approx(1.0, abs=1e-6)
    # The heading changes by pi k / |a| in a full reversal.
    assert SleighBackwards().heading(200.0) == pytest.approx(math.pi * math.sqrt(0.4) / 0.5, rel=1e-3)


def test_a_tow_at_an_equilibrium_angle_does_not_rotate():
    assert np.abs(Tow(1.0, 0.0).relative_angle([1.0, -1.0, 1e3, -1e3])).max() == 0
    assert np.all(Tow(1.0, math.pi).relative_angle([1.0, 1e3]) == math.pi)
    assert Tow(1.0, 1e-9).relative_angle(-1e3) == pytest.approx(math.pi, abs=1e-15)  # unstable backwards


@pytest.mark.parametrize(("hitch", "speed"), [(0.6, 1.3), (-0.4, -0.4)])
def test_a_trailer_behind_a_circling_car_is_a_tow(hitch, speed):
    car, t = CarWithTrailers(2.5, (3.0,), (hitch,)), np.linspace(0, 8, 9)
    driven = car.drive(speed, 0.3, (1.0, 2.0, 0.3), (0.4,), t)
    curvature = math.tan(0.3) / 2.5
    pace, direction = math.hypot(1, hitch * curvature), 0.3 - math.atan(hitch * curvature)
    tow = Tow(3.0, 0.7 - direction, pace / curvature, (0.0, 0.0, direction))
    assert np.abs(tow.heading(pace * speed * t) - driven.pose[:, 1, 2]).max() < 2e-12
    assert driven.error.max() < 2e-11
    if speed > 0:  # steady state with v sin b - h w cos b = L w
        settled = -(math.asin(3.0 * curvature / pace) + math.atan(hitch * curvature))
        assert car.drive(speed, 0.3, (0, 0, 0), (0.4,), [300.0]).bends[0, 0] == pytest.approx(settled, abs=1e-11)


def test_axles_of_a_car_with_trailers_have_no_lateral_velocity():
    car = CarWithTrailers(1.0, (0.9, 1.1, 0.7), (0.2, 0.0, -0.1))
    t, step = np.linspace(0.1, 2, 4), 1e-3
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60 / step
    shifts = np.array([-3, -2, -1, 1, 2, 3]) * step

    def driven(t):
        speed, steering = (lambda t: 1 + 0.5 * np.sin(t)), (lambda t: 0.5 * np.cos(1.3 * t))
        return car.drive(speed, steering, (0.0, 0.0, 0.0), (0.3, -0.5, 0.2), t)

    middle = driven(t)
    velocity = np.sum([w * driven(t + s).pose for w, s in zip(weights, shifts, strict=True)], axis=0)
    heading = middle.pose[:, :, 2]
    across = -np.sin(heading) * velocity[..., 0] + np.cos(heading) * velocity[..., 1]
    along = np.cos(heading) * velocity[..., 0] + np.sin(heading) * velocity[..., 1]
    assert np.abs(across).max() < 1e-8  # truncation and rounding
    assert np.abs(along - middle.speed).max() < 1e-8


def test_the_jackknife_time_of_a_reversing_trailer_agrees_with_the_closed_form():
    car = CarWithTrailers(2.0, (1.5,), (0.0,))
    driven = car.drive(-1.0, 0.0, (0.0, 0.0, 0.0), (0.01,), [10.0, 20.0])
    # tan(psi/2) is proportional to exp(s/L) and is 1 at a right angle.
    assert driven.jackknifed_at == pytest.approx(-1.5 * math.log(math.tan(0.005)), abs=1e-10)
    assert driven.bends[-1, 0] == pytest.approx(2 * math.atan(math.tan(0.005) * math.exp(20 / 1.5)), abs=1e-10)
    assert car.drive(1.0, 0.0, (0.0, 0.0, 0.0), (0.01,), [20.0]).jackknifed_at is None
    for bend in (-0.3, 0.3):  # the first trailer's axle is the second trailer's hitch
        pair = CarWithTrailers(1.0, (0.9, 1.1), (0.0, 0.0))
        second = pair.drive(-1.0, 0.0, (0.0, 0.0, 0.0), (0.0, bend), [4.0], limit=1.0)
        assert (driven.jackknifed, second.jackknifed) == (1, 2)
        assert Tow(1.1, 0.3).relative_angle(-present(second.jackknifed_at)) == pytest.approx(1.0, abs=1e-11)


@pytest.mark.parametrize("turning_rate", [0.5, -0.5])
def test_a_caster_on_a_circling_cart_is_a_tow(turning_rate):
    casters, t = Casters(((1.0, 0.3), (1.0, -0.3)), 0.1), np.linspace(0, 5, 11)
    swung, error = casters.swing((1.0, 2.0), 0.7, turning_rate, t)
    assert error.max() < 1e-11
    for index, angle in enumerate((1.0, 2.0)):
        tow, speed = casters.tow(index, angle, 0.7, turning_rate)
        assert np.abs(tow.relative_angle(speed * t) + angle - tow.angle - swung[:, index]).max() < 1e-11


def test_casters_turn_by_pi_when_the_cart_reverses():
    casters = Casters(((1.0, 0.3), (1.0, -0.3)), 0.1)
    # beta is a right angle when tan(beta/2) = 1, at s = c log(1/tan(0.0005)).
    way = -0.1 * math.log(math.tan(0.0005))
    swung, _ = casters.swing((1e-3, -1e-3), -0.5, 0.0, [0.0, way / 0.5, 20.0])
    assert np.abs(swung[1:] - np.array([[0.5, -0.5], [1, -1]]) * math.pi).max() < 1e-8


def test_the_wheels_and_kingpins_of_a_cart_are_at_hand_computed_points():
    """The points [m] from each centre of mass are computed by hand, without `Casters`."""
    cart = Cart(centre=0.3, front=0.8, width=0.5, trail=0.12, caster_centre=0.04, redundant=True).mechanism()
    points = {joint.name: joint.second_point for joint in cart.joints if isinstance(joint, Skate)}
    assert points["left wheel"] == pytest.approx((-0.3, 0.25))
    assert points["right wheel"] == pytest.approx((-0.3, -0.25))
    for side, sign in (("left", 1), ("right", -1)):
        kingpin = next(joint for joint in cart.joints if joint.name == f"{side} caster's kingpin")
        assert isinstance(kingpin, Pin)
        assert (kingpin.first, kingpin.second) == ("cart", f"{side} caster")
        assert kingpin.first_point == pytest.approx((0.5, sign * 0.25))
        assert kingpin.second_point == pytest.approx((0.04, 0.0))
        assert points[f"{side} caster's wheel"] == pytest.approx((0.04 - 0.12, 0.0))


@pytest.mark.parametrize(("bends", "which"), [((0.1, -2.0), 2), ((2.0, 0.1), 1), ((0.1, 0.2), None)])
def test_a_trailer_jackknifed_at_the_start_is_reported_by_number(bends, which):
    for times in ([0.0], [0.0, 1e-3]):
        found = CarWithTrailers(1.0, (0.9, 1.1), (0.2, 0.0)).drive(1.0, 0.0, (0.0, 0.0, 0.0), bends, times)
        assert (found.jackknifed_at, found.jackknifed) == (None if which is None else 0.0, which)


def test_a_brief_jackknife_between_samples_is_reported():
    car, start = CarWithTrailers(1.0, (1.0,), (0.0,)), (0.0, 0.0, 0.0)

    def drive(t, limit=math.pi):
        return car.drive(1.0, lambda t: 0.9 * np.sin(3 * t), start, (0.0,), t, limit)

    largest = np.abs(drive(np.linspace(0, 2, 2001)).bends).max()
    assert drive([2.0], largest + 1e-5).jackknifed_at is None
    assert drive([2.0], largest - 1e-9).jackknifed == 1


RANDOM = np.random.default_rng(185)
ROWS = [*map(tuple, RANDOM.normal(size=(3, 3)).tolist()), (1e-9, 2e-9, 3e-9), (1e9, 0.0, -1e9), (0.0, -2.0, 0.0)]


@pytest.mark.parametrize("row", ROWS)
def test_rows_with_a_velocity_component_are_skates_and_not_integrable(row):
    skate, size = skate_of(row), np.hypot(*row[:2])
    assert skate is not None
    place = np.zeros(3)
    for place in RANDOM.normal(size=(4, 3)):
        body = Body("body", 1.0, 1.0, tuple(place.tolist()))
        held = Mechanism((body,), (skate,)).rows(place[None])[0]
        # The error is the rounding of the skate's point and angle, relative to the row.
        assert held == pytest.approx(one_form(row)(place)[0] / size, abs=1e-15 * (1 + np.abs(row).max() / size))
        assert frobenius(row, place) == pytest.approx(-(size**2), rel=1e-13)
    unit = tuple(number / max(map(abs, row)) for number in row)
    assert not is_integrable(one_form(unit), place)
    assert growth(one_form(unit), place) == (2, 3)


@pytest.mark.parametrize(
    ("speed", "rate", "alpha"), [(1.3, 1.7, -0.6), (-2.0, 0.4, 5.0), (1e-6, -1e6, 0.0), (3, 1e-6, 0)]
)
def test_the_coriolis_like_term_has_factor_one_for_a_skate_and_two_for_a_slider(speed, rate, alpha):
    assert coriolis_factors(speed, rate, alpha) == pytest.approx((1.0, 2.0), rel=1e-12)


def test_a_row_that_is_not_exact_may_be_integrable():
    """The row is exp(x) d(y + theta^2), which is integrable and not exact."""
    place = np.array([0.3, -0.2, 0.8])

    def scaled_position(place):
        factor = np.exp(place[..., 0])
        return np.stack([0 * factor, factor, 2 * place[..., 2] * factor], axis=-1)[..., None, :]

    assert np.abs(exterior_derivatives(scaled_position, place)).max() > 0.1
    assert np.abs(obstruction(scaled_position, place)).max() < 1e-14
    assert is_integrable(scaled_position, place)
    assert growth(scaled_position, place) == (2,)


def test_a_row_with_zero_obstruction_at_one_place_only_is_not_integrable():
    """The row w = dy + x^2 dtheta has dot(w, curl w) = 2 x, which is zero only at x = 0."""

    def deceiving(place):
        x = place[..., 0]
        return np.stack([0 * x, 1 + 0 * x, x**2], axis=-1)[..., None, :]

    assert np.abs(obstruction(deceiving, np.zeros(3))).max() < 1e-15
    assert not is_integrable(deceiving, np.zeros(3))


@pytest.mark.parametrize(
    ("mechanism", "counted", "bracketed"),
    [
        (PinnedBody().mechanism(), (1, 1), (1,)),
        (ChaplyginSleigh().mechanism(), (3, 2), (2, 3)),
        (four_bar(), (1, 1), (1,)),
        (four_bar(1.0, 1.0), (0, 0), (0,)),
        (Cart().mechanism(), (5, 2), (2, 3, 5)),
        (Cart(redundant=True).mechanism(), (5, 2), (2, 3, 5)),
        # With one freedom of velocity the motion follows one curve, so the skates are integrable together.
        (CarAndTrailer().mechanism(), (4, 1), (1,)),
        (CarAndTrailer(redundant=True).mechanism(), (4, 1), (1,)),
    ],
    ids=["pinned", "sleigh", "four-bar", "driven four-bar", "cart", "cart, redundant", "car", "car, redundant"],
)
def test_freedoms_by_rank_agree_with_freedoms_by_brackets(mechanism, counted, bracketed):
    assert mechanism.degrees_of_freedom() == counted
    assert freedoms_by_brackets(mechanism) == bracketed
    assert bracketed[0] == counted[1]
    assert mechanism_is_integrable(mechanism) == (len(bracketed) == 1)
