"""`crosscheck site` writes the results as a static site. Motions of lessons that are not stored are run first."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from reports.cli.interruption import delayed_signals
from reports.cli.options import FOLDER, SITE, STORE, Folder, with_folder
from reports.cli.report import CHECKOUT, published
from reports.cli.run import run_interruptible
from reports.cli.streams import said
from reports.cli.terminal import Terminal, opened
from reports.model.ending import BadInput
from reports.model.tasks import Answer, Motion
from reports.run.files import folder_for
from reports.site.build import SiteSource, build, tasks
from reports.site.folder import REMEDY, refuse_strangers, serve_folder, server, write_site
from reports.site.generator import require_packages
from reports.site.packages import npm_trouble
from reports.write.provenance import versions

NPM_CACHE = "npm"  # Name of the folder with downloaded packages, inside the folder of results.


def site(
    output: Annotated[Path, typer.Option(help="Where the site is written.")] = SITE,
    pages: Annotated[
        Path | None,
        typer.Option(help="Folder with the pages that `crosscheck report` wrote; the published ones unless given."),
    ] = None,
    serve: Annotated[bool, typer.Option("--serve", help="Then show it at http://localhost:8000 until Ctrl-C.")] = False,
    port: Annotated[int, typer.Option(help="Another port for --serve.")] = 8000,
    results: Folder = FOLDER,
) -> None:
    """Write the results as a static site: lessons with moving pictures, tables, charts, engines in the page."""
    if not 0 < port < 65536:
        raise BadInput(f"--port is {port}; give a number from 1 to 65535")
    folder = pages or (published() if (published() / "index.md").is_file() else results)
    if not (folder / "index.md").is_file():
        command = with_folder("crosscheck report", results)
        raise BadInput(f"{folder} has no index.md: write the pages first with {command}, or name --pages")
    require_packages()
    refuse_strangers(output)
    folder_for(output.absolute().parent, REMEDY)  # before any run
    if serve:
        server(Path(), port).server_close()
    terminal = Terminal(140)
    source = SiteSource(
        **texts_of(folder),
        answers={},
        cache=results / NPM_CACHE,
        foot=f"Made by crosscheck site with {versions(())}.".replace("`", ""),
        contributing=_of_checkout("CONTRIBUTING.md"),
        lecture=_of_checkout("lecture.ipynb"),
    )
    if trouble := npm_trouble(source.cache):  # The message comes now, since building takes long.
        said(f"parts of the site will be missing: {trouble}")
    source.answers = _answers(terminal, results)
    files = build(source)
    with delayed_signals() as check:
        size = write_site(output, files)
        check()
    for trouble in source.troubles:
        said(trouble)
    terminal.say(
        f"{len(files)} files written to {output}, {size / 1e6:.2f} MB when compressed; index.html is the first"
    )
    if serve:
        terminal.say(f"http://localhost:{port} shows it; Ctrl-C ends")
        serve_folder(output, port)


def texts_of(folder: Path) -> dict[str, Any]:
    """The texts in a folder of results, as keyword arguments of `SiteSource`."""

    def texts(*patterns: str) -> dict[str, str]:
        paths = [path for pattern in patterns for path in sorted(folder.glob(pattern))]
        return {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in paths}

    tables = texts("*.csv", "programs/*.py", "upstream/*.md")
    return {"pages": texts("*.md"), "pictures": texts("*.svg"), "tables": tables}


def _of_checkout(name: str) -> str:
    path = CHECKOUT / name
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def _answers(terminal: Terminal, results: Path) -> dict[Motion, Answer]:
    wanted = tasks()
    with opened(results / STORE) as store:
        run_interruptible(terminal, store, wanted, fresh=False, limit=60.0)
        answers = store.answers(wanted)
    return {task: answers[task] for task in wanted if task in answers}
