"""Pages that workers render are those that one process renders."""

from __future__ import annotations

from pathlib import Path

from reports.cli.drawing import drawn, material_of
from reports.cli.selection import shown_cells
from reports.model.catalogue import PAGES
from reports.model.measure import measure
from reports.pages.rendering import render_page
from reports.run.store import Store


def test_pages_of_workers_are_those_of_one_process(tmp_path: Path) -> None:
    pages = [page for page in PAGES if page.name in ("reactions", "integrators")]
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        for cell in [next(c for c in shown_cells(page) if c.engine.name == "pymunk") for page in pages]:
            store.put(measure(cell, repeat=False))
    with Store.read(path) as store:
        material = {page: material_of(page, store) for page in pages}
    made = drawn(material, (), "make report", tmp_path)
    alone = {page.name: render_page(page, given, "make report") for page, given in material.items()}
    assert set(made) == {page.name for page in pages}
    assert made == alone
