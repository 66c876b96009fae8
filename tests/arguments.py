"""Arguments that can't be meant, by what a parameter is declared to be; written apart from what checks them.

`bad` lists values for an annotation, `good` gives one that is valid. Neither uses `reference.kinds`, which is under
test.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib
import inspect
import itertools
import pkgutil
import typing
from collections.abc import Callable, Iterator, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from numpy.typing import ArrayLike

import engines
import reference
from engines import registry
from engines.pymunk.contraction import Sweeping
from reference.checks import (
    AnyComplexes,
    Complexes,
    Count,
    Fraction,
    Name,
    NonNegative,
    Numbers,
    Positive,
    Sign,
    Signs,
    Times,
)
from reference.kinds import Floats, Rule
from tests.mechanisms import four_bar
from tests.samples import INSTANCES, RUN

NAN, INF = float("nan"), float("inf")
NOTHING_AT_ALL = [None, object(), {}, {"x": 1.0}, float, Ellipsis, np.timedelta64(1, "s")]
ENDLESS: list[Any] = []
ENDLESS += [ENDLESS, ENDLESS]  # numpy would take it apart until memory is full
NO_NUMBERS = [*NOTHING_AT_ALL, "1.5", "abc", b"1", 1 + 2j, np.complex128(1 + 2j), True, np.bool_(False), [], {1.0, 2.0}]
NOT_FINITE = [NAN, INF, -INF, np.float64("nan"), np.float32("inf")]
NO_SCALARS = [[1.0], (1.0,), np.array([1.0, 2.0]), np.zeros((2, 2)), [[1.0]]]
NO_ARRAYS = ["abc", "1.5", ["1.5"], [1.0, None], [1.0, True], [[1.0], [1.0, 2.0]], np.array(["1", "2"])]
NO_ARRAYS += [*NOTHING_AT_ALL, True, np.array([True]), np.array([object()]), b"1", {1.0}, [10**400]]
NO_ARRAYS += [ENDLESS, [np.timedelta64(1, "s")], itertools.repeat(1.0)]
COMPLEX = [1j, [1 + 2j], np.array([1 + 2j])]

KNOWN: dict[Any, list[Any]] = {
    float: [*NO_NUMBERS, *NOT_FINITE, *NO_SCALARS, 10**400, "contractions"],
    bool: [*NOTHING_AT_ALL, 0, 1, 0.5, "True", "", [], np.float64(1.0), NAN],
    str: [*NOTHING_AT_ALL, 3, b"abc", ["abc"], NAN, True],
    ArrayLike: [*NO_ARRAYS, *COMPLEX, NAN, [1.0, NAN], INF, np.array([INF])],
    NoneType: [],
}
KNOWN[int] = [*KNOWN[float], 1.5, 2.0, np.float64(2.0), np.float32(1.0)]
KNOWN[Positive] = [*KNOWN[float], 0, 0.0, -1, -1e-300, np.float32(-1.0), -(10**400)]
KNOWN[NonNegative] = [*KNOWN[float], -1, -5e-324]
KNOWN[Fraction] = [*KNOWN[float], -0.1, 1.0000001, 2]
KNOWN[Count] = [*KNOWN[int], 0, -1, 2**31, 2**63, np.int64(0), np.uint64(2**63)]
KNOWN[Sign] = [*KNOWN[int], 0, 2, -2]
KNOWN[Signs] = [*KNOWN[ArrayLike], 0, [1, 0], 0.5, [1.0, 2.0]]
KNOWN[Name] = [*KNOWN[str], "", " ", "a\nb", "\x00"]
KNOWN[Floats] = KNOWN[ArrayLike]
KNOWN[Numbers] = [*NO_ARRAYS, *COMPLEX]
KNOWN[Complexes] = [*NO_ARRAYS, NAN, [1.0, NAN], INF, complex(NAN, 1), np.array([1j * INF])]
KNOWN[AnyComplexes] = NO_ARRAYS
KNOWN[Times] = [*KNOWN[ArrayLike], -1.0, [0.0, -1e-9], [[0.0, 1.0]], np.zeros((2, 2))]


def _known(annotation: Any) -> list[Any] | None:
    try:
        return KNOWN.get(annotation)
    except TypeError:
        return None


def bad(annotation: Any) -> list[Any]:
    """Values that can't be meant where this is declared."""
    if annotation is Any:
        return []
    found, arguments, origin = _known(annotation), get_args(annotation), get_origin(annotation)
    if found is not None:
        return found
    if origin is Annotated and isinstance(arguments[-1], Rule):
        *others, rule = arguments
        shapes = [0.5, np.zeros(1), np.zeros((1, 1))] if rule.words.startswith("of shape") else []
        wrong = [value for value in shapes if not rule.holds(value)]
        return bad(Annotated[*others] if len(others) > 1 else others[0]) + wrong
    if origin is Annotated:
        return [value for value in bad(arguments[0]) if not any(value is each for each in NOT_FINITE)]
    if origin is Literal:
        return [*KNOWN[str], "", "nonsense", arguments[0] + " ", [arguments[0]], (arguments[0],)]
    if origin is tuple:
        return _bad_tuples(arguments)
    if origin in (Union, UnionType):
        return [value for each in arguments for value in bad(each) if not any(_meant(value, one) for one in arguments)]
    if origin is Callable or annotation is Callable:
        return [None, "abc", 1.0, [], {}]
    if isinstance(annotation, type):
        return [*NOTHING_AT_ALL, 1.0, "abc", [], annotation]
    raise AssertionError(f"no bad values are known for {annotation!r}")


def _bad_tuples(arguments: tuple[Any, ...]) -> list[Any]:
    if arguments[-1] is Ellipsis:
        members, short = [arguments[0]], []
    else:
        members = list(arguments)
        short = [
            (),
            [],
            tuple(good(each) for each in members[:-1]),
            tuple(good(each) for each in [*members, members[0]]),
        ]
    spoilt = []
    for index, each in enumerate(members):
        for value in bad(each):
            row = [good(one) for one in members]
            row[index] = value
            spoilt.append(tuple(row))
    return [*short, *spoilt, *NOTHING_AT_ALL, 1.0, NAN, "ab", "abc", {1.0, 2.0}, np.float64(1.0), np.array(1.0)]


def _meant(value: Any, annotation: Any) -> bool:
    """Whether a value that is bad for another member of a union may be meant by this one."""
    if annotation is NoneType:
        return value is None
    if get_origin(annotation) is Callable or annotation is Callable:
        return callable(value)
    if annotation is float or get_origin(annotation) is Annotated:
        value = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(annotation, type) and isinstance(value, annotation)


GOOD = (
    *((float, 0.5), (int, 1), (bool, False), (str, "b"), (ArrayLike, 0.5), (Any, 0.5), (NoneType, None)),
    *((Sign, 1), (Signs, 1), (Name, "b"), (Complexes, 0.5), (AnyComplexes, 0.5)),
)


def good(annotation: Any) -> Any:
    """A valid value."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if annotation == Floats:
        return np.array([0.5])
    for each, value in GOOD:
        if annotation == each:
            return value
    if origin is Annotated:
        arrays = (np.zeros(2), np.zeros((1, 3)), np.zeros((1, 2)), np.zeros(1), np.zeros((1, 1, 3)), np.ones((1, 1)))
        for value in (good(arguments[0]), 3, *arrays):
            if all(note.holds(value) for note in annotation.__metadata__ if hasattr(note, "holds")):
                return value
    if origin is Literal:
        return arguments[0]
    if origin is tuple:
        return tuple(good(each) for each in arguments if each is not Ellipsis)
    if origin in (Union, UnionType):
        return good(arguments[0])
    if origin is Callable or annotation is Callable:
        return lambda value: value
    if annotation is Sweeping:  # no user makes one
        return Sweeping(8)
    return next(each for each in INSTANCES if isinstance(each, annotation))


def modules() -> Iterator[Any]:
    for package in (reference, engines):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if found.name.startswith("engines.lagrange.compiled."):  # numba's, and nobody calls it
                continue
            try:
                module = importlib.import_module(found.name)
            except ModuleNotFoundError as missing:
                if missing.name != "numba":
                    raise
            else:
                yield module


def public(kind: Callable[[Any], bool]) -> dict[str, Any]:
    """What reference and engines define of this kind under a public name."""
    return {
        f"{module.__name__}.{name}": value
        for module in modules()
        for name, value in vars(module).items()
        if not name.startswith("_") and kind(value) and value.__module__ == module.__name__
    }


def dataclasses_of_the_suite() -> dict[str, type]:
    return public(lambda value: isinstance(value, type) and dataclasses.is_dataclass(value))


def functions_of_the_suite() -> Iterator[tuple[Callable[..., Any], Any]]:
    """Every function and method that checks its arguments, with an object to call it on or None."""
    for function in public(inspect.isfunction).values():
        if hasattr(function, "__validated__"):
            yield function, None
    for owner in public(inspect.isclass).values():
        for function in vars(owner).values():
            function = getattr(function, "__func__", function)
            if inspect.isfunction(function) and hasattr(function, "__validated__"):
                yield function, _object_of(owner)


def _object_of(owner: type) -> Any:
    for each in (*INSTANCES, RUN):
        if isinstance(each, owner):
            return each
    for engine in registry.ENGINES:
        run = engine.build(four_bar(), 1e-3)
        if isinstance(run, owner):
            return run
    raise AssertionError(f"there is no instance of {owner.__name__} to try: add one to INSTANCES")


@dataclasses.dataclass(frozen=True)
class Trial:
    """One argument that can't be meant: who gets it, its name, and a call that gives it."""

    owner: str
    name: str
    value: Any
    call: Callable[[], Any]


def trials() -> list[Trial]:
    """All of them, in one order."""
    out: list[Trial] = []
    for cls in dict.fromkeys(type(each) for each in INSTANCES):
        sample = next(each for each in INSTANCES if type(each) is cls)
        hints = typing.get_type_hints(cls, include_extras=True)
        for field in dataclasses.fields(cls):
            if hints[field.name] is not Any:
                for value in bad(hints[field.name]):
                    change = {field.name: value}
                    call = functools.partial(dataclasses.replace, sample, **change)
                    out.append(Trial(cls.__name__, field.name, value, call))
    for function, owner in functions_of_the_suite():
        out += _of_function(function, owner)
    return out


def _of_function(function: Callable[..., Any], owner: Any) -> Iterator[Trial]:
    hints = typing.get_type_hints(function, include_extras=True)
    hints.pop("return", None)
    parameters = [each for each in inspect.signature(function).parameters if each in hints and each != "settings"]
    for name in parameters:
        if hints[name] is Any:
            continue
        others = {each: hints[each] for each in parameters if each != name}
        called = function if owner is None else functools.partial(function, owner)
        for value in bad(hints[name]):
            call = functools.partial(_with_good_others, called, others, {name: value})
            yield Trial(function.__qualname__, name, value, call)


def _with_good_others(function: Callable[..., Any], others: Mapping[str, Any], given: Mapping[str, Any]) -> Any:
    """The call itself; values are made when it is tried, since a few of all trials are."""
    return function(**{name: good(hint) for name, hint in others.items()}, **given)
