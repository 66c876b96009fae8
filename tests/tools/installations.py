"""Distributions built as wheels and installed in environments of their own, without anything from the network."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
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


def our_wheel(folder: Path) -> Path:
    """The wheel of this checkout; the test is skipped where none can be built."""
    require_a_builder()
    return wheel_of(checkout_copy(folder / "checkout"), folder / "built")


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


def run(program: Path, *words: object, folder: Path, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    """A program of such an environment, started in `folder`, with nothing of ours on the path; `path` stands first."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    kept |= {} if path is None else {"PYTHONPATH": str(path)}
    return subprocess.run([program, *map(str, words)], cwd=folder, env=kept, capture_output=True, text=True)


# Somebody else's distribution, as files.
THEIR_PROJECT = """
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "their-suite"
version = "1.2.3"

[project.entry-points."crosscheck.engines"]
impulses = "their_suite.impulses:ENGINES"

[project.entry-points."crosscheck.scenes"]
flywheel = "their_suite.flywheel:FLYWHEEL"
spare = "their_suite.flywheel:SPARE"

[project.entry-points."crosscheck.pages"]
flywheel = "their_suite.page:PAGE"

[tool.setuptools]
packages = ["their_suite"]

[tool.setuptools.package-data]
their_suite = ["*.md"]
"""

THEIR_ENGINE = '''
"""Impulses: each step changes the velocities so that all joints close a share of their gaps; then bodies drift."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from engines import Engine, Promise, Size, refuse_forces
from reference.trajectory import Trajectory
from reference.checks import Count, Fraction, Name, Positive, Valid, validated


@dataclass(frozen=True)
class Impulses(Engine, Valid):
    variant: Name
    share: Fraction
    name = "impulses"
    packages = ("their-suite", "numpy")

    def order(self, mechanism):
        return Promise(1, differences=1)

    def step_cost(self, mechanism):
        return 60e-6

    def holder(self, joint, mechanism):
        return "engine"

    @validated
    def build(self, mechanism: object, dt: Positive):
        refuse_forces(mechanism, self.name)
        return Model(self, mechanism, dt)


class Model:
    def __init__(self, engine, mechanism, dt):
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, mechanism.row_count)
        self.engine, self.mechanism, self.dt, self.called = engine, mechanism, dt, False

    @validated
    def __call__(self, samples: Count, every: Count):
        import time

        if self.called:
            raise RuntimeError("a run is one shot: build it again")
        self.called = True
        begin = time.process_time()
        pose, twist, states = self.mechanism.pose, self.mechanism.twist, []
        for index in range(samples * every + 1):
            after = self.kicked(pose, twist, index * self.dt)
            if index % every == 0:
                states.append((pose, twist, self.mechanism.reaction(pose, (after - twist) / self.dt)))
            pose, twist = pose + self.dt * after, after
        times = np.arange(samples + 1) * every * self.dt
        return Trajectory(times, *map(np.array, zip(*states)), time.process_time() - begin)

    def kicked(self, pose, twist, t):
        mechanism, weight = self.mechanism, 1 / self.mechanism.inertias.reshape(-1)
        rows = mechanism.rows(pose)
        free = (twist + self.dt * mechanism.free_fall).reshape(-1)
        gap = np.nan_to_num(mechanism.gap(pose, t))
        wanted = mechanism.rate - self.engine.share * gap / self.dt - rows @ free
        impulse = np.linalg.lstsq((rows * weight) @ rows.T, wanted, rcond=None)[0]
        return (free + weight * (rows.T @ impulse)).reshape(-1, 3)


ENGINES = (Impulses("default", 0.2), Impulses("closed", 1.0))
'''

THEIR_SCENE = '''
"""A disc on an axle through its centre: it turns steadily, and the axle carries its weight."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory
from reference.checks import Positive


@dataclass(frozen=True)
class Flywheel(Scene):
    """A disc that turns steadily on an axle."""

    name: ClassVar[str] = "flywheel"
    source: ClassVar[str] = "their own invention"
    rate: float = 2.0
    mass: Positive = 3.0
    duration: Positive = 0.2
    horizon: Positive = 0.2

    def mechanism(self):
        disc = Body("disc", self.mass, 0.5, (0.0, 0.0, 0.0), (0.0, 0.0, self.rate))
        return Mechanism((disc,), (Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0)),), (0.0, -10.0))

    def _motion(self, times):
        pose, twist = np.zeros((len(times), 1, 3)), np.zeros((len(times), 1, 3))
        pose[:, 0, 2], twist[:, 0, 2] = self.rate * times, self.rate
        return Trajectory(times, pose, twist, np.tile([0.0, 10.0 * self.mass], (len(times), 1)))


class Spare(Flywheel):
    """A flywheel that no page teaches."""

    name = "spare_wheel"


FLYWHEEL, SPARE = Flywheel(), Spare()
'''

THEIR_PAGE = """
from pathlib import Path

from engines.registry import VARIANTS
from reports.model.page import Page
from reports.write.rows import lookups
from their_suite.flywheel import FLYWHEEL

PAGE = Page(
    name="flywheel",
    title="Their flywheel",
    lesson="A disc on an axle, which every engine should hold.",
    scenes=(FLYWHEEL,),
    engines=VARIANTS,
    template=Path(__file__).with_name("page.md"),
    words=lambda material: lookups(material, (FLYWHEEL,)),
)
"""

THEIR_TEMPLATE = """{% extends "base.md" %}
{% block lesson %}
Closed impulses reach {{ best("flywheel", "impulses", "closed").angle | number }} rad.
{% endblock %}
"""


def distribution(folder: Path) -> Path:
    """Somebody else's distribution, an engine in two variants and a scene with its page, ready to be built here."""
    files = {
        "pyproject.toml": THEIR_PROJECT,
        "their_suite/__init__.py": "",
        "their_suite/impulses.py": THEIR_ENGINE,
        "their_suite/flywheel.py": THEIR_SCENE,
        "their_suite/page.py": THEIR_PAGE,
        "their_suite/page.md": THEIR_TEMPLATE,
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text.lstrip("\n"), encoding="utf-8")
    return folder
