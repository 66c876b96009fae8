"""The data of a live scene for a page: models, exact motions and drawings for each position of the sliders.

The exact motions and Munk2D's spaces are doubles in base64. The motions of engines in Python are stored answers.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.mujoco.stiffness import Shipped
from reference.couplings import Coupling
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.tasks import Answer, Motion
from reports.site import drawn
from reports.site.drawn import between, index_of, joints_of, loose, measure_of, place_of, required_friction
from reports.site.live.models import mujoco_text, space_of
from reports.site.live.sliders import ENGINES, NAMES, Live, Name

DIGITS = 6  # decimal places of forces and their points
PACKAGES: dict[Name, str] = {"munk": "pymunk", "mujoco": "mujoco-core"}


def data(live: Live, answers: Mapping[Motion, Answer]) -> dict[str, Any]:
    """Return the data of a live scene for JSON. A list over slider positions has the order of `Live.places`.

    The page integrates the equations of pinned linkages. The data of these mechanisms contain the exact motion only for
    the initial positions of the sliders. The pose and the twist of a body are six numbers.
    """
    mechanism = live.scene.mechanism()
    positions = [(scene, scene.mechanism()) for scene in live.places()]
    mechanisms = [mechanism for _, mechanism in positions]
    models: dict[Name, list[Any]] = {
        name: [_models(name, engine, live, mechanisms) for _, engine in live.methods(name)] for name in ENGINES
    }
    stored = {key: answers.get(motion) for key, motion in live.stored().items()}
    return {
        "measure": measure_of(mechanism),
        "frames": live.frames,
        "window": live.window or (0, live.frames),
        "duration": live.scene.duration,
        "bodies": [body.name for body in mechanism.bodies],
        "centre": None if live.centre is None else mechanism.body_index(live.centre),
        "places": [_place(live, scene, mechanism) for scene, mechanism in positions],
        **models,
        "native": {
            name: [_native(stored.get((name, index)), method) for index, method in enumerate(methods)]
            for name, methods in models.items()
        },
        "versions": {name: f"{NAMES[name]} {version(package)}" for name, package in PACKAGES.items()},
    }


def _place(live: Live, scene: Scene, mechanism: Mechanism) -> dict[str, Any]:
    pinned = all(isinstance(joint, Pin | Slot | Drive) for joint in mechanism.joints)
    has_motion = not pinned or scene == live.scene
    truth = scene.motion(np.arange(live.frames + 1) * (scene.duration / live.frames))
    blades = [joint for joint in mechanism.joints if isinstance(joint, Skate)]
    traces = live.traces or [(str(blade.second), blade.second_point) for blade in blades]
    return {
        "inertia": [value for body in mechanism.bodies for value in (body.mass, body.mass, body.inertia)],
        "gravity": list(mechanism.gravity),
        "equations": _equations(mechanism) if pinned else None,
        "truth": packed(np.concatenate([truth.pose, truth.twist], axis=-1)) if has_motion else None,
        "forces": forces(mechanism, truth) if has_motion else None,
        "drawing": drawing(live, mechanism, truth.pose),
        "joints": joints_of(mechanism),
        "blades": [
            {
                "name": blade.name,
                "body": mechanism.body_index(str(blade.second)),
                "point": blade.second_point,
                "angle": blade.angle,
            }
            for blade in blades
        ],
        "traces": [{"body": mechanism.body_index(body), "point": point} for body, point in traces],
    }


def _equations(mechanism: Mechanism) -> dict[str, Any]:
    """Return the input of the page's exact solver, without inertia, gravity and joints."""
    drives = [joint for joint in mechanism.joints if isinstance(joint, Drive)]
    return {
        "pose": mechanism.pose.ravel().tolist(),
        "twist": mechanism.twist.ravel().tolist(),
        "drives": [
            {
                "first": index_of(mechanism, drive.first),
                "second": index_of(mechanism, drive.second),
                "rate": drive.turning_rate,
            }
            for drive in drives
        ],
    }


def forces(mechanism: Mechanism, truth: Trajectory) -> list[dict[str, Any]]:
    """Return the reaction of each joint on its second body: the point [m] and the force [N], as flat lists of pairs.

    A rolling contact also has the required friction coefficient [1]. A drive has no entry, since its reaction is a
    torque. `partly`: whether the motion determines only one component of the force.
    """
    out, row = [], 0
    for joint in mechanism.joints:
        reaction = truth.reaction[:, row : row + joint.size]
        row += joint.size
        finite = np.isfinite(reaction)
        if isinstance(joint, Drive | Coupling) or not (finite.any() or isinstance(joint, Roll)):
            continue
        first, second = between(mechanism, joint, truth.pose)
        across = joint.rows(first, second)[..., 3:5]
        entry: dict[str, Any] = {"name": joint.name, "at": _listed(place_of(joint, first, second))}
        force = np.einsum("ti,tij->tj", np.nan_to_num(reaction), across)
        entry |= {"force": _listed(force), "partly": not bool(finite.all())}
        if isinstance(joint, Roll):
            entry["contact"] = True
            if finite.all():
                normal = reaction[:, 1:] * across[:, 1]
                entry |= {"normal": _listed(normal), "friction": _listed(required_friction(reaction))}
        out.append(entry)
    return out


def _listed(values: NDArray[np.float64]) -> list[float | None]:
    """Return a flat list. Numbers of 1e6 or more and numbers that are not finite become None, since JSON has no NaN."""
    flat = np.asarray(values, dtype=float).ravel()
    return [round(value, DIGITS) + 0.0 if np.isfinite(value) and abs(value) < 1e6 else None for value in flat.tolist()]


def _native(answer: Answer | None, method: Mapping[str, Any]) -> list[str] | None:
    """Return the poses of the engine in Python, and also its twists if the page cannot run this method."""
    if answer is None or not answer.finished:
        return None
    return [packed(answer.array(name)) for name in (("pose", "twist") if "why" in method else ("pose",))]


def packed(values: NDArray[np.float64]) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _models(name: Name, engine: Any, live: Live, mechanisms: Sequence[Mechanism]) -> dict[str, Any]:
    """Return the models of an engine by slider position and step, or the reason why the page cannot run the engine.

    The list has one step if the model does not depend on the step. The model of MuJoCo depends on the step if its
    stiffness does, or if the mechanism has skates or rolling contacts.
    """
    steps = [live.scene.duration / steps for steps in live.steps]
    try:
        if isinstance(engine, str):
            raise Unsupported(engine)
        if name == "munk":
            plans = [space_of(engine, mechanism, live.scene.duration) for mechanism in mechanisms]
            return {"models": [[{**vars(plan), "numbers": packed(np.array(plan.numbers))}] for plan in plans]}
        needed = steps if not isinstance(engine.stiffness, Shipped) or loose(mechanisms[0]) else steps[:1]
        return {"models": [[vars(mujoco_text(engine, mechanism, step)) for step in needed] for mechanism in mechanisms]}
    except Unsupported as reason:
        return {"why": reason.lacking or str(reason), "idle": list(ENGINES[name])}


def drawing(live: Live, mechanism: Mechanism, pose: NDArray[np.float64]) -> dict[str, Any]:
    """Return the SVG elements of a picture. `pose` (times, bodies, 3) is the exact motion."""
    x, y, width, height = drawn.box(mechanism, live, pose)
    return {
        "box": " ".join(drawn.number(value) for value in (x, -y - height, width, height)),
        "ground": "".join(line.svg() for line in drawn.ground_lines(mechanism, live, pose)),
        "bodies": [drawn.body_shape(mechanism, live, body.name) for body in mechanism.bodies],
        "size": mechanism.length_scale,
    }


def first_picture(live: Live) -> str:
    """Return an SVG with the initial pose and the paths of the exact motion, for readers without JavaScript."""
    mechanism = live.scene.mechanism()
    pose = live.scene.motion(np.linspace(0.0, live.scene.duration, live.frames + 1)).pose
    parts = drawing(live, mechanism, pose)
    paths = (drawn.path(drawn.point_path(pose[:, mechanism.body_index(body)], point)) for body, point in live.traces)
    traces = "".join(f'<path class="trace" d="{path}"/>' for path in paths)
    bodies = "".join(
        f'<g class="body" transform="{drawn.placed(where)}">{shape}</g>'
        for where, shape in zip(pose[0], parts["bodies"], strict=True)
    )
    return (
        f'<svg class="stage" viewBox="{parts["box"]}" role="img" aria-label="The mechanism: {live.word}">'
        f'<g class="world" transform="scale(1 -1)"><g class="ground">{parts["ground"]}</g>'
        f'<g class="motion truth"><g class="traces">{traces}</g>{bodies}</g><g class="overlay"></g></g></svg>'
    )
