"""The judge: exact multipliers at the tightest tolerance, with an estimate of the error by a second run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engines import OneShot
from engines.lagrange.engine import Lagrange, Tolerance, _LagrangeRun
from reference.checks import Count, Positive, validated
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
LOOSER = 10.0  # times the tolerance has the second run
ROUGH = 100.0  # times the tolerance has a run that rounding disturbs
HELD = 1e-10  # of poses, in radians and parts of the mechanism's length, and of velocities, in the mechanism's own time


@dataclass(frozen=True)
class Judge(Lagrange):
    """The tightest tolerance that double precision carries, and an `estimate` of what the answer is wrong by.

    That is the difference to a second run, whose steps are others: at LOOSER times the tolerance, with samples twice as
    often and one more after the end, as steps end at samples or at the end wherever the tolerance allows it. So it is
    about LOOSER times the error where the tolerance sets the steps, and about the error where rounding does. From where
    poses, or velocities in the mechanism's own time, differ by more than HELD the motion is unresolved, and a warning
    tells it: nobody can be held against it from there on.

    Where rows are nearly dependent, rounding alone may be above the tolerance, and steps become too small; then another
    run is made with ROUGH times as much.
    """

    tolerance: Tolerance | None = 1e-13

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> _JudgeRun:  # pyright: ignore[reportIncompatibleMethodOverride]
        """As of any method; raises ValueError for a step that is not a finite time above zero."""
        return _JudgeRun(self, mechanism, dt)


class _JudgeRun(OneShot):
    def __init__(self, engine: Judge, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self._first = _LagrangeRun(engine, mechanism, dt)
        self.size = self._first.size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self.begin()
        found, factor = self._first(samples, every), LOOSER
        spent = found.stepping
        if not np.isfinite(found.pose).all():
            rough = self._looser(ROUGH, 1)(samples, every)
            spent += rough.stepping
            if np.isfinite(rough.pose).all():
                found, factor = rough, ROUGH * LOOSER
        other = self._looser(factor, 2)(2 * samples + 1, every)
        estimate = np.abs(found.pose - other.pose[:-1:2])
        rate = np.abs(found.twist - other.twist[:-1:2]) * self._mechanism.time_scale
        # Both runs may leave the same joint open: masses may be so far apart that its row is lost beside others.
        left = np.maximum(estimate, rate) / self._mechanism.pose_unit
        left = np.concatenate([left.reshape(len(left), -1), self._left_open(found)], axis=1)
        # Not below, where one is no number.
        above = ~(left < HELD).all(axis=1)
        unresolved_at, warnings = None, found.warnings
        if above.any():
            unresolved_at = float(found.t[int(np.argmax(above))])
            warnings = (*warnings, f"lagrange: unresolved from {unresolved_at:.6g} s on, {HELD:g} is not held")
        spent += other.stepping
        return replace(found, stepping=spent, warnings=warnings, estimate=estimate, unresolved_at=unresolved_at)

    def _left_open(self, found: Trajectory) -> Array:
        """(times, 2 rows) gaps and slips, in the mechanism's own length and time, beyond the rounding of places; NaN
        where the motion is lost."""
        mechanism, out = self._mechanism, np.full((len(found.t), 2 * self._mechanism.row_count), np.nan)
        alive = np.isfinite(found.pose).all(axis=(1, 2)) & np.isfinite(found.twist).all(axis=(1, 2))
        t, pose, twist = found.t[alive], found.pose[alive], found.twist[alive]
        size = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
        gap = np.abs(np.nan_to_num(mechanism.gap(pose, t))) / size
        slip = np.abs(mechanism.slip(pose, twist)) * mechanism.time_scale / size
        far = np.abs(pose[..., :2]).max(axis=(1, 2)) / mechanism.length_scale
        out[alive] = np.concatenate([gap, slip], axis=1) - 100 * np.finfo(float).eps * far[:, None]
        return out

    def _looser(self, factor: float, parts: int) -> _LagrangeRun:
        """A run with so many times the tolerance, and steps [s] that are parts of those asked for."""
        tolerance = None if self._engine.tolerance is None else factor * self._engine.tolerance
        return _LagrangeRun(replace(self._engine, tolerance=tolerance), self._mechanism, self._dt / parts)


TRUTH = Judge()
"""What scenes and engines are checked against."""
