"""`crosscheck errata` prints a table of the misprints in the chapter, with three values and a verdict."""

from __future__ import annotations

from typing import Annotated

import typer

from reports.cli.terminal import Terminal, print_table
from reports.model.ending import BadInput
from reports.pages.errata.page import engine_rows, slip_rows

VALUES = ("printed, and its value", "right, and its value", "derivative, and all values' unit", "verdict")
ENGINES_HEADER = ("no.", "engine", "its motion", "unit", "printed misses by", "right misses by")
CAUCHY = "The derivative is that of a position (11: of a velocity; 19: the loop's closure), by Cauchy's integral."


def errata(
    number: Annotated[list[int] | None, typer.Argument(help="Only these numbers of the list of errata.")] = None,
    engines: Annotated[bool, typer.Option("--engines", help="What engines say of it too (some seconds).")] = False,
) -> None:
    """The chapter's printed slips: each formula's value as printed and as it must be, and what decides."""
    rows = slip_rows()
    known = [int(row[0]) for row in rows]
    if unknown := [word for word in number or () if word not in known]:
        raise BadInput(f"no slip has the number {unknown[0]}; there are {', '.join(map(str, known))}")
    terminal, chosen = Terminal(150), number or known
    header = ("no.", "where", *VALUES)
    print_table(terminal, "Printed slips of the chapter", header, [r for r in rows if int(r[0]) in chosen], len(header))
    terminal.print(f"\n{CAUCHY}")
    if engines:
        rows, lost = engine_rows()
        terminal.print()
        print_table(terminal, "Engines as referees", ENGINES_HEADER, [r for r in rows if int(r[0]) in chosen], 4)
        for sentence in lost:
            terminal.print(sentence, markup=False)
