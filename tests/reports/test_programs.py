"""Every cheapest setting on a page is a program that runs as it is printed and gives the error that the row says."""

from __future__ import annotations

import contextlib
import io
import re

import numpy as np
import pytest

from reports.model.convergence import judged
from reports.model.page import Material, Page
from reports.write.page_tables import advice
from reports.write.programs import PAGES as FOLDER
from reports.write.programs import Program, advised_programs, program, programs_of
from tests.committed_rows import page_rows
from tests.reports.test_any_rows import FROM_ROWS

MECHANISMS = tuple(page for page in FROM_ROWS if page.scenes)

named = pytest.mark.parametrize("page", MECHANISMS, ids=lambda page: page.name)


def run(source: str) -> tuple[dict, str]:
    """What a program's names are at its end, and what it printed."""
    names, said = {"__name__": "__main__"}, io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(source, "a program", "exec"), names)
    return names, said.getvalue()


def programs(page: Page) -> list[tuple[Program, list]]:
    """The programs of a page from the committed rows, each with the rows of its method."""
    scene = page.advised_scene
    assert scene is not None
    rows = [row for row in judged(Material(page_rows(page)).sweep([scene]), page.quantity) if row.scene == scene.name]
    engines = {f"{engine.name} {engine.variant}": engine for engine in page.engines_of(scene)}
    found = advice(rows, page.quantity, tuple(engines))
    advised = {each.row.method for each in found if each.row is not None}
    made = advised_programs(page, scene, found, engines)
    assert {each.method for each in made} == advised
    return [(each, [row for row in rows if row.method == each.method]) for each in made]


@named
def test_a_program_moves_as_the_method_whose_name_it_has_and_errs_by_no_more_than_its_row(page):
    scene = page.advised_scene
    engines = {f"{engine.name} {engine.variant}": engine for engine in page.engines_of(scene)}
    for each, rows in programs(page):
        names, said = run(each.text)
        if not each.alone:
            (row,) = [row for row in rows if row.every == names["every"]]
            error = getattr(row, page.quantity)
            assert names["error"] == pytest.approx(error, rel=0.01, abs=1e-12), each.file
            assert said.split()[1:3] == [page.quantity, "error:"]
            continue
        steps, duration = names["steps"], names["duration"]
        assert duration <= min(scene.duration, scene.horizon)
        trajectory = engines[each.method].build(scene.mechanism(), duration / steps)(1, steps)
        body, *told = re.findall(r"^# Exact: ([^:]*): x = (\S+) m, y = (\S+) m, angle = (\S+) rad$", each.text, re.M)[0]
        # Programs have twelve digits of the scene's numbers; a motion of some seconds makes that a few 1e-11.
        pose = trajectory.pose[-1, scene.mechanism().body_index(body)]
        assert np.asarray(names["end"]) == pytest.approx(pose, abs=1e-9), each.file
        assert said.startswith(f"{body}: ")
        (row,) = [row for row in rows if row.step == pytest.approx(duration / steps)]
        far = np.abs(np.array([float(value) for value in told]) - names["end"])
        assert np.hypot(*far[:2]) <= 1.01 * row.position + 1e-9
        assert far[2] <= 1.01 * row.angle + 1e-9


def test_every_program_of_an_engine_alone_is_of_a_method_of_its_page():
    pages = {page.name: page for page in MECHANISMS}
    for path in FOLDER.glob("*/programs/*.py"):
        page = pages[path.parents[1].name]
        methods = [f"{engine.name} {engine.variant}" for engine in page.engines]
        assert path.read_text(encoding="utf-8") in [program(programs_of(page), method) for method in methods], path


def test_a_program_that_is_wrong_by_a_thousandth_is_noticed():
    source = program(FOLDER / "four_bar" / "programs", "mujoco tuned")
    right, wrong = run(source)[0]["end"], run(source.replace('mass="0.4"', 'mass="0.4004"'))[0]["end"]
    assert max(abs(a - b) for a, b in zip(right, wrong, strict=True)) > 1e-6
