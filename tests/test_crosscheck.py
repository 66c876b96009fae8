"""Every scene of every page in every method, against the truth: outcomes, errors and orders that theory promises.

The cells are of the report's grid, run by the same supervised pool into a store of their own. No number of a scene and
no stored result stands here: a bound follows from the step, the method's order and how fast the truth turns.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from reference.scene import Scene
from reports.cells import QUICK, sweep_cells
from reports.measure import Measurement
from reports.outcomes import Outcome
from reports.pages import PAGES
from reports.quantities import quantity
from reports.running import run_into
from reports.store import Store
from reports.sweep import Verdict, groups, sweeps

CHECKS = ("outcome", "error", "gap", "order", "reaction")
BEGINNINGS = ("upstream:", "by design:", "ours:")
GRID = [(page, scene, engine) for page in PAGES for scene in page.scenes for engine in page.engines_of(scene)]

# The report's quick steps, and one finer where it is cheap (COST_LIMIT: one run's estimated seconds): the order of a
# fast motion shows only below its time scale.
STEPS = (*QUICK, 3 * QUICK[-1])
COST_LIMIT = 0.5
# Steps longer than this many radians of the truth's fastest turning are not asymptotic, so no order is read from them.
ASYMPTOTIC = 0.1
# An observed order may lie this much below the promised one: at a tenth of a radian the next power is a tenth of the
# leading one, half a decade on a thirtieth, and 10^0.5 in steps turns that into 0.1; the sign of it is unknown.
ORDER_SLACK = 0.3
# Room in an error bound for the constant of the method and the shape of the motion, which (w h)^p leaves out.
ROOM = 10.0

Rows = dict[tuple[str, str, str], list[Measurement]]


def parameters(check: str) -> list:
    """One case a scene and method, those known to fall short marked as failures that must come true."""
    out = []
    for page, scene, engine in GRID:
        reason = page.known.get((scene.name, f"{engine.name} {engine.variant}", check))
        marks = [pytest.mark.xfail(strict=True, reason=reason)] if reason else []
        name = f"{scene.name}-{engine.name} {engine.variant}"
        order = page.orders.get(f"{engine.name} {engine.variant}")
        out.append(pytest.param(scene, engine, order, id=name, marks=marks))
    return out


@pytest.fixture(scope="session")
def rows(tmp_path_factory) -> Rows:
    """All cells of all pages, run once."""
    cells = [
        cell
        for page in PAGES
        for scene in page.scenes
        for cell in sweep_cells((scene,), page.engines_of(scene), STEPS, COST_LIMIT)
    ]
    with Store(tmp_path_factory.mktemp("crosscheck") / "cells.sqlite") as store:
        run_into(store, cells, timed=False)
        found = store.get(cells)
    assert len(found) == len(set(cells))
    return groups(found.values())


def of(rows: Rows, scene: Scene, engine) -> list[Measurement]:
    """The rows of a scene and method, coarse to fine; skips what the engine says it can't do."""
    found = rows[scene.name, engine.name, engine.variant]
    if found[-1].outcome == Outcome.UNSUPPORTED:
        pytest.skip(found[-1].sentence)
    return found


@cache
def turning_rate(scene: Scene) -> float:
    """How fast the truth turns at most within the horizon [rad/s]: what a step must be held against."""
    t = np.linspace(0, scene.horizon, scene.samples + 1)
    return float(np.abs(scene.motion(t).twist[..., 2]).max()) or 1.0


def bound(scene: Scene, step: float, order: int) -> float:
    """An angle error [rad] that a method of this order keeps below: w T (w h)^p, the sum of its local errors.

    Over the horizon T errors grow no faster than about linearly (that is the horizon's definition); w is the truth's
    largest rate. Rounding is added, since no order goes below it.
    """
    rate = turning_rate(scene)
    return ROOM * (rate * scene.horizon * (rate * step) ** order + quantity("angle").rounding)


def crosscheck(check: str):
    """Mark and parametrise one check over the whole grid."""

    def decorate(function):
        cases = pytest.mark.parametrize(("scene", "engine", "order"), parameters(check))
        return pytest.mark.crosscheck(cases(function))

    return decorate


@crosscheck("outcome")
def test_at_the_finest_step_a_method_ends_on_the_right_branch_with_closed_joints(rows, scene, engine, order):
    finest = of(rows, scene, engine)[-1]
    assert Outcome(finest.outcome).comparable, f"{finest.outcome}: {finest.sentence}"


@crosscheck("error")
def test_at_the_finest_step_the_angle_error_is_what_the_order_promises(rows, scene, engine, order):
    finest = of(rows, scene, engine)[-1]
    assert finest.angle <= bound(scene, finest.step, order)


@crosscheck("gap")
def test_at_the_finest_step_the_joints_are_as_closed_as_the_order_promises(rows, scene, engine, order):
    finest = of(rows, scene, engine)[-1]
    if not scene.mechanism().holonomic.any():
        pytest.skip("none of its rows knows a position")
    # A joint is at most a length away from what turns: its gap is an angle error times that length.
    assert finest.gap <= bound(scene, finest.step, order) * scene.mechanism().length_scale


@crosscheck("order")
def test_the_angle_error_falls_with_the_promised_order_or_reaches_rounding(rows, scene, engine, order):
    fine = [row for row in of(rows, scene, engine) if turning_rate(scene) * row.step <= ASYMPTOTIC]
    if not fine:
        pytest.skip("no step is fine enough")
    found = next(sweep for sweep in sweeps(fine) if sweep.quantity.name == "angle")
    if found.verdict is Verdict.ROUNDING:
        return
    assert found.verdict is not Verdict.PLATEAU, f"stays at {found.plateau:.2g} rad"
    if found.points < 2:
        pytest.skip(f"{len(fine)} steps are fine enough; {found.verdict}")
    assert found.order >= order - ORDER_SLACK


@crosscheck("reaction")
def test_at_the_finest_step_reactions_are_right_to_first_order(rows, scene, engine, order):
    finest = of(rows, scene, engine)[-1]
    if finest.reaction_rows == 0:
        pytest.skip("it tells no reactions")
    # A force is a change of velocity over a step, so it is known no better than to that step: relative w h. And where
    # the mechanism is at a wrong angle its forces are those of that angle: relative to the angle error in radians.
    assert math.isfinite(finest.reaction)
    assert finest.reaction <= ROOM * (turning_rate(scene) * finest.step + finest.angle)


def test_every_method_has_a_promise_and_every_promise_a_method():
    for page in PAGES:
        assert set(page.orders) == {f"{engine.name} {engine.variant}" for engine in page.engines}


def test_every_known_deviation_names_a_real_case_and_says_whose_it_is():
    for page in PAGES:
        methods = {f"{engine.name} {engine.variant}" for engine in page.engines}
        for (scene, method, check), reason in page.known.items():
            assert scene in {s.name for s in page.scenes}, scene
            assert method in methods, method
            assert check in CHECKS, check
            assert reason.startswith(BEGINNINGS), reason


def test_the_grid_is_not_empty_and_every_scene_has_its_page():
    from reference.scenes import SCENES

    assert GRID
    taught = {scene.name for page in PAGES for scene in page.scenes}
    assert taught == {scene.name for scene in SCENES if scene.page in {page.name for page in PAGES}}


def test_a_bound_shrinks_with_the_step_and_the_order():
    scene = PAGES[0].scenes[0]
    assert bound(scene, 1e-3, 2) < bound(scene, 1e-3, 1)
    # A tenth of the step, order 1: a tenth of the bound, but for the rounding in both.
    assert bound(scene, 1e-4, 1) == pytest.approx(bound(scene, 1e-3, 1) / 10, rel=1e-6)
