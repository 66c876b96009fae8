"""The page on scaling: what a step costs and how wrong it is as a pendulum grows from one link to a thousand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, log, pi, sqrt
from typing import Any

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.pymunk.contraction import LEFT, MOST
from reference.scenes.many_links import LongPendulum
from reports.charts.theme import svg
from reports.grid.cells import Cell
from reports.grid.scaling_fit import Series, cost_exponent, error_exponent, series_of
from reports.pages.page import Material, Page
from reports.pages.pendulum import page as pendulum
from reports.pages.scaling.chart import scaling_chart
from reports.pages.scaling.reference_method import BandedChain
from reports.pages.scaling.truth_error import TruthError
from reports.text.tables import NOTHING, markdown, number
from reports.text.unmeasured import UNMEASURED

NAME = "scaling"

STEP = 5e-3  # s, the same for all: about the longest at which a reduced-coordinate Euler step still follows 200 links
SMALL = (1, 2, 3, 5, 10, 20)
LARGE = (50, 100, 200)
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

# Method -> the largest chain that it is given: what takes seconds for a step is left out.
LARGEST: dict[Engine, int] = {
    pymunk.DEFAULT: 1000,
    pymunk.TUNED: 1000,
    pymunk.EXTENDED: 300,
    mujoco.DEFAULT: 1000,
    mujoco.TUNED: 1000,
    FREE: 1000,
    SPARSE: 1000,
    SWEPT: 300,
    EULER: 300,
    RUNGE_KUTTA: 300,
    BandedChain(): 1000,
}
# These two are run to the end up to 100 links only, since more take seconds a step.
LIMITED: tuple[Engine, ...] = (SWEPT, RUNGE_KUTTA)
CHEAP: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, FREE, SPARSE, BandedChain())

# Equal links: a sweep leaves 1 - pi^2/(4 N^2) of the slowest mode, and the sweeps of a step shall leave LEFT of it.
SWEEPS_OVER_SQUARE = -4 * log(LEFT) / pi**2
CAPPED = ceil(sqrt(MOST / SWEEPS_OVER_SQUARE))

LAWS = {
    "pymunk default": "10 sweeps over $N$ joints in every step: $O(N)$; too few above some number of links",
    "pymunk tuned": (
        rf"${number(SWEEPS_OVER_SQUARE)} \, N^2$ sweeps over $N$ joints: $O(N^3)$; from {CAPPED} links on there are "
        f"{MOST} sweeps: $O(N)$"
    ),
    "pymunk extended": "the same, 23 steps for one",
    "mujoco default": r"reduced coordinates, a dense $N \times N$ mass matrix: $O(N^2)$ to fill, $O(N^3)$ to factorise",
    "mujoco tuned": "the same four times a step",
    f"mujoco {FREE.variant}": "$3 N$ coordinates and $3 N$ rows, each of two bodies: banded, sparse Newton is $O(N)$",
    f"mujoco {SPARSE.variant}": "the same, four times a step, refined",
    f"mujoco {SWEPT.variant}": r"at most 100 sweeps over the dense $3 N \times 3 N$ matrix of the rows: $O(N^2)$",
    "lagrange euler projection": (
        "exact multipliers: $J M^{-1} J^T$ of $2 N$ rows is factorised in its narrow band, $O(N)$; without numba "
        "it is dense, $O(N^3)$"
    ),
    "lagrange rk4 projection": "the same four times a step",
    "reference banded rk4": "the same multipliers, block-tridiagonal: $O(N)$; below 100 links numpy's calls cost most",
}


def cells() -> tuple[Cell, ...]:
    """Every method at every size; the purpose "growth" runs always, "large" in a full run only."""
    found = []
    for engine, largest in LARGEST.items():
        for links in (*SMALL, *LARGE, *COSTLY):
            if links > largest:
                continue
            if links in COSTLY or (links > 100 and engine in LIMITED):
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


@dataclass(frozen=True)
class StudyPage(Page):
    """A page about cells of its own instead of scenes, failures and maps."""

    studied: tuple[Cell, ...] = ()

    def extra_cells(self) -> tuple[Cell, ...]:
        return self.studied


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
    """CPU time of a step [µs] by method and links, with the fitted exponent."""
    sizes = sorted({point.size for series in found for point in series.points})
    body = []
    for series in found:
        points = [series.at(size) for size in sizes]
        numbers = [_told(1e6 * point.step, point.outcome) if point else "" for point in points]
        body.append([series.method, *numbers, _law(cost_exponent(series))])
    return markdown(["method", *map(str, sizes), "exponent (links)"], body)


def error_table(found: tuple[Series, ...]) -> str:
    """The largest angle error [rad] by method and links, with the fitted exponent."""
    whole = LongPendulum().duration
    run = {(f"{c.engine.name} {c.engine.variant}", c.scene.links) for c in CELLS if c.scene.duration == whole}  # type: ignore[attr-defined]
    sizes = sorted({size for _, size in run})
    body = []
    for series in found:
        numbers = [
            _told(point.error, point.outcome) if point and (series.method, size) in run else ""
            for size, point in ((size, series.at(size)) for size in sizes)
        ]
        body.append([series.method, *numbers, _law(error_exponent(series))])
    return markdown(["method", *map(str, sizes), "exponent (links)"], body)


def words(material: Material) -> Mapping[str, Any]:
    """The tables, the laws, and single points for sentences, UNMEASURED where nothing was run."""
    found = _found(material)
    by_method = {series.method: series for series in found}

    def at(engine: Engine, links: int) -> Any:
        series = by_method.get(f"{engine.name} {engine.variant}")
        return (series.at(links) if series else None) or UNMEASURED

    return {
        "missing": not found,
        "costs": cost_table(found),
        "errors": error_table(found),
        "laws": markdown(
            ["method", "measured", "what explains it"],
            [[s.method, _law(cost_exponent(s)), LAWS[s.method]] for s in found],
            left=3,
        ),
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


PAGE = StudyPage(
    name=NAME,
    title="Cost and error as a chain grows",
    lesson="From one link to a thousand: what coordinates, sweeps and exact multipliers cost as the chain grows.",
    scenes=(),
    engines=(),
    companions=pendulum.SCENES,
    figures=figures,
    words=words,
    studied=CELLS,
    tasks=(OWN,),
)
