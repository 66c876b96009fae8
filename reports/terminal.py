"""What the command line prints: rich tables and the progress of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from reports.cells import Cell


def print_table(console: Console, title: str, header: Sequence[str], rows: Sequence[Sequence[str]], left: int) -> None:
    """A table whose first `left` columns are words, the others numbers.

    All of it is plain text: a unit in brackets, as in "step [s]", is no markup.
    """
    table = Table(title=Text(title), title_justify="left", header_style="bold", show_edge=False, pad_edge=False)
    for index, name in enumerate(header):
        table.add_column(Text(name), justify="left" if index < left else "right", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    console.print(table)


@contextmanager
def progress(console: Console, total: int) -> Iterator[tuple[Callable[[object], None], Callable[[list[Cell]], None]]]:
    """(done, watch): call done with each row, and watch with the cells that are running."""
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[running]}", style="dim"),
        console=console,
        transient=True,
    )
    with bar:
        task = bar.add_task("cells", total=total, running="starting")

        def watch(cells: list[Cell]) -> None:
            bar.update(task, running=" | ".join(cell.label for cell in cells))

        def done(row: object) -> None:
            bar.advance(task)

        yield done, watch
