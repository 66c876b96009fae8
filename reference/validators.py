"""Validators check values by annotations and have words that describe valid values.

`float` is a finite number and `int` an integer; a bool is neither. `ArrayLike` has numbers in any shape, and `Array`
is converted to an array of floats. Literal, tuple, unions and classes have the meaning that type checkers give them.
`Annotated` adds a Rule, or allows NOT_FINITE or COMPLEX numbers. `Any` is not checked. `reference.checks` applies
validators to fields and arguments.
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

# The result of a validator for a value that is not valid.
INVALID: Any = object()
# With this mark in Annotated, infinite numbers and NaN are valid unless a rule refuses them.
NOT_FINITE: Any = object()
# With this mark in Annotated, numbers may be complex.
COMPLEX: Any = object()
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rule:
    """A further condition on a value. In messages, `words` follow the words for the value's type."""

    predicate: Callable[[Any], Any]
    words: str


def of_shape(*shape: int | str) -> Rule:
    """The rule that an array's last axes have these sizes. A name is any size, a first '...' any number of axes."""
    sizes = shape[1:] if shape[:1] == ("...",) else shape

    def predicate(value: Any) -> bool:
        actual = np.shape(value)
        if len(actual) < len(sizes) or (len(actual) > len(sizes) and sizes is shape):
            return False
        return all(isinstance(b, str) or a == b for a, b in zip(actual[len(actual) - len(sizes) :], sizes, strict=True))

    return Rule(predicate, f"of shape ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})")


def from_to(low: float, high: float) -> Rule:
    """Numbers between `low` and `high`, both included."""
    return Rule(lambda value: low <= value <= high, f"from {low:.12g} to {high:.12g}")


@dataclass(frozen=True)
class Validator:
    """The function `validate` returns the plain value or INVALID, and `words` describe valid values."""

    words: str
    validate: Callable[[Any], Any]


def _scalar(value: Any) -> Any:
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _number(value: Any) -> Any:
    value = _scalar(value)
    if isinstance(value, bool | np.timedelta64) or not isinstance(value, numbers.Real):
        return INVALID
    try:
        return float(value)
    except OverflowError:
        return INVALID


def _finite(value: Any) -> Any:
    value = value if type(value) is float else _number(value)
    return value if value is not INVALID and -math.inf < value < math.inf else INVALID


def _integer(value: Any) -> Any:
    value = _scalar(value)
    is_integer = isinstance(value, numbers.Integral) and not isinstance(value, bool | np.timedelta64)
    return int(value) if is_integer else INVALID


def _boolean(value: Any) -> Any:
    value = _scalar(value)
    return bool(value) if isinstance(value, bool | np.bool_) else INVALID


def _text(value: Any) -> Any:
    value = _scalar(value)
    return str(value) if isinstance(value, str) else INVALID


def _array(value: Any) -> Any:
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # a ragged sequence, or an object that numpy can't convert
        return INVALID
    return array.astype(float, copy=False) if array.dtype.kind in "iuf" else INVALID


def _finite_array(value: Any) -> Any:
    array = _array(value)
    return array if array is INVALID or np.isfinite(array).all() else INVALID


def _numbers(value: Any) -> Any:
    """The value keeps its type, since functions of numbers return numbers and functions of arrays return arrays."""
    return value if _finite_array(value) is not INVALID else INVALID


def _any_analytic(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.number):
        return value if value.dtype.kind in "iufc" else INVALID
    return value if isinstance(value, complex) or _number(value) is not INVALID else _array(value)


def _analytic(value: Any) -> Any:
    taken = _any_analytic(value)
    return taken if taken is INVALID or np.isfinite(taken).all() else INVALID


_BY_TYPE = {
    float: Validator("a finite number", _finite),
    int: Validator("a whole number", _integer),
    bool: Validator("True or False", _boolean),
    str: Validator("a string", _text),
    NoneType: Validator("None", lambda value: None if value is None else INVALID),
    Any: Validator("anything", lambda value: value),
    Array: Validator("finite numbers", _finite_array),
    COMPLEX: Validator("finite numbers, real or complex", _analytic),
}
_UNBOUNDED = {
    float: Validator("a number", _number),
    Array: Validator("numbers", _array),
    COMPLEX: Validator("numbers, real or complex", _any_analytic),
}


@lru_cache(maxsize=1024)
def validator_of(annotation: Any) -> Validator:
    """The validator of an annotation. Raises TypeError for an unknown annotation."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation == ArrayLike:
        return Validator("finite numbers", _numbers)
    if annotation in _BY_TYPE:
        return _BY_TYPE[annotation]
    if origin is Annotated:
        plain, *notes = arguments
        rules = [note for note in notes if isinstance(note, Rule)]
        plain = COMPLEX if COMPLEX in notes else plain
        return _with_rules(_UNBOUNDED[plain] if NOT_FINITE in notes else validator_of(plain), rules)
    if origin is Literal:
        return _choice(arguments)
    if origin is tuple:
        return _sequence(arguments)
    if origin in (Union, UnionType):
        return _either([validator_of(member) for member in arguments])
    if origin is Callable or annotation is Callable:
        return Validator("a function", lambda value: value if callable(value) else INVALID)
    if isinstance(annotation, type):
        return _instance(annotation)
    raise TypeError(f"no check is known for the annotation {annotation!r}")


def _with_rules(validator: Validator, rules: Sequence[Rule]) -> Validator:
    def validate(value: Any) -> Any:
        value = validator.validate(value)
        return value if value is INVALID or all(rule.predicate(value) for rule in rules) else INVALID

    return Validator(" ".join([validator.words, *(rule.words for rule in rules)]), validate)


def _choice(choices: Sequence[Any]) -> Validator:
    def validate(value: Any) -> Any:
        plain = _text(value)
        return plain if plain in choices else INVALID

    return Validator(f"one of {', '.join(map(repr, choices))}" if len(choices) > 1 else repr(choices[0]), validate)


def _sequence(arguments: Sequence[Any]) -> Validator:
    has_any_length = arguments[-1] is Ellipsis
    validators = [validator_of(member) for member in arguments if member is not Ellipsis]
    validates, count = [validator.validate for validator in validators], len(validators)

    def validate(value: Any) -> Any:
        value = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(value, tuple | list) or (not has_any_length and len(value) != count):
            return INVALID
        wanted = validates * len(value) if has_any_length else validates
        members = tuple([validate_one(member) for validate_one, member in zip(wanted, value, strict=True)])
        return INVALID if any(member is INVALID for member in members) else members

    member_words = [validator.words for validator in validators]
    words = member_words[0] if len(set(member_words)) == 1 else " and ".join(member_words)
    return Validator(f"a tuple of {'values' if has_any_length else f'{count} values'}, each {words}", validate)


def _either(validators: Sequence[Validator]) -> Validator:
    def validate(value: Any) -> Any:
        return next((taken for validator in validators if (taken := validator.validate(value)) is not INVALID), INVALID)

    return Validator(" or ".join(validator.words for validator in validators), validate)


def _instance(annotation: type) -> Validator:
    # Cached by class, since a check of a protocol with twenty members takes 50 us.
    fitting: set[type] = set()

    def validate(value: Any) -> Any:
        if type(value) in fitting:
            return value
        if not isinstance(value, annotation) or isinstance(value, type):
            return INVALID
        if is_dataclass(value):
            fitting.add(type(value))
        return value

    article = "an" if annotation.__name__[0] in "AEIOU" else "a"
    return Validator(f"{article} {annotation.__name__}", validate)
