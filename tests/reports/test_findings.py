"""Findings and the guides from the committed rows: each number is a row's, what its rows contradict is not said."""

# pyright: reportAttributeAccessIssue=false
from __future__ import annotations

import contextlib
import io
import math
import re
from dataclasses import replace
from functools import cache

import mujoco
import numpy as np
import pytest

from reports.model.catalogue import PAGES
from reports.model.outcomes import SATURATED, TORN, Outcome
from reports.model.page import Material
from reports.model.tasks import Answer, Task
from reports.pages import findings as module
from reports.pages.faults.page import OFFSETS
from reports.pages.findings import CPU, FINDINGS, LOOKS, STEP, TENTH, Known, Line, draw, findings, of_releases, of_rows
from reports.pages.guides.page import EVERY, FOUR_BAR
from reports.pages.guides.page import PAGES as GUIDES
from reports.pages.index import SYMPTOMS
from reports.pages.rendering import render_page
from reports.pages.versions.page import table
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.versions.table import ACCELERATION, Entry
from reports.write.page_tables import COMPARED
from reports.write.rows import Rows, lookups
from reports.write.tables import number
from reports.write.templates import anchor, headings, link
from reports.write.unmeasured import MARK
from tests.committed_rows import RESULTS, answer_to, page_rows
from tests.rows import falling

NAMES = [find.__name__ for find in FINDINGS]


TAUGHT = tuple(page for page in PAGES if page.name in ("four_bar", "pendulum", "person", "skate", "rolling"))
FAULTS, VERSIONS = (next(page for page in PAGES if page.name == name) for name in ("faults", "versions"))
# Found in files of releases; the first is drawn from an answer.
OF_RELEASES = {"faults", "releases", "trees"}


@cache
def answered() -> dict[Task, Answer]:
    return {OFFSETS: answer_to(OFFSETS)}


def changed(change):
    """The pages' material, each row as `change(cell, row)` gives it; None leaves it out."""
    return {
        FAULTS: Material({}, answered()),
        VERSIONS: Material({}),
        **{
            page: Material(
                {cell: new for cell, row in page_rows(page).items() if (new := change(cell, row)) is not None}
            )
            for page in TAUGHT
        },
    }


@cache
def told():
    return {found.name: found for found in findings(changed(lambda cell, row: row))}


def test_the_committed_rows_bear_all_of_them_out():
    assert list(told()) == NAMES
    assert len({found.title for found in told().values()}) == len(NAMES)


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


def crank(variant, every, purpose="failure"):
    return stored("driven_four_bar", f"mujoco {variant}", every, "angle", purpose)


def free(method, field="angle"):
    return stored("free_four_bar", method, 10, field)


def test_its_numbers_are_those_of_the_rows_that_it_names():
    shown = ("pymunk default", "pymunk tuned", "mujoco default", "mujoco tuned")
    energies = [stored("pendulum_1", name, 10, "energy") for name in shown]
    overwritten = "default, overwritten crank"
    numbers = {
        "spring": [free("mujoco tuned"), free("mujoco tuned", "cpu") / free("mujoco default", "cpu")],
        "luck": [stored("spinning_four_bar", "mujoco default", 10, "angle")],
        "start": [free(f"pymunk {variant}") for variant in ("default", "tuned", "leapfrog")],
        "exact": [
            1e3 * stored("free_four_bar", "lagrange rk4 none", 3, "cpu"),
            1e3 * free("mujoco tuned", "cpu"),
            1e3 * stored("free_four_bar", "pymunk extended", 3, "cpu"),
        ],
        "energy": [100 * energy for energy in energies],
        "iterations": [person(10, 1, "angle"), person(10, 10, "angle"), person(20, 10, "angle")],
        "forces": [person(20, 10, "angle"), *(100 * person(count, 10, "reaction") for count in (20, 100))],
        "skate": [stored("sleigh", f"pymunk {v}", n, "position") for v, n in (("default", 1), ("tuned", 10))],
        "crank": [
            crank(overwritten, 10),
            crank(overwritten, 100),
            crank("tuned, overwritten crank", 10),
            crank("tuned", 10, "sweep"),
        ],
        "contact": [stored("rolling_ellipse", f"mujoco {each}", 10, "angle") for each in ("tuned", "extended")],
    }
    assert set(numbers) == set(NAMES) - OF_RELEASES
    for name, values in numbers.items():
        for value in values:
            assert re.search(rf"(?<![\d.]){re.escape(number(value))}(?![\d.e])", told()[name].text), (
                name,
                number(value),
            )


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
        ("exact", times(0.01, "cpu", **FREE, method="pymunk leapfrog")),
        ("exact", times(0.01, "cpu", **FREE, method="mujoco tuned")),
        ("luck", falls("spinning_four_bar", "mujoco default", "angle")),
        ("luck", times(4.0, "angle", scene="spinning_four_bar", method="mujoco default", steps=at(COMPARED))),
        ("start", falls("free_four_bar", "pymunk leapfrog", "angle")),
        ("start", times(10.0, "angle", **FREE, method="pymunk leapfrog")),
        ("start", times(10.0, "angle", **FREE, method="pymunk tuned")),
        ("energy", times(0.1, "energy", scene="pendulum_1", method="pymunk default")),
        ("energy", times(1e10, "energy", scene="pendulum_1", method="mujoco tuned")),
        ("energy", times(0.1, "energy", scene="pendulum_1", method="mujoco default")),
        ("iterations", times(0.1, "angle", **PERSON[10], steps=at(COMPARED))),
        ("iterations", times(10.0, "angle", **PERSON[20])),
        ("iterations", times(30.0, "angle", scene="person_one_foot", method="pymunk default", steps=at(COMPARED))),
        ("forces", times(1.1, "angle", **PERSON[20])),
        ("forces", times(0.2, "reaction", **PERSON[20])),
        ("skate", times(1e-2, "position", scene="sleigh", method="pymunk default", steps=at(1e-4))),
        ("skate", times(10.0, "position", scene="sleigh", method="pymunk tuned")),
        ("crank", times(0.1, "angle", **CRANK, method="mujoco default, overwritten crank", steps=at(TENTH))),
        ("crank", times(1e-3, "angle", **CRANK, method="mujoco tuned, overwritten crank")),
        ("crank", times(100.0, "angle", scene="driven_four_bar", method="mujoco tuned")),
        ("contact", falls("rolling_ellipse", "mujoco default", "angle")),
        ("contact", falls("rolling_ellipse", "pymunk tuned", "angle")),
        ("contact", times(1e3, "angle", scene="rolling_ellipse", method="mujoco extended")),
        ("contact", times(10.0, "angle", scene="rolling_ellipse", method="mujoco tuned")),
    ],
)
def test_a_finding_that_its_rows_contradict_is_not_told(name, wrong):
    (find,) = (find for find in FINDINGS if find.__name__ == name)
    assert not find(Known.of(changed(wrong))).told


ABOUT = {
    "free_four_bar": ("spring", "start", "exact"),
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


def test_without_any_rows_or_with_failed_ones_alone_nothing_is_told_of_them():
    assert {found.name for found in findings(changed(lambda cell, row: None))} == OF_RELEASES
    assert findings({}) == []
    assert {found.name for found in findings({FAULTS: Material({}), VERSIONS: Material({})})} == OF_RELEASES - {
        "faults"
    }
    failed = findings(changed(lambda cell, row: replace(row, outcome=Outcome.TORN)))
    # Errors of failed runs may still speak of energy: a pendulum that is off by a radian has lost what it has lost.
    assert {found.name for found in failed} - OF_RELEASES <= {"energy"}


def entries(**changes):
    """The releases' rows, those of a method or a release with another error or cost."""

    def change(entry):
        return replace(entry, **changes) if (entry.version, entry.variant) == AT else entry

    return replace(table(), entries=tuple(map(change, table().entries)))


AT = ("3.7.0", "tuned")


def test_a_release_whose_run_can_not_be_compared_is_no_point_of_its_line():
    known = Entry("toy", "1", "disc", "default", 1e-3, "angle", 0.5, Outcome.FINISHED, 1.0, "")
    assert of_releases("disc", [replace(known, version="0", outcome=Outcome.TORN), known]).points == (("1", 0.5),)


def test_what_the_releases_contradict_is_not_told(monkeypatch):
    known = Known(Rows())
    assert module.releases(known).told
    assert module.trees(known).told
    monkeypatch.setattr(module, "table", lambda: entries(error=4e-3))
    assert not module.releases(known).told
    newest = tuple(replace(entry, error=1e-4) if entry.quantity == ACCELERATION else entry for entry in table().entries)
    monkeypatch.setattr(module, "table", lambda: replace(table(), entries=newest))
    assert not module.trees(known).told
    mended = tuple(
        replace(row, printed=f"expected {row.expected}, found {row.expected}")
        for row in module.recorded()
        if row.script in module.FAULTS
    )
    monkeypatch.setattr(module, "recorded", lambda: mended)
    assert not module.faults(Known(Rows(), answered())).told


def test_lines_differ_without_colours():
    assert len({(look["linestyle"], look["marker"]) for look in LOOKS}) == len(LOOKS)
    steps = [of_rows(name, Rows(falling(f"pymunk {name}", (1e-2, 1e-3))), "angle") for name in "abcd"]
    (axes,) = draw(steps, STEP, "error").axes
    assert [np.asarray(line.get_xdata()).tolist() for line in axes.lines] == [[100.0, 10.0]] * 4
    assert [np.asarray(line.get_ydata()).tolist() for line in axes.lines] == [[1e-2, 1e-3]] * 4
    assert len({line.get_color() for line in axes.lines}) == 1  # one engine, one colour
    with pytest.raises(ValueError, match="5 lines"):
        draw([*steps, Line("e", "pymunk", ())], STEP, "error")
    dear = of_rows("a", Rows(falling("pymunk a", (1e-2, 1e-3))), "angle", CPU)
    assert [x for x, _ in dear.points] == pytest.approx([1.0, 10.0])  # ms a simulated second: `falling` costs step^-1


# --- symptoms and links ---

PUBLISHED = {path.name: path.read_text(encoding="utf-8") for path in RESULTS.glob("*.md")}
FILES = PUBLISHED | render_page(YOUR_LOOP, Material({}), "the command")


@pytest.mark.parametrize("symptom", SYMPTOMS, ids=lambda symptom: symptom.seen[:30])
def test_a_symptom_leads_to_a_section_that_is_there(symptom):
    address = link(symptom.page, symptom.heading, FILES)
    name, _, place = address.partition("#")
    assert name in FILES
    assert not symptom.heading or place in {anchor(heading) for heading in headings(FILES[name])}


_, _, SETTINGS = GUIDES
BLOCK = re.compile(r"^```\w+\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SETTING = re.compile(r"`[^`\n]*`")  # to be pasted, or a release
ADDRESS = re.compile(r"(?<=\])\([^)]*\)")
FOOT = re.compile(r"^---\n.*", re.DOTALL | re.MULTILINE)
MEASURED = re.compile(r"\d\.\d|\de-\d")

named = pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.name)


def text_of(page, rows) -> str:
    (text,) = render_page(page, Material(rows), "the command").values()
    return text


def prose(text: str) -> str:
    """A page without programs, settings, the addresses of its links, and its last line, which names versions."""
    return FOOT.sub("", ADDRESS.sub("", SETTING.sub("", BLOCK.sub("", text))))


@named
def test_without_rows_a_guide_has_no_number_that_was_measured(page):
    text = prose(text_of(page, {}))
    for threshold in (TORN, SATURATED):  # of the code, not measured
        text = text.replace(f"more than {threshold:g} ", "")
    assert not MEASURED.search(text)
    assert "not measured" not in text
    assert not re.search(r"\b(nan|None|Unmeasured)\b", text)


def test_every_number_of_the_settings_is_that_of_a_row():
    """Rows with other errors make other numbers: none is typed."""
    rows = page_rows(SETTINGS)
    shown = MEASURED.findall(prose(text_of(SETTINGS, rows)))
    assert len(shown) > 20
    unknown = {cell: replace(row, angle=math.nan, reaction=math.nan, cpu=math.nan) for cell, row in rows.items()}
    assert not MEASURED.search(prose(text_of(SETTINGS, unknown)))


@cache
def known() -> dict:
    """What asks for single rows of the settings, from the committed ones."""
    return lookups(Material(page_rows(SETTINGS)), (FOUR_BAR,))


def test_without_forces_that_depend_on_velocity_implicitfast_does_what_euler_does():
    """The guide's sentence about a loop: both errors are the same to the digits that it prints, and of first order."""
    euler, implicit = (("free_four_bar", "mujoco", f"stiff {name}") for name in ("Euler", "implicitfast"))
    asked = known()
    for every in (1, EVERY):
        assert asked["at"](*implicit, every).angle == pytest.approx(asked["at"](*euler, every).angle, rel=1e-2)
    for method in (euler, implicit):
        assert asked["sweep"](*method).order == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(
    ("integrator", "product", "stable"),
    [("Euler", 1.8, True), ("Euler", 2.2, False), ("implicitfast", 2.2, True), ("implicitfast", 200.0, True)],
)
def test_euler_loses_a_servo_beyond_two_and_implicitfast_never(integrator, product, stable):
    """The guide's bound on a servo of gain k on an inertia I: Euler multiplies its rate by 1 - h k / I in a step."""
    step, inertia = 1e-3, 0.1
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option timestep="{step}" gravity="0 0 0" integrator="{integrator}"/>
          <worldbody><body><joint name="turn" axis="0 0 1"/>
            <inertial pos="0 0 0" mass="1" diaginertia="1 1 {inertia}"/></body></worldbody>
          <actuator><velocity joint="turn" kv="{product * inertia / step}"/></actuator></mujoco>""")
    data = mujoco.MjData(model)
    data.qvel[:] = 1.0
    mujoco.mj_step(model, data, 20)
    # 0.8 to the twentieth is 0.01, 1.2 to the twentieth 38.
    assert (abs(data.qvel[0]) < 0.1) == stable
    assert (abs(data.qvel[0]) > 10.0) != stable


def test_a_stiff_loops_reactions_have_a_plateau_where_its_angles_fall_and_digits_are_lost():
    asked = known()
    tuned = ("free_four_bar", "mujoco", "tuned")
    assert asked["sweep"](*tuned).order == pytest.approx(2.0, abs=0.1)
    assert not asked["sweep"](*tuned).plateau > 0
    assert asked["sweep"](*tuned, "reaction").plateau > 10 * asked["at"](*tuned, EVERY).angle
    extended = asked["at"]("free_four_bar", "pymunk", "extended", EVERY)
    assert extended.reaction > 100 * extended.angle


def test_one_change_alone_wins_little_and_both_win_much():
    """The spring as shipped with RK4, and the stiff spring with Euler, against both changed."""
    at = known()["at"]
    shipped, fourth, stiff, both = (
        at("free_four_bar", "mujoco", variant, EVERY).angle
        for variant in ("default", "RK4 alone", "stiff Euler", "tuned")
    )
    assert min(fourth, stiff) > 0.5 * shipped
    assert both < 1e-3 * shipped


@pytest.mark.parametrize("place", [0, 1], ids=["pymunk", "mujoco"])
def test_a_program_of_the_page_prints_the_weight_of_the_hanging_body(place):
    source = BLOCK.findall(text_of(SETTINGS, {}))[place]
    assert source.count("\n") <= 20
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(source, "a page", "exec"), {"__name__": "__main__"})
    assert said.getvalue().count("19.62") == 2  # 2 kg at 9.81 m/s^2: by Newton's law, and by what the engine says
    assert "-19.62" not in said.getvalue()
