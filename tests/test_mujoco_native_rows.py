"""Rows that machine code writes into MuJoCo are those that Python writes; where there is no such code, Python stays."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import EXTENDED, row_callback
from engines.mujoco.joints.slot import slot_row
from engines.mujoco.row_callback import Native
from engines.mujoco.written_rows import Law
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import CarAndTrailer, ChaplyginSleigh, RollingEllipse
from reference.trajectory import Trajectory
from reports.search.mechanisms import mechanism

pytest.importorskip("numba", reason="numba, the extra 'fast', is not installed")

ENGINE = replace(EXTENDED, estimates=False)
KINDS = ("pin", "slot", "skate", "rod", "drive", "weld")


def callback(own: Mechanism) -> Any:
    (found,) = ENGINE.model(own, 1e-3).hooks.control
    return found


def both(own: Mechanism, samples: int, every: int, dt: float = 1e-3) -> tuple[Trajectory, Trajectory]:
    """The same motion, its rows written by machine code and by Python."""
    native, python = ENGINE.build(own, dt), ENGINE.build(own, dt)
    hooks = python.model.hooks
    plain = replace(hooks, control=tuple(each.python for each in hooks.control if isinstance(each, Native)))
    return native(samples, every), replace(python, model=replace(python.model, hooks=plain))(samples, every)


def test_machine_code_writes_what_python_writes_at_any_state() -> None:
    random, asked = np.random.default_rng(7), 0
    for number in range(40):
        own = mechanism(22, number, KINDS)
        model = ENGINE.model(own, 1e-3)
        if not model.hooks.control:
            continue
        (control,) = model.hooks.control
        assert isinstance(control, Native)
        asked += 1
        compiled, found = model.compiled, []
        position, velocity = random.normal(size=compiled.nq), random.normal(size=compiled.nv)
        for each in (control, control.python):
            data = mujoco.MjData(compiled)
            data.qpos[:], data.qvel[:] = position, velocity
            with row_callback.installed(each):
                mujoco.mj_forward(compiled, data)
            found.append((data.efc_J.copy(), data.efc_aref.copy()))
        for native, python in zip(*found, strict=True):
            # The same sums of products of about 10, each rounded once or twice more.
            assert np.abs(native - python).max() <= 1e-14 * max(np.abs(python).max(), 1.0)
    assert asked > 15


@pytest.mark.parametrize("scene", [ChaplyginSleigh(), CarAndTrailer()], ids=lambda scene: scene.name)
def test_a_motion_is_the_same_by_either(scene: Any) -> None:
    native, python = both(scene.mechanism(), 5, 100)
    assert np.abs(native.pose - python.pose).max() < 1e-14
    assert np.abs(native.reaction - python.reaction).max() < 1e-12 * np.abs(python.reaction).max()
    assert native.warnings == python.warnings == ()


def test_a_motion_that_blows_up_is_told_alike() -> None:
    wild = Body("sleigh", 1.0, 1.0, (0.0, 0.0, 0.0), (1e9, 0.0, 1e9))
    native, python = both(Mechanism((wild,), (Skate("skate", None, "sleigh", (0.0, 0.0)),)), 20, 10, 0.1)
    assert native.reset_at == python.reset_at
    assert native.reset_at is not None
    assert native.warnings == python.warnings


def test_a_row_that_is_no_number_makes_the_reference_none() -> None:
    model = ENGINE.model(ChaplyginSleigh().mechanism(), 1e-3)
    data = mujoco.MjData(model.compiled)
    data.qvel[:] = 1e200  # its square is beyond all numbers
    with model.hooked():
        mujoco.mj_forward(model.compiled, data)
    assert np.isnan(data.efc_aref).all()


def test_rows_that_are_not_known_are_left_to_python(monkeypatch: pytest.MonkeyPatch) -> None:
    sleigh = ChaplyginSleigh().mechanism()
    assert isinstance(callback(sleigh), Native)
    assert not isinstance(callback(RollingEllipse().mechanism()), Native)
    monkeypatch.setattr(row_callback, "machine_code", lambda: False)
    assert not isinstance(callback(sleigh), Native)


def test_machine_code_that_writes_otherwise_is_not_taken_and_somebody_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    right = row_callback.row_writer

    def turned(*given: Any) -> Any:
        rows = right(*given)

        def other(*state: Any) -> Any:
            flat, reference = rows(*state)
            return flat, [1.000001 * value + 1e-6 for value in reference]

        return other

    monkeypatch.setattr(row_callback, "row_writer", turned)
    with pytest.warns(UserWarning, match="machine code writes other rows"):
        assert not isinstance(callback(ChaplyginSleigh().mechanism()), Native)


def test_a_law_is_a_function_of_its_numbers() -> None:
    numbers = (0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 3.0)
    still, across = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.5, 0.0, 0.0, 0.25, 0.0)
    (row,) = Law(slot_row, numbers)(0.0, still, across)
    # A line along x: the gap is y. J = (0, -1, 0, 0, 1, 0), and J a = -3 * 0.25 - 2 * 0.5.
    assert np.allclose(row, (0.0, -1.0, 0.0, 0.0, 1.0, 0.0, -1.75), rtol=0.0, atol=1e-15)
