"""Versions, processor and date for the last line of a page."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from functools import cache
from importlib.metadata import PackageNotFoundError
from pathlib import Path

from engines import Engine, registry
from engines.package_versions import installed_version

# Packages that compute reference motions and the errors of every engine.
MEASURED_WITH = ("numpy", "scipy")


def versions(engines: Iterable[Engine] = ()) -> str:
    """The versions of all registered engines and of `engines`, such as 'Python 3.11.7, numpy 2.4.0, ...'."""
    return row_versions(*registry.ENGINES, *engines)


def row_versions(*engines: Engine) -> str:
    """The versions on which rows of `engines` depend, such as 'Python 3.11.7, numpy 2.4.0, ...'."""
    names = dict.fromkeys([*MEASURED_WITH, *(name for engine in engines for name in engine.packages)])
    return ", ".join([f"Python {platform.python_version()}", *map(_version, names)])


def engine_versions(engines: Iterable[Engine]) -> str:
    """The versions of the engines' own packages, such as 'exudyn 1.13.6, pin 4.1.0, ...'."""
    return ", ".join(dict.fromkeys(_version(name) for engine in engines for name in engine.packages))


@cache  # a lookup takes milliseconds
def _version(package: str) -> str:
    try:
        return f"{package} {installed_version(package)}"
    except PackageNotFoundError:
        return f"{package} not installed"


def still_installed(versions: str) -> bool:
    """Whether the installed packages have these versions, which are a result of `row_versions`. Only Python's minor
    version is compared, since a patch release changes no number of an engine."""
    python, *others = versions.split(", ")
    installed = [f"Python {platform.python_version()}", *(_version(line.split(" ", 1)[0]) for line in others)]
    return others == installed[1:] and python.split(".")[:2] == installed[0].split(".")[:2]


def machine() -> str:
    """A text such as 'x86_64, 2 processors, name of the processor, Linux', without the host's name."""
    return f"{platform.machine()}, {os.cpu_count()} processors, {_processor()}, {platform.system()}"


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return " ".join(line.split(":", 1)[1].split())
    except OSError:
        pass
    return platform.processor() or "processor unknown"
