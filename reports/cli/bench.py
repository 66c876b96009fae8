"""`crosscheck bench`: what stepping costs beside bare loops, and the reference beside another library."""

from __future__ import annotations

from typing import Annotated

import typer

from reports.cli.options import Scenes, Workers
from reports.cli.terminal import Terminal, print_table

SUITE = "suite"  # instead of scenes, or before them
JUDGE = "judge"  # instead of scenes


def bench(
    scene: Scenes = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="`suite`: the full grid; `judge`: more.")] = False,
    workers: Workers = None,
) -> None:
    """Time `run` against bare stepping loops, and the reference against another library; prints, asserts nothing.

    `bench suite [SCENES]` runs the grid into an empty store and tells what the time of a run goes into. `bench judge`
    times exact multipliers: an evaluation, steps, chains, many mechanisms at once, and the truths.
    """
    if scene == [JUDGE]:
        from reports.cli.bench_judge import bench_judge

        bench_judge(full)
        return
    if scene and scene[0] == SUITE:
        from reports.cli.bench_suite import bench_suite

        bench_suite(scene[1:], full, workers)
        return
    from engines.registry import ENGINES
    from reports.bench import four_bar
    from reports.bench.loops import loop_costs
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_scenes
    from reports.text.provenance import machine, versions
    from reports.text.tables import number

    console = Terminal(140)
    known, names, _ = with_words(registered(), scene or (), None)
    for one in choose_scenes(names, known.scenes, known.pages):
        costs = loop_costs(ENGINES, one.mechanism(), one.spacing / 10, one.samples, 10)
        body = [
            (f"{c.engine.name} {c.engine.variant}", number(1e6 * c.bare), number(1e6 * c.run), f"{c.ratio:.3f}")
            for c in costs
        ]
        if body:
            header = ["method", "bare loop [us/step]", "run [us/step]", "ratio [1]"]
            print_table(console, f"{one.name}: run over the bare loop", header, body, 1)
            console.print()
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
