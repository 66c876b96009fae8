"""The engine as a value: its settings and what it promises, and the variants that the report shows."""

# pyright: reportMissingImports=false, reportAttributeAccessIssue=false
# (the package is an extra, and its bindings are compiled.)

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from engines.contract import EXACT, Holder, Promise, Unpromised
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.pinocchio.model import Integrator, Model
from engines.single_run import Optional, SingleRun, refuse_all_but
from engines.tree import refuse_slots_in_loops, spanning_tree
from reference.checks import Name, NonNegative, Positive, validated
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

EVALUATION_COST = 6e-6  # s, with three bodies
FORCES_COST = 250e-6  # s, of force elements, which are worked out by numpy
LACKS = {
    Rod: "pinocchio holds points and frames together, and no distance between points",
    Gear: "pinocchio's dynamics with loops has no coordinates that follow others by a ratio",
    Skate: "pinocchio holds accelerations of whole points, and no velocity across a blade",
    Roll: "pinocchio has no rolling contact between curves",
}


@dataclass(frozen=True)
class Pinocchio(Optional):
    """An engine in the sense of `engines.Engine`.

    `integrator`: "euler" (semi-implicit, order 1) or "rk4" (order 4); `correction` of loops [1/s], see above.
    """

    extra: ClassVar[str] = "pinocchio"
    modules: ClassVar[tuple[str, ...]] = ("pinocchio",)
    distributions: ClassVar[tuple[str, ...]] = ("pin",)
    forces_by: ClassVar[Holder] = "ours"

    variant: Name
    integrator: Integrator = "euler"
    correction: NonNegative = 0.0

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """The integrator's; what the tree holds is exact."""
        tree = spanning_tree(mechanism)
        order = 4 if self.integrator == "rk4" else 1
        if tree.loops:
            return Promise(order)
        if turns_steadily(mechanism) or is_prescribed(mechanism):
            return Promise(EXACT)
        return Promise(order, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]: its evaluations, and one more for each drive."""
        drives = sum(isinstance(joint, Drive) for joint in mechanism.joints)
        stages = 4 if self.integrator == "rk4" else 1
        evaluation = EVALUATION_COST * (1 + drives) * over_three(mechanism)
        return stages * (evaluation + (FORCES_COST if mechanism.forces else 0.0))

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Joints are the engine's; the torque of a drive is worked out by our code."""
        return "ours" if isinstance(joint, Drive) and joint not in spanning_tree(mechanism).kept else "engine"

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> SingleRun:
        """A model for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        refuse_all_but(mechanism, "pinocchio", (Pin, Slot, Drive, Weld), LACKS)
        tree = spanning_tree(mechanism)
        refuse_slots_in_loops(tree, "pinocchio")
        self.require()
        model = Model(mechanism, tree, self.correction)
        return SingleRun(
            mechanism, dt, model.size, lambda samples, every: model.record(self.integrator, dt, samples, every)
        )


DEFAULT = Pinocchio("default")
TUNED = Pinocchio("tuned", "rk4")
VARIANTS = (DEFAULT, TUNED)
