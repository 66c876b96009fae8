"""Comparison of Gauss collocation with closed forms, with more stages and with the explicit method of order 8."""

from __future__ import annotations

import numpy as np
import pytest

from reference.numerics import gauss_collocation as gauss
from reference.numerics.integration import IntegrationFailed

EXTENDED = np.finfo(np.longdouble).eps < 1e-18
FAST = np.longdouble(700)


def oscillations(t: np.ndarray) -> np.ndarray:
    """Two angles and their rates (times, 4). The first angle is a slow oscillation, the second the sum of a slow and a
    fast one.
    """
    t = t.astype(np.longdouble)
    slow, fast = np.cos(t), np.sin(FAST * t) / FAST
    return np.stack([slow, slow + fast, -np.sin(t), -np.sin(t) + np.cos(FAST * t)], axis=-1)


def pull(angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Angular accelerations in the motion of `oscillations`."""
    slow = angle[..., 0]
    return np.stack([-slow, -slow - FAST**2 * (angle[..., 1] - slow)], axis=-1)


@pytest.mark.skipif(not EXTENDED, reason="numpy.longdouble is the ordinary double here: windows are short then")
def test_collocation_of_a_fast_and_a_slow_oscillation_is_accurate_at_all_times():
    t = np.sort(np.random.default_rng(1).uniform(0, 2, 300))
    found = gauss.integrate(pull, [1.0, 1.0], [0.0, 1.0], 2.0, 1.0)
    # The error is a rounding of the time (2e-16 s) times the rate of the fast oscillation (1 rad/s).
    assert np.abs(found(t) - oscillations(t))[:, :2].max() < 1e-15
    assert np.abs(found(t) - oscillations(t))[:, 2:].max() < 1e-15 * 700
    # A window is about a third of a period, for which the explicit method needs twenty steps.
    assert len(found.times) < 2 * 700


def circle(state: np.ndarray) -> np.ndarray:
    return np.stack([state[..., 1], -state[..., 0]], axis=-1)


@pytest.mark.parametrize("few", [gauss.FEW_WINDOWS, 2], ids=["windows", "steps"])
def test_motions_with_rates_in_doubles_are_accurate_by_collocation_and_by_the_explicit_method(monkeypatch, few):
    monkeypatch.setattr(gauss, "FEW_WINDOWS", few)
    t = np.linspace(0, 30, 50)
    found = gauss.motion(circle, [0.0, 1.0], 30.0, np.ones(2))(t)
    # The explicit method has an error of 3e-14 per step in about fifty steps. Collocation has only rounding errors.
    allowed = 2e-12 if few == 2 else 5e-14
    assert np.abs(found - np.stack([np.sin(t), np.cos(t)], axis=-1)).max() < allowed


def test_the_error_bound_of_a_motion_with_few_windows_is_above_its_true_error():
    t = np.linspace(1, 30, 30)
    rates = lambda state: np.stack([state[..., 1], -np.sin(state[..., 0])], axis=-1)  # noqa: E731
    found = gauss.motion(rates, [3.0, 0.5], 30.0, np.ones(2))(t)
    # A whirling pendulum, integrated with 32 stages and a smaller tolerance.
    exact = gauss.integrate(
        lambda angle, rate: -np.sin(angle), [3.0], [0.5], 30.0, 1.0, 32, 3e-18 if EXTENDED else 3e-15
    )
    stated = gauss.error_of(rates, [3.0, 0.5], t, np.ones(2))
    assert np.all(stated > np.abs(found - exact(t)).max(axis=-1))
    # The bound is the difference from a coarser rule, so it is larger than rounding errors.
    assert stated.max() > 1.5 * gauss.COARSER * np.finfo(float).eps * np.abs(found).max()
    assert stated.max() < 1e-10


def test_integration_through_a_singularity_raises_integration_failed():
    with pytest.raises(IntegrationFailed, match="the motion stops at t = 1 s"), np.errstate(all="ignore"):
        gauss.integrate(lambda angle, rate: rate**2, [0.0], [1.0], 2.0, 1.0)  # 1 / (1 - t)
    with pytest.raises(ValueError, match="times must lie in"):
        gauss.integrate(pull, [1.0, 1.0], [0.0, 1.0], 0.01, 1.0)([0.02])
