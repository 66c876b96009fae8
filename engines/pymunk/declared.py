"""Declarations of pymunk: convergence orders, enforcement of joints, and the law of a step.

A step drifts before it solves, so the law uses the constraint rows at the pose after the drift. A joint corrects a
fraction of its gap. The law gives the velocities that satisfy the rows and have the smallest mass-weighted distance
from the velocities without joints. The law is valid for converged iterations, so `instants` makes enough iterations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, assert_never

import numpy as np
from numpy.typing import NDArray

from engines import EXACT, ConvergenceOrder, Enforcement, Instant, NotDeclared
from engines.constrained import constrained
from engines.motions import is_prescribed, starts_at_rest, turns_steadily
from engines.pymunk.convergence import (
    DENSE,
    UNSTABLE,
    convergence_factor,
    convergence_factor_at,
    corrects_gap,
    step_spectral_radius,
)
from engines.pymunk.iterations import CONVERGED_RESIDUAL
from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.pymunk.joints.slide import along_blade, groove_is_exact
from engines.pymunk.model import CONSTRAINT_ROWS, Model
from engines.pymunk.running import Recording, record
from reference.couplings import Coupling
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

if TYPE_CHECKING:
    from engines.pymunk.engine import Pymunk

Array = NDArray[np.float64]

LAW_ITERATION_LIMIT = 20_000

Kind = Literal[
    "contact", "set velocity", "single skate", "skate", "damper", "prescribed", "steady", "at rest", "moving"
]

# Velocities are read at the ends of steps, so all errors have order 1.
FIRST_ORDER = ConvergenceOrder(1, differences=1)
# A step corrects the whole gap, so the remaining gap is that of a single drift.
WHOLE_GAP_ORDER = ConvergenceOrder(1, gap=2, differences=1)
# The iterations solve a single row at the pose after the drift exactly, and a skate has no gap.
SINGLE_ROW = ConvergenceOrder(1, gap=2, slip=EXACT, differences=1)
# The initial half kick makes every step symmetric in time.
SYMMETRIC_ORDER = ConvergenceOrder(2, differences=1)
# Orders for steps that correct a fraction of a gap, for steps that correct the whole gap, and for a leapfrog.
ORDERS: Mapping[Kind, tuple[ConvergenceOrder, ConvergenceOrder, ConvergenceOrder]] = {
    "contact": (FIRST_ORDER, FIRST_ORDER, FIRST_ORDER),
    "set velocity": (FIRST_ORDER, FIRST_ORDER, FIRST_ORDER),
    "single skate": (SINGLE_ROW, SINGLE_ROW, SINGLE_ROW),
    # A row at the end of a step causes errors of order 1, also in a leapfrog.
    "skate": (FIRST_ORDER, WHOLE_GAP_ORDER, WHOLE_GAP_ORDER),
    "damper": (FIRST_ORDER, WHOLE_GAP_ORDER, WHOLE_GAP_ORDER),
    # No kick changes a prescribed motion, so the errors of poses are the gaps.
    "prescribed": (
        FIRST_ORDER,
        ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1, differences=1),
        SYMMETRIC_ORDER,
    ),
    # Only the pin exerts a force, and its kick is perpendicular to the path. Therefore the energy is constant.
    "steady": (FIRST_ORDER, ConvergenceOrder(2, rate=1, slip=1, reaction=1, differences=1), SYMMETRIC_ORDER),
    # Without the half kick the motion has a delay of dt/2. For velocities, the kick of the last step compensates the
    # delay.
    "at rest": (FIRST_ORDER, ConvergenceOrder(1, rate=2, gap=2, slip=1, differences=1), SYMMETRIC_ORDER),
    "moving": (FIRST_ORDER, WHOLE_GAP_ORDER, SYMMETRIC_ORDER),
}


def order(engine: Pymunk, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
    if engine.skate in ("centre", "point") and any(_is_off_centre(joint) for joint in mechanism.joints):
        return NotDeclared("setting a velocity to zero ignores that a force at the blade turns the body, at any step")
    if isinstance(engine.iterations, int) and _is_unstable(engine, mechanism, engine.iterations):
        return NotDeclared(
            f"with {engine.iterations} iterations from the impulses of the step before, impulses grow at any step"
        )
    fraction_of_gap, whole_gap, leapfrog = ORDERS[_kind(engine, mechanism)]
    if not isinstance(engine.error_bias, str) and engine.error_bias != 0:
        return fraction_of_gap
    return leapfrog if engine.leapfrog else whole_gap


def _kind(engine: Pymunk, mechanism: Mechanism) -> Kind:
    has_skate, has_roll = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
    if has_roll and engine.roll == "contact":
        return "contact"
    if has_skate and engine.skate not in ("projection", "groove"):
        return "set velocity"
    if has_skate:
        return "single skate" if len(mechanism.joints) == 1 else "skate"
    if mechanism.applied.dissipate:
        return "damper"
    if is_prescribed(mechanism):
        return "prescribed"
    if turns_steadily(mechanism):
        return "steady"
    return "at rest" if starts_at_rest(mechanism) else "moving"


def _is_unstable(engine: Pymunk, mechanism: Mechanism, iterations: int) -> bool:
    """Whether impulses grow from step to step in the limit of short steps.

    In the limit of short steps, a step corrects the whole gap (error_bias 0) or no part of the gap. The result is False
    for more than DENSE rows, for which stability is not computed.
    """
    if mechanism.row_count > DENSE:
        return False
    corrected = corrects_gap(mechanism, engine.uses_contacts) * float(engine.error_bias == 0)
    return step_spectral_radius(mechanism, mechanism.pose, iterations, corrected) > 1 + UNSTABLE


def enforcement(engine: Pymunk, joint: Joint, mechanism: Mechanism) -> Enforcement:
    """The enforcement of a joint, which is "engine, our rows" if our code places the joint before every step."""
    match joint:
        case Slot() if _is_link(joint, mechanism):
            return "engine, our rows"
        case Skate():
            return "engine, our rows" if engine.skate == "groove" else "ours"
        case Roll() if engine.roll != "contact":
            return "engine, our rows"
        case Pin() | Weld() | Gear() | Rod() | Slot() | Drive() | Roll() | Coupling():
            return "engine"
        case _:
            assert_never(joint)


def _is_off_centre(joint: Joint) -> bool:
    return isinstance(joint, Skate) and abs(along_blade(joint)) > 1e-12 * math.hypot(*joint.second_point)


def _is_link(joint: Joint, mechanism: Mechanism) -> bool:
    """Whether the construction of a slot is a `MovedPinJoint`, since a groove would be wrong."""
    if not isinstance(joint, Slot):
        return False
    cranks, turned = find_cranks(mechanism), find_turned(mechanism)
    is_known = joint.first is None or joint.first in cranks
    origin = cranks[joint.second].own_point if joint.second in cranks else (0.0, 0.0)
    point = (joint.second_point[0] - origin[0], joint.second_point[1] - origin[1])
    return not (is_known and groove_is_exact(point, turns=joint.second not in turned))


def instants(
    engine: Pymunk, mechanism: Mechanism, dt: float, steps: int, built: Mechanism
) -> tuple[Instant, ...] | NotDeclared:
    """Velocities after each of the first `steps` steps, at least one; see `engines.Engine.instants`."""
    has_skate, has_roll = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
    if (has_roll and engine.roll != "pivot") or (has_skate and engine.skate != "groove"):
        return NotDeclared("the law of a step covers joints only: no contacts, and no velocities that our code sets")
    if mechanism.applied.dissipate:
        return NotDeclared("a damper is part of the iterations, which the law of a step does not cover")
    converged = _converged(engine, mechanism, dt, max(steps, 1), built)
    if isinstance(converged, NotDeclared):
        return converged
    model, recording = converged
    out: list[Instant] = []
    for step in range(1, max(steps, 1) + 1):
        law, free = _law(model, mechanism, recording, step, dt)
        velocity = recording.after[step]
        out.append(Instant("velocity", (recording.pose[step], velocity), velocity, law, (free,)))
    return tuple(out)


def first_law(engine: Pymunk, mechanism: Mechanism, dt: float) -> Array:
    model = engine.model(mechanism, dt)
    return _law(model, mechanism, record(model, dt, 1, 1, raw=engine.leapfrog), 1, dt)[0]


def _converged(
    engine: Pymunk, mechanism: Mechanism, dt: float, steps: int, built: Mechanism
) -> tuple[Model, Recording] | NotDeclared:
    rho = convergence_factor(mechanism)
    while True:
        iterations = math.ceil(math.log(CONVERGED_RESIDUAL) / math.log(rho)) + 5 if rho > 0 else 5
        if iterations > LAW_ITERATION_LIMIT:
            return NotDeclared(f"an iteration leaves {rho:.6f} of the slowest mode, so the iterations do not converge")
        model = engine.model_with(built, dt, replace(engine.plan(built, 0.0), iterations=iterations))
        recording = record(model, dt, steps, 1, raw=engine.leapfrog)
        if not (np.isfinite(recording.pose).all() and np.isfinite(recording.after).all()):
            raise RuntimeError(f"the motion is not finite within {steps} steps {recording.stopped}".strip())
        rho = max(convergence_factor_at(mechanism, pose) for pose in recording.pose)
        if rho**iterations <= CONVERGED_RESIDUAL:
            return model, recording


def _law(model: Model, mechanism: Mechanism, recording: Recording, step: int, dt: float) -> tuple[Array, Array]:
    """The velocities (bodies, 3) after a step according to the law, and the velocities without joints."""
    # In pymunk, springs are also constraints, but their error_bias has no effect.
    joints = [constraint for constraint in model.space.constraints if type(constraint) in CONSTRAINT_ROWS]
    bias = min((constraint.error_bias for constraint in joints), default=0.0)
    corrected = corrects_gap(mechanism) * (1 - bias ** (dt / model.unit))
    pose, before = recording.pose[step], recording.before[step - 1]
    gap = np.nan_to_num(mechanism.gap(pose, step * dt))
    free = before + dt * mechanism.unconstrained(pose, before)
    rows, right = mechanism.rows(pose), mechanism.rate - corrected * gap / dt
    return constrained(rows, right, mechanism.inertias, free).motion, free
