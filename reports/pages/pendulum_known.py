"""Where a method is known to fall short on the pendulums, each with its reason."""

from __future__ import annotations

EULER = "by design: a first-order method loses a chain's motion at the steps that are run here"
FAST = (
    "by design: the bound is made from how fast the links turn; the chain's own modes are faster, so its errors are "
    "larger by their powers"
)
SOFT = "by design: as shipped every equality is a spring of 0.02 s, and their softness adds up along the chain"
LONG = (
    "by design: the grid's steps over 2000 s are a tenth of a second or larger, too large for 845 periods; the page "
    "looks at finer ones among its experiments"
)
HUNDRED = "by design: 300 sweeps do not converge on a hundred links, which leaves errors of no power of the step"

KNOWN: dict[tuple[str, str, str], str] = {
    **{(f"pendulum_{n}", "lagrange euler projection", "outcome"): EULER for n in (1, 10, 100)},
    **{("pendulum_100", "lagrange euler projection", check): EULER for check in ("error", "reaction")},
    **{
        ("pendulum_100", method, "error"): FAST
        for method in (
            "mujoco tuned",
            "mujoco extended",
            "mujoco extended, free, sparse Newton",
            "lagrange rk4 projection",
        )
    },
    **{("pendulum_100", "pymunk extended", check): HUNDRED for check in ("error", "gap", "order")},
    **{(f"pendulum_{n}", "mujoco default, free coordinates", "order"): SOFT for n in (2, 10, 100)},
    ("pendulum_100", "mujoco default, free coordinates", "error"): SOFT,
    **{
        ("point_pendulum", method, "outcome"): LONG
        for method in (
            "pymunk default",
            "pymunk tuned",
            "pymunk extended",
            "mujoco tuned",
            "mujoco extended",
            "lagrange euler projection",
            "lagrange rk4 projection",
            "mujoco default, free coordinates",
            "mujoco extended, free, sparse Newton",
        )
    },
    **{("point_pendulum", "pymunk extended", check): LONG for check in ("error", "gap")},
    **{("point_pendulum", "mujoco default, free coordinates", check): LONG for check in ("gap", "reaction")},
}
