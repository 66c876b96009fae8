"""A distribution of somebody else, as files: an engine in two variants, and a scene with its page. It is no test."""

from __future__ import annotations

from pathlib import Path

PYPROJECT = """
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

ENGINE = '''
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

SCENE = '''
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

PAGE = """
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

TEMPLATE = """{% extends "base.md" %}
{% block lesson %}
Closed impulses reach {{ best("flywheel", "impulses", "closed").angle | number }} rad.
{% endblock %}
"""


def distribution(folder: Path) -> Path:
    """The distribution's source below this folder, ready to be built."""
    files = {
        "pyproject.toml": PYPROJECT,
        "their_suite/__init__.py": "",
        "their_suite/impulses.py": ENGINE,
        "their_suite/flywheel.py": SCENE,
        "their_suite/page.py": PAGE,
        "their_suite/page.md": TEMPLATE,
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text.lstrip("\n"), encoding="utf-8")
    return folder
