"""The failure atlas: everything on it is read from the file that `crosscheck atlas` writes.

A map has a panel a method, regions by what became of the runs, and lines that explain where they end.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.atlas.columns import FILE, Line, read
from reports.pages.atlas.subjects import SUBJECTS, Subject
from reports.plots.looks import SHADE_NAMES, outcome_colour, shade
from reports.plots.theme import LIGHT, drawing, style_axes, svg
from reports.write.columns import told_variant
from reports.write.tables import markdown, number, step_words

FOLDER = Path(__file__).parents[2] / "results"
BOUNDS = (math.inf, 1e-2, 1e-4)  # rad: what a step may miss at most, at all values of a map
HALF = 0.5  # of the slowest mode: from here on, what sweeps leave grows from step to step
WIDE = 2.2  # decades
DASHES = {"fastest": (0, (5, 2)), "gives": (0, (1, 1.2)), "left": (0, (6, 2, 1, 2))}
ROLES = {"fastest": "second", "gives": "first", "left": "fourth"}


@cache
def lines(path: Path = FOLDER / FILE) -> tuple[Line, ...]:
    """What was kept of all maps."""
    return read(path)


def of(subject: Subject) -> list[Line]:
    """Methods in the order of the engines' registration, as far as they are registered, by the names of pages."""
    from engines.registry import VARIANTS, method_name

    order = {method_name(engine): place for place, engine in enumerate(VARIANTS)}
    own = [line for line in lines() if line.subject == subject.name]
    own.sort(key=lambda line: (order.get(line.method, len(order)), line.method, line.value))
    scene = subject.make(subject.values[1])
    told = {method_name(engine): told_variant(scene, engine) for engine in VARIANTS}
    return [replace(line, variant=told.get(line.method, line.variant)) for line in own]


def outcome_table(lines: Sequence[Line]) -> str:
    """A line a method: the share of cells with each outcome, and from where on all finished."""
    met = [outcome for outcome in Outcome if any(outcome in line.told for line in lines)]
    body = []
    for method in dict.fromkeys(line.method for line in lines):
        of_method = [line for line in lines if line.method == method]
        ends = [outcome for line in of_method for outcome in line.told]
        shares = [f"{100 * ends.count(outcome) / len(ends):.0f} %" for outcome in met]
        body.append([method, *shares, *(largest_step(of_method, bound) for bound in BOUNDS)])
    bounds = (f"all below {number(bound, 1)} rad" for bound in BOUNDS[1:])
    return markdown(["method", *map(str, met), "step at which all finish", *bounds], body)


def largest_step(own: Sequence[Line], bound: float) -> str:
    """The largest step from which on downwards every cell of a method finished with an angle error below `bound` [rad].

    At all values; '-' if there is none. A cell that was not run counts with the error of the next larger step's.
    """
    found = ""
    worst = [_carried(line) for line in own]
    for place, step in reversed(list(enumerate(own[0].steps))):
        if not all(
            line.told[place].comparable and errors[place] < bound for line, errors in zip(own, worst, strict=True)
        ):
            break
        found = step_words(step)
    return found or "-"


def _carried(line: Line) -> list[float]:
    """The error [rad] at each step; of cells that were not run that of the last one before which was, 0 before any."""
    found, last = [], 0.0
    for error in line.errors:
        last = last if math.isnan(error) else 10**error
        found.append(last)
    return found


def agreement(own: Sequence[Line]) -> tuple[int, int]:
    """(columns whose softness tells to within a factor of three from which step on a joint tears, columns that tear).

    Only columns in which the largest steps tear and smaller ones do not: else there is no border to compare.
    """
    near = count = 0
    for line in own:
        torn = [outcome in (Outcome.TORN, Outcome.DIVERGED, Outcome.RESET) for outcome in line.told]
        if not (torn[0] and not torn[-1]) or not (0 < line.gives < math.inf):
            continue
        last = max(place for place, one in enumerate(torn) if one)
        count += 1
        near += 1 / 3 <= line.steps[last] / line.gives <= 3
    return near, count


def context(material: Material) -> Mapping[str, Any]:
    """A dictionary a map that was run; nothing else on the page has numbers."""
    maps = []
    for subject, lines in ((subject, of(subject)) for subject in SUBJECTS):
        if lines:
            near, tearing = agreement(lines)
            counts = {
                "columns": len({line.value for line in lines}),
                "steps": len(lines[0].counts),
                "run": sum(line.run for line in lines),
                "points": sum(len(line.counts) for line in lines),
            }
            texts = {name: getattr(subject, name) for name in ("name", "title", "remark")}
            maps.append({**texts, **counts, "table": outcome_table(lines), "near": near, "tearing": tearing})
    missing = [subject.title for subject in SUBJECTS if not of(subject)]
    totals = {name: sum(each[name] for each in maps) for name in ("near", "tearing")}
    return {"subjects": maps, "missing": missing, **totals}


def figures(material: Material) -> Mapping[str, str]:
    """A picture a map that was run."""
    return {
        subject.name: svg(atlas_map(subject, lines), f"{subject.title}: step against {subject.parameter}")
        for subject in SUBJECTS
        if (lines := of(subject))
    }


def atlas_map(subject: Subject, lines: Sequence[Line]) -> Figure:
    """Step against the parameter, both logarithmic (whole numbers evenly), one panel a method."""
    methods = list(dict.fromkeys(line.method for line in lines))
    columns = min(2, len(methods)) or 1
    count = -(-len(methods) // columns) or 1
    drawn: set[str] = set()
    met: set[Outcome | str] = set()
    with drawing(2.9 * count + 1.1) as figure:
        axes = figure.subplots(count, columns, squeeze=False, sharex=True, sharey=True).ravel()
        for spare in axes[len(methods) :]:
            spare.set_visible(False)
        for index, (panel, method) in enumerate(zip(axes, methods, strict=False)):
            own = sorted((line for line in lines if line.method == method), key=lambda line: line.value)
            style_axes(panel, grid=False)
            panel.set_title(fill(method, 30), loc="left", fontweight="bold", color=LIGHT.ink)
            panel.set_yscale("log")
            if subject.whole:
                panel.xaxis.set_major_locator(MaxNLocator(integer=True))
            else:
                panel.set_xscale("log")
            # Of few decades, ticks between them too.
            decades = math.log10(own[0].steps[0] / own[0].steps[-1])
            panel.yaxis.set_major_locator(LogLocator(10, (1.0,) if decades > WIDE else (1.0, 2.0, 5.0)))
            panel.yaxis.set_major_formatter(FuncFormatter(lambda step, _: number(1e3 * step)))
            panel.yaxis.set_minor_formatter(NullFormatter())
            met |= _regions(panel, own, subject.whole)
            drawn |= _explained(panel, own, subject)
            panel.set_xlabel(subject.parameter if index + columns >= len(methods) else "")
            panel.set_ylabel("step [ms]" if index % columns == 0 else "")
        handles: list[Any] = []
        names = []
        for role in (role for role in SHADE_NAMES if role in met):
            handles.append(Rectangle((0, 0), 1, 1, facecolor=getattr(LIGHT, role), edgecolor=LIGHT.quiet))
            names.append(SHADE_NAMES[role])
        for outcome in (outcome for outcome in Outcome if outcome in met):
            face = Rectangle((0, 0), 1, 1, facecolor=outcome_colour(outcome, LIGHT), edgecolor=LIGHT.quiet)
            # A hatch apart from its ground: in one patch its colours would not follow the reader's scheme.
            hatch = Rectangle((0, 0), 1, 1, fill=False, edgecolor=LIGHT.quiet, hatch=outcome.hatch or None)
            handles.append((face, hatch))
            names.append(str(outcome))
        words = {
            "fastest": f"2 / frequency of {subject.fastest}",
            "gives": "from here on the method's own softness tears a joint",
            "left": "sweeps leave half of the slowest mode",
        }
        for name in (name for name in words if name in drawn):
            handles.append(Line2D([], [], color=getattr(LIGHT, ROLES[name]), linestyle=DASHES[name], linewidth=1.8))
            names.append(words[name])
        figure.legend(handles, names, loc="outside lower center", ncols=3)
    return figure


def edges(values: Sequence[float], whole: bool) -> np.ndarray:
    """The borders of cells whose middles are these increasing values, in their logarithm unless they are whole."""
    middles = np.asarray(values, dtype=float) if whole else np.log(values)
    if len(middles) == 1:
        return np.array([middles[0] - 0.5, middles[0] + 0.5]) if whole else np.exp([middles[0] - 0.5, middles[0] + 0.5])
    between = (middles[1:] + middles[:-1]) / 2
    borders = np.concatenate([[2 * middles[0] - between[0]], between, [2 * middles[-1] - between[-1]]])
    return borders if whole else np.exp(borders)


def ends(line: Line) -> list[Outcome | str]:
    """What became of each step: the shade of its error, or the outcome that is no answer."""
    return [
        shade(error) if outcome.comparable else outcome
        for outcome, error in zip(line.told, _carried(line), strict=True)
    ]


def _regions(panel: Axes, lines: Sequence[Line], whole: bool) -> set[Outcome | str]:
    """One shape an end: the cells of a column that follow one another are one rectangle of it."""
    across = edges([line.value for line in lines], whole)
    shapes: dict[Outcome | str, list[tuple[float, float, float, float]]] = {}
    for line, (left, right) in zip(lines, pairwise(across), strict=True):
        up, told = edges(line.steps[::-1], False), ends(line)[::-1]
        begin = 0
        for place in range(1, len(told) + 1):
            if place == len(told) or told[place] != told[begin]:
                shapes.setdefault(told[begin], []).append((left, right, up[begin], up[place]))
                begin = place
    for end, boxes in shapes.items():
        corners = [[(a, c), (b, c), (b, d), (a, d), (a, c)] for a, b, c, d in boxes]
        codes = [Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY] * len(boxes)
        path = Outline(np.array(corners).reshape(-1, 2), codes)
        face = outcome_colour(end, LIGHT) if isinstance(end, Outcome) else getattr(LIGHT, end)
        # The thin line of the same colour closes the seams between columns.
        panel.add_patch(PathPatch(path, facecolor=face, edgecolor=face, linewidth=0.4))
        if isinstance(end, Outcome) and end.hatch:
            panel.add_patch(PathPatch(path, facecolor="none", edgecolor=LIGHT.quiet, linewidth=0, hatch=end.hatch))
    panel.set_xlim(across[0], across[-1])
    upwards = edges(lines[0].steps[::-1], False)
    panel.set_ylim(upwards[0], upwards[-1])
    return set(shapes)


def _explained(panel: Axes, lines: Sequence[Line], subject: Subject) -> set[str]:
    """The lines that lie within the panel, over what is coloured."""
    values = np.array([line.value for line in lines])
    low, high = panel.get_ylim()
    drawn = set()

    def line(name: str, x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray) -> None:
        panel.plot(x, y, color=getattr(LIGHT, ROLES[name]), linestyle=DASHES[name], linewidth=1.8, clip_on=True)
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


PAGE = Page(
    name="atlas",
    title="Failure atlas",
    lesson="Where methods fail: step against the parameter that breaks a scene, and where borders could be expected.",
    context=context,
    figures=figures,
)
