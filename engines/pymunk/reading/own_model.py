"""A user's pymunk space as it is: copied, and stepped with its own settings or with others that pymunk documents."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import RotaryLimitJoint, SlideJoint

from engines.pymunk.reading.joints import Described
from engines.pymunk.reading.obstacles import obstacles, sleepers
from engines.reading import Change, Give, Obstacle
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
DIVISORS = (1, 2, 4, 8, 16, 32, 64, 128, 256)
MORE_ITERATIONS = 50
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
        space.remove(*[each for each in space.constraints if isinstance(each, SlideJoint | RotaryLimitJoint)])
    elif element == "sleep":
        space.sleep_time_threshold = inf
    else:
        raise ValueError(f"--without is {element!r}; it must be one of contact, damping, limit, sleep")


@dataclass(frozen=True, eq=False)
class OwnPymunk:
    """A space and what it describes; see `engines.reading.OwnModel`. `step` [s]: the user's."""

    described: Described
    mechanism: Mechanism
    step: float
    unknown_step: bool  # the space has not been stepped, and no step was named

    @property
    def engine(self) -> str:
        return "pymunk"

    @property
    def dt(self) -> float:
        return self.step

    @property
    def assumed(self) -> str:
        if not self.unknown_step:
            return ""
        return f"a step of {self.step:.4g} s, since the space has not been stepped (give yours with --step)"

    @property
    def softly_held(self) -> bool:
        return False

    @property
    def declares(self) -> bool:
        """How far joints give way follows from steps and sweeps: pymunk declares no law without them."""
        return False

    @property
    def elements(self) -> Sequence[str]:
        return ("contact", "limit")

    @property
    def suspects(self) -> Mapping[str, str]:
        return self.described.suspects

    @property
    def settings(self) -> Mapping[str, str]:
        space = self.described.space
        known = ", assumed" if self.assumed else ""
        out = {
            "step": f"{self.step:.6g} s{known}",
            "iterations": f"{space.iterations}",
            "gravity": f"{space.gravity.x:g}, {space.gravity.y:g}",
        }
        biases = sorted({joint.error_bias for joint in space.constraints})
        out["error_bias"] = ", ".join(f"{bias:.4g}" for bias in biases)
        return out

    def start(self) -> Array:
        return self._start(None)

    def without(self, element: str) -> Array:
        return self._start(element)

    def _start(self, element: str | None) -> Array:
        """What small steps make of the velocities; extrapolated, since a step drifts before it kicks."""
        steps = [SMALL * self.mechanism.time_scale, SMALL / 2 * self.mechanism.time_scale]
        first, second = (self._kicked(step, element) for step in steps)
        return 2 * second - first

    def _kicked(self, step: float, element: str | None) -> Array:
        space, bodies = self._fresh()
        if element is not None:
            switch_off(space, element)
        space.iterations = max(space.iterations, SWEEPS)
        self._stepper(space, bodies)(step)
        return (_twists(bodies) - self.mechanism.twist) / step

    def give(self, gap: Array) -> Give:
        none = np.zeros(self.mechanism.row_count)
        return Give(none, none, none, np.full_like(none, np.nan))

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        space, bodies = self._fresh()
        words, labels = list(self.described.words.values()), list(self.described.constraints.values())
        asleep = sleepers(self.described, self.step, t, twist)
        met = [*asleep, *obstacles(space, bodies, words, labels, t, pose)]
        return sorted(met, key=lambda each: each.t)

    def changes(self, smallest: float) -> list[Change]:
        space = self.described.space
        own, more = space.iterations, max(MORE_ITERATIONS, 2 * space.iterations)
        out = []
        for iterations, bias in ((own, None), (own, 0.0), (more, None), (more, 0.0)):
            for divisor in DIVISORS:
                dt = self.step / divisor
                if dt < smallest:
                    break
                words = f"{iterations} iterations{'' if bias is None else ', error_bias 0'}, step {dt * 1e3:.4g} ms"
                lines = [f"space.iterations = {iterations}"] if iterations != own else []
                if bias is not None:
                    lines += ["for joint in space.constraints:", f"    joint.error_bias = {bias:g}"]
                # A comment: a space that a pasted line has stepped once is open by a step, and no start to check.
                lines.append(f"# call space.step({dt!r}) in your loop; to check the space again, give --step {dt!r}")
                out.append(Change(words, dt, tuple(lines), (("iterations", iterations), ("bias", bias))))
        return out

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        space, bodies = self._fresh()
        dt, spacing = self.step, every * self.step
        if change is not None:
            options, dt = dict(change.options), change.dt
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
        for sample in range(1, samples + 1):
            begin = time.process_time()
            for _ in range(steps - 1):
                step(dt)
            stepping += time.process_time() - begin
            before, begin = _twists(bodies), time.process_time()
            step(dt)
            stepping += time.process_time() - begin
            pose[sample], twist[sample] = _poses(bodies), _twists(bodies)
            # The kick of a step is of the pose after its drift: this is the acceleration at the sample.
            acceleration[sample] = (twist[sample] - before) / dt
            if not np.isfinite(pose[sample]).all():
                pose[sample:], twist[sample:] = np.nan, np.nan
                break
        reaction = np.full((samples + 1, self.mechanism.row_count), np.nan)
        sound = np.isfinite(acceleration).all(axis=(1, 2)) & np.isfinite(pose).all(axis=(1, 2))
        if self.mechanism.row_count and sound.any():
            reaction[sound] = self.mechanism.reaction(pose[sound], acceleration[sound], twist=twist[sound])
            reaction[:, self._prescribed] = np.nan
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

    @property
    def _prescribed(self) -> NDArray[np.bool_]:
        """Rows (rows,) that only say how a body moves: no force of pymunk holds them."""
        names = [joint.name for joint in self.mechanism.joints for _ in range(joint.size)]
        return np.array([name in self.described.prescribed for name in names], dtype=bool)

    def _fresh(self) -> tuple[pymunk.Space, list[pymunk.Body]]:
        """A copy of the space, and its bodies in the mechanism's order."""
        given = self.described.space
        order = list(given.bodies)
        places = [order.index(body) for body in self.described.moving]
        space = given.copy()
        # No body falls asleep in what is judged (`sleepers`), and pymunk (7.3.1) aborts after some copies in which
        # bodies do.
        space.sleep_time_threshold = inf
        copies = list(space.bodies)
        for mine, own in zip(copies, order, strict=True):
            if own.center_of_gravity.length:
                # pymunk (7.3.1) places a copy before it knows where the centre of mass is, and so elsewhere.
                mine.angle, mine.position = own.angle, own.position
        bodies = [copies[place] for place in places]
        return space, bodies


def _poses(bodies: Sequence[pymunk.Body]) -> Array:
    places = [body.local_to_world(body.center_of_gravity) for body in bodies]
    return np.array([(place.x, place.y, body.angle) for place, body in zip(places, bodies, strict=True)])


def _twists(bodies: Sequence[pymunk.Body]) -> Array:
    return np.array([(*body.velocity, body.angular_velocity) for body in bodies])
