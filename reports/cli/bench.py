"""`crosscheck bench`: tables of what `reports.bench` measures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from reports.cli.options import Scenes
from reports.cli.site import SITE

COMPARED = ("mujoco==3.17.0", "mujoco==4.0.1")
MODEL = Path(__file__).parents[1] / "pages" / "your_model" / "models" / "four_bar.xml"
MOST_LINES = 12


def bench(
    scene: Scenes = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="`suite`: the full grid.")] = False,
    site: Annotated[Path, typer.Option(help="`site`: a folder that `crosscheck site` wrote.")] = SITE,
) -> None:
    """Time `run` against bare loops; asserts nothing.

    `bench suite [SCENES]`: CPU time of a grid by part, method and scene. `bench judge`: exact multipliers and truths.
    `bench answers`: whole commands, cold. `bench site`: sizes and times of the site.
    """
    word, *scenes = scene or [""]
    if word == "suite":
        _print_grid(scenes, full)
    elif word == "judge":
        _print_judge()
    elif word == "answers":
        _print_commands()
    elif word == "site":
        from reports.bench import measure_site

        _print_rows("the site", measure_site(site))
    else:
        _print_loops(scene or [])
    from reports.write.provenance import machine, versions

    print(f"{versions()}; {machine()}")


def _print(title: str, header: Sequence[str], body: Sequence[Sequence[str]]) -> None:
    from reports.cli.terminal import Terminal, print_table

    terminal = Terminal(140)
    print_table(terminal, title, list(header), list(map(tuple, body)), 1)
    terminal.print()


def _print_rows(title: str, rows: Iterable[tuple[str, float, str]]) -> None:
    from reports.write.tables import number

    _print(title, ("quantity", "measured", "unit"), [(name, number(value), unit) for name, value, unit in rows])


def _print_loops(scenes: Sequence[str]) -> None:
    from engines import method_name
    from engines.registry import ENGINES
    from reports.bench import measure_loops
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_scenes
    from reports.write.tables import number

    known, names, _ = with_words(registered(), scenes, None)
    for chosen in choose_scenes(names, known.scenes, known.pages):
        body = [
            (method_name(c.engine), number(1e6 * c.bare), number(1e6 * c.run), f"{c.ratio:.3f}")
            for c in measure_loops(ENGINES, chosen)
        ]
        if body:
            header = ("method", "bare loop [us/step]", "run [us/step]", "ratio [1]")
            _print(f"{chosen.name}: run over the bare loop", header, body)


def _print_grid(scenes: Sequence[str], full: bool) -> None:
    from reports.bench import measure_grid
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_cells, choose_engines, choose_scenes

    known, names, _ = with_words(registered(), scenes, None)
    chosen = choose_scenes(names, known.scenes, known.pages)
    cells = choose_cells(chosen, choose_engines(None, None, known.engines), known.pages, full)
    for name, spent in measure_grid(cells).items():
        ordered, total = sorted(spent.items(), key=lambda pair: -pair[1]), sum(spent.values())
        rest = ("all others", sum(seconds for _, seconds in ordered[MOST_LINES:]))
        body = [(key, f"{s:.2f}", f"{100 * s / total:.1f}") for key, s in (*ordered[:MOST_LINES], rest)]
        _print(f"{len(cells)} cells, by {name}", (name, "CPU [s]", "share [%]"), body)


def _print_judge() -> None:
    from reports.bench import measure_judge, measure_truths
    from reports.cli.known import registered
    from reports.cli.selection import choose_cells

    known = registered()
    scenes = dict.fromkeys(cell.scene for cell in choose_cells(known.scenes, known.engines, known.pages, True))
    truths = measure_truths(scenes)  # first, since some motions are cached
    total = ("all truths of the full grid", sum(seconds for _, seconds, _ in truths), "s")
    _print_rows("the judge: CPU time", [*measure_judge(), *truths[:MOST_LINES], total])


def _print_commands() -> None:
    from reports.bench import COMMAND_TURNS, measure_command
    from reports.cli.versions import installed_once
    from reports.write.tables import number

    installed_once(COMPARED)
    commands = (
        ("--help",),
        ("check", str(MODEL)),
        ("run", "free_four_bar", "--quick"),
        ("compare", *COMPARED, "--scenes", "free_four_bar"),
    )
    body = []
    for cost in map(measure_command, commands):
        words = " ".join(Path(word).name if "/" in word else word for word in cost.words)
        body.append((f"crosscheck {words}", number(cost.wall), number(cost.cpu), str(cost.status)))
    title = f"Seconds to the first useful answer, the quickest of {COMMAND_TURNS}, each in an empty folder"
    _print(title, ("command", "clock [s]", "CPU [s]", "status"), body)
