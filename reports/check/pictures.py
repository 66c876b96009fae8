"""Two pictures of a check: errors over time, and the mechanism at the moment when it is most wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from reports.check.judging import UNITS
from reports.check.picture_data import Lines, PictureData, Pose
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg

LEAST = 1e-16
BARS: dict[str, Any] = {"marker": "o", "solid_capstyle": "round"}


def pictures(shown: PictureData) -> dict[str, tuple[str, str]]:
    """By 'errors' and 'worst': what each shows, and the SVG."""
    named = {
        "errors": (f"Errors of {shown.label} over time, beside the judge's own error", _errors(shown)),
        "worst": (f"The mechanism at {shown.moment:.3g} s, where the error of {shown.label} is largest", _worst(shown)),
    }
    return {key: (title, svg(figure, title)) for key, (title, figure) in named.items()}


def _errors(shown: PictureData) -> Figure:
    theme, quantities = LIGHT, list(shown.own)
    with settings():
        figure = new_figure(5.4 if len(quantities) > 2 else 3.1, theme)
        panels = figure.subplots(-(-len(quantities) // 2), 2, squeeze=False).ravel()
        for panel in panels[len(quantities) :]:
            panel.set_axis_off()
        for panel, quantity in zip(panels, quantities, strict=False):
            style_axes(panel, theme)
            panel.set_yscale("log")
            lines = [(shown.t, shown.own, shown.label, theme.first, "-")]
            if shown.advised is not None:
                lines.append((shown.advised_t, shown.advised, "advised settings", theme.second, "--"))
            lines.append((shown.judge_t, shown.judge, "the judge's own error", theme.quiet, ":"))
            for t, errors, label, colour, dashes in lines:
                values = np.maximum(errors[quantity], LEAST)
                panel.plot(t[1:], values[1:], color=colour, linestyle=dashes, linewidth=1.5, label=label)
            if shown.horizon is not None:
                panel.axvline(shown.horizon, color=theme.third, linestyle="-.", label="errors grow exponentially")
            panel.set_title(f"{quantity} error, {UNITS[quantity]}", loc="left")
            panel.set_xlabel("time, s")
        handles, labels = panels[0].get_legend_handles_labels()
        legend = figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def _worst(shown: PictureData) -> Figure:
    theme = LIGHT
    with settings():
        figure = new_figure(4.2, theme, width=6.2)
        panel = figure.subplots()
        plane(panel, theme, shown.ground, "held to the ground")
        ideal(panel, theme, shown.ideal, "ideal joints")
        dashed: dict[str, Any] = {"color": theme.first, "linestyle": "--"}
        _draw(panel, shown.found.rails, linewidth=0.6, color=theme.first, alpha=0.5)
        _draw(panel, shown.found.links, linewidth=0.8, **dashed)
        _draw(panel, shown.found.bars, shown.label, linewidth=1.5, markersize=4, **dashed, **BARS)
        legend = figure.legend(loc="outside lower center", ncols=3, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def plane(panel: Any, theme: Theme, ground: Any, label: str | None = None) -> None:
    """An empty plane of motion, with the points that are held to the ground (points, 2) [m]."""
    style_axes(panel, theme)
    panel.set_aspect("equal", adjustable="datalim")
    panel.set_xlabel("x in the plane of motion, m")
    panel.set_ylabel("y, m")
    if len(ground):
        panel.plot(*np.array(ground).T, linestyle="none", marker="^", markersize=8, color=theme.quiet, label=label)


def ideal(panel: Any, theme: Theme, pose: Pose, label: str | None = None) -> None:
    """The pose of ideal joints: full lines."""
    _draw(panel, pose.rails, linewidth=0.6, color=theme.ink, alpha=0.5)
    _draw(panel, pose.links, linewidth=1.0, color=theme.ink)
    _draw(panel, pose.bars, label, color=theme.ink, linewidth=3.0, markersize=6, **BARS)


def _draw(panel: Any, lines: Lines, label: str | None = None, **look: Any) -> None:
    for index, line in enumerate(lines):
        panel.plot(*np.array(line).T, label=label if index == 0 else None, **look)
