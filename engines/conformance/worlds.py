"""Small mechanisms whose exact motions are known in closed form.

Units are kg, m, s, rad, N and N m. Vectors of the plane are complex numbers x + i y.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engines.conformance.check import Array, World, WorldMotion
from reference.joints import Drive, Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll

G = 10.0  # m/s^2, downwards.
MASS, INERTIA = 2.0, 0.3  # Mass [kg] and inertia [kg m^2] of most bodies.
WEIGHT = MASS * G
ORIGIN = (0.0, 0.0)


def body(name: str = "body", mass: float = MASS, inertia: float = INERTIA) -> Body:
    return Body(name, mass, inertia, (0.0, 0.0, 0.0))


def world(
    name: str,
    joints: tuple[Joint, ...],
    states: Callable[[Array], Sequence[Any]],
    reaction: Callable[[Array], Sequence[Any]] | None = None,
    bodies: tuple[Body, ...] = (body(),),
    gravity: float = -G,
) -> World:
    """A world whose bodies start in the states at t = 0.

    `states(t)` returns position (complex) and angle of each body, each with two derivatives, as numbers or arrays
    (times,). `reaction(t)` returns reactions (rows, times); by default they follow from the accelerations.
    """

    def motion(t: Array) -> WorldMotion:
        numbers: list[list[Any]] = [[np.broadcast_to(value, t.shape) for value in state] for state in states(t)]
        pose, twist, change = (
            np.moveaxis(np.array([(s[k].real, s[k].imag, s[3 + k].real) for s in numbers]), -1, 0) for k in range(3)
        )
        if reaction is None:
            return WorldMotion(pose, twist, change, mechanism.reaction(pose, change))
        return WorldMotion(pose, twist, change, np.array([np.broadcast_to(row, t.shape) for row in reaction(t)]).T)

    starts = [[complex(np.ravel(value)[0]) for value in state] for state in states(np.zeros(1))]
    placed = (
        replace(body, pose=(z.real, z.imag, angle.real), twist=(v.real, v.imag, rate.real))
        for body, (z, v, _, angle, rate, _) in zip(bodies, starts, strict=True)
    )
    mechanism = Mechanism(tuple(placed), joints, (0.0, gravity))
    return World(name, mechanism, motion)


def resting(name: str, joints: tuple[Joint, ...], reaction: list[float], place: complex, angle: float) -> World:
    return world(name, joints, lambda t: [(place, 0.0, 0.0, angle, 0.0, 0.0)], lambda t: reaction)


def swing(t: Array, angle: float, rate: float, frequency: float) -> tuple[Array, Array, Array]:
    """Angle, rate and acceleration of a swing with angle'' = -frequency^2 sin(angle), by Jacobi's functions."""
    from scipy.special import ellipj, ellipkinc

    modulus = math.hypot(rate / (2 * frequency), math.sin(angle / 2))
    phase = math.asin(math.sin(angle / 2) / modulus)
    start = ellipkinc(phase if rate >= 0 else math.pi - phase, modulus**2)
    sn, cn, _, _ = ellipj(frequency * t + start, modulus**2)
    swung = 2 * np.arcsin(modulus * sn)
    return swung, 2 * modulus * frequency * cn, -(frequency**2) * np.sin(swung)


def round_about(radius: float, angle: Any, rate: Any, change: Any) -> tuple[Any, Any, Any]:
    point = radius * np.exp(1j * angle)
    return point, 1j * rate * point, (1j * change - rate**2) * point


def _swinging_bar() -> World:
    """A bar whose centre of mass is `arm` below the pin: frequency^2 = m g arm / (I + m arm^2)."""
    arm = 0.5
    frequency = math.sqrt(MASS * G * arm / (INERTIA + MASS * arm**2))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.6, 1.5, frequency)
        return [(*round_about(arm, angle - math.pi / 2, rate, change), angle, rate, change)]

    return world("swinging bar", (Pin("hinge", None, "body", ORIGIN, (0.0, arm)),), states)


def _swinging_parallelogram() -> World:
    """Two equal cranks and a coupler that stays parallel to the ground: a loop with one degree of freedom."""
    crank, base, arm = 0.5, 0.8, 0.2  # Arm: distance of a crank's centre of mass from its pivot.
    heavy, light = 1.5, 1.0  # Masses of the coupler and a crank.
    inertia = 2 * (0.05 + light * arm**2) + heavy * crank**2
    frequency = math.sqrt((2 * light * arm + heavy * crank) * G / inertia)

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.5, 1.5, frequency)
        (x, v, a), (along, speed, gain) = (
            round_about(radius, angle - math.pi / 2, rate, change) for radius in (arm, crank)
        )
        turning = angle, rate, change
        return [(x, v, a, *turning), (x + base, v, a, *turning), (along + base / 2, speed, gain, 0.0, 0.0, 0.0)]

    bodies = (body("left", light, 0.05), body("right", light, 0.05), body("coupler", heavy, 0.1))
    top, end = (0.0, arm), (0.0, arm - crank)
    joints = (
        Pin("A", None, "left", ORIGIN, top),
        Pin("B", "left", "coupler", end, (-base / 2, 0.0)),
        Pin("C", "coupler", "right", (base / 2, 0.0), end),
        Pin("D", None, "right", (base, 0.0), top),
    )
    return world("swinging parallelogram", joints, states, bodies=bodies)


def _driven_crank() -> World:
    """A crank at a constant rate; the drive's torque balances the moment of the weight."""
    arm, rate = 0.5, 3.0

    def states(t: Array) -> Any:
        return [(*round_about(arm, 0.4 + rate * t, rate, 0.0), 0.4 + rate * t, rate, 0.0)]

    def reaction(t: Array) -> Any:
        point = round_about(arm, 0.4 + rate * t, 0.0, 0.0)[0]
        return [-MASS * rate**2 * point.real, MASS * (G - rate**2 * point.imag), MASS * G * point.real]

    joints = (Pin("hinge", None, "body", ORIGIN, (-arm, 0.0)), Drive("motor", None, "body", rate, 0.4))
    return world("driven crank", joints, states, reaction)


def _sliding_block() -> World:
    """A block whose centre of mass slides down an incline while it turns at a constant rate."""
    slope, speed, spin = -0.5, 0.8, 0.7
    pull, line = G * math.sin(-slope), np.exp(1j * slope)

    def states(t: Array) -> Any:
        distance = speed * t + pull * t**2 / 2
        return [(distance * line, (speed + pull * t) * line, pull * line, 0.3 + spin * t, spin, 0.0)]

    slot = Slot("guide", None, "body", ORIGIN, slope, ORIGIN)
    return world("sliding block", (slot,), states, lambda t: [MASS * G * math.cos(slope)])


def _bead() -> World:
    """A bead in a slot of a rod that turns at a constant rate: r'' = rate^2 r - g sin(turned).

    The solution is r = near cosh(rate t) + far sinh(rate t) + g sin(turned) / (2 rate^2). The force of the rod on the
    bead is 2 m r' rate + m g cos(turned).
    """
    rate, begin, near, far = 3.0, 0.5, 0.2, 0.1
    sag = G / (2 * rate**2)

    def along(t: Array) -> tuple[Array, Array, Array]:
        homogeneous = near * np.cosh(rate * t) + far * np.sinh(rate * t)
        derivative = near * np.sinh(rate * t) + far * np.cosh(rate * t)
        sine, cosine = np.sin(begin + rate * t), np.cos(begin + rate * t)
        return homogeneous + sag * sine, rate * (derivative + sag * cosine), rate**2 * (homogeneous - sag * sine)

    def states(t: Array) -> Any:
        r, speed, change = along(t)
        turned = begin + rate * t
        line = np.exp(1j * turned)
        acceleration = (change - rate**2 * r + 2j * speed * rate) * line
        return [
            (0.0, 0.0, 0.0, turned, rate, 0.0),
            (r * line, (speed + 1j * r * rate) * line, acceleration, 0.0, 0.0, 0.0),
        ]

    def reaction(t: Array) -> Any:
        r, speed, _ = along(t)
        cosine, sine = np.cos(begin + rate * t), np.sin(begin + rate * t)
        contact = MASS * (2 * speed * rate + G * cosine)
        return [-contact * sine, contact * cosine + MASS * G, contact * r, contact]

    joints = (
        Pin("hinge", None, "rod", ORIGIN, ORIGIN),
        Drive("motor", None, "rod", rate, begin),
        Slot("groove", "rod", "bead", ORIGIN, 0.0, ORIGIN),
    )
    return world("bead on a turning rod", joints, states, reaction, (body("rod"), body("bead")))


def _trammel() -> World:
    """A bar whose ends slide on two perpendicular lines; its centre swings on a circle, and the bar turns backwards."""
    half = 0.5
    frequency = math.sqrt(MASS * G * half / (MASS * half**2 + INERTIA))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.7, 1.5, frequency)
        # The end (half, 0) of the bar is on the x axis, so the angle of the bar is minus the polar angle of its centre.
        return [(*round_about(half, angle - math.pi / 2, rate, change), math.pi / 2 - angle, -rate, -change)]

    joints = (
        Slot("level", None, "body", ORIGIN, 0.0, (half, 0.0)),
        Slot("upright", None, "body", ORIGIN, math.pi / 2, (-half, 0.0)),
    )
    return world("trammel", joints, states)


def _skate() -> World:
    """A skate under its centre of mass on a slope, with a constant turning rate w.

    heading' = w and v' = -g sin(heading), so v = c + (g / w) cos(heading).
    """
    spin, speed, begin, blade = 2.0, 1.2, 0.5, 0.3
    pull = G / spin
    steady = speed - pull * math.cos(begin)

    def states(t: Array) -> Any:
        heading = begin + spin * t
        sine, v = np.sin(heading), steady + pull * np.cos(heading)
        x = steady * (sine - math.sin(begin)) + pull * (spin * t + (np.sin(2 * heading) - math.sin(2 * begin)) / 2) / 2
        y = -steady * (np.cos(heading) - math.cos(begin)) + pull * (sine**2 - math.sin(begin) ** 2) / 2
        ahead = np.exp(1j * heading)
        return [((x + 1j * y) / spin, v * ahead, (-G * sine + 1j * v * spin) * ahead, heading - blade, spin, 0.0)]

    def reaction(t: Array) -> Any:
        cosine = np.cos(begin + spin * t)
        return [MASS * ((steady + pull * cosine) * spin + G * cosine)]

    return world("skate on a slope", (Skate("blade", None, "body", ORIGIN, blade),), states, reaction)


def _sleigh() -> World:
    """Chaplygin's sleigh on a horizontal plane, with its blade behind the centre of mass.

    The velocity v along the blade and the rate w satisfy v' = arm w^2 and (I + m arm^2) w' = -m arm v w. The solution
    is v = V tanh(s) and w = W / cosh(s), with V^2 m = W^2 (I + m arm^2) and s = s0 + p t, p = m arm V / (I + m arm^2).
    The heading changes by W / p (gd(s) - gd(s0)), with the Gudermannian function gd.
    """
    arm, largest, begin, turned = 0.4, 2.0, 0.5, 0.3
    whole = INERTIA + MASS * arm**2
    fastest = largest * math.sqrt(whole / MASS)
    pace = MASS * arm * fastest / whole
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def gudermannian(s: Any) -> Any:
        return 2 * np.arctan(np.tanh(s / 2))

    def heading(t: Array) -> Array:
        return turned + largest / pace * (gudermannian(begin + pace * t) - gudermannian(begin))

    def speed(t: Array) -> Array:
        return fastest * np.tanh(begin + pace * t)

    def states(t: Array) -> Any:
        angle, v, rate = heading(t), speed(t), largest / np.cosh(begin + pace * t)
        quadrature = t[:, None] * (nodes + 1) / 2  # Gauss's rule has only rounding errors for t < 1 s
        blade = t / 2 * ((speed(quadrature) * np.exp(1j * heading(quadrature))) @ weights)
        dv, change = arm * rate**2, -MASS * arm * v * rate / whole
        ahead = np.exp(1j * angle)
        acceleration = (dv - arm * rate**2 + 1j * (arm * change + v * rate)) * ahead
        return [(blade + arm * ahead, (v + 1j * arm * rate) * ahead, acceleration, angle, rate, change)]

    def reaction(t: Array) -> Any:
        return [INERTIA * MASS * speed(t) * largest / np.cosh(begin + pace * t) / whole]

    return world("sleigh", (Skate("blade", None, "body", (-arm, 0.0)),), states, reaction, gravity=0.0)


def rolling(ground: Any, radius: float, angle: float, ground_arc: float) -> Rolling:
    """A disc of `radius` about its centre of mass, at `angle` [rad], that touches the ground at `ground_arc` [m]."""
    below = float(ground.angle(ground_arc)) + math.pi - angle  # angle of the disc's tangent at the contact
    return Rolling(Circle(radius), ground, angle, ground_arc, radius * (below - math.pi / 2))


def _disc() -> World:
    """A disc rolls down a slope: r angle'' = -g sin(slope) / (1 + I / (m r^2)), with the friction -I angle'' / r."""
    radius, slope, spin, begin = 0.3, 0.4, -2.0, 0.2
    pull = G * math.sin(slope) / (1 + INERTIA / (MASS * radius**2))
    downhill = np.exp(-1j * slope)

    def states(t: Array) -> Any:
        distance, speed = -radius * spin * t + pull * t**2 / 2, -radius * spin + pull * t
        turning = begin - distance / radius, -speed / radius, -pull / radius
        return [((distance + 1j * radius) * downhill, speed * downhill, pull * downhill, *turning)]

    # The ground's arc length increases uphill, since its material is on the left. Friction also points uphill.
    joint = Roll("rim", None, "body", rolling(Line(math.pi - slope), radius, begin, 0.0))
    forces = [INERTIA * pull / radius**2, MASS * G * math.cos(slope)]
    return world("disc on a slope", (joint,), states, lambda t: forces)


def _disc_in_a_hole() -> World:
    """A disc swings in a round hole like a pendulum, with frequency^2 = g / (between (1 + I / (m r^2)))."""
    hole, radius, begin = 1.2, 0.3, 0.5
    between = hole - radius
    frequency = math.sqrt(G / (between * (1 + INERTIA / (MASS * radius**2))))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, begin, 1.0, frequency)
        ratio = -between / radius  # without slip
        turning = ratio * (angle - begin), ratio * rate, ratio * change
        return [(*round_about(between, angle - math.pi / 2, rate, change), *turning)]

    # The arc length of the ring begins at +x and increases clockwise.
    joint = Roll("rim", None, "body", rolling(Ring(hole), radius, 0.0, hole * (math.pi / 2 - begin)))
    return world("disc in a hole", (joint,), states)


# A bar on a pin through its centre of mass turns at a constant rate, from an angle of more than one turn.
SPINNING = world(
    "spinning bar",
    (Pin("hinge", None, "body", ORIGIN, ORIGIN),),
    lambda t: [(0.0, 0.0, 0.0, 20.0 - 60.0 * t, -60.0, 0.0)],
    gravity=0.0,
)
# Bodies at rest, whose reactions balance the weight.
RESTING: tuple[World, ...] = (
    resting("hanging bar", (Pin("hinge", None, "body", (0.3, 1.0), (0.0, 0.5)),), [0.0, WEIGHT], 0.3 + 0.5j, 0.0),
    resting(
        "held arm",
        (Pin("hinge", None, "body", ORIGIN, (-0.5, 0.0)), Drive("motor", None, "body", 0.0, 0.0)),
        [0.0, WEIGHT, WEIGHT * 0.5],
        0.5,
        0.0,
    ),
    resting("resting block", (Slot("guide", None, "body", (0.0, 0.2), 0.0, ORIGIN),), [WEIGHT], 0.4 + 0.2j, 0.1),
    resting("resting skate", (Skate("blade", None, "body", ORIGIN),), [WEIGHT], 0.4 + 0.2j, 0.0),
    resting("resting disc", (Roll("rim", None, "body", rolling(Line(), 0.3, 0.2, 0.0)),), [0.0, WEIGHT], 0.3j, 0.2),
)
_MAKERS = (
    *(_swinging_bar, _swinging_parallelogram, _driven_crank, _sliding_block, _bead, _trammel, _skate, _sleigh),
    *(_disc, _disc_in_a_hole),
)
MOVING: tuple[World, ...] = tuple(make() for make in _MAKERS)
WORLDS = (*RESTING, *MOVING)
