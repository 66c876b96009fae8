"""Pages rendered by workers, one on each processor: pictures are nearly all of what a report takes.

A page holds functions, which can't be sent; what a worker is sent is its name, with what is stored of it.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from reports.cli.known import Known, registered, with_remembered
from reports.cli.selection import shown_cells
from reports.gate.prediction import all_tasks
from reports.model.outcomes import Loss
from reports.model.page import Material, Page
from reports.pages.rendering import render_page
from reports.run.running import worker_count
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise

MANY = 1000  # rows: of fewer, pages are rendered sooner than workers have started
LIMIT = 600.0  # CPU seconds of one page


def known_to(store: Store, publish: bool) -> Known:
    """The contents of a report: a published one has what is registered, another also what else was run."""
    known = registered()
    return known if publish else with_remembered(known, store.remembered(), motion=True)


def material_of(page: Page, store: Store) -> Material:
    """All that is stored of a page."""
    return Material(store.get(shown_cells(page)), store.answers(all_tasks(page)))


@dataclass(frozen=True)
class Drawing:
    """The work of a worker on (a page's name, what is stored of it). words: references that the store remembers."""

    words: tuple[str, ...]
    command: str

    def __call__(self, item: tuple[str, Material]) -> dict[str, str]:
        name, material = item
        pages = _pages(self.words)
        gc.disable()  # it would look through all that was imported; what one page leaves is little
        try:
            return render_page(pages[name], material, self.command)
        finally:
            gc.enable()
            gc.collect()


@lru_cache(maxsize=1)
def _pages(words: tuple[str, ...]) -> dict[str, Page]:
    pages = {page.name: page for page in with_remembered(registered(), words).pages}
    gc.freeze()
    return pages


def drawn(
    material: Mapping[Page, Material], words: Iterable[str], command: str, order: Path
) -> dict[str, dict[str, str]]:
    """The files of the pages that a worker could render, by the pages' names; the caller renders the others.

    words: references that the store remembers; order: a folder with a report: pages with the largest pictures begin.
    """
    pages = sorted(((page.name, stored) for page, stored in material.items()), key=lambda pair: -_size(order, pair[0]))
    work = Drawing(tuple(words), command)
    files: dict[str, dict[str, str]] = {}
    with suppress(WorkersLost):
        for (name, _), result, _ in supervise(work, pages, LIMIT, worker_count()):
            if not isinstance(result, Loss):
                files[name] = result
    return files


def _size(folder: Path, name: str) -> int:
    with suppress(OSError):
        return sum(file.stat().st_size for file in folder.glob(f"{name}_*.svg"))
    return 0
