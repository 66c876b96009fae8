"""Mechanisms drawn from their poses: a bar joins the joint points of a body, a small circle is a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.trajectory import body_points, ground_points
from reports.charts.theme import LIGHT, Theme, new_figure, settings, style_axes

Array = NDArray[np.float64]

# A method's pose is drawn over the truth only where a point of it is off by this part of the picture: a line's width.
VISIBLE = 5e-3


def draw_pose(panel: Axes, mechanism: Mechanism, pose: Array, **line: Any) -> None:
    """Bars of one pose; keyword arguments are those of a line."""
    for points in body_points(mechanism, pose).values():
        panel.plot(points[:, 0], points[:, 1], solid_capstyle="round", **line)


def draw_ground(panel: Axes, mechanism: Mechanism, theme: Theme) -> None:
    points = ground_points(mechanism)
    if len(points):
        panel.plot(points[:, 0], points[:, 1], linestyle="none", marker="^", markersize=7, color=theme.quiet, zorder=1)


def configurations(
    mechanism: Mechanism,
    truth: Array,
    titles: Sequence[str],
    others: Mapping[str, tuple[Array, str, Any]] | None = None,
    theme: Theme = LIGHT,
    columns: int = 3,
) -> Figure:
    """Small multiples of poses (pictures, bodies, 3) of the truth, with other methods' overlaid where the eye can tell.

    others: name -> (poses (pictures, bodies, 3), theme colour name, line style). A method that is nowhere visibly off
    is named in the legend as such, not drawn.
    """
    others = others or {}
    corners = np.concatenate(
        [points for pose in truth for points in body_points(mechanism, pose).values()] + [ground_points(mechanism)]
    )
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.08 * float((high - low).max())
    count = -(-len(truth) // columns)
    width = 9.2 / columns
    height = width * float((high - low + 2 * margin)[1] / (high - low + 2 * margin)[0])
    with settings():
        figure = new_figure(count * (height + 0.15) + 0.5, theme)
        panels = figure.subplots(count, columns, squeeze=False).ravel()
        for panel in panels:
            panel.set_axis_off()
        drawn: set[str] = set()
        for index, (panel, pose, title) in enumerate(zip(panels, truth, titles, strict=False)):
            style_axes(panel, theme, grid=False)
            panel.set_aspect("equal")
            panel.set_xlim(low[0] - margin, high[0] + margin)
            panel.set_ylim(low[1] - margin, high[1] + margin)
            panel.set_title(title, loc="left", fontsize=9, color=theme.ink)
            draw_ground(panel, mechanism, theme)
            draw_pose(
                panel,
                mechanism,
                pose,
                color=theme.ink,
                linewidth=2.2,
                marker="o",
                markersize=4.5,
                markerfacecolor=theme.paper,
                markeredgecolor=theme.ink,
                zorder=2,
            )
            for name, (poses, colour, dashes) in others.items():
                if visibly_off(mechanism, pose, poses[index], float((high - low).max())):
                    drawn.add(name)
                    draw_pose(
                        panel,
                        mechanism,
                        poses[index],
                        color=getattr(theme, colour),
                        linewidth=1.4,
                        linestyle=dashes,
                        zorder=3,
                    )
        handles = [Line2D([], [], color=theme.ink, linewidth=2.2, label="truth")]
        for name, (_, colour, dashes) in others.items():
            label = name if name in drawn else f"{name}: not visibly off"
            handles.append(Line2D([], [], color=getattr(theme, colour), linewidth=1.4, linestyle=dashes, label=label))
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def visibly_off(mechanism: Mechanism, truth: Array, pose: Array, size: float) -> bool:
    """Whether a joint point is off by more than VISIBLE of the picture's size [m]; never for a pose not finite."""
    if not np.isfinite(pose).all():
        return False
    first, second = body_points(mechanism, truth), body_points(mechanism, pose)
    worst = max((float(np.abs(first[name] - second[name]).max()) for name in first if len(first[name])), default=0.0)
    return worst > VISIBLE * size
