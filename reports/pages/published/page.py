"""The page of problems that others published: Andrews' mechanism, and what three benchmarks cost to a tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from engines import Engine
from engines.registry import VARIANTS, method
from reference.andrews import Andrews
from reference.four_bar.scenes import FreeFourBar
from reference.n_four_bar import NFourBar
from reference.pendulum.link import PointPendulum
from reference.scene import Scene
from reports.charts.stroboscope import Strip, stroboscope
from reports.charts.theme import svg
from reports.grid.cells import FULL, sweep_cells
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.pages.page import Material, Page
from reports.pages.pendulum.experiments import PHASE
from reports.pages.published.answers import compared
from reports.pages.published.expectations import KNOWN
from reports.text.lookups import told

NAME = "published"
SCENES = (Andrews(),)
# rad: the largest angle error over the whole problem. A low and a high precision, of our choice.
TOLERANCES = (1e-3, 1e-6)
# Bounds of use: 0.1 degree, a millimetre, and half a percent of the largest kinetic energy.
ANGLE, GAP, ENERGY = math.radians(0.1), 1e-3, 5e-3
BORROWED = (*PHASE, *sweep_cells((NFourBar(), FreeFourBar()), VARIANTS, FULL))


@dataclass(frozen=True)
class Scored:
    """A method in one problem: of its rows within a tolerance [rad], for each tolerance, the cheapest; None without."""

    rows: tuple[Measurement | None, ...]
    duration: float  # s, of the problem
    run: bool  # whether any row is there

    @property
    def costs(self) -> list[float | None]:
        """CPU time of the whole problem [s] for each tolerance, None where none was reached."""
        return [None if row is None else row.cpu * self.duration for row in self.rows]


def scored(rows: Iterable[Measurement], scene: Scene, engines: Iterable[Engine]) -> list[Scored]:
    """Every engine in a scene, by the cells that were run."""
    own = [row for row in rows if row.scene == scene.name]
    found = []
    for engine in engines:
        mine = [row for row in own if (row.engine, row.variant) == (engine.name, engine.variant)]
        within = [[row for row in mine if row.angle < tolerance and not _wrong(row)] for tolerance in TOLERANCES]
        cheapest = tuple(min(rows, key=lambda row: row.cpu, default=None) for rows in within)
        found.append(Scored(cheapest, scene.duration, bool(mine)))
    return found


def _wrong(row: Measurement) -> bool:
    return Outcome(row.outcome).wrong


def largest_step(rows: Iterable[Measurement], engine: Engine, quantity: str, bound: float) -> float | None:
    """The largest step [s] at which an error is below a bound, and at all smaller ones too; None for none."""
    own = [row for row in rows if (row.engine, row.variant) == (engine.name, engine.variant)]
    passed = None
    for row in sorted(own, key=lambda row: row.step):
        if _wrong(row) or not getattr(row, quantity) < bound:
            break
        passed = row.step
    return passed


def bounds(rows: Iterable[Measurement], engines: Iterable[Engine]) -> list[dict[str, Any]]:
    """Of every engine the largest step within each of the three bounds, in the free four-bar."""
    four_bar = [row for row in rows if row.scene == FreeFourBar.name]
    asked = (("angle", ANGLE), ("gap", GAP), ("energy", ENERGY))
    return [
        {"method": method(engine), "steps": [largest_step(four_bar, engine, *each) for each in asked]}
        for engine in engines
        if any((row.engine, row.variant) == (engine.name, engine.variant) for row in four_bar)
    ]


def figures(material: Material) -> dict[str, str]:
    """Stroboscopic pictures of the truth: the crank's first half turn, and a whole turn when it is fast."""
    scene = Andrews()
    strips = (
        Strip(scene, "From rest", 7, end=0.012),
        Strip(scene, "Fast", 7, start=0.04, end=0.046),
    )
    return {"stroboscope": svg(stroboscope(strips), "Andrews' squeezing mechanism in motion")}


def words(material: Material) -> Mapping[str, Any]:
    """Published numbers beside ours; `by_method`: the costs of three benchmarks by tolerance; `bounds`."""
    rows = [*material.sweep(SCENES), *material.of(BORROWED)]
    problems = [scored(rows, scene, VARIANTS) for scene in (PointPendulum(), NFourBar(), SCENES[0])]
    by_method = [
        {"method": method(engine), "problems": cells} for engine, *cells in zip(VARIANTS, *problems, strict=True)
    ]
    return {
        **told(material, SCENES),
        "compared": compared(SCENES[0]),
        "by_method": by_method,
        "tolerances": TOLERANCES,
        "bounds": bounds(rows, VARIANTS),
        "time": SCENES[0].mechanism().time_scale,
    }


PAGE = Page(
    name=NAME,
    title="Problems that others published",
    lesson="Andrews' squeezing mechanism against digits that nobody here wrote, and what three benchmarks cost.",
    scenes=SCENES,
    engines=VARIANTS,
    borrowed=BORROWED,
    figures=figures,
    words=words,
    known=KNOWN,
)
