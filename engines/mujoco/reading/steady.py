"""Hinges that nothing can accelerate, by an armature far above every inertia: MuJoCo's way to prescribe a rotation."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import numpy as np

from engines.mujoco.reading.frame import HINGE, name_of, plain_name
from engines.mujoco.reading.joints import JOINT, Scene
from reference.joints import Drive

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
