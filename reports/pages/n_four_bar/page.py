"""The N-four-bar's page: a chain whose one freedom becomes N + 1 twice a turn."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from engines.registry import VARIANTS
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reports.model.checks import Deviation
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.n_four_bar.experiments import FAILURES, SOFT
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups
from reports.write.unmeasured import UNMEASURED

NAME = "n_four_bar"
SCENES = (NFourBar(), TenFourBars(), FortyFourBars())


def figures(material: Material) -> dict[str, str]:
    """Stroboscopic pictures of the truth: two loops and ten from upright, and two through the singular position."""
    two, ten = NFourBar(), TenFourBars()
    line = float(two.singular_times(5.0)[0])
    strips = (
        Strip(two, "Two loops", 7, end=0.9),
        Strip(two, "Through the singular position", 7, start=line - 0.15, end=line + 0.15),
        Strip(ten, "Ten loops", 6, end=1.0),
    )
    return {"stroboscope": svg(stroboscope(strips), "N four-bars in motion")}


def words(material: Material) -> Mapping[str, Any]:
    """Rows, the exact instants of each scene, `failed`: how a method without a best row ended, and `soft`: errors of
    soft loops, UNMEASURED unless all that was run of them left the branch, as the sentence says.
    """
    asked = lookups(material, SCENES)

    def failed(scene: str, engine: str, variant: str) -> Any:
        outcomes = asked["ended"](scene, engine, variant)
        if not outcomes:
            return UNMEASURED
        wrong = all(Outcome(outcome).wrong for outcome in outcomes)
        return "stays on the branch" if wrong else f"can be compared: {', '.join(outcomes)}"

    rows = material.of(SOFT)
    angles = [row.angle for row in rows if Outcome(row.outcome).wrong and math.isfinite(row.angle)]
    whole = rows and len(angles) == len(rows)
    soft = {"count": len(rows), "least": min(angles), "most": max(angles)} if whole else UNMEASURED
    exact = {
        scene.name: {"period": scene.period, "singular": [float(t) for t in scene.singular_times(scene.period)]}
        for scene in (NFourBar(), TenFourBars(), FortyFourBars())
    }
    return {**asked, "failed": failed, "soft": soft, "exact": exact}


# Where a method is known to fall short on the N-four-bar, each with its reason.
SWEPT = (
    "by design: near the singular position the forces have no limit and sweeps do not converge; what they leave is "
    "corrected in the next step"
)
SHIPPED = (
    "by design: as shipped a joint closes a tenth of its gap in a sixtieth of a second, which loses the energy to pass "
    "the top again"
)
EXTRAPOLATED = (
    "by design: with forty loops the steps are a tenth of a second and more, too long for a series in the step"
)
SPRING = (
    "by design: as shipped a loop is a spring of 0.02 s, soft enough for each crank to find its own way in the line"
)
STEP = "by design: near the singular position the loop's force, and the gap it leaves, depend on where the samples fall"
SPRUNG = "by design: near the singular position a loop's spring pulls with its gap over a singular value"
COARSER = "by design: the run of half as many steps, which tells the error, starts anew at the first singular position"
EULER = "by design: a first-order method gains enough energy to turn over faster and faster"
LARGE = "by design: the reset comes at the first singular position, at a step of 0.02 s with 41 cranks"

# Measured with two cranks, for 1 to 4 steps in a hundredth of a second: rounding over that square is 2e-9, 2e-8, 2e-6
# and 2e-3, the errors are 1e-8, 2e-9, 2e-5 and 2e-3 rad, compiled and in numpy.
RANK = (
    "by design: where a stage meets the singular position, a rounded pose turns the way that rows leave open by its "
    "rounding over the square of their smallest singular value"
)

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("n_four_bar_2", "pymunk default", "outcome"): Deviation(SHIPPED, outcome=Outcome.SATURATED),
    ("n_four_bar_2", "pymunk extended", "outcome"): Deviation(SWEPT, outcome=Outcome.UNRESOLVED),
    ("n_four_bar_2", "mujoco default", "outcome"): Deviation(SPRING, outcome=Outcome.BRANCH_FLIP),
    ("n_four_bar_2", "mujoco tuned", "reaction"): Deviation(SPRUNG, 14),
    ("n_four_bar_2", "mujoco extended", "error"): Deviation(STEP, 14),
    ("n_four_bar_2", "mujoco extended", "rate"): Deviation(STEP, 26),
    ("n_four_bar_2", "mujoco extended", "gap"): Deviation(STEP, 3.4),
    ("n_four_bar_2", "mujoco extended", "energy"): Deviation(STEP, 2.8),
    ("n_four_bar_2", "mujoco extended", "reaction"): Deviation(STEP, 220),
    ("n_four_bar_2", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
    ("n_four_bar_10", "pymunk default", "outcome"): Deviation(SHIPPED, outcome=Outcome.SATURATED),
    ("n_four_bar_10", "pymunk tuned", "outcome"): Deviation(SWEPT, outcome=Outcome.SATURATED),
    ("n_four_bar_10", "pymunk extended", "outcome"): Deviation(SWEPT, outcome=Outcome.TORN),
    ("n_four_bar_10", "mujoco default", "outcome"): Deviation(SPRING, outcome=Outcome.BRANCH_FLIP),
    ("n_four_bar_10", "mujoco tuned", "reaction"): Deviation(SPRUNG, 37),
    ("n_four_bar_10", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
    ("n_four_bar_40", "pymunk default", "outcome"): Deviation(SHIPPED, outcome=Outcome.TORN),
    ("n_four_bar_40", "pymunk tuned", "outcome"): Deviation(SWEPT, outcome=Outcome.TORN),
    ("n_four_bar_40", "pymunk extended", "outcome"): Deviation(EXTRAPOLATED, outcome=Outcome.TORN),
    ("n_four_bar_40", "mujoco default", "outcome"): Deviation(SPRING, outcome=Outcome.BRANCH_FLIP),
    ("n_four_bar_40", "mujoco tuned", "outcome"): Deviation(LARGE, outcome=Outcome.RESET),
    ("n_four_bar_40", "mujoco extended", "outcome"): Deviation(COARSER, outcome=Outcome.UNRESOLVED),
    ("n_four_bar_40", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
    ("n_four_bar_2", "pymunk tuned", "gap"): Deviation(SWEPT, 4100000.0),
    ("n_four_bar_2", "pymunk tuned", "reaction"): Deviation(SWEPT, 2.7),
    ("n_four_bar_2", "lagrange rk4 projection", "error"): Deviation(RANK, 390, rounding=True),
    ("n_four_bar_2", "lagrange rk4 projection", "rate"): Deviation(RANK, 310, rounding=True),
    ("n_four_bar_2", "lagrange rk4 projection", "energy"): Deviation(RANK, 2.6, rounding=True),
    ("n_four_bar_2", "lagrange rk4 projection", "reaction"): Deviation(RANK, 97, rounding=True),
    ("n_four_bar_2", "lagrange rk4 projection", "order"): Deviation(RANK, 10, rounding=True),
    ("n_four_bar_2", "lagrange dop853 projection", "error"): Deviation(RANK, 19000.0, rounding=True),
    ("n_four_bar_2", "lagrange dop853 projection", "rate"): Deviation(RANK, 13000.0, rounding=True),
    ("n_four_bar_2", "lagrange dop853 projection", "energy"): Deviation(RANK, 96, rounding=True),
    ("n_four_bar_2", "lagrange dop853 projection", "reaction"): Deviation(RANK, 25000.0, rounding=True),
    ("n_four_bar_2", "lagrange dop853 projection", "order"): Deviation(RANK, 11, rounding=True),
    ("n_four_bar_10", "lagrange dop853 projection", "error"): Deviation(RANK, 83000.0, rounding=True),
    ("n_four_bar_10", "lagrange dop853 projection", "rate"): Deviation(RANK, 39000.0, rounding=True),
    ("n_four_bar_10", "lagrange dop853 projection", "energy"): Deviation(RANK, 9300, rounding=True),
    ("n_four_bar_10", "lagrange dop853 projection", "reaction"): Deviation(RANK, 3800, rounding=True),
    ("n_four_bar_10", "lagrange dop853 projection", "order"): Deviation(RANK, 20, rounding=True),
    ("n_four_bar_40", "lagrange dop853 projection", "error"): Deviation(RANK, 6200, rounding=True),
    ("n_four_bar_40", "lagrange dop853 projection", "rate"): Deviation(RANK, 4100, rounding=True),
    ("n_four_bar_40", "lagrange dop853 projection", "energy"): Deviation(RANK, 66, rounding=True),
    ("n_four_bar_40", "lagrange dop853 projection", "reaction"): Deviation(RANK, 590, rounding=True),
    ("n_four_bar_40", "lagrange dop853 projection", "order"): Deviation(RANK, 7.8, rounding=True),
}

PAGE = Page(
    name=NAME,
    title="N four-bars side by side",
    lesson="Twice a turn all bars lie in one line and one freedom becomes $N + 1$: there an engine may go on wrongly.",
    scenes=SCENES,
    engines=VARIANTS,
    failures=FAILURES,
    figures=figures,
    words=words,
    known=KNOWN,
)
