"""Dense output of DOP853, for samples within a step."""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined, merged
from engines.lagrange.compiled.steps import evaluate_stage, project


@merged
def fill_samples(system, storage, method, iterations, t, dt, end, spacing, sample, poses, twists):
    """Fill the samples after `sample` within a step that begins at t; return the last completed sample."""
    has_stages, pose, twist = False, storage.stage_pose, storage.stage_twist
    while sample < len(poses) - 1 and end >= spacing * (sample + 1):
        instant = spacing * (sample + 1)
        if instant == end:
            for k in range(poses.shape[1]):
                poses[sample + 1, k], twists[sample + 1, k] = storage.new_pose[k], storage.new_twist[k]
        else:
            if not has_stages:
                for stage in range(13, 16):
                    evaluate_stage(system, storage, method.stages, method.nodes, stage, t, dt)
                has_stages = True
            share = (instant - t) / dt
            interpolate(storage.pose, storage.new_pose, storage.velocities, method.dense, dt, share, pose)
            interpolate(storage.twist, storage.new_twist, storage.accelerations, method.dense, dt, share, twist)
            project(system, pose, twist, instant, iterations, storage.pose_unit)
            for k in range(poses.shape[1]):
                poses[sample + 1, k], twists[sample + 1, k] = pose[k], twist[k]
        if system.status.missing_roll >= 0:
            return sample
        for k in range(poses.shape[1]):
            if not math.isfinite(poses[sample + 1, k]):
                return sample
        sample += 1
    return sample


@inlined
def interpolate(old, new, rates, dense, dt, share, out):
    """Set `out` to the state at a share of the step from `old` to `new`, from the stages' rates (16, coordinates).

    The factors `share` and `remaining` alternate, as in scipy's Dop853DenseOutput.
    """
    remaining = 1 - share
    for k in range(len(out)):
        change, at_start, at_end = new[k] - old[k], dt * rates[0, k], dt * rates[12, k]
        high = 0.0
        for power in range(3, -1, -1):
            value = 0.0
            for stage in range(16):
                value += dense[power, stage] * rates[stage, k]
            high = (high + dt * value) * (share if power % 2 == 1 else remaining)
        value = ((high + 2 * change - (at_end + at_start)) * share + at_start - change) * remaining + change
        out[k] = old[k] + value * share
