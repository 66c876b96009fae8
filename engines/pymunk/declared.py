"""What pymunk declares of a mechanism: the orders of its impulses, who enforces each joint, and the law of a step.

The law is asked beside the velocities that it gives after a step: they are the nearest that the joints allow.

The engine moves before it solves, so the rows are those of the pose after the step's drift; and a joint closes a part
of its gap in a step, so that its points move towards each other. Sweeps are let converge: this is about what the joints
are, not about how many sweeps a user takes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from engines import EXACT, ConvergenceOrder, Enforcement, Instant, NotDeclared
from engines.constrained import constrained
from engines.motions import is_prescribed, starts_at_rest, turns_steadily
from engines.pymunk.contraction import DENSE, GROWING, closing, contraction, contraction_at, growth
from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.pymunk.joints.slide import REACH, along_blade, groove_is_exact
from engines.pymunk.model import ROWS, Model
from engines.pymunk.running import Recording, record
from reference.forces import Damper, TorsionDamper
from reference.joints import Drive, Joint, Skate, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.rolling.roll import Roll

if TYPE_CHECKING:
    from engines.pymunk.engine import Pymunk

Array = NDArray[np.float64]

PUSHED = "as its groove pushes"  # the check of the law that a groove joint obeys instead
CONVERGED = 1e-16  # of the slowest mode, after the sweeps of one step
MOST_SWEEPS = 20_000


def instants(
    engine: Pymunk, mechanism: Mechanism, dt: float, steps: int, built: Mechanism
) -> tuple[Instant, ...] | NotDeclared:
    """Velocities after each of the first `steps` steps, one at least; see `engines.Engine.instants`."""
    rolling, skating = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Roll, Skate))
    if (rolling and engine.roll != "pivot") or (skating and engine.skate != "groove"):
        return NotDeclared("contacts, and blades that are no joint, obey no law of a step")
    if any(isinstance(force, Damper | TorsionDamper) for force in mechanism.forces):
        return NotDeclared("a damper takes part in the sweeps, and obeys no law of a step")
    converged = _converged(engine, mechanism, dt, max(steps, 1), built)
    if isinstance(converged, NotDeclared):
        return converged
    model, told = converged
    out: list[Instant] = []
    for step in range(1, max(steps, 1) + 1):
        for check in ("velocity", PUSHED) if engine.slot == "groove" else ("velocity",):
            law, free = _law(model, mechanism, told, step, dt, grooves=check == PUSHED)
            out.append(Instant(check, (told.pose[step], told.after[step]), told.after[step], law, (free,)))
    return tuple(out)


def first_law(engine: Pymunk, mechanism: Mechanism, dt: float) -> Array:
    """Velocities (bodies, 3) after the first step, as the joints ask for."""
    model = engine.model(mechanism, dt)
    return _law(model, mechanism, record(model, dt, 1, 1, raw=engine.leapfrog), 1, dt)[0]


def _converged(
    engine: Pymunk, mechanism: Mechanism, dt: float, steps: int, built: Mechanism
) -> tuple[Model, Recording] | NotDeclared:
    """The first steps, with as many sweeps as the worst of their poses needs: it may be far from that of the start."""
    rho = contraction(mechanism)
    while True:
        sweeps = math.ceil(math.log(CONVERGED) / math.log(rho)) + 5 if rho > 0 else 5
        if sweeps > MOST_SWEEPS:
            return NotDeclared(f"sweeps leave {rho:.6f} of the slowest mode each, so that they don't converge")
        if engine.slot == "groove":  # the contraction is of rows that push as they see
            sweeps = MOST_SWEEPS
        model = engine.swept_model(built, dt, replace(engine.sweeping(built, 0.0), iterations=sweeps))
        told = record(model, dt, steps, 1, raw=engine.leapfrog)
        if engine.slot == "groove" and not np.abs(told.pose[..., :2]).max() < REACH * mechanism.length_scale:
            return NotDeclared("the known defect of GrooveJoint drove the motion beyond the groove's ends")
        if not (np.isfinite(told.pose).all() and np.isfinite(told.after).all()):
            raise RuntimeError(f"the motion was lost within {steps} steps {told.stopped}".strip())
        rho = max(contraction_at(mechanism, pose) for pose in told.pose)
        if rho**sweeps <= CONVERGED:
            return model, told


def _law(
    model: Model, mechanism: Mechanism, told: Recording, step: int, dt: float, grooves: bool = False
) -> tuple[Array, Array]:
    """Velocities (bodies, 3) after a step: those that the joints allow, and those without joints.

    `grooves`: with slots as Chipmunk's groove joints push (the page of faults). They solve both directions at the
    anchor and keep the part along the normal n: with K the inverse mass there, what becomes zero is n^T K^-1 times the
    anchors' velocity.
    """
    closed = np.zeros(mechanism.row_count)
    closing = [not isinstance(joint, Skate | Drive) for joint in mechanism.joints for _ in range(joint.size)]
    # A blade, which has no gap, closes none; a spring has an error_bias that it makes no use of.
    joints = [constraint for constraint in model.space.constraints if type(constraint) in ROWS]
    bias = min((constraint.error_bias for constraint in joints), default=0.0)
    closed[np.array(closing, dtype=bool)] = 1 - bias ** (dt / model.unit)
    pose = told.pose[step]
    gap = np.nan_to_num(mechanism.gap(pose, step * dt))
    free = told.before[step - 1] + dt * mechanism.unconstrained(pose, told.before[step - 1])
    rows, right = mechanism.rows(pose), mechanism.rate - closed * gap / dt
    if not grooves:
        return constrained(rows, right, mechanism.inertias, free).motion, free
    light = 1 / mechanism.inertias.reshape(-1)
    ended = _as_grooves_see(mechanism, pose, gap, light)
    impulse = np.linalg.solve((ended * light) @ rows.T, right - ended @ free.reshape(-1))
    return free + (light * (rows.T @ impulse)).reshape(-1, 3), free


def _as_grooves_see(mechanism: Mechanism, pose: Array, gap: Array, light: Array) -> Array:
    """The rows (rows, 3 bodies) of velocities that end at their values: a groove's are n^T K^-1 J / n^T K^-1 n.

    J (2, 3 bodies) is the second body's point against that of the first's material which lies in the groove's middle
    line beside it.
    """
    out, row = mechanism.rows(pose), 0
    for joint in mechanism.joints:
        if isinstance(joint, Slot):
            first, second = (
                pose[mechanism.body_index(name)] if name else np.zeros(3) for name in (joint.first, joint.second)
            )
            line = first[2] + joint.line_angle
            across = np.array([-math.sin(line), math.cos(line)])
            place = second[:2] + rotated(second[2], np.array(joint.second_point))
            beside = place - gap[row] * across
            both = np.zeros((2, out.shape[1]))
            for name, body, at, sign in ((joint.first, first, beside, -1.0), (joint.second, second, place, 1.0)):
                if name:
                    x, y = at - body[:2]
                    begin = 3 * mechanism.body_index(name)
                    both[:, begin : begin + 3] = sign * np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
            weighed = np.linalg.solve((both * light) @ both.T, across)
            out[row] = weighed @ both / (weighed @ across)
        row += joint.size
    return out


# Velocities read at the ends of steps: everything is of first order.
STEPPED = ConvergenceOrder(1, differences=1)
# A step closes the whole gap, so that only the gap of one drift remains: second order.
CLOSING = ConvergenceOrder(1, gap=2, differences=1)
# One row, at the pose after the drift, solved exactly: no slip remains, and it has no gap.
HELD = ConvergenceOrder(1, gap=2, slip=EXACT, differences=1)
# From rest the missing half kick is a delay, which the last step's kick compensates in the velocities.
FROM_REST = ConvergenceOrder(1, rate=2, gap=2, slip=1, differences=1)
# A prescribed motion needs no kick: the error of a pose is its gap.
PRESCRIBED = ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1, differences=1)
# Only the pin acts on a body that turns steadily: its kick is perpendicular to the path and keeps the energy.
STEADY = ConvergenceOrder(2, rate=1, slip=1, reaction=1, differences=1)
# Half a kick ahead: every step is symmetric in time.
LEAPFROG = ConvergenceOrder(2, differences=1)


def promise(engine: Pymunk, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
    """The orders; NotDeclared for joint constructions whose error does not vanish with the step."""
    skating, rolling = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
    if engine.slot == "groove" and any(_is_rewritten(joint, mechanism) for joint in mechanism.joints):
        return NotDeclared(
            "a groove off the centre of mass of a body that turns settles at a wrong impulse, at any step"
        )
    if engine.skate in ("centre", "point") and any(_is_off_centre(joint) for joint in mechanism.joints):
        return NotDeclared(
            "a velocity that is zeroed without the turning of a force at the blade is another body's, at any step"
        )
    if isinstance(engine.iterations, int) and _grows(engine, mechanism, engine.iterations):
        return NotDeclared(
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
    closes = closing(mechanism, engine.uses_contacts) * float(engine.error_bias == 0)
    return growth(mechanism, mechanism.pose, iterations, closes) > 1 + GROWING


def enforcement(engine: Pymunk, joint: Joint, mechanism: Mechanism) -> Enforcement:
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
