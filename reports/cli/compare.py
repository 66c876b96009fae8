"""`crosscheck compare` prints the differences between two builds of an engine."""

from __future__ import annotations

import math
from collections import Counter
from typing import Annotated

import typer

from reports.cli.interruption import delayed_signals
from reports.cli.options import FOLDER, REFERENCES, AsJson, AsMarkdown, Folder, SomeScenes
from reports.cli.terminal import Terminal, print_table, telling
from reports.cli.versions import WIDTH, announce_pip, named_scenes, progress_of
from reports.gate.change import DEAR
from reports.model.ending import BadInput, Broken
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.versions.builds import BuildComparison, compare_builds
from reports.versions.comparison import Difference, RowComparison

LONGEST_REASON = 300  # characters


def compare(
    first: Annotated[str, typer.Argument(metavar="A", help="NAME==VERSION, a wheel, or a folder that holds a build.")],
    second: Annotated[str, typer.Argument(metavar="B", help="The other one, which must not be worse.")],
    engine: Annotated[
        str | None, typer.Option("--engine", help=f"The engine under test: its name, or {REFERENCES}.")
    ] = None,
    variant: Annotated[list[str] | None, typer.Option("--variant", help="Only this variant (repeatable).")] = None,
    scenes: SomeScenes = None,
    cost: Annotated[
        float | None, typer.Option("--cost", help="Status 1 too if a method takes this many times as much CPU time.")
    ] = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Print changes of errors, orders, outcomes and costs from A to B. Status 1 if an error became 3 times larger."""
    if cost is not None and not 0 < cost < math.inf:
        raise BadInput(f"--cost is {cost:g}; give a number above 0, such as 1.5")
    chosen = named_scenes(scenes) if scenes else None
    with telling(WIDTH, as_json, as_markdown) as console:
        with delayed_signals() as check:
            progress = progress_of(console, check)
            result = compare_builds(
                first, second, engine, variant or (), chosen, results, progress, announce=announce_pip
            )
        for side, column in zip(result.sides, result.columns, strict=True):
            if reason := column.trouble or column.mark:
                console.tell(f"{side.label}: {reason}")
        print_comparison(console, result)
        if result.complaint:
            raise Broken(result.complaint)
        slower = [
            f"{method} takes {ratio:.2f} times the CPU time"
            for method, ratio in result.comparison.costs.items()
            if cost is not None and ratio > cost
        ]
        if slower:
            first, second = (side.label for side in result.sides)
            raise Broken(f"{second} is slower than {first}: {', '.join(slower)}, and --cost is {cost:g}")


def print_comparison(console: Terminal, builds: BuildComparison) -> None:
    """Print a table with a row for each method of each scene, tables of differences and orders, and a summary."""
    comparison, (first, second) = builds.comparison, (side.label for side in builds.sides)
    lines = comparison.by("scene", "method")
    other = tuple(difference for difference in comparison.differences if not difference.worse)
    step = ("step [s]", first, second)
    tables = [
        (
            f"From {first} to {second}",
            ("scene", "method", "what changed most", *step, "CPU time, times", "verdict"),
            [[*names, *_cells(line.chief), line.cost, line.verdict] for names, line in lines.items()],
        ),
        *(
            (
                f"Numbers and outcomes that are {kind}",
                ("scene", "method", "what", *step),
                [[difference.after.scene, difference.after.method, *_cells(difference)] for difference in differences],
            )
            for kind, differences in (
                ("worse", comparison.worse),
                ("better, or other", other if console.form == "json" else ()),
            )
        ),
        (
            "Order of the angle's error",
            ("scene", "method", first, second),
            [[turn.scene, turn.method, turn.before, turn.after] for turn in comparison.orders],
        ),
    ]
    for title, header, body in tables:
        if body:
            print_table(console, title, header, body, 3 if "step [s]" in header else 2)
            console.print()
    for label, reasons in zip((first, second), _reasons(comparison), strict=True):
        for reason, count in reasons.items():
            console.tell(f"{label}: {reason}{f' ({count} cells)' if count > 1 else ''}")
    for check in comparison.grown:
        console.tell(f"{second}: {check}")
    for method, ratio in comparison.costs.items():
        if ratio > DEAR:
            console.tell(f"{second}: {method} takes {ratio:.3g} times the CPU time")
    cost = f"CPU time is {comparison.cost:.2f} times as much, by the median"
    unchanged = sum(line.verdict == "nothing changed" for line in lines.values())
    console.tell(
        f"From {first} to {second}, {len(comparison.pairs)} cells of both: {len(comparison.worse)} numbers are worse, "
        f"{len(other)} better or other; nothing changed in {unchanged} of {len(lines)} methods of scenes; "
        f"{cost if math.isfinite(comparison.cost) else 'nothing was timed'}"
    )


def _cells(difference: Difference) -> list[str | float]:
    name = difference.quantity
    label = name if name in ("outcome", "reaction_rows") else f"{name} [{quantity(name).unit}]"
    return [label, difference.after.step, difference.value(difference.before), difference.value(difference.after)]


def _reasons(found: RowComparison) -> tuple[Counter[str], Counter[str]]:

    def reason(row: Measurement) -> str:
        sentence = " ".join(row.engine_sentence.split())[:LONGEST_REASON]
        return "" if Outcome(row.outcome).comparable else ": ".join(filter(None, (row.outcome, sentence)))

    ended = [difference for difference in found.differences if difference.quantity == "outcome"]
    earlier, later = (
        Counter(reason(difference.before) for difference in ended),
        Counter(reason(difference.after) for difference in ended),
    )
    for counted in (earlier, later):
        del counted[""]
    return earlier, later
