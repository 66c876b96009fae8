"""Releases of MuJoCo that move wrongly: their motions say so, those of other releases don't."""

from __future__ import annotations

import mujoco
import pytest

from engines.mujoco import DEFAULT
from engines.mujoco.releases import MARK, known_wrong
from reference.scenes.four_bar.scenes import FreeFourBar


@pytest.mark.parametrize(
    ("version", "reason"), [("3.3.7", "velocity term"), ("3.6.0", "velocity term"), ("4.0.0", "Hessian")]
)
def test_motions_of_a_version_that_moves_wrongly_say_so(
    monkeypatch: pytest.MonkeyPatch, version: str, reason: str
) -> None:
    monkeypatch.setattr(mujoco, "__version__", version)
    scene = FreeFourBar()
    motion = DEFAULT.build(scene.mechanism(), scene.spacing)(1, 1)
    [told] = [warning for warning in motion.warnings if MARK in warning]
    assert told.startswith("ours: ")
    assert reason in told
    assert version in told


@pytest.mark.parametrize("version", ["3.7.0", "3.10.0", "3.17.0", "4.0.1", "4.1.0", mujoco.__version__])
def test_versions_that_move_rightly_have_no_mark(version: str) -> None:
    assert known_wrong(version) == ""
