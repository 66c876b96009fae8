"""A stability map: step against a parameter, each cell coloured, hatched and lettered by what became of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes
from reports.write.tables import number

HATCHES = {
    Outcome.UNRESOLVED: "oo",
    Outcome.SATURATED: "..",
    Outcome.BRANCH_FLIP: "\\\\\\",
    Outcome.TORN: "///",
    Outcome.DIVERGED: "xx",
    Outcome.RESET: "--",
    Outcome.ABORTED: "++",
    Outcome.TIMED_OUT: "||",
}


def outcome_colour(outcome: Outcome, theme: Theme) -> str:
    match outcome:
        case Outcome.FINISHED | Outcome.CONVERGED:
            return theme.good
        case Outcome.PLATEAU | Outcome.UNRESOLVED | Outcome.SATURATED | Outcome.BRANCH_FLIP:
            return theme.middling
        case Outcome.TORN | Outcome.DIVERGED | Outcome.RESET:
            return theme.bad
        case Outcome.UNSUPPORTED | Outcome.REFUSED:
            return theme.grid
        case _:
            return theme.worse


def stability_map(
    rows: Iterable[tuple[float, Measurement]], parameter: str, theme: Theme = LIGHT, columns: int | None = None
) -> Figure:
    """Step against a parameter, one panel a method, each cell coloured, hatched and lettered by its outcome.

    `rows` are (value of the parameter, measurement). A cell that finished shows the exponent of its angle error.
    Raises ValueError where two rows would stand in one place: only one of them could be seen.
    """
    rows = list(rows)
    for (method, value, step), count in Counter((row.method, value, row.step) for value, row in rows).items():
        if count > 1:
            raise ValueError(f"map: there are {count} rows of {method!r} at {value:g} and a step of {step:.3g} s")
    methods = list(dict.fromkeys(row.method for _, row in rows))
    values = sorted({value for value, _ in rows})
    steps = sorted({row.step for _, row in rows})
    columns = columns or (2 if len(methods) in (2, 4) else 3)
    count = -(-len(methods) // columns) or 1
    with settings():
        figure = new_figure(count * (0.34 * len(steps) + 1.0) + 0.9, theme)
        axes = figure.subplots(count, min(columns, len(methods)) or 1, squeeze=False, sharex=True, sharey=True).ravel()
        for spare in axes[len(methods) :]:
            spare.set_visible(False)
        for panel, method in zip(axes, methods, strict=False):
            style_axes(panel, theme, grid=False)
            panel.set_title(fill(method, 24), loc="left", fontweight="bold", color=theme.ink)
            for value, row in rows:
                if row.method == method:
                    _map_cell(panel, values.index(value), steps.index(row.step), row, theme)
            panel.set_xlim(0, len(values))
            panel.set_ylim(0, len(steps))
            panel.set_xticks(np.arange(len(values)) + 0.5, [f"{value:g}" for value in values])
            panel.set_yticks(np.arange(len(steps)) + 0.5, [number(step) for step in steps])
            panel.tick_params(length=0)
        for index, panel in enumerate(axes[: len(methods)]):
            lowest, leftmost = index + columns >= len(methods), index % columns == 0
            panel.tick_params(labelbottom=lowest, labelleft=leftmost)
            panel.set_xlabel(parameter if lowest else "")
            panel.set_ylabel("step [s]" if leftmost else "")
        met = sorted({Outcome(row.outcome) for _, row in rows}, key=list(Outcome).index)
        failed = [outcome for outcome in met if not outcome.comparable]
        patches, names = [_patch((0, 0), outcome, theme) for outcome in failed], [f"{o.letter}  {o}" for o in failed]
        if len(failed) < len(met):
            patches.insert(0, _patch((0, 0), Outcome.FINISHED, theme))
            names.insert(0, "finished: its angle error's power of ten")
        legend = figure.legend(patches, names, loc="outside lower center", ncols=4, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def _patch(corner: tuple[float, float], outcome: Outcome, theme: Theme) -> Rectangle:
    return Rectangle(
        corner,
        1,
        1,
        facecolor=outcome_colour(outcome, theme),
        edgecolor=theme.paper,
        linewidth=1.2,
        hatch=HATCHES.get(outcome),
    )


def _map_cell(panel: Axes, column: int, line: int, row: Measurement, theme: Theme) -> None:
    outcome = Outcome(row.outcome)
    panel.add_patch(_patch((column, line), outcome, theme))
    label = outcome.letter
    if outcome.comparable and math.isfinite(row.angle) and row.angle > 0:
        label = f"{math.floor(math.log10(row.angle))}"
    panel.text(column + 0.5, line + 0.5, label, ha="center", va="center", color=theme.ink, fontsize=8, in_layout=False)
