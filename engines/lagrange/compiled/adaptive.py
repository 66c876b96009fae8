"""DOP853 with adaptive steps, each projected onto the joints.

Step control and the test for stiffness follow Hairer, Norsett and Wanner's program (part I, section II.6), as in scipy.
Errors are in units of the mechanism's length and speed.
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined, inner, merged
from engines.lagrange.compiled.dense import fill_samples
from engines.lagrange.compiled.steps import accelerate, add_stages, copy_state, evaluate_stage, project, store_stage

# Safety factor on the step at which the error estimate is equal to the tolerance.
STEP_SAFETY = 0.9
# The smallest and the largest ratio of successive steps.
LEAST_STEP_FACTOR, LARGEST_STEP_FACTOR = 0.2, 10.0
# Largest number of accepted and rejected steps between two samples, which take a second in total for a few bodies.
MOST_TRIES = 20_000
# A run may have MOST_TRIES accepted steps and additional steps for each completed sample.
FURTHER_STEPS_PER_SAMPLE = 1_000
# The relative rounding of double precision.
DOUBLE_EPSILON = 2.2e-16
# Largest rotation [rad] between the start of a step and a stage, for a contact. A step with a larger rotation is too
# long.
FARTHEST_STAGE = 1.0
# STIFF_PRODUCT is the step times the largest eigenvalue at the stability limit. After STIFF_STEPS consecutive steps at
# the limit, the motion counts as stiff.
STIFF_PRODUCT, STIFF_STEPS = 6.1, 15


@inner
def adaptive_steps(system, storage, method, samples, begin, iterations, spacing, tolerance):
    """Fill poses and twists (samples, 3 bodies), `spacing` apart, after `begin`; return the last completed sample."""
    poses, twists = samples.poses, samples.twists
    status, last = system.status, len(poses) - 1
    copy_state(poses[begin], twists[begin], storage.pose, storage.twist)
    t, sample, tries, stiff, step = spacing * begin, begin, 0, 0, -1.0
    was_rejected = False
    while sample < last:
        if step < 0:  # this also evaluates the first stage
            step = first_step(system, storage, t, tolerance, min(spacing * 10, spacing * last - t))
        shortest = 16 * DOUBLE_EPSILON * max(abs(t), spacing)
        tries += 1
        steps_allowed = MOST_TRIES + FURTHER_STEPS_PER_SAMPLE * sample
        if not step > shortest or tries > MOST_TRIES or status.accepted_steps > steps_allowed:
            status.stopped_at = t
            return sample
        dt, end = step_length(step, t, spacing, sample, last)
        evaluate_stages(system, storage, method, t, dt)
        if is_astray(system, storage.pose):
            step, was_rejected = LEAST_STEP_FACTOR * dt, True
            continue
        copy_state(storage.pose, storage.twist, storage.new_pose, storage.new_twist)
        add_stages(storage, method.weights, dt, storage.new_pose, storage.new_twist)
        if status.missing_roll >= 0:
            return sample
        error = dt * error_rate(storage, method, tolerance)
        if not error < 1:
            step = dt * (max(LEAST_STEP_FACTOR, STEP_SAFETY * error**-0.125) if error < 1e300 else LEAST_STEP_FACTOR)
            was_rejected = True
            continue
        factor = LARGEST_STEP_FACTOR if error == 0 else min(LARGEST_STEP_FACTOR, STEP_SAFETY * error**-0.125)
        step = dt * (min(1.0, factor) if was_rejected else factor)
        was_rejected = False
        status.rounding += step_rounding(storage, status.smallest_pivot)
        finish_step(system, storage, iterations, end)
        if status.missing_roll >= 0:
            return sample
        stiff = stiff + 1 if is_stiff(storage, dt) else 0
        if stiff >= STIFF_STEPS and math.isnan(status.stiff_from):
            status.stiff_from = t
        status.accepted_steps += 1
        done = fill_samples(system, storage, method, iterations, t, dt, end, spacing, sample, poses, twists)
        tries, sample = (0 if done > sample else tries), done
        if sample < last and end >= spacing * (sample + 1):  # a sample of this step is not finite
            return sample
        t = end
        advance(storage)
    return sample


@merged
def step_length(step, t, spacing, sample, last):
    """The length of a step and the time at its end.

    The target is the next sample if the step is below twice the spacing of samples; otherwise it is the last sample. If
    the step is more than half of the remaining time, but not all of it, two equal steps replace it.
    """
    target = spacing * (sample + 1) if step < 2 * spacing else spacing * last
    remaining = target - t
    dt = remaining if 1.01 * step >= remaining else (0.5 * remaining if 2 * step > remaining else step)
    return dt, (target if dt == remaining else t + dt)


@merged
def evaluate_stages(system, storage, method, t, dt):
    """Evaluate stages 2 to 12, or end at a contact without a cell; stage 1 is the last stage of the previous step."""
    system.status.smallest_pivot = 1.0
    for stage in range(1, 12):
        evaluate_stage(system, storage, method.stages, method.nodes, stage, t, dt)
        if system.status.missing_roll >= 0:
            return


@merged
def finish_step(system, storage, iterations, end):
    pose, twist = storage.new_pose, storage.new_twist
    project(system, pose, twist, end, iterations, storage.pose_unit)
    accelerate(system, pose, twist, end, storage.acceleration)
    store_stage(storage, 12, twist)


@merged
def advance(storage):
    """Copy the final state and the last stage of a step to the start of the next step."""
    copy_state(storage.new_pose, storage.new_twist, storage.pose, storage.twist)
    for k in range(len(storage.pose)):
        storage.velocities[0, k], storage.accelerations[0, k] = storage.velocities[12, k], storage.accelerations[12, k]


@merged
def step_rounding(storage, smallest_pivot):
    """The largest rounding error of a speed in a step, in units of the mechanism's speed."""
    moved = 0.0
    for k in range(len(storage.pose)):
        moved = max(moved, abs(storage.new_twist[k] - storage.twist[k]) / storage.twist_unit[k])
    return moved * DOUBLE_EPSILON / math.sqrt(max(smallest_pivot, DOUBLE_EPSILON))


@merged
def is_stiff(storage, dt):
    """Whether the step is at the stability limit; the last two stages give an estimate of the largest eigenvalue."""
    velocities, accelerations = storage.velocities, storage.accelerations
    rates = states = 0.0
    for k in range(len(storage.pose)):
        unit, speed = storage.pose_unit[k], storage.twist_unit[k]
        rates += square((velocities[12, k] - velocities[11, k]) / unit)
        rates += square((accelerations[12, k] - accelerations[11, k]) / speed)
        states += square((storage.new_pose[k] - storage.stage_pose[k]) / unit)
        states += square((storage.new_twist[k] - velocities[11, k]) / speed)
    return dt * dt * rates > STIFF_PRODUCT * STIFF_PRODUCT * states and states > 0


@inlined
def is_astray(system, pose):
    """Whether a stage needed a contact that is too far from `pose`; if so, the status is reset."""
    status = system.status
    if status.missing_roll < 0:
        return False
    roll = system.rolls[status.missing_roll]
    rotation = pose[3 * roll.second + 2] - pose[3 * roll.first + 2]
    if abs(status.missing_angle - rotation) <= FARTHEST_STAGE:
        return False
    status.missing_roll = -1
    return True


@inlined
def square(value):
    return value * value


@inlined
def error_norm(storage, pose, twist, tolerance):
    """The root mean square of a pose and a twist, relative to the tolerated error at the current state."""
    total, moving = 0.0, len(storage.pose) - 3
    for k in range(moving):
        pose_error = pose[k] / (tolerance * (storage.pose_unit[k] + abs(storage.pose[k])))
        twist_error = twist[k] / (tolerance * (storage.twist_unit[k] + abs(storage.twist[k])))
        total += square(pose_error) + square(twist_error)
    return math.sqrt(total / (2 * moving))


@merged
def first_step(system, storage, t, tolerance, longest):
    """Evaluate the first stage, and return the first step by Hairer, Norsett and Wanner's rule."""
    pose, twist, acceleration = storage.pose, storage.twist, storage.acceleration
    new_pose, new_twist = storage.new_pose, storage.new_twist
    accelerate(system, pose, twist, t, acceleration)
    store_stage(storage, 0, twist)
    states = error_norm(storage, pose, twist, tolerance)
    rates = error_norm(storage, twist, acceleration, tolerance)
    guess = min(longest, 1e-6 * longest if states < 1e-5 or rates < 1e-5 else 0.01 * states / rates)
    for k in range(len(pose)):
        new_pose[k] = pose[k] + guess * twist[k]
        new_twist[k] = twist[k] + guess * acceleration[k]
    accelerate(system, new_pose, new_twist, t + guess, acceleration)
    if is_astray(system, pose):
        return 1e-3 * guess
    for k in range(len(pose)):
        new_pose[k] = (new_twist[k] - twist[k]) / guess
        new_twist[k] = (acceleration[k] - storage.accelerations[0, k]) / guess
    largest = max(rates, error_norm(storage, new_pose, new_twist, tolerance))
    step = max(1e-6 * longest, 1e-3 * guess) if largest <= 1e-15 else (0.01 / largest) ** 0.125
    return min(longest, 100 * guess, step)


@merged
def error_rate(storage, method, tolerance):
    """The error estimate of a step divided by the step, relative to the tolerated error."""
    threes = fives = 0.0
    moving = len(storage.pose) - 3
    for k in range(moving):
        scale = tolerance * (storage.pose_unit[k] + max(abs(storage.pose[k]), abs(storage.new_pose[k])))
        third, fifth = stage_errors(storage.velocities, method, k)
        threes += square(third / scale)
        fives += square(fifth / scale)
    for k in range(moving):
        scale = tolerance * (storage.twist_unit[k] + max(abs(storage.twist[k]), abs(storage.new_twist[k])))
        third, fifth = stage_errors(storage.accelerations, method, k)
        threes += square(third / scale)
        fives += square(fifth / scale)
    both = fives + 0.01 * threes
    return fives / math.sqrt(both * 2 * moving) if both != 0 else 0.0


@inlined
def stage_errors(rates, method, k):
    """The error estimates of order 3 and 5 of a coordinate, divided by the step."""
    third = fifth = 0.0
    for stage in range(12):
        third += method.third[stage] * rates[stage, k]
        fifth += method.fifth[stage] * rates[stage, k]
    return third, fifth
