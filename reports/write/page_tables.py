"""The tables of a mechanism's page: errors by method, recommended settings, and programs with these settings."""

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
from reports.model.quantities import QUANTITIES, quantity
from reports.model.spending import EQUAL_COST_FACTOR
from reports.write.row_tables import sweep_words
from reports.write.tables import DASH, ENFORCED_BY, markdown, milliseconds, number, step_words

# Step [s] at which methods are compared. A grid without this step uses its nearest step.
COMPARED_STEP = 1e-3
# Error bounds in the unit of the page's quantity. A setting is recommended for each bound.
TARGETS = (1e-2, 1e-4, 1e-6, 1e-9)

# Function of (method, step [s]) that returns the error by the declared regularisation, or NaN if it is unknown.
DeclaredError = Callable[[str, float], float]


def compared_step(rows: Iterable[Measurement]) -> float:
    """The step [s] of the sweep whose ratio to COMPARED_STEP is nearest to 1, or NaN without rows."""
    steps = {row.step for row in rows if row.purpose == "sweep"}
    return min(steps, key=lambda step: abs(math.log(step / COMPARED_STEP)), default=math.nan)


def scene_table(
    rows: Sequence[Measurement],
    name: str,
    enforcement: Mapping[str, str] | None = None,
    declared: DeclaredError = lambda method, step: math.nan,
    inner_runs: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """A Markdown table of the methods in one scene, with errors and cost at `compared_step` and convergence.

    Args:
        name: the quantity of the page. Columns for errors of joints follow if a row has such errors.
        enforcement: method -> what enforces the joints.
        declared: declared error of a method at a step. A plateau that is larger is marked.
        inner_runs: method -> description of the inner runs.
    """
    step, compared = compared_step(rows), quantity(name)
    verdicts = by_method(sweeps(rows), name)
    columns = [compared] + [
        q
        for q in QUANTITIES
        if q.is_of_joints and q is not compared and any(math.isfinite(getattr(row, q.name)) for row in rows)
    ]
    titles = {row.method: f"{row.method} ({inner_runs[row.method]})" for row in rows if row.method in inner_runs}
    declared_errors = {row.method: declared(row.method, step) for row in rows}
    is_soft = any(value > 0 for value in declared_errors.values())
    body = []
    for key, members in groups(rows).items():
        method = members[0].method
        row = next((row for row in members if row.step == step), None)
        errors = [number(getattr(row, q.name)) if row else DASH for q in columns]
        if row is not None and not Outcome(row.outcome).comparable:
            errors[0] = f"**{row.outcome}**"
        if is_soft:
            errors.insert(1, number(declared_errors[method]))
        cost = milliseconds(row.cpu) if row and row.cpu > 0 else DASH
        finest = min(members, key=lambda row: row.step)
        behaviour = sweep_words(verdicts[key], "" if Outcome(finest.outcome).comparable else finest.outcome)
        if verdicts[key].plateau > ROOM_SOFT * declared(method, finest.step) + compared.rounding:
            behaviour += ", **not declared**"
        body.append([titles.get(method, method), *errors, cost, behaviour])
    heads = [q.heading for q in columns]
    if is_soft:
        heads.insert(1, f"declared [{compared.unit}]")
    header = ["method", *heads, "CPU [ms/s]", f"order as the step shrinks, plateau in {compared.unit}"]
    by_title = enforcement and {titles.get(method, method): text for method, text in enforcement.items()}
    return markdown(header, body, left=1, enforcement=by_title)


@dataclass(frozen=True)
class Advice:
    """The recommended setting of an engine for some targets. `row` is None if no step meets these targets."""

    engine: str
    targets: tuple[float, ...]
    row: Measurement | None
    sweep: Sweep | None = None


def advice(rows: Sequence[Measurement], name: str, order: Sequence[str] = ()) -> tuple[Advice, ...]:
    """The cheapest method for each engine and target, from the rows of one scene. `order`: methods in the page's order.
    A step counts only if all smaller steps of its method meet the target too, since errors may cancel at one step."""
    verdicts = by_method(sweeps(rows), name)
    rank = {method: index for index, method in enumerate(order)}
    advised: list[Advice] = []
    for engine in dict.fromkeys(row.engine for row in rows):
        methods = [members for key, members in groups(rows).items() if key[1] == engine]
        by_setting: dict[tuple[str, float] | None, tuple[Measurement | None, list[float]]] = {}
        for target in TARGETS:
            row = _cheapest(methods, name, target, rank)
            by_setting.setdefault((row.method, row.step) if row else None, (row, []))[1].append(target)
        for row, targets in by_setting.values():
            sweep = verdicts[row.scene, row.engine, row.variant] if row else None
            advised.append(Advice(engine, tuple(targets), row, sweep))
    return tuple(advised)


def _cheapest(
    methods: Iterable[Sequence[Measurement]], name: str, target: float, rank: Mapping[str, int]
) -> Measurement | None:
    # Of methods of equal cost, the first one of the page is recommended. A page lists methods with our code last.
    cheapest = [min(rows, key=lambda row: row.cpu) for members in methods if (rows := reliable(members, name, target))]
    least = min((row.cpu for row in cheapest), default=math.nan)
    equal = [row for row in cheapest if row.cpu <= EQUAL_COST_FACTOR * least]
    return min(equal, key=lambda row: (rank.get(row.method, len(rank)), row.cpu), default=None)


def reliable(members: Sequence[Measurement], name: str, target: float) -> list[Measurement]:
    """The timed rows of one method at steps that are smaller than each step that misses the target."""
    rows = []
    for row in sorted(members, key=lambda row: row.step):
        if not (Outcome(row.outcome).comparable and getattr(row, name) <= target):
            break
        rows.append(row)
    return [row for row in rows if row.cpu > 0]


def advice_table(advised: Iterable[Advice], name: str, enforcement: Mapping[str, str] | None = None) -> str:
    header, body = advice_lines(advised, name, enforcement)
    return markdown(header, body, left=4 if enforcement else 3)


def advice_lines(
    advised: Iterable[Advice], name: str, enforcement: Mapping[str, str] | None = None
) -> tuple[list[str], list[list[str]]]:
    unit = quantity(name).unit
    body = []
    for setting in advised:
        targets = ", ".join(number(target, 1) for target in setting.targets)
        row, sweep = setting.row, setting.sweep
        if row is None or sweep is None:
            body.append([setting.engine, targets, "not reached", *[""] * (5 if enforcement else 4)])
            continue
        order = f"{sweep.order:.1f}" if sweep.points >= 2 else DASH
        enforced_by = [enforcement.get(row.method, DASH)] if enforcement else []
        numbers = [step_words(row.step), number(getattr(row, name)), milliseconds(row.cpu), order]
        body.append([setting.engine, targets, f"**{row.variant}**", *enforced_by, *numbers])
    header = ["engine", f"below [{unit}]", "method", *([ENFORCED_BY] if enforcement else [])]
    return [*header, "step", f"error [{unit}]", "CPU [ms/s]", "order"], body


# A program without this suite is a file `results/programs/<scene>_<method>.py`, where "_" replaces other characters
# than letters and digits. The program has the lines `duration = ...` (within the scene's horizon) and `steps = ...`,
# and prints the pose `end` of a body. Programs are written by hand, because `crosscheck export` can't write methods
# with code in each step. A report changes only the line `steps = ...`. For a method without a program, the page has
# code that calls this suite.
PROGRAM_FOLDER = "programs"
RESULTS = Path(__file__).parents[1] / "results"
DURATION_LINE = re.compile(r"^duration = ([\d.]+)", re.MULTILINE)
STEPS_LINE = re.compile(r"^steps = \d+.*$", re.MULTILINE)


@dataclass(frozen=True)
class Program:
    """The program of a recommended method. every: the number of steps between samples. file: path in the folder of the
    results. text: text of the file, or "" if it does not exist.
    """

    method: str
    every: int
    file: str
    text: str


def advised_programs(scene: Scene, advised: Iterable[Advice], methods: Iterable[str]) -> list[Program]:
    """A program for each recommended method of a scene, in the order of `methods`."""
    settings: dict[str, list[tuple[Measurement, float]]] = {method: [] for method in methods}
    for setting in advised:
        if setting.row is not None and setting.row.method in settings:
            settings[setting.row.method].append((setting.row, min(setting.targets)))
    return [
        Program(method, rows[0][0].every, file_of(scene.name, method), _with_steps(scene, method, rows))
        for method, rows in settings.items()
        if rows
    ]


def _with_steps(scene: Scene, method: str, rows: Iterable[tuple[Measurement, float]]) -> str:
    text = program(scene.name, method)
    if not text:
        return ""
    until = DURATION_LINE.search(text)
    if until is None:
        raise ValueError(f"{scene.name}: the program of {method} lacks its line `duration = ...`")
    counts = {round(float(until[1]) / scene.spacing) * row.every: number(target, 1) for row, target in rows}
    comment = "; ".join(f"{count}: below {target}" for count, target in counts.items())
    return STEPS_LINE.sub(f"steps = {next(iter(counts))}" + (f"  # {comment}" if len(counts) > 1 else ""), text)


def file_of(scene: str, method: str) -> str:
    return f"{PROGRAM_FOLDER}/{_slug(scene)}_{_slug(method)}.py"


def _slug(name: str) -> str:
    return re.sub("[^a-z0-9]+", "_", name.lower())


def program(scene: str, method: str) -> str:
    """The text of a method's program file; empty if the file does not exist."""
    path = RESULTS / file_of(scene, method)
    return path.read_text(encoding="utf-8") if path.is_file() else ""
