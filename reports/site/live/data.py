"""A live part as the data that a page loads: models, truth and drawings at every place of the sliders.

What is the same at several places is there once: `pool` holds it, and places have its number. The numbers of truth
and of Munk2D's plans are doubles as they are, in base64. Nothing is stepped here: what Python's engines gave comes as
stored motions.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.mujoco.stiffness import Shipped
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.model.tasks import Answer, Motion
from reports.site import drawn
from reports.site.drawn import index_of, joints_of, loose, measure_of
from reports.site.embed import forces
from reports.site.live.models import plan_of, text_of
from reports.site.live.sliders import ENGINES, Live, Name, Point

PACKAGES = {"munk": ("pymunk", "pymunk"), "mujoco": ("MuJoCo", "mujoco-core")}  # its name, and that of its package


@dataclass
class Pool:
    """Values that a page needs, each once; `number` gives the place of one."""

    values: list[Any] = field(default_factory=list)
    known: dict[str, int] = field(default_factory=dict)

    def number(self, value: Any) -> int:
        """Where the value stands, put there if it is new."""
        key = json.dumps(value)
        if key not in self.known:
            self.known[key] = len(self.values)
            self.values.append(value)
        return self.known[key]


def data(live: Live, answers: Mapping[Motion, Answer]) -> dict[str, Any]:
    """All that a page needs of a live scene, for JSON; lists of places are in the order of `Live.places`.

    Of pinned linkages the page finds the exact motion itself, from `mechanisms`; `truth` is then that of the scene's
    own numbers alone. Poses and twists of a body are six numbers.
    """
    pool = Pool()
    places = list(live.places())
    mechanisms = [scene.mechanism() for scene in places]
    mechanism = live.scene.mechanism()
    pinned = all(isinstance(joint, Pin | Slot | Drive) for joint in mechanism.joints)
    times = np.arange(live.frames + 1) * (live.scene.duration / live.frames)
    motions = [scene.motion(times) if not pinned or scene == live.scene else None for scene in places]
    truth = live.scene.motion(times)
    stored = live.stored()
    ways: dict[Name, list[dict[str, Any]]] = {
        name: [_model(name, engine, live, mechanisms, pool) for _, engine in live.ways(name)] for name in ENGINES
    }
    points = [[(body, point) for body, point in live.traces] or _blades(each) for each in mechanisms]
    return {
        "word": live.word,
        "scene": live.scene.name,
        "measure": measure_of(mechanism),
        "frames": live.frames,
        "window": live.window or (0, live.frames),
        "steps": live.steps,
        "duration": live.scene.duration,
        "sliders": [{"name": slider.field, "size": len(slider.values)} for slider in live.sliders],
        "bodies": [body.name for body in mechanism.bodies],
        "truth": [None if each is None else pool.number(packed(_states(each))) for each in motions],
        "mechanisms": [pool.number(_equations(each)) for each in mechanisms] if pinned else None,
        "forces": [
            None if each is None else pool.number(forces(one, each))
            for one, each in zip(mechanisms, motions, strict=True)
        ],
        "drawings": [
            pool.number(drawing(live, one, truth.pose if each is None else each.pose))
            for one, each in zip(mechanisms, motions, strict=True)
        ],
        "joints": [pool.number(joints_of(each)) for each in mechanisms],
        "blades": [pool.number(_edges(each)) for each in mechanisms],
        "traces": [
            pool.number([{"body": one.body_index(body), "point": point} for body, point in each])
            for one, each in zip(mechanisms, points, strict=True)
        ],
        "centre": None if live.centre is None else mechanism.body_index(live.centre),
        **ways,
        "native": {
            name: [
                _native(answers.get(stored[name, index]) if (name, index) in stored else None, way)
                for index, way in enumerate(each)
            ]
            for name, each in ways.items()
        },
        "versions": {name: native_version(name) for name in ENGINES},
        "pool": pool.values,
    }


def _states(motion: Trajectory) -> NDArray[np.float64]:
    return np.concatenate([motion.pose, motion.twist], axis=-1)


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


def _blades(mechanism: Mechanism) -> list[tuple[str, Point]]:
    return [(str(joint.second), joint.second_point) for joint in mechanism.joints if isinstance(joint, Skate)]


def _edges(mechanism: Mechanism) -> list[dict[str, Any]]:
    """The skates: the body of each, its point there [m] and the blade's angle on it [rad]."""
    return [
        {
            "name": each.name,
            "body": mechanism.body_index(str(each.second)),
            "point": each.second_point,
            "angle": each.angle,
        }
        for each in mechanism.joints
        if isinstance(each, Skate)
    ]


def native_version(engine: str) -> str:
    """Such as "MuJoCo 4.0.1": what Python runs."""
    name, package = PACKAGES[engine]
    return f"{name} {version(package)}"


def _native(answer: Answer | None, way: Mapping[str, Any]) -> list[str] | None:
    """The poses that Python's engine gave, and where the page has no engine for this the twists."""
    if answer is None or not answer.finished:
        return None
    return [packed(answer.array(name)) for name in (("pose", "twist") if "why" in way else ("pose",))]


def packed(values: NDArray[np.float64]) -> str:
    """Doubles, the lowest byte first, in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _plans(engine: Any, live: Live, mechanisms: Sequence[Mechanism], pool: Pool) -> dict[str, Any]:
    plans = [plan_of(engine, mechanism, live.scene.duration) for mechanism in mechanisms]
    return {
        "plans": [pool.number(packed(np.array(plan.numbers))) for plan in plans],
        "idle": plans[0].idle,
        "impulses": plans[0].impulses,
    }


def _texts(engine: Any, live: Live, mechanisms: Sequence[Mechanism], pool: Pool) -> dict[str, Any]:
    steps = [live.scene.duration / steps for steps in live.steps]
    # A model for one step is that for all, unless a blade stands in the ground or a spring is as fast as the step.
    known = steps if not isinstance(engine.stiffness, Shipped) or loose(mechanisms[0]) else steps[:1]
    by_step = [[text_of(engine, mechanism, step) for step in known] for mechanism in mechanisms]
    texts = [each[0] for each in by_step]
    first = texts[0]
    if any((each.bodies, each.links, each.idle) != (first.bodies, first.links, first.idle) for each in texts):
        raise ValueError("the trees of a slider's places differ")
    return {
        "texts": [[pool.number(each.text) for each in told] for told in by_step],
        "changes": [[pool.number(each.changes) for each in told] for told in by_step],
        "velocity": [pool.number(each.velocity) for each in texts],
        "bodies": first.bodies,
        "links": first.links,
        "idle": first.idle,
    }


def _model(name: Name, engine: Any, *given: Any) -> dict[str, Any]:
    """What the page's engine is given, or the sentence that says why it can't be: all sliders then act on nothing."""
    try:
        if isinstance(engine, str):
            raise Unsupported(engine)
        return _plans(engine, *given) if name == "munk" else _texts(engine, *given)
    except Unsupported as reason:
        return {"why": str(reason), "idle": list(ENGINES[name])}


def drawing(live: Live, mechanism: Mechanism, pose: NDArray[np.float64]) -> dict[str, Any]:
    """The parts of a picture as SVG; `pose` (times, bodies, 3), the truth."""
    left, bottom, width, height = drawn.box(mechanism, live, pose)
    return {
        "box": " ".join(drawn.number(value) for value in (left, -bottom - height, width, height)),
        "ground": drawn.ground(mechanism, live, pose),
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
