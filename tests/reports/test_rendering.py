"""A page's rows, tables and sentences, and the files that are written of them."""

from __future__ import annotations

import csv
import re
from dataclasses import replace

import pytest

from reports.model.cells import Cell
from reports.model.convergence import Verdict
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation
from reports.pages.index import render_index, render_readme
from reports.pages.rendering import render_all, render_page
from reports.write.provenance import machine
from reports.write.rows import lookups
from reports.write.templates import marks
from reports.write.unmeasured import UNMEASURED
from tests.reports.test_overview import PAGE, OtherDisc
from tests.rows import falling, row_of
from tests.toys import Disc, Toy

README = "\n".join(mark for name in ("findings", "overview") for mark in marks(name))


DISC, OTHER = Disc(), OtherDisc()


CELLS = {
    Cell(scene, Toy(variant), every): row_of(
        f"mujoco {variant}", scene=scene.name, every=every, step=0.1 / every, angle=angle / every**2, cpu=angle
    )
    for scene, factor in ((DISC, 1.0), (OTHER, 0.1))
    for variant, angle in (("default", 1.1e-2 * factor), ("tuned", 1.3e-3 * factor))
    for every in (1, 10, 100)
}


def test_a_pages_material_gives_the_rows_of_the_sweep_and_no_experiments_among_them():
    tried = Cell(DISC, Toy("default"), 3, "failure")
    material = Material({**CELLS, tried: row_of("mujoco default", scene="disc", every=3, purpose="failure")})
    assert [row.scene for row in material.sweep((DISC,))] == ["disc"] * 6
    assert all(row.purpose == "sweep" for row in material.sweep((DISC, OTHER)))
    assert [row.every for row in material.of((tried,))] == [3]


def test_sentences_take_the_rows_of_the_scene_and_method_that_they_name():
    words = lookups(Material(CELLS), (DISC, OTHER))
    best = words["best"]("disc", "mujoco", "default")
    assert (best.scene, best.variant, best.angle) == ("disc", "default", pytest.approx(1.1e-6))
    assert words["best"]("other_disc", "mujoco", "tuned").angle == pytest.approx(1.3e-8)
    assert words["best"]("disc", "pymunk", "tuned") is UNMEASURED
    at = words["at"]("disc", "mujoco", "tuned", 10)
    assert (at.scene, at.variant, at.every) == ("disc", "tuned", 10)
    assert words["at"]("disc", "mujoco", "tuned", 7) is UNMEASURED
    sweep = words["sweep"]("other_disc", "mujoco", "tuned")
    assert (sweep.scene, sweep.variant, sweep.quantity.name) == ("other_disc", "tuned", "angle")
    assert (sweep.best, sweep.verdict) == (pytest.approx(1.3e-8), Verdict.FALLS)
    assert words["sweep"]("disc", "mujoco", "tuned", "gap").quantity.name == "gap"
    assert words["sweep"]("disc", "pymunk", "tuned") is UNMEASURED
    assert words["ended"]("disc", "mujoco", "tuned") == ["finished"]
    only = lookups(Material(CELLS), (OTHER,))
    assert only["best"]("disc", "mujoco", "default") is UNMEASURED


def test_a_page_of_two_scenes_has_in_each_scenes_tables_its_own_rows_alone():
    text = render_page(PAGE, Material(CELLS), "the command")["base_data.md"]
    assert not {"saturated", "torn"} & set(re.findall(r"\w+", text))
    titles = ("Work and precision", "Order and plateau", "Reactions", "What was modelled")
    parts = {title: text.split(f"## {title}")[1].split("\n## ")[0].split("\n---")[0] for title in titles}
    for part in parts.values():
        first, second = part.split("other_disc")
        assert first.count("mujoco") == second.count("mujoco") > 0
    # The cost is the error's number here: 11 ms and 1.3 ms in the first scene, a tenth in the second.
    work = parts["Work and precision"]
    found = [line.strip("| ").split(" | ") for line in work.splitlines() if line.startswith("| mujoco")]
    assert [line[3] for line in found] == ["11", "1.3", "1.1", "0.13"]
    assert "- **other_disc**, invented too. Another scene." in text


def test_methods_that_are_not_featured_stand_on_the_data_page_alone():
    page = replace(PAGE, scenes=(DISC,), featured=lambda r: r.variant == "tuned")
    files = render_page(page, Material(CELLS), "the command")
    short = files["base.md"].split("**disc** at a step of")[1]
    everything = files["base_data.md"].split("## Work and precision")[1].split("## Order")[0]
    assert ("| mujoco tuned" in short, "| mujoco default" in short) == (True, False)
    assert ("| mujoco tuned" in everything, "| mujoco default" in everything) == (True, True)


def test_a_page_judges_by_the_quantity_that_it_compares():
    errors = falling("mujoco default", (1e-2, 3e-5, 3e-5, 3e-5), "position")
    errors = [replace(r, angle=1e-2 * r.step**2) for r in errors]
    rows = {Cell(DISC, Toy(), 10**i): r for i, r in enumerate(errors)}
    for quantity, outcome in (("position", "plateau"), ("angle", "converged")):
        page = replace(PAGE, scenes=(DISC,), quantity=quantity)
        text = render_page(page, Material(rows), "the command")["base_data.md"]
        assert set(re.findall(r"^- \*\*(plateau|converged)\*\*: ", text, re.MULTILINE)) == {outcome}


def test_an_experiment_has_its_own_rows_their_sentences_and_what_was_observed():
    torn, sound = (Cell(DISC, Toy(name), 1, "failure") for name in ("torn", "sound"))
    rows = {
        torn: row_of("mujoco torn", outcome=Outcome.TORN, sentence="it tore", gap=1.7, step=0.1),
        sound: row_of("mujoco sound", sentence="", angle=1.9e-5, step=0.1),
    }
    by_hand = Observation("by hand", "a setting", "0.02 rad")
    first = Failure("First", "It should turn.", (torn,), lambda material: [by_hand])
    second = Failure("Second", "So should this.", (sound,), columns=("energy",))
    never = Failure("Third", "Never run.", (Cell(DISC, Toy("never"), 1, "failure"),))
    page = replace(PAGE, scenes=(DISC,), failures=(first, second, never))
    files = render_page(page, Material(rows), "the command")
    text = files["base_data.md"]
    one, two, three = (
        text.split(f"### {name}")[1].split("\n## ")[0].split("\n### ")[0] for name in ("First", "Second", "Third")
    )
    assert "| mujoco torn | - | **torn** 1.7 m |" in one
    assert "**torn**: it tore" in one
    assert "| by hand | a setting | 0.02 rad |" in one
    assert "sound" not in one
    assert "| mujoco sound | - | 0.1 | **finished** | 5.3e-3 |" in two
    assert "|" not in three
    lines = files["base.md"].split("## Where methods fail")[1].split("\n- ")
    assert [line.split("**")[1] for line in lines[1:]] == [
        f"[{name}](base_data.md#{name.lower()})" for name in ("First", "Second", "Third")
    ]
    assert "Of 1 run: 1 **torn**." in lines[1]
    assert "Of 1 run: 1 ended with an energy error of 5.3e-3 relative." in lines[2]
    assert "not run yet." in lines[3]


def test_a_method_that_cannot_build_a_scene_is_told_once():
    rows = {
        Cell(DISC, Toy(), every): row_of(
            "mujoco x", every=every, outcome=Outcome.UNSUPPORTED, sentence="it has no pins"
        )
        for every in (1, 10)
    }
    text = render_page(replace(PAGE, scenes=(DISC,)), Material(rows), "the command")["base_data.md"]
    assert text.count("mujoco x can't build it: it has no pins") == 1


def test_index_and_readme_tell_the_scenes_of_the_pages():
    pages = {PAGE: Material(CELLS)}
    index = render_index(pages, "the command")
    assert "[disc](base.md), rad" in index
    assert "[other disc](base.md), rad" in index
    assert "- [Discs](base.md). One disc." in index
    assert all(f"- **{outcome}**: {outcome.meaning}" in index for outcome in Outcome)
    readme = render_readme(README, pages)
    assert "[disc](reports/results/base.md), rad" in readme
    assert "other disc" not in readme
    assert "order 2.0" in readme


def test_the_readme_is_the_same_after_a_run_that_took_another_time():
    slower = {cell: replace(row, cpu=7 * row.cpu, build=3.0, runs=9) for cell, row in CELLS.items()}
    assert render_readme(README, {PAGE: Material(slower)}) == render_readme(README, {PAGE: Material(CELLS)})
    worse = {cell: replace(row, angle=7 * row.angle) for cell, row in CELLS.items()}
    assert render_readme(README, {PAGE: Material(worse)}) != render_readme(README, {PAGE: Material(CELLS)})


def test_all_files_end_with_one_end_of_line_and_have_every_row_once():
    keyed = {cell: replace(r, key=str(i)) for i, (cell, r) in enumerate(CELLS.items())}
    files = render_all({PAGE: Material(keyed), replace(PAGE, title="Again"): Material(keyed)}, "the command")
    assert {"index.md", "base.md", "errors.csv", "timings.csv", "descriptions.csv"} <= set(files)
    for name, text in files.items():
        assert text.endswith("\n"), name
        assert not text.endswith("\n\n"), name
    for name in ("errors.csv", "timings.csv"):
        lines = [line for line in files[name].splitlines() if not line.startswith("#")]
        found = list(csv.DictReader(lines))
        assert sorted((r["scene"], r["variant"], r["every"]) for r in found) == sorted(
            (r.scene, r.variant, str(r.every)) for r in CELLS.values()
        )
    assert "angle" not in files["timings.csv"].splitlines()[-1]
    assert all(words in files["timings.csv"] for words in ("the command", machine()))
