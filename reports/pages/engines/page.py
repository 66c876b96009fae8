"""The page of engines: what each builds, how exact each is, and why engines of one order differ by a factor of 20.

Each table is made from rows or answers, and empty where there are none.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from matplotlib.figure import Figure

from engines import method_name, registry
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.tasks import Answer
from reports.pages.engines.experiments import (
    ASKED,
    BORROWED,
    CHARTED,
    CLOSED_AT,
    CLOSED_BY,
    CLOSING,
    CODE,
    COMPILED,
    CONTACT,
    CORRECTED,
    FREE,
    MOVES,
    SHARES,
    SPRUNG,
    SWEPT,
    TOO_OLD,
    YES,
    Capabilities,
    VelocityTerm,
)
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.plots.work_precision import work_precision
from reports.write.columns import Column, column_of
from reports.write.provenance import told_versions
from reports.write.tables import NOTHING, markdown, number


def rows_of(material: Material, scenes: Iterable[str]) -> list[Measurement]:
    """The rows of these scenes in all engines, those beside the grid as if they were of it; no user's tricks."""
    names = {*scenes}
    return [
        replace(row, purpose="sweep")
        for cell, row in material.rows.items()
        if cell.scene.name in names
        and cell.purpose in ("sweep", "beside")
        and column_of(cell.scene, cell.engine) is not Column.NAIVE
    ]


def missed(row: Measurement, field: str) -> float:
    return getattr(row, field) if Outcome(row.outcome).comparable and getattr(row, field) > 0 else float("inf")


def line_of(material: Material, cells: Mapping[float, Any]) -> list[tuple[float, float]]:
    return [
        (share, material.rows[cell].angle)
        for share, cell in cells.items()
        if cell in material.rows and missed(material.rows[cell], "angle") < float("inf")
    ]


def matrix(answers: Mapping[Capabilities, Answer]) -> str:
    """A column an engine, from what it built; empty where nothing was asked yet."""
    engines = [task.of for task in answers]
    body = [[what, *(verdict(str(answer.values[what])) for answer in answers.values())] for what in ASKED]
    body += [[what, *(str(answer.values[what]) for answer in answers.values())] for what in ("reactions", "width")]
    body.append(["version", *(told_versions([engine]) for engine in engines)])
    return markdown(["", *(engine.name for engine in engines)], body, left=len(engines) + 1) if engines else ""


def verdict(told: str) -> str:
    """The word of a cell. The engine lacks a thing only where the sentence names a place in its documentation."""
    if told in (YES, CONTACT, CODE):
        return told
    if told.startswith(TOO_OLD):
        return "too old"
    return "**has none**" if "https://" in told else "not built"


def sentences(answers: Mapping[Capabilities, Answer]) -> list[tuple[str, str, str, str]]:
    """(engine, what, the word, the sentence) of what is not built."""
    return [
        (task.of.name, what, verdict(told), told)
        for task, answer in answers.items()
        for what in ASKED
        if (told := str(answer.values[what])) not in (YES, CONTACT, CODE)
    ]


def share_table(material: Material) -> str:
    lines = {name: dict(line_of(material, cells)) for name, cells in CLOSING.items()}
    body = [[number(share), *(number(lines[name].get(share, float("nan"))) for name in lines)] for share in SHARES]
    header = ["share closed in a step", *(f"{name}: angle error [rad]" for name in lines)]
    return markdown(header, body, left=0) if any(lines.values()) else ""


def _told(row: Measurement | None) -> str:
    """The angle error, or what became of the run."""
    if row is None:
        return NOTHING
    return number(row.angle) if Outcome(row.outcome).comparable else f"**{row.outcome}**"


def moves_table(material: Material) -> str:
    """What moves each engine: as it was, and with one setting turned; lines that were not run are left out."""
    body = [
        [engine, what, _told(material.rows.get(before)), _told(material.rows.get(after))]
        for engine, what, before, after in MOVES
        if before in material.rows or after in material.rows
    ]
    header = ["engine", "what is turned", "angle error before [rad]", "after [rad]"]
    return markdown(header, body, left=2) if body else ""


LOOKS = (("first", "o", "-"), ("second", "s", "--"))


def draw_shares(
    found: Mapping[str, Sequence[tuple[float, float]]], shipped: Mapping[str, tuple[float, float]], theme: Theme = LIGHT
) -> Figure:
    """`found`: by name (share, angle error [rad]), by rising share; `shipped`: marked points, by what they are."""
    with settings():
        figure = new_figure(3.6, theme, 6.6)
        axes = figure.subplots()
        for (name, points), (role, mark, line) in zip(found.items(), LOOKS, strict=False):
            colour = getattr(theme, role)
            axes.loglog(*zip(*points, strict=True), linestyle=line, marker=mark, color=colour, markersize=5, label=name)
        for name, (share, error) in shipped.items():
            axes.plot([share], [error], marker="o", markersize=13, fillstyle="none", color=theme.ink, linestyle="none")
            axes.annotate(name, (share, error), xytext=(11, 8), textcoords="offset points", color=theme.ink, fontsize=8)
        axes.set_xlabel("share of a gap that a step of 1 ms closes")
        axes.set_ylabel("largest angle error [rad]")
        style_axes(axes, theme)
        axes.margins(0.08, 0.15)
        axes.legend(loc="lower left")
    return figure


NAME = "engines"
# One of each, as shipped where that is a variant: what is built does not depend on settings, but for constructions.
ASKED_OF = tuple({engine.name: engine for engine in reversed((*registry.VARIANTS, *registry.OTHERS))}.values())[::-1]
MATRIX = tuple(map(Capabilities, ASKED_OF))
# Of what declares a compliance of its loops, which a law can follow; the settings that make it small.
TERMS = tuple(
    VelocityTerm(engine)
    for engine in (*registry.VARIANTS, *registry.OTHERS)
    if engine.variant == "tuned" and (soft := engine.softness(FREE.mechanism(), 1e-3)) is not None and soft.compliance
)
EXPERIMENTS = (
    Failure(
        title="How much of a gap a step closes",
        expected="The share that a step closes decides how far pins stay open, and so the error, at equal step.",
        cells=tuple(dict.fromkeys((*CLOSED_BY, *CLOSED_AT.values(), *SPRUNG.values(), *CORRECTED.values()))),
    ),
    Failure(
        title="Compiled models",
        expected="The same model as in C, with an error that no step makes smaller where a loop turns.",
        cells=COMPILED,
        columns=("angle", "gap", "reaction"),
    ),
)


def shown(rows: Sequence[Measurement], field: str) -> set[tuple[str, str]]:
    """(scene, method) of each engine as shipped, and of the variant of it that comes nearest to the truth."""
    chosen: set[tuple[str, str]] = set()
    for scene, engine in dict.fromkeys((row.scene, row.engine) for row in rows):
        own = [row for row in rows if (row.scene, row.engine) == (scene, engine)]
        best = min(own, key=lambda row: missed(row, field))
        chosen |= {(scene, best.method)} | {(scene, row.method) for row in own if row.variant == "default"}
    return chosen


def figures(material: Material) -> dict[str, str]:
    """Work and precision by quantity, and the error against the share of a gap that is closed."""
    drawn: dict[str, str] = {}
    for field, names in CHARTED.items():
        rows = [row for row in rows_of(material, names) if missed(row, field) < float("inf") and row.cpu > 0]
        if rows:
            chosen = shown(rows, field)
            figure = work_precision(rows, lambda row, chosen=chosen: (row.scene, row.method) in chosen, field)
            drawn[f"work_{field}"] = svg(
                figure, f"Each engine as shipped and at its best: {field} error against CPU time"
            )
    lines = {name: points for name, cells in CLOSING.items() if (points := line_of(material, cells))}
    if lines:
        marked = ("as shipped", SHARES[1]), ("its usual erp", 0.2)
        shipped = {
            words: point
            for (words, share), name in zip(marked, CLOSING, strict=True)
            for point in lines.get(name, ())
            if point[0] == share
        }
        drawn["shares"] = svg(draw_shares(lines, shipped), "Angle error against the share of a gap that a step closes")
    return drawn


def _terms(material: Material) -> str:
    body = [
        [method_name(task.of), *(number(float(answer.array(name).max())) for name in ("with", "without"))]
        for task in TERMS
        if (answer := material.finished(task)) is not None
    ]
    header = ["method", "from the law with the velocity term", "from the law without it"]
    return markdown(header, body) if body else ""


def words(material: Material) -> Mapping[str, Any]:
    """Tables by name, each empty where nothing was run."""
    answers = {task: answer for task in MATRIX if (answer := material.finished(task)) is not None}
    return {
        "matrix": matrix(answers),
        "refused": sentences(answers),
        "shares": share_table(material),
        "moves": moves_table(material),
        "terms": _terms(material),
        "absent": list(registry.ABSENT.values()),
    }


PAGE = Page(
    name=NAME,
    title="Engines side by side",
    lesson="What each engine builds, what it costs, how near it comes; and why engines of one order differ twentyfold.",
    scenes=(),
    engines=(),
    companions=(FREE,),
    borrowed=BORROWED,
    cells=SWEPT,
    failures=EXPERIMENTS,
    figures=figures,
    words=words,
    tasks=(*MATRIX, *TERMS),
)
