"""A run of `Lagrange` in compiled code or in numpy, and its warnings."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from engines import OneShot, Size
from engines.lagrange.compiled_model import CompiledModel, open_warning, stopped_warning
from engines.lagrange.dynamics import (
    PROJECTION_ITERATIONS,
    Dynamics,
    Step,
    adaptive,
    regularised_bias,
    runge_kutta,
    semi_implicit_euler,
)
from engines.lagrange.methods import FIXED_DOP853, NO_STAGES, RK4
from reference.checks import Count, validated
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning, Trajectory

if TYPE_CHECKING:
    from engines.lagrange.engine import Lagrange

Array = NDArray[np.float64]

FIXED_STEP_TABLEAUS = {"euler": NO_STAGES, "rk4": RK4, "dop853": FIXED_DOP853}
# A row is lost if its slip exceeds this share of the largest speed after a projection. Without a projection, the error
# of the row's acceleration is compared with the largest acceleration. The value is the square root of the rounding.
LOST_ROW = 1.5e-8
# Smallest speed with which a slip is compared, in units of the mechanism's length and time scale.
SLOW_MOTION = 1e-4


class LagrangeRun(OneShot):
    def __init__(self, engine: Lagrange, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self._regularisation = engine.regularisation(mechanism, dt)
        self._model = CompiledModel.of(mechanism) if engine.in_machine_code else None
        self._dynamics = None if self._model else Dynamics(mechanism, self._regularisation)
        if self._model is not None and self._regularisation is not None:
            self._model.regularise(self._regularisation, np.ones(mechanism.row_count, dtype=bool))
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, mechanism.row_count)

    @property
    def dynamics(self) -> Dynamics:
        if self._dynamics is None:
            self._dynamics = Dynamics(self._mechanism, self._regularisation)
        return self._dynamics

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are no positive whole numbers, and RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        self.begin()
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        if self._model is not None:
            self._engine.prepare()
        started = time.process_time()
        with np.errstate(all="ignore"):  # a diverging run has another warning
            poses, twists = self._motion(samples, every)
            stepping = time.process_time() - started
            warnings = self._model.warnings(self._engine.tolerance) if self._model is not None else ()
            reactions, accelerations = self._reactions(t, poses, twists)
            warnings = warnings or self._incomplete(t, poses) or self._lost_rows(t, poses, twists, accelerations)
            return Trajectory(t, poses, twists, reactions, stepping, warnings)

    def _motion(self, samples: int, every: int) -> tuple[Array, Array]:
        """Poses and twists (samples + 1, bodies, 3), or NaN after the last completed sample."""
        if self._model is None:
            poses, twists = np.full((2, samples + 1, *self._mechanism.pose.shape), np.nan)
            poses[0], twists[0] = self._mechanism.pose, self._mechanism.twist
            self._step_in_numpy(poses, twists, 0, every)
            return poses, twists
        poses, twists = self._model.empty_samples(samples)
        completed = self._step_compiled(self._model, poses, twists, every)
        if self._model.lacks_contact:
            self._step_in_numpy(poses, twists, completed, every)
        return poses, twists

    def _step_compiled(self, model: CompiledModel, poses: Array, twists: Array, every: int) -> int:
        if self._engine.tolerance is not None:
            return model.adaptive_steps(self._engine.tolerance, self._dt * every, 0, poses, twists)
        iterations = PROJECTION_ITERATIONS if self._engine.stabilisation == "projection" else 0
        tableau = FIXED_STEP_TABLEAUS[self._engine.integrator]
        return model.fixed_steps(tableau, iterations, self._dt, every, 0, poses, twists)

    def _numpy_step(self) -> Step:
        if self._engine.tolerance is not None:
            return adaptive(self.dynamics, self._engine.tolerance)
        if self._engine.integrator == "euler":
            return semi_implicit_euler(self.dynamics)
        return runge_kutta(self.dynamics, FIXED_STEP_TABLEAUS[self._engine.integrator])

    def _step_in_numpy(self, poses: Array, twists: Array, begin: int, every: int) -> None:
        """Fill the samples after `begin` while the motion is finite."""
        step, pose, twist = self._numpy_step(), poses[begin], twists[begin]
        steps, dt = (1, self._dt * every) if self._engine.tolerance is not None else (every, self._dt)
        for sample in range(begin, len(poses) - 1):
            for i in range(steps):
                t = (sample * steps + i) * dt
                pose, twist = step(pose, twist, t, dt)
                if self._engine.stabilisation == "projection":
                    pose, twist = self.dynamics.project(pose, twist, t + dt)
            if not np.all(np.isfinite(pose)):
                return
            poses[sample + 1], twists[sample + 1] = pose, twist

    def _reactions(self, t: Array, poses: Array, twists: Array) -> tuple[Array, Array]:
        """Reactions (samples, rows) and accelerations (samples, bodies, 3), or NaN for states that are not finite.

        Reactions of dependent rows are the minimum-norm solution, as in `Mechanism.reaction`.
        """
        mechanism = self._mechanism
        reactions, accelerations = np.full((len(t), mechanism.row_count), np.nan), np.full_like(poses, np.nan)
        finite = np.all(np.isfinite(poses) & np.isfinite(twists), axis=(1, 2))
        if not mechanism.row_count or not np.any(finite):
            return reactions, accelerations
        model = self._model
        if model is not None:
            count = len(t) - int(np.argmax(finite[::-1]))
            reactions[:count], accelerations[:count] = model.reactions(float(t[1]), poses[:count], twists[:count])
            if not model.lacks_contact:
                if model.has_dependent_rows:
                    reactions[:count] = mechanism.reaction(poses[:count], accelerations[:count], twist=twists[:count])
                return reactions, accelerations
        for at in np.flatnonzero(finite):
            rows, reactions[at] = self.dynamics.reaction(poses[at], twists[at], t[at])
            accelerations[at] = self.dynamics.acceleration_under(rows, reactions[at], poses[at], twists[at])
        if self.dynamics.has_dependent_rows:
            reactions[finite] = mechanism.reaction(poses[finite], accelerations[finite], twist=twists[finite])
        return reactions, accelerations

    def _incomplete(self, t: Array, poses: Array) -> tuple[RunWarning, ...]:
        """The warning of a run that stopped early, or whose projection in numpy did not converge."""
        if self._dynamics is not None and not np.isnan(self._dynamics.open_from):
            return (open_warning(self._dynamics.open_from),)
        finite = np.all(np.isfinite(poses), axis=(1, 2))
        return () if finite[-1] else (stopped_warning(self._engine.tolerance, float(t[int(np.argmin(finite)) - 1])),)

    def _lost_rows(self, t: Array, poses: Array, twists: Array, accelerations: Array) -> tuple[RunWarning, ...]:
        """The warning about joints that slip after a projection, or (without projection) whose accelerations violate
        rows.

        If a body's distance from a joint is large relative to its radius of gyration, its mass has a small effect on J
        M^-1 J^T. If the effect is below rounding, the factorisation ignores the row as a dependent row.
        """
        mechanism, regularisation = self._mechanism, self._regularisation
        slow_speed = SLOW_MOTION * mechanism.length_scale / mechanism.time_scale
        if self._engine.stabilisation == "projection":
            is_lost = self._exceeds(mechanism.slip(poses, twists), twists, slow_speed)
            return _lost_row_warning("joints slip after the projection", t[1:][is_lost[1:]])
        # Without projection, rolling curves may separate, but the equations are valid only in contact.
        if any(isinstance(joint, Roll) for joint in mechanism.joints):
            t, poses, twists, accelerations = t[:1], poses[:1], twists[:1], accelerations[:1]
        expected = mechanism.bias(poses, twists)
        if regularisation is not None:
            gap = np.where(mechanism.holonomic, mechanism.gap(poses, t), 0.0)
            slip = mechanism.slip(poses, twists)
            expected = regularised_bias(regularisation, np.array(regularisation.rows), expected, slip, gap)
        missing = mechanism.slip(poses, accelerations) + mechanism.rate - expected
        is_lost = self._exceeds(missing, accelerations, slow_speed / mechanism.time_scale)
        return _lost_row_warning("accelerations open joints", t[is_lost])

    def _exceeds(self, rows: Array, rates: Array, slow: float) -> NDArray[np.bool_]:
        """Whether a row exceeds LOST_ROW * (largest rate + slow), by time (times,).

        Angular values are multiplied by the mechanism's length.
        """
        mechanism = self._mechanism
        size = np.array([1.0, 1.0, mechanism.length_scale])
        row = np.abs(rows) * np.where(mechanism.is_angular, mechanism.length_scale, 1.0)
        return row.max(axis=1, initial=0.0) > LOST_ROW * (np.abs(rates * size).max(axis=(1, 2)) + slow)


def _lost_row_warning(symptom: str, times: Array) -> tuple[RunWarning, ...]:
    if not len(times):
        return ()
    text = (
        f"lagrange: at {times[0]:.6g} s {symptom}: masses, or an arm and a radius of gyration, are so far apart that a "
        "row is lost beside others, or the position is singular"
    )
    return (RunWarning(text, "rank", time=float(times[0])),)
