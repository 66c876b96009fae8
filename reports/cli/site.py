"""`crosscheck site`: the results as a static site, with motions that are run for it if they are not stored."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, STORE, Folder, with_folder
from reports.cli.report import CHECKOUT
from reports.cli.streams import said
from reports.cli.terminal import Terminal
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reports.model.tasks import Answer, Motion

PUBLISHED = CHECKOUT / "reports" / "results"
SITE = Path("crosscheck-site")
CACHE = "npm"  # the folder in that of the results with the packages that were fetched


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
    from reports.run.files import folder_for
    from reports.site.build import build
    from reports.site.folder import REMEDY, refuse_strangers, serve_folder, server, write_site
    from reports.site.generator import require_packages
    from reports.site.lesson import Source

    if not 0 < port < 65536:
        raise BadInput(f"--port is {port}; give a number from 1 to 65535")
    folder = pages or (PUBLISHED if (PUBLISHED / "index.md").is_file() else results)
    if not (folder / "index.md").is_file():
        command = with_folder("crosscheck report", results)
        raise BadInput(f"{folder} has no index.md: write the pages first with {command}, or name --pages")
    require_packages()
    refuse_strangers(output)
    folder_for(output.absolute().parent, REMEDY)  # before anything is run
    if serve:
        server(Path(), port).server_close()
    console = Terminal(140)
    source = Source(
        **texts_of(folder),
        answers={},
        cache=results / CACHE,
        foot=_foot(),
        contributing=_of_checkout("CONTRIBUTING.md"),
        lecture=_of_checkout("lecture.ipynb"),
    )
    if source.registry.trouble:  # at once, for the rest takes a while
        said(f"parts of the site will be missing: {source.registry.trouble}")
    source.answers = _answers(console, results)
    files = build(source)
    with kept() as check:
        size = write_site(output, files)
        check()
    for trouble in source.troubles:
        said(trouble)
    console.say(f"{len(files)} files written to {output}, {size / 1e6:.2f} MB when compressed; index.html is the first")
    if serve:
        console.say(f"http://localhost:{port} shows it; Ctrl-C ends")
        serve_folder(output, port)


def texts_of(folder: Path) -> dict[str, Any]:
    """What a site shows of a folder of results, as fields of `Source`."""
    tables = _texts(folder, "*.csv") | _texts(folder, "programs/*.py") | _texts(folder, "upstream/*.md")
    return {"pages": _texts(folder, "*.md"), "pictures": _texts(folder, "*.svg"), "tables": tables}


def _texts(folder: Path, pattern: str) -> dict[str, str]:
    found = sorted(folder.glob(pattern))
    return {path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in found}


def _of_checkout(name: str) -> str:
    path = CHECKOUT / name
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def _answers(console: Terminal, results: Path) -> dict[Motion, Answer]:
    """The motions of the lessons; those that are not stored are run by the pool first."""
    from reports.cli.run import run_interruptible
    from reports.cli.terminal import opened
    from reports.site.build import tasks

    wanted = tasks()
    with opened(results / STORE) as store:
        run_interruptible(console, store, wanted, fresh=False, limit=60.0)
        found = store.answers(wanted)
    return {task: found[task] for task in wanted if task in found}


def _foot() -> str:
    from reports.write.provenance import versions

    return f"Made by `crosscheck site` with {versions(())}.".replace("`", "")
