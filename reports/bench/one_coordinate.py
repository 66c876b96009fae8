"""The free four-bar in one coordinate as machine code: the least work with which its motion can be computed.

The loop is closed by intersecting two circles, so there are no joint forces and no projections. Lagrange's equation of
the crank's angle is M theta'' + M_theta theta'^2 / 2 = Q, and DOP853 integrates it with adaptive steps (Hairer, Norsett
and Wanner, part I, section II.6). The motion shares no function with the judge and with the scene's exact motion.
"""

from __future__ import annotations

import math
import time

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.integrate import DOP853

from reference.scenes.four_bar.scenes import FreeFourBar

Array = NDArray[np.float64]

STAGES, WEIGHTS, THIRD, FIFTH = DOP853.A.copy(), DOP853.B.copy(), DOP853.E3.copy(), DOP853.E5.copy()
MOST_STEPS = 1_000_000
# The order of the parameters that `_bars` and `_acceleration` read.
Numbers = tuple[float, float, float, float, float, float, float, float, float, float, float]


def parameters(scene: FreeFourBar) -> Numbers:
    """Lengths [m] of the crank, the coupler and the rocker, the ground vector [m], the branch, masses [kg], gravity."""
    lengths, ground = scene.four_bar.lengths, scene.ground
    return (*lengths, *ground, float(scene.branch), *scene.masses, *scene.gravity)


@njit(error_model="numpy")
def _bars(angle: float, p: Numbers) -> tuple[float, float, float, float, float, float]:
    """The vectors A -> B, B -> C and D -> C [m] at an angle [rad] of the crank."""
    l1, l2, l3, ground_x, ground_y, branch, _, _, _, _, _ = p
    x1, y1 = l1 * math.cos(angle), l1 * math.sin(angle)
    x, y = ground_x - x1, ground_y - y1  # B -> D
    square = x * x + y * y
    along = 0.5 * (l2 * l2 - l3 * l3 + square) / square
    across = branch * math.sqrt(l2 * l2 / square - along * along)
    x2, y2 = along * x - across * y, along * y + across * x
    return x1, y1, x2, y2, x2 - x, y2 - y


@njit(error_model="numpy")
def _acceleration(angle: float, rate: float, p: Numbers) -> float:
    """The crank's angular acceleration [rad/s^2]. Derivatives with respect to the crank's angle end in _1 and _2."""
    l1, l2, l3, _, _, _, m1, m2, m3, gravity_x, gravity_y = p
    x1, y1, x2, y2, x3, y3 = _bars(angle, p)
    dot12, cross12 = x1 * x2 + y1 * y2, x1 * y2 - y1 * x2
    dot13, cross13 = x1 * x3 + y1 * y3, x1 * y3 - y1 * x3
    dot23, cross23 = x2 * x3 + y2 * y3, x2 * y3 - y2 * x3
    beta_1, phi_1 = -cross13 / cross23, -cross12 / cross23
    beta_2 = (dot13 + beta_1 * beta_1 * dot23 - phi_1 * phi_1 * l3 * l3) / cross23
    phi_2 = (dot12 + beta_1 * beta_1 * l2 * l2 - phi_1 * phi_1 * dot23) / cross23
    inertia = m1 * l1 * l1 / 3 + m2 * (l1 * l1 + beta_1 * dot12 + beta_1 * beta_1 * l2 * l2 / 3)
    inertia += m3 * l3 * l3 / 3 * phi_1 * phi_1
    change = 0.5 * m2 * (beta_2 * dot12 + (beta_1 - beta_1 * beta_1) * cross12)
    change += m2 * l2 * l2 / 3 * beta_1 * beta_2 + m3 * l3 * l3 / 3 * phi_1 * phi_2
    moved_x = -(0.5 * m1 + m2) * y1 - 0.5 * m2 * beta_1 * y2 - 0.5 * m3 * phi_1 * y3
    moved_y = (0.5 * m1 + m2) * x1 + 0.5 * m2 * beta_1 * x2 + 0.5 * m3 * phi_1 * x3
    return (gravity_x * moved_x + gravity_y * moved_y - change * rate * rate) / inertia


@njit(error_model="numpy")
def _step(
    angle: float, rate: float, dt: float, p: Numbers, rates: Array, tolerance: float
) -> tuple[float, float, float]:
    """The state after a step of `dt`, and its error relative to the tolerance; fills rates[1:] (13, 2)."""
    for stage in range(1, 12):
        moved = turned = 0.0
        for earlier in range(stage):
            moved += STAGES[stage, earlier] * rates[earlier, 0]
            turned += STAGES[stage, earlier] * rates[earlier, 1]
        rates[stage, 0] = rate + dt * turned
        rates[stage, 1] = _acceleration(angle + dt * moved, rates[stage, 0], p)
    moved = turned = 0.0
    for stage in range(12):
        moved += WEIGHTS[stage] * rates[stage, 0]
        turned += WEIGHTS[stage] * rates[stage, 1]
    new_angle, new_rate = angle + dt * moved, rate + dt * turned
    rates[12, 0], rates[12, 1] = new_rate, _acceleration(new_angle, new_rate, p)
    threes = fives = 0.0
    for k in range(2):
        three = five = 0.0
        for stage in range(13):
            three += THIRD[stage] * rates[stage, k]
            five += FIFTH[stage] * rates[stage, k]
        size = max(abs(angle), abs(new_angle)) if k == 0 else max(abs(rate), abs(new_rate))
        scale = tolerance * (1.0 + size)
        threes += (three / scale) ** 2
        fives += (five / scale) ** 2
    both = fives + 0.01 * threes
    return new_angle, new_rate, dt * fives / math.sqrt(2 * both) if both > 0 else 0.0


@njit(error_model="numpy")
def _run(p: Numbers, tolerance: float, spacing: float, states: Array) -> int:
    """Fill states (samples + 1, 2) after the first one; return the number of steps, or -1 if they are too many."""
    rates = np.empty((13, 2))
    angle, rate = states[0, 0], states[0, 1]
    rates[0, 0], rates[0, 1] = rate, _acceleration(angle, rate, p)
    t, step, steps = 0.0, 0.1 * spacing, 0
    for sample in range(1, len(states)):
        end = spacing * sample
        while t < end:
            steps += 1
            if steps > MOST_STEPS:
                return -1
            is_last = 1.01 * step >= end - t
            dt = end - t if is_last else step
            new_angle, new_rate, error = _step(angle, rate, dt, p, rates, tolerance)
            if not error < 1:  # or NaN
                step = dt * (max(0.2, 0.9 * error**-0.125) if error < 1e300 else 0.2)
                continue
            grown = dt * (10.0 if error == 0 else min(10.0, 0.9 * error**-0.125))
            step = max(step, grown) if is_last else grown
            t = end if is_last else t + dt
            angle, rate = new_angle, new_rate
            rates[0, 0], rates[0, 1] = rates[12, 0], rates[12, 1]
        states[sample, 0], states[sample, 1] = angle, rate
    return steps


def motion(scene: FreeFourBar, tolerance: float, samples: int) -> tuple[Array, float]:
    """The angles of the three bars (samples + 1, 3) [rad] at equal intervals of the scene's duration, and the CPU time
    [s]. The angles are NaN if the tolerance is too small."""
    numbers, states = parameters(scene), np.empty((samples + 1, 2))
    states[0] = scene.start, scene.rate
    begin = time.process_time()
    steps = _run(numbers, tolerance, scene.duration / samples, states)
    seconds = time.process_time() - begin
    if steps < 0:
        return np.full((samples + 1, 3), np.nan), seconds
    bars = np.array([_bars(angle, numbers) for angle in states[:, 0]])
    angles = np.unwrap(np.arctan2(bars[:, 1::2], bars[:, ::2]), axis=0)
    start = scene.mechanism().pose[:, 2]
    angles += 2 * np.pi * np.round((start - angles[0]) / (2 * np.pi))
    angles[:, 0] = states[:, 0]
    return angles, seconds
