"""Pages rendered by workers, one on each processor: pictures are nearly all of what a report takes.

A worker reads the store for itself, since a page holds functions, which can't be sent; what it is sent is a name.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from reports.cli.known import Known, registered, with_remembered
from reports.cli.selection import shown_cells
from reports.grid.imports import recall
from reports.grid.outcomes import Loss
from reports.grid.pool import worker_count
from reports.grid.store import Store
from reports.grid.supervisor import WorkersLost, supervise
from reports.grid.truths import FOLDER
from reports.pages.page import Material, Page
from reports.text.rendering import render_page

MANY = 1000  # rows: of fewer, pages are rendered sooner than workers have started
LIMIT = 600.0  # CPU seconds of one page


def known_to(store: Store, publish: bool) -> Known:
    """What a report tells of: published is what is registered; a report of one's own shows what else was run."""
    own = registered()
    return own if publish else with_remembered(own, store.remembered())


def material_of(page: Page, store: Store) -> Material:
    """All that is stored of a page."""
    return Material(store.get(shown_cells(page)), store.answers(page.all_tasks()))


@dataclass(frozen=True)
class Drawing:
    """What a worker does with a page's name. store: the file; truths: the folder with what sources import."""

    store: Path
    truths: Path
    publish: bool
    command: str

    def __call__(self, name: str) -> dict[str, str]:
        pages = _pages(self)
        with Store.read(self.store) as store:
            return render_page(pages[name], material_of(pages[name], store), self.command)


@lru_cache(maxsize=1)
def _pages(drawing: Drawing) -> dict[str, Page]:
    recall(drawing.truths)
    with Store.read(drawing.store) as store:
        return {page.name: page for page in known_to(store, drawing.publish).pages}


def drawn(store: Store, publish: bool, command: str, pages: Iterable[Page], order: Path) -> dict[str, dict[str, str]]:
    """The files of pages by their names, of those that a worker could render: what is wrong with another is told where
    it is rendered again.

    order: a folder with a report, of which those pages begin that have the largest pictures.
    """
    names = sorted((page.name for page in pages), key=lambda name: -_size(order, name))
    work = Drawing(store.copied, (store.path.parent / FOLDER).resolve(), publish, command)
    found: dict[str, dict[str, str]] = {}
    with suppress(WorkersLost):
        for name, result, _ in supervise(work, names, LIMIT, worker_count(timed=False)):
            if not isinstance(result, Loss):
                found[name] = result
    return found


def _size(folder: Path, name: str) -> int:
    with suppress(OSError):
        return sum(file.stat().st_size for file in folder.glob(f"{name}_*.svg"))
    return 0
