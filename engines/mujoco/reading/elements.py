"""Read the joints, driven hinges and equalities of a MuJoCo model as ideal joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.consistent_start import PRINTED
from engines.mujoco.reading.frame import BODY, FREE, HINGE, JOINT, PLANAR, SLIDE, PlanarModel, name_of, plain_name
from engines.reading import refuse
from reference.couplings import Coupling, Term
from reference.joints import Drive, Gear, Joint, Pin, Rod, Slot, Weld

Array = NDArray[np.float64]
Ends = tuple[int, int, Array, Array]  # Two groups, and two points [m] of the world.
WeightedJoints = Sequence[tuple[int, float]]  # Joints of the model with their factors in a sum of coordinates.
EQUALITY, TENDON = mujoco.mjtObj.mjOBJ_EQUALITY, mujoco.mjtObj.mjOBJ_TENDON
# Smallest ratio of armature to inertia at which a hinge counts as driven. The armature divides the accelerations of the
# hinge by this ratio. The remaining accelerations are a tenth of the accepted difference from the judge's
# accelerations.
DRIVING_RATIO = 1e7
TORQUE_SCALE = 10  # index of a weld's torquescale in eq_data


def tree_joints(planar: PlanarModel) -> list[Joint]:
    return [joint for group in range(len(planar.bodies)) for joint in _joints_with_parent(planar, group)]


def _joints_with_parent(planar: PlanarModel, group: int) -> list[Joint]:
    data, hinges, slides = planar.data, planar.joints_of(group, HINGE), planar.joints_of(group, SLIDE)
    body = name_of(planar.model, BODY, planar.groups.roots[group])
    if len(hinges) > 1:
        raise refuse(body, "it has two hinges with nothing between them that has a mass")
    if np.linalg.matrix_rank(data.xaxis[slides].reshape(-1, 3), tol=PLANAR) < len(slides):
        raise refuse(body, "two of its slides are parallel")
    if planar.joints_of(group, FREE) or (len(slides) == 2 and hinges):
        return []
    joints = hinges or slides
    parent = planar.parent(joints[0])
    label, names = planar.new_name(JOINT, joints[0]), (planar.name(parent), planar.name(group))
    if len(slides) == 2:
        return [Drive(label, *names, 0.0, planar.turned(parent, group))]
    if not slides:
        anchor = data.xanchor[hinges[0]]
        return [Pin(label, *planar.between(parent, group, anchor, anchor))]
    axis = data.xaxis[slides[0]]
    if not hinges:
        line = planar.in_body(parent, planar.centre(group)), planar.direction(parent, axis), (0.0, 0.0)
        turned = planar.turned(parent, group)
        return [Slot(label, *names, *line), Drive(planar.names.new(f"{label}, no turning"), *names, 0.0, turned)]
    anchor = data.xanchor[hinges[0]]
    # If the slide comes before the hinge, the line of the slot is fixed in the parent.
    first, second = (parent, group) if slides[0] < hinges[0] else (group, parent)
    line = planar.in_body(first, anchor), planar.direction(first, axis), planar.in_body(second, anchor)
    return [Slot(label, planar.name(first), planar.name(second), *line)]


def is_driven(planar: PlanarModel, joint: int) -> bool:
    armature = float(planar.model.dof_armature[int(planar.model.jnt_dofadr[joint])])
    points = np.array(
        [body.pose[:2] for body in planar.bodies] + [planar.frame.in_plane(at) for at in planar.data.xanchor]
    )
    span = float(np.ptp(points, axis=0).max())
    largest_inertia = sum(body.inertia + body.mass * span**2 for body in planar.bodies)
    return bool(planar.model.jnt_type[joint] == HINGE and armature >= DRIVING_RATIO * largest_inertia)


def drives(planar: PlanarModel) -> list[Drive]:
    out = []
    for joint in range(planar.model.njnt):
        if not is_driven(planar, joint):
            continue
        group, parent = planar.group_of(joint), planar.parent(joint)
        rate = float(planar.groups.signs[joint]) * float(planar.data.qvel[int(planar.model.jnt_dofadr[joint])])
        label = planar.names.new(f"{plain_name(planar.model, JOINT, joint)} turns")
        out.append(Drive(label, planar.name(parent), planar.name(group), rate, planar.turned(parent, group)))
        reason = f"its armature is so large that nothing accelerates it, so it is taken as driven at {rate:g} rad/s"
        planar.note(name_of(planar.model, JOINT, joint), reason)
    return out


def equalities(planar: PlanarModel) -> list[Joint]:
    model, data = planar.model, planar.data
    flags = mujoco.mjtDisableBit.mjDSBL_EQUALITY | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    out: list[Joint] = []
    for index in range(model.neq):
        element = name_of(model, EQUALITY, index)
        if not data.eq_active[index] or model.opt.disableflags & int(flags):
            planar.note(element, "it is switched off")
            continue
        kind = mujoco.mjtEq(int(model.eq_type[index])).name.split("_")[1].lower()
        if kind not in EQUALITIES:
            raise refuse(element, f"an equality of the kind {kind} has no ideal counterpart here")
        read_equality, _ = EQUALITIES[kind]
        joints = read_equality(planar, index, element)
        if joints and not len(equality_rows(data, index)):
            planar.note(element, "the joints imply it, so MuJoCo makes no row for it, and it is left out")
            joints = []
        planar.held[index] = tuple(joints)
        out += joints
    return out


def equality_rows(data: Any, index: int) -> NDArray[np.intp]:
    return np.flatnonzero((data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)) & (data.efc_id == index))


def _ends(planar: PlanarModel, index: int) -> Ends:
    model, data = planar.model, planar.data
    objects = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    if model.eq_objtype[index] == int(mujoco.mjtObj.mjOBJ_SITE):
        first, second = (planar.group(model.site_bodyid[site]) for site in objects)
        return first, second, *(data.site_xpos[site] for site in objects)
    parts = (0, 3) if model.eq_type[index] == int(mujoco.mjtEq.mjEQ_CONNECT) else (3, 0)
    points = (
        data.xpos[body] + data.xmat[body].reshape(3, 3) @ model.eq_data[index][part : part + 3]
        for body, part in zip(objects, parts, strict=True)
    )
    return planar.group(objects[0]), planar.group(objects[1]), *points


def _read_connect(planar: PlanarModel, index: int, element: str) -> list[Joint]:
    ends = _ends(planar, index)
    if ends[0] == ends[1]:
        planar.note(element, "it joins a body to itself")
        return []
    return [Pin(planar.new_name(EQUALITY, index), *planar.between(*ends))]


def _read_weld(planar: PlanarModel, index: int, element: str) -> list[Joint]:
    ends = _ends(planar, index)
    rows = equality_rows(planar.data, index)
    open_by = np.abs(planar.data.efc_pos[rows]).max(initial=0.0)
    if ends[0] != ends[1] and open_by > PLANAR * max(1.0, planar.model.stat.extent):
        raise refuse(element, f"it is open by {open_by:.2g} m or rad at the start")
    pins = _read_connect(planar, index, element)
    if not pins or planar.model.eq_data[index][TORQUE_SCALE]:
        turned = planar.turned(*ends[:2])
        return [Weld(pin.name, *planar.between(*ends), turned) for pin in pins]
    planar.note(element, "it holds a point and no angle, since its torquescale is zero")
    return pins


def _term(planar: PlanarModel, joint: int, factor: float) -> Term:
    """`factor` times the coordinate of a joint, plus a constant. Raises Unsupported for a hinge between two slides."""
    data, group, parent = planar.data, planar.group_of(joint), planar.parent(joint)
    if planar.model.jnt_type[joint] == HINGE:
        return Term(planar.name(parent), planar.name(group), factor * float(planar.groups.signs[joint]))
    hinges, slides = planar.joints_of(group, HINGE), planar.joints_of(group, SLIDE)
    if hinges and slides[0] < hinges[0] < slides[-1]:
        reason = "its hinge is between two slides, which is not read in a sum; give the slides a separate body"
        raise refuse(name_of(planar.model, JOINT, joint), reason)
    at = data.xanchor[hinges[0]] if hinges else planar.centre(group)
    # With two slides, a slide's coordinate changes along the normal of the other slide.
    axes = np.array([planar.frame.in_plane(data.xaxis[slide]) for slide in slides])
    x, y = np.linalg.pinv(axes)[:, slides.index(joint)]
    along, size = planar.frame.both.T @ [x, y], float(np.hypot(x, y))
    first, second, sign = parent, group, 1.0
    if hinges and hinges[0] < slides[0]:  # the hinge turns the line
        first, second, sign = group, parent, -1.0
    line = planar.in_body(first, at), planar.direction(first, along), planar.in_body(second, at)
    return Term(planar.name(first), planar.name(second), sign * factor * size, True, *line)


def terms_of(planar: PlanarModel, parts: WeightedJoints) -> tuple[tuple[Term, ...], float]:
    terms = tuple(_term(planar, joint, factor) for joint, factor in parts)
    pose = {body.name: np.array(body.pose) for body in planar.bodies} | {None: np.zeros(3)}
    return terms, float(sum(term.value(pose[term.first], pose[term.second]) for term in terms))


def angle_weights(planar: PlanarModel, parts: WeightedJoints) -> dict[int, float]:
    """The factors of the bodies' angles in a sum of hinge coordinates, without zeros."""
    weights: dict[int, float] = {}
    for joint, factor in parts:
        for group, sign in ((planar.group_of(joint), 1.0), (planar.parent(joint), -1.0)):
            if group >= 0:
                weights[group] = weights.get(group, 0.0) + sign * factor * float(planar.groups.signs[joint])
    return {group: weight for group, weight in sorted(weights.items()) if abs(weight) > PLANAR}


def wrapped_joints(model: Any, tendon: int) -> list[tuple[int, float]] | None:
    """The joints and coefficients of a fixed tendon, or None for a spatial tendon."""
    wraps = range(int(model.tendon_adr[tendon]), int(model.tendon_adr[tendon] + model.tendon_num[tendon]))
    if np.any(model.wrap_type[wraps] != int(mujoco.mjtWrap.mjWRAP_JOINT)):
        return None
    return [(int(model.wrap_objid[wrap]), float(model.wrap_prm[wrap])) for wrap in wraps]


def ends_of_tendon(planar: PlanarModel, tendon: int) -> Ends:
    """The groups and ends of a straight tendon. Raises Unsupported for another tendon."""
    model, element = planar.model, name_of(planar.model, TENDON, tendon)
    first_wrap, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    if count != 2 or np.any(model.wrap_type[first_wrap : first_wrap + count] != int(mujoco.mjtWrap.mjWRAP_SITE)):
        raise refuse(element, "only a tendon straight between two sites has an ideal counterpart; this one wraps")
    sites = model.wrap_objid[first_wrap : first_wrap + 2]
    begin, end = planar.data.site_xpos[sites]
    if abs((end - begin) @ planar.frame.normal) > PLANAR * max(1.0, model.stat.extent):
        raise refuse(
            element,
            "its two sites are at different distances from the plane, so its length differs from that in the plane",
        )
    first, second = (planar.group(body) for body in model.site_bodyid[sites])
    return first, second, begin, end


def _read_coupling(planar: PlanarModel, index: int, element: str) -> list[Joint]:
    model, curve = planar.model, planar.model.eq_data[index][:5]
    pairs = [(int(model.eq_obj1id[index]), 1.0), (int(model.eq_obj2id[index]), -float(curve[1]))]
    parts = [(joint, factor) for joint, factor in pairs if joint >= 0 and factor]
    moved = planar.data.qpos - model.qpos0
    open_by = sum((factor * moved[planar.qpos_of(joint)] for joint, factor in parts), -curve[0])
    return _read_sum(planar, index, element, parts, float(open_by))


def _read_sum(planar: PlanarModel, index: int, element: str, parts: WeightedJoints, open_by: float) -> list[Joint]:
    if np.any(planar.model.eq_data[index][2:5]):
        raise refuse(element, "a coupling that is not linear has no ideal counterpart here")
    slides = any(planar.model.jnt_type[joint] != HINGE for joint, _ in parts)
    # A smaller gap is rounding in the file, which the reader closes.
    largest = max((abs(factor) for _, factor in parts), default=1.0)
    if abs(open_by) > PRINTED * largest * (max(1.0, float(planar.model.stat.extent)) if slides else 1.0):
        raise refuse(element, f"it is open by {abs(open_by):.2g} {'m' if slides else 'rad'} at the start")
    weights = angle_weights(planar, parts)
    label, groups = planar.new_name(EQUALITY, index), list(weights)
    if slides or len(groups) > 2:
        terms, offset = terms_of(planar, parts)
        return [Coupling(label, terms, offset - open_by)]
    if not groups:
        planar.note(element, "no coordinate changes the sum that it keeps constant")
        return []
    *others, second = groups
    first = others[0] if others else -1
    ratio = -weights[first] / weights[second] if others else 1.0
    turned = planar.angle(second) - ratio * planar.angle(first) - open_by / weights[second]
    if abs(ratio - 1) <= PLANAR:
        return [Drive(label, planar.name(first), planar.name(second), 0.0, turned)]
    return [Gear(label, planar.name(first), planar.name(second), ratio, turned)]


def _read_tendon(planar: PlanarModel, index: int, element: str) -> list[Joint]:
    model, data = planar.model, planar.data
    tendon, other = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    extension = data.ten_length - model.tendon_length0
    open_by = float(extension[tendon] - model.eq_data[index][0])
    parts = wrapped_joints(model, tendon)
    if other >= 0:
        other_parts, share = wrapped_joints(model, other), -float(model.eq_data[index][1])
        if parts is None or other_parts is None:
            reason = "it couples two tendons and one goes through sites; only tendons over joints are read"
            raise refuse(element, reason)
        parts = [*parts, *((joint, share * factor) for joint, factor in other_parts)]
        open_by += share * float(extension[other])
    if parts is not None:
        return _read_sum(planar, index, element, parts, open_by)
    ends = ends_of_tendon(planar, tendon)
    if ends[0] == ends[1]:
        planar.note(element, "its two ends are on one body")
        return []
    if abs(open_by) > PRINTED * max(1.0, model.stat.extent):
        raise refuse(element, f"it is open by {abs(open_by):.2g} m at the start")
    length = float(data.ten_length[tendon]) - open_by
    return [Rod(planar.new_name(EQUALITY, index), *planar.between(*ends), length)]


# Readers of equalities, and descriptions of the ideal counterparts.
EQUALITIES: dict[str, tuple[Callable[[PlanarModel, int, str], list[Joint]], str]] = {
    "connect": (_read_connect, "a pin"),
    "weld": (_read_weld, "a weld; a pin where its torquescale is zero"),
    "joint": (
        _read_coupling,
        "a gear, a fixed angle, or a linear coupling of hinges and slides: mimic joints, rack and pinion",
    ),
    "tendon": (_read_tendon, "a rod between two sites; over joints, of one tendon or of two, a linear coupling"),
}
# Connections of a body with its parent, and descriptions of the ideal counterparts.
TREE_CONNECTIONS = {
    "no joint": "one body with its parent",
    "hinge, slide, both": "a pin, a line and a fixed angle, a line",
    "two slides, alone or with a hinge": "a fixed angle, nothing",
    "free": "nothing, where the body moves in the plane",
    "armature": "inertia where the body alone has it; a drive at the rate of the start where nothing accelerates it",
}
