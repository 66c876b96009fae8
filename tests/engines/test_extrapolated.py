"""Tests of the extrapolation to step zero on toy engines with known error terms."""

from __future__ import annotations

import math
import pickle
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from engines import CLAIM, Run, Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.richardson import combine, expected_error, extrapolation_weights
from reference.forces import TorsionDamper
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory
from tests.mechanisms import pendulum
from tests.present import present
from tests.toys import Plain


@dataclass(frozen=True)
class SeriesToy(Plain):
    """A toy engine with the pose cos t + error. The error is the sum of coefficient * t * dt^power over `terms`.

    The errors of twists and reactions are multiples of the pose error.
    """

    terms: dict[int, float] = field(default_factory=lambda: {2: 1.0, 3: -2.0})
    broken_below: float = 0.0  # Runs with smaller steps [s] are NaN after the first sample.
    resets_below: float = 0.0  # Runs with smaller steps [s] have a reset.
    turned_above: float = math.inf  # Runs with larger steps [s] have an error of 1 rad from t = 2 s on.
    name: str = "toy"
    variant: str = "plain"

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        if len(mechanism.bodies) != 1:
            raise Unsupported("a toy has one body")
        return SeriesRun(self, mechanism, dt)


class SeriesRun:
    def __init__(self, toy: SeriesToy, mechanism: Mechanism, dt: float) -> None:
        self.toy, self.dt, self.rows = toy, dt, mechanism.row_count
        self.size = Size(1, 3, 2, 2)

    def __call__(self, samples: int, every: int) -> Trajectory:
        t = np.arange(samples + 1, dtype=float) * every * self.dt
        error = t * sum(c * self.dt**power for power, c in self.toy.terms.items())
        if self.dt < self.toy.broken_below:
            error[1:] = np.nan
        if self.dt > self.toy.turned_above:
            error[t > 2] += 1
        shape = np.ones((1, 1, 3))
        reset = self.dt < self.toy.resets_below
        return Trajectory(
            t,
            (np.cos(t) + error)[:, None, None] * shape,
            (-np.sin(t) + 2 * error)[:, None, None] * shape,
            (np.exp(-t) - 3 * error)[:, None] * np.ones(self.rows),
            stepping=1e-3 * samples * every,
            warnings=("reset", f"at step {self.dt:.3g}") if reset else (),
            reset_at=self.dt * 100 if reset else None,
        )


def test_a_run_warning_keeps_its_fields_when_pickled():
    moment = pickle.loads(pickle.dumps(RunWarning("upstream: late", "rate limit", "upstream", 0.5)))
    assert (str(moment), moment.kind, moment.origin, moment.time) == ("upstream: late", "rate limit", "upstream", 0.5)
    base = SeriesToy().build(sledge(), 0.1)(3, 1)
    warned = replace(base, warnings=(moment, "Nan in qacc"))
    assert warned.warnings == ("upstream: late", "Nan in qacc")
    assert [found.time for found in warned.warnings_of("rate limit")] == [0.5]
    assert [str(found) for found in warned.warnings_of("other")] == ["Nan in qacc"]


def sledge() -> Mechanism:
    """A bar on a skate. A skate has no gap at any pose of a toy engine."""
    return replace(pendulum(), joints=(Skate("blade", None, "bar", (0.0, 0.0), 0.0),))


def errors(trajectory: Trajectory) -> tuple[float, float, float]:
    t = trajectory.t
    return (
        np.abs(trajectory.pose - np.cos(t)[:, None, None]).max(),
        np.abs(trajectory.twist + np.sin(t)[:, None, None]).max(),
        np.abs(trajectory.reaction - np.exp(-t)[:, None]).max(),
    )


def run(method: Extrapolated, dt: float = 0.1) -> Trajectory:
    return method.build(sledge(), dt)(10, 3)


def test_the_weights_sum_to_one_and_cancel_every_power():
    assert extrapolation_weights((1, 2), (2,)) == pytest.approx([-1 / 3, 4 / 3], abs=1e-15)  # Richardson's
    for levels, powers in (((1, 2), (1,)), ((2, 3, 4, 6, 8), (2, 3, 4, 5)), ((1, 2, 4), (2, 4))):
        weights = extrapolation_weights(levels, powers)
        assert weights.sum() == pytest.approx(1, abs=1e-13)
        for power in powers:
            # The tolerance allows for rounding of terms that are smaller than 100.
            assert weights @ (levels[0] / np.array(levels)) ** power == pytest.approx(0, abs=1e-13)


def test_errors_in_the_removed_powers_vanish():
    inner = SeriesToy().build(sledge(), 0.1)(10, 3)
    assert min(errors(inner)) > 1e-2
    assert max(errors(run(Extrapolated(SeriesToy(), "extended", (1, 2, 3), (2, 3))))) < 1e-13
    exact = run(Extrapolated(SeriesToy(), "extended", (1, 2, 3, 4), (2, 3, 4)))
    assert present(exact.estimate).max() < 1e-12  # The bound is rounding of all steps.
    # With the powers (2, 4) the term 2 t dt^3 causes an error of 2 * 3 * 1e-3 / 60. Other powers cause larger errors.
    for powers in ((2, 4), (1, 3), (3, 4)):
        extrapolated = run(Extrapolated(SeriesToy(), "extended", (1, 2, 3), powers))
        assert min(errors(extrapolated)) > 0.9e-4
        assert present(extrapolated.estimate).max() > 1e-5
    # Error expansions of any size are recognised.
    for size in (1e-6, 1.0, 30.0):
        toy = SeriesToy({2: size, 3: -2 * size, 4: size})
        for levels, powers in (((1, 2), (2,)), ((1, 2, 3, 4), (2, 3, 4))):
            trajectory = run(Extrapolated(toy, "extended", levels, powers))
            assert not any("no series" in warning for warning in trajectory.warnings)


def test_runs_without_error_expansion_give_the_finest_run_and_are_unresolved():
    # All runs except the finest run change to another branch at t = 2 s.
    turned = Extrapolated(SeriesToy(turned_above=0.03), "extended", (1, 2, 3, 4), (2, 3, 4)).build(sledge(), 0.1)(10, 3)
    finest = SeriesToy(turned_above=0.03).build(sledge(), 0.025)(10, 12)
    assert turned.unresolved_at == pytest.approx(2.1)
    assert turned.warnings == (
        "ours: reactions are resolved to 5e+00 of the largest force",
        "ours: unresolved from 2.1 s on, the runs are no series in the step",
    )
    late = turned.t > 2
    for name in ("pose", "twist", "reaction"):
        assert np.array_equal(getattr(turned, name)[late], getattr(finest, name)[late])
        assert not np.array_equal(getattr(turned, name)[~late], getattr(finest, name)[~late])
    assert turned.estimate is not None
    # The estimate is the difference of 1 rad between the finest run and the other runs.
    assert np.all(np.abs(turned.estimate[late] - 1) < 0.1)
    assert turned.estimate[~late].max() < 1e-3


@pytest.mark.parametrize("every", [1, 2, 3, 10])
def test_the_sampling_changes_neither_motion_nor_estimate_nor_warnings(every):
    method = Extrapolated(SeriesToy({2: 1.0, 3: 300.0, 4: 100.0, 5: 5000.0}), "extended", (1, 2, 3, 4), (2, 3, 4))
    dense, sampled = (method.build(sledge(), 0.025)(60 // count, count) for count in (1, every))
    for name in ("t", "pose", "twist", "estimate"):
        assert np.array_equal(present(getattr(sampled, name)), present(getattr(dense, name))[::every])
    assert sampled.unresolved_at == dense.unresolved_at
    assert 0 < present(dense.unresolved_at) < dense.t[-1]
    # The motion is unresolved before the estimate exceeds the claim.
    above = np.max(present(dense.estimate), axis=(1, 2)) > CLAIM
    assert present(dense.unresolved_at) < dense.t[np.argmax(above)]
    assert f"ours: unresolved from {dense.unresolved_at:.4g} s on, its own estimate is not below its claim" in (
        sampled.warnings
    )


@pytest.mark.parametrize("growth", [0.0, 0.3, 1.0])
def test_the_estimate_is_near_the_error_of_a_power_series_in_the_step(growth):
    # The expansion of 1 / (1 - h / 3) contains all powers of the step h.
    levels, powers = (2, 3, 4, 6, 8), (1, 2, 3, 4)
    steps = (0.05 + growth) / np.array(levels)
    values = np.cumsum(np.ones((5, 3)), axis=1) / (1 - steps[:, None] / 3)
    error = np.abs(combine(values, extrapolation_weights(levels, powers)) - np.arange(1, 4))
    estimate = expected_error(values, levels, powers)
    assert np.all(estimate > error)
    # If successive differences fall by more than a factor of 100, the estimate is below the last difference.
    last = np.abs(
        np.subtract(*(combine(values[i:], extrapolation_weights(levels[i:], powers[: 4 - i])) for i in (0, 1)))
    )
    assert np.all(estimate < np.maximum(30 * error, last))


def test_runs_that_step_over_a_damper_are_unresolved_from_the_start():
    # The inertia of the bar is 1 / 3 kg m^2, so the damper stops it in a third of a millisecond.
    linkage = replace(sledge(), forces=(TorsionDamper("damper", None, "bar", 1e3),))
    exact = Extrapolated(SeriesToy({2: 0.0}), "extended", (1, 2, 3), (2, 3))
    assert exact.build(linkage, 0.9 * linkage.time_scale)(10, 1).unresolved_at is None
    over = exact.build(linkage, 1.1 * linkage.time_scale)(10, 1)
    assert over.unresolved_at == 0
    assert any("unresolved from 0 s on" in warning for warning in over.warnings)


def test_samples_are_nan_if_one_level_fails():
    trajectory = run(Extrapolated(SeriesToy(broken_below=0.04), "extended", (1, 2, 3), (2, 3)))
    assert np.all(np.isfinite(trajectory.pose[0]))
    for values in (trajectory.pose, trajectory.twist, trajectory.reaction, trajectory.estimate):
        assert values is not None
        assert np.all(np.isnan(values[1:]))
    combined = combine(np.array([[np.inf, 1.0], [1.0, 2.0]]), extrapolation_weights((1, 2), (1,)))
    assert np.isnan(combined[0])
    assert combined[1] == pytest.approx(3.0)


def test_stepping_times_add_up_and_warnings_and_the_first_reset_are_passed_on():
    trajectory = run(Extrapolated(SeriesToy(resets_below=0.06), "extended", (1, 2, 3), (2, 3)))
    assert trajectory.stepping == pytest.approx(1e-3 * 30 * (1 + 2 + 3))
    assert trajectory.reset_at == pytest.approx(100 * 0.1 / 3)
    assert trajectory.warnings[:3] == ("reset", "at step 0.05", "at step 0.0333")
    assert run(Extrapolated(SeriesToy(), "extended", (1, 2), (2,))).reset_at is None


@pytest.mark.parametrize(
    ("levels", "powers"),
    [((1, 2), (2, 3)), ((1, 2, 3), (2,)), ((2, 1), (2,)), ((1, 1), (2,)), ((0, 1), (2,)), ((1, 2), (0,)), ((1,), ())],
)
def test_levels_and_powers_that_do_not_fit_are_refused(levels, powers):
    with pytest.raises(ValueError, match=r"(?i)extrapolated: (levels|powers|.* levels remove)"):
        Extrapolated(SeriesToy(), "extended", levels, powers)


def test_a_further_run_decides_if_the_last_difference_is_small_by_chance():
    # The terms of orders 5 and 6 cancel in the last difference, but not in the remaining error.
    levels, powers, dt = (1, 2, 3, 4), (2, 3, 4), 0.1
    steps = dt / np.array(levels)
    residual = {power: float(extrapolation_weights(levels, powers) @ steps**power) for power in (5, 6)}
    without = {power: float(extrapolation_weights(levels[1:], powers[:-1]) @ steps[1:] ** power) for power in (5, 6)}
    last = {power: residual[power] - without[power] for power in (5, 6)}
    size = 3 * CLAIM / abs(residual[5] - residual[6] * last[5] / last[6])  # The error after 1 s is 3 CLAIM.
    toy = SeriesToy({2: 1e-3, 3: -2e-3, 4: 1e-3, 5: size, 6: -size * last[5] / last[6]})
    trajectory = run(Extrapolated(toy, "extended", levels, powers), dt)
    error = np.abs(trajectory.pose - np.cos(trajectory.t)[:, None, None]).max(axis=(1, 2))
    assert error.max() > 3 * CLAIM
    claimed = trajectory.t < (math.inf if trajectory.unresolved_at is None else trajectory.unresolved_at)
    assert error[claimed].max() <= CLAIM
    assert np.all(error <= present(trajectory.estimate).max(axis=(1, 2)) + 1e-12)
