"""Engines at equal CPU time: a panel for each scene and column of the tables, in it a line for each engine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reports.plots.looks import colour, family_of, mark
from reports.plots.theme import LIGHT, drawing, style_axes

HEIGHT = 6.2  # inches
MAIN = ("pymunk", "mujoco")
JUDGE = "lagrange"  # no engine to choose: what plain code with exact multipliers reaches
NAMES = {
    "pymunk": "pymunk",
    "mujoco": "MuJoCo",
    "exudyn": "Exudyn",
    "box2d": "Box2D",
    "pinocchio": "Pinocchio",
    "mjx": "MJX",
    "bullet": "Bullet",
    JUDGE: "plain code, exact multipliers",
}

Points = Sequence[tuple[float, float]]  # (CPU seconds per simulated second, error), by rising cost


@dataclass(frozen=True)
class Compared:
    """A row of panels: `lines` by column and engine, `absent` by column and reason the engines without one."""

    title: str
    axis: str
    lines: Mapping[str, Mapping[str, Points]]
    absent: Mapping[str, Mapping[str, Sequence[str]]]


def engines_compared(rows: Sequence[Compared]) -> Figure:
    """The least error within a CPU time against that time, both logarithmic; all panels have the same axes."""
    engines = list(dict.fromkeys(each for row in rows for lines in row.lines.values() for each in lines))
    with drawing(HEIGHT) as figure:
        columns = list(dict.fromkeys(column for row in rows for column in row.lines))
        grid = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
        for panels, row in zip(grid, rows, strict=True):
            for panel, column in zip(panels, columns, strict=True):
                panel.set_xscale("log")
                panel.set_yscale("log")
                style_axes(panel)
                for engine, points in row.lines.get(column, {}).items():
                    if points:
                        shown = [(1e3 * cost, error) for cost, error in points]
                        panel.plot(*zip(*shown, strict=True), **_look(engine, engines))
                absent = {
                    word: ", ".join(NAMES.get(each, each) for each in names)
                    for word, names in row.absent.get(column, {}).items()
                    if names
                }
                _say(panel, 0.98, 0.98, "\n".join(f"{word}: {names}" for word, names in absent.items()), "right")
                panel.set_title(f"{row.title}, {column}", loc="left", fontweight="bold", fontsize=9, color=LIGHT.ink)
            panels[0].set_ylabel(row.axis)
        _say(grid[0][0], 0.02, 0.12, "better: lower\nand further left", "left")
        for panel in grid[-1]:
            panel.set_xlabel("CPU time per simulated second [ms]")
        for panel in grid.ravel():
            panel.minorticks_off()
        handles = [Line2D([], [], label=NAMES.get(each, each), **_look(each, engines)) for each in engines]
        figure.legend(handles=handles, loc="outside lower center", ncols=4, handlelength=3)
    return figure


def _say(panel: Axes, x: float, y: float, words: str, side: Literal["left", "right"]) -> None:
    panel.text(x, y, words, transform=panel.transAxes, fontsize=8, color=LIGHT.quiet, ha=side, va="top")


def _look(engine: str, engines: Sequence[str]) -> dict[str, Any]:
    """The colour and mark of the engine's family; plain code has a dashed grey line."""
    if engine == JUDGE:
        return {"color": LIGHT.quiet, "linestyle": "--", "linewidth": 1.5, "marker": ".", "markersize": 5}
    paint = colour(engine, engines=engines)
    return {
        "color": paint,
        "linestyle": "-",
        "linewidth": 2.2 if engine in MAIN else 1.5,
        "marker": mark(family_of(engine), engines),
        "markersize": 5.5,
        "markerfacecolor": paint if engine in MAIN else LIGHT.paper,  # told apart without colours too
    }
