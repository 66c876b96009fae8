"""`crosscheck atlas`: every scene of the failure atlas, step against the parameter that breaks it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.cli.options import FOLDER, STORE, Folder, Scheduler, Workers, listed

if TYPE_CHECKING:
    from reports.cli.terminal import Terminal
    from reports.model.tasks import Answer
    from reports.pages.atlas.column import Column
    from reports.pages.atlas.subjects import Subject
    from reports.pages.atlas.table import Cost, Line
    from reports.run.cluster import Workforce
    from reports.run.store import Store

LIMIT = 600.0  # CPU seconds of one column, far above any that is known
STRIDE = 4  # of so many steps one is run, and those between only where a border is; in small maps all
SMALL = 16  # points along a side
VARIANTS_SHOWN = ("default", "tuned")
ATLAS = "atlas"  # the folder with what is stored of it


def atlas(
    scenes: Annotated[str | None, typer.Option(help="Maps by name, with commas between; all if none is named.")] = None,
    points: Annotated[int, typer.Option(min=2, max=200, help="Of a map, along each side.")] = 40,
    every_point: Annotated[
        bool, typer.Option("--every-point", help="Run also the points between two of one outcome, 4 steps apart.")
    ] = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write the files from which the published page is made, too.")
    ] = False,
) -> None:
    """Map where methods fail: step against the parameter that breaks a scene. It is no part of a full run."""
    from engines.registry import VARIANTS
    from reports.cli.report import published, refuse_outside_a_checkout, write_files
    from reports.cli.terminal import Terminal, opened
    from reports.pages.atlas.column import Column
    from reports.pages.atlas.table import CELLS, COSTS, Costs, as_csv, costs_as_csv, read, read_costs
    from reports.run.cluster import elsewhere, pool
    from reports.write.provenance import machine, today, versions

    subjects = chosen(scenes)
    if publish:
        refuse_outside_a_checkout()
    engines = tuple(engine for engine in VARIANTS if engine.variant in VARIANTS_SHOWN)
    columns = {
        (subject, value): Column(
            subject.make(value), engines, subject.steps(points), 1 if every_point or points < SMALL else STRIDE
        )
        for subject in subjects
        for value in subject.at(points)
    }
    terminal = Terminal(140)
    folder = results / ATLAS
    with elsewhere(scheduler) as cluster, opened(folder / STORE) as store:
        crew, begin = cluster or pool(workers), monotonic()
        run = run_columns(terminal, store, list(columns.values()), crew)
        wall = monotonic() - begin if run == len(columns) else 0.0
        answers = whole(store, list(columns.values()))
        chunks, puts = rates(store, crew if cluster else None)
        threads = crew.threads
    lines, costs = told(columns, answers)
    said = f"{today()}, {machine()}, {versions()}"
    made = Costs(said, round(wall, 1), threads, chunks, puts, tuple(costs))
    places = [folder, *([published()] if publish else [])]
    for place in places:
        names = {subject.name for subject in subjects}
        others = [line for line in read(place / CELLS) if line.subject not in names]
        earlier = read_costs(place / COSTS)
        also = [line for line in (earlier.lines if earlier else ()) if line.subject not in names]
        every = Costs(**{**vars(made), "lines": (*made.lines, *also), "wall": 0.0 if also else made.wall})
        texts = {place / CELLS: as_csv([*lines, *others]), place / COSTS: costs_as_csv(every)}
        write_files(texts, f"{sum(line.run for line in lines)} cells written to {place / CELLS}")
    terminal.say(f"{run} of {len(columns)} columns run in {wall or monotonic() - begin:.0f} s, the others were stored")


def chosen(scenes: str | None) -> tuple[Subject, ...]:
    """The maps of these names. Raises BadInput."""
    from reports.pages.atlas.subjects import SUBJECTS

    known = {subject.name: subject for subject in SUBJECTS}
    return SUBJECTS if scenes is None else tuple(known[word] for word in listed("--scenes", [scenes], known))


def run_columns(terminal: Terminal, store: Store, columns: Sequence[Column], crew: Workforce) -> int:
    """Run what is not stored; a column whose process ends is asked again cell by cell. How many columns were run."""
    from reports.cli.terminal import interruptible
    from reports.run.running import missing, run_into

    ordered = sorted(columns, key=lambda column: -column.cost)  # the longest first
    with interruptible(terminal, store, ordered, LIMIT, "columns") as (waiting, done, watch):
        run_into(store, waiting, False, LIMIT, crew.threads, done, watch, supervised=crew.supervise)
        answers = store.answers(columns)
        singles = [one for column in columns if not answers[column].finished for one in column.singles]
        singles = list(missing(singles, store, LIMIT))
        run_into(store, singles, False, LIMIT, crew.threads, watch=watch, supervised=crew.supervise)
    return len(waiting)


def whole(store: Store, columns: Sequence[Column]) -> dict[Column, dict[Any, Answer]]:
    """The answers to each column: one, or one for each of its cells where it was asked cell by cell."""
    answers = store.answers(columns)
    return {
        column: {column: answers[column]} if answers[column].finished else dict(store.answers(column.singles))
        for column in columns
    }


def told(
    columns: Mapping[tuple[Subject, float], Column], answers: Mapping[Column, Mapping[Any, Answer]]
) -> tuple[list[Line], list[Cost]]:
    """The lines of the atlas's file, and what each subject took in each method."""
    from reports.pages.atlas.column import line_of
    from reports.pages.atlas.table import Cost

    lines: list[Line] = []
    spent: dict[tuple[str, str], tuple[int, float]] = {}
    for (subject, value), column in columns.items():
        for engine in column.engines:
            line, seconds = line_of(subject, value, column, engine, answers[column])
            lines.append(line)
            cells, before = spent.get((subject.name, line.method), (0, 0.0))
            spent[subject.name, line.method] = cells + line.run, before + seconds
    return lines, [Cost(*key, *numbers) for key, numbers in spent.items()]


def rates(store: Store, cluster: Workforce | None) -> tuple[float, float]:
    """(chunks of nothing that go through a cluster in a second, NaN without one; answers stored in a second)."""
    from reports.model.outcomes import Outcome
    from reports.model.tasks import Answer, answered
    from reports.pages.atlas.column import SAMPLE, Nothing

    chunks = float("nan")
    tasks = [Nothing(number) for number in range(SAMPLE)]
    if cluster is not None:
        begin = monotonic()
        for _ in cluster.supervise(answered, tasks, LIMIT):
            pass
        chunks = len(tasks) / (monotonic() - begin)
    begin = monotonic()
    for task in tasks:
        store.put_answer(task, Answer(Outcome.FINISHED, values=task.run()))
    return chunks, len(tasks) / (monotonic() - begin)
