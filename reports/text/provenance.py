"""What a result was made with: versions, processor, date. Printed at the foot of every page."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from engines import registry

# What every number depends on, whatever the engine: the truth and the errors are made with these.
MEASURED_WITH = ("numpy", "scipy")


def packages() -> tuple[str, ...]:
    """The distributions whose versions are printed: ours for the measuring, and those that registered engines name."""
    return tuple(dict.fromkeys([*MEASURED_WITH, *(name for engine in registry.ENGINES for name in engine.packages)]))


def versions() -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what the numbers depend on."""
    found = [f"Python {platform.python_version()}"]
    for package in packages():
        try:
            found.append(f"{package} {metadata.version(package)}")
        except metadata.PackageNotFoundError:
            found.append(f"{package} not installed")
    return ", ".join(found)


def still_installed(told: str) -> bool:
    """Whether all that such a line names is here in the same versions; what else is installed by now doesn't count."""
    return set(told.split(", ")) <= set(versions().split(", "))


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
