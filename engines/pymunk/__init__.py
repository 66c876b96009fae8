"""pymunk under test: impulses by Gauss-Seidel sweeps, as shipped, well set, started in step, and extrapolated.

What one step of Chipmunk does (cpSpaceStep): it drifts, p += v dt, with the old velocity; then, at the new positions,
it kicks, and lets every joint correct the velocities in turn, `iterations` times, beginning with the impulses of the
step before. So after n steps it holds p_n and a velocity that has felt the forces up to p_n in full. Two readings:

- As a user reads it (`leapfrog` False): `body.velocity` is the velocity at t_n. As the first drift used the velocity
  at 0, not at dt/2, the motion is half a kick off: first order. (From rest this is a delay of dt/2, which the kick in
  the last step happens to make up for in the velocities: they alone are then of second order.)
- As a leapfrog (`leapfrog` True): one kick of half a step, without drift, comes before the first step. What the engine
  then holds is v at t_n + dt/2, and the velocity at t_n is the mean of the two around it: second order.

The force of step n is evaluated at p_n, so in both readings (change of velocity over step n) / dt is an acceleration
at t_n, along the rows at p_n; `Mechanism.reaction` turns it into reactions with their signs (`constraint.impulse` is
only a magnitude). In the first reading the whole motion is of first order, hence so is this. No step lies before the
first sample: `PymunkRun` says what stands there.

A joint closes the fraction 1 - error_bias ** dt of its gap in a step. As shipped this is about 6.3 dt, so that a gap of
the order of dt remains; with error_bias 0 all of it is closed every step, and what remains is of the order of dt ** 2.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from itertools import repeat

import pymunk
from pymunk.constraints import PivotJoint

from engines import check_counts, check_step
from engines.extrapolated import Extrapolated
from engines.pymunk.model import Model, build_model
from engines.pymunk.recorder import PymunkRun
from reference.mechanism import Mechanism

_space = pymunk.Space()
_pivot = PivotJoint(_space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0))
SHIPPED_ITERATIONS = _space.iterations  # 10
SHIPPED_ERROR_BIAS = _pivot.error_bias  # 0.9 ** 60: a tenth of the gap is closed in a sixtieth of a second


@dataclass(frozen=True)
class Pymunk:
    """An engine in the sense of `engines.Engine`.

    `iterations` sweeps over the joints in a step; `error_bias` in [0, 1], the fraction of a joint's gap that is left
    after one second; `leapfrog`: start half a step ahead, read velocities in between, and step without the checks in
    `Space.step`, which never apply to a model that does not change. Raises ValueError for other values: the engine
    would abort the process.
    """

    variant: str
    iterations: int = SHIPPED_ITERATIONS
    error_bias: float = SHIPPED_ERROR_BIAS
    leapfrog: bool = False

    def __post_init__(self) -> None:
        if not (isinstance(self.iterations, int) and 1 <= self.iterations < 2**31):
            raise ValueError(f"pymunk: iterations is {self.iterations!r}; it must be a whole number from 1")
        bias = self.error_bias
        if not (isinstance(bias, int | float) and math.isfinite(bias) and 0 <= bias <= 1):
            raise ValueError(
                f"pymunk: error_bias is {bias!r}; it must be from 0 (close every gap in one step) to 1 (never)"
            )

    @property
    def name(self) -> str:
        return "pymunk"

    def build(self, mechanism: Mechanism, dt: float) -> PymunkRun:
        """A model of the mechanism at t = 0 for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        check_step(dt)
        return PymunkRun(mechanism, float(dt), self.model, self.leapfrog, self.iterations)

    def model(self, mechanism: Mechanism, iterations: int) -> Model:
        """The engine's objects for this mechanism, not yet stepped, with that many sweeps in a step."""
        return build_model(mechanism, iterations, float(self.error_bias))


DEFAULT = Pymunk("default")
# Five sweeps are enough for a small loop, and half as dear: what they leave open is closed by the next step, warm.
TUNED = Pymunk("tuned", iterations=5, error_bias=0.0)
LEAPFROG = Pymunk("leapfrog", iterations=5, error_bias=0.0, leapfrog=True)
# The leapfrog's error has all powers from the second, not only even ones.
EXTENDED = Extrapolated(LEAPFROG, "extended", levels=(2, 3, 4, 6, 8), powers=(2, 3, 4, 5))
METHODS = (DEFAULT, TUNED, LEAPFROG, EXTENDED)


def bare_loop(engine: Pymunk | Extrapolated, mechanism: Mechanism, dt: float, steps: int) -> float:
    """CPU seconds of `steps` steps of dt [s] with nothing recorded: the floor under the stepping of a run.

    An extrapolated engine counts as it runs: `level` times as many steps, of dt / level, for each of its levels.
    """
    if isinstance(engine, Extrapolated):
        if not isinstance(engine.engine, Pymunk):
            raise ValueError(f"bare_loop: the extrapolated engine is {engine.engine.name}; it must be pymunk")
        return sum(bare_loop(engine.engine, mechanism, dt / level, steps * level) for level in engine.levels)
    check_step(dt)
    check_counts(steps, 1)
    step, space = engine.model(mechanism, engine.iterations).stepper(raw=engine.leapfrog)
    begin = time.process_time()
    for _ in repeat(None, steps):
        step(space, dt)
    return time.process_time() - begin


__all__ = ["DEFAULT", "EXTENDED", "LEAPFROG", "METHODS", "TUNED", "Pymunk", "bare_loop"]
