"""`crosscheck report`: pages and charts from what is stored, in the folder of the results or published.

Pictures are nearly all of the work: where there are many rows, workers render pages, one on each processor.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Annotated

import typer

from engines import registry
from reports.cli import selection
from reports.cli.interruption import delayed_signals
from reports.cli.known import registered, with_stored
from reports.cli.options import FOLDER, SEARCH, STORE, Folder, refuse_file, with_folder
from reports.cli.terminal import Terminal
from reports.gate.prediction import all_tasks
from reports.model import catalogue
from reports.model.ending import BadInput
from reports.model.outcomes import Loss
from reports.model.page import Material, Page
from reports.pages import index, rendering
from reports.pages.claims import contradicted
from reports.pages.four_bar.page import MOVING_EVERY, MOVING_METHODS, MOVING_PICTURE, MOVING_TASKS
from reports.run.files import write_whole
from reports.run.running import missing, worker_count
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from reports.search import page as search_page
from reports.search import plan
from reports.site.animated import animation, shown
from reports.site.lessons import take_like
from reports.write.csv_files import DIGESTS, as_published, digests_csv, read_published
from reports.write.tables import step_words
from reports.write.templates import without_dead_links

CHECKOUT = Path(__file__).parents[2]
SEARCHED = ("search.md", "search_errors.svg")
MANY = 1000  # rows: of fewer, pages are rendered sooner than workers have started
PAGE_LIMIT = 600.0  # CPU seconds of one page
Materials = Mapping[Page, Material]


def report(
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write to the checkout's reports/results and README.md instead.")
    ] = False,
) -> None:
    """Write pages, charts, errors.csv and timings.csv from what is stored."""
    for sentence in write_report(results, publish).sentences:
        Terminal(140).say(sentence)


@dataclass(frozen=True)
class WrittenReport:
    """The folder of a report, the names of its files, and sentences about them for the user."""

    folder: Path
    files: tuple[str, ...]
    sentences: tuple[str, ...]


def write_report(results: Path = FOLDER, publish: bool = False) -> WrittenReport:
    """Write pages, charts and tables of the rows stored in `results`. Raises BadInput where there is nothing."""
    if publish:
        refuse_outside_a_checkout()
    refuse_file(results)
    nothing = BadInput(f"{results} holds nothing for the present sources: {with_folder('crosscheck run', results)}")
    searched = search_files(results, publish)
    folder = published() if publish else results
    if not (results / STORE).exists():
        if not searched:
            raise nothing
        write_files({folder / name: text for name, text in searched.items()})
        line = f"{len(searched)} files written to {folder}: the search alone, since no cells are stored"
        return WrittenReport(folder, tuple(searched), (line,))
    if publish:  # the searches are run by a command of their own: their published pages stay
        paths = {name: folder / name for name in SEARCHED if (folder / name).is_file()}
        searched = searched or {name: path.read_text(encoding="utf-8") for name, path in paths.items()}
    material, references, left = stored_material(results, publish)
    if not any(stored.rows for stored in material.values()):
        raise nothing
    if publish:
        material = publishable(material, left)
    files = rendered(folder, material, references, searched, publish)
    files[DIGESTS] = digests_csv(files)
    texts = {folder / name: text for name, text in files.items()}
    if publish:
        readme = CHECKOUT / "README.md"
        texts[readme] = index.render_readme(readme.read_text(encoding="utf-8"), material)
    write_files(texts)
    line = f"{len(files)} files written. Read this first: {folder / 'index.md'}"
    return WrittenReport(folder, tuple(files), (line, left) if left else (line,))


def material_of(page: Page, store: Store) -> Material:
    """All that is stored of a page."""
    return Material(store.get(selection.shown_cells(page)), store.answers(all_tasks(page)))


def stored_material(results: Path, publish: bool) -> tuple[Materials, tuple[str, ...], str]:
    """(what is stored of each page, the references that the store remembers, a sentence on missing cells or "").

    A published report has the pages that are registered, another also those of what else was run.
    """
    with Store.read(results / STORE) as store:
        references = () if publish else tuple(store.load_references())
        pages = with_stored(registered(), references, motion=True).pages
        # A borrowed cell belongs to the full grid as far as the page that it is borrowed from runs it.
        items = [(*selection.page_cells(page), *selection.page_tasks(page)) for page in catalogue.PAGES]
        whole = tuple(dict.fromkeys(item for members in items for item in members))
        left = len(missing(whole, store))
        material = {page: material_of(page, store) for page in pages}
    names = {page.name for page in catalogue.PAGES}
    # A page of which nothing is stored has nothing to show: it was not run, or its sources have changed since.
    material = {
        page: stored
        for page, stored in material.items()
        if stored.rows or (page.name in names if publish else stored.answers)
    }
    grid = f"{left} of {len(whole)} cells of the full grid are not stored: "
    return material, references, grid + with_folder("crosscheck run --full", results) if left else ""


def publishable(material: Materials, left: str) -> Materials:
    """The material, with published digits of rows that are as before. Raises BadInput if it may not be published.

    Rows of an engine that is not installed would be lost.
    """
    before = read_published(published())
    if absent := [registry.ABSENT[engine] for engine in before.engines if engine in registry.ABSENT]:
        raise BadInput(f"nothing is published, since rows of engines are that are not installed; {'; '.join(absent)}")
    if left:
        raise BadInput(f"nothing is published, {left}")
    material = {page: replace(stored, rows=as_published(stored.rows, before)) for page, stored in material.items()}
    if wrong := contradicted(material):
        raise BadInput(f"nothing is published, since rows contradict these claims of pages: {'; '.join(wrong)}")
    return material


def rendered(
    folder: Path, material: Materials, references: tuple[str, ...], searched: Mapping[str, str], publish: bool
) -> dict[str, str]:
    """The files of a report into this folder by their names, but for their digests."""
    command = "make publish" if publish else "crosscheck report"
    many = sum(len(stored.rows) for stored in material.values()) > MANY
    pages = drawn(material, references, command, published()) if many else {}
    files = rendering.render_all(material, command, searched, pages)
    files |= moving_picture(material.values())
    if publish:
        timings = published() / "timings.csv"
        if timings.is_file() and "timings.csv" in files:
            old = timings.read_text(encoding="utf-8")
            same = old.partition("\n")[2] == files["timings.csv"].partition("\n")[2]  # but for the date
            files["timings.csv"] = old if same else files["timings.csv"]
        return files

    def is_page(name: str) -> bool:
        return name in files or (folder / name).is_file()

    return {name: without_dead_links(text, is_page) if name.endswith(".md") else text for name, text in files.items()}


@dataclass(frozen=True)
class Drawing:
    """Draws a page in a worker from (its name, its stored material). words: references that the store remembers."""

    words: tuple[str, ...]
    command: str

    def __call__(self, item: tuple[str, Material]) -> dict[str, str]:
        name, material = item
        page = _pages(self.words)[name]  # it holds functions, which can't be sent
        gc.disable()  # it would look through all that was imported; what one page leaves is little
        try:
            return rendering.render_page(page, material, self.command)
        finally:
            gc.enable()
            gc.collect()


@lru_cache(maxsize=1)
def _pages(words: tuple[str, ...]) -> dict[str, Page]:
    pages = {page.name: page for page in with_stored(registered(), words).pages}
    gc.freeze()
    return pages


def drawn(material: Materials, words: Iterable[str], command: str, order: Path) -> dict[str, dict[str, str]]:
    """The files of the pages that a worker could render, by the pages' names; the caller renders the others.

    words: references that the store remembers; order: a folder with a report: pages with the largest pictures begin.
    """

    def size(pair: tuple[str, Material]) -> int:
        return sum(file.stat().st_size for file in order.glob(f"{pair[0]}_*.svg"))

    pages = sorted(((page.name, stored) for page, stored in material.items()), key=size, reverse=True)
    files: dict[str, dict[str, str]] = {}
    with suppress(WorkersLost):
        for (name, _), result, _ in supervise(Drawing(tuple(words), command), pages, PAGE_LIMIT, worker_count()):
            if not isinstance(result, Loss):
                files[name] = result
    return files


def moving_picture(material: Iterable[Material]) -> dict[str, str]:
    """The moving picture of README, by its name; nothing where not all of its motions are stored."""
    answers = {task: answer for stored in material for task, answer in stored.answers.items() if task in MOVING_TASKS}
    if any(task not in answers for task in MOVING_TASKS):
        return {}
    cell = MOVING_TASKS[0].cell
    take = take_like(cell.scene, tuple((name, engine, MOVING_EVERY) for name, engine in MOVING_METHODS.items()))
    title = f"A four-bar linkage falls: the exact motion, and engines at steps of {step_words(cell.step)}"
    return {MOVING_PICTURE: animation(shown(take, answers), title)}


def write_files(texts: Mapping[Path, str], line: str = "") -> None:
    """Write them whole or not at all, and print a line about it, if there is one."""
    with delayed_signals() as check:  # between two files is no place to stop
        write_whole(texts, "the pages that were there stay as they were")
        check()
    if line:
        Terminal(140).say(line)


def search_files(results: Path, publish: bool = False) -> dict[str, str]:
    """The page of the stored searches, and its picture; to be published, those of the last commit's seeds alone."""
    if not (results / SEARCH / STORE).exists():
        return {}
    planned = sum(piece.count for piece in plan.published_chunks()) if publish else 0
    with Store.read(results / SEARCH / STORE) as store:
        return search_page.render_page(
            *search_page.read_stored(store, publish), index.foot("crosscheck search"), planned
        )


def published() -> Path:
    """The folder of the published results in a checkout."""
    return CHECKOUT / "reports" / "results"


def refuse_outside_a_checkout() -> None:
    """Raises BadInput unless the package lies in a checkout: an installed copy has no README to write."""
    for path in (CHECKOUT / "README.md", published() / "index.md"):
        if not path.is_file():
            raise BadInput(f"--publish is for a checkout of the project; there is no {path}")
