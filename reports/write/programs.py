"""Programs to copy: each cheapest setting that a page names, as code that runs as it is printed and prints a number.

With an engine alone, a program is a file `results/programs/<scene>_<method>.py`, other characters than letters and
digits as "_". It says its `duration`, within the scene's horizon, and its `steps`, and ends with the place and angle of
one body in `end`, which it prints. It is kept by hand but for its line of `steps`, which the method's own row gives.
There is one where `crosscheck export` can't write the method, since it needs code in each step. The others are run by
one block of the page, which calls this suite.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from reference.scene import Scene
from reports.model.measure import Measurement
from reports.write.page_tables import Advice
from reports.write.tables import number

FOLDER = "programs"  # beside the pages that are written
KEPT = Path(__file__).parents[1] / "results" / FOLDER
DURATION = re.compile(r"^duration = ([\d.]+)", re.MULTILINE)
STEPS = re.compile(r"^steps = \d+.*$", re.MULTILINE)


@dataclass(frozen=True)
class Program:
    """A method at its cheapest `every`, steps between two samples; `text`, to be `file` below the results, if there is
    a program of its engine alone, else ''."""

    method: str
    every: int
    file: str
    text: str


def advised_programs(scene: Scene, found: Iterable[Advice], methods: Iterable[str]) -> list[Program]:
    """The methods of some advice for a scene, each once, that are among `methods`."""
    rows: dict[str, list[tuple[Measurement, float]]] = {method: [] for method in methods}
    for each in found:
        if each.row is not None and each.row.method in rows:
            rows[each.row.method].append((each.row, min(each.targets)))
    return [
        Program(method, own[0][0].every, file_of(scene.name, method), _with_steps(scene, method, own))
        for method, own in rows.items()
        if own
    ]


def _with_steps(scene: Scene, method: str, rows: Iterable[tuple[Measurement, float]]) -> str:
    text = program(scene.name, method)
    if not text:
        return ""
    until = DURATION.search(text)
    if until is None:
        raise ValueError(f"{scene.name}: the program of {method} lacks its duration")
    counts = {round(float(until[1]) / scene.spacing) * row.every: number(target, 1) for row, target in rows}
    told = "; ".join(f"{count}: below {target}" for count, target in counts.items())
    return STEPS.sub(f"steps = {next(iter(counts))}" + (f"  # {told}" if len(counts) > 1 else ""), text)


def file_of(scene: str, method: str) -> str:
    return f"{FOLDER}/{_slug(scene)}_{_slug(method)}.py"


def _slug(name: str) -> str:
    return re.sub("[^a-z0-9]+", "_", name.lower())


def program(scene: str, method: str) -> str:
    """The program of a method of an engine alone; empty without one."""
    path = KEPT.parent / file_of(scene, method)
    return path.read_text(encoding="utf-8") if path.is_file() else ""
