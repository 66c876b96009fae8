"""`crosscheck bench` measures the motions of the runs, and counts each part of the CPU time once."""

import numpy as np
import pytest

from engines import mujoco, pymunk, registry
from engines.lagrange import TRUTH, loading
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import SquareOnCatenaries
from reports.bench import times
from reports.bench.times import (
    measure_batch,
    measure_command,
    measure_grid,
    measure_judge,
    measure_loops,
    measure_trees,
    measure_truths,
    measure_worlds,
)
from reports.cli.bench import _print_worlds
from reports.model.cells import Cell
from reports.model.ending import BadInput
from tests.toys import Disc, Toy


def test_an_engine_is_compared_with_the_bare_loop_of_its_name():
    costs = list(measure_loops([Toy(), pymunk.TUNED, mujoco.TUNED], Disc(), 2))
    assert [cost.engine for cost in costs] == [pymunk.TUNED, mujoco.TUNED]  # the toy has no bare loop
    assert all(cost.steps == 2 * Disc().samples for cost in costs)


def test_the_time_of_a_grid_is_counted_once_by_part_by_method_and_by_scene():
    spent = measure_grid([Cell(Disc(), Toy(), every) for every in (1, 2, 3)])
    assert {"building", "stepping", "comparing", "truth", "other"} <= spent["part"].keys()
    assert (list(spent["method"]), list(spent["scene"])) == (["toy default"], [Disc.name])
    assert sum(spent["part"].values()) == pytest.approx(sum(spent["method"].values()))


def test_the_timed_runs_of_the_judge_are_accurate_and_need_numba(monkeypatch):
    if loading.installed():
        errors = [value for name, value, _ in measure_judge(links=(3,), turns=1) if name.endswith("its error")]
        # The errors are those of order 4 with the step 1e-3 s, of order 8 with 5e-3 s and 1e-2 s, and of adaptive
        # steps.
        assert errors[0] < 1e-6
        assert errors[1] < 1e-9
        assert errors[2] < errors[1] / 20
        assert errors[3] < 1e-12
    monkeypatch.setattr("engines.lagrange.engine.installed", lambda: False)
    with pytest.raises(BadInput, match="the extra 'fast'"):
        measure_judge()


def test_the_timed_batch_agrees_with_single_runs_and_trees_of_all_sizes_are_timed():
    if loading.installed():
        assert measure_batch(40)[-1][1] < 1e-12
        assert len(list(measure_trees((3, 10), turns=1))) == 8


def test_exact_motions_are_sorted_by_cost_and_a_scene_without_one_is_left_out():
    scenes = [BarPendulum(duration=0.1), LinkPendulum(links=7, duration=0.51), SquareOnCatenaries()]
    rows = measure_truths(scenes)
    assert {name.removeprefix("truth of ").partition("(")[0] for name, _, _ in rows} == {"BarPendulum", "LinkPendulum"}
    assert [row[1] for row in rows] == sorted((row[1] for row in rows), reverse=True)


def test_a_timed_command_reports_its_exit_status():
    assert [measure_command([word])[2] for word in ("--help", "no such command")] == [0, 2]


def test_a_program_of_many_worlds_is_compared_with_the_judge_and_left_out_where_it_takes_too_long(monkeypatch):
    """The toy's program is slow, and turns its last world by 0.25 rad."""

    def run_worlds(engine, mechanisms, dt, steps):
        poses = np.array([TRUTH.build(mechanism, dt)(1, steps).pose[-1] for mechanism in mechanisms])
        poses[-1, 0, 2] += 0.25
        return poses, 1e3 * len(mechanisms)

    monkeypatch.setattr(times, "registered_by_key", lambda group, kind: {"toy": run_worlds})
    monkeypatch.setattr(registry, "INSTALLED", (Toy(),))
    judge, found, *later = measure_worlds((2, 3), 10)
    assert (judge.worlds, found.worlds) == (2, 2)
    assert found.error == pytest.approx(0.25, abs=1e-6)
    assert found.steps_per_second == pytest.approx(10 / 1e3)
    assert [cost.method for cost in later] == [judge.method]


def test_counts_of_worlds_that_are_not_positive_and_an_unknown_device_are_refused():
    for count in ("many", "0", "-1"):
        with pytest.raises(BadInput, match=f"'{count}' are no numbers of worlds"):
            _print_worlds([count], None)
    with pytest.raises(BadInput, match="--device abacus: it must be cpu or cuda"):
        _print_worlds([], "abacus")
