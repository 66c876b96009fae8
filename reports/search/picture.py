"""The errors of the law of one instant as a picture: a panel for each subject, a line for each kind of link."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes
from reports.search.chunk import Asked

LAWS = ("acceleration", "velocity")
LEAST, MOST = 1e-17, 1e2  # what an error of exactly zero, and one without a number, is drawn at
ACROSS = 3  # panels side by side
LINE, BETWEEN = 0.19, 0.55  # inches: a line, and what a row of panels takes besides

Errors = Mapping[str, Mapping[str, Sequence[float]]]  # by subject, by kind


def distribution(told: Iterable[Asked], theme: Theme = LIGHT) -> Figure | None:
    """Median to worst error; None where no law of an instant was asked."""
    found, vocabulary = _errors(told)
    if not found:
        return None
    rows: list[tuple[list[str], list[str]]] = []  # (subjects, kinds) of a row of panels: those of one vocabulary
    for kinds in dict.fromkeys(vocabulary.values()):
        own = [name for name in found if vocabulary[name] == kinds]
        shown = [kind for kind in kinds if any(kind in found[name] for name in own)]
        rows += [(own[first : first + ACROSS], shown) for first in range(0, len(own), ACROSS)]
    heights = [BETWEEN + LINE * len(kinds) for _, kinds in rows]
    with settings():
        figure = new_figure(0.5 + sum(heights), theme)
        grid = figure.add_gridspec(len(rows), ACROSS, height_ratios=heights)
        for row, (names, kinds) in enumerate(rows):
            for column, name in enumerate(names):
                axes = figure.add_subplot(grid[row, column])
                _panel(axes, name, found[name], kinds, theme)
                axes.tick_params(labelleft=column == 0)
        figure.supxlabel(
            "relative error; mark: median, bar: 99 %, dot: worst; dashed: $10^{-9}$; right: cases", size=8.5
        )
    return figure


def _errors(told: Iterable[Asked]) -> tuple[dict[str, dict[str, list[float]]], dict[str, tuple[str, ...]]]:
    """Errors by subject and kind, and the kinds that each subject knows."""
    found: dict[str, dict[str, list[float]]] = {}
    vocabulary: dict[str, tuple[str, ...]] = {}
    for one in told:
        subject = one.chunk.subject
        for check in LAWS:
            if check in one.told.errors:
                vocabulary[subject.name] = subject.kinds
                for kind in one.kinds:
                    found.setdefault(subject.name, {}).setdefault(kind, []).append(one.told.errors[check][0])
    return found, vocabulary


def _panel(axes: Axes, name: str, found: Mapping[str, Sequence[float]], kinds: Sequence[str], theme: Theme) -> None:
    style_axes(axes, theme)
    axes.grid(False, axis="y")
    for place, kind in enumerate(kinds):
        if kind not in found:
            continue
        errors = np.sort(np.clip(np.nan_to_num(found[kind], posinf=MOST), LEAST, MOST))
        median, most = errors[len(errors) // 2], errors[math.ceil(0.99 * (len(errors) - 1))]
        axes.plot([median, errors[-1]], [place, place], color=theme.first, linewidth=1.2)
        axes.plot([median], [place], "o", color=theme.first, markersize=4)
        axes.plot([most], [place], "|", color=theme.first, markersize=7)
        axes.plot([errors[-1]], [place], ".", color=theme.first, markersize=4)
        axes.text(
            1.0, place, str(len(errors)), transform=axes.get_yaxis_transform(), ha="right", va="center",
            size=6.5, color=theme.quiet,
        )  # fmt: skip
    axes.axvline(1e-9, color=theme.quiet, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set_title(name, color=theme.ink)
    axes.set_yticks(range(len(kinds)), kinds)
    axes.set_ylim(len(kinds) - 0.4, -0.6)
    axes.set_xscale("log")
    axes.set_xlim(LEAST / 3, MOST * 3e3)  # room for the number of cases
    axes.set_xticks([1e-16, 1e-12, 1e-8, 1e-4, 1.0])
    axes.minorticks_off()
