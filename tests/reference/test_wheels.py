"""Wheels: tows, cars with trailers, casters: their limits, folds and settlings, and what their wheels stand on.

Tows, casters and trailers in fifty digits are asked by `laws`, the coasting scenes by `test_scenes`.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.joints import Pin, Skate
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart, Casters
from reference.scenes.wheels.tractrix import Tow
from reference.scenes.wheels.trailers import CarWithTrailers
from tests.present import present


def test_a_tow_on_a_circle_settles_or_goes_round_for_ever():
    for radius in (3.0, -1.5):
        tow = Tow(1.0, 2.0, radius)
        assert tow.relative_angle(60.0) == pytest.approx(-math.asin(1.0 / radius), abs=1e-14)
    slow = Tow(1.0, 0.0, 1.0)  # R = L: the wheel comes to the centre as 2 L^2 / s
    assert (slow.relative_angle(1e6) + math.pi / 2) * 1e6 == pytest.approx(2, rel=1e-5)
    round_and_round = Tow(1.0, 0.3, 0.5)
    period = 2 * math.pi / math.sqrt(0.5**-2 - 1)  # psi falls by a full turn
    turned = round_and_round.relative_angle([0.0, period, 7 * period, -period])
    assert np.abs(turned - 0.3 + 2 * math.pi * np.array([0, 1, 7, -1])).max() < 1e-13


def test_a_tow_started_straight_behind_or_folded_over_stays_so():
    assert np.abs(Tow(1.0, 0.0).relative_angle([1.0, -1.0, 1e3, -1e3])).max() == 0
    assert np.all(Tow(1.0, math.pi).relative_angle([1.0, 1e3]) == math.pi)
    assert Tow(1.0, 1e-9).relative_angle(-1e3) == pytest.approx(math.pi, abs=1e-15)  # pushed, it folds over


@pytest.mark.parametrize(("hitch", "speed"), [(0.0, 1.3), (0.6, 1.3), (-0.4, 1.3), (0.6, -0.4)])
def test_a_trailer_behind_a_circling_car_is_a_tow(hitch, speed):
    car, t = CarWithTrailers(2.5, (3.0,), (hitch,)), np.linspace(0, 20, 21)
    driven = car.drive(speed, 0.3, (1.0, 2.0, 0.3), (0.4,), t)
    curvature = math.tan(0.3) / 2.5
    pace, direction = math.hypot(1, hitch * curvature), 0.3 - math.atan(hitch * curvature)
    tow = Tow(3.0, 0.7 - direction, pace / curvature, (0.0, 0.0, direction))
    assert np.abs(tow.heading(pace * speed * t) - driven.pose[:, 1, 2]).max() < 2e-12
    assert driven.error.max() < 2e-11
    if speed > 0:  # v sin b - h w cos b = L w: it circles with the car
        settled = -(math.asin(3.0 * curvature / pace) + math.atan(hitch * curvature))
        assert car.drive(speed, 0.3, (0, 0, 0), (0.4,), [300.0]).bends[0, 0] == pytest.approx(settled, abs=1e-11)


def test_no_axle_of_a_train_skids_whatever_is_steered():
    car = CarWithTrailers(1.0, (0.9, 1.1, 0.7), (0.2, 0.0, -0.1))
    t, step = np.linspace(0.1, 6, 13), 1e-3
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
    assert np.abs(across).max() < 1e-8  # order 6 of rates about 2/s, and 1e-12/h
    assert np.abs(along - middle.speed).max() < 1e-8


def test_a_reversing_trailer_jackknifes_when_its_exact_angle_says():
    car = CarWithTrailers(2.0, (1.5,), (0.0,))
    driven = car.drive(-1.0, 0.0, (0.0, 0.0, 0.0), (0.01,), [10.0, 20.0])
    # tan(psi/2) grows as exp(s/L); it is 1 at a right angle.
    assert driven.jackknifed_at == pytest.approx(-1.5 * math.log(math.tan(0.005)), abs=1e-10)
    assert driven.jackknifed == 1
    assert driven.bends[-1, 0] == pytest.approx(2 * math.atan(math.tan(0.005) * math.exp(20 / 1.5)), abs=1e-10)
    assert car.drive(1.0, 0.0, (0.0, 0.0, 0.0), (0.01,), [20.0]).jackknifed_at is None
    assert car.drive(1.0, 0.0, (0.0, 0.0, 0.0), (-2.0,), [1.0]).jackknifed_at == 0.0


def test_bad_trains_are_refused():
    with pytest.raises(InvalidMechanism):
        CarWithTrailers(1.0, (1.0,), ())
    with pytest.raises(InvalidMechanism):
        CarAndTrailer(steering=math.pi / 2)
    car = CarWithTrailers(1.0, (1.0,), (0.0,))
    with pytest.raises(InvalidMechanism, match="joint angles"):
        car.drive(1.0, 0.0, (0, 0, 0), (), [1.0])
    with pytest.raises(InvalidMechanism, match="steering"):
        car.drive(1.0, math.nan, (0, 0, 0), (0.0,), [1.0])


@pytest.mark.parametrize("turning_rate", [0.5, -0.5])
def test_a_caster_on_a_circling_cart_is_a_tow(turning_rate):
    casters, t = Casters(((1.0, 0.3), (1.0, -0.3)), 0.1), np.linspace(0, 5, 11)
    swung, error = casters.swing((1.0, 2.0), 0.7, turning_rate, t)
    assert error.max() < 1e-11
    for index, angle in enumerate((1.0, 2.0)):
        tow, speed = casters.tow(index, angle, 0.7, turning_rate)
        assert np.abs(tow.relative_angle(speed * t) + angle - tow.angle - swung[:, index]).max() < 1e-11


def test_casters_swing_round_when_the_cart_is_reversed():
    casters = Casters(((1.0, 0.3), (1.0, -0.3)), 0.1)
    swung, _ = casters.swing((1e-3, -1e-3), -0.5, 0.0, [0.0, 20.0])
    assert np.abs(swung[1] - [math.pi, -math.pi]).max() < 1e-10
    assert np.abs(casters.swing((0.0, 0.0), -0.5, 0.0, [20.0])[0]).max() == 0
    # Halfway when tan(beta/2) = 1: s = c log(1/tan(0.0005)).
    way = -0.1 * math.log(math.tan(0.0005))
    assert casters.swing((1e-3, 0.0), -0.5, 0.0, [way / 0.5])[0][0, 0] == pytest.approx(math.pi / 2, abs=1e-8)


@pytest.mark.parametrize("scene", [CarAndTrailer(), Cart()], ids=["car", "cart"])
def test_the_second_wheel_of_an_axle_changes_nothing_but_the_count_of_rows(scene):
    both, t = replace(scene, redundant=True), np.linspace(0, scene.duration, 9)
    one, two = scene.mechanism(), both.mechanism()
    assert two.row_count > one.row_count
    assert np.linalg.matrix_rank(two.rows(two.pose)) == np.linalg.matrix_rank(one.rows(one.pose)) == one.row_count
    assert np.abs(scene.motion(t).pose - both.motion(t).pose).max() == 0
    # Only the sum of the two wheels' forces is known; the smallest solution halves it.
    left = [index for index, name in enumerate(two.row_names) if "left wheel across" in name]
    right = [index for index, name in enumerate(two.row_names) if "right wheel across" in name]
    assert len(left) == len(right) == two.row_count - one.row_count
    reaction = both.motion(t).reaction
    assert np.abs(reaction[:, left] - reaction[:, right]).max() < 1e-12


def test_a_cart_stands_on_its_wheels_where_its_drawing_says():
    """Written down by hand, in metres from each body's centre of mass: the truth takes its places from `Casters`."""
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
@pytest.mark.parametrize("times", [[0.0], [0.0, 1e-3]])
def test_a_trailer_that_is_folded_at_the_start_is_told_by_its_number(bends, which, times):
    found = CarWithTrailers(1.0, (0.9, 1.1), (0.2, 0.0)).drive(1.0, 0.0, (0.0, 0.0, 0.0), bends, times)
    assert (found.jackknifed_at, found.jackknifed) == (None if which is None else 0.0, which)


@pytest.mark.parametrize("bend", [-0.3, 0.3])
def test_the_second_trailer_that_folds_to_either_side_is_told_by_its_number(bend):
    car = CarWithTrailers(1.0, (0.9, 1.1), (0.0, 0.0))
    found = car.drive(-1.0, 0.0, (0.0, 0.0, 0.0), (0.0, bend), [4.0], limit=1.0)
    assert found.jackknifed == 2
    # Straight behind the car, the first trailer's axle pushes the second as a tow.
    at = present(found.jackknifed_at)
    assert Tow(1.1, 0.3).relative_angle(-at) == pytest.approx(1.0, abs=1e-11)


def test_a_joint_that_passes_the_limit_for_a_moment_is_dated():
    car = CarWithTrailers(1.0, (1.0,), (0.0,))

    def drive(limit):
        return car.drive(1.0, lambda t: 0.9 * np.sin(3 * t), (0.0, 0.0, 0.0), (0.0,), [6.0], limit)

    t = np.linspace(0, 6, 6001)
    largest = np.abs(car.drive(1.0, lambda t: 0.9 * np.sin(3 * t), (0.0, 0.0, 0.0), (0.0,), t).bends).max()
    assert drive(largest + 1e-5).jackknifed_at is None
    assert drive(largest - 1e-9).jackknifed == 1


def test_a_vehicle_at_rest_stays():
    for scene in (CarAndTrailer(speed=0.0), Cart(speed=0.0, turning_rate=0.0)):
        motion = scene.motion([0.0, 3.0])
        assert np.abs(np.diff(motion.pose, axis=0)).max() == 0
        assert np.abs(motion.reaction).max() == 0
