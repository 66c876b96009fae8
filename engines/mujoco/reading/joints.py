"""A model while it is read, and MuJoCo's joints as ideal ones: hinges, slides, both, none."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.frame import FREE, HINGE, PLANAR, SLIDE, Frame, Groups, name_of, plain_name
from engines.reading import Names, Note, refuse
from reference.joints import Body, Drive, Joint, Pin, Slot, Vector

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
