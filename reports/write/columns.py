"""Who holds a mechanism's joints in a method, in a few words: a reader must not take our rows for an engine's own.

And what stands in a column of a table of engines, by who holds the joints; and the tables of all scenes.

A method's name does not decide: documented settings are such only where the engine itself holds every joint by them.
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
from reports.write.page_tables import SAME_COST, TARGETS, reliable
from reports.write.tables import NOTHING, error_words, markdown, milliseconds, number, step_words


class Column(StrEnum):
    """The columns of a table of engines, and what stands in none."""

    SHIPPED = "as shipped"
    SETTINGS = "documented settings"
    CODE = "with our code"
    NAIVE = "naive"  # our code alone holds a joint that the engine does not have
    WHOLE = ""  # of an engine that has no such variants


VARIANTS = {"default": Column.SHIPPED, "tuned": Column.SETTINGS, "extended": Column.CODE}


@cache
def column_of(scene: Scene, engine: Engine) -> Column:
    """Where a method stands for a scene; one that is neither as shipped nor extended has settings."""
    mechanism = mechanism_of(scene)
    held = {engine.enforcement(joint, mechanism) for joint in mechanism.joints}
    if "ours" in held:
        return Column.NAIVE
    if "engine, our rows" in held or len(engine.inner_steps(mechanism)) > 1:
        return Column.CODE
    return VARIANTS.get(engine.variant, Column.SETTINGS)


def told_variant(scene: Scene, engine: Engine) -> str:
    """The variant as a page names it: an engine's usual name is not lent to a trick of a user's; no two share one."""
    if engine.variant not in VARIANTS or column_of(scene, engine) is not Column.NAIVE:
        return engine.variant
    return str(Column.NAIVE) if engine.variant == "default" else f"{Column.NAIVE}, {engine.variant}"


def told_rows(rows: Mapping[Cell, Measurement]) -> dict[Cell, Measurement]:
    """Rows under the variants that pages name."""
    return {cell: replace(row, variant=told_variant(cell.scene, cell.engine)) for cell, row in rows.items()}


def held_by(engine: Engine, mechanism: Mechanism) -> str:
    """'engine', 'ours', or 'engine; skate: ours' where joints are held by different ones.

    Joints are named by kind; where those of one kind differ, by their own names.
    """
    holders: list[Enforcement] = [engine.enforcement(joint, mechanism) for joint in mechanism.joints]
    if len({*holders}) <= 1:
        return holders[0] if holders else "no joints"
    kinds: dict[str, set[Enforcement]] = {}
    for joint, holder in zip(mechanism.joints, holders, strict=True):
        kinds.setdefault(_kind(joint), set()).add(holder)
    found: dict[Enforcement, dict[str, None]] = {}
    for joint, holder in zip(mechanism.joints, holders, strict=True):
        name = _kind(joint) if len(kinds[_kind(joint)]) == 1 else joint.name
        found.setdefault(holder, {})[name] = None
    others = [f"{' and '.join(names)}: {holder}" for holder, names in sorted(found.items()) if holder != "engine"]
    return "; ".join(["engine", *others] if "engine" in found else others)


def _kind(joint: object) -> str:
    return type(joint).__name__.lower()


@cache
def held_in(scene: Scene, engine: Engine) -> str:
    """Who holds a scene's joints; kept, because a method asks its whole model about each of a hundred joints."""
    return held_by(engine, mechanism_of(scene))


def holders(cells: Iterable[Cell]) -> dict[str, str]:
    """Who holds the joints in these cells, by method; several answers where the cells of a method differ."""
    found: dict[str, dict[str, None]] = {}
    for cell in cells:
        method = f"{cell.engine.name} {told_variant(cell.scene, cell.engine)}"
        found.setdefault(method, {}).setdefault(held_in(cell.scene, cell.engine))
    return {method: " or ".join(told) for method, told in found.items()}


# CPU seconds per simulated second at which methods stand side by side: a hundredth of real time.
BUDGET = 1e-2
WITHIN = SAME_COST * BUDGET  # what scatters by less is equal


NO_JOINT, NOT_BUILT, TOO_DEAR = "no such joint", "not built", "too dear"


def runs_of(engine: Engine, scene: Scene, step: float) -> str:
    """'5 runs, finest 0.125 ms' for steps as told [s]; empty for a single run."""
    steps = engine.inner_steps(mechanism_of(scene))
    return f"{len(steps)} runs, finest {number(1e3 * step * min(steps), 3)} ms" if len(steps) > 1 else ""


@dataclass(frozen=True)
class Line:
    """The rows of one scene in one engine, by column; a column without methods is one in which the engine has none."""

    page: Page
    scene: Scene
    engine: str
    columns: Mapping[Column, tuple[tuple[Engine, tuple[Measurement, ...]], ...]]

    @property
    def name(self) -> str:
        return self.page.quantity


Entry = tuple[Page, Sequence[Measurement]]  # a page, and the rows of those of its scenes that are to be shown


def lines(entries: Iterable[Entry]) -> list[Line]:
    """A line for each scene and engine that have rows.

    Where an engine's tuned variant needs our code for a scene, a construction of the page that needs none stands for
    its documented settings, if there is one.
    """
    found = []
    for page, rows in entries:
        usual = usual_variants((engine.name, engine.variant) for engine in page.engines)
        for scene in page.scenes:
            own = [row for row in rows if row.scene == scene.name]
            for name in dict.fromkeys(row.engine for row in own):
                methods = [engine for engine in page.engines_of(scene) if engine.name == name]
                columns: dict[Column, list[Engine]] = {}
                for engine in methods:
                    if engine.variant in usual[name]:
                        place = column_of(scene, engine) if VARIANTS.keys() & {*usual[name]} else Column.WHOLE
                        columns.setdefault(place, []).append(engine)
                if Column.SETTINGS not in columns and Column.WHOLE not in columns:
                    others = [each for each in methods if column_of(scene, each) is Column.SETTINGS]
                    columns |= {Column.SETTINGS: others} if others else {}
                with_rows = {
                    place: tuple(
                        (each, tuple(row for row in own if row.method == method_name(each))) for each in engines
                    )
                    for place, engines in columns.items()
                    if place is not Column.NAIVE
                }
                found.append(Line(page, scene, name, with_rows))
    return found


Words = Callable[[Line, Column], str]  # of a cell


def empty(line: Line, column: Column) -> str:
    """Why a cell is empty: the engine has no such joint, or our adapter builds none; '' for one that is not."""
    if column not in line.columns:
        return NO_JOINT
    rows = [row for _, own in line.columns[column] for row in own]
    if not rows or any(row.outcome != Outcome.UNSUPPORTED for row in rows):
        return ""
    # The engine lacks a thing where the sentence names a place in its documentation.
    return NO_JOINT if any("https://" in row.sentence for row in rows) else NOT_BUILT


def _told(line: Line, column: Column, cell: Words) -> str:
    """A cell: empty, with the reason, where the engine has no such joint or our adapter builds none."""
    if word := empty(line, column):
        return f"*{word}*"
    if not any(own for _, own in line.columns[column]):
        return NOTHING
    return cell(line, column) + means(line, column)


def means(line: Line, column: Column) -> str:
    """ ", contact" where a contact with friction stands for a joint, and the variant where it has no usual name."""
    joints = mechanism_of(line.scene).joints
    engine_holds = column in (Column.SHIPPED, Column.SETTINGS)
    contact = engine_holds and any(isinstance(joint, Skate | Roll) for joint in joints)
    engine_names = [engine.variant for engine, _ in line.columns[column]]
    unusual = [] if column is Column.WHOLE else [f"*{name}*" for name in engine_names if name not in VARIANTS]
    return "".join(f", {word}" for word in [*(["contact"] if contact else []), *dict.fromkeys(unusual)])


def _table(
    found: Sequence[Line],
    cell: Words,
    folder: str,
    both: bool,
    remarks: Mapping[tuple[str, Column], str] = MappingProxyType({}),
) -> Iterator[tuple[str, str]]:
    """(engine, table), or one table of all engines under an empty name if `both`; `remarks` stand in the header."""
    for engine in [""] if both else dict.fromkeys(line.engine for line in found):
        own = [line for line in found if engine in ("", line.engine)]
        engines = dict.fromkeys(line.engine for line in own)
        heads = [
            (name, place)
            for name in engines
            for place in Column
            if any(line.engine == name and place in line.columns for line in own)
        ]
        body = []
        for scene in dict.fromkeys((line.page.name, line.scene) for line in own):
            here = {line.engine: line for line in own if (line.page.name, line.scene) == scene}
            first = next(iter(here.values()))
            unit = quantity(first.name).unit
            name = f"[{first.scene.name.replace('_', ' ')}]({folder}{first.page.name}.md), {unit}"
            body.append([name, *(_told(here[each], place, cell) if each in here else NOTHING for each, place in heads)])
        names = [f"{each} {place}".strip() + remarks.get((each, place), "") for each, place in heads]
        yield engine, markdown(["scene", *names], body, len(heads) + 1)


def error_within(rows: Sequence[Measurement], name: str, cost: float) -> float:
    """The least error of a method's runs that take no more CPU time than this [s/s]; infinite without one.

    An error counts at a step only if no smaller step has a larger one: else it is luck.
    """
    worst, least = 0.0, math.inf
    for row in sorted(rows, key=lambda row: row.step):
        error = getattr(row, name)
        worst = max(worst, error) if Outcome(row.outcome).comparable and math.isfinite(error) else math.inf
        if 0 < row.cpu <= cost:
            least = min(least, worst)
    return least


def reached(methods: Iterable[Sequence[Measurement]], name: str) -> list[tuple[float, float]]:
    """(CPU time [s/s], least error within it) by rising cost: of each run of some methods that brings it down, and of
    the dearest."""
    methods = list(methods)
    costs = sorted({row.cpu for rows in methods for row in rows if row.cpu > 0})
    found = [(cost, min(error_within(rows, name, cost) for rows in methods)) for cost in costs]
    drawn = [(cost, error) for cost, error in found if 0 < error < math.inf]
    better = [point for before, point in zip([(0.0, math.inf), *drawn], drawn, strict=False) if point[1] < before[1]]
    return better + [point for point in drawn[-1:] if point not in better]


def equal_cost(entries: Iterable[Entry], folder: str = "") -> str:
    """One table of all engines: the error that each column reaches within BUDGET."""
    return next((table for _, table in _table(_swept(entries), within_budget, folder, both=True)), "")


def within_budget(line: Line, column: Column) -> str:
    """The least error of a column within BUDGET, or why there is none."""
    methods = [rows for _, rows in line.columns[column]]
    least = min((error_within(rows, line.name, WITHIN) for rows in methods), default=math.inf)
    if math.isfinite(least):
        return number(least)
    cheap = [row for rows in methods for row in rows if 0 < row.cpu <= WITHIN]
    failed = dict.fromkeys(row.outcome for row in cheap if not Outcome(row.outcome).comparable)
    return f"**{', '.join(failed)}**" if failed else "not kept" if cheap else TOO_DEAR


def equal_error(entries: Iterable[Entry], folder: str = "") -> dict[str, str]:
    """Engine -> its table: the least CPU time [ms/s] for an error below each of TARGETS."""

    def cell(line: Line, column: Column) -> str:
        costs = [
            min(
                (row.cpu for _, rows in line.columns[column] for row in reliable(rows, line.name, target)),
                default=math.nan,
            )
            for target in TARGETS
        ]
        return ", ".join(map(milliseconds, costs)) if any(map(math.isfinite, costs)) else NOTHING

    return dict(_table(_swept(entries), cell, folder, both=False))


def _swept(entries: Iterable[Entry]) -> list[Line]:
    return lines((page, [row for row in rows if row.purpose == "sweep"]) for page, rows in entries)


def equal_step(entries: Iterable[Entry], steps: Mapping[str, float] = USUAL_STEPS, folder: str = "") -> dict[str, str]:
    """Engine -> its table: the errors at these steps [s] by name. No cell has a time.

    How many runs an answer takes stands in the heading where it is the same for all scenes.
    """
    last, found = list(steps.values())[-1], lines(entries)
    runs: dict[tuple[str, Column], set[str]] = {}
    for line in found:
        for column, methods in line.columns.items():
            runs.setdefault((line.engine, column), set()).add(runs_of(methods[-1][0], line.scene, last))
    alike = {place: next(iter(words)) for place, words in runs.items() if len(words) == 1}

    def cell(line: Line, column: Column) -> str:
        engine, rows = line.columns[column][-1]  # of our code, what is extended furthest
        own = "" if (line.engine, column) in alike else runs_of(engine, line.scene, last)
        return "; ".join(filter(None, (_at_steps(line, engine, rows, steps), own)))

    remarks = {place: f" ({words})" for place, words in alike.items() if words}
    return dict(_table(found, cell, folder, both=False, remarks=remarks))


def _at_steps(line: Line, engine: Engine, members: Sequence[Measurement], steps: Mapping[str, float]) -> str:
    """'0.044, 0.01; plateau 0.011', or the outcomes where no step gave an answer."""
    if not any(Outcome(row.outcome).comparable for row in members):
        return ", ".join(dict.fromkeys(row.outcome for row in members))
    asked = [step for name, step in steps.items() if is_run_at(name, engine.name, engine.variant)]
    sweep = by_method(sweeps(members), line.name).get((line.scene.name, engine.name, engine.variant))
    at = [next((row for row in members if is_step(row.step, step)), None) for step in asked]
    errors = [getattr(row, line.name) for row in at if row is not None and Outcome(row.outcome).comparable]
    words = [error_words(row, line.name) for row in at]
    told = words if len(set(words)) > 1 else words[:1]  # "saturated" once
    end = _brought(sweep, members, errors) if sweep else ""
    return "; ".join(filter(None, (", ".join(told), end)))


def _brought(sweep: Sweep, members: Iterable[Measurement], told: Sequence[float]) -> str:
    """What a smaller step brings: an order only where the error falls to the finest step."""
    finest = min((row for row in members if row.purpose == "sweep"), key=lambda row: row.step)
    if not Outcome(finest.outcome).comparable:
        return f"**{finest.outcome}** at {step_words(finest.step)}"
    match sweep.verdict:
        case Verdict.PLATEAU:
            luck = " (less is luck)" if any(error < sweep.plateau / 2 for error in told) else ""
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
