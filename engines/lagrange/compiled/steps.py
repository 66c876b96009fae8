"""Accelerations, projections and steps of fixed size, for any mechanism and any explicit tableau."""

from __future__ import annotations

import math

from engines.lagrange import arrays as ix
from engines.lagrange.compiled.inner import inner
from engines.lagrange.compiled.rows import applied_accelerations, rows
from engines.lagrange.compiled.schur import ALL, HOLONOMIC, residual, row_times, solve

# Newton's correction is squared by the next one: after one this small, in parts of the mechanism, the next is lost in
# rounding. So is what a factor of the rows before it leaves of the slip, which is itself a small part of the speeds.
CLOSED = 1e-9


@inner
def accelerations(whole, real, cells, pose, twist, t, out):
    """Accelerations under all forces and the joints' reactions, to `out`; the rows and reactions there stay too."""
    applied_accelerations(whole, real, pose, twist, out)
    if whole[ix.ROWS] == 0:
        return
    rows(whole, real, cells, pose, twist, t)
    residual(whole, real, out, whole[ix.BIAS], whole[ix.RIGHT])
    if whole[ix.SOFT] > 0:
        for row in range(whole[ix.ROWS]):
            slip = row_times(whole, real, twist, row) - real[whole[ix.RATE] + row]
            value = real[whole[ix.DAMPING] + row] * slip + real[whole[ix.STIFFNESS] + row] * real[whole[ix.GAP] + row]
            real[whole[ix.RIGHT] + row] -= value + real[whole[ix.LACKING] + row] * real[whole[ix.BIAS] + row]
    whole[ix.WHICH] = ALL
    solve(whole, real, False, False)
    change, ground = whole[ix.CHANGE], whole[ix.COLUMNS] - 3
    for k in range(ground):
        real[out + k] += real[change + k]
    for k in range(ground, ground + 3):  # zero times a stage that was lost would stay there, and in all that follow
        real[out + k] = 0.0


@inner
def project_onto_joints(whole, real, cells, pose, twist, t, most):
    """Move a pose and a twist to the nearest, by mass, that the joints allow: Newton's method, `most` times at most.

    ix.UNCLOSED tells when that was not enough: a step ended too far from any pose of the joints, or in a singular one.
    """
    if whole[ix.ROWS] == 0:
        return
    holonomic = most if whole[ix.HOLONOMIC_ROWS] > 0 else 0
    which = HOLONOMIC if whole[ix.HOLONOMIC_ROWS] < whole[ix.ROWS] else ALL
    kept, columns, right, gaps = False, whole[ix.COLUMNS], whole[ix.RIGHT], whole[ix.GAP]
    change, units = whole[ix.CHANGE], whole[ix.POSE_UNIT]
    for iteration in range(holonomic + 1):  # the last one for the twist
        last, largest = iteration == holonomic, 0.0
        rows(whole, real, cells, pose, twist, t)
        if last:
            residual(whole, real, twist, whole[ix.RATE], right)
        else:
            for row in range(whole[ix.ROWS]):
                real[right + row] = -real[gaps + row]
        whole[ix.WHICH] = ALL if last else which
        solve(whole, real, True, last and kept)
        if last:
            for k in range(columns):
                real[twist + k] += real[change + k]
            return
        for k in range(columns):
            real[pose + k] += real[change + k]
            largest = max(largest, abs(real[change + k]) / real[units + k])
        if not largest > CLOSED:
            holonomic, kept = iteration + 1, which == ALL
        elif iteration + 1 == holonomic and math.isnan(real[whole[ix.STATUS] + ix.UNCLOSED]):
            real[whole[ix.STATUS] + ix.UNCLOSED] = t


@inner
def evaluate_stage(whole, real, cells, stages, nodes, stage, pose, twist, t, dt):
    """One stage of a tableau, from the state at these places: its velocity and its acceleration."""
    columns = whole[ix.COLUMNS]
    velocity, acceleration = whole[ix.VELOCITY] + stage * columns, whole[ix.ACCELERATION] + stage * columns
    place = whole[ix.STAGE_POSE]
    for k in range(columns):
        real[velocity + k], real[place + k] = real[twist + k], real[pose + k]
    for earlier in range(stage):
        share = stages[stage, earlier] * dt
        if share != 0:
            gain, rate = whole[ix.ACCELERATION] + earlier * columns, whole[ix.VELOCITY] + earlier * columns
            for k in range(columns):
                real[velocity + k] += share * real[gain + k]
                real[place + k] += share * real[rate + k]
    at = t + nodes[stage] * dt
    accelerations(whole, real, cells, place, velocity, at, acceleration)


@inner
def add_stages(whole, real, weights, dt, pose, twist):
    """Add to a state the weighted velocities and accelerations of the stages: their sum, which rounds a place once."""
    columns = whole[ix.COLUMNS]
    for k in range(columns):
        moved = gained = 0.0
        for stage in range(len(weights)):
            moved += weights[stage] * real[whole[ix.VELOCITY] + stage * columns + k]
            gained += weights[stage] * real[whole[ix.ACCELERATION] + stage * columns + k]
        real[pose + k] += dt * moved
        real[twist + k] += dt * gained


@inner
def fixed_steps(whole, real, cells, stages, weights, nodes, project, dt, every, begin, poses, twists):
    """Steps of `dt` from the sample `begin` on, `every` of them a sample, into rows of poses and twists.

    Without stages it is the semi-implicit Euler method. `project`: how often Newton's method may correct a step, 0 for
    no projection. Gives the last sample that is done: all of them, that before a pose that is not finite, or that
    before a contact that a table has no cell for (`WANTED_ROLL`).
    """
    columns, pose, twist, acceleration = whole[ix.COLUMNS], whole[ix.POSE], whole[ix.TWIST], whole[ix.ACCELERATION]
    for k in range(columns):
        real[pose + k], real[twist + k] = poses[begin, k], twists[begin, k]
    for sample in range(begin, len(poses) - 1):
        for step in range(every):
            t = (sample * every + step) * dt
            if len(nodes) == 0:
                accelerations(whole, real, cells, pose, twist, t, acceleration)
                for k in range(columns):
                    real[twist + k] += dt * real[acceleration + k]
                    real[pose + k] += dt * real[twist + k]
            else:
                for stage in range(len(nodes)):
                    evaluate_stage(whole, real, cells, stages, nodes, stage, pose, twist, t, dt)
                add_stages(whole, real, weights, dt, pose, twist)
            if project > 0:
                project_onto_joints(whole, real, cells, pose, twist, t + dt, project)
            if real[whole[ix.STATUS] + ix.WANTED_ROLL] >= 0:
                return sample
        for k in range(columns):
            if not math.isfinite(real[pose + k]):
                return sample
            poses[sample + 1, k], twists[sample + 1, k] = real[pose + k], real[twist + k]
    return len(poses) - 1
