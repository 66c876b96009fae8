"""How long a cell or a task may take: what decides in which order they run, and how many are sent together."""

from __future__ import annotations

import csv
import math
import warnings
from collections.abc import Hashable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from reports.model.cells import Cell, estimated_cost
from reports.model.tasks import Task
from reports.run.waiting import kin_of

PUBLISHED = Path(__file__).parents[1] / "results" / "timings.csv"
LEAST = 3e-3  # s that a cell takes besides stepping, before anything is known

Item = TypeVar("Item", bound=Cell | Task)


def expected_seconds(item: Any) -> float:
    """CPU seconds of one run: of a cell as published if it is, else by the engine's own formula; of a task by its own.

    It orders work and nothing else, so that a cell of other settings may stand for this one.
    """
    if not isinstance(item, Cell):
        return LEAST + float(getattr(item, "cost", 0.0))
    known = _published().get(_name(item))
    return LEAST + (estimated_cost(item) if known is None else known)


def dearest_first(items: Iterable[Item]) -> list[Item]:
    """Items that are akin (`reports.run.waiting`) together, the kin that takes longest first, and so in each.

    So that what begins last is short, and no worker runs long after the others have ended.
    """
    found: dict[Hashable, list[tuple[float, Item]]] = {}
    for item in items:
        found.setdefault(kin_of(item), []).append((expected_seconds(item), item))

    def seconds(pair: tuple[float, Item]) -> float:
        return pair[0]

    groups = sorted(found.values(), key=lambda group: -sum(map(seconds, group)))
    return [item for group in groups for _, item in sorted(group, key=seconds, reverse=True)]


def _name(cell: Cell) -> tuple[str, ...]:
    named = (cell.scene.name, cell.engine.name, cell.engine.variant, cell.purpose, cell.sample_count, cell.every)
    return tuple(map(str, named))


@cache
def _published(path: Path = PUBLISHED) -> dict[tuple[str, ...], float]:
    """Seconds of stepping and building by scene, engine, variant, purpose, samples and steps a sample.

    Where cells of several settings have these in common, the longest. Nothing where there is no such file, nor, with a
    warning, of a damaged one: work is then ordered by formulas.
    """
    found: dict[tuple[str, ...], float] = {}
    if not path.is_file():
        return found
    try:
        lines: Sequence[str] = [line for line in path.read_text(encoding="utf-8").splitlines() if line[:1] != "#"]
        for row in csv.DictReader(lines):
            name = tuple(row[part] for part in ("scene", "engine", "variant", "purpose", "samples", "every"))
            duration = float(row["step"]) * int(row["every"]) * int(row["samples"])
            seconds = float(row["cpu"]) * duration + float(row["build"])
            if math.isfinite(seconds):
                found[name] = max(seconds, found.get(name, 0.0))
    except (OSError, KeyError, ValueError, TypeError) as reason:
        warnings.warn(
            f"{path} can't be read ({type(reason).__name__}: {reason}): work is ordered by formulas", stacklevel=2
        )
        return {}
    return found
