"""The shape of the pages: links that lead somewhere, code that runs as it is printed, no two documents of one name."""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from reports.cli.drawing import drawn, material_of
from reports.cli.selection import shown_cells
from reports.gate.pytest_plugin import _engines
from reports.model.catalogue import PAGES, _without_doubles, generic_page, with_scenes
from reports.model.measure import measure
from reports.model.page import Page
from reports.pages.rendering import render_page
from reports.run.store import Store
from reports.write.programs import PAGES as FOLDER
from reports.write.programs import program, programs_of
from reports.write.tables import step_words
from reports.write.templates import anchor, headings
from tests.committed_rows import RESULTS
from tests.committed_rows import page_rows as whole
from tests.reports import test_any_rows as rendering
from tests.reports.test_any_rows import FROM_ROWS, cheap, written
from tests.toys import Disc, Toy

undrawn = rendering.undrawn  # pytest finds a fixture by its name in the module

MECHANISMS = tuple(page for page in FROM_ROWS if page.scenes)
FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PROGRAM = re.compile(r"^### ([^\n]*)\n\n```python\n(.*?)^```\n\nExact: ([^:]*): ([^\n]*)\.$", re.DOTALL | re.MULTILINE)
# Engine, variant and step of each line of the table of advice.
ADVISED = re.compile(r"^\| (\w+) \| [^|]* \| \*\*([^|]*)\*\* \|(?: [^|]* \|)? ([^|]* ms) \|", re.MULTILINE)

named = pytest.mark.parametrize("page", MECHANISMS, ids=lambda page: page.name)


@cache
def texts(page: Page) -> dict[str, str]:
    """The Markdown files of a page from the committed rows, without its pictures; call under `undrawn`."""
    return {name: text for name, text in written(cheap(page), whole(page)).items() if name.endswith(".md")}


@cache
def anchors(file: str) -> frozenset[str]:
    """What links to a page's file may end with, whichever page it is; call under `undrawn`.

    Raises FileNotFoundError for a file of no page.
    """
    page = next((page for page in PAGES if file == page.document), None)
    # The index is of all pages.
    text = (RESULTS / file).read_text(encoding="utf-8") if page is None else texts(page)[file]
    return frozenset(anchor(title) for title in headings(text))


@named
def test_every_link_of_a_page_has_its_heading(page, undrawn):
    for name, text in texts(page).items():
        for target, heading in re.findall(r"\]\((\w+\.md)?#([^)]*)\)", text):
            assert heading in anchors(target or name), (name, target, heading)


def run(source: str) -> tuple[dict, str]:
    """What a program's names are at its end, and what it printed."""
    names, said = {"__name__": "__main__"}, io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(source, "a page", "exec"), names)
    return names, said.getvalue()


@named
def test_every_block_of_code_on_a_page_runs_as_printed_and_prints_its_result(page, undrawn):
    for text in texts(page).values():
        for language, source in FENCED.findall(text):
            assert language == "python", f"{language}: only programs that run as they are belong on a page"
            assert run(source)[1].strip()


@named
def test_a_program_moves_as_the_method_whose_name_it_has(page, undrawn):
    text, scene = texts(page)[f"{page.name}.md"], page.advised_scene
    assert scene is not None
    engines = {f"{engine.name} {engine.variant}": engine for engine in page.engines_of(scene)}
    printed = PROGRAM.findall(text)
    assert len(printed) == text.count("[a program to copy](")
    for method, source, body, exact in printed:
        names, said = run(source)
        steps, duration = names["steps"], names["duration"]
        assert duration <= min(scene.duration, scene.horizon)
        trajectory = engines[method].build(scene.mechanism(), duration / steps)(1, steps)
        pose = trajectory.pose[-1, scene.mechanism().body_index(body)]
        # Programs have twelve digits of the scene's numbers; a motion of some seconds makes that a few 1e-11.
        assert np.asarray(names["end"]) == pytest.approx(pose, abs=1e-9), method
        assert said.startswith(f"{body}: ")
        rows = [r for r in whole(page).values() if (r.method, r.scene) == (method, scene.name) and r.purpose == "sweep"]
        (row,) = [row for row in rows if row.step == pytest.approx(duration / steps)]
        # The first step that the table above advises for this method: another one may have a row too.
        assert step_words(row.step) == next(step for *who, step in ADVISED.findall(text) if " ".join(who) == method)
        told = np.array([float(value) for value in re.findall(r"= (-?[\d.]+)", exact)])
        far = np.abs(told - names["end"])
        assert max(far[:2]) <= 1.01 * row.position + 1e-9
        assert far[2] <= 1.01 * row.angle + 1e-9


def test_every_program_is_of_a_method_of_its_page():
    pages = {page.name: page for page in MECHANISMS}
    for path in FOLDER.glob("*/programs/*.py"):
        page = pages[path.parents[1].name]
        methods = [f"{engine.name} {engine.variant}" for engine in page.engines]
        assert path.read_text(encoding="utf-8") in [program(programs_of(page), method) for method in methods], path


def test_a_program_that_is_wrong_by_a_thousandth_is_noticed():
    source = program(FOLDER / "four_bar" / "programs", "mujoco tuned")
    right, wrong = run(source)[0]["end"], run(source.replace('mass="0.4"', 'mass="0.4004"'))[0]["end"]
    assert max(abs(a - b) for a, b in zip(right, wrong, strict=True)) > 1e-6


def called(name: str) -> Disc:
    """A disc in a scene of this name."""
    return type("Named", (Disc,), {"name": name})()


def test_pages_of_scenes_whose_names_are_alike_share_no_document():
    names = ("a/b", "a b")
    pages = with_scenes((), [called(name) for name in names], (Toy(),))
    assert [page.scenes[0].name for page in pages] == list(names)
    assert len({page.document for page in pages}) == len(names)


def test_a_scene_called_index_does_not_replace_the_index():
    assert generic_page(called("index"), (Toy(),)).document == "index_2.md"


def test_a_page_whose_document_is_another_pages_is_left_out_in_a_line():
    first = Page("x", "X", "One.", (called("one"),), (Toy(),))
    second = replace(first, scenes=(called("two"),))
    kept, troubles = _without_doubles([first, second, replace(second, name="index")])
    assert kept == (first,)
    assert troubles == (
        "crosscheck.pages: the page 'x' is left out, since it would have the file x.md, as 'x' has",
        "crosscheck.pages: the page 'index' is left out, since it would have the file index.md, as the index of all "
        "pages has",
    )


def test_engines_of_the_gate_are_names_or_references(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.path", [*__import__("sys").path])
    assert _engines(["pymunk", "mujoco tuned"]) == ((), ("pymunk", "mujoco tuned"))
    (tmp_path / "own_toy.py").write_text("from tests.toys import Toy\nOWN = (Toy('a'), Toy('b'))\n")
    found = _engines([f"{tmp_path}/own_toy.py:OWN", "engines.pymunk:TUNED"])
    assert [engine.variant for engine in found[0]] == ["a", "b", "tuned"]
    assert found[1] == ("toy a", "toy b", "pymunk tuned")
    (tmp_path / "another.py").write_text("from tests.toys import Toy\nOTHER = Toy('tuned', name='pymunk')\n")
    with pytest.raises(pytest.UsageError, match="another engine is called 'pymunk tuned'; give it another name"):
        _engines([f"{tmp_path}/another.py"])
    with pytest.raises(pytest.UsageError, match="there is no such file"):
        _engines([f"{tmp_path}/missing.py"])


def test_pages_of_workers_are_those_of_one_process(tmp_path: Path) -> None:
    pages = [page for page in PAGES if page.name in ("settings", "person")]
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        for cell in [next(c for c in shown_cells(page) if c.engine.name == "pymunk") for page in pages]:
            store.put(measure(cell, repeat=False))
    with Store.read(path) as store:
        material = {page: material_of(page, store) for page in pages}
    made = drawn(material, (), "make report", tmp_path)
    alone = {page.name: render_page(page, given, "make report") for page, given in material.items()}
    assert set(made) == {page.name for page in pages}
    assert made == alone
