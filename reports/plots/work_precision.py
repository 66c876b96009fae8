"""Charts of rows: error against CPU time, error against step, and all engines at equal CPU time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from reports.model.convergence import groups
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.plots.looks import colour, family_of, look, mark
from reports.plots.theme import LIGHT, add_legend, drawing, new_figure, note, settings, style_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

PANEL_COLUMNS = 2
SLOPES = (1, 2, 4)
FAN_POSITIONS = 25

Featured = Callable[[Measurement], bool]


def pareto(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """The Pareto front of (cost, error) pairs; costs increase."""
    front: list[tuple[float, float]] = []
    for cost, error in sorted(points):
        if not front or error < front[-1][1]:
            front.append((cost, error))
    return front


def forwards(members: Iterable[Measurement]) -> list[Measurement]:
    """The rows of one method that cost less than each row at a smaller step; the largest step is first. Methods that
    choose steps or iterations by trial runs may cost more at large steps."""
    forward: list[Measurement] = []
    for row in sorted(members, key=lambda row: row.step):
        if not forward or row.cpu < forward[-1].cpu:
            forward.append(row)
    return forward[::-1]


def _variants_by_engine(rows: Sequence[Measurement]) -> dict[str, list[str]]:
    variants: dict[str, dict[str, None]] = {}
    for row in rows:
        variants.setdefault(row.engine, {})[row.variant] = None
    return {engine: list(names) for engine, names in variants.items()}


def drawable(rows: Iterable[Measurement], field: str) -> list[Measurement]:
    """The comparable rows of sweeps with a positive finite error."""
    return [
        row
        for row in rows
        if row.purpose == "sweep" and Outcome(row.outcome).comparable and 0 < getattr(row, field) < math.inf
    ]


def _scenes_with_lines(rows: Sequence[Measurement]) -> list[str]:
    scenes = list(dict.fromkeys(row.scene for row in rows))
    with_lines = {scene for (scene, _, _), members in groups(rows).items() if len(members) > 1}
    return [scene for scene in scenes if scene in with_lines] or scenes


def _panels(scenes: Sequence[str], height: float) -> tuple[Figure, list[Axes]]:
    columns = min(PANEL_COLUMNS, len(scenes)) or 1
    count = -(-len(scenes) // columns) or 1
    figure = new_figure(height * count + 0.9)
    axes = figure.subplots(count, columns, squeeze=False, sharey=True).ravel()
    for spare in axes[len(scenes) :]:
        spare.set_visible(False)
    for panel, scene in zip(axes, scenes, strict=False):
        panel.set_title(scene.replace("_", " "), loc="left", fontweight="bold", color=LIGHT.ink)
        panel.set_xscale("log")
        panel.set_yscale("log")
        style_axes(panel)
    return figure, list(axes[: len(scenes)])


def _finish(panel: Axes) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter

    from reports.plots.powers import PowersOfTen

    for axis, (low, high) in ((panel.xaxis, panel.get_xlim()), (panel.yaxis, panel.get_ylim())):
        # A range below two decades may contain only one power of ten, and a single tick does not show the scale.
        narrow = math.log10(high / low) < 2
        axis.set_major_locator(LogLocator(base=10, subs=(1.0, 3.0) if narrow else (1.0,), numticks=9))
        axis.set_major_formatter(PowersOfTen(minor_thresholds=(math.inf, math.inf)))
        axis.set_minor_formatter(NullFormatter())
    panel.minorticks_off()


Pairs = list[tuple[float, float]]


def _chart(
    shown: Sequence[Measurement], scenes: Sequence[str], field: str, label: str, series: Callable[..., Pairs]
) -> tuple[Figure, list[Axes], list[Line2D]]:
    from matplotlib.lines import Line2D

    variants = _variants_by_engine(shown)
    figure, panels = _panels(scenes, 3.6)
    for index, (panel, scene) in enumerate(zip(panels, scenes, strict=True)):
        for (_, engine, variant), members in groups(row for row in shown if row.scene == scene).items():
            panel.plot(*zip(*series(members), strict=True), zorder=3, **look(engine, variant, variants))
        panel.set_xlabel(label)
        if index % PANEL_COLUMNS == 0:
            panel.set_ylabel(f"largest {quantity(field).heading}")
    handles = [
        Line2D([], [], label=f"{engine} {variant}", **look(engine, variant, variants))
        for engine, names in variants.items()
        for variant in names
    ]
    return figure, panels, handles


def work_precision(rows: Iterable[Measurement], featured: Featured = lambda row: True, field: str = "angle") -> Figure:
    """A panel for each scene with error against CPU time and the Pareto front of all rows. A featured method is a line
    through its rows from `forwards`. Rows of other methods are small grey dots."""
    from matplotlib.lines import Line2D

    def pairs(members: Iterable[Measurement]) -> Pairs:
        return [(1e3 * row.cpu, getattr(row, field)) for row in members]

    rows = [row for row in drawable(rows, field) if row.cpu > 0]
    shown = [row for row in rows if featured(row)]
    scenes, label = _scenes_with_lines(shown or rows), "CPU time per simulated second [ms]"
    with settings():
        figure, panels, handles = _chart(shown, scenes, field, label, lambda members: pairs(forwards(members)))
        for panel, scene in zip(panels, scenes, strict=True):
            of_scene = [row for row in rows if row.scene == scene]
            front = zip(*pareto(pairs(of_scene)), strict=True)
            panel.plot(*front, color=LIGHT.grid, linewidth=7, drawstyle="steps-post", zorder=1)
            if others := pairs(row for row in of_scene if not featured(row)):
                panel.plot(*zip(*others, strict=True), ".", color=LIGHT.quiet, markersize=3, zorder=2)
            _finish(panel)
        handles.append(Line2D([], [], color=LIGHT.grid, linewidth=8, label="least error within a CPU time"))
        if len(shown) < len(rows):
            handles.append(Line2D([], [], color=LIGHT.quiet, marker=".", linestyle="none", label="other methods"))
        add_legend(figure, handles, 4, handlelength=3.2)
    return figure


def error_against_step(
    rows: Iterable[Measurement], featured: Featured = lambda row: True, field: str = "angle"
) -> Figure:
    from matplotlib.lines import Line2D

    def pairs(members: Iterable[Measurement]) -> Pairs:
        return [(1e3 * row.step, getattr(row, field)) for row in members]

    rows = [row for row in drawable(rows, field) if featured(row)]
    with settings():
        figure, panels, handles = _chart(rows, _scenes_with_lines(rows), field, "step [ms]", pairs)
        for panel in panels:
            panel.axhspan(1e-16, quantity(field).rounding, color=LIGHT.grid, alpha=0.45, linewidth=0, zorder=0)
            panel.set_ylim(bottom=min(getattr(row, field) for row in rows) / 3)
        for panel in panels:
            _guides(panel)
            _finish(panel)
        handles.append(Line2D([], [], color=LIGHT.grid, linewidth=8, alpha=0.6, label="rounding"))
        add_legend(figure, handles, 4, handlelength=3.2)
    return figure


def _guides(panel: Axes) -> None:
    """Draw reference lines with several slopes at the place that is farthest from the curves of the panel."""
    from scipy.spatial import KDTree

    low, high = np.log10([panel.get_xlim(), panel.get_ylim()]).T
    size = high - low  # decades
    width, gap = min(0.22 * size[0], 0.28 * size[1] / max(SLOPES)), 0.05 * size[0]
    # Positions of the fan's points and numbers, relative to its vertex and as fractions of the panel.
    slopes = [(share * width, slope * share * width) for slope in SLOPES for share in np.linspace(0, 1, 5)]
    fan = np.array([*slopes, *((width + gap, slope * width) for slope in SLOPES)]) / size
    lines = [(np.log10(line.get_xydata()) - low) / size for line in panel.lines]
    between = np.linspace(0, 1, 12)[:, None]
    occupied = [a + between * (b - a) for line in lines for a, b in zip(line, [*line[1:], line[-1]], strict=True)]
    room = 0.97 - fan.max(axis=0)
    positions = [np.linspace(0.03, most, FAN_POSITIONS) for most in room]
    corners = np.stack(np.meshgrid(*positions, indexing="ij"), axis=-1).reshape(-1, 1, 2)
    points = np.concatenate(occupied) if occupied else np.array([[0.0, 1.0]])
    distances = KDTree(points).query(corners + fan)[0].min(axis=1)
    left, bottom = low + corners[distances.argmax(), 0] * size
    for slope, alignment in zip(SLOPES, ("top", "center", "bottom"), strict=True):  # the alignment keeps numbers apart
        end = bottom + slope * width
        panel.plot(10 ** np.array([left, left + width]), 10 ** np.array([bottom, end]), color=LIGHT.quiet,
                   linewidth=0.8, zorder=2, scalex=False, scaley=False)  # fmt: skip
        note(panel, str(slope), (10 ** (left + width), 10**end), (3, 0), LIGHT.quiet, fontsize=8, va=alignment)


COMPARED_HEIGHT = 6.2  # inches
NOTE_WIDTH = 27  # Characters of a line of a panel's note.
NOTE_HEIGHT = 0.075  # Height of a line of a panel's note, relative to the panel.
MAIN_ENGINES = ("pymunk", "mujoco")
EXACT_SOLVER = "lagrange"
ENGINE_NAMES = {
    "pymunk": "pymunk",
    "mujoco": "MuJoCo",
    "exudyn": "Exudyn",
    "box2d": "Box2D",
    "pinocchio": "Pinocchio",
    "mjx": "MJX",
    "bullet": "Bullet",
    "drake": "Drake",
    "mujoco-warp": "MuJoCo Warp",
    "newton": "Newton",
    "rapier": "Rapier",
    "jolt": "Jolt",
    EXACT_SOLVER: "plain code, exact multipliers",
}

CostErrorPairs = Sequence[tuple[float, float]]  # pairs (CPU seconds per simulated second, error) with increasing cost


@dataclass(frozen=True)
class ComparedRow:
    """A row of panels. lines: column -> engine -> points. absent: column -> reason -> engines without a line."""

    title: str
    axis: str
    lines: Mapping[str, Mapping[str, CostErrorPairs]]
    absent: Mapping[str, Mapping[str, Sequence[str]]]


def engines_compared(rows: Sequence[ComparedRow]) -> Figure:
    """A panel for each row and column with the least error within a CPU time; all panels have the same axes."""
    from matplotlib.lines import Line2D

    engines = list(dict.fromkeys(engine for row in rows for lines in row.lines.values() for engine in lines))
    with drawing(COMPARED_HEIGHT) as figure:
        columns = list(dict.fromkeys(column for row in rows for column in row.lines))
        grid = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
        for panels, row in zip(grid, rows, strict=True):
            for panel, column in zip(panels, columns, strict=True):
                panel.set_xscale("log")
                panel.set_yscale("log")
                style_axes(panel)
                for engine, points in row.lines.get(column, {}).items():
                    if points:
                        in_ms = [(1e3 * cost, error) for cost, error in points]
                        panel.plot(*zip(*in_ms, strict=True), **_look_of(engine, engines))
                absent = [
                    f"{reason}: {', '.join(ENGINE_NAMES.get(engine, engine) for engine in names)}"
                    for reason, names in row.absent.get(column, {}).items()
                    if names
                ]
                lines = [line for sentence in absent for line in wrap(sentence, NOTE_WIDTH)]
                _write(panel, 0.98, 0.04 + NOTE_HEIGHT * len(lines), "\n".join(lines), "right")
                panel.set_title(f"{row.title}, {column}", loc="left", fontweight="bold", fontsize=9, color=LIGHT.ink)
            panels[0].set_ylabel(row.axis)
        _write(grid[0][0], 0.02, 0.12, "better: lower\nand further left", "left")
        for panel in grid[-1]:
            panel.set_xlabel("CPU time per simulated second [ms]")
        for panel in grid.ravel():
            panel.minorticks_off()
        handles = [Line2D([], [], label=ENGINE_NAMES.get(name, name), **_look_of(name, engines)) for name in engines]
        add_legend(figure, handles, 4, handlelength=3)
    return figure


def _write(panel: Axes, x: float, y: float, text: str, side: Literal["left", "right"]) -> None:
    panel.text(x, y, text, transform=panel.transAxes, fontsize=8, color=LIGHT.quiet, ha=side, va="top")


def _look_of(engine: str, engines: Sequence[str]) -> dict[str, Any]:
    if engine == EXACT_SOLVER:
        return {"color": LIGHT.quiet, "linestyle": "--", "linewidth": 1.5, "marker": ".", "markersize": 5}
    paint = colour(engine, engines=engines)
    return {
        "color": paint,
        "linestyle": "-",
        "linewidth": 2.2 if engine in MAIN_ENGINES else 1.5,
        "marker": mark(family_of(engine), engines),
        "markersize": 5.5,
        "markerfacecolor": paint if engine in MAIN_ENGINES else LIGHT.paper,
    }
