"""Tests with joints and force elements that only the vocabulary knows. Other code refuses these elements by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

import reference.mechanism
from engines import Unsupported, method_name, registry
from engines.conformance.same import Isometry, joints_swapped
from engines.lagrange import TRUTH
from engines.mujoco.writers import MJCF, URDF
from engines.pymunk.written_script import SCRIPT
from reference import checks
from reference.elements import BetweenTwo, JointElement
from reference.forces import FORCES, ForceElement, ForceFacts, Torque
from reference.joints import JOINTS, Body, Gear, Joint, Pin
from reference.mechanism import Mechanism
from reports.search import relations
from reports.search.law import CheckSkipped
from reports.search.parts import Recipe, RecipeBody
from tests.engines.test_promised import QUICKLY, installed


@dataclass(frozen=True)
class Rack(BetweenTwo, JointElement):
    """A joint that moves the second body along the world's x axis by `radius` [m] times the first body's rotation."""

    labels: ClassVar[tuple[str, ...]] = ("along",)

    radius: float = 0.5

    def gap(self, first, second, t):
        return (second[..., 0] - self.radius * first[..., 2])[..., None]

    def rows(self, first, second):
        rows = np.zeros((*first.shape[:-1], 1, 6), dtype=first.dtype)
        rows[..., 0, 2], rows[..., 0, 3] = -np.asarray(self.radius), 1.0
        return rows


@dataclass(frozen=True)
class Friction(BetweenTwo, ForceFacts):
    """A smoothed Coulomb torque [N m] that the first body exerts on the second body."""

    torque: float = 0.2

    @property
    def dissipates(self):
        return True

    def fastest_rate(self, places, bodies, length):
        return 1.0

    def on(self, first, second, first_twist, second_twist):
        out = np.zeros((*first.shape[:-1], 6), dtype=first.dtype)
        out[..., 5] = -self.torque * np.tanh((second_twist[..., 2] - first_twist[..., 2]) / 0.1)
        out[..., 2] = -out[..., 5]
        return out

    def potential(self, first, second):
        return np.zeros_like(first[..., 2] + second[..., 2])


@dataclass(frozen=True)
class Belt(Gear):
    """A subclass of a joint that the adapters build."""


@dataclass(frozen=True)
class Brake(Torque):
    """A subclass of a force element that the adapters build, with the law of `Friction`."""

    def on(self, first, second, first_twist, second_twist):
        rate = second_twist[..., 2] - first_twist[..., 2]
        return -super().on(first, second, first_twist, second_twist) * np.tanh(rate / 0.1)[..., None]


WHEEL = Body("wheel", 2.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
SLEDGE = Body("sledge", 1.0, 0.1, (0.0, 1.0, 0.0), (1.0, 0.0, 4.0))
AXLE = Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0))
RACK, BELT = Rack("rack", "wheel", "sledge"), Belt("belt", "wheel", "sledge", 2.0)
FRICTION, BRAKE = Friction("brake", None, "wheel"), Brake("brake", None, "wheel", 0.2)
ELEMENTS = (RACK, BELT, FRICTION, BRAKE)
ENGINES = (*registry.ENGINES, *registry.OTHERS)
CAPABILITIES = {engine.name: engine.capability for engine in ENGINES if engine.capability}
# These engines evaluate the law of a force element.
BY_LAW = {"lagrange", *(name for name, capability in CAPABILITIES.items() if capability.forces is None)}


@pytest.fixture(autouse=True)
def _wider_vocabulary(monkeypatch):
    monkeypatch.setattr(reference.mechanism, "Joint", Joint | Rack)
    monkeypatch.setattr(reference.mechanism, "ForceElement", ForceElement | Friction)
    checks._validators_of_fields.cache_clear()
    yield
    checks._validators_of_fields.cache_clear()


def mechanism_with(element: Any) -> Mechanism:
    if element in (RACK, BELT):
        return Mechanism((WHEEL, SLEDGE), (AXLE, element), (0.0, 0.0))
    return Mechanism((WHEEL,), (AXLE,), (0.0, 0.0), (element,))


@pytest.mark.parametrize("engine", [engine for engine in ENGINES if engine.name != "lagrange"], ids=method_name)
def test_an_engine_refuses_an_unknown_element_by_its_table(engine):
    for element in ELEMENTS[:2] if engine.name in BY_LAW else ELEMENTS:
        with pytest.raises(Unsupported) as refusal:
            engine.build(mechanism_with(element), 0.01)
        assert (refusal.value.engine, refusal.value.kind) == (engine.name, type(element).__name__)
        assert type(element).__name__ in str(refusal.value)


def test_the_judge_moves_an_unknown_joint_by_its_own_rows():
    twist = TRUTH.build(mechanism_with(RACK), 1e-3)(10, 50).twist
    assert twist[-1, 1, 0] == pytest.approx(0.5 * twist[-1, 0, 2], abs=1e-9)


@pytest.mark.parametrize("name", sorted({engine.name for engine in (*registry.ENGINES, *QUICKLY)} & BY_LAW))
def test_an_engine_that_evaluates_force_elements_uses_an_unknown_law(name):
    engine = installed(next(engine for engine in ENGINES if engine.name == name))
    for element in (FRICTION, BRAKE):
        run = engine.build(mechanism_with(element), 1e-3)(10, 50)
        # A torque of 0.2 N m acts on 0.1 kg m^2 for 0.5 s. The tanh differs from 1 by 2e-9 at more than 1 rad/s.
        assert run.twist[-1, 0, 2] == pytest.approx(1.0, abs=2e-4)


@pytest.mark.parametrize("writer", [MJCF, URDF, SCRIPT], ids=lambda writer: type(writer).__name__)
def test_a_writer_refuses_an_unknown_element_by_name(writer):
    for element in ELEMENTS:
        with pytest.raises(Unsupported, match=type(element).__name__):
            writer.write(mechanism_with(element), 0.01, "default")


def test_another_description_of_an_unknown_element_is_refused_by_name():
    for element in (RACK, FRICTION):
        with pytest.raises(ValueError, match=type(element).__name__):
            Isometry(turn=0.7)(mechanism_with(element))
    with pytest.raises(ValueError, match="Rack"):
        joints_swapped(mechanism_with(RACK))


def test_a_relation_of_the_search_skips_an_unknown_element_by_name():
    recipe = Recipe((RecipeBody(), RecipeBody()), ())
    for name in ("turned", "mirrored"):
        skipped = relations.describe_otherwise(mechanism_with(RACK), recipe, name)
        assert isinstance(skipped, CheckSkipped)
        assert "Rack" in skipped.reason


@pytest.mark.parametrize("capability", CAPABILITIES.values(), ids=CAPABILITIES)
def test_a_table_of_constructions_has_known_classes_and_no_reason_against_them(capability):
    assert {*capability.joints} <= {*JOINTS}
    assert {*(capability.forces or ())} <= {*FORCES}
    assert {*capability.lacks} <= {*JOINTS, *FORCES} - {*capability.joints} - {*(capability.forces or ())}
