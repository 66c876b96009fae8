"""The pymunk adapter: what it builds, at which instant it reads, what it refuses in a sentence and leaves behind.

Which order and error each method reaches stands in `test_matrix`.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pymunk
import pytest
from numpy.typing import NDArray
from pymunk import constraints

from engines import Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, bare_loop
from engines.pymunk.methods import SKATES
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingEllipse, RollingOnCircle
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from tests import ROOT
from tests.engines.test_matrix import elbow
from tests.mechanisms import four_bar

FREE, MOVING, DRIVEN = four_bar(), four_bar(10.0), four_bar(10.0, drive=10.0)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)


def largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values).max())


def test_the_default_is_the_engine_as_shipped():
    space, body = pymunk.Space(), pymunk.Body(1, 1)
    pivot = constraints.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    assert space.iterations == DEFAULT.iterations == 10
    assert pivot.error_bias == DEFAULT.error_bias == pytest.approx(0.9**60, rel=1e-5)  # it rounds 0.1 to single


@every_method
def test_no_more_is_built_than_the_mechanism_has(method):
    assert method.build(FREE, 1e-3).size == Size(bodies=3, coordinates=9, rows=8, solver_rows=8)
    # The crank's pin and drive are its motion: only three pins are left to forces.
    assert method.build(DRIVEN, 1e-3).size == Size(bodies=3, coordinates=9, rows=6, solver_rows=6)
    assert method.build(elbow(), 1e-3).size == Size(bodies=2, coordinates=6, rows=5, solver_rows=5)
    # The crank's pin and drive and the block's angle are motions; two pins and a groove are left.
    assert method.build(DrivenSliderCrank().mechanism(), 1e-3).size == Size(3, 9, 5, 5)


@pytest.mark.parametrize("grounded_first", [True, False])
def test_a_crank_turns_about_its_pin_whatever_the_order_of_its_joints(grounded_first):
    centre, rate, own = np.array([2.0, -1.0]), -3.0, (0.3, 0.1)
    angle = 0.7
    arm = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ own
    position, velocity = centre - arm, -rate * np.array([-arm[1], arm[0]])
    (x, y), (along, up) = map(float, position), map(float, velocity)
    body = Body("crank", 2.0, 0.5, (x, y, angle), (along, up, rate))
    joints = (
        (Pin("A", None, "crank", (2.0, -1.0), own), Drive("drive", None, "crank", rate, angle))
        if grounded_first
        else (Drive("drive", "crank", None, -rate, -angle), Pin("A", "crank", None, own, (2.0, -1.0)))
    )
    mechanism = Mechanism((body,), joints, (0.0, -9.81))
    for method in METHODS:
        trajectory = method.build(mechanism, 1e-2)(30, 3)
        # Rounding: the angle is a sum of at most 720 steps near one radian, weighted by less than 100 if extrapolated.
        assert largest(mechanism.gap(trajectory.pose, trajectory.t)) < 1e-12
        assert largest(mechanism.slip(trajectory.pose, trajectory.twist)) < 1e-12
        # The pin carries weight and centripetal force, and the drive the moment of the weight about the pin.
        swing = trajectory.pose[:, 0, :2] - centre
        sign = 1 if grounded_first else -1
        order = [0, 1, 2] if grounded_first else [1, 2, 0]
        force = sign * 2.0 * (-(rate**2) * swing + [0, 9.81])
        torque = sign * 2.0 * 9.81 * swing[:, 0]
        error = np.abs(trajectory.reaction[:, order] - np.column_stack([force, torque]))
        assert error[1:].max() < 1e-9  # rounding
        # Before the first sample no step lies: there stands the third step's force, 0.09 rad on, or what the third and
        # fourth extrapolate to, 6 (rate dt)^2 of the force away, or that extrapolated, with a fifth of the step.
        assert error[0].max() < {DEFAULT: 0.09, TUNED: 0.09, LEAPFROG: 6e-3, EXTENDED: 1e-9}[method] * 2.0 * 9.81


def test_two_bodies_of_prescribed_motion_cannot_be_joined():
    one = Body("one", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    joints = (
        Pin("A", None, "one", (0.0, 0.0), (0.0, 0.0)),
        Drive("first", None, "one", 1.0, 0.0),
        Drive("second", None, "one", 1.0, 0.0),
    )
    for pinned in (0, 1):  # a crank, and a body that can only turn as driven
        with pytest.raises(Unsupported, match="'second' joins two bodies whose motion is already prescribed"):
            TUNED.build(Mechanism((one,), joints[pinned:]), 1e-3)


@every_method
def test_a_motion_that_blows_up_is_a_result_and_not_an_exception(method):
    heavy = replace(MOVING, bodies=(*MOVING.bodies[:2], replace(MOVING.bodies[2], mass=1e-6, inertia=1e-9)))
    trajectory = method.build(heavy, 1e200)(20, 2)
    assert trajectory.pose.shape == (21, 3, 3)
    assert not np.all(np.isfinite(trajectory.pose))
    assert np.all(np.isnan(trajectory.reaction[~np.all(np.isfinite(trajectory.pose), axis=(1, 2))]))


def thrown(mass: float | None = None) -> Mechanism:
    """A sleigh that goes too far at once, or two links of masses too far apart for numbers."""
    if mass is None:
        sled = ChaplyginSleigh().mechanism()
        return replace(sled, bodies=(replace(sled.bodies[0], twist=(1e150, 0.0, 0.0)),))
    links = LinkPendulum().mechanism()
    return replace(links, bodies=(links.bodies[0], replace(links.bodies[1], mass=mass, inertia=mass)))


@pytest.mark.parametrize(
    ("methods", "wild", "step"),
    [
        (METHODS, RollingEllipse().mechanism(), 1e200),
        (METHODS, RollingOnCircle().mechanism(), 1e200),
        (SKATES, thrown(), 1e200),
        (METHODS[:3], thrown(1e-300), 1e-3),
        (METHODS[:2], thrown(1e300), 1e-3),
    ],
    ids=["ellipse", "hill", "sleigh", "light", "heavy"],
)
def test_so_is_one_of_contacts_of_blades_and_of_masses_too_far_apart(methods, wild, step):
    for method in methods:
        with np.errstate(all="ignore"):
            assert method.build(wild, step)(5, 2).pose.shape == (6, len(wild.bodies), 3)


@pytest.mark.parametrize(("engine", "levels"), [(TUNED, (1,)), (Extrapolated(TUNED, "two", (1, 3), (1,)), (1, 3))])
def test_the_bare_loop_takes_all_steps_of_a_run(engine, levels, monkeypatch):
    steps = []
    monkeypatch.setattr("engines.pymunk.repeat", lambda _, count: steps.append(count) or range(count))
    bare_loop(engine, FREE, 1e-4, 20)
    assert steps == [20 * level for level in levels]


def test_no_space_is_left_for_the_end_of_the_interpreter():
    """Freeing one there may crash the process after it has said all, and its exit status is another."""
    code = """
import gc, pymunk, engines.registry
gc.collect()
print([each for each in gc.get_objects() if isinstance(each, (pymunk.Space, pymunk.Body))])
"""
    told = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (told.returncode, told.stdout, told.stderr) == (0, "[]\n", "")
