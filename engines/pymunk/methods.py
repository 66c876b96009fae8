"""Every method of pymunk as a value: the three variants, what lies between them, and each construction of a joint.

METHODS are for every scene. What stands below them holds one kind of joint in one way each, for a page that compares
them; what each way is stands in `engines.pymunk.joints`.
"""

from __future__ import annotations

from dataclasses import replace

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Extended, Pymunk
from engines.pymunk.joints.roll import Contact

DEFAULT = Pymunk("default")
# Contact: all of the overlap is left alone, because pushing bodies apart rolls them too. That is `bias`, of which
# nothing is closed, so that `slop` is no length here: any other gives the same motion to the last bit.
TUNED = Pymunk("tuned", "contraction", "contraction", skate="groove", contact=Contact(slop=1.0, bias=1.0, vertices=512))
LEAPFROG = Pymunk("leapfrog", "contraction", "contraction", leapfrog=True, skate="groove", roll="pivot")
# What is extrapolated has to be smooth in the step from the first sample on, and stable: about two milliseconds a step
# for the few mechanisms whose rows nearly depend on each other, where 300 sweeps leave nearly all.
WORK = 200_000
SETTLED = replace(LEAPFROG, settled=1, work=WORK)
# Skates and hinges in one loop pass impulses round: with fewer sweeps, what they leave shows before the step's error.
# To aim a groove takes as long as these forty.
AIMED = Pymunk(
    "aimed",
    "contraction",
    "contraction",
    skate="groove",
    roll="pivot",
    settled=1,
    fewest=40,
    work=WORK,
)
# The leapfrog's error has all powers from the second, not only even ones; with a skate from the first.
FIVE = (2, 3, 4, 6, 8)
EXTENDED = Extended(
    "extended",
    skates=Extrapolated(AIMED, "extended", levels=FIVE, powers=(1, 2, 3, 4)),
    pins=Extrapolated(SETTLED, "extended", levels=FIVE, powers=(2, 3, 4, 5)),
)
VARIANTS: tuple[Engine, ...] = (DEFAULT, TUNED, EXTENDED)
METHODS: tuple[Engine, ...] = (DEFAULT, TUNED, LEAPFROG, EXTENDED)

# A skate as users try it, by an impulse, and by pymunk's own joint.
SKATE_CENTRE = Pymunk("skate: centre's velocity zeroed", skate="centre")
SKATE_POINT = Pymunk("skate: point's velocity zeroed", skate="point")
SKATE_PROJECTED = Pymunk("skate: impulse at the blade", skate="projection")
SKATE_GROOVE = Pymunk("skate: groove, predicted heading", skate="groove")
SKATE_GROOVE_EXTRAPOLATED = Extrapolated(AIMED, "skate: groove, extrapolated", levels=FIVE, powers=(1, 2, 3, 4))
SKATES: tuple[Engine, ...] = (SKATE_CENTRE, SKATE_POINT, SKATE_PROJECTED, SKATE_GROOVE, SKATE_GROOVE_EXTRAPOLATED)

# A round body is one shape without corners, so the methods that differ in corners only are one method for it.
CORNERS = (8, 32, 128, 512)
ROLL_FACETED = tuple(
    Pymunk(f"roll: contact, {corners} corners", roll="contact", contact=Contact(1.0, 1.0, vertices=corners))
    for corners in CORNERS
)
ROLL_PIVOT = Pymunk("roll: pivot, predicted contact", 5, 0.0, leapfrog=True, roll="pivot")
