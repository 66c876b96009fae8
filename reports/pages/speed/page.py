"""The page on CPU times of the judge and of other engines at equal errors, which `crosscheck bench peers` measures."""

from __future__ import annotations

import math
import statistics
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reports.model.page import Material, Page
from reports.pages.speed.table import (
    JUDGE,
    ONE_COORDINATE,
    REACHED,
    UNREACHED,
    UNSUPPORTED,
    WANTED_AHEAD,
    WANTED_WITHIN,
    SpeedRow,
    SpeedTable,
    read,
)
from reports.plots.looks import colour, mark
from reports.plots.theme import LIGHT, add_legend, drawing, label_decades, style_axes, svg
from reports.write.tables import markdown, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

REASONS = tomllib.loads(Path(__file__).with_name("reasons.toml").read_text(encoding="utf-8"))["reasons"]
NO_REASON = "not explained yet"


def reason_of(row: SpeedRow) -> str:
    cell = {"engines": row.engine, "scenes": row.scene, "targets": row.target}
    for entry in REASONS:
        if all(cell[key] in entry.get(key, (cell[key],)) for key in cell):
            return " ".join(entry["reason"].split())
    return NO_REASON


def behind(table: SpeedTable) -> list[list[str]]:
    """The engine, the cells in which the judge misses its aim with their ratios, and the reason."""
    cells: dict[tuple[str, str], list[str]] = {}
    for row in table.rows:
        if row.is_behind:
            cells.setdefault((row.engine, reason_of(row)), []).append(f"{row.scene} at {row.target:.0e}: {row.words}")
    return [[engine, "; ".join(found), reason] for (engine, reason), found in cells.items()]


def spread(table: SpeedTable) -> tuple[float, float]:
    """The judge's longest time over its shortest one, between the rows of a scene and an error: median and largest."""
    times: dict[tuple[str, float], list[float]] = {}
    for row in table.rows:
        if row.outcome == REACHED and row.judge_seconds > 0:
            times.setdefault((row.scene, row.target), []).append(row.judge_seconds)
    ratios = [max(found) / min(found) for found in times.values()] or [math.nan]
    return statistics.median(ratios), max(ratios)


def unreached(table: SpeedTable) -> list[list[str]]:
    """The cells in which an engine or the judge does not reach the error: the best setting and its error."""
    return [
        [row.scene, row.engine, f"{row.target:.0e}", row.setting or "-", number(row.error), row.note or "-"]
        for row in table.rows
        if row.outcome == UNREACHED
    ]


def refusals(table: SpeedTable) -> list[list[str]]:
    """The engine, the scenes that it does not build, and the reason."""
    scenes: dict[tuple[str, str], list[str]] = {}
    for row in table.rows:
        if row.outcome == UNSUPPORTED and row.target == table.targets[0]:
            scenes.setdefault((row.engine, row.note), []).append(row.scene)
    return [[engine, ", ".join(names), note] for (engine, note), names in scenes.items()]


def settings(table: SpeedTable) -> tuple[Sequence[str], list[list[str]]]:
    """The chosen settings: the header, and for each scene and error those of the judge and of the engines."""

    def words(row: SpeedRow | None) -> str:
        return row.setting if row is not None and row.outcome == REACHED else "-"

    engines = [JUDGE, *(engine for engine in table.engines if engine == _family(engine))]
    places = [(scene, target) for scene in table.scenes for target in table.targets]
    body = [
        [scene, f"{target:.0e}", *(words(table.at(scene, engine, target)) for engine in engines)]
        for scene, target in places
    ]
    return ("scene", "error [rad]", *engines), body


def _family(engine: str) -> str:
    """The engine of which a line is a part, such as 'pinocchio' for 'pinocchio, C++ alone'."""
    return engine.partition(",")[0]


def roofline(table: SpeedTable, name: str) -> Mapping[str, float]:
    """Operations, bytes and time of a step, and the shares of the machine's peaks [%]."""
    work, moved, seconds = (table.number(f"{name} {field}") for field in ("operations", "bytes", "seconds"))
    return {
        "operations": work,
        "bytes": moved,
        "seconds": seconds,
        "operations_share": 100 * work / seconds / table.number("peak operations"),
        "bytes_share": 100 * moved / seconds / table.number(f"{name} peak bytes"),
        "size": table.number(f"{name} size"),
    }


def context_of(table: SpeedTable) -> Mapping[str, Any]:
    judged = [table.at("four-bar", JUDGE, target) for target in table.targets]
    return {
        "missing": not table.rows,
        "tables": [(f"{target:.0e}", markdown(table.header, table.lines(target))) for target in table.targets],
        "behind": markdown(("engine", "scene, error [rad] and ratio", "reason"), behind(table), left=3),
        "is_behind": bool(behind(table)),
        "unreached": markdown(
            ("scene", "engine", "error [rad]", "best", "its error", "note"), unreached(table), left=6
        ),
        "refusals": markdown(("engine", "scenes", "reason"), refusals(table), left=3),
        "settings": markdown(*settings(table), left=2 + len(table.engines)),
        "facts": table.facts,
        "wanted": (WANTED_AHEAD, WANTED_WITHIN),
        "spread": [number(ratio) for ratio in spread(table)],
        "start": table.number("judge start"),
        "per_second": [number(1e3 * row.seconds) for row in judged if row is not None],
        "roofline": {name: roofline(table, name) for name in ("four-bar", "chain")},
        "peak": table.number("peak operations"),
    }


def _look(engine: str, engines: Sequence[str]) -> dict[str, Any]:
    """Engines differ by the form and the filling of their marks, and therefore also in grey."""
    if engine == ONE_COORDINATE:
        return {"marker": "X", "color": LIGHT.ink, "markerfacecolor": LIGHT.ink}
    family = _family(engine)
    paint = colour(family)
    is_part = engine != family
    return {"marker": mark(family), "color": paint, "markerfacecolor": LIGHT.paper if is_part else paint}


def ratio_chart(table: SpeedTable) -> Figure:
    """A panel for each error: the ratio of CPU times over the judge, a line for each scene."""
    from matplotlib.lines import Line2D

    with drawing(1.4 + 0.42 * len(table.scenes)) as figure:
        panels = figure.subplots(1, len(table.targets), sharex=True, sharey=True, squeeze=False)[0]
        for panel, target in zip(panels, table.targets, strict=True):
            _draw(panel, table, target)
        panels[0].set_yticks(range(len(table.scenes)), table.scenes)
        panels[0].invert_yaxis()
        handles = [
            Line2D([], [], linestyle="", markersize=6, label=engine, **_look(engine, table.engines))
            for engine in table.engines
        ]
        handles.append(Line2D([], [], linestyle="-", color=LIGHT.quiet, marker=">", markersize=4, label="or more"))
        add_legend(figure, handles, 4)
    return figure


def _draw(panel: Axes, table: SpeedTable, target: float) -> None:
    style_axes(panel)
    panel.set_title(f"error at most {target:.0e} rad", loc="left", fontweight="bold")
    panel.set_xscale("log")
    panel.set_xlabel("CPU time over that of the judge [1]")
    panel.axvline(1, color=LIGHT.ink, linewidth=1.2)
    panel.axvline(WANTED_AHEAD, color=LIGHT.quiet, linewidth=1, linestyle="--")
    count = max(1, len(table.engines) - 1)
    for place, scene in enumerate(table.scenes):
        for index, engine in enumerate(table.engines):
            row = table.at(scene, engine, target)
            if row is None or not math.isfinite(row.ratio) or row.ratio <= 0:
                continue
            height = place + 0.6 * (index / count - 0.5)
            look = _look(engine, table.engines)
            if row.outcome == UNREACHED:
                panel.plot([row.ratio, 2.2 * row.ratio], [height] * 2, color=look["color"], linewidth=0.9)
                panel.plot([2.2 * row.ratio], [height], marker=">", markersize=3.5, color=look["color"])
            panel.plot([row.ratio], [height], linestyle="", markersize=5, zorder=3, **look)
    label_decades(panel.xaxis, 12, label="{:g}".format)
    for edge in range(len(table.scenes) - 1):
        panel.axhline(edge + 0.5, color=LIGHT.grid, linewidth=0.7)
    panel.grid(False, axis="y")


def figures_of(table: SpeedTable) -> dict[str, str]:
    title = "CPU time of engines over that of the judge at equal errors, by scene"
    return {"ratios": svg(ratio_chart(table), title)} if table.rows else {}


def page_of(table: SpeedTable) -> Page:
    """The page of another table than the published one."""
    return replace(PAGE, context=lambda _: context_of(table), figures=lambda _: figures_of(table))


def context(material: Material) -> Mapping[str, Any]:
    return context_of(read())


def figures(material: Material) -> Mapping[str, str]:
    return figures_of(read())


PAGE = Page(
    name="speed",
    title="Speed at equal errors",
    lesson="The CPU time of the exact solver and of four engines, each at its cheapest setting that reaches an error.",
    context=context,
    figures=figures,
)
