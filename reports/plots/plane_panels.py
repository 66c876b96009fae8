"""Plane pictures: paths, blades and notes in panels of true shape, and curves over time in panels that are not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from reports.plots.theme import LIGHT, WIDTH, drawing, style_axes

Array = NDArray[np.float64]

MARGIN = 0.07  # of a panel's larger extent
LOWEST, HIGHEST = 1.4, 5.0  # inches that a panel may be high
NARROWEST = 0.7  # a panel's least width over its height: ticks need room


@dataclass(frozen=True)
class Path:
    """A line through points (points, 2); equal labels are one entry of the legend. `colour` names a theme's role.

    `framed`: whether the panel is as large as this path (a wrong motion may run out of the picture). `dot`: at its end.
    """

    points: ArrayLike
    label: str = ""
    colour: str = "ink"
    dashes: Any = "-"
    width: float = 1.6
    framed: bool = True
    dot: bool = False

    def finite(self) -> Array:
        points = np.asarray(self.points, dtype=float)
        return points[np.isfinite(points).all(axis=1)]


@dataclass(frozen=True)
class Blades:
    """Skates or bars, drawn as strokes of `length` [m] at poses (n, 3) of their middles; `label` for the legend."""

    poses: ArrayLike
    length: float
    colour: str = "ink"
    width: float = 3.0
    label: str = ""

    def strokes(self) -> list[Array]:
        poses = np.asarray(self.poses, dtype=float)
        half = 0.5 * self.length * np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=-1)
        return [np.stack([place - arm, place + arm]) for place, arm in zip(poses[:, :2], half, strict=True)]


@dataclass(frozen=True)
class PanelNote:
    """A few words at a place; `align` as matplotlib's horizontal alignment."""

    place: tuple[float, float]
    words: str
    align: str = "left"


@dataclass(frozen=True)
class Panel:
    """One picture. `plane` draws lengths as they are; otherwise the axes have names and may be logarithmic."""

    title: str
    paths: Sequence[Path] = ()
    blades: Sequence[Blades] = ()
    notes: Sequence[PanelNote] = ()
    plane: bool = True
    across: str = ""
    up: str = ""
    logarithmic: bool = False
    logarithmic_across: bool = False

    def corners(self) -> tuple[Array, Array]:
        """The lowest and highest coordinates of what frames the panel."""
        points = [path.finite() for path in self.paths if path.framed]
        points += [stroke for blades in self.blades for stroke in blades.strokes()]
        points += [np.array([note.place]) for note in self.notes]
        everything = np.concatenate(points)
        low, high = everything.min(axis=0), everything.max(axis=0)
        lacking = max(0.0, NARROWEST * float(high[1] - low[1]) - float(high[0] - low[0]))
        spread = np.array([0.5 * lacking, 0.0])
        return low - spread, high + spread


def paths(panels: Sequence[Panel], columns: int = 3, height: float | None = None) -> Figure:
    """The panels in rows, with one legend below. A row is as high [inches] as its pictures ask for, unless given."""
    columns = min(columns, len(panels))
    rows = [panels[i : i + columns] for i in range(0, len(panels), columns)]
    heights = [height or max(_height(panel, WIDTH / columns) for panel in row) for row in rows]
    with drawing(sum(heights) + 0.35 * len(rows) + 0.5) as figure:
        axes = figure.subplots(len(rows), columns, squeeze=False, gridspec_kw={"height_ratios": heights})
        handles: dict[str, Line2D] = {}
        for spot, panel in zip(axes.ravel(), panels, strict=False):
            _draw(spot, panel, handles)
        for spare in axes.ravel()[len(panels) :]:
            spare.set_visible(False)
        if handles:
            figure.legend(handles=list(handles.values()), loc="outside lower center", ncols=3, handlelength=3.2)
    return figure


def _height(panel: Panel, width: float) -> float:
    if not panel.plane:
        return 2.6
    low, high = panel.corners()
    size = (high - low) + 2 * MARGIN * float((high - low).max())
    return float(np.clip(width * size[1] / size[0], LOWEST, HIGHEST))


def _draw(spot: Axes, panel: Panel, handles: dict[str, Line2D]) -> None:
    style_axes(spot)
    spot.set_title(panel.title, loc="left", fontsize=9, color=LIGHT.ink)
    for order, path in enumerate(panel.paths):
        look = {"color": getattr(LIGHT, path.colour), "linestyle": path.dashes, "linewidth": path.width}
        points = path.finite()
        spot.plot(points[:, 0], points[:, 1], zorder=3 + 0.01 * order, **look)
        if path.dot and len(points):
            spot.plot(*points[-1], marker="o", markersize=4.5, color=look["color"], zorder=4)
        if path.label:
            handles.setdefault(path.label, Line2D([], [], label=path.label, **look))
    for blades in panel.blades:
        look = {"color": getattr(LIGHT, blades.colour), "linewidth": blades.width}
        for stroke in blades.strokes():
            spot.plot(stroke[:, 0], stroke[:, 1], solid_capstyle="round", zorder=2.5, **look)
        if blades.label:
            handles.setdefault(blades.label, Line2D([], [], label=blades.label, **look))
    box = {"facecolor": LIGHT.paper, "edgecolor": "none", "pad": 1.0}
    words: dict[str, Any] = {"va": "center", "fontsize": 8, "color": LIGHT.ink, "zorder": 5, "bbox": box}
    for note in panel.notes:
        spot.annotate(note.words, note.place, ha=note.align, **words)
    spot.set_xlabel(panel.across or ("x [m]" if panel.plane else ""))
    spot.set_ylabel(panel.up or ("y [m]" if panel.plane else ""))
    if panel.logarithmic:
        spot.set_yscale("log")
    if panel.logarithmic_across:
        spot.set_xscale("log")
    if panel.plane:
        low, high = panel.corners()
        margin = MARGIN * float((high - low).max())
        spot.set_xlim(low[0] - margin, high[0] + margin)
        spot.set_ylim(low[1] - margin, high[1] + margin)
        spot.set_aspect("equal")
        spot.locator_params(nbins=5)
