"""`crosscheck versions`: released versions of an engine, each in a process of its own, side by side."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, STORE, Folder
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from engines import Engine
    from reference.scene import Scene
    from reports.cli.terminal import Terminal
    from reports.versions.column import VersionColumn
    from reports.versions.table import Table

WIDTH = 150  # into a file or a pipe
DATA = "versions.csv"


def versions(
    engine: Annotated[str | None, typer.Argument(help="An engine by name, such as mujoco.")] = None,
    version: Annotated[list[str] | None, typer.Argument(help="Its versions, such as 3.6.0.")] = None,
    scenes: Annotated[
        list[str] | None, typer.Option("--scenes", help="Only these scenes (repeatable, or with commas).")
    ] = None,
    everything: Annotated[bool, typer.Option("--all", help="The versions of all engines that the page shows.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run again what is already stored.")] = False,
    publish: Annotated[
        bool, typer.Option("--publish", help="Renew the data of the page in the checkout (only with --all).")
    ] = False,
    results: Folder = FOLDER,
) -> None:
    """Run scenes in released versions of an engine; each is installed once, in the user's cache folder."""
    from engines.registry import OTHERS, VARIANTS
    from reports.cli.report import published, refuse_outside_a_checkout
    from reports.cli.terminal import Terminal
    from reports.run.files import write_whole
    from reports.versions.table import as_csv, as_published, catalogued, merged, read

    if publish:
        refuse_outside_a_checkout()
    asked = _asked(engine, version or (), everything)
    if publish and (not everything or scenes):
        raise BadInput("--publish renews all of the page's data: give it with --all, and without --scenes")
    chosen = named_scenes(scenes or ())
    console = Terminal(WIDTH)
    wrong: list[str] = []
    with kept() as check:
        table = catalogued(read(Path(results) / DATA)) if everything else None
        for name, numbers in asked.items():
            engines = [each for each in (*VARIANTS, *OTHERS) if each.name == name]
            found = []
            for number in numbers:
                try:
                    column = _column(console, name, number, engines, chosen, results, fresh, not scenes, check)
                except BadInput as reason:
                    if not everything and len(numbers) == 1:
                        raise
                    wrong.append(f"{name} {number}: {reason}")
                    print(f"crosscheck: {wrong[-1]}", file=sys.stderr)
                    continue
                found.append(column)
                if table is not None:
                    table = merged(table, _table(name, [column]))
                    write_whole({Path(results) / DATA: as_csv(table)}, "what is stored is kept")
            _print(console, _table(name, found), name)
        if publish and table is not None and not wrong:
            renewed = as_published(table, read(published() / DATA))
            write_whole({published() / DATA: as_csv(renewed)}, "the file that was there stays as it was")
            console.say(f"{published() / DATA} is renewed")
    if wrong:
        raise BadInput(f"{len(wrong)} of the versions could not be run, the others are stored; the first: {wrong[0]}")


def _asked(engine: str | None, numbers: list[str] | tuple[str, ...], everything: bool) -> dict[str, tuple[str, ...]]:
    """Engine -> versions. Raises BadInput for words that don't go together, or are not known."""
    from engines.registry import OTHERS, VARIANTS
    from reports.versions.catalogue import compared_versions, distributions

    if everything:
        if engine is not None:
            raise BadInput("--all runs the versions of every engine; leave the engine out")
        return compared_versions()
    if engine is None:
        raise BadInput("name an engine and versions, such as: crosscheck versions mujoco 3.6.0 4.0.1; or give --all")
    distributions((*VARIANTS, *OTHERS), engine)
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


def _column(
    console: Terminal,
    name: str,
    number: str,
    engines: list[Engine],
    scenes: tuple[Scene, ...],
    results: Path,
    fresh: bool,
    trees: bool,
    check: object,
) -> VersionColumn:
    from time import monotonic

    from reports.cli.selection import QUICK_CELL
    from reports.run.installed import installed
    from reports.versions.catalogue import distributions
    from reports.versions.column import VersionRequest, column, modules_in

    place = installed(distributions(engines, name), number)
    begin = monotonic()
    request = VersionRequest(
        scenes,
        name,
        modules_in(place),
        place,
        (results / STORE).absolute(),
        most=QUICK_CELL if trees else float("inf"),
        trees=trees,
        fresh=fresh,
        folder=Path.cwd(),
    )
    found = column(number, request, engines, lambda labels: check())  # type: ignore[operator]
    told = found.trouble or found.mark
    line = f"{name} {number}: {len(found.rows)} rows after {monotonic() - begin:.0f} s"
    console.say(f"{line}; {told}" if told else line)
    return found


def _table(name: str, columns: list[VersionColumn]) -> Table:
    from reports.model.catalogue import PAGES
    from reports.versions.table import Table, entries

    quantities = {scene.name: page.quantity for page in PAGES for scene in page.scenes}
    marks = {(name, each.version): each.trouble or each.mark for each in columns if each.trouble or each.mark}
    return Table(tuple(entry for each in columns for entry in entries(name, each, quantities)), marks)


def _print(console: Terminal, table: Table, name: str) -> None:
    """Errors at a usual step, a line a scene and method, a column a version; outcomes where there is no error."""
    from reports.cli.terminal import print_table
    from reports.write.tables import number

    numbers = table.versions(name)
    lines: dict[tuple[str, str], dict[str, str]] = {}
    for entry in table.entries:
        told = number(entry.error) if entry.comparable else entry.outcome
        lines.setdefault((entry.scene, entry.variant), {})[entry.version] = told
    rows = [[*key, *(found.get(each, "-") for each in numbers)] for key, found in sorted(lines.items())]
    if rows:
        console.print()
        print_table(console, f"{name}: largest error", ("scene", "method", *numbers), rows, 2)
