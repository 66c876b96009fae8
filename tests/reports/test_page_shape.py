"""The shape of the pages: links that lead somewhere, code that runs as it is printed, no two documents of one name."""

from __future__ import annotations

import contextlib
import io
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from reports.cli.drawing import drawn, material_of
from reports.cli.selection import shown_cells
from reports.gate.pytest_plugin import _engines
from reports.model.catalogue import PAGES, _without_doubles, generic_page, with_scenes
from reports.model.measure import measure
from reports.model.page import Page
from reports.pages.rendering import render_page
from reports.run.store import Store
from reports.write.templates import anchor, headings
from tests.committed_rows import RESULTS
from tests.committed_rows import page_rows as whole
from tests.reports.test_any_rows import FROM_ROWS, cheap, undrawn, written
from tests.toys import Disc, Toy

__all__ = ["undrawn"]
MECHANISMS = tuple(page for page in FROM_ROWS if page.scenes)
FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
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


@cache
def run(source: str) -> tuple[dict, str]:
    """What a program's names are at its end, and what it printed; run once, whichever test asks."""
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
def test_no_method_is_told_by_its_settings_as_python_prints_them(page, undrawn):
    for text in texts(page).values():
        assert not re.search(r"\b(Pymunk|MuJoCo|Lagrange|Extended|Extrapolated)\(\w+=", text)


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
