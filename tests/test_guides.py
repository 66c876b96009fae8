"""The guides: glossary, reactions, integrators. Their numbers are stored rows, and their programs run."""

from __future__ import annotations

import contextlib
import io
import math
import re
from dataclasses import replace

import pytest

from reports.cli.selection import choose_cells, page_cells
from reports.pages.guides.page import EVERY, PAGES, SCENES, VARIANTS
from reports.pages.page import Material
from reports.text.rendering import render_page
from tests.committed_rows import page_rows

GLOSSARY, REACTIONS, INTEGRATORS = PAGES
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FOOT = re.compile(r"^---\n.*", re.DOTALL | re.MULTILINE)
MEASURED = re.compile(r"\d\.\d|\de-\d")

named = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


def text_of(page, rows) -> str:
    (text,) = render_page(page, Material(rows), "the command").values()
    return text


def prose(text: str) -> str:
    """A page without its programs and its last line, which names versions."""
    return FOOT.sub("", BLOCK.sub("", text))


@named
def test_without_rows_a_guide_has_no_number_that_was_measured(page):
    text = prose(text_of(page, {}))
    assert not MEASURED.search(text)
    assert "not measured" not in text
    assert not re.search(r"\b(nan|None|Unmeasured)\b", text)


@pytest.mark.parametrize("page", [REACTIONS, INTEGRATORS], ids=lambda page: page.name)
def test_every_number_of_a_guide_is_that_of_a_row(page):
    """Rows with other errors make other numbers: none is typed."""
    rows = page_rows(page)
    shown = MEASURED.findall(prose(text_of(page, rows)))
    assert len(shown) > 20
    unknown = {cell: replace(row, angle=math.nan, reaction=math.nan, cpu=math.nan) for cell, row in rows.items()}
    assert not MEASURED.search(prose(text_of(page, unknown)))


@pytest.mark.parametrize("page", [REACTIONS, INTEGRATORS], ids=lambda page: page.name)
def test_every_clause_of_a_guide_has_its_committed_rows(page):
    text = text_of(page, page_rows(page))
    said = (
        ["pymunk as shipped has"] if page is REACTIONS else ["measured order is", "half a step of velocity", "here 0"]
    )
    assert [words for words in said if words not in text] == []


def test_the_rows_of_guides_are_at_a_millisecond():
    for scene in SCENES:
        assert scene.spacing / EVERY == pytest.approx(1e-3, rel=0.05)


def test_guides_read_the_rows_of_other_pages_and_have_nothing_run():
    assert page_cells(REACTIONS) == REACTIONS.borrowed
    assert REACTIONS.borrowed
    chosen = choose_cells(SCENES, VARIANTS, PAGES, full=False)
    assert chosen == choose_cells(SCENES, VARIANTS, (), full=False)


@pytest.mark.parametrize("place", [0, 1], ids=["pymunk", "mujoco"])
def test_a_program_of_the_page_prints_the_weight_of_the_hanging_body(place):
    source = BLOCK.findall(text_of(REACTIONS, {}))[place]
    assert source.count("\n") <= 20
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(source, "a page", "exec"), {"__name__": "__main__"})
    assert said.getvalue().count("19.62") == 2  # 2 kg at 9.81 m/s^2: by Newton's law, and by what the engine says
    assert "-19.62" not in said.getvalue()


def test_the_glossary_has_a_sentence_for_each_of_its_words():
    entries = re.findall(r"^- \*\*(.+?)\*\*.*?: ?(.+)$", text_of(GLOSSARY, {}), re.MULTILINE)
    assert len(entries) >= 25
    assert len({word.lower() for word, _ in entries}) == len(entries)
