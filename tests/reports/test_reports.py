"""Rendering of invented rows, and the command line's answers to good and bad words."""

from __future__ import annotations

import csv
import io
import platform
import re
import xml.etree.ElementTree as xml
from dataclasses import replace
from importlib import metadata

import numpy as np
import pytest

from reports import __main__ as command_line
from reports.cli.selection import (
    choose_cells,
    shown_cells,
)
from reports.model import catalogue
from reports.model.catalogue import PAGES
from reports.model.cells import QUICK, Cell, sweep_cells
from reports.model.measure import measure
from reports.model.page import Failure, Material, Observation, Page
from reports.pages.rendering import render_all
from reports.plots.looks import SHADE_NAMES
from reports.plots.theme import DARK, LIGHT, SERIES, new_figure, settings, style_axes, svg
from tests.committed_rows import stale
from tests.reports.test_any_rows import undrawn
from tests.toys import FAILURES, Disc, FailingToy, Toy

__all__ = ["undrawn"]
ENGINES = (Toy(), Toy("soft", plateau=1e-3), FailingToy("unsupported"), FailingToy("tear"))
FAST_FAILURES = tuple(FailingToy(v) for v in FAILURES if v not in ("abort", "exit", "hang", "raise"))
LARGE = tuple(Cell(Disc(), Toy("default", factor=0.1), every, "large") for every in QUICK)
PAGE = Page(
    name="base",  # the template that the real pages extend
    title="Discs | and bars",
    lesson="One disc.",
    scenes=(Disc(),),
    engines=ENGINES,
    failures=(
        Failure(
            "Everything that fails",
            "It should turn.",
            tuple(Cell(Disc(), toy, 1, "failure") for toy in FAST_FAILURES),
            lambda material: [Observation("by hand", "none", "0.02 rad")],
        ),
        Failure("Many of them", "They should turn.", LARGE),
    ),
)


@pytest.fixture(scope="module")
def material():
    cells = (*sweep_cells(PAGE.scenes, PAGE.engines, QUICK), *PAGE.extra_cells())
    # Invented timings, so that the same rows are drawn twice.
    return Material({cell: replace(measure(cell, repeat=False), cpu=1e-3 * cell.every, build=1e-5) for cell in cells})


@pytest.fixture(scope="module")
def files(material):
    return render_all({PAGE: material}, "the command")


def test_every_table_has_as_many_cells_in_each_line_as_in_its_head(files):
    for name in ("base.md", "index.md"):
        lines = files[name].splitlines()
        heads = [i for i, line in enumerate(lines) if re.fullmatch(r"\|( -+:? \|)+", line)]
        assert heads
        for head in heads:
            assert lines[head - 1].startswith("|")
            bars = lines[head].count("|")
            following = head + 1
            while following < len(lines) and lines[following].startswith("|"):
                assert len(re.findall(r"(?<!\\)\|", lines[following])) == bars, lines[following]
                following += 1


def test_the_same_rows_give_the_same_bytes_and_other_timings_the_same_errors(material, files):
    assert render_all({PAGE: material}, "the command") == files
    slower = Material({cell: replace(row, cpu=2 * row.cpu, build=1.0) for cell, row in material.rows.items()})
    plain = replace(PAGE, figures=lambda material: {})
    assert render_all({plain: slower}, "the command")["errors.csv"] == files["errors.csv"]


def test_every_digest_in_the_errors_is_described(files):
    errors = list(csv.DictReader(io.StringIO(files["errors.csv"])))
    described = {row["digest"]: row["description"] for row in csv.DictReader(io.StringIO(files["descriptions.csv"]))}
    used = {row[name] for row in errors for name in ("parameters", "settings", "versions")}
    assert used == set(described)
    for row in errors:  # every row says what it was made with
        told = described[row["versions"]]
        assert told.startswith(f"Python {platform.python_version()}, numpy ")
        assert all(f"{name} {metadata.version(name)}" in told for name in ("scipy", *Toy().packages))
    assert any("(" in text for text in described.values())


def test_pictures_are_well_formed_and_every_colour_has_its_dark_counterpart(files):
    for name, text in files.items():
        if name.endswith(".svg"):
            xml.fromstring(text)
            sheet = text[text.index("<style>@media") : text.index("</style>")]
            drawing = text.replace(sheet, "")
            for kind, colour in set(re.findall(r"(fill|stroke): (#[0-9a-f]{6})", drawing)):
                assert f'[style*="{kind}: {colour}"]' in sheet, (name, kind, colour)
            assert DARK.paper in sheet
            assert "Date" not in text
            assert "/tmp" not in text


def test_a_title_beside_the_middle_and_other_words_without_a_colour_of_their_own_are_no_black_on_dark_paper():
    with settings():
        figure = new_figure(2.0, LIGHT)
        panel = figure.subplots()
        panel.set_title("an error", loc="left")
        style_axes(panel, LIGHT)
        panel.plot([1, 2], color=LIGHT.first, label="a line")
        figure.legend()
    words = re.findall(r"<text [^>]*>", svg(figure, "a picture"))
    assert len(words) > 5
    assert all("fill: " in each for each in words)


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_ink_can_be_read_on_every_paper_it_stands_on(theme):
    def luminance(colour: str) -> float:
        parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
        return float(np.dot([0.2126, 0.7152, 0.0722], linear))

    def contrast(one: str, other: str) -> float:
        low, high = sorted((luminance(one), luminance(other)))
        return (high + 0.05) / (low + 0.05)

    # Contrast as the web content guidelines define it: 4.5 for text, 3 for lines and marks.
    shades = (getattr(theme, role) for role in SHADE_NAMES)
    for ground in (theme.paper, *shades, theme.bad, theme.worse, theme.grid):
        assert contrast(theme.ink, ground) >= 4.5
    for mark in (*(getattr(theme, name) for name in SERIES), theme.quiet):
        assert contrast(mark, theme.paper) >= 3


def test_a_quick_run_has_the_failures_of_the_pages_and_a_full_one_the_large_ones_too():
    page = replace(PAGE, name="discs")
    quick = choose_cells((Disc(),), (*ENGINES, *FAST_FAILURES), (page,), full=False)
    full = choose_cells((Disc(),), (*ENGINES, *FAST_FAILURES, Toy(factor=0.1)), (page,), full=True)
    assert {cell.purpose for cell in quick} == {"sweep", "failure"}
    assert {cell.purpose for cell in full} == {"sweep", "usual", "failure", "large"}
    assert {cell.every for cell in choose_cells((Disc(),), ENGINES, (page,), False, every=[4])} == {4}


@pytest.mark.parametrize(
    ("words", "telling"),
    [
        (["run", "fuor_bar"], "four_bar"),
        (["run", "--engine", "pymonk"], "pymunk"),
        (["run", "--every", "0"], "greater than or equal to 1"),
        (["run", "--step", "0.0033"], "does not divide"),
        (["run", "--limit", "0"], "greater than zero"),
        (["show", "driven_four_bar"], "crosscheck run"),
        (["report"], "crosscheck run"),
        (["rnu"], "rnu"),
        (["run", "--nonsense"], "--nonsense"),
    ],
)
def test_bad_input_is_one_line_on_stderr_and_exit_status_2(words, telling, tmp_path, capfd):
    arguments = [*words, "--results", str(tmp_path)] if words[0] in ("run", "show", "report") else words
    with pytest.raises(SystemExit) as ending:
        command_line.main(arguments)
    out, err = capfd.readouterr()
    assert ending.value.code == 2
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert telling in err


def test_run_report_and_show_from_an_empty_folder(tmp_path, capfd, undrawn, at_home, monkeypatch):
    """One page of ours, without its pictures, which test_installations.py has drawn by an installation."""
    monkeypatch.setattr(catalogue, "PAGES", tuple(page for page in PAGES if page.name == "four_bar"))
    chosen = ["free_four_bar", "--engine", "lagrange", "--variant", "euler baumgarte"]
    for words in (["run", *chosen, "--every", "1"], ["report"], ["show", *chosen]):
        with pytest.raises(SystemExit) as ending:
            command_line.main([*words, "--results", str(tmp_path)])
        assert ending.value.code == 0
    out = capfd.readouterr().out
    assert "1 of 1 cells run" in out
    assert "lagrange euler baumgarte" in out
    assert {"index.md", "four_bar.md", "errors.csv", "timings.csv"} <= {path.name for path in tmp_path.iterdir()}


def test_no_published_row_is_of_other_numbers_or_settings_than_the_present_ones():
    found = stale(dict.fromkeys(cell for page in PAGES for cell in shown_cells(page)))
    assert found == [], f"{len(found)} cells have to be published anew: {', '.join(found[:5])}"
