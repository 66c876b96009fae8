"""Accelerations, projections, and fixed steps of explicit Runge-Kutta methods."""

from __future__ import annotations

import math

import numpy as np

from engines.lagrange.compiled import inlined, inner, merged
from engines.lagrange.compiled.forces import applied_accelerations
from engines.lagrange.compiled.joints import set_bodies, set_equations
from engines.lagrange.compiled.solve import FEW_ROWS, WELL_CONDITIONED, factorise_rows, row_times, solve
from engines.lagrange.records import CLOSED, RowLaw, RowSelection

# A projection is nearly singular below this pivot. Rounding of gaps, 1e-16, then becomes velocities of 1e-16 / pivot.
NEARLY_SINGULAR = 1e-8
# A named constant, since numba would compile `solve` a second time for the literal 0.
NO_CORRECTIONS = np.int64(0)


@inner
def accelerate(system, pose, twist, t, out):
    """Set `out` (coordinates,) to the accelerations, and the reactions and rows of the system."""
    set_bodies(system.bodies, pose, twist)
    applied_accelerations(system, out)
    ground = len(out) - 3
    if len(system.rows) > 0:
        set_equations(system, t)
        set_right_side(system, twist, out)
        system.status.selection = RowSelection.ALL
        factorise_rows(system)
        solve(system, 1 if len(system.rows) > FEW_ROWS else 0)
        for k in range(ground):
            out[k] += system.change[k]
    for k in range(ground, ground + 3):  # values may be NaN in a diverged stage
        out[k] = 0.0


@merged
def set_right_side(system, twist, applied):
    """Set the right side to bias - J applied, minus spring and damper terms for soft rows."""
    rows = len(system.rows)
    for row in range(rows):
        system.right[row] = system.equations[row].bias - row_times(system, row, applied)
    if system.constants.regularised == RowLaw.IDEAL:
        return
    for row in range(rows):
        equation = system.equations[row]
        slip = row_times(system, row, twist) - equation.rate
        value = equation.damping * slip + equation.stiffness * equation.gap
        system.right[row] -= value + equation.without_bias * equation.bias


@inner
def project(system, pose, twist, t, iterations, pose_unit):
    """Move a pose and a twist to the nearest values that satisfy the joints, in the norm of the masses."""
    rows, moving = len(system.rows), len(pose) - 3
    if rows == 0:
        return
    keeps_factor = system.constants.holonomic_rows > 0 and project_pose(system, pose, twist, t, iterations, pose_unit)
    set_bodies(system.bodies, pose, twist)
    set_equations(system, t)
    for row in range(rows):
        system.right[row] = system.equations[row].rate - row_times(system, row, twist)
    system.status.selection = RowSelection.ALL
    if not keeps_factor or system.status.factor_pivot < WELL_CONDITIONED:
        factorise_rows(system)
    solve(system, 1 if keeps_factor else 0)
    for k in range(moving):
        twist[k] += system.change[k]
    is_singular = system.status.factor_pivot < NEARLY_SINGULAR and system.constants.dependent == 0
    if is_singular and math.isnan(system.status.singular_at):
        system.status.singular_at = t


@merged
def project_pose(system, pose, twist, t, iterations, pose_unit):
    """Close the gaps by Newton's method; return whether the last factorisation is accurate enough for the twist.

    `open_from` of the status is the first time at which the iterations did not close the joints. The step then ended
    too far from an admissible pose, or at a singular pose.
    """
    rows, moving = len(system.rows), len(pose) - 3
    has_holonomic_rows_only = system.constants.holonomic_rows == rows
    for _ in range(iterations):
        set_bodies(system.bodies, pose, twist)
        set_equations(system, t)
        for row in range(rows):
            system.right[row] = -system.equations[row].gap
        system.status.selection = RowSelection.ALL if has_holonomic_rows_only else RowSelection.HOLONOMIC
        factorise_rows(system)
        solve(system, NO_CORRECTIONS)
        largest = 0.0
        for k in range(moving):
            pose[k] += system.change[k]
            largest = max(largest, abs(system.change[k]) / pose_unit[k])
        if not largest > CLOSED:
            return has_holonomic_rows_only
    if math.isnan(system.status.open_from):
        system.status.open_from = t
    return False


@inlined
def copy_state(pose, twist, to_pose, to_twist):
    for k in range(len(pose)):
        to_pose[k], to_twist[k] = pose[k], twist[k]


@inner
def evaluate_stage(system, storage, stages, nodes, stage, t, dt):
    velocities, accelerations = storage.velocities, storage.accelerations
    pose, twist = storage.stage_pose, storage.stage_twist
    for k in range(len(pose)):
        pose[k], twist[k] = storage.pose[k], storage.twist[k]
    for earlier in range(stage):
        share = stages[stage, earlier] * dt
        if share != 0:
            for k in range(len(pose)):
                twist[k] += share * accelerations[earlier, k]
                pose[k] += share * velocities[earlier, k]
    accelerate(system, pose, twist, t + nodes[stage] * dt, storage.acceleration)
    store_stage(storage, stage, twist)


@inlined
def store_stage(storage, stage, velocity):
    for k in range(len(velocity)):
        storage.velocities[stage, k], storage.accelerations[stage, k] = velocity[k], storage.acceleration[k]


@inlined
def add_stages(storage, weights, dt, pose, twist):
    """Add weighted sums of the stages to a state; each sum is computed first, so that the state is rounded once."""
    for k in range(len(pose)):
        moved = gained = 0.0
        for stage in range(len(weights)):
            moved += weights[stage] * storage.velocities[stage, k]
            gained += weights[stage] * storage.accelerations[stage, k]
        pose[k] += dt * moved
        twist[k] += dt * gained


@inner
def fixed_steps(system, storage, tableau, samples, begin, iterations, dt, every):
    """Make `every` steps of `dt` per sample after `begin`, and fill poses and twists (samples, 3 bodies).

    Without stages the method is semi-implicit Euler. A run stops early before a pose that is not finite, or before a
    contact without a cell in its table (`missing_roll`). Returns the last completed sample.
    iterations: number of Newton iterations after a step; 0 for no projection.
    """
    pose, twist, poses, twists = storage.pose, storage.twist, samples.poses, samples.twists
    copy_state(poses[begin], twists[begin], pose, twist)
    for sample in range(begin, len(poses) - 1):
        for step in range(every):
            t = (sample * every + step) * dt
            if len(tableau.nodes) == 0:
                accelerate(system, pose, twist, t, storage.acceleration)
                for k in range(len(pose)):
                    twist[k] += dt * storage.acceleration[k]
                    pose[k] += dt * twist[k]
            else:
                for stage in range(len(tableau.nodes)):
                    evaluate_stage(system, storage, tableau.stages, tableau.nodes, stage, t, dt)
                add_stages(storage, tableau.weights, dt, pose, twist)
            if iterations > 0:
                project(system, pose, twist, t + dt, iterations, storage.pose_unit)
            if system.status.missing_roll >= 0:
                return sample
        for k in range(poses.shape[1]):
            if not math.isfinite(pose[k]):
                return sample
            poses[sample + 1, k], twists[sample + 1, k] = pose[k], twist[k]
    return len(poses) - 1


@inner
def evaluate_samples(system, storage, samples, begin, dt):
    """Set the reactions and accelerations at samples `dt` apart; return the last completed sample."""
    poses, twists, reactions, accelerations = samples.poses, samples.twists, samples.reactions, samples.accelerations
    for sample in range(begin, len(poses)):
        copy_state(poses[sample], twists[sample], storage.pose, storage.twist)
        accelerate(system, storage.pose, storage.twist, sample * dt, storage.acceleration)
        if system.status.missing_roll >= 0:
            return sample
        for row in range(len(system.reaction)):
            reactions[sample, row] = system.reaction[row]
        for k in range(accelerations.shape[1]):
            accelerations[sample, k] = storage.acceleration[k]
    return len(poses) - 1
