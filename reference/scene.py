"""Scenes, which define an experiment by a mechanism for engines and a reference motion."""

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
from reference.validators import INVALID, Array, of_shape, validator_of

# Approximate time between samples [s]. Every step of a sweep is a fraction of this time, so all steps have the same
# sample times.
SAMPLE_SPACING = 1e-2
Poses = Annotated[Numbers, of_shape("...", "bodies", 3)]  # Poses are NaN after the end of an engine's run.
# Names of a scene's times and their annotations.
TIME_ANNOTATIONS = (("duration", Positive), ("horizon", Positive), ("samples", Count))


Result = TypeVar("Result")


def shared(function: Callable[..., Result], *arguments: Any) -> Result:
    """The result of function(*arguments); it is cached, so that equal scenes share their integrated motion."""
    return _shared(function, *arguments)


@lru_cache(maxsize=64)
def _shared(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


class NoMotion(InvalidMechanism):
    """No finite motion can be computed for a scene, although each of its numbers is valid."""


class Scene(Valid, ABC):
    """Base of scenes: frozen dataclasses whose fields are the only data of an experiment.

    `name` is the scene's key, `source` its place in the chapter, and `duration` [s] the length of runs. Until `horizon`
    [s] errors grow at most about linearly, so that convergence orders can be fitted. `max_durations` limits `max_time`.
    """

    name: ClassVar[str]
    source: ClassVar[str]
    max_durations: ClassVar[float] = 10.0
    duration: float
    horizon: float

    def __init_subclass__(cls, **named: Any) -> None:
        """Make failed arithmetic in `mechanism`, also in a user's scene, raise NoMotion with the scene's name."""
        super().__init_subclass__(**named)
        if "mechanism" in vars(cls):
            cls.mechanism = _raising_no_motion(vars(cls)["mechanism"])  # type: ignore[method-assign]

    def __post_init__(self) -> None:
        super().__post_init__()
        field_names = {field.name for field in fields(self)}  # type: ignore[arg-type]
        for name, annotation in TIME_ANNOTATIONS:
            # Class attributes that are no fields are checked here; properties are not evaluated.
            value = inspect.getattr_static(self, name)
            if name not in field_names and not hasattr(value, "__get__"):
                validate(self._owner(), name, value, annotation)

    def __getstate__(self) -> dict[str, Any]:
        names = [field.name for field in fields(self)]  # type: ignore[arg-type]
        return {name: getattr(self, name) for name in (*names, *(["name"] if "name" in vars(self) else []))}

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """The bodies and joints at t = 0."""

    def motion(self, t: ArrayLike) -> Trajectory:
        """The reference motion with poses, twists and reactions at times t (times,) or one time [s].

        Raises InvalidMechanism unless all times are finite, between 0 and `max_time`, and before the motion's end.
        Raises NoMotion for a motion that can't be computed or is not finite.
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
    def _motion(self, times: Array) -> Trajectory:
        pass

    def _refuse_not_finite(self, motion: Trajectory) -> None:
        """Raise OverflowError for numbers that are not finite; unknown reactions are NaN.

        The squares of velocities must be finite, since energies and accelerations contain these squares.
        """
        for name, numbers, finite in (
            ("poses", motion.pose, np.isfinite),
            ("squares of velocities", motion.twist**2, np.isfinite),
            ("reactions", motion.reaction, lambda reaction: ~np.isinf(reaction)),
        ):
            at_instants = finite(numbers).reshape(len(motion.t), -1).all(axis=1)
            if not at_instants.all():
                raise OverflowError(f"its {name} are not finite numbers at {motion.t[np.argmin(at_instants)]:.6g} s")

    def times(self, t: ArrayLike) -> Array:
        """Return times [s] as an array (times,); raise InvalidMechanism unless all are between 0 and `max_time`."""
        times = sample_times(self._owner(), t)
        if times.size and times.max() > self.max_time:
            raise InvalidMechanism(
                f"{self._owner()}: t is {short_repr(t)}; its motion is known up to {self.max_time:.9g} s, which is "
                f"{self.max_durations:g} times its duration: for later times make the scene with a longer duration"
            )
        return times

    @property
    def max_time(self) -> float:
        """The last time of `motion` [s], `max_durations` times the duration.

        The error of an integrated motion grows with the time, in a chaotic motion exponentially. A closed form has an
        error of about 1e-16 of the angle of rotation since t = 0.
        """
        return self.max_durations * self.duration * (1 + 1e-9)  # multiples of a step may be rounded upwards

    def _owner(self) -> str:
        return f"scene {self.name!r}"

    @validated
    def branch_of(self, pose: Poses) -> NDArray[np.int_]:
        """The branch (assembly mode) (...,) of poses (..., bodies, 3): +1 or -1, or 0 for scenes with one branch.

        Raises InvalidMechanism if the number of bodies is wrong.
        """
        bodies, actual = len(self.mechanism().bodies), np.shape(pose)[-2]
        if actual != bodies:
            raise InvalidMechanism(f"{self._owner()}: pose is of {actual} bodies; it must be of {bodies}")
        return self._branch_of(np.asarray(pose))

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        return np.zeros(pose.shape[:-2], dtype=int)

    @property
    def comparable_until(self) -> float:
        """The time [s] until which real bodies can follow the ideal motion."""
        return math.inf

    @property
    def samples(self) -> int:
        """The number of sampling intervals in the duration."""
        return max(1, round(self.duration / SAMPLE_SPACING))

    @property
    def spacing(self) -> float:
        return self.duration / self.samples


class PlacedScene(Scene):
    """A scene that defines the motion of its bodies; the reactions follow from the accelerations by Newton's law."""

    @abstractmethod
    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (times, bodies, 3) at checked times (times,) [s]."""

    @cached_property
    def _mechanism(self) -> Mechanism:
        return self.mechanism()

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, acceleration = self.placement(times)
        reaction = self._mechanism.reaction(pose, acceleration, twist=twist)
        if not np.isfinite(reaction).all():
            raise OverflowError("the reactions that its accelerations need are not finite")
        return Trajectory(times, pose, twist, reaction)


@contextmanager
def _named(owner: str, trouble: str) -> Iterator[None]:
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


def _raising_no_motion(mechanism: Callable[[Any], Mechanism]) -> Callable[[Any], Mechanism]:
    @wraps(mechanism)
    def raising_no_motion(scene: Scene) -> Mechanism:
        with np.errstate(all="ignore"), _named(scene._owner(), "its numbers make no mechanism"):
            return mechanism(scene)

    return raising_no_motion


def with_settings(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """The scene with fields set by name from text, such as "0.5", "(0, -9.81)" or "True".

    Returns the scene itself if no value changes. Raises InvalidMechanism for an unknown field, for a value that is not
    valid for the field, and for numbers from which no mechanism can be made. The message suggests the nearest field.
    """
    names = [field.name for field in fields(scene)]  # type: ignore[arg-type]
    hints = typing.get_type_hints(type(scene), include_extras=True)
    values: dict[str, Any] = {}
    for name, text in settings.items():
        if name not in names:
            near = difflib.get_close_matches(name, names, 1, 0.0)
            raise InvalidMechanism(
                f"{scene.name} has no number called {name!r}; did you mean {near[0]!r}? There are {', '.join(names)}"
            )
        validator = validator_of(hints[name])
        readings = [validator.validate(reading) for reading in _readings(text)]
        value = next((reading for reading in readings if reading is not INVALID), INVALID)
        if value is INVALID:
            raise refusal(scene.name, name, _readings(text)[0], validator.words)
        if value != getattr(scene, name):
            values[name] = value
    if not values:
        return scene
    name = _name(scene.name, {name: values[name] for name in names if name in values})
    changed = named(_replaced(scene, values), name)
    changed.mechanism()  # raises an error if the values are not valid together
    return changed


def with_distinct_names(scenes: tuple[Scene, ...]) -> tuple[Scene, ...]:
    """The scenes with distinct names; equal names are extended by numbers that differ from the defaults."""
    names = [scene.name for scene in scenes]
    return tuple(
        named(_replaced(scene, {}), _name(scene.name, _changed_fields(scene)))
        if names.count(scene.name) > 1 and _changed_fields(scene)
        else scene
        for scene in scenes
    )


def named(scene: Scene, name: str) -> Scene:
    """Set the name of a scene and return it. The name does not count when scenes are compared."""
    object.__setattr__(scene, "name", name)
    return scene


def _replaced(scene: Scene, values: Mapping[str, Any]) -> Scene:
    return replace(scene, **values)  # type: ignore[type-var]


def _readings(text: str) -> list[Any]:
    try:
        return [ast.literal_eval(text.strip()), text]
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return [text]


def _changed_fields(scene: Scene) -> dict[str, Any]:
    defaults = {field.name: field.default for field in fields(scene)}  # type: ignore[arg-type]
    return {
        name: getattr(scene, name)
        for name, default in defaults.items()
        if default is MISSING or getattr(scene, name) != default
    }


def _name(base: str, values: Mapping[str, Any]) -> str:
    return " ".join([base, *(f"{name}={_short(value)}" for name, value in values.items())])


def _short(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({','.join(map(_short, value))})"
    text = repr(value) if not isinstance(value, str) else value
    return "".join(text.removesuffix(".0").split())
