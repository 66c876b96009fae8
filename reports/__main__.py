"""The command line, `crosscheck` or `python -m reports`, and the only file that writes pages."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from reports.choice import (
    BadInput,
    choose_cells,
    choose_engines,
    choose_scenes,
    grid_engines,
    known_engines,
    page_cells,
)
from reports.errata_command import errata
from reports.measure import Measurement
from reports.shapes_command import shapes
from reports.supervisor import WorkersLost

RESULTS = Path(__file__).parent / "results"
README = Path(__file__).parents[1] / "README.md"
STORE = "cells.sqlite"
INTERRUPTED = 130  # what a shell expects of a program ended by Ctrl-C

app = typer.Typer(
    help="How far a physics engine's constraints are from ideal ones, on planar mechanisms with an analytic truth.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
# Into a file or a pipe a table keeps its width, whatever the terminal's.
console = Console(width=None if sys.stdout.isatty() else 140)

Folder = Annotated[Path, typer.Option("--results", help="Folder of the pages and of the stored results.")]
EngineName = Annotated[str | None, typer.Option("--engine", help="Only this engine.")]
VariantName = Annotated[str | None, typer.Option("--variant", help="Only this variant.")]


@app.command("list")
def list_command() -> None:
    """Scenes, engines and variants, and what is unsupported, with the reason."""
    from engines.registry import ENGINES
    from reference.scenes import SCENES
    from reports.cells import Cell
    from reports.running import support
    from reports.terminal import print_table

    scenes = [(scene.name, scene.page, scene.source, f"{scene.duration:.4g}") for scene in SCENES]
    print_table(console, "Scenes", ["scene", "page", "source", "duration [s]"], scenes, 3)
    console.print()
    print_table(
        console, "Engines", ["engine", "variant", "settings"], [(e.name, e.variant, repr(e)) for e in ENGINES], 3
    )
    console.print()
    reasons = support([Cell(scene, engine, 1) for scene in SCENES for engine in ENGINES])
    # Sorted: workers answer in any order.
    rows = sorted((c.scene.name, f"{c.engine.name} {c.engine.variant}", why) for c, why in reasons.items() if why)
    if rows:
        print_table(console, "Unsupported", ["scene", "method", "why"], rows, 3)
    else:
        console.print("Every engine variant builds every scene.")


@app.command()
def run(
    scene: Annotated[list[str] | None, typer.Argument(help="Scenes or pages; all of them if none is named.")] = None,
    engine: EngineName = None,
    variant: VariantName = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="Fine steps and stability maps too.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run again what is already stored.")] = False,
    every: Annotated[list[int] | None, typer.Option(help="Only this many steps between samples (repeatable).")] = None,
    step: Annotated[list[float] | None, typer.Option(help="Only this step [s]; must divide the sampling.")] = None,
    limit: Annotated[float, typer.Option(help="CPU seconds after which a cell is ended.")] = 60.0,
    results: Folder = RESULTS,
) -> None:
    """Run the cells that are not stored yet; what is done survives an interruption."""
    from reference.scenes import SCENES
    from reports.pages import PAGES
    from reports.running import missing, run_into
    from reports.store import Store
    from reports.terminal import progress

    if not 0 < limit < float("inf"):
        raise BadInput(f"--limit is {limit}; it must be a finite number of seconds greater than zero")
    cells = choose_cells(
        choose_scenes(scene or (), SCENES),
        choose_engines(engine, variant, known_engines(PAGES)),
        PAGES,
        full,
        every or (),
        step or (),
    )
    with Store(results / STORE) as store:
        waiting = cells if fresh else missing(cells, store, limit)
        try:
            with progress(console, len(waiting)) as (done, watch):
                count = run_into(store, cells, fresh, limit, done=done, watch=watch)
        except KeyboardInterrupt:
            left = len(missing(cells, store, limit))
            console.print(
                f"Stopped: {len(cells) - left} of {len(cells)} cells are stored; the next run goes on from there."
            )
            raise typer.Exit(INTERRUPTED) from None
        print_summary(list(store.get(cells).values()))
    console.print(f"{count} of {len(cells)} cells run, the others were stored. Next: crosscheck report")


def print_summary(rows: list[Measurement]) -> None:
    """A table a scene, a line a method; then what became of the experiments outside the sweeps."""
    from reports.sweep import judged
    from reports.tables import SUMMARY_HEADER, summary_rows
    from reports.terminal import print_table

    told = judged(rows)
    for scene in dict.fromkeys(row.scene for row in told if row.purpose == "sweep"):
        print_table(console, scene, SUMMARY_HEADER, summary_rows([row for row in told if row.scene == scene]), 1)
        console.print()
    extra = Counter(str(row.outcome) for row in rows if row.purpose != "sweep")
    if extra:
        console.print("Failure experiments and maps: " + ", ".join(f"{n} {o}" for o, n in sorted(extra.items())))


@app.command()
def report(results: Folder = RESULTS) -> None:
    """Write pages, charts, errors.csv and timings.csv from what is stored."""
    from reports.page import Material
    from reports.pages import PAGES
    from reports.rendering import render_all, render_readme
    from reports.running import trajectories
    from reports.store import Store

    wanted = {page: page_cells(page) for page in PAGES}
    with Store(results / STORE) as store:
        material = {page: Material(store.get(cells), trajectories) for page, cells in wanted.items()}
    found, total = sum(len(m.rows) for m in material.values()), sum(map(len, wanted.values()))
    if not found:
        raise BadInput("nothing is stored for the present sources: crosscheck run comes first")
    files = render_all(material, "crosscheck run --full && crosscheck report")
    for name, text in files.items():
        (results / name).write_text(text, encoding="utf-8", newline="\n")
    console.print(f"{len(files)} files written to {results}")
    if results == RESULTS:
        README.write_text(render_readme(README.read_text(encoding="utf-8"), material), encoding="utf-8", newline="\n")
    if found < total:
        console.print(f"{total - found} of {total} cells of the full grid are not stored: crosscheck run --full")


@app.command()
def show(
    scene: Annotated[str, typer.Argument(help="The scene.")],
    engine: EngineName = None,
    variant: VariantName = None,
    results: Folder = RESULTS,
) -> None:
    """Print a scene's stored numbers."""
    from reference.scenes import SCENES
    from reports.cells import FULL, sweep_cells
    from reports.pages import PAGES
    from reports.quantities import QUANTITIES
    from reports.store import Store
    from reports.sweep import judged, sweeps
    from reports.tables import ERROR_HEADER, error_rows, order_rows
    from reports.terminal import print_table

    chosen = choose_scenes([scene], SCENES)
    with Store(results / STORE) as store:
        engines = choose_engines(engine, variant, known_engines(PAGES))
        cells = [c for one in chosen for c in sweep_cells((one,), grid_engines(one, engines, PAGES), FULL)]
        rows = judged(store.get(cells).values())
    if not rows:
        raise BadInput(f"nothing is stored for {scene!r} and the present sources: crosscheck run {scene} comes first")
    for one in chosen:
        own = [row for row in rows if row.scene == one.name]
        print_table(console, f"{one.name}, {one.source}", ERROR_HEADER, error_rows(own), 2)
        console.print()
        names = [q.name for q in QUANTITIES]
        orders = [[cell.replace("**", "") for cell in line] for line in order_rows(sweeps(own), names)]
        print_table(console, "Order and plateau", ["method", *names], orders, 9)


@app.command()
def bench(
    scene: Annotated[list[str] | None, typer.Argument(help="Scenes or pages; all of them if none is named.")] = None,
) -> None:
    """Time `run` against bare stepping loops, and the reference against another library; prints, asserts nothing."""
    from engines.registry import ENGINES
    from reference.scenes import SCENES
    from reports.bench.loops import loop_costs
    from reports.machine import machine, versions
    from reports.tables import number
    from reports.terminal import print_table

    for one in choose_scenes(scene or (), SCENES):
        costs = loop_costs(ENGINES, one.mechanism(), one.spacing / 10, one.samples, 10)
        body = [
            (f"{c.engine.name} {c.engine.variant}", number(1e6 * c.bare), number(1e6 * c.run), f"{c.ratio:.3f}")
            for c in costs
        ]
        if body:
            header = ["method", "bare loop [us/step]", "run [us/step]", "ratio"]
            print_table(console, f"{one.name}: run over the bare loop", header, body, 1)
            console.print()
    from reports.bench import four_bar

    floor = four_bar.floor_ratio()
    console.print(f"four-bar kinematics, {floor['count']} crank angles, all six outputs: {floor['ours']:.3f} s,")
    console.print(f"  {floor['ratio']:.2f} times one tan and two arctan2 an angle")
    try:
        other = four_bar.pylinkage_ratio()
    except RuntimeError as reason:
        console.print(f"  {reason}: pip install -e '.\\[bench]'")
    else:
        console.print(f"  pylinkage {other['pylinkage']:.3f} s, {other['ratio']:.1f} times ours")
    console.print(f"{versions()}; {machine()}")


app.command("shapes")(shapes)
app.command("errata")(errata)


def main(arguments: list[str] | None = None) -> None:
    """Entry point. Bad input is one line on stderr and exit status 2, lost workers are status 1; Ctrl-C is 130."""
    try:
        status = app(arguments, standalone_mode=False, prog_name="crosscheck")
    except BadInput as error:
        print(f"crosscheck: {error}", file=sys.stderr)
        sys.exit(2)
    except WorkersLost as error:
        print(f"crosscheck: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    except Exception as error:
        # Usage errors of the command line's own library: it would print several lines.
        told = getattr(error, "format_message", None)
        if told is None:
            raise
        print(f"crosscheck: {told()}", file=sys.stderr)
        sys.exit(2)
    sys.exit(status if isinstance(status, int) else 0)


if __name__ == "__main__":
    main()
