"""`crosscheck bench`: stepping beside bare loops, and the site."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import Scenes, Workers
from reports.cli.site import SITE

if TYPE_CHECKING:
    from reports.cli.terminal import Terminal

ANSWERS = "answers"  # instead of scenes
COMPARED = ("mujoco==3.17.0", "mujoco==4.0.1")
SUITE = "suite"  # instead of scenes, or before them
JUDGE = "judge"  # instead of scenes


def bench(
    scene: Scenes = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="`suite`: the full grid.")] = False,
    workers: Workers = None,
    site: Annotated[Path, typer.Option(help="A folder that `crosscheck site` wrote: its sizes and times.")] = SITE,
) -> None:
    """Time `run` against bare loops, and the site; asserts nothing.

    `bench suite [SCENES]` runs the grid into an empty store and tells what the time of a run goes into. `bench judge`
    times exact multipliers: an evaluation, steps, chains, and the truths. `bench answers` times whole commands, cold:
    how long one waits for the first useful answer.
    """
    if scene == [ANSWERS]:
        _answers()
        return
    if scene == [JUDGE]:
        from reports.cli.bench_judge import bench_judge

        bench_judge()
        return
    if scene and scene[0] == SUITE:
        from reports.cli.bench_suite import bench_suite

        bench_suite(scene[1:], full, workers)
        return
    from engines.registry import ENGINES, method_name
    from reports.bench.suite import loop_costs
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_scenes
    from reports.cli.terminal import Terminal, print_table
    from reports.write.provenance import machine, versions
    from reports.write.tables import number

    console = Terminal(140)
    known, names, _ = with_words(registered(), scene or (), None)
    for one in choose_scenes(names, known.scenes, known.pages):
        costs = loop_costs(ENGINES, one.mechanism(), one.spacing / 10, one.samples, 10)
        body = [(method_name(c.engine), number(1e6 * c.bare), number(1e6 * c.run), f"{c.ratio:.3f}") for c in costs]
        if body:
            header = ["method", "bare loop [us/step]", "run [us/step]", "ratio [1]"]
            print_table(console, f"{one.name}: run over the bare loop", header, body, 1)
            console.print()
    _site(console, site)
    console.print(f"{versions()}; {machine()}")


def _answers() -> None:
    from reports.bench.answers import TURNS, questions, waited
    from reports.cli.terminal import Terminal, print_table
    from reports.cli.versions import installed_once
    from reports.write.provenance import machine

    console = Terminal(140)
    installed_once(COMPARED)
    found = [waited(question) for question in questions(COMPARED)]
    rows = [
        (" ".join(("crosscheck", *map(_short, each.question.words))), each.wall, each.cpu, each.question.wanted)
        for each in found
    ]
    title = f"Seconds to the first useful answer, the quickest of {TURNS}, each into an empty folder"
    print_table(console, title, ["command", "clock [s]", "CPU [s]", "asked for [s]"], rows, 1)
    console.print(machine())


def _short(word: str) -> str:
    return Path(word).name if "/" in word else word


def _site(console: Terminal, folder: Path) -> None:
    from reports.bench.site import FIRST, SECOND, SIZE, STEP, size_of, times_of

    try:
        size = size_of(folder)
        console.print(f"site: {size.files} files, {size.megabytes:.2f} MB when compressed, of at most {SIZE:g}")
        times = times_of(folder)
    except ValueError as reason:
        console.print(f"site: {reason}".replace("[", "\\["))
        return
    both = sum(times.stepped.values())
    each = ", ".join(f"{name} {spent:.1f}" for name, spent in times.stepped.items())
    console.print(
        f"  first picture after {times.painted:.2f} s, of at most {FIRST:g}; engines after {times.ready:.1f} s"
    )
    console.print(
        f"  a second of the four-bar in steps of {1e3 * STEP:g} ms: {each}, both {both:.1f} ms, of at most {SECOND:g}"
    )
