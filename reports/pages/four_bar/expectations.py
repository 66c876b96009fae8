"""Where a method is known to fall short of theory on the four-bar, and where this motion asks for another promise."""

from __future__ import annotations

from reports.model.checks import Deviation

SOFT = "by design: as shipped a loop is a spring of 0.02 s, whatever the step; its softness leaves a plateau"
FIRST = (
    "by design: this integrator takes a loop's spring implicitly, so from a closed start its first acceleration is the "
    "exact one divided by $1 + h b + h^2 k$: by 1.44 for a spring of five steps"
)
DRIFT = "by design: nothing closes the gap that a first-order method opens"
FIVE = "by design: a spring of five steps gives way as the square of five"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("driven_four_bar", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("driven_four_bar", "mujoco stiff discrete", "gap"): Deviation(FIVE, 1.1),
    ("driven_four_bar", "mujoco stiff discrete", "reaction"): Deviation(FIRST, 1.2),
    ("driven_four_bar", "mujoco RK4 alone", "order"): Deviation(SOFT, 10),
    ("free_four_bar", "mujoco RK4 alone", "order"): Deviation(SOFT, 10),
    ("free_four_bar", "lagrange euler none", "gap"): Deviation(DRIFT, 1.2),
    ("spinning_four_bar", "mujoco RK4 alone", "order"): Deviation(SOFT, 10),
    ("spinning_four_bar", "lagrange euler none", "gap"): Deviation(DRIFT, 1.4),
}
