"""The iterations in a step of pymunk and the corrected fraction of a gap, for the worst pose of a motion."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from math import ceil, log
from typing import Annotated

import numpy as np

from engines import Unsupported
from engines.pymunk.convergence import (
    DENSE,
    MIN_ITERATIONS,
    RESIDUAL,
    STARTUP_WORK,
    Factor,
    convergence_factor,
    convergence_factor_at,
    convergence_factors,
    iterations_for,
    stable_factor,
)
from engines.pymunk.model import Settings, build_model
from engines.pymunk.running import record
from engines.remembered import by_identity
from reference.checks import LARGEST_COUNT, Count, NonNegative, validated
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.validators import from_to

# Factor on the largest stable gain (1 - r)/r if the residual r exceeds RESIDUAL.
SAFETY = 0.8
# Limit on iterations. With more iterations, a smaller step would be a better use of the CPU time for a hundred links.
ITERATION_LIMIT = 300
CONVERGED_RESIDUAL = 1e-16
# Number of stages of the start-up. The last stage ends at the tenth step, which is often the first sample.
STARTUP_STAGES = 6

# A pilot run has PILOT_POSES poses for up to DENSE rows. For more rows it has FEW_PILOT_POSES, since a pose then takes
# as long as some hundred steps.
PILOT_POSES, FEW_PILOT_POSES = 16, 2
# Number of steps of the pilot run per radian of the fastest motion.
PILOT_STEPS = 20
MAX_PILOT_STEPS = 4096
# A step of the pilot run corrects a tenth of a gap. We found no mechanism that is unstable with this fraction.
PILOT = Settings(iterations=10, error_bias=0.9, unit=1.0, skate="groove", roll="pivot")
# Largest gap of a usable pose of the pilot run, in rad or relative to the mechanism's length scale.
MAX_PILOT_GAP = 0.05

Whole = Annotated[int, from_to(0, LARGEST_COUNT)]


@dataclass(frozen=True)
class IterationPlan:
    """The iterations in a step, the resulting residual of the slowest mode, and the corrected fraction of a gap.

    `converged`: number of iterations that reach CONVERGED_RESIDUAL, or fewer if STARTUP_WORK limits them.
    `converged_residual`: residual after `converged` iterations.
    """

    iterations: int
    gain: float = 1.0
    residual: float = 0.0
    converged: int = 1000
    converged_residual: float = 0.0

    def startup(self, steps: int) -> list[int]:
        """The iterations of the first steps, which decrease from `converged` in stages of `steps` steps each.

        In an extrapolation, `steps` is such that a stage ends at the same time in all runs.
        """
        first = [self.converged, *[ceil(self.converged / 2)] * (steps - 1)][:steps]
        if not 0 < self.residual <= RESIDUAL:
            return first
        factors = [1 + log(STARTUP_STAGES / stage) / -log(self.residual) for stage in range(1, STARTUP_STAGES)]
        counts = [ceil(self.iterations * factor) for factor in factors]
        return first + [min(count, self.converged) for count in counts for _ in range(steps)]


def plan_by_rule(rho: float, joints: int, fewest: int = MIN_ITERATIONS, work: int = 0) -> IterationPlan:
    iterations = iterations_in_step(rho, joints, fewest, work)
    needed = ceil(log(CONVERGED_RESIDUAL) / log(rho)) if rho > 0 else 1
    return plan_with(rho, iterations, max(iterations, min(needed, STARTUP_WORK // joints)))


def plan_with(rho: float, iterations: int, converged: int = 1000) -> IterationPlan:
    return IterationPlan(iterations, stable_gain(rho, iterations), rho**iterations, converged, rho**converged)


@validated
def iterations_in_step(rho: Factor, joints: Count = 1, fewest: Count = MIN_ITERATIONS, work: Whole = 0) -> int:
    """The number of iterations that reduce the slowest mode to RESIDUAL; at least `fewest`.

    If iterations times joints exceed `work`, ITERATION_LIMIT is the upper limit.
    """
    needed = iterations_for(rho, fewest)
    return needed if needed * joints <= work else min(needed, max(ITERATION_LIMIT, fewest))


@validated
def stable_gain(rho: Factor, iterations: Count) -> float:
    """The largest fraction of a gap that a step may correct."""
    residual = rho**iterations
    return 1.0 if residual <= RESIDUAL else min(1.0, SAFETY * (1 - residual) / residual)


@validated
def worst_factor(mechanism: Mechanism, duration: NonNegative, rolls_are_contacts: bool = False) -> float:
    """The largest convergence factor at t = 0 and at the poses of a pilot run of `duration` [s].

    If some rows correct no gap, `engines.pymunk.convergence.stable_factor` increases the factor.
    """
    # The duration is rounded, since its rounding errors differ between the levels of an extrapolation.
    return _worst_factor(mechanism, float(f"{duration:.12g}"), rolls_are_contacts)


@by_identity()
def _worst_factor(mechanism: Mechanism, duration: float, rolls_are_contacts: bool) -> float:
    poses = _pilot_poses(mechanism, duration)
    rho = max([convergence_factor(mechanism), *_factors(mechanism, poses)])
    return stable_factor(mechanism, np.array([mechanism.pose, *poses]), rho, rolls_are_contacts)


def _factors(mechanism: Mechanism, poses: list[np.ndarray]) -> list[float]:
    if poses and mechanism.row_count <= DENSE:
        with contextlib.suppress(np.linalg.LinAlgError):
            return convergence_factors(mechanism, np.array(poses)).tolist()
    return [convergence_factor_at(mechanism, pose) for pose in poses]


def _pilot_poses(mechanism: Mechanism, duration: float) -> list[np.ndarray]:
    if duration == 0 or not mechanism.joints:
        return []
    count = PILOT_POSES if mechanism.row_count <= DENSE else FEW_PILOT_POSES
    every = max(1, ceil(min(duration / mechanism.time_scale * PILOT_STEPS, MAX_PILOT_STEPS) / count))
    dt = duration / (every * count)
    try:
        with np.errstate(all="ignore"):
            model = build_model(mechanism, replace(PILOT, unit=dt))
            poses = record(model, dt, count, every, raw=True).pose[1:]
            gap = mechanism.gap(poses, dt * every * np.arange(1, count + 1))
    except Unsupported:
        return []
    except (ValueError, ArithmeticError):
        # In a pilot run, curves may reach a pose without contact. Without curves, the exception is a bug.
        if not any(isinstance(joint, Roll) for joint in mechanism.joints):
            raise
        return []
    too_open = np.abs(gap) > MAX_PILOT_GAP * np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    usable = np.isfinite(poses).all(axis=(1, 2)) & ~too_open.any(axis=1)
    return list(poses[usable])
