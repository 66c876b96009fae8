"""Where a method is known to fall short of theory in rolling."""

from __future__ import annotations

from reports.model.checks import Deviation
from reports.model.outcomes import Outcome

POLYGON = "by design: a body that is not round is a polygon here, and rolls from corner to corner in blows"
SOFT = "by design: as shipped the contact is a spring of 0.02 s, whatever the step"
CHATTER = "upstream: a contact without the velocity term is let go and caught again; its force is right on average"
BARELY = "by design: pins already hold the gears apart, so that only softness lets them press and rub"


KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("rolling_ellipse", "pymunk default", "outcome"): Deviation(POLYGON, outcome=Outcome.SATURATED),
    ("rolling_ellipse", "pymunk tuned", "error"): Deviation(POLYGON, 1.2),
    ("rolling_ellipse", "pymunk tuned", "reaction"): Deviation(POLYGON, 17),
    ("rolling_ellipse", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("rolling_ellipse", "mujoco tuned", "reaction"): Deviation(CHATTER, 3.8),
    ("rolling_ellipse", "mujoco contact, stiff Euler", "reaction"): Deviation(CHATTER, 4.9),
    ("rolling_disc", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("rolling_disc", "mujoco tuned", "reaction"): Deviation(CHATTER, 44),
    ("rolling_disc", "mujoco contact, stiff Euler", "reaction"): Deviation(CHATTER, 60),
    ("rolling_cam", "pymunk default", "outcome"): Deviation(POLYGON, outcome=Outcome.SATURATED),
    ("rolling_cam", "pymunk tuned", "error"): Deviation(POLYGON, 11),
    ("rolling_cam", "pymunk tuned", "rate"): Deviation(POLYGON, 4.8),
    ("rolling_cam", "pymunk tuned", "energy"): Deviation(POLYGON, 1.3),
    ("rolling_cam", "pymunk tuned", "reaction"): Deviation(POLYGON, 75),
    ("rolling_incline", "pymunk default", "error"): Deviation(POLYGON, 15),
    ("rolling_incline", "pymunk default", "rate"): Deviation(POLYGON, 6.3),
    ("rolling_incline", "pymunk default", "gap"): Deviation(POLYGON, 4.5),
    ("rolling_incline", "pymunk default", "energy"): Deviation(POLYGON, 5.1),
    ("rolling_incline", "pymunk default", "reaction"): Deviation(POLYGON, 480),
    ("rolling_incline", "pymunk tuned", "error"): Deviation(POLYGON, 2.3),
    ("rolling_incline", "pymunk tuned", "rate"): Deviation(POLYGON, 1.1),
    ("rolling_incline", "pymunk tuned", "energy"): Deviation(POLYGON, 1.2),
    ("rolling_incline", "pymunk tuned", "reaction"): Deviation(POLYGON, 120),
    ("rolling_incline", "mujoco default", "reaction"): Deviation(CHATTER, 1.6),
    ("rolling_incline", "mujoco default", "order"): Deviation(CHATTER, 2.5),
    ("rolling_incline", "mujoco tuned", "reaction"): Deviation(CHATTER, 31),
    ("rolling_incline", "mujoco contact, stiff Euler", "reaction"): Deviation(CHATTER, 37),
    ("rolling_on_circle", "pymunk default", "reaction"): Deviation(CHATTER, 16),
    ("rolling_on_circle", "pymunk tuned", "reaction"): Deviation(CHATTER, 16),
    ("rolling_on_circle", "mujoco default", "reaction"): Deviation(CHATTER, 2.8),
    ("rolling_on_circle", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("rolling_on_circle", "mujoco tuned", "reaction"): Deviation(CHATTER, 61),
    ("rolling_on_circle", "mujoco contact, stiff Euler", "reaction"): Deviation(CHATTER, 75),
    ("elliptic_gears", "pymunk default", "reaction"): Deviation(POLYGON, 9.2),
    ("elliptic_gears", "mujoco default", "order"): Deviation(BARELY, 2.5),
    ("elliptic_gears", "mujoco tuned", "reaction"): Deviation(BARELY, 4),
    ("elliptic_gears", "pymunk tuned", "reaction"): Deviation(POLYGON, 2.3),
}
