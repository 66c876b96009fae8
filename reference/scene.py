"""A scene: the numbers of one experiment, read by engines as a mechanism and by the textbook as a motion."""

from __future__ import annotations

import ast
import difflib
import inspect
import math
import typing
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, fields, replace
from functools import cached_property, lru_cache, wraps
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import (
    Count,
    InvalidMechanism,
    Numbers,
    Positive,
    Valid,
    refusal,
    sample_times,
    short_repr,
    validate,
    validated,
)
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reference.validators import INVALID, Floats, of_shape, validator_of

# Samples stand about this far apart [s]; every step of a sweep divides the distance: all steps meet the same instants.
SAMPLE_SPACING = 1e-2
Poses = Annotated[Numbers, of_shape("...", "bodies", 3)]  # of all bodies; NaN where an engine gave up
TIMES = (("duration", Positive), ("horizon", Positive), ("samples", Count))  # what a scene's times may be


Result = TypeVar("Result")


def shared(function: Callable[..., Result], *arguments: Any) -> Result:
    """function(*arguments), computed once for equal arguments: equal scenes share their integrated motion."""
    return _shared(function, *arguments)


@lru_cache(maxsize=64)
def _shared(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


class NoMotion(InvalidMechanism):
    """The numbers of a scene are valid each, and no finite motion can be computed from them."""


class Scene(Valid, ABC):
    """Subclasses are frozen dataclasses, and their fields are the only place where a number is written.

    `name` is the scene's key, `source` where the chapter has it. `duration` [s] is how long it runs; until `horizon`
    [s] an error grows no faster than about linearly, so that orders can be fitted.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    max_durations: ClassVar[float] = 10.0  # durations, see `max_time`
    duration: float
    horizon: float

    def __init_subclass__(cls, **named: Any) -> None:
        """Failed arithmetic in the `mechanism` of any scene, ours or a user's, becomes a sentence with its name."""
        super().__init_subclass__(**named)
        if "mechanism" in vars(cls):
            cls.mechanism = _in_words(vars(cls)["mechanism"])  # type: ignore[method-assign]

    def __post_init__(self) -> None:
        super().__post_init__()
        own = {field.name for field in fields(self)}  # type: ignore[arg-type]
        for name, annotation in TIMES:
            # What a class sets without a field; a property is worked out only when it is asked for.
            value = inspect.getattr_static(self, name)
            if name not in own and not hasattr(value, "__get__"):
                validate(self._owner(), name, value, annotation)

    def __getstate__(self) -> dict[str, Any]:
        """Its numbers alone, so that a scene travels to another process without what it has worked out.

        A scene with other numbers may have a name of its own (`reference.scene`), which travels with them.
        """
        own = [field.name for field in fields(self)]  # type: ignore[arg-type]
        return {name: getattr(self, name) for name in (*own, *(["name"] if "name" in vars(self) else []))}

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """The bodies and joints at t = 0."""

    def motion(self, t: ArrayLike) -> Trajectory:
        """The truth at times t (times,) [s], or at one: poses, twists, reactions.

        Raises InvalidMechanism unless all times are finite and lie from 0 to `max_time`, or where the motion itself
        ends; NoMotion where it can't be computed, or is not finite.
        """
        times = self.times(t)
        until = f"no motion is known up to {times.max(initial=0.0):.9g} s"
        with np.errstate(all="ignore"), _named(self._owner(), until):
            motion = self._motion(times if times.size else np.zeros(1))
            self._refuse_not_finite(motion)
        if times.size:
            return motion
        return Trajectory(times, motion.pose[:0], motion.twist[:0], motion.reaction[:0])

    @abstractmethod
    def _motion(self, times: Floats) -> Trajectory:
        """The truth at times (times,) [s] that `motion` has checked; at least one."""

    def _refuse_not_finite(self, motion: Trajectory) -> None:
        """Raise OverflowError for a motion with which nothing can be compared; unknown reactions are NaN.

        Energies and accelerations are made of the squares of velocities.
        """
        for name, numbers, finite in (
            ("poses", motion.pose, np.isfinite),
            ("squares of velocities", motion.twist**2, np.isfinite),
            ("reactions", motion.reaction, lambda reaction: ~np.isinf(reaction)),
        ):
            at_instants = finite(numbers).reshape(len(motion.t), -1).all(axis=1)
            if not at_instants.all():
                raise OverflowError(f"its {name} are not finite numbers at {motion.t[np.argmin(at_instants)]:.6g} s")

    def times(self, t: ArrayLike) -> Floats:
        """Times [s], or one, as an array (times,); InvalidMechanism unless each is finite and from 0 to `max_time`."""
        times = sample_times(self._owner(), t)
        if times.size and times.max() > self.max_time:
            raise InvalidMechanism(
                f"{self._owner()}: t is {short_repr(t)}; its motion is known up to {self.max_time:.9g} s, which is "
                f"{self.max_durations:g} times its duration: for later times make the scene with a longer duration"
            )
        return times

    @property
    def max_time(self) -> float:
        """The last time that `motion` answers [s], `max_durations` times the duration.

        A truth by integration takes time and loses digits in proportion to the time asked for, a chaotic one loses all
        of them, and even a closed form knows the angle after a time t only to about 1e-16 of what was turned since 0.
        """
        return self.max_durations * self.duration * (1 + 1e-9)  # multiples of a step may be rounded upwards

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


class PlacedScene(Scene):
    """A scene that knows where its bodies are: its reactions are those that their accelerations need."""

    @abstractmethod
    def placement(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Poses, twists and accelerations (times, bodies, 3) at times (times,) [s] that are checked."""

    @cached_property
    def _mechanism(self) -> Mechanism:
        return self.mechanism()

    def _motion(self, times: Floats) -> Trajectory:
        pose, twist, acceleration = self.placement(times)
        reaction = self._mechanism.reaction(pose, acceleration, twist=twist)
        if not np.isfinite(reaction).all():
            raise OverflowError("the reactions that its accelerations need are not finite")
        return Trajectory(times, pose, twist, reaction)


@contextmanager
def _named(owner: str, trouble: str) -> Iterator[None]:
    """Failed arithmetic within becomes NoMotion, and every refusal begins with the owner's name."""
    try:
        yield
    except InvalidMechanism as reason:
        if isinstance(reason, ArithmeticError):
            raise NoMotion(f"{owner}: {trouble}: {reason}") from reason
        if str(reason).startswith(owner):
            raise
        raise type(reason)(f"{owner}: {reason}") from reason
    except (ArithmeticError, np.linalg.LinAlgError, MemoryError) as reason:
        raise NoMotion(f"{owner}: {trouble}: {reason.args[-1] if reason.args else type(reason).__name__}") from reason


def _in_words(mechanism: Callable[[Any], Mechanism]) -> Callable[[Any], Mechanism]:
    @wraps(mechanism)
    def in_words(scene: Scene) -> Mechanism:
        with np.errstate(all="ignore"), _named(scene._owner(), "its numbers make no mechanism"):
            return mechanism(scene)

    return in_words


def with_settings(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """The scene with fields set by their names, each value a text as it is typed: 0.5, (0, -9.81), True.

    Fields that get the value they have already are not set, and a scene with none is the scene itself. Raises
    InvalidMechanism, in a sentence: for a name that is no field, with the nearest one; for a value that the field does
    not take; for numbers that make no mechanism.
    """
    known = [field.name for field in fields(scene)]  # type: ignore[arg-type]
    hints = typing.get_type_hints(type(scene), include_extras=True)
    values: dict[str, Any] = {}
    for name, text in settings.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.0)
            raise InvalidMechanism(
                f"{scene.name} has no number called {name!r}; did you mean {near[0]!r}? There are {', '.join(known)}"
            )
        kind = validator_of(hints[name])
        taken = next((value for each in _readings(text) if (value := kind.validate(each)) is not INVALID), INVALID)
        if taken is INVALID:
            raise refusal(scene.name, name, _readings(text)[0], kind.words)
        if taken != getattr(scene, name):
            values[name] = taken
    if not values:
        return scene
    name = _name(scene.name, {name: values[name] for name in known if name in values})
    changed = named(_replaced(scene, values), name)
    changed.mechanism()  # raises for numbers that are valid each and no mechanism together
    return changed


def told_apart(scenes: tuple[Scene, ...]) -> tuple[Scene, ...]:
    """The scenes, those of one class and name called after the numbers in which they differ from its defaults."""
    names = [scene.name for scene in scenes]
    return tuple(
        named(_replaced(scene, {}), _name(scene.name, _set(scene)))
        if names.count(scene.name) > 1 and _set(scene)
        else scene
        for scene in scenes
    )


def named(scene: Scene, name: str) -> Scene:
    """The same object, called so. Its numbers decide whether two scenes are equal, as with any dataclass."""
    object.__setattr__(scene, "name", name)
    return scene


def _replaced(scene: Scene, values: Mapping[str, Any]) -> Scene:
    return replace(scene, **values)  # type: ignore[type-var]


def _readings(text: str) -> list[Any]:
    """What a text may stand for: a value as Python writes it, or the text itself."""
    try:
        return [ast.literal_eval(text.strip()), text]
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return [text]


def _set(scene: Scene) -> dict[str, Any]:
    """The fields whose values are not their class's defaults."""
    defaults = {field.name: field.default for field in fields(scene)}  # type: ignore[arg-type]
    return {
        name: getattr(scene, name)
        for name, default in defaults.items()
        if default is MISSING or getattr(scene, name) != default
    }


def _name(base: str, values: Mapping[str, Any]) -> str:
    return " ".join([base, *(f"{name}={_short(value)}" for name, value in values.items())])


def _short(value: Any) -> str:
    """A value with all its digits, in few letters and without blanks."""
    if isinstance(value, tuple):
        return f"({','.join(map(_short, value))})"
    text = repr(value) if not isinstance(value, str) else value
    return "".join(text.removesuffix(".0").split())
