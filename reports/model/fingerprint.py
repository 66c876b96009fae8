"""The cache key of a result is a digest of the source files and installed versions that affect the result.

A row depends on all sources in MEASURING. The answer to a task depends on all sources in OURS. An installed module of a
third party is identified by its version, and another module by the files of its package or folder.
"""

from __future__ import annotations

import dataclasses
import hashlib
import platform
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib import metadata
from importlib.machinery import EXTENSION_SUFFIXES, SOURCE_SUFFIXES
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from engines.package_versions import installed_version

ROOT = Path(__file__).resolve().parents[2]
OURS = ("reference", "engines", "reports")
MEASURING = ("reference", "engines", "reports/model", "reports/run")  # Rows depend on these folders.
SUFFIXES = {f".{suffix.rpartition('.')[2]}" for suffix in (*SOURCE_SUFFIXES, *EXTENSION_SUFFIXES)}
INSTALLED = {"site-packages", "dist-packages"}  # Modules in these folders are identified by their versions.
NAME_FIELD = re.compile(r"^Name:(.*)$", re.MULTILINE)  # In the metadata of a distribution.
# The first folder of each Python file in the list of a distribution's files, or the name of a file without a folder.
MODULE_FILE = re.compile(r'^"?([^/,"\n]+?)(?:/[^,"\n]*)?\.py"?,', re.MULTILINE)
SCIENTIFIC = ("numpy", "scipy")  # Packages on which every result depends.
SHORT, USUAL, LONG = 8, 16, 32  # Numbers of hexadecimal digits in tables, names of files, and cache keys.


def digest(content: str | bytes, digits: int = USUAL) -> str:
    data = content.encode(errors="replace") if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()[:digits]


def fingerprint(*values: Any, folders: tuple[str, ...] = MEASURING) -> str:
    """The digest for results of these values. folders: folders of this suite that affect the results."""
    return digest(repr(versions_of(*values, folders=folders)), LONG)


def versions_of(*values: Any, folders: tuple[str, ...] = MEASURING) -> dict[str, str]:
    """Name -> version of a distribution or of Python, or digest of source files."""
    modules, packages = set[str](), set[str]()
    for value in _parts(values):
        kinds = (*(value if isinstance(value, type) else type(value)).__mro__, *((value,) if callable(value) else ()))
        modules |= {str(getattr(kind, "__module__", "")) for kind in kinds}
        packages |= set(getattr(value, "packages", ()) if hasattr(value, "step_cost") else ())  # of an engine
    return _versions(frozenset(modules), frozenset(packages), folders)


@cache
def _versions(modules: frozenset[str], packages: frozenset[str], folders: tuple[str, ...]) -> dict[str, str]:
    versions, distributions = {}, {*SCIENTIFIC, *packages}
    for module in sorted({name.partition(".")[0] for name in modules} - {*OURS, *sys.stdlib_module_names}):
        if files := _files(module):
            versions[f"files of {module}"] = _content(files)
        else:
            distributions.update(_distributions().get(module, ()))
    for name in sorted(with_required(distributions | _rivals(packages)) | packages):
        with suppress(metadata.PackageNotFoundError):  # An engine's package may not be installed.
            versions[normalised(name)] = installed_version(name)
    return {**versions, "Python": platform.python_version(), "our source files": _our_files(folders)[:12]}


def _rivals(packages: Iterable[str]) -> set[str]:
    """Distributions that share a module with these packages, such as a release under another name."""
    named = {normalised(name) for name in packages}
    holders = [set(map(normalised, names)) for names in _distributions().values()]
    return {name for names in holders if names & named for name in names}


def _parts(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        yield value
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            yield from _parts(getattr(value, field.name) for field in dataclasses.fields(value))
        elif isinstance(value, Mapping):
            yield from _parts((*value.keys(), *value.values()))
        elif isinstance(value, (tuple, list, set, frozenset)):
            yield from _parts(value)


def _files(module: str) -> tuple[Path, ...]:
    """The sources of a module that is not installed, and the files whose names occur in these sources."""
    try:
        spec = find_spec(module)
    except (ImportError, ValueError):  # A module may have no spec.
        spec = None
    if spec is None or not (spec.submodule_search_locations or spec.origin):
        return ()
    places = [Path(name) for name in spec.submodule_search_locations or ()]
    paths = [path for place in places for path in place.rglob("*")] or list(Path(str(spec.origin)).parent.glob("*"))
    if any(INSTALLED & set(path.parts) for path in paths):
        return ()
    files = [path for path in paths if path.is_file() and "__pycache__" not in path.parts]
    sources = [path for path in files if path.suffix in SUFFIXES]
    text = "".join(path.read_text(encoding="utf-8", errors="replace") for path in sources if path.suffix == ".py")
    return tuple(sorted(path for path in files if path in sources or path.name in text))


@cache
def _our_files(folders: tuple[str, ...]) -> str:
    paths = (sorted((ROOT / folder).rglob(pattern)) for folder in folders for pattern in ("*.py", "*.mjs"))
    return _content(path for group in paths for path in group)


def _content(paths: Iterable[Path]) -> str:
    return digest(b"\0".join(path.name.encode() + b"\0" + path.read_bytes() for path in paths), LONG)


@cache
def _distributions() -> Mapping[str, list[str]]:
    """Top-level module -> names of the installed distributions that have it.

    `metadata.packages_distributions` also parses every path and all metadata, which takes half a second.
    """
    holders: dict[str, list[str]] = {}
    for distribution in metadata.distributions():
        if name := NAME_FIELD.search(distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""):
            modules = (distribution.read_text("top_level.txt") or "").split()
            for module in modules or set(MODULE_FILE.findall(distribution.read_text("RECORD") or "")):
                holders.setdefault(module, []).append(name[1].strip())
    return holders


def with_required(distributions: Iterable[str]) -> set[str]:
    """Normalised names of the distributions and of all installed distributions that they require. Packages that only an
    extra requires are left out, since they may be installed without being used."""
    names: set[str] = set()
    waiting = list(distributions)
    while waiting:
        name = normalised(waiting.pop())
        if name not in names and (requirements := _required(name)) is not None:
            names.add(name)
            waiting += requirements
    return names


@cache
def _required(name: str) -> tuple[str, ...] | None:
    try:
        requirements = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return None
    texts = (text for text in requirements if not re.search(r"\bextra\s*==", text))
    names = (re.match(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)", text) for text in texts)
    return tuple(match[1] for match in names if match)


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
