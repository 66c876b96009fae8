"""Output of the command line: rich tables and the progress of a run."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from engines.registry import mislabelled
from reports.cli.interruption import delayed_signals
from reports.cli.streams import said, written
from reports.model.ending import FINE, BadInput, Broken, visible
from reports.model.measure import Measurement
from reports.run.running import missing
from reports.run.store import Store
from reports.write.tables import display_width, markdown, text_table, words_of
from reports.write.templates import inert

PULSE = 10.0  # Time [s] between two lines of progress in a file or a pipe.


class Terminal(Console):
    """The output of a command, with the width of the terminal, or with `width` columns in a file or a pipe. `form` is
    "text", "markdown" or "json". Markdown and JSON go to standard output, and other output, such as progress, then goes
    to standard error. The JSON document is printed at the end (`telling`). `print` raises the errors of `written`."""

    def __init__(self, width: int, form: str = "text") -> None:
        super().__init__(width=None if sys.stdout.isatty() else width, stderr=form != "text")
        self.form = form
        self.document: dict[str, Any] = {"tables": [], "sentences": []}

    def print(self, *objects: Any, **options: Any) -> None:
        with written():
            super().print(*objects, **options)

    def say(self, sentence: str) -> None:
        """Print a sentence that is no result, without markup, since file names may contain brackets."""
        self.print(visible(sentence), markup=False, highlight=False, soft_wrap=True)

    def tell(self, sentence: str) -> None:
        if self.form == "json":
            self.document["sentences"].append(sentence)
        elif self.form == "markdown":
            with written():
                print(f"{inert(visible(sentence))}\n")
        else:
            self.say(sentence)

    def close(self, status: int, message: str = "") -> None:
        """Print the JSON document if the form is "json"."""
        if self.form == "json":
            with written():
                print(json.dumps(self.document | {"status": status, "message": message}, indent=1))

    def keep(self, rows: Iterable[Measurement]) -> None:
        """Add rows with all digits to the JSON document. The keys are the column names of `errors.csv`."""
        if self.form == "json":
            cells = ({name: plain(value) for name, value in vars(row).items()} for row in rows)
            self.document.setdefault("rows", []).extend(cells)

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


@contextmanager
def opened(path: Path) -> Iterator[Store]:
    """Open a store for writing. If a damaged store was renamed, a line on stderr reports it."""
    with Store(path) as store:
        if store.notice:
            said(store.notice)
        yield store


@contextmanager
def telling(width: int, as_json: bool, as_markdown: bool) -> Iterator[Terminal]:
    """A terminal with the form that the options select. Raises BadInput for both options at once. The JSON document is
    printed at the end, but not after invalid input. The document has `tables`, `sentences`, the exit `status`, and
    `message`. A table has a `title` and `rows`. A row is an object with column names as keys, in which an unknown
    number is null."""
    if as_json and as_markdown:
        raise BadInput("--json and --markdown are two forms of one output; give one of them")
    terminal = Terminal(width, "json" if as_json else "markdown" if as_markdown else "text")
    try:
        yield terminal
    except Broken as broken:
        if as_markdown:
            terminal.tell(str(broken))
        terminal.close(broken.status, str(broken))
        raise
    terminal.close(FINE)


def print_table(
    console: Terminal, title: str, header: Sequence[str], rows: Iterable[Sequence[str | float]], left: int
) -> None:
    """Print a table in the form of the terminal. The first `left` columns contain words, and further columns numbers.
    Cells are plain text, so a unit in brackets, as in "step [s]", is not markup. rich folds a table that is too
    wide."""
    if console.form == "json":
        cells = [{name: plain(cell) for name, cell in zip(header, row, strict=True)} for row in rows]
        console.document["tables"].append({"title": title, "rows": cells})
        return
    title, header = visible(title), [visible(name) for name in header]
    words = [tuple(visible(words_of(cell)) for cell in row) for row in rows]
    if console.form == "markdown":
        with written():
            print(f"**{inert(title)}**\n\n{inert(markdown(header, words, left))}\n")
        return
    lines = text_table(header, words, left, (" ┃ ", " │ "), ("━", "━╇━"))
    if max(map(display_width, lines)) <= console.width and not any("\n" in word for row in words for word in row):
        head, *rest = lines
        text = Text.assemble((title, "table.title"), "\n", (head, "bold"), *(f"\n{line}" for line in rest))
        console.print(text, soft_wrap=True)  # rich.Table would take ten times as long.
        return
    table = Table(title=Text(title), title_justify="left", header_style="bold", show_edge=False, pad_edge=False)
    for index, name in enumerate(header):
        table.add_column(Text(name), justify="left" if index < left else "right", overflow="fold")
    for row in words:
        table.add_row(*map(Text, row))
    console.print(table)


def plain(cell: Any) -> str | float | None:
    """The JSON value of a cell. NaN becomes null, and an infinite number becomes text."""
    if not isinstance(cell, int | float):
        return str(cell)
    return cell if math.isfinite(cell) else None if math.isnan(cell) else str(cell)


@contextmanager
def interruptible(
    console: Terminal,
    store: Store,
    items: Sequence[Any],
    limit: float,
    words: str,
    fresh: bool = False,
    size: Callable[[Any], int] | None = None,
) -> Iterator[tuple[Sequence[Any], Callable[..., None], Callable[[list[Any]], None]]]:
    """(items to run, done, watch) for a run that Ctrl-C may interrupt. `progress` describes done and watch. words:
    plural noun for the items. fresh: whether stored items are run again. size: function that returns the number of
    cases in an item. After Ctrl-C it prints a line about the stored rows and raises KeyboardInterrupt."""
    if sentence := mislabelled():
        raise BadInput(sentence)
    with delayed_signals() as check:
        waiting = items if fresh else missing(items, store, limit)
        try:
            total, unit = (len(waiting), "cells") if size is None else (sum(map(size, waiting)), "cases")
            with progress(console, total, check, unit) as (done, watch):
                yield waiting, done, watch
            check()
        except KeyboardInterrupt:
            stored = len(items) - len(missing(items, store, limit))
            console.say(f"Stopped: {stored} of {len(items)} {words} are stored; the next run goes on from there.")
            raise


@contextmanager
def progress(
    console: Console, total: int, check: Callable[[], None], unit: str = "cells"
) -> Iterator[tuple[Callable[..., None], Callable[[list[Any]], None]]]:
    """(done, watch). done(result, many=1) counts results. watch(items) shows the running items. Both functions call
    `check`.

    A terminal shows a bar. A file or a pipe gets a line every PULSE seconds.
    """
    bar: Progress | None = None
    if console.is_terminal:
        bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[running]}", style="dim"),
            console=console,
            transient=True,
        )
        bar.add_task(unit, total=total, running="starting")
    start = last = monotonic()
    count = 0

    def watch(items: list[Any]) -> None:
        nonlocal last
        running = visible(" | ".join(item.label for item in items))
        if bar is not None:
            bar.update(bar.task_ids[0], running=running)
        elif (now := monotonic()) - last >= PULSE:
            last = now
            line = f"{count} of {total} {unit} run after {now - start:.0f} s{f'; running: {running}' if items else ''}"
            console.print(line, markup=False, highlight=False, soft_wrap=True)
        check()

    def done(result: object, many: int = 1) -> None:
        nonlocal count
        count += many
        if bar is not None:
            bar.advance(bar.task_ids[0], many)
        check()

    with bar or nullcontext():
        yield done, watch
