"""Models that we did not write: each is read, or refused in one sentence. Nothing of theirs is kept here."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import mujoco
import numpy as np
import pymunk
import pytest

from engines import Unsupported
from engines.mujoco import read
from reference.validation import InvalidMechanism
from reports.check.comparing import refuse_disagreement

pytestmark = pytest.mark.slow

EXAMPLES = Path(pymunk.__file__).parent / "examples"
# In a process of its own: windows and drawing are replaced, and the space of the first step is looked at.
ASK = """
import json, os, runpy, signal, sys
from unittest.mock import MagicMock

for name in ("pygame", "pygame.locals", "pygame.color", "pygame.font", "pyglet", "pyglet.gl", "pyglet.window"):
    sys.modules[name] = MagicMock()
import pymunk

for name in ("pygame_util", "pyglet_util"):
    sys.modules[f"pymunk.{name}"] = MagicMock()
    setattr(pymunk, name, sys.modules[f"pymunk.{name}"])

class Stepped(BaseException):
    pass

def step(space, dt):
    raise Stepped(space, dt)

own, pymunk.Space.step = pymunk.Space.step, step
pymunk.Space.debug_draw = lambda space, options: None
signal.alarm(20)
try:
    runpy.run_path(sys.argv[1], run_name="__main__")
    print(json.dumps(None))
except Stepped as stepped:
    space, dt = stepped.args
    pymunk.Space.step = own
    from engines import Unsupported
    from engines.pymunk import read
    from reference.validation import InvalidMechanism
    from reports.check.comparing import refuse_disagreement
    try:
        reading = read(space, dt)
        told = {"read": [len(reading.mechanism.bodies), refuse_disagreement(reading)]}
    except (Unsupported, InvalidMechanism) as reason:
        told = {"refused": str(reason)}
    print(json.dumps(told))
except BaseException as reason:
    print(json.dumps(None))
"""


@pytest.fixture(scope="module")
def answers():
    """By the name of an example what became of its space; None where the example makes none without a window."""
    out = {}
    for path in sorted(EXAMPLES.glob("*.py")):
        if path.name.startswith("_"):
            continue
        told = subprocess.run(
            [sys.executable, "-c", ASK, str(path)],
            cwd=Path(__file__).resolve().parents[1],
            env={"PYTHONPATH": f"{Path(__file__).resolve().parents[1]}:{EXAMPLES}", "PATH": ""},
            capture_output=True,
            text=True,
        )
        lines = told.stdout.splitlines()
        out[path.stem] = json.loads(lines[-1]) if lines and told.returncode == 0 else "crashed"
    return out


def test_every_space_of_pymunks_examples_is_read_or_refused_in_a_sentence(answers):
    assert "crashed" not in answers.values()
    spaces = {name: told for name, told in answers.items() if told is not None}
    assert len(spaces) >= 10
    for told in spaces.values():
        if "read" in told:
            assert told["read"][1] < 1e-6
        else:
            assert "\n" not in told["refused"]
            assert 20 < len(told["refused"]) < 400


# What each is expected to give, with all that is no ideal joint switched off, or the words of the refusal.
SWITCHED = ("contact", "limit", "armature", "frictionloss", "fluid")
GYMNASIUM = {
    "half_cheetah": 7,
    "hopper": 4,
    "inverted_double_pendulum": 3,
    "inverted_pendulum": 2,
    "reacher": 3,
    "swimmer": 3,
    "walker2d": 7,
    "ant": "not parallel",
    "humanoid": "not parallel",
}
DM_CONTROL = {
    "acrobot": 2,
    "cartpole": 2,
    "cheetah": 7,
    "hopper": 5,
    "pendulum": 1,
    "reacher": 2,
    "walker": 7,
    "finger": 3,
    "manipulator": "couples the angles",
    "point_mass": "a force along a slide",
    "quadruped": "not parallel",
}


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """The packages' own files, fetched by pip and unpacked; skipped where no registry answers."""
    folder = tmp_path_factory.mktemp("packages")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(folder)]
    told = subprocess.run([*command, "gymnasium", "dm_control"], capture_output=True, text=True)
    if told.returncode:
        pytest.skip("pip finds no registry here")
    for wheel in folder.glob("*.whl"):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder / wheel.name.split("-")[0])
    return folder


@pytest.mark.parametrize(
    ("place", "name", "expected"),
    [
        *(("gymnasium/gymnasium/envs/mujoco/assets", *item) for item in GYMNASIUM.items()),
        *(("dm_control/dm_control/suite", *item) for item in DM_CONTROL.items()),
    ],
)
def test_a_model_of_a_package_is_read_or_refused_in_a_sentence(packages, place, name, expected):
    model = mujoco.MjModel.from_xml_path(str(packages / place / f"{name}.xml"))  # type: ignore[attr-defined]
    if isinstance(expected, str):
        with pytest.raises((Unsupported, InvalidMechanism), match=expected):
            read(model, None, SWITCHED)
        return
    data, random = mujoco.MjData(model), np.random.default_rng(1)  # type: ignore[attr-defined]
    data.qpos[:] += random.uniform(-0.5, 0.5, model.nq)
    data.qvel[:] = random.uniform(-2, 2, model.nv)
    data.ctrl[:] = 0.3
    reading = read(model, data, SWITCHED)
    assert len(reading.mechanism.bodies) == expected
    assert refuse_disagreement(reading) < 1e-9
