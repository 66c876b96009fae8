"""`crosscheck search`: random mechanisms in engines, held against the law, other descriptions and the judge."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import (
    FOLDER,
    SEARCH,
    STORE,
    EngineName,
    Folder,
    Scheduler,
    VariantName,
    Workers,
    with_folder,
)
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reports.cli.terminal import Terminal
    from reports.run.cluster import Workforce
    from reports.run.store import Store
    from reports.search.chunk import Asked, Chunk
    from reports.search.subjects import Subject

LIMIT = 120.0  # CPU seconds of one piece
WAVE = 4  # pieces for each worker between two looks at the clock
ALL_ORACLES = "instant,relations,motions"


def search(
    engine: EngineName = None,
    variant: VariantName = None,
    cases: Annotated[int, typer.Option(min=1, help="Cases for each engine.")] = 200,
    seconds: Annotated[float | None, typer.Option(help="Begin nothing after this time; what is done is kept.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Another seed gives other mechanisms.")] = 1,
    kinds: Annotated[
        str | None,
        typer.Option(help="Of joints and forces: pin,rod,spring,...; of MuJoCo alone: connect,gear,..."),
    ] = None,
    decades: Annotated[int, typer.Option(min=0, max=6, help="By how many more masses and lengths differ.")] = 0,
    oracles: Annotated[str, typer.Option(help=f"What is asked: {ALL_ORACLES}.")] = ALL_ORACLES,
    release: Annotated[
        str | None, typer.Option(help="MuJoCo alone in this release, as 3.6.0: installed once, in the user's cache.")
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    results: Folder = FOLDER,
) -> None:
    """Search random mechanisms for faults; each finding is made small and written as a script of the engine's own."""
    from reports.cli.terminal import Terminal, opened
    from reports.run.cluster import elsewhere, pool
    from reports.search.chunk import as_words, asked, chunks, stored
    from reports.search.subjects import ORACLES

    if seconds is not None and not 0 < seconds < float("inf"):
        raise BadInput(f"--seconds is {seconds}; it must be a finite number greater than zero")
    subjects = chosen(engine, variant) if release is None else [of_release(release, engine, variant)]
    known = tuple(dict.fromkeys(kind for subject in subjects for kind in subject.kinds))
    wanted = listed("--kinds", kinds, known) if kinds is not None else known
    subjects = [one for one in subjects if {*wanted} & {*one.kinds}]
    pieces = chunks(subjects, seed, cases, wanted, decades, listed("--oracles", oracles, ORACLES))
    folder = results / SEARCH
    terminal = Terminal(150)
    with elsewhere(scheduler) as crew, opened(folder / STORE) as store:
        store.remember(as_words(piece) for piece in pieces)
        run_pieces(terminal, store, pieces, seconds, crew or pool(workers))
        told = list(asked(stored(store, pieces)))
        print_summary(terminal, told)
        shrink_and_write(terminal, store, told, folder, crew or pool(workers))
    terminal.say(f"{len(told)} cases are stored in {folder}. Next: {with_folder('crosscheck report', results)}")


def listed(option: str, words: str, known: Sequence[str]) -> tuple[str, ...]:
    """Words with commas between them, each of them known. Raises BadInput."""
    out = tuple(dict.fromkeys(word.strip() for word in words.split(",") if word.strip()))
    if not out or not {*out} <= {*known}:
        raise BadInput(f"{option} is {words!r}; it must be one or some of {', '.join(known)}, with commas between them")
    return out


def chosen(engine: str | None, variant: str | None) -> list[Subject]:
    """The engines of these names, and MuJoCo alone; all variants if none is named. Raises BadInput."""
    from engines.loading import is_reference
    from engines.registry import ENGINES, INSTALLED, VARIANTS, load
    from reports.cli.selection import choose_engines
    from reports.search.subjects import Adapted, Alone

    if variant == "alone" and engine in (None, "mujoco"):
        return [Alone()]
    if engine is not None and is_reference(engine):
        try:
            return [Adapted(one) for one in choose_engines(None, variant, load(engine))]
        except ValueError as error:
            raise BadInput(str(error)) from None
    known = (*(VARIANTS if variant is None else ENGINES), *(INSTALLED if engine is not None else ()))
    engines = choose_engines(engine, variant, known)
    alone: list[Subject] = [Alone()] if variant is None and engine in (None, "mujoco") else []
    return [*(Adapted(one) for one in engines), *alone]


def of_release(release: str, engine: str | None, variant: str | None) -> Subject:
    """MuJoCo alone in another release. Raises BadInput where it can't be had, or something else is asked for too."""
    from reports.run.installed import installed
    from reports.search.release import DISTRIBUTIONS
    from reports.search.subjects import Alone

    if engine not in (None, "mujoco") or variant not in (None, "alone"):
        raise BadInput(f"--release is {release!r}, which is MuJoCo's alone; leave out --engine and --variant")
    installed(DISTRIBUTIONS, release)
    return Alone(release)


def run_pieces(
    terminal: Terminal, store: Store, pieces: Sequence[Chunk], seconds: float | None, crew: Workforce
) -> None:
    """Run what is not stored until the time is over; a case that ends its process is found and kept.

    All at once where there is time for all: between two waves workers wait for the last of the first.
    """
    from reports.cli.terminal import interruptible
    from reports.run.running import missing, run_into
    from reports.search.chunk import lost, stored

    begin = monotonic()
    with interruptible(terminal, store, pieces, LIMIT, "pieces") as (waiting, done, watch):
        size = len(waiting) if seconds is None else WAVE * crew.threads
        while waiting and (seconds is None or monotonic() - begin < seconds):
            wave, waiting = waiting[:size], waiting[size:]
            run_into(store, wave, False, LIMIT, crew.threads, done, watch, supervised=crew.supervise)
            singles = missing(lost(stored(store, wave)), store, LIMIT)
            run_into(store, singles, False, LIMIT, crew.threads, watch=watch, supervised=crew.supervise)


def print_summary(terminal: Terminal, told: Sequence[Asked]) -> None:
    """A line for each check of each subject: how many cases, the errors' distribution, how many are faults."""
    from reports.cli.terminal import print_table
    from reports.search.chunk import HEADER, summary

    print_table(terminal, "Errors, each relative to the largest of what it is an error of", HEADER, summary(told), 2)


def shrink_and_write(terminal: Terminal, store: Store, told: Sequence[Asked], folder: Path, crew: Workforce) -> None:
    """Make some findings of each check smaller, and write them as recipes and scripts."""
    from reports.cli.terminal import interruptible
    from reports.run.files import write_whole
    from reports.run.running import run_into
    from reports.search.shrinking import Shrink, files_of, line_of, worst_of

    tasks = [Shrink.of(check, one) for check, one in worst_of(told)]
    if not tasks:
        terminal.say("Nothing was found.")
        return
    with interruptible(terminal, store, tasks, LIMIT, "findings") as (waiting, done, watch):
        run_into(store, waiting, False, LIMIT, crew.threads, done, watch, supervised=crew.supervise)
    texts = {}
    answers = store.answers(tasks)
    for task in tasks:
        terminal.say(f"{task.label}: {line_of(answers[task])}")
        texts |= {folder / name: text for name, text in files_of(task, answers[task]).items()}
    write_whole(texts, "the findings that were there stay as they were")
