"""pymunk under test: impulses by Gauss-Seidel sweeps, as shipped, well set, started in step, and extrapolated.

All methods are in `engines.pymunk.methods`, the constructions of each joint in `engines.pymunk.joints`.

What one step of Chipmunk does (its cpSpaceStep.c): it drifts, p += v dt, with the old velocity; then, at the new
positions, it kicks, and lets every joint correct the velocities in turn, `iterations` times, beginning with the
impulses of the step before. So after n steps it holds p_n and a velocity that has felt the forces up to p_n in full.
Two readings:

- As a user reads it (`leapfrog` False): `body.velocity` is the velocity at t_n. As the first drift used the velocity
  at 0, not at dt/2, the motion is half a kick off: first order. (From rest this is a delay of dt/2, which the kick in
  the last step makes up for in the velocities: they alone are then of second order.)
- As a leapfrog (`leapfrog` True): one kick of half a step, without drift, comes before the first step. The engine then
  holds v at t_n + dt/2, and the velocity at t_n is the mean of the two around it: second order.

The force of step n is evaluated at p_n, so in both readings (change of velocity over step n) / dt is an acceleration
at t_n, along the rows at p_n; `Mechanism.reaction` turns it into reactions with their signs (`constraint.impulse` is
only a magnitude). No step lies before the first sample: see `PymunkRun`.

A joint closes the fraction 1 - error_bias ** dt of its gap in a step. As shipped this is about 6.3 dt, so that a gap of
the order of dt remains; with error_bias 0 all of it is closed every step, and what remains is of the order of dt ** 2.
How many sweeps that takes, and when it may not be done, is in `engines.pymunk.contraction`.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from importlib import import_module
from itertools import repeat
from typing import Any

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import SHIPPED_ERROR_BIAS, SHIPPED_ITERATIONS, Extended, Pymunk
from engines.pymunk.joints.roll import Contact
from engines.pymunk.methods import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, VARIANTS
from reference.checks import Count, Positive, validated
from reference.mechanism import Mechanism


@validated
def bare_loop(engine: Engine, mechanism: Mechanism, dt: Positive, steps: Count) -> float:
    """CPU seconds of `steps` steps of dt [s] with nothing recorded: the floor under the stepping of a run.

    An extrapolated engine counts as it runs: `level` times as many steps, of dt / level, for each of its levels. Raises
    ValueError for an engine that is not pymunk.
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


def read(space: Any, step: float | None = None, without: Sequence[str] = ()) -> Any:
    """A pymunk.Space as a mechanism: see `engines.pymunk.reading.read`."""
    # By its name: what only reads a user's models is no part of what an engine's rows depend on.
    return import_module("engines.pymunk.reading").read(space, step, without)


__all__ = [
    "DEFAULT",
    "EXTENDED",
    "LEAPFROG",
    "METHODS",
    "SHIPPED_ERROR_BIAS",
    "SHIPPED_ITERATIONS",
    "TUNED",
    "VARIANTS",
    "Contact",
    "Extended",
    "Pymunk",
    "bare_loop",
    "read",
]
