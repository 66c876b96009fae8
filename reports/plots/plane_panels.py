"""Panels with paths, blades and notes in the plane, and panels with other curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reports.plots.theme import FIGURE_WIDTH, LIGHT, add_legend, drawing, style_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Array = NDArray[np.float64]

PANEL_MARGIN = 0.07
MIN_HEIGHT, MAX_HEIGHT = 1.4, 5.0  # inches.
MIN_ASPECT = 0.7  # Smallest ratio of width to height; in a narrower panel the labels of ticks overlap.


@dataclass(frozen=True)
class Path:
    """A line through points (points, 2). Paths with the same label share an entry of the legend. colour: a role of the
    theme. framed: whether the limits of the axes include the path. dot: whether the end of the path has a dot."""

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
    """Skates or bars, drawn as lines of `length` [m] with their centres at poses (n, 3)."""

    poses: ArrayLike
    length: float
    colour: str = "ink"
    width: float = 3.0
    label: str = ""

    def strokes(self) -> list[Array]:
        poses = np.asarray(self.poses, dtype=float)
        half = 0.5 * self.length * np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=-1)
        return [np.stack([centre - arm, centre + arm]) for centre, arm in zip(poses[:, :2], half, strict=True)]


@dataclass(frozen=True)
class PanelNote:
    """A text at a point. `align` is matplotlib's horizontal alignment."""

    point: tuple[float, float]
    text: str
    align: str = "left"


@dataclass(frozen=True)
class Panel:
    """One panel. With `plane`, both axes are lengths and have the same scale."""

    title: str
    paths: Sequence[Path] = ()
    blades: Sequence[Blades] = ()
    notes: Sequence[PanelNote] = ()
    plane: bool = True
    x_label: str = ""
    y_label: str = ""
    logarithmic: bool = False
    logarithmic_across: bool = False

    def corners(self) -> tuple[Array, Array]:
        """The lowest and highest coordinates of framed paths, blades and notes. The width is at least MIN_ASPECT times
        the height."""
        points = [path.finite() for path in self.paths if path.framed]
        points += [stroke for blades in self.blades for stroke in blades.strokes()]
        points += [np.array([note.point]) for note in self.notes]
        everything = np.concatenate(points)
        low, high = everything.min(axis=0), everything.max(axis=0)
        missing_width = max(0.0, MIN_ASPECT * float(high[1] - low[1]) - float(high[0] - low[0]))
        spread = np.array([0.5 * missing_width, 0.0])
        return low - spread, high + spread


def paths(panels: Sequence[Panel], columns: int = 3, height: float | None = None) -> Figure:
    """The panels in rows with one legend. The default `height` of a row [inches] follows from its panels."""
    columns = min(columns, len(panels))
    rows = [panels[i : i + columns] for i in range(0, len(panels), columns)]
    heights = [height or max(_height(panel, FIGURE_WIDTH / columns) for panel in row) for row in rows]
    with drawing(sum(heights) + 0.35 * len(rows) + 0.5) as figure:
        axes = figure.subplots(len(rows), columns, squeeze=False, gridspec_kw={"height_ratios": heights})
        handles: dict[str, Line2D] = {}
        for spot, panel in zip(axes.ravel(), panels, strict=False):
            _draw(spot, panel, handles)
        for spare in axes.ravel()[len(panels) :]:
            spare.set_visible(False)
        if handles:
            add_legend(figure, list(handles.values()), 3, handlelength=3.2)
    return figure


def _height(panel: Panel, width: float) -> float:
    if not panel.plane:
        return 2.6
    low, high = panel.corners()
    size = (high - low) + 2 * PANEL_MARGIN * float((high - low).max())
    return float(np.clip(width * size[1] / size[0], MIN_HEIGHT, MAX_HEIGHT))


def _draw(spot: Axes, panel: Panel, handles: dict[str, Line2D]) -> None:
    from matplotlib.lines import Line2D

    style_axes(spot)
    spot.set_title(panel.title, loc="left", fontsize=9, color=LIGHT.ink)
    for index, path in enumerate(panel.paths):
        look = {"color": getattr(LIGHT, path.colour), "linestyle": path.dashes, "linewidth": path.width}
        points = path.finite()
        spot.plot(points[:, 0], points[:, 1], zorder=3 + 0.01 * index, **look)
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
    text_style: dict[str, Any] = {"va": "center", "fontsize": 8, "color": LIGHT.ink, "zorder": 5, "bbox": box}
    for note in panel.notes:
        spot.annotate(note.text, note.point, ha=note.align, **text_style)
    spot.set_xlabel(panel.x_label or ("x [m]" if panel.plane else ""))
    spot.set_ylabel(panel.y_label or ("y [m]" if panel.plane else ""))
    if panel.logarithmic:
        spot.set_yscale("log")
    if panel.logarithmic_across:
        spot.set_xscale("log")
    if panel.plane:
        low, high = panel.corners()
        margin = PANEL_MARGIN * float((high - low).max())
        spot.set_xlim(low[0] - margin, high[0] + margin)
        spot.set_ylim(low[1] - margin, high[1] + margin)
        spot.set_aspect("equal")
        spot.locator_params(nbins=5)
