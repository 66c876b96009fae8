"""Tables that compare engines in all scenes: at equal CPU time, at equal error and at equal step.

The column of a method in a scene depends on what enforces the joints. In methods with documented settings, the engine
enforces every joint.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from types import MappingProxyType

from engines import Enforcement, Engine
from engines.registry import method_name
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.scene import Scene
from reports.model.cells import USUAL_STEPS, Cell, is_run_at, is_step, mechanism_of, usual_variants
from reports.model.convergence import Sweep, Verdict, by_method, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.model.quantities import quantity
from reports.model.spending import EQUAL_COST_FACTOR
from reports.write.page_tables import TARGETS, reliable
from reports.write.row_tables import error_words
from reports.write.tables import DASH, markdown, milliseconds, number, step_words


class Column(StrEnum):
    """The kinds of methods. NAIVE methods, whose joints are enforced outside of the engine, have no column."""

    SHIPPED = "as shipped"
    SETTINGS = "documented settings"
    CODE = "with our code"
    NAIVE = "naive"
    WHOLE = ""  # column for engines without a variant in COLUMN_OF_VARIANT


COLUMN_OF_VARIANT = {"default": Column.SHIPPED, "tuned": Column.SETTINGS, "extended": Column.CODE}
ENFORCEMENT_LABELS: Mapping[Enforcement, str] = {
    "engine": "engine",
    "engine, our rows": "engine, our equations",
    "ours": "our code",
}


@cache
def column_of(scene: Scene, engine: Engine) -> Column:
    mechanism = mechanism_of(scene)
    enforcement = {engine.enforcement(joint, mechanism) for joint in mechanism.joints}
    if "ours" in enforcement:
        return Column.NAIVE
    if "engine, our rows" in enforcement or len(engine.inner_steps(mechanism)) > 1:
        return Column.CODE
    return COLUMN_OF_VARIANT.get(engine.variant, Column.SETTINGS)


def displayed_variant(scene: Scene, engine: Engine) -> str:
    """The name of a variant on pages. For a naive method, "naive" replaces "default" or precedes the name."""
    if engine.variant not in COLUMN_OF_VARIANT or column_of(scene, engine) is not Column.NAIVE:
        return engine.variant
    return str(Column.NAIVE) if engine.variant == "default" else f"{Column.NAIVE}, {engine.variant}"


def with_displayed_variants(rows: Mapping[Cell, Measurement]) -> dict[Cell, Measurement]:
    return {cell: replace(row, variant=displayed_variant(cell.scene, cell.engine)) for cell, row in rows.items()}


def describe_enforcement(engine: Engine, mechanism: Mechanism) -> str:
    """What enforces the joints, such as 'engine', or 'engine; skate: our code' if joints differ. A joint is named by
    its kind, or by its name if joints of its kind differ.
    """
    joints: list[tuple[str, str, Enforcement]] = [
        (type(joint).__name__.lower(), joint.name, engine.enforcement(joint, mechanism)) for joint in mechanism.joints
    ]
    by_kind: dict[str, set[Enforcement]] = {}
    for kind, _, enforcement in joints:
        by_kind.setdefault(kind, set()).add(enforcement)
    names: dict[Enforcement, dict[str, None]] = {}
    for kind, name, enforcement in joints:
        names.setdefault(enforcement, {})[kind if len(by_kind[kind]) == 1 else name] = None
    if len(names) <= 1:
        return next((ENFORCEMENT_LABELS[enforcement] for enforcement in names), "no joints")
    others = [
        f"{' and '.join(of_one)}: {ENFORCEMENT_LABELS[enforcement]}"
        for enforcement, of_one in sorted(names.items())
        if enforcement != "engine"
    ]
    return "; ".join(["engine", *others] if "engine" in names else others)


@cache  # `enforcement` may examine the whole model, and a scene may have a hundred joints
def _describe_enforcement_in(scene: Scene, engine: Engine) -> str:
    return describe_enforcement(engine, mechanism_of(scene))


def enforcement_by_method(cells: Iterable[Cell]) -> dict[str, str]:
    """Method -> what enforces the joints. If cells of a method differ, their descriptions are joined by " or "."""
    by_method: dict[str, dict[str, None]] = {}
    for cell in cells:
        method = f"{cell.engine.name} {displayed_variant(cell.scene, cell.engine)}"
        by_method.setdefault(method, {}).setdefault(_describe_enforcement_in(cell.scene, cell.engine))
    return {method: " or ".join(descriptions) for method, descriptions in by_method.items()}


CPU_BUDGET = 1e-2  # CPU time per simulated second at which methods are compared [s/s]
ACCEPTED_CPU = EQUAL_COST_FACTOR * CPU_BUDGET

NO_JOINT, NOT_BUILT, TOO_SLOW = "no such joint", "not built", "too slow"
SMALLER_STEP_FAILS = "a smaller step fails"


def describe_inner_runs(engine: Engine, scene: Scene, step: float) -> str:
    """The number of inner runs with their smallest step, such as '5 runs, finest 0.125 ms'; empty for a single run."""
    steps = engine.inner_steps(mechanism_of(scene))
    return f"{len(steps)} runs, finest {number(1e3 * step * min(steps), 3)} ms" if len(steps) > 1 else ""


@dataclass(frozen=True)
class EngineLine:
    """The methods of an engine in one scene with their rows, by column. A column without methods is missing."""

    page: Page
    scene: Scene
    engine: str
    columns: Mapping[Column, tuple[tuple[Engine, tuple[Measurement, ...]], ...]]

    @property
    def quantity(self) -> str:
        return self.page.quantity


PageRows = tuple[Page, Sequence[Measurement]]  # a page, and the compared rows of its scenes


def engine_lines(entries: Iterable[PageRows]) -> list[EngineLine]:
    """A line for each scene and engine with rows. If the variant "tuned" needs our code in a scene, the column SETTINGS
    has other methods with documented settings."""
    return [
        _engine_line(page, scene, engine, [row for row in rows if row.scene == scene.name])
        for page, rows in entries
        for scene in page.scenes
        for engine in dict.fromkeys(row.engine for row in rows if row.scene == scene.name)
    ]


def _engine_line(page: Page, scene: Scene, engine_name: str, rows: Sequence[Measurement]) -> EngineLine:
    usual = usual_variants((engine.name, engine.variant) for engine in page.engines).get(engine_name, ())
    methods = [engine for engine in page.engines_of(scene) if engine.name == engine_name]
    columns: dict[Column, list[Engine]] = {}
    for engine in methods:
        if engine.variant in usual:
            column = column_of(scene, engine) if COLUMN_OF_VARIANT.keys() & {*usual} else Column.WHOLE
            columns.setdefault(column, []).append(engine)
    if Column.SETTINGS not in columns and Column.WHOLE not in columns:
        others = [engine for engine in methods if column_of(scene, engine) is Column.SETTINGS]
        columns |= {Column.SETTINGS: others} if others else {}
    with_rows = {
        column: tuple((engine, tuple(row for row in rows if row.method == method_name(engine))) for engine in of_column)
        for column, of_column in columns.items()
        if column is not Column.NAIVE
    }
    return EngineLine(page, scene, engine_name, with_rows)


FormatCell = Callable[[EngineLine, Column], str]


def absence_reason(line: EngineLine, column: Column) -> str:
    """The reason NO_JOINT or NOT_BUILT, or "" if a method of the column builds the mechanism or if no method was
    run."""
    if column not in line.columns:
        return NO_JOINT
    rows = [row for _, of_method in line.columns[column] for row in of_method]
    if not rows or any(row.outcome != Outcome.UNSUPPORTED for row in rows):
        return ""
    absent = {kind for engine, _ in line.columns[column] for kind in engine.absent_elements}
    return NO_JOINT if absent.intersection(map(type, mechanism_of(line.scene).joints)) else NOT_BUILT


def _format_cell(line: EngineLine, column: Column, format_rows: FormatCell) -> str:
    if reason := absence_reason(line, column):
        return f"*{reason}*"
    if not any(rows for _, rows in line.columns[column]):
        return DASH
    return format_rows(line, column) + remarks_of(line, column)


def remarks_of(line: EngineLine, column: Column) -> str:
    """The remarks in a cell, which are ', contact' if a contact replaces a joint, and the names of unusual variants."""
    joints = mechanism_of(line.scene).joints
    by_contact = any(engine.uses_contacts for engine, _ in line.columns[column])
    by_contact &= column in (Column.SHIPPED, Column.SETTINGS)
    contact = by_contact and any(isinstance(joint, Skate | Roll) for joint in joints)
    variants = [engine.variant for engine, _ in line.columns[column]]
    unusual = [] if column is Column.WHOLE else [f"*{name}*" for name in variants if name not in COLUMN_OF_VARIANT]
    return "".join(f", {remark}" for remark in [*(["contact"] if contact else []), *dict.fromkeys(unusual)])


def _table(
    lines: Sequence[EngineLine],
    format_rows: FormatCell,
    remarks: Mapping[tuple[str, Column], str] = MappingProxyType({}),
) -> str:
    """A Markdown table with a line for each scene and a column for each engine and kind. `remarks`: ends of headers."""
    engines = dict.fromkeys(line.engine for line in lines)
    present = {(line.engine, column) for line in lines for column in line.columns}
    heads = [(engine, column) for engine in engines for column in Column if (engine, column) in present]
    body = []
    for key in dict.fromkeys((line.page.name, line.scene) for line in lines):
        of_scene = {line.engine: line for line in lines if (line.page.name, line.scene) == key}
        first = next(iter(of_scene.values()))
        title = f"[{first.scene.name.replace('_', ' ')}]({first.page.name}.md), {quantity(first.quantity).unit}"
        cells = (
            _format_cell(of_scene[engine], column, format_rows) if engine in of_scene else DASH
            for engine, column in heads
        )
        body.append([title, *cells])
    names = [f"{engine} {column}".strip() + remarks.get((engine, column), "") for engine, column in heads]
    return markdown(["scene", *names], body, len(heads) + 1)


def _by_engine(lines: Sequence[EngineLine]) -> Iterator[tuple[str, list[EngineLine]]]:
    for engine in dict.fromkeys(line.engine for line in lines):
        yield engine, [line for line in lines if line.engine == engine]


def error_within(rows: Sequence[Measurement], name: str, cost: float) -> float:
    """The least error of a method's runs that take at most this CPU time [s/s]; infinite without such a run. A run
    counts with the largest error at its step and all smaller steps, since two errors may cancel at one step."""
    worst, least = 0.0, math.inf
    for row in sorted(rows, key=lambda row: row.step):
        error = getattr(row, name)
        worst = max(worst, error) if Outcome(row.outcome).comparable and math.isfinite(error) else math.inf
        if 0 < row.cpu <= cost:
            least = min(least, worst)
    return least


def error_by_cost(methods: Iterable[Sequence[Measurement]], name: str) -> list[tuple[float, float]]:
    """Pairs (CPU time [s/s], error within this time) for the first and the last time, and for each time at which the
    error falls."""
    methods = list(methods)
    costs = sorted({row.cpu for rows in methods for row in rows if row.cpu > 0})
    pairs = [(cost, min(error_within(rows, name, cost) for rows in methods)) for cost in costs]
    pairs = [(cost, error) for cost, error in pairs if 0 < error < math.inf]
    return [pair for index, pair in enumerate(pairs) if index in (0, len(pairs) - 1) or pair[1] < pairs[index - 1][1]]


def _swept(entries: Iterable[PageRows]) -> list[EngineLine]:
    return engine_lines((page, [row for row in rows if row.purpose == "sweep"]) for page, rows in entries)


def equal_cost(entries: Iterable[PageRows]) -> str:
    """The table of the least errors within CPU_BUDGET; empty without rows."""
    lines = _swept(entries)
    return _table(lines, within_budget) if lines else ""


def within_budget(line: EngineLine, column: Column) -> str:
    """The least error of a column within CPU_BUDGET, or the reason why there is no such error."""
    methods = [rows for _, rows in line.columns[column]]
    least = min((error_within(rows, line.quantity, ACCEPTED_CPU) for rows in methods), default=math.inf)
    if math.isfinite(least):
        return number(least)
    cheap = [row for rows in methods for row in rows if 0 < row.cpu <= ACCEPTED_CPU]
    failed = dict.fromkeys(row.outcome for row in cheap if not Outcome(row.outcome).comparable)
    return f"**{', '.join(failed)}**" if failed else SMALLER_STEP_FAILS if cheap else TOO_SLOW


def equal_error(entries: Iterable[PageRows]) -> dict[str, str]:
    """For each engine, a table of the least CPU times [ms/s] at which the error is below each of TARGETS."""

    def least_costs(line: EngineLine, column: Column) -> str:
        costs = [
            min(
                (row.cpu for _, rows in line.columns[column] for row in reliable(rows, line.quantity, target)),
                default=math.nan,
            )
            for target in TARGETS
        ]
        return ", ".join(map(milliseconds, costs)) if any(map(math.isfinite, costs)) else DASH

    return {engine: _table(lines, least_costs) for engine, lines in _by_engine(_swept(entries))}


def equal_step(entries: Iterable[PageRows], steps: Mapping[str, float] = USUAL_STEPS) -> dict[str, str]:
    """A table for each engine with errors at `steps` (name -> step [s]) and the effect of smaller steps. The header of
    a method has its number of inner runs, unless the number depends on the scene."""
    last, lines = list(steps.values())[-1], engine_lines(entries)
    runs: dict[tuple[str, Column], set[str]] = {}
    for line in lines:
        for column, methods in line.columns.items():
            runs.setdefault((line.engine, column), set()).add(describe_inner_runs(methods[-1][0], line.scene, last))
    same_runs = {key: next(iter(descriptions)) for key, descriptions in runs.items() if len(descriptions) == 1}

    def errors_at_steps(line: EngineLine, column: Column) -> str:
        engine, rows = line.columns[column][-1]  # the last method of a column has the largest part of our code
        in_cell = "" if (line.engine, column) in same_runs else describe_inner_runs(engine, line.scene, last)
        return "; ".join(filter(None, (_errors_at_steps(line, engine, rows, steps), in_cell)))

    remarks = {key: f" ({description})" for key, description in same_runs.items() if description}
    return {engine: _table(of_engine, errors_at_steps, remarks) for engine, of_engine in _by_engine(lines)}


def _errors_at_steps(line: EngineLine, engine: Engine, rows: Sequence[Measurement], steps: Mapping[str, float]) -> str:
    """A text such as '0.044, 0.01; plateau 0.011', or the outcomes if no run can be compared."""
    if not any(Outcome(row.outcome).comparable for row in rows):
        return ", ".join(dict.fromkeys(row.outcome for row in rows))
    wanted = [step for name, step in steps.items() if is_run_at(name, engine.name, engine.variant)]
    sweep = by_method(sweeps(rows), line.quantity).get((line.scene.name, engine.name, engine.variant))
    chosen = [next((row for row in rows if is_step(row.step, step)), None) for step in wanted]
    errors = [getattr(row, line.quantity) for row in chosen if row is not None and Outcome(row.outcome).comparable]
    cells = [error_words(row, line.quantity) for row in chosen]
    cells = cells if len(set(cells)) > 1 else cells[:1]
    end = _effect_of_smaller_steps(sweep, rows, errors) if sweep else ""
    return "; ".join(filter(None, (", ".join(cells), end)))


def _effect_of_smaller_steps(sweep: Sweep, rows: Iterable[Measurement], errors: Sequence[float]) -> str:
    finest = min((row for row in rows if row.purpose == "sweep"), key=lambda row: row.step)
    if not Outcome(finest.outcome).comparable:
        return f"**{finest.outcome}** at {step_words(finest.step)}"
    match sweep.verdict:
        case Verdict.PLATEAU:
            luck = " (less is luck)" if any(error < sweep.plateau / 2 for error in errors) else ""
            return f"**plateau {number(sweep.plateau)}**{luck}"
        case Verdict.ROUNDING:
            return "to rounding"
        case Verdict.FALLS if sweep.points >= 2:
            return f"order {sweep.order:.1f}"
        case Verdict.LEVELS:
            return "**levels off**"
        case Verdict.GROWS | Verdict.ERRATIC:
            return f"**least at {step_words(sweep.best_step)}**, then worse"
        case _:
            return ""
