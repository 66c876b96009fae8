"""Runs of a user's pymunk space with the user's settings or with other documented settings.

The module also finds contacts, limits and sleep in a motion, which the mechanism does not have.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import constraints

from engines.pymunk.iterations import iterations_in_step, stable_gain, worst_factor
from engines.pymunk.methods import LARGEST_WORK
from engines.pymunk.reading.constraints import (
    LIMIT_JOINTS,
    ImportedSpace,
    both_sided,
    copy_space,
    is_equality,
    set_poses,
)
from engines.reading import Change, Note, Obstacle, RowRegularisation, left_out, refuse
from engines.sampling import reactions, sampled
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
MOST_SHAPES = 400
DIVISORS = (1, 2, 4, 8, 16, 32, 64, 128, 256)  # divisors of the user's step, for `changes`
FURTHER_DIVISORS = (*DIVISORS, 512, 1024, 2048, 4096)
MORE_ITERATIONS = 50
# Duration of the pilot run for `changes`, relative to the time scale of the mechanism.
PILOT_DURATION = 10
# Step for the accelerations at t = 0, relative to the time scale of the mechanism.
SMALL_STEP = 1e-4
CONVERGED_ITERATIONS = 20_000  # for this step


def switch_off(space: pymunk.Space, element: str) -> None:
    if element == "contact":
        for shape in space.shapes:
            shape.sensor = True
    elif element == "damping":
        space.damping = 1.0
    elif element == "limit":
        space.remove(*(each for each in space.constraints if isinstance(each, LIMIT_JOINTS) and not is_equality(each)))
    elif element == "sleep":
        space.sleep_time_threshold = inf
    else:
        raise ValueError(f"--without is {element!r}; it must be one of contact, damping, limit, sleep")


@dataclass(frozen=True, eq=False)
class OwnPymunk:
    """A space and its mechanism; see `engines.reading.OwnModel`. `dt` is the user's step [s]."""

    imported: ImportedSpace
    mechanism: Mechanism
    dt: float
    step_is_assumed: bool  # The space has not been stepped, and the user gave no step.
    ahead: bool = False  # The user's script advances the velocities by half a step before the first step.
    engine: str = "pymunk"
    has_soft_joints: bool = False
    # Gaps depend on steps and iterations, and pymunk declares no law for them.
    declares: bool = False
    elements: Sequence[str] = ("contact", "limit")

    @property
    def assumed(self) -> str:
        if not self.step_is_assumed:
            return ""
        return f"a step of {self.dt:.4g} s, since the space has not been stepped (give yours with --step)"

    @property
    def start_twist(self) -> Array:
        return np.array([body.twist for body in self.imported.bodies])

    @property
    def suspects(self) -> Mapping[str, str]:
        return self.imported.suspects

    @property
    def settings(self) -> Mapping[str, str]:
        space = self.imported.space
        return {
            "step": f"{self.dt:.6g} s{', assumed' if self.assumed else ''}",
            "iterations": f"{space.iterations}",
            "gravity": f"{space.gravity.x:g}, {space.gravity.y:g}",
            "error_bias": ", ".join(f"{bias:.4g}" for bias in sorted({each.error_bias for each in space.constraints})),
        }

    def start(self) -> Array:
        return self.without(None)

    def without(self, element: str | None) -> Array:
        """The accelerations (bodies, 3) at t = 0, extrapolated to zero step, since a drift precedes the kick."""
        steps = [SMALL_STEP * self.mechanism.time_scale, SMALL_STEP / 2 * self.mechanism.time_scale]
        first, second = (self._kicked(step, element) for step in steps)
        return 2 * second - first

    def _kicked(self, step: float, element: str | None) -> Array:
        space, bodies = copy_space(self.imported)
        if element is not None:
            switch_off(space, element)
        for limit in [constraint for constraint in space.constraints if is_equality(constraint)]:
            # A limit acts only after a step that violates the limit, but the ideal joint acts from t = 0 on.
            space.remove(limit)
            space.add(both_sided(limit))
        space.iterations = max(space.iterations, CONVERGED_ITERATIONS)
        for body, (x, y, turn) in zip(bodies, self.mechanism.twist.tolist(), strict=True):
            body.velocity, body.angular_velocity = (x, y), turn
        self._stepper(space, bodies)(step)
        return (_twists(bodies) - self.mechanism.twist) / step

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        zero = np.zeros(self.mechanism.row_count)
        return RowRegularisation(zero, zero, np.diag(zero), np.full_like(zero, np.nan))

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        met = [*sleepers(self.imported, self.dt, t, twist), *contacts_and_limits(self.imported, t, pose)]
        return sorted(met, key=lambda obstacle: obstacle.t)

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        """The changes to try; steps correct the whole gap only if they are stable at all poses of the pilot run."""
        users, increased = self.imported.space.iterations, max(MORE_ITERATIONS, 2 * self.imported.space.iterations)
        rho = worst_factor(self.mechanism, PILOT_DURATION * self.mechanism.time_scale)
        enough = iterations_in_step(rho, max(1, len(self.mechanism.joints)), work=LARGEST_WORK)
        counts = sorted({users, increased, enough, *((10 * increased,) if further else ())})
        whole_gap = [(count, 0.0, ahead) for count in counts if stable_gain(rho, count) == 1 for ahead in (False, True)]
        options = dict.fromkeys([(users, None, self.ahead), (increased, None, self.ahead), *whole_gap])
        steps = [self.dt / divisor for divisor in (FURTHER_DIVISORS if further else DIVISORS)]
        return [self._change(*option, dt) for option in options for dt in steps if dt >= smallest]

    def _change(self, iterations: int, bias: float | None, ahead: bool, dt: float) -> Change:
        summary = f"{iterations} iterations{'' if bias is None else ', error_bias 0'}"
        summary += ", started half a step ahead by code that runs once" if ahead else ""
        lines = [f"space.iterations = {iterations}"] if iterations != self.imported.space.iterations else []
        if bias is not None:
            lines += ["for joint in space.constraints:", f"    joint.error_bias = {bias:g}"]
        if ahead and not self.ahead:
            lines += start_ahead("space", self.imported.space, dt)
        lines.append(f"# call space.step({dt!r}) in your loop; to check the space again, give --step {dt!r}")
        options = (("iterations", iterations), ("bias", bias), ("ahead", ahead))
        return Change(f"{summary}, step {dt * 1e3:.4g} ms", dt, tuple(lines), options)

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        return ()

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        space, bodies = copy_space(self.imported)
        dt, spacing, ahead = self.dt, every * self.dt, self.ahead
        if change is not None:
            options, dt = dict(change.options), change.dt
            ahead = options["ahead"]
            space.iterations = options["iterations"]
            if options["bias"] is not None:
                for joint in space.constraints:
                    joint.error_bias = options["bias"]
        steps, step = max(1, round(spacing / dt)), self._stepper(space, bodies)
        t = np.arange(samples + 1, dtype=np.float64) * spacing
        shape = (samples + 1, len(bodies), 3)
        pose, twist, acceleration, before = (np.full(shape, np.nan) for _ in range(4))
        pose[0], twist[0] = self.mechanism.pose, self.mechanism.twist

        def advance(count: int) -> None:
            for _ in range(count):
                step(dt)

        def record_before(sample: int) -> None:
            before[sample] = _twists(bodies)

        def record(sample: int) -> bool:
            if sample == 0:
                return False
            state, after = _poses(bodies), _twists(bodies)
            # The kick acts at the pose after the drift, so the result is the acceleration at the sample.
            acceleration[sample] = (after - before[sample]) / dt
            if np.isfinite(state).all():
                pose[sample], twist[sample] = state, (before[sample] + after) / 2 if ahead else after
            return not np.isfinite(state).all()

        if ahead:
            for body in bodies:
                body.position -= body.velocity * (dt / 2)
                body.angle -= body.angular_velocity * dt / 2
            step(dt / 2)
        stepping = sampled([steps] * samples, advance, record, record_before)
        own = self.mechanism
        reaction = reactions(own, pose, twist, acceleration, own.inertias, own.gravity)
        # pymunk provides no force for joints of a prescribed motion.
        names = [joint.name for joint in own.joints for _ in range(joint.size)]
        reaction[:, [name in self.imported.prescribed for name in names]] = np.nan
        return Trajectory(t, pose, twist, reaction, stepping)

    def _stepper(self, space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> Callable[[float], None]:
        """A function that sets the constant forces, which a step resets, and makes a step."""
        pushed = [(bodies[index], *push) for index, push in self.imported.pushed.items()]
        if not pushed:
            return space.step

        def step(dt: float) -> None:
            for body, force, torque in pushed:
                body.force, body.torque = force, torque
            space.step(dt)

        return step


def start_ahead(name: str, space: pymunk.Space, dt: float) -> list[str]:
    """Lines of a script that advance the velocities of the space `name` by half a step of dt [s]."""
    save, restore = list[str](), list[str]()
    if any(body.force.length or body.torque for body in space.bodies):  # a step resets the forces
        save = [f"pushed = [(body, body.force, body.torque) for body in {name}.bodies]"]
        restore = ["for body, force, torque in pushed:", "    body.force, body.torque = force, torque"]
    return [
        *save,
        f"for body in {name}.bodies:  # once, before the first step, which moves them back",
        f"    body.position -= body.velocity * {dt / 2!r}",
        f"    body.angle -= body.angular_velocity * {dt / 2!r}",
        f"{name}.step({dt / 2!r})",
        *restore,
    ]


def _poses(bodies: Sequence[pymunk.Body]) -> Array:
    centres = [body.local_to_world(body.center_of_gravity) for body in bodies]
    return np.array([(centre.x, centre.y, body.angle) for centre, body in zip(centres, bodies, strict=True)])


def _twists(bodies: Sequence[pymunk.Body]) -> Array:
    return np.array([(*body.velocity, body.angular_velocity) for body in bodies])


def contacts_and_limits(imported: ImportedSpace, t: Array, pose: Array) -> list[Obstacle]:
    """The first contact of each pair of shapes and the first time at each limit, for poses (times, bodies, 3).

    Raises Unsupported for more than MOST_SHAPES shapes.
    """
    space, bodies = copy_space(imported)
    first: dict[str, Obstacle] = {}

    def add(time: float, description: str, remedy: str) -> None:
        first.setdefault(description, Obstacle(float(time), description, remedy))

    shapes = [shape for shape in space.shapes if not shape.sensor]
    if len(shapes) > MOST_SHAPES:
        raise refuse("the space", f"it has {len(shapes)} shapes; more than {MOST_SHAPES} are not looked at")
    in_space = set(space.constraints)  # constraints outside the space have no effect
    pairs = [pair for pair in itertools.combinations(shapes, 2) if _may_touch(*pair, in_space)]
    limits = [
        (constraint, label)
        for constraint, label in zip(space.constraints, imported.labels.values(), strict=True)
        if isinstance(constraint, (*LIMIT_JOINTS, constraints.GrooveJoint)) and not is_equality(constraint)
    ]
    names = {id(body): name for body, name in zip(bodies, imported.body_names.values(), strict=True)}
    for time, poses in zip(t, pose, strict=True):
        set_poses(bodies, poses)
        for shape in shapes:
            shape.cache_bb()
        for one, other in pairs:
            if one.bb.intersects(other.bb) and _touch(one, other):
                owners = [names.get(id(shape.body), "the ground") for shape in (one, other)]
                add(time, f"a shape of {owners[0]} touches one of {owners[1]}", left_out("contact"))
        for limit, label in limits:
            if _reached(limit):
                groove = isinstance(limit, constraints.GrooveJoint)
                add(time, f"{label} reaches its end", "give a longer groove" if groove else left_out("limit"))
    return list(first.values())


def sleepers(imported: ImportedSpace, step: float, t: Array, twist: Array) -> list[Obstacle]:
    """Bodies that may sleep, since they are idle for `sleep_time_threshold` in twists (times, bodies, 3).

    A body is idle in Chipmunk (cpSpaceProcessComponents) if m v^2 + I w^2 is at most m s^2. The speed s is
    `idle_speed_threshold`. If the threshold is zero, s is the speed that gravity adds in a step. In Chipmunk, connected
    bodies must also be idle. This function does not check connected bodies, so it may report more bodies than Chipmunk
    lets sleep.
    """
    space = imported.space
    if isinf(space.sleep_time_threshold):
        return []
    allowed = space.idle_speed_threshold or space.gravity.length * step
    out = []
    for index, (body, name) in enumerate(imported.body_names.items()):
        if body.body_type != pymunk.Body.DYNAMIC:
            continue
        speed = np.hypot(twist[:, index, 0], twist[:, index, 1])
        turning = 0.0 if isinf(body.moment) else body.moment / body.mass * twist[:, index, 2] ** 2
        idle_since = np.inf
        for time, is_idle in zip(t, speed**2 + turning <= allowed**2, strict=True):
            idle_since = min(idle_since, time) if is_idle else np.inf
            if time - idle_since >= space.sleep_time_threshold:
                out.append(Obstacle(float(time), f"{name} may fall asleep", left_out("sleep")))
                break
    return out


def _touch(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    try:
        return bool(one.shapes_collide(other).points)
    except AssertionError:  # pymunk raises this for two shapes at exactly the same pose
        return True


def _may_touch(one: pymunk.Shape, other: pymunk.Shape, in_space: set[constraints.Constraint]) -> bool:
    if one.body is other.body or one.body is None or other.body is None:
        return False
    if pymunk.Body.DYNAMIC not in (one.body.body_type, other.body.body_type):
        return False
    joints: Any = one.body.constraints & other.body.constraints & in_space
    first, second = one.filter, other.filter
    is_same_group = first.group and first.group == second.group
    if is_same_group or not all(joint.collide_bodies for joint in joints):
        return False
    return bool(first.categories & second.mask) and bool(second.categories & first.mask)


def _reached(limit: Any) -> bool:
    a, b = limit.a, limit.b
    if isinstance(limit, constraints.SlideJoint):
        distance = a.local_to_world(limit.anchor_a).get_distance(b.local_to_world(limit.anchor_b))
        return not limit.min < distance < limit.max
    if isinstance(limit, constraints.RotaryLimitJoint):
        return not limit.min < b.angle - a.angle < limit.max
    begin, end = a.local_to_world(limit.groove_a), a.local_to_world(limit.groove_b)
    share = (b.local_to_world(limit.anchor_b) - begin).dot(end - begin) / (end - begin).dot(end - begin)
    return not 0 < share < 1
