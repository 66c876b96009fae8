"""The judge: exact multipliers at a tolerance near rounding, with an error estimate from a second run."""

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

# Claimed accuracy of poses and velocities, in rad or in units of the mechanism's length and time scale.
JUDGE_CLAIM = 1e-10
# Tolerance of the second run relative to the tolerance of the first run.
SECOND_RUN_FACTOR = 10.0
# Factor on the tolerance if rounding disturbs the step control and the run is repeated.
FALLBACK_FACTOR = 100.0


@dataclass(frozen=True)
class Judge(Lagrange):
    """The engine with a tolerance near rounding and an `estimate` of its error.

    The estimate is the difference from a second run with SECOND_RUN_FACTOR times the tolerance. The second run has 2 n
    + 1 samples instead of n, so it takes other steps. If the tolerance determines the error, the estimate is about
    SECOND_RUN_FACTOR times the error. If rounding determines the error, the estimate is about the error. If the
    estimate of poses or velocities exceeds JUDGE_CLAIM, the motion is unresolved from then on, and the run has a
    warning.

    If rows are nearly dependent, rounding may exceed the tolerance, and steps become too small. In this case the run is
    repeated with FALLBACK_FACTOR times the tolerance.
    """

    tolerance: Tolerance | None = 1e-13

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> _JudgeRun:  # pyright: ignore[reportIncompatibleMethodOverride]
        return _JudgeRun(self, mechanism, dt)


class _JudgeRun(OneShot):
    def __init__(self, engine: Judge, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self._first_run = LagrangeRun(engine, mechanism, dt)
        self.size = self._first_run.size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are no positive whole numbers, and RuntimeError at the second call."""
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
        # Both runs may have the same open joint, since a row is lost if masses are too different.
        errors = np.concatenate([errors.reshape(len(errors), -1), self._violations(trajectory)], axis=1)
        is_unresolved = ~(errors < JUDGE_CLAIM).all(axis=1)  # True for NaN
        unresolved_at, warnings = None, trajectory.warnings
        if is_unresolved.any():
            unresolved_at = float(trajectory.t[int(np.argmax(is_unresolved))])
            text = f"lagrange: unresolved from {unresolved_at:.6g} s on, {JUDGE_CLAIM:g} is not held"
            warnings = (*warnings, RunWarning(text, "unresolved", time=unresolved_at))
        return replace(trajectory, stepping=stepping, warnings=warnings, estimate=estimate, unresolved_at=unresolved_at)

    def _violations(self, trajectory: Trajectory) -> Array:
        """Gaps and slips (times, 2 rows) in units of the mechanism's length and time scale, minus the rounding of
        positions.

        Gaps and slips are NaN at times with a state that is not finite.
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
        tolerance = None if self._engine.tolerance is None else factor * self._engine.tolerance
        return LagrangeRun(replace(self._engine, tolerance=tolerance), self._mechanism, self._dt / parts)


TRUTH = Judge()
