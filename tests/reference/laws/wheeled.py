"""Towed wheels, skates and pinned bodies in fifty digits, each from its equation of motion solved in closed form."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np

from reference.scenes.skates.pinned_body import PinnedBody
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.skates.slopes import SkateOnSlope
from reference.scenes.wheels.trailers import Tow
from tests.reference.laws.law import DIGITS, Law, Outside, angle, decades
from tests.reference.laws.pendulums import swung


def tow(length: Any, start: Any, radius: Any, way: Any) -> list[Any]:
    """The drawbar's angle and the wheel's place, by the exponential of the 2 by 2 system."""
    curvature = 1 / radius
    root = mp.sqrt(mp.mpc(1 - (length * curvature) ** 2))
    if root == 0:
        raise Outside
    size = root * way / (2 * length)
    even, odd = mp.cosh(size), mp.sinh(size) / root  # sinh(m s) / (2 L m)
    p, q = mp.sin(start / 2), mp.cos(start / 2)
    across = (even * p - odd * (p + length * curvature * q)).real
    along = (even * q + odd * (length * curvature * p + q)).real
    turned = 2 * mp.atan2(across, along)
    heading = curvature * way + turned
    chord = 2 * radius * mp.sin(curvature * way / 2) * mp.expj(curvature * way / 2)
    wheel = chord - length * mp.expj(heading)
    return [turned, wheel.real, wheel.imag]


def our_tow(length: float, start: float, radius: float, way: float) -> list[Any]:
    made = Tow(length, start, radius)
    return [made.relative_angle(way), *made.wheel(way)]


def tow_sizes(length: Any, start: Any, radius: Any, way: Any) -> list[Any]:
    """The angle is what is left of the start's, and the wheel a drawbar away from the hitch."""
    turned, x, y = tow(length, start, radius, way)
    place = max(abs(mp.mpc(x, y)), length)
    return [max(abs(turned), abs(start)), place, place]


def drawn_tow(rng: np.random.Generator) -> tuple[float, ...]:
    """Radii around the length, and far from it; starts next to both equilibria."""
    length = decades(rng)
    share = 1 + float(rng.choice([-1, 1])) * decades(rng, -12, -0.1) if rng.random() < 0.5 else decades(rng, -2, 4)
    radius = length * share * float(rng.choice([-1, 1]))
    start = math.remainder(angle(rng, (0.0, math.pi)), 2 * math.pi)
    if abs(share) > 1 and rng.random() < 0.3:  # next to where it settles, or to where it is pushed from
        settled = -math.asin(length / radius)
        start = (settled if rng.random() < 0.5 else math.pi - settled) + float(rng.normal()) * decades(rng, -9, 0)
        start = math.remainder(start, 2 * math.pi)
    return length, start, radius, length * float(rng.uniform(-1, 1)) * decades(rng, -9, 1.3)


def sleigh(mass: Any, inertia: Any, offset: Any, speed: Any, turning: Any, t: Any) -> list[Any]:
    """Speed, turning rate, heading and the blade's force, by Gudermann's function."""
    arm = mp.sqrt(inertia / mass + offset**2)
    top = mp.hypot(speed, arm * turning)
    begin = mp.asinh(speed / (arm * abs(turning)))
    phase = begin + offset * top / arm**2 * t
    u, w = top * mp.tanh(phase), mp.sign(turning) * top / arm / mp.cosh(phase)
    heading = mp.sign(turning) * arm / offset * 2 * (mp.atan(mp.tanh(phase / 2)) - mp.atan(mp.tanh(begin / 2)))
    force = mass * (w * u - offset * (mass * offset * u * w / (inertia + mass * offset**2)))
    return [u, w, heading, force]


def our_sleigh(mass: float, inertia: float, offset: float, speed: float, turning: float, t: float) -> list[Any]:
    scene = ChaplyginSleigh(mass, inertia, offset, speed, turning, duration=max(t, 1e-300))
    return [*scene.rates(t), scene.heading(t), float(np.ravel(scene.lateral_force(t))[0])]


def drawn_sleigh(rng: np.random.Generator) -> tuple[float, ...]:
    length, clock, mass = decades(rng), decades(rng), decades(rng)
    offset = length * float(rng.choice([-1, 1])) * decades(rng, -3, 1)
    speed, turning = (float(rng.normal()) * decades(rng, -6, 1) for _ in range(2))
    return (
        *(mass, mass * length**2 * decades(rng, -3, 1), offset, speed * length / clock, turning / clock),
        clock * float(rng.uniform(0, 1)) * decades(rng, -6, 1.5),
    )


def slope(mass: Any, gravity: Any, heading: Any, speed: Any, turning: Any, t: Any) -> list[Any]:
    """Place, velocity along the blade, and force; u' = -g sin(theta), integrated twice."""
    with mp.workdps(3 * DIGITS):  # the closed form divides by the square of the turning rate
        now, pull = heading + turning * t, gravity / turning
        free = speed - pull * mp.cos(heading)
        u = free + pull * mp.cos(now)
        x = free * (mp.sin(now) - mp.sin(heading)) / turning
        x += pull * (t / 2 + (mp.sin(2 * now) - mp.sin(2 * heading)) / (4 * turning))
        y = -free * (mp.cos(now) - mp.cos(heading)) / turning
        y += pull * (mp.sin(now) ** 2 - mp.sin(heading) ** 2) / (2 * turning)
        return [x, y, u * mp.cos(now), u * mp.sin(now), mass * (u * turning + gravity * mp.cos(now))]


def our_slope(mass: float, gravity: float, heading: float, speed: float, turning: float, t: float) -> list[Any]:
    scene = SkateOnSlope(mass, 1.0, gravity, heading, speed, turning, duration=max(t, 1e-300))
    run = scene.motion([t])
    return [*run.pose[0, 0, :2], *run.twist[0, 0, :2], run.reaction[0, 0]]


def slope_sizes(mass: Any, gravity: Any, heading: Any, speed: Any, turning: Any, t: Any) -> list[Any]:
    """Velocity and force are sums of two, which may cancel."""
    fast = abs(speed) + gravity * t
    place = t * fast
    return [place, place, fast, fast, mass * (fast * abs(turning) + gravity)]


def drawn_slope(rng: np.random.Generator) -> tuple[float, ...]:
    clock, length = decades(rng), decades(rng)
    return (
        *(decades(rng), length / clock**2 * decades(rng, -2, 2), angle(rng)),
        *(
            length / clock * float(rng.normal()) * decades(rng, -3, 1),
            float(rng.normal()) * decades(rng, -9, 1) / clock,
        ),
        clock * float(rng.uniform(0, 1)),
    )


def pinned(mass: Any, inertia: Any, x: Any, y: Any, start: Any, rate: Any, pull: Any, t: Any) -> list[Any]:
    """Rate of turning and the pin's force of a body whose `point` (x, y) is pinned; gravity `pull` to -y."""
    square = x**2 + y**2
    frequency = mp.sqrt(mass * pull * mp.sqrt(square) / (inertia + mass * square))
    lag = mp.atan2(-y, -x) + mp.pi / 2  # from the body's angle to that of the line from the pin, from straight down
    first = start + lag
    first -= 2 * mp.pi * mp.nint(first / (2 * mp.pi))
    now, turning, acceleration = swung(frequency, first, rate, t)
    arm = -mp.mpc(x, y) * mp.expj(now - lag)
    force = mass * (arm * mp.mpc(-(turning**2), acceleration) + mp.mpc(0, pull))
    return [turning, force.real, force.imag]


def our_pinned(
    mass: float, inertia: float, x: float, y: float, start: float, rate: float, pull: float, t: float
) -> list[Any]:
    scene = PinnedBody(mass, inertia, (x, y), (0.0, 0.0), start, rate, (0.0, -pull), duration=max(t, 1e-300))
    run = scene.motion([t])
    return [run.twist[0, 0, 2], *run.reaction[0]]


def pinned_sizes(mass: Any, inertia: Any, x: Any, y: Any, start: Any, rate: Any, pull: Any, t: Any) -> list[Any]:
    """The largest rate and force of the whole motion: a part of it may pass zero."""
    arm = mp.hypot(x, y)
    frequency = mp.sqrt(mass * pull * arm / (inertia + mass * arm**2))
    fast = abs(rate) + 2 * frequency
    force = mass * (arm * fast**2 + pull)
    return [fast, force, force]


def drawn_pinned(rng: np.random.Generator) -> tuple[float, ...]:
    length, clock, mass = decades(rng), decades(rng), decades(rng)
    x, y = (length * float(rng.normal()) for _ in range(2))
    return (
        *(mass, mass * length**2 * decades(rng, -3, 1), x, y, angle(rng), float(rng.normal()) / clock),
        *(length / clock**2 * decades(rng, -1, 1), clock * float(rng.uniform(0, 1)) * decades(rng, -6, 1)),
    )


WHEELED = (
    Law("towed wheel", drawn_tow, our_tow, tow, vectors=(slice(1, 3),), angles=(0,), size=tow_sizes),
    Law("sleigh", drawn_sleigh, our_sleigh, sleigh),
    Law("skate on a slope", drawn_slope, our_slope, slope, vectors=(slice(0, 2), slice(2, 4)), size=slope_sizes),
    Law("pinned body", drawn_pinned, our_pinned, pinned, vectors=(slice(1, 3),), size=pinned_sizes),
)
