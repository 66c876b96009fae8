"""The page of stability maps, drawn from the file that `crosscheck atlas` writes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.atlas.maps import FILE, MAPS, StabilityMap, StoredColumn, read
from reports.plots.looks import SHADE_NAMES, outcome_colour, shade
from reports.plots.theme import LIGHT, drawing, label_decades, style_axes, svg
from reports.write.columns import displayed_variant
from reports.write.tables import DASH, markdown, number, step_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

RESULTS = Path(__file__).parents[2] / "results"
ERROR_BOUNDS = (math.inf, 1e-2, 1e-4)  # rad.
CRITICAL_RESIDUAL = 0.5  # See `residual_of_sweeps`.
MAX_DECADES_FOR_FINE_TICKS = 2.2
# Prediction of a border -> (label, role of the colour, dashes). "gives" and "left" are fields of `StoredColumn`.
PREDICTIONS: Mapping[str, tuple[str, str, Any]] = {
    "fastest": ("2 / frequency of {map.fastest}", "second", (0, (5, 2))),
    "gives": ("above this step the declared regularisation tears a joint", "first", (0, (1, 1.2))),
    "left": ("half of the slowest mode's error remains after a step's iterations", "fourth", (0, (6, 2, 1, 2))),
}


@cache
def stored_columns() -> tuple[StoredColumn, ...]:
    return read(RESULTS / FILE)


def columns_of(stability_map: StabilityMap) -> list[StoredColumn]:
    """The columns of a map with displayed names of variants. Columns of registered methods come first."""
    from engines.registry import VARIANTS, method_name

    order = {method_name(engine): index for index, engine in enumerate(VARIANTS)}
    columns = [column for column in stored_columns() if column.subject == stability_map.name]
    columns.sort(key=lambda column: (order.get(column.method, len(order)), column.method, column.value))
    scene = stability_map.make(stability_map.values[1])
    variants = {method_name(engine): displayed_variant(scene, engine) for engine in VARIANTS}
    return [replace(column, variant=variants.get(column.method, column.variant)) for column in columns]


def outcome_table(columns: Sequence[StoredColumn]) -> str:
    """A Markdown table with a line for each method: the shares of outcomes, and the largest steps for ERROR_BOUNDS."""
    present = [outcome for outcome in Outcome if any(outcome in column.outcome_of_steps for column in columns)]
    body = []
    for method in dict.fromkeys(column.method for column in columns):
        of_method = [column for column in columns if column.method == method]
        outcomes = [outcome for column in of_method for outcome in column.outcome_of_steps]
        shares = [f"{100 * outcomes.count(outcome) / len(outcomes):.0f} %" for outcome in present]
        body.append([method, *shares, *(largest_step(of_method, bound) for bound in ERROR_BOUNDS)])
    bounds = (f"all below {number(bound, 1)} rad" for bound in ERROR_BOUNDS[1:])
    return markdown(["method", *map(str, present), "step at which all finish", *bounds], body)


def largest_step(columns: Sequence[StoredColumn], bound: float) -> str:
    """The largest step such that all runs at this step and at smaller steps finish with errors below `bound` [rad]. The
    result is a dash if there is no such step. A cell that was not run has the error at the next larger step."""
    largest = DASH
    errors = [_errors_of_steps(column) for column in columns]
    for index, step in reversed(list(enumerate(columns[0].steps))):
        if not all(
            column.outcome_of_steps[index].comparable and of_column[index] < bound
            for column, of_column in zip(columns, errors, strict=True)
        ):
            break
        largest = step_words(step)
    return largest


def _errors_of_steps(column: StoredColumn) -> list[float]:
    """The error at each step [rad]; a cell that was not run has the error at the next larger step, or 0."""
    errors, last = [], 0.0
    for power in column.errors:
        last = last if math.isnan(power) else 10**power
        errors.append(last)
    return errors


def agreement(columns: Sequence[StoredColumn]) -> tuple[int, int]:
    """The number of columns whose tearing step is predicted within a factor of three, and the number of counted
    columns.

    A column counts if it has a prediction, a torn run at the largest step, and no torn run at the smallest step.
    """
    near = count = 0
    for column in columns:
        torn = [outcome in (Outcome.TORN, Outcome.DIVERGED, Outcome.RESET) for outcome in column.outcome_of_steps]
        if not (torn[0] and not torn[-1]) or not (0 < column.gives < math.inf):
            continue
        smallest_torn = max(index for index, is_torn in enumerate(torn) if is_torn)
        count += 1
        near += 1 / 3 <= column.steps[smallest_torn] / column.gives <= 3
    return near, count


def context(material: Material) -> Mapping[str, Any]:
    maps = []
    for stability_map, columns in ((each, columns_of(each)) for each in MAPS):
        if columns:
            near, tearing = agreement(columns)
            counts = {
                "columns": len({column.value for column in columns}),
                "steps": len(columns[0].counts),
                "run": sum(column.run_count for column in columns),
                "points": sum(len(column.counts) for column in columns),
            }
            texts = {name: getattr(stability_map, name) for name in ("name", "title", "remark")}
            maps.append({**texts, **counts, "table": outcome_table(columns), "near": near, "tearing": tearing})
    missing = [stability_map.title for stability_map in MAPS if not columns_of(stability_map)]
    totals = {name: sum(entry[name] for entry in maps) for name in ("near", "tearing")}
    return {"subjects": maps, "missing": missing, **totals}


def figures(material: Material) -> Mapping[str, str]:
    return {
        each.name: svg(atlas_map(each, columns), f"{each.title}: step against {each.parameter}")
        for each in MAPS
        if (columns := columns_of(each))
    }


def atlas_map(stability_map: StabilityMap, columns: Sequence[StoredColumn]) -> Figure:
    """A panel for each method, with regions of equal outcome over parameter and step. The axis of an integer parameter
    is linear; other axes are logarithmic.
    """
    methods = list(dict.fromkeys(column.method for column in columns))
    across = min(2, len(methods)) or 1
    count = -(-len(methods) // across) or 1
    predictions: set[str] = set()
    regions: set[Outcome | str] = set()
    with drawing(2.9 * count + 1.1) as figure:
        axes = figure.subplots(count, across, squeeze=False, sharex=True, sharey=True).ravel()
        for spare in axes[len(methods) :]:
            spare.set_visible(False)
        for index, (panel, method) in enumerate(zip(axes, methods, strict=False)):
            of_method = sorted((column for column in columns if column.method == method), key=lambda c: c.value)
            _prepare(panel, method, of_method, stability_map.whole)
            regions |= _draw_regions(panel, of_method, stability_map.whole)
            predictions |= _draw_predictions(panel, of_method, stability_map)
            panel.set_xlabel(stability_map.parameter if index + across >= len(methods) else "")
            panel.set_ylabel("step [ms]" if index % across == 0 else "")
        figure.legend(*_legend_entries(stability_map, regions, predictions), loc="outside lower center", ncols=3)
    return figure


def _prepare(panel: Axes, method: str, columns: Sequence[StoredColumn], whole: bool) -> None:
    from matplotlib.ticker import MaxNLocator

    style_axes(panel, grid=False)
    panel.set_title(fill(method, 30), loc="left", fontweight="bold", color=LIGHT.ink)
    panel.set_yscale("log")
    if whole:
        panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        panel.set_xscale("log")
    decades = math.log10(columns[0].steps[0] / columns[0].steps[-1])
    ticks = (1.0,) if decades > MAX_DECADES_FOR_FINE_TICKS else (1.0, 2.0, 5.0)
    label_decades(panel.yaxis, None, ticks, lambda step: number(1e3 * step))


def _legend_entries(
    stability_map: StabilityMap, regions: set[Outcome | str], predictions: set[str]
) -> tuple[list[Any], list[str]]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

    handles: list[Any] = []
    labels = []
    for role in (role for role in SHADE_NAMES if role in regions):
        handles.append(Rectangle((0, 0), 1, 1, facecolor=getattr(LIGHT, role), edgecolor=LIGHT.quiet))
        labels.append(SHADE_NAMES[role])
    for outcome in (outcome for outcome in Outcome if outcome in regions):
        face = Rectangle((0, 0), 1, 1, facecolor=outcome_colour(outcome), edgecolor=LIGHT.quiet)
        # The hatch is a separate patch, because otherwise its colour would not follow the reader's colour scheme.
        hatch = Rectangle((0, 0), 1, 1, fill=False, edgecolor=LIGHT.quiet, hatch=outcome.hatch or None)
        handles.append((face, hatch))
        labels.append(str(outcome))
    for name, (label, role, dashes) in PREDICTIONS.items():
        if name in predictions:
            handles.append(Line2D([], [], color=getattr(LIGHT, role), linestyle=dashes, linewidth=1.8))
            labels.append(label.format(map=stability_map))
    return handles, labels


def edges(values: Sequence[float], whole: bool) -> np.ndarray:
    """The edges of cells with the increasing centres `values`. An edge is the arithmetic mean of two centres for
    integers (`whole`), otherwise their geometric mean.
    """
    middles = np.asarray(values, dtype=float) if whole else np.log(values)
    if len(middles) == 1:
        borders = np.array([middles[0] - 0.5, middles[0] + 0.5])
    else:
        between = (middles[1:] + middles[:-1]) / 2
        borders = np.concatenate([[2 * middles[0] - between[0]], between, [2 * middles[-1] - between[-1]]])
    return borders if whole else np.exp(borders)


def regions_of_steps(column: StoredColumn) -> list[Outcome | str]:
    """The shade of the error at each step, or the outcome of a run that can't be compared."""
    return [
        shade(error) if outcome.comparable else outcome
        for outcome, error in zip(column.outcome_of_steps, _errors_of_steps(column), strict=True)
    ]


def _draw_regions(panel: Axes, columns: Sequence[StoredColumn], whole: bool) -> set[Outcome | str]:
    """Draw each region as one path, and return the regions. Successive cells of a column form one rectangle."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    across = edges([column.value for column in columns], whole)
    shapes: dict[Outcome | str, list[tuple[float, float, float, float]]] = {}
    for column, (left, right) in zip(columns, pairwise(across), strict=True):
        up, regions = edges(column.steps[::-1], False), regions_of_steps(column)[::-1]
        begin = 0
        for index in range(1, len(regions) + 1):
            if index == len(regions) or regions[index] != regions[begin]:
                shapes.setdefault(regions[begin], []).append((left, right, up[begin], up[index]))
                begin = index
    for region, boxes in shapes.items():
        corners = [[(a, c), (b, c), (b, d), (a, d), (a, c)] for a, b, c, d in boxes]
        codes = [Outline.MOVETO, Outline.LINETO, Outline.LINETO, Outline.LINETO, Outline.CLOSEPOLY] * len(boxes)
        path = Outline(np.array(corners).reshape(-1, 2), codes)
        face = outcome_colour(region) if isinstance(region, Outcome) else getattr(LIGHT, region)
        # A thin line of the same colour covers the gaps between columns.
        panel.add_patch(PathPatch(path, facecolor=face, edgecolor=face, linewidth=0.4))
        if isinstance(region, Outcome) and region.hatch:
            panel.add_patch(PathPatch(path, facecolor="none", edgecolor=LIGHT.quiet, linewidth=0, hatch=region.hatch))
    panel.set_xlim(across[0], across[-1])
    upwards = edges(columns[0].steps[::-1], False)
    panel.set_ylim(upwards[0], upwards[-1])
    return set(shapes)


def _draw_predictions(panel: Axes, columns: Sequence[StoredColumn], stability_map: StabilityMap) -> set[str]:
    values = np.array([column.value for column in columns])
    low, high = panel.get_ylim()
    names = set()

    def line(name: str, x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray) -> None:
        _, role, dashes = PREDICTIONS[name]
        panel.plot(x, y, color=getattr(LIGHT, role), linestyle=dashes, linewidth=1.8, clip_on=True)
        names.add(name)

    fastest = np.array([2 / stability_map.frequency(stability_map.make(value)) for value in values])
    if np.any((fastest > low) & (fastest < high)):
        line("fastest", values, fastest)
    # The curve leaves the panel at the bottom if every step tears a joint, and at the top if no step does.
    tearing = [math.inf if math.isnan(column.gives) else column.gives for column in columns]
    tearing = np.clip(tearing, low / 2, high * 2)
    if np.any((tearing > low) & (tearing < high)) or (tearing.min() < low and tearing.max() > high):
        line("gives", values, tearing)
    for first, second in pairwise(columns):
        residuals = (first.left, second.left)
        if (min(residuals) < CRITICAL_RESIDUAL <= max(residuals)) and not math.isnan(sum(residuals)):
            between = (first.value + second.value) / 2 if stability_map.whole else math.sqrt(first.value * second.value)
            line("left", [between, between], [low, high])
    return names


PAGE = Page(
    name="atlas",
    title="Failure atlas",
    lesson="Where methods fail: step against the parameter that breaks a scene, with predictions of the borders.",
    context=context,
    figures=figures,
)
