"""What theory promises for a skate in each construction, and where one is known to fall short of it."""

from __future__ import annotations

# Every row that is held only at the ends of steps makes a method of first order, whatever the integrator; a reflection
# is symmetric in time: second; extrapolation removes the powers it is given. MuJoCo's RK4 keeps its order 4 with rows
# that are written in every stage.
ORDERS: dict[str, int] = {
    "pymunk default": 1,
    "pymunk tuned": 1,
    "pymunk extended": 6,
    "mujoco default": 1,
    "mujoco tuned": 1,
    "mujoco extended": 4,
    "lagrange euler projection": 1,
    "lagrange rk4 projection": 4,
    "pymunk skate: centre's velocity zeroed": 1,
    "pymunk skate: point's velocity zeroed": 1,
    "pymunk skate: impulse at the blade": 1,
    "pymunk skate: groove, stale heading": 1,
    "pymunk skate: groove, predicted heading": 1,
    "pymunk skate: reflection": 2,
    "pymunk skate: friction": 1,
    "pymunk skate: groove, extrapolated": 5,
    "pymunk skate: reflection, extrapolated": 8,
    "mujoco friction blade": 1,
    "mujoco thin wheel": 1,
    "mujoco velocity servo": 1,
    "mujoco tendon friction": 1,
    "mujoco tendon": 1,
    "mujoco tendon RK4": 1,
    "mujoco leapfrog": 2,
    "mujoco applied force": 1,
    "mujoco passive force": 4,
    "mujoco rows, shipped compliance": 4,
}

ANOTHER_BODY = "by design: the velocity across is set without the turning that a force at the blade brings"
STRAIGHT = "by design: it never turns round, a naive zeroing makes a stable vehicle of an unstable one"
SOFT = "by design: a contact as shipped is a spring of 0.02 s and gives way, whatever the step"
LATE = "by design: a row at the old heading has no slip to stop in the first step, so its first force is none"
COMPLIANT = "by design: a row with its shipped compliance gives way, whatever the step"
SLOW = "ours: the bound counts time in turnings, and here the speed over the length is a thousand times as fast"

KNOWN: dict[tuple[str, str, str], str] = {
    **{
        ("sleigh", method, check): ANOTHER_BODY
        for method in (
            "pymunk default",
            "pymunk skate: centre's velocity zeroed",
            "pymunk skate: point's velocity zeroed",
        )
        for check in ("outcome", "error")
    },
    ("sleigh", "mujoco default", "order"): SOFT,
    **{
        ("sleigh", f"mujoco {variant}", "reaction"): LATE
        for variant in (
            "default",
            "friction blade",
            "thin wheel",
            "velocity servo",
            "tendon friction",
            "tendon",
            "tendon RK4",
        )
    },
    **{("sleigh", "mujoco rows, shipped compliance", check): COMPLIANT for check in ("error", "order")},
    **{("sleigh_backwards", "pymunk default", check): STRAIGHT for check in ("error", "order", "reaction")},
    ("sleigh_backwards", "mujoco default", "order"): SOFT,
    **{
        ("sleigh_backwards", method, check): SLOW
        for method in ("pymunk tuned", "mujoco default", "mujoco tuned", "lagrange euler projection")
        for check in ("error", "reaction")
    },
}
