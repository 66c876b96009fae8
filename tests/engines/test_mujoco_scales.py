"""A mechanism of a millimetre and one of a kilometre move alike in MuJoCo, and so do grams and thousands of tonnes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from engines.mujoco import DEFAULT, METHODS, MuJoCo, Shipped
from reference.joints import Drive
from reference.mechanism import Mechanism
from reference.scenes.catalogue import scene

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
