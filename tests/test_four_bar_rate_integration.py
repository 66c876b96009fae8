"""The four-bar's rates, integrated: how far the angles drift, and the order of each method."""

import math

import numpy as np
import pytest

from tests.test_four_bar import CHAPTER


def test_integrated_rates_at_the_common_tolerance_miss_by_two_hundredths_in_one_revolution():
    times = np.linspace(0, np.pi / 5, 401)
    run = CHAPTER.integrate_rates(times)  # RK45, rtol 1e-3, atol 1e-6
    beta, _ = CHAPTER.angles(run.theta)
    assert np.max(np.abs(run.beta - beta)) == pytest.approx(2.4e-2, rel=0.05)
    assert run.stopped == ""


def test_integrated_rates_drift_by_a_radian_in_a_hundred_revolutions():
    times = np.linspace(0, 100 * np.pi / 5, 1001)
    run = CHAPTER.integrate_rates(times)
    beta, _ = CHAPTER.angles(math.pi / 2 + 10 * times)
    error = np.abs(run.beta - beta)
    assert np.nanmax(error) > 0.5
    assert bool(run.stopped) == bool(np.any(np.isnan(run.beta)))
    assert run.evaluations < 100_100


# RK4's steps are longer: with Euler's its error is the rounding of thousands of steps.
@pytest.mark.parametrize(("method", "order", "steps"), [("euler", 1, (200, 400)), ("rk4", 4, (8, 16))])
def test_fixed_steps_have_their_order(method, order, steps):
    times = np.linspace(0, np.pi / 5, 21)
    beta, _ = CHAPTER.angles(math.pi / 2 + 10 * times)
    coarse, fine = (
        np.max(np.abs(CHAPTER.integrate_rates(times, method=method, every=every, limit=10**6).beta - beta))
        for every in steps
    )
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("method", ["RK23", "DOP853", "Radau", "BDF", "LSODA"])
def test_every_adaptive_method_reaches_a_tight_tolerance(method):
    times = np.linspace(0, np.pi / 5, 11)
    run = CHAPTER.integrate_rates(times, method=method, rtol=1e-7, atol=1e-9)
    assert np.max(np.abs(run.beta - CHAPTER.angles(run.theta)[0])) < 1e-4  # global error, some 1000 steps of 1e-7


def test_integration_stops_and_says_so():
    times = np.linspace(0, 10, 11)
    for method in ("euler", "rk4", "RK45"):
        run = CHAPTER.integrate_rates(times, method=method, limit=15)
        assert "stopped at" in run.stopped
        assert np.isnan(run.beta[-1])
    with pytest.raises(ValueError, match="method is 'ode45'"):
        CHAPTER.integrate_rates(times, method="ode45")
    with pytest.raises(ValueError, match="increasing"):
        CHAPTER.integrate_rates([1.0, 0.0])


@pytest.mark.parametrize(("method", "cost"), [("euler", 1), ("rk4", 4)])
def test_a_limit_that_is_a_whole_number_of_steps_is_used_up(method, cost):
    run = CHAPTER.integrate_rates([0.0, 0.01, 0.02], method=method, every=10, limit=20 * cost)
    assert run.stopped == ""
    assert run.evaluations == 20 * cost
    short = CHAPTER.integrate_rates([0.0, 0.01, 0.02], method=method, every=10, limit=20 * cost - 1)
    assert short.evaluations == 19 * cost
    assert "stopped at" in short.stopped
