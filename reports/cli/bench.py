"""`crosscheck bench` prints tables of the measurements in `reports.bench`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from engines import method_name
from engines.lagrange import loading
from engines.registry import ENGINES
from reports.bench import peers
from reports.bench.site import measure_site
from reports.bench.times import (
    COMMAND_TURNS,
    WORLD_COUNTS,
    measure_batch,
    measure_command,
    measure_grid,
    measure_judge,
    measure_loops,
    measure_trees,
    measure_truths,
    measure_worlds,
)
from reports.cli.known import choose
from reports.cli.options import FOLDER, SITE, DeviceName, Folder, Scenes, choose_device, listed, refuse_file
from reports.cli.report import published, refuse_outside_a_checkout, write_files
from reports.cli.selection import choose_cells
from reports.cli.terminal import Terminal, print_table
from reports.model.ending import BadInput
from reports.model.page import Material
from reports.pages.rendering import render_page
from reports.pages.speed.page import page_of
from reports.pages.speed.table import FILE, SpeedTable, as_csv, read
from reports.run.installed import installed
from reports.versions.builds import distributions, engines_named
from reports.write.provenance import machine, versions
from reports.write.tables import number

COMPARED_RELEASES = ("mujoco==3.17.0", "mujoco==4.0.1")
TIMED_MODEL = Path(__file__).parents[1] / "pages" / "your_model" / "models" / "four_bar.xml"
MOST_LINES = 12


def bench(
    scene: Scenes = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="`suite`: the full grid.")] = False,
    site: Annotated[Path, typer.Option(help="`site`: a folder that `crosscheck site` wrote.")] = SITE,
    device: DeviceName = None,
    engine: Annotated[
        list[str] | None, typer.Option("--engines", help="`peers`: only these engines (repeatable, or with commas).")
    ] = None,
    budget: Annotated[float, typer.Option(min=0.0, help="`peers`: longest run of an engine, in seconds of CPU.")] = 1.0,
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="`peers`: write to the checkout's reports/results, too.")
    ] = False,
) -> None:
    """Compare the CPU times of `run` and of bare loops. `bench suite [SCENES]` measures the CPU time of a grid by part,
    method and scene. `bench judge` measures the judge and exact motions. `bench peers [SCENES]` compares the judge with
    other engines at equal errors, and writes the page `speed`; `--full` measures all scenes. `bench worlds [COUNTS]`
    measures steps per second and errors of many four-bars in one program, on the device of `--device`. `bench answers`
    measures whole commands. `bench site` measures the site."""
    match scene or []:
        case ["suite", *scenes]:
            _print_grid(scenes, full)
        case ["judge", *_]:
            _print_judge()
        case ["peers", *names]:
            _compare_peers(names, engine, full, budget, results, publish)
        case ["worlds", *counts]:
            _print_worlds(counts, device)
        case ["answers", *_]:
            _print_commands()
        case ["site", *_]:
            _print_rows("the site", measure_site(site))
        case scenes:
            _print_loops(scenes)
    print(f"{versions()}; {machine()}")


def _print(title: str, header: Sequence[str], body: Sequence[Sequence[str]]) -> None:
    terminal = Terminal(140)
    print_table(terminal, title, header, body, 1)
    terminal.print()


def _print_rows(title: str, rows: Iterable[tuple[str, float, str]]) -> None:
    _print(title, ("quantity", "measured", "unit"), [(name, number(value), unit) for name, value, unit in rows])


def _print_loops(scenes: Sequence[str]) -> None:
    for chosen in choose(scenes).scenes:
        body = [
            (method_name(loop.engine), number(1e6 * loop.bare), number(1e6 * loop.run), f"{loop.run / loop.bare:.3f}")
            for loop in measure_loops(ENGINES, chosen)
        ]
        if body:
            header = ("method", "bare loop [us/step]", "run [us/step]", "ratio [1]")
            _print(f"{chosen.name}: run over the bare loop", header, body)


def _print_grid(scenes: Sequence[str], full: bool) -> None:
    choice = choose(scenes)
    cells = choose_cells(choice.scenes, choice.engines, choice.known.pages, full)
    for name, spent in measure_grid(cells).items():
        ordered, total = sorted(spent.items(), key=lambda pair: -pair[1]), sum(spent.values())
        rest = ("all others", sum(seconds for _, seconds in ordered[MOST_LINES:]))
        body = [(key, f"{s:.2f}", f"{100 * s / total:.1f}") for key, s in (*ordered[:MOST_LINES], rest)]
        _print(f"{len(cells)} cells, by {name}", (name, "CPU [s]", "share [%]"), body)


def _print_judge() -> None:
    choice = choose()
    scenes = dict.fromkeys(
        cell.scene for cell in choose_cells(choice.scenes, choice.engines, choice.known.pages, full=True)
    )
    truths = measure_truths(scenes)  # These come first, since some motions are cached.
    total = ("all truths of the full grid", sum(seconds for _, seconds, _ in truths), "s")
    _print_rows("the judge: CPU time", [*measure_judge(), *truths[:MOST_LINES], total])
    _print_rows("the judge: many mechanisms, and many bodies", [*measure_batch(), *measure_trees()])


def _compare_peers(
    names: Sequence[str], engines: Sequence[str] | None, full: bool, budget: float, results: Path, publish: bool
) -> None:
    """Print the table of each error, and write its file, page and picture after each scene.

    Rows of other scenes that the folder has from the same processor and versions are kept.
    """
    scenes = listed("bench peers", names, peers.SCENES) if names else tuple(peers.SCENES) if full else peers.QUICK
    chosen = peers.PEERS if engines is None else listed("--engines", engines, peers.PEERS)
    if publish:
        refuse_outside_a_checkout()
    refuse_file(results)
    if not loading.installed():
        raise BadInput("the judge is timed as compiled code: install numba, the extra 'fast'")
    stored, files = read(results / FILE), dict[str, str]()
    table = SpeedTable((), peers.facts(budget)).with_rows_of(stored)
    for rows in peers.measure_peers(scenes, chosen, budget):
        table = table.with_new(rows, tuple(peers.SCENES), peers.LINES)
        files = {FILE: as_csv(table), **render_page(page_of(table), Material({}), "crosscheck bench peers")}
        write_files({results / name: text for name, text in files.items()})
    if publish:
        if set(table.scenes) != set(peers.SCENES) or set(table.engines) < set(peers.PEERS):
            raise BadInput("nothing is published, since the published table has all scenes and engines; use --full")
        write_files({published() / name: text for name, text in files.items()})
    for target in table.targets:
        _print(f"CPU time over that of the judge, error at most {target:.0e} rad", table.header, table.lines(target))
    print(f"{len(files)} files written to {results}")


def _print_worlds(counts: Sequence[str], device: str | None) -> None:
    """Print steps per second. By default the numbers of worlds are those of the benchmark."""
    choose_device(device)
    if not all(word.isdecimal() and int(word) for word in counts):
        raise BadInput(f"bench worlds: {' '.join(counts)!r} are no numbers of worlds, such as 1 64 4096")
    body = [
        (cost.method, str(cost.worlds), number(cost.steps_per_second), number(cost.error))
        for cost in measure_worlds(tuple(map(int, counts)) or WORLD_COUNTS)
    ]
    _print("many worlds", ("method", "worlds", "steps of a world per second", "angle error [rad]"), body)


def _print_commands() -> None:
    for name, _, release in (word.partition("==") for word in COMPARED_RELEASES):
        installed(distributions(engines_named(name)[0]), release)
    commands = (
        ("--help",),
        ("check", str(TIMED_MODEL)),
        ("run", "free_four_bar", "--quick"),
        ("compare", *COMPARED_RELEASES, "--scenes", "free_four_bar"),
    )
    body = []
    for command in commands:
        wall, cpu, status = measure_command(command)
        words = " ".join(Path(word).name if "/" in word else word for word in command)
        body.append((f"crosscheck {words}", number(wall), number(cpu), str(status)))
    title = f"Seconds to the first useful answer, the quickest of {COMMAND_TURNS}, each in an empty folder"
    _print(title, ("command", "clock [s]", "CPU [s]", "status"), body)
