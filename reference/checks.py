"""Runtime validation of fields and arguments from their annotations.

A frozen dataclass that inherits from `Valid` checks its fields when it is made. A function with `validated` checks its
arguments when it is called. Both raise InvalidMechanism, a ValueError, with a sentence that states which value is
wrong, why, and which values are valid. Numbers of numpy are converted to numbers of Python. Lists and arrays are
converted to the declared type, a tuple or an array of floats. So equal settings have equal reprs.
Relations between values (lengths that assemble) are checked by the class itself. The validators are in
`reference.validators`.
"""

from __future__ import annotations

import inspect
import math
import typing
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from functools import cache, cached_property, wraps
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from reference.validators import COMPLEX, INVALID, NOT_FINITE, Array, Rule, Validator, from_to, validator_of

# Maximum number of characters of a value in a message.
MAX_CHARACTERS = 80
# The largest C int, since engines store counts in this type.
LARGEST_COUNT = 2**31 - 1
_ABOVE_ZERO = Rule(lambda value: value > 0, "greater than zero")

Positive = Annotated[float, _ABOVE_ZERO]
NonNegative = Annotated[float, Rule(lambda value: value >= 0, "not below zero")]
Fraction = Annotated[float, from_to(0, 1)]
Count = Annotated[int, from_to(1, LARGEST_COUNT)]
Sign = Annotated[int, Rule(lambda value: value in (1, -1), "that is 1 or -1")]
Signs = Annotated[ArrayLike, Rule(lambda value: np.all(np.abs(value) == 1), "each 1 or -1")]
Name = Annotated[str, Rule(lambda value: value.strip() and value.isprintable(), "that is not empty and can be printed")]
Numbers = Annotated[Array, NOT_FINITE]  # Unknown values are NaN.
Complexes = Annotated[Any, COMPLEX]  # Array arguments of functions that are differentiated by a complex step.
AnyComplexes = Annotated[Complexes, NOT_FINITE]
Times = Annotated[
    ArrayLike, Rule(lambda value: np.ndim(value) < 2 and np.all(np.asarray(value) >= 0), "in one row, none below zero")
]


class InvalidMechanism(ValueError):
    """An invalid body, joint, setting or argument; the message states the value, the reason and the valid values."""


class NotFinite(InvalidMechanism, ArithmeticError):
    """An argument that is infinite or NaN and must be finite."""


def short_repr(value: Any) -> str:
    """The repr of a value in one short line."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # an int with too many digits, or an object that can't be printed
        text = f"something of the type {type(value).__name__}"
    return text if len(text) <= MAX_CHARACTERS else f"{text[: MAX_CHARACTERS - 3]}..."


def refusal(owner: str, name: str, value: Any, words: str) -> InvalidMechanism:
    """The error for a value without the required property: NotFinite for an infinity or NaN, else InvalidMechanism."""
    plain = isinstance(value, float | complex | np.ndarray | np.generic) and np.asarray(value).dtype.kind in "fc"
    error = NotFinite if plain and not np.isfinite(value).all() else InvalidMechanism
    return error(f"{owner}: {name} is {short_repr(value)}; it must be {words}")


@cache
def _validators_of_fields(cls: type) -> dict[str, Validator]:
    hints = typing.get_type_hints(cls, include_extras=True)
    return {field.name: validator_of(hints[field.name]) for field in fields(cls)}


class Valid:
    """The base of a frozen dataclass whose fields are checked.

    A `__post_init__` in a subclass begins with `super().__post_init__()`. An array becomes a read-only copy, since
    results that are computed from it are cached.
    """

    _copies: ClassVar[bool] = True

    def __post_init__(self) -> None:
        values = self.__dict__
        for name, kind in _validators_of_fields(type(self)).items():
            value = values[name]
            taken = kind.validate(value)
            if taken is INVALID:
                raise refusal(self._owner(), name, value, kind.words)
            if self._copies and isinstance(taken, np.ndarray) and taken.flags.writeable:
                taken = freeze(taken.copy())
            if taken is not value:
                values[name] = taken

    def _owner(self) -> str:
        name = self.__dict__.get("name")
        return f"{type(self).__name__} {short_repr(name)}" if isinstance(name, str) else type(self).__name__


Function = TypeVar("Function", bound=Callable[..., Any])


def validated(function: Function) -> Function:
    """Check a function's arguments by the annotations before each call; the object of a method is not checked.

    Functions that users call are validated; loops call unchecked functions.
    """
    parameters = inspect.signature(function).parameters.values()
    names = [item.name for item in parameters if item.kind not in (item.VAR_KEYWORD, item.VAR_POSITIONAL)]

    @cache
    def kinds() -> dict[str, Validator]:
        hints = typing.get_type_hints(function, include_extras=True)
        return {name: validator_of(hints[name]) for name in names if name in hints}

    def take_argument(name: str, value: Any) -> Any:
        kind = kinds().get(name)
        taken = value if kind is None else kind.validate(value)
        if taken is INVALID and kind is not None:
            raise refusal(function.__qualname__, name, value, kind.words)
        return taken

    @wraps(function)
    def checked(*given: Any, **named: Any) -> Any:
        plain = [*(take_argument(*pair) for pair in zip(names, given, strict=False)), *given[len(names) :]]
        named = {name: take_argument(name, value) for name, value in named.items()}
        try:
            return function(*plain, **named)
        except ArithmeticError as reason:  # for example division by zero or overflow
            if isinstance(reason, InvalidMechanism):
                raise
            raise InvalidMechanism(
                f"{function.__qualname__}: it has no value for these arguments: {reason}; give others"
            ) from reason

    checked.__validated__ = True  # type: ignore[attr-defined]
    return checked  # type: ignore[return-value]


def index_of(owner: str, name: str, value: int, count: int) -> int:
    """Return an index between 0 and `count` - 1; raise InvalidMechanism for other values."""
    return validate(owner, name, value, Annotated[int, from_to(0, count - 1)])


def sample_times(owner: str, t: ArrayLike) -> Array:
    """Return times [s] as an array (times,); raise InvalidMechanism unless all are finite and not negative."""
    return np.atleast_1d(np.asarray(validate(owner, "t", t, Times), dtype=float))


def validate(owner: str, name: str, value: Any, annotation: Any) -> Any:
    """Check one value by its annotation, and return the plain value."""
    kind = validator_of(annotation)
    taken = kind.validate(value)
    if taken is INVALID:
        raise refusal(owner, name, value, kind.words)
    return taken


Value = TypeVar("Value")


def freeze(value: Value) -> Value:
    """Make all arrays in the value read-only and return the value.

    An engine that changed a mechanism's arrays would change the rows of all engines that run later.
    """
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, tuple):
        for member in value:
            freeze(member)
    elif is_dataclass(value):
        for field in fields(value):
            freeze(getattr(value, field.name))
    return value


class cached_readonly(cached_property[Value]):
    def __init__(self, function: Callable[[Any], Value]) -> None:
        super().__init__(lambda owner: freeze(function(owner)))
        self.__doc__ = function.__doc__


# Maximum number of bytes of one array, which is far above the need of this suite's scenes. A machine with 8 GB has
# memory for such an array and for the copies in linear algebra.
LARGEST_ARRAY = 2 * 2**30


def require_room(what: str, shape: Sequence[int], size: int = 8, largest: int = LARGEST_ARRAY) -> None:
    """Raise InvalidMechanism if an array of this shape, with elements of `size` bytes, takes more than `largest`."""
    wanted = math.prod(shape) * size
    if wanted > largest:
        raise InvalidMechanism(
            f"{what} of the shape {tuple(shape)} would take {wanted:.3g} bytes; more than {largest:.3g} are refused"
        )
