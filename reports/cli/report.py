"""`crosscheck report`: pages and charts from what is stored, in the folder of the results or published."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, STORE, Folder, with_folder
from reports.cli.terminal import Terminal
from reports.grid.ending import BadInput
from reports.grid.files import write_whole
from reports.grid.store import Store

CHECKOUT = Path(__file__).parents[2]


def report(
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write to the checkout's reports/results and README.md instead.")
    ] = False,
) -> None:
    """Write pages, charts, errors.csv and timings.csv from what is stored."""
    if publish:
        refuse_outside_a_checkout()
    nothing = BadInput(f"{results} holds nothing for the present sources: {with_folder('crosscheck run', results)}")
    if not (results / STORE).exists():
        raise nothing
    from reports.cli.known import registered, with_remembered
    from reports.cli.selection import page_cells
    from reports.grid.running import missing
    from reports.pages.page import Material
    from reports.text.rendering import render_all, render_readme

    own = registered()
    with Store.read(results / STORE) as store:
        # What is published is of what is registered; a report of one's own shows what else was run.
        known = own if publish else with_remembered(own, store.remembered())
        # What a page borrows belongs to the full grid as far as the page that it is borrowed from runs it.
        shown = [item for page in own.pages for item in (*page_cells(page), *page.all_tasks())]
        borrowed = {cell for page in own.pages for cell in page.borrowed}
        run = {cell for page in own.pages if not page.borrowed for cell in page_cells(page)}
        whole = tuple(dict.fromkeys(item for item in shown if item not in borrowed or item in run))
        material = {
            page: Material(store.get(page_cells(page)), store.answers(page.all_tasks())) for page in known.pages
        }
        left = len(missing(whole, store))
    names = {page.name for page in own.pages}
    # A scene that is only remembered, and whose sources have changed since, has nothing to show.
    material = {page: given for page, given in material.items() if given.rows or page.name in names}
    command = with_folder("crosscheck run --full", results)
    grid = f"{left} of {len(whole)} cells of the full grid are not stored: {command}"
    if not any(given.rows for given in material.values()):
        raise nothing
    if publish and left:
        raise BadInput(f"nothing is published, {grid}")
    folder = published() if publish else results
    files = render_all(material, "make report" if publish else "crosscheck report")
    texts = {folder / name: text for name, text in files.items()}
    if publish:
        readme = CHECKOUT / "README.md"
        texts[readme] = render_readme(readme.read_text(encoding="utf-8"), material)
    with kept() as check:  # between two files is no place to stop
        write_whole(texts, "the pages that were there stay as they were")
        check()
    terminal = Terminal(140)
    terminal.say(f"{len(files)} files written to {folder}, index.md is the first to read")
    if left:
        terminal.say(grid)


def published() -> Path:
    """Where the published results stand in a checkout."""
    return CHECKOUT / "reports" / "results"


def refuse_outside_a_checkout() -> None:
    """Raises BadInput unless the package lies in a checkout: an installed copy has no README to write."""
    for path in (CHECKOUT / "README.md", published() / "index.md"):
        if not path.is_file():
            raise BadInput(f"--publish is for a checkout of the project; there is no {path}")
