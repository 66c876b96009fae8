"""Where a method is known to fall short on the N-four-bar, each with its reason."""

from __future__ import annotations

from reports.model.checks import Deviation
from reports.model.outcomes import Outcome

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
SOFT = "by design: as shipped a loop is a spring of 0.02 s, soft enough for each crank to find its own way in the line"
STEP = "by design: near the singular position the loop's force, and the gap it leaves, depend on where the samples fall"
SPRUNG = "by design: near the singular position a loop's spring pulls with its gap over a singular value"
COARSER = "by design: the run of half as many steps, which tells the error, starts anew at the first singular position"
EULER = "by design: a first-order method gains enough energy to turn over faster and faster"
LARGE = "by design: the reset comes at the first singular position, at a step of 0.02 s with 41 cranks"

TWO, TEN, FORTY = "n_four_bar_2", "n_four_bar_10", "n_four_bar_40"

# Measured with two cranks, for 1 to 4 steps in a hundredth of a second: rounding over that square is 2e-9, 2e-8, 2e-6
# and 2e-3, the errors are 1e-8, 2e-9, 2e-5 and 2e-3 rad, compiled and in numpy.
RANK = (
    "by design: where a stage meets the singular position, a rounded pose turns the way that rows leave open by its "
    "rounding over the square of their smallest singular value"
)

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("n_four_bar_2", "pymunk default", "outcome"): Deviation(SHIPPED, outcome=Outcome.SATURATED),
    ("n_four_bar_2", "pymunk extended", "outcome"): Deviation(SWEPT, outcome=Outcome.UNRESOLVED),
    ("n_four_bar_2", "mujoco default", "outcome"): Deviation(SOFT, outcome=Outcome.BRANCH_FLIP),
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
    ("n_four_bar_10", "mujoco default", "outcome"): Deviation(SOFT, outcome=Outcome.BRANCH_FLIP),
    ("n_four_bar_10", "mujoco tuned", "reaction"): Deviation(SPRUNG, 37),
    ("n_four_bar_10", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
    ("n_four_bar_40", "pymunk default", "outcome"): Deviation(SHIPPED, outcome=Outcome.TORN),
    ("n_four_bar_40", "pymunk tuned", "outcome"): Deviation(SWEPT, outcome=Outcome.TORN),
    ("n_four_bar_40", "pymunk extended", "outcome"): Deviation(EXTRAPOLATED, outcome=Outcome.TORN),
    ("n_four_bar_40", "mujoco default", "outcome"): Deviation(SOFT, outcome=Outcome.BRANCH_FLIP),
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
