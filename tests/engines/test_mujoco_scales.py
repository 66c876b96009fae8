"""A mechanism of a millimetre and one of a kilometre move alike in MuJoCo, and so do grams and thousands of tonnes."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import DEFAULT, EXTENDED, METHODS, MuJoCo, Shipped
from reference.forces import Spring, Torque
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import scene
from reports.search.mechanisms import mechanism as drawn
from reports.search.parts import EVERY

POINTS = ("first_point", "second_point")


def scaled(mechanism: Mechanism, length: float, mass: float) -> Mechanism:
    """The same mechanism in other units of length and mass; time is left as it is, so that steps are."""
    bodies = tuple(
        replace(
            body,
            mass=mass * body.mass,
            inertia=mass * length**2 * body.inertia,
            pose=(length * body.pose[0], length * body.pose[1], body.pose[2]),
            twist=(length * body.twist[0], length * body.twist[1], body.twist[2]),
        )
        for body in mechanism.bodies
    )
    joints = tuple(
        replace(
            joint,
            **{
                name: tuple(length * value for value in getattr(joint, name)) for name in POINTS if hasattr(joint, name)
            },
        )
        for joint in mechanism.joints
    )
    return Mechanism(bodies, joints, tuple(length * value for value in mechanism.gravity))  # type: ignore[arg-type]


def numbers(engine: MuJoCo, mechanism: Mechanism, length: float, mass: float) -> tuple[Any, ...]:
    """Poses, twists and reactions in the units of the mechanism that was scaled."""
    motion = engine.build(scaled(mechanism, length, mass), 1e-3)(5, 10)
    unit = np.array([length, length, 1.0])
    torque = np.array([isinstance(joint, Drive) for joint in mechanism.joints for _ in range(joint.size)])
    force = mass * length * np.where(torque, length, 1.0)
    return motion.pose / unit, motion.twist / unit, motion.reaction / force, motion.warnings


@dataclass(frozen=True)
class WideAsTheMechanism(Shipped):
    """The shipped impedance, but the gap over which it grows is a millimetre to a mechanism of a metre only."""

    length: float = 1.0

    @property
    def impedance(self) -> tuple[float, float, float, float, float]:
        low, high, width, middle, power = super().impedance
        return low, high, width * self.length, middle, power


SCALES = ((1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6))
SCENES = ("free_four_bar", "driven_slider_crank", "sleigh", "cart")
# All that hold loops, slots, skates and drives by numbers of the mechanism's own.
OWN = tuple(engine for engine in METHODS if not isinstance(engine.stiffness, Shipped))


@pytest.mark.parametrize("engine", OWN, ids=lambda engine: engine.variant)
@pytest.mark.parametrize("name", SCENES)
def test_units_of_length_and_mass_change_no_method(name: str, engine: MuJoCo) -> None:
    mechanism = scene(name).mechanism()
    own = numbers(engine, mechanism, 1.0, 1.0)
    for length, mass in SCALES:
        same(numbers(engine, mechanism, length, mass), own, mass)


@pytest.mark.parametrize("name", SCENES[:2])
def test_as_shipped_a_millimetre_of_the_impedance_is_all_that_has_a_unit(name: str) -> None:
    mechanism = scene(name).mechanism()
    tight = replace(DEFAULT, tolerance=1e-15)  # as shipped it stops by metres per second squared
    own = numbers(tight, mechanism, 1.0, 1.0)
    for length, mass in SCALES:
        same(numbers(replace(tight, stiffness=WideAsTheMechanism(length)), mechanism, length, mass), own, mass)
    small = numbers(DEFAULT, mechanism, 1e-3, 1.0)
    assert np.abs(small[0] - own[0]).max() > 1e-7


def same(found: tuple[Any, ...], own: tuple[Any, ...], mass: float) -> None:
    # In other units numbers are rounded otherwise, and a stiff spring amplifies that; other masses round nothing.
    allowed = 1e-9 if mass == 1 else 1e-10
    for values, expected in zip(found[:3], own[:3], strict=True):
        assert np.abs(values - expected).max() < allowed * np.abs(expected).max()
    assert found[3] == own[3]


def test_a_spring_at_an_arm_of_a_tenth_of_a_micrometre_turns_its_body() -> None:
    """MuJoCo takes a site within 1e-6 m for its body's origin when it compiles, so that there is no arm."""
    text = """<mujoco><worldbody><body><joint type="hinge" axis="0 0 1"/><inertial pos="0 0 0" mass="1"
        diaginertia="1 1 1"/><site pos="0 {} 0"/></body></worldbody></mujoco>"""
    as_compiled = [mujoco.MjModel.from_xml_string(text.format(arm)).site_sameframe[0] for arm in (0.99e-6, 1.01e-6)]
    assert as_compiled == [mujoco.mjtSameFrame.mjSAMEFRAME_BODY, mujoco.mjtSameFrame.mjSAMEFRAME_BODYROT]

    pin = Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0))
    spring = Spring("spring", None, "body", (1.0, 0.0), (0.0, 1e-7), 1.0, 0.0)
    mechanism = Mechanism((Body("body", 1.0, 1e-7, (0.0, 0.0, 0.0)),), (pin,), (0.0, 0.0), (spring,))
    for engine in (DEFAULT, EXTENDED):
        data = engine.build(mechanism, 1e-3).data
        assert abs(data.qacc[0] + 1.0) < 1e-12  # 1 N at 1e-7 m of 1e-7 kg m^2, backwards


def test_a_drive_of_wheels_as_large_as_a_town_is_no_softer_than_that_of_small_ones() -> None:
    """Its row's inverse inertia is so small a number of 1 / (kg m^2) that MuJoCo would not take its compliance."""
    missed = []
    for size in (1.0, 1e6):
        bodies = tuple(
            Body(name, 1.0, inertia * size**2, (place * size, 0.0, 0.0), (0.0, 0.0, rate))
            for name, inertia, place, rate in (("large", 1.0, 0.0, -1.0), ("small", 1e-3, 3.0, -3.0))
        )
        pin = Pin("pin", None, "large", (-0.5 * size, 0.0), (-0.5 * size, 0.0))
        bodies = (replace(bodies[0], twist=(0.0, -0.5 * size, -1.0)), bodies[1])
        drive = Drive("drive", "large", "small", -2.0, 0.0)
        torque = Torque("torque", "small", "large", -10.0 * size**2)
        run = EXTENDED.build(Mechanism(bodies, (pin, drive), (0.0, 0.0), (torque,)), 1e-3)(10, 10)
        missed.append(np.abs(run.pose[:, 1, 2] - run.pose[:, 0, 2] + 2.0 * run.t).max())
    assert missed[0] < 1e-10
    assert missed[1] < 1e-10


def test_extended_begins_with_accelerations_of_light_bodies_that_are_solved() -> None:
    """From nothing Newton's method ends where it sees its cost no longer fall: 1e-5 of the light body's are missed."""
    mechanism = drawn(1199539626, 2, EVERY, 4)
    dt = 0.01 * mechanism.time_scale
    run, once = EXTENDED.build(mechanism, dt), EXTENDED.model(mechanism, dt)
    first = once.start().qacc.copy()
    with run.model.hooked():
        mujoco.mj_forward(run.model.compiled, run.data)
    solved = run.data.qacc.copy()
    run.data.qacc_warmstart[:] = solved
    with run.model.hooked():
        mujoco.mj_forward(run.model.compiled, run.data)
    assert np.abs(first - run.data.qacc).max() > 1e-7 * np.abs(first).max()
    assert np.abs(solved - run.data.qacc).max() < 1e-12 * np.abs(first).max()
