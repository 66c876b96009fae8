"""Skates as fixed tendons: a sum of joint velocities whose coefficients are the skate's row, rewritten every step.

MuJoCo holds a tendon's length; here the stiffness is next to none and only the damping acts, so the length that the
changing coefficients pretend does nothing, and need not be reset.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building, Callback, Hooks, read_by_step
from engines.mujoco.joints.skate.multipliers import refuse_loops, without_slip
from engines.mujoco.stiffness import STIFFEST
from engines.mujoco.written_rows import GROUND, WrittenJoint, chain, row_writer

# A stiffness must not be zero in solref's direct form; this one pulls at a metre with a picometre per second squared.
NO_STIFFNESS = -1e-12


def add_tendons(building: Building, joints: Sequence[WrittenJoint], ahead: float = 0.0) -> None:
    """Equality rows that stop the slip within a step: J v = 0 after it, at the pose `ahead` [s] along the velocity."""
    for number in range(len(joints)):
        _add_equality(building, number, 1 / building.dt)
    _add_rewritten(building, joints, ahead)
    _read_by_step_if_staged(building)
    building.size += len(joints)


def add_friction_tendons(building: Building, joints: Sequence[WrittenJoint]) -> None:
    """Friction loss that is never overcome: as strong as ten thousand of the mechanism's own inertial forces."""
    mechanism = building.mechanism
    weight = sum(body.mass for body in mechanism.bodies) * mechanism.length_scale / mechanism.time_scale**2
    _add_rewritten(
        building,
        joints,
        frictionloss=1e4 * weight,
        solref_friction=[NO_STIFFNESS, -STIFFEST[1] / building.dt],
        solimp_friction=list(STIFFEST),
    )
    _read_by_step_if_staged(building)
    building.size += len(joints)


def add_leapfrog(building: Building, joints: Sequence[WrittenJoint]) -> None:
    """Positions half a step ahead of velocities, and the slip reflected in every step: the mean of two slips is none.

    Time-symmetric, so of order 2 as long as the inertia doesn't depend on the pose. Reflections leave a slip that
    changes sign in every step and is no part of the motion: a velocity is read without its slip at the instant, and an
    acceleration as the mean of the two beside it, in which it cancels.
    """
    refuse_loops(building, "the leapfrog of reflected slips")
    if building.mechanism.forces:
        raise Unsupported("the leapfrog of reflected slips takes no forces but gravity: none were tried with it")
    for number in range(len(joints)):
        _add_equality(building, number, 2 / building.dt)
    _add_rewritten(building, joints)
    building.size += len(joints)

    half = building.dt / 2

    def bind(compiled: Any, address: Sequence[int]) -> Hooks:
        rows = row_writer(building.tree, address, joints, compiled.nv)
        rewrite = _rewriting(building, joints, compiled, address, 0.0)

        def ahead(_model: Any, data: Any) -> None:
            data.qpos[:] += half * data.qvel

        def read(model: Any, data: Any) -> tuple[Any, Any, Any]:
            forward, position, velocity = data.qacc.copy(), data.qpos.copy(), data.qvel.copy()
            # The step before, backwards in time: half a step behind, with the velocity turned round.
            data.qpos[:], data.qvel[:] = position - 2 * half * velocity, -velocity
            backward = solved(model, data)
            data.qpos[:], data.qvel[:] = position - half * velocity, velocity
            mujoco.mj_forward(model, data)
            along = without_slip(model, data, rows)
            now = data.qpos.copy()
            data.qpos[:] = position
            solved(model, data)
            return now, along, (forward + backward) / 2

        def solved(model: Any, data: Any) -> Any:
            rewrite(model, data)
            mujoco.mj_forward(model, data)
            return data.qacc.copy()

        return Hooks(start=(ahead,), read=read)

    building.binders.append(bind)


def _read_by_step_if_staged(building: Building) -> None:
    """A row that stops the slip within a step pulls differently in each stage: their mean is what acts."""
    if building.spec.option.integrator == mujoco.mjtIntegrator.mjINT_RK4:
        building.binders.append(lambda _compiled, _address: Hooks(read=read_by_step))


def _add_equality(building: Building, number: int, damping: float) -> None:
    building.spec.add_equality(
        type=mujoco.mjtEq.mjEQ_TENDON,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        name1=f"skate {number}",
        solref=[NO_STIFFNESS, -STIFFEST[1] * damping],
        solimp=list(STIFFEST),
    )


def _add_rewritten(building: Building, joints: Sequence[WrittenJoint], ahead: float = 0.0, **options: Any) -> None:
    tree = building.tree
    # The coefficients at the start set the scale of the compliance when the model is compiled.
    width = tree.coordinates
    start, _ = row_writer(tree, range(width), joints, width)(0.0, [0.0] * width, [0.0] * width)
    columns = [chain(tree, joint) for joint in joints]
    for number, own in enumerate(columns):
        tendon = building.spec.add_tendon(name=f"skate {number}", **options)
        for column in own:
            tendon.wrap_joint(f"coordinate {column}", start[number * width + column])

    building.binders.append(
        lambda compiled, address: Hooks(before=(_rewriting(building, joints, compiled, address, ahead),))
    )


def _rewriting(
    building: Building, joints: Sequence[WrittenJoint], compiled: Any, address: Sequence[int], ahead: float
) -> Callback:
    """What writes the tendons' coefficients for the pose, or for the one that the velocity leads to."""
    tree = building.tree
    columns = [[address[column] for column in chain(tree, joint)] for joint in joints]
    if len(joints) == 1 and joints[0].first is None and len(tree.links) == 1 and tree.links[0].kind == "free":
        return _for_one_body(building, joints[0], columns[0][2], ahead)
    own = [number * compiled.nv + column for number, row in enumerate(columns) for column in row]
    first = int(compiled.tendon_adr[compiled.tendon("skate 0").id])
    place = slice(first, first + len(own))
    rows, coefficients = row_writer(tree, address, joints, compiled.nv), compiled.wrap_prm

    def rewrite(_model: Any, data: Any) -> None:
        position, velocity = data.qpos.tolist(), data.qvel.tolist()
        if ahead:
            position = [q + ahead * v for q, v in zip(position, velocity, strict=True)]
        flat, _ = rows(data.time, position, velocity)
        coefficients[place] = [flat[index] for index in own]

    return _unless_blown_up(rewrite)


def _for_one_body(building: Building, joint: WrittenJoint, rotation: int, ahead: float) -> Callback:
    """The same for one free body: the row depends on its angle alone, and turns with it."""
    start_angle = float(building.mechanism.pose[0, 2])
    at_rest = joint.rows(0.0, GROUND, (0.0, 0.0, start_angle, 0.0, 0.0, 0.0))[0]
    left_x, left_y = at_rest[3], at_rest[4]
    sine_of, cosine_of = math.sin, math.cos

    def rewrite(model: Any, data: Any) -> None:
        turned = data.qpos.item(rotation)
        if ahead:
            turned += ahead * data.qvel.item(rotation)
        cosine, sine = cosine_of(turned), sine_of(turned)
        coefficients = model.wrap_prm
        coefficients[0] = cosine * left_x - sine * left_y
        coefficients[1] = sine * left_x + cosine * left_y

    return _unless_blown_up(rewrite)


def _unless_blown_up(rewrite: Callable[[Any, Any], None]) -> Callback:
    def guarded(model: Any, data: Any) -> None:
        try:
            rewrite(model, data)
        except (ValueError, OverflowError):
            return  # MuJoCo finds what isn't a number by itself, and starts anew

    return guarded
