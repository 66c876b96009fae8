"""A model while it is read, and its joints, steady hinges and equalities as ideal joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.consistent_start import PRINTED
from engines.mujoco.reading.frame import (
    BODY,
    FREE,
    HINGE,
    JOINT,
    PLANAR,
    SLIDE,
    PlanarModel,
    name_of,
    plain_name,
)
from engines.reading import refuse
from reference.couplings import Coupling, Term
from reference.joints import Drive, Gear, Joint, Pin, Rod, Slot, Weld

Array = NDArray[np.float64]
Ends = tuple[int, int, Array, Array]  # two groups, and their points in the world [m]
Parts = Sequence[tuple[int, float]]  # joints of the model, and their factors in a sum of coordinates
EQUALITY, TENDON = mujoco.mjtObj.mjOBJ_EQUALITY, mujoco.mjtObj.mjOBJ_TENDON
# The armature beside the largest inertia that a joint can feel, from which on a hinge counts as driven. The remaining
# acceleration is the reciprocal: a tenth of what the accelerations of engine and judge may differ by at the start.
FAR_ABOVE = 1e7
TORQUE_SCALE = 10  # its index in eq_data of a weld


def tree_joints(scene: PlanarModel) -> list[Joint]:
    """The joints of each body with its parent."""
    return [joint for group in range(len(scene.bodies)) for joint in _joints_with_parent(scene, group)]


def _joints_with_parent(scene: PlanarModel, group: int) -> list[Joint]:
    data, hinges, slides = scene.data, scene.joints_of(group, HINGE), scene.joints_of(group, SLIDE)
    body = name_of(scene.model, BODY, scene.groups.roots[group])
    if len(hinges) > 1:
        raise refuse(body, "it has two hinges with nothing between them that has a mass")
    if np.linalg.matrix_rank(data.xaxis[slides].reshape(-1, 3), tol=PLANAR) < len(slides):
        raise refuse(body, "two of its slides are parallel")
    if scene.joints_of(group, FREE) or (len(slides) == 2 and hinges):
        return []
    joints = hinges or slides
    parent = scene.parent(joints[0])
    label, names = scene.new_name(JOINT, joints[0]), (scene.name(parent), scene.name(group))
    if len(slides) == 2:
        return [Drive(label, *names, 0.0, scene.turned(parent, group))]
    if not slides:
        anchor = data.xanchor[hinges[0]]
        return [Pin(label, *scene.between(parent, group, anchor, anchor))]
    axis = data.xaxis[slides[0]]
    if not hinges:
        line = scene.in_body(parent, scene.centre(group)), scene.direction(parent, axis), (0.0, 0.0)
        turned = scene.turned(parent, group)
        return [Slot(label, *names, *line), Drive(scene.names.new(f"{label}, no turning"), *names, 0.0, turned)]
    anchor = data.xanchor[hinges[0]]
    # The line is in the parent if the slide comes first.
    first, second = (parent, group) if slides[0] < hinges[0] else (group, parent)
    line = scene.in_body(first, anchor), scene.direction(first, axis), scene.in_body(second, anchor)
    return [Slot(label, scene.name(first), scene.name(second), *line)]


def is_steady(scene: PlanarModel, joint: int) -> bool:
    """Whether a joint is a hinge whose rate no force of the model changes."""
    armature = float(scene.model.dof_armature[int(scene.model.jnt_dofadr[joint])])
    points = np.array(
        [body.pose[:2] for body in scene.bodies] + [scene.frame.in_plane(at) for at in scene.data.xanchor]
    )
    span = float(np.ptp(points, axis=0).max())
    largest = sum(body.inertia + body.mass * span**2 for body in scene.bodies)  # that a joint can feel, armatures apart
    return bool(scene.model.jnt_type[joint] == HINGE and armature >= FAR_ABOVE * largest)


def drives(scene: PlanarModel) -> list[Drive]:
    """A drive at the rate of the start for every steady hinge, with a note."""
    out = []
    for joint in range(scene.model.njnt):
        if not is_steady(scene, joint):
            continue
        group, parent = scene.group_of(joint), scene.parent(joint)
        rate = float(scene.groups.signs[joint]) * float(scene.data.qvel[int(scene.model.jnt_dofadr[joint])])
        label = scene.names.new(f"{plain_name(scene.model, JOINT, joint)} turns")
        out.append(Drive(label, scene.name(parent), scene.name(group), rate, scene.turned(parent, group)))
        words = f"its armature is so large that nothing accelerates it, so it is taken as driven at {rate:g} rad/s"
        scene.note(name_of(scene.model, JOINT, joint), words)
    return out


def equalities(scene: PlanarModel) -> list[Joint]:
    """The ideal joints of the model's equalities, which close loops and couple coordinates."""
    model, data = scene.model, scene.data
    off = mujoco.mjtDisableBit.mjDSBL_EQUALITY | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    out: list[Joint] = []
    for index in range(model.neq):
        element = name_of(model, EQUALITY, index)
        if not data.eq_active[index] or model.opt.disableflags & int(off):
            scene.note(element, "it is switched off")
            continue
        kind = mujoco.mjtEq(int(model.eq_type[index])).name.split("_")[1].lower()
        if kind not in EQUALITIES:
            raise refuse(element, f"an equality of the kind {kind} has no ideal counterpart here")
        read_equality, _ = EQUALITIES[kind]
        joints = read_equality(scene, index, element)
        if joints and not len(equality_rows(data, index)):
            scene.note(element, "it holds what the joints hold already, so MuJoCo makes no row of it, nor do we")
            joints = []
        scene.held[index] = tuple(joints)
        out += joints
    return out


def equality_rows(data: Any, index: int) -> NDArray[np.intp]:
    """The indices of an equality's rows in MuJoCo's."""
    return np.flatnonzero((data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)) & (data.efc_id == index))


def _ends(scene: PlanarModel, index: int) -> Ends:
    """The two groups of a connect or a weld, and the point of each in the world."""
    model, data = scene.model, scene.data
    objects = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    if model.eq_objtype[index] == int(mujoco.mjtObj.mjOBJ_SITE):
        first, second = (scene.group(model.site_bodyid[site]) for site in objects)
        return first, second, *(data.site_xpos[site] for site in objects)
    parts = (0, 3) if model.eq_type[index] == int(mujoco.mjtEq.mjEQ_CONNECT) else (3, 0)
    points = (
        data.xpos[body] + data.xmat[body].reshape(3, 3) @ model.eq_data[index][part : part + 3]
        for body, part in zip(objects, parts, strict=True)
    )
    return scene.group(objects[0]), scene.group(objects[1]), *points


def _read_connect(scene: PlanarModel, index: int, element: str) -> list[Joint]:
    ends = _ends(scene, index)
    if ends[0] == ends[1]:
        scene.note(element, "it holds a body to itself")
        return []
    return [Pin(scene.new_name(EQUALITY, index), *scene.between(*ends))]


def _read_weld(scene: PlanarModel, index: int, element: str) -> list[Joint]:
    ends = _ends(scene, index)
    rows = equality_rows(scene.data, index)
    open_by = np.abs(scene.data.efc_pos[rows]).max(initial=0.0)
    if ends[0] != ends[1] and open_by > PLANAR * max(1.0, scene.model.stat.extent):
        raise refuse(element, f"it is open by {open_by:.2g} m or rad at the start")
    pins = _read_connect(scene, index, element)
    if not pins or scene.model.eq_data[index][TORQUE_SCALE]:
        turned = scene.turned(*ends[:2])
        return [Weld(pin.name, *scene.between(*ends), turned) for pin in pins]
    scene.note(element, "it holds a point and no angle, since its torquescale is zero")
    return pins


def _term(scene: PlanarModel, joint: int, factor: float) -> Term:
    """factor times a joint's coordinate, except for a constant. Raises Unsupported for a hinge between two slides."""
    data, group, parent = scene.data, scene.group_of(joint), scene.parent(joint)
    if scene.model.jnt_type[joint] == HINGE:
        return Term(scene.name(parent), scene.name(group), factor * float(scene.groups.signs[joint]))
    hinges, slides = scene.joints_of(group, HINGE), scene.joints_of(group, SLIDE)
    if hinges and slides[0] < hinges[0] < slides[-1]:
        reason = "its body turns between two slides, of which no sum is read; give the slides a body of their own"
        raise refuse(name_of(scene.model, JOINT, joint), reason)
    at = data.xanchor[hinges[0]] if hinges else scene.centre(group)
    # With two slides, the coordinate of one is measured along the direction across the other.
    axes = np.array([scene.frame.in_plane(data.xaxis[slide]) for slide in slides])
    x, y = np.linalg.pinv(axes)[:, slides.index(joint)]
    along, size = scene.frame.both.T @ [x, y], float(np.hypot(x, y))
    first, second, sign = parent, group, 1.0
    if hinges and hinges[0] < slides[0]:  # the hinge turns the line
        first, second, sign = group, parent, -1.0
    line = scene.in_body(first, at), scene.direction(first, along), scene.in_body(second, at)
    return Term(scene.name(first), scene.name(second), sign * factor * size, True, *line)


def terms_of(scene: PlanarModel, parts: Parts) -> tuple[tuple[Term, ...], float]:
    """A sum of joints' coordinates as terms, and its value at the start."""
    terms = tuple(_term(scene, joint, factor) for joint, factor in parts)
    pose = {body.name: np.array(body.pose) for body in scene.bodies} | {None: np.zeros(3)}
    return terms, float(sum(term.value(pose[term.first], pose[term.second]) for term in terms))


def angle_weights(scene: PlanarModel, parts: Parts) -> dict[int, float]:
    """The factor of each body's angle in a sum of hinge coordinates; bodies with none are left out."""
    weights: dict[int, float] = {}
    for joint, factor in parts:
        for group, sign in ((scene.group_of(joint), 1.0), (scene.parent(joint), -1.0)):
            if group >= 0:
                weights[group] = weights.get(group, 0.0) + sign * factor * float(scene.groups.signs[joint])
    return {group: weight for group, weight in sorted(weights.items()) if abs(weight) > PLANAR}


def wrapped_joints(model: Any, tendon: int) -> list[tuple[int, float]] | None:
    """The joints of a fixed tendon with their coefficients; None of a spatial one."""
    wraps = range(int(model.tendon_adr[tendon]), int(model.tendon_adr[tendon] + model.tendon_num[tendon]))
    if np.any(model.wrap_type[wraps] != int(mujoco.mjtWrap.mjWRAP_JOINT)):
        return None
    return [(int(model.wrap_objid[wrap]), float(model.wrap_prm[wrap])) for wrap in wraps]


def straight(scene: PlanarModel, tendon: int) -> Ends:
    """The two groups that a spatial tendon joins, and its ends in the world. Raises Unsupported if it wraps."""
    model, element = scene.model, name_of(scene.model, TENDON, tendon)
    begin, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    if count != 2 or np.any(model.wrap_type[begin : begin + count] != int(mujoco.mjtWrap.mjWRAP_SITE)):
        raise refuse(element, "only a tendon straight between two sites has an ideal counterpart; this one wraps")
    sites = model.wrap_objid[begin : begin + 2]
    at, end = scene.data.site_xpos[sites]
    if abs((end - at) @ scene.frame.normal) > PLANAR * max(1.0, model.stat.extent):
        raise refuse(element, "its two sites are at different distances from the plane, so its length is not ours")
    first, second = (scene.group(body) for body in model.site_bodyid[sites])
    return first, second, at, end


def _read_coupling(scene: PlanarModel, index: int, element: str) -> list[Joint]:
    """Coordinates of two joints, or of one, in a linear relation."""
    model, curve = scene.model, scene.model.eq_data[index][:5]
    pairs = [(int(model.eq_obj1id[index]), 1.0), (int(model.eq_obj2id[index]), -float(curve[1]))]
    parts = [(joint, factor) for joint, factor in pairs if joint >= 0 and factor]
    moved = scene.data.qpos - model.qpos0
    open_by = sum((factor * moved[scene.qpos_of(joint)] for joint, factor in parts), -curve[0])
    return _read_sum(scene, index, element, parts, float(open_by))


def _read_sum(scene: PlanarModel, index: int, element: str, parts: Parts, open_by: float) -> list[Joint]:
    """A sum of joints' coordinates that an equality holds, and that is `open_by` [m or rad] at the start."""
    if np.any(scene.model.eq_data[index][2:5]):
        raise refuse(element, "a coupling that is not linear has no ideal counterpart here")
    slides = any(scene.model.jnt_type[joint] != HINGE for joint, _ in parts)
    # A smaller one is that of rounded digits, which the reading closes.
    largest = max((abs(factor) for _, factor in parts), default=1.0)
    if abs(open_by) > PRINTED * largest * (max(1.0, float(scene.model.stat.extent)) if slides else 1.0):
        raise refuse(element, f"it is open by {abs(open_by):.2g} {'m' if slides else 'rad'} at the start")
    weights = angle_weights(scene, parts)
    label, groups = scene.new_name(EQUALITY, index), list(weights)
    if slides or len(groups) > 2:
        terms, offset = terms_of(scene, parts)
        return [Coupling(label, terms, offset - open_by)]
    if not groups:
        scene.note(element, "the sum that it holds does not change")
        return []
    *others, second = groups
    first = others[0] if others else -1
    ratio = -weights[first] / weights[second] if others else 1.0
    turned = scene.angle(second) - ratio * scene.angle(first) - open_by / weights[second]
    if abs(ratio - 1) <= PLANAR:
        return [Drive(label, scene.name(first), scene.name(second), 0.0, turned)]
    return [Gear(label, scene.name(first), scene.name(second), ratio, turned)]


def _read_tendon(scene: PlanarModel, index: int, element: str) -> list[Joint]:
    """A tendon of constant length: a rod between two sites, or a sum of coordinates."""
    model, data = scene.model, scene.data
    tendon, other = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    longer = data.ten_length - model.tendon_length0
    open_by = float(longer[tendon] - model.eq_data[index][0])
    parts = wrapped_joints(model, tendon)
    if other >= 0:
        more, share = wrapped_joints(model, other), -float(model.eq_data[index][1])
        if parts is None or more is None:
            reason = "it couples two tendons of which one goes through sites; only those over joints are read"
            raise refuse(element, reason)
        parts, open_by = [*parts, *((joint, share * by) for joint, by in more)], open_by + share * float(longer[other])
    if parts is not None:
        return _read_sum(scene, index, element, parts, open_by)
    ends = straight(scene, tendon)
    if ends[0] == ends[1]:
        scene.note(element, "its two ends are on one body")
        return []
    if abs(open_by) > PRINTED * max(1.0, model.stat.extent):
        raise refuse(element, f"it is open by {abs(open_by):.2g} m at the start")
    length = float(data.ten_length[tendon]) - open_by
    return [Rod(scene.new_name(EQUALITY, index), *scene.between(*ends), length)]


# The reader of each kind of equality, and the ideal joint that it is read as.
EQUALITIES: dict[str, tuple[Callable[[PlanarModel, int, str], list[Joint]], str]] = {
    "connect": (_read_connect, "a pin"),
    "weld": (_read_weld, "a weld; a pin where its torquescale is zero"),
    "joint": (
        _read_coupling,
        "a gear, a fixed angle, or a linear coupling of hinges and slides: mimic joints, rack and pinion",
    ),
    "tendon": (_read_tendon, "a rod between two sites; over joints, of one tendon or of two, a linear coupling"),
}
# What hangs a body on its parent.
JOINTS = {
    "no joint": "one body with its parent",
    "hinge, slide, both": "a pin, a line and a fixed angle, a line",
    "two slides, alone or with a hinge": "a fixed angle, nothing",
    "free": "nothing, where the body moves in the plane",
    "armature": "inertia where the body alone has it; a drive at the rate of the start where nothing accelerates it",
}
