"""Rolling in pymunk by contact and by constraint, as methods for a page.

By contact: `engines.pymunk.outlines`; by a pivot: `.rollers`; by reflection: `.reflection`. A round body is one shape
without corners, so the methods that differ in corners only are one method for it.
"""

from __future__ import annotations

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Pymunk
from engines.pymunk.extended import EVEN, EVEN_POWERS, FIVE
from engines.pymunk.outlines import Contact
from engines.pymunk.reflection import Reflected

CORNERS = (8, 32, 128, 512)
SHIPPED = Pymunk("roll: contact as shipped", roll="contact")
# All of the overlap is left alone, because pushing bodies apart rolls them too.
FACETED = tuple(
    Pymunk(f"roll: contact, {corners} corners", roll="contact", contact=Contact(1.0, 1.0, vertices=corners))
    for corners in CORNERS
)
THIN_GROUND = Pymunk(
    "roll: contact, 512 corners, thin ground", roll="contact", contact=Contact(1.0, 1.0, vertices=512, thickness=0.0)
)
STALE_PIVOT = Pymunk("roll: pivot, stale contact", 5, 0.0, leapfrog=True, roll="stale pivot")
PIVOT = Pymunk("roll: pivot, predicted contact", 5, 0.0, leapfrog=True, roll="pivot")
REFLECTED = Reflected("roll: reflection")
PIVOT_EXTRAPOLATED = Extrapolated(PIVOT, "roll: pivot, extrapolated", levels=FIVE, powers=(2, 3, 4, 5))
REFLECTED_EXTRAPOLATED = Extrapolated(REFLECTED, "roll: reflection, extrapolated", levels=EVEN, powers=EVEN_POWERS)
METHODS: tuple[Engine, ...] = (
    SHIPPED,
    *FACETED,
    THIN_GROUND,
    STALE_PIVOT,
    PIVOT,
    REFLECTED,
    PIVOT_EXTRAPOLATED,
    REFLECTED_EXTRAPOLATED,
)
