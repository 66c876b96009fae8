"""`crosscheck bench`: what it compares is the same motion, and what is missing is told."""

import re

import pytest

from engines import mujoco, pymunk
from engines.lagrange import Lagrange, loading
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import SquareOnCatenaries
from reports.bench import answers, judge
from reports.bench.suite import BETWEEN, OTHER, STARTING, Account, loop_costs, timings_alike
from reports.cli.bench import bench
from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.model.tasks import Motion
from reports.run.running import run_items
from tests.toys import Disc, FailingToy, Toy


def test_an_engine_is_compared_with_the_loop_that_is_declared_for_its_name():
    scene = Disc()
    found = loop_costs([Toy(), pymunk.TUNED, mujoco.TUNED], scene.mechanism(), 1e-3, 2, 2)
    assert [cost.engine for cost in found] == [pymunk.TUNED, mujoco.TUNED]  # nobody declares one for the toy
    assert all(cost.steps == 4 and cost.bare > 0 for cost in found)


def test_an_account_changes_no_row_and_counts_every_item():
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3)]
    items = [*cells, Cell(Disc(), FailingToy("abort"), 1), Motion(cells[0])]
    account = Account()
    told = dict(run_items(items, workers=1, supervised=account.supervise))
    plain = dict(run_items(items, workers=1))
    assert {item: result.outcome for item, result in told.items()} == {i: r.outcome for i, r in plain.items()}
    assert [told[cell].angle for cell in cells] == [plain[cell].angle for cell in cells]
    assert account.lost == 1
    assert told[items[3]].outcome == Outcome.ABORTED
    assert {"building", "stepping", "comparing", "truth", "tasks", STARTING, BETWEEN, OTHER} <= account.parts.keys()
    assert account.scenes.keys() == {Disc.name, "tasks"}
    assert account.methods.keys() == {"toy default"}
    # Each part is counted once: nothing is in two of them.
    assert sum(account.methods.values()) == pytest.approx(
        account.seconds - account.parts[STARTING] - account.parts[BETWEEN]
    )
    assert len(account.longest) == 4
    # One worker at a time, and another one after the abort: there was work for it until the end.
    assert len(account.last) > 1
    assert account.tail(1) == 0.0


def test_the_time_without_work_for_all_leaves_out_workers_that_were_replaced():
    # Two at a time: the first was replaced at 4 s, the second had nothing to do from 9 s on, the third ended at 10 s.
    account = Account(first={1: 0.0, 2: 0.0, 3: 4.5}, last={1: 4.0, 2: 9.0, 3: 10.0})
    assert account.tail(2) == 1.0
    assert account.tail(1) == 0.0
    assert account.tail(3) == 10.0  # there were never three
    # The last one is replaced when nothing waits for the other worker any more.
    late = Account(first={1: 0.0, 2: 0.0, 3: 8.5}, last={1: 5.0, 2: 8.0, 3: 9.0})
    assert late.tail(2) == 4.0
    assert Account().tail(2) == 0.0


def test_the_timings_of_one_worker_and_of_all_are_of_the_same_cells():
    cells = [Cell(Disc(), Toy(), 1), Cell(Disc(), Toy(), 2), Cell(Disc(), Toy(), 3, "map")]
    found = timings_alike(cells, workers=2, turns=1)
    assert (found.cells, found.workers) == (2, 2)  # a map is not timed
    assert found.middle > 0
    assert timings_alike(cells[2:], workers=2, turns=1).cells == 0


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_the_judges_figures_are_of_runs_that_are_right(monkeypatch):
    monkeypatch.setattr(judge, "REPEATS", 1)
    found = {figure.what: figure for figure in judge.figures(links=(3,))}
    assert all(figure.measured > 0 for figure in found.values())
    errors = [figure.measured for what, figure in found.items() if what.endswith("its error")]
    assert len(errors) == 4
    # Of order 4 at 1e-3 s, of order 8 at 1e-2 s and half of it: less than a 2^8th, and rounding; and of a tolerance.
    assert errors[0] < 1e-6
    assert errors[1] < 1e-9
    assert errors[2] < errors[1] / 20
    assert errors[3] < 1e-12
    chain = next(figure for what, figure in found.items() if what.startswith("chain of 3 links"))
    assert chain.asked == 3e-3


def test_the_judges_figures_say_that_they_need_numba(monkeypatch):
    monkeypatch.setattr("engines.lagrange.engine.installed", lambda: False)
    with pytest.raises(RuntimeError, match="the extra 'fast'"):
        judge.figures()


def test_the_judge_stands_beside_the_fastest_engine_that_reaches_an_error():
    scene = BarPendulum(duration=0.1, horizon=0.1)
    near, far = judge.beside_others(scene, [Lagrange("rk4"), pymunk.EXTENDED, pymunk.DEFAULT], (1e-4, 1e-30))
    assert near.factor == near.other / near.own > 0
    assert near.method.startswith("pymunk")
    assert far.own != far.own  # NaN: nobody reaches it
    assert far.method == ""


def test_truths_stand_by_their_cost_and_a_scene_without_one_is_left_out():
    short, chain, none = BarPendulum(duration=0.1), LinkPendulum(links=7, duration=0.51), SquareOnCatenaries()
    found = judge.truth_costs([short, chain, none])
    assert {scene for scene, _ in found} == {short, chain}  # beyond the corner the square has no motion
    assert [seconds for _, seconds in found] == sorted((seconds for _, seconds in found), reverse=True)


def test_crosscheck_bench_judge_prints_what_was_measured_beside_what_is_asked_for(monkeypatch, capsys):
    monkeypatch.setattr("reports.cli.selection.choose_cells", lambda *_: [Cell(Disc(), Toy(), 1)])
    monkeypatch.setattr(judge, "truth_costs", lambda scenes: [(scene, 0.25) for scene in scenes])
    monkeypatch.setattr(judge, "figures", lambda: [judge.Figure("one evaluation", 3e-6, "s", 5e-6)])
    monkeypatch.setattr(judge, "beside_others", lambda *_: [judge.Beside(1e-6, 2e-3, 9e-3, "pymunk extended")])
    bench(["judge"])
    told = [re.split(r" *│ *| {2,}", line.strip()) for line in capsys.readouterr().out.splitlines()]
    assert ["the dearest truths, of 0.25 s for the 1 of the full grid"] in told
    assert [repr(Disc()), "0.25"] in told
    assert ["one evaluation", "3e-6", "5e-6", "s"] in told
    assert ["1e-6", "2", "9", "pymunk extended", "4.5"] in told  # milliseconds


def test_a_command_is_timed_as_a_process_and_its_status_is_told():
    found = answers.waited(answers.Question(("--help",), 0.15))
    assert (found.status, found.cpu > 0, found.wall > 0) == (0, True, True)
    refused = answers.waited(answers.Question(("no such command",), 0.15))
    assert refused.status == 2
