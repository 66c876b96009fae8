"""`crosscheck versions` runs scenes in released versions of an engine and prints a table of errors."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from types import SimpleNamespace
from typing import Annotated, Any

import typer

from reference.scene import Scene
from reports.cli.interruption import delayed_signals
from reports.cli.known import choose
from reports.cli.options import FOLDER, STORE, AsJson, AsMarkdown, Folder, SomeScenes
from reports.cli.report import published, refuse_outside_a_checkout
from reports.cli.run import refuse_nothing_but_failures
from reports.cli.selection import QUICK_CELL
from reports.cli.streams import said
from reports.cli.terminal import Terminal, print_table, progress, telling
from reports.model.catalogue import PAGES
from reports.model.ending import BadInput
from reports.model.measure import Measurement
from reports.run.files import write_whole
from reports.versions.builds import SCENES, Progress, engines_named, run_release
from reports.versions.column import VersionColumn
from reports.versions.table import (
    DATA,
    RELEASES,
    ReleaseTable,
    as_csv,
    as_published,
    changes,
    entries,
    merged,
    read,
    released,
)

WIDTH = 150  # Number of columns of a table in a file or a pipe.


def versions(
    engine: Annotated[str | None, typer.Argument(help="An engine by name, such as mujoco.")] = None,
    version: Annotated[list[str] | None, typer.Argument(help="Its versions, such as 3.6.0.")] = None,
    scenes: SomeScenes = None,
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
    """Run scenes in released versions of an engine. A version is installed once, in the user's cache folder."""
    if publish:
        refuse_outside_a_checkout()
    wanted = _versions_by_engine(engine, version or (), everything)
    if publish and (not everything or scenes):
        raise BadInput("--publish renews all of the page's data: give it with --all, and without --scenes")
    chosen, data = named_scenes(scenes or (() if everything else SCENES)), Path(results) / DATA.name
    options: dict[str, Any] = {"most": QUICK_CELL, "trees": True} if everything and not scenes else {}
    table = released(data) if everything else None
    wrong: list[str] = []
    rows: list[Measurement] = []
    with telling(WIDTH, as_json, as_markdown) as console, delayed_signals() as check:
        for name, numbers in wanted.items():
            columns = []
            for number in numbers:
                try:
                    column = _run(console, check, name, number, chosen, results / STORE, fresh=fresh, **options)
                except BadInput as reason:
                    if not everything and len(numbers) == 1:
                        raise
                    wrong.append(f"{name} {number}: {reason}")
                    said(wrong[-1])
                    continue
                columns.append(column)
                rows += column.rows
                if table is not None:
                    table = merged(table, _table(name, [column]))
                    write_whole({data: as_csv(table)}, "what is stored is kept")
            _print(console, _table(name, columns), name)
        if publish and table is not None and not wrong:
            target = published() / DATA.name
            write_whole({target: as_csv(as_published(table, read(target)))}, "the file that was there stays as it was")
            console.say(f"{target} is renewed")
        refuse_nothing_but_failures(rows)
    if wrong:
        raise BadInput(f"{len(wrong)} of the versions could not be run, the others are stored; the first: {wrong[0]}")


def _run(
    console: Terminal,
    check: Callable[[], None],
    name: str,
    number: str,
    scenes: tuple[Scene, ...],
    store: Path,
    **terms: Any,
) -> VersionColumn:
    begin = monotonic()
    column = run_release(name, number, scenes, store, progress_of(console, check), announce_pip, **terms)
    console.say(f"{name} {number}: {len(column.rows)} rows after {monotonic() - begin:.0f} s")
    if reason := column.trouble or column.mark:
        console.tell(f"{name} {number}: {reason}")
    return column


def progress_of(console: Terminal, check: Callable[[], None]) -> Progress:
    """A Progress that shows the cells of a version on a terminal. After Ctrl-C, `check` raises."""

    @contextmanager
    def shown(label: str, count: int) -> Iterator[tuple[Callable[..., None], Callable[[Sequence[str]], None]]]:
        with progress(console, count, check, f"cells of {label}") as (done, watch):
            yield done, lambda labels: watch([SimpleNamespace(label=name) for name in labels])

    return shown


def _versions_by_engine(
    engine: str | None, numbers: list[str] | tuple[str, ...], everything: bool
) -> dict[str, tuple[str, ...]]:
    if everything:
        if engine is not None:
            raise BadInput("--all runs the versions of every engine; leave the engine out")
        return {name: tuple(versions) for name, versions in RELEASES.items()}
    if engine is None:
        raise BadInput("name an engine and versions, such as: crosscheck versions mujoco 3.6.0 4.0.1; or give --all")
    engines_named(engine)
    if not numbers:
        text = " ".join(RELEASES.get(engine, ()))
        raise BadInput(f"name versions of {engine}" + (f", such as {text}" if text else ""))
    return {engine: tuple(dict.fromkeys(numbers))}


def named_scenes(words: list[str] | tuple[str, ...]) -> tuple[Scene, ...]:
    """The scenes with these names, which commas may separate. No names select all scenes. Raises BadInput."""
    names = [name.strip() for argument in words for name in argument.split(",") if name.strip()]
    return choose(names).scenes


def announce_pip(word: str) -> None:
    """Print a line on stderr before pip runs, without the prefix of an error message."""
    print(f"{word}: installed by pip, unless it is there already", file=sys.stderr, flush=True)


def _table(name: str, columns: list[VersionColumn]) -> ReleaseTable:
    quantities = {scene.name: page.quantity for page in PAGES for scene in page.scenes}
    marks = {
        (name, column.version): column.trouble or column.mark for column in columns if column.trouble or column.mark
    }
    return ReleaseTable(tuple(entry for column in columns for entry in entries(name, column, quantities)), marks)


def _print(console: Terminal, table: ReleaseTable, name: str) -> None:
    numbers = table.versions(name)
    lines: dict[tuple[str, str, str], dict[str, str | float]] = {}
    for entry in table.entries:
        key = entry.scene, entry.variant, f"{entry.quantity} [{entry.unit}]"
        lines.setdefault(key, {})[entry.version] = entry.error if entry.comparable else entry.outcome
    changes_by_method: dict[tuple[str, str], list[str]] = {}
    for _, entry, change_text in changes(table.entries):
        changes_by_method.setdefault((entry.scene, entry.variant), []).append(f"{entry.version} {change_text}")
    rows = [
        [
            *key,
            *(values.get(number, "-") for number in numbers),
            "; ".join(changes_by_method.get(key[:2], ["nothing changed"])),
        ]
        for key, values in sorted(lines.items())
    ]
    if rows:
        console.print()
        header = ("scene", "method", "largest error", *(f"{name} {number}" for number in numbers), "change")
        print_table(console, f"{name}: largest errors; a change is one by more than three times", header, rows, 3)
