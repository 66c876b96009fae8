"""Validators of annotations: what a value has to be, and the words that say it.

`float` is a finite number, `int` a whole one (a bool is neither), `ArrayLike` numbers in any shape, `NDArray` the same
made an array of floats; Literal, tuple, unions and classes mean what they say; `Annotated` adds a Rule, or allows
NOT_FINITE or COMPLEX numbers; `Any` is not checked. `reference.checks` applies them to fields and arguments.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from functools import lru_cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from numpy.typing import ArrayLike, NDArray

NOT_TAKEN: Any = object()
# In Annotated: infinite numbers and NaN are valid, unless a rule refuses them.
NOT_FINITE: Any = object()
COMPLEX: Any = object()
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Rule:
    """One more condition on a value of the right kind, and the words that follow those of the kind."""

    holds: Callable[[Any], Any]
    words: str


def of_shape(*shape: int | str) -> Rule:
    """Arrays with these sizes of the last axes, names standing for any; a first name of '...' for any axes before."""
    sizes = shape[1:] if shape[:1] == ("...",) else shape

    def holds(value: Any) -> bool:
        given = np.shape(value)
        if len(given) < len(sizes) or (len(given) > len(sizes) and sizes is shape):
            return False
        return all(isinstance(b, str) or a == b for a, b in zip(given[len(given) - len(sizes) :], sizes, strict=True))

    return Rule(holds, f"of shape ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})")


def from_to(low: float, high: float) -> Rule:
    """Numbers between these, both included."""
    return Rule(lambda value: low <= value <= high, f"from {low:.12g} to {high:.12g}")


@dataclass(frozen=True)
class Kind:
    """A validator: `take` returns the value as a plain one, or NOT_TAKEN; `words` say which values are valid."""

    words: str
    take: Callable[[Any], Any]


def _scalar(value: Any) -> Any:
    """The member of an array without dimensions; any other value as it is."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _number(value: Any) -> Any:
    value = _scalar(value)
    if isinstance(value, bool | np.timedelta64) or not isinstance(value, numbers.Real):
        return NOT_TAKEN
    try:
        return float(value)
    except OverflowError:
        return NOT_TAKEN


def _finite(value: Any) -> Any:
    value = value if type(value) is float else _number(value)
    return value if value is not NOT_TAKEN and -math.inf < value < math.inf else NOT_TAKEN


def _whole(value: Any) -> Any:
    value = _scalar(value)
    whole = isinstance(value, numbers.Integral) and not isinstance(value, bool | np.timedelta64)
    return int(value) if whole else NOT_TAKEN


def _truth(value: Any) -> Any:
    value = _scalar(value)
    return bool(value) if isinstance(value, bool | np.bool_) else NOT_TAKEN


def _text(value: Any) -> Any:
    value = _scalar(value)
    return str(value) if isinstance(value, str) else NOT_TAKEN


def _array(value: Any) -> Any:
    """Real numbers in one shape as an array of floats."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # ragged, or an object that numpy can't convert
        return NOT_TAKEN
    return array.astype(float, copy=False) if array.dtype.kind in "iuf" else NOT_TAKEN


def _finite_array(value: Any) -> Any:
    array = _array(value)
    return array if array is NOT_TAKEN or np.isfinite(array).all() else NOT_TAKEN


def _numbers(value: Any) -> Any:
    """Functions of numbers and of arrays return numbers and arrays, so the value keeps its type."""
    return value if _finite_array(value) is not NOT_TAKEN else NOT_TAKEN


def _any_analytic(value: Any) -> Any:
    """Numbers, real or complex: a complex step passes through functions that take these."""
    if isinstance(value, np.ndarray | np.number):
        return value if value.dtype.kind in "iufc" else NOT_TAKEN
    return value if isinstance(value, complex) or _number(value) is not NOT_TAKEN else _array(value)


def _analytic(value: Any) -> Any:
    taken = _any_analytic(value)
    return taken if taken is NOT_TAKEN or np.isfinite(taken).all() else NOT_TAKEN


_PLAIN = {
    float: Kind("a finite number", _finite),
    int: Kind("a whole number", _whole),
    bool: Kind("True or False", _truth),
    str: Kind("a string", _text),
    NoneType: Kind("None", lambda value: None if value is None else NOT_TAKEN),
    Any: Kind("anything", lambda value: value),
    Floats: Kind("finite numbers", _finite_array),
    COMPLEX: Kind("finite numbers, real or complex", _analytic),
}
_UNBOUNDED = {
    float: Kind("a number", _number),
    Floats: Kind("numbers", _array),
    COMPLEX: Kind("numbers, real or complex", _any_analytic),
}


@lru_cache(maxsize=1024)
def kind_of(annotation: Any) -> Kind:
    """The validator of an annotation; raises TypeError where none is known."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation == ArrayLike:
        return Kind("finite numbers", _numbers)
    if annotation in _PLAIN:
        return _PLAIN[annotation]
    if origin is Annotated:
        plain, *notes = arguments
        rules = [note for note in notes if isinstance(note, Rule)]
        plain = COMPLEX if COMPLEX in notes else plain
        return _ruled(_UNBOUNDED[plain] if NOT_FINITE in notes else kind_of(plain), rules)
    if origin is Literal:
        return _choice(arguments)
    if origin is tuple:
        return _sequence(arguments)
    if origin in (Union, UnionType):
        return _either([kind_of(member) for member in arguments])
    if origin is Callable or annotation is Callable:
        return Kind("a function", lambda value: value if callable(value) else NOT_TAKEN)
    if isinstance(annotation, type):
        return _instance(annotation)
    raise TypeError(f"no check is known for the annotation {annotation!r}")


def _ruled(kind: Kind, rules: Sequence[Rule]) -> Kind:
    def take(value: Any) -> Any:
        value = kind.take(value)
        return value if value is NOT_TAKEN or all(rule.holds(value) for rule in rules) else NOT_TAKEN

    return Kind(" ".join([kind.words, *(rule.words for rule in rules)]), take)


def _choice(choices: Sequence[Any]) -> Kind:
    def take(value: Any) -> Any:
        plain = _text(value)
        return plain if plain in choices else NOT_TAKEN

    return Kind(f"one of {', '.join(map(repr, choices))}" if len(choices) > 1 else repr(choices[0]), take)


def _sequence(arguments: Sequence[Any]) -> Kind:
    """A tuple of one kind in any number, or of as many kinds as it has members."""
    endless = arguments[-1] is Ellipsis
    kinds = [kind_of(member) for member in arguments if member is not Ellipsis]
    takes, count = [kind.take for kind in kinds], len(kinds)

    def take(value: Any) -> Any:
        value = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(value, tuple | list) or (not endless and len(value) != count):
            return NOT_TAKEN
        wanted = takes * len(value) if endless else takes
        members = tuple([take_one(member) for take_one, member in zip(wanted, value, strict=True)])
        return NOT_TAKEN if any(member is NOT_TAKEN for member in members) else members

    words = kinds[0].words if len({kind.words for kind in kinds}) == 1 else " and ".join(kind.words for kind in kinds)
    return Kind(f"a tuple of {'values' if endless else f'{count} values'}, each {words}", take)


def _either(kinds: Sequence[Kind]) -> Kind:
    def take(value: Any) -> Any:
        return next((taken for kind in kinds if (taken := kind.take(value)) is not NOT_TAKEN), NOT_TAKEN)

    return Kind(" or ".join(kind.words for kind in kinds), take)


def _instance(annotation: type) -> Kind:
    # Dataclasses of which one object fits: all do. To ask a protocol of twenty members takes 50 us.
    fitting: set[type] = set()

    def take(value: Any) -> Any:
        if type(value) in fitting:
            return value
        if not isinstance(value, annotation) or isinstance(value, type):
            return NOT_TAKEN
        if is_dataclass(value):
            fitting.add(type(value))
        return value

    article = "an" if annotation.__name__[0] in "AEIOU" else "a"
    return Kind(f"{article} {annotation.__name__}", take)
