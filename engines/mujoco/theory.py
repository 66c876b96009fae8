"""What theory promises of MuJoCo's joints and rows, and which are its own: by settings and mechanism alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from engines import EXACT, Holder, Promise, Unpromised
from engines.motions import is_prescribed, turns_steadily
from engines.mujoco.joints.roll import RollContact, RollEquality
from engines.mujoco.joints.skate import STEPWISE
from engines.mujoco.joints.slot import resting_line
from engines.mujoco.stiffness import TiedToStep
from engines.tree import Tree
from reference.joints import Drive, Joint, Rod, Roll, Skate, Slot
from reference.mechanism import Mechanism

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

# A loop closed by a spring of some steps: its gap falls as the square of the step, whatever integrates it.
SPRUNG = Promise(1, gap=2)
# The same in a motion that is prescribed, where a pose is wrong by its gap alone.
SPRUNG_PRESCRIBED = Promise(2, rate=1, slip=1, energy=1, reaction=1)

ORDER = 4  # of RK4, and so of every run with an estimate


def promise(engine: MuJoCo, mechanism: Mechanism, tree: Tree) -> Promise | Unpromised:
    """The integrator's order, unless the rows of skates, contacts or loops know less than it asks for."""
    skating, rolling = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
    driven = any(isinstance(joint, Drive) and joint not in tree.kept for joint in mechanism.joints)
    if driven and engine.drive != "inertia":
        return Unpromised(
            "a servo's gain misses the rate at any step"
            if engine.drive == "servo"
            else "a state that is overwritten between steps obeys no equation of which an order is known"
        )
    looped = tree.closed
    order = 4 if engine.integrator == "RK4" else 1
    # A contact's row knows the velocity and not how it changes: first order at best, whatever integrates it.
    if rolling and isinstance(engine.rolls, RollContact):
        return Promise(1)
    if rolling and isinstance(engine.rolls, RollEquality):
        return Promise(1, gap=2)
    gap = None if looped or rolling else EXACT
    if skating and engine.skates == "leapfrog":
        # Symmetric in time, and read without the slip that its reflections leave.
        return Promise(2, gap=gap, slip=EXACT, energy=4, differences=1)
    if skating and engine.skates not in ("rows", "passive"):
        # A row that is held at the ends of steps; one at the pose that the velocity leads to has less slip.
        return Promise(1, gap=gap, slip=2 if engine.skates == "predicted tendon" else None)
    if looped and isinstance(engine.stiffness, TiedToStep):
        if order > 1:
            return Promise(2, rate=1, slip=1, energy=1, reaction=1, integrator=order)
        return SPRUNG_PRESCRIBED if is_prescribed(mechanism) else SPRUNG
    if looped or rolling:
        return Promise(order)
    if skating:
        return Promise(order, gap=gap)
    if turns_steadily(mechanism):
        return Promise(EXACT)  # its coordinates turn at a constant rate, which any integrator adds up
    return Promise(order, gap=EXACT, slip=EXACT)


def holder(engine: MuJoCo, joint: Joint, tree: Tree) -> Holder:
    """Coordinates of the tree, connects, fixed tendons, contacts and servos are MuJoCo's; rows that callbacks or hooks
    write are shared; a force or a state that is worked out beside MuJoCo is ours.
    """
    match joint:
        case Drive() if joint not in tree.kept and engine.drive == "overwrite":
            return "ours"
        case Slot() if tree.closes_by(joint) and engine.slots == "rows" and resting_line(joint, tree) is None:
            return "engine, our rows"
        case Rod() if engine.rods == "rows":
            return "engine, our rows"
        case Skate() if engine.skates in ("force", "passive"):
            return "ours"
        case Skate() if engine.skates == "rows" or engine.skates in STEPWISE:
            return "engine, our rows"
        case Roll() if not isinstance(engine.rolls, RollContact):
            return "engine, our rows"
    return "engine"
