"""DOP853 with steps of its own choice, each projected onto the joints, dense output at samples; and `run` of all tasks.

The control of the step is that of Hairer, Norsett and Wanner's program (part I, section II.6), as in scipy; so is their
test for stiffness. Errors are measured in parts of the mechanism's own length and speed.
"""

from __future__ import annotations

import math

from numba import njit, types

from engines.lagrange import arrays as ix
from engines.lagrange.compiled.inner import inner, straight
from engines.lagrange.compiled.rows import rotation
from engines.lagrange.compiled.steps import (
    accelerations,
    add_stages,
    evaluate_stage,
    fixed_steps,
    project_onto_joints,
)

SAFETY, LEAST_FACTOR, LARGEST_FACTOR = 0.9, 0.2, 10.0
MOST_STEPS = 20_000  # accepted or not, between two samples; a second of stepping for a few bodies
EACH_SAMPLE = 1_000  # accepted ones that each sample adds to these: a run of many samples comes to its end too
ROUNDING = 2.2e-16
FARTHEST_STAGE = 1.0  # rad from the step's begin: other radii touch there, so that no such step holds a tolerance
STIFF_PRODUCT, STIFF_STEPS = 6.1, 15  # step times largest eigenvalue at the border of stability, so often met


@inner
def adaptive_steps(
    whole, real, cells, stages, weights, nodes, third, fifth, dense, project, tolerance, spacing, begin, poses, twists
):
    """From the sample `begin` on, samples `spacing` apart into rows of poses and twists; gives the last one done."""
    columns, pose, twist = whole[ix.COLUMNS], whole[ix.POSE], whole[ix.TWIST]
    new, fast = whole[ix.NEW_POSE], whole[ix.NEW_TWIST]
    velocity, acceleration, status = whole[ix.VELOCITY], whole[ix.ACCELERATION], whole[ix.STATUS]
    end = spacing * (len(poses) - 1)
    for k in range(columns):
        real[pose + k], real[twist + k] = poses[begin, k], twists[begin, k]
    t, sample, tries, rejected, stiff, step = spacing * begin, begin, 0, False, 0, -1.0
    while sample < len(poses) - 1:
        if step < 0:  # the first step, and its first stage
            step = _first_step(whole, real, cells, t, tolerance, min(spacing * 10, end - t))
        least = 16 * ROUNDING * max(abs(t), spacing)
        tries += 1
        if not step > least or tries > MOST_STEPS or real[status + ix.STEPS] > MOST_STEPS + EACH_SAMPLE * sample:
            real[status + ix.STOPPED] = t
            return sample
        # Steps about as long as samples are apart end there, longer ones where the run does; a crumb is shared out.
        target = spacing * (sample + 1) if step < 2 * spacing else end
        rest = target - t
        dt = rest if 1.01 * step >= rest else (0.5 * rest if 2 * step > rest else step)
        goal = target if dt == rest else t + dt
        real[status + ix.SMALLEST] = 1.0
        for stage in range(1, 12):
            evaluate_stage(whole, real, cells, stages, nodes, stage, pose, twist, t, dt)
            if real[status + ix.WANTED_ROLL] >= 0:
                break
        if _went_astray(whole, real, pose):
            step, rejected = LEAST_FACTOR * dt, True
            continue
        for k in range(columns):
            real[new + k], real[fast + k] = real[pose + k], real[twist + k]
        add_stages(whole, real, weights, dt, new, fast)
        error = dt * _error(whole, real, third, fifth, tolerance)
        if real[status + ix.WANTED_ROLL] >= 0:
            return sample
        if not error < 1:
            step = dt * (max(LEAST_FACTOR, SAFETY * error**-0.125) if error < 1e300 else LEAST_FACTOR)
            rejected = True
            continue
        factor = LARGEST_FACTOR if error == 0 else min(LARGEST_FACTOR, SAFETY * error**-0.125)
        step = dt * (min(1.0, factor) if rejected else factor)
        rejected = False
        real[status + ix.ROUNDED] += _rounding(whole, real)
        project_onto_joints(whole, real, cells, new, fast, goal, project)
        last = 12 * columns
        for k in range(columns):
            real[velocity + last + k] = real[fast + k]
        accelerations(whole, real, cells, new, fast, goal, acceleration + last)
        if real[status + ix.WANTED_ROLL] >= 0:
            return sample
        stiff = stiff + 1 if _is_stiff(whole, real, dt) else 0
        if stiff >= STIFF_STEPS and math.isnan(real[status + ix.STIFF]):
            real[status + ix.STIFF] = t
        real[status + ix.STEPS] += 1
        done = _fill_samples(
            whole, real, cells, stages, nodes, dense, project, t, dt, goal, spacing, sample, poses, twists
        )
        tries, sample = (0 if done > sample else tries), done
        if sample < len(poses) - 1 and goal >= spacing * (sample + 1):  # one that is due is lost
            return sample
        t = goal
        for k in range(columns):
            real[pose + k], real[twist + k] = real[new + k], real[fast + k]
            real[velocity + k], real[acceleration + k] = real[velocity + last + k], real[acceleration + last + k]
    return sample


@inner
def _rounding(whole, real):
    """How much rounding alone may have changed speeds in a step, in parts of the mechanism's own."""
    moved = 0.0
    for k in range(whole[ix.COLUMNS]):
        change = abs(real[whole[ix.NEW_TWIST] + k] - real[whole[ix.TWIST] + k])
        moved = max(moved, change / real[whole[ix.TWIST_UNIT] + k])
    return moved * ROUNDING / math.sqrt(max(real[whole[ix.STATUS] + ix.SMALLEST], ROUNDING))


@inner
def _is_stiff(whole, real, dt):
    """Whether step times largest eigenvalue, from the last two stages, is at the border of stability."""
    columns, velocity, acceleration = whole[ix.COLUMNS], whole[ix.VELOCITY], whole[ix.ACCELERATION]
    last, ahead, rates, states = 12 * columns, 11 * columns, 0.0, 0.0
    for k in range(columns):
        unit, faster = real[whole[ix.POSE_UNIT] + k], real[whole[ix.TWIST_UNIT] + k]
        rates += _square((real[velocity + last + k] - real[velocity + ahead + k]) / unit)
        rates += _square((real[acceleration + last + k] - real[acceleration + ahead + k]) / faster)
        states += _square((real[whole[ix.NEW_POSE] + k] - real[whole[ix.STAGE_POSE] + k]) / unit)
        states += _square((real[whole[ix.NEW_TWIST] + k] - real[velocity + ahead + k]) / faster)
    return dt * dt * rates > STIFF_PRODUCT * STIFF_PRODUCT * states and states > 0


@inner
def _fill_samples(whole, real, cells, stages, nodes, dense, project, t, dt, goal, spacing, sample, poses, twists):
    """Fill the samples after `sample` that a step from t to `goal` passes; gives the last one that is done."""
    ready, at, fast = False, whole[ix.STAGE_POSE], whole[ix.STAGE_TWIST]
    while sample < len(poses) - 1 and goal >= spacing * (sample + 1):
        instant = spacing * (sample + 1)
        if instant == goal:
            for k in range(whole[ix.COLUMNS]):
                poses[sample + 1, k] = real[whole[ix.NEW_POSE] + k]
                twists[sample + 1, k] = real[whole[ix.NEW_TWIST] + k]
        else:
            if not ready:
                for stage in range(13, 16):
                    evaluate_stage(whole, real, cells, stages, nodes, stage, whole[ix.POSE], whole[ix.TWIST], t, dt)
                ready = True
            _between(whole, real, dense, dt, (instant - t) / dt)
            project_onto_joints(whole, real, cells, at, fast, instant, project)
            for k in range(whole[ix.COLUMNS]):
                poses[sample + 1, k], twists[sample + 1, k] = real[at + k], real[fast + k]
        if real[whole[ix.STATUS] + ix.WANTED_ROLL] >= 0:
            return sample
        for k in range(whole[ix.COLUMNS]):
            if not math.isfinite(poses[sample + 1, k]):
                return sample
        sample += 1
    return sample


@inner
def _went_astray(whole, real, pose):
    """Whether a stage asked for a contact so far from that in a pose that it is no part of the motion; no table is."""
    status = whole[ix.STATUS]
    wanted = real[status + ix.WANTED_ROLL]
    if wanted < 0 or abs(real[status + ix.WANTED_ANGLE] - rotation(whole, real, wanted, pose)) <= FARTHEST_STAGE:
        return False
    real[status + ix.WANTED_ROLL] = -1.0
    return True


@inner
def _square(value):
    return value * value


@inner
def _size(whole, real, pose, twist, state, fast, tolerance):
    """The mean square of a pair of vectors, in parts of the error allowed at a state."""
    total = 0.0
    for k in range(whole[ix.COLUMNS] - 3):
        unit = tolerance * (real[whole[ix.POSE_UNIT] + k] + abs(real[state + k]))
        faster = tolerance * (real[whole[ix.TWIST_UNIT] + k] + abs(real[fast + k]))
        total += _square(real[pose + k] / unit) + _square(real[twist + k] / faster)
    return math.sqrt(total / (2 * (whole[ix.COLUMNS] - 3)))


@inner
def _first_step(whole, real, cells, t, tolerance, longest):
    """Hairer, Norsett and Wanner's guess, and the stage at the start."""
    columns, pose, twist = whole[ix.COLUMNS], whole[ix.POSE], whole[ix.TWIST]
    new, fast = whole[ix.NEW_POSE], whole[ix.NEW_TWIST]
    velocity, acceleration = whole[ix.VELOCITY], whole[ix.ACCELERATION]
    for k in range(columns):
        real[velocity + k] = real[twist + k]
    accelerations(whole, real, cells, pose, twist, t, acceleration)
    states = _size(whole, real, pose, twist, pose, twist, tolerance)
    rates = _size(whole, real, velocity, acceleration, pose, twist, tolerance)
    guess = min(longest, 1e-6 * longest if states < 1e-5 or rates < 1e-5 else 0.01 * states / rates)
    for k in range(columns):
        real[new + k] = real[pose + k] + guess * real[velocity + k]
        real[fast + k] = real[twist + k] + guess * real[acceleration + k]
    accelerations(whole, real, cells, new, fast, t + guess, acceleration + columns)
    if _went_astray(whole, real, pose):
        return 1e-3 * guess
    for k in range(columns):
        real[new + k] = (real[fast + k] - real[twist + k]) / guess
        real[fast + k] = (real[acceleration + columns + k] - real[acceleration + k]) / guess
    bend = _size(whole, real, new, fast, pose, twist, tolerance)
    largest = max(rates, bend)
    step = max(1e-6 * longest, 1e-3 * guess) if largest <= 1e-15 else (0.01 / largest) ** 0.125
    return min(longest, 100 * guess, step)


@inner
def _error(whole, real, third, fifth, tolerance):
    """The estimate of a step's error in parts of what is allowed, for a step of one second."""
    columns, threes, fives = whole[ix.COLUMNS], 0.0, 0.0
    for part in range(2):
        stage, old = (whole[ix.VELOCITY], whole[ix.POSE]) if part == 0 else (whole[ix.ACCELERATION], whole[ix.TWIST])
        new, unit = (
            (whole[ix.NEW_POSE], whole[ix.POSE_UNIT]) if part == 0 else (whole[ix.NEW_TWIST], whole[ix.TWIST_UNIT])
        )
        for k in range(columns - 3):
            three = five = 0.0
            for i in range(12):
                three += third[i] * real[stage + i * columns + k]
                five += fifth[i] * real[stage + i * columns + k]
            scale = tolerance * (real[unit + k] + max(abs(real[old + k]), abs(real[new + k])))
            threes += _square(three / scale)
            fives += _square(five / scale)
    both = fives + 0.01 * threes
    return fives / math.sqrt(both * 2 * (columns - 3)) if both != 0 else 0.0


@inner
def _between(whole, real, dense, dt, part):
    """Dense output at a part of the step, to where a stage's pose and twist stand."""
    columns = whole[ix.COLUMNS]
    rest = 1 - part
    for second in range(2):
        stage, old = (whole[ix.ACCELERATION], whole[ix.TWIST]) if second else (whole[ix.VELOCITY], whole[ix.POSE])
        new = whole[ix.NEW_TWIST] if second else whole[ix.NEW_POSE]
        for k in range(columns):
            change, start = real[new + k] - real[old + k], dt * real[stage + k]
            end = dt * real[stage + 12 * columns + k]
            high = 0.0
            for power in range(3, -1, -1):
                value = 0.0
                for i in range(16):
                    value += dense[power, i] * real[stage + i * columns + k]
                high = (high + dt * value) * (part if power % 2 == 1 else rest)
            # F[3] at power 0: factors alternate, 1 - part where scipy's index counted from the top is odd.
            value = ((high + 2 * change - (end + start)) * part + start - change) * rest + change
            real[(whole[ix.STAGE_TWIST] if second else whole[ix.STAGE_POSE]) + k] = real[old + k] + value * part


# The one function that Python calls, compiled when this module is imported, or read from the cache. All tasks are in
# it, because what several compiled functions share is compiled anew for each of them.
WHOLE, CELLS = types.int64[::1], types.complex128[:, ::1]
LIST, TABLE = types.float64[::1], types.float64[:, ::1]
SIGNATURE = types.int64(
    *(types.int64, WHOLE, LIST, CELLS, TABLE, LIST, LIST, LIST, LIST, TABLE),
    *(types.int64, types.float64, types.float64, types.int64, types.int64, TABLE, TABLE, TABLE),
)


def run(
    task, whole, real, cells, stages, weights, nodes, third, fifth, dense,
    project, tolerance, dt, every, begin, poses, twists, out,
):  # fmt: skip
    """MARCH: `fixed_steps`. ix.CONTROL: `adaptive_steps`, `dt` between samples. REACT: fill `out` (samples, rows) and
    `out`'s last columns with the reactions and accelerations at samples `dt` apart."""
    whole, real = straight(whole), straight(real)
    if task == ix.MARCH:
        return fixed_steps(whole, real, cells, stages, weights, nodes, project, dt, every, begin, poses, twists)
    if task == ix.CONTROL:
        return adaptive_steps(
            whole,
            real,
            cells,
            stages,
            weights,
            nodes,
            third,
            fifth,
            dense,
            project,
            tolerance,
            dt,
            begin,
            poses,
            twists,
        )
    columns, rows, pose, twist, acceleration = (
        whole[ix.COLUMNS], whole[ix.ROWS], whole[ix.POSE], whole[ix.TWIST], whole[ix.ACCELERATION]
    )  # fmt: skip
    for sample in range(begin, len(poses)):
        for k in range(columns):
            real[pose + k], real[twist + k] = poses[sample, k], twists[sample, k]
        accelerations(whole, real, cells, pose, twist, sample * dt, acceleration)
        if real[whole[ix.STATUS] + ix.WANTED_ROLL] >= 0:
            return sample
        for row in range(rows):
            out[sample, row] = real[whole[ix.REACTION] + row]
        for k in range(columns):
            out[sample, rows + k] = real[acceleration + k]
    return len(poses) - 1


run = njit(SIGNATURE, cache=True, nogil=True, error_model="numpy")(run)
