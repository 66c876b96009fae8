"""pymunk: impulses by Gauss-Seidel iterations, as shipped, well set, and extrapolated.

All methods are in `engines.pymunk.methods`, the constructions of each joint in `engines.pymunk.joints`.

A step of Chipmunk (its cpSpaceStep.c) first drifts, p += v dt, with the old velocity. Then, at the new positions, it
adds the forces to the velocities (kick), and every joint corrects the velocities in turn, `iterations` times, starting
from the impulses of the step before. After n steps it has the positions p_n, and velocities that include the forces at
p_n in full. They can be read in two ways:

- As a user reads them (`leapfrog` False): `body.velocity` is the velocity at t_n. As the first drift used the velocity
  at 0 and not at dt/2, half a kick is missing: first order. (From rest this is a delay of dt/2, which the kick of the
  last step compensates in the velocities: they alone are of second order.)
- As a leapfrog (`leapfrog` True): a kick of half a step, without drift, comes before the first step. The engine then
  has v at t_n + dt/2, and the velocity at t_n is the mean of the two around it: second order.

The force of step n is evaluated at p_n, so in both readings (change of velocity over step n) / dt is the acceleration
at t_n, with the rows at p_n. `Mechanism.reaction` computes signed reactions from it (`constraint.impulse` is only a
magnitude). For the first sample see `PymunkRun`.

A joint corrects the fraction 1 - error_bias ** dt of its gap in a step. As shipped this is about 6.3 dt, so a gap of
the order of dt remains. With error_bias 0 the whole gap is corrected in every step, and dt ** 2 remains. The iterations
that this needs, and its limit of stability, are in `engines.pymunk.convergence`.
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
    """CPU seconds of `steps` steps of dt [s] without recording: the lower bound of a run's `stepping`.

    For each `level` of an extrapolation, `level` times as many steps of dt / level. Raises ValueError for an engine
    that is not pymunk.
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


__all__ = [
    "DEFAULT",
    "EXTENDED",
    "LEAPFROG",
    "METHODS",
    "SHIPPED_ERROR_BIAS",
    "SHIPPED_ITERATIONS",
    "TUNED",
    "VARIANTS",
    "ContactSettings",
    "Extended",
    "Pymunk",
    "bare_loop",
]
