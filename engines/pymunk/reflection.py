"""A skate or a rolling contact by reflection: twice the impulse that would hold it, between two half steps.

An impulse that holds J v = 0 projects the velocity, v -> P v, and makes a method of first order. Twice that impulse
reflects it, v -> (2 P - 1) v, which keeps the energy, and is its own inverse. Between a half drift and a half kick on
either side the step is symmetric in time: second order, with an error in even powers only, and the row holds on the
average of two steps. What the row lacks in between changes sign with every step, so runs that are to be compared need
numbers of steps between samples that are all even or all odd.

Engine: the drifts are its steps, with no joint and no gravity in it. This works for single bodies with one joint to the
ground, in closed form; for several joined bodies the reflection of the whole is unstable where they turn fast.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib

from engines import EXACT, Holder, Promise, Size, Unpromised, Unsupported, refuse_forces
from engines.motions import over_three
from engines.pymunk.joints.skate import along_blade
from engines.read_reactions import reactions
from engines.rolling_table import rolled
from reference.joints import Joint, Skate, Vector
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reference.validation import Count, Name, Positive, Valid, validated

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
STEP_COST = 2e-6  # s, with three bodies
# Looked up once: every step asks each of them.
get_position, get_angle, set_velocity = lib.cpBodyGetPosition, lib.cpBodyGetAngle, lib.cpBodySetVelocity
get_velocity, get_rate, set_rate = lib.cpBodyGetVelocity, lib.cpBodyGetAngularVelocity, lib.cpBodySetAngularVelocity
# Kicks by half a step of gravity (dt [s]), reflects, kicks again: the body's C pointer -> velocities before and after.
Reflector = Callable[[Any], tuple[Triple, Triple]]


@validated
def reflectable(mechanism: Mechanism) -> bool:
    """Whether every joint is a Skate or Roll of a body on the ground that has no other joint; and no forces."""
    held = [joint.second for joint in mechanism.joints]
    kinds = all(isinstance(joint, Skate | Roll) and joint.first is None for joint in mechanism.joints)
    return bool(held) and kinds and not mechanism.forces and len(set(held)) == len(held)


@dataclass(frozen=True)
class Reflected(Valid):
    """An engine in the sense of `engines.Engine`: second order, for bodies with one Skate or Roll each."""

    variant: Name

    @property
    def name(self) -> str:
        return "pymunk"

    @property
    def packages(self) -> tuple[str, ...]:
        return ("pymunk",)

    @property
    def family(self) -> str:
        return "pymunk"

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """What a reflection lacks changes sign with every step, and the energy is kept."""
        return Promise(2, energy=EXACT, differences=1)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About how long a step takes [s]."""
        return STEP_COST * over_three(mechanism)

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """pymunk moves free bodies here; the joint's impulse is this file's."""
        return "ours"

    def softness(self, mechanism: Mechanism, dt: float) -> None:
        """Nothing gives way."""

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> ReflectedRun:
        """Raises Unsupported for any other joint, ValueError for a bad dt."""
        if not reflectable(mechanism):
            refuse_forces(mechanism, "a reflection")
            raise Unsupported(
                "a reflection is known in closed form only for one skate or contact of a body on the ground"
            )
        return ReflectedRun(mechanism, dt)


class ReflectedRun:
    """One model, ready to be stepped once; see `engines.Run`."""

    def __init__(self, mechanism: Mechanism, dt: float) -> None:
        self._mechanism, self._dt, self._over = mechanism, dt, False
        count, rows = len(mechanism.bodies), mechanism.row_count
        self.size = Size(bodies=count, coordinates=3 * count, rows=rows, solver_rows=0)
        self._model(1.0)  # what can't be built is refused now

    def _model(self, sense: float) -> tuple[pymunk.Space, list[Any], list[Reflector]]:
        """Space, bodies and what is done to each; sense -1 runs time backwards."""
        mechanism = self._mechanism
        space = pymunk.Space()
        bodies, reflectors = [], []
        joints = {joint.second: joint for joint in mechanism.joints}
        for description in mechanism.bodies:
            body = pymunk.Body(description.mass, description.inertia)
            body.position, body.angle = description.pose[:2], description.pose[2]
            vx, vy, rate = (sense * value for value in description.twist)
            body.velocity, body.angular_velocity = (vx, vy), rate
            space.add(body)
            bodies.append(body)
            reflectors.append(_reflector(joints.get(description.name), description, mechanism.gravity, self._dt))
        return space, bodies, reflectors

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        if self._over:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._over = True
        states, before, after, stepping, stopped = self._stepped(1.0, samples, every)
        # The step that would have led here is the first one of the motion backwards, backwards.
        earlier = -self._stepped(-1.0, 1, 1)[1][1]
        before[0] = earlier
        acceleration = (after - before) / (2 * self._dt)
        pose, twist = states[..., :3], states[..., 3:]
        pose[0], twist[0] = self._mechanism.pose, self._mechanism.twist
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        mechanism = self._mechanism
        # The reflection makes its impulses with these masses.
        reaction = reactions(mechanism, pose, twist, acceleration, mechanism.inertias, mechanism.gravity)
        return Trajectory(t, pose, twist, reaction, stepping, (stopped,) if stopped else ())

    def _stepped(self, sense: float, samples: int, every: int) -> tuple[Array, Array, Array, float, str]:
        """States (times, bodies, 6), and the velocities (times, bodies, 3) one step before each and one step after.

        With sense -1, `before` at the second sample is its own velocity, not that of a step earlier.
        """
        space, bodies, reflectors = self._model(sense)
        dt, half = self._dt, self._dt / 2
        step, pointer, pairs = (
            lib.cpSpaceStep,
            space._space,
            [(b._body, r) for b, r in zip(bodies, reflectors, strict=True)],
        )
        count = len(pairs)
        states = np.full((samples + 1, count, 6), np.nan)
        before, after = np.full((samples + 1, count, 3), np.nan), np.full((samples + 1, count, 3), np.nan)
        kept: list[tuple[list[tuple[Triple, Triple]], list[tuple[Triple, Triple]], list[Triple]]] = []
        stopped = ""
        between = range(every - 1)
        begin = time.process_time()
        try:
            # Two half drifts with nothing between them are one: samples alone need the halves.
            for _ in range(samples):
                step(pointer, half)
                first = last = [reflect(body) for body, reflect in pairs]
                for _ in between:
                    step(pointer, dt)
                    last = [reflect(body) for body, reflect in pairs]
                step(pointer, half)
                kept.append((first, last, [_pose(body) for body, _ in pairs]))
        except (ValueError, ArithmeticError) as reason:
            stopped = f"ours: stopped, as a joint could no longer be placed ({reason})"
        stepping = time.process_time() - begin
        for index, (first, last, pose) in enumerate(kept):
            after[index] = [new for _, new in first]
            before[index + 1] = [old for old, _ in last]
            states[index + 1, :, :3] = pose
            states[index + 1, :, 3:] = [new for _, new in last]
        if len(kept) == samples:
            try:
                step(pointer, half)
                after[samples] = [reflect(body)[1] for body, reflect in pairs]
            except (ValueError, ArithmeticError):
                pass  # the motion reached the last sample, its force stays unknown
        if sense < 0:
            before[1] = states[1, :, 3:]
        return states, before, after, stepping, stopped


def _pose(body: Any) -> Triple:
    place = get_position(body)
    return place.x, place.y, get_angle(body)


def _reflector(joint: Any, description: Body, gravity: Vector, dt: float) -> Reflector:
    kick = (gravity[0] * dt / 2, gravity[1] * dt / 2)
    match joint:
        case Skate():
            return _skating(joint, description.mass, description.inertia, kick)
        case Roll():
            return _rolling(joint, description.mass, description.inertia, kick)
        case _:
            return _falling(kick)


def _falling(kick: Vector) -> Reflector:
    def fall(body: Any) -> tuple[Triple, Triple]:
        velocity, rate = get_velocity(body), get_rate(body)
        old = (velocity.x, velocity.y, rate)
        new = (old[0] + 2 * kick[0], old[1] + 2 * kick[1], rate)
        set_velocity(body, new[:2])
        return old, new

    return fall


def _skating(joint: Skate, mass: float, inertia: float, kick: Vector) -> Reflector:
    along, blade = along_blade(joint), joint.angle
    impulse = 2 / (1 / mass + along**2 / inertia)
    push, spin = impulse / mass, impulse * along / inertia
    kick_x, kick_y = kick

    def reflect(body: Any) -> tuple[Triple, Triple]:
        velocity, rate = get_velocity(body), get_rate(body)
        heading = get_angle(body) + blade
        left_x, left_y = -sin(heading), cos(heading)
        old_x, old_y = velocity.x, velocity.y
        x, y = old_x + kick_x, old_y + kick_y
        across = x * left_x + y * left_y + along * rate
        new = (x - push * across * left_x + kick_x, y - push * across * left_y + kick_y, rate - spin * across)
        set_velocity(body, new[:2])
        set_rate(body, new[2])
        return (old_x, old_y, rate), new

    return reflect


def _rolling(joint: Roll, mass: float, inertia: float, kick: Vector) -> Reflector:
    arm_at = rolled(joint.rolling).arm
    kick_x, kick_y = kick

    def reflect(body: Any) -> tuple[Triple, Triple]:
        velocity, rate, angle = (
            get_velocity(body),
            get_rate(body),
            get_angle(body),
        )
        arm = arm_at(angle)
        arm_x, arm_y = arm.real, arm.imag  # from the contact to the centre
        old_x, old_y = velocity.x, velocity.y
        x, y = old_x + kick_x, old_y + kick_y
        # About the contact the angular momentum is kept: the projection turns about it at this rate, the reflection
        # is twice that, less what was.
        turning = 2 * (inertia * rate + mass * (arm_x * y - arm_y * x)) / (inertia + mass * (arm_x**2 + arm_y**2))
        new = (-turning * arm_y - x + kick_x, turning * arm_x - y + kick_y, turning - rate)
        set_velocity(body, new[:2])
        set_rate(body, new[2])
        return (old_x, old_y, rate), new

    return reflect
