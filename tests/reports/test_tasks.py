"""Tasks: what pages tell of beside their rows is run by the pool, kept, and read; a report itself steps nothing."""

from __future__ import annotations

import functools
import json
import re
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from engines import Unsupported, mujoco, pymunk
from reference.scenes.catalogue import SCENES
from reference.trajectory import Trajectory
from reports.cli.selection import QUICK_CELL, choose_cells, choose_engines, choose_tasks, known_engines
from reports.gate.prediction import all_tasks
from reports.model import fingerprint
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.tasks import Answer, Motion, Task, answered, trajectory_of
from reports.pages.rendering import render_page
from reports.pages.skate.page import path_picture
from reports.run import store as store_module
from reports.run.running import missing, run_into, run_items
from reports.run.store import Store
from tests.present import present
from tests.reports.rough_toys import RoughToy
from tests.toys import Disc, FailingToy, Toy


@dataclass(frozen=True)
class Sum(Task):
    """One that runs no engine."""

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


def test_a_task_is_kept_to_the_last_bit_and_run_once_beside_cells(tmp_path):
    cell, tasks = Cell(Disc(), Toy(), 1), [Sum((0.1, 0.2, np.nan)), Sum((1 / 3,)), motion()]
    results = []
    with Store(tmp_path / "cells.sqlite") as store:
        assert missing([*tasks, cell], store) == (*tasks, cell)
        assert run_into(store, [*tasks, cell], done=results.append) == len(results) == 4
        assert run_into(store, [*tasks, cell]) == 0
        assert store.get([cell])[cell].outcome == Outcome.FINISHED
        found = store.answers([*tasks, Sum((5.0,))])
    assert set(found) == set(tasks)
    for task in tasks:
        exact = answered(task)
        assert found[task].finished
        assert found[task].values.keys() == exact.values.keys()
        for name, value in exact.values.items():
            if isinstance(value, str):
                assert found[task].values[name] == value
            else:
                assert found[task].array(name).shape == value.shape
                assert found[task].array(name).tobytes() == value.tobytes()
    assert found[tasks[1]].number("sum") == 1 / 3
    run = cell.engine.build(cell.scene.mechanism(), cell.step)(cell.sample_count, cell.every)
    kept = trajectory_of(found[tasks[2]])
    for name in ("t", "pose", "twist", "reaction"):
        assert np.array_equal(getattr(kept, name), getattr(run, name)), name


ENDS = {
    motion("abort"): (Outcome.ABORTED, "SIGABRT"),
    motion("raise"): (Outcome.FAILED, "RuntimeError: something else"),
    motion("refuse"): (Outcome.REFUSED, "mass is -1; it must be greater than zero"),
    motion("unsupported"): (Outcome.UNSUPPORTED, "it has no pins"),
    Sum(()): (Outcome.REFUSED, "there is nothing to add up"),
    Sum((0.0,)): (Outcome.UNSUPPORTED, "zero has no sum here"),
}


def test_what_became_of_a_task_is_its_answer_and_is_kept_too_and_a_second_try_is_told(tmp_path):
    again = Motion(Cell(Disc(), RoughToy("segfault once", folder=str(tmp_path)), 1))
    with Store(tmp_path / "cells.sqlite") as store:
        run_into(store, [*ENDS, again])
        answers = store.answers([*ENDS, again])
        assert missing([*ENDS, again], store) == ()
    second = answers.pop(again)
    assert second.finished
    assert "the second went through" in second.sentence
    for task, answer in answers.items():
        outcome, sentence = ENDS[task]
        assert (answer.outcome, answer.finished, answer.values) == (outcome, False, {})
        assert sentence in answer.sentence
        assert sentence in answer.told


def test_the_key_of_a_task_is_that_of_its_numbers_its_kind_and_its_sources(monkeypatch):
    keys = {Sum((1.0,)).key, Sum((2.0,)).key, motion().key, motion(every=3).key, motion("refuse").key}
    assert len(keys) == 5
    assert Sum((1.0,)).key == Sum((1.0,)).key
    before = motion().key
    assert before != Cell(Disc(), Toy(), 1).key
    monkeypatch.setattr("reports.model.tasks.fingerprint", lambda *values: "other sources")
    assert motion().key != before


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text[:-3],
        lambda text: text.replace("finished", "finisheD"),
        lambda text: store_module._signed("[1]"),
        lambda text: store_module._signed(json.dumps({"key": "another"})),
        lambda text: store_module._signed(text.partition(" ")[2].replace('"finished"', '"melted"')),
        lambda text: store_module._signed(re.sub(r'"float64": "\w', '"float64": "=', text.partition(" ")[2])),
        lambda text: store_module._signed(text.partition(" ")[2].replace('"values"', '"numbers"')),
    ],
)
def test_an_answer_that_can_not_be_read_is_none(change):
    text = store_module.text_of_answer("key", answered(Sum((1.0, 2.0))))
    assert present(store_module.answer_of("key", text)).number("sum") == 3.0
    assert store_module.answer_of("another", text) is None
    assert store_module.answer_of("key", change(text)) is None


def test_a_quick_run_leaves_out_dear_tasks_and_an_engine_alone_runs_its_own():
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
    """But those of engines whose package is not here."""
    every = {task for page in PAGES for task in all_tasks(page) if task.engine is None or not task.engine.missing}
    assert set(choose_tasks(SCENES, choose_engines(None, None, known_engines(PAGES)), PAGES, full=True)) == every
    assert not any(isinstance(cell, Task) for cell in choose_cells(SCENES[:1], (), PAGES, full=True))


def test_no_answer_is_stale_because_of_words_or_pictures():
    """A task's module, and what it imports, is apart from templates, commands and charts."""
    words = re.compile(r"reports/(plots|cli|pages/(rendering|\w+/page))\b")
    for kind in {type(task) for page in PAGES for task in all_tasks(page)}:
        places, _ = fingerprint._behind(frozenset({kind.__module__}))
        names = [place.relative_to(fingerprint.ROOT).as_posix() for place in places]
        assert [name for name in names if words.match(name)] == [], kind.__name__


@cache
def answers(page: Page) -> dict[Task, Answer]:
    return {task: answered(task) for task in all_tasks(page)}


def refusing(monkeypatch) -> list[str]:
    """Every engine's `build` raises from now on; the names of those that were asked."""
    asked: list[str] = []

    def build(self, *arguments):
        asked.append(type(self).__name__)
        raise AssertionError("an engine is built while a page is written")

    for kind in {type(engine) for engine in known_engines(PAGES)}:
        monkeypatch.setattr(kind, "build", build)
    return asked


def written_twice(page: Page, material: Material, monkeypatch) -> None:
    with_engines = render_page(page, material, "the command")
    with monkeypatch.context() as patch:
        asked = refusing(patch)
        # A figure or a table that was kept in memory would hide an engine.
        for value in list(vars(__import__(page.words.__module__, fromlist=["words"])).values()):
            if isinstance(value, functools._lru_cache_wrapper):
                value.cache_clear()
        assert render_page(page, material, "the command") == with_engines
    assert asked == []


# All kinds: pictures with motions over them, tables from motions, observations, referees, and rows alone.
@pytest.mark.parametrize("name", ["centrodes", "errata", "wheels", "scaling"])
def test_a_page_is_the_same_without_engines(name, monkeypatch):
    [page] = [page for page in PAGES if page.name == name]
    written_twice(page, Material({}, answers(page)), monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_page_is_the_same_without_engines(page, monkeypatch):
    written_twice(page, Material({}, answers(page)), monkeypatch)


def test_an_engine_that_is_built_while_a_page_is_written_is_noticed(monkeypatch):
    page = Page("discs", "Discs", "One disc.", (), (), words=lambda material: {"x": motion().run()})
    monkeypatch.setattr("tests.reports.test_tasks.PAGES", (replace(page, tasks=(motion(),)),))
    asked = refusing(monkeypatch)
    with pytest.raises(AssertionError, match="while a page is written"):
        page.words(Material({}))
    assert asked == ["Toy"]


def test_motions_for_pictures_leave_out_what_was_not_run_or_failed():
    sound, failed, never = (motion(variant).cell for variant in ("", "refuse", "raise"))
    material = Material({}, {Motion(cell): answered(Motion(cell)) for cell in (sound, failed)})
    found = material.motions([sound, failed, never])
    assert set(found) == {sound}
    assert isinstance(found[sound], Trajectory)


def test_a_path_is_drawn_for_each_motion_that_was_kept():
    cell = next(task.cell for page in PAGES if page.name == "skate" for task in page.tasks if isinstance(task, Motion))
    empty = path_picture(Material({}))
    one = path_picture(Material({}, {Motion(cell): answered(Motion(cell))}))
    drawn = [sum(len(panel.get_lines()) for panel in picture.axes) for picture in (empty, one)]
    assert drawn[1] == drawn[0] + 2  # a path and the dot at its end


def test_the_motion_of_an_engine_is_the_same_from_a_worker():
    for task, answer in run_items([Motion(Cell(Disc(), engine, 3)) for engine in (pymunk.TUNED, mujoco.TUNED)]):
        assert np.array_equal(answer.array("pose"), answered(task).array("pose"))
