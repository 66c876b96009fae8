"""What remarks under experiments say: numbers are those of rows and motions, and "falls", "stays", "tears" is so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from engines import mujoco, pymunk
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reports.model.cells import Cell
from reports.model.measure import Measurement, blank
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material
from reports.model.tasks import Answer, Motion, Task
from reports.pages.atlas.page import lines as atlas_lines
from reports.pages.common import PUBLIC
from reports.pages.four_bar import experiments as four_bar
from reports.pages.four_bar import experiments as four_bar_failures
from reports.pages.n_four_bar import experiments as n_four_bar_failures
from reports.pages.pendulum import experiments as pendulum
from reports.pages.pendulum import experiments as pendulum_failures
from reports.pages.rolling import experiments as rolling
from reports.pages.rolling import experiments as rolling_failures
from reports.pages.rolling.experiments import polygon_cells, softness_cells
from reports.pages.skate import experiments as skate_failures
from reports.pages.slider_crank import experiments as slider_crank
from reports.pages.wheels import experiments as wheels
from reports.write.experiments import told_remark
from reports.write.unmeasured import MARK
from tests.committed_rows import answer_to, committed_rows


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
    tasks = [Motion(cell) for cells in skate_failures.LIMITED.values() for cell in cells]
    found = skate_failures.delays(Material({}, {task: answer_to(task) for task in tasks}))
    assert 0 < found["least"] <= found["most"] < 0.3


def test_the_naive_trailer_folds_half_a_second_late_at_both_steps():
    tasks = (wheels.REFERENCE, *(Motion(cell) for cell in wheels.RUNS if cell.engine.name == "pymunk"))
    material = Material({}, {task: answer_to(task) for task in tasks})
    late = wheels.lateness(material)["late"]
    assert len(late) == 2
    assert all(0.4 < each < 0.7 for each in late)
    told = {line.setting: line.outcome for line in wheels.folding(material) if line.method == "pymunk naive"}
    exact = next(line for line in wheels.folding(material) if line.method == "the reference, coasting").outcome
    for outcome, each in zip(told.values(), late, strict=True):
        assert float(outcome.split()[0]) - float(exact.split()[0]) == pytest.approx(each, abs=2e-4)


def test_contacts_part_from_the_ideal_motion_by_hundreds_of_times_their_error():
    contacts = [Motion(cell) for cell in rolling.PARTINGS if cell.engine in PUBLIC]
    assert len(contacts) == 4
    assert rolling.after_parting(Material({}, {task: answer_to(task) for task in contacts}))["least"] > 100


BROKEN = (Outcome.TORN, Outcome.RESET)


def methods(failures: tuple[Failure, ...], title: str) -> dict[str, list[Measurement]]:
    """The rows of each method in an experiment, largest step first."""
    (failure,) = [failure for failure in failures if failure.title == title]
    found: dict[str, list[Measurement]] = {}
    for row in sorted(committed_rows(failure.cells).values(), key=lambda row: -row.step):
        found.setdefault(f"{row.engine} {row.variant}", []).append(row)
    return found


def falls(rows: list[Measurement], factor: float = 5.0) -> bool:
    return len(rows) > 1 and all(fine.angle < coarse.angle / factor for coarse, fine in pairwise(rows))


def stays(rows: list[Measurement]) -> bool:
    return len(rows) > 1 and all(0.8 < fine.angle / coarse.angle < 1.25 for coarse, fine in pairwise(rows))


def outcomes(rows: list[Measurement]) -> list[Outcome]:
    return [Outcome(row.outcome) for row in rows]


def comparable(rows: list[Measurement]) -> list[bool]:
    return [outcome.comparable for outcome in outcomes(rows)]


def test_every_method_gets_through_a_change_point_at_most_steps() -> None:
    found = methods(four_bar_failures.FAILURES, "A parallelogram through its change points")
    assert falls(found["pymunk default"])
    assert falls(found["pymunk tuned"])
    assert stays(found["mujoco default"])
    assert all(comparable(found["lagrange rk4 projection"]))
    assert outcomes(found["pymunk extended"])[0] == Outcome.UNRESOLVED
    for name in ("mujoco tuned", "mujoco extended"):
        assert outcomes(found[name]).count(Outcome.RESET) == 1


def test_an_overwritten_crank_stays_wrong_on_the_loop_as_shipped_and_a_servo_lags() -> None:
    found = methods(four_bar_failures.FAILURES, "Five ways to drive a crank")
    assert stays(found["mujoco default, overwritten crank"][1:])
    assert stays(found["mujoco tuned, servo"])
    assert falls(found["mujoco tuned"])
    rows = found["mujoco tuned, overwritten crank"]
    assert outcomes(rows)[0] == Outcome.TORN
    assert falls(rows)
    assert all(row.angle > 100 * other.angle for row, other in zip(rows, found["mujoco tuned"], strict=True))


def test_about_half_of_the_runs_at_steps_far_too_large_end_on_a_torn_loop_and_the_one_that_estimates_says_so() -> None:
    found = methods(four_bar_failures.FAILURES, "Steps far too large")
    # Where its runs are no series in the step the extrapolation keeps its finest one, which holds together.
    estimating = found.pop("pymunk extended")
    assert all("unresolved" in f"{row.outcome} {row.sentence}" for row in estimating)
    rows = [row for own in found.values() for row in own]
    assert 0.4 < outcomes(rows).count(Outcome.TORN) / len(rows) < 0.6


def test_forces_without_a_limit_are_too_much_for_pymunk_tuned_at_the_smallest_step() -> None:
    found = methods(n_four_bar_failures.FAILURES, "Forces that have no limit")
    assert comparable(found["pymunk tuned"]) == [True, True, False]
    assert falls(found["pymunk default"])
    assert falls(found["mujoco tuned"])
    assert stays(found["mujoco default"])
    assert max(row.angle for row in found["mujoco extended"]) < 1e-6
    assert not falls(found["mujoco extended"], 1.0)
    # Its sweeps don't converge there, whatever the step: it says so, and by how much it may be wrong.
    assert all("unresolved" in f"{row.outcome} {row.sentence}" for row in found["pymunk extended"])
    assert all(row.estimate > row.angle for row in found["pymunk extended"])


def test_pymunks_point_pendulum_keeps_its_energy_with_the_gap_closed_but_never_its_phase() -> None:
    found = methods(pendulum_failures.FAILURES, "Two thousand seconds of a point pendulum")
    assert min(row.energy for row in found["pymunk default"]) > 0.9
    assert found["pymunk tuned"][-1].energy < 0.05
    assert not any(comparable(found["pymunk default"] + found["pymunk tuned"]))
    euler, fourth = found["mujoco default"], found["mujoco tuned"]
    assert euler[0].angle < fourth[0].angle
    assert euler[-1].angle > fourth[-1].angle


def test_sweeps_on_a_heavy_tip() -> None:
    found = methods(pendulum_failures.FAILURES, "A light chain with a heavy tip")
    closing = found["pymunk 10 sweeps, all of the gap"]
    assert all(row.angle > shipped.angle for row, shipped in zip(closing, found["pymunk default"], strict=True))
    assert outcomes(found["pymunk extended"]) == [Outcome.UNRESOLVED]
    for name in ("pymunk default", "pymunk tuned", "pymunk 10 sweeps, all of the gap"):
        assert comparable(found[name]) == [False, True, True]
    assert comparable(found["pymunk 1000 sweeps, all of the gap"]) == [False, True, False]
    assert all(outcome in BROKEN for outcome in outcomes(found[f"mujoco {pendulum_failures.SWEPT.variant}"]))
    assert comparable(found[f"mujoco {pendulum_failures.PATIENT.variant}"]) == [True]
    assert comparable(found["mujoco tuned"]) == [False, True, True]
    # They divide a step that is too long, and say that their estimate is above what they claim.
    for name in ("mujoco extended", "mujoco extended, free, sparse Newton"):
        assert outcomes(found[name]) == [Outcome.UNRESOLVED, Outcome.UNRESOLVED, Outcome.FINISHED]
        assert [row.angle < most for row, most in zip(found[name], (1e-2, 1e-7, 1e-8), strict=True)] == 3 * [True]


def test_beyond_the_horizon_only_methods_of_higher_order_are_right_and_only_at_the_small_step() -> None:
    found = methods(pendulum_failures.FAILURES, "Beyond the horizon of the double pendulum")
    for name in ("pymunk default", "pymunk tuned", "mujoco default"):
        assert not any(comparable(found[name]))
    for name in ("mujoco tuned", "pymunk extended", "mujoco extended", "lagrange rk4 projection"):
        assert found[name][-1].angle < 1e-3


def test_a_hundred_links_at_large_steps() -> None:
    found = methods(pendulum_failures.FAILURES, "A hundred links at large steps")
    assert outcomes(found["mujoco default"])[:2] == [Outcome.RESET, Outcome.SATURATED]
    assert outcomes(found["mujoco tuned"])[:2] == [Outcome.RESET] * 2
    assert outcomes(found["lagrange euler projection"])[:2] == [Outcome.DIVERGED] * 2
    for name in ("pymunk default", "pymunk tuned"):
        assert outcomes(found[name])[:2] == [Outcome.TORN] * 2
        assert max(row.energy for row in found[name]) < 0.05
    assert 2.5 < max(row.gap for row in found["pymunk default"] + found["pymunk tuned"]) < 3.5  # [m], as are links
    assert all(comparable(rows)[-1] for rows in found.values())


def test_a_ring_hardened_too_far_has_its_joint_shut_and_more_energy_than_there_was() -> None:
    found = methods(pendulum_failures.FAILURES, "A ring of a hundred links, closed by one joint")
    assert stays(found["mujoco default"])
    assert found["mujoco Newton, softening 1e-6"][0].angle < 1e-10
    lost = found["mujoco Newton, softening 1e-8"][0]
    assert lost.energy > 1
    assert lost.gap < 1e-3
    assert lost.angle < 0.1  # what it is, rounding decides


def test_the_step_at_which_two_errors_cancel_has_a_smaller_error_than_the_next() -> None:
    rows = methods(four_bar_failures.FAILURES, "Worse as the step shrinks")["mujoco default"]
    lucky, finer = (next(row for row in rows if 0.5 < row.step / step < 2) for step in (1e-3, 1e-4))
    assert lucky.angle < finer.angle / 5


def test_two_sweeps_are_enough_at_a_millisecond_and_tear_the_loop_at_a_tenth_of_it() -> None:
    two = methods(four_bar_failures.FAILURES, "Too few iterations")["pymunk tuned, 2 sweeps"]
    assert comparable(two)[1:] == [True, False]
    assert outcomes(two)[-1] == Outcome.TORN


def mapped(subject: str) -> dict[str, dict[float, tuple[Outcome, ...]]]:
    """Outcomes of a map of the atlas by method and value, largest step first."""
    found: dict[str, dict[float, tuple[Outcome, ...]]] = {}
    for line in atlas_lines():
        if line.subject == subject:
            found.setdefault(line.method, {})[line.value] = line.told
    return found


def test_what_the_map_of_couplers_says() -> None:
    found = mapped("coupler")
    for value in (min(found["mujoco default"]), max(found["mujoco default"])):
        assert set(found["mujoco default"][value]) == {Outcome.TORN}
    assert all(told[-1].comparable for told in found["mujoco tuned"].values())


def test_what_the_map_of_slots_near_their_reach_says() -> None:
    found = mapped("offset")
    for method in ("pymunk default", "mujoco default"):
        assert found[method][min(found[method])][-1] == Outcome.BRANCH_FLIP
    assert all(told[-1].comparable for told in found["pymunk tuned"].values())


def test_what_the_map_of_sleighs_says() -> None:
    found = mapped("sleigh")
    naive = found.pop("pymunk default")
    assert naive[min(naive)][-1].comparable
    assert not naive[max(naive)][-1].comparable
    assert all(told[-1].comparable for own in found.values() for told in own.values())


def test_steps_far_too_large_open_the_contact_more_at_larger_steps_and_no_engine_warns() -> None:
    length = next(f for f in rolling_failures.FAILURES if f.title == "Steps far too large").cells[0].scene
    for rows in methods(rolling_failures.FAILURES, "Steps far too large").values():
        gaps = [row.gap for row in rows]
        assert gaps == sorted(gaps, reverse=True)
        assert all(row.outcome == Outcome.TORN and "without a warning" in row.sentence for row in rows)
        assert gaps[-1] > 0.2 * length.mechanism().length_scale


def test_corners_alone_make_the_error_of_a_coarse_polygon_and_with_512_the_step_still_has_a_part() -> None:
    rows = committed_rows([cell for _, cell in polygon_cells()])
    angle = {(corners, cell.every): rows[cell].angle for corners, cell in polygon_cells()}
    for corners in (32, 128):
        assert angle[corners, 100] == pytest.approx(angle[corners, 10], rel=0.05)
    assert 0.7 < angle[512, 100] / angle[512, 10] < 0.9


def test_a_soft_contacts_error_is_its_time_constants_and_a_stiff_ones_is_the_steps_too() -> None:
    rows = committed_rows([cell for _, cell in softness_cells()])
    angle = {(constant, cell.every): rows[cell].angle for constant, cell in softness_cells()}
    assert angle[2e-2, 10] == pytest.approx(angle[2e-2, 100], rel=0.05)
    assert abs(angle[6e-3, 10] / angle[6e-3, 100] - 1) > 0.2
    assert angle[2e-3, 10] > 2 * angle[2e-3, 100]
    # The shortest constant is not the best one.
    assert angle[2e-4, 100] > angle[6e-4, 100]


def test_a_second_wheel_on_an_axle_changes_no_methods_position_error() -> None:
    for scene, doubled in ((CarAndTrailer(), CarAndTrailer(redundant=True)), (Cart(), Cart(redundant=True))):
        for engine in (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED):
            for every in (1, 10):
                one, two = Cell(scene, engine, every), Cell(doubled, engine, every, "failure")
                rows = committed_rows([one, two])
                assert rows[two].position == pytest.approx(rows[one].position, rel=0.01)


def test_mujocos_default_blade_does_not_creep_at_rest_and_its_tuned_row_does() -> None:
    found = methods(skate_failures.FAILURES, "At rest across a slope")
    rows = {(name, row.step): row for name, own in found.items() for row in own}
    assert rows["pymunk default", 0.01].position == 0
    for step in (0.01, 0.001):
        assert rows["mujoco default", step].position < 1e-12
        assert rows["mujoco tuned", step].position > 1e-7
