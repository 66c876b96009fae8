"""Load the values that a reference or an entry point names.

A reference is `package.module:NAME`, `path/to/file.py`, or `path/to/file.py:NAME`. NAME is a value, or a tuple or list
of values. A file without NAME means all values at its top level. Entry points, words of a command line and stored
references all follow this rule.

In a checkout our entry points are read from `pyproject.toml`. A clone then works without installation, and an editable
installation sees changes of the file.
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
    """A kind of value that a reference must name.

    word: name of the kind in messages, such as "engine".
    trouble: function that returns a clause on why a value is not of this kind; empty if the value is of this kind.
    defaults: function that returns an instance of a class made without arguments, or None. If `defaults` is None,
    classes in a file are ignored
    """

    word: str
    trouble: Callable[[Any], str]
    defaults: Callable[[type], Any] | None = None


def is_reference(word: str) -> bool:
    """Whether a word of the command line is a reference instead of a registered name."""
    return ":" in word or word.endswith(".py")


def load(reference: str, kind: Kind, folder: Path | None = None) -> tuple[Any, ...]:
    """The values that a reference names, without duplicates. Raises ValueError if there are no values.

    `folder` is the base of relative paths, by default the current folder. The folder of a file, or `folder`, is
    appended to `sys.path` and stays there, since worker processes import the module by its name.
    """
    source, name = _parts(reference)
    folder = Path.cwd() if folder is None else folder
    module = _module_of_file(folder / source) if source.endswith(".py") else _imported(source, source, folder)
    try:
        values = _named(module, name) if name else tuple(_at_top(module, kind, reference))
    except AttributeError:
        raise ValueError(f"{reference}: {source} has no {name}") from None
    for value in values:
        try:
            trouble = kind.trouble(value) or _unhashable(value)
        except Exception as error:
            trouble = f"its own code can't be used: {describe(error)}"
        if trouble:
            raise ValueError(f"{reference}: a value of the type {type(value).__name__} is no {kind.word}: {trouble}")
    if not values:
        where = "it is empty" if name else "nothing at the top level of this file is one"
        raise ValueError(f"{reference} should hold at least one {kind.word}: {where}")
    return tuple(dict.fromkeys(values))


def _parts(reference: str) -> tuple[str, str]:
    if reference.endswith(".py"):
        return reference, ""
    source, _, name = reference.rpartition(":")
    if not source.strip() or not all(part.isidentifier() for part in name.split(".")):
        raise ValueError(f"{reference!r} names nothing; give {FORMS}")
    return source.strip(), name


def _named(module: ModuleType, name: str) -> tuple[Any, ...]:
    value = functools.reduce(getattr, name.split("."), module)
    return tuple(value) if isinstance(value, tuple | list) else (value,)


def _unhashable(value: Any) -> str:
    try:
        hash(value)
    except TypeError:
        return "it can't be hashed; make its class a frozen dataclass, of fields that can"
    return ""


def _at_top(module: ModuleType, kind: Kind, reference: str) -> Iterator[Any]:
    """The values of a module in their order, and default instances of classes that have no instance in the module."""
    values = list(vars(module).values())
    classes = {type(value) for value in values}
    for value in values:
        if not isinstance(value, type):
            if not kind.trouble(value):
                yield value
        elif kind.defaults is not None and value.__module__ == module.__name__ and value not in classes:
            try:
                instance = kind.defaults(value)
            except Exception as error:
                raise ValueError(f"{reference}: {value.__name__}() can't be made: {describe(error)}") from None
            if instance is not None:
                yield instance


def _module_of_file(path: Path) -> ModuleType:
    """Import `path/to/package/file.py` by its usual name `package.file`. Raises ValueError."""
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file")
    path = path.resolve()
    folder, name = path.parent, path.stem
    while (folder / "__init__.py").is_file():
        folder, name = folder.parent, f"{folder.name}.{name}"
    module = _imported(name, str(path), folder)
    origin = getattr(module, "__file__", None)
    if origin is None or Path(origin).resolve() != path:
        raise ValueError(
            f"{path}: another module is called {name!r} ({origin or 'built in'}); give the file another name"
        )
    return module


def _imported(name: str, owner: str, folder: Path) -> ModuleType:
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # appended, so that the folder hides no installed module
    try:
        return import_module(name)
    except (Exception, SystemExit) as error:  # the module may raise any exception
        raise ValueError(f"{owner} can't be imported: {describe(error)}") from None


def describe(error: BaseException) -> str:
    """An error in one line, with the line of the imported module: "file.py:12: NameError: name 'x' is not defined"."""
    text = f"{type(error).__name__}: {error}"
    if isinstance(error, SyntaxError) and error.filename:
        text = f"{error.filename}:{error.lineno}: {type(error).__name__}: {error.msg}"
    else:
        machinery = (__file__, import_module.__code__.co_filename)
        frames = [
            frame
            for frame in traceback.extract_tb(error.__traceback__)
            if not frame.filename.startswith("<frozen") and frame.filename not in machinery
        ]
        # The first frame is in the module itself. Later frames may be in libraries that have no fault.
        in_module = [frame for frame in frames if frame.filename == frames[0].filename]
        if in_module:
            text = f"{in_module[-1].filename}:{in_module[-1].lineno}: {text}"
    return " ".join(text.split())


@dataclass(frozen=True)
class Registered:
    """The values of a group, and `troubles`: one line for each entry point that can't be used."""

    values: tuple[Any, ...]
    troubles: tuple[str, ...] = ()


def registered(
    group: str,
    kind: Kind,
    name: Callable[[Any], str],
    known: Mapping[str, Any] = MappingProxyType({}),
    extras: bool = False,
) -> Registered:
    """All values of a group with unique names. Of several values with one name, ours is used, or else the first.

    known: values of other groups by name; a different value with a known name is left out.
    extras: whether to use entry points with an extra, such as `engines.exudyn:VARIANTS [exudyn]`, or those without.
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
            loaded = load(reference.strip(), kind)
        except ValueError as reason:
            troubles.append(f"{about} is left out: {reason}")
            continue
        for value in loaded:
            label = name(value)
            if label in owners and value != {**known, **values}[label]:
                troubles.append(f"{about}: {label!r} is left out, since {owners[label]} has one of this name")
            elif label not in values:
                values[label], owners[label] = value, owner
    return Registered(tuple(values.values()), tuple(troubles))


def registered_by_key(group: str, kind: Kind) -> dict[str, Any]:
    """The values of a group by key; for equal keys, our value or the first distribution's value is used.

    A value that can't be loaded is left out. A warning is given, unless a package of another project is missing.
    """
    values: dict[str, Any] = {}
    for owner, key, reference in (*_ours(group), *_theirs(group)):
        try:
            value = load(reference, kind)[0]
        except ValueError as reason:
            if not _lacks_a_package(reason.__context__):
                warnings.warn(f"{group}: {key!r} of the distribution {owner} is left out: {reason}", stacklevel=2)
            continue
        values.setdefault(key, value)
    return values


def _lacks_a_package(error: BaseException | None) -> bool:
    package = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return package not in ("", "reference", "engines", "reports")


@functools.cache
def _checkout() -> dict[str, Any] | None:
    """The project table of our pyproject.toml, or None if this is no checkout."""
    file = Path(__file__).resolve().parents[1] / "pyproject.toml"
    if not file.is_file():
        return None
    with file.open("rb") as stream:
        project = tomllib.load(stream).get("project", {})
    return project if project.get("name") == OURS else None


def _ours(group: str) -> list[tuple[str, str, str]]:
    """(distribution, key, reference) of our entry points, sorted by key as in an installation."""
    project = _checkout()
    if project is None:
        return [point for point in _installed(group) if point[0] == OURS]
    return sorted((OURS, key, value) for key, value in project.get("entry-points", {}).get(group, {}).items())


def _theirs(group: str) -> list[tuple[str, str, str]]:
    return [point for point in _installed(group) if point[0] != OURS]


def _installed(group: str) -> list[tuple[str, str, str]]:
    points = metadata.entry_points(group=group)
    return sorted((point.dist.name if point.dist else "unknown", point.name, point.value) for point in points)
