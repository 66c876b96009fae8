"""Error against the share of a gap that a step closes: one line an engine, and where engines stand as shipped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes

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
        axes.legend(frameon=False, labelcolor=theme.ink, loc="lower left")
    return figure
