"""`crosscheck errata`: the chapter's printed slips, each with its three values and the verdict, on the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reference.chapter.errata.erratum import Erratum, Values

HEADER = (
    "no.",
    "where",
    "printed, and its value",
    "right, and its value",
    "derivative, and all values' unit",
    "verdict",
)
WIDTH = 150  # into a file or a pipe


def errata(
    number: Annotated[list[int] | None, typer.Argument(help="Only these numbers of the list of errata.")] = None,
    engines: Annotated[bool, typer.Option("--engines", help="What engines say of it too (some seconds).")] = False,
) -> None:
    """The chapter's printed slips: each formula's value as printed and as it must be, and what decides."""
    from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS
    from reports.cli.terminal import Terminal, print_table

    known = sorted(slip.number for slip in (*ERRATA, *WORD_SLIPS))
    for one in number or ():
        if one not in known:
            raise BadInput(f"no slip has the number {one}; there are {', '.join(map(str, known))}")
    wide = Terminal(WIDTH)
    rows = [row for row in rows_of_slips() if not number or int(row[0]) in number]
    print_table(wide, "Printed slips of the chapter", HEADER, rows, len(HEADER))
    wide.print(
        "\nThe derivative is that of a position (11: of a velocity; 19: the loop's closure), by Cauchy's integral."
    )
    if engines:
        from reports.pages.errata.experiments import TASKS, rulings
        from reports.run.running import run_items
        from reports.write.tables import number as short

        found = dict(run_items(TASKS))
        lost: list[str] = []
        units = {slip.number: slip.unit for slip in ERRATA}
        said = [
            (str(r.number), r.method, r.about, units[r.number], short(r.values.miss), short(r.values.agreement))
            for r in rulings(((task, found[task]) for task in TASKS), lost)
            if r.number in (number or known)
        ]
        wide.print()
        header = ("no.", "engine", "its motion", "unit", "printed misses by", "right misses by")
        print_table(wide, "Engines as referees", header, said, 4)
        for sentence in lost:
            wide.print(sentence, markup=False)


def _missed(erratum: Erratum, values: Values) -> str:
    from reports.write.tables import number

    if erratum.by_tolerance is None:
        return f"off by {number(values.miss)}, right by {number(values.agreement)}"
    misses = (f"{number(miss)} at rtol {number(each)}" for each, miss in erratum.by_tolerance().items())
    return f"the claim; integration off by {', '.join(misses)} (ours); formula by {number(values.agreement)}"


def rows_of_slips() -> list[tuple[str, ...]]:
    """A row a slip under HEADER, by number; those in words have no values."""
    from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS
    from reports.pages.errata.page import digits

    found: dict[int, tuple[str, ...]] = {}
    for erratum in ERRATA:
        values = erratum.values()
        eyes = "dimensions show it" if erratum.dimensions else "only numbers show it"
        found[erratum.number] = (
            str(erratum.number),
            erratum.where,
            f"{erratum.printed}\n= {digits(values.printed)}",
            f"{erratum.right}\n= {digits(values.right)}",
            f"{digits(values.decides)}\n{erratum.unit}",
            f"{_missed(erratum, values)}; {eyes}",
        )
    for slip in WORD_SLIPS:
        found[slip.number] = (str(slip.number), slip.where, slip.printed, slip.right, "-", f"words: {slip.reason}")
    return [found[key] for key in sorted(found)]
