"""Tests of the rendering of invented rows, and of numbers that keep their published text."""

from __future__ import annotations

import csv
import math
import re
import xml.etree.ElementTree as xml
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from reports.cli.report import moving_picture
from reports.gate.theory import cases
from reports.model.catalogue import PAGES
from reports.model.cells import QUICK, Cell, sweep_cells
from reports.model.convergence import Verdict
from reports.model.ending import BadInput
from reports.model.measure import measure
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation, Page
from reports.model.quantities import OF, QUANTITIES, agrees, quantity
from reports.model.tasks import Answer, Task
from reports.pages.four_bar.page import MOVING_METHODS, MOVING_TASKS
from reports.pages.index import render_readme
from reports.pages.rendering import render_all, render_page
from reports.pages.your_loop.page import FRESH, PASTED_CELLS
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.plots.theme import DARK
from reports.write import csv_files
from reports.write.provenance import machine
from reports.write.rows import lookups
from reports.write.templates import environment, marks
from reports.write.unmeasured import NOT_MEASURED, UNMEASURED, MissingAsNaN, without_marks
from tests.rows import ROW, falling, row_of
from tests.toys import FAILURES, Disc, FailingToy, OtherDisc, Toy

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
    # The timings are invented, so that a picture is the same each time.
    return Material({cell: replace(measure(cell, repeat=False), cpu=1e-3 * cell.every, build=1e-5) for cell in cells})


@pytest.fixture(scope="module")
def files(material):
    return render_all({PAGE: material}, "the command")


def test_every_table_has_as_many_cells_in_each_line_as_in_its_head(files):
    for name in ("base.md", "index.md"):
        blocks = re.findall(r"(?:^\|.*\n)+", files[name], re.MULTILINE)
        assert blocks
        for block in blocks:
            lines = block.splitlines()
            assert re.fullmatch(r"\|( -+:? \|)+", lines[1])
            assert len({len(re.findall(r"(?<!\\)\|", line)) for line in lines}) == 1, block


def test_the_same_rows_give_the_same_bytes_and_other_timings_the_same_errors(material, files):
    assert render_all({PAGE: material}, "the command") == files
    slower = Material({cell: replace(row, cpu=2 * row.cpu, build=1.0) for cell, row in material.rows.items()})
    plain = replace(PAGE, figures=lambda material: {})
    assert render_all({plain: slower}, "the command")["errors.csv"] == files["errors.csv"]


def test_pictures_are_well_formed_and_every_colour_has_its_dark_counterpart(files):
    for name, text in files.items():
        if name.endswith(".svg"):
            xml.fromstring(text)
            sheet = text[text.index("<style>@media") : text.index("</style>")]
            for kind, colour in set(re.findall(r"(fill|stroke): (#[0-9a-f]{6})", text.replace(sheet, ""))):
                assert f'[style*="{kind}: {colour}"]' in sheet, (name, kind, colour)
            assert DARK.paper in sheet
            assert all("fill: " in text_value for text_value in re.findall(r"<text [^>]*>", text)), name
            assert not re.search("Date|/tmp", text)


README = "\n".join(marks("loop"))


DISC, OTHER = Disc(), OtherDisc()
DISCS = Page("base", "Discs", "One disc.", (DISC, OTHER), (Toy(),))
CELLS = {
    Cell(scene, Toy(variant), every): row_of(
        f"mujoco {variant}", scene=scene.name, every=every, step=0.1 / every, angle=angle / every**2, cpu=angle
    )
    for scene, factor in ((DISC, 1.0), (OTHER, 0.1))
    for variant, angle in (("default", 1.1e-2 * factor), ("tuned", 1.3e-3 * factor))
    for every in (1, 10, 100)
}


def test_lookups_return_the_rows_of_their_scene_and_method():
    text = lookups(Material(CELLS), (DISC, OTHER))
    method = ("other_disc", "mujoco", "tuned")
    assert text["best"](*method).angle == text["sweep"](*method).best == pytest.approx(1.3e-8)
    assert text["sweep"](*method).verdict == Verdict.FALLS
    at = text["at"]("disc", "mujoco", "tuned", 10)
    assert (at.scene, at.variant, at.every) == ("disc", "tuned", 10)
    assert text["ended"]("disc", "mujoco", "tuned") == ["finished"]
    only = lookups(Material(CELLS), (OTHER,))
    assert only["best"]("disc", "mujoco", "default") is text["at"]("disc", "mujoco", "tuned", 7) is UNMEASURED


def test_convergence_on_a_page_is_that_of_its_quantity():
    errors = falling("mujoco default", (1e-2, 3e-5, 3e-5, 3e-5), "position")
    errors = [replace(r, angle=1e-2 * r.step**2) for r in errors]
    rows = {Cell(DISC, Toy(), 10**i): r for i, r in enumerate(errors)}
    for name, text_value in (("position", "plateau **3e-5**"), ("angle", "2.00 (±")):
        page = replace(DISCS, scenes=(DISC,), quantity=name)
        text = render_page(page, Material(rows), "the command")["base.md"]
        assert text_value in next(line for line in text.splitlines() if line.startswith("| mujoco default"))


def test_the_readme_has_medians_of_fresh_mechanisms_and_does_not_depend_on_timings():
    def readme(median: float, cpu: float) -> list[str]:
        rows = {pasted_cell: row_of("mujoco tuned", angle=3.4e-7, cpu=cpu) for pasted_cell in PASTED_CELLS}
        error = {"error": np.array([1e-9, median, 0.3])}
        answers: dict[Task, Answer] = {task: Answer(Outcome.FINISHED, values=error) for task in FRESH}
        return render_readme(README, {YOUR_LOOP: Material(rows, answers)}).split()

    text = " ".join(readme(2.5e-6, 1.0))
    assert text.count("2.5e-6 rad (1e-9 to 0.3) with these lines") == 2
    assert "3.4e-7" not in text
    assert readme(2.5e-6, 7.0) == readme(2.5e-6, 1.0) != readme(2.5e-3, 1.0)


def test_all_files_end_with_one_end_of_line_and_have_every_row_once():
    keyed = {cell: replace(r, key=str(i)) for i, (cell, r) in enumerate(CELLS.items())}
    files = render_all({DISCS: Material(keyed), replace(DISCS, title="Again"): Material(keyed)}, "the command")
    assert all(text.endswith("\n") and not text.endswith("\n\n") for text in files.values())
    for name in ("errors.csv", "timings.csv"):
        result = csv.DictReader(line for line in files[name].splitlines() if not line.startswith("#"))
        assert sorted((r["scene"], r["variant"], r["every"]) for r in result) == sorted(
            (r.scene, r.variant, str(r.every)) for r in CELLS.values()
        )


def test_an_experiment_has_its_own_rows_and_observations():
    torn, sound = (Cell(DISC, Toy(name), 1, "failure") for name in ("torn", "sound"))
    rows = {
        torn: row_of("mujoco torn", outcome=Outcome.TORN, sentence="it tore", gap=1.7, step=0.1),
        sound: row_of("mujoco sound", sentence="", step=0.1),
    }
    first = Failure("First", "It should turn.", (torn,), lambda material: [Observation("by hand", "a way", "0.02 rad")])
    second = Failure("Second", "So should this.", (sound,), columns=("energy",))
    page = replace(DISCS, scenes=(DISC,), failures=(first, second))
    text = render_page(page, Material(rows), "the command")["base.md"]
    first, second = (text.split(f"### {name}")[1].split("\n## ")[0].split("\n### ")[0] for name in ("First", "Second"))
    for text_value in ("| mujoco torn | **torn** 1.7 m |", "| by hand | a way | 0.02 rad |"):
        assert (text_value in first, text_value in second) == (True, False)
    assert "| mujoco sound | 100 ms | 5.3e-3 |" in second


def test_the_animation_of_the_readme_is_small_and_respects_reduced_motion():
    answers: dict[Task, Answer] = {task: Answer(Outcome.FINISHED, "", task.run()) for task in MOVING_TASKS}
    (text,) = moving_picture([Material({}), Material({}, answers)]).values()
    assert len(text.encode()) < 300_000
    still_part, moving_part = text.split("@media (prefers-reduced-motion: no-preference) {")
    assert ("@keyframes" in still_part, "(prefers-color-scheme: dark)" in still_part) == (False, True)
    # Three bars move in the exact motion and in the motion of each method in MOVING_METHODS.
    assert len(re.findall(r"@keyframes m\d+b\d+\{", moving_part)) == 3 * (len(MOVING_METHODS) + 1)
    assert moving_picture([Material({}, dict(list(answers.items())[1:]))]) == {}


@pytest.mark.parametrize(
    ("template", "said"),
    [
        ("{{ row.angle | number }}", NOT_MEASURED),
        ("{{ (1e3 * row.step / row.other.step) | number }}", NOT_MEASURED),
        ("{{ row }} {{ unknown }} {{ nothing }}", f"{NOT_MEASURED} {NOT_MEASURED} {NOT_MEASURED}"),
        ("{% if row %}run{% else %}not run{% endif %}", "not run"),
        ("a{% filter if_measured %}: {{ row.angle | number }} rad{% endfilter %}.", "a."),
        ("a{% filter if_measured %}: 1{% filter if_measured %}, {{ row }}{% endfilter %}{% endfilter %}.", "a: 1."),
        ("a\n![A chart]({{ pictures.chart }})\nb", "a\nb"),
        ("a\n![A chart]({{ pictures.drawn }})\nb", "a\n![A chart](drawn.svg)\nb"),
    ],
)
def test_a_missing_number_is_marked_and_removes_its_clause(template, said):
    options = {
        "row": UNMEASURED,
        "rows": MissingAsNaN(),
        "unknown": math.nan,
        "nothing": None,
        "pictures": MissingAsNaN(drawn="drawn.svg"),
    }
    assert without_marks(environment().from_string(template).render(options)) == said


NAMES = tuple(quantity.name for quantity in QUANTITIES)
CELL = Cell(Disc(), Toy(), 1)


@cache
def numbers_of_two_processors() -> list[dict[str, str]]:
    text = Path(__file__).with_name("two_processors.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


@cache
def amplified() -> dict[tuple[str, str], float]:
    return {(case.scene.name, case.method): case.amplified for case in cases(PAGES)}


def test_the_numbers_of_two_processors_agree_with_either_as_the_baseline():
    assert {line["quantity"] for line in numbers_of_two_processors()} == {*NAMES}
    for line in numbers_of_two_processors():
        name, factor = line["quantity"], amplified()[line["scene"], line["method"]]
        first, second = float(line["one"]), float(line["other"])
        assert agrees(name, first, second, factor), line
        assert agrees(name, second, first, factor), line


@pytest.fixture
def before(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "errors.csv").write_text(csv_files.as_csv([ROW], timings=False))
    (tmp_path / "timings.csv").write_text(csv_files.as_csv([ROW], timings=True, header=f"a date\n{machine()}"))
    published = csv_files.read_published(tmp_path)
    assert (published.machine, published.engines) == (machine(), ("toy",))
    (texts,) = published.rows.values()
    return dict(texts)


@pytest.mark.parametrize("name", csv_files.ERROR_COLUMNS)
def test_an_error_keeps_its_published_text_only_within_rounding(name, before):
    published, rounding = getattr(ROW, name), quantity(OF.get(name, name)).rounding
    near, far = published + 0.9 * rounding, published * 1.0123456
    texts = [csv_files.with_published_numbers(replace(ROW, **{name: number}), before, True) for number in (near, far)]
    assert [getattr(row, name) for row in texts] == [published, float(f"{far:.4g}")]
    assert float(f"{far:.4g}") != published


@pytest.mark.parametrize(("name", "noise"), csv_files.TIMING_NOISE.items())
def test_a_time_is_kept_within_noise_and_on_the_same_machine(name, noise, before):
    published = getattr(ROW, name)
    within, beyond = (replace(ROW, **{name: published * factor}) for factor in (0.99 * noise, 1.01 * noise))
    for where, same in ((machine(), True), ("another machine", False)):
        of_run = csv_files.Published(
            {tuple(csv_files.cell_text(ROW, column) for column in csv_files.IDENTITY_COLUMNS): before}, where
        )
        assert (getattr(csv_files.as_published({CELL: within}, of_run)[CELL], name) == published) == same
    assert getattr(csv_files.with_published_numbers(beyond, before, True), name) != published


def test_a_new_row_or_a_changed_outcome_does_not_get_published_numbers(before):
    moved = replace(ROW, position=ROW.position * (1 + 1e-12), cpu=1.01 * ROW.cpu)
    torn = csv_files.with_published_numbers(replace(moved, outcome=Outcome.TORN), before, True)
    assert torn.cpu == csv_files.with_published_numbers(moved, {}, True).cpu == float(f"{1.01 * ROW.cpu:.4g}")
    assert torn.outcome == Outcome.TORN


def test_a_file_without_the_columns_of_rows_is_refused_by_name(tmp_path):
    (tmp_path / "errors.csv").write_text("scene,engine\na,b\n")
    with pytest.raises(BadInput, match=r"errors\.csv has no column 'variant'"):
        csv_files.read_published(tmp_path)
    assert not csv_files.read_published(tmp_path / "nowhere").rows
