"""Small mechanisms whose motions are known in closed form: what an engine's run is held against.

Each has one or a few bodies, and the joints that its name says. Nothing here comes from a scene or from an engine, and
the formulas stand beside the numbers. Units: kg, m, s, rad, N, N m.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from engines.conformance.world import (
    INERTIA,
    MASS,
    WEIGHT,
    Array,
    G,
    World,
    body,
    resting,
    round_about,
    swing,
    world,
)
from reference.joints import Drive, Pin, Skate, Slot
from reference.rolling.curves import Circle, Line, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll


def _swinging_bar() -> World:
    """A bar whose centre of mass is `arm` below the pin: frequency^2 = m g arm / (I + m arm^2)."""
    arm = 0.5
    frequency = math.sqrt(MASS * G * arm / (INERTIA + MASS * arm**2))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.6, 1.5, frequency)
        place, velocity, acceleration = round_about(arm, angle - math.pi / 2, rate, change)
        return [[*place, angle]], [[*velocity, rate]], [[*acceleration, change]]

    pin = Pin("hinge", None, "body", (0.0, 0.0), (0.0, arm))
    return world("swinging bar", (body("body"),), (pin,), (0.0, -G), states)


def _swinging_parallelogram() -> World:
    """Two equal cranks and a coupler that stays parallel to the ground: one freedom, and the pins close a loop."""
    crank, base, arm = 0.5, 0.8, 0.2  # arm: of a crank's centre of mass from the ground
    heavy, light = 1.5, 1.0  # kg, the coupler and a crank
    own = 2 * (0.05 + light * arm**2) + heavy * crank**2
    frequency = math.sqrt((2 * light * arm + heavy * crank) * G / own)

    def states(t: Array) -> Any:
        angles = swing(t, 0.5, 1.5, frequency)
        angle, rate, change = angles
        inner, outer = (round_about(radius, angle - math.pi / 2, rate, change) for radius in (arm, crank))
        still = np.zeros_like(t)
        return [
            [[x, y, own], [x + apart, y, own], [along + apart / 2, across, still]]
            for (x, y), (along, across), own, apart in zip(inner, outer, angles, (base, 0.0, 0.0), strict=True)
        ]

    bodies = (body("left", light, 0.05), body("right", light, 0.05), body("coupler", heavy, 0.1))
    top, end = (0.0, arm), (0.0, arm - crank)
    joints = (
        Pin("A", None, "left", (0.0, 0.0), top),
        Pin("B", "left", "coupler", end, (-base / 2, 0.0)),
        Pin("C", "coupler", "right", (base / 2, 0.0), end),
        Pin("D", None, "right", (base, 0.0), top),
    )
    return world("swinging parallelogram", bodies, joints, (0.0, -G), states)


def _driven_crank() -> World:
    """A crank at a constant rate: the drive carries the weight's moment, the pin the weight and m a."""
    arm, rate = 0.5, 3.0

    def states(t: Array) -> Any:
        angle = 0.4 + rate * t
        place, velocity, acceleration = round_about(arm, angle, np.full_like(t, rate), np.zeros_like(t))
        return [[*place, angle]], [[*velocity, rate]], [[*acceleration, 0.0]]

    def reaction(t: Array) -> Any:
        x, y = arm * np.cos(0.4 + rate * t), arm * np.sin(0.4 + rate * t)
        return [-MASS * rate**2 * x, MASS * (G - rate**2 * y), MASS * G * x]

    joints = (
        Pin("hinge", None, "body", (0.0, 0.0), (-arm, 0.0)),
        Drive("motor", None, "body", rate, 0.4),
    )
    return world("driven crank", (body("body"),), joints, (0.0, -G), states, reaction)


def _spinning_bar() -> World:
    """A bar on a pin through its centre of mass turns at a constant rate, from an angle of more than one turn."""
    rate, begin = -60.0, 20.0
    pin = Pin("hinge", None, "body", (0.0, 0.0), (0.0, 0.0))
    return world(
        "spinning bar",
        (body("body"),),
        (pin,),
        (0.0, 0.0),
        lambda t: ([[0.0, 0.0, begin + rate * t]], [[0.0, 0.0, rate]], [[0.0, 0.0, 0.0]]),
    )


def _sliding_block() -> World:
    """A block whose centre of mass slides down an incline, turning at a rate that nothing changes."""
    slope, speed, spin = -0.5, 0.8, 0.7
    pull = G * math.sin(-slope)
    x, y = math.cos(slope), math.sin(slope)

    def states(t: Array) -> Any:
        way, now = speed * t + pull * t**2 / 2, speed + pull * t
        return [[way * x, way * y, 0.3 + spin * t]], [[now * x, now * y, spin]], [[pull * x, pull * y, 0.0]]

    slot = Slot("guide", None, "body", (0.0, 0.0), slope, (0.0, 0.0))
    return world("sliding block", (body("body"),), (slot,), (0.0, -G), states, lambda t: [MASS * G * math.cos(slope)])


def _bead() -> World:
    """A bead in a slot of a rod that turns at a constant rate: r'' = rate^2 r - g sin(turned).

    r = near cosh(rate t) + far sinh(rate t) + g sin(turned) / (2 rate^2), and across the rod the bead feels
    2 m r' rate + m g cos(turned).
    """
    rate, begin, near, far = 3.0, 0.5, 0.2, 0.1
    own = G / (2 * rate**2)

    def along(t: Array) -> tuple[Array, Array, Array]:
        grown = near * np.cosh(rate * t) + far * np.sinh(rate * t)
        growing = near * np.sinh(rate * t) + far * np.cosh(rate * t)
        sine, cosine = np.sin(begin + rate * t), np.cos(begin + rate * t)
        return grown + own * sine, rate * (growing + own * cosine), rate**2 * (grown - own * sine)

    def states(t: Array) -> Any:
        way, speed, change = along(t)
        turned = begin + rate * t
        cosine, sine = np.cos(turned), np.sin(turned)
        ahead, across = change - rate**2 * way, 2 * speed * rate
        return (
            [[0.0, 0.0, turned], [way * cosine, way * sine, 0.0]],
            [[0.0, 0.0, rate], [speed * cosine - way * rate * sine, speed * sine + way * rate * cosine, 0.0]],
            [[0.0, 0.0, 0.0], [ahead * cosine - across * sine, ahead * sine + across * cosine, 0.0]],
        )

    def reaction(t: Array) -> Any:
        way, speed, _ = along(t)
        cosine, sine = np.cos(begin + rate * t), np.sin(begin + rate * t)
        pressed = MASS * (2 * speed * rate + G * cosine)
        # The hinge and the motor hold the rod against its weight and against what it presses on the bead.
        return [-pressed * sine, pressed * cosine + MASS * G, pressed * way, pressed]

    joints = (
        Pin("hinge", None, "rod", (0.0, 0.0), (0.0, 0.0)),
        Drive("motor", None, "rod", rate, begin),
        Slot("groove", "rod", "bead", (0.0, 0.0), 0.0, (0.0, 0.0)),
    )
    return world("bead on a turning rod", (body("rod"), body("bead")), joints, (0.0, -G), states, reaction)


def _trammel() -> World:
    """A bar whose ends slide on two lines at a right angle: its middle swings on a circle, its angle the other way."""
    half = 0.5
    frequency = math.sqrt(MASS * G * half / (MASS * half**2 + INERTIA))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.7, 1.5, frequency)
        parts = round_about(half, angle - math.pi / 2, rate, change)
        # The end (half, 0) of the bar is on the x axis, the other on the y axis: the bar's angle is minus the middle's.
        own = (math.pi / 2 - angle, -rate, -change)
        return [[[*part, turned]] for part, turned in zip(parts, own, strict=True)]

    joints = (
        Slot("level", None, "body", (0.0, 0.0), 0.0, (half, 0.0)),
        Slot("upright", None, "body", (0.0, 0.0), math.pi / 2, (-half, 0.0)),
    )
    return world("trammel", (body("body"),), joints, (0.0, -G), states)


def _skate() -> World:
    """A skate under its centre of mass on a slope: it turns steadily, and only the pull along the blade changes v.

    heading' = w and v' = -g sin(heading), so v = c + (g / w) cos(heading).
    """
    spin, speed, begin, blade = 2.0, 1.2, 0.5, 0.3
    pull = G / spin
    steady = speed - pull * math.cos(begin)

    def states(t: Array) -> Any:
        heading = begin + spin * t
        cosine, sine = np.cos(heading), np.sin(heading)
        now, change = steady + pull * cosine, -G * sine
        x = steady * (sine - math.sin(begin)) + pull * (spin * t + (np.sin(2 * heading) - math.sin(2 * begin)) / 2) / 2
        y = -steady * (cosine - math.cos(begin)) + pull * (sine**2 - math.sin(begin) ** 2) / 2
        aside = now * spin
        return (
            [[x / spin, y / spin, heading - blade]],
            [[now * cosine, now * sine, spin]],
            [[change * cosine - aside * sine, change * sine + aside * cosine, 0.0]],
        )

    def reaction(t: Array) -> Any:
        cosine = np.cos(begin + spin * t)
        return [MASS * ((steady + pull * cosine) * spin + G * cosine)]

    joint = Skate("blade", None, "body", (0.0, 0.0), blade)
    return world("skate on a slope", (body("body"),), (joint,), (0.0, -G), states, reaction)


def _sleigh() -> World:
    """Chaplygin's sleigh, its blade behind the centre of mass, on level ice: in the end it runs straight ahead.

    With v along the blade and w the rate: v' = arm w^2, (I + m arm^2) w' = -m arm v w. So v = V tanh(s) and
    w = W / cosh(s), where V^2 m = W^2 (I + m arm^2) and s = s0 + p t with p = m arm V / (I + m arm^2). The heading has
    turned by W / p (gd(s) - gd(s0)), gd the Gudermannian function.
    """
    arm, largest, begin, turned = 0.4, 2.0, 0.5, 0.3
    whole = INERTIA + MASS * arm**2
    fastest = largest * math.sqrt(whole / MASS)
    pace = MASS * arm * fastest / whole
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def heading(t: Array) -> Array:
        def turned_by(s: Any) -> Any:
            return 2 * np.arctan(np.tanh(s / 2))

        return turned + largest / pace * (turned_by(begin + pace * t) - turned_by(begin))

    def speed(t: Array) -> Array:
        return fastest * np.tanh(begin + pace * t)

    def states(t: Array) -> Any:
        angle, now, rate = heading(t), speed(t), largest / np.cosh(begin + pace * t)
        within = t[:, None] * (nodes + 1) / 2  # the path's integral by Gauss's rule, to rounding below a second
        way = t / 2 * ((speed(within) * np.exp(1j * heading(within))) @ weights)
        faster, slower = arm * rate**2, -MASS * arm * now * rate / whole
        ahead = np.exp(1j * angle)
        place = way + arm * ahead
        velocity = (now + 1j * arm * rate) * ahead
        change = (faster - arm * rate**2 + 1j * (arm * slower + now * rate)) * ahead
        return (
            [[place.real, place.imag, angle]],
            [[velocity.real, velocity.imag, rate]],
            [[change.real, change.imag, slower]],
        )

    def reaction(t: Array) -> Any:
        rate = largest / np.cosh(begin + pace * t)
        return [INERTIA * MASS * speed(t) * rate / whole]

    joint = Skate("blade", None, "body", (-arm, 0.0))
    return world("sleigh", (body("body"),), (joint,), (0.0, 0.0), states, reaction)


def rolling(ground: Any, radius: float, angle: float, ground_arc: float) -> Rolling:
    """A disc of `radius` about its centre of mass, at `angle`, on a ground at `ground_arc`."""
    below = float(ground.angle(ground_arc)) + math.pi - angle  # the tangent's angle on the disc at the contact
    return Rolling(Circle(radius), ground, angle, ground_arc, radius * (below - math.pi / 2))


def _disc() -> World:
    """A disc rolls down a slope: r angle'' = -g sin(slope) / (1 + I / (m r^2)), and friction is -I angle'' / r."""
    radius, slope, spin, begin = 0.3, 0.4, -2.0, 0.2
    pull = G * math.sin(slope) / (1 + INERTIA / (MASS * radius**2))
    x, y = math.cos(slope), -math.sin(slope)  # downhill

    def states(t: Array) -> Any:
        way, speed = -radius * spin * t + pull * t**2 / 2, -radius * spin + pull * t
        return (
            [[way * x - radius * y, way * y + radius * x, begin - way / radius]],
            [[speed * x, speed * y, -speed / radius]],
            [[pull * x, pull * y, -pull / radius]],
        )

    # The ground's material is on its left, so it is traversed uphill: there friction, which slows the disc, points.
    ground = Line(math.pi - slope)
    joint = Roll("rim", None, "body", rolling(ground, radius, begin, 0.0))
    forces = [INERTIA * pull / radius**2, MASS * G * math.cos(slope)]
    return world("disc on a slope", (body("body"),), (joint,), (0.0, -G), states, lambda t: forces)


def _disc_in_a_hole() -> World:
    """A disc rolls to and fro at the bottom of a round hole: a pendulum of frequency^2 = g / (q (1 + I / (m r^2)))."""
    hole, radius, begin = 1.2, 0.3, 0.5
    between = hole - radius
    frequency = math.sqrt(G / (between * (1 + INERTIA / (MASS * radius**2))))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, begin, 1.0, frequency)
        parts = round_about(between, angle - math.pi / 2, rate, change)
        # Without slip r own' = -q angle'.
        owns = (-between / radius * (angle - begin), -between / radius * rate, -between / radius * change)
        return [[[*part, own]] for part, own in zip(parts, owns, strict=True)]

    ring = Ring(hole)  # arc 0 at +x, clockwise
    joint = Roll("rim", None, "body", rolling(ring, radius, 0.0, hole * (math.pi / 2 - begin)))
    return world("disc in a hole", (body("body"),), (joint,), (0.0, -G), states)


SPINNING = _spinning_bar()
# One body each, which nothing moves: what reactions say of its weight.
RESTING: tuple[World, ...] = (
    resting("hanging bar", (Pin("hinge", None, "body", (0.3, 1.0), (0.0, 0.5)),), [0.0, WEIGHT], (0.3, 0.5, 0.0)),
    resting(
        "held arm",
        (Pin("hinge", None, "body", (0.0, 0.0), (-0.5, 0.0)), Drive("motor", None, "body", 0.0, 0.0)),
        [0.0, WEIGHT, WEIGHT * 0.5],
        (0.5, 0.0, 0.0),
    ),
    resting("resting block", (Slot("guide", None, "body", (0.0, 0.2), 0.0, (0.0, 0.0)),), [WEIGHT], (0.4, 0.2, 0.1)),
    resting("resting skate", (Skate("blade", None, "body", (0.0, 0.0)),), [WEIGHT], (0.4, 0.2, 0.0)),
    resting(
        "resting disc", (Roll("rim", None, "body", rolling(Line(), 0.3, 0.2, 0.0)),), [0.0, WEIGHT], (0.0, 0.3, 0.2)
    ),
)
MOVING: tuple[World, ...] = (
    _swinging_bar(),
    _swinging_parallelogram(),
    _driven_crank(),
    _sliding_block(),
    _bead(),
    _trammel(),
    _skate(),
    _sleigh(),
    _disc(),
    _disc_in_a_hole(),
)
WORLDS = (*RESTING, *MOVING)
