"""Values that a reference or an entry point names.

A reference is `package.module:NAME`, `path/to/file.py`, or `path/to/file.py:NAME`. NAME is one value, or a tuple or
list of them; a file without a name stands for all values at its top level. Entry points, words of a command
line and stored references are read by this one rule.

Our entry points stand in `pyproject.toml`. In a checkout that file itself is read: so a clone that was never installed
has them, and one that was installed before the file changed has the present ones.
"""

from __future__ import annotations

import functools
import sys
import tomllib
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module, metadata
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import Any

OURS = "planar-crosscheck"
FORMS = "package.module:NAME, path/to/file.py or path/to/file.py:NAME"


@dataclass(frozen=True)
class Kind:
    """What a reference must name. `trouble`: why a value is none, a clause; empty if it is one.

    `defaults`: of a class in a file, what it is without arguments; None where a class can't stand for its default.
    """

    word: str  # "engine"
    trouble: Callable[[Any], str]
    defaults: Callable[[type], Any] | None = None


def is_reference(word: str) -> bool:
    """Whether a word of the command line names a file or a module, and no registered name."""
    return ":" in word or word.endswith(".py")


def load(reference: str, kind: Kind, folder: Path | None = None) -> tuple[Any, ...]:
    """The values that a reference names, each once. Raises ValueError, a sentence, where there are none.

    `folder`: where it counts from, the current one unless it is given. A module's folder, or this one, is added to the
    end of `sys.path` and stays there, since worker processes import what they are given by its name.
    """
    place, name = _parts(reference)
    folder = Path.cwd() if folder is None else folder
    module = _module_of_file(folder / place) if place.endswith(".py") else _imported(place, place, folder)
    try:
        values = _named(module, name) if name else tuple(_at_top(module, kind, reference))
    except AttributeError:
        raise ValueError(f"{reference}: {place} has no {name}") from None
    for each in values:
        try:
            why = kind.trouble(each) or _unhashable(each)
        except Exception as error:
            why = f"its own code can't be used: {describe(error)}"
        if why:
            raise ValueError(f"{reference}: a value of the type {type(each).__name__} is no {kind.word}: {why}")
    if not values:
        where = "it is empty" if name else "nothing at the top level of this file is one"
        raise ValueError(f"{reference} should hold at least one {kind.word}: {where}")
    return tuple(dict.fromkeys(values))


def _parts(reference: str) -> tuple[str, str]:
    """(module or file, name in it or nothing). Raises ValueError."""
    if reference.endswith(".py"):
        return reference, ""
    place, _, name = reference.rpartition(":")
    if not place.strip() or not all(part.isidentifier() for part in name.split(".")):
        raise ValueError(f"{reference!r} names nothing; give {FORMS}")
    return place.strip(), name


def _named(module: ModuleType, name: str) -> tuple[Any, ...]:
    value = functools.reduce(getattr, name.split("."), module)
    return tuple(value) if isinstance(value, tuple | list) else (value,)


def _unhashable(value: Any) -> str:
    """Why a value can't be a key, a clause; empty if it can. Results are kept by what they are of."""
    try:
        hash(value)
    except TypeError:
        return "it can't be hashed; make its class a frozen dataclass, of fields that can"
    return ""


def _at_top(module: ModuleType, kind: Kind, reference: str) -> Iterator[Any]:
    """The values of a module in their order, and its own classes by their defaults where no value is of that class."""
    values = list(vars(module).values())
    given = {type(value) for value in values}
    for value in values:
        if not isinstance(value, type):
            if not kind.trouble(value):
                yield value
        elif kind.defaults is not None and value.__module__ == module.__name__ and value not in given:
            try:
                made = kind.defaults(value)
            except Exception as error:
                raise ValueError(f"{reference}: {value.__name__}() can't be made: {describe(error)}") from None
            if made is not None:
                yield made


def _module_of_file(path: Path) -> ModuleType:
    """A file as the module that it is to any other file: `path/to/package/file.py` is `package.file`. ValueError."""
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file")
    path = path.resolve()
    folder, name = path.parent, path.stem
    while (folder / "__init__.py").is_file():
        folder, name = folder.parent, f"{folder.name}.{name}"
    module = _imported(name, str(path), folder)
    found = getattr(module, "__file__", None)
    if found is None or Path(found).resolve() != path:
        raise ValueError(
            f"{path}: another module is called {name!r} ({found or 'built in'}); give the file another name"
        )
    return module


def _imported(name: str, owner: str, folder: Path) -> ModuleType:
    """A module by its name, in this folder too. Raises ValueError."""
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # at the end: it must not hide what is installed
    try:
        return import_module(name)
    except (Exception, SystemExit) as error:  # whatever somebody else's module does while it is imported
        raise ValueError(f"{owner} can't be imported: {describe(error)}") from None


def describe(error: BaseException) -> str:
    """'file.py:12: NameError: name 'x' is not defined': the line of the module that was imported, on one line."""
    words = f"{type(error).__name__}: {error}"
    if isinstance(error, SyntaxError) and error.filename:
        words = f"{error.filename}:{error.lineno}: {type(error).__name__}: {error.msg}"
    else:
        machinery = (__file__, import_module.__code__.co_filename)
        frames = [
            frame
            for frame in traceback.extract_tb(error.__traceback__)
            if not frame.filename.startswith("<frozen") and frame.filename not in machinery
        ]
        # The first file is the module itself; what it called may lie in a library that is right.
        own = [frame for frame in frames if frame.filename == frames[0].filename]
        if own:
            words = f"{own[-1].filename}:{own[-1].lineno}: {words}"
    return " ".join(words.split())


@dataclass(frozen=True)
class Registered:
    """What a group holds, and a line about each entry point that can't be used; it names the distribution."""

    values: tuple[Any, ...]
    troubles: tuple[str, ...] = ()


def registered(
    group: str,
    kind: Kind,
    name: Callable[[Any], str],
    known: Mapping[str, Any] = MappingProxyType({}),
    extras: bool = False,
) -> Registered:
    """All values of a group, no two of one `name`; of two, ours stays, or that of the first distribution.

    `known`: what is registered elsewhere already, by name: another value of such a name is left out too. `extras`:
    those entry points alone that name an extra, as `engines.exudyn:VARIANTS [exudyn]` does; else those that name none.
    """
    values: dict[str, Any] = {}
    owners = dict.fromkeys(known, "another group")
    troubles: list[str] = []
    for owner, key, whole in (*_ours(group), *_theirs(group)):
        reference, extra, _ = whole.partition("[")
        if bool(extra) != extras:
            continue
        about = f"{group}: {key!r} of the distribution {owner}"
        try:
            found = load(reference.strip(), kind)
        except ValueError as reason:
            troubles.append(f"{about} is left out: {reason}")
            continue
        for value in found:
            word = name(value)
            if word in owners and value != {**known, **values}[word]:
                troubles.append(f"{about}: {word!r} is left out, since {owners[word]} has one of this name")
            elif word not in values:
                values[word], owners[word] = value, owner
    return Registered(tuple(values.values()), tuple(troubles))


def registered_by_key(group: str, kind: Kind) -> dict[str, Any]:
    """The first value of each key of a group; one of a key that ours has is left out.

    So is what can't be used: with a warning, unless a package is not installed that it needs.
    """
    found: dict[str, Any] = {}
    for owner, key, reference in (*_ours(group), *_theirs(group)):
        try:
            value = load(reference, kind)[0]
        except ValueError as reason:
            if not _lacks_a_package(reason.__context__):
                warnings.warn(f"{group}: {key!r} of the distribution {owner} is left out: {reason}", stacklevel=2)
            continue
        found.setdefault(key, value)
    return found


def _lacks_a_package(error: BaseException | None) -> bool:
    """Whether an import failed since a package that is none of ours is not installed."""
    lacking = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return lacking not in ("", "reference", "engines", "reports")


@functools.cache
def _checkout() -> dict[str, Any] | None:
    """The project table of the pyproject.toml beside these packages; None where there is none, or another project's."""
    file = Path(__file__).resolve().parents[1] / "pyproject.toml"
    if not file.is_file():
        return None
    with file.open("rb") as stream:
        project = tomllib.load(stream).get("project", {})
    return project if project.get("name") == OURS else None


def _ours(group: str) -> list[tuple[str, str, str]]:
    """(distribution, key, reference) of what we register, by key: the order of a file is lost in an installation."""
    project = _checkout()
    if project is None:
        return [point for point in _installed(group) if point[0] == OURS]
    return sorted((OURS, key, value) for key, value in project.get("entry-points", {}).get(group, {}).items())


def _theirs(group: str) -> list[tuple[str, str, str]]:
    """(distribution, key, reference) of what others register, in an order that does not depend on the path."""
    return [point for point in _installed(group) if point[0] != OURS]


def _installed(group: str) -> list[tuple[str, str, str]]:
    points = metadata.entry_points(group=group)
    return sorted((point.dist.name if point.dist else "unknown", point.name, point.value) for point in points)
