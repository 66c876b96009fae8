"""Ten findings from the committed rows: each number is a row's, and a claim that its rows contradict is not made."""

from __future__ import annotations

import re
import xml.etree.ElementTree as xml
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from reports.model.catalogue import PAGES
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.pages.findings.finding import LOOKS, MILLISECOND, TENTH, WIDTH, Line, draw
from reports.pages.findings.findings import FINDINGS, findings, pictures
from reports.pages.index import SYMPTOMS
from reports.write.rows import Rows, own_rows
from reports.write.tables import number
from reports.write.templates import anchor, headings, link
from reports.write.unmeasured import MARK
from tests.committed_rows import RESULTS, page_rows
from tests.rows import falling, row_of

NAMES = [find.__name__ for find in FINDINGS]


TAUGHT = tuple(page for page in PAGES if page.name in ("four_bar", "pendulum", "person", "skate", "rolling"))


def changed(change):
    """The pages' material, each row as `change(cell, row)` gives it; None leaves it out."""
    return {
        page: Material({cell: new for cell, row in page_rows(page).items() if (new := change(cell, row)) is not None})
        for page in TAUGHT
    }


@cache
def told():
    return {found.name: found for found in findings(changed(lambda cell, row: row))}


def test_the_committed_rows_bear_all_ten_out():
    assert list(told()) == NAMES
    assert len(NAMES) == 10
    assert len({found.title for found in told().values()}) == 10


def stored(scene, method, every, field, purpose="sweep"):
    """One number of the committed rows."""
    (row,) = (
        row
        for page in TAUGHT
        for row in page_rows(page).values()
        if (row.scene, row.method, row.every, row.purpose) == (scene, method, every, purpose)
    )
    return getattr(row, field)


def person(count, every, field):
    return stored("person_one_foot", f"pymunk {count} sweeps, all of the gap", every, field, "failure")


def crank(variant, every):
    return stored("driven_four_bar", f"mujoco {variant}", every, "angle", "failure")


def free(method, field="angle"):
    return stored("free_four_bar", method, 10, field)


def test_its_numbers_are_those_of_the_rows_that_it_names():
    energies = [stored("pendulum_1", name, 10, "energy") for name in ("pymunk default", "pymunk tuned", "mujoco tuned")]
    overwritten = "default, overwritten crank"
    numbers = {
        "spring": [free("mujoco tuned")],
        "tuned": [free(f"{engine} default") / free(f"{engine} tuned") for engine in ("pymunk", "mujoco")],
        "luck": [stored("spinning_four_bar", "mujoco default", 10, "angle")],
        "reading": [free("pymunk leapfrog"), free("pymunk tuned")],
        "energy": [100 * energy for energy in energies],
        "iterations": [person(10, 1, "angle"), person(10, 10, "angle"), person(20, 10, "angle")],
        "forces": [person(20, 10, "angle"), *(100 * person(count, 10, "reaction") for count in (20, 100))],
        "skate": [stored("sleigh", f"pymunk {v}", n, "position") for v, n in (("default", 1), ("tuned", 10))],
        "crank": [
            crank(overwritten, 10),
            crank(overwritten, 100),
            crank("tuned, overwritten crank", 10),
            crank("tuned", 10),
        ],
        "contact": [stored("rolling_ellipse", "mujoco extended", 10, "angle")],
    }
    assert set(numbers) == set(NAMES)
    for name, values in numbers.items():
        for value in values:
            assert re.search(rf"(?<![\d.]){re.escape(number(value))}(?![\d.e])", told()[name].text), (
                name,
                number(value),
            )


@pytest.mark.parametrize(
    ("name", "scene", "method", "quantity"),
    [
        ("spring", "free_four_bar", "mujoco RK4 alone", "angle"),
        ("luck", "spinning_four_bar", "mujoco default", "angle"),
        ("contact", "rolling_ellipse", "pymunk tuned", "angle"),
        ("contact", "rolling_ellipse", "mujoco default", "angle"),
    ],
)
def test_the_limit_that_it_tells_is_near_the_finest_error(name, scene, method, quantity):
    rows = own_rows(changed(lambda cell, row: row)).of(scene, method)
    limit, finest = rows.sweep(quantity).plateau, rows[-1]
    assert number(limit) in told()[name].text
    # All of these end flat: half a decade changes them by less than a twentieth.
    assert getattr(finest, quantity) == pytest.approx(limit, rel=0.05)


def times(factor, *fields, scene, method, purpose="sweep", steps=lambda step: True):
    """Rows of one method with some errors multiplied."""

    def change(cell, row):
        if (row.scene, row.method, row.purpose) == (scene, method, purpose) and steps(row.step):
            return replace(row, **{field: factor * getattr(row, field) for field in fields})
        return row

    return change


def falls(scene, method, field):
    """Rows of one method with an error that falls with the step."""
    return lambda cell, row: replace(row, **{field: row.step}) if (row.scene, row.method) == (scene, method) else row


def at(wanted):
    return lambda step: abs(step - wanted) < 0.01 * wanted


FREE = {"scene": "free_four_bar"}
PERSON = {
    count: {"scene": "person_one_foot", "method": f"pymunk {count} sweeps, all of the gap", "purpose": "failure"}
    for count in (10, 20)
}
CRANK = {"scene": "driven_four_bar", "purpose": "failure"}


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("spring", falls("free_four_bar", "mujoco default", "angle")),
        ("spring", falls("free_four_bar", "mujoco RK4 alone", "angle")),
        ("spring", falls("free_four_bar", "mujoco RK4 alone", "gap")),
        ("spring", times(1.2, "angle", **FREE, method="mujoco RK4 alone")),
        ("spring", times(1.2, "gap", **FREE, method="mujoco RK4 alone")),
        ("spring", times(100.0, "angle", **FREE, method="mujoco tuned")),
        ("tuned", times(1e6, "angle", **FREE, method="mujoco tuned", steps=at(MILLISECOND))),
        ("tuned", times(3.0, "angle", **FREE, method="pymunk tuned", steps=at(MILLISECOND))),
        ("luck", falls("spinning_four_bar", "mujoco default", "angle")),
        ("luck", times(4.0, "angle", scene="spinning_four_bar", method="mujoco default", steps=at(MILLISECOND))),
        ("reading", falls("free_four_bar", "pymunk leapfrog", "angle")),
        ("reading", times(10.0, "angle", **FREE, method="pymunk leapfrog")),
        ("energy", times(0.1, "energy", scene="pendulum_1", method="pymunk default")),
        ("energy", times(1e10, "energy", scene="pendulum_1", method="mujoco tuned")),
        ("iterations", times(0.1, "angle", **PERSON[10], steps=at(MILLISECOND))),
        ("iterations", times(10.0, "angle", **PERSON[20])),
        ("forces", times(1.1, "angle", **PERSON[20])),
        ("forces", times(0.2, "reaction", **PERSON[20])),
        ("skate", times(1e-2, "position", scene="sleigh", method="pymunk default", steps=at(1e-4))),
        ("skate", times(10.0, "position", scene="sleigh", method="pymunk tuned")),
        ("crank", times(0.1, "angle", **CRANK, method="mujoco default, overwritten crank", steps=at(TENTH))),
        ("crank", times(1e-3, "angle", **CRANK, method="mujoco tuned, overwritten crank")),
        ("crank", times(100.0, "angle", **CRANK, method="mujoco tuned")),
        ("contact", falls("rolling_ellipse", "mujoco default", "angle")),
        ("contact", falls("rolling_ellipse", "pymunk tuned", "angle")),
        ("contact", times(1e3, "angle", scene="rolling_ellipse", method="mujoco extended")),
    ],
)
def test_a_finding_that_its_rows_contradict_is_not_told(name, wrong):
    (find,) = (find for find in FINDINGS if find.__name__ == name)
    assert not find(own_rows(changed(wrong))).told


ABOUT = {
    "free_four_bar": ("spring", "tuned", "reading"),
    "spinning_four_bar": ("luck",),
    "driven_four_bar": ("crank",),
    "pendulum_1": ("energy",),
    "person_one_foot": ("iterations", "forces"),
    "sleigh": ("skate",),
    "rolling_ellipse": ("contact",),
}


@pytest.mark.parametrize("scene", ABOUT)
def test_without_a_scenes_rows_its_findings_are_not_told_and_the_others_stay(scene):
    left = findings(changed(lambda cell, row: None if row.scene == scene else row))
    assert {found.name for found in left} == {name for name in NAMES if name not in ABOUT[scene]}
    assert all(MARK not in found.title + found.text for found in left)


def test_without_any_rows_or_with_failed_ones_alone_nothing_is_told():
    assert findings(changed(lambda cell, row: None)) == []
    assert findings({}) == []
    failed = findings(changed(lambda cell, row: replace(row, outcome=Outcome.TORN)))
    # Errors of failed runs may still speak of energy: a pendulum that is off by a radian has lost what it has lost.
    assert {found.name for found in failed} <= {"energy"}


def test_without_timings_no_cost_is_told():
    untimed = findings(changed(lambda cell, row: replace(row, cpu=0.0)))
    assert "tuned" not in [found.name for found in untimed]


def test_each_picture_is_legible_on_a_telephone_and_in_the_dark_and_has_every_line_with_its_label():
    files = pictures(told().values())
    assert sorted(files) == sorted(found.picture for found in told().values())
    for found in told().values():
        text = files[found.picture]
        root = xml.fromstring(text)
        assert float(root.attrib["width"].removesuffix("pt")) == 72 * WIDTH == 270  # 360 pixels
        assert "prefers-color-scheme: dark" in text
        assert found.title in text
        figure = draw(found.lines, found.quantity)
        (axes,) = figure.axes
        assert [line.get_label() for line in axes.lines] == [line.label for line in found.lines]
        assert all(np.size(line.get_xdata()) >= 2 for line in axes.lines), found.name
        sizes: list[Any] = [text.get_fontsize() for text in (*figure.legends[0].get_texts(), *axes.get_xticklabels())]
        assert min(sizes) >= 8  # points, at 360 pixels: nothing is scaled down
        assert all(line.label in found.alternative for line in found.lines)


def test_lines_differ_without_colours():
    assert len({(look["linestyle"], look["marker"]) for look in LOOKS}) == len(LOOKS)
    steps = [Line(name, Rows(falling(f"pymunk {name}", (1e-2, 1e-3)))) for name in "abcd"]
    (axes,) = draw(steps, "angle").axes
    assert [np.asarray(line.get_xdata()).tolist() for line in axes.lines] == [[100.0, 10.0]] * 4
    assert [np.asarray(line.get_ydata()).tolist() for line in axes.lines] == [[1e-2, 1e-3]] * 4
    assert len({line.get_color() for line in axes.lines}) == 1  # one engine, one colour
    with pytest.raises(ValueError, match="5 lines"):
        draw([*steps, Line("e", Rows())], "angle")


def test_a_failed_run_stands_in_a_picture_and_an_unknown_error_does_not():
    rows = [row_of("pymunk a", step=1e-2, angle=3.0, outcome=Outcome.SATURATED), row_of("pymunk a", angle=float("nan"))]
    (axes,) = draw([Line("a", Rows(rows))], "angle").axes
    assert [np.asarray(line.get_ydata()).tolist() for line in axes.lines] == [[3.0]]


# --- symptoms and links ---

FILES = {path.name: path.read_text(encoding="utf-8") for path in RESULTS.glob("*.md")}


@pytest.mark.parametrize("symptom", SYMPTOMS, ids=lambda symptom: symptom.seen[:30])
def test_a_symptom_leads_to_a_section_that_is_there(symptom):
    address = link(symptom.page, symptom.heading, FILES)
    name, _, place = address.partition("#")
    assert name in FILES
    assert not symptom.heading or place in {anchor(heading) for heading in headings(FILES[name])}


def test_a_link_is_to_the_page_then_to_one_beside_it_then_to_the_page_without_a_place():
    files = {"b_data.md": "## First\n\n### Second, with `code`!\n", "b.md": "# B\n\n## First\n", "c.md": "## Third\n"}
    assert link("b", "First", files) == "b.md#first"
    assert link("b", "Second, with `code`!", files) == "b_data.md#second-with-code"
    assert link("b", "Third", files) == "b.md"
    assert link("b", "", files) == "b.md"


def test_a_comment_in_code_is_no_heading():
    assert headings("# A\n\n```\n# no heading\n```\n\n## B\n") == ("A", "B")
