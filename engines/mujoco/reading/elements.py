"""A model while it is read, and what holds its bodies: joints, steady hinges and equalities as ideal joints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.consistent_start import PRINTED
from engines.mujoco.reading.frame import FREE, HINGE, PLANAR, SLIDE, Frame, Groups, name_of, plain_name
from engines.reading import Names, Note, refuse
from reference.couplings import Coupling, Term
from reference.joints import Body, Drive, Gear, Joint, Pin, Rod, Slot, Vector, Weld

Array = NDArray[np.float64]
JOINT, EQUALITY, BODY = mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_EQUALITY, mujoco.mjtObj.mjOBJ_BODY


@dataclass(eq=False)
class Scene:
    """A model in its start, while it is read: what the readers of joints and of forces ask of it."""

    model: Any
    data: Any
    frame: Frame
    groups: Groups
    bodies: tuple[Body, ...]
    names: Names = field(default_factory=Names)
    notes: list[Note] = field(default_factory=list)
    held: dict[int, tuple[Joint, ...]] = field(default_factory=dict)  # by equality: what stands for it

    def group(self, body: int) -> int:
        """The index among the mechanism's bodies, -1 for the ground."""
        return int(self.groups.of[body])

    def name(self, group: int) -> str | None:
        return None if group < 0 else self.bodies[group].name

    def parent(self, joint: int) -> int:
        """The group on which a joint hangs its own."""
        return self.group(int(self.model.body_parentid[self.model.jnt_bodyid[joint]]))

    def own(self, group: int, place: Any) -> Vector:
        """A place of the world (3,) [m] in the frame of a body, or of the ground."""
        x, y = self.frame.in_plane(place)
        if group < 0:
            return x, y
        at_x, at_y, angle = self.bodies[group].pose
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y = x - at_x, y - at_y
        return float(cosine * x + sine * y), float(cosine * y - sine * x)

    def angle(self, group: int) -> float:
        return 0.0 if group < 0 else self.bodies[group].pose[2]

    def direction(self, group: int, axis: Any) -> float:
        """The angle [rad] of a direction of the world in the frame of a body."""
        x, y = self.frame.in_plane(axis)
        return float(np.arctan2(y, x)) - self.angle(group)

    def sign(self, joint: int) -> float:
        return float(np.sign(self.data.xaxis[joint] @ self.frame.normal))

    def joints_of(self, group: int) -> range:
        root = self.groups.roots[group]
        begin = int(self.model.body_jntadr[root])
        return range(begin, begin + int(self.model.body_jntnum[root]))

    def note(self, element: str, reason: str) -> None:
        self.notes.append(Note(element, reason))


def tree_joints(scene: Scene) -> list[Joint]:
    """What hangs every body on its parent."""
    return [joint for group in range(len(scene.bodies)) for joint in _hung(scene, group)]


def _hung(scene: Scene, group: int) -> list[Joint]:
    model, data = scene.model, scene.data
    own = list(scene.joints_of(group))
    kinds = [int(model.jnt_type[index]) for index in own]
    hinges = [index for index in own if model.jnt_type[index] == HINGE]
    slides = [index for index in own if model.jnt_type[index] == SLIDE]
    body = name_of(model, BODY, scene.groups.roots[group])
    if FREE in kinds:
        return []
    if len(hinges) > 1:
        raise refuse(body, "it has two hinges with nothing between them that has a mass")
    across = np.linalg.matrix_rank(np.array([data.xaxis[index] for index in slides]).reshape(-1, 3), tol=PLANAR)
    if across < len(slides):
        raise refuse(body, "two of its slides are parallel")
    parent, second = scene.parent(own[0]), scene.name(group)
    first = scene.name(parent)
    label = scene.names.new(plain_name(model, JOINT, own[0] if not hinges else hinges[0]))
    if len(slides) == 2 and hinges:
        return []
    turned = scene.angle(group) - scene.angle(parent)
    if len(slides) == 2:
        return [Drive(label, first, second, 0.0, turned)]
    if not slides:
        anchor = data.xanchor[hinges[0]]
        return [Pin(label, first, second, scene.own(parent, anchor), scene.own(group, anchor))]
    axis = data.xaxis[slides[0]]
    if not hinges:
        x, y, _ = scene.bodies[group].pose
        centre = scene.frame.both.T @ [x, y]
        line = Slot(label, first, second, scene.own(parent, centre), scene.direction(parent, axis), (0.0, 0.0))
        return [line, Drive(scene.names.new(f"{label}, no turning"), first, second, 0.0, turned)]
    anchor = data.xanchor[hinges[0]]
    if slides[0] < hinges[0]:  # the slide comes first: its line is in the parent
        points = scene.own(parent, anchor), scene.direction(parent, axis), scene.own(group, anchor)
        return [Slot(label, first, second, *points)]
    points = scene.own(group, anchor), scene.direction(group, axis), scene.own(parent, anchor)
    return [Slot(label, second, first, *points)]


# Armature beside the largest inertia that a joint can feel. What is left of an acceleration is the reciprocal: a tenth
# of what the accelerations of engine and judge may differ by at the start.
FAR_ABOVE = 1e7


def steady(scene: Scene, joint: int) -> bool:
    """Whether a joint is a hinge whose rate no force of the model changes."""
    armature = float(scene.model.dof_armature[int(scene.model.jnt_dofadr[joint])])
    return bool(scene.model.jnt_type[joint] == HINGE and armature >= FAR_ABOVE * _largest_inertia(scene))


def drives(scene: Scene) -> list[Drive]:
    """A drive at the rate of the start for every steady hinge, with a note."""
    out = []
    for joint in range(scene.model.njnt):
        if not steady(scene, joint):
            continue
        group, parent = scene.group(int(scene.model.jnt_bodyid[joint])), scene.parent(joint)
        rate = scene.sign(joint) * float(scene.data.qvel[int(scene.model.jnt_dofadr[joint])])
        label = scene.names.new(f"{plain_name(scene.model, JOINT, joint)} turns")
        turned = scene.angle(group) - scene.angle(parent)
        out.append(Drive(label, scene.name(parent), scene.name(group), rate, turned))
        words = f"its armature is so large that nothing accelerates it, so it is taken as driven at {rate:g} rad/s"
        scene.note(name_of(scene.model, JOINT, joint), words)
    return out


def _largest_inertia(scene: Scene) -> float:
    """About the largest inertia that a joint of the model can feel [kg m^2], armatures left out."""
    places = np.array(
        [body.pose[:2] for body in scene.bodies] + [scene.frame.in_plane(at) for at in scene.data.xanchor]
    )
    span = float(np.ptp(places, axis=0).max())
    return sum(body.inertia + body.mass * span**2 for body in scene.bodies)


def equalities(scene: Scene) -> list[Joint]:
    """What closes loops and couples angles."""
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
        reads, _ = EQUALITIES[kind]
        joints = reads(scene, index, element)
        if joints and not len(equality_rows(data, index)):
            scene.note(element, "it holds what the joints hold already, so MuJoCo makes no row of it, nor do we")
            joints = []
        scene.held[index] = tuple(joints)
        out += joints
    return out


def equality_rows(data: Any, index: int) -> NDArray[np.intp]:
    """Which of MuJoCo's rows are of an equality."""
    return np.flatnonzero((data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)) & (data.efc_id == index))


def _ends(scene: Scene, index: int, element: str) -> tuple[int, int, Array, Array]:
    """The two groups, and where each has its point in the world."""
    model, data = scene.model, scene.data
    objects = int(model.eq_obj1id[index]), int(model.eq_obj2id[index])
    if model.eq_objtype[index] == int(mujoco.mjtObj.mjOBJ_SITE):
        bodies = [int(model.site_bodyid[each]) for each in objects]
        places = [data.site_xpos[each] for each in objects]
    else:
        bodies = list(objects)
        parts = (0, 3) if model.eq_type[index] == int(mujoco.mjtEq.mjEQ_CONNECT) else (3, 0)
        points = [model.eq_data[index][part : part + 3] for part in parts]
        places = [
            data.xpos[body] + data.xmat[body].reshape(3, 3) @ point for body, point in zip(bodies, points, strict=True)
        ]
    groups = [scene.group(body) for body in bodies]
    return groups[0], groups[1], places[0], places[1]


def _connected(scene: Scene, index: int, element: str) -> list[Joint]:
    first, second, at, other = _ends(scene, index, element)
    if first == second:
        scene.note(element, "it connects a body with itself")
        return []
    label = scene.names.new(plain_name(scene.model, EQUALITY, index))
    return [Pin(label, scene.name(first), scene.name(second), scene.own(first, at), scene.own(second, other))]


TORQUE_SCALE = 10  # its place in eq_data of a weld


def _welded(scene: Scene, index: int, element: str) -> list[Joint]:
    first, second, at, other = _ends(scene, index, element)
    if first == second:
        scene.note(element, "it welds a body to itself")
        return []
    rows = equality_rows(scene.data, index)
    if np.abs(scene.data.efc_pos[rows]).max(initial=0.0) > PLANAR * max(1.0, scene.model.stat.extent):
        raise refuse(element, f"it is open by {np.abs(scene.data.efc_pos[rows]).max():.2g} m or rad at the start")
    label = scene.names.new(plain_name(scene.model, EQUALITY, index))
    points = scene.own(first, at), scene.own(second, other)
    if scene.model.eq_data[index][TORQUE_SCALE] == 0:
        scene.note(element, "it holds a point and no angle, since its torquescale is zero")
        return [Pin(label, scene.name(first), scene.name(second), *points)]
    turned = scene.angle(second) - scene.angle(first)
    return [Weld(label, scene.name(first), scene.name(second), *points, turned)]


def is_turned_with(scene: Scene, joint: int) -> bool:
    """Whether a slide's line is in its own body, which a hinge before it turns. Raises Unsupported for a hinge between
    two slides.
    """
    own = scene.joints_of(scene.group(int(scene.model.jnt_bodyid[joint])))
    hinges = [each for each in own if scene.model.jnt_type[each] == HINGE]
    slides = [each for each in own if scene.model.jnt_type[each] == SLIDE]
    if hinges and slides[0] < hinges[0] < slides[-1]:
        raise refuse(
            name_of(scene.model, JOINT, joint),
            "its body turns between two slides, of which no sum is read; give the slides a body of their own",
        )
    return bool(hinges) and hinges[0] < slides[0]


def term_of(scene: Scene, joint: int, factor: float) -> Term:
    """factor times a joint's coordinate, but for a constant."""
    model, data = scene.model, scene.data
    group, parent = scene.group(int(model.jnt_bodyid[joint])), scene.parent(joint)
    first, second = scene.name(parent), scene.name(group)
    if model.jnt_type[joint] == HINGE:
        return Term(first, second, factor * scene.sign(joint))
    own = list(scene.joints_of(group))
    slides = [each for each in own if model.jnt_type[each] == SLIDE]
    at = next((data.xanchor[each] for each in own if model.jnt_type[each] == HINGE), None)
    at = scene.frame.both.T @ scene.bodies[group].pose[:2] if at is None else at
    # Of two slides each is told by the direction across the other.
    axes = np.array([scene.frame.in_plane(data.xaxis[each]) for each in slides])
    x, y = np.linalg.pinv(axes)[:, slides.index(joint)]
    along, size = scene.frame.both.T @ [x, y], float(np.hypot(x, y))
    here, there = scene.own(group, at), scene.own(parent, at)
    if is_turned_with(scene, joint):
        return Term(second, first, -factor * size, True, here, scene.direction(group, along), there)
    return Term(first, second, factor * size, True, there, scene.direction(parent, along), here)


def terms_of(scene: Scene, parts: list[tuple[int, float]]) -> tuple[tuple[Term, ...], float]:
    """A sum of joints' coordinates as terms, and its value at the start."""
    terms = tuple(term_of(scene, joint, factor) for joint, factor in parts)
    pose = {body.name: np.array(body.pose) for body in scene.bodies} | {None: np.zeros(3)}
    return terms, float(sum(term.value(pose[term.first], pose[term.second]) for term in terms))


def angle_weights(scene: Scene, parts: list[tuple[int, float]]) -> dict[int, float]:
    """How much the angle of each body adds to a sum of hinge coordinates; bodies that add nothing are left out."""
    weights: dict[int, float] = {}
    for joint, factor in parts:
        for group, sign in ((scene.group(int(scene.model.jnt_bodyid[joint])), 1.0), (scene.parent(joint), -1.0)):
            if group >= 0:
                weights[group] = weights.get(group, 0.0) + sign * factor * scene.sign(joint)
    return {group: weight for group, weight in sorted(weights.items()) if abs(weight) > PLANAR}


def wrapped_joints(model: Any, tendon: int) -> list[tuple[int, float]] | None:
    """The joints of a fixed tendon with their coefficients; None of a spatial one."""
    begin, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    if np.any(model.wrap_type[begin : begin + count] != int(mujoco.mjtWrap.mjWRAP_JOINT)):
        return None
    return [(int(model.wrap_objid[each]), float(model.wrap_prm[each])) for each in range(begin, begin + count)]


def straight(scene: Scene, tendon: int) -> tuple[int, int, Array, Array]:
    """The two groups that a spatial tendon joins, and its ends in the world. Raises Unsupported if it wraps."""
    model, data = scene.model, scene.data
    element = name_of(model, mujoco.mjtObj.mjOBJ_TENDON, tendon)
    begin, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    if count != 2 or np.any(model.wrap_type[begin : begin + count] != int(mujoco.mjtWrap.mjWRAP_SITE)):
        raise refuse(element, "only a tendon straight between two sites has an ideal counterpart; this one wraps")
    sites = [int(site) for site in model.wrap_objid[begin : begin + 2]]
    places = [data.site_xpos[site] for site in sites]
    if abs((places[1] - places[0]) @ scene.frame.normal) > PLANAR * max(1.0, model.stat.extent):
        raise refuse(element, "its two sites are at different distances from the plane, so its length is not ours")
    first, second = (scene.group(int(model.site_bodyid[site])) for site in sites)
    return first, second, places[0], places[1]


def _coupled(scene: Scene, index: int, element: str) -> list[Joint]:
    """Angles of bodies that a coupling of hinges holds in a linear relation: of one body, or of two."""
    model, data = scene.model, scene.data
    curve = model.eq_data[index][:5]
    pairs = [(int(model.eq_obj1id[index]), 1.0), (int(model.eq_obj2id[index]), -float(curve[1]))]
    parts = [(joint, factor) for joint, factor in pairs if joint >= 0 and factor]
    wrong = -curve[0]
    for joint, factor in parts:
        place = int(model.jnt_qposadr[joint])
        wrong += factor * (data.qpos[place] - model.qpos0[place])
    return _held_angles(scene, index, element, parts, float(wrong))


def _held_angles(scene: Scene, index: int, element: str, parts: list[tuple[int, float]], wrong: float) -> list[Joint]:
    model = scene.model
    if np.any(model.eq_data[index][2:5]):
        raise refuse(element, "a coupling that is not linear has no ideal counterpart here")
    slides = any(model.jnt_type[joint] != HINGE for joint, _ in parts)
    # A smaller one is that of rounded digits, which the reading closes.
    largest = max((abs(factor) for _, factor in parts), default=1.0)
    if abs(wrong) > PRINTED * largest * (max(1.0, float(model.stat.extent)) if slides else 1.0):
        raise refuse(element, f"it is open by {abs(wrong):.2g} {'m' if slides else 'rad'} at the start")
    weights = angle_weights(scene, parts)
    label = scene.names.new(plain_name(model, EQUALITY, index))
    groups = list(weights)
    if slides or len(groups) > 2:
        terms, offset = terms_of(scene, parts)
        return [Coupling(label, terms, offset - wrong)]
    if len(groups) == 1:
        held = scene.angle(groups[0]) - wrong / weights[groups[0]]
        return [Drive(label, None, scene.name(groups[0]), 0.0, held)]
    if not groups:
        scene.note(element, "the sum that it holds does not change")
        return []
    first, second = groups
    ratio = -weights[first] / weights[second]
    turned = scene.angle(second) - ratio * scene.angle(first) - wrong / weights[second]
    if abs(ratio - 1) <= PLANAR:
        return [Drive(label, scene.name(first), scene.name(second), 0.0, turned)]
    return [Gear(label, scene.name(first), scene.name(second), ratio, turned)]


def _tied(scene: Scene, index: int, element: str) -> list[Joint]:
    """A tendon of constant length: a rod between two sites, or a sum of angles."""
    model, data = scene.model, scene.data
    tendon = int(model.eq_obj1id[index])
    wrong = float(data.ten_length[tendon] - model.tendon_length0[tendon] - model.eq_data[index][0])
    parts = wrapped_joints(model, tendon)
    if (other := int(model.eq_obj2id[index])) >= 0:
        more, share = wrapped_joints(model, other), -float(model.eq_data[index][1])
        if parts is None or more is None:
            raise refuse(
                element, "it couples two tendons of which one goes through sites; only those over joints are read"
            )
        wrong += share * float(data.ten_length[other] - model.tendon_length0[other])
        return _held_angles(scene, index, element, [*parts, *((joint, share * by) for joint, by in more)], wrong)
    if parts is not None:
        return _held_angles(scene, index, element, parts, wrong)
    first, second, at, end = straight(scene, tendon)
    if first == second:
        scene.note(element, "its two ends are on one body")
        return []
    if abs(wrong) > PRINTED * max(1.0, model.stat.extent):
        raise refuse(element, f"it is open by {abs(wrong):.2g} m at the start")
    label = scene.names.new(plain_name(model, EQUALITY, index))
    points = scene.own(first, at), scene.own(second, end)
    return [Rod(label, scene.name(first), scene.name(second), *points, float(data.ten_length[tendon]) - wrong)]


# By the kind of an equality: what reads it, and as what.
EQUALITIES = {
    "connect": (_connected, "a pin"),
    "weld": (_welded, "a weld; a pin where its torquescale is zero"),
    "joint": (
        _coupled,
        "a gear, a fixed angle, or a linear coupling of hinges and slides: mimic joints, rack and pinion",
    ),
    "tendon": (_tied, "a rod between two sites; over joints, of one tendon or of two, a linear coupling"),
}
# What hangs a body on its parent.
JOINTS = {
    "no joint": "one body with its parent",
    "hinge, slide, both": "a pin, a line and a fixed angle, a line",
    "two slides, alone or with a hinge": "a fixed angle, nothing",
    "free": "nothing, where the body moves in the plane",
    "armature": "inertia where the body alone has it; a drive at the rate of the start where nothing accelerates it",
}
