"""A live part as the data that a page loads: models, truth and drawings at every place of the sliders.

The numbers of truth and of Munk2D's plans are doubles as they are, in base64. Nothing is stepped here: what Python's
engines gave comes as stored motions.
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
from reports.site.drawn import between, demanded, index_of, joints_of, loose, measure_of, place_of
from reports.site.live.models import plan_of, text_of
from reports.site.live.sliders import ENGINES, NAMES, Live, Name

DIGITS = 6  # of forces and their places, after the point
PACKAGES: dict[Name, str] = {"munk": "pymunk", "mujoco": "mujoco-core"}


def data(live: Live, answers: Mapping[Motion, Answer]) -> dict[str, Any]:
    """All that a page needs of a live scene, for JSON; lists of places are in the order of `Live.places`.

    Of pinned linkages the page finds the exact motion itself, from `equations`; `truth` is then that of the scene's own
    numbers alone. Poses and twists of a body are six numbers.
    """
    mechanism = live.scene.mechanism()
    places = [(scene, scene.mechanism()) for scene in live.places()]
    mechanisms = [each for _, each in places]
    ways: dict[Name, list[Any]] = {
        name: [_models(name, engine, live, mechanisms) for _, engine in live.ways(name)] for name in ENGINES
    }
    stored = {key: answers.get(motion) for key, motion in live.stored().items()}
    return {
        "measure": measure_of(mechanism),
        "frames": live.frames,
        "window": live.window or (0, live.frames),
        "duration": live.scene.duration,
        "bodies": [body.name for body in mechanism.bodies],
        "centre": None if live.centre is None else mechanism.body_index(live.centre),
        "places": [_place(live, *each) for each in places],
        **ways,
        "native": {
            name: [_native(stored.get((name, index)), way) for index, way in enumerate(each)]
            for name, each in ways.items()
        },
        "versions": {name: f"{NAMES[name]} {version(package)}" for name, package in PACKAGES.items()},
    }


def _place(live: Live, scene: Scene, mechanism: Mechanism) -> dict[str, Any]:
    """The mechanism at a place of the sliders, how it is drawn, and its motion."""
    pinned = all(isinstance(joint, Pin | Slot | Drive) for joint in mechanism.joints)
    known = not pinned or scene == live.scene
    truth = (scene if known else live.scene).motion(np.arange(live.frames + 1) * (scene.duration / live.frames))
    blades = [joint for joint in mechanism.joints if isinstance(joint, Skate)]
    traces = live.traces or [(str(blade.second), blade.second_point) for blade in blades]
    return {
        "equations": _equations(mechanism) if pinned else None,
        "truth": packed(np.concatenate([truth.pose, truth.twist], axis=-1)) if known else None,
        "forces": forces(mechanism, truth) if known else None,
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
    """What the page's own exact motion is made of, beside the joints."""
    drives = [joint for joint in mechanism.joints if isinstance(joint, Drive)]
    return {
        "inertia": [value for body in mechanism.bodies for value in (body.mass, body.mass, body.inertia)],
        "gravity": list(mechanism.gravity),
        "pose": mechanism.pose.ravel().tolist(),
        "twist": mechanism.twist.ravel().tolist(),
        "drives": [
            {
                "first": index_of(mechanism, each.first),
                "second": index_of(mechanism, each.second),
                "rate": each.turning_rate,
            }
            for each in drives
        ],
    }


def forces(mechanism: Mechanism, truth: Trajectory) -> list[dict[str, Any]]:
    """The reaction of each joint on its second body: where it acts [m] and the force [N], two numbers an instant.

    Of a rolling contact also the friction that it demands [1]. Nothing for a drive, whose reaction is a torque. With
    `partly` the motion does not determine all of a force, and what it does determine is told.
    """
    found, row = [], 0
    for joint in mechanism.joints:
        own = truth.reaction[:, row : row + joint.size]
        row += joint.size
        known = np.isfinite(own)
        if isinstance(joint, Drive | Coupling) or not (known.any() or isinstance(joint, Roll)):
            continue
        first, second = between(mechanism, joint, truth.pose)
        across = joint.rows(first, second)[..., 3:5]
        told: dict[str, Any] = {"name": joint.name, "at": _listed(place_of(joint, first, second))}
        told |= {"force": _listed(np.einsum("ti,tij->tj", np.nan_to_num(own), across)), "partly": not bool(known.all())}
        if isinstance(joint, Roll):
            told["contact"] = True
            if known.all():
                normal = own[:, 1:] * across[:, 1]
                told |= {"normal": _listed(normal), "friction": _listed(demanded(own))}
        found.append(told)
    return found


def _listed(values: NDArray[np.float64]) -> list[float | None]:
    """All numbers one after another; None where there is none, since JSON has no NaN."""
    flat = np.asarray(values, dtype=float).ravel()
    return [round(value, DIGITS) + 0.0 if np.isfinite(value) and abs(value) < 1e6 else None for value in flat.tolist()]


def _native(answer: Answer | None, way: Mapping[str, Any]) -> list[str] | None:
    """The poses that Python's engine gave, and where the page has no engine for this the twists."""
    if answer is None or not answer.finished:
        return None
    return [packed(answer.array(name)) for name in (("pose", "twist") if "why" in way else ("pose",))]


def packed(values: NDArray[np.float64]) -> str:
    """Doubles, the lowest byte first, in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _models(name: Name, engine: Any, live: Live, mechanisms: Sequence[Mechanism]) -> dict[str, Any]:
    """What the page's engine is given, by place and step, or why it can't be: all sliders then act on nothing.

    A model for one step is that for all, unless a blade stands in the ground or a spring is as fast as the step.
    """
    steps = [live.scene.duration / steps for steps in live.steps]
    try:
        if isinstance(engine, str):
            raise Unsupported(engine)
        if name == "munk":
            plans = [plan_of(engine, mechanism, live.scene.duration) for mechanism in mechanisms]
            return {"models": [[{**vars(plan), "numbers": packed(np.array(plan.numbers))}] for plan in plans]}
        known = steps if not isinstance(engine.stiffness, Shipped) or loose(mechanisms[0]) else steps[:1]
        return {"models": [[vars(text_of(engine, mechanism, step)) for step in known] for mechanism in mechanisms]}
    except Unsupported as reason:
        return {"why": str(reason), "idle": list(ENGINES[name])}


def drawing(live: Live, mechanism: Mechanism, pose: NDArray[np.float64]) -> dict[str, Any]:
    """The parts of a picture as SVG; `pose` (times, bodies, 3), the truth."""
    left, bottom, width, height = drawn.box(mechanism, live, pose)
    return {
        "box": " ".join(drawn.number(value) for value in (left, -bottom - height, width, height)),
        "ground": "".join(line.svg() for line in drawn.ground_lines(mechanism, live, pose)),
        "bodies": [drawn.body_shape(mechanism, live, body.name) for body in mechanism.bodies],
        "size": mechanism.length_scale,
    }


def first_picture(live: Live) -> str:
    """The exact motion at its start with its paths, for who has no script."""
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
