"""`crosscheck bench`: what it compares is the same motion, and what is missing is told."""

import sys

import pytest

from engines import mujoco, pymunk
from reports.bench.four_bar import floor_ratio, pylinkage_ratio
from reports.bench.loops import loop_costs
from reports.bench.suite import BETWEEN, OTHER, STARTING, Account, timings_alike
from reports.grid.cells import Cell
from reports.grid.outcomes import Outcome
from reports.grid.pool import run_items
from reports.grid.tasks import Motion
from tests.toys import Disc, FailingToy, Toy


def test_the_bench_times_the_same_motion_as_pylinkage():
    pytest.importorskip("pylinkage")
    result = pylinkage_ratio(count=1000)
    # pylinkage adds up its crank angle step by step: a thousand roundings.
    assert result["difference"] < 1e-12
    assert result["ratio"] == result["pylinkage"] / result["ours"]


def test_the_bench_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "pylinkage", None)
    with pytest.raises(RuntimeError, match="'bench' extra"):
        pylinkage_ratio(count=1000)
    assert floor_ratio(count=1000)["floor"] > 0


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


def test_the_timings_of_one_worker_and_of_all_are_of_the_same_cells():
    cells = [Cell(Disc(), Toy(), 1), Cell(Disc(), Toy(), 2), Cell(Disc(), Toy(), 3, "map")]
    found = timings_alike(cells, workers=2, turns=1)
    assert (found.cells, found.workers) == (2, 2)  # a map is not timed
    assert found.middle > 0
    assert timings_alike(cells[2:], workers=2, turns=1).cells == 0
