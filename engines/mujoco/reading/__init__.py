"""The reader of users' MuJoCo models (MJCF, URDF or binary) as planar mechanisms."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import mujoco
import numpy as np

from engines.consistent_start import OpenStart, closed_positions, with_consistent_start
from engines.mujoco.reading.elements import (
    EQUALITIES,
    TENDON,
    TREE_CONNECTIONS,
    drives,
    equalities,
    is_driven,
    tree_joints,
)
from engines.mujoco.reading.forces import ACTUATOR, FORCE_COUNTERPARTS, forces, is_off, turns
from engines.mujoco.reading.frame import (
    FREE,
    HINGE,
    JOINT,
    PLANAR,
    PlanarModel,
    find_bodies,
    find_frame,
    flattened,
    name_of,
)
from engines.mujoco.reading.own_model import OwnMuJoCo, in_state, limited_forces, positions
from engines.mujoco.reading.settings import rewritten, switch_off
from engines.mujoco.running import logged_warnings
from engines.reading import AS_IT_IS, Note, Reading, ReadingTerms, Source, left_out, refuse, refuse_at_start
from reference.checks import InvalidMechanism
from reference.forces import Force

MODEL_SUFFIXES = (".xml", ".mjcf", ".urdf", ".mjb")


def read(model: Any, data: Any = None, without: Sequence[str] = (), closing: bool = True) -> Reading:
    """The mechanism of a mujoco.MjModel in the state of a mujoco.MjData, by default in the model's initial state.

    `without`: kinds of elements to switch off in a copy of the model. `closing`: whether to close gaps that come from
    rounded digits. Raises Unsupported with the name of an element without a planar counterpart. Raises InvalidMechanism
    for a state that violates the equalities of the model.
    """
    planar, users, tilt = _plane_of(model, mujoco.MjData(model) if data is None else data, without)
    joints = [*tree_joints(planar), *drives(planar), *equalities(planar)]
    acting = forces(planar)
    bodies, weights = _with_armature(planar)
    gravity = (0.0, 0.0) if is_off(planar.model, "GRAVITY") else planar.frame.in_plane(planar.model.opt.gravity)
    _note_gravity_across(planar)
    _note_limits_and_contacts(planar)
    for element in without:
        planar.note(element, "switched off as you requested, in your model too")
    elements = bodies, joints, gravity, (*acting, *weights)
    closed = closed_positions(*elements) if closing else None
    if closed is not None:
        planar.data.qpos[:] = positions(planar, closed[0][None])[0]
        reading = read(model, planar.data, without, closing=False)
        return replace(reading, notes=(closed[1], *reading.notes))
    try:
        mechanism, start_notes = with_consistent_start(*elements)
    except OpenStart as reason:
        advice = "MuJoCo pulls it together in its first steps; give a keyframe in which it is closed"
        raise InvalidMechanism(f"{reason}: {advice}") from None
    own_model = OwnMuJoCo(planar, mechanism, users, tilt)
    refuse_at_start(own_model, mechanism)
    return Reading(mechanism, own_model, (*start_notes, *planar.notes), model.names.split(b"\x00")[0].decode())


def _plane_of(model: Any, state: Any, without: Sequence[str]) -> tuple[PlanarModel, Any, float]:
    """The planar model in a state, the model to run, and the largest tilt [rad] of its joints.

    Both models are copies without the elements to switch off. Raises Unsupported if the model does not move in a plane.
    """
    model = copy.copy(model)
    for element in without:
        switch_off(model, element)
    started = in_state(model, state)
    if model.nv == 0:
        raise refuse("the model", "nothing in it can move")
    if model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_SLEEP):
        reason = "MuJoCo stops slow bodies, even a pendulum at its turning point, but joints do not"
        raise refuse("flag sleep", f"{reason}; {left_out('sleep')}")
    _refuse_not_finite(model, started)
    # Contacts and the solver are evaluated later, after a model with too many bodies is refused.
    mujoco.mj_kinematics(model, started)
    mujoco.mj_comPos(model, started)
    frame = find_frame(model, started)
    flat, tilt = flattened(model, frame)
    users, model, tilt = (model, flat, tilt) if tilt > PLANAR else (model, model, 0.0)
    mujoco.mj_kinematics(model, started)
    mujoco.mj_comPos(model, started)
    groups, bodies = find_bodies(model, started, frame)
    mujoco.mj_forward(model, started)
    return PlanarModel(model, started, frame, groups, bodies), users, tilt


def read_object(model: Any, terms: ReadingTerms = AS_IT_IS) -> Reading:
    if terms.step is not None:
        model = copy.copy(model)
        model.opt.timestep = terms.step
    return read(model, None, terms.without)


def _refuse_not_finite(model: Any, data: Any) -> None:
    joints_of_qpos = np.searchsorted(model.jnt_qposadr, np.arange(model.nq), side="right") - 1
    owners_of = (("qpos", JOINT, joints_of_qpos), ("qvel", JOINT, model.dof_jntid), ("ctrl", ACTUATOR, None))
    for name, kind, owners in owners_of:
        values = getattr(data, name)
        for index in np.flatnonzero(~np.isfinite(values)):
            element = name_of(model, kind, index if owners is None else owners[index])
            reason = f"{name} of {element} is {values[index]} at the start; it must be a finite number"
            raise refuse("the model", reason)


def _note_gravity_across(planar: PlanarModel) -> None:
    model = planar.model
    across = 0.0 if is_off(model, "GRAVITY") else float(model.opt.gravity @ planar.frame.normal)
    if abs(across) <= 1e-12 * max(1.0, float(np.linalg.norm(model.opt.gravity))):
        return
    if np.any(model.jnt_type == FREE):
        raise refuse("gravity", "it pulls a free body out of the plane")
    planar.note("gravity", f"{across:g} m/s^2 of it act across the plane, where joints hold the bodies")


def _note_limits_and_contacts(planar: PlanarModel) -> None:
    """Add notes on limits and contacts, which the mechanism does not have and a judged motion must not reach."""
    model, limit = planar.model, "its limit is left out, since it is not reached in the judged motion"
    for element in limited_forces(model):
        planar.note(element, f"its force is limited; {limit}")
    low, high = model.jnt_range.T
    for index in np.flatnonzero((low == high) & (low != 0) & (model.jnt_limited == 0)):
        reason = f"MuJoCo does not limit it, since both ends of its range are {low[index]:g}"
        planar.note(name_of(model, JOINT, index), f"{reason}; an equality would keep it there")
    if is_off(model, "CONSTRAINT"):
        return
    for kind, limited in ((JOINT, model.jnt_limited), (TENDON, model.tendon_limited)):
        for index in np.flatnonzero(limited * (not is_off(model, "LIMIT"))):
            planar.note(name_of(model, kind, index), limit)
    shaped = np.any(model.geom_contype) and np.any(model.geom_conaffinity)
    if not is_off(model, "CONTACT") and model.ngeom > 1 and (shaped or model.npair):
        planar.note("contacts", "they are left out, since none is made in the judged motion")


def _with_armature(planar: PlanarModel) -> tuple[tuple[Any, ...], list[Force]]:
    """Bodies with the inertia of armatures, and forces against the weight of this inertia, since an armature has no
    weight.

    Raises Unsupported for an armature between two moving bodies.
    """
    model, bodies, weights = planar.model, list(planar.bodies), []
    gravity = np.zeros(3) if is_off(model, "GRAVITY") else model.opt.gravity
    for joint in range(model.njnt):
        added = float(model.dof_armature[int(model.jnt_dofadr[joint])])
        if not added or is_driven(planar, joint):
            continue
        group, parent = planar.group_of(joint), planar.parent(joint)
        element, body = name_of(model, JOINT, joint), bodies[group]
        if model.jnt_type[joint] == HINGE and not turns(planar, parent):
            bodies[group] = replace(body, inertia=body.inertia + added)
        elif model.jnt_type[joint] != FREE and parent < 0 and len(planar.joints_of(group)) == 1:
            bodies[group] = replace(body, mass=body.mass + added)
            weight = planar.frame.in_plane(-added * gravity)
            if any(weight):
                label = planar.names.new(f"{body.name}: armature has no weight")
                weights.append(Force(label, body.name, (0.0, 0.0), weight))
        else:
            reason = "its armature is an inertia of a relative motion, which is no property of a body"
            raise refuse(element, f"{reason}; {left_out('armature')}")
    return tuple(bodies), weights


class MuJoCoReader:
    words = "a MuJoCo model (model.xml, model.urdf)"
    elements: ClassVar[Mapping[str, str]] = {
        **TREE_CONNECTIONS,
        **{f"equality {kind}": words for kind, (_, words) in EQUALITIES.items()},
        **FORCE_COUNTERPARTS,
    }

    def reads(self, word: str) -> bool:
        return Path(word).suffix.lower() in MODEL_SUFFIXES

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
        """Raises ValueError for a file that is no model, and Unsupported for a model that is no planar mechanism."""
        path = folder / word
        if path.is_dir():
            raise ValueError(f"{word}: it is a folder")
        if not path.is_file():
            raise ValueError(f"{word}: there is no such file")
        with logged_warnings() as log:
            try:
                if path.suffix.lower() == ".mjb":
                    model = mujoco.MjModel.from_binary_path(str(path))
                else:
                    model = mujoco.MjModel.from_xml_path(str(path))
            except ValueError as error:
                raise ValueError(f"{word}: MuJoCo can't compile it: {' '.join(str(error).split())}") from None
            if terms.step is not None:
                model.opt.timestep = terms.step
            data = mujoco.MjData(model)
            if model.nkey and terms.key != "none":
                mujoco.mj_resetDataKeyframe(model, data, _key(model, terms.key))
            elif terms.key not in ("", "none"):
                raise ValueError(f"--key is {terms.key!r}; {word} has no keyframes")
            reading = read(model, data, terms.without)
        notes = (*reading.notes, *(Note("a warning of MuJoCo's", words) for words in log.messages))
        source = Source(
            path,
            lambda change: rewritten(path.read_bytes(), change),
            lambda other: self.read(other.name, other.parent, replace(terms, step=None)),
        )
        reading = replace(reading, notes=notes, source=None if path.suffix.lower() == ".mjb" else source)
        assert isinstance(reading.model, OwnMuJoCo)
        text = "" if reading.source is None else path.read_text(encoding="utf-8", errors="replace")
        urdf = path.suffix.lower() == ".urdf" and "<mujoco" not in text
        classes = "class=" in text or "<include" in text
        return replace(reading, model=replace(reading.model, urdf=urdf, classes=classes))


def _key(model: Any, key: str) -> int:
    if not key:
        return 0
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_KEY, index) or str(index) for index in range(model.nkey)]
    if key not in names:
        raise ValueError(f"--key is {key!r}; there are {', '.join(names)}, and none")
    return names.index(key)


READER = MuJoCoReader()
