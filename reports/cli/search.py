"""`crosscheck search` tests engines on random mechanisms by physical laws, equivalent descriptions and the judge."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from engines.registry import ENGINES, INSTALLED, VARIANTS
from reports.cli.known import engines_named
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
from reports.cli.terminal import Terminal, interruptible, opened, print_table, telling
from reports.model.ending import BadInput
from reports.run import cluster
from reports.run.files import write_whole
from reports.run.installed import installed
from reports.search import plan
from reports.search.chunk import CHECKS_HEADER, FINDINGS_HEADER, CaseResult, finding_rows, make_chunks, summary_rows
from reports.search.parts import SINGULAR_KINDS
from reports.search.release import DISTRIBUTIONS
from reports.search.run import DEFAULT_CASES, Search
from reports.search.shrinking import files_of, line_of
from reports.search.subjects import DEFAULT_ORACLES, ORACLES, Adapted, Alone, Subject

FRESH_CASES = 10  # Number of cases for each engine with a fresh seed.
USUAL = ",".join(DEFAULT_ORACLES)
FURTHER = ",".join(name for name in ORACLES if name not in DEFAULT_ORACLES)
Seed = Annotated[
    int | None, typer.Option(min=0, help="Other mechanisms; if none is given, those of the last commit's hash.")
]
Fresh = Annotated[bool, typer.Option(help="Keep drawing new random seeds until --seconds is over; all engines.")]
Kinds = Annotated[
    str | None, typer.Option(help="Of joints and forces: pin,rod,spring,...; of MuJoCo alone: connect,gear,...")
]
Oracles = Annotated[
    str, typer.Option(help=f"What is asked: {USUAL}; or {FURTHER}, of methods that estimate their own errors.")
]
ReleaseName = Annotated[
    str | None, typer.Option(help="MuJoCo alone in this release, as 3.6.0: installed once, in the user's cache.")
]


def search(
    engine: EngineName = None,
    variant: VariantName = None,
    cases: Annotated[int | None, typer.Option(min=1, help="Cases for each engine: 200; 10 of a fresh seed.")] = None,
    seconds: Annotated[float | None, typer.Option(help="Begin nothing after this time; what is done is kept.")] = None,
    seed: Seed = None,
    fresh: Fresh = False,
    published: Annotated[bool, typer.Option(help="All that the published page shows, planted faults too.")] = False,
    kinds: Kinds = None,
    decades: Annotated[int, typer.Option(min=0, max=6, help="By how many more masses and lengths differ.")] = 0,
    oracles: Oracles = USUAL,
    release: ReleaseName = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Search random mechanisms for faults, and reduce and write each finding as a script of the engine."""
    chosen = any((engine, variant, cases, seed is not None, kinds, decades, release, oracles != USUAL))
    _refuse(seconds, seed, fresh, published, chosen)
    subjects = chosen_subjects(engine, variant, release, everything=fresh or published)
    all_kinds = tuple(dict.fromkeys(kind for subject in subjects for kind in subject.kinds))
    wanted = listed("--kinds", [kinds], (*all_kinds, *SINGULAR_KINDS)) if kinds is not None else all_kinds
    subjects = [subject for subject in subjects if {*wanted} & {*subject.kinds, *SINGULAR_KINDS}]
    names = listed("--oracles", [oracles], tuple(ORACLES))
    if fresh:
        batches = plan.fresh_chunks(subjects, cases or FRESH_CASES)
    elif published:
        batches = iter([plan.published_chunks()])
    else:
        first = plan.published_seeds()[0] if seed is None else seed
        batches = iter([make_chunks(subjects, first, cases or DEFAULT_CASES, wanted, decades, names)])
    folder = results / SEARCH
    with (
        telling(150, as_json, as_markdown) as terminal,
        cluster.connect_cluster(scheduler, workers) as crew,
        opened(folder / STORE) as store,
    ):
        run = Search(store, crew, seconds, partial(interruptible, terminal))
        found = run.run(batches)
        if published:
            run.run_controls()
        title = "Errors, each relative to the largest of what it is an error of"
        print_table(terminal, title, CHECKS_HEADER, summary_rows(found), 2)
        if faults := finding_rows(found):
            print_table(terminal, "Findings, by what draws them again", FINDINGS_HEADER, faults, 2)
        terminal.tell(run.summary)
        _shrink_and_write(terminal, run, found, folder)
        terminal.say(f"{len(found)} cases are stored in {folder}. Next: {with_folder('crosscheck report', results)}")


def _refuse(seconds: float | None, seed: int | None, fresh: bool, published: bool, chosen: bool) -> None:
    if seconds is not None and not 0 < seconds < float("inf"):
        raise BadInput(f"--seconds is {seconds}; it must be a finite number greater than zero")
    if fresh and (seconds is None or published or seed is not None):
        raise BadInput("--fresh needs --seconds, and takes no --seed and no --published: it draws seeds until then")
    if published and chosen:
        raise BadInput(
            "--published takes --seconds, --workers, --scheduler and --results alone: what is asked is fixed"
        )


def chosen_subjects(
    engine: str | None, variant: str | None, release: str | None = None, everything: bool = False
) -> list[Subject]:
    """The engines with this name and variant. MuJoCo without our adapter can be selected too. Raises BadInput."""
    if release is not None:
        if engine not in (None, "mujoco") or variant not in (None, "alone"):
            raise BadInput(f"--release is {release!r}, which is MuJoCo's alone; leave out --engine and --variant")
        installed(DISTRIBUTIONS, release)
        return [Alone(release)]
    if everything and engine is None and variant is None:
        return plan.all_subjects()
    if variant == "alone" and engine in (None, "mujoco"):
        return [Alone()]
    known = (*(VARIANTS if variant is None else ENGINES), *(INSTALLED if engine is not None else ()))
    alone: list[Subject] = [Alone()] if variant is None and engine in (None, "mujoco") else []
    return [*(Adapted(method) for method in engines_named(engine, variant, known)), *alone]


def _shrink_and_write(terminal: Terminal, run: Search, found: list[CaseResult], folder: Path) -> None:
    if not any(case.result.faults for case in found):
        terminal.tell("Nothing was found.")
        return
    texts = {}
    for task, answer in run.shrink(found).items():
        terminal.tell(f"{task.label}: {line_of(answer)}")
        texts |= {folder / name: text for name, text in files_of(task, answer).items()}
    write_whole(texts, "the findings that were there stay as they were")
