"""What a reference names: `package.module:NAME`, `path/to/file.py`, or `path/to/file.py:NAME`.

NAME stands for one value, or for a tuple or list of them; a file without a name for all that stand at its top level. So
the entry points of a distribution, the words of a command line and what a store remembers are read by one rule.
"""

from __future__ import annotations

import functools
import sys
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

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
    module = _module_of_file(folder / place) if place.endswith(".py") else _module(place, folder)
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


def _module(name: str, folder: Path) -> ModuleType:
    """A module by its name, in this folder too. Raises ValueError."""
    _add_to_path(folder)
    return _imported(name, name)


def _module_of_file(path: Path) -> ModuleType:
    """A file as the module that it is to any other file: `path/to/package/file.py` is `package.file`. ValueError."""
    if not path.is_file():
        raise ValueError(f"{path}: there is no such file")
    path = path.resolve()
    folder, name = path.parent, path.stem
    while (folder / "__init__.py").is_file():
        folder, name = folder.parent, f"{folder.name}.{name}"
    _add_to_path(folder)
    module = _imported(name, str(path))
    found = getattr(module, "__file__", None)
    if found is None or Path(found).resolve() != path:
        raise ValueError(
            f"{path}: another module is called {name!r} ({found or 'built in'}); give the file another name"
        )
    return module


def _add_to_path(folder: Path) -> None:
    if str(folder) not in sys.path:
        sys.path.append(str(folder))  # at the end: it must not hide what is installed


def _imported(name: str, owner: str) -> ModuleType:
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
