"""One link is exact next to the separatrix, over 845 periods, and in its passages.

Its motion in fifty digits is asked by `laws`, its forces by `test_scenes`.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from reference.numerics.elliptic import incomplete, jacobi, quarter_period
from reference.scenes.pendulum.link import Pendulum, PointPendulum

FREQUENCY = 3.0


@pytest.mark.parametrize("complement", [1.0, 0.1, 1e-8, 1e-30])
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


def test_a_passage_at_the_start_and_one_at_the_end_are_counted() -> None:
    # Upright in the middle, where sn is zero exactly: the start is a passage at t = 0, not next to it.
    pendulum = Pendulum(FREQUENCY, 0.0, 1.0)
    times = pendulum.passages(0.0, 10.0)
    assert times[0] == 0
    last = float(times[-1])
    assert list(pendulum.passages(0.0, last)) == list(times)
    assert list(pendulum.passages(0.0, math.nextafter(last, 0))) == list(times[:-1])
    assert len(Pendulum(FREQUENCY, 1.0).passages(1.5, 10.0)) == 0  # out of reach


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


@pytest.mark.parametrize("pendulum", [Pendulum(3.0, 1.0, 0.2), Pendulum(3.0, -2.5, -1.0), Pendulum(2.0, 3.0, 5.0)])
def test_passages_are_all_those_that_looking_finds_up_to_the_last(pendulum):
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
