"""The page on the cost of a step and the error of pendulums with 1 to 1000 links."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, log, pi, sqrt
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from engines import Engine, method_name, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.pymunk.convergence import RESIDUAL
from engines.pymunk.iterations import ITERATION_LIMIT
from reference.scenes.pendulum.scenes import LongPendulum
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.tasks import Task, Values
from reports.pages.pendulum import page as pendulum
from reports.plots.looks import look
from reports.plots.theme import LIGHT, add_legend, drawing, label_decades, style_axes, svg
from reports.write.tables import DASH, markdown, number
from reports.write.unmeasured import UNMEASURED

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class TruthError(Task):
    """A task with the error of a long chain's reference motion at the end of the motion."""

    scene: LongPendulum

    seconds: ClassVar[float] = 0.5  # measured, with 200 links
    words: ClassVar[str] = "error of the reference motion of {0.scene.links} links"

    def run(self) -> Values:
        """`error`: the largest angle error [rad]."""
        return {"error": self.scene.truth_error([self.scene.duration])[0]}


FIT_POINTS = 3  # the fit uses the largest sizes, at which constant costs are small


@dataclass(frozen=True)
class SizePoint:
    """The result of a method for a chain of `size` links. step: CPU time of a step [s]. error: the largest angle error
    [rad], or NaN if the run was made for its CPU time only."""

    size: int
    step: float
    error: float
    outcome: str


@dataclass(frozen=True)
class MethodSeries:
    """The results of a method; the smallest chain is first."""

    engine: str
    variant: str
    points: tuple[SizePoint, ...]

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    def at(self, size: int) -> Any:
        return next((point for point in self.points if point.size == size), UNMEASURED)


def series_of(rows: Mapping[Cell, Measurement], timed: float) -> tuple[MethodSeries, ...]:
    """The results by method. Cells that last less than `timed` [s] have a cost but no error."""
    points_by_method: dict[tuple[str, str], list[SizePoint]] = {}
    for cell, row in rows.items():
        comparable, is_full = Outcome(row.outcome).comparable, cell.scene.duration >= timed * (1 - 1e-9)
        cost = row.cpu * cell.step if comparable or not is_full else math.nan
        error = row.angle if is_full and comparable else math.nan
        point = SizePoint(int(getattr(cell.scene, "links", 0)), cost, error, str(row.outcome))
        points_by_method.setdefault((row.engine, row.variant), []).append(point)
    return tuple(
        MethodSeries(*method, tuple(sorted(points, key=lambda p: p.size)))
        for method, points in points_by_method.items()
    )


def exponent(sizes: Iterable[float], values: Iterable[float]) -> tuple[float, int, int]:
    """The slope of log value over log size for the last FIT_POINTS finite points, and the fit's smallest and largest
    size. With fewer than two points the result is (NaN, 0, 0)."""
    pairs = [(n, v) for n, v in zip(sizes, values, strict=True) if math.isfinite(v) and v > 0][-FIT_POINTS:]
    if len(pairs) < 2:
        return math.nan, 0, 0
    n, v = np.log(np.array(pairs, dtype=float)).T
    return float(np.polyfit(n, v, 1)[0]), int(pairs[0][0]), int(pairs[-1][0])


TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
FURTHER_MARKS = ("X", "v")


def scaling_chart(all_series: Sequence[MethodSeries]) -> Figure:
    """A panel with the CPU time of a step [µs], and a panel with the largest angle error [rad] of full runs."""
    from matplotlib.lines import Line2D

    variants: dict[str, list[str]] = {}
    for series in all_series:
        variants.setdefault(series.engine, []).append(series.variant)
    looks = {s.method: _look(s, variants) for s in all_series}
    with drawing(5.6) as figure:
        cost, error = figure.subplots(1, 2, gridspec_kw={"width_ratios": [1.25, 1]})
        for panel, title, label in (
            (cost, "Cost of a step", "CPU time of a step [µs]"),
            (error, "Error at a fixed step", "largest angle error [rad]"),
        ):
            panel.set_title(title, loc="left", fontweight="bold", color=LIGHT.ink)
            panel.set_xscale("log")
            panel.set_yscale("log")
            style_axes(panel)
            panel.set_xlabel("links")
            panel.set_ylabel(label)
        for series in all_series:
            for panel, points in (
                (cost, [(p.size, 1e6 * p.step) for p in series.points]),
                (error, [(p.size, p.error) for p in series.points]),
            ):
                if pairs := [(n, value) for n, value in points if math.isfinite(value) and value > 0]:
                    panel.plot(*zip(*pairs, strict=True), zorder=3, **looks[series.method])
        for panel in (cost, error):
            label_decades(panel.xaxis, 30, (1, 2, 5), lambda n: f"{n:g}" if round(n) in TICKS else "")
            label_decades(panel.yaxis, 16)
            panel.minorticks_off()
        handles = [Line2D([], [], label=series.method, **looks[series.method]) for series in all_series]
        add_legend(figure, handles, 3, handlelength=3.2)
    return figure


def _look(series: MethodSeries, variants: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """The usual `look`; the fourth and the fifth method of an engine have other marks."""
    index = variants[series.engine].index(series.variant)
    other_mark = {"marker": FURTHER_MARKS[index - 3], "fillstyle": "full"} if index in (3, 4) else {}
    return look(series.engine, series.variant, variants) | other_mark


def fitted(series: MethodSeries) -> str:
    """The exponent of the cost with the fitted range of sizes, such as '1.0 (50 to 1000)'."""
    least, most = SIZES_OF_FIT.get(series.method, (0, math.inf))
    points = [point for point in series.points if least <= point.size <= most]
    slope, first, last = exponent([p.size for p in points], [p.step for p in points])
    return f"{slope:.1f} ({first} to {last})" if last else DASH


FIXED_STEP = 5e-3  # s; at much larger steps, Euler steps in reduced coordinates fail with 200 links
SMALL_SIZES = (1, 3, 10, 20)
LARGE_SIZES = (50, 100)
COSTLY_SIZES = (300, 1000)  # chains of these sizes are run for a few steps only, to measure the CPU time
PENDULUM_SAMPLES = 5
FEW_STEPS = 4
MORE_STEPS = 40  # for cheap methods at COSTLY_SIZES, since their first step is slower than later steps

FREE_DEFAULT = replace(mujoco.DEFAULT, variant="default, free coordinates", coordinates="free")
# Error estimates are switched off, because their runs would increase the CPU time of a step.
PLAIN = replace(mujoco.EXTENDED, coordinates="free", estimates=False)
SCALING_SPARSE_NEWTON = replace(
    pendulum.PENDULUM_SPARSE_NEWTON, variant="extended, free, sparse Newton, no estimate", estimates=False
)
PGS = replace(PLAIN, variant="extended, free, PGS sweeps, no estimate", solvers=("PGS",))
EULER, RUNGE_KUTTA = Lagrange("euler", "projection"), Lagrange("rk4", "projection")

SCALING_METHODS: tuple[Engine, ...] = (
    *(pymunk.DEFAULT, pymunk.TUNED, pymunk.EXTENDED, mujoco.DEFAULT, mujoco.TUNED),
    *(FREE_DEFAULT, SCALING_SPARSE_NEWTON, PGS, EULER, RUNGE_KUTTA),
)
# Methods that take seconds for a step of a chain with more than 300 links.
AT_MOST_300 = (pymunk.EXTENDED, PGS, EULER, RUNGE_KUTTA)
CHEAP: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, FREE_DEFAULT, SCALING_SPARSE_NEWTON)

# In a chain of N equal links, an iteration multiplies the slowest mode by 1 - pi^2/(4 N^2). A step needs
# SWEEPS_OVER_SQUARE N^2 iterations to reduce this mode by the factor RESIDUAL. From CAPPED links on, a step has
# ITERATION_LIMIT iterations.
SWEEPS_OVER_SQUARE = -4 * log(RESIDUAL) / pi**2
CAPPED = ceil(sqrt(ITERATION_LIMIT / SWEEPS_OVER_SQUARE))

# Method -> smallest and largest size of a fit. Below CAPPED links, "pymunk tuned" has a number of iterations that grows
# with the size.
# At COSTLY_SIZES these methods make few steps, and early steps have more iterations.
SIZES_OF_FIT: Mapping[str, tuple[float, float]] = {
    "pymunk tuned": (CAPPED, max(LARGE_SIZES)),
    "pymunk extended": (0, max(LARGE_SIZES)),
}


def cells() -> tuple[Cell, ...]:
    """The cells of each method at each size. A quick run has only the cells with the purpose "growth"."""
    chosen = []
    for engine in SCALING_METHODS:
        for links in (*SMALL_SIZES, *LARGE_SIZES, *COSTLY_SIZES):
            if links > 300 and engine in AT_MOST_300:
                continue
            if links in COSTLY_SIZES:
                steps = MORE_STEPS if engine in CHEAP else FEW_STEPS
                scene = LongPendulum(links, duration=steps * FIXED_STEP, horizon=steps * FIXED_STEP)
                chosen.append(Cell(scene, engine, steps, "large", 1))
            else:
                scene = LongPendulum(links)
                every = round(scene.duration / FIXED_STEP) // PENDULUM_SAMPLES
                chosen.append(
                    Cell(scene, engine, every, "growth" if links in SMALL_SIZES else "large", PENDULUM_SAMPLES)
                )
    return tuple(chosen)


SCALING_CELLS = cells()
FULL_DURATION = LongPendulum().duration
REFERENCE_ERROR = TruthError(LongPendulum(max(LARGE_SIZES)))


def found_series(material: Material) -> tuple[MethodSeries, ...]:
    return series_of({cell: material.rows[cell] for cell in SCALING_CELLS if cell in material.rows}, FULL_DURATION)


def figures(material: Material) -> dict[str, str]:
    all_series = found_series(material)
    title = "Cost of a step and error against the number of links"
    return {"cost": svg(scaling_chart(all_series), title)} if all_series else {}


def cost_table(all_series: tuple[MethodSeries, ...]) -> str:
    sizes = sorted({point.size for series in all_series for point in series.points})
    return _table(all_series, sizes, lambda point: 1e6 * point.step)


def error_table(all_series: tuple[MethodSeries, ...]) -> str:
    run = {
        (method_name(c.engine), getattr(c.scene, "links", 0))
        for c in SCALING_CELLS
        if c.scene.duration == FULL_DURATION
    }
    compared = [
        replace(series, points=tuple(point for point in series.points if (series.method, point.size) in run))
        for series in all_series
    ]
    return _table(compared, sorted({size for _, size in run}), lambda point: point.error)


def _table(all_series: Iterable[MethodSeries], sizes: Sequence[int], value: Callable[[SizePoint], float]) -> str:
    def cell_text(point: Any) -> str:
        return "" if not point else f"**{point.outcome}**" if math.isnan(value(point)) else number(value(point))

    body = [[series.method, *(cell_text(series.at(size)) for size in sizes)] for series in all_series]
    return markdown(["method", *map(str, sizes)], body)


def context(material: Material) -> Mapping[str, Any]:
    all_series = found_series(material)
    by_method = {series.method: series for series in all_series}

    def at(engine: Engine, links: int) -> Any:
        return by_method[name].at(links) if (name := method_name(engine)) in by_method else UNMEASURED

    return {
        "missing": not all_series,
        "costs": cost_table(all_series),
        "errors": error_table(all_series),
        "laws": {series.method: fitted(series) for series in all_series},
        "sweeps": {"over_square": SWEEPS_OVER_SQUARE, "capped": CAPPED, "most": ITERATION_LIMIT},
        "crossing": crossing(by_method.get("mujoco tuned"), by_method.get(f"mujoco {SCALING_SPARSE_NEWTON.variant}"))
        or UNMEASURED,
        "tree": {n: at(mujoco.TUNED, n) for n in (100, 1000)},
        "sparse": {n: at(SCALING_SPARSE_NEWTON, n) for n in (100, 1000)},
        "swept": at(PGS, 100),
        "impulses": {n: at(pymunk.DEFAULT, n) for n in (100, 1000)},
        "own": answer.number("error") if (answer := material.finished(REFERENCE_ERROR)) else UNMEASURED,
        "step": FIXED_STEP,
        "duration": FULL_DURATION,
    }


def crossing(one: MethodSeries | None, other: MethodSeries | None) -> tuple[int, int] | None:
    """Two neighbouring sizes between which `one` becomes more expensive than `other`, or None if it never does."""
    if one is None or other is None:
        return None
    pairs = [(p.size, p.step, q.step) for p in one.points if (q := other.at(p.size))]
    return next(((n, m) for (n, a, b), (m, c, d) in pairwise(pairs) if a <= b and c > d), None)


PAGE = Page(
    name="scaling",
    title="Cost and error as a chain grows",
    lesson="From one link to a thousand: what coordinates, sweeps and exact multipliers cost as the chain grows.",
    companions=pendulum.PAGE.scenes,
    figures=figures,
    context=context,
    cells=SCALING_CELLS,
    tasks=(REFERENCE_ERROR,),
)
