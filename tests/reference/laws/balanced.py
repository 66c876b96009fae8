"""Closed chains in fifty digits: every body's own balance of forces and moments, all joint forces as unknowns.

The reference solves these mechanisms in as many coordinates as they have freedoms, without joint forces.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np

from reference.scenes.person import HEAD_ARMS_TRUNK, SHANK, SHANK_AND_FOOT, THIGH, OneFoot, TwoFeet
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from tests.reference.laws.law import Law, Outside, angle, decades

# A body: mass, inertia, direction of its x axis, turning rate. A pin: (body, its own point), twice; -1 is the ground.
# A skate: body, own point, direction against the body, velocity of the point along it.
Body = tuple[Any, Any, Any, Any]


def balanced(
    bodies: Sequence[Body],
    pins: Sequence[tuple[int, Any, int, Any]],
    skates: Sequence[tuple[int, Any, Any, Any]],
    pull: Any,
) -> tuple[list[Any], list[Any]]:
    """Accelerations (x, y, angle of each body) and forces (pins, on the second body; skates, to the left).

    Gravity `pull` is to -y; own points are complex numbers.
    """
    size, rows = 3 * len(bodies), []
    for first, own, second, other in pins:
        arms = [point * mp.expj(bodies[body][2]) if body >= 0 else 0 for body, point in ((first, own), (second, other))]
        for part in (lambda z: z.real, lambda z: z.imag):
            row, right = [mp.mpf(0)] * size, mp.mpf(0)
            for sign, body, arm in ((-1, first, arms[0]), (1, second, arms[1])):
                if body >= 0:
                    row[3 * body] += sign * part(mp.mpc(1, 0))
                    row[3 * body + 1] += sign * part(mp.mpc(0, 1))
                    row[3 * body + 2] += sign * part(1j * arm)
                    right += sign * part(arm * bodies[body][3] ** 2)
            rows.append((row, right))
    for body, own, blade, speed in skates:
        turn = bodies[body][3]
        arm, along = own * mp.expj(bodies[body][2]), mp.expj(bodies[body][2] + blade)
        left = 1j * along
        row = [mp.mpf(0)] * size
        row[3 * body], row[3 * body + 1] = left.real, left.imag
        row[3 * body + 2] = (mp.conj(left) * 1j * arm).real
        # Across the blade the point gains turn * speed, as the blade turns away from it.
        rows.append((row, turn * speed + turn**2 * (mp.conj(left) * arm).real))
    whole = mp.zeros(size + len(rows))
    right = mp.zeros(size + len(rows), 1)
    for number, (mass, inertia, _, _) in enumerate(bodies):
        for column, weight in enumerate((mass, mass, inertia)):
            whole[3 * number + column, 3 * number + column] = weight
        right[3 * number + 1] = -mass * pull
    for number, (row, value) in enumerate(rows, start=size):
        for column, share in enumerate(row):
            whole[number, column], whole[column, number] = share, -share
        right[number] = value
    solution = mp.lu_solve(whole, right)
    return list(solution[:size]), list(solution[size:])


LEG = (SHANK, THIGH, HEAD_ARMS_TRUNK, THIGH)


def segments(mass: Any, height: Any, last: Any, angles: Sequence[Any], rates: Sequence[Any]) -> tuple[list[Any], ...]:
    """Bodies, and of each how far its joints are behind and ahead of its centre."""
    bodies, behind, ahead = [], [], []
    for number, (part, at, turn) in enumerate(zip((*LEG, last), angles, rates, strict=True)):
        own, length = mp.mpf(part.mass) * mass, mp.mpf(part.length) * height
        centre = mp.mpf(1 - part.centre if number < 2 else part.centre)
        bodies.append((own, own * (mp.mpf(part.gyration) * length) ** 2, at, turn))
        behind.append(-centre * length)
        ahead.append(length - centre * length)
    return bodies, behind, ahead


def hung(behind: list[Any], ahead: list[Any]) -> list[tuple[int, Any, int, Any]]:
    """Left ankle, left knee, hip of the trunk, right hip, right knee."""
    return [
        (-1, 0, 0, behind[0]),
        (0, ahead[0], 1, behind[1]),
        (1, ahead[1], 2, behind[2]),
        (1, ahead[1], 3, behind[3]),
        (3, ahead[3], 4, behind[4]),
    ]


def one_foot(mass: Any, height: Any, pull: Any, *state: Any) -> list[Any]:
    """The five angular accelerations."""
    bodies, behind, ahead = segments(mass, height, SHANK_AND_FOOT, state[:5], state[5:])
    return balanced(bodies, hung(behind, ahead), [], pull)[0][2::3]


def our_one_foot(mass: float, height: float, pull: float, *state: float) -> list[Any]:
    return list(OneFoot(mass, height, pull).accelerations(np.array(state[:5]), np.array(state[5:])))


def drawn_one_foot(rng: np.random.Generator) -> tuple[float, ...]:
    height, clock = decades(rng), decades(rng)
    angles = (angle(rng) for _ in range(5))
    return (decades(rng), height, height / clock**2, *angles, *(float(rng.normal()) / clock for _ in range(5)))


def two_feet(mass: Any, height: Any, pull: Any, stance: Any, x: Any, y: Any, trunk: Any, *rates: Any) -> list[Any]:
    """Accelerations of the hip and of the trunk's angle; knees to the left."""
    shank, thigh = mp.mpf(SHANK.length) * height, mp.mpf(THIGH.length) * height
    angles, turning = [], []
    for ankle in (mp.mpf(0), stance):
        to_hip = mp.mpc(x - ankle, y)
        square = abs(to_hip) ** 2
        cosine = (square + shank**2 - thigh**2) / (2 * shank * abs(to_hip))
        if abs(cosine) >= 1:
            raise Outside
        lower = mp.arg(to_hip) + mp.acos(cosine)
        upper = mp.arg(to_hip - shank * mp.expj(lower))
        # shank i e^(i lower) w1 + thigh i e^(i upper) w2 = velocity of the hip
        one, other = 1j * shank * mp.expj(lower), 1j * thigh * mp.expj(upper)
        found = mp.lu_solve(mp.matrix([[one.real, other.real], [one.imag, other.imag]]), mp.matrix(list(rates[:2])))
        angles.append((lower, upper))
        turning.append(list(found))
    directions = [angles[0][0], angles[0][1], trunk, angles[1][1] - mp.pi, angles[1][0] - mp.pi]
    own = [turning[0][0], turning[0][1], rates[2], turning[1][1], turning[1][0]]
    bodies, behind, ahead = segments(mass, height, SHANK, directions, own)
    pins = [*hung(behind, ahead), (-1, 0, 4, ahead[4])]
    found, _ = balanced(bodies, pins, [], pull)
    arm = behind[2] * mp.expj(trunk)
    hip = mp.mpc(found[6], found[7]) + arm * mp.mpc(-(rates[2] ** 2), found[8])
    return [hip.real, hip.imag, found[8]]


def our_two_feet(
    mass: float, height: float, pull: float, stance: float, x: float, y: float, trunk: float, *rates: float
) -> list[Any]:
    scene = TwoFeet(mass, height, pull, stance=stance, hip_x=x, hip_y=y)
    return list(scene.accelerations(np.array([x, y, trunk]), np.array(rates)))


def drawn_two_feet(rng: np.random.Generator) -> tuple[float, ...]:
    """Knees from well bent to nearly straight."""
    height, clock = decades(rng), decades(rng)
    reach = 0.491 * (1 - decades(rng, -6, -0.5))
    lean = float(rng.uniform(-0.4, 0.4))
    x, y = reach * math.sin(lean), reach * math.cos(lean)
    stance = x + float(rng.uniform(-0.3, 0.3)) * reach
    speed = height / clock
    return (
        *(decades(rng), height, height / clock**2, height * stance, height * x, height * y, angle(rng)),
        *(float(rng.normal()) * speed, float(rng.normal()) * speed, float(rng.normal()) / clock),
    )


def car(mass: Any, other: Any, inertia: Any, own: Any, ahead: Any, before: Any, *rest: Any) -> list[Any]:
    """Forces: front wheel, hitch x and y, the car's axle, the trailer's axle."""
    wheelbase, steering, hitch, length, speed, bend = rest
    turn = speed * mp.tan(steering) / wheelbase
    # The hitch's velocity, and from it the trailer's: nothing moves across its axle.
    moved = mp.mpc(speed, -hitch * turn) * mp.expj(-bend)
    trailer_turn = moved.imag / length
    bodies = [(mass, inertia, mp.mpf(0), turn), (other, own, bend, trailer_turn)]
    front = mp.mpc(speed, wheelbase * turn)
    skates = [
        (0, wheelbase - ahead, steering, (front * mp.expj(-steering)).real),
        (0, -ahead, mp.mpf(0), speed),
        (1, -before, mp.mpf(0), moved.real),
    ]
    _, forces = balanced(bodies, [(0, -ahead - hitch, 1, length - before)], skates, mp.mpf(0))
    return [forces[2], forces[0], forces[1], forces[3], forces[4]]


def our_car(
    mass: float, other: float, inertia: float, own: float, ahead: float, before: float, *rest: Any
) -> list[Any]:
    wheelbase, steering, hitch, length, speed, bend = rest
    scene = CarAndTrailer(
        (mass, other), (inertia, own), (ahead, before), wheelbase, steering, hitch, length, speed, bend
    )
    return list(scene.motion([0.0]).reaction[0])


def drawn_car(rng: np.random.Generator) -> tuple[float, ...]:
    unit, clock, weight = decades(rng), decades(rng), decades(rng)
    masses = [weight * decades(rng, -1, 1) for _ in range(2)]
    inertias = [mass * unit**2 * decades(rng, -2, 0) for mass in masses]
    return (
        *masses,
        *inertias,
        *(unit * float(rng.normal()) for _ in range(2)),
        unit * decades(rng, -1, 1),
        float(rng.uniform(-1.5, 1.5)),
        unit * float(rng.normal()),
        unit * decades(rng, -1, 1),
        unit / clock * float(rng.normal()),
        angle(rng),
    )


BALANCED = (
    Law("person on one foot", drawn_one_foot, our_one_foot, one_foot, vectors=(slice(0, 5),), quick=0, many=30),
    Law("person on two feet", drawn_two_feet, our_two_feet, two_feet, vectors=(slice(0, 2),), quick=0, many=30),
    Law("car and trailer", drawn_car, our_car, car, vectors=(slice(0, 5),), quick=2, many=200),
)
