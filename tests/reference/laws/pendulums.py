"""Pendulums in fifty digits: Jacobi's functions for one link, Lagrange's equations for several."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np

from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.link import Pendulum
from tests.reference.laws.law import Law, Outside, angle, decades
from tests.reference.laws.linkages import solved


def swung(frequency, start, rate, t):
    """Angle, rate and acceleration of a pendulum: swinging or whirling (Whittaker, Analytical Dynamics, 44)."""
    sine, half_rate = mp.sin(start / 2), rate / (2 * frequency)
    square = sine**2 + half_rate**2
    if square == 1 or square == 0:
        raise Outside
    modulus, back = mp.sqrt(square), mp.sign(rate) or 1
    if square < 1:
        begin = mp.ellipf(mp.asin(sine / modulus), square)
        if half_rate < 0:  # on its way back; starts are within half a turn of the bottom
            begin = 2 * mp.ellipk(square) - begin
        u = frequency * t + begin
        sn, cn = mp.ellipfun("sn", u, m=square), mp.ellipfun("cn", u, m=square)
        now = 2 * mp.asin(modulus * sn)
        return [now, 2 * frequency * modulus * cn, -(frequency**2) * mp.sin(now)]
    begin = back * mp.ellipf(start / 2, 1 / square)
    u = modulus * frequency * t + begin
    sn, cn, dn = (mp.ellipfun(kind, u, m=1 / square) for kind in ("sn", "cn", "dn"))
    now = 2 * back * mp.atan2(sn, cn)
    return [now, 2 * frequency * modulus * back * dn, -(frequency**2) * mp.sin(now)]


def swing(frequency, start, rate, t):
    """Of angle, rate and acceleration: the largest of the motion, in all its time."""
    modulus = mp.hypot(mp.sin(start / 2), rate / (2 * frequency))
    return [2 * min(modulus, mp.pi), 2 * frequency * modulus, frequency**2 * min(2 * modulus, 1)]


def drawn_pendulum(rng: np.random.Generator) -> tuple[float, ...]:
    """Half of the starts near the separatrix, or near the top or the bottom; up to a hundred radians of time."""
    frequency, start = decades(rng), angle(rng, (0.0, math.pi, -math.pi))
    start = math.remainder(start, 2 * math.pi)
    rate = 2 * frequency * float(rng.normal())
    if rng.random() < 0.3:
        rate = 2 * frequency * math.cos(start / 2) * (1 + float(rng.choice([-1, 1])) * decades(rng, -12, 0))
    if rng.random() < 0.1:
        rate = 0.0
    return frequency, start, rate, float(rng.uniform(0, 1)) * decades(rng, -9, 2) / frequency


def links(count: int) -> Law:
    def exact(*numbers):
        lengths, masses = numbers[:count], numbers[count : 2 * count]
        angles, rates, gravity = numbers[2 * count : 3 * count], numbers[3 * count : 4 * count], numbers[-1]
        below = [mp.fsum(masses[i + 1 :]) for i in range(count)]
        lever = [lengths[i] * (masses[i] / 2 + below[i]) for i in range(count)]

        def weight(i, j):
            if i == j:
                return lengths[i] ** 2 * (masses[i] / 3 + below[i])
            return lengths[min(i, j)] * lever[max(i, j)]

        rows = [[weight(i, j) * mp.cos(angles[i] - angles[j]) for j in range(count)] for i in range(count)]
        right = [
            -mp.fsum(weight(i, j) * mp.sin(angles[i] - angles[j]) * rates[j] ** 2 for j in range(count))
            - gravity * lever[i] * mp.sin(angles[i])
            for i in range(count)
        ]
        return solved(rows, right)

    def ours(*numbers):
        chain = Chain(tuple(numbers[:count]), tuple(numbers[count : 2 * count]), numbers[-1])
        return chain.accelerations(numbers[2 * count : 3 * count], numbers[3 * count : 4 * count])

    def draw(rng: np.random.Generator) -> tuple[float, ...]:
        length, weight, clock = decades(rng), decades(rng), decades(rng)
        return (
            *(length * decades(rng, -1, 1) for _ in range(count)),
            *(weight * decades(rng, -2, 2) for _ in range(count)),
            *(angle(rng) for _ in range(count)),
            *(float(rng.normal()) / clock for _ in range(count)),
            length / clock**2,
        )

    def size(*numbers):
        """Where a link whirls, its forces have the size of its centripetal acceleration, not of what turns it."""
        return [max(abs(value), rate**2) for value, rate in zip(exact(*numbers), numbers[3 * count : -1], strict=True)]

    return Law(f"chain of {count}", draw, ours, exact, vectors=(slice(0, count),), size=size)


def side_by_side(length, mass, gravity, speed, t):
    """Two four-bars' cranks: one pendulum that starts at its top, of which the scene gives the nearest double."""
    frequency = mp.sqrt(3 * 7 * gravity / (2 * 9 * length))
    turned, rate, _ = swung(frequency, mp.mpf(math.pi), -speed / length, t)
    return [turned, rate]


def our_side_by_side(length, mass, gravity, speed, t):
    scene = NFourBar(length=length, mass=mass, gravity=gravity, speed=speed, duration=max(t, 1e-300))
    motion = scene.motion([t])
    return [motion.pose[0, 0, 2] + math.pi / 2, motion.twist[0, 0, 2]]


def drawn_side_by_side(rng: np.random.Generator) -> tuple[float, ...]:
    length, clock = decades(rng), decades(rng)
    return (
        *(length, decades(rng), length / clock**2 * decades(rng, -1, 1), length / clock * decades(rng, -3, 3)),
        clock * float(rng.uniform(0, 10)),
    )


PENDULUMS = (
    Law("pendulum", drawn_pendulum, lambda f, a, r, t: Pendulum(f, a, r).motion(t), swung, angles=(0,), size=swing),
    *(links(count) for count in (1, 2, 4)),
    Law("four-bars side by side", drawn_side_by_side, our_side_by_side, side_by_side, angles=(0,)),
)
