"""One link is exact: against arbitrary precision, against energy and Newton, next to the separatrix, over 845
periods.
"""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.numerics.elliptic import incomplete, jacobi, quarter_period
from reference.scenes.pendulum.link import BarPendulum, Pendulum, PointPendulum
from reference.trajectory import energy, joint_gap, slip

FREQUENCY = 3.0
STARTS = [  # angle, rate: swinging, whirling both ways, at the top, on the separatrix, several turns away
    (2.0, 0.0),
    (0.3, 1.0),
    (0.3, -8.0),
    (-2.0, 7.0),
    (5.0, 3.0),
    (3.1, -1e-5),
    (math.pi, 1e-3),
    (0.0, 6.0),
    (0.0, -6.0),
    (9.0, -20.0),
    (0.0, 0.0),
]


def integrated(
    frequency: float, angle: float, rate: float, t: float, steps: int = 64, order: int = 32
) -> tuple[float, float]:
    """The second opinion: Taylor series of the angle, its sine and cosine, at 25 digits; it knows no elliptic function.

    Twice the steps or a higher order change no digit of a double.
    """
    with mpmath.workdps(25):
        square, step = mpmath.mpf(frequency) ** 2, mpmath.mpf(t) / steps
        place: Any = mpmath.mpf(angle)
        speed: Any = mpmath.mpf(rate)
        for _ in range(steps):
            series, sine, cosine = [place, speed], [mpmath.sin(place)], [mpmath.cos(place)]
            for k in range(1, order):
                # Derivatives of sin(angle) and cos(angle), and angle'' = -f^2 sin(angle), coefficient by coefficient.
                turning = [j * series[j] / k for j in range(1, k + 1)]
                sine.append(mpmath.fdot(turning, cosine[::-1]))
                cosine.append(-mpmath.fdot(turning, sine[-2::-1]))
                series.append(-square * sine[k - 1] / (k * (k + 1)))
            powers = [step**j for j in range(order + 1)]
            place = mpmath.fdot(series, powers)
            speed = mpmath.fdot([j * series[j] for j in range(1, order + 1)], powers)
        return float(place), float(speed)


@pytest.mark.parametrize(("angle", "rate"), STARTS)
def test_the_angle_is_that_of_an_integration_at_25_digits(angle: float, rate: float) -> None:
    t = 1.1
    expected, expected_rate = integrated(FREQUENCY, angle, rate, t)
    found, found_rate, _ = Pendulum(FREQUENCY, angle, rate).motion(t)
    # f t = 3 radians of phase and angles to 40 rad, each rounded at 1e-16; the start is not close to the separatrix, or
    # has no rounding there.
    assert abs(found - expected) < 2e-14
    assert abs(found_rate - expected_rate) < 2e-13


def test_a_frequency_wrong_by_a_thousandth_is_caught() -> None:
    expected, _ = integrated(FREQUENCY, 2.0, 0.0, 1.1)
    found, _, _ = Pendulum(FREQUENCY * 1.001, 2.0, 0.0).motion(1.1)
    assert abs(found - expected) > 1e-3


@pytest.mark.parametrize("complement", [1.0, 0.5, 0.1, 1e-3, 1e-8, 1e-16, 1e-30])
def test_jacobi_functions_keep_their_digits_down_to_the_separatrix(complement: float) -> None:
    with mpmath.workdps(60):
        parameter = 1 - mpmath.mpf(complement)
        quarter = quarter_period(complement)
        exact = mpmath.pi / 2 / mpmath.agm(1, mpmath.sqrt(mpmath.mpf(complement)))
        assert abs(quarter / exact - 1) < 5e-16
        for argument in np.linspace(-3.3 * quarter, 3.3 * quarter, 23):
            sn, cn, dn, amplitude = (float(value) for value in jacobi(argument, complement))
            exact_sn, exact_cn, exact_dn = (
                mpmath.ellipfun(f, mpmath.mpf(argument), m=parameter) for f in ("sn", "cn", "dn")
            )  # The argument's own rounding is up to 230 * 1e-16 and the functions' slopes are at most 1.
            tolerance = 8e-16 * (1 + abs(argument))
            assert abs(sn - exact_sn) < tolerance
            assert abs(cn - exact_cn) < tolerance
            assert abs(dn / exact_dn - 1) < tolerance
            assert abs(math.sin(amplitude) - exact_sn) < tolerance


def test_the_incomplete_integral_keeps_its_digits_beside_the_quarter_period() -> None:
    for complement in (0.5, 1e-8, 1e-30):
        for sine, cosine in ((0.3, 0.7), (1.0, 1e-9), (1.0, -1e-9), (-1.0, -0.2), (1.0, 0.0)):
            with mpmath.workdps(60):
                exact = mpmath.ellipf(mpmath.atan2(mpmath.mpf(sine), mpmath.mpf(cosine)), 1 - mpmath.mpf(complement))
                assert abs(float(incomplete(sine, cosine, complement)) - exact) < 1e-15 * (1 + abs(exact))


@pytest.mark.parametrize("angle", [math.pi, math.pi - 1e-6, 3.0])
def test_a_release_from_rest_near_the_top_keeps_its_digits(angle: float) -> None:
    """Even from float(pi), 1.2e-16 off the top, the fall comes at the right time: period 4 K(k) / f, K by mpmath."""
    with mpmath.workdps(50):
        exact = 4 * mpmath.ellipk(mpmath.sin(mpmath.mpf(angle) / 2) ** 2) / FREQUENCY
        assert abs(Pendulum(FREQUENCY, angle).period / exact - 1) < 1e-15


def test_next_to_the_separatrix_the_error_is_the_rounding_of_the_start() -> None:
    """Moving the rate by one unit in its last place moves the answer as much as the stated loss, and as our error."""
    rate = 2 * FREQUENCY * (1 + 1e-9)
    pendulum = Pendulum(FREQUENCY, 0.0, rate)
    t = pendulum.period  # at the bottom, at full speed, just after passing the top
    moved, _, _ = Pendulum(FREQUENCY, 0.0, math.nextafter(rate, 10)).motion(t)
    found, _, _ = pendulum.motion(t)
    with mpmath.workdps(40):
        k = mpmath.mpf(rate) / (2 * FREQUENCY)
        u = k * FREQUENCY * mpmath.mpf(t)
        quarter = mpmath.ellipk(1 / k**2)
        rest = u - 2 * quarter * mpmath.nint(u / (2 * quarter))
        sn = mpmath.ellipfun("sn", rest, m=1 / k**2)
        exact = float(2 * (mpmath.asin(sn) + mpmath.pi * mpmath.nint(u / (2 * quarter))))
    loss = 1e-16 / abs(pendulum.excess)
    assert abs(found - exact) < 10 * loss
    assert abs(moved - found) > 0.1 * loss


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.0])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_separatrix_itself_is_the_gudermannian(angle: float, direction: int) -> None:
    """angle = 2 gd(f t + c) climbs towards the top and doesn't pass it; near k = 1 exactly, rounding decides the
    side.
    """
    pendulum = Pendulum(FREQUENCY, angle, direction * 2 * FREQUENCY * math.cos(angle / 2))
    start = math.asinh(math.tan(direction * angle / 2))
    t = 1.0
    expected = direction * 2 * math.atan(math.sinh(FREQUENCY * t + start))
    # One rounding in k^2 - 1 grows like exp(f t) = 20 towards the top.
    assert abs(float(pendulum.motion(t)[0]) - expected) < 1e-14


def test_small_swings_have_the_small_period_and_the_kinds_are_named() -> None:
    # K(k) = pi/2 (1 + k^2/4 + ...), k = 5e-4.
    assert Pendulum(2.0, 1e-3).period == pytest.approx(math.pi * (1 + 1e-6 / 16), rel=1e-12)
    assert Pendulum(2.0, 1.0).kind == "swinging"
    assert Pendulum(2.0, 0.0, 4.1).kind == "whirling"
    assert Pendulum(2.0, 0.0, 4.0).kind == "separatrix"
    assert math.isinf(Pendulum(2.0, 0.0, 4.0).period)


@pytest.mark.parametrize(("angle", "rate"), [(2.0, 0.5), (0.3, -8.0), (-1.0, 30.0)])
def test_passages_are_the_times_at_an_angle_and_none_is_missed(angle: float, rate: float) -> None:
    pendulum = Pendulum(FREQUENCY, angle, rate)
    times = pendulum.passages(0.5, 6.0)
    turned = pendulum.motion(times)[0] - 0.5
    assert np.abs(turned - 2 * math.pi * np.round(turned / (2 * math.pi))).max() < 1e-13
    fine = np.sin((pendulum.motion(np.linspace(0, 6.0, 20_001))[0] - 0.5) / 2)
    assert np.count_nonzero(fine[1:] * fine[:-1] < 0) == len(times)


def test_a_passage_at_the_start_and_one_at_the_end_are_counted() -> None:
    # Upright in the middle, where sn is zero exactly: the start is a passage at t = 0, not next to it.
    pendulum = Pendulum(FREQUENCY, 0.0, 1.0)
    times = pendulum.passages(0.0, 10.0)
    assert times[0] == 0
    last = float(times[-1])
    assert list(pendulum.passages(0.0, last)) == list(times)
    assert list(pendulum.passages(0.0, math.nextafter(last, 0))) == list(times[:-1])


def test_an_angle_out_of_reach_has_no_passages() -> None:
    assert len(Pendulum(FREQUENCY, 1.0).passages(1.5, 10.0)) == 0


SCENES = [
    BarPendulum(),
    BarPendulum(angle=1.0, rate=-9.0, length=0.7, mass=3.0),
    PointPendulum(duration=20.0, horizon=20.0),
]


@pytest.mark.parametrize("scene", SCENES)
def test_the_truth_satisfies_the_joint_the_energy_and_newton(scene: BarPendulum) -> None:
    mechanism = scene.mechanism()
    assert mechanism.degrees_of_freedom() == (1, 1)
    motion = scene.motion(np.linspace(0, scene.duration, 301))
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-14
    assert np.abs(slip(mechanism, motion)).max() < 1e-13
    total = energy(mechanism, motion)
    assert np.ptp(total) < 1e-13 * scene.mass * scene.gravity * scene.length
    # The accelerations come from the Mechanism alone, and the pin force with them: M a = f + J^T reaction.
    acceleration = accelerations_of(mechanism, motion.pose, motion.twist)
    expected = mechanism.reaction(motion.pose, acceleration)
    assert np.abs(motion.reaction - expected).max() < 1e-12 * np.abs(expected).max()


def accelerations_of(mechanism: Mechanism, pose: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """From the rows alone: J a = bias with M a = f + J^T reaction."""
    rows = mechanism.rows(pose)
    weighted = rows / mechanism.inertias.reshape(-1)
    free = np.broadcast_to(mechanism.free_fall.reshape(-1), (*pose.shape[:-2], rows.shape[-1]))[..., None]
    right = mechanism.bias(pose, twist)[..., None] - rows @ free
    reaction = np.linalg.solve(weighted @ np.swapaxes(rows, -1, -2), right)
    return (free + np.swapaxes(weighted, -1, -2) @ reaction)[..., 0].reshape(pose.shape)


def test_a_pin_force_of_the_wrong_sign_is_caught() -> None:
    scene = BarPendulum()
    motion = scene.motion([0.3])
    expected = scene.mechanism().reaction(motion.pose, accelerations_of(scene.mechanism(), motion.pose, motion.twist))
    assert np.abs(-motion.reaction - expected).max() > 1


def test_the_benchmark_pendulum_keeps_its_phase_for_845_periods() -> None:
    scene = PointPendulum()
    assert scene.samples == 4000
    with mpmath.workdps(40):
        frequency = mpmath.sqrt(mpmath.mpf(9.81))
        quarter = mpmath.ellipk(mpmath.mpf(1) / 2)
        period = 4 * quarter / frequency
        assert abs(scene.pendulum.period / period - 1) < 5e-16
        assert int(2000 / period) == 844
        times = [0.5, 999.5, 1234.5, 2000.0]
        found = scene.bob(scene.motion(times).pose)
        for t, (x, y) in zip(times, found, strict=True):
            phase = mpmath.fmod(mpmath.mpf(t), period) * frequency + quarter
            sine = mpmath.ellipfun("sn", phase, m=0.5) / mpmath.sqrt(2)
            # 845 periods, each rounded at 2e-16 of 2.4 s, at speeds to 4.4 m/s.
            assert abs(x - 2 * sine * mpmath.sqrt(1 - sine**2)) < 3e-12
            assert abs(y + 1 - 2 * sine**2) < 3e-12


def test_bad_numbers_are_refused() -> None:
    for wrong in ({"length": 0.0}, {"mass": -1.0}, {"gravity": 0.0}, {"angle": math.nan}, {"rate": math.inf}):
        with pytest.raises(InvalidMechanism, match=next(iter(wrong))):
            BarPendulum(**wrong)
    with pytest.raises(InvalidMechanism, match="frequency"):
        Pendulum(0.0, 1.0)


@pytest.mark.parametrize("pendulum", [Pendulum(3.0, 1.0, 0.2), Pendulum(3.0, -2.5, -1.0), Pendulum(2.0, 3.0, 5.0)])
@pytest.mark.parametrize("sign", [1, -1])
def test_passages_are_all_those_that_looking_finds_up_to_the_last(pendulum, sign):
    pendulum = Pendulum(pendulum.frequency, sign * pendulum.angle, sign * pendulum.rate)
    t = np.linspace(0, 12 * pendulum.period, 120_001)
    motion = pendulum.motion(t)[0]
    for angle in (0.5, -0.9, 0.0):
        side = np.sin((motion - angle) / 2)
        seen = t[1:][side[1:] * side[:-1] < 0]
        assert len(seen) > 10
        np.testing.assert_allclose(pendulum.passages(angle, float(t[-1])), seen, atol=2 * t[1])
        for last in (0, 3, len(seen) - 1):  # `until` just after a passage, and just before it
            exact = float(pendulum.passages(angle, float(t[-1]))[last])
            assert len(pendulum.passages(angle, exact * (1 + 1e-12))) == last + 1
            assert len(pendulum.passages(angle, exact * (1 - 1e-12))) == last
