"""What the search allows MuJoCo follows from what MuJoCo declares, and a mistake just above it is found."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, TUNED, MuJoCo
from engines.mujoco import engine as mujoco_engine
from engines.mujoco.model import Model
from reference.joints import Skate
from reports.search.instant_mujoco import solved
from reports.search.parts import EVERY, Recipe
from reports.search.recipe import build
from reports.search.subjects import Adapted

Change = Callable[[Model], None]


def wrong(monkeypatch: pytest.MonkeyPatch, change: Change) -> None:
    """Change every model of MuJoCo's once it is built."""
    right = mujoco_engine.build_model

    def built(*given: Any) -> Model:
        model = right(*given)
        change(model)
        return model

    monkeypatch.setattr(mujoco_engine, "build_model", built)


def faults(engine: MuJoCo, seed: int, number: int, oracle: str) -> tuple[str, ...]:
    subject = Adapted(engine)
    told = subject.ask(subject.draw(seed, number, EVERY, 0), number, (oracle,))
    assert told.errors, "nothing was asked"
    return told.faults


def test_a_gap_is_told_from_its_rounding_where_a_strong_damper_makes_rows_stiff(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Stiff for a time scale of a millisecond, at rates of some radians a second; places are of some metres."""
    assert faults(TUNED, 4242, 237, "instant") == ()
    for gap in (2e-14, -2e-14):  # m; two roundings of such a place are 1e-15

        def opened(model: Model, gap: float = gap) -> None:
            model.compiled.eq_data[:, 3] += gap

        with monkeypatch.context() as here:
            wrong(here, opened)
            assert set(faults(TUNED, 4242, 237, "instant")) == {"acceleration", "reaction"}


@pytest.mark.parametrize(("seed", "number", "change"), [(77777, 64, "shifted"), (4242, 2, "mirrored")])
def test_what_friction_leaves_within_the_tolerance_is_no_fault_and_a_pull_of_the_place_is(
    seed: int, number: int, change: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert faults(DEFAULT, seed, number, "relations") == ()

    def pulled(model: Model) -> None:
        model.compiled.opt.gravity[:2] *= 1 + 3e-6 * model.mechanism.pose[0, 0]

    wrong(monkeypatch, pulled)
    assert faults(DEFAULT, seed, number, "relations") == (change,)


def skating(cases: int) -> list[Recipe]:
    subject = Adapted(DEFAULT)
    drawn = [subject.draw(77777, number, ("pin", "skate", "slot", "torsion-spring"), 0) for number in range(cases)]
    return [case for case in drawn if any(isinstance(joint, Skate) for joint in build(case).joints)]


def left_by_the_solver(engine: MuJoCo, case: Recipe, declared: float) -> float:
    """The largest e^T M e / (2 tolerance I) of some steps, e being how far accelerations are from those solved."""
    mechanism = build(case)
    dt = 0.01 * mechanism.time_scale
    model, best = engine.model(mechanism, dt), solved(engine).model(mechanism, dt)
    data, largest = model.start(), 0.0
    for _ in range(5):
        mujoco.mj_forward(model.compiled, data)
        exact = mujoco.MjData(best.compiled)
        exact.qpos[:], exact.qvel[:], exact.qacc_warmstart[:] = data.qpos, data.qvel, data.qacc_warmstart
        mujoco.mj_forward(best.compiled, exact)
        error, momentum = data.qacc - exact.qacc, np.empty(model.compiled.nv)
        mujoco.mj_mulM(model.compiled, data, momentum, error)
        largest = max(largest, float(error @ momentum) / (2 * declared * float(model.compiled.dof_M0.sum())))
        mujoco.mj_step(model.compiled, data)
    return largest


def test_a_solver_leaves_no_more_of_friction_than_its_tolerance_says() -> None:
    cases = []
    for case in skating(90):
        try:
            cases.append((case, left_by_the_solver(DEFAULT, case, DEFAULT.tolerance)))
        except Unsupported:  # a blade on another body
            continue
    assert len(cases) >= 10
    assert 0.1 < max(left for _, left in cases) <= 1.0
    looser = replace(DEFAULT, tolerance=10 * DEFAULT.tolerance)
    assert max(left_by_the_solver(looser, case, DEFAULT.tolerance) for case, _ in cases) > 1.0


def test_a_start_that_mujoco_would_reset_is_refused() -> None:
    """A pin's loop, a gear and a damper of which an acceleration of 4e14 rad/s^2 comes, above mjMAXVAL."""
    subject = Adapted(TUNED)
    with pytest.raises(Unsupported, match="mjMAXVAL"):
        TUNED.build(build(subject.draw(1199539626, 29, EVERY, 2)), 1e-3)
