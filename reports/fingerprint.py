"""What a result depends on: the source files and package versions behind a scene, an engine and the measuring.

Stored results are reused only while these are unchanged. Files are followed through their imports, so a change in one
engine's file makes the cells of that engine stale and no others.
"""

from __future__ import annotations

import ast
import dataclasses
import hashlib
import sys
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from reports.requirements import with_required

ROOT = Path(__file__).resolve().parent.parent
OURS = ("reference", "engines", "reports")


def _source(module: str) -> Path | None:
    """The file of one of our modules, or of a module already imported (an engine defined by a test)."""
    if module.split(".")[0] in OURS:
        path = ROOT.joinpath(*module.split("."))
        for candidate in (path / "__init__.py", path.with_suffix(".py")):
            if candidate.is_file():
                return candidate
        return None
    loaded = getattr(sys.modules.get(module), "__file__", None)
    return Path(loaded) if loaded else None


@cache
def _imports(path: Path) -> tuple[str, ...]:
    """Every module name that a file's import statements could mean, at any depth of nesting."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names.add(node.module)
            names.update(f"{node.module}.{alias.name}" for alias in node.names)
    return tuple(sorted(names))


@cache
def _closure(module: str) -> tuple[frozenset[Path], frozenset[str]]:
    """(our files, other packages' top-level names) behind a module, itself included."""
    files: set[Path] = set()
    packages: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = _source(name) if name == module or name.split(".")[0] in OURS else None
        if path is None:
            packages.add(name.split(".")[0])
        elif path not in files:
            files.add(path)
            waiting.extend(_imports(path))
    return frozenset(files), frozenset(packages - set(OURS) - set(sys.stdlib_module_names))


def modules_behind(*values: Any) -> set[str]:
    """The modules of these dataclasses and of every dataclass in their fields (an engine that wraps another)."""
    found: set[str] = set()
    waiting = list(values)
    while waiting:
        value = waiting.pop()
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            found.update(base.__module__ for base in type(value).__mro__ if base.__module__ != "builtins")
            waiting.extend(getattr(value, field.name) for field in dataclasses.fields(value))
        elif isinstance(value, (tuple, list)):
            waiting.extend(value)
    return found


@cache
def _distributions() -> dict[str, list[str]]:
    return dict(metadata.packages_distributions())


@cache
def _digest(modules: frozenset[str]) -> str:
    files: set[Path] = set()
    packages: set[str] = set()
    for module in modules:
        own_files, own_packages = _closure(module)
        files |= own_files
        packages |= own_packages
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    distributions = {name for package in packages for name in _distributions().get(package, ())}
    for distribution in sorted(with_required(distributions)):
        digest.update(f"{distribution}=={metadata.version(distribution)}\0".encode())
    return digest.hexdigest()


def fingerprint(*values: Any) -> str:
    """A digest of the sources and package versions behind these scenes and engines, and behind the measuring."""
    modules = {name for name in modules_behind(*values) if name.split(".")[0] not in ("abc", "typing", "dataclasses")}
    return _digest(frozenset(modules | {"reports.measure"}))
