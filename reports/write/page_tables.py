"""The tables of a mechanism's page, which setting gives which accuracy, and the programs that take that setting."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from reference.scene import Scene
from reports.model.convergence import ROOM_SOFT, Sweep, by_method, groups, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.write.tables import NOTHING, markdown, milliseconds, number, step_words, sweep_words

# The step [s] at which methods stand side by side, or the grid's nearest: a user's who has refined once.
COMPARED = 1e-3
# What a user may want to be below, in the unit of the page's quantity.
TARGETS = (1e-2, 1e-4, 1e-6, 1e-9)
# Costs nearer than this are equal: timings of short runs scatter by about a fifth. Of equals the first of the page is
# taken, since each engine's methods stand there from its own settings to our code around it.
SAME_COST = 1.25


# What a method's declared softness costs at a step [s], in the unit of the page's quantity; NaN if not known.
Declared = Callable[[str, float], float]


def undeclared(method: str, step: float) -> float:
    return math.nan


def compared_step(rows: Iterable[Measurement]) -> float:
    """The step [s] of these rows that is nearest to COMPARED, by ratio; NaN without rows."""
    steps = {row.step for row in rows if row.purpose == "sweep"}
    return min(steps, key=lambda step: abs(math.log(step / COMPARED)), default=math.nan)


def scene_table(
    rows: Sequence[Measurement],
    name: str,
    held: Mapping[str, str] | None = None,
    declared: Declared = undeclared,
    runs: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """A line a method of one scene: its errors and cost at the compared step, and what a smaller step brings.

    `held`: who holds the joints, by method; `runs`: how many runs its answer takes, where that is more than one.

    Where it is known for a method, what its declared softness costs stands beside its error, and a plateau that is
    larger is marked: it is neither the step's nor declared.
    """
    step, told = compared_step(rows), quantity(name)
    verdicts = by_method(sweeps(rows), name)
    held = held and {**held, **{f"{each} ({told})": held[each] for each, told in runs.items() if each in held}}
    known = [
        q
        for q in map(quantity, dict.fromkeys((name, "gap", "slip", "reaction")))
        if q.name == name or any(math.isfinite(getattr(row, q.name)) for row in rows)
    ]
    methods = {members[0].method: members for members in groups(rows).values()}
    softness = {method: declared(method, step) for method in methods}
    soft = any(value > 0 for value in softness.values())
    body = []
    for key, members in groups(rows).items():
        row = next((row for row in members if row.step == step), None)
        errors = [number(getattr(row, q.name)) if row else NOTHING for q in known]
        if row is not None and not Outcome(row.outcome).comparable:
            errors[0] = f"**{row.outcome}**"
        if soft:
            errors.insert(1, number(softness[members[0].method]))
        cost = milliseconds(row.cpu) if row and row.cpu > 0 else NOTHING
        finest = min(members, key=lambda row: row.step)
        smaller = sweep_words(verdicts[key], "" if Outcome(finest.outcome).comparable else finest.outcome)
        if verdicts[key].plateau > ROOM_SOFT * declared(members[0].method, finest.step) + told.rounding:
            smaller += ", **not declared**"
        method = members[0].method
        body.append([f"{method} ({runs[method]})" if method in runs else method, *errors, cost, smaller])
    heads = [f"{q.label} error [{q.unit}]" if q.name not in ("gap", "slip") else f"{q.label} [{q.unit}]" for q in known]
    if soft:
        heads.insert(1, f"declared [{told.unit}]")
    header = ["method", *heads, "CPU [ms/s]", f"order as the step shrinks, plateau in {told.unit}"]
    return markdown(header, body, left=1, held=held)


@dataclass(frozen=True)
class Advice:
    """The cheapest method of one engine for some targets, and the row at the step that is to be taken; None where no
    step of no method is below them."""

    engine: str
    targets: tuple[float, ...]
    row: Measurement | None
    sweep: Sweep | None = None


def advice(rows: Sequence[Measurement], name: str, order: Sequence[str] = ()) -> tuple[Advice, ...]:
    """For each engine and target the cheapest method, for the rows of one scene; `order`: of the page's methods.

    A step counts if all finer steps of its method are below the target as well: else its small error was luck.
    """
    verdicts = by_method(sweeps(rows), name)
    place = {method: index for index, method in enumerate(order)}
    found: list[Advice] = []
    for engine in dict.fromkeys(row.engine for row in rows):
        members = {key: own for key, own in groups(rows).items() if key[1] == engine}
        own: dict[tuple[str, float] | None, tuple[Measurement | None, list[float]]] = {}
        for target in TARGETS:
            row = _cheapest(members.values(), name, target, place)
            own.setdefault((row.method, row.step) if row else None, (row, []))[1].append(target)
        for row, targets in own.values():
            sweep = verdicts[row.scene, row.engine, row.variant] if row else None
            found.append(Advice(engine, tuple(targets), row, sweep))
    return tuple(found)


def _cheapest(
    methods: Iterable[Sequence[Measurement]], name: str, target: float, place: Mapping[str, int]
) -> Measurement | None:
    costs = []
    for members in methods:
        below = reliable(members, name, target)
        if below:
            costs.append(min(below, key=lambda row: row.cpu))
    least = min((row.cpu for row in costs), default=math.nan)
    equal = [row for row in costs if row.cpu <= SAME_COST * least]
    return min(equal, key=lambda row: (place.get(row.method, len(place)), row.cpu), default=None)


def reliable(members: Sequence[Measurement], name: str, target: float) -> list[Measurement]:
    """The rows of one method from the finest step up to the first that is not below the target, those with a cost."""
    found = []
    for row in sorted(members, key=lambda row: row.step):
        if not (Outcome(row.outcome).comparable and getattr(row, name) <= target):
            break
        found.append(row)
    return [row for row in found if row.cpu > 0]


def advice_table(found: Iterable[Advice], name: str, held: Mapping[str, str] | None = None) -> str:
    """A line for each advice: method, who holds the joints, step, error, cost and order."""
    header, body = advice_lines(found, name, held)
    return markdown(header, body, left=4 if held else 3)


def advice_lines(
    found: Iterable[Advice], name: str, held: Mapping[str, str] | None = None
) -> tuple[list[str], list[list[str]]]:
    """The same as (header, lines of cells)."""
    unit = quantity(name).unit
    body = []
    for each in found:
        below = ", ".join(number(target, 1) for target in each.targets)
        row, sweep = each.row, each.sweep
        if row is None or sweep is None:
            body.append([each.engine, below, "not reached", *[""] * (5 if held else 4)])
            continue
        order = f"{sweep.order:.1f}" if sweep.points >= 2 else NOTHING
        holder = [held.get(row.method, NOTHING)] if held else []
        numbers = [step_words(row.step), number(getattr(row, name)), milliseconds(row.cpu), order]
        body.append([each.engine, below, f"**{row.variant}**", *holder, *numbers])
    header = ["engine", f"below [{unit}]", "method", *(["joints held by"] if held else [])]
    return [*header, "step", f"error [{unit}]", "CPU [ms/s]", "order"], body


# Programs to copy: each cheapest setting that a page names, as code that runs as it is printed and prints a number.
#
# With an engine alone, a program is a file `results/programs/<scene>_<method>.py`, other characters than letters and
# digits as "_". It says its `duration`, within the scene's horizon, and its `steps`, and ends with the place and angle
# of one body in `end`, which it prints. It is kept by hand but for its line of `steps`, which the method's own row
# gives. There is one where `crosscheck export` can't write the method, since it needs code in each step. The others are
# run by one block of the page, which calls this suite.
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
