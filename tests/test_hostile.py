"""Scenes and engines of somebody else that exit, trap, hang, fork or lie: an outcome or one line, never a traceback."""

from __future__ import annotations

import re

import pytest

from reports.cli import trial
from reports.grid.ending import FINE, REFUSED
from reports.grid.store import Store
from tests.test_command_line import call, one_line

SCENE = """
import os, signal, time
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from tests.toys import Disc, turning

@dataclass(frozen=True)
class Odd(Disc):
    name: ClassVar[str] = "odd"

"""
ENGINE = """
import os, signal, time
from dataclasses import dataclass
from tests.toys import Toy, ToyRun

@dataclass(frozen=True)
class Odd(Toy):
    name: str = "odd"

"""
DEEDS = {
    "raises": "raise RuntimeError('no such thing')",
    "refuses": "raise ValueError('no such thing')",
    "exits": "os._exit(0)",
    "leaves": "raise SystemExit(0)",
    "interrupts": "raise KeyboardInterrupt",
    "traps": "os.kill(os.getpid(), signal.SIGILL)",
    "sleeps": "time.sleep(1e6)",
    "nothing": "return None",
}
OF_SCENES = {
    "mechanism": "def mechanism(self):",
    "__eq__": "__hash__ = Disc.__hash__\n    def __eq__(self, other):",
    "__hash__": "def __hash__(self):",
    "__repr__": "def __repr__(self):",
    "samples": "@property\n    def samples(self):",
    "__post_init__": "def __post_init__(self):",
}
OF_ENGINES = {"__hash__": "def __hash__(self):", "packages": "", "step_cost": "def step_cost(self, mechanism):"}


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(trial, "TIME_LIMIT", 2.0)
    monkeypatch.setattr(trial, "SLEEPING", 2.0)
    return tmp_path


def member(text, head, deed):
    return f"{text}    {head}\n        {DEEDS[deed]}\n"


def told_in_a_line(capfd):
    told = one_line(capfd.readouterr().err)
    assert "Traceback" not in told
    return told


@pytest.mark.parametrize(
    ("name", "deed"),
    [
        *(("mechanism", deed) for deed in DEEDS),
        *(("samples", deed) for deed in ("raises", "exits", "nothing")),
        *((name, deed) for name in ("__eq__", "__hash__", "__repr__", "__post_init__") for deed in ("raises", "exits")),
    ],
)
def test_what_a_scene_s_own_code_does_is_one_line(here, capfd, name, deed):
    (here / "odd_scene.py").write_text(member(SCENE, OF_SCENES[name], deed).replace("ClassVar[str]", "ClassVar[str]"))
    for words in (("run", "odd_scene.py"), ("export", "odd_scene.py")):
        if (name, deed) == ("__post_init__", "nothing"):
            continue
        assert call(*words) == REFUSED
        assert "odd_scene.py" in told_in_a_line(capfd)
