"""The shape of each mechanism's page: its data page beside it, code that runs as it is printed."""

from __future__ import annotations

import contextlib
import io
import re
from functools import cache

import numpy as np
import pytest

from reports.model.catalogue import PAGES
from reports.model.page import Page
from reports.write.programs import PAGES as FOLDER
from reports.write.programs import program, programs_of
from reports.write.tables import number
from reports.write.templates import anchor, headings
from tests.committed_rows import RESULTS
from tests.committed_rows import page_rows as whole
from tests.reports import test_any_rows as rendering
from tests.reports.test_any_rows import FROM_ROWS, cheap, written

undrawn = rendering.undrawn  # pytest finds a fixture by its name in the module

MECHANISMS = tuple(page for page in FROM_ROWS if page.scenes)
FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PROGRAM = re.compile(r"^### ([^\n]*)\n\n```python\n(.*?)^```\n\nExact: ([^:]*): ([^\n]*)\.$", re.DOTALL | re.MULTILINE)
# Engine, variant and step of each line of the table of advice.
ADVISED = re.compile(r"^\| (\w+) \| [^|]* \| \*\*([^|]*)\*\* \| [^|]* \| ([^| ]*) \|", re.MULTILINE)

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
    page = next((page for page in PAGES if file in page.documents), None)
    # The index is of all pages.
    text = (RESULTS / file).read_text(encoding="utf-8") if page is None else texts(page)[file]
    return frozenset(anchor(title) for title in headings(text))


@named
def test_a_page_and_its_data_page_link_to_each_other_and_every_link_has_its_heading(page, undrawn):
    found = texts(page)
    assert set(found) == {f"{page.name}.md", page.data_page}
    for name, text in found.items():
        (other,) = set(found) - {name}
        assert f"]({other})" in text
        for target, heading in re.findall(r"\]\((\w+\.md)?#([^)]*)\)", text):
            assert heading in anchors(target or name), (name, target, heading)


@named
def test_the_contents_of_a_data_page_name_each_of_its_headings(page, undrawn):
    text = texts(page)[page.data_page]
    contents = re.findall(r"^ *- \[.*\]\(#(.*)\)$", text, re.MULTILINE)
    assert contents == [anchor(title) for title in re.findall(r"^##+ (.*)$", text, re.MULTILINE)]


@named
def test_the_page_says_for_the_scene_it_names_which_setting_gives_which_accuracy(page, undrawn):
    assert page.advised in {"", *(scene.name for scene in page.scenes)}
    text = texts(page)[f"{page.name}.md"]
    assert text.index("## Which setting for which accuracy") < text.index("![")
    assert page.advised_scene is not None
    assert f"**{page.advised_scene.name}**" in text


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
        assert number(row.step) == next(step for *who, step in ADVISED.findall(text) if " ".join(who) == method)
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
