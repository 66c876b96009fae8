"""The engine as a value: its settings and what it promises, and the variants that the report shows."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# (the package is an extra, and its bindings are compiled.)

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from engines.contract import EXACT, Holder, Promise, Unpromised
from engines.extrapolated import Extrapolated
from engines.exudyn.system import Integrator, Solving, System, holds_velocities
from engines.motions import is_prescribed, over_three
from engines.single_run import Optional, SingleRun
from reference.checks import Name, Positive, validated
from reference.joints import Joint
from reference.mechanism import Mechanism

STEP_COST = 19e-6  # s, with three bodies


@dataclass(frozen=True)
class Exudyn(Optional):
    """An engine in the sense of `engines.Engine`.

    `relative` and `absolute` are the tolerances of Newton's method, 1e-8 and 1e-10 as shipped; `damping`: the spectral
    radius of GeneralizedAlpha at infinite frequency, 0.9 as shipped (1 damps nothing). `consistent`: the start's
    accelerations are given to the engine, and not computed by it. `sparse`: Newton's matrix is factored as sparse.
    `own_units`: lengths in the model are counted in the mechanism's own, and `absolute` in its own forces.
    """

    extra: ClassVar[str] = "exudyn"
    modules: ClassVar[tuple[str, ...]] = ("exudyn",)
    distributions: ClassVar[tuple[str, ...]] = ("exudyn",)
    library: ClassVar[tuple[str, str] | None] = ("libGL.so.1", "libgl1")  # its window's, which is never opened here

    variant: Name
    integrator: Integrator = "GeneralizedAlpha"
    relative: Positive = 1e-8
    absolute: Positive = 1e-10
    damping: Positive = 0.9
    consistent: bool = False
    sparse: bool = False
    own_units: bool = False

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """Second, both; what is held as an equation is exact up to Newton's tolerance. Without consistent accelerations
        at the start no reactions are told where velocities are held."""
        velocities = holds_velocities(mechanism)
        reaction = math.nan if velocities and not self.consistent else None
        if self.integrator == "TrapezoidalIndex2":
            return Promise(2, slip=EXACT, reaction=reaction)
        held = velocities or is_prescribed(mechanism)
        return Promise(2, reaction=reaction) if held else Promise(2, gap=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]: the cube of many bodies where Newton's matrix is dense."""
        size = over_three(mechanism)
        if self.sparse:
            return STEP_COST * size
        return STEP_COST * size * max(1.0, size / 5) ** 2

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Every joint is the engine's own."""
        return "engine"

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> SingleRun:
        """A system for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        self.require()
        length, force = 1.0, 1.0
        if self.own_units:
            length = 2.0 ** round(math.log2(mechanism.length_scale))
            force = max(body.mass for body in mechanism.bodies) / mechanism.time_scale**2
        solving = Solving(
            self.integrator, self.relative, self.absolute * force, self.damping, self.consistent, self.sparse
        )
        system = System(mechanism, length)
        return SingleRun(mechanism, dt, system.size, lambda samples, every: system.record(solving, dt, samples, every))


DEFAULT = Exudyn("default")
TUNED = Exudyn(
    "tuned", "TrapezoidalIndex2", relative=1e-10, absolute=1e-14, consistent=True, sparse=True, own_units=True
)
# What Newton's method leaves is the same in all levels, so that no estimate sees it: in 1e4 steps it adds up to 1e-8,
# a tenth of what is claimed. Where masses are unequal, less than this is rounding, which it can't go below.
EXTENDED = Extrapolated(replace(TUNED, relative=1e-12), "extended", levels=(1, 2, 3, 4), powers=(2, 4, 6))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
