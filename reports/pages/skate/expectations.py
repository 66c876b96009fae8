"""Where a construction of a skate is known to fall short of theory, each with its reason."""

from __future__ import annotations

from engines import Promise
from reports.model.checks import Deviation
from reports.model.outcomes import Outcome

# Another body's motion has no order; here it is held to an ideal row's all the same, so that by how much it misses that
# stays known.
ORDERS = {("sleigh_backwards", "pymunk default"): Promise(1, differences=1)}

ANOTHER_BODY = "by design: the velocity across is set without the turning that a force at the blade brings"
STRAIGHT = "by design: it never turns round, a naive zeroing makes a stable vehicle of an unstable one"
SOFT = "by design: a contact as shipped is a spring of 0.02 s and gives way, whatever the step"
LATE = "by design: a row at the old heading has no slip to stop in the first step, so its first force is none"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("sleigh", "pymunk default", "outcome"): Deviation(ANOTHER_BODY, outcome=Outcome.SATURATED),
    ("sleigh", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("sleigh", "pymunk skate: centre's velocity zeroed", "outcome"): Deviation(ANOTHER_BODY, outcome=Outcome.SATURATED),
    ("sleigh", "pymunk skate: point's velocity zeroed", "outcome"): Deviation(ANOTHER_BODY, outcome=Outcome.SATURATED),
    ("sleigh", "mujoco friction blade", "reaction"): Deviation(LATE, 5.9),
    ("sleigh_backwards", "pymunk default", "error"): Deviation(STRAIGHT, 140),
    ("sleigh_backwards", "pymunk default", "rate"): Deviation(STRAIGHT, 98),
    ("sleigh_backwards", "pymunk default", "gap"): Deviation(STRAIGHT, 1.3),
    ("sleigh_backwards", "pymunk default", "energy"): Deviation(STRAIGHT, 18),
    ("sleigh_backwards", "pymunk default", "reaction"): Deviation(STRAIGHT, 43),
    ("sleigh_backwards", "pymunk default", "order"): Deviation(STRAIGHT, 2.5),
    ("sleigh_backwards", "mujoco default", "error"): Deviation(SOFT, 1.6),
    ("sleigh_backwards", "mujoco default", "rate"): Deviation(SOFT, 1.7),
    ("sleigh_backwards", "mujoco default", "energy"): Deviation(SOFT, 3300),
    ("sleigh_backwards", "mujoco default", "order"): Deviation(SOFT, 2.5),
}
