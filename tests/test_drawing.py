"""Pages that workers render are those that one process renders."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reports.cli import drawing, kept_pages
from reports.cli.drawing import drawn, made_of, material_of
from reports.cli.kept_pages import digest, keep, kept
from reports.cli.selection import shown_cells
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.measure import blank, measure
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.tasks import Answer, Motion
from reports.pages.rendering import render_page
from reports.run.store import Store


def test_pages_of_workers_are_those_of_one_process(tmp_path: Path) -> None:
    pages = [page for page in PAGES if page.name in ("four_bar", "person")]
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        for cell in [next(c for c in shown_cells(page) if c.engine.name == "lagrange") for page in pages]:
            store.put(measure(cell, repeat=False))
    with Store.read(path) as store:
        material = {page: material_of(page, store) for page in pages}
    made = drawn(material, (), "make report", tmp_path)
    alone = {page.name: render_page(page, given, "make report") for page, given in material.items()}
    assert set(made) == {page.name for page in pages}
    assert made == alone


PAGE = next(page for page in PAGES if page.name == "person")
CELL = shown_cells(PAGE)[0]
MATERIAL = Material({CELL: replace(blank(CELL, Outcome.FINISHED), angle=1e-3)})


def test_a_page_of_which_nothing_has_changed_is_not_drawn_again(tmp_path, monkeypatch):
    drawn_pages: list[str] = []

    def render(page: Page, material: Material, command: str) -> dict[str, str]:
        drawn_pages.append(page.name)
        return {
            f"{page.name}.md": f"{command}: {[row.angle for row in material.rows.values()]}, the {len(drawn_pages)}th"
        }

    monkeypatch.setattr(drawing, "render_page", render)
    others = [page for page in PAGES if page.name in ("errata", "wheels")]

    def made(material: Material, command: str = "make report") -> dict[str, str]:
        given = {PAGE: material, **{page: Material({}) for page in others}}
        found = made_of(given, (), command, tmp_path, tmp_path / "pages")
        assert found.keys() == {"person", "errata", "wheels"}
        return dict(found["person"])

    first = made(MATERIAL)
    assert sorted(drawn_pages) == ["errata", "person", "wheels"]
    assert made(MATERIAL) == first
    assert len(drawn_pages) == 3
    other = made(Material({CELL: replace(MATERIAL.rows[CELL], angle=2e-3)}))
    assert drawn_pages[3:] == ["person"]
    assert "0.002" in other["person.md"]
    assert made(MATERIAL, "crosscheck report") != first
    assert len(drawn_pages) == 7


def test_all_that_a_page_is_made_from_counts(monkeypatch):
    row, motion = MATERIAL.rows[CELL], Motion(CELL)
    answers = [
        Answer(Outcome.FINISHED, values={"angle": np.array(angle), "why": why})
        for angle, why in (((1.0, 2.0), "so"), ((1.0, 2.5), "so"), (((1.0,), (2.0,)), "so"), ((1.0, 2.0), "not so"))
    ]
    other = Cell(CELL.scene, CELL.engine, CELL.every + 1)
    found = [
        digest(PAGE, MATERIAL, "make report", ()),
        digest(PAGE, MATERIAL, "make report", ("a scene",)),
        digest(PAGE, Material({}), "make report", ()),
        digest(PAGE, Material({CELL: replace(row, cpu=2.0)}), "make report", ()),
        digest(PAGE, Material({other: row}), "make report", ()),
        digest(replace(PAGE, name="another"), MATERIAL, "make report", ()),
        *(digest(PAGE, Material({}, {motion: answer}), "make report", ()) for answer in answers),
    ]
    assert len(set(found)) == len(found)
    assert digest(PAGE, MATERIAL, "make report", ()) == found[0]
    monkeypatch.setattr(kept_pages, "_surroundings", lambda: "other sources")
    assert digest(PAGE, MATERIAL, "make report", ()) not in found


def test_sources_templates_and_what_the_atlas_is_drawn_from_count_and_what_a_report_writes_does_not():
    names = {path.relative_to(kept_pages.ROOT).as_posix() for path in kept_pages._sources()}
    wanted = {"reports/plots/theme.py", "reports/pages/base.md", "engines/registry.py", "reference/scene.py"}
    assert wanted | {"reports/results/atlas.csv", "reports/pages/faults/versions.csv"} <= names
    assert not {"reports/results/errors.csv", "reports/results/timings.csv", "reports/results/index.md"} & names


@pytest.mark.parametrize("damage", ["", "{", '{"digest": "here"}', "[]", "changed"])
def test_kept_files_that_are_damaged_are_not_taken(tmp_path, damage):
    keep(tmp_path, "person", "here", {"person.md": "words"})
    assert kept(tmp_path, "person", "here") == {"person.md": "words"}
    assert kept(tmp_path, "person", "there") is None
    assert kept(tmp_path, "another", "here") is None
    file = tmp_path / "person.json"
    told = json.loads(file.read_text("utf-8"))
    told["files"]["person.md"] = "other words"
    file.write_text(json.dumps(told) if damage == "changed" else damage, "utf-8")
    assert kept(tmp_path, "person", "here") is None


def test_where_nothing_can_be_kept_pages_are_drawn_all_the_same(tmp_path):
    (tmp_path / "pages").write_text("a file where the folder should be")
    keep(tmp_path / "pages", "person", "here", {"person.md": "words"})
    assert kept(tmp_path / "pages", "person", "here") is None
