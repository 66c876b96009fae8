"""Rows held against the baseline: which numbers may move, and what a file that is none says."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from pathlib import Path

import pytest

from engines import Promise
from engines.altered import Altered
from reports.gate.baseline import BadBaseline, Baseline, Old, identity, read_baseline
from reports.gate.change import change, drift
from reports.gate.nudged import Nudge, nudged_cells
from reports.gate.verdicts import Case
from reports.gate.walk import walk
from reports.grid.cells import Cell
from reports.grid.measure import Measurement, measure
from reports.grid.outcomes import Outcome
from reports.grid.quantities import OF, agrees, quantity
from reports.text.csv_files import as_csv
from tests.test_gate import NAMES, SCENE, alone, of, row
from tests.toys import Toy


def old(outcome: Outcome = Outcome.FINISHED, **errors: float) -> Old:
    return Old(outcome, {**dict.fromkeys(NAMES, 1e-9), **errors})


@pytest.mark.parametrize("name", [*NAMES, *OF])
def test_two_values_of_a_quantity_agree_within_its_rounding_and_one_printed_digit(name):
    assert name in {field.name for field in fields(Measurement)}
    rounding = quantity(OF.get(name, name)).rounding
    assert agrees(name, 2.5e-14, 2.4e-14)
    assert agrees(name, 1e-14 + 0.9 * rounding, 1e-14)
    assert not agrees(name, 1e-14 + 1.1 * rounding, 1e-14)
    assert agrees(name, 1e-14 + 1.1 * rounding, 1e-14, amplified=2.0)
    assert agrees(name, 0.33649, 0.3364)
    assert not agrees(name, 0.33661, 0.3364)


@pytest.mark.parametrize(
    ("now", "before", "same"),
    [
        (math.nan, math.nan, True),
        (math.inf, math.inf, True),
        (0.0, 0.0, True),
        (math.nan, 1.0, False),
        (1.0, math.nan, False),
        (math.inf, 1.0, False),
        (1.0, math.inf, False),
        (math.nan, math.inf, False),
    ],
)
def test_no_number_agrees_with_a_number(now, before, same):
    assert agrees("angle", now, before) is same


@pytest.mark.parametrize("quantity", NAMES)
def test_a_number_that_changed_by_a_hundredth_is_noticed(quantity):
    found = change(row(**alone(quantity, 1.01e-9)), old())
    assert [check.quantity for check in found if not check.passed] == [quantity]


def test_numbers_that_differ_beyond_the_printed_digits_are_the_same():
    assert all(check.passed for check in change(row(angle=1.23449e-5), old(angle=1.234e-5)))


def test_what_rounding_does_to_a_start_is_what_it_may_do_to_a_number():
    now, before = row(angle=3e-13), old(angle=2e-13)
    assert not of(change(now, before), "angle").passed
    near = [row(angle=2.8e-13), row(angle=3.1e-13)]
    assert of(change(now, before, near), "angle").passed
    nearer = [row(angle=3.001e-13)]
    assert not of(change(now, before, nearer), "angle").passed


def test_an_outcome_that_changed_is_noticed_unless_rounding_changes_it():
    torn = row(outcome=Outcome.TORN)
    assert not change(torn, old())[0].passed
    assert change(torn, old(Outcome.TORN))[0].passed
    assert change(torn, old(Outcome.SATURATED), [row(outcome=Outcome.SATURATED)])[0].passed


def test_with_other_versions_three_times_as_large_fails_and_twice_does_not():
    assert all(check.passed for check in drift(row(angle=2e-5), old(angle=1e-5)))
    assert not of(drift(row(angle=4e-5), old(angle=1e-5)), "angle").passed
    assert of(drift(row(angle=5e-12), old(angle=1e-13)), "angle").passed, "rounding"


def test_a_walk_holds_each_row_against_the_baselines_row_of_the_same_cell():
    case = Case(SCENE, Toy("one", factor=1e-4), Promise(2))
    measured = [measure(cell, repeat=False) for cell in case.cells()]
    same = {
        identity(each): Old(Outcome(each.outcome), {name: getattr(each, name) for name in NAMES}) for each in measured
    }
    coarsest = identity(measured[0])
    changed = {**same, coarsest: replace(same[coarsest], errors={**same[coarsest].errors, "angle": 1e-12})}
    lacking = {key: value for key, value in same.items() if key != coarsest}
    found = [walk([case], Baseline(cells), workers=1)[case] for cells in (same, changed, lacking)]
    assert [len(verdict.change_complaints) for verdict in found] == [0, 1, 0]
    assert "it was 1e-12" in found[1].change_complaints[0]
    assert [verdict.new for verdict in found] == [0, 0, 1]
    # Of other versions a number may differ, and not be more than three times as large.
    for versions, complaints_told in (("", 1), ("Python 2.7", 0)):
        near = {**same, coarsest: replace(same[coarsest], errors={**same[coarsest].errors, "angle": 0.9e-8})}
        assert len(walk([case], Baseline(near, versions), workers=1)[case].change_complaints) == complaints_told


def written(path: Path, *measured: Measurement) -> Path:
    path.write_text(as_csv(measured, timings=False), encoding="utf-8")
    return path


def test_a_baseline_is_read_as_it_was_written_with_the_versions_beside_it(tmp_path):
    path = written(tmp_path / "errors.csv", row(angle=1.5e-5), row(every=3, outcome=Outcome.TORN))
    found = read_baseline(path)
    assert found.cells[identity(row())].errors["angle"] == 1.5e-5
    assert found.cells[identity(row(every=3))].outcome == Outcome.TORN
    assert found.same_versions
    (tmp_path / "timings.csv").write_text("# 2026-01-01\n# Python 2.7, numpy 0.1\n")
    assert read_baseline(path).versions == "Python 2.7, numpy 0.1"
    assert not read_baseline(path).same_versions


@pytest.mark.parametrize("text", [None, "", "a,b\n1,2\n", "\0\0", "damaged"])
def test_a_file_that_is_no_baseline_is_one_line(tmp_path, text):
    path = tmp_path / "errors.csv"
    if text == "damaged":
        written(path, row())
        path.write_text(path.read_text().replace("finished", "dissolved"))
    elif text is not None:
        path.write_text(text)
    with pytest.raises(BadBaseline, match=r"baseline .*errors\.csv") as told:
        read_baseline(path)
    assert "\n" not in str(told.value)


def test_a_nudged_start_is_another_rounding_of_the_same_and_the_same_for_a_seed():
    mechanism = SCENE.mechanism()
    spins = {Nudge(seed)(mechanism).twist[0, 2] for seed in range(20)}
    assert len(spins) == 3
    assert max(abs(spin / mechanism.twist[0, 2] - 1) for spin in spins) <= 2.3e-16
    assert Nudge(1)(mechanism) == Nudge(1)(mechanism)
    cells = nudged_cells(Cell(SCENE, Toy(), 1))
    assert len({cell.key for cell in cells}) == len(cells)
    assert all(isinstance(cell.engine, Altered) and cell.label == Cell(SCENE, Toy(), 1).label for cell in cells)
