"""`crosscheck report`: pages and charts from what is stored, in the folder of the results or published."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, SEARCH, STORE, Folder, refuse_file, with_folder
from reports.model.ending import BadInput
from reports.run.files import write_whole

if TYPE_CHECKING:
    from reports.model.page import Material, Page

CHECKOUT = Path(__file__).parents[2]
SEARCHED = ("search.md", "search_errors.svg")
LARGE = 2**20  # bytes of a store: smaller ones have too few rows for workers (`reports.cli.drawing`)
Materials = Mapping["Page", "Material"]


def report(
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write to the checkout's reports/results and README.md instead.")
    ] = False,
) -> None:
    """Write pages, charts, errors.csv and timings.csv from what is stored."""
    from reports.cli.terminal import Terminal

    for sentence in write_report(results, publish).sentences:
        Terminal(140).say(sentence)


@dataclass(frozen=True)
class WrittenReport:
    """The folder of a report, the names of its files, and sentences about them for the user."""

    folder: Path
    files: tuple[str, ...]
    sentences: tuple[str, ...]


def write_report(results: Path = FOLDER, publish: bool = False) -> WrittenReport:
    """Write pages, charts and tables of what is stored in `results`. Raises BadInput where there is nothing."""
    if publish:
        refuse_outside_a_checkout()
    refuse_file(results)
    nothing = BadInput(f"{results} holds nothing for the present sources: {with_folder('crosscheck run', results)}")
    searched = search_files(results, publish)
    folder = published() if publish else results
    if not (results / STORE).exists():
        if not searched:
            raise nothing
        line = f"{len(searched)} files written to {folder}: the search alone, since no cells are stored"
        write_files({folder / name: text for name, text in searched.items()})
        return WrittenReport(folder, tuple(searched), (line,))
    if (results / STORE).stat().st_size > LARGE:
        from reports.run.worker import start_early

        start_early("reports.cli.drawing")  # imported while this process imports the rest
    from reports.pages.index import render_readme
    from reports.write.csv_files import DIGESTS, digests_csv

    if publish:  # the searches are run by a command of their own: their published pages stay
        standing = ((name, folder / name) for name in SEARCHED)
        searched = searched or {name: path.read_text(encoding="utf-8") for name, path in standing if path.is_file()}
    material, remembered, missing = stored_material(results, publish)
    if not any(stored.rows for stored in material.values()):
        raise nothing
    if publish:
        material = publishable(material, missing)
    files = rendered(folder, material, remembered, searched, publish)
    files[DIGESTS] = digests_csv(files)
    texts = {folder / name: text for name, text in files.items()}
    if publish:
        readme = CHECKOUT / "README.md"
        texts[readme] = render_readme(readme.read_text(encoding="utf-8"), material)
    write_files(texts)
    line = f"{len(files)} files written. Read this first: {folder / 'index.md'}"
    return WrittenReport(folder, tuple(files), (line, missing) if missing else (line,))


def stored_material(results: Path, publish: bool) -> tuple[Materials, tuple[str, ...], str]:
    """(what is stored of each page, the references that the store remembers, a sentence on missing cells or "")."""
    from reports.cli.drawing import known_to, material_of
    from reports.cli.selection import page_cells, page_tasks
    from reports.model.catalogue import PAGES
    from reports.run.running import missing
    from reports.run.store import Store

    with Store.read(results / STORE) as store:
        known = known_to(store, publish)
        # A borrowed cell belongs to the full grid as far as the page that it is borrowed from runs it.
        whole = tuple(dict.fromkeys(item for page in PAGES for item in (*page_cells(page), *page_tasks(page))))
        left = len(missing(whole, store))
        names = {page.name for page in PAGES}
        material = {page: material_of(page, store) for page in known.pages}
        remembered = () if publish else tuple(store.remembered())
    # A page of which nothing is stored has nothing to show: it was not run, or its sources have changed since.
    material = {
        page: stored
        for page, stored in material.items()
        if stored.rows or (page.name in names if publish else stored.answers)
    }
    grid = f"{left} of {len(whole)} cells of the full grid are not stored: "
    return material, remembered, grid + with_folder("crosscheck run --full", results) if left else ""


def publishable(material: Materials, missing: str) -> Materials:
    """The material, with published digits of rows that are as before. Raises BadInput if it may not be published."""
    from reports.pages.claims import contradicted
    from reports.write.csv_files import as_published, read_published

    before = read_published(published())
    refuse_without(before.engines)
    if missing:
        raise BadInput(f"nothing is published, {missing}")
    material = {page: replace(stored, rows=as_published(stored.rows, before)) for page, stored in material.items()}
    if wrong := contradicted(material):
        raise BadInput(f"nothing is published, since rows contradict these claims of pages: {'; '.join(wrong)}")
    return material


def rendered(
    folder: Path, material: Materials, remembered: tuple[str, ...], searched: Mapping[str, str], publish: bool
) -> dict[str, str]:
    """The files of a report into this folder by their names, but for their digests."""
    from reports.cli.drawing import MANY, drawn
    from reports.pages.rendering import render_all
    from reports.write.templates import without_links_to_nothing

    command = "make publish" if publish else "crosscheck report"
    many = sum(len(stored.rows) for stored in material.values()) > MANY
    pages = drawn(material, remembered, command, published()) if many else {}
    files = render_all(material, command, searched, pages)
    files |= moving_picture(material.values())
    if not publish:

        def is_page(name: str) -> bool:
            return name in files or (folder / name).is_file()

        return {
            name: without_links_to_nothing(text, is_page) if name.endswith(".md") else text
            for name, text in files.items()
        }
    timings = published() / "timings.csv"
    if timings.is_file() and "timings.csv" in files:
        old = timings.read_text(encoding="utf-8")
        files["timings.csv"] = old if same_but_for_the_date(old, files["timings.csv"]) else files["timings.csv"]
    return files


def moving_picture(material: Iterable[Material]) -> dict[str, str]:
    """The moving picture of README, by its name; nothing where not all of its motions are stored."""
    from reports.pages.four_bar.page import MOVED, MOVING, MOVING_EVERY, MOVING_PICTURE
    from reports.site.animated import animation, shown
    from reports.site.lessons import take_like
    from reports.write.tables import step_words

    answers = {task: answer for stored in material for task, answer in stored.answers.items() if task in MOVED}
    if any(task not in answers for task in MOVED):
        return {}
    scene = MOVED[0].cell.scene
    take = take_like(scene, tuple((word, engine, MOVING_EVERY) for word, engine in MOVING.items()))
    title = f"A four-bar linkage falls: the exact motion, and engines at steps of {step_words(MOVED[0].cell.step)}"
    return {MOVING_PICTURE: animation(shown(take, answers), title)}


def same_but_for_the_date(old: str, new: str) -> bool:
    """Whether two timings.csv differ in nothing but their first line."""
    return old.partition("\n")[2] == new.partition("\n")[2]


def refuse_without(engines: Iterable[str]) -> None:
    """Raises BadInput if one of these engines, whose rows are published, is not installed: its rows would be lost."""
    from engines.registry import ABSENT

    absent = [ABSENT[engine] for engine in engines if engine in ABSENT]
    if absent:
        raise BadInput(f"nothing is published, since rows of engines are that are not installed; {'; '.join(absent)}")


def write_files(texts: Mapping[Path, str], line: str = "") -> None:
    """Write them whole or not at all, and print a line about it, if there is one."""
    with kept() as check:  # between two files is no place to stop
        write_whole(texts, "the pages that were there stay as they were")
        check()
    if line:
        from reports.cli.terminal import Terminal

        Terminal(140).say(line)


def search_files(results: Path, publish: bool = False) -> dict[str, str]:
    """The page of the stored searches, and its picture; to be published, those of the last commit's seeds alone."""
    if not (results / SEARCH / STORE).exists():
        return {}
    from reports.pages.index import foot
    from reports.run.store import Store
    from reports.search import plan
    from reports.search.page import files, read

    planned = sum(piece.count for piece in plan.published()) if publish else 0
    with Store.read(results / SEARCH / STORE) as store:
        return files(*read(store, publish), foot("crosscheck search"), planned)


def published() -> Path:
    """The folder of the published results in a checkout."""
    return CHECKOUT / "reports" / "results"


def refuse_outside_a_checkout() -> None:
    """Raises BadInput unless the package lies in a checkout: an installed copy has no README to write."""
    for path in (CHECKOUT / "README.md", published() / "index.md"):
        if not path.is_file():
            raise BadInput(f"--publish is for a checkout of the project; there is no {path}")
