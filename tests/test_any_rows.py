"""Every page can be read, whatever was run: any part of the rows of the committed results, and any of them failed."""

from __future__ import annotations

import inspect
import math
import random
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cache

import pytest

from engines import Unsupported
from reports.charts import theme
from reports.cli.selection import page_cells
from reports.grid.cells import Cell
from reports.grid.measure import Measurement, blank
from reports.grid.outcomes import Outcome
from reports.pages import observing
from reports.pages.catalogue import PAGES
from reports.pages.errata import errata_engines as referees
from reports.pages.page import Material, Page
from reports.pages.rolling import charts as rolling_charts
from reports.pages.rolling import drawings as rolling_drawings
from reports.pages.rolling import page as rolling
from reports.pages.rolling.experiments import polygon_cells, softness_cells
from reports.pages.scaling import page as scaling
from reports.pages.skate import experiments as skate_failures
from reports.pages.wheels import experiments as wheels_failures
from reports.text.rendering import environment, render_index, render_page, render_readme
from reports.text.unmeasured import FILTERS, MARK, UNMEASURED, WORDS, Known, without_marks
from tests.committed_rows import RESULTS, committed_rows
from tests.toys import Plain

SUBSETS = 16  # of every page
FAILED = [outcome for outcome in Outcome if not outcome.comparable]
NUMBERS = [f.name for f in fields(Measurement) if f.type == "float" and f.name != "step"]
FROM_ROWS = tuple(page for page in PAGES if page_cells(page))  # the two others are computed when they are written
# The pictures of the others show the truth alone, with trajectories over it that no row holds.
DRAWN_FROM_ROWS = ("skate", "rolling", "scaling")

# Some errors stay and others fall: only of those that stay can a sentence say where.
PLATEAU = ("however small the step", "at every step", "(plateau ")

Rows = Mapping[Cell, Measurement]


@cache
def whole(page: Page) -> Rows:
    return committed_rows(page_cells(page))


def some(rows: Rows, chance: random.Random) -> Rows:
    """A part of the rows: single ones, engines, variants, scenes, steps and purposes taken away, others failed."""
    kept = dict(rows)
    for of in (
        lambda cell: cell.engine.name,
        lambda cell: cell.engine.variant,
        lambda cell: cell.scene.name,
        lambda cell: cell.every,
        lambda cell: cell.purpose,
    ):
        if kept and chance.random() < 0.3:
            gone = of(chance.choice(list(kept)))
            kept = {cell: row for cell, row in kept.items() if of(cell) != gone}
    share = chance.choice([0.0, 0.1, 0.5, 0.9, 0.99])
    kept = {cell: row for cell, row in kept.items() if chance.random() >= share}
    failing, unknown = chance.choice([0.0, 0.1, 0.7, 1.0]), chance.choice([0.0, 0.0, 0.3])
    for cell, row in kept.items():
        if chance.random() < failing:
            kept[cell] = blank(cell, chance.choice(FAILED), chance.choice(["", "a reason"]))
        elif chance.random() < unknown:
            kept[cell] = replace(row, **dict.fromkeys(chance.sample(NUMBERS, 4), math.nan))
    return kept


def prose(text: str) -> str:
    """A page with a word for its lines of code, and for code among words."""
    return re.sub(r"`[^`\n]+`", "CODE", re.sub(r"^```.*?^```$", "CODE", text, flags=re.DOTALL | re.MULTILINE))


def complaints(page: str, files: Mapping[str, str]) -> list[str]:
    """What a reader would stumble over on a page, and on the data page beside it if there is one."""
    text = "\n".join(prose(files[name]) for name in (f"{page}.md", f"{page}_data.md") if name in files)
    sentences = "\n".join(line for line in text.splitlines() if not line.startswith("|"))
    found = [f"{word} in the text" for word in ("{{", "{%", MARK, WORDS) if word in text]
    found += [match[0] for match in re.finditer(r".*\b(nan|None|Undefined|Unmeasured)\b.*", text)]
    found += [f"torn sentence: {match[0]}" for match in re.finditer(r".*[\s(][,.;:)](\s.*|$)", sentences)]
    found += [f"nothing follows: {match[0]}" for match in re.finditer(r".*:\n\n+(#.*|\Z)", sentences)]
    found += [f"no number: {match[0]}" for match in re.finditer(r".*(?<!\|) - (rad|m|s|ms|N|off)\b.*", sentences)]
    shown = set(re.findall(r"\]\((\w+\.svg)\)", text))
    drawn = {name for name in files if name.endswith(".svg")}
    found += [f"picture without file: {name}" for name in shown - drawn]
    found += [f"file without picture: {name}" for name in drawn - shown]
    known = (
        {f"{page.name}.md" for page in PAGES}
        | {page.data_page for page in PAGES if page.scenes}
        | {"index.md", "errors.csv", "timings.csv", "descriptions.csv"}
    )
    found += [f"dead link: {name}" for name in set(re.findall(r"\]\((\w+\.(?:md|csv))[)#]", text)) - known]
    return found


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures are made of nothing, since drawing them is what costs; which there are is decided as always."""
    for module in [module for name, module in sys.modules.items() if name.startswith("reports")]:
        for name, value in list(vars(module).items()):
            if inspect.isfunction(value) and value.__annotations__.get("return") == "Figure":
                monkeypatch.setattr(module, name, lambda *arguments, **settings: None)
            elif value is theme.svg:
                monkeypatch.setattr(module, name, lambda figure, title: "<svg/>")
    monkeypatch.setattr(rolling_drawings, "roulettes", lambda: None)


@cache
def pictures_of_the_truth(page: Page) -> Mapping[str, str]:
    return dict.fromkeys(page.figures(Material({})), "<svg/>")


def cheap(page: Page) -> Page:
    """A page without what needs no rows and takes long: methods that are no engines, pictures of the truth alone."""
    quiet = tuple(replace(failure, observations=None) for failure in page.failures)
    if page.name in DRAWN_FROM_ROWS:
        return replace(page, failures=quiet)
    return replace(page, failures=quiet, figures=lambda material: pictures_of_the_truth(page))


def written(page: Page, rows: Rows) -> Mapping[str, str]:
    return render_page(page, Material(rows), "the command")


@pytest.mark.parametrize("page", FROM_ROWS, ids=lambda page: page.name)
def test_a_page_can_be_read_whatever_rows_it_is_written_from(page, undrawn):
    for seed in range(SUBSETS):
        rows = some(whole(page), random.Random(f"{page.name} {seed}"))
        assert complaints(page.name, written(cheap(page), rows)) == [], seed
    assert complaints(page.name, written(cheap(page), {})) == []
    failed = {cell: blank(cell, Outcome.FAILED, "RuntimeError: something") for cell in whole(page)}
    assert complaints(page.name, written(cheap(page), failed)) == []


@pytest.mark.parametrize("page", FROM_ROWS, ids=lambda page: page.name)
def test_charts_can_be_drawn_of_a_few_rows_and_of_unknown_numbers(page):
    """Really drawn: what is cheap to draw, since a chart of little is where axes and legends break."""
    chance, rows = random.Random(page.name), whole(page)
    few = {cell: rows[cell] for cell in chance.sample(list(rows), 12)}
    for cell in list(few)[::2]:
        few[cell] = replace(few[cell], **dict.fromkeys(chance.sample(NUMBERS, 6), math.nan))
    for name, text in written(replace(cheap(page), figures=lambda material: {}), few).items():
        assert not name.endswith(".svg") or text.startswith("<?xml")


def test_the_charts_of_experiments_can_be_drawn_of_a_few_rows_and_of_failed_ones():
    chance = random.Random(0)
    rows = whole(rolling.PAGE)
    corners = [(value, rows[cell]) for value, cell in polygon_cells()]
    constants = [(value, rows[cell]) for value, cell in softness_cells()]
    chains = whole(scaling.PAGE)
    for count in (1, 4):
        few = [chance.sample(own, count) for own in (corners, constants)]
        failed = [[(value, replace(row, angle=math.nan)) for value, row in own] for own in few]
        assert theme.svg(rolling_charts.draw_plateaus(*few), "few")
        assert theme.svg(rolling_charts.draw_plateaus(*failed), "failed")
        some_chains = {cell: chains[cell] for cell in chance.sample(list(chains), count)}
        for own in (some_chains, {cell: blank(cell, Outcome.TIMED_OUT) for cell in some_chains}):
            assert scaling.figures(Material(own))


def test_the_overview_can_be_read_whatever_was_run():
    for seed in range(4):
        materials = {page: Material(some(whole(page), random.Random(f"{page.name} {seed}"))) for page in FROM_ROWS}
        text = render_index(materials.items(), "the command")
        assert complaints("index", {"index.md": text}) == [], seed
        readme = render_readme((RESULTS.parents[1] / "README.md").read_text(encoding="utf-8"), materials)
        assert "nan" not in readme


@pytest.mark.parametrize("page", FROM_ROWS, ids=lambda page: page.name)
def test_with_every_row_every_clause_stands(page, undrawn, monkeypatch):
    vanished: list[str] = []

    def kept(clause: str) -> str:
        if MARK in clause and not any(words in clause for words in PLATEAU):
            vanished.append(clause)
        return "" if MARK in clause else clause

    monkeypatch.setitem(FILTERS, "if_measured", kept)
    assert complaints(page.name, written(cheap(page), whole(page))) == []
    assert vanished == []


@pytest.mark.parametrize(
    ("template", "said"),
    [
        ("{{ row.angle | number }}", WORDS),
        ("{{ row.cpu | milliseconds }}", WORDS),
        ("{{ (1e3 * row.step / row.other.step) | number }}", WORDS),
        ("{{ rows[3].step | number(3) }}", WORDS),
        ("{{ '%.2f' | format(row.order) }}", WORDS),
        ("{{ row }} {{ unknown }} {{ nothing }}", f"{WORDS} {WORDS} {WORDS}"),
        ("{% if row %}run{% else %}not run{% endif %}", "not run"),
        ("{% if row.points >= 2 %}many{% endif %}", ""),
        ("a{% filter if_measured %}: {{ row.angle | number }} rad{% endfilter %}.", "a."),
        ("a{% filter if_measured %}: {{ 0.25 | number }} rad{% endfilter %}.", "a: 0.25 rad."),
        (
            "a{% filter if_measured %}: 1{% filter if_measured %}, {{ row }}{% endfilter %}{% endfilter %}.",
            "a: 1.",
        ),
        ("a\n![A chart]({{ pictures.chart }})\nb", "a\nb"),
        ("a\n![A chart]({{ pictures.drawn }})\nb", "a\n![A chart](drawn.svg)\nb"),
    ],
)
def test_a_forgotten_guard_says_so_and_a_clause_without_its_number_vanishes(template, said):
    given = {
        "row": UNMEASURED,
        "rows": Known(),
        "unknown": math.nan,
        "nothing": None,
        "pictures": Known(drawn="drawn.svg"),
    }
    assert without_marks(environment().from_string(template).render(given)) == said


@pytest.mark.parametrize("raised", [RuntimeError("no such thing"), Unsupported("no such joint")])
def test_an_engine_that_fails_while_a_page_is_written_costs_its_own_line_alone(raised, monkeypatch):
    def fails(cell):
        raise raised

    monkeypatch.setattr(observing, "trajectory_of", fails)
    for observations in (skate_failures.backwards, skate_failures.slipping, wheels_failures.folding):
        told = observations()
        assert [seen for seen in told if "exact" in seen.method or "reference" in seen.method]
        lost = [seen for seen in told if "failed: RuntimeError: no such thing" in seen.outcome]
        assert bool(lost) == isinstance(raised, RuntimeError)


def test_a_referee_that_fails_is_named_and_the_others_rule():
    @dataclass(frozen=True)
    class Broken(Plain):
        name: str = "broken"
        variant: str = "engine"

        def build(self, mechanism, dt):
            raise RuntimeError("no such thing")

    lost: list[str] = []
    assert referees.rulings((Broken(),), lost) == ()
    assert len(lost) == len(referees.QUESTIONS)
    assert lost[0] == "broken engine failed where a disc rolls off a round hill: RuntimeError: no such thing"
    with pytest.raises(RuntimeError, match="no such thing"):
        referees.rulings((Broken(),))
