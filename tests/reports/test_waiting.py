"""In which order work is done, and by which worker: the dearest first, and what is akin in one process."""

from __future__ import annotations

import os
import random
import time
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from engines.registry import VARIANTS
from reference.scenes.catalogue import SCENES
from reports.cli.selection import choose_cells
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.tasks import Motion, Task, Values
from reports.run import queue
from reports.run.queue import Waiting, dearest_first, expected_seconds, kin_of
from reports.run.running import run_items
from reports.run.supervisor import supervise
from tests.toys import Disc, Toy


@dataclass(frozen=True)
class Kindred:
    kin: str
    number: int


def jobs(*names: str) -> list[SimpleNamespace]:
    return [SimpleNamespace(item=Kindred(name, number)) for number, name in enumerate(names)]


def test_a_worker_stays_with_its_kin_then_takes_one_that_nobody_has_and_at_last_helps_others():
    waiting = Waiting()
    waiting.add(jobs("a", "b", "a", "b", "c"))
    assert len(waiting) == 5
    first, kin = waiting.take(None, [])
    assert (first.item.number, kin) == (0, "a")
    second, other = waiting.take(None, ["a"])
    assert (second.item.number, other) == (1, "b")
    assert waiting.take("a", ["b"])[0].item.number == 2
    assert waiting.take("a", ["b"])[0].item.number == 4  # c, which nobody has
    assert waiting.take("c", ["b"])[0].item.number == 3  # nothing else is left
    with pytest.raises(LookupError):
        waiting.take("c", [])


def test_what_says_nothing_of_its_kin_keeps_its_order_even_if_it_is_equal():
    waiting = Waiting()
    waiting.add(SimpleNamespace(item=word) for word in ("x", "y", "x"))
    assert [waiting.take(None, [])[0].item for _ in range(3)] == ["x", "y", "x"]


def test_cells_and_motions_of_a_scene_are_akin_and_those_of_another_are_not():
    cell = Cell(Disc(), Toy(), 1)
    assert kin_of(cell) == kin_of(Cell(Disc(), Toy(), 7)) == kin_of(Motion(cell))
    assert kin_of(cell) != kin_of(Cell(Disc(rate=3.0), Toy(), 1))


def test_the_dearest_kin_comes_first_and_in_it_the_dearest_cell(monkeypatch):
    costs = {(2.0, 1): 1.0, (2.0, 2): 3.0, (5.0, 1): 2.5, (7.0, 1): 2.0, (7.0, 3): 2.5}
    cells = {Cell(Disc(rate=rate), Toy(), every): (rate, every) for rate, every in costs}
    monkeypatch.setattr(queue, "expected_seconds", lambda cell: costs[cells[cell]])
    mixed = random.Random(1).sample(list(cells), len(cells))
    assert [cells[cell] for cell in dearest_first(mixed)] == [(7.0, 3), (7.0, 1), (2.0, 2), (2.0, 1), (5.0, 1)]


def test_what_a_cell_took_when_it_was_published_counts_more_than_a_formula(tmp_path, monkeypatch):
    cell = Cell(Disc(), Toy(), 2)
    named = f"{cell.scene.name},toy,default,sweep,x,y,{cell.sample_count},2"
    (tmp_path / "timings.csv").write_text(
        "# of a run\nscene,engine,variant,purpose,parameters,settings,samples,every,step,cpu,runs,build\n"
        f"{named},{cell.step},10.0,1,0.5\n{named},{cell.step},5.0,1,0.25\n"
        f"{named.replace('sweep', 'map')},{cell.step},nan,0,nan\n",
        encoding="utf-8",
    )
    assert expected_seconds(cell) < 1.0
    published = queue._published(tmp_path / "timings.csv")
    assert queue._published(tmp_path / "none.csv") == {}
    monkeypatch.setattr(queue, "_published", lambda: published)
    assert expected_seconds(cell) == pytest.approx(10.0 * cell.scene.duration + 0.5 + queue.LEAST, rel=1e-9)
    assert expected_seconds(replace(cell, purpose="map")) < 1.0  # it has no number there


def test_published_timings_that_are_damaged_are_told_and_change_no_cell_of_a_quick_run(tmp_path, monkeypatch):
    quick = choose_cells(SCENES[:3], VARIANTS, PAGES, False)
    (tmp_path / "timings.csv").write_text("scene,engine\ndisc,toy\n", encoding="utf-8")
    with pytest.warns(UserWarning, match="can't be read"):
        assert queue._published(tmp_path / "timings.csv") == {}
    monkeypatch.setattr(queue, "_published", lambda: {})
    assert choose_cells(SCENES[:3], VARIANTS, PAGES, False) == quick
    named = {queue._name(cell): 100.0 for cell in quick}
    monkeypatch.setattr(queue, "_published", lambda: named)
    assert choose_cells(SCENES[:3], VARIANTS, PAGES, False) == quick


def test_the_published_timings_are_found_and_some_of_the_grid_is_in_them():
    assert len(queue._published()) > 1000


def process_of(item: Kindred) -> int:
    time.sleep(0.2)  # the other worker is there by then
    return os.getpid()


def test_each_kin_is_worked_on_in_one_process_while_there_is_other_work():
    items = [Kindred(name, number) for number in range(6) for name in ("a", "b")]
    where: dict[str, set[int]] = {"a": set(), "b": set()}
    for item, process, _ in supervise(process_of, items, 60.0, 2):
        where[item.kin].add(process)
    # The one that is done first helps the other.
    assert min(len(found) for found in where.values()) == 1
    assert len(set.union(*where.values())) == 2


def where_it_stays(item: int) -> tuple[int, ...]:
    return tuple(sorted(os.sched_getaffinity(0)))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system keeps no process on a processor")
def test_a_worker_that_times_stays_on_a_processor_of_its_own_and_others_on_none():
    own = queue.apart()
    told = {found for _, found, _ in supervise(where_it_stays, range(4), 60.0, len(own), None, None, True)}
    assert told <= {(one,) for one in own}
    assert [found for _, found, _ in supervise(where_it_stays, [0], 60.0, 1)] == [queue.usable()]


def test_of_processors_that_share_a_core_one_is_taken(tmp_path, monkeypatch):
    monkeypatch.setattr(queue, "usable", lambda: (0, 1, 2, 3, 4))
    monkeypatch.setattr(queue, "TOPOLOGY", tmp_path)
    assert queue.apart() == (0, 1, 2, 3, 4)  # the system does not tell
    for number, siblings in enumerate(("0,2", "1,3", "0,2", "1,3")):
        (tmp_path / f"cpu{number}/topology").mkdir(parents=True)
        (tmp_path / f"cpu{number}/topology/thread_siblings_list").write_text(siblings + "\n", encoding="ascii")
    assert queue.apart() == (0, 1, 4)


@dataclass(frozen=True)
class Where(Task):
    """Where it runs."""

    number: int

    @property
    def cost(self) -> float:
        return 0.0

    @property
    def label(self) -> str:
        return "where"

    def run(self) -> Values:
        return {"process": np.array(float(os.getpid()))}


def test_more_workers_than_cores_run_what_is_timed_first_and_alone(monkeypatch):
    monkeypatch.setattr("reports.run.running.worker_count", lambda timed: 1 if timed else 2)
    rounds = []

    def told(function, items, limit, workers, watch, wall, alone):
        rounds.append(([type(item).__name__ for item in items], workers, alone))
        return supervise(function, items, limit, workers, watch, wall, alone)

    items = [Cell(Disc(), Toy(), 1), Where(1), Cell(Disc(), Toy(), 2, "map")]
    assert {item for item, _ in run_items(items, workers=3, supervised=told)} == set(items)
    assert [(sorted(names), *rest) for names, *rest in rounds] == [(["Cell"], 1, True), (["Cell", "Where"], 3, False)]
    rounds.clear()
    assert len(list(run_items(items, workers=3, timed=False, supervised=told))) == 3
    assert [each[1:] for each in rounds] == [(3, False)]
