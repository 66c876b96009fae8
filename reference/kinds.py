"""What an annotation allows: each as a check, with the words that say what is valid.

`float` is a finite number, `int` a whole one (a bool is neither), `ArrayLike` numbers in any shape, `NDArray` the same
made an array of floats; Literal, tuple, unions and classes say what they mean; `Annotated` adds a Rule, or allows what
is NOT_FINITE or COMPLEX; what is `Any` is not looked at. See `reference.checks`, where these are used.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from functools import lru_cache
from itertools import islice
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
    """One more condition on a value of the right kind, and the words that say it after those of the kind."""

    holds: Callable[[Any], Any]
    words: str


def of_shape(*shape: int | str) -> Rule:
    """Arrays with these sizes of the last axes, names standing for any; a first name of '...' for any axes before."""
    sizes = shape[1:] if shape[:1] == ("...",) else shape

    def holds(value: Any) -> bool:
        found = np.shape(value)
        if len(found) < len(sizes) or (len(found) > len(sizes) and sizes is shape):
            return False
        return all(isinstance(b, str) or a == b for a, b in zip(found[len(found) - len(sizes) :], sizes, strict=True))

    return Rule(holds, f"of shape ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})")


def from_to(low: float, high: float) -> Rule:
    """Numbers between these, both included."""
    return Rule(lambda value: low <= value <= high, f"from {low:.12g} to {high:.12g}")


@dataclass(frozen=True)
class Kind:
    """What an annotation allows: `take` gives the value made plain, or NOT_TAKEN; `words` say what would be taken."""

    words: str
    take: Callable[[Any], Any]


MOST_FROM_ITERATOR = 2**20  # numbers: one that never ends must not be waited for
MOST_DIMENSIONS = 16


def _scalar(value: Any) -> Any:
    """What an array without dimensions holds."""
    return value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _listed(value: Any) -> Any:
    """A list of the members of what has an order; anything else as it is."""
    if isinstance(value, memoryview):
        return value.tolist()
    if isinstance(value, Iterator):
        members = list(islice(value, MOST_FROM_ITERATOR + 1))
        return members if len(members) <= MOST_FROM_ITERATOR else NOT_TAKEN
    if isinstance(value, Sequence) and not isinstance(value, list | tuple | str | bytes | bytearray):
        return list(value)
    return value


def _ends(value: Any, within: tuple[Any, ...] = ()) -> bool:
    """Whether lists in lists come to an end: numpy would take one that holds itself apart until memory is full."""
    if not isinstance(value, Sequence) or isinstance(value, str | bytes | bytearray):
        return True
    if len(within) >= MOST_DIMENSIONS or any(value is each for each in within):
        return False
    return all(_ends(each, (*within, value)) for each in value if type(each) is not float)


def _number(value: Any) -> Any:
    if type(value) is float:
        return value
    value = _scalar(value)
    if isinstance(value, bool | np.timedelta64) or not isinstance(value, numbers.Real):
        return NOT_TAKEN
    try:
        return float(value)
    except OverflowError:
        return NOT_TAKEN


def _finite(value: Any) -> Any:
    if type(value) is float:  # nearly always: thousands of bodies are made at a time
        return value if -math.inf < value < math.inf else NOT_TAKEN
    value = _number(value)
    return value if value is NOT_TAKEN or math.isfinite(value) else NOT_TAKEN


def _whole(value: Any) -> Any:
    if type(value) is int:
        return value
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
    """Real numbers in one shape as an array of floats; neither bools nor text, not even one among numbers."""
    if type(value) is np.ndarray and value.dtype == np.float64:
        return value
    value = _listed(value)
    try:
        if not isinstance(value, np.ndarray | float):
            if not _ends(value):
                return NOT_TAKEN
            each = np.array(value, dtype=object)
            if any(_number(item) is NOT_TAKEN for item in each.flat):
                return NOT_TAKEN
            return each.astype(float)
        array = np.asarray(value)
        return array.astype(float) if array.dtype.kind in "iuf" else NOT_TAKEN
    except (TypeError, ValueError, OverflowError):  # ragged, or an object that numpy can't take apart
        return NOT_TAKEN


def _finite_array(value: Any) -> Any:
    array = _array(value)
    return array if array is NOT_TAKEN or np.isfinite(array).all() else NOT_TAKEN


def _kept(value: Any) -> Any:
    """Functions of numbers and of arrays give numbers and arrays, so the value stays what it is."""
    if type(value) is float:
        return value if math.isfinite(value) else NOT_TAKEN
    value = _listed(value)
    return value if _finite_array(value) is not NOT_TAKEN else NOT_TAKEN


def _analytic(value: Any) -> Any:
    """Numbers, real or complex: a complex step passes through what takes these."""
    taken = _any_analytic(value)
    return taken if taken is NOT_TAKEN or np.isfinite(taken).all() else NOT_TAKEN


def _any_analytic(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.number):
        return value if value.dtype.kind in "iufc" else NOT_TAKEN
    if isinstance(value, complex) or _number(value) is not NOT_TAKEN:
        return value
    return _array(value)


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
    """What an annotation allows."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation == ArrayLike:
        return Kind("finite numbers", _kept)
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
        return _either([kind_of(each) for each in arguments])
    if origin is Callable or annotation is Callable:
        return Kind("a function", lambda value: value if callable(value) else NOT_TAKEN)
    if isinstance(annotation, type):
        return _instance(annotation)
    raise TypeError(f"no check is known for the annotation {annotation!r}")


def _ruled(kind: Kind, rules: Sequence[Rule]) -> Kind:
    take, tests = kind.take, tuple(rule.holds for rule in rules)

    def ruled(value: Any) -> Any:
        value = take(value)
        if value is not NOT_TAKEN:
            for holds in tests:
                if not holds(value):
                    return NOT_TAKEN
        return value

    return Kind(" ".join([kind.words, *(rule.words for rule in rules)]), ruled)


def _choice(choices: Sequence[Any]) -> Kind:
    def take(value: Any) -> Any:
        plain = _text(value)
        return plain if plain in choices else NOT_TAKEN

    return Kind(f"one of {', '.join(map(repr, choices))}" if len(choices) > 1 else repr(choices[0]), take)


def _sequence(arguments: Sequence[Any]) -> Kind:
    """A tuple of one kind in any number, or of as many kinds as it has members."""
    endless = arguments[-1] is Ellipsis
    kinds = [kind_of(each) for each in arguments if each is not Ellipsis]
    takes, count = [kind.take for kind in kinds], len(kinds)

    def take(value: Any) -> Any:
        if type(value) is not tuple:
            value = value.tolist() if isinstance(value, np.ndarray) and value.ndim else _listed(value)
            if not isinstance(value, tuple | list):
                return NOT_TAKEN
        if not endless and len(value) != count:
            return NOT_TAKEN
        wanted = takes * len(value) if endless else takes
        members = tuple([each(member) for each, member in zip(wanted, value, strict=True)])
        for member in members:
            if member is NOT_TAKEN:
                return NOT_TAKEN
        return members

    each = kinds[0].words if len({kind.words for kind in kinds}) == 1 else " and ".join(kind.words for kind in kinds)
    return Kind(f"a tuple of {'values' if endless else f'{count} values'}, each {each}", take)


def _either(kinds: Sequence[Kind]) -> Kind:
    takes = [kind.take for kind in kinds]

    def take(value: Any) -> Any:
        value = _listed(value)  # an iterator gives its members once
        for each in takes:
            taken = each(value)
            if taken is not NOT_TAKEN:
                return taken
        return NOT_TAKEN

    return Kind(" or ".join(kind.words for kind in kinds), take)


def _instance(annotation: type) -> Kind:
    # Dataclasses of which one object fits: all do, since they have the same members. To ask a protocol of twenty
    # members takes 50 us, and thousands of cells have an engine.
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
