"""The engine pymunk with its default settings, with better settings, and with extrapolation.

A step of Chipmunk (cpSpaceStep.c) begins with a drift: the positions change by v dt with the old velocities v. At the
new positions a kick adds the effect of the forces to the velocities. Then every joint corrects the velocities in turn,
`iterations` times. The iterations start from the impulses of the previous step. After n steps the velocities contain
the full kick at the positions p_n. They are read in one of two ways:

- `leapfrog` False is how users read them: `body.velocity` is the velocity at t_n. The first drift uses the velocity at
  0 and not at dt/2. Half a kick is missing, so errors are of first order. From rest, the positions are late by dt/2,
  and only the velocities are of second order, since the kick of the last step compensates the delay.
- `leapfrog` True begins with a kick of half a step without drift. The engine then has v at t_n + dt/2, and the velocity
  at t_n is the mean of the velocities half a step before and after. Errors are of second order.

The force of step n is evaluated at p_n. In both cases, the change of velocity over step n divided by dt is therefore
the acceleration at t_n. `Mechanism.reaction` computes signed reactions from it, since `constraint.impulse` is only a
magnitude.

A joint corrects the fraction 1 - error_bias ** dt of its gap in a step. With the default error_bias the fraction is
about 6.3 dt, and a gap of the order of dt remains. With error_bias 0 a gap of the order of dt ** 2 remains.
"""

from __future__ import annotations

import time
from itertools import repeat

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import SHIPPED_ERROR_BIAS, SHIPPED_ITERATIONS, Extended, Pymunk
from engines.pymunk.joints.roll import ContactSettings
from engines.pymunk.methods import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, VARIANTS
from reference.checks import Count, Positive, validated
from reference.mechanism import Mechanism


@validated
def bare_loop(engine: Engine, mechanism: Mechanism, dt: Positive, steps: Count) -> float:
    """CPU time [s] of `steps` steps of dt [s] without recording, a lower bound of the `stepping` of a run.

    An extrapolation makes `level` times as many steps of dt / level at each level. Raises ValueError for other engines.
    """
    if isinstance(engine, Extended):
        engine = engine.chosen(mechanism)
    if isinstance(engine, Extrapolated):
        inner = engine.engine
        return sum(bare_loop(inner, mechanism, dt / level, steps * level) for level in engine.levels)
    if not isinstance(engine, Pymunk):
        raise ValueError(f"bare_loop: the engine is {engine.name}; it must be pymunk")
    model = engine.model(mechanism, dt, duration=dt * steps)
    step, space = model.stepper(raw=engine.leapfrog)
    dt /= model.unit
    begin = time.process_time()
    for _ in repeat(None, steps):
        step(space, dt)
    return time.process_time() - begin


__all__ = ["DEFAULT", "EXTENDED", "LEAPFROG", "METHODS", "TUNED", "VARIANTS", "ContactSettings", "Pymunk", "bare_loop"]
__all__ += ["SHIPPED_ERROR_BIAS", "SHIPPED_ITERATIONS"]
