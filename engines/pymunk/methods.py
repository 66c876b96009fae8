"""The methods of pymunk. METHODS are for all scenes, and the other methods compare constructions of a joint."""

from __future__ import annotations

from dataclasses import replace

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Extended, Pymunk
from engines.pymunk.joints.roll import ContactSettings

DEFAULT = Pymunk("default")
# With bias 1 the engine corrects no overlap, because a correction would also roll the bodies. `slop` then has no
# effect.
UNCORRECTED_OVERLAP = ContactSettings(slop=1.0, bias=1.0, vertices=512)
TUNED = Pymunk("tuned", "contraction", "contraction", skate="groove", contact=UNCORRECTED_OVERLAP)
LEAPFROG = Pymunk("leapfrog", "contraction", "contraction", leapfrog=True, skate="groove", roll="pivot")
# Extrapolation needs a stable method, and an error that is smooth in the step from the first sample on. For a few
# mechanisms with nearly dependent rows, 300 iterations converge too little. This limit permits more iterations, which
# take about 2 ms.
LARGEST_WORK = 200_000
STARTED = replace(LEAPFROG, startup_steps=1, max_work=LARGEST_WORK)
# In a loop with skates and hinges, fewer iterations have a residual above the error of the step. Forty iterations take
# as long as the placing of one groove.
WITH_GROOVES = replace(STARTED, variant="aimed", leapfrog=False, min_iterations=40)
# The error of the leapfrog contains all powers of the step from 2 on. With a skate the error contains all powers from 1
# on.
FIVE_LEVELS = (2, 3, 4, 6, 8)
EXTENDED = Extended(
    "extended",
    skates=Extrapolated(WITH_GROOVES, "extended", levels=FIVE_LEVELS, powers=(1, 2, 3, 4)),
    pins=Extrapolated(STARTED, "extended", levels=FIVE_LEVELS, powers=(2, 3, 4, 5)),
)
VARIANTS: tuple[Engine, ...] = (DEFAULT, TUNED, EXTENDED)
METHODS: tuple[Engine, ...] = (DEFAULT, TUNED, LEAPFROG, EXTENDED)

SKATE_CENTRE = Pymunk("skate: centre's velocity zeroed", skate="centre")
SKATE_POINT = Pymunk("skate: point's velocity zeroed", skate="point")
SKATE_PROJECTED = Pymunk("skate: impulse at the blade", skate="projection")
SKATE_GROOVE = Pymunk("skate: groove, predicted heading", skate="groove")
SKATE_GROOVE_EXTRAPOLATED = replace(EXTENDED.skates, variant="skate: groove, extrapolated")
SKATE_METHODS = (SKATE_CENTRE, SKATE_POINT, SKATE_PROJECTED, SKATE_GROOVE, SKATE_GROOVE_EXTRAPOLATED)

ROLL_POLYGON = Pymunk("roll: contact, 512 corners", contact=UNCORRECTED_OVERLAP)
ROLL_PIVOT = Pymunk("roll: pivot, predicted contact", 5, 0.0, leapfrog=True, roll="pivot")
