"""What a result was made with: versions, processor, date. Printed at the foot of every page."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

PACKAGES = ("numpy", "scipy", "pymunk", "mujoco-core")


def versions() -> str:
    """'Python 3.11.7, numpy 2.4.0, ...' of what the numbers depend on."""
    found = [f"Python {platform.python_version()}"]
    for package in PACKAGES:
        try:
            found.append(f"{package} {metadata.version(package)}")
        except metadata.PackageNotFoundError:
            found.append(f"{package} not installed")
    return ", ".join(found)


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
