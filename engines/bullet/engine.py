"""The engine as a value: its settings, what it promises and refuses, and the variants that the report shows."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# (the package is an extra, and its bindings are compiled.)

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from engines.bullet.world import World, geared_columns
from engines.contract import EXACT, Holder, Promise, Unpromised, Unsupported
from engines.extrapolated import Extrapolated
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.single_run import Optional, SingleRun, refuse_all_but
from engines.tree import Tree, refuse_slots_in_loops, spanning_tree
from reference.checks import Count, Fraction, Name, Positive, validated
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

STEP_COST = 9e-6  # s of a step of three bodies, as shipped
FORCES_COST = 250e-6  # s, of force elements, which are worked out by numpy
ITERATION_COST = 0.1e-6  # s, of an iteration for each row of a loop
SHIPPED_ITERATIONS, SHIPPED_ERP = 50, 0.2
LACKS = {
    Rod: "bullet's trees have no constraint of a distance",
    Skate: "bullet stops slip by friction at a contact alone, and has no joint for it",
    Roll: "in bullet a disc rolls by contact and friction, there is no joint for it",
}


@dataclass(frozen=True)
class Bullet(Optional):
    """An engine in the sense of `engines.Engine`.

    `iterations` of the solver over its rows, which end early below `residual`; `erp`: the share of a gap that a step
    closes.
    """

    extra: ClassVar[str] = "bullet"
    modules: ClassVar[tuple[str, ...]] = ("pybullet",)
    distributions: ClassVar[tuple[str, ...]] = ("pybullet",)
    forces_by: ClassVar[Holder] = "ours"

    variant: Name
    iterations: Count = SHIPPED_ITERATIONS
    residual: Fraction = 1e-7
    erp: Fraction = SHIPPED_ERP

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """First, of semi-implicit Euler; what the tree holds is exact."""
        if spanning_tree(mechanism).loops or any(isinstance(joint, Gear) for joint in mechanism.joints):
            return Promise(1, differences=1)
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return Promise(EXACT, reaction=1, differences=1)
        return Promise(1, gap=EXACT, slip=EXACT, differences=1)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]."""
        rows = 3 * len(spanning_tree(mechanism).loops)
        forces = FORCES_COST if mechanism.forces else 0.0
        return STEP_COST * over_three(mechanism) + ITERATION_COST * self.iterations * rows + forces

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Every joint is the engine's own."""
        return "engine"

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> SingleRun:
        """A model for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        refuse_all_but(mechanism, "bullet", (Pin, Slot, Drive, Weld, Gear), LACKS)
        tree = spanning_tree(mechanism)
        drives = _refused(mechanism, tree)
        self.require()
        parameters = {"numSolverIterations": self.iterations, "solverResidualThreshold": self.residual, "erp": self.erp}
        world = World(mechanism, tree, drives, dt, parameters)
        return SingleRun(mechanism, dt, world.size, lambda samples, every: world.record(dt, samples, every))


def _refused(mechanism: Mechanism, tree: Tree) -> dict[int, float]:
    """Tree coordinates that a motor turns, and their rates [rad/s]; raises Unsupported."""
    refuse_slots_in_loops(tree, "bullet")
    for link in tree.links:
        if len(link.columns) > 1:
            raise Unsupported(
                f"body {mechanism.bodies[link.body].name!r}: bullet's tree has no link without a mass, "
                "which a body that slides and turns, or hangs on nothing, would need"
            )
    rates: dict[int, float] = {}
    for joint in mechanism.joints:
        if isinstance(joint, Drive) and joint not in tree.kept:
            turned = tree.turning(joint.first, joint.second)
            if len(turned) != 1 or next(iter(turned)) in rates:
                raise Unsupported(f"drive {joint.name!r}: a motor of bullet turns one joint, and has one rate")
            ((column, sign),) = turned.items()
            rates[column] = sign * joint.turning_rate
        if isinstance(joint, Gear):
            geared_columns(tree, joint)
    return rates


DEFAULT = Bullet("default")
TUNED = Bullet("tuned", iterations=200, residual=0.0, erp=1.0)
# All of a gap is closed in every step: with less, what a few steps leave behind is no series in the step.
EXTENDED = Extrapolated(TUNED, "extended", levels=(1, 2, 3, 4), powers=(1, 2, 3))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
