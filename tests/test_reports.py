"""Rendering of invented rows, and the command line's answers to good and bad words."""

from __future__ import annotations

import csv
import io
import math
import platform
import re
import xml.etree.ElementTree as xml
from dataclasses import replace
from importlib import metadata

import numpy as np
import pytest
from jinja2 import UndefinedError

from reports import __main__ as command_line
from reports.cli.selection import (
    BadInput,
    choose_cells,
    choose_engines,
    choose_scenes,
    nearest,
    shown_cells,
    steps_per_sample,
)
from reports.model.catalogue import PAGES
from reports.model.cells import QUICK, Cell, sweep_cells
from reports.model.convergence import judged
from reports.model.measure import TIMINGS, measure
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation, Page
from reports.pages.rendering import render_all
from reports.plots import work_precision as charts
from reports.plots.theme import DARK, LIGHT, SERIES, svg
from reports.write.templates import environment
from tests import test_any_rows as rendering
from tests.committed_rows import stale
from tests.toys import FAILURES, Disc, FailingToy, Toy

undrawn = rendering.undrawn  # pytest finds a fixture by its name in the module

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


def test_the_page_tells_failures_models_and_how_it_was_made(files):
    page = files["base.md"] + files["base_data.md"]
    for word in ("# Discs", "it has no pins", "**torn**", "by hand", "0.02 rad", "the command", "numpy"):
        assert word in page
    assert "mass is -1; it must be greater than zero" in page
    assert "plateau **" in page


def test_every_picture_of_a_page_is_among_the_files_and_the_other_way_round(files):
    shown = set(re.findall(r"\]\((\w+\.svg)\)", files["base.md"]))
    assert shown == {name for name in files if name.endswith(".svg")}
    assert {"base_work.svg", "base_steps.svg"} == shown


def test_every_table_has_as_many_cells_in_each_line_as_in_its_head(files):
    for name in ("base.md", "base_data.md", "index.md"):
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


def test_the_same_rows_give_the_same_bytes(material, files):
    again = render_all({PAGE: material}, "the command")
    assert again == files


def test_errors_have_no_timing_in_them_and_timings_say_where_they_were_taken(files):
    errors = list(csv.DictReader(io.StringIO(files["errors.csv"])))
    assert not set(TIMINGS) & set(errors[0])
    timings = files["timings.csv"].splitlines()
    assert any("processors" in line for line in timings if line.startswith("#"))
    body = list(csv.DictReader(line for line in timings if not line.startswith("#")))
    assert len(body) == len(errors)
    assert float(body[0]["cpu"]) > 0


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


def test_errors_do_not_change_when_timings_do(material, files):
    slower = Material({cell: replace(row, cpu=2 * row.cpu, build=1.0) for cell, row in material.rows.items()})
    assert render_all({PAGE: slower}, "the command")["errors.csv"] == files["errors.csv"]


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


def test_no_two_roles_of_a_theme_share_a_colour():
    for theme in (LIGHT, DARK):
        assert len(set(vars(theme).values())) == len(vars(theme))


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
    for ground in (theme.paper, theme.good, theme.middling, theme.bad, theme.worse, theme.grid):
        assert contrast(theme.ink, ground) >= 4.5
    for mark in (*(getattr(theme, name) for name in SERIES), theme.quiet):
        assert contrast(mark, theme.paper) >= 3


def test_a_chart_without_any_row_is_not_an_error_and_failed_rows_are_not_drawn(material):
    failed = [row for row in material.rows.values() if not Outcome(row.outcome).comparable]
    assert svg(charts.error_against_step(failed), "nothing")
    assert svg(charts.work_precision([], theme=LIGHT), "nothing")


def test_a_template_that_names_what_is_not_given_fails():
    with pytest.raises(UndefinedError):
        environment().from_string("{{ nothing }}").render()


def test_judging_upgrades_sweeps_and_leaves_failures_alone(material):
    found = {(row.purpose, row.variant, row.outcome) for row in judged(material.rows.values())}
    assert ("sweep", "default", Outcome.CONVERGED) in found
    assert ("sweep", "soft", Outcome.PLATEAU) in found
    assert ("failure", "tear", Outcome.TORN) in found


def test_unknown_words_are_refused_with_the_nearest_known():
    scenes, engines = (Disc(),), (Toy(), Toy("tuned"))
    with pytest.raises(BadInput, match="unknown scene 'dsic': did you mean 'disc'"):
        choose_scenes(["dsic"], scenes, ())
    with pytest.raises(BadInput, match="unknown engine 'tyo': did you mean 'toy'"):
        choose_engines("tyo", None, engines)
    with pytest.raises(BadInput, match="unknown variant of toy 'tunde': did you mean 'tuned'"):
        choose_engines("toy", "tunde", engines)
    assert "there are alpha, beta" in str(nearest("scene", "zzz", ["alpha", "beta"]))
    assert choose_scenes(["discs"], scenes, (replace(PAGE, name="discs"),)) == scenes
    assert choose_engines("toy", None, engines) == engines


def test_steps_must_divide_the_sampling():
    scene = Disc()
    assert steps_per_sample(scene, scene.spacing / 7) == 7
    with pytest.raises(BadInput, match=r"does not divide .* --every 3"):
        steps_per_sample(scene, scene.spacing / 3.1)
    for step in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(BadInput, match="greater than zero"):
            steps_per_sample(scene, step)


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
        (["run", "--variant", "tunde"], "tuned"),
        (["run", "--every", "0"], "greater than or equal to 1"),
        (["run", "--every", "2.5"], "--every"),
        (["run", "--step", "0.0033"], "does not divide"),
        (["run", "--step", "-1"], "greater than zero"),
        (["run", "--step", "nan"], "greater than zero"),
        (["run", "--limit", "0"], "greater than zero"),
        (["show", "driven_fourbar"], "driven_four_bar"),
        (["show", "driven_four_bar"], "crosscheck run"),
        (["report"], "crosscheck run"),
        (["bench", "fuor_bar"], "four_bar"),
        (["rnu"], "rnu"),
        (["show"], "scene"),
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


def test_run_report_and_show_from_an_empty_folder(tmp_path, capfd, undrawn):
    """Without its pictures, which test_third_party.py has drawn by an installation."""
    chosen = ["driven_four_bar", "--engine", "lagrange", "--variant", "euler baumgarte"]
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
