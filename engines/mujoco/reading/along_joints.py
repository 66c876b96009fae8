"""Springs, dampers and constant forces along a joint's own coordinate, as force elements of the plane."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines.mujoco.reading.frame import FREE, HINGE, SLIDE, name_of
from engines.mujoco.reading.joints import JOINT, Scene
from engines.reading import Obstacle, refuse
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring

FAR = 30.0  # extents of the model: where the far end of a spring along a slide stands


def off(model: Any, word: str) -> bool:
    """Whether a flag of the model switches this off."""
    return bool(model.opt.disableflags & int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{word}", 0)))


def sprung(scene: Scene, joint: int, name: str, stiffness: float, rest: float) -> list[ForceElement]:
    """A spring of a joint's coordinate, at ease at `rest` [m or rad]."""
    if not stiffness:
        return []
    if stiffness < 0:
        raise refuse(name_of(scene.model, JOINT, joint), "a spring of negative stiffness has no counterpart here")
    model, group, parent = scene.model, scene.group(int(scene.model.jnt_bodyid[joint])), scene.parent(joint)
    way = rest - float(scene.data.qpos[int(model.jnt_qposadr[joint])])
    label, ends = scene.names.new(f"{name} spring"), (scene.name(parent), scene.name(group))
    if model.jnt_type[joint] == HINGE:
        turned = scene.angle(group) - scene.angle(parent)
        return [TorsionSpring(label, *ends, stiffness, turned + scene.sign(joint) * way)]
    far, near, length = _along(scene, joint)
    return [Spring(label, *ends, scene.own(parent, far), scene.own(group, near), stiffness, length + way)]


def damped(scene: Scene, joint: int, name: str, damping: float) -> list[ForceElement]:
    """A damper of a joint's coordinate."""
    if not damping:
        return []
    if damping < 0:
        raise refuse(name_of(scene.model, JOINT, joint), "a negative damping has no counterpart here")
    group, parent = scene.group(int(scene.model.jnt_bodyid[joint])), scene.parent(joint)
    label, ends = scene.names.new(f"{name} damper"), (scene.name(parent), scene.name(group))
    if scene.model.jnt_type[joint] == HINGE:
        return [TorsionDamper(label, *ends, damping)]
    far, near, _ = _along(scene, joint)
    return [Damper(label, *ends, scene.own(parent, far), scene.own(group, near), damping)]


def _along(scene: Scene, joint: int) -> tuple[Any, Any, float]:
    """Ends in the world, far behind on the parent and on the body, between which the distance is that of the slide."""
    model, data = scene.model, scene.data
    own = list(scene.joints_of(scene.group(int(model.jnt_bodyid[joint]))))
    others = [each for each in own if each != joint]
    if any(model.jnt_type[each] == SLIDE for each in others) or any(each < joint for each in others):
        reason = "a force along a slide needs a body that slides once, in a direction of its parent"
        raise refuse(name_of(model, JOINT, joint), reason)
    near = data.xanchor[others[0]] if others else data.xipos[int(model.jnt_bodyid[joint])]
    length = FAR * max(1.0, float(model.stat.extent))
    return near - length * data.xaxis[joint], near, length


def beyond_springs(scene: Scene, t: Any, places: Any) -> Obstacle | None:
    """When a motion of positions (times, nq) comes near the far end of a spring or damper along a slide, if it does."""
    model, length = scene.model, FAR * max(1.0, float(scene.model.stat.extent))
    for joint in np.flatnonzero(model.jnt_type == SLIDE):
        if model.jnt_stiffness[joint] or model.dof_damping[model.jnt_dofadr[joint]]:
            way = places[:, model.jnt_qposadr[joint]] - scene.data.qpos[model.jnt_qposadr[joint]]
            if np.any(way < -0.9 * length):
                words = f"{name_of(model, JOINT, int(joint))} slides further than the spring that stands for its own"
                at = float(t[int(np.argmax(way < -0.9 * length))])
                return Obstacle(at, words, "--without spring and --without damper")
    return None


def pushed(scene: Scene, joint: int, name: str, push: float) -> list[ForceElement]:
    """A constant force or torque along a joint's coordinate."""
    if not push:
        return []
    model, group, parent = scene.model, scene.group(int(scene.model.jnt_bodyid[joint])), scene.parent(joint)
    label, second = scene.names.new(name), scene.name(group)
    assert second is not None
    if model.jnt_type[joint] == HINGE:
        return [Torque(label, scene.name(parent), second, scene.sign(joint) * push)]
    if turns(scene, parent):
        raise refuse(name, "a force along a slide of a body that turns is not constant in the plane")
    if any(each < joint and model.jnt_type[each] == HINGE for each in scene.joints_of(group)):
        raise refuse(name, "a force along a slide that turns with its body is not constant in the plane")
    along = push * scene.data.xaxis[joint]
    at = scene.data.xipos[int(model.jnt_bodyid[joint])]
    at = next((scene.data.xanchor[each] for each in scene.joints_of(group) if model.jnt_type[each] == HINGE), at)
    out: list[ForceElement] = [Force(label, second, scene.own(group, at), scene.frame.in_plane(along))]
    first = scene.name(parent)
    if first is not None:
        against = scene.names.new(f"{name}, on {first}")
        out.append(Force(against, first, scene.own(parent, at), scene.frame.in_plane(-along)))
    return out


def turns(scene: Scene, group: int) -> bool:
    """Whether a body can turn."""
    while group >= 0:
        joints = scene.joints_of(group)
        if any(scene.model.jnt_type[joint] in (HINGE, FREE) for joint in joints):
            return True
        group = scene.parent(joints[0])
    return False
