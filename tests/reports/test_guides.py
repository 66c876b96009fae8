"""The guides: glossary, reactions, integrators. Their numbers are stored rows, and their programs run."""

# pyright: reportAttributeAccessIssue=false
from __future__ import annotations

import contextlib
import io
import math
import re
from dataclasses import replace

import mujoco
import pytest
import typer

from reports.cli.commands import app
from reports.cli.selection import choose_cells, page_cells, shown_cells
from reports.model.page import Material
from reports.pages.guides.page import EVERY, FOUR_BAR, PAGES, SCENES, VARIANTS
from reports.pages.rendering import render_page
from reports.write.rows import lookups
from tests.committed_rows import page_rows

GLOSSARY, REACTIONS, INTEGRATORS, CLUSTER = PAGES
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
ADDRESS = re.compile(r"(?<=\])\([^)]*\)")
FOOT = re.compile(r"^---\n.*", re.DOTALL | re.MULTILINE)
MEASURED = re.compile(r"\d\.\d|\de-\d")

named = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


def text_of(page, rows) -> str:
    (text,) = render_page(page, Material(rows), "the command").values()
    return text


def prose(text: str) -> str:
    """A page without its programs, the addresses of its links, and its last line, which names versions."""
    return FOOT.sub("", ADDRESS.sub("", BLOCK.sub("", text)))


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


def test_the_rows_of_guides_are_at_a_millisecond():
    for scene in SCENES:
        assert scene.spacing / EVERY == pytest.approx(1e-3, rel=0.05)


def known(page) -> dict:
    """What asks for single rows of a guide, from the committed ones."""
    return lookups(Material(page_rows(page)), (FOUR_BAR,))


def test_without_forces_that_depend_on_velocity_implicitfast_does_what_euler_does():
    """The guide's sentence about a loop: both errors are the same to the digits that it prints, and of first order."""
    euler, implicit = (("free_four_bar", "mujoco", f"stiff {name}") for name in ("Euler", "implicitfast"))
    asked = known(INTEGRATORS)
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
    asked = known(REACTIONS)
    tuned = ("free_four_bar", "mujoco", "tuned")
    assert asked["sweep"](*tuned).order == pytest.approx(2.0, abs=0.1)
    assert not asked["sweep"](*tuned).plateau > 0
    assert asked["sweep"](*tuned, "reaction").plateau > 10 * asked["at"](*tuned, EVERY).angle
    extended = asked["at"]("free_four_bar", "pymunk", "extended", EVERY)
    assert extended.reaction > 100 * extended.angle


def test_one_change_alone_wins_little_and_both_win_much():
    """The spring as shipped with RK4, and the stiff spring with Euler, against both changed."""
    at = known(INTEGRATORS)["at"]
    shipped, fourth, stiff, both = (
        at("free_four_bar", "mujoco", variant, EVERY).angle
        for variant in ("default", "RK4 alone", "stiff Euler", "tuned")
    )
    assert min(fourth, stiff) > 0.5 * shipped
    assert both < 1e-3 * shipped


def test_guides_read_the_rows_of_other_pages_and_have_nothing_run():
    assert page_cells(REACTIONS) == ()
    assert shown_cells(REACTIONS) == REACTIONS.borrowed
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


def test_the_guide_to_clusters_names_commands_and_options_that_exist():
    text = render_page(CLUSTER, Material({}), "crosscheck report")["cluster.md"]
    commands = set(re.findall(r"^crosscheck ([a-z]+).*--scheduler (tcp://HOST:8786|local:4)$", text, re.MULTILINE))
    assert commands == {("search", "local:4"), ("run", "tcp://HOST:8786")}
    known = typer.main.get_command(app)
    for name, _ in commands:
        options = [option for each in known.commands[name].params for option in each.opts]  # type: ignore[attr-defined]
        assert "--scheduler" in options
