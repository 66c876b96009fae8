"""The checks of the gate fail for wrong rows and pass for right ones."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Any

import pytest

from engines import EXACT, ConvergenceOrder, NotDeclared, Regularisation
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.gate.change import Baseline
from reports.gate.prediction import COMPLIANCE, DAMPING, STIFFNESS, Prediction, declared_error, soft_tasks
from reports.gate.pytest_plugin import lines, report
from reports.gate.theory import ROOM, ROOM_OWN, TOO_FEW, Case, cases, checks, count_vacuous, order, theory
from reports.gate.walk import CaseVerdict
from reports.model.cells import Cell
from reports.model.checks import Check, Deviation, complaints
from reports.model.measure import Measurement, blank, measure
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.model.quantities import QUANTITIES
from reports.model.tasks import Answer, Task, answered
from tests.toys import Disc, Plain, Toy

SCENE = Disc()
# The judge's errors are 1e-4 with the second order and 1e-8 with the fourth order at a step of 1e-2 s.
NAMES = tuple(quantity.name for quantity in QUANTITIES)


class SlowDisc(Disc):
    name = "slow disc"


JUDGE = Prediction(
    step=1e-2,
    second=dict.fromkeys(NAMES, 1e-4),
    fourth=dict.fromkeys(NAMES, 1e-8),
    length=1.0,
    speed=1.0,
    acceleration=10.0,
    changing=(1.0, 1.0),
    soft={((True, True), True): dict.fromkeys(NAMES, 1e-3)},
    holonomic=(True, True),
)
FINE = 1e-3


def row(every: int = 10, outcome: Outcome = Outcome.FINISHED, **errors: Any) -> Measurement:
    """A row of the toy at the step 1e-2 / every [s]; errors that are not given are 1e-9."""
    return replace(blank(Cell(SCENE, Toy(), every), outcome), **{**dict.fromkeys(NAMES, 1e-9), **errors})


def alone(quantity: str, error: float) -> dict[str, Any]:
    return {quantity: error}


def of(found: tuple[Check, ...], quantity: str) -> Check:
    return next(check for check in found if check.quantity == quantity)


@pytest.mark.parametrize("quantity", NAMES)
def test_each_quantity_that_is_above_its_bound_fails_and_no_other(quantity):
    # At a tenth of the judge's step, the error of second order is 1e-4 / 100.
    result = theory(JUDGE, ConvergenceOrder(2), None, row(**alone(quantity, 1.1 * (ROOM * 1e-6 + 2e-9))))
    assert [check.quantity for check in result if not check.passed] == [quantity]
    assert all(
        check.passed for check in theory(JUDGE, ConvergenceOrder(2), None, row(**alone(quantity, 0.9 * ROOM * 1e-6)))
    )


@pytest.mark.parametrize(
    ("holonomic", "change", "give"),
    [
        (True, {}, 1e-3),
        (True, {"compliance": 0.005}, 5e-4),
        (True, {"stiffness": 25000.0}, 1e-4),
        (True, {"stiffness": 25000.0, "damping": 50.0}, 1e-4),
        (False, {"stiffness": 25000.0, "damping": 50.0}, 2e-3),  # a nonholonomic row has only a damper
    ],
)
def test_softness_costs_in_proportion_to_compliance_over_stiffness(holonomic, change, give):
    judge = replace(JUDGE, holonomic=(holonomic, holonomic))
    assert judge.softness_error("angle", replace(SOFT, **change)) == pytest.approx(give, rel=1e-12)
    assert judge.softness_error("angle", None) == 0


def coarser(quantity: str = "angle", **errors: Any) -> list[Measurement]:
    """Rows at larger steps. `at3=1e-7` is the error with three steps between samples 1e-2 s apart."""
    return [row(every=int(name[2:]), **{quantity: error}) for name, error in errors.items()]


SOFT = Regularisation(2500.0, 100.0, 0.01, (True, True))
UNKNOWN = NotDeclared("nobody knows")
WITHOUT_SOFT = replace(JUDGE, soft={((True, True), True): dict.fromkeys(NAMES, math.inf)})
LOST = replace(JUDGE, second=dict.fromkeys(NAMES, math.inf), fourth=dict.fromkeys(NAMES, math.inf))
WILD = replace(JUDGE, second=dict.fromkeys(NAMES, 1e3), fourth=dict.fromkeys(NAMES, 1e3))
PRESCRIBED = replace(JUDGE, prescribed=True, lag=dict.fromkeys(NAMES, 2.0))
Given = tuple[Prediction, ConvergenceOrder | NotDeclared, Regularisation | None, list[Measurement]]
BOUNDS: dict[str, tuple[Given, str, float]] = {  # case -> (arguments of `theory`, quantity, bound of its error)
    "two coarser steps bound by the promised order": (
        (JUDGE, ConvergenceOrder(2), None, coarser(at1=1e-7, at3=1e-8)), "angle", ROOM_OWN * 1e-9 + 1e-11),
    "one coarser step may be luck": (
        (JUDGE, ConvergenceOrder(2), None, coarser(at1=1e-9)), "angle", ROOM * 1e-6 + 1e-11),
    "one coarser step where the judge is lost": (
        (LOST, ConvergenceOrder(2), None, coarser(at1=1e-7)), "angle", ROOM_OWN * 1e-9 + 1e-11),
    "a promise of one quantity": (
        (JUDGE, ConvergenceOrder(4, rate=2, gap=EXACT, reaction=0), None, []), "rate", ROOM * 1e-6 + 1e-10),
    "a promise of all others": ((JUDGE, ConvergenceOrder(4, rate=2), None, []), "angle", ROOM * 1e-12 + 1e-11),
    "an exact gap": ((JUDGE, ConvergenceOrder(4, gap=EXACT), None, []), "gap", 1e-12),
    "a reaction of a single step without a promise": ((JUDGE, UNKNOWN, None, []), "reaction", 0.5),
    # The bound is the change of the rate at 2 rad/s^2 in half a step of 1e-3 s, whatever the coarser steps allow.
    "the middle of a step": (
        (PRESCRIBED, ConvergenceOrder(2, rate=1), None, coarser("rate", at1=1e-2, at3=3.3e-3)),
        "rate", 1.25e-3 + 1e-10),
    # The coarsest step would allow 1.25e-7, or 2.5e-7 in a motion that is not prescribed.
    "prescribed, the next coarser step": (
        (PRESCRIBED, ConvergenceOrder(2), None, coarser(at1=1e-5, at3=1e-7, at5=4e-8)), "angle", 1.25e-8 + 1e-11),
    "free, all coarser steps": (
        (JUDGE, ConvergenceOrder(2), None, coarser(at1=1e-5, at3=1e-7, at5=4e-8)), "angle", ROOM_OWN * 1e-7 + 1e-11),
    **{f"no {name} above what the outcome refuses": ((WILD, ConvergenceOrder(1), None, []), name, most)
       for name, most in {"angle": 0.5, "rate": 1.0, "slip": 1.0, "reaction": 1.0, "gap": 0.05}.items()},
}  # fmt: skip


@pytest.mark.parametrize("name", BOUNDS)
def test_a_row_passes_just_below_its_bound_and_fails_just_above_it(name):
    (judge, promise, softness, coarse), quantity, bound = BOUNDS[name]
    for part, passes in ((0.98, True), (1.03, False)):
        errors = alone(quantity, part * bound)
        assert of(theory(judge, promise, softness, row(**errors), coarse), quantity).passed is passes


def test_where_nothing_is_in_proportion_to_softness_its_own_run_bounds_a_row():
    steps, solver_errors = [row(every=1), row(every=3)], dict.fromkeys(NAMES, 1e-5)
    for error, passes in ((1.9e-5, True), (2.1e-5, False)):  # ROOM_SOFT
        result = theory(WITHOUT_SOFT, ConvergenceOrder(2), SOFT, row(angle=error), steps, solver_errors)
        assert of(result, "angle").passed is passes


def test_rounding_of_a_change_of_velocity_is_carried_by_a_combination_of_runs():
    for carried in (1.0, 17.0):
        result = of(theory(JUDGE, ConvergenceOrder(2, differences=8, amplified=carried), None, row()), "reaction")
        # Rounding of 1e-10 m/s in 1/8000 s is 8e-8 relative to 10 m/s^2. Every reaction has 1e-9 in addition.
        assert dict(result.terms)["rounding"] == pytest.approx(carried * 8e-8 + 1e-9, rel=1e-12)


def test_without_a_promise_an_error_may_not_be_far_above_what_the_methods_own_steps_change_in_it():
    for coarse, error, passes in (((0.013, 0.011), 0.01, True), ((0.072, 0.071), 0.07, False)):
        result = theory(JUDGE, UNKNOWN, None, row(angle=error), coarser(at1=coarse[0], at3=coarse[1]))
        assert of(result, "angle").passed is passes
    assert not theory(JUDGE, UNKNOWN, None, row(outcome=Outcome.TORN))[0].passed
    assert order(UNKNOWN, rows(*falling_errors(2))) == ()


def test_an_order_declared_by_a_page_replaces_that_of_the_engine_for_this_scene_only():
    first_order, disc_case = ConvergenceOrder(1), ("disc", "toy default")
    page = Page("discs", "Discs", "Discs turn.", (SCENE, SlowDisc()), (Toy(),), orders={disc_case: first_order})
    assert [case.promise for case in cases([page])] == [first_order, ConvergenceOrder(2)]


def test_a_run_that_can_not_be_compared_fails_by_its_outcome_and_an_unsupported_one_has_no_check():
    result = theory(JUDGE, ConvergenceOrder(1), None, row(outcome=Outcome.TORN))
    assert [check.name for check in result if not check.passed] == ["outcome"]
    assert count_vacuous(result) == {"the run is not comparable, so its outcome alone is checked": len(NAMES)}
    assert theory(JUDGE, ConvergenceOrder(1), None, row(outcome=Outcome.UNSUPPORTED)) == ()


def test_a_number_that_is_none_fails_unless_there_is_none_to_tell_and_that_is_counted():
    result = theory(JUDGE, ConvergenceOrder(1), None, row(reaction=math.nan, angle=math.inf))
    assert [check.quantity for check in result if not check.passed] == ["angle", "reaction"]
    assert not count_vacuous(result)
    untold = theory(JUDGE, ConvergenceOrder(1, reaction=math.nan), None, row(reaction=math.nan))
    assert count_vacuous(untold) == {"the engine declares that it does not report it": 1}
    for none in (replace(JUDGE, holonomic=(False, False)), replace(JUDGE, second={**JUDGE.second, "gap": math.nan})):
        assert count_vacuous(theory(none, ConvergenceOrder(1), None, row(gap=math.nan))) == {
            "the scene does not have this quantity": 1
        }
    # a step with an unknown error gives no bound
    for coarse in permutations(coarser(at1=math.nan, at2=1e-7, at3=1e-8)):
        bound = of(theory(JUDGE, ConvergenceOrder(2), None, row(), coarse), "angle").bound
        assert bound == pytest.approx(ROOM_OWN * 1e-7 * (2 / 10) ** 2 + 1e-11)


def rows(*errors: float) -> list[Measurement]:
    return [row(every=every, angle=error) for every, error in zip((1, 3, 10, 30), errors, strict=False)]


def falling_errors(power: float, points: int = 4) -> tuple[float, ...]:
    return tuple(1e-3 / every**power for every in (1, 3, 10, 30)[:points])


@pytest.mark.parametrize(
    ("promised", "errors", "passes"),
    [
        (2, falling_errors(2), True),
        (2, falling_errors(1.7), True),
        (2, falling_errors(1), False),  # The error falls too slowly.
        (1, falling_errors(2), False),  # The declared order is below the observed order.
        (1, (1e-3, 3.3e-4, 3.2e-4, 3.1e-4), False),  # A plateau.
        (1, (1e-3, 3.3e-4, 3.2e-4), False),  # Levels off.
        (1, (1e-5, 1e-4, 1e-3, 1e-2), False),  # grows.
    ],
)
def test_the_promised_order_passes_and_another_a_plateau_and_growth_do_not(promised, errors, passes):
    (check,) = order(ConvergenceOrder(promised), rows(*errors))
    assert check.passed is passes


def test_no_order_is_asked_of_two_points_or_of_rounding():
    for some in (rows(*falling_errors(2, points=2)), rows(1e-12, 1e-13, 1e-13, 1e-12)):
        assert count_vacuous(order(ConvergenceOrder(2), some)) == {TOO_FEW: 1}


def toy_checks(engine: Toy) -> tuple[Check, ...]:
    """The checks of the angle of a toy with declared order 2; the judge's error is 1 rad/s^2 times the step squared."""
    case = Case(SCENE, engine, ConvergenceOrder(2))
    measured = [measure(cell, repeat=False) for cell in case.cells()]
    return tuple(check for check in checks(case, measured, JUDGE) if check.quantity == "angle")


@pytest.mark.parametrize(
    ("engine", "failing"),
    [
        (Toy("good", factor=1.0), set()),
        (Toy("bad", factor=30.0), {"error"}),
        # This toy has a constant error, which at every step is below the bound from the judge.
        (Toy("soft", factor=1.0, plateau=2e-6), {"error", "order"}),
    ],
    ids=lambda value: getattr(value, "variant", ""),
)
def test_a_toy_that_is_right_passes_and_a_wrong_one_fails(engine, failing):
    assert {check.name for check in toy_checks(engine) if not check.passed} == failing


def test_a_deviation_that_doubled_or_went_away_or_has_no_check_is_a_complaint():
    def found(measured: float) -> tuple[Check, ...]:
        return (Check("error", "angle", measured, 1.0),)

    expected = {"error": Deviation("by design: soft", 10.0)}
    assert not complaints(found(10.0), expected)
    assert not complaints(found(19.0), expected)
    assert "known are 10" in complaints(found(21.0), expected)[0]
    assert "no longer" in complaints(found(0.4), expected)[0]
    assert "no such check" in complaints((), expected)[0]
    assert complaints(found(1.1), {}) == (str(found(1.1)[0]),)
    # Rounding errors that a motion amplifies differ between processors.
    expected = {"error": Deviation("by design: rank", 10.0, rounding=True)}
    assert not complaints(found(0.1), expected)
    assert not complaints(found(99.0), expected)
    assert "known are 10" in complaints(found(101.0), expected)[0]


@pytest.mark.parametrize("outcome", [Outcome.ABORTED, Outcome.TORN, Outcome.SATURATED])
def test_a_deviation_with_an_outcome_excuses_this_outcome_only(outcome):
    case = Case(SCENE, Toy(), ConvergenceOrder(2), (("outcome", Deviation("by design: x", outcome=Outcome.SATURATED)),))
    ended = row(outcome=outcome)
    reported = CaseVerdict(case, (ended,), theory(JUDGE, ConvergenceOrder(2), None, ended)).theory_complaints
    assert len(reported) == (outcome != Outcome.SATURATED)
    assert all("known is saturated" in line for line in reported)
    better = CaseVerdict(case, (row(),), theory(JUDGE, ConvergenceOrder(2), None, row())).theory_complaints
    assert any("deviates no longer" in line for line in better)


def verdict(*found: Check, known: tuple = (), moved: tuple[Check, ...] = ()) -> CaseVerdict:
    return CaseVerdict(Case(SCENE, Toy(), ConvergenceOrder(2), known), (row(angle=2e-5),), found, moved, before=(None,))


def test_the_report_has_the_bound_of_every_case_and_its_failed_checks():
    good = verdict(Check("error", "angle", 2e-5, 1e-4), Check("gap", "gap", 0.9, 1.0))
    assert lines([good]) == [["disc", "toy default", "1e-3", "2e-5", "1e-4", "gap", "0.9", "passed"]]
    bad = verdict(Check("error", "angle", 2e-4, 1e-4))
    assert lines([bad])[0][-1] == "FAILED: theory"
    changed = verdict(Check("error", "angle", 1.0, 2.0), moved=(Check("change", "angle", 1.0, 0.5),))
    assert lines([changed])[0][-1] == "FAILED: change"
    expected = verdict(Check("error", "angle", 2e-4, 1e-4), known=(("error", Deviation("by design: soft", 3.0)),))
    text = report([good, bad, expected, changed], Baseline({}))
    assert "4 scenes and methods, 2 failed, 1 with known deviations" in text
    assert "disc-toy default: change (angle): 1, bound 0.5" in text
    assert "disc-toy default: error (angle): 0.0002, bound 0.0001" in text
    assert "| disc | toy default | error | 3 | by design: soft |" in text
    assert "cells are not in the baseline" in text
    assert "3 checks of theory; 1 of them can't fail." in report(
        [good, verdict(*order(ConvergenceOrder(2), ()))], Baseline({})
    )


@dataclass(frozen=True)
class SoftToy(Plain):
    name: str = "toy"
    variant: str = "soft"
    share: float = COMPLIANCE

    def build(self, mechanism, dt):
        raise NotImplementedError

    def regularisation(self, mechanism, dt):
        return Regularisation(STIFFNESS, DAMPING, self.share, (True,) * mechanism.row_count)


def test_the_declared_error_is_proportional_to_the_compliance():
    scene, engine = FreeFourBar(duration=0.1), SoftToy()
    (task,) = soft_tasks(scene, (engine,))
    answers: dict[Task, Answer] = {task: answered(task)}
    angle_error = answers[task].number("angle")
    assert angle_error > 0
    assert declared_error(answers, scene, engine, "angle", 1e-3) == pytest.approx(angle_error)
    softer = replace(engine, share=3 * COMPLIANCE)
    assert declared_error(answers, scene, softer, "angle", 1e-3) == pytest.approx(3 * angle_error)
    assert math.isnan(declared_error({}, scene, engine, "angle", 1e-3))
    assert math.isnan(declared_error({task: Answer(Outcome.ABORTED)}, scene, engine, "angle", 1e-3))
    assert declared_error({}, scene, Toy(), "angle", 1e-3) == 0
