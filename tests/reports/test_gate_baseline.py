"""Tests of the comparison with the baseline: which numbers may change, and messages for bad files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from engines import ConvergenceOrder
from engines.lagrange import Lagrange
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.gate.change import (
    Altered,
    BadBaseline,
    Baseline,
    Nudge,
    Old,
    change,
    describe_improvements,
    drift,
    growth,
    identity,
    mixed,
    nudged_cells,
    read_baseline,
)
from reports.gate.pytest_plugin import changes
from reports.gate.theory import Case
from reports.gate.walk import remarks, run_and_check, vanished
from reports.model.cells import Cell
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.quantities import OF, agrees, quantity
from reports.write.csv_files import DIGESTS, as_csv, digests_csv
from tests.reports.test_gate import NAMES, SCENE, alone, of, row
from tests.toys import Toy


def old(outcome: Outcome = Outcome.FINISHED, **errors: float) -> Old:
    return Old(outcome, {**dict.fromkeys(NAMES, 1e-9), **errors})


@pytest.mark.parametrize("name", [*NAMES, *OF])
def test_two_values_of_a_quantity_agree_within_its_rounding_and_one_printed_digit(name):
    rounding = quantity(OF.get(name, name)).rounding
    for now, earlier, amplified, same in (
        (1e-14 + 0.9 * rounding, 1e-14, 1.0, True),
        (1e-14 + 1.1 * rounding, 1e-14, 1.0, False),
        (1e-14 + 1.1 * rounding, 1e-14, 2.0, True),
        (0.33649, 0.3364, 1.0, True),
        (0.33661, 0.3364, 1.0, False),
    ):
        assert agrees(name, now, earlier, amplified) is same


@pytest.mark.parametrize("quantity", NAMES)
def test_a_number_that_changed_by_a_hundredth_or_is_not_known_any_more_is_noticed(quantity):
    changed = change(row(**alone(quantity, 1.01e-5)), old(**alone(quantity, 1e-5)))
    gone = [gate(row(**alone(quantity, math.nan)), old()) for gate in (change, drift)]
    for result in (changed, *gone):
        assert [check.quantity for check in result if not check.passed] == [quantity]


def test_the_bound_of_a_change_is_what_other_roundings_do_and_never_zero():
    now, earlier = row(angle=3e-9), old(angle=2e-9)
    missing = [row(outcome=Outcome.TORN, angle=9.0), row(angle=math.nan)]
    for others, passes in (([], False), ([2.8e-9, 3.1e-9], True), ([3.001e-9], False)):
        result = change(now, earlier, [*(row(angle=angle) for angle in others), *missing])
        assert of(result, "angle").passed is passes
    now, earlier = row(angle=2.29e-14, velocity=5e-10), old(angle=2.55e-14, velocity=0.0)
    assert of(change(now, earlier), "angle").passed
    assert not of(change(now, earlier), "velocity").passed
    assert of(change(now, earlier, amplified=17.0), "velocity").passed  # a combination of runs amplifies rounding


@pytest.mark.parametrize("gate", [change, drift])
def test_reactions_of_fewer_rows_than_before_fail(gate):
    earlier = replace(old(), reaction_rows=8)
    assert [check.quantity for check in gate(row(reaction_rows=2), earlier) if not check.passed] == ["reaction_rows"]
    assert all(check.passed for check in gate(row(reaction_rows=8), earlier))


def test_a_number_that_was_unknown_before_is_reported_and_with_the_same_versions_it_is_a_change():
    earlier = old(reaction=math.nan)
    assert describe_improvements(row(reaction=3e-9), earlier) == ("reaction: 3e-09; it was not known",)
    assert all(check.passed for check in drift(row(reaction=3e-9), earlier))
    assert not of(change(row(reaction=3e-9), earlier), "reaction").passed
    assert describe_improvements(row(), old()) == ()


def test_the_numbers_of_a_run_that_is_not_resolved_are_held_and_those_of_a_torn_one_are_luck():
    now, earlier = row(outcome=Outcome.UNRESOLVED, angle=2e-5), old(Outcome.UNRESOLVED, angle=1e-5)
    assert [check.quantity for check in change(now, earlier) if not check.passed] == ["angle"]
    near = [row(outcome=Outcome.UNRESOLVED, angle=1.8e-5), row(outcome=Outcome.TORN, angle=9.0)]
    assert of(change(now, earlier, near), "angle").passed
    assert not of(change(now, earlier, near[1:]), "angle").passed
    assert [check.quantity for check in change(row(outcome=Outcome.TORN, angle=1.0), old(Outcome.TORN))] == ["outcome"]


@pytest.mark.parametrize(
    ("before", "now", "passes"),
    [
        (Outcome.UNRESOLVED, Outcome.FINISHED, True),
        *((Outcome.FINISHED, fault, False) for fault in Outcome if not fault.comparable),
        *((fault, Outcome.FINISHED, True) for fault in Outcome if not fault.comparable),
        (Outcome.SATURATED, Outcome.ABORTED, False),
        (Outcome.SATURATED, Outcome.UNRESOLVED, False),
    ],
)
def test_another_outcome_fails_with_the_same_versions_and_an_improvement_is_a_remark_with_others(before, now, passes):
    now, before = row(outcome=now), old(before)
    assert not all(check.passed for check in change(now, before))
    assert all(check.passed for check in drift(now, before)) is passes
    remark = (f"outcome: {now.outcome}; it was {before.outcome}",) if passes else ()
    assert describe_improvements(now, before) == remark


def of_scenes(*factors: float) -> list[tuple[Measurement, Old]]:
    """For each scene, a row whose angle error is a factor times 1e-5, and its baseline row with the error 1e-5."""
    return [(replace(row(angle=1e-5 * f), scene=f"scene {n}"), old(angle=1e-5)) for n, f in enumerate(factors)]


def test_in_many_scenes_a_method_may_not_be_nearly_three_times_as_wrong_in_the_median():
    def failed(*factors: float) -> list[str]:
        return [check.quantity for check in growth(of_scenes(*factors)) if not check.passed]

    # By chance the error in one scene may rise by a factor of 3. The median of nine scenes scatters 1.25 / sqrt(9)
    # times as much.
    assert failed(2.9) == []
    assert failed(*[2.9] * 9) == ["angle"]
    assert failed(*[3 ** (1.2 / 3)] * 9) == []
    assert failed(*[3 ** (1.3 / 3)] * 9) == ["angle"]
    assert failed(*[0.3] * 4, *[1.0], *[2.9] * 4) == []
    # All cells of one scene count as a single cell.
    assert [check for check in growth(of_scenes(2.9) * 9) if not check.passed] == []
    below = [(replace(now, angle=3e-13), replace(earlier, errors={"angle": 1e-13})) for now, earlier in of_scenes(1, 1)]
    assert [check.passed for check in growth(below)] == [True]


def known_of(row: Measurement) -> Old:
    return Old(Outcome(row.outcome), {name: getattr(row, name) for name in NAMES}, row.reaction_rows, row.cpu)


def test_a_scene_of_ours_that_a_baseline_has_no_row_of_fails_and_somebody_elses_is_new():
    case = Case(SCENE, Toy(), ConvergenceOrder(2))
    assert vanished(case, (None, None)) == ()
    assert vanished(case, (old(), None)) == (), "it ends at a coarser step"
    assert not vanished(case, (None, old()))[0].passed
    ours = Case(DrivenFourBar(), Lagrange(), ConvergenceOrder(1))
    (check,) = vanished(ours, (None, None))
    assert not check.passed
    assert "write the baseline again" in str(check)
    assert vanished(ours, (old(), old())) == ()


def test_run_and_check_compares_each_row_and_its_cost_with_the_baselines_row_of_the_same_cell(at_home):
    case = Case(SCENE, Toy("one", factor=1e-4), ConvergenceOrder(2))
    measured = [measure(cell, repeat=False) for cell in case.cells()]
    same = {identity(item): known_of(item) for item in measured}
    coarsest = identity(measured[0])

    def angle(value: float) -> dict[tuple[str, str, int, int], Old]:
        return {**same, coarsest: replace(same[coarsest], errors={**same[coarsest].errors, "angle": value})}

    lacking = {key: value for key, value in same.items() if key != coarsest}
    # With other versions of packages, a number may be up to three times as large.
    for cells, versions, new, reported in (
        (same, "", 0, []),
        (angle(1e-12), "", 0, ["it was 1e-12"]),
        (lacking, "", 1, ["lacks steps between others"]),
        (angle(0.9e-8), "", 0, ["it was 9e-09"]),
        (angle(0.9e-8), "Python 2.7", 0, []),
    ):
        result = run_and_check([case], Baseline(cells, versions), workers=1)[case]
        assert result.new == new
        assert len(result.change_complaints) == len(reported)
        assert all(text in line for text, line in zip(reported, result.change_complaints, strict=True))
    cheap = Baseline({key: replace(value, cpu=value.cpu / 1e3) for key, value in same.items()})
    dear = run_and_check([case], cheap, workers=1, dearest=1.5)[case]
    assert ["CPU time" in line for line in dear.change_complaints] == [True]
    assert any("times the CPU time of the baseline" in line for line in changes([dear], cheap))
    assert remarks(replace(dear, before=tuple(replace(known_of(item), cpu=math.nan) for item in measured))) == ()


def written(path: Path, *measured: Measurement) -> Path:
    path.write_text(as_csv(measured, timings=False), encoding="utf-8")
    return path


def test_a_baseline_is_read_as_it_was_written_with_the_versions_and_times_beside_it(tmp_path):
    experiment = replace(row(angle=0.3), purpose="usual")  # this row has the step of a row of the sweep
    path = written(tmp_path / "errors.csv", row(angle=1.5e-5), row(every=3, outcome=Outcome.TORN), experiment)
    baseline = read_baseline(path)
    assert baseline.cells[identity(row())].errors["angle"] == 1.5e-5
    assert baseline.cells[identity(row(every=3))].outcome == Outcome.TORN
    assert math.isnan(baseline.cells[identity(row())].cpu)
    assert baseline.same_versions
    timed = as_csv([replace(row(), cpu=0.25, runs=3, build=0.5), replace(experiment, cpu=9.0)], timings=True)
    (tmp_path / "timings.csv").write_text(f"# 2026-01-01\n# Python 2.7, numpy 0.1\n{timed}")
    baseline = read_baseline(path)
    assert baseline.cells[identity(row())].cpu == 0.25
    assert (baseline.versions, baseline.same_versions) == ("Python 2.7, numpy 0.1", False)


def test_a_baseline_that_was_edited_or_lies_beside_other_pages_is_told_in_one_line(tmp_path):
    errors = as_csv([row(), row(every=3)], timings=False)
    files = {"errors.csv": errors, "index.md": "# Results", "disc.md": "0.5", "disc.svg": "<svg/>", "timings.csv": ""}

    def told(**changed: str) -> str:
        for name, text in {**files, DIGESTS: digests_csv(files), **changed}.items():
            (tmp_path / name).write_text(text, encoding="utf-8")
        return mixed(read_baseline(tmp_path / "errors.csv"))

    assert told() == ""
    assert told(**{"disc.svg": "<other/>"}) == ""
    assert told(**{"timings.csv": "# another day"}) == ""
    fewer = as_csv([row()], timings=False)
    for changed in ({"errors.csv": fewer}, {"disc.md": "0.4"}):
        line = told(**changed)
        assert next(iter(changed)) in line
        assert line in changes([], read_baseline(tmp_path / "errors.csv"))
    (tmp_path / DIGESTS).unlink()
    assert "has no digests.csv" in mixed(read_baseline(tmp_path / "errors.csv"))
    (tmp_path / "index.md").unlink()
    assert mixed(read_baseline(tmp_path / "errors.csv")) == ""


@pytest.mark.parametrize("text", [None, "", "a,b\n1,2\n", "\0\0", "damaged"])
def test_a_file_that_is_no_baseline_is_refused_in_one_line(tmp_path, text):
    path = tmp_path / "errors.csv"
    if text == "damaged":
        written(path, row())
        path.write_text(path.read_text().replace("finished", "dissolved"))
    elif text is not None:
        path.write_text(text)
    with pytest.raises(BadBaseline, match=r"baseline .*errors\.csv") as reported:
        read_baseline(path)
    assert "\n" not in str(reported.value)


def test_a_baseline_without_the_column_of_a_quantity_is_a_sentence_and_the_others_are_compared(tmp_path):
    lines = as_csv([row()], timings=False).splitlines()
    column = lines[0].split(",").index("reaction")
    text = "\n".join(",".join(cell for i, cell in enumerate(line.split(",")) if i != column) for line in lines)
    (tmp_path / "errors.csv").write_text(text)
    baseline = read_baseline(tmp_path / "errors.csv")
    (stored_row,) = baseline.cells.values()
    assert set(stored_row.errors) == set(NAMES) - {"reaction"}
    assert [line for line in changes([], baseline) if "no column 'reaction'" in line]


def test_a_nudged_mechanism_is_another_rounding_of_all_that_enters_and_the_same_for_a_seed():
    mechanism = DrivenFourBar().mechanism()
    nudged = [Nudge(seed)(mechanism) for seed in range(20)]

    def seen(value: Callable[[Mechanism], float]) -> set[float]:
        return {value(other) / value(mechanism) - 1 for other in nudged}

    for value in (
        lambda each: each.bodies[1].mass,
        lambda each: each.bodies[1].inertia,
        lambda each: each.bodies[1].pose[0],
        lambda each: each.gravity[1],
        lambda each: next(joint for joint in each.joints if joint.name == "C").first_point[0],
    ):
        assert len(seen(value)) == 3
        assert max(map(abs, seen(value))) <= 2 * 2.3e-16  # the quotient has one more rounding
    assert Nudge(1)(mechanism) == Nudge(1)(mechanism)
    cells = nudged_cells(Cell(SCENE, Toy(), 1))
    assert len({cell.key for cell in cells}) == len(cells)
    assert all(isinstance(cell.engine, Altered) and cell.label == Cell(SCENE, Toy(), 1).label for cell in cells)
