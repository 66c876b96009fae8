"""The judge: exact multipliers at the tightest tolerance, with an error estimate from a second run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engines import OneShot
from engines.lagrange.engine import Lagrange, Tolerance
from engines.lagrange.running import LagrangeRun
from reference.checks import Count, Positive, validated
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

Array = NDArray[np.float64]

# The claimed accuracy: of poses in radians and in units of the mechanism's length, of velocities in its own time.
JUDGE_CLAIM = 1e-10
# The tolerance of the second run, relative to the first.
SECOND_RUN_FACTOR = 10.0
# The tolerance of a run that replaces one in which rounding disturbs the step control, relative to that.
FALLBACK_FACTOR = 100.0


@dataclass(frozen=True)
class Judge(Lagrange):
    """The tightest tolerance that double precision allows, and an `estimate` of the error.

    The estimate is the difference to a second run with other steps: its tolerance is SECOND_RUN_FACTOR times as large,
    and it has samples twice as often and one more at the end, since steps end at samples where the tolerance allows it.
    So the estimate is about SECOND_RUN_FACTOR times the error if the tolerance determines it, and about the error if
    rounding does. The motion is unresolved, with a warning, from the first sample at which the estimate of poses or of
    velocities exceeds JUDGE_CLAIM.

    If rows are nearly dependent, rounding may exceed the tolerance, and steps become too small. The run is then
    repeated with FALLBACK_FACTOR times the tolerance.
    """

    tolerance: Tolerance | None = 1e-13

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> _JudgeRun:  # pyright: ignore[reportIncompatibleMethodOverride]
        """A run with samples dt [s] apart; raises ValueError for a dt that is not a finite time above zero."""
        return _JudgeRun(self, mechanism, dt)


class _JudgeRun(OneShot):
    def __init__(self, engine: Judge, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self._first_run = LagrangeRun(engine, mechanism, dt)
        self.size = self._first_run.size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self.begin()
        trajectory, factor = self._first_run(samples, every), SECOND_RUN_FACTOR
        stepping = trajectory.stepping
        if not np.isfinite(trajectory.pose).all():
            fallback = self._looser_run(FALLBACK_FACTOR, 1)(samples, every)
            stepping += fallback.stepping
            if np.isfinite(fallback.pose).all():
                trajectory, factor = fallback, FALLBACK_FACTOR * SECOND_RUN_FACTOR
        second = self._looser_run(factor, 2)(2 * samples + 1, every)
        stepping += second.stepping
        estimate = np.abs(trajectory.pose - second.pose[:-1:2])
        rate_estimate = np.abs(trajectory.twist - second.twist[:-1:2]) * self._mechanism.time_scale
        errors = np.maximum(estimate, rate_estimate) / self._mechanism.pose_unit
        # Both runs may leave the same joint open: its row is lost if masses are too far apart.
        errors = np.concatenate([errors.reshape(len(errors), -1), self._violations(trajectory)], axis=1)
        is_unresolved = ~(errors < JUDGE_CLAIM).all(axis=1)  # also if an error is NaN
        unresolved_at, warnings = None, trajectory.warnings
        if is_unresolved.any():
            unresolved_at = float(trajectory.t[int(np.argmax(is_unresolved))])
            text = f"lagrange: unresolved from {unresolved_at:.6g} s on, {JUDGE_CLAIM:g} is not held"
            warnings = (*warnings, RunWarning(text, "unresolved", time=unresolved_at))
        return replace(trajectory, stepping=stepping, warnings=warnings, estimate=estimate, unresolved_at=unresolved_at)

    def _violations(self, trajectory: Trajectory) -> Array:
        """Gaps and slips (times, 2 rows) in the mechanism's own length and time, less the rounding of positions.

        NaN where the motion is lost.
        """
        mechanism, out = self._mechanism, np.full((len(trajectory.t), 2 * self._mechanism.row_count), np.nan)
        finite = np.isfinite(trajectory.pose).all(axis=(1, 2)) & np.isfinite(trajectory.twist).all(axis=(1, 2))
        t, pose, twist = trajectory.t[finite], trajectory.pose[finite], trajectory.twist[finite]
        size = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
        gap = np.abs(np.nan_to_num(mechanism.gap(pose, t))) / size
        slip = np.abs(mechanism.slip(pose, twist)) * mechanism.time_scale / size
        distance = np.abs(pose[..., :2]).max(axis=(1, 2)) / mechanism.length_scale
        out[finite] = np.concatenate([gap, slip], axis=1) - 100 * np.finfo(float).eps * distance[:, None]
        return out

    def _looser_run(self, factor: float, parts: int) -> LagrangeRun:
        """A run with `factor` times the tolerance, and samples that divide dt in `parts`."""
        tolerance = None if self._engine.tolerance is None else factor * self._engine.tolerance
        return LagrangeRun(replace(self._engine, tolerance=tolerance), self._mechanism, self._dt / parts)


TRUTH = Judge()
"""The judge with which scenes and engines are compared."""
