"""Where a method is known to fall short on Andrews' mechanism, each with its reason."""

from __future__ import annotations

from reports.model.checks import Deviation
from reports.model.outcomes import Outcome

CLOSING = (
    "by design: as shipped a joint closes a tenth of its gap in a sixtieth of a second, a third of the whole motion"
)
SOFT = "by design: as shipped a loop is a spring with a time constant of 0.02 s, and the whole motion takes 0.05 s"
TIED = (
    "by design: at these steps its time constant is five steps, as a fifth of the motion's own would be shorter; the "
    "order is 2 there, and 4 at smaller ones"
)
EULER = "by design: the crank speeds up for the whole motion, and a method of first order is radians behind"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("andrews", "pymunk default", "outcome"): Deviation(CLOSING, outcome=Outcome.SATURATED),
    ("andrews", "mujoco default", "outcome"): Deviation(SOFT, outcome=Outcome.TORN),
    ("andrews", "mujoco extended", "outcome"): Deviation(TIED, outcome=Outcome.UNRESOLVED),
    ("andrews", "lagrange euler projection", "outcome"): Deviation(EULER, outcome=Outcome.SATURATED),
}
