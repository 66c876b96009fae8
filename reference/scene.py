"""A scene: the numbers of one experiment, read by engines as a mechanism and by the textbook as a motion."""

from __future__ import annotations

import inspect
import math
from abc import ABC, abstractmethod
from dataclasses import fields
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Count, InvalidMechanism, Numbers, Positive, Valid, sample_times, shown, take, validated
from reference.kinds import Floats, of_shape
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

# Samples stand about this far apart [s]; every step of a sweep divides the distance: all steps meet the same instants.
SAMPLE_SPACING = 1e-2
Poses = Annotated[Numbers, of_shape("...", "bodies", 3)]  # of all bodies; NaN where an engine gave up
TIMES = (("duration", Positive), ("horizon", Positive), ("samples", Count))  # what a scene's times may be


class Scene(Valid, ABC):
    """Subclasses are frozen dataclasses, and their fields are the only place where a number is written.

    `name` is the scene's key, `source` where the chapter has it. `duration` [s] is how long it runs; until `horizon`
    [s] an error grows no faster than about linearly, so that orders can be fitted.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    reach: ClassVar[float] = 10.0  # durations, see `latest`
    duration: float
    horizon: float

    def __post_init__(self) -> None:
        super().__post_init__()
        own = {field.name for field in fields(self)}  # type: ignore[arg-type]
        for name, annotation in TIMES:
            # What a class sets without a field; a property is worked out only when it is asked for.
            value = inspect.getattr_static(self, name)
            if name not in own and not hasattr(value, "__get__"):
                take(self._owner(), name, value, annotation)

    def __getstate__(self) -> dict[str, Any]:
        """Its numbers alone, so that a scene travels to another process without what it has worked out.

        A scene with other numbers may have a name of its own (`reference.variation`), which travels with them.
        """
        own = [field.name for field in fields(self)]  # type: ignore[arg-type]
        return {name: getattr(self, name) for name in (*own, *(["name"] if "name" in vars(self) else []))}

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """The bodies and joints at t = 0."""

    def motion(self, t: ArrayLike) -> Trajectory:
        """The truth at times t (times,) [s], or at one: poses, twists, reactions.

        Raises InvalidMechanism unless all times are finite and lie from 0 to `latest`, or where the motion itself ends.
        """
        times = self.times(t)
        try:
            motion = self._motion(times if times.size else np.zeros(1))
        except ArithmeticError as reason:
            raise InvalidMechanism(
                f"{self._owner()}: no motion is known up to {times.max():.9g} s: {reason}"
            ) from reason
        if times.size:
            return motion
        return Trajectory(times, motion.pose[:0], motion.twist[:0], motion.reaction[:0])

    @abstractmethod
    def _motion(self, times: Floats) -> Trajectory:
        """The truth at times (times,) [s] that `motion` has checked; at least one."""

    def times(self, t: ArrayLike) -> Floats:
        """Times [s], or one, as an array (times,); InvalidMechanism unless each is finite and from 0 to `latest`."""
        times = sample_times(self._owner(), t)
        if times.size and times.max() > self.latest:
            raise InvalidMechanism(
                f"{self._owner()}: t is {shown(t)}; its motion is known up to {self.latest:.9g} s, which is "
                f"{self.reach:g} times its duration: for later times make the scene with a longer duration"
            )
        return times

    @property
    def latest(self) -> float:
        """The last time that `motion` answers [s], `reach` times the duration.

        A truth by integration takes time and loses digits in proportion to the time asked for, a chaotic one loses all
        of them, and even a closed form knows the angle after a time t only to about 1e-16 of what was turned since 0.
        """
        return self.reach * self.duration * (1 + 1e-9)  # multiples of a step may be rounded upwards

    def _owner(self) -> str:
        return f"scene {self.name!r}"

    @validated
    def branch_of(self, pose: Poses) -> NDArray[np.int_]:
        """The branch (assembly mode) (...,) of poses (..., bodies, 3): +1, -1; 0 where a scene has only one.

        Raises InvalidMechanism for poses of another number of bodies than its mechanism has.
        """
        bodies, given = len(self.mechanism().bodies), np.shape(pose)[-2]
        if given != bodies:
            raise InvalidMechanism(f"{self._owner()}: pose is of {given} bodies; it must be of {bodies}")
        return self._branch_of(np.asarray(pose))

    def _branch_of(self, pose: Floats) -> NDArray[np.int_]:
        """The same of poses that `branch_of` has checked."""
        return np.zeros(pose.shape[:-2], dtype=int)

    @property
    def comparable_until(self) -> float:
        """Up to when a body could do what the ideal motion asks of it [s]; beyond, no comparison with it is valid."""
        return math.inf

    @property
    def samples(self) -> int:
        """Sampling intervals over the duration."""
        return max(1, round(self.duration / SAMPLE_SPACING))

    @property
    def spacing(self) -> float:
        """The time between samples [s]."""
        return self.duration / self.samples
