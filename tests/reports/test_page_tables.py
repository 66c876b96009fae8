"""What a mechanism's page tells of rows by hand: which setting to take, a table a scene, a line an experiment."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import pytest

from engines import Holder, Softness
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.gate.prediction import COMPLIANCE, DAMPING, STIFFNESS, declared_error, soft_tasks
from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material
from reports.model.tasks import Answer, Task, answered
from reports.write.experiments import compared_only, told_experiment
from reports.write.holders import holders
from reports.write.page_tables import advice, advice_table, compared_step, reliable, scene_table
from reports.write.tables import markdown
from tests.present import present
from tests.rows import falling, row_of, table
from tests.toys import Disc, Plain, Toy


def test_the_cheapest_method_below_each_error_is_advised_for_each_engine():
    # Errors at steps of 1e-1, 1e-2, 1e-3 s, which cost 1, 10 and 100 ms; the second method costs three times as much.
    rows = [
        *falling("a slow", (1e-1, 1e-3, 1e-5)),
        *[replace(row, cpu=3 * row.cpu) for row in falling("a fast", (1e-5, 1e-7, 1e-10))],
        *falling("b only", (1e-1, 1e-2, 5e-3)),
    ]
    found = {(each.engine, each.targets): each.row for each in advice(rows, "angle")}
    told = {key: (row.method, row.step) if row else None for key, row in found.items()}
    assert told == {
        ("a", (1e-2, 1e-4)): ("a fast", 1e-1),
        ("a", (1e-6,)): ("a fast", 1e-2),
        ("a", (1e-9,)): ("a fast", 1e-3),
        ("b", (1e-2,)): ("b only", 1e-2),
        ("b", (1e-4, 1e-6, 1e-9)): None,
    }
    head, *body = table(advice_table(advice(rows, "angle"), "angle", {"a fast": "ours"}))
    assert head[1:5] == ["below [rad]", "method", "joints held by", "step"]
    assert body[0] == ["a", "0.01, 1e-4", "**fast**", "ours", "100 ms", "1e-5", "3", "2.5"]
    assert body[-1][:3] == ["b", "1e-4, 1e-6, 1e-9", "not reached"]
    assert len(body[-1]) == len(head)


def test_a_small_error_at_a_coarse_step_that_a_finer_one_does_not_keep_is_luck():
    lucky = falling("a lucky", (1e-5, 1e-2, 1e-3))
    assert [row.step for row in reliable(lucky, "angle", 1e-2)] == [1e-3, 1e-2, 1e-1]
    assert [row.step for row in reliable(lucky, "angle", 5e-3)] == [1e-3]
    assert reliable(lucky, "angle", 1e-4) == []
    torn = [*lucky[:2], replace(lucky[2], outcome=Outcome.TORN)]
    assert reliable(torn, "angle", 1.0) == []
    unknown = [*lucky[:2], replace(lucky[2], angle=math.nan)]
    assert reliable(unknown, "angle", 1.0) == []


def test_of_costs_that_are_equal_within_their_scatter_the_first_method_of_the_page_is_advised():
    late, early = row_of("a late", angle=1e-10, cpu=1.0), row_of("a early", angle=1e-10, cpu=1.2)
    for rows, order, expected in (
        ((late, early), ("a early", "a late"), "a early"),
        ((late, early), ("a late", "a early"), "a late"),
        ((late, replace(early, cpu=1.3)), ("a early", "a late"), "a late"),
    ):
        (found,) = advice(rows, "angle", order)
        assert present(found.row).method == expected


def test_a_scenes_table_has_each_method_at_the_same_step_and_says_what_a_smaller_one_brings():
    rows = [
        *falling("a x", (1e-2, 1e-4, 1e-6), gap=1.7e-3, slip=math.nan, reaction=math.nan),
        *falling("b y", (1e-2, 3e-5, 3e-5, 3e-5), gap=1.9e-3, slip=math.nan, reaction=math.nan),
        row_of("c z", step=1e-3, outcome=Outcome.TORN, gap=0.5, slip=math.nan, reaction=math.nan),
    ]
    head, *body = table(scene_table(rows, "angle"))
    assert head == ["method", "angle error [rad]", "gap [m]", "CPU [ms/s]", "order as the step shrinks, plateau in rad"]
    assert body[0] == ["a x", "1e-6", "1.7e-3", "100", "2.00 (±0, 3 points)"]
    assert body[1][:2] == ["b y", "3e-5"]
    assert body[1][-1].endswith("plateau **3e-5**")
    assert body[2][:3] == ["c z", "**torn**", "0.5"]
    held = table(scene_table(rows, "angle", {"a x": "engine", "b y": "ours"}))
    assert [line[1] for line in held] == ["joints held by", "engine", "ours", "-"]


def test_a_plateau_above_what_is_declared_is_marked():
    rows = [*falling("a soft", (1e-2, 3e-5, 3e-5, 3e-5)), *falling("b wrong", (1e-2, 3e-5, 3e-5, 3e-5))]
    head, *body = table(scene_table(rows, "angle", declared=lambda method, step: 2e-5 if method == "a soft" else 1e-6))
    assert head[2] == "declared [rad]"
    assert [line[2] for line in body] == ["2e-5", "1e-6"]
    assert ["not declared" in line[-1] for line in body] == [False, True]
    assert "declared" not in scene_table(rows, "angle")


def test_an_experiment_in_which_nothing_was_compared_says_so():
    @dataclass(frozen=True)
    class Ended(Disc):
        @property
        def comparable_until(self) -> float:  # type: ignore[override]
            return 0.0

    cell = Cell(Ended(), Toy(), 1, "failure")
    row = row_of("toy default", angle=0.0)
    assert math.isnan(compared_only(cell, row).angle)
    assert compared_only(cell, row).gap == row.gap
    assert compared_only(replace(cell, scene=Disc()), row) == row
    told = told_experiment(Failure("T", "E", (cell,)), Material({cell: row}))
    assert "- rad" in told.grid
    assert "0 rad" not in told.grid


def test_who_holds_the_joints_stands_beside_each_method_and_changes_with_the_scene():
    @dataclass(frozen=True)
    class Ours(Plain):
        name: str = "toy"
        variant: str = "ours"

        def build(self, mechanism, dt):
            raise NotImplementedError

        def holder(self, joint, mechanism) -> Holder:
            return "ours"

    class Half(Ours):
        def holder(self, joint, mechanism):
            return "engine"

    found = holders([Cell(FreeFourBar(), Ours(), 1), Cell(FreeFourBar(), Half(), 1), Cell(FreeFourBar(), Ours(), 10)])
    assert found == {"toy ours": "ours or engine"}
    head, line = table(scene_table([row_of("toy ours")], "angle", found))
    assert (head[:2], line[:2]) == (["method", "joints held by"], ["toy ours", "ours or engine"])
    assert markdown(["method", "b"], [["x", "1"]], held={"y": "ours"}).splitlines()[-1] == "| x | - | 1 |"


@dataclass(frozen=True)
class Soft(Plain):
    name: str = "toy"
    variant: str = "soft"
    share: float = COMPLIANCE

    def build(self, mechanism, dt):
        raise NotImplementedError

    def softness(self, mechanism, dt):
        return Softness(STIFFNESS, DAMPING, self.share, (True,) * mechanism.row_count)


def test_what_is_declared_is_in_proportion_to_the_judges_own_softness():
    scene, engine = FreeFourBar(duration=0.1), Soft()
    (task,) = soft_tasks(scene, (engine,))
    answers: dict[Task, Answer] = {task: answered(task)}
    own = answers[task].number("angle")
    assert own > 0
    assert declared_error(answers, scene, engine, "angle", 1e-3) == pytest.approx(own)
    softer = replace(engine, share=3 * COMPLIANCE)
    assert declared_error(answers, scene, softer, "angle", 1e-3) == pytest.approx(3 * own)
    assert math.isnan(declared_error({}, scene, engine, "angle", 1e-3))
    assert math.isnan(declared_error({task: Answer(Outcome.ABORTED)}, scene, engine, "angle", 1e-3))
    assert declared_error({}, scene, Toy(), "angle", 1e-3) == 0


def test_methods_are_compared_at_the_step_that_is_nearest_by_its_ratio():
    assert compared_step([row_of("a x", step=step) for step in (3e-4, 2.9e-3)]) == 2.9e-3
