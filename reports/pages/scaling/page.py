"""The page on scaling: what a step costs and how wrong it is as a pendulum grows from one link to a thousand."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from math import ceil, log, pi, sqrt
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from engines import Engine, method_name, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.pymunk.contraction import LEFT, MOST
from reference.scenes.pendulum.scenes import LongPendulum
from reports.model.cells import Cell
from reports.model.page import Material, Page
from reports.pages.pendulum import page as pendulum
from reports.pages.scaling.experiments import BandedChain, Point, Series, TruthError, cost_exponent, series_of
from reports.plots.looks import look
from reports.plots.theme import LIGHT, drawing, style_axes, svg
from reports.write.tables import NOTHING, markdown, number
from reports.write.unmeasured import UNMEASURED

TICKS = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
FURTHER = ("X", "v")


def scaling_chart(found: Sequence[Series]) -> Figure:
    """Two panels side by side: CPU time of a step [µs], and the largest angle error after the whole run [rad]."""
    variants: dict[str, list[str]] = {}
    for series in found:
        variants.setdefault(series.engine, []).append(series.variant)
    looks = {s.method: _look(s, variants) for s in found}
    with drawing(5.6) as figure:
        cost, error = figure.subplots(1, 2, gridspec_kw={"width_ratios": [1.25, 1]})
        for panel, title, what in (
            (cost, "Cost of a step", "CPU time of a step [µs]"),
            (error, "Error at a fixed step", "largest angle error [rad]"),
        ):
            panel.set_title(title, loc="left", fontweight="bold", color=LIGHT.ink)
            panel.set_xscale("log")
            panel.set_yscale("log")
            style_axes(panel)
            panel.set_xlabel("links")
            panel.set_ylabel(what)
        for series in found:
            _draw(cost, [(p.size, 1e6 * p.step) for p in series.points], looks[series.method])
            _draw(error, [(p.size, p.error) for p in series.points], looks[series.method])
        for panel in (cost, error):
            _ticks(panel)
        handles = [Line2D([], [], label=series.method, **looks[series.method]) for series in found]
        figure.legend(handles=handles, loc="outside lower center", ncols=3, handlelength=3.2)
    return figure


def _look(series: Series, variants: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """As in all charts; a fourth and fifth method of an engine, whose half-filled marks are too alike, get others."""
    own = look(series.engine, series.variant, variants)
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


def fitted(series: Series) -> tuple[float, int, int]:
    """The exponent of its cost, where it is one method, with the first and last size of the fit."""
    return cost_exponent(series, *ALIKE.get(series.method, (0, math.inf)))


STEP = 5e-3  # s, the same for all: about the longest at which a reduced-coordinate Euler step still follows 200 links
SMALL = (1, 3, 10, 20)
LARGE = (50, 100)
COSTLY = (300, 1000)  # a few steps only, for their cost
SAMPLES = 5
FEW, MORE = 4, 40  # steps; a cheap one would else show little but how the first step fills the caches

FREE = replace(mujoco.DEFAULT, variant="default, free coordinates", coordinates="free")
# What a step costs: the runs behind an estimate would be counted with it.
PLAIN = replace(mujoco.EXTENDED, coordinates="free", estimates=False)
SPARSE = replace(
    PLAIN,
    variant="extended, free, sparse Newton, no estimate",
    solvers=("Newton",),
    iterations=5,
    tolerance=1e-20,
    jacobian="sparse",
)
SWEPT = replace(PLAIN, variant="extended, free, PGS sweeps, no estimate", solvers=("PGS",))
EULER, RUNGE_KUTTA = Lagrange("euler", "projection"), Lagrange("rk4", "projection")

METHODS: tuple[Engine, ...] = (
    *(pymunk.DEFAULT, pymunk.TUNED, pymunk.EXTENDED, mujoco.DEFAULT, mujoco.TUNED),
    *(FREE, SPARSE, SWEPT, EULER, RUNGE_KUTTA, BandedChain()),
)
# They take seconds for a step of a longer chain.
AT_MOST_300 = (pymunk.EXTENDED, SWEPT, EULER, RUNGE_KUTTA)
CHEAP: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, FREE, SPARSE, BandedChain())

# Equal links: a sweep leaves 1 - pi^2/(4 N^2) of the slowest mode, and the sweeps of a step shall leave LEFT of it.
SWEEPS_OVER_SQUARE = -4 * log(LEFT) / pi**2
CAPPED = ceil(sqrt(MOST / SWEEPS_OVER_SQUARE))

# No fit goes across sizes at which a method is another one: by its sweeps, which have a limit, and at COSTLY
# sizes, where the first steps, which are swept longer, are a large part of a few steps.
ALIKE: Mapping[str, tuple[float, float]] = {"pymunk tuned": (CAPPED, max(LARGE)), "pymunk extended": (0, max(LARGE))}


def cells() -> tuple[Cell, ...]:
    """Every method at every size; the purpose "growth" runs always, "large" in a full run only."""
    found = []
    for engine in METHODS:
        for links in (*SMALL, *LARGE, *COSTLY):
            if links > 300 and engine in AT_MOST_300:
                continue
            if links in COSTLY:
                steps = MORE if engine in CHEAP else FEW
                scene = LongPendulum(links, duration=steps * STEP, horizon=steps * STEP)
                found.append(Cell(scene, engine, steps, "large", 1))
            else:
                scene = LongPendulum(links)
                every = round(scene.duration / STEP) // SAMPLES
                found.append(Cell(scene, engine, every, "growth" if links in SMALL else "large", SAMPLES))
    return tuple(found)


CELLS = cells()
OWN = TruthError(LongPendulum(max(LARGE)))  # the longest chain that is run to the end


def _found(material: Material) -> tuple[Series, ...]:
    return series_of({cell: material.rows[cell] for cell in CELLS if cell in material.rows}, LongPendulum().duration)


def figures(material: Material) -> dict[str, str]:
    """The chart, if anything was run."""
    found = _found(material)
    title = "Cost of a step and error against the number of links"
    return {"cost": svg(scaling_chart(found), title)} if found else {}


def _law(fit: tuple[float, int, int]) -> str:
    slope, first, last = fit
    return f"{slope:.1f} ({first} to {last})" if last else NOTHING


def _told(value: float, outcome: str) -> str:
    """A number, or what became of the run where it has none."""
    return number(value) if value == value else f"**{outcome}**"


def cost_table(found: tuple[Series, ...]) -> str:
    """CPU time of a step [µs] by method and links."""
    sizes = sorted({point.size for series in found for point in series.points})
    return _table(found, sizes, lambda series, point: _told(1e6 * point.step, point.outcome))


def error_table(found: tuple[Series, ...]) -> str:
    """The largest angle error [rad] by method and links."""
    whole = LongPendulum().duration
    run = {(method_name(c.engine), c.scene.links) for c in CELLS if c.scene.duration == whole}  # type: ignore[attr-defined]

    def cell(series: Series, point: Point) -> str:
        return _told(point.error, point.outcome) if (series.method, point.size) in run else ""

    return _table(found, sorted({size for _, size in run}), cell)


def _table(found: tuple[Series, ...], sizes: Sequence[int], cell: Callable[[Series, Point], str]) -> str:
    body = [
        [series.method, *(cell(series, point) if (point := series.at(size)) else "" for size in sizes)]
        for series in found
    ]
    return markdown(["method", *map(str, sizes)], body)


def words(material: Material) -> Mapping[str, Any]:
    """The tables, the laws, and single points for sentences, UNMEASURED where nothing was run."""
    found = _found(material)
    by_method = {series.method: series for series in found}

    def at(engine: Engine, links: int) -> Any:
        series = by_method.get(method_name(engine))
        return (series.at(links) if series else None) or UNMEASURED

    return {
        "missing": not found,
        "costs": cost_table(found),
        "errors": error_table(found),
        "laws": {series.method: _law(fitted(series)) for series in found},
        "sweeps": {"over_square": SWEEPS_OVER_SQUARE, "capped": CAPPED, "most": MOST},
        "crossing": crossing(by_method.get("mujoco tuned"), by_method.get(f"mujoco {SPARSE.variant}")) or UNMEASURED,
        "tree": {n: at(mujoco.TUNED, n) for n in (100, 1000)},
        "sparse": {n: at(SPARSE, n) for n in (100, 1000)},
        "swept": at(SWEPT, 100),
        "banded": {n: at(BandedChain(), n) for n in (100, 1000)},
        "impulses": {n: at(pymunk.DEFAULT, n) for n in (100, 1000)},
        "own": own.number("error") if (own := material.finished(OWN)) else UNMEASURED,
        "step": STEP,
        "duration": LongPendulum().duration,
    }


def crossing(one: Series | None, other: Series | None) -> tuple[int, int] | None:
    """Between which two sizes the first begins to cost more than the other; None unless it does."""
    if one is None or other is None:
        return None
    pairs = [(p.size, p.step, q.step) for p in one.points if (q := other.at(p.size))]
    for (small, a, b), (large, c, d) in pairwise(pairs):
        if a <= b and c > d:
            return small, large
    return None


PAGE = Page(
    name="scaling",
    title="Cost and error as a chain grows",
    lesson="From one link to a thousand: what coordinates, sweeps and exact multipliers cost as the chain grows.",
    scenes=(),
    engines=(),
    companions=pendulum.SCENES,
    figures=figures,
    words=words,
    cells=CELLS,
    tasks=(OWN,),
)
