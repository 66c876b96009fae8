"""MuJoCo's springs, dampers, actuators, tendons and applied forces as force elements of the plane."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines.mujoco.reading.elements import JOINT, Scene, angle_weights, straight, terms_of, wrapped_joints
from engines.mujoco.reading.frame import FREE, HINGE, PLANAR, SLIDE, name_of, plain_name
from engines.reading import left_out, refuse
from reference.couplings import Term
from reference.forces import CoupledForce, Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring

TENDON, ACTUATOR = mujoco.mjtObj.mjOBJ_TENDON, mujoco.mjtObj.mjOBJ_ACTUATOR
# What acts, and what it is read as.
FORCES = {
    "stiffness, springref and damping of a joint": "a spring and a damper",
    "tendon between two sites": "a spring and a damper",
    "tendon over joints": "a spring and a damper along the sum",
    "motor or servo at constant control, on a joint or on a tendon over joints": "a force, a spring and a damper",
    "motor at a site": "a force and a torque in the directions of a site of the ground",
    "qfrc_applied, xfrc_applied, gravcomp": "constant forces",
}


def forces(scene: Scene) -> list[ForceElement]:
    """All that acts besides gravity."""
    _refuse_what_has_no_counterpart(scene)
    return [*_of_joints(scene), *_of_tendons(scene), *_of_actuators(scene), *_applied(scene)]


def _refuse_what_has_no_counterpart(scene: Scene) -> None:
    model = scene.model
    if (model.opt.density or model.opt.viscosity) and not off(model, "PASSIVE"):
        raise refuse(
            "option density or viscosity", f"the drag of a fluid has no ideal counterpart; {left_out('fluid')}"
        )
    if model.nplugin or model.nflex:
        raise refuse("a plugin or a flexible body", "its forces have no ideal counterpart")
    if not (off(model, "FRICTIONLOSS") or off(model, "CONSTRAINT")):
        for dof in np.flatnonzero(model.dof_frictionloss):
            element = name_of(model, JOINT, int(model.dof_jntid[dof]))
            raise refuse(element, f"its friction loss has no ideal counterpart; {left_out('frictionloss')}")
        for tendon in np.flatnonzero(model.tendon_frictionloss):
            raise refuse(name_of(model, TENDON, int(tendon)), "its friction loss has no ideal counterpart")
    for table, word in ((model.jnt_stiffnesspoly, "stiffness"), (model.tendon_stiffnesspoly, "stiffness")):
        if np.any(table):
            raise refuse("a joint or a tendon", f"a {word} that is not linear has no ideal counterpart")
    if np.any(model.dof_dampingpoly) or np.any(model.tendon_dampingpoly):
        raise refuse("a joint or a tendon", "a damping that is not linear has no ideal counterpart")
    if np.any(model.jnt_plasticadr >= 0) or np.any(model.tendon_plasticadr >= 0):
        raise refuse("a joint or a tendon", "a spring that yields has no ideal counterpart")


def _of_joints(scene: Scene) -> list[ForceElement]:
    model = scene.model
    out: list[ForceElement] = []
    for joint in range(model.njnt):
        dof, place = int(model.jnt_dofadr[joint]), int(model.jnt_qposadr[joint])
        stiffness = 0.0 if off(model, "SPRING") else float(model.jnt_stiffness[joint])
        damping = 0.0 if off(model, "DAMPER") else float(model.dof_damping[dof])
        if model.jnt_type[joint] == FREE and (stiffness or damping):
            raise refuse(name_of(model, JOINT, joint), "stiffness or damping of a free joint has no counterpart here")
        if model.jnt_type[joint] in (HINGE, SLIDE):
            rest = float(model.qpos_spring[place])
            out += along_joint(scene, joint, plain_name(model, JOINT, joint), 0.0, stiffness, damping, rest)
    return out


def _of_tendons(scene: Scene) -> list[ForceElement]:
    model = scene.model
    out: list[ForceElement] = []
    for tendon in range(model.ntendon):
        element, name = name_of(model, TENDON, tendon), plain_name(model, TENDON, tendon)
        stiffness = 0.0 if off(model, "SPRING") else float(model.tendon_stiffness[tendon])
        damping = 0.0 if off(model, "DAMPER") else float(model.tendon_damping[tendon])
        if model.tendon_armature[tendon]:
            raise refuse(element, "the armature of a tendon has no ideal counterpart here")
        if not stiffness and not damping:
            continue
        low, high = (float(value) for value in model.tendon_lengthspring[tendon])
        if stiffness and low != high:
            raise refuse(element, "a spring that is slack over a range of lengths has no ideal counterpart")
        if min(stiffness, damping) < 0:
            raise refuse(element, "a negative stiffness or damping has no counterpart here")
        parts = wrapped_joints(model, tendon)
        if parts is not None:
            between = _between(scene, parts)
            if between is None:
                terms, constant = _tendon_terms(scene, tendon, parts)
                out.append(CoupledForce(scene.names.new(name), terms, 0.0, stiffness, damping, low - constant))
                continue
            first, second, factor = between
            ends = scene.name(first), scene.name(second)
            turned = scene.angle(second) - scene.angle(first)
            rest = turned + (low - float(scene.data.ten_length[tendon])) / factor
            if stiffness:
                out.append(TorsionSpring(scene.names.new(f"{name} spring"), *ends, stiffness * factor**2, rest))
            if damping:
                out.append(TorsionDamper(scene.names.new(f"{name} damper"), *ends, damping * factor**2))
            continue
        first, second, at, other = straight(scene, tendon)
        if first == second:
            scene.note(element, "its two ends are on one body")
            continue
        ends = scene.name(first), scene.name(second), scene.own(first, at), scene.own(second, other)
        if stiffness:
            out.append(Spring(scene.names.new(f"{name} spring"), *ends, stiffness, low))
        if damping:
            out.append(Damper(scene.names.new(f"{name} damper"), *ends, damping))
    return out


def _tendon_terms(scene: Scene, tendon: int, parts: list[tuple[int, float]]) -> tuple[tuple[Term, ...], float]:
    """A fixed tendon's length as a sum of terms, and the constant that it has besides [m or rad]."""
    terms, value = terms_of(scene, parts)
    return terms, float(scene.data.ten_length[tendon]) - value


def _between(scene: Scene, parts: list[tuple[int, float]]) -> tuple[int, int, float] | None:
    """The two groups, the first perhaps the ground, whose relative angle times a factor a fixed tendon's length is.

    None where it is another sum.
    """
    if any(scene.model.jnt_type[joint] != HINGE for joint, _ in parts):
        return None
    weights = angle_weights(scene, parts)
    groups = list(weights)
    if len(groups) == 1:
        return -1, groups[0], weights[groups[0]]
    if len(groups) == 2 and abs(weights[groups[0]] + weights[groups[1]]) <= PLANAR:
        return groups[0], groups[1], weights[groups[1]]
    return None


def _of_actuators(scene: Scene) -> list[ForceElement]:
    model, data = scene.model, scene.data
    if off(model, "ACTUATION"):
        return []
    out: list[ForceElement] = []
    servos = limited_servos(model)  # where a limit is reached the motion is refused
    for actuator in range(model.nu):
        element, name = name_of(model, ACTUATOR, actuator), plain_name(model, ACTUATOR, actuator)
        if model.opt.disableactuator & (1 << max(0, int(model.actuator_group[actuator]))):
            scene.note(element, "its group is switched off")
            continue
        gear = float(model.actuator_gear[actuator][0])
        gain, bias = model.actuator_gainprm[actuator], model.actuator_biasprm[actuator]
        simple = (
            model.actuator_dyntype[actuator] == int(mujoco.mjtDyn.mjDYN_NONE)
            and model.actuator_gaintype[actuator] == int(mujoco.mjtGain.mjGAIN_FIXED)
            and model.actuator_biastype[actuator]
            in (int(mujoco.mjtBias.mjBIAS_NONE), int(mujoco.mjtBias.mjBIAS_AFFINE))
            and not _of(model, "actuator_delay", actuator)
        )
        if _of(model, "actuator_armature", actuator) or _of(model, "actuator_damping", actuator):
            raise refuse(element, "armature or damping of an actuator has no ideal counterpart here; give the joint's")
        affine = bias[:3] if model.actuator_biastype[actuator] == int(mujoco.mjtBias.mjBIAS_AFFINE) else np.zeros(3)
        order = float(data.ctrl[actuator])
        if model.actuator_ctrllimited[actuator] and not off(model, "CLAMPCTRL"):
            given, order = order, float(np.clip(order, *model.actuator_ctrlrange[actuator]))
            if order != given:
                scene.note(element, f"its control of {given:g} is beyond its range; MuJoCo takes {order:g}, so we do")
        push = float(gain[0]) * order + float(affine[0])
        if simple and not push and not np.any(affine):
            scene.note(element, "its control is zero, so it does not act")
            continue
        kind, target = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator][0])
        if not simple:
            raise refuse(element, "only a motor or a servo without a state of its own, at constant control, is read")
        if model.actuator_forcelimited[actuator] and not servos[actuator]:
            push = float(np.clip(push, *model.actuator_forcerange[actuator]))
        if kind in (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)):
            out += _on_joint(scene, element, name, target, gear, push, affine)
        elif kind == int(mujoco.mjtTrn.mjTRN_TENDON) and (parts := wrapped_joints(model, target)) is not None:
            out.append(_on_tendon(scene, element, name, target, parts, gear, push, affine))
        elif np.any(affine[1:]):
            raise refuse(element, "a servo is read only where it acts on a joint, or on a tendon over joints")
        elif kind == int(mujoco.mjtTrn.mjTRN_SITE):
            out += _at_site(scene, element, name, actuator, push)
        else:
            raise refuse(element, "it acts neither on a joint, nor on a sum of angles, nor at a site")
    return out


def _on_tendon(
    scene: Scene,
    element: str,
    name: str,
    tendon: int,
    parts: list[tuple[int, float]],
    gear: float,
    push: float,
    affine: Any,
) -> ForceElement:
    """A constant force along a fixed tendon, and the spring and damper of a servo."""
    stiffness, damping = (-gear * gear * float(value) for value in affine[1:3])
    if min(stiffness, damping) < 0:
        raise refuse(element, "a servo that pushes away from its goal has no counterpart here")
    label, between = scene.names.new(name), _between(scene, parts)
    if between is not None and not stiffness and not damping:
        first, second, factor = between
        return Torque(label, scene.name(first), scene.name(second), gear * push * factor)
    terms, constant = _tendon_terms(scene, tendon, parts)
    return CoupledForce(label, terms, gear * push, stiffness, damping, -constant)


def _on_joint(
    scene: Scene, element: str, name: str, joint: int, gear: float, push: float, affine: Any
) -> list[ForceElement]:
    """A constant force, and the spring and damper of a servo."""
    model = scene.model
    if model.jnt_type[joint] not in (HINGE, SLIDE):
        raise refuse(element, "it acts on a joint that is neither a hinge nor a slide")
    stiffness, damping = -gear * gear * float(affine[1]), -(gear**2) * float(affine[2])
    return along_joint(scene, joint, name, gear * push, stiffness, damping)


def _at_site(scene: Scene, element: str, name: str, actuator: int, push: float) -> list[ForceElement]:
    """A constant force and torque at a site, in the directions of a site of the ground."""
    model, data = scene.model, scene.data
    site, base = (int(each) for each in model.actuator_trnid[actuator])
    group = scene.group(int(model.site_bodyid[site]))
    second = scene.name(group)
    if base < 0 or scene.group(int(model.site_bodyid[base])) >= 0:
        raise refuse(element, "a force at a site that turns with a body is not constant in the plane")
    if second is None:
        return []
    axes = data.site_xmat[base].reshape(3, 3)
    force, torque = (push * (axes @ part) for part in np.split(model.actuator_gear[actuator], 2))
    out: list[ForceElement] = []
    if any(scene.frame.in_plane(force)):
        at = scene.own(group, data.site_xpos[site])
        out.append(Force(scene.names.new(name), second, at, scene.frame.in_plane(force)))
    if torque @ scene.frame.normal:
        out.append(Torque(scene.names.new(name), None, second, float(torque @ scene.frame.normal)))
    return out


def _of(model: Any, field: str, index: int) -> bool:
    return bool(np.any(getattr(model, field)[index])) if hasattr(model, field) else False


def _applied(scene: Scene) -> list[ForceElement]:
    """Forces that stand in the data, and weights that the model takes off bodies."""
    model, data = scene.model, scene.data
    out: list[ForceElement] = []
    for dof in np.flatnonzero(data.qfrc_applied):
        joint = int(model.dof_jntid[dof])
        if model.jnt_type[joint] not in (HINGE, SLIDE):
            raise refuse(
                name_of(model, JOINT, joint), "a force applied to a free joint is not read; apply it to a body"
            )
        out += along_joint(scene, joint, f"{plain_name(model, JOINT, joint)} applied", float(data.qfrc_applied[dof]))
    gravity = np.zeros(3) if off(model, "GRAVITY") else model.opt.gravity
    for body in range(1, model.nbody):
        group = scene.group(body)
        second = scene.name(group)
        if second is None:
            continue
        push, torque = data.xfrc_applied[body][:3].copy(), float(data.xfrc_applied[body][3:] @ scene.frame.normal)
        push -= model.body_gravcomp[body] * model.body_mass[body] * gravity
        name = plain_name(model, mujoco.mjtObj.mjOBJ_BODY, body)
        if np.any(push):
            at = scene.own(group, data.xipos[body])
            out.append(Force(scene.names.new(f"{name} force"), second, at, scene.frame.in_plane(push)))
        if torque:
            out.append(Torque(scene.names.new(f"{name} torque"), None, second, torque))
    return out


def off(model: Any, word: str) -> bool:
    """Whether a flag of the model switches this off."""
    return bool(model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{word}", 0)))


def along_joint(
    scene: Scene,
    joint: int,
    name: str,
    push: float = 0.0,
    stiffness: float = 0.0,
    damping: float = 0.0,
    rest: float = 0.0,
) -> list[ForceElement]:
    """A constant force, a spring at ease at `rest` [m or rad], and a damper, along the coordinate of a joint."""
    model, element = scene.model, name_of(scene.model, JOINT, joint)
    if stiffness < 0:
        raise refuse(element, "a spring of negative stiffness has no counterpart here")
    if damping < 0:
        raise refuse(element, "a negative damping has no counterpart here")
    way = rest - float(scene.data.qpos[int(model.jnt_qposadr[joint])])
    if model.jnt_type[joint] != HINGE:
        if not (push or stiffness or damping):
            return []
        terms, start = terms_of(scene, [(joint, 1.0)])
        return [CoupledForce(scene.names.new(name), terms, push, stiffness, damping, start + way)]
    group, parent, sign = scene.group(int(model.jnt_bodyid[joint])), scene.parent(joint), scene.sign(joint)
    ends, out = (scene.name(parent), scene.name(group)), list[ForceElement]()
    if push:
        out.append(Torque(scene.names.new(name), *ends, sign * push))
    if stiffness:
        turned = scene.angle(group) - scene.angle(parent)
        out.append(TorsionSpring(scene.names.new(f"{name} spring"), *ends, stiffness, turned + sign * way))
    if damping:
        out.append(TorsionDamper(scene.names.new(f"{name} damper"), *ends, damping))
    return out


def turns(scene: Scene, group: int) -> bool:
    """Whether a body can turn."""
    while group >= 0:
        joints = scene.joints_of(group)
        if any(scene.model.jnt_type[joint] in (HINGE, FREE) for joint in joints):
            return True
        group = scene.parent(joints[0])
    return False


def limited_servos(model: Any) -> Any:
    """Actuators (nu,) with a limit whose force is not constant; a constant one is read with its limit."""
    affine = model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_AFFINE)
    return model.actuator_forcelimited.astype(bool) & affine & np.any(model.actuator_biasprm[:, 1:3], axis=1)
