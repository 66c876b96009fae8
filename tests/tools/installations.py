"""Distributions built as wheels and installed in environments of their own, without anything from the network."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from contextlib import suppress
from importlib import metadata
from pathlib import Path

import pytest

from tests import ROOT

OLDEST_BUILDER = 77  # of setuptools, as in the build-system table of pyproject.toml
# Beyond what is committed: what is built and what is stored lies in the checkout too.
NOT_COPIED = (".*", "__pycache__", "build", "dist", "*.egg-info", "crosscheck-results", "tests")

BUILD = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"


def require_a_builder() -> None:
    """Skip the test unless wheels can be built here."""
    try:
        version = metadata.version("setuptools")
    except metadata.PackageNotFoundError:
        pytest.skip("setuptools is not installed; the extra 'test' of pyproject.toml has it")
    if int(version.split(".")[0]) < OLDEST_BUILDER:
        pytest.skip(f"setuptools {version} is older than {OLDEST_BUILDER}, which pyproject.toml asks for")


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], Path]) -> Path:
    """What `make` returns of an empty folder: made by the first worker of pytest that asks, while the others wait."""
    base = factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    answer = shared / f"{name}.made"
    with (shared / f"{name}.lock").open("w", encoding="utf-8") as lock:
        with suppress(ImportError):  # not everywhere: there two workers may meet, and one fails with FileExistsError
            import fcntl

            fcntl.flock(lock, fcntl.LOCK_EX)
        if not answer.exists():
            folder = shared / name
            folder.mkdir()
            answer.write_text(str(make(folder)), encoding="utf-8")
    return Path(answer.read_text(encoding="utf-8"))


def our_wheel(factory: pytest.TempPathFactory) -> Path:
    """The wheel of this checkout, built once for all tests; they are skipped where none can be built."""
    require_a_builder()
    return made_once(
        factory, "our-wheel", lambda folder: wheel_of(checkout_copy(folder / "checkout"), folder / "built")
    )


def checkout_copy(folder: Path) -> Path:
    """A copy of this checkout to build from, since a build leaves files behind."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
    return folder


def wheel_of(source: Path, folder: Path) -> Path:
    """Build the distribution whose pyproject.toml lies in `source`."""
    subprocess.run([sys.executable, "-c", BUILD, folder], cwd=source, check=True, capture_output=True, text=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def environment_with(folder: Path, *wheels: Path) -> Path:
    """An environment with these wheels, and below them what is installed here but this project; its program folder.

    The packages that the project requires are found in the present environment: its folder is named in a .pth file,
    and .pth files in that folder, which lead to this checkout, are not read. The extra 'fast' is not installed: a new
    installation with numba would compile its code first, for a quarter of a minute.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    python = programs / "python"
    asked = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = Path(subprocess.run([python, "-c", asked], check=True, capture_output=True, text=True).stdout.strip())
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-index", "--no-deps"]
    told = subprocess.run([*pip, "--no-compile", *map(str, wheels)], capture_output=True, text=True)
    if told.returncode and "No module named pip" in told.stderr:
        pytest.skip("pip is not installed")
    assert told.returncode == 0, told.stderr
    places = dict.fromkeys(sysconfig.get_path(name) for name in ("purelib", "platlib"))
    without_numba = 'import sys; sys.modules["numba"] = None'
    (site / "below.pth").write_text("\n".join([*places, without_numba]) + "\n", encoding="utf-8")
    return programs


def run(program: Path, *words: object, folder: Path) -> subprocess.CompletedProcess[str]:
    """A program of such an environment, started in `folder`, with nothing of ours on the path."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return subprocess.run([program, *map(str, words)], cwd=folder, env=kept, capture_output=True, text=True)
