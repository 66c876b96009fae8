"""`crosscheck bench judge`: what exact multipliers cost, and the truths."""

from __future__ import annotations

import math
from collections.abc import Callable

DEAREST = 8
WIDTH = 100  # characters of a scene's numbers


def bench_judge() -> None:
    """Print the judge's figures beside what is asked for and beside other engines. Raises BadInput without numba."""
    from engines.registry import ENGINES
    from reference.scenes.four_bar.scenes import FreeFourBar
    from reports.bench.judge import beside_others, figures, truth_costs
    from reports.cli.known import registered
    from reports.cli.selection import choose_cells
    from reports.cli.terminal import Terminal, print_table
    from reports.model.ending import BadInput
    from reports.write.provenance import machine, versions
    from reports.write.tables import number

    console = Terminal(140)
    # First: some motions are kept, and cost nothing later.
    known = registered()
    scenes = dict.fromkeys(cell.scene for cell in choose_cells(known.scenes, known.engines, known.pages, True))
    costs = truth_costs(scenes)
    dearest = [(repr(scene)[:WIDTH], number(seconds)) for scene, seconds in costs[:DEAREST]]
    total = number(sum(seconds for _, seconds in costs))
    title = f"the dearest truths, of {total} s for the {len(costs)} of the full grid"
    print_table(console, title, ["scene", "CPU [s]"], dearest, 1)
    console.print()
    try:
        found = figures()
    except RuntimeError as reason:
        raise BadInput(str(reason)) from reason
    rows = [(each.what, number(each.measured), _asked(each.asked, number), each.unit) for each in found]
    print_table(console, "the judge: CPU time", ["what", "measured", "asked for", "unit"], rows, 1)
    console.print()
    beside = [
        (number(each.error), number(1e3 * each.own), number(1e3 * each.other), each.method, number(each.factor))
        for each in beside_others(FreeFourBar(), ENGINES)
    ]
    header = ["error [rad]", "judge [ms/s]", "other [ms/s]", "the other", "factor [1]"]
    print_table(console, "free four-bar: the least time for an error", header, beside, 1)
    console.print(f"{versions()}; {machine()}")


def _asked(value: float, number: Callable[[float], str]) -> str:
    return "" if math.isnan(value) else number(value)
