"""The skate: its row and parking; the sleigh and the pinned body, closed forms against multipliers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.chapter.parking import Move, commutator, commutator_displacement, park, sidestep, stops, trace
from reference.checks import InvalidMechanism
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.pinned_body import FreelyPinnedBody, PinnedBody
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.trajectory import energy, joint_gap, slip
from tests.reference.multipliers import TIGHT, multipliers


def test_the_joint_has_the_row_of_18_64_and_leaves_three_configurations_and_two_velocities():
    for angle in (0.0, 0.7, -2.0):
        body = Body("sledge", 2.0, 0.3, (0.4, 0.1, angle))
        mechanism = Mechanism((body,), (Skate("skate", None, "sledge", (-0.5, 0.3)),))
        printed = [-math.sin(angle), math.cos(angle), -0.5]  # the coordinate y' of C drops out
        assert np.abs(mechanism.rows(mechanism.pose)[0] - printed).max() < 1e-15
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


SLEIGHS = [
    ChaplyginSleigh(),
    ChaplyginSleigh(offset=-0.5),
    ChaplyginSleigh(speed=-1.0, turning_rate=-2.0),
    ChaplyginSleigh(speed=0.0),
    ChaplyginSleigh(speed=0.0, turning_rate=-3.0, offset=-0.2),
    ChaplyginSleigh(turning_rate=0.0),
    ChaplyginSleigh(offset=0.0),
    ChaplyginSleigh(offset=1e-9),
    ChaplyginSleigh(offset=30.0, inertia=1e-3),
    ChaplyginSleigh(start=(1.0, -2.0, 5.0)),
    SleighBackwards(duration=5.0),
]


@pytest.mark.parametrize("sleigh", SLEIGHS, ids=lambda s: f"{s.offset:g} {s.speed:g} {s.turning_rate:g}")
def test_the_sleigh_agrees_with_multipliers_and_keeps_its_constants(sleigh):
    t = np.linspace(0, sleigh.duration, 31)
    motion, mechanism = sleigh.motion(t), sleigh.mechanism()
    # An error of a constant of motion, 1e-13 in the integration, grows with the unstable sleigh's exp(1.25 * 5).
    assert np.abs(multipliers(mechanism, sleigh.duration) - motion.pose[-1]).max() < 1e-11
    assert np.abs(slip(mechanism, motion)).max() < 1e-14 * (1 + abs(sleigh.offset * sleigh.turning_rate))
    assert np.isnan(joint_gap(mechanism, motion)).all()
    assert np.abs(energy(mechanism, motion) / sleigh.energy - 1).max() < 1e-14
    # The second constant of motion, free of time: asin(u/V) - (a/k) |theta - theta(0)|, in a form without asin's loss.
    (speed, turning), top = sleigh.rates(t), sleigh._top_speed
    gone = sleigh.offset / sleigh._arm * np.abs(sleigh.heading(t) - sleigh.start[2])
    first = sleigh._arm * abs(sleigh.turning_rate)
    assert np.abs(speed - sleigh.speed * np.cos(gone) - first * np.sin(gone)).max() < 1e-13 * (1 + top)
    assert np.abs(sleigh._arm * np.abs(turning) - first * np.cos(gone) + sleigh.speed * np.sin(gone)).max() < 1e-13 * (
        1 + top
    )


@pytest.mark.parametrize("sleigh", SLEIGHS[:6], ids=lambda s: f"{s.offset:g} {s.speed:g} {s.turning_rate:g}")
def test_the_lateral_force_is_what_newtons_law_needs(sleigh):
    t, step = np.linspace(0.1, 2, 8), 1e-3
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60 / step
    shifts = np.array([-3, -2, -1, 1, 2, 3]) * step
    motion = sleigh.motion(t)
    acceleration = sum(w * sleigh.motion(t + s).twist for w, s in zip(weights, shifts, strict=True))
    needed = sleigh.mechanism().reaction(motion.pose, acceleration)
    assert np.abs(needed - motion.reaction).max() < 1e-10  # order 6: (w h)^6 and eps/h


def test_the_sleigh_agrees_with_mpmath_to_rounding():
    rng = np.random.default_rng(11)
    for _ in range(4):
        mass, inertia, offset, speed, turning = rng.uniform([0.5, 0.1, -1, -2, -3], [3, 1, 1, 2, 3])
        sleigh = ChaplyginSleigh(mass, inertia, offset, speed, turning)
        with mpmath.workdps(30):
            a, square = mpmath.mpf(offset), mpmath.mpf(inertia) / mpmath.mpf(mass) + mpmath.mpf(offset) ** 2
            arm, top = mpmath.sqrt(square), mpmath.sqrt(mpmath.mpf(speed) ** 2 + square * mpmath.mpf(turning) ** 2)
            first = mpmath.asinh(mpmath.mpf(speed) / (arm * abs(mpmath.mpf(turning))))

            sign = math.copysign(1, turning)

            def phase(t, a=a, square=square, top=top, first=first):
                return first + a * top * t / square

            def heading(t, a=a, arm=arm, first=first, phase=phase, sign=sign):
                return sign * arm / a * (mpmath.atan(mpmath.sinh(phase(t))) - mpmath.atan(mpmath.sinh(first)))

            moved = mpmath.quad(
                lambda t, top=top, phase=phase, heading=heading: top * mpmath.tanh(phase(t)) * mpmath.expj(heading(t)),
                mpmath.linspace(0, 3, 13),
            )
            expected = np.array([mpmath.re(moved), mpmath.im(moved), heading(mpmath.mpf(3))], dtype=float)
        assert np.abs(sleigh.skate_pose(3.0)[0] - expected).max() < 1e-13


def test_a_long_run_keeps_its_digits():
    sleigh = ChaplyginSleigh(duration=1000.0)
    motion = sleigh.motion([999.0, 1000.0])
    # By then it slides straight at V; the distance is 1000 V, whose rounding is 3e-13.
    assert np.hypot(*np.diff(motion.pose[:, 0, :2], axis=0)[0]) == pytest.approx(sleigh._top_speed, abs=2e-12)


def test_a_stiff_sleigh_settles_and_is_then_followed_for_ever():
    for sleigh in (ChaplyginSleigh(speed=1e5, duration=1e3), ChaplyginSleigh(offset=-1e-3, inertia=1e-9, duration=1e3)):
        long = sleigh.skate_pose([1e-2 + sleigh._settled, 1000.0])
        gone, settled = long[1] - long[0], long[1, 2]
        top = math.copysign(sleigh._top_speed * (1000 - 1e-2 - sleigh._settled), sleigh.offset)
        assert np.abs(gone[:2] - top * np.array([math.cos(settled), math.sin(settled)])).max() < 1e-14 * abs(top)
    # Before it settles the quadrature alone has the motion: the two halves agree.
    sleigh = ChaplyginSleigh()
    later = sleigh._settled + 1.0
    assert abs(sleigh._moved(later) - sleigh.skate_pose(later)[0] @ [1, 1j, 0]) < 1e-13


def test_backwards_a_small_turning_grows_at_the_linear_rate_and_the_sleigh_turns_round():
    sleigh = SleighBackwards(turning_rate=1e-9)
    turning = sleigh.rates([1.0, 2.0])[1]
    assert math.log(turning[1] / turning[0]) == pytest.approx(sleigh.growth_rate(), rel=1e-14)
    assert ChaplyginSleigh().growth_rate() < 0
    speed = SleighBackwards().rates([0.0, 20.0])[0]
    assert speed[0] == pytest.approx(-1.0, abs=1e-6)
    assert speed[1] == pytest.approx(1.0, abs=1e-6)
    # Two turns of the heading's limit: pi k/|a| for a full reversal from a straight run.
    assert SleighBackwards().heading(200.0) == pytest.approx(math.pi * math.sqrt(0.4) / 0.5, rel=1e-3)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda u, w, a, square: (-a * w * w, a * u * w / square),  # the offset's sign
        lambda u, w, a, square: (2 * a * w * w, -2 * a * u * w / square),  # a factor 2, as in Coriolis' term
        lambda u, w, a, square: (a * w * w, -a * u * w / (square - a * a)),  # inertia about the centre of mass
    ],
    ids=["sign of the offset", "factor 2", "inertia about the centre"],
)
def test_wrong_sleighs_are_caught(wrong):
    sleigh = ChaplyginSleigh()

    def rate(_, state):
        angle, u, w = state[2:]
        return [u * math.cos(angle), u * math.sin(angle), w, *wrong(u, w, sleigh.offset, sleigh._arm**2)]

    end = solve_ivp(rate, (0, 3), [0, 0, 0, 1, 2], **TIGHT).y[:3, -1]
    assert np.abs(end - sleigh.skate_pose(3.0)[0]).max() > 0.1


def test_bad_sleighs_are_refused_and_a_point_mass_goes_straight():
    with pytest.raises(InvalidMechanism, match="nothing resists turning"):
        ChaplyginSleigh(inertia=0.0, offset=0.0)
    bad: dict[str, Any]
    for bad in (
        {"mass": 0.0},
        {"inertia": -1.0},
        {"speed": math.nan},
        {"offset": math.inf},
        {"start": (0, 0, math.nan)},
    ):
        with pytest.raises(InvalidMechanism):
            ChaplyginSleigh(**bad)
    for times in ([-0.1], [math.nan], [[1.0]]):
        with pytest.raises(InvalidMechanism):
            ChaplyginSleigh().motion(times)
    point = ChaplyginSleigh(inertia=0.0)
    motion = point.motion([0.0, 1.0, 2.0])
    assert np.abs(motion.twist[:, 0, :2] - motion.twist[0, 0, :2]).max() < 1e-14
    assert np.abs(motion.reaction).max() == 0
    with pytest.raises(InvalidMechanism, match="inertia"):
        point.mechanism()


@pytest.mark.parametrize(
    "body",
    [
        PinnedBody(),
        PinnedBody(turning_rate=12.0),
        PinnedBody(turning_rate=-12.0, angle=7.0),
        PinnedBody(point=(0.2, -0.3), pin=(1.0, 2.0), gravity=(3.0, 4.0), angle=-2.0),
        PinnedBody(point=(0.0, 0.0)),
        FreelyPinnedBody(),
        PinnedBody(angle=-math.pi / 2, turning_rate=0.0),
    ],
    ids=["swings", "whirls", "whirls back", "askew", "at its centre", "free", "hangs"],
)
def test_the_pinned_body_agrees_with_multipliers_and_keeps_its_constants(body):
    t = np.linspace(0, body.duration, 31)
    motion, mechanism = body.motion(t), body.mechanism()
    assert mechanism.degrees_of_freedom() == (1, 1)
    # Without projection the integration's gap grows as its tolerance, 1e-13 per step, times t^2.
    assert np.abs(multipliers(mechanism, body.duration) - motion.pose[-1]).max() < 1e-10
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-14
    assert np.abs(slip(mechanism, motion)).max() < 1e-13
    total = energy(mechanism, motion)
    assert np.ptp(total) < 1e-13 * (1 + np.abs(total).max())


def test_the_pins_reaction_is_what_newtons_law_needs():
    body, t, step = PinnedBody(), np.linspace(0.1, 2, 8), 1e-3
    weights = np.array([-1, 9, -45, 45, -9, 1]) / 60 / step
    shifts = np.array([-3, -2, -1, 1, 2, 3]) * step
    motion = body.motion(t)
    acceleration = np.sum([w * body.motion(t + s).twist for w, s in zip(weights, shifts, strict=True)], axis=0)
    needed = body.mechanism().reaction(motion.pose, acceleration)
    assert np.abs(needed - motion.reaction).max() < 1e-8  # order 6: 10^6 (w h)^6 and eps/h, times 20 N
    wrong = replace(body, inertia=body.inertia * 1.001).motion(t).reaction
    assert np.abs(needed - wrong).max() > 1e-5


def test_bad_pinned_bodies_are_refused():
    bad: dict[str, Any]
    for bad in ({"mass": 0.0}, {"inertia": 0.0}, {"point": (math.nan, 0.0)}, {"gravity": (0.0, math.inf)}):
        with pytest.raises(InvalidMechanism):
            PinnedBody(**bad)
    with pytest.raises(InvalidMechanism, match="none below zero"):
        PinnedBody().motion([-1.0])
