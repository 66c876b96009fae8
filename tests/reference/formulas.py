"""Formulas in fifty digits for linkages, pendulums, chains, tows, sleighs, ellipses and cams."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np

from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Curve
from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.link import Pendulum
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import SliderCrank
from reference.scenes.wheels.trailers import Tow
from tests.reference.law import Law, Outside, angle, decades


def root(square: Any) -> Any:
    """The square root of a number; raises Outside for negative numbers."""
    if square < 0:
        raise Outside
    return mp.sqrt(square)


def solved(rows: list[list[Any]], right: list[Any]) -> list[Any]:
    """The solution x of a linear system with the matrix `rows`."""
    return list(mp.lu_solve(mp.matrix(rows), mp.matrix(right)))


def closed(crank: Any, coupler: Any, rocker: Any, x: Any, y: Any, theta: Any, branch: int) -> tuple[Any, ...]:
    """Crank, coupler and rocker as complex numbers."""
    bar, ground = crank * mp.expj(theta), mp.mpc(x, y)
    span = abs(ground - bar)
    foot = (span**2 + coupler**2 - rocker**2) / (2 * span)
    out = (ground - bar) / span * mp.mpc(foot, branch * root(coupler**2 - foot**2))
    return bar, out, bar + out - ground


def four_bar(branch: int) -> Law:
    def exact(crank, coupler, rocker, x, y, theta, rate, acceleration):
        a, b, c = closed(crank, coupler, rocker, x, y, theta, branch)
        rows = [[-b.imag, c.imag], [b.real, -c.real]]
        once = solved(rows, [a.imag * rate, -a.real * rate])
        rest = a * (1j * acceleration - rate**2) - b * once[0] ** 2 + c * once[1] ** 2
        return [mp.arg(b), mp.arg(c), *once, *solved(rows, [-rest.real, -rest.imag])]

    def ours(crank, coupler, rocker, x, y, theta, rate, acceleration):
        return FourBar(crank, coupler, rocker, (x, y)).kinematics(theta, rate, acceleration, branch)

    return Law(f"four-bar, branch {branch:+d}", drawn_four_bar, ours, exact, angles=(0, 1))


def drawn_four_bar(rng: np.random.Generator) -> tuple[float, ...]:
    """Random lengths and a crank angle at which the loop closes; half of the angles are near a crank limit."""
    scale, theta = decades(rng), angle(rng)
    crank, ground, heading = decades(rng, -2, 2), decades(rng, -2, 2), rng.uniform(-math.pi, math.pi)
    if rng.random() < 0.3:
        heading = 0.0
    x, y = ground * math.cos(heading), ground * math.sin(heading)
    span = abs(complex(x, y) - crank * complex(math.cos(theta), math.sin(theta)))
    if rng.random() < 0.5:  # coupler + rocker exceeds the distance B to D
        whole, part = span * (1 + decades(rng, -14, 1)), rng.random()
        coupler, rocker = whole * part, whole * (1 - part)
        if abs(coupler - rocker) > span:
            coupler = rocker = whole / 2
    else:
        coupler = span * (0.5 + decades(rng, -1, 2))
        rocker = abs(coupler + float(rng.choice([-1, 1])) * span * (1 - decades(rng, -14, 0)))
    return (
        *(scale * value for value in (crank, coupler, rocker, x, y)),
        *(theta, float(rng.normal()) * decades(rng), float(rng.normal()) * decades(rng)),
    )


def limits(crank, coupler, rocker, x, y):
    """The crank angle from the ground's direction at which coupler and rocker are in line, by the cosine rule."""
    ground = mp.hypot(x, y)
    cosine = (crank**2 + ground**2 - (coupler + rocker) ** 2) / (2 * crank * ground)
    if abs(cosine) >= 1:
        raise Outside
    return [mp.acos(cosine)]


def our_limits(crank, coupler, rocker, x, y):
    linkage = FourBar(crank, coupler, rocker, (x, y))
    intervals = linkage.crank_limits()
    if intervals is None or len(intervals) != 1:
        raise ValueError
    return [(intervals[0][1] - intervals[0][0]) / 2]


def drawn_limits(rng: np.random.Generator) -> tuple[float, ...]:
    scale = decades(rng)
    crank, ground = decades(rng, -2, 2), decades(rng, -2, 2)
    # The reachable range is a point at coupler + rocker = |crank - ground|, and a full turn at coupler + rocker = crank
    # + ground.
    low, high = abs(crank - ground), crank + ground
    part = decades(rng, -14, -0.3)
    reach, share = low + (high - low) * (part if rng.random() < 0.5 else 1 - part), rng.uniform(0.3, 0.7)
    return tuple(scale * value for value in (crank, reach * share, reach * (1 - share), ground, 0.0))


def slider_crank(branch: int) -> Law:
    def positions(crank, rod, offset, theta):
        sine = (offset - crank * mp.sin(theta)) / rod
        cosine = branch * root((1 - sine) * (1 + sine))
        return sine, cosine, crank * mp.cos(theta) + rod * cosine

    def exact(crank, rod, offset, theta, rate, acceleration):
        sine, cosine, x = positions(crank, rod, offset, theta)
        first = -crank * mp.cos(theta) / (rod * cosine)
        second = (crank * mp.sin(theta) + rod * sine * first**2) / (rod * cosine)
        turn, pull = first * rate, first * acceleration + second * rate**2
        arm = rod * mp.mpc(cosine, sine)
        slider = crank * mp.expj(theta) * (1j * acceleration - rate**2) + arm * (1j * pull - turn**2)
        along = (1j * crank * mp.expj(theta) + 1j * arm * first).real
        return [x, along, slider.real, mp.atan2(sine, cosine), first, second]

    def ours(crank, rod, offset, theta, rate, acceleration):
        shape = SliderCrank(crank, rod, offset, branch)
        turn, slide = shape.rates(theta)
        bend, gain = (each.imag / 1e-100 for each in shape.rates(theta + 1e-100j))
        return [
            *(shape.position(theta), slide, gain * rate**2 + slide * acceleration),
            *(shape.rod_angle(theta), turn, bend),
        ]

    return Law(f"slider-crank, branch {branch:+d}", drawn_slider_crank, ours, exact, angles=(3,))


def drawn_slider_crank(rng: np.random.Generator) -> tuple[float, ...]:
    """Random crank and rod lengths, with a rod that is often only slightly longer than the crank."""
    scale, clock = decades(rng), decades(rng)
    crank = decades(rng, -2, 2)
    rod = crank * (1 + decades(rng, -12, 2))
    offset = (rod - crank) * float(rng.uniform(-1, 1))
    return (
        *(scale * crank, scale * rod, scale * offset, angle(rng)),
        *(float(rng.normal()) / clock, float(rng.normal()) / clock**2),
    )


def swung(frequency: Any, start: Any, rate: Any, t: Any) -> list[Any]:
    """Angle, rate and acceleration of a swinging or whirling pendulum (Whittaker, Analytical Dynamics, 44)."""
    sine, half_rate = mp.sin(start / 2), rate / (2 * frequency)
    square = sine**2 + half_rate**2
    if square == 1 or square == 0:
        raise Outside
    modulus, back = mp.sqrt(square), mp.sign(rate) or 1
    if square < 1:
        begin = mp.ellipf(mp.asin(sine / modulus), square)
        if half_rate < 0:  # the swinging pendulum is within half a turn of the bottom
            begin = 2 * mp.ellipk(square) - begin
        u = frequency * t + begin
        sn, cn = mp.ellipfun("sn", u, m=square), mp.ellipfun("cn", u, m=square)
        now = 2 * mp.asin(modulus * sn)
        return [now, 2 * frequency * modulus * cn, -(frequency**2) * mp.sin(now)]
    u = modulus * frequency * t + back * mp.ellipf(start / 2, 1 / square)
    sn, cn, dn = (mp.ellipfun(kind, u, m=1 / square) for kind in ("sn", "cn", "dn"))
    now = 2 * back * mp.atan2(sn, cn)
    return [now, 2 * frequency * modulus * back * dn, -(frequency**2) * mp.sin(now)]


def swing(frequency: Any, start: Any, rate: Any, t: Any) -> list[Any]:
    """The largest angle, rate and acceleration of the motion."""
    modulus = mp.hypot(mp.sin(start / 2), rate / (2 * frequency))
    return [2 * min(modulus, mp.pi), 2 * frequency * modulus, frequency**2 * min(2 * modulus, 1)]


def drawn_pendulum(rng: np.random.Generator) -> tuple[float, ...]:
    """Random pendulums at times up to 100 radians of phase, often near the separatrix or an equilibrium."""
    frequency, start = decades(rng), angle(rng, (0.0, math.pi, -math.pi))
    start = math.remainder(start, 2 * math.pi)
    rate = 2 * frequency * float(rng.normal())
    if rng.random() < 0.3:
        rate = 2 * frequency * math.cos(start / 2) * (1 + float(rng.choice([-1, 1])) * decades(rng, -12, 0))
    if rng.random() < 0.1:
        rate = 0.0
    return frequency, start, rate, float(rng.uniform(0, 1)) * decades(rng, -9, 2) / frequency


def chain(*numbers: Any) -> list[Any]:
    """Angular accelerations of three bars in a chain, by Lagrange's equations."""
    lengths, masses, angles, rates = (numbers[k : k + 3] for k in (0, 3, 6, 9))
    rows, right = mp.zeros(3), mp.zeros(3, 1)
    for i, j in np.ndindex(3, 3):
        outer, apart = max(i, j), angles[i] - angles[j]
        weight = lengths[i] * lengths[j] * (masses[outer] / (3 if i == j else 2) + sum(masses[outer + 1 :]))
        rows[i, j] = weight * mp.cos(apart)
        right[i] -= weight * mp.sin(apart) * rates[j] ** 2
        if i == j:
            right[i] -= numbers[-1] * lengths[i] * (masses[i] / 2 + sum(masses[i + 1 :])) * mp.sin(angles[i])
    return list(mp.lu_solve(rows, right))


def drawn_chain(rng: np.random.Generator) -> tuple[float, ...]:
    length, weight, clock = decades(rng), decades(rng), decades(rng)
    sizes = (*(length * decades(rng, -1, 1) for _ in range(3)), *(weight * decades(rng, -2, 2) for _ in range(3)))
    rates = (float(rng.normal()) / clock for _ in range(3))
    return (*sizes, *(angle(rng) for _ in range(3)), *rates, length / clock**2)


def tow(length: Any, start: Any, radius: Any, way: Any) -> list[Any]:
    """The drawbar's angle and the wheel's position, by the exponential of a 2 by 2 matrix."""
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
    chord = 2 * radius * mp.sin(curvature * way / 2) * mp.expj(curvature * way / 2)
    wheel = chord - length * mp.expj(curvature * way + turned)
    return [turned, wheel.real, wheel.imag]


def our_tow(length: float, start: float, radius: float, way: float) -> list[Any]:
    made = Tow(length, start, radius)
    return [made.relative_angle(way), *made.wheel(way)]


def tow_sizes(length: Any, start: Any, radius: Any, way: Any) -> list[Any]:
    """Magnitudes whose rounding is allowed: the start angle for psi, the drawbar's length for the position."""
    turned, x, y = tow(length, start, radius, way)
    place = max(abs(mp.mpc(x, y)), length)
    return [max(abs(turned), abs(start)), place, place]


def drawn_tow(rng: np.random.Generator) -> tuple[float, ...]:
    """Random radii near the length and far from it, with start angles near both equilibria."""
    length = decades(rng)
    share = 1 + float(rng.choice([-1, 1])) * decades(rng, -12, -0.1) if rng.random() < 0.5 else decades(rng, -2, 4)
    radius = length * share * float(rng.choice([-1, 1]))
    start = math.remainder(angle(rng, (0.0, math.pi)), 2 * math.pi)
    if abs(share) > 1 and rng.random() < 0.3:  # near equilibria
        settled = -math.asin(length / radius)
        start = (settled if rng.random() < 0.5 else math.pi - settled) + float(rng.normal()) * decades(rng, -9, 0)
        start = math.remainder(start, 2 * math.pi)
    return length, start, radius, length * float(rng.uniform(-1, 1)) * decades(rng, -9, 1.3)


def sleigh(mass: Any, inertia: Any, offset: Any, speed: Any, turning: Any, t: Any) -> list[Any]:
    """Speed, turning rate, heading and lateral force of a sleigh, by Gudermann's function."""
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


def ellipse(a: Any, b: Any, u: Any) -> list[Any]:
    """Arc, tangent angle, point and curvature of an ellipse, by Legendre's integral."""
    if max(a / b, b / a) > 999:
        raise Outside
    sine, cosine = mp.sin(u), mp.cos(u)
    excess = mp.atan2((a - b) * sine * cosine, a * sine**2 + b * cosine**2)  # angle's excess
    curvature = a * b / mp.hypot(a * sine, b * cosine) ** 3
    return [b * mp.ellipe(u, 1 - (a / b) ** 2), u + mp.pi / 2 + excess, a * cosine, b * sine, curvature]


def cam(radius: Any, *numbers: Any) -> list[Any]:
    """Arc, tangent angle, point and curvature of a cam; `numbers` are three pairs of cosine and sine coefficients, and
    the normal's angle.
    """
    *harmonics, nu = numbers

    def series(nu: Any, order: int) -> Any:
        out = mp.mpf(0)
        for k in range(1, 1 + len(harmonics) // 2):
            phase = k * nu + order * mp.pi / 2
            out += mp.mpf(k) ** order * (harmonics[2 * k - 2] * mp.cos(phase) + harmonics[2 * k - 1] * mp.sin(phase))
        return out

    arc = radius * nu + sum((at - start for at, start in ((series(nu, k), series(0, k)) for k in (-1, 1))), mp.mpf(0))
    point = mp.expj(nu) * mp.mpc(radius + series(nu, 0), series(nu, 1))
    return [arc, nu + mp.pi / 2, point.real, point.imag, 1 / (radius + series(nu, 0) + series(nu, 2))]


def curve_at(curve: Curve, place: float) -> list[Any]:
    """Arc, tangent angle, point and curvature of one of the reference's curves at a parameter."""
    return [curve.arc_of(place), curve.angle_of(place), *curve.point_of(place), curve.curvature_of(place)]


def drawn_ellipse(rng: np.random.Generator) -> tuple[float, ...]:
    a = decades(rng)
    b = a * (decades(rng, -2.9, 2.9) if rng.random() < 0.5 else 1 + decades(rng, -14, 0))
    return a, b


def turned(rng: np.random.Generator) -> float:
    """A random angle of up to a few turns, often near a multiple of a right angle."""
    if rng.random() < 0.5:
        return float(rng.uniform(-20, 20))
    return float(rng.integers(-4, 5)) * math.pi / 2 + float(rng.choice([-1, 1])) * decades(rng, -12, 0)


def drawn_cam(rng: np.random.Generator) -> tuple[float, ...]:
    """A random convex cam, which is often nearly not convex."""
    radius, spread = decades(rng), (0.1 if rng.random() < 0.7 else 0.35)
    c = [radius * float(rng.uniform(-1, 1)) for _ in range(2)]
    return radius, *c, *(radius * spread * float(rng.uniform(-1, 1)) / share for share in (3, 3, 8, 8))


LAWS = (
    *(four_bar(1), four_bar(-1), slider_crank(1), slider_crank(-1)),
    Law("four-bar, limit of the crank", drawn_limits, our_limits, limits),
    Law("pendulum", drawn_pendulum, lambda f, a, r, t: Pendulum(f, a, r).motion(t), swung, angles=(0,), size=swing),
    Law(
        "chain of three",
        drawn_chain,
        lambda *n: Chain(n[:3], n[3:6], n[-1]).accelerations(n[6:9], n[9:12]),
        chain,
        vectors=(slice(0, 3),),
    ),
    Law("towed wheel", drawn_tow, our_tow, tow, vectors=(slice(1, 3),), angles=(0,), size=tow_sizes),
    Law("sleigh", drawn_sleigh, our_sleigh, sleigh),
    Law(
        "ellipse at a parameter",
        lambda rng: (*drawn_ellipse(rng), turned(rng)),
        lambda a, b, u: curve_at(Ellipse(a, b), u),
        ellipse,
        vectors=(slice(2, 4),),
    ),
    Law(
        "cam at a parameter",
        lambda rng: (*drawn_cam(rng), turned(rng)),
        lambda radius, *n: curve_at(Cam(radius, n[:-1:2], n[1:-1:2]), n[-1]),
        cam,
        vectors=(slice(2, 4),),
    ),
)
