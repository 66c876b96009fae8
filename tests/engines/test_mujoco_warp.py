"""Tests that MuJoCo Warp moves like MuJoCo to single precision, and tests of statements in its adapter.

On a new computer Warp compiles its kernels for minutes, so the tests that run Warp are marked as slow.
"""

from __future__ import annotations

import numpy as np
import pytest

from engines import Unsupported, mjx, mujoco_warp
from engines.device import DEVICE, chosen_device
from reference.scenes.catalogue import scene
from tests.engines.test_promised import MECHANISMS, SAMPLES, installed, span


@pytest.fixture
def with_warp() -> None:
    installed(mujoco_warp.DEFAULT)


def test_an_unknown_device_is_refused_by_name(monkeypatch):
    assert chosen_device() == "cpu"
    monkeypatch.setenv(DEVICE, "abacus")
    with pytest.raises(Unsupported, match="'abacus'; it must be 'cpu' or 'cuda'"):
        chosen_device()


@pytest.mark.parametrize("engine", [mjx.DEFAULT, mujoco_warp.DEFAULT], ids=lambda engine: engine.name)
def test_joints_that_need_a_contact_are_refused(engine):
    for name in ("sleigh", "rolling_disc"):
        with pytest.raises(Unsupported, match=f"our adapter of {engine.title} builds none"):
            engine.build(scene(name).mechanism(), 1e-2)


@pytest.mark.slow
@pytest.mark.usefixtures("with_warp")
def test_a_device_that_is_not_here_is_refused(monkeypatch):
    monkeypatch.setenv(DEVICE, "cuda")
    with pytest.raises(Unsupported, match="Warp finds no device 'cuda' here"):
        mujoco_warp.DEFAULT.build(scene("pendulum_2").mechanism(), 1e-2)


@pytest.mark.slow
@pytest.mark.usefixtures("with_warp")
@pytest.mark.parametrize("engine", mujoco_warp.VARIANTS, ids=lambda engine: engine.variant)
@pytest.mark.parametrize("name", [name for name in MECHANISMS if name != "weld that closes a loop"])
def test_it_moves_as_mujoco_with_the_same_settings(engine, name):
    """The error of single precision in these motions is at most 2e-6."""
    spacing = span(name) / SAMPLES / 40
    found, expected = (method.build(MECHANISMS[name], spacing)(SAMPLES, 40) for method in (engine, engine.settings))
    bound = 1e-4 if any("velocity term" in warning for warning in found.warnings) else 5e-6
    assert np.abs(found.pose - expected.pose).max() < bound * max(1.0, np.abs(expected.pose).max())


@pytest.mark.slow
@pytest.mark.usefixtures("with_warp")
def test_the_stiffest_impedance_is_worse_in_single_precision():
    linkage, truth = scene("free_four_bar"), scene("free_four_bar").motion
    stiffest = mujoco_warp.MuJoCoWarp("stiffest", mujoco_warp.C_TUNED)
    errors = []
    for engine in (mujoco_warp.TUNED, stiffest):
        run = engine.build(linkage.mechanism(), 1e-3)(50, round(0.02 * linkage.duration / 1e-3))
        errors.append(np.abs(run.pose - truth(run.t).pose).max())
    assert errors[0] < errors[1]
