"""One map of the atlas: a panel a method, regions by what became of the runs, and lines that explain where they end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reports.model.outcomes import Outcome
from reports.pages.atlas.subjects import Subject
from reports.pages.atlas.table import Line
from reports.plots.stability import HATCHES, outcome_colour
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes
from reports.write.tables import number

HALF = 0.5  # of the slowest mode: from here on, what sweeps leave grows from step to step
WIDE = 2.2  # decades
DASHES = {"fastest": (0, (5, 2)), "gives": (0, (1, 1.2)), "left": (0, (6, 2, 1, 2))}
ROLES = {"fastest": "second", "gives": "first", "left": "fourth"}


def atlas_map(subject: Subject, lines: Sequence[Line], theme: Theme = LIGHT) -> Figure:
    """Step against the parameter, both logarithmic (whole numbers evenly), one panel a method."""
    methods = list(dict.fromkeys(line.method for line in lines))
    columns = min(2, len(methods)) or 1
    count = -(-len(methods) // columns) or 1
    drawn: set[str] = set()
    met: set[Outcome] = set()
    with settings():
        figure = new_figure(2.9 * count + 1.1, theme)
        axes = figure.subplots(count, columns, squeeze=False, sharex=True, sharey=True).ravel()
        for spare in axes[len(methods) :]:
            spare.set_visible(False)
        for index, (panel, method) in enumerate(zip(axes, methods, strict=False)):
            own = sorted((line for line in lines if line.method == method), key=lambda line: line.value)
            style_axes(panel, theme, grid=False)
            panel.set_title(fill(method, 30), loc="left", fontweight="bold", color=theme.ink)
            panel.set_yscale("log")
            if not subject.whole:
                panel.set_xscale("log")
            # Of few decades, ticks between them too.
            decades = math.log10(own[0].steps[0] / own[0].steps[-1])
            panel.yaxis.set_major_locator(LogLocator(10, (1.0,) if decades > WIDE else (1.0, 2.0, 5.0)))
            panel.yaxis.set_major_formatter(FuncFormatter(lambda step, _: number(step)))
            panel.yaxis.set_minor_formatter(NullFormatter())
            met |= _regions(panel, own, subject.whole, theme)
            drawn |= _explained(panel, own, subject, theme)
            panel.set_xlabel(subject.parameter if index + columns >= len(methods) else "")
            panel.set_ylabel("step [s]" if index % columns == 0 else "")
        # A hatch apart from its ground: in one patch its colours would not follow the reader's scheme.
        handles: list[Any] = [
            (
                Rectangle((0, 0), 1, 1, facecolor=outcome_colour(outcome, theme), edgecolor=theme.quiet),
                Rectangle((0, 0), 1, 1, fill=False, edgecolor=theme.quiet, hatch=HATCHES.get(outcome)),
            )
            for outcome in Outcome
            if outcome in met
        ]
        names = [str(outcome) for outcome in Outcome if outcome in met]
        words = {
            "fastest": f"2 / frequency of {subject.fastest}",
            "gives": "from here on the method's own softness tears a joint",
            "left": "sweeps leave half of the slowest mode",
        }
        for name, told in words.items():
            if name in drawn:
                handles.append(Line2D([], [], color=getattr(theme, ROLES[name]), linestyle=DASHES[name], linewidth=1.8))
                names.append(told)
        legend = figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def edges(values: Sequence[float], whole: bool) -> np.ndarray:
    """The borders of cells whose middles are these increasing values, in their logarithm unless they are whole."""
    middles = np.asarray(values, dtype=float) if whole else np.log(values)
    if len(middles) == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5]) if whole else np.exp([middles[0] - 0.5, middles[0] + 0.5])
    between = (middles[1:] + middles[:-1]) / 2
    borders = np.concatenate([[2 * middles[0] - between[0]], between, [2 * middles[-1] - between[-1]]])
    return borders if whole else np.exp(borders)


def _regions(panel: Axes, lines: Sequence[Line], whole: bool, theme: Theme) -> set[Outcome]:
    """One shape an outcome: the cells of a column that follow one another are one rectangle of it."""
    across = edges([line.value for line in lines], whole)
    shapes: dict[Outcome, list[tuple[float, float, float, float]]] = {}
    for line, (left, right) in zip(lines, pairwise(across), strict=True):
        up, told = edges(line.steps[::-1], False), line.told[::-1]
        begin = 0
        for place in range(1, len(told) + 1):
            if place == len(told) or told[place] != told[begin]:
                shapes.setdefault(told[begin], []).append((left, right, up[begin], up[place]))
                begin = place
    for outcome, boxes in shapes.items():
        corners = [[(a, c), (b, c), (b, d), (a, d), (a, c)] for a, b, c, d in boxes]
        codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * len(boxes)
        path = Path(np.array(corners).reshape(-1, 2), codes)
        face = outcome_colour(outcome, theme)
        # The thin line of the same colour closes the seams between columns.
        panel.add_patch(PathPatch(path, facecolor=face, edgecolor=face, linewidth=0.4))
        if hatch := HATCHES.get(outcome):
            panel.add_patch(PathPatch(path, facecolor="none", edgecolor=theme.quiet, linewidth=0, hatch=hatch))
    panel.set_xlim(across[0], across[-1])
    upwards = edges(lines[0].steps[::-1], False)
    panel.set_ylim(upwards[0], upwards[-1])
    return set(shapes)


def _explained(panel: Axes, lines: Sequence[Line], subject: Subject, theme: Theme) -> set[str]:
    """The lines that lie within the panel, over what is coloured."""
    values = np.array([line.value for line in lines])
    low, high = panel.get_ylim()
    drawn = set()

    def line(name: str, x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray) -> None:
        panel.plot(x, y, color=getattr(theme, ROLES[name]), linestyle=DASHES[name], linewidth=1.8, clip_on=True)
        drawn.add(name)

    fastest = np.array([2 / subject.frequency(value) for value in values])
    if np.any((fastest > low) & (fastest < high)):
        line("fastest", values, fastest)
    # Where all steps give it is at the bottom, where none does at the top: the curve leaves the panel there.
    gives = np.clip([math.inf if math.isnan(each.gives) else each.gives for each in lines], low / 2, high * 2)
    if np.any((gives > low) & (gives < high)) or (gives.min() < low and gives.max() > high):
        line("gives", values, gives)
    for first, second in pairwise(lines):
        if (first.left < HALF) != (second.left < HALF) and not math.isnan(first.left + second.left):
            middle = (first.value + second.value) / 2 if subject.whole else math.sqrt(first.value * second.value)
            line("left", [middle, middle], [low, high])
    return drawn
