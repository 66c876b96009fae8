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


def packages(engines: Iterable[Engine] = ()) -> tuple[str, ...]:
    """The distributions whose versions are printed: ours for the measuring, those of registered engines, of these."""
    told = (name for engine in (*registry.ENGINES, *engines) for name in engine.packages)
    return tuple(dict.fromkeys([*MEASURED_WITH, *told]))


def versions(engines: Iterable[Engine] = ()) -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what the numbers depend on; `engines`: those beside the registered ones."""
    return ", ".join([f"Python {platform.python_version()}", *map(_version, packages(engines))])


def row_versions(engine: Engine) -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what a row of this engine depends on."""
    packages_of = dict.fromkeys([*MEASURED_WITH, *engine.packages])
    return ", ".join([f"Python {platform.python_version()}", *map(_version, packages_of)])


def told_versions(engines: Iterable[Engine]) -> str:
    """'exudyn 1.13.6, pin 4.1.0, ...' of these engines alone."""
    return ", ".join(dict.fromkeys(_version(package) for engine in engines for package in engine.packages))


@cache
def _version(package: str) -> str:
    """Looked up once: each costs some milliseconds, and every page tells a dozen."""
    try:
        return f"{package} {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        return f"{package} not installed"


def still_installed(told: str) -> bool:
    """Whether all that such a line names is here in the same versions; what else is installed by now doesn't count."""
    python, *others = told.split(", ")
    return python == f"Python {platform.python_version()}" and all(
        each == _version(each.split(" ", 1)[0]) for each in others
    )


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
