"""The convergence orders of pymunk's impulses, and who enforces its joints, by settings and mechanism alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from engines import EXACT, Holder, Promise, Unpromised
from engines.motions import is_prescribed, starts_at_rest, turns_steadily
from engines.pymunk.contraction import DENSE, GROWING, closing, growth
from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.pymunk.joints.skate import along_blade
from engines.pymunk.joints.slot import groove_is_exact
from reference.joints import Joint, Roll, Skate, Slot
from reference.mechanism import Mechanism

if TYPE_CHECKING:
    from engines.pymunk.engine import Pymunk

# Velocities read at the ends of steps: everything is of first order.
STEPPED = Promise(1, differences=1)
# A step closes the whole gap, so that only the gap of one drift remains: second order.
CLOSING = Promise(1, gap=2, differences=1)
# One row, at the pose after the drift, solved exactly: no slip remains, and it has no gap.
HELD = Promise(1, gap=2, slip=EXACT, differences=1)
# From rest the missing half kick is a delay, which the last step's kick compensates in the velocities.
FROM_REST = Promise(1, rate=2, gap=2, slip=1, differences=1)
# A prescribed motion needs no kick: the error of a pose is its gap.
PRESCRIBED = Promise(2, rate=1, slip=1, energy=1, reaction=1, differences=1)
# Only the pin acts on a body that turns steadily: its kick is perpendicular to the path and keeps the energy.
STEADY = Promise(2, rate=1, slip=1, reaction=1, differences=1)
# Half a kick ahead: every step is symmetric in time.
LEAPFROG = Promise(2, differences=1)


def promise(engine: Pymunk, mechanism: Mechanism) -> Promise | Unpromised:
    """The orders; Unpromised for joint constructions whose error does not vanish with the step."""
    skating, rolling = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
    if engine.slot == "groove" and any(_is_rewritten(joint, mechanism) for joint in mechanism.joints):
        return Unpromised(
            "a groove off the centre of mass of a body that turns settles at a wrong impulse, at any step"
        )
    if engine.skate in ("centre", "point") and any(_is_off_centre(joint) for joint in mechanism.joints):
        return Unpromised(
            "a velocity that is zeroed without the turning of a force at the blade is another body's, at any step"
        )
    if isinstance(engine.iterations, int) and _grows(engine, mechanism, engine.iterations):
        return Unpromised(
            f"{engine.iterations} sweeps that begin with the impulses of the step before let these grow, at any step"
        )
    closing = isinstance(engine.error_bias, str) or engine.error_bias == 0
    if rolling and engine.roll == "contact":
        return STEPPED
    if skating:
        # A row of the end of a step makes a method of first order, from half a kick ahead too.
        if engine.skate not in ("projection", "groove"):
            return STEPPED
        if len(mechanism.joints) == 1:
            return HELD
        return CLOSING if closing else STEPPED
    if not closing:
        return STEPPED
    if mechanism.applied.dissipate:
        return CLOSING
    if engine.leapfrog:
        return LEAPFROG
    if is_prescribed(mechanism):
        return PRESCRIBED
    if turns_steadily(mechanism):
        return STEADY
    return FROM_REST if starts_at_rest(mechanism) else CLOSING


def _grows(engine: Pymunk, mechanism: Mechanism, iterations: int) -> bool:
    """Whether kept impulses grow from step to step at any step; False for more than DENSE rows.

    A short step closes either the whole gap or nearly nothing of it.
    """
    if mechanism.row_count > DENSE:
        return False
    closes = closing(mechanism, engine.touches) * float(engine.error_bias == 0)
    return growth(mechanism, mechanism.pose, iterations, closes) > 1 + GROWING


def holder(engine: Pymunk, joint: Joint, mechanism: Mechanism) -> Holder:
    """Pivots, grooves, motors, prescribed bodies and contacts are pymunk's; joints placed in every step are shared."""
    match joint:
        case Slot() if engine.slot == "exact" and _is_rewritten(joint, mechanism):
            return "engine, our rows"
        case Skate() if engine.skate in ("centre", "point", "projection"):
            return "ours"
        case Skate() if engine.skate == "groove":
            return "engine, our rows"
        case Roll() if engine.roll != "contact":
            return "engine, our rows"
    return "engine"


def _is_off_centre(joint: Joint) -> bool:
    """Whether a force at a skate's blade turns its body, by more than rounding."""
    return isinstance(joint, Skate) and abs(along_blade(joint)) > 1e-12 * math.hypot(*joint.second_point)


def _is_rewritten(joint: Joint, mechanism: Mechanism) -> bool:
    """Whether a slot's exact row is a link that is aimed before every step, because no groove would be exact."""
    if not isinstance(joint, Slot):
        return False
    cranks, turned = find_cranks(mechanism), find_turned(mechanism)
    known = joint.first is None or joint.first in cranks
    origin = cranks[joint.second].own_point if joint.second in cranks else (0.0, 0.0)
    point = (joint.second_point[0] - origin[0], joint.second_point[1] - origin[1])
    return not (known and groove_is_exact(point, turns=joint.second not in turned))
