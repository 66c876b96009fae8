"""The commands of the command line, and its help; `report`, `shapes` and `errata` have files of their own."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from typing import Annotated

import typer

from reports.cli.conform import conform
from reports.cli.errata import errata
from reports.cli.interruption import kept
from reports.cli.report import FOLDER, STORE, Folder, report, with_folder
from reports.cli.selection import choose_cells, choose_engines, choose_scenes, grid_engines, known_engines
from reports.cli.shapes import shapes
from reports.cli.terminal import Terminal, print_table, progress, written
from reports.grid.cells import Cell
from reports.grid.ending import FINE, STATUSES, BadInput
from reports.grid.measure import Measurement
from reports.grid.store import Store

app = typer.Typer(
    help="How far a physics engine's constraints are from ideal ones, on planar mechanisms with an analytic truth.",
    epilog=STATUSES,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
console = Terminal(140)

EngineName = Annotated[str | None, typer.Option("--engine", help="Only this engine.")]
VariantName = Annotated[str | None, typer.Option("--variant", help="Only this variant.")]


@app.command("list")
def list_command() -> None:
    """Scenes, engines and variants, and what is unsupported, with the reason."""
    from engines.registry import ENGINES
    from reference.scenes import SCENES
    from reports.grid.running import support
    from reports.pages.catalogue import page_of

    taught = {scene: page.name if (page := page_of(scene)) else "" for scene in SCENES}
    scenes = [(scene.name, taught[scene], scene.source, f"{scene.duration:.4g}") for scene in SCENES]
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
    results: Folder = FOLDER,
) -> None:
    """Run the cells that are not stored yet; what is done survives an interruption."""
    from reference.scenes import SCENES
    from reports.pages.catalogue import PAGES

    if not 0 < limit < float("inf"):
        raise BadInput(f"--limit is {limit}; it must be a finite number of seconds greater than zero")
    cells = choose_cells(
        choose_scenes(scene or (), SCENES, PAGES),
        choose_engines(engine, variant, known_engines(PAGES)),
        PAGES,
        full,
        every or (),
        step or (),
    )
    with Store(results / STORE) as store:
        if store.notice:
            print(f"crosscheck: {store.notice}", file=sys.stderr)
        count = run_interruptible(store, cells, fresh, limit)
        print_summary(list(store.get(cells).values()))
    following = with_folder("crosscheck report", results)
    console.say(f"{count} of {len(cells)} cells run, the others were stored. Next: {following}")


def run_interruptible(store: Store, cells: Sequence[Cell], fresh: bool, limit: float) -> int:
    """Run cells with a bar of progress; how many were run. Raises KeyboardInterrupt, having said what is stored."""
    from reports.grid.running import missing, run_into

    with kept() as check:
        waiting = len(cells) if fresh else len(missing(cells, store, limit))
        try:
            with progress(console, waiting, check) as (done, watch):
                count = run_into(store, cells, fresh, limit, done=done, watch=watch)
            check()
        except KeyboardInterrupt:
            stored = len(cells) - len(missing(cells, store, limit))
            console.say(f"Stopped: {stored} of {len(cells)} cells are stored; the next run goes on from there.")
            raise
    return count


def print_summary(rows: list[Measurement]) -> None:
    """A table a scene, a line a method; then what became of the experiments outside the sweeps."""
    from reports.grid.convergence import judged
    from reports.text.tables import SUMMARY_HEADER, summary_rows

    told = judged(rows)
    for scene in dict.fromkeys(row.scene for row in told if row.purpose == "sweep"):
        print_table(console, scene, SUMMARY_HEADER, summary_rows([row for row in told if row.scene == scene]), 1)
        console.print()
    extra = Counter(str(row.outcome) for row in rows if row.purpose != "sweep")
    if extra:
        console.print("Failure experiments and maps: " + ", ".join(f"{n} {o}" for o, n in sorted(extra.items())))


@app.command()
def show(
    scene: Annotated[str, typer.Argument(help="The scene.")],
    engine: EngineName = None,
    variant: VariantName = None,
    results: Folder = FOLDER,
) -> None:
    """Print a scene's stored numbers."""
    from reference.scenes import SCENES
    from reports.pages.catalogue import PAGES

    chosen = choose_scenes([scene], SCENES, PAGES)
    command = with_folder(f"crosscheck run {scene}", results)
    nothing = BadInput(f"{results} holds nothing for {scene!r} and the present sources: {command}")
    if not (results / STORE).exists():
        raise nothing
    from reports.grid.cells import FULL, sweep_cells
    from reports.grid.convergence import judged, sweeps
    from reports.grid.quantities import QUANTITIES
    from reports.text.tables import ERROR_HEADER, error_rows, order_rows

    with Store.read(results / STORE) as store:
        engines = choose_engines(engine, variant, known_engines(PAGES))
        cells = [c for one in chosen for c in sweep_cells((one,), grid_engines(one, engines, PAGES), FULL)]
        rows = judged(store.get(cells).values())
    if not rows:
        raise nothing
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
    from reports.pages.catalogue import PAGES
    from reports.text.provenance import machine, versions
    from reports.text.tables import number

    for one in choose_scenes(scene or (), SCENES, PAGES):
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


app.command("report")(report)
app.command("shapes")(shapes)
app.command("errata")(errata)
app.command("conform")(conform)


def invoke(arguments: Sequence[str]) -> int:
    """Run a command; its exit status. Raises what it raises, and the usage errors of typer."""
    command = typer.main.get_command(app)
    status = FINE
    try:
        # Not its own `main`: that turns a closed pipe and Ctrl-C into statuses of its own.
        with written():  # the help, if it is asked for
            context = command.make_context("crosscheck", list(arguments) or ["--help"])
        with context:
            command.invoke(context)
    except typer.Exit as done:
        status = done.exit_code
    with written():
        return status
