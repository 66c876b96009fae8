"""Runtime validation of fields and arguments from their annotations.

A frozen dataclass that inherits from `Valid` has its fields checked when it is made, a function with `validated` its
arguments when it is called. Either raises InvalidMechanism, a ValueError, in a sentence that says which value, why, and
what would be valid. Values become plain ones: numpy's numbers become Python's, lists and arrays become tuples where a
tuple is declared and arrays of floats where an array is; so equal settings have equal reprs. Relations between values
(lengths that assemble) are checked by hand afterwards. `reference.validators` has the validators.
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

from reference.validators import COMPLEX, INVALID, NOT_FINITE, Floats, Rule, Validator, from_to, validator_of

MOST_LETTERS = 80  # of a value in a message

LARGEST_COUNT = 2**31 - 1  # of a C int: engines count in these
_ABOVE_ZERO = Rule(lambda value: value > 0, "greater than zero")

Positive = Annotated[float, _ABOVE_ZERO]
NonNegative = Annotated[float, Rule(lambda value: value >= 0, "not below zero")]
Fraction = Annotated[float, from_to(0, 1)]
Count = Annotated[int, from_to(1, LARGEST_COUNT)]
Sign = Annotated[int, Rule(lambda value: value in (1, -1), "that is 1 or -1")]
Signs = Annotated[ArrayLike, Rule(lambda value: np.all(np.abs(value) == 1), "each 1 or -1")]
Name = Annotated[str, Rule(lambda value: value.strip() and value.isprintable(), "that is not empty and can be printed")]
Numbers = Annotated[Floats, NOT_FINITE]  # NaN where an engine or a truth can't tell
Complexes = Annotated[Any, COMPLEX]  # in any shape, real or complex: a complex step passes through what takes these
AnyComplexes = Annotated[Complexes, NOT_FINITE]
Times = Annotated[
    ArrayLike,
    Rule(lambda value: np.ndim(value) < 2 and np.all(np.asarray(value) >= 0), "in one row, none below zero"),
]


class InvalidMechanism(ValueError):
    """A body, joint, setting or argument that can't be: which value, why, and what would be valid."""


class NotFinite(InvalidMechanism, ArithmeticError):
    """An argument that overflowed or is NaN where a finite number must be."""


def short_repr(value: Any) -> str:
    """A value in one short line."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # a whole number of too many digits, an object that can't be printed
        text = f"something of the type {type(value).__name__}"
    return text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 3]}..."


def refusal(owner: str, name: str, value: Any, words: str) -> InvalidMechanism:
    """The error for a value that isn't what the words say; NotFinite for numbers with an infinity or NaN."""
    plain = isinstance(value, float | complex | np.ndarray | np.generic) and np.asarray(value).dtype.kind in "fc"
    error = NotFinite if plain and not np.isfinite(value).all() else InvalidMechanism
    return error(f"{owner}: {name} is {short_repr(value)}; it must be {words}")


@cache
def _validators_of_fields(cls: type) -> dict[str, Validator]:
    """The validator of every field, by name."""
    hints = typing.get_type_hints(cls, include_extras=True)
    return {field.name: validator_of(hints[field.name]) for field in fields(cls)}


class Valid:
    """The base of a frozen dataclass whose fields are checked: what more a class has to check follows this.

    A class with a `__post_init__` of its own begins it with `super().__post_init__()`. An array becomes a copy that
    can't be written, since what is worked out from it is kept.
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
        """Who it is in a message: its class, and its name if that is a field."""
        name = self.__dict__.get("name")
        return f"{type(self).__name__} {short_repr(name)}" if isinstance(name, str) else type(self).__name__


Function = TypeVar("Function", bound=Callable[..., Any])


def validated(function: Function) -> Function:
    """Check a function's arguments by their annotations before it runs; a method's own object is not looked at.

    For what users call. A loop that calls a function at every step has an unchecked one inside.
    """
    parameters = inspect.signature(function).parameters.values()
    names = [each.name for each in parameters if each.kind not in (each.VAR_KEYWORD, each.VAR_POSITIONAL)]

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
        except ArithmeticError as reason:  # a division by zero, a number too large, a root that is not found
            if isinstance(reason, InvalidMechanism):
                raise
            raise InvalidMechanism(
                f"{function.__qualname__}: it has no value for these arguments: {reason}; give others"
            ) from reason

    checked.__validated__ = True  # type: ignore[attr-defined]
    return checked  # type: ignore[return-value]


def index_of(owner: str, name: str, value: int, count: int) -> int:
    """A place among `count`, counted from 0; InvalidMechanism for any other."""
    return validate(owner, name, value, Annotated[int, from_to(0, count - 1)])


def sample_times(owner: str, t: ArrayLike) -> Floats:
    """Times (times,) [s], or one, as an array; InvalidMechanism unless all are finite and none lies before 0."""
    return np.atleast_1d(np.asarray(validate(owner, "t", t, Times), dtype=float))


def validate(owner: str, name: str, value: Any, annotation: Any) -> Any:
    """One value checked by hand, as a field or an argument with this annotation would be."""
    kind = validator_of(annotation)
    taken = kind.validate(value)
    if taken is INVALID:
        raise refusal(owner, name, value, kind.words)
    return taken


Value = TypeVar("Value")


def freeze(value: Value) -> Value:
    """The same value, no array of which can be written any more: numpy refuses it as "read-only".

    An engine that changed a mechanism's arrays would falsify the rows of the engines after it.
    """
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    elif isinstance(value, tuple):
        for each in value:
            freeze(each)
    elif is_dataclass(value):
        for field in fields(value):
            freeze(getattr(value, field.name))
    return value


class cached_readonly(cached_property[Value]):
    """A cached property whose arrays are `freeze`."""

    def __init__(self, function: Callable[[Any], Value]) -> None:
        super().__init__(lambda owner: freeze(function(owner)))
        self.__doc__ = function.__doc__


# Far above what the scenes of this suite need, and what a machine of 8 GB still has room for together with the copies
# that linear algebra makes.
LARGEST = 2 * 2**30  # bytes


def require_room(what: str, shape: Sequence[int], size: int = 8, largest: int = LARGEST) -> None:
    """Raise InvalidMechanism if an array of this shape, with elements of `size` bytes, takes more than `largest`."""
    wanted = math.prod(shape) * size
    if wanted > largest:
        raise InvalidMechanism(
            f"{what} of the shape {tuple(shape)} would take {wanted:.3g} bytes; more than {largest:.3g} are refused"
        )
