"""`crosscheck report` writes pages and charts of the stored results.

If there are many rows, workers render the pages, since drawing takes most of the time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache, partial
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
from reports.run.running import missing
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from reports.run.worker import worker_count
from reports.search import page as search_page
from reports.search import plan
from reports.site.animated import animation, shown
from reports.site.live.scenes import take_like
from reports.write.csv_files import DIGESTS, as_published, digests_csv, read_published
from reports.write.tables import step_words
from reports.write.templates import without_dead_links

CHECKOUT = Path(__file__).parents[2]
SEARCHED = ("search.md", "search_errors.svg")
MANY = 1000  # With fewer rows, starting workers would take longer than rendering.
PAGE_LIMIT = 600.0  # Limit of CPU seconds for one page.
Materials = Mapping[Page, Material]


def report(
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write to the checkout's reports/results and README.md instead.")
    ] = False,
) -> None:
    """Write pages, charts, errors.csv and timings.csv from the stored results."""
    for sentence in write_report(results, publish)[1]:
        Terminal(140).say(sentence)


def write_report(results: Path = FOLDER, publish: bool = False) -> tuple[Path, list[str]]:
    """Write pages, charts and tables of the rows stored in `results`; return their folder and sentences for the user.
    Raises BadInput if nothing is stored."""
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
        return folder, [f"{len(searched)} files written to {folder}: the search alone, since no cells are stored"]
    if publish:  # If no searches are stored, their published pages remain.
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
    return folder, [f"{len(files)} files written. Read this first: {folder / 'index.md'}", *filter(None, [left])]


def material_of(page: Page, store: Store) -> Material:
    return Material(store.get(selection.shown_cells(page)), store.answers(all_tasks(page)))


def stored_material(results: Path, publish: bool) -> tuple[Materials, tuple[str, ...], str]:
    """(material of each page, stored references, a sentence on missing cells or ""). A published report has only
    registered pages. Other reports also have pages for the stored references."""
    with Store.read(results / STORE) as store:
        references = () if publish else tuple(store.load_references())
        pages = with_stored(registered(), references, motion=True).pages
        # A borrowed cell counts as a cell of the page that runs it.
        items = [(*selection.page_cells(page), *selection.page_tasks(page)) for page in catalogue.PAGES]
        whole = tuple(dict.fromkeys(item for members in items for item in members))
        left = len(missing(whole, store))
        material = {page: material_of(page, store) for page in pages}
    names = {page.name for page in catalogue.PAGES}
    # Pages without stored results were not run, or the sources have changed since. Such pages are left out.
    material = {
        page: stored
        for page, stored in material.items()
        if stored.rows or (page.name in names if publish else stored.answers)
    }
    grid = f"{left} of {len(whole)} cells of the full grid are not stored: "
    return material, references, grid + with_folder("crosscheck run --full", results) if left else ""


def publishable(material: Materials, left: str) -> Materials:
    """The material in which unchanged rows have the published digits. Raises BadInput if cells are missing, if rows
    contradict a claim of a page, or if an engine with published rows is not installed."""
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
    """Name -> text of a file of the report. The file of digests is not included."""
    command = "make publish" if publish else "crosscheck report"
    many = sum(len(stored.rows) for stored in material.values()) > MANY
    pages = drawn(material, references, command, published()) if many else {}
    files = rendering.render_all(material, command, searched, pages)
    files |= moving_picture(material.values())
    if publish:
        timings = published() / "timings.csv"
        if timings.is_file() and "timings.csv" in files:
            old = timings.read_text(encoding="utf-8")
            same = old.partition("\n")[2] == files["timings.csv"].partition("\n")[2]  # without the date
            files["timings.csv"] = old if same else files["timings.csv"]
        return files

    def is_page(name: str) -> bool:
        return name in files or (folder / name).is_file()

    return {name: without_dead_links(text, is_page) if name.endswith(".md") else text for name, text in files.items()}


def draw_page(references: tuple[str, ...], command: str, item: tuple[str, Material]) -> dict[str, str]:
    """The files of the page of (name, material), rendered in a worker. references: the stored references."""
    name, material = item
    page = _pages(references)[name]  # A page has functions, which can't be pickled.
    gc.disable()  # Collection would be slow, and a page leaves little garbage.
    try:
        return rendering.render_page(page, material, command)
    finally:
        gc.enable()
        gc.collect()


@lru_cache(maxsize=1)
def _pages(references: tuple[str, ...]) -> dict[str, Page]:
    pages = {page.name: page for page in with_stored(registered(), references).pages}
    gc.freeze()
    return pages


def drawn(material: Materials, references: Iterable[str], command: str, order: Path) -> dict[str, dict[str, str]]:
    """Name of a page -> files of the page. Pages that workers could not render are missing. references: references in
    the store. order: folder of an earlier report, whose sizes determine the order."""

    def size(pair: tuple[str, Material]) -> int:
        return sum(file.stat().st_size for file in order.glob(f"{pair[0]}_*.svg"))

    pages = sorted(((page.name, stored) for page, stored in material.items()), key=size, reverse=True)
    files: dict[str, dict[str, str]] = {}
    with suppress(WorkersLost):
        job = partial(draw_page, tuple(references), command)
        for (name, _), result, _ in supervise(job, pages, PAGE_LIMIT, worker_count()):
            if not isinstance(result, Loss):
                files[name] = result
    return files


def moving_picture(material: Iterable[Material]) -> dict[str, str]:
    """Name -> text of the animation in README. The result is empty unless all motions are stored."""
    answers = {task: answer for stored in material for task, answer in stored.answers.items() if task in MOVING_TASKS}
    if any(task not in answers for task in MOVING_TASKS):
        return {}
    cell = MOVING_TASKS[0].cell
    take = take_like(cell.scene, tuple((name, engine, MOVING_EVERY) for name, engine in MOVING_METHODS.items()))
    title = f"A four-bar linkage falls: the exact motion, and engines at steps of {step_words(cell.step)}"
    return {MOVING_PICTURE: animation(shown(take, answers), title)}


def write_files(texts: Mapping[Path, str], line: str = "") -> None:
    """Write all files or no file, then print `line`."""
    with delayed_signals() as check:  # An interruption must not leave a mixed report.
        write_whole(texts, "the pages that were there stay as they were")
        check()
    if line:
        Terminal(140).say(line)


def search_files(results: Path, publish: bool = False) -> dict[str, str]:
    """The page and the picture of stored searches. A published page has only searches with the last commit's seeds."""
    if not (results / SEARCH / STORE).exists():
        return {}
    planned = sum(piece.count for piece in plan.published_chunks()) if publish else 0
    with Store.read(results / SEARCH / STORE) as store:
        return search_page.render_page(
            *search_page.read_stored(store, publish), index.foot("crosscheck search"), planned
        )


def published() -> Path:
    return CHECKOUT / "reports" / "results"


def refuse_outside_a_checkout() -> None:
    """Raise BadInput unless the package is in a checkout. An installed copy has no README."""
    for path in (CHECKOUT / "README.md", published() / "index.md"):
        if not path.is_file():
            raise BadInput(f"--publish is for a checkout of the project; there is no {path}")
