"""What a result depends on: the sources and package versions behind a scene, an engine or a task, and the measuring.

Stored results are reused only while these are unchanged. Imports are followed from one piece to the next, and a piece
counts by the bytes of all that is in it: the whole of `reference`, an engine's package, any other module of ours; of
somebody else a package or a file, with the data that it names. What is installed counts by its version. So a change in
one engine's package makes the results of that engine stale and no others.
"""

from __future__ import annotations

import dataclasses
import hashlib
import platform
import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import metadata
from importlib.machinery import EXTENSION_SUFFIXES, SOURCE_SUFFIXES
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
OURS = ("reference", "engines", "reports")
DEPTHS = {"reference": 1, "engines": 2}  # how many parts of a module's name name its piece
# What every row is made by: errors and outcomes, and the supervision that tells an abort from a time limit.
MEASURING = ("reports.model.measure", "reports.run.running")
PLAIN = {float, int, bool, str, type(None)}
SUFFIXES = {f".{suffix.rpartition('.')[2]}" for suffix in (*SOURCE_SUFFIXES, *EXTENSION_SUFFIXES)}
INSTALLED = {"site-packages", "dist-packages"}  # names of the folders in which a version stands for the files
# An import at the beginning of a line or of a part of one. A sentence that looks like one adds what may not be needed.
NAMES = r"[\w.]+(?:[ \t]+as[ \t]+\w+)?"
LIST = rf"{NAMES}(?:[ \t]*,[ \t]*{NAMES})*(?=[ \t]*,?[ \t]*(?:[#;\\\r\n]|\Z))"
FROM = rf"from[ \t]+([\w.]+)[ \t]+import[ \t]*(\([^)]*\)|{LIST}|\*)"
IMPORT = re.compile(rf"(?:^|[:;])[ \t]*(?:{FROM}|import[ \t]+({LIST}))", re.M)


@cache
def _piece(module: str) -> tuple[Path, ...]:
    """The folder or file that counts with a module; none for what is installed or built in, and for an attribute."""
    parts = module.split(".")
    if parts[0] in OURS:
        depth = DEPTHS.get(parts[0], len(parts) + 1)
        place = ROOT.joinpath(*parts[:depth])
        if len(parts) >= depth and place.is_dir():
            return (place,)
        return tuple(file for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file())
    if parts[0] in sys.stdlib_module_names:
        return ()
    try:
        spec = find_spec(parts[0])
    except (ImportError, ValueError):  # a module that was made by hand
        spec = None
    if spec is None:
        return ()
    places = [Path(name) for name in spec.submodule_search_locations or filter(None, [spec.origin])]
    # A folder without sources is none, though Python would take it: one of results, of the name of a word.
    return tuple(place for place in places if INSTALLED.isdisjoint(place.parts) and place.exists() and _files(place))


@cache
def _files(place: Path) -> tuple[Path, ...]:
    """The files of a piece: all that is in one of ours, else sources and the data beside and below that they name."""
    found = sorted((*place.parent.glob("*"), *place.parent.glob("*/*")) if place.is_file() else place.rglob("*"))
    found = [path for path in found if path.is_file() and "__pycache__" not in path.parts]
    if place.is_relative_to(ROOT) and place.relative_to(ROOT).parts[0] in OURS:
        return (place,) if place.is_file() else tuple(found)
    sources = [place] if place.is_file() else [path for path in found if path.suffix in SUFFIXES]
    text = "".join(path.read_text(encoding="utf-8", errors="replace") for path in sources)
    data = (path for path in found if path.suffix not in SUFFIXES and path.name in text)
    return (*sources, *data)


@cache
def _contents(place: Path) -> bytes:
    """A digest of a piece: names and bytes of its files. A checkout in another folder has the same."""
    digest, root = hashlib.sha256(), ROOT if ROOT in place.parents else place.parent
    for path in _files(place):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.digest()


@cache
def _imports(place: Path) -> frozenset[str]:
    """Every module that the imports of a piece could mean, at any depth of nesting."""
    found: set[str] = set()
    for path in _files(place):
        if path.suffix == ".py":
            for origin, names, modules in IMPORT.findall(path.read_bytes().decode(errors="replace")):
                found.update(f"{origin}.{name}" for name in re.findall(r"\w+", names))
                found.update([origin] if origin else (name.split()[0] for name in modules.split(",")))
    return frozenset(name for name in found if not name.startswith("."))  # those lie in the same piece


@cache
def _behind(modules: frozenset[str]) -> tuple[frozenset[Path], frozenset[str]]:
    """(pieces, distributions) behind these modules, themselves included."""
    places: set[Path] = set()
    others: set[str] = set()
    seen: set[str] = set()
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module in seen:
            continue
        seen.add(module)
        package = module.rpartition(".")[0]  # importing a module runs the packages that it is in first
        waiting += [package] if package else []
        found = _piece(module)
        if not found:
            others.add(module.split(".")[0])
        for place in found:
            if place not in places:
                places.add(place)
                waiting += _imports(place)
    distributions = {name for package in others.difference(OURS) for name in _distributions().get(package, ())}
    return frozenset(places), frozenset(with_required(distributions))


def modules_behind(*values: Any) -> set[str]:
    """The modules of these values' classes, of functions and classes among them, and of all that they hold.

    What a dataclass holds stands in its fields: an engine that wraps another, a setting that is an object.
    """
    found = {object.__module__}
    waiting = list(values)
    while waiting:
        value = waiting.pop()
        if type(value) in PLAIN:  # nearly all that a scene holds
            continue
        classes = value.__mro__ if isinstance(value, type) else type(value).__mro__
        found.update(base.__module__ for base in classes)
        if callable(value) and isinstance(getattr(value, "__module__", None), str):
            found.add(value.__module__)
        if isinstance(value, Mapping):
            waiting.extend((*value.keys(), *value.values()))
        elif isinstance(value, (tuple, list, set, frozenset)):
            waiting.extend(value)
        elif dataclasses.is_dataclass(value) and not isinstance(value, type):
            waiting.extend(getattr(value, field.name) for field in dataclasses.fields(value))
    return found


@cache
def digest_of(modules: frozenset[str]) -> str:
    """A digest of the sources and package versions behind these modules; none of them is imported for it."""
    places, distributions = _behind(modules)
    digest = hashlib.sha256(f"Python=={platform.python_version()}\0".encode())
    for contents in sorted(map(_contents, places)):
        digest.update(contents)
    for distribution in sorted(distributions):
        digest.update(f"{distribution}=={_version(distribution)}\0".encode())
    return digest.hexdigest()


def modules_of(*values: Any) -> frozenset[str]:
    """The modules behind these scenes and engines, or behind a task, and behind the measuring."""
    return frozenset({*modules_behind(*values), *MEASURING})


def fingerprint(*values: Any) -> str:
    """A digest of the sources and package versions behind these scenes and engines, and behind the measuring."""
    return digest_of(modules_of(*values))


def versions_of(modules: frozenset[str]) -> dict[str, str]:
    """What differs where `digest_of` does: versions by distribution, that of Python, a digest of all source files."""
    places, distributions = _behind(modules)
    sources = hashlib.sha256(b"".join(sorted(map(_contents, places))))
    own = {"Python": platform.python_version(), "our source files": sources.hexdigest()[:12]}
    return {**{name: _version(name) for name in sorted(distributions)}, **own}


@cache
def _distributions() -> Mapping[str, list[str]]:
    return metadata.packages_distributions()


@cache
def _version(distribution: str) -> str:
    return metadata.version(distribution)


def with_required(distributions: Iterable[str]) -> set[str]:
    """The distributions and all that they require, directly or not, as far as it is installed; normalised names.

    pymunk calls its engine through cffi, which no file of ours imports. What only an extra asks for is left out, since
    whether it is installed says nothing about whether it is used.
    """
    found: set[str] = set()
    waiting = list(distributions)
    while waiting:
        name = normalised(waiting.pop())
        if name not in found and (requirements := _required(name)) is not None:
            found.add(name)
            waiting += requirements
    return found


@cache  # reading what is installed takes longer than all else that a key needs
def _required(name: str) -> tuple[str, ...] | None:
    """What an installed distribution requires; None if it is not installed, being asked for on other systems only."""
    try:
        requirements = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return None
    names = (re.match(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)", text) for text in requirements if not _of_an_extra(text))
    return tuple(match[1] for match in names if match)


def _of_an_extra(requirement: str) -> bool:
    return re.search(r"\bextra\s*==", requirement) is not None


def normalised(name: str) -> str:
    """As package indexes compare names."""
    return re.sub(r"[-_.]+", "-", name).lower()
