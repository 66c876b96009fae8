"""Tests of tasks: the pool runs and stores tasks, and a report reads answers without running an engine."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from engines import Unsupported
from engines.registry import OTHERS, VARIANTS
from reference.scenes.catalogue import SCENES
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.cli.selection import QUICK_CELL, choose_cells, choose_engines, choose_tasks, known_engines
from reports.gate.prediction import all_tasks
from reports.model import measure as measuring
from reports.model.catalogue import PAGES
from reports.model.cells import QUICK, Cell
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.tasks import Answer, Motion, Task, answered, trajectory_of
from reports.pages.rendering import render_page
from reports.run.running import missing, run_into
from reports.run.store import Store
from tests.committed_rows import answer_to
from tests.toys import Disc, FailingToy, Toy, in_process


@dataclass(frozen=True)
class Sum(Task):
    numbers: tuple[float, ...]
    cost: float = 0.01  # type: ignore[misc]  # a property in the base

    @property
    def label(self) -> str:
        return f"sum of {self.numbers}"

    def run(self):
        if not self.numbers:
            raise ValueError("there is nothing to add up")
        if self.numbers == (0.0,):
            raise Unsupported("zero has no sum here")
        return {"sum": np.asarray(sum(self.numbers)), "table": np.outer(self.numbers, self.numbers), "word": "done"}


def motion(variant: str = "", every: int = 1) -> Motion:
    return Motion(Cell(Disc(), FailingToy(variant) if variant else Toy(), every))


def test_an_answer_is_stored_to_the_last_bit_and_its_task_is_run_once(tmp_path):
    cell, tasks = Cell(Disc(), Toy(), 1), [Sum((0.1, 0.2, np.nan)), Sum((1 / 3,)), motion()]
    results = []
    with Store(tmp_path / "cells.sqlite") as store:
        assert missing([*tasks, cell], store) == (*tasks, cell)
        assert run_into(store, [*tasks, cell], done=results.append, supervised=in_process) == len(results) == 4
        assert run_into(store, [*tasks, cell]) == 0
        assert store.get([cell])[cell].outcome == Outcome.FINISHED
        result = store.answers([*tasks, Sum((5.0,))])
    assert set(result) == set(tasks)
    for task in tasks:
        exact = answered(task)
        assert result[task].finished
        assert result[task].values.keys() == exact.values.keys()
        for name, value in exact.values.items():
            if isinstance(value, str):
                assert result[task].values[name] == value
            else:
                assert result[task].array(name).shape == value.shape
                assert result[task].array(name).tobytes() == value.tobytes()
    assert result[tasks[1]].number("sum") == 1 / 3
    run = cell.engine.build(cell.scene.mechanism(), cell.step)(cell.sample_count, cell.every)
    remaining = trajectory_of(result[tasks[2]])
    for name in ("t", "pose", "twist", "reaction"):
        assert np.array_equal(getattr(remaining, name), getattr(run, name)), name


ENDS = {
    motion("abort"): (Outcome.ABORTED, "SIGABRT"),
    motion("refuse"): (Outcome.REFUSED, "mass is -1; it must be greater than zero"),
    motion("unsupported"): (Outcome.UNSUPPORTED, "it has no pins"),
    Sum(()): (Outcome.REFUSED, "there is nothing to add up"),
    Sum((0.0,)): (Outcome.UNSUPPORTED, "zero has no sum here"),
}


def test_the_outcome_of_a_failed_task_is_stored(tmp_path):
    with Store(tmp_path / "cells.sqlite") as store:
        run_into(store, [*ENDS])
        answers = store.answers(ENDS)
        assert missing(ENDS, store) == ()
    for task, answer in answers.items():
        outcome, sentence = ENDS[task]
        assert (answer.outcome, answer.finished, answer.values) == (outcome, False, {})
        assert sentence in answer.sentence
        assert sentence in answer.told


def test_a_quick_run_leaves_out_long_tasks_and_a_named_engine_runs_only_its_tasks():
    cheap, dear = Sum((1.0,)), Sum((2.0,), 10 * QUICK_CELL)
    mine, other = motion(), motion("refuse")
    failure = Failure("Kept", "It should turn.", tasks=(dear, mine))
    page = Page("discs", "Discs", "One disc.", (Disc(),), (Toy(),), failures=(failure,), tasks=(cheap, other, mine))
    engines = (Toy(), FailingToy("refuse"))
    assert all_tasks(page) == (cheap, other, mine, dear)
    assert choose_tasks((Disc(),), engines, (page,), full=False) == (cheap, other, mine)
    assert choose_tasks((Disc(),), engines, (page,), full=True) == (cheap, other, mine, dear)
    assert choose_tasks((Disc(),), engines[:1], (page,), full=True) == (cheap, mine, dear)
    assert choose_tasks(SCENES, engines, (page,), full=True) == ()
    assert FailingToy("refuse") in known_engines((page,))


def test_a_full_run_of_all_scenes_has_every_task_of_every_page():
    """Tasks of engines whose package is not installed are left out."""
    every = {task for page in PAGES for task in all_tasks(page) if task.engine is None or not task.engine.missing}
    assert set(choose_tasks(SCENES, choose_engines(None, None, known_engines(PAGES)), PAGES, full=True)) == every
    assert not any(isinstance(cell, Task) for cell in choose_cells(SCENES[:1], (), PAGES, full=True))


def test_a_run_for_pages_leaves_out_the_cells_of_extras_that_no_page_lists():
    shown, other = (Cell(scene, OTHERS[0], QUICK[-1], "beside") for scene in SCENES[:2])
    page = Page("one", "One", "One row.", SCENES[:2], VARIANTS[:1], cells=(shown,))
    full, printed = (
        choose_cells(SCENES[:2], (VARIANTS[0], OTHERS[0]), (page,), full=True, printed=printed)
        for printed in (False, True)
    )
    assert {shown, other} <= {*full}
    assert {*full} - {*printed} == {cell for cell in full if cell.engine == OTHERS[0]} - {shown}


@cache
def answers(page: Page) -> dict[Task, Answer]:
    return {task: answer_to(task) for task in all_tasks(page)}


# the page "centrodes" has tasks, and "scaling" has only rows
@pytest.mark.parametrize("name", ["centrodes", "scaling"])
def test_a_page_is_written_without_engines(name, monkeypatch):
    [page] = [page for page in PAGES if page.name == name]
    material = Material({}, answers(page))
    for kind in {type(engine) for engine in known_engines(PAGES)}:
        monkeypatch.setattr(kind, "build", None)
    # A figure or a table in a cache would hide that an engine is used.
    for value in list(vars(__import__(page.context.__module__, fromlist=["context"])).values()):
        if isinstance(value, functools._lru_cache_wrapper):
            value.cache_clear()
    assert render_page(page, material, "the command")


def test_an_exact_motion_is_stored_to_the_last_bit_and_a_damaged_file_is_computed_again(tmp_path, monkeypatch):
    monkeypatch.setattr(measuring, "SHORT_MOTION", -1.0)
    scene, t = LinkPendulum(links=2), np.linspace(0.0, 0.5, 6).tobytes()
    motion = measuring._motion.__wrapped__
    first = motion(scene, t, "name", tmp_path)
    (file,) = tmp_path.iterdir()
    total = file.read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(LinkPendulum, "_motion", None)
        for part in measuring.PARTS:
            np.testing.assert_array_equal(getattr(first, part), getattr(motion(scene, t, "name", tmp_path), part))
        for instants, name in ((t[:-8], "name"), (t, "other")):
            with pytest.raises(TypeError):
                motion(scene, instants, name, tmp_path)
    for content in (b"", b"no archive at all", total[: len(total) // 2]):
        file.write_bytes(content)
        np.testing.assert_array_equal(motion(scene, t, "name", tmp_path).pose, first.pose)
        assert file.read_bytes() == total
    assert motion(scene, t, "name", tmp_path / "none").pose.shape == (6, 2, 3)
