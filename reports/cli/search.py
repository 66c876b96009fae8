"""`crosscheck search`: random mechanisms in engines, held against the law, other descriptions and the judge."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.cli.options import (
    FOLDER,
    SEARCH,
    STORE,
    AsJson,
    AsMarkdown,
    EngineName,
    Folder,
    Scheduler,
    VariantName,
    Workers,
    listed,
    with_folder,
)
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reports.cli.terminal import Terminal
    from reports.model.tasks import Answer
    from reports.run.cluster import Workforce
    from reports.run.store import Store
    from reports.search.chunk import Asked, Chunk
    from reports.search.subjects import Subject

LIMIT = 120.0  # CPU seconds of one piece
CONTROL = 1800.0  # of a planted fault: 300 cases of each size
WAVE = 4  # pieces for each worker between two looks at the clock
TEN = 10  # cases of a fresh seed for each engine
ALL_ORACLES = "instant,relations,motions"


def search(
    engine: EngineName = None,
    variant: VariantName = None,
    cases: Annotated[int | None, typer.Option(min=1, help="Cases for each engine: 200; 10 of a fresh seed.")] = None,
    seconds: Annotated[float | None, typer.Option(help="Begin nothing after this time; what is done is kept.")] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Other mechanisms; if none is given, those of the last commit's hash.")
    ] = None,
    fresh: Annotated[
        bool, typer.Option(help="One seed after the other that was never run, for --seconds; in all engines.")
    ] = False,
    published: Annotated[bool, typer.Option(help="What the published page tells of, planted faults too.")] = False,
    kinds: Annotated[
        str | None,
        typer.Option(help="Of joints and forces: pin,rod,spring,...; of MuJoCo alone: connect,gear,..."),
    ] = None,
    decades: Annotated[int, typer.Option(min=0, max=6, help="By how many more masses and lengths differ.")] = 0,
    oracles: Annotated[
        str, typer.Option(help=f"What is asked: {ALL_ORACLES}; or claims, of methods that estimate their own errors.")
    ] = ALL_ORACLES,
    release: Annotated[
        str | None, typer.Option(help="MuJoCo alone in this release, as 3.6.0: installed once, in the user's cache.")
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Search random mechanisms for faults; each finding is made small and written as a script of the engine's own."""
    from reports.cli.terminal import opened, telling
    from reports.run.cluster import elsewhere, pool
    from reports.search import plan
    from reports.search.chunk import as_words, asked, chunks, stored
    from reports.search.parts import SINGULAR
    from reports.search.subjects import CLAIMS, ORACLES

    if seconds is not None and not 0 < seconds < float("inf"):
        raise BadInput(f"--seconds is {seconds}; it must be a finite number greater than zero")
    if fresh and (seconds is None or published or seed is not None):
        raise BadInput("--fresh needs --seconds, and takes no --seed and no --published: it draws seeds until then")
    if published and any((engine, variant, cases, seed is not None, kinds, decades, release, oracles != ALL_ORACLES)):
        raise BadInput(
            "--published takes --seconds, --workers, --scheduler and --results alone: what is asked is fixed"
        )
    every = (fresh or published) and engine is None and variant is None
    subjects = plan.everything() if every else chosen(engine, variant)
    if release is not None:
        subjects = [of_release(release, engine, variant)]
    own = tuple(dict.fromkeys(kind for subject in subjects for kind in subject.kinds))
    wanted = listed("--kinds", [kinds], (*own, *SINGULAR)) if kinds is not None else own
    subjects = [one for one in subjects if {*wanted} & {*one.kinds, *SINGULAR}]
    asked_of = listed("--oracles", [oracles], (*ORACLES, CLAIMS))
    batches: Iterable[list[Chunk]]
    if fresh:
        batches = plan.fresh(subjects, cases or TEN)
    elif published:
        batches = [plan.published()]
    else:
        batches = [chunks(subjects, plan.seeds()[0] if seed is None else seed, cases or 200, wanted, decades, asked_of)]
    folder, count, pieces = results / SEARCH, Count(), []
    with (
        telling(150, as_json, as_markdown) as terminal,
        elsewhere(scheduler) as crew,
        opened(folder / STORE) as store,
    ):
        for batch in batches:
            if not pieces:  # what a subject takes is asked before anything is drawn
                count.begin = monotonic()
            if seconds is not None and count.spent >= seconds:
                break
            store.remember(as_words(piece) for piece in batch)
            run_pieces(terminal, store, batch, seconds, crew or pool(workers), count)
            pieces += batch
        if published:
            run_controls(terminal, store, crew or pool(workers))
        told = list(asked(stored(store, pieces)))
        print_summary(terminal, told)
        terminal.tell(count.told)
        shrink_and_write(terminal, store, told, folder, crew or pool(workers), seconds)
        terminal.say(f"{len(told)} cases are stored in {folder}. Next: {with_folder('crosscheck report', results)}")


@dataclass
class Count:
    """How many cases were asked in this run, and when the first finding came."""

    begin: float = field(default_factory=monotonic)
    cases: int = 0
    first: str = ""

    @property
    def spent(self) -> float:
        return monotonic() - self.begin

    def add(self, answer: Answer, lost: int) -> int:
        """How many cases are in this one; `lost`: in one that ended its process."""
        from reports.search.chunk import cases_in, has_fault

        many = cases_in(answer) or lost
        self.cases += many
        if not self.first and (has_fault(answer) or (lost and not answer.finished)):
            self.first = f" The first finding came after {self.spent:.1f} s, within {self.cases} cases."
        return many

    @property
    def told(self) -> str:
        return f"{self.cases} cases were asked in {self.spent:.0f} s.{self.first}"


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
    terminal: Terminal, store: Store, pieces: Sequence[Chunk], seconds: float | None, crew: Workforce, count: Count
) -> None:
    """Run what is not stored until the time is over; a case that ends its process is found and kept.

    All at once where there is time for all: between two waves workers wait for the last of the first.
    """
    from reports.cli.terminal import interruptible
    from reports.run.running import missing, run_into
    from reports.search.chunk import lost, stored

    with interruptible(terminal, store, pieces, LIMIT, "pieces", size=lambda piece: piece.count) as (
        waiting,
        done,
        watch,
    ):

        def counted(answer: Any, many: int = 0) -> None:
            done(answer, count.add(answer, many))

        def one_more(answer: Any) -> None:
            counted(answer, 1)

        size = len(waiting) if seconds is None else WAVE * crew.threads
        while waiting and (seconds is None or count.spent < seconds):
            wave, waiting = waiting[:size], waiting[size:]
            run_into(store, wave, False, LIMIT, crew.threads, counted, watch, supervised=crew.supervise)
            singles = missing(lost(stored(store, wave)), store, LIMIT)
            run_into(store, singles, False, LIMIT, crew.threads, one_more, watch, supervised=crew.supervise)


def run_controls(terminal: Terminal, store: Store, crew: Workforce) -> None:
    """How soon planted faults are found; those that are stored are not run again."""
    from reports.cli.terminal import interruptible
    from reports.run.running import run_into
    from reports.search.planted import controls

    with interruptible(terminal, store, controls(), CONTROL, "planted faults") as (waiting, done, watch):
        run_into(store, waiting, False, CONTROL, crew.threads, done, watch, supervised=crew.supervise)


def print_summary(terminal: Terminal, told: Sequence[Asked]) -> None:
    """A line for each check of each subject, with how many cases, the errors' distribution and how many are faults; and
    a line for each fault, by which it is drawn again."""
    from reports.cli.terminal import print_table
    from reports.search.chunk import FOUND, HEADER, findings, summary

    print_table(terminal, "Errors, each relative to the largest of what it is an error of", HEADER, summary(told), 2)
    if faults := findings(told):
        print_table(terminal, "Findings, by what draws them again", FOUND, faults, 2)


def shrink_and_write(
    terminal: Terminal, store: Store, told: Sequence[Asked], folder: Path, crew: Workforce, seconds: float | None
) -> None:
    """Make some findings of each check smaller, for as long again as was searched, and write them as recipes and
    scripts."""
    from reports.cli.terminal import interruptible
    from reports.run.files import write_whole
    from reports.run.running import run_into
    from reports.search.shrinking import Shrink, files_of, line_of, worst_of

    tasks = [Shrink.of(check, one) for check, one in worst_of(told)]
    if not tasks:
        terminal.tell("Nothing was found.")
        return
    begin = monotonic()
    with interruptible(terminal, store, tasks, LIMIT, "findings") as (waiting, done, watch):
        size = len(waiting) if seconds is None else crew.threads
        while waiting and (seconds is None or monotonic() - begin < seconds):
            wave, waiting = waiting[:size], waiting[size:]
            run_into(store, wave, False, LIMIT, crew.threads, done, watch, supervised=crew.supervise)
    texts = {}
    answers = store.answers(tasks)
    for task in (one for one in tasks if one in answers):
        terminal.tell(f"{task.label}: {line_of(answers[task])}")
        texts |= {folder / name: text for name, text in files_of(task, answers[task]).items()}
    write_whole(texts, "the findings that were there stay as they were")
