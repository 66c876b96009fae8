"""`crosscheck versions`: released versions of an engine, each in a process of its own, side by side."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, STORE, AsJson, AsMarkdown, Folder
from reports.cli.streams import said
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reference.scene import Scene
    from reports.cli.terminal import Terminal
    from reports.model.measure import Measurement
    from reports.versions.builds import Progress
    from reports.versions.column import VersionColumn
    from reports.versions.table import ReleaseTable

WIDTH = 150  # into a file or a pipe
USUAL = "Only these scenes (repeatable, or with commas); six short ones if none is named."


def versions(
    engine: Annotated[str | None, typer.Argument(help="An engine by name, such as mujoco.")] = None,
    version: Annotated[list[str] | None, typer.Argument(help="Its versions, such as 3.6.0.")] = None,
    scenes: Annotated[list[str] | None, typer.Option("--scenes", help=USUAL)] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="All that the page shows: engines, scenes, random trees.")
    ] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run again what is already stored.")] = False,
    publish: Annotated[
        bool, typer.Option("--publish", help="Renew the data of the page in the checkout (only with --all).")
    ] = False,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Run scenes in released versions of an engine; each is installed once, in the user's cache folder."""
    from reports.cli.report import published, refuse_outside_a_checkout
    from reports.cli.run import refuse_nothing_but_failures
    from reports.cli.terminal import telling
    from reports.run.files import write_whole
    from reports.versions.builds import SCENES
    from reports.versions.table import DATA, as_csv, as_published, merged, read, released

    if publish:
        refuse_outside_a_checkout()
    wanted = _versions_by_engine(engine, version or (), everything)
    if publish and (not everything or scenes):
        raise BadInput("--publish renews all of the page's data: give it with --all, and without --scenes")
    chosen = named_scenes(scenes or (() if everything else SCENES))
    wrong: list[str] = []
    rows: list[Measurement] = []
    with telling(WIDTH, as_json, as_markdown) as console, kept() as check:
        run = _runner(console, check, chosen, results / STORE, fresh, everything and not scenes)
        table = released(Path(results) / DATA.name) if everything else None
        for name, numbers in wanted.items():
            columns = []
            for number in numbers:
                try:
                    columns.append(run(name, number))
                except BadInput as reason:
                    if not everything and len(numbers) == 1:
                        raise
                    wrong.append(f"{name} {number}: {reason}")
                    said(wrong[-1])
                    continue
                rows += columns[-1].rows
                if table is not None:
                    table = merged(table, _table(name, columns[-1:]))
                    write_whole({Path(results) / DATA.name: as_csv(table)}, "what is stored is kept")
            _print(console, _table(name, columns), name)
        if publish and table is not None and not wrong:
            renewed = as_published(table, read(published() / DATA.name))
            write_whole({published() / DATA.name: as_csv(renewed)}, "the file that was there stays as it was")
            console.say(f"{published() / DATA.name} is renewed")
        refuse_nothing_but_failures(rows)
    if wrong:
        raise BadInput(f"{len(wrong)} of the versions could not be run, the others are stored; the first: {wrong[0]}")


def _runner(
    console: Terminal, check: Callable[[], None], scenes: tuple[Scene, ...], store: Path, fresh: bool, trees: bool
) -> Callable[[str, str], VersionColumn]:
    """A function that runs a release and prints what became of it."""
    from time import monotonic

    from reports.cli.selection import QUICK_CELL
    from reports.versions.builds import run_release

    terms: dict[str, Any] = {"most": QUICK_CELL, "trees": True} if trees else {}

    def run(name: str, number: str) -> VersionColumn:
        begin = monotonic()
        progress = progress_of(console, check)
        column = run_release(name, number, scenes, store, progress, announce_pip, fresh=fresh, **terms)
        console.say(f"{name} {number}: {len(column.rows)} rows after {monotonic() - begin:.0f} s")
        if reason := column.trouble or column.mark:
            console.tell(f"{name} {number}: {reason}")
        return column

    return run


def progress_of(console: Terminal, check: Callable[[], None]) -> Progress:
    """The progress of columns on a terminal; `check` for Ctrl-C."""

    @contextmanager
    def shown(label: str, count: int) -> Iterator[tuple[Callable[..., None], Callable[[Sequence[str]], None]]]:
        from reports.cli.terminal import progress

        with progress(console, count, check, f"cells of {label}") as (done, watch):
            yield done, lambda labels: watch([SimpleNamespace(label=each) for each in labels])

    return shown


def installed_once(words: Iterable[str]) -> None:
    """Install releases, NAME==VERSION, unless they are there. Raises BadInput."""
    from reports.run.installed import installed
    from reports.versions.catalogue import distributions, engines_named

    for name, _, number in (word.partition("==") for word in words):
        installed(distributions(engines_named(name)[0]), number)


def _versions_by_engine(
    engine: str | None, numbers: list[str] | tuple[str, ...], everything: bool
) -> dict[str, tuple[str, ...]]:
    """Engine -> versions. Raises BadInput for words that don't go together, or are not known."""
    from reports.versions.catalogue import compared_versions, engines_named

    if everything:
        if engine is not None:
            raise BadInput("--all runs the versions of every engine; leave the engine out")
        return compared_versions()
    if engine is None:
        raise BadInput("name an engine and versions, such as: crosscheck versions mujoco 3.6.0 4.0.1; or give --all")
    engines_named(engine)
    if not numbers:
        known = " ".join(compared_versions().get(engine, ()))
        raise BadInput(f"name versions of {engine}" + (f", such as {known}" if known else ""))
    return {engine: tuple(dict.fromkeys(numbers))}


def named_scenes(words: list[str] | tuple[str, ...]) -> tuple[Scene, ...]:
    """The scenes named; else those whose run at a usual step is short. Raises BadInput."""
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_scenes

    names = [name.strip() for word in words for name in word.split(",") if name.strip()]
    known, names, _ = with_words(registered(), names, None)
    return choose_scenes(names, known.scenes, known.pages)


def announce_pip(word: str) -> None:
    """Before a wait. It is progress, and does not begin as a refusal does."""
    print(f"{word}: installed by pip, unless it is there already", file=sys.stderr, flush=True)


def _table(name: str, columns: list[VersionColumn]) -> ReleaseTable:
    from reports.model.catalogue import PAGES
    from reports.versions.table import ReleaseTable, entries

    quantities = {scene.name: page.quantity for page in PAGES for scene in page.scenes}
    marks = {(name, each.version): each.trouble or each.mark for each in columns if each.trouble or each.mark}
    return ReleaseTable(tuple(entry for each in columns for entry in entries(name, each, quantities)), marks)


def _print(console: Terminal, table: ReleaseTable, name: str) -> None:
    """Errors at a usual step, a line a scene and method, a column a version; outcomes where there is no error."""
    from reports.cli.terminal import print_table
    from reports.versions.table import changes

    numbers = table.versions(name)
    lines: dict[tuple[str, str, str], dict[str, str | float]] = {}
    for entry in table.entries:
        key = entry.scene, entry.variant, f"{entry.quantity} [{entry.unit}]"
        lines.setdefault(key, {})[entry.version] = entry.error if entry.comparable else entry.outcome
    words: dict[tuple[str, str], list[str]] = {}
    for _, after, word in changes(table.entries):
        words.setdefault((after.scene, after.variant), []).append(f"{after.version} {word}")
    rows = [
        [*key, *(found.get(each, "-") for each in numbers), "; ".join(words.get(key[:2], ["nothing changed"]))]
        for key, found in sorted(lines.items())
    ]
    if rows:
        console.print()
        header = ("scene", "method", "largest error", *(f"{name} {each}" for each in numbers), "change")
        print_table(console, f"{name}: largest errors; a change is one by more than three times", header, rows, 3)
