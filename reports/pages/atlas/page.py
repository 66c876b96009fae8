"""The failure atlas: everything on it is read from two files that `crosscheck atlas` writes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.atlas.chart import atlas_map
from reports.pages.atlas.subjects import SUBJECTS, Subject
from reports.pages.atlas.table import CELLS, COSTS, Costs, Line, read, read_costs
from reports.plots.theme import svg
from reports.run.cluster import CHUNK
from reports.write.tables import markdown, number

FOLDER = Path(__file__).parents[2] / "results"
MANY = 1_000_000  # cells whose cost is told
CORES = (1, 64, 1024)


@cache
def lines(path: Path = FOLDER / CELLS) -> tuple[Line, ...]:
    """What was kept of all maps."""
    return read(path)


@cache
def costs(path: Path = FOLDER / COSTS) -> Costs | None:
    """What they took; None where nothing was kept."""
    return read_costs(path)


def of(subject: Subject) -> list[Line]:
    """Methods in the order of the engines' registration, as far as they are registered."""
    from engines.registry import VARIANTS, method

    order = {method(engine): place for place, engine in enumerate(VARIANTS)}
    own = [line for line in lines() if line.subject == subject.name]
    return sorted(own, key=lambda line: (order.get(line.method, len(order)), line.method, line.value))


def outcome_table(own: Sequence[Line]) -> str:
    """A line a method: of how many cells what became, and from where on all finished."""
    methods = list(dict.fromkeys(line.method for line in own))
    met = [o for o in Outcome if any(o in line.told for line in own)]
    body = []
    for name in methods:
        told = [outcome for line in own if line.method == name for outcome in line.told]
        shares = [f"{100 * told.count(outcome) / len(told):.0f} %" for outcome in met]
        body.append([name, *shares, str(largest_safe([line for line in own if line.method == name]))])
    header = ["method", *map(str, met), "largest step that is safe at every value [s]"]
    return markdown(header, body)


def largest_safe(own: Sequence[Line]) -> str:
    """The largest step from which on downwards every cell of a method finished, at all values; '-' if there is none."""
    safe = ""
    for place, step in reversed(list(enumerate(own[0].steps))):
        if not all(line.told[place].comparable for line in own):
            break
        safe = number(step)
    return safe or "-"


def agreement(own: Sequence[Line]) -> tuple[int, int]:
    """(columns whose softness tells to within a factor of three from which step on a joint tears, columns that tear).

    Only columns in which the largest steps tear and smaller ones do not: else there is no border to compare.
    """
    near = count = 0
    for line in own:
        torn = [outcome in (Outcome.TORN, Outcome.DIVERGED, Outcome.RESET) for outcome in line.told]
        if not (torn[0] and not torn[-1]) or not (0 < line.gives < math.inf):
            continue
        last = max(place for place, one in enumerate(torn) if one)
        count += 1
        near += 1 / 3 <= line.steps[last] / line.gives <= 3
    return near, count


def scaling(found: Costs) -> dict[str, Any]:
    """What MANY cells take on so many cores, and where it stops scaling: by the numbers of one measured atlas.

    A cell takes `each` CPU seconds. The client stores an answer after the other, and a cluster's scheduler passes one
    chunk after the other on: the slower of the two is the floor, whatever the number of cores.
    """
    each = found.seconds / found.cells
    puts = MANY / found.puts
    chunks = MANY * each / CHUNK / found.chunks if found.chunks > 0 else math.nan
    floor = max(puts, 0.0 if math.isnan(chunks) else chunks)
    free = [(cores, MANY * each / cores) for cores in CORES]
    body = [
        [f"{cores}", _time(t), _time(max(t, floor)), "the cores" if t > floor else "the client"] for cores, t in free
    ]
    return {
        "each": each,
        "table": markdown(["cores", "CPU time over cores", "at least", "limited by"], body, left=0),
        "puts": found.puts,
        "chunks": found.chunks,
        "stops": MANY * each / floor,
        "floor": _time(floor),
        "told": not math.isnan(found.chunks),
        "cells": found.cells,
        "seconds": found.seconds,
        "wall": found.wall,
        "workers": found.workers,
        "made_with": found.made_with,
    }


def _time(seconds: float) -> str:
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * length:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds:.3g} s"


def words(material: Material) -> Mapping[str, Any]:
    """A dictionary a map that was run; nothing else on the page has numbers."""
    told = []
    for subject in SUBJECTS:
        own = of(subject)
        if own:
            near, count = agreement(own)
            told.append(
                {
                    "name": subject.name,
                    "title": subject.title,
                    "table": outcome_table(own),
                    "near": near,
                    "tearing": count,
                    "columns": len({line.value for line in own}),
                    "steps": len(own[0].counts),
                    "run": sum(line.run for line in own),
                    "points": sum(len(line.counts) for line in own),
                }
            )
    found = costs()
    missing = [subject.title for subject in SUBJECTS if not of(subject)]
    return {"subjects": told, "missing": missing, "scaling": scaling(found) if found and found.lines else None}


def figures(material: Material) -> Mapping[str, str]:
    """A picture a map that was run."""
    return {
        subject.name: svg(atlas_map(subject, of(subject)), f"{subject.title}: step against {subject.parameter}")
        for subject in SUBJECTS
        if of(subject)
    }


PAGE = Page(
    name="atlas",
    title="Failure atlas",
    lesson="Where methods fail: step against the parameter that breaks a scene, and what explains the borders.",
    scenes=(),
    engines=(),
    words=words,
    figures=figures,
)
