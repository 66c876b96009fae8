"""`crosscheck bench suite`: where the time of a run goes, into an empty store."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reports.bench.suite import Account
    from reports.cli.terminal import Terminal

MOST_LINES = 12
COMPARED = 60  # cells whose timings are compared


def bench_suite(scenes: Sequence[str], full: bool, workers: int | None) -> None:
    """Run the grid of these scenes (all if none) into a store that is thrown away, and print the shares."""
    begin = time.process_time()
    from reports.bench.suite import Account, timings_alike
    from reports.cli.interruption import ending_at_once
    from reports.cli.known import registered, with_words
    from reports.cli.run import run_interruptible
    from reports.cli.selection import choose_cells, choose_engines, choose_scenes, choose_tasks
    from reports.cli.terminal import Terminal
    from reports.model.cells import estimated_seconds
    from reports.model.measure import TIMED
    from reports.run.cluster import Pool, pool
    from reports.run.files import temporary_folder
    from reports.run.running import worker_count
    from reports.run.store import Store
    from reports.write.provenance import machine, versions

    parts = {"importing": time.process_time() - begin}

    def passed(part: str) -> None:
        nonlocal begin
        parts[part] = time.process_time() - begin
        begin = time.process_time()

    begin = time.process_time()
    known, names, _ = with_words(registered(), scenes, None)
    chosen = choose_scenes(names, known.scenes, known.pages)
    engines = choose_engines(None, None, known.engines)
    cells = choose_cells(chosen, engines, known.pages, full)
    items = (*cells, *choose_tasks(chosen, engines, known.pages, full))
    passed("choosing cells")
    for item in items:
        _ = item.key
    passed("fingerprints")
    terminal, account, crew = Terminal(140), Account(), pool(workers)
    with temporary_folder() as folder, Store(folder / "cells.sqlite") as store:
        run_interruptible(terminal, store, items, False, 60.0, Pool(crew.threads, account.supervise))
        passed("supervising and storing")
    print_account(terminal, account, parts, len(items), crew.threads)
    short = sorted((cell for cell in cells if cell.purpose in TIMED), key=estimated_seconds)
    some = short[:: max(1, len(short) // COMPARED)]
    most = worker_count(timed=True)
    if most > 1:
        with ending_at_once():
            found = timings_alike(some, most)
        terminal.say(
            f"Timings of {found.cells} cells by {most} workers over those by 1: {found.middle:.3f} in the middle, "
            f"{100 * found.within:.0f} % within 10 %"
        )
    else:
        terminal.say("Timings of one worker and of several: this machine has one core for what is timed.")
    terminal.say(f"{versions()}; {machine()}")


def print_account(terminal: Terminal, account: Account, parts: dict[str, float], count: int, workers: int) -> None:
    """Tables of the shares, and how busy the workers were."""
    from reports.cli.terminal import print_table

    own = {f"this process: {name}": seconds for name, seconds in parts.items()}
    whole = account.seconds + sum(own.values())

    def table(title: str, found: dict[str, float]) -> None:
        ordered = sorted(found.items(), key=lambda pair: -pair[1])
        lines = [(name, f"{seconds:.2f}", f"{100 * seconds / whole:.1f}") for name, seconds in ordered[:MOST_LINES]]
        rest = sum(seconds for _, seconds in ordered[MOST_LINES:])
        if rest:
            lines.append(("all others", f"{rest:.2f}", f"{100 * rest / whole:.1f}"))
        print_table(terminal, title, ["", "CPU [s]", "share [%]"], lines, 1)
        terminal.print()

    table(f"{count} cells and tasks, by part", {**account.parts, **own})
    table("By method", dict(account.methods))
    table("By scene", dict(account.scenes))
    table("The longest", {label: seconds for seconds, label in account.longest})
    busy = account.seconds / (workers * account.wall) if account.wall else float("nan")
    tail = account.tail(min(workers, len(account.last)))
    terminal.say(
        f"{account.wall:.1f} s with {workers} workers, whose processes were at work for {100 * busy:.0f} % of it; "
        f"{account.lost} items without an answer; in the last {tail:.1f} s there was not work for all."
    )
