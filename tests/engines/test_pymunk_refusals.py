"""What the pymunk adapter refuses in a sentence, and what it leaves behind."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported
from engines.extrapolated import Extrapolated
from engines.lagrange import Lagrange
from engines.pymunk import METHODS, TUNED, Pymunk, bare_loop
from reference.joints import Drive, Joint, Pin
from reference.mechanism import Body, Mechanism
from tests import ROOT
from tests.mechanisms import four_bar, pendulum

FREE, MOVING = four_bar(), four_bar(10.0)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)


def test_two_bodies_of_prescribed_motion_cannot_be_joined():
    one = Body("one", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    joints = (
        Pin("A", None, "one", (0.0, 0.0), (0.0, 0.0)),
        Drive("first", None, "one", 1.0, 0.0),
        Drive("second", None, "one", 1.0, 0.0),
    )
    with pytest.raises(Unsupported, match="'second' joins two bodies whose motion is already prescribed"):
        TUNED.build(Mechanism((one,), joints), 1e-3)


def test_a_joint_that_has_no_construction_is_refused_in_a_sentence():
    class Weld:
        """Looks like a joint to the mechanism, is none that the engine knows."""

        def __init__(self, pin: Joint) -> None:
            self.pin = pin

        def __getattr__(self, name: str):
            return getattr(self.pin, name)

    mechanism = pendulum()
    odd = replace(mechanism)
    object.__setattr__(odd, "joints", (Weld(mechanism.joints[0]),))
    with pytest.raises(Unsupported, match="no construction for a Weld"):
        TUNED.build(odd, 1e-3)


@pytest.mark.parametrize("iterations", [0, -1, 2.5, float("nan"), 2**31, "10", None])
def test_iterations_that_would_abort_the_process_are_refused(iterations):
    with pytest.raises(ValueError, match="iterations is"):
        Pymunk("mine", iterations=iterations)


@pytest.mark.parametrize("error_bias", [-0.1, 1.5, float("nan"), float("inf"), "0", None])
def test_an_error_bias_that_would_abort_the_process_is_refused(error_bias):
    with pytest.raises(ValueError, match="error_bias is"):
        Pymunk("mine", error_bias=error_bias)


@every_method
def test_a_motion_that_blows_up_is_a_result_and_not_an_exception(method):
    heavy = replace(MOVING, bodies=(*MOVING.bodies[:2], replace(MOVING.bodies[2], mass=1e-6, inertia=1e-9)))
    trajectory = method.build(heavy, 1e200)(20, 2)
    assert trajectory.pose.shape == (21, 3, 3)
    assert not np.all(np.isfinite(trajectory.pose))
    assert np.all(np.isnan(trajectory.reaction[~np.all(np.isfinite(trajectory.pose), axis=(1, 2))]))


@pytest.mark.parametrize(("engine", "levels"), [(TUNED, (1,)), (Extrapolated(TUNED, "two", (1, 3), (1,)), (1, 3))])
def test_the_bare_loop_takes_all_steps_of_a_run(engine, levels, monkeypatch):
    steps = []
    monkeypatch.setattr("engines.pymunk.repeat", lambda _, count: steps.append(count) or range(count))
    bare_loop(engine, FREE, 1e-4, 20)
    assert steps == [20 * level for level in levels]


def test_the_bare_loop_of_another_engine_is_refused():
    other = Extrapolated(Lagrange("rk4", "none"), "extended", (1, 2), (4,))
    with pytest.raises(ValueError, match="it must be pymunk"):
        bare_loop(other, FREE, 1e-3, 10)


def test_no_space_is_left_for_the_end_of_the_interpreter():
    """Freeing one there may crash the process after it has said all, and its exit status is another."""
    code = """
import gc, pymunk, engines.registry
gc.collect()
print([each for each in gc.get_objects() if isinstance(each, (pymunk.Space, pymunk.Body))])
"""
    told = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (told.returncode, told.stdout, told.stderr) == (0, "[]\n", "")
