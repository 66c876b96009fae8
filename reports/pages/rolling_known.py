"""What theory promises for rolling in each method, and where a method is known to fall short of it."""

from __future__ import annotations

from reference.rolling.elliptic_gears import EllipticGears
from reference.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reports.pages.chain_orders import EXTRAPOLATED, STEPPED
from reports.promises import EXACT, Promise, Promises

ELLIPSE, DISC, CAM = RollingEllipse.name, RollingDisc.name, RollingCam.name
INCLINE, RING = RollingDownhill.name, RollingInRing.name
HILL, GEARS = RollingOnCircle.name, EllipticGears.name

# A contact's row knows the velocity and not how it changes: first order at best, whatever integrates it. A pivot at the
# contact that is, instead of the one that will be, keeps half of that error, but closes its gap all the same.
EQUALITY = "mujoco joint equality, rewritten"
ORDERS: Promises = {
    "pymunk default": STEPPED,
    "pymunk tuned": STEPPED,
    "pymunk extended": EXTRAPOLATED,
    "mujoco default": Promise(1),
    "mujoco tuned": Promise(1),
    "mujoco extended": Promise(4),
    "lagrange rk4 projection": Promise(4, gap=EXACT, slip=EXACT),
    "pymunk roll: pivot, stale contact": Promise(1, gap=2, slip=2, differences=1),
    "pymunk roll: pivot, predicted contact": Promise(2, differences=1),
    # What a reflection lacks changes sign with every step, and the energy is kept.
    "pymunk roll: reflection": Promise(2, energy=EXACT, differences=1),
    "mujoco contact, stiff Euler": Promise(1),
    EQUALITY: Promise(1, gap=2),
    "mujoco contact, completed": Promise(4),
    # Where nothing but the contact turns the body, its velocities' error of first order alternates and leaves no pose.
    **{(scene, EQUALITY): Promise(2, rate=1, slip=1, energy=1, reaction=1) for scene in (ELLIPSE, RING)},
    # Gears turn at a prescribed rate: what a stale contact lacks is in the forces alone.
    (GEARS, "pymunk roll: pivot, stale contact"): Promise(2, reaction=1, differences=1),
}

POLYGON = "by design: a body that is not round is a polygon here, and rolls from corner to corner in blows"
SOFT = "by design: as shipped the contact is a spring of 0.02 s, whatever the step"
CHATTER = "upstream: a contact without the velocity term is let go and caught again; its force is right on average"
STANDING = "upstream: a row without the velocity term; at the start it carries the weight of a body at rest"
BARELY = "by design: pins already hold the gears apart, so that only softness lets them press and rub"
STALE = "by design: half of the rolling acceleration is missing, so that the forces are those of another motion"
FAST_CONTACT = (
    "by design: in the ring the contact turns 9/4 times as fast as the body, of which the bound knows nothing"
)

KNOWN: dict[tuple[str, str, str], str] = {
    **{(ELLIPSE, "pymunk default", check): POLYGON for check in ("outcome", "error", "reaction")},
    **{(ELLIPSE, "pymunk tuned", check): POLYGON for check in ("order", "reaction")},
    **{(CAM, "pymunk default", check): POLYGON for check in ("outcome", "error", "reaction")},
    **{(CAM, "pymunk tuned", check): POLYGON for check in ("error", "order", "reaction")},
    **{(INCLINE, "pymunk default", check): POLYGON for check in ("error", "reaction")},
    **{(INCLINE, "pymunk tuned", check): POLYGON for check in ("order", "reaction")},
    **{(scene, "mujoco default", "order"): SOFT for scene in (ELLIPSE, DISC)},
    **{(scene, "mujoco tuned", "reaction"): CHATTER for scene in (ELLIPSE, DISC, INCLINE)},
    **{(scene, "mujoco contact, stiff Euler", "reaction"): CHATTER for scene in (ELLIPSE, DISC, INCLINE)},
    (INCLINE, "mujoco default", "reaction"): CHATTER,
    **{(scene, "mujoco joint equality, rewritten", "reaction"): STANDING for scene in (ELLIPSE, INCLINE, RING)},
    (RING, "mujoco extended", "error"): FAST_CONTACT,
    **{(HILL, f"pymunk {variant}", "reaction"): CHATTER for variant in ("default", "tuned")},
    **{(HILL, f"mujoco {variant}", "reaction"): CHATTER for variant in ("default", "tuned", "contact, stiff Euler")},
    (HILL, "mujoco default", "order"): SOFT,
    **{(GEARS, "pymunk default", check): POLYGON for check in ("order", "reaction")},
    **{(GEARS, "pymunk tuned", check): POLYGON for check in ("outcome", "reaction")},
    **{(GEARS, f"mujoco {variant}", "reaction"): BARELY for variant in ("default", "tuned", "contact, stiff Euler")},
    (GEARS, "pymunk roll: pivot, stale contact", "reaction"): STALE,
}
