"""Tests with a joint and a force element that only the vocabulary knows. Other code refuses these elements by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

import reference.mechanism
from engines import Unsupported, method_name, registry
from engines.capability import Capability
from engines.conformance.same import Isometry, joints_swapped
from engines.mujoco.writers import MJCF, URDF
from engines.pymunk.written_script import SCRIPT
from reference import checks
from reference.elements import BetweenTwo, JointElement
from reference.forces import ForceElement, ForceFacts
from reference.joints import Body, Joint, Pin
from reference.mechanism import Mechanism
from reports.search import relations
from reports.search.law import CheckSkipped
from reports.search.parts import Recipe, RecipeBody


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


WHEEL = Body("wheel", 2.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0))
SLEDGE = Body("sledge", 1.0, 0.1, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
AXLE = Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0))
ENGINES = tuple({engine.name: engine for engine in (*registry.VARIANTS, *registry.OTHERS)}.values())
# These engines evaluate the law of a force element.
FORCES_BY_LAW = {engine.name for engine in ENGINES if engine.capability and engine.capability.forces is None}


@pytest.fixture
def with_rack(monkeypatch):
    _widen(monkeypatch, "Joint", Joint | Rack)
    rack: Any = Rack("rack", "wheel", "sledge")  # The type checker does not know this joint.
    yield Mechanism((WHEEL, SLEDGE), (AXLE, rack), (0.0, 0.0))
    checks._validators_of_fields.cache_clear()


@pytest.fixture
def with_friction(monkeypatch):
    _widen(monkeypatch, "ForceElement", ForceElement | Friction)
    friction: Any = Friction("brake", None, "wheel")
    yield Mechanism((WHEEL,), (AXLE,), (0.0, 0.0), (friction,))
    checks._validators_of_fields.cache_clear()


def _widen(monkeypatch, name, union):
    monkeypatch.setattr(reference.mechanism, name, union)
    checks._validators_of_fields.cache_clear()


@pytest.mark.parametrize("engine", ENGINES, ids=method_name)
def test_an_engine_refuses_an_unknown_element_by_its_table(engine, with_rack, with_friction):
    if engine.capability is None:
        assert engine.name == "lagrange"
        return
    for mechanism, kind in ((with_rack, "Rack"), (with_friction, "Friction")):
        if kind == "Friction" and engine.name in FORCES_BY_LAW:
            continue
        with pytest.raises(Unsupported, match=kind) as refusal:
            engine.build(mechanism, 0.01)
        assert (refusal.value.engine, refusal.value.kind) == (engine.name, kind)


def test_the_judge_moves_unknown_elements_by_their_own_rows_and_law(with_rack, with_friction):
    judge = next(engine for engine in ENGINES if engine.name == "lagrange")
    twist = judge.build(with_rack, 1e-3)(10, 50).twist
    assert twist[-1, 1, 0] == pytest.approx(0.5 * twist[-1, 0, 2], abs=1e-9)
    # The tanh differs from 1 by 2e-9 if the wheel is faster than 1 rad/s.
    rate = judge.build(with_friction, 1e-3)(10, 50).twist[-1, 0, 2]
    assert rate == pytest.approx(2.0 - 0.2 / 0.1 * 0.5, abs=2e-3)


@pytest.mark.parametrize("writer", [MJCF, URDF, SCRIPT], ids=lambda writer: type(writer).__name__)
def test_a_writer_refuses_an_unknown_element_by_name(writer, with_rack, with_friction):
    for mechanism, kind in ((with_rack, "Rack"), (with_friction, "Friction")):
        with pytest.raises(Unsupported, match=kind):
            writer.write(mechanism, 0.01, "default")


def test_another_description_of_an_unknown_element_is_refused_by_name(with_rack, with_friction):
    for mechanism, kind in ((with_rack, "Rack"), (with_friction, "Friction")):
        with pytest.raises(ValueError, match=kind):
            Isometry(turn=0.7)(mechanism)
    with pytest.raises(ValueError, match="Rack"):
        joints_swapped(with_rack)


def test_a_relation_of_the_search_skips_an_unknown_element_by_name(with_rack):
    recipe = Recipe((RecipeBody(), RecipeBody()), ())
    for name in ("turned", "mirrored"):
        skipped = relations.describe_otherwise(recipe, with_rack, name)
        assert isinstance(skipped, CheckSkipped)
        assert "Rack" in skipped.reason


def test_a_table_names_an_element_without_a_reason():
    refusal = Capability("toy", (), ()).refusal(Mechanism((WHEEL,), (AXLE,), (0.0, 0.0)))
    assert refusal is not None
    assert (refusal.kind, refusal.lacking) == ("Pin", "toy has no construction for a Pin here")
