"""`crosscheck errata`: the chapter's printed slips, each with its three values and the verdict, on the terminal."""

from __future__ import annotations

from typing import Annotated

import typer

from reports.model.ending import BadInput

HEADER = (
    "no.",
    "where",
    "printed, and its value",
    "right, and its value",
    "derivative, and all values' unit",
    "verdict",
)
ENGINES_HEADER = ("no.", "engine", "its motion", "unit", "printed misses by", "right misses by")
WIDTH = 150  # into a file or a pipe


def errata(
    number: Annotated[list[int] | None, typer.Argument(help="Only these numbers of the list of errata.")] = None,
    engines: Annotated[bool, typer.Option("--engines", help="What engines say of it too (some seconds).")] = False,
) -> None:
    """The chapter's printed slips: each formula's value as printed and as it must be, and what decides."""
    from reports.cli.terminal import Terminal, print_table
    from reports.pages.errata.page import engine_rows, slip_rows

    rows = slip_rows()
    known = [int(row[0]) for row in rows]
    for one in number or ():
        if one not in known:
            raise BadInput(f"no slip has the number {one}; there are {', '.join(map(str, known))}")
    wide, chosen = Terminal(WIDTH), number or known
    shown = [row for row in rows if int(row[0]) in chosen]
    print_table(wide, "Printed slips of the chapter", HEADER, shown, len(HEADER))
    wide.print(
        "\nThe derivative is that of a position (11: of a velocity; 19: the loop's closure), by Cauchy's integral."
    )
    if engines:
        found, lost = engine_rows()
        wide.print()
        shown = [row for row in found if int(row[0]) in chosen]
        print_table(wide, "Engines as referees", ENGINES_HEADER, shown, 4)
        for sentence in lost:
            wide.print(sentence, markup=False)
