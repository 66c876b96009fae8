"""Cost of a step and error against the number of links, log-log, one series a method, each cost with its slope."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from reports.model.scaling_fit import Series, cost_exponent
from reports.plots.looks import look
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes

TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
FURTHER = ("X", "v")
CROWDED = 0.085  # of the panel's height: labels nearer than this are pushed apart


def scaling_chart(found: Sequence[Series], theme: Theme = LIGHT) -> Figure:
    """Two panels side by side: CPU time of a step [µs], and the largest angle error after the whole run [rad]."""
    variants: dict[str, list[str]] = {}
    for series in found:
        variants.setdefault(series.engine, []).append(series.variant)
    looks = {s.method: _look(s, variants, theme) for s in found}
    with settings():
        figure = new_figure(5.6, theme)
        cost, error = figure.subplots(1, 2, gridspec_kw={"width_ratios": [1.25, 1]})
        for panel, title, what in (
            (cost, "Cost of a step, with its slope at the large end", "CPU time of a step [µs]"),
            (error, "Error at a fixed step", "largest angle error [rad]"),
        ):
            panel.set_title(title, loc="left", fontweight="bold", color=theme.ink)
            panel.set_xscale("log")
            panel.set_yscale("log")
            style_axes(panel, theme)
            panel.set_xlabel("links")
            panel.set_ylabel(what)
        for series in found:
            _draw(cost, [(p.size, 1e6 * p.step) for p in series.points], looks[series.method])
            _draw(error, [(p.size, p.error) for p in series.points], looks[series.method])
        for panel in (cost, error):
            _ticks(panel)
        _slopes(cost, found, looks, theme)
        handles = [Line2D([], [], label=series.method, **looks[series.method]) for series in found]
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, handlelength=3.2)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def _look(series: Series, variants: Mapping[str, Sequence[str]], theme: Theme) -> dict[str, Any]:
    """As in all charts; a fourth and fifth method of an engine, whose half-filled marks are too alike, get others."""
    own = look(series.engine, series.variant, variants, theme)
    index = variants[series.engine].index(series.variant)
    return own | ({"marker": FURTHER[index - 3], "fillstyle": "full"} if index in (3, 4) else {})


def _draw(panel: Axes, points: Sequence[tuple[float, float]], how: dict[str, Any]) -> None:
    known = [(n, value) for n, value in points if math.isfinite(value) and value > 0]
    if known:
        panel.plot(*zip(*known, strict=True), zorder=3, **how)


def _ticks(panel: Axes) -> None:
    panel.xaxis.set_major_locator(LogLocator(base=10, subs=(1, 2, 5), numticks=30))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda n, _: f"{n:g}" if round(n) in TICKS else ""))
    panel.xaxis.set_minor_locator(NullLocator())
    panel.yaxis.set_major_locator(LogLocator(base=10, numticks=16))
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.minorticks_off()


def _slopes(panel: Axes, found: Sequence[Series], looks: dict[str, dict[str, Any]], theme: Theme) -> None:
    """The exponent of each series beside its last point; labels that would overlap are moved apart up and down."""
    labels = []
    for series in found:
        slope, _, _ = cost_exponent(series)
        known = [p for p in series.points if math.isfinite(p.step)]
        if math.isfinite(slope) and known:
            labels.append((known[-1].size, math.log10(1e6 * known[-1].step), f"{slope:.1f}", looks[series.method]))
    if not labels:
        return
    low, high = (math.log10(value) for value in panel.get_ylim())
    apart = CROWDED / 2 * (high - low)
    right = panel.get_xlim()[1]
    panel.set_xlim(right=right * 1.6)
    for size in {label[0] for label in labels}:
        column = sorted((label for label in labels if label[0] == size), key=lambda label: label[1])
        heights = _spread([label[1] for label in column], apart)
        for (_, _, text, how), height in zip(column, heights, strict=True):
            panel.annotate(
                text,
                (size, 10**height),
                xytext=(7, 0),
                textcoords="offset points",
                color=how["color"],
                va="center",
                fontsize=8,
                fontweight="bold",
            )


def _spread(heights: Sequence[float], apart: float) -> list[float]:
    """Rising heights moved so that neighbours are at least `apart`, each group about its own middle."""
    groups: list[list[float]] = []
    for height in heights:
        groups.append([height])
        while len(groups) > 1 and _low(groups[-1], apart) - _high(groups[-2], apart) < apart:
            last = groups.pop()
            groups[-1] += last
    return [_low(group, apart) + i * apart for group in groups for i in range(len(group))]


def _low(group: Sequence[float], apart: float) -> float:
    return sum(group) / len(group) - apart * (len(group) - 1) / 2


def _high(group: Sequence[float], apart: float) -> float:
    return sum(group) / len(group) + apart * (len(group) - 1) / 2
