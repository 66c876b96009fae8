"""A user's pymunk space as it is: copied, and stepped with its own settings or with others that pymunk documents.

And what its motion runs into that its mechanism lacks: shapes that touch, limits that are reached, sleep.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import Constraint, GrooveJoint, RotaryLimitJoint, SlideJoint

from engines.pymunk.contraction import gain, sweeps
from engines.pymunk.expected import worst_contraction
from engines.pymunk.methods import WORK
from engines.pymunk.reading.joints import LIMITS, Described, both_sided, copied, is_equality, place
from engines.reading import Change, Note, Obstacle, RowRegularisation, left_out, refuse
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
MOST_SHAPES = 400
DIVISORS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
FURTHER = (*DIVISORS, 512, 1024, 2048, 4096)
MORE_ITERATIONS = 50
EXPECTED = 10  # times the mechanism's time: in which poses so many iterations have to be enough
SMALL = 1e-4  # of the mechanism's time: a step for the accelerations at t = 0, and half of it
SWEEPS = 20_000  # at that step: impulses are passed on until nothing is left


def switch_off(space: pymunk.Space, element: str) -> None:
    """Change a space so that this kind of element no longer acts. Raises ValueError for a word that is none."""
    if element == "contact":
        for shape in space.shapes:
            shape.sensor = True
    elif element == "damping":
        space.damping = 1.0
    elif element == "limit":
        space.remove(*[each for each in space.constraints if isinstance(each, LIMITS) and not is_equality(each)])
    elif element == "sleep":
        space.sleep_time_threshold = inf
    else:
        raise ValueError(f"--without is {element!r}; it must be one of contact, damping, limit, sleep")


@dataclass(frozen=True, eq=False)
class OwnPymunk:
    """A space and what it describes; see `engines.reading.OwnModel`. `dt` [s]: the user's step."""

    described: Described
    mechanism: Mechanism
    dt: float
    unknown_step: bool  # the space has not been stepped, and no step was named
    ahead: bool = False  # the user's own lines bring velocities half a step ahead before the first step
    engine: str = "pymunk"
    has_soft_joints: bool = False
    # How far joints give way follows from steps and sweeps: pymunk declares no law without them.
    declares: bool = False
    elements: Sequence[str] = ("contact", "limit")

    @property
    def assumed(self) -> str:
        if not self.unknown_step:
            return ""
        return f"a step of {self.dt:.4g} s, since the space has not been stepped (give yours with --step)"

    @property
    def start_twist(self) -> Array:
        return np.array([body.twist for body in self.described.bodies])

    @property
    def suspects(self) -> Mapping[str, str]:
        return self.described.suspects

    @property
    def settings(self) -> Mapping[str, str]:
        space = self.described.space
        return {
            "step": f"{self.dt:.6g} s{', assumed' if self.assumed else ''}",
            "iterations": f"{space.iterations}",
            "gravity": f"{space.gravity.x:g}, {space.gravity.y:g}",
            "error_bias": ", ".join(f"{bias:.4g}" for bias in sorted({each.error_bias for each in space.constraints})),
        }

    def start(self) -> Array:
        return self.without(None)

    def without(self, element: str | None) -> Array:
        """Accelerations of small steps from the start; extrapolated, since a step drifts before it kicks."""
        steps = [SMALL * self.mechanism.time_scale, SMALL / 2 * self.mechanism.time_scale]
        first, second = (self._kicked(step, element) for step in steps)
        return 2 * second - first

    def _kicked(self, step: float, element: str | None) -> Array:
        space, bodies = copied(self.described)
        if element is not None:
            switch_off(space, element)
        for limit in [each for each in space.constraints if is_equality(each)]:
            # It pushes from outside alone, so at the start, where it is closed, it does not act yet.
            space.remove(limit)
            space.add(both_sided(limit))
        space.iterations = max(space.iterations, SWEEPS)
        for body, (x, y, turn) in zip(bodies, self.mechanism.twist.tolist(), strict=True):
            body.velocity, body.angular_velocity = (x, y), turn
        self._stepper(space, bodies)(step)
        return (_twists(bodies) - self.mechanism.twist) / step

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        none = np.zeros(self.mechanism.row_count)
        return RowRegularisation(none, none, np.diag(none), np.full_like(none, np.nan))

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        met = [*sleepers(self.described, self.dt, t, twist), *obstacles(self.described, t, pose)]
        return sorted(met, key=lambda each: each.t)

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        """Whole gaps are closed in a step only where so many iterations are stable in every pose that is expected."""
        own, more = self.described.space.iterations, max(MORE_ITERATIONS, 2 * self.described.space.iterations)
        rho = worst_contraction(self.mechanism, EXPECTED * self.mechanism.time_scale)
        enough = sweeps(rho, max(1, len(self.mechanism.joints)), work=WORK)
        counts = sorted({own, more, enough, *((10 * more,) if further else ())})
        closed = [(count, 0.0, ahead) for count in counts if gain(rho, count) == 1 for ahead in (False, True)]
        out = []
        for kind in dict.fromkeys([(own, None, self.ahead), (more, None, self.ahead), *closed]):
            for divisor in FURTHER if further else DIVISORS:
                dt = self.dt / divisor
                if dt < smallest:
                    break
                out.append(self._change(*kind, dt))
        return out

    def _change(self, iterations: int, bias: float | None, ahead: bool, dt: float) -> Change:
        words = f"{iterations} iterations{'' if bias is None else ', error_bias 0'}"
        words += ", started half a step ahead by code that runs once" if ahead else ""
        lines = [f"space.iterations = {iterations}"] if iterations != self.described.space.iterations else []
        if bias is not None:
            lines += ["for joint in space.constraints:", f"    joint.error_bias = {bias:g}"]
        if ahead and not self.ahead:
            lines += start_ahead("space", self.described.space, dt)
        lines.append(f"# call space.step({dt!r}) in your loop; to check the space again, give --step {dt!r}")
        options = (("iterations", iterations), ("bias", bias), ("ahead", ahead))
        return Change(f"{words}, step {dt * 1e3:.4g} ms", dt, tuple(lines), options)

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        return ()

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        space, bodies = copied(self.described)
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
        pose, twist, acceleration = (np.full(shape, np.nan) for _ in range(3))
        pose[0], twist[0] = self.mechanism.pose, self.mechanism.twist
        stepping = 0.0

        def advance(count: int) -> None:
            nonlocal stepping
            begin = time.process_time()
            for _ in range(count):
                step(dt)
            stepping += time.process_time() - begin

        if ahead:
            for body in bodies:
                body.position -= body.velocity * (dt / 2)
                body.angle -= body.angular_velocity * dt / 2
            step(dt / 2)
        for sample in range(1, samples + 1):
            advance(steps - 1)
            before = _twists(bodies)
            advance(1)
            pose[sample], after = _poses(bodies), _twists(bodies)
            twist[sample] = (before + after) / 2 if ahead else after
            # The kick of a step is of the pose after its drift: this is the acceleration at the sample.
            acceleration[sample] = (after - before) / dt
            if not np.isfinite(pose[sample]).all():
                pose[sample:], twist[sample:] = np.nan, np.nan
                break
        reaction = np.full((samples + 1, self.mechanism.row_count), np.nan)
        sound = np.isfinite(acceleration).all(axis=(1, 2)) & np.isfinite(pose).all(axis=(1, 2))
        if self.mechanism.row_count and sound.any():
            reaction[sound] = self.mechanism.reaction(pose[sound], acceleration[sound], twist=twist[sound])
            # No force of pymunk holds the joints that only say how a body moves.
            held = [(joint.name, joint.size) for joint in self.mechanism.joints]
            reaction[:, [name in self.described.prescribed for name, size in held for _ in range(size)]] = np.nan
        return Trajectory(t, pose, twist, reaction, stepping)

    def _stepper(self, space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> Callable[[float], None]:
        """The space's own step, with the forces that stand on bodies set anew before it."""
        pushed = [(bodies[place], *push) for place, push in self.described.pushed.items()]
        if not pushed:
            return space.step

        def step(dt: float) -> None:
            for body, force, torque in pushed:
                body.force, body.torque = force, torque
            space.step(dt)

        return step


def start_ahead(name: str, space: pymunk.Space, dt: float) -> list[str]:
    """The lines that bring the velocities of this space, called so, half a step of dt [s] ahead of the positions."""
    keep, restore = list[str](), list[str]()
    if any(body.force.length or body.torque for body in space.bodies):  # a step takes them off
        keep = [f"pushed = [(body, body.force, body.torque) for body in {name}.bodies]"]
        restore = ["for body, force, torque in pushed:", "    body.force, body.torque = force, torque"]
    return [
        *keep,
        f"for body in {name}.bodies:  # once, before the first step, which moves them back",
        f"    body.position -= body.velocity * {dt / 2!r}",
        f"    body.angle -= body.angular_velocity * {dt / 2!r}",
        f"{name}.step({dt / 2!r})",
        *restore,
    ]


def _poses(bodies: Sequence[pymunk.Body]) -> Array:
    places = [body.local_to_world(body.center_of_gravity) for body in bodies]
    return np.array([(place.x, place.y, body.angle) for place, body in zip(places, bodies, strict=True)])


def _twists(bodies: Sequence[pymunk.Body]) -> Array:
    return np.array([(*body.velocity, body.angular_velocity) for body in bodies])


def obstacles(described: Described, t: Array, pose: Array) -> list[Obstacle]:
    """The first of each kind on poses (times, bodies, 3). Raises Unsupported for too many shapes."""
    space, bodies = copied(described)
    found: dict[str, Obstacle] = {}

    def meets(at: float, words: str, remedy: str) -> None:
        found.setdefault(words, Obstacle(float(at), words, remedy))

    shapes = [shape for shape in space.shapes if not shape.sensor]
    if len(shapes) > MOST_SHAPES:
        raise refuse("the space", f"it has {len(shapes)} shapes; more than {MOST_SHAPES} are not looked at")
    in_space = set(space.constraints)  # one that is outside keeps nothing apart, though its bodies name it
    pairs = [pair for pair in itertools.combinations(shapes, 2) if _may_touch(*pair, in_space)]
    limits = [
        (mine, label)
        for mine, label in zip(space.constraints, described.constraints.values(), strict=True)
        if isinstance(mine, SlideJoint | RotaryLimitJoint | GrooveJoint) and not is_equality(mine)
    ]
    names = {id(body): word for body, word in zip(bodies, described.words.values(), strict=True)}
    for at, poses in zip(t, pose, strict=True):
        place(bodies, poses)
        for shape in shapes:
            shape.cache_bb()
        for one, other in pairs:
            if one.bb.intersects(other.bb) and _touch(one, other):
                who = [names.get(id(shape.body), "the ground") for shape in (one, other)]
                meets(at, f"a shape of {who[0]} touches one of {who[1]}", left_out("contact"))
        for limit, label in limits:
            if _reached(limit):
                groove = isinstance(limit, GrooveJoint)
                meets(at, f"{label} reaches its end", "give a longer groove" if groove else left_out("limit"))
    return list(found.values())


def sleepers(found: Described, step: float, t: Array, twist: Array) -> list[Obstacle]:
    """Bodies that pymunk may put to sleep on twists (times, bodies, 3): idle for as long as the space says.

    Idle, as Chipmunk counts (cpSpaceProcessComponents): m v^2 + I w^2 is at most m times the square of the threshold,
    or of what gravity adds to a speed in a step if there is none. Whether a body's neighbours idle too is not asked.
    """
    space = found.space
    if isinf(space.sleep_time_threshold):
        return []
    allowed = space.idle_speed_threshold or space.gravity.length * step
    out = []
    for index, (body, word) in enumerate(found.words.items()):
        if body.body_type != pymunk.Body.DYNAMIC:
            continue
        speed = np.hypot(twist[:, index, 0], twist[:, index, 1])
        turning = 0.0 if isinf(body.moment) else body.moment / body.mass * twist[:, index, 2] ** 2
        since = np.inf
        for at, idle in zip(t, speed**2 + turning <= allowed**2, strict=True):
            since = min(since, at) if idle else np.inf
            if at - since >= space.sleep_time_threshold:
                out.append(Obstacle(float(at), f"{word} may fall asleep", left_out("sleep")))
                break
    return out


def _touch(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    try:
        return bool(one.shapes_collide(other).points)
    except AssertionError:  # what pymunk itself calls likely a bug of its own: two shapes in exactly the same place
        return True


def _may_touch(one: pymunk.Shape, other: pymunk.Shape, in_space: set[Constraint]) -> bool:
    """Whether pymunk would let these shapes collide."""
    if one.body is other.body or one.body is None or other.body is None:
        return False
    if pymunk.Body.DYNAMIC not in (one.body.body_type, other.body.body_type):
        return False
    joined: Any = one.body.constraints & other.body.constraints & in_space
    if any(not joint.collide_bodies for joint in joined):
        return False
    mine, theirs = one.filter, other.filter
    if mine.group and mine.group == theirs.group:
        return False
    return bool(mine.categories & theirs.mask) and bool(theirs.categories & mine.mask)


def _reached(limit: Any) -> bool:
    """Whether a limit is at or beyond an end where its bodies are now."""
    a, b = limit.a, limit.b
    if isinstance(limit, SlideJoint):
        apart = a.local_to_world(limit.anchor_a).get_distance(b.local_to_world(limit.anchor_b))
        return not limit.min < apart < limit.max
    if isinstance(limit, RotaryLimitJoint):
        return not limit.min < b.angle - a.angle < limit.max
    begin, end = a.local_to_world(limit.groove_a), a.local_to_world(limit.groove_b)
    share = (b.local_to_world(limit.anchor_b) - begin).dot(end - begin) / (end - begin).dot(end - begin)
    return not 0 < share < 1
