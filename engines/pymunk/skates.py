"""A skate in pymunk by every construction that people use, as methods for a page: see `engines.pymunk.blades`."""

from __future__ import annotations

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Pymunk
from engines.pymunk.extended import AIMED, EVEN, EVEN_POWERS, FIVE
from engines.pymunk.reflection import Reflected

CENTRE = Pymunk("skate: centre's velocity zeroed", skate="centre")
POINT = Pymunk("skate: point's velocity zeroed", skate="point")
PROJECTED = Pymunk("skate: impulse at the blade", skate="projection")
STALE_GROOVE = Pymunk("skate: groove, stale heading", skate="stale groove")
GROOVE = Pymunk("skate: groove, predicted heading", skate="groove")
REFLECTED = Reflected("skate: reflection")
FRICTION = Pymunk("skate: friction", skate="friction")
GROOVE_EXTRAPOLATED = Extrapolated(AIMED, "skate: groove, extrapolated", levels=FIVE, powers=(1, 2, 3, 4))
REFLECTED_EXTRAPOLATED = Extrapolated(REFLECTED, "skate: reflection, extrapolated", levels=EVEN, powers=EVEN_POWERS)
METHODS: tuple[Engine, ...] = (
    CENTRE,
    POINT,
    PROJECTED,
    STALE_GROOVE,
    GROOVE,
    REFLECTED,
    FRICTION,
    GROOVE_EXTRAPOLATED,
    REFLECTED_EXTRAPOLATED,
)
