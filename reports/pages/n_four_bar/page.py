"""The page of the N-four-bar. This linkage has one degree of freedom, and N + 1 at its two singular positions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from engines import mujoco
from engines.lagrange import Lagrange
from engines.registry import VARIANTS
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation
from reports.pages.common import MAIN_METHODS, cells, described, scene_page
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

SHIPPED_RK4 = replace(mujoco.DEFAULT, variant="RK4 alone", integrator="RK4")
SOFT_LOOPS = cells(NFourBar(), (mujoco.DEFAULT, SHIPPED_RK4), (1, 3, 10, 30))
ONCE = NFourBar(duration=1.2, horizon=1.2)  # a motion that passes only the first singular position


def forces_without_a_limit(material: Material) -> list[Observation]:
    """The largest reaction at instants that approach a singular position."""
    intervals = np.array([1e-1, 1e-2, 1e-3, 1e-4])
    reactions = np.abs(NFourBar().motion(NFourBar().singular_times(5.0)[0] - intervals).reaction).max(axis=1)
    return [
        Observation("the reference", f"{number(interval, 1)} s before", f"largest reaction {reaction:.3g} N")
        for interval, reaction in zip(intervals, reactions, strict=True)
    ]


LINKAGES_IN_A_ROW = (NFourBar(), TenFourBars(), FortyFourBars())


def figures(material: Material) -> dict[str, str]:
    two, ten = NFourBar(), TenFourBars()
    singular = float(two.singular_times(5.0)[0])
    strips = (
        Strip(two, "Two loops", 7, end=0.9),
        Strip(two, "Through the singular position", 7, start=singular - 0.15, end=singular + 0.15),
        Strip(ten, "Ten loops", 6, end=1.0),
    )
    return {"stroboscope": svg(stroboscope(strips), "N four-bars in motion")}


def context(material: Material) -> Mapping[str, Any]:
    """Numbers for the text. exact: period and singular instants [s] by scene. failed: function of (scene, engine,
    variant) -> phrase that states whether all motions are wrong. soft: number and range of the errors of SOFT_LOOPS, or
    UNMEASURED if not all these motions are wrong."""
    look_up = lookups(material, LINKAGES_IN_A_ROW)

    def failed(scene: str, engine: str, variant: str) -> Any:
        outcomes = look_up["ended"](scene, engine, variant)
        if not outcomes:
            return UNMEASURED
        wrong = all(Outcome(outcome).wrong for outcome in outcomes)
        return "stays on the branch" if wrong else f"can be compared: {', '.join(outcomes)}"

    rows = material.of(SOFT_LOOPS)
    angles = [row.angle for row in rows if Outcome(row.outcome).wrong and math.isfinite(row.angle)]
    all_left = rows and len(angles) == len(rows)
    soft = {"count": len(rows), "least": min(angles), "most": max(angles)} if all_left else UNMEASURED
    exact = {
        scene.name: {"period": scene.period, "singular": [float(t) for t in scene.singular_times(scene.period)]}
        for scene in LINKAGES_IN_A_ROW
    }
    return {"failed": failed, "soft": soft, "exact": exact}


PAGE = scene_page(
    "n_four_bar",
    title="N four-bars side by side",
    lesson="Twice a turn all bars lie in one line and one freedom becomes $N + 1$: there an engine may go on wrongly.",
    scenes=LINKAGES_IN_A_ROW,
    engines=VARIANTS,
    failures=described(
        __file__,
        Failure("Through the singular position, as shipped", cells=SOFT_LOOPS),
        Failure(
            "Forces that have no limit",
            cells=cells(ONCE, MAIN_METHODS, (1, 10, 100)),
            observations=forces_without_a_limit,
        ),
        Failure(
            "Exact multipliers at a singular position",
            cells=cells(
                ONCE, (Lagrange("rk4", "none"), Lagrange("rk4", "baumgarte"), Lagrange("rk4", "projection")), (1, 3, 10)
            ),
        ),
        first=lambda: f"{NFourBar().singular_times(5.0)[0]:.4f}",
    ),
    figures=figures,
    context=context,
)
