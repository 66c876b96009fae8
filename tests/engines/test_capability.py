"""A joint or a force element that an adapter does not know is refused by name, never left out of the model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from engines import Unsupported, registry
from engines.lagrange import Lagrange
from engines.mujoco.writers import MJCF, URDF
from engines.pymunk.written_script import SCRIPT
from reference.forces import Torque
from reference.joints import Gear, Pin
from reference.mechanism import Body, Mechanism


@dataclass(frozen=True)
class Belt(Gear):
    """A joint newer than every adapter: the rotations are coupled by the ratio of two pulleys."""


@dataclass(frozen=True)
class Brake(Torque):
    """A force element newer than every adapter: a smoothed Coulomb torque."""

    def on(self, first, second, first_twist, second_twist):
        rate = second_twist[..., 2] - first_twist[..., 2]
        return -super().on(first, second, first_twist, second_twist) * np.tanh(rate / 0.1)[..., None]


PLATES = (
    Body("a", 2.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0)),
    Body("b", 1.0, 0.1, (1.0, 0.0, 0.0), (0.0, 0.0, 4.0)),
)
PINS = (Pin("A", None, "a", (0.0, 0.0), (0.0, 0.0)), Pin("B", None, "b", (1.0, 0.0), (0.0, 0.0)))
WITH_BELT = Mechanism(PLATES, (*PINS, Belt("belt", "a", "b", 2.0)), (0.0, 0.0))
WITH_BRAKE = Mechanism(PLATES, PINS, (0.0, 0.0), (Brake("brake", None, "a", 0.2),))
ENGINES = (*registry.ENGINES, *registry.OTHERS)
OURS = ("lagrange", "box2d", "bullet", "pinocchio")  # they evaluate force elements by the elements' own law


REFUSED = [(engine, WITH_BELT, "Belt") for engine in ENGINES if engine.name != "lagrange"]
REFUSED += [(engine, WITH_BRAKE, "Brake") for engine in ENGINES if engine.name not in OURS]


@pytest.mark.parametrize(("engine", "mechanism", "named"), REFUSED, ids=lambda value: getattr(value, "variant", None))
def test_an_adapter_refuses_an_element_that_it_does_not_know_by_name(engine, mechanism, named):
    if engine.missing:
        pytest.skip(engine.missing)
    with pytest.raises(Unsupported, match=named):
        engine.build(mechanism, 0.01)


@pytest.mark.parametrize("writer", [MJCF, URDF, SCRIPT], ids=lambda writer: type(writer).__name__)
def test_a_written_file_never_lacks_an_element(writer):
    for mechanism in (WITH_BELT, WITH_BRAKE):
        with pytest.raises(Unsupported):
            writer.write(mechanism, 0.01, "default")


@pytest.mark.parametrize("name", OURS)
def test_an_engine_that_evaluates_forces_by_their_own_law_brakes_the_plate(name):
    engine = next(engine for engine in ENGINES if engine.name == name)
    if engine.missing:
        pytest.skip(engine.missing)
    run = engine.build(WITH_BRAKE, 1e-3)(10, 50)
    # 0.2 N m on 0.1 kg m^2 for 0.5 s; the tanh differs from 1 by 2e-9 while the plate is faster than 1 rad/s.
    assert run.twist[-1, 0, 2] == pytest.approx(1.0, abs=2e-4)


def test_machine_code_leaves_an_unknown_joint_to_its_own_rows():
    run = Lagrange().build(WITH_BELT, 1e-3)(10, 50)
    assert run.twist[-1, :, 2] == pytest.approx([2.0, 4.0], abs=1e-12)
