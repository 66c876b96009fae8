"""What a result was made with: versions, processor, date. Printed at the foot of every page."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path

from engines import Engine, registry

# What every number depends on, whatever the engine: the truth and the errors are made with these.
MEASURED_WITH = ("numpy", "scipy")


def versions(engines: Iterable[Engine] = ()) -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what the numbers depend on; `engines`: those beside the registered ones."""
    return row_versions(*registry.ENGINES, *engines)


def row_versions(*engines: Engine) -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what the rows of these engines depend on."""
    names = dict.fromkeys([*MEASURED_WITH, *(name for engine in engines for name in engine.packages)])
    return ", ".join([f"Python {platform.python_version()}", *map(_version, names)])


def told_versions(engines: Iterable[Engine]) -> str:
    """'exudyn 1.13.6, pin 4.1.0, ...' of these engines alone."""
    return ", ".join(dict.fromkeys(_version(name) for engine in engines for name in engine.packages))


@cache
def _version(package: str) -> str:
    """Looked up once: each costs some milliseconds, and every page tells a dozen."""
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} not installed"


def still_installed(versions: str) -> bool:
    """Whether every package of this line is installed in that version; other packages do not count.

    Python counts by its minor version: a patch changes no number of an engine, and would select the weaker rule.
    """
    python, *others = versions.split(", ")
    here = [f"Python {platform.python_version()}", *(_version(line.split(" ", 1)[0]) for line in others)]
    return [_minor(python), *others] == [_minor(here[0]), *here[1:]]


def _minor(python: str) -> str:
    """'Python 3.11' of 'Python 3.11.7'."""
    return ".".join(python.split(".")[:2])


def machine() -> str:
    """'x86_64, 2 processors, name of the processor'; never a path or a host's name."""
    return f"{platform.machine()}, {os.cpu_count()} processors, {_processor()}, {platform.system()}"


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return " ".join(line.split(":", 1)[1].split())
    except OSError:
        pass
    return platform.processor() or "processor unknown"


def today() -> str:
    return datetime.now(UTC).strftime("%Y-%m-%d")
