"""MuJoCo's sparse factorisation against its dense one: the same accelerations, and release 4.0.0 found out."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import os
import subprocess
import sys
import venv
from pathlib import Path

import mujoco
import pytest

from engines import Unsupported
from engines import mujoco as adapter
from engines.mujoco.methods import SKATES
from reference.scenes.catalogue import SCENES
from tests.engines import mujoco_factorisation as factorisation
from tests.engines.mujoco_factorisation import AGREEMENT, disagreement

# Three links on the tip of the first, a fifth on one of them, two loops across: the smallest that 4.0.0 gets wrong.
PARENTS = (-1, 0, 0, 0, 2)
CROSSING = ((2, 1), (3, 1))


def branching_tree() -> str:
    def link(index: int) -> str:
        carried = "".join(link(child) for child, parent in enumerate(PARENTS) if parent == index)
        place = "0 0 0" if index == 0 else "1 0 0"
        return (
            f'<body name="link {index}" pos="{place}"><joint axis="0 0 1"/>'
            f'<inertial pos="0.5 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>{carried}</body>'
        )

    loops = "".join(f'<connect body1="link {a}" body2="link {b}" anchor="1 0 0"/>' for a, b in CROSSING)
    return (
        '<mujoco><option gravity="0 -9.81 0"><flag contact="disable"/></option>'
        f"<worldbody>{link(0)}</worldbody><equality>{loops}</equality></mujoco>"
    )


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_every_model_has_the_same_accelerations_dense_and_sparse(scene) -> None:
    mechanism = scene.mechanism()
    # Of nine methods three each, by the scene's place; and what free bodies make of a chain of a hundred takes long.
    few = len(mechanism.bodies) < 30
    for engine in (
        (*adapter.METHODS, *SKATES)[SCENES.index(scene) % 3 :: 3] if few else (adapter.TUNED, adapter.EXTENDED)
    ):
        try:
            model = engine.model(mechanism, 1e-3)
        except Unsupported:
            continue
        assert disagreement(model.compiled) < AGREEMENT, engine.variant


def test_this_release_solves_the_tree_that_an_earlier_one_did_not() -> None:
    assert disagreement(mujoco.MjModel.from_xml_string(branching_tree())) < AGREEMENT


def test_asking_leaves_the_model_as_it_was() -> None:
    model = mujoco.MjModel.from_xml_string(branching_tree())
    before = (model.opt.jacobian, model.opt.tolerance, model.opt.solver)
    disagreement(model)
    assert (model.opt.jacobian, model.opt.tolerance, model.opt.solver) == before


def test_a_difference_in_the_inertia_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = mujoco.mj_forward

    def wrong(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        right(model, data)
        if model.opt.jacobian == mujoco.mjtJacobian.mjJAC_SPARSE:
            data.qacc[-1] *= 1 + 1e-6

    monkeypatch.setattr(factorisation.mujoco, "mj_forward", wrong)
    assert disagreement(mujoco.MjModel.from_xml_string(branching_tree())) > AGREEMENT


def test_states_away_from_the_models_own_are_asked_too(monkeypatch: pytest.MonkeyPatch) -> None:
    right, places = mujoco.mj_forward, []

    def noted(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        places.append(tuple(data.qpos))
        right(model, data)

    monkeypatch.setattr(factorisation.mujoco, "mj_forward", noted)
    disagreement(mujoco.MjModel.from_xml_string(branching_tree()), states=4)
    assert len(set(places)) == 4
    assert places[0] == (0.0,) * len(PARENTS)


@pytest.mark.slow
def test_the_guard_catches_release_4_0_0(tmp_path: Path) -> None:
    home = tmp_path / "environment"
    venv.create(home, with_pip=True)
    python = str(home / ("Scripts/python.exe" if os.name == "nt" else "bin/python"))
    install = [python, "-m", "pip", "install", "--quiet", "mujoco-core==4.0.0"]
    if subprocess.run(install, capture_output=True, timeout=300, check=False).returncode:
        pytest.skip("MuJoCo 4.0.0 can't be installed here")
    model = tmp_path / "tree.xml"
    model.write_text(branching_tree())

    def asked(interpreter: str) -> tuple[str, float]:
        command = [interpreter, str(factorisation.__file__), str(model)]
        version, number = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
        return version, float(number)

    version, number = asked(python)
    assert version == "4.0.0"
    assert number > 1e-3
    version, number = asked(sys.executable)
    assert version == mujoco.__version__
    assert number < AGREEMENT
