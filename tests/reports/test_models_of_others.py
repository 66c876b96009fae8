"""Models that we did not write: each is read, or refused in one sentence. Nothing of theirs is kept here."""

from __future__ import annotations

from dataclasses import asdict

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import read
from reference.checks import InvalidMechanism
from reports.check.judging import refuse_disagreement
from reports.pages.your_model.page import rows
from tests.reports.models_of_others import models, spaces, unpacked

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def examples():
    return list(spaces())


def test_every_space_of_pymunks_examples_is_read_or_refused_in_a_sentence(examples):
    assert len(examples) >= 10
    for found in examples:
        if not found.bodies:
            assert "\n" not in found.reason
            assert 20 < len(found.reason) < 400


def test_the_table_of_the_page_has_every_example_of_pymunk(examples):
    assert [asdict(found) for found in examples] == [row for row in rows() if row["source"] == "pymunk"]


def test_the_table_of_the_page_has_every_model_of_the_packages(packages):
    assert [asdict(found) for found in models(packages)] == [row for row in rows() if row["source"] != "pymunk"]


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
    if not unpacked(folder):
        pytest.skip("pip finds no registry here")
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
