"""Where a method is known to fall short on the N-four-bar, each with its reason."""

from __future__ import annotations

SWEPT = (
    "by design: near the singular position the forces have no limit and sweeps do not converge; what they leave is "
    "corrected in the next step"
)
SHIPPED = (
    "by design: as shipped a joint closes a tenth of its gap in a sixtieth of a second, which loses the energy to pass "
    "the top again"
)
EXTRAPOLATED = "by design: extrapolation needs an error that is smooth in the step; at a singular position it is not"
SOFT = "by design: as shipped a loop is a spring of 0.02 s, soft enough for each crank to find its own way in the line"
STEP = "by design: near the singular position the loop's force, and the gap it leaves, depend on where the samples fall"
EULER = "by design: a first-order method gains enough energy to turn over faster and faster"
LARGE = "by design: the reset comes at the first singular position, at a step of 0.02 s with 41 cranks"

TWO, TEN, FORTY = "n_four_bar_2", "n_four_bar_10", "n_four_bar_40"

KNOWN: dict[tuple[str, str, str], str] = {
    **{(scene, "pymunk default", "outcome"): SHIPPED for scene in (TWO, TEN, FORTY)},
    **{(scene, "pymunk default", "error"): SHIPPED for scene in (TWO, TEN, FORTY)},
    **{(scene, "pymunk tuned", "outcome"): SWEPT for scene in (TWO, TEN, FORTY)},
    **{(scene, "pymunk tuned", "error"): SWEPT for scene in (TWO, TEN)},
    (TEN, "pymunk tuned", "reaction"): SWEPT,
    **{
        (scene, "pymunk extended", check): EXTRAPOLATED for scene in (TWO, TEN, FORTY) for check in ("outcome", "error")
    },
    **{(scene, "pymunk extended", "gap"): EXTRAPOLATED for scene in (TWO, TEN)},
    **{(scene, "pymunk extended", "reaction"): EXTRAPOLATED for scene in (TEN, FORTY)},
    **{(scene, "mujoco default", "outcome"): SOFT for scene in (TWO, TEN, FORTY)},
    (TWO, "mujoco default", "error"): SOFT,
    (FORTY, "mujoco tuned", "outcome"): LARGE,
    **{(TWO, method, "order"): STEP for method in ("mujoco tuned", "mujoco extended")},
    **{(scene, "mujoco tuned", "reaction"): STEP for scene in (TWO, TEN)},
    **{(scene, "lagrange euler projection", "outcome"): EULER for scene in (TWO, TEN, FORTY)},
    **{(scene, "lagrange euler projection", "error"): EULER for scene in (TWO, TEN, FORTY)},
}
