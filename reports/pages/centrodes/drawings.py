"""The four-bar's coupler with its centrodes drawn, and how fast the instant centre runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reference.chapter.centrodes import Centrodes
from reference.joints import Pin
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.rolling.curves import Array
from reports.charts.drawings import draw_ground, draw_pose
from reports.charts.theme import LIGHT, Theme, new_figure, settings, style_axes


def draw_centrodes(
    mechanism: Mechanism, poses: Array, curves: Centrodes, indices: Sequence[int], body: int, theme: Theme = LIGHT
) -> Figure:
    """A panel for each index into the samples (of poses (samples, bodies, 3) and of the curves, in one order)."""
    with settings():
        figure = new_figure(4.4, theme)
        for panel, index in zip(figure.subplots(1, len(indices), sharex=True, sharey=True), indices, strict=True):
            style_axes(panel, theme, grid=False)
            panel.set_axis_off()
            panel.set_aspect("equal")
            pose, centre = poses[index], curves.space[index]
            joints = mechanism.bodies[body].name
            for joint in mechanism.joints:
                # The lines of crank and rocker, produced to the centre.
                if isinstance(joint, Pin) and joint.first is None and joint.second != joints:
                    line = np.stack([np.asarray(joint.first_point), centre])
                    panel.plot(*line.T, color=theme.grid, linewidth=1.2, zorder=0)
            panel.plot(*curves.space.T, color=theme.first, linewidth=2, zorder=1)
            moved = rotated(np.asarray(pose[body, 2]), curves.body) + pose[body, :2]
            panel.plot(*moved.T, color=theme.second, linewidth=2, linestyle="--", zorder=2)
            draw_ground(panel, mechanism, theme)
            draw_pose(panel, mechanism, pose, color=theme.ink, linewidth=2, marker="o", markersize=4.5,
                      markerfacecolor=theme.paper, markeredgecolor=theme.ink, zorder=3)  # fmt: skip
            panel.plot(*centre, "o", color=theme.fourth, markersize=6, zorder=4)
            _letters(panel, mechanism, pose, theme)
        handles = [
            Line2D([], [], color=theme.first, linewidth=2, label="fixed centrode"),
            Line2D([], [], color=theme.second, linewidth=2, linestyle="--", label="moving centrode"),
            Line2D([], [], color=theme.fourth, marker="o", linestyle="none", label="instant centre"),
        ]
        for text in figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False).get_texts():
            text.set_color(theme.ink)
    return figure


def _letters(panel: Axes, mechanism: Mechanism, pose: Array, theme: Theme) -> None:
    """The pins' names: beyond the end of a bar on the ground, of the others away from the middle of all pins."""
    places, bars = {}, {}
    for joint in mechanism.joints:
        if isinstance(joint, Pin) and joint.second is not None:
            own = pose[mechanism.body_index(joint.second)]
            bars[joint], places[joint] = own[:2], rotated(own[2], np.asarray(joint.second_point)) + own[:2]
    middle = np.mean(list(places.values()), axis=0)
    for joint, place in places.items():
        away = place - (middle if joint.first is not None else bars[joint])
        away = away if np.any(away) else np.array([0.0, 1.0])
        panel.annotate(joint.name, place, xytext=tuple(11 * away / np.linalg.norm(away)), textcoords="offset points",
                       ha="center", va="center", color=theme.ink, zorder=5,
                       bbox={"facecolor": theme.paper, "edgecolor": "none", "pad": 0.0})  # fmt: skip


def draw_rate(curves: Centrodes, theme: Theme = LIGHT) -> Figure:
    """ds/dtheta from the way of the centre and from the curvatures, with their relative difference below."""
    total = 1 / (curves.space_curvature + curves.body_curvature)
    degrees = np.degrees(curves.theta)
    with settings():
        figure = new_figure(4.0, theme)
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
        above.plot(degrees, curves.rate, color=theme.first, linewidth=4, alpha=0.5, label="ds/dθ, way of the centre")
        above.plot(degrees, total, color=theme.ink, linewidth=1.2, label="1/($\\kappa_A+\\kappa_B$), both curvatures")
        below.semilogy(degrees, np.maximum(np.abs(total / curves.rate - 1), 1e-17), color=theme.ink, linewidth=1)
        for panel, up in ((above, "m/rad"), (below, "relative\ndifference")):
            style_axes(panel, theme)
            panel.set_ylabel(up)
        for text in above.legend(frameon=False).get_texts():
            text.set_color(theme.ink)
        below.set_xlabel("angle of the coupler [degrees]")
    return figure
