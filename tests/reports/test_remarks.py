"""Numbers in remarks under experiments are those of the experiments' own rows and motions, and vanish without them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material
from reports.model.tasks import Answer, Motion, Task, answered
from reports.pages.four_bar import experiments as four_bar
from reports.pages.pendulum import experiments as pendulum
from reports.pages.rolling import experiments as rolling
from reports.pages.rolling import methods as parting
from reports.pages.rolling.methods import CONTACTS
from reports.pages.skate import methods as slipping
from reports.pages.slider_crank import experiments as slider_crank
from reports.pages.wheels import experiments as wheels
from reports.write.experiments import told_remark
from reports.write.unmeasured import MARK


def experiment(failures: tuple[Failure, ...], title: str) -> Failure:
    (found,) = [failure for failure in failures if failure.title == title]
    return found


def remark(failure: Failure, material: Material) -> str:
    return told_remark(failure, material.of(failure.cells), material)


def invented(failure: Failure, chosen: Callable[[Cell], bool], name: str, value: float) -> Material:
    """Rows with the same numbers in all, but for one quantity of the chosen ones."""
    rows: dict[Cell, Measurement] = {}
    for cell in failure.cells:
        rows[cell] = replace(blank(cell, Outcome.FINISHED), angle=0.5, gap=0.5, energy=0.5)
        if chosen(cell):
            rows[cell] = replace(rows[cell], **{name: value})
    return Material(rows)


def of(variant: str, every: int = 1) -> Callable[[Cell], bool]:
    return lambda cell: (cell.engine.variant, cell.every) == (variant, every)


RING = "A ring of a hundred links, closed by one joint"


@pytest.mark.parametrize(
    ("failures", "title", "chosen", "name", "value", "told"),
    [
        (pendulum.FAILURES, RING, of("Newton, softening 1e-6"), "angle", 0.037, "right to 0.037 rad"),
        (pendulum.FAILURES, RING, of("Newton, softening 1e-8"), "energy", 7.3, "(7.3 times as much)"),
        (
            pendulum.FAILURES,
            "Beyond the horizon of the double pendulum",
            lambda cell: cell.engine == pendulum.HIGHER_ORDER[-1] and cell.every == 10,
            "angle",
            7.3,
            "to 7.3 rad or better",
        ),
        (
            pendulum.FAILURES,
            "A hundred links at large steps",
            lambda cell: cell.engine == pendulum.pymunk.TUNED and cell.samples == 20,
            "gap",
            7.3,
            "by up to 7.3 times a link's",
        ),
        (four_bar.FAILURES, "Worse as the step shrinks", of("default", 10), "angle", 0.037, "0.037 rad there, 0.5 rad"),
        (four_bar.FAILURES, "Worse as the step shrinks", of("default", 100), "angle", 7.3, "there, 7.3 rad at a tenth"),
        (rolling.FAILURES, "Polygons", lambda cell: cell.every == 100, "angle", 0.037, "from 0.5 to 0.037 rad"),
        (
            rolling.FAILURES,
            "Steps far too large",
            lambda cell: cell.samples == 20,
            "gap",
            0.037,
            "by 0.037 m or more",
        ),
    ],
)
def test_a_number_of_a_remark_is_that_of_its_row(failures, title, chosen, name, value, told):
    failure = experiment(failures, title)
    assert told in remark(failure, invented(failure, chosen, name, value))
    # Where that row has no number the clause is gone, and the sentence stands.
    without = remark(failure, invented(failure, chosen, name, np.nan))
    assert told.split()[0] + " " + told.split()[1] not in without
    assert MARK not in without


def test_torn_runs_are_counted():
    failure = experiment(four_bar.FAILURES, "Steps far too large")
    ends = [Outcome.TORN, Outcome.FINISHED, Outcome.TORN, Outcome.RESET, Outcome.TORN]
    rows = {cell: blank(cell, end) for cell, end in zip(failure.cells, ends, strict=False)}
    assert "3 of these 5 runs end with finite numbers" in remark(failure, Material(rows))
    assert "of these" not in remark(failure, Material({}))


def test_remarks_have_no_mark_left_when_nothing_was_run():
    for page in PAGES:
        for failure in page.failures:
            text = remark(failure, Material({}))
            assert MARK not in text
            assert "{" not in text


def test_a_slider_that_starts_nearer_leaves_later_by_what_the_answers_say():
    failure = experiment(slider_crank.FAILURES, "A slider that has to start the crank, next to its dead centre")
    answers: dict[Task, Answer] = {
        task: Answer(Outcome.FINISHED, values={"when": np.asarray(when)})
        for task, when in zip(slider_crank.LEAVING, (1.0, 2.0, 2.5), strict=True)
    }
    text = remark(failure, Material({}, answers))
    assert "nearer leaves 0.5 s later" in text
    assert "by e every 0.11 s" in text  # 0.5 s over log 100


def test_friction_slips_a_tenth_or_two_after_its_limit_is_passed():
    tasks = [Motion(cell) for cells in slipping.LIMITED.values() for cell in cells]
    found = slipping.delays(Material({}, {task: answered(task) for task in tasks}))
    assert 0 < found["least"] <= found["most"] < 0.3


def test_the_naive_trailer_folds_half_a_second_late_at_both_steps():
    tasks = (wheels.REFERENCE, *(Motion(cell) for cell in wheels.RUNS if cell.engine.name == "pymunk"))
    material = Material({}, {task: answered(task) for task in tasks})
    late = wheels.lateness(material)["late"]
    assert len(late) == 2
    assert all(0.4 < each < 0.7 for each in late)
    told = {line.setting: line.outcome for line in wheels.folding(material) if line.method == "pymunk default"}
    exact = next(line for line in wheels.folding(material) if line.method == "the reference, coasting").outcome
    for outcome, each in zip(told.values(), late, strict=True):
        assert float(outcome.split()[0]) - float(exact.split()[0]) == pytest.approx(each, abs=2e-4)


def test_contacts_part_from_the_ideal_motion_by_hundreds_of_times_their_error():
    contacts = [Motion(cell) for cell in parting.PARTINGS if cell.engine in CONTACTS]
    assert len(contacts) == 4
    assert parting.after_parting(Material({}, {task: answered(task) for task in contacts}))["least"] > 100
