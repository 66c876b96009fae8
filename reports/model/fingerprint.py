"""What a result depends on: the source files and package versions behind a scene, an engine and the measuring.

Stored results are reused only while these are unchanged. Files are followed through their imports, so a change in one
engine's file makes the cells of that engine stale and no others. What is installed counts by its version; every other
file counts by its bytes: ours, an engine's of somebody else in a checkout of his own, a test's.
"""

from __future__ import annotations

import dataclasses
import hashlib
import platform
import sys
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from importlib.machinery import EXTENSION_SUFFIXES, SOURCE_SUFFIXES
from pathlib import Path
from typing import Any

from reports.model.imports import named_in
from reports.model.requirements import with_required

ROOT = Path(__file__).resolve().parents[2]
OURS = ("reference", "engines", "reports")
# What every row is made by: errors and outcomes, and the supervision that tells an abort from a time limit.
MEASURING = ("reports.model.measure", "reports.run.pool")
SUFFIXES = (*SOURCE_SUFFIXES, *EXTENSION_SUFFIXES)
PLAIN = {float, int, bool, str, type(None)}
INSTALLED = {"site-packages", "dist-packages"}  # names of the folders in which a version stands for the files


def _source(module: str) -> Path | None:
    """The file whose bytes a module is, loaded or not; None for an attribute and for what is installed or built in."""
    top = module.split(".")[0]
    if top in OURS:
        return _place(module)[0]
    if top in sys.stdlib_module_names or _installed(_place(top)[0]):
        return None
    loaded = getattr(sys.modules.get(module), "__file__", None)
    path = Path(loaded) if loaded is not None else _place(module)[0]
    return None if _installed(path) else path


def _installed(path: Path | None) -> bool:
    return path is not None and not INSTALLED.isdisjoint(path.parts)


@cache
def _place(module: str) -> tuple[Path | None, tuple[Path, ...]]:
    """(a module's file, if it has one; the folders in which its submodules are), found without importing it."""
    parent, _, name = module.rpartition(".")
    folders = _place(parent)[1] if parent else (ROOT,) if name in OURS else tuple(map(Path, sys.path))
    for folder in folders:
        for stem, inside in ((folder / name / "__init__", (folder / name,)), (folder / name, ())):
            for suffix in SUFFIXES:
                file = stem.with_name(stem.name + suffix)
                if file.is_file():
                    return file, inside
    return None, tuple(folder / name for folder in folders if (folder / name).is_dir())


def _data(folder: Path, strings: frozenset[str]) -> set[Path]:
    """The files beside a source that its strings name, and those in a folder beside it that they name too."""
    files = [name for name in strings if Path(name).suffix not in ("", ".py")]
    folders = [folder, *(folder / name for name in strings if files and (folder / name).is_dir())]
    return {place / name for place in folders for name in files if (place / name).is_file()}


@cache
def _direct(module: str) -> tuple[Path | None, frozenset[str], frozenset[tuple[str, Path]]]:
    """(a module's file; the modules that it imports; the data that it names, by the names of both).

    None and nothing of what counts by its version.
    """
    path = _source(module)
    if path is None or path.suffix != ".py":
        return path, frozenset(), frozenset()
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    imported, strings = named_in(path.read_bytes(), package)
    data = ((f"{module}: {file.relative_to(path.parent)}", file) for file in _data(path.parent, strings))
    return path, imported, frozenset(data)


@cache
def _closure(module: str) -> tuple[frozenset[tuple[str, Path]], frozenset[str]]:
    """(files by the names of their modules, other packages' top-level names) behind a module, itself included.

    Importing a module runs the packages that it is in first, so they are behind it too.
    """
    files: set[tuple[str, Path]] = set()
    packages: set[str] = set()
    seen: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if not name or name in seen:
            continue
        seen.add(name)
        waiting.append(name.rpartition(".")[0])
        path, imported, data = _direct(name)
        if path is None:
            packages.add(name.split(".")[0])
        else:
            files.add((name, path))
            files.update(data)
            waiting.extend(imported)
    followed = {name.split(".")[0] for name, _ in files}
    return frozenset(files), frozenset(packages - followed - set(sys.stdlib_module_names))


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
def _distributions() -> dict[str, list[str]]:
    return dict(metadata.packages_distributions())


def _providing(package: str) -> list[str]:
    """The distributions that a package is imported from: of two that have it, the one whose folder is searched first.

    MuJoCo comes as `mujoco-core` and came as `mujoco`, and both may be there.
    """
    names = _distributions().get(package, [])
    place = _place(package)[0]
    if len(names) < 2 or place is None:
        return names
    return [name for name in names if _folder(name) in place.parents] or names


def _folder(distribution: str) -> Path:
    return Path(str(metadata.distribution(distribution).locate_file("")))


@cache
def _behind(modules: frozenset[str]) -> tuple[frozenset[tuple[str, Path]], frozenset[str]]:
    """(files by the names of their modules, distributions) behind these modules."""
    files: set[tuple[str, Path]] = set()
    packages: set[str] = set()
    for module in modules:
        own_files, own_packages = _closure(module)
        files |= own_files
        packages |= own_packages
    distributions = {name for package in packages for name in _providing(package)}
    return frozenset(files), frozenset(with_required(distributions))


@cache
def digest_of(modules: frozenset[str]) -> str:
    """A digest of the source files and package versions behind these modules; none of them is imported for it."""
    files, distributions = _behind(modules)
    digest = hashlib.sha256(f"Python=={platform.python_version()}\0".encode())
    # By name, not by place: a checkout in another folder has the same results.
    for name, path in sorted(files):
        digest.update(name.encode() + b"\0" + _contents(path) + b"\0")
    for distribution in sorted(distributions):
        digest.update(f"{distribution}=={_version(distribution)}\0".encode())
    return digest.hexdigest()


@cache
def _contents(path: Path) -> bytes:
    """A digest of a file's bytes: most files are behind most cells."""
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def _version(distribution: str) -> str:
    return metadata.version(distribution)


def modules_of(*values: Any) -> frozenset[str]:
    """The modules behind these scenes and engines, or behind a task, and behind the measuring."""
    return frozenset({*modules_behind(*values), *MEASURING})


def fingerprint(*values: Any) -> str:
    """A digest of the sources and package versions behind these scenes and engines, and behind the measuring."""
    return digest_of(modules_of(*values))


def versions_of(modules: frozenset[str]) -> dict[str, str]:
    """What differs where `digest_of` does: versions by distribution, that of Python, a digest of all source files."""
    files, distributions = _behind(modules)
    sources = hashlib.sha256(b"".join(name.encode() + b"\0" + path.read_bytes() for name, path in sorted(files)))
    own = {"Python": platform.python_version(), "our source files": sources.hexdigest()[:12]}
    return {**{name: _version(name) for name in sorted(distributions)}, **own}
