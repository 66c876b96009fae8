"""A skate with its centre of mass off the blade, free and pinned: closed forms against multipliers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.checks import InvalidMechanism
from reference.scenes.skates.pinned_body import FreelyPinnedBody, PinnedBody, pin_constants
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.trajectory import energy, joint_gap, slip
from tests.multipliers import TIGHT, multipliers

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


def test_the_total_heading_change_is_the_headings_limit():
    for sleigh in (*SLEIGHS[:5], SleighBackwards()):
        assert sleigh.heading(200.0) - sleigh.start[2] == pytest.approx(sleigh.total_heading_change(), abs=1e-13)
    assert ChaplyginSleigh(offset=0.0).total_heading_change() == math.inf
    assert ChaplyginSleigh(turning_rate=0.0).total_heading_change() == 0.0


def test_a_long_run_keeps_its_digits():
    sleigh = ChaplyginSleigh(duration=1000.0)
    motion = sleigh.motion([999.0, 1000.0])
    # By then it slides straight at V; the distance is 1000 V, whose rounding is 3e-13.
    assert np.hypot(*np.diff(motion.pose[:, 0, :2], axis=0)[0]) == pytest.approx(sleigh._top_speed, abs=2e-12)


def test_a_stiff_sleigh_settles_and_is_then_followed_for_ever():
    for sleigh in (ChaplyginSleigh(speed=1e5, duration=1e3), ChaplyginSleigh(offset=-1e-3, inertia=1e-9, duration=1e3)):
        long, settled = sleigh.skate_pose([1e-2 + sleigh._settled, 1000.0]), sleigh.total_heading_change()
        gone = long[1] - long[0]
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
    assert SleighBackwards().total_heading_change() == pytest.approx(math.pi * math.sqrt(0.4) / 0.5, rel=1e-3)


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
    assert np.abs(pin_constants(motion.pose[:, 0], body.point) - body.pin).max() < 1e-14
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
