"""MJX: MuJoCo's model by another implementation. Slow: a model takes tens of seconds to compile."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mjx import DEFAULT, NO_VELOCITY_TERM, TUNED, VARIANTS
from reference.joints import Gear, Pin
from reference.mechanism import Body, Mechanism
from reports.model.catalogue import SCENES
from reports.pages.engines.experiments import reactions_with, started_anew
from tests.mechanisms import ALONE
from tests.present import present

BY_NAME = {scene.name: scene for scene in SCENES}


@pytest.fixture
def installed() -> None:
    if DEFAULT.missing:
        pytest.skip(DEFAULT.missing)


@pytest.fixture(autouse=True)
def _programs_forgotten():
    """After each test: JAX ends a process that has compiled some hundreds of programs by a segmentation fault."""
    yield
    if "jax" in sys.modules:
        sys.modules["jax"].clear_caches()


def test_what_c_code_would_have_to_run_is_refused():
    for name in ("sleigh", "rolling_disc"):
        with pytest.raises(Unsupported, match="our adapter of MJX builds none"):
            DEFAULT.build(BY_NAME[name].mechanism(), 1e-2)


NO_DEVICE = """
from engines import Unsupported
from engines.mjx import DEFAULT
from reference.scenes.catalogue import SCENES
scene = next(each for each in SCENES if each.name == "pendulum_2")
try:
    DEFAULT.build(scene.mechanism(), 1e-2)
except Unsupported as reason:
    print(reason)
"""


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
def test_a_device_that_is_not_there_is_a_refusal_in_one_line():
    environment = {**os.environ, "JAX_PLATFORMS": "cuda"}
    run = subprocess.run([sys.executable, "-c", NO_DEVICE], capture_output=True, text=True, env=environment, check=True)
    assert run.stdout == "JAX finds no device to run on here: JAX_PLATFORMS is 'cuda'\n"


def geared(arm: float, light: float, wheel: float, gravity: tuple[float, float]) -> Mechanism:
    """A pendulum of 2 g and `light` kg m^2, geared to the wheel of a free body of 20 t; of random search, seed
    1189519295."""
    bodies = Body("pendulum", 2e-3, light, (0.0, 0.0, 0.0)), Body("free", 2e4, wheel, (0.0, 0.0, 0.0))
    pin = Pin("pin", None, "pendulum", (arm, -arm), (arm, -arm))
    return Mechanism(bodies, (pin, Gear("gear", "pendulum", "free", 2.0, 0.0)), gravity=gravity)


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
def test_what_the_solver_leaves_within_its_tolerance_is_told():
    """As shipped, 1e-8 of all inertias: more than all that a wheel of 1e-6 kg m^2 beside 500 kg m^2 costs."""
    run = DEFAULT.build(geared(500.0, 500.0, 1e-6, (-1e-3, 9e-4)), 12.0)(4, 10)
    assert [each.startswith("ours: the solver missed the accelerations") for each in run.warnings] == [True]
    mended = replace(DEFAULT, settings=replace(DEFAULT.settings, tolerance=1e-28))
    assert mended.build(geared(500.0, 500.0, 1e-6, (-1e-3, 9e-4)), 12.0)(4, 10).warnings == ()


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
def test_forces_of_a_loop_are_those_of_its_declared_compliance_without_the_velocity_term():
    """(A + R) f = b: R is what the compiled model itself declares (`efc_R`), and b has the term J-dot v or not.

    Nothing is left to a choice then: from the law without the term only rounding and the solver's tolerance differ.
    """
    scene = BY_NAME["free_four_bar"]
    truth = scene.motion(np.linspace(0.2, 1.0, 4) * scene.duration)
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        now = started_anew(scene.mechanism(), pose, twist)
        soft = present(TUNED.softness(now, 1e-3))
        model = TUNED.settings.model(now, 1e-3)
        declared = np.zeros(now.row_count)
        # A connect has a third row, out of the plane; in the model masses have a unit.
        declared[np.flatnonzero(soft.rows)] = model.start().efc_R[:2] / model.unit
        told = TUNED.build(now, 1e-3)(1, 1).reaction[0]
        largest = np.abs(told).max()
        assert np.abs(told - reactions_with(now, soft.rows, False, declared)).max() < 1e-9 * largest
        assert np.abs(told - reactions_with(now, soft.rows, True, declared)).max() > 1e-3 * largest
        # Without the compliance the law is missed by at most |R| / (the least eigenvalue of A) of the force itself.
        weight = 1 / now.inertias.reshape(-1)
        rows = now.rows(now.pose)
        held = np.linalg.inv((rows * weight) @ rows.T)[np.ix_(soft.rows, soft.rows)]  # of the loop, the others held
        bound = declared.max() * np.linalg.eigvalsh(held).max()
        assert bound < 1e-3
        assert np.abs(told - reactions_with(now, soft.rows, False)).max() < bound * largest


# Of each kind of element that has a construction of its own in the model: tendons, actuators, equalities; and a tree.
COMPILED = ("spring", "torsion spring", "force", "gear", "rod", "weld", "pendulum_2")


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize("name", COMPILED)
def test_elements_move_as_in_mujoco(name):
    mechanism = ALONE[name] if name in ALONE else BY_NAME[name].mechanism()
    exact = TRUTH.build(mechanism, 0.05)(6, 1)
    for engine in VARIANTS if name == "pendulum_2" else (DEFAULT,):
        here, there = (each.build(mechanism, 2e-3)(6, 25) for each in (engine, engine.settings))
        np.testing.assert_allclose(here.pose, there.pose, rtol=0, atol=1e-11)
        np.testing.assert_allclose(here.reaction, there.reaction, rtol=0, atol=1e-8)
        # The gear hangs on a rod.
        assert here.warnings == ((NO_VELOCITY_TERM,) if name in ("rod", "gear") else ())
        assert np.abs(here.pose - exact.pose).max() < 1e-2
