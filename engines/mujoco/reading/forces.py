"""Read MuJoCo's springs, dampers, actuators, tendons and applied forces as planar force elements."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines.mujoco.reading.elements import (
    TENDON,
    WeightedJoints,
    angle_weights,
    ends_of_tendon,
    terms_of,
    wrapped_joints,
)
from engines.mujoco.reading.frame import BODY, FREE, HINGE, JOINT, PLANAR, SLIDE, PlanarModel, name_of, plain_name
from engines.reading import left_out, refuse
from reference.forces import CoupledForce, Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring

ACTUATOR = mujoco.mjtObj.mjOBJ_ACTUATOR
# Elements of a model that act as forces, and descriptions of the ideal counterparts.
FORCE_COUNTERPARTS = {
    "stiffness, springref and damping of a joint": "a spring and a damper",
    "tendon between two sites": "a spring and a damper",
    "tendon over joints": "a spring and a damper along the sum",
    "motor or servo at constant control, on a joint or on a tendon over joints": "a force, a spring and a damper",
    "motor at a site": "a force and a torque in the directions of a site of the ground",
    "qfrc_applied, xfrc_applied, gravcomp": "constant forces",
}
NEGATIVE = "a negative stiffness or damping has no counterpart here"


def forces(planar: PlanarModel) -> list[ForceElement]:
    """The force elements of the model without gravity. Raises Unsupported for forces without an ideal counterpart."""
    _refuse_forces_without_counterpart(planar.model)
    return [*_of_joints(planar), *_of_tendons(planar), *_of_actuators(planar), *_applied(planar)]


def is_off(model: Any, word: str) -> bool:
    return bool(model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{word}")))


def _refuse_forces_without_counterpart(model: Any) -> None:
    friction = "its friction loss has no ideal counterpart"
    has_friction = not (is_off(model, "FRICTIONLOSS") or is_off(model, "CONSTRAINT"))
    if model.opt.density or model.opt.viscosity:
        reason = f"the drag of a fluid has no ideal counterpart; {left_out('fluid')}"
        raise refuse("option density or viscosity", reason)
    if model.nplugin or model.nflex:
        raise refuse("a plugin or a flexible body", "its forces have no ideal counterpart")
    for dof in np.flatnonzero(model.dof_frictionloss * has_friction):
        raise refuse(name_of(model, JOINT, model.dof_jntid[dof]), f"{friction}; {left_out('frictionloss')}")
    for tendon in np.flatnonzero(model.tendon_frictionloss * has_friction):
        raise refuse(name_of(model, TENDON, tendon), friction)
    for element, *tables in (
        ("a stiffness that is not linear", model.jnt_stiffnesspoly, model.tendon_stiffnesspoly),
        ("a damping that is not linear", model.dof_dampingpoly, model.tendon_dampingpoly),
        ("a spring that yields", model.jnt_plasticadr >= 0, model.tendon_plasticadr >= 0),
    ):
        if any(map(np.any, tables)):
            raise refuse("a joint or a tendon", f"{element} has no ideal counterpart")


def _along(
    planar: PlanarModel,
    element: str,
    name: str,
    parts: WeightedJoints,
    stretch: float,
    push: float = 0.0,
    stiffness: float = 0.0,
    damping: float = 0.0,
) -> list[ForceElement]:
    """A constant force, a spring and a damper along a sum of joint coordinates.

    `stretch` is the rest value of the sum minus its initial value [m or rad].
    """
    if min(stiffness, damping) < 0:
        raise refuse(element, NEGATIVE)
    if not (push or stiffness or damping):
        return []
    weights = angle_weights(planar, parts)
    opposite = len(weights) == 1 or (len(weights) == 2 and abs(sum(weights.values())) <= PLANAR)
    if not opposite or any(planar.model.jnt_type[joint] != HINGE for joint, _ in parts):
        terms, start = terms_of(planar, parts)
        return [CoupledForce(planar.names.new(name), terms, push, stiffness, damping, start + stretch)]
    first, second = (-1, *weights)[-2:]
    factor, ends, out = weights[second], (planar.name(first), planar.name(second)), list[ForceElement]()
    if push:
        out.append(Torque(planar.names.new(name), *ends, push * factor))
    if stiffness:
        rest = planar.turned(first, second) + stretch / factor
        out.append(TorsionSpring(planar.names.new(f"{name} spring"), *ends, stiffness * factor**2, rest))
    if damping:
        out.append(TorsionDamper(planar.names.new(f"{name} damper"), *ends, damping * factor**2))
    return out


def _of_joints(planar: PlanarModel) -> list[ForceElement]:
    model, out = planar.model, list[ForceElement]()
    for joint in range(model.njnt):
        stiffness = 0.0 if is_off(model, "SPRING") else float(model.jnt_stiffness[joint])
        damping = 0.0 if is_off(model, "DAMPER") else float(model.dof_damping[model.jnt_dofadr[joint]])
        element, name, address = name_of(model, JOINT, joint), plain_name(model, JOINT, joint), planar.qpos_of(joint)
        if model.jnt_type[joint] == FREE and (stiffness or damping):
            raise refuse(element, "stiffness or damping of a free joint has no counterpart here")
        stretch = float(model.qpos_spring[address]) - float(planar.data.qpos[address])
        out += _along(planar, element, name, [(joint, 1.0)], stretch, 0.0, stiffness, damping)
    return out


def _of_tendons(planar: PlanarModel) -> list[ForceElement]:
    model, out = planar.model, list[ForceElement]()
    for tendon in range(model.ntendon):
        element, name = name_of(model, TENDON, tendon), plain_name(model, TENDON, tendon)
        stiffness = 0.0 if is_off(model, "SPRING") else float(model.tendon_stiffness[tendon])
        damping = 0.0 if is_off(model, "DAMPER") else float(model.tendon_damping[tendon])
        low, high = (float(value) for value in model.tendon_lengthspring[tendon])
        if model.tendon_armature[tendon]:
            raise refuse(element, "the armature of a tendon has no ideal counterpart here")
        if stiffness and low != high:
            raise refuse(element, "a spring that is slack over a range of lengths has no ideal counterpart")
        if min(stiffness, damping) < 0:
            raise refuse(element, NEGATIVE)
        if not stiffness and not damping:
            continue
        parts = wrapped_joints(model, tendon)
        if parts is not None:
            out += _along(planar, element, name, parts, low - _length(planar, tendon), 0.0, stiffness, damping)
            continue
        ends = ends_of_tendon(planar, tendon)
        if ends[0] == ends[1]:
            planar.note(element, "its two ends are on one body")
            continue
        if stiffness:
            out.append(Spring(planar.names.new(f"{name} spring"), *planar.between(*ends), stiffness, low))
        if damping:
            out.append(Damper(planar.names.new(f"{name} damper"), *planar.between(*ends), damping))
    return out


def _length(planar: PlanarModel, tendon: int) -> float:
    return float(planar.data.ten_length[tendon])


def _of_actuators(planar: PlanarModel) -> list[ForceElement]:
    model = planar.model
    if is_off(model, "ACTUATION"):
        return []
    return [force for actuator in range(model.nu) for force in _of_actuator(planar, actuator)]


def _of_actuator(planar: PlanarModel, actuator: int) -> list[ForceElement]:
    model = planar.model
    element, name = name_of(model, ACTUATOR, actuator), plain_name(model, ACTUATOR, actuator)
    if model.opt.disableactuator & (1 << max(0, int(model.actuator_group[actuator]))):
        planar.note(element, "its group is switched off")
        return []
    if np.any(model.actuator_armature[actuator]) or np.any(model.actuator_damping[actuator]):
        raise refuse(element, "armature or damping of an actuator has no ideal counterpart here; give the joint's")
    kinds = mujoco.mjtBias
    is_affine = model.actuator_biastype[actuator] == int(kinds.mjBIAS_AFFINE)
    is_simple = (
        model.actuator_dyntype[actuator] == int(mujoco.mjtDyn.mjDYN_NONE)
        and model.actuator_gaintype[actuator] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and (is_affine or model.actuator_biastype[actuator] == int(kinds.mjBIAS_NONE))
        and not np.any(model.actuator_delay[actuator])
    )
    bias = model.actuator_biasprm[actuator][:3] * is_affine
    push = float(model.actuator_gainprm[actuator][0]) * _control(planar, actuator, element) + float(bias[0])
    if is_simple and not push and not np.any(bias):
        planar.note(element, "its control is zero, so it does not act")
        return []
    if not is_simple:
        raise refuse(element, "only a motor or a servo without a state of its own, at constant control, is read")
    if model.actuator_forcelimited[actuator] and not limited_servos(model)[actuator]:
        push = float(np.clip(push, *model.actuator_forcerange[actuator]))
    kind, target = mujoco.mjtTrn(int(model.actuator_trntype[actuator])), int(model.actuator_trnid[actuator][0])
    gear = float(model.actuator_gear[actuator][0])
    servo = gear * push, *(-gear * gear * float(value) for value in bias[1:])
    if kind in (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT):
        if model.jnt_type[target] not in (HINGE, SLIDE):
            raise refuse(element, "it acts on a joint that is neither a hinge nor a slide")
        stretch = -float(planar.data.qpos[planar.qpos_of(target)])
        return _along(planar, element, name, [(target, 1.0)], stretch, *servo)
    if kind == mujoco.mjtTrn.mjTRN_TENDON and (parts := wrapped_joints(model, target)) is not None:
        return _along(planar, element, name, parts, -_length(planar, target), *servo)
    if np.any(bias[1:]):
        raise refuse(element, "a servo is read only where it acts on a joint, or on a tendon over joints")
    if kind != mujoco.mjtTrn.mjTRN_SITE:
        raise refuse(element, "it acts neither on a joint, nor on a sum of angles, nor at a site")
    return _at_site(planar, element, name, actuator, push)


def _control(planar: PlanarModel, actuator: int, element: str) -> float:
    model, control = planar.model, float(planar.data.ctrl[actuator])
    if not model.actuator_ctrllimited[actuator] or is_off(model, "CLAMPCTRL"):
        return control
    clamped = float(np.clip(control, *model.actuator_ctrlrange[actuator]))
    if clamped != control:
        planar.note(element, f"its control of {control:g} is beyond its range; MuJoCo takes {clamped:g}, so we do")
    return clamped


def _at_site(planar: PlanarModel, element: str, name: str, actuator: int, push: float) -> list[ForceElement]:
    model, data = planar.model, planar.data
    site, base = (int(index) for index in model.actuator_trnid[actuator])
    if base < 0 or planar.group(model.site_bodyid[base]) >= 0:
        raise refuse(element, "a force at a site that turns with a body is not constant in the plane")
    axes = data.site_xmat[base].reshape(3, 3)
    force, torque = (push * (axes @ part) for part in np.split(model.actuator_gear[actuator], 2))
    group = planar.group(model.site_bodyid[site])
    return _on_body(planar, group, data.site_xpos[site], force, torque, name, name)


def _on_body(
    planar: PlanarModel, group: int, at: Any, force: Any, torque: Any, force_name: str, torque_name: str
) -> list[ForceElement]:
    """A constant force (3,) [N] at a point of the world and a constant torque (3,) [N m] on a body."""
    second, out, pull = planar.name(group), list[ForceElement](), planar.frame.in_plane(force)
    if second is not None and any(pull):
        out.append(Force(planar.names.new(force_name), second, planar.in_body(group, at), pull))
    if second is not None and torque @ planar.frame.normal:
        out.append(Torque(planar.names.new(torque_name), None, second, float(torque @ planar.frame.normal)))
    return out


def _applied(planar: PlanarModel) -> list[ForceElement]:
    model, data, out = planar.model, planar.data, list[ForceElement]()
    for dof in np.flatnonzero(data.qfrc_applied):
        joint = int(model.dof_jntid[dof])
        element, name = name_of(model, JOINT, joint), plain_name(model, JOINT, joint)
        if model.jnt_type[joint] not in (HINGE, SLIDE):
            raise refuse(element, "a force applied to a free joint is not read; apply it to a body")
        out += _along(planar, element, f"{name} applied", [(joint, 1.0)], 0.0, float(data.qfrc_applied[dof]))
    gravity = np.zeros(3) if is_off(model, "GRAVITY") else model.opt.gravity
    for body in range(1, model.nbody):
        push = data.xfrc_applied[body][:3] - model.body_gravcomp[body] * model.body_mass[body] * gravity
        name = plain_name(model, BODY, body)
        names = f"{name} force", f"{name} torque"
        out += _on_body(planar, planar.group(body), data.xipos[body], push, data.xfrc_applied[body][3:], *names)
    return out


def turns(planar: PlanarModel, group: int) -> bool:
    return group >= 0 and (
        bool(planar.joints_of(group, HINGE, FREE)) or turns(planar, planar.parent(planar.joints_of(group)[0]))
    )


def limited_servos(model: Any) -> Any:
    """Whether an actuator (nu,) has a variable, limited force; `forces` applies the limit of a constant force."""
    affine = model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_AFFINE)
    return model.actuator_forcelimited.astype(bool) & affine & np.any(model.actuator_biasprm[:, 1:3], axis=1)
