"""pymunk's velocities after a step against the law of its impulses: the nearest ones that the joints allow.

The engine moves before it solves, so the rows are those of the pose after the step's drift; and a joint closes a part
of its gap in a step, so that its points move towards each other. Sweeps are let converge: this is about what the joints
are, not about how many sweeps a user takes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from engines.pymunk import Pymunk
from engines.pymunk.contraction import contraction, contraction_at
from engines.pymunk.joints.slot import REACH
from engines.pymunk.model import ROWS, Model
from engines.pymunk.running import Recording, record
from reference.forces import Damper, TorsionDamper
from reference.joints import Drive, Roll, Skate, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reports.search.law import ROUNDINGS, Constrained, Fault, NotAsked, carried, constrained, difference, written

Array = NDArray[np.float64]

STEP = 0.01  # of the mechanism's own time scale
STEPS = 4
LAW = 1e-9
PUSHED = "as its groove pushes"  # the check of the law that a groove joint obeys instead
CONVERGED = 1e-16  # of the slowest mode, after the sweeps of one step: far below LAW, whatever the mode's own size
MOST_SWEEPS = 20_000


def bound(engine: Pymunk) -> float:
    """The error, relative to the largest velocity, above which something is wrong; rounding makes a thousandth."""
    return LAW


def errors(engine: Pymunk, mechanism: Mechanism) -> dict[str, float]:
    """By what velocities miss the law in the first steps, relative to the largest velocity.

    Raises NotAsked where joints have no law of a step, or sweeps don't converge; Fault where the motion is lost.
    """
    rolling = any(isinstance(joint, Roll) for joint in mechanism.joints)
    skating = any(isinstance(joint, Skate) for joint in mechanism.joints)
    if (rolling and engine.roll != "pivot") or (skating and engine.skate != "groove"):
        raise NotAsked("contacts, and blades that are no joint, obey no law of a step")
    if any(isinstance(force, Damper | TorsionDamper) for force in mechanism.forces):
        raise NotAsked("a damper takes part in the sweeps, and obeys no law of a step")
    dt = STEP * mechanism.time_scale
    model, told = _converged(engine, mechanism, dt)
    checks = ("velocity", PUSHED) if engine.slot == "groove" else ("velocity",)
    worst: dict[str, float] = dict.fromkeys(checks, 0.0)
    for step, check in product(range(1, STEPS + 1), checks):
        law, free = _law(model, mechanism, told, step, dt, grooves=check == PUSHED)
        rounded = _rounded(mechanism, told, step, dt, law, free) / LAW
        worst[check] = max(worst[check], difference(mechanism, told.after[step], law.motion, (free, rounded)))
    return worst


def _rounded(mechanism: Mechanism, told: Recording, step: int, dt: float, law: Constrained, free: Array) -> Array:
    """What rounding leaves in velocities (bodies, 3), which is no fault.

    Gaps and velocities are rounded, and closing a gap within a step makes a velocity of it (`carried`). And a joint
    adds up its impulse: what is rounded off that is a velocity of the lightest body that it holds.
    """
    numbers = written(mechanism) / dt + np.abs(free) + np.abs(told.after[step])
    pushed = np.abs(law.force) @ np.abs(mechanism.rows(told.pose[step])) / mechanism.inertias.reshape(-1)
    noise = carried(mechanism, told.pose[step], numbers, grooves(mechanism) / dt).motion + pushed.reshape(-1, 3)
    return ROUNDINGS * np.finfo(float).eps * noise


def grooves(mechanism: Mechanism) -> Array:
    """(rows,) how far away [m] the ends of grooves are, which stand for slots: a gap is rounded as these places are."""
    far = [isinstance(joint, Slot) for joint in mechanism.joints for _ in range(joint.size)]
    return REACH * mechanism.length_scale * np.array(far, dtype=float)


def _converged(engine: Pymunk, mechanism: Mechanism, dt: float) -> tuple[Model, Recording]:
    """The first steps, with as many sweeps as the worst pose of theirs needs: it may be far from that of the start."""
    rho = contraction(mechanism)
    while True:
        sweeps = math.ceil(math.log(CONVERGED) / math.log(rho)) + 5 if rho > 0 else 5
        if sweeps > MOST_SWEEPS:
            raise NotAsked(f"sweeps leave {rho:.6f} of the slowest mode each, so that they don't converge")
        if engine.slot == "groove":  # the contraction is of rows that push as they see
            sweeps = MOST_SWEEPS
        model = engine.swept_model(mechanism, dt, replace(engine.sweeping(mechanism, 0.0), iterations=sweeps))
        told = record(model, dt, STEPS, 1, raw=engine.leapfrog)
        far = np.abs(told.pose[..., :2]).max()
        if engine.slot == "groove" and not far < REACH * mechanism.length_scale:
            raise NotAsked("a groove that pushes wrongly, as is known, drove the motion beyond its ends")
        if not (np.isfinite(told.pose).all() and np.isfinite(told.after).all()):
            raise Fault(f"it was lost within {STEPS} steps {told.stopped}".strip())
        rho = max(contraction_at(mechanism, pose) for pose in told.pose)
        if rho**sweeps <= CONVERGED:
            return model, told


def first_law(engine: Pymunk, mechanism: Mechanism, dt: float) -> Array:
    """Velocities (bodies, 3) after the first step, as the joints ask for."""
    model = engine.model(mechanism, dt)
    return _law(model, mechanism, record(model, dt, 1, 1, raw=engine.leapfrog), 1, dt)[0].motion


def _law(
    model: Model, mechanism: Mechanism, told: Recording, step: int, dt: float, grooves: bool = False
) -> tuple[Constrained, Array]:
    """Velocities (bodies, 3) after a step: those that the joints allow, and those without joints.

    `grooves`: with slots as Chipmunk's groove joints push (the page of faults). They solve both directions at the
    anchor and keep the part along the normal n: with K the inverse mass there, what becomes zero is n^T K^-1 times the
    anchors' velocity.
    """
    closed = np.zeros(mechanism.row_count)
    closing = [not isinstance(joint, Skate | Drive) for joint in mechanism.joints for _ in range(joint.size)]
    held = np.array(closing, dtype=bool)
    # A blade, which has no gap, closes none; a spring has an error_bias that it makes no use of.
    joints = [constraint for constraint in model.space.constraints if type(constraint) in ROWS]
    bias = min((constraint.error_bias for constraint in joints), default=0.0)
    closed[held] = 1 - bias ** (dt / model.unit)
    pose = told.pose[step]
    gap = np.nan_to_num(mechanism.gap(pose, step * dt))
    free = told.before[step - 1] + dt * mechanism.unconstrained(pose, told.before[step - 1])
    rows, right = mechanism.rows(pose), mechanism.rate - closed * gap / dt
    if grooves:
        light = 1 / mechanism.inertias.reshape(-1)
        ended = _as_grooves_see(mechanism, pose, gap, light)
        impulse = np.linalg.solve((ended * light) @ rows.T, right - ended @ free.reshape(-1))
        return Constrained(free + (light * (rows.T @ impulse)).reshape(-1, 3), impulse), free
    return constrained(rows, right, mechanism.inertias, free), free


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
