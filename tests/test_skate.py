"""The skate: its row, its kinematics under given rates, parking, the sleigh and the pinned body, each checked twice."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from reference.chapter.parking import Move, commutator, commutator_displacement, park, sidestep, stops, trace
from reference.checks import InvalidMechanism
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.pinned_body import SkatePath, pin_constants, pin_rows, pinned_pose, skate_row

# ---------------------------------------------------------------------------------------------------------- rows


def test_the_joint_has_the_row_of_18_64_and_leaves_three_configurations_and_two_velocities():
    for angle in (0.0, 0.7, -2.0):
        body = Body("sledge", 2.0, 0.3, (0.4, 0.1, angle))
        mechanism = Mechanism((body,), (Skate("skate", None, "sledge", (-0.5, 0.3)),))
        assert np.abs(mechanism.rows(mechanism.pose) - skate_row(angle, (-0.5, 0.3))).max() < 1e-15
        assert mechanism.degrees_of_freedom() == (3, 2)
        assert np.isnan(mechanism.gap(mechanism.pose, 0.0)).all()


def test_a_blade_at_an_angle_and_on_another_body_stops_the_relative_velocity_across_it():
    rng = np.random.default_rng(5)
    poses, twists = rng.normal(size=(2, 2, 3))
    point, angle = (0.3, -0.4), 0.9
    bodies = tuple(Body(name, 1.0, 1.0, tuple(pose.tolist())) for name, pose in zip("ab", poses, strict=True))
    mechanism = Mechanism(bodies, (Skate("blade", "a", "b", point, angle),))
    turn = np.array([[math.cos(poses[1, 2]), -math.sin(poses[1, 2])], [math.sin(poses[1, 2]), math.cos(poses[1, 2])]])
    place = poses[1, :2] + turn @ point

    def at(body):
        arm = place - poses[body, :2]
        return twists[body, :2] + twists[body, 2] * np.array([-arm[1], arm[0]])

    left = np.array([-math.sin(poses[1, 2] + angle), math.cos(poses[1, 2] + angle)])
    assert mechanism.slip(poses, twists)[0] == pytest.approx((at(1) - at(0)) @ left, abs=1e-14)


def test_a_start_that_slides_sideways_is_refused():
    body = Body("sledge", 1.0, 1.0, (0.0, 0.0, 0.0), (1.0, 0.1, 0.0))
    with pytest.raises(InvalidMechanism, match="moving apart"):
        Mechanism((body,), (Skate("skate", None, "sledge", (0.0, 0.0)),))
    with pytest.raises(InvalidMechanism, match="finite"):
        Skate("skate", None, "sledge", (math.nan, 0.0))


def test_the_pins_constants_integrate_its_rows():
    point, angles = (0.4, -0.7), np.linspace(-3, 3, 13)
    pose = pinned_pose(angles, (1.5, -2.0), point)
    assert np.abs(pin_constants(pose, point) - [1.5, -2.0]).max() < 1e-15
    slope = np.stack(
        [pinned_pose(a + 1e-6, (1.5, -2.0), point) - pinned_pose(a - 1e-6, (1.5, -2.0), point) for a in angles]
    )
    # The rows hold on the tangent of the integrated pose, to the central difference's own 1e-12 / 1e-6.
    assert np.abs(pin_rows(angles, point) @ (slope / 2e-6)[..., None]).max() < 1e-9


# ---------------------------------------------------------------------------------------------------------- kinematics


def waving(t):
    return 0.5 + np.sin(1.7 * t)


def steering(t):
    return 1.3 * np.cos(0.8 * t) - 0.2


def test_a_path_with_given_rates_agrees_with_an_integration_and_with_mpmath():
    path = SkatePath(waving, steering, (0.2, -0.3, 0.4))
    t = np.array([6.0, 0.0, 2.5])
    got = path.pose(t)

    def heading(s):
        return 0.4 + 1.3 * mpmath.sin(0.8 * s) / 0.8 - 0.2 * s

    for row, time in zip(got, t, strict=True):
        parts = np.linspace(0, time, 9).tolist()
        moved = mpmath.quad(lambda s: (0.5 + mpmath.sin(1.7 * s)) * mpmath.expj(heading(s)), parts) if time else 0
        expected = [0.2 + mpmath.re(moved), -0.3 + mpmath.im(moved), heading(time)]
        assert np.abs(row - np.array(expected, dtype=float)).max() < 1e-13


def test_two_constants_give_an_arc_that_the_quadrature_repeats():
    for speed, turning in ((1.3, 0.7), (-2.0, 1e-9), (1.0, 0.0), (0.0, 3.0)):
        t = np.linspace(0, 20, 11)
        arc = SkatePath(speed, turning, (0.1, 0.2, 0.3)).pose(t)
        again = SkatePath(lambda t, v=speed: v + 0 * t, lambda t, w=turning: w + 0 * t, (0.1, 0.2, 0.3)).pose(t)
        assert np.abs(arc - again).max() < 1e-13


def test_jumps_and_kinks_in_the_given_rates_are_integrated():
    path = SkatePath(lambda t: np.where(t < math.pi / 3, 1.0, -0.5), lambda t: 0 * t)
    # One jump, boxed in by halving down to rounding.
    assert path.pose([4.0])[0, 0] == pytest.approx(math.pi / 3 - 0.5 * (4 - math.pi / 3), abs=1e-12)


def test_velocity_and_acceleration_are_derivatives_of_the_position():
    path, point = SkatePath(waving, steering), (0.3, -0.4)
    t = np.linspace(0.5, 5, 10)

    def place(t):
        x, y, angle = path.pose(t).T
        return np.stack(
            [x + 0.3 * np.cos(angle) + 0.4 * np.sin(angle), y + 0.3 * np.sin(angle) - 0.4 * np.cos(angle)], 1
        )

    step = 1e-3  # central differences of order 6: h^6 = 1e-18 and rounding 1e-16/h
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60 / step
    shifts = np.array([-3, -2, -1, 1, 2, 3]) * step

    def slope(f):
        return sum(w * f(t + s) for w, s in zip(weights, shifts, strict=True))

    assert np.abs(slope(place) - path.velocity(t, point)).max() < 1e-11
    assert np.abs(slope(lambda t: path.velocity(t, point)) - path.acceleration(t, point)).max() < 1e-11
    # Wrong models that this must catch: erratum 11 as printed, v_C d(j')/dt, and the usual factor 2.
    angle = path.pose(t)[:, 2]
    along, left = np.stack([np.cos(angle), np.sin(angle)], 1), np.stack([-np.sin(angle), np.cos(angle)], 1)
    term = (waving(t) * steering(t))[:, None]
    printed = path.acceleration(t, point) - term * left - term * along
    doubled = path.acceleration(t, point) + term * left
    for wrong in (printed, doubled):
        assert np.abs(slope(lambda t: path.velocity(t, point)) - wrong).max() > 0.5


def test_a_path_whose_derivative_is_not_known_exactly_says_so():
    with pytest.raises(InvalidMechanism, match="not an analytic function"):
        SkatePath(lambda t: np.abs(t) ** 2, 1.0).acceleration([1.0])
    with pytest.raises(InvalidMechanism, match="none below zero"):
        SkatePath(1.0, 1.0).pose([-1.0])
    with pytest.raises(InvalidMechanism, match="not finite at"):
        SkatePath(lambda t: 0 * t + np.nan, 1.0).pose([1.0])
    with pytest.raises(InvalidMechanism, match="turning_rate"):
        SkatePath(1.0, math.inf)


# ---------------------------------------------------------------------------------------------------------- parking


def test_any_pose_is_reached_from_any_other_by_turn_slide_turn():
    rng = np.random.default_rng(7)
    for start, goal in zip(rng.uniform(-9, 9, (50, 3)), rng.uniform(-9, 9, (50, 3)), strict=True):
        for backwards in (True, False):
            moves = park(tuple(start), tuple(goal), backwards)
            assert np.abs(stops(tuple(start), moves)[-1] - goal).max() < 1e-13
            assert abs(moves[0].turn) <= (math.pi / 2 if backwards else math.pi)
    assert park((1.0, 2.0, 0.0), (1.0, 2.0, 3.0)) == (Move(), Move(turn=3.0))


def test_no_part_of_a_manoeuvre_skids():
    path = trace((0.0, 0.0, 0.3), (*park((0.0, 0.0, 0.3), (1.0, 2.0, -1.0)), *sidestep(1.0, 0.7, 0.5)))
    moved, middle = np.diff(path, axis=0), 0.5 * (path[1:, 2] + path[:-1, 2])
    assert np.abs(-np.sin(middle) * moved[:, 0] + np.cos(middle) * moved[:, 1]).max() < 1e-14


def test_the_commutator_moves_sideways_by_the_product_of_its_moves_as_they_shrink():
    assert (
        np.abs(stops((0.0, 0.0, 0.0), commutator(0.6, 0.5))[-1] - [*commutator_displacement(0.6, 0.5), 0.0]).max()
        < 1e-15
    )
    turn = np.array([1e-1, 1e-2, 1e-3])
    rest = commutator_displacement(turn, turn) / turn[:, None] ** 2 - [0.0, 1.0]
    assert np.abs(rest[:, 0] / turn + 1 / 2).max() < 1e-3  # -turn/2 + turn^3/24
    assert np.abs(rest[:, 1] / turn**2 + 1 / 6).max() < 1e-4  # -turn^2/6 + turn^4/120


def test_a_sidestep_is_exactly_sideways_within_its_room():
    for distance in (2.3, -0.01, 1e-6):
        moves = sidestep(distance, 0.5, 0.4)
        assert np.abs(stops((0.0, 0.0, 0.0), moves)[-1] - [0.0, distance, 0.0]).max() < 1e-14
        assert np.abs(trace((0.0, 0.0, 0.0), moves)[:, 2]).max() <= 0.4 + 1e-12
    assert sidestep(0.0, 1.0, 1.0) == ()
    with pytest.raises(InvalidMechanism, match="room"):
        sidestep(1.0, 0.0, 1.0)
