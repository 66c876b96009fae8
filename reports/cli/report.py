"""`crosscheck report`: pages and charts from what is stored, in the folder of the results or published."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, SEARCH, STORE, Folder, refuse_file, with_folder
from reports.model.ending import BadInput
from reports.run.files import write_whole

if TYPE_CHECKING:
    from reports.model.page import Material

CHECKOUT = Path(__file__).parents[2]
SEARCHED = ("search.md", "search_errors.svg")
LARGE = 2**20  # bytes of a store: smaller ones have too few rows for workers (`reports.cli.drawing`)


def report(
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write to the checkout's reports/results and README.md instead.")
    ] = False,
) -> None:
    """Write pages, charts, errors.csv and timings.csv from what is stored."""
    if publish:
        refuse_outside_a_checkout()
    refuse_file(results)
    nothing = BadInput(f"{results} holds nothing for the present sources: {with_folder('crosscheck run', results)}")
    searched = search_files(results, publish)
    if not (results / STORE).exists():
        if not searched:
            raise nothing
        folder = published() if publish else results
        line = f"{len(searched)} files written to {folder}: the search alone, since no cells are stored"
        write_files({folder / name: text for name, text in searched.items()}, line)
        return
    if (results / STORE).stat().st_size > LARGE:
        from reports.run.worker import start_early

        # Beside what is imported here; by the time that workers are wanted, they can be there.
        start_early("reports.cli.drawing")
    from reports.cli.drawing import MANY, drawn, known_to, material_of
    from reports.cli.selection import page_cells, page_tasks
    from reports.model.catalogue import PAGES
    from reports.pages.claims import contradicted
    from reports.pages.index import render_readme
    from reports.pages.rendering import render_all
    from reports.run.running import missing
    from reports.run.store import Store
    from reports.write import kept_numbers
    from reports.write.csv_files import DIGESTS, digests_csv
    from reports.write.templates import without_links_to_nothing

    folder = published() if publish else results
    before = kept_numbers.read(published()) if publish else kept_numbers.Published()
    refuse_without(before.engines)
    if publish:  # the searches are run by a command of their own: what is published of them stays
        standing = ((name, folder / name) for name in SEARCHED)
        searched = searched or {name: path.read_text(encoding="utf-8") for name, path in standing if path.is_file()}
    with Store.read(results / STORE) as store:
        known = known_to(store, publish)
        # What a page borrows belongs to the full grid as far as the page that it is borrowed from runs it.
        asked = (item for page in PAGES for item in (*page_cells(page), *page_tasks(page)))
        whole = tuple(dict.fromkeys(asked))
        left = len(missing(whole, store))
        material = {page: material_of(page, store) for page in known.pages}
        names = {page.name for page in PAGES}
        # A page of which nothing is stored has nothing to show: not asked for, or its sources have changed since.
        material = {
            page: given
            for page, given in material.items()
            if given.rows or (page.name in names if publish else given.answers)
        }
        grid = f"{left} of {len(whole)} cells of the full grid are not stored: "
        grid += with_folder("crosscheck run --full", results)
        if not any(given.rows for given in material.values()):
            raise nothing
        if publish and left:
            raise BadInput(f"nothing is published, {grid}")
        if publish:
            rows = {page: kept_numbers.as_published(given.rows, before) for page, given in material.items()}
            material = {page: replace(given, rows=rows[page]) for page, given in material.items()}
            if wrong := contradicted(material):
                raise BadInput(f"nothing is published, since rows contradict these claims of pages: {'; '.join(wrong)}")
        command = "make publish" if publish else "crosscheck report"
        many = sum(len(given.rows) for given in material.values()) > MANY
        words = () if publish else store.remembered()
    made = drawn(material, words, command, published()) if many else {}
    files = render_all(material, command, searched, made)
    files |= moving_picture(material.values())
    timings = published() / "timings.csv"
    if publish and timings.is_file() and "timings.csv" in files:
        old = timings.read_text(encoding="utf-8")
        files["timings.csv"] = old if same_but_for_the_date(old, files["timings.csv"]) else files["timings.csv"]
    if not publish:
        files = {
            name: without_links_to_nothing(text, lambda page: page in files or (folder / page).is_file())
            if name.endswith(".md")
            else text
            for name, text in files.items()
        }
    files[DIGESTS] = digests_csv(files)
    texts = {folder / name: text for name, text in files.items()}
    if publish:
        readme = CHECKOUT / "README.md"
        texts[readme] = render_readme(readme.read_text(encoding="utf-8"), material)
    write_files(texts, f"{len(files)} files written. Read this first: {folder / 'index.md'}")
    if left:
        from reports.cli.terminal import Terminal

        Terminal(140).say(grid)


def moving_picture(material: Iterable[Material]) -> dict[str, str]:
    """The picture of README that moves, by its name; nothing where not all of its motions are stored."""
    from reports.pages.four_bar.page import MOVED, MOVING, MOVING_EVERY, MOVING_PICTURE
    from reports.site.animated import animation, shown
    from reports.site.lessons import take_like
    from reports.write.tables import step_words

    answers = {task: answer for each in material for task, answer in each.answers.items() if task in MOVED}
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
    """Raises BadInput if one of these engines, whose rows are published, is not installed: they would be taken out."""
    from engines.registry import ABSENT

    absent = [ABSENT[engine] for engine in engines if engine in ABSENT]
    if absent:
        raise BadInput(f"nothing is published, since rows of engines are that are not installed; {'; '.join(absent)}")


def write_files(texts: Mapping[Path, str], line: str) -> None:
    """Write them whole or not at all, and say so."""
    from reports.cli.terminal import Terminal

    with kept() as check:  # between two files is no place to stop
        write_whole(texts, "the pages that were there stay as they were")
        check()
    Terminal(140).say(line)


def search_files(results: Path, publish: bool = False) -> dict[str, str]:
    """The page of the searches that are stored here, and its picture; nothing without any. What is published is of
    seeds that the last commit gives."""
    place = results / SEARCH / STORE
    if not place.exists():
        return {}
    from reports.pages.index import foot
    from reports.run.store import Store
    from reports.search import plan
    from reports.search.page import files, read

    planned = sum(piece.count for piece in plan.published()) if publish else 0
    with Store.read(place) as store:
        return files(*read(store, publish), foot("crosscheck search"), planned)


def published() -> Path:
    """Where the published results stand in a checkout."""
    return CHECKOUT / "reports" / "results"


def refuse_outside_a_checkout() -> None:
    """Raises BadInput unless the package lies in a checkout: an installed copy has no README to write."""
    for path in (CHECKOUT / "README.md", published() / "index.md"):
        if not path.is_file():
            raise BadInput(f"--publish is for a checkout of the project; there is no {path}")
