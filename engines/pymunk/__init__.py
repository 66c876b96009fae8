"""The engine pymunk with default settings, with better settings, and with extrapolation.

A step of Chipmunk (cpSpaceStep.c) begins with a drift, which changes the positions by v dt with the old velocities v.
At the new positions a kick adds the effect of the forces to the velocities. Then the joints correct the velocities one
after the other, `iterations` times. The iterations start from the impulses of the previous step. After n steps the
velocities contain the full kick at the positions p_n. There are two ways to read the velocities.

- If `leapfrog` is False, `body.velocity` is the velocity at t_n, as users read it. The first drift uses the velocity at
  t = 0 instead of dt/2. Half a kick is missing, so errors have order 1. After a start from rest, positions have a delay
  of dt/2. Velocities have order 2, since the kick of the last step compensates the delay.
- If `leapfrog` is True, the run begins with a kick of half a step without drift. After the half kick, the engine has
  the velocity v at t_n + dt/2. The velocity at t_n is the mean of the velocities at t_n - dt/2 and t_n + dt/2. Errors
  have order 2.

The force of step n is evaluated at p_n. Therefore the change of velocity over step n divided by dt is always the
acceleration at t_n. `Mechanism.reaction` computes signed reactions from these accelerations, since `constraint.impulse`
is only a magnitude.

In a step a joint corrects the fraction 1 - error_bias ** dt of a gap. With the default error_bias the fraction is about
6.3 dt, and the remaining gap has order 1. With error_bias 0 the remaining gap has order 2.
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
    """CPU time [s] of `steps` steps of dt [s] without recording, which is a lower bound of a run's `stepping`.

    An extrapolation makes `level` times as many steps of dt / level for each level. Raises ValueError for other
    engines.
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
