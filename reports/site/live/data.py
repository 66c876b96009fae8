"""A live part as the data that a page loads: models, truth and drawings at every place of the sliders.

What is the same at several places is there once: `pool` holds it, and places have its number. The numbers of truth
and of Munk2D's plans are doubles as they are, in base64. Nothing is stepped here: what Python's engines gave comes as
stored motions.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from reference.mechanism import Mechanism
from reports.model.tasks import Answer, Motion
from reports.site import drawn
from reports.site.drawn import joints_of, loose, measure_of
from reports.site.lesson import Lesson, Source, Take
from reports.site.live import sliders
from reports.site.live.models import plan_of, text_of
from reports.site.live.sliders import Live
from reports.site.munk2d import compiled
from reports.site.packages import MUJOCO, NotFetched, fetched
from reports.site.rows import stored_rows

NUMBER = re.compile(r"(?<=[\" ])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?=[\" ])")
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
    """All that a page needs of a live scene, for JSON; lists of places are in the order of `Live.places`."""
    pool = Pool()
    places = list(live.places())
    mechanisms, poses = [], []  # of each place once, side by side: both may need the same integration
    for scene in places:
        mechanisms.append(scene.mechanism())
        poses.append(scene.motion(np.arange(live.frames + 1) * (scene.duration / live.frames)).pose)
    mechanism = live.scene.mechanism()
    return {
        "word": live.word,
        "scene": live.scene.name,
        "measure": measure_of(mechanism),
        "frames": live.frames,
        "steps": live.steps,
        "duration": live.scene.duration,
        "sliders": [{"name": slider.field, "size": len(slider.values)} for slider in live.sliders],
        "bodies": [body.name for body in mechanism.bodies],
        "truth": [pool.number(packed(pose)) for pose in poses],
        "drawings": [
            pool.number(_drawing(Take(scene, ends=live.ends, traces=live.traces), own, pose))
            for scene, own, pose in zip(places, mechanisms, poses, strict=True)
        ],
        "joints": [pool.number(joints_of(own)) for own in mechanisms],
        "mujoco": [_or_why(lambda engine=engine: _texts(engine, live, mechanisms, pool)) for _, engine in live.mujoco],
        "munk": [_or_why(lambda engine=engine: _plans(engine, mechanisms, pool)) for _, engine in live.munk],
        "traces": [{"body": mechanism.body_index(body), "point": point} for body, point in live.traces],
        "native": {
            name: {"version": native_version(name), "pose": _pose(answers.get(motion))}
            for name, motion in live.shipped().items()
        },
        "pool": pool.values,
    }


def native_version(engine: str) -> str:
    """Such as "MuJoCo 4.0.1": what Python runs."""
    name, package = PACKAGES[engine]
    return f"{name} {version(package)}"


def _or_why(make: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """What is made, or the sentence that says why it can't be."""
    try:
        return make()
    except Unsupported as reason:
        return {"why": str(reason)}


def _pose(answer: Answer | None) -> str | None:
    return packed(answer.array("pose")) if answer is not None and answer.finished else None


def packed(values: NDArray[np.float64]) -> str:
    """Doubles, the lowest byte first, in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f8").tobytes()).decode()


def _plans(engine: Any, mechanisms: Sequence[Mechanism], pool: Pool) -> dict[str, Any]:
    return {"plans": [pool.number(packed(np.array(plan_of(engine, mechanism)))) for mechanism in mechanisms]}


def _texts(engine: Any, live: Live, mechanisms: Sequence[Mechanism], pool: Pool) -> dict[str, Any]:
    steps = [live.scene.duration / steps for steps in live.steps]
    # Where nothing stands on skates, a model for one step is that for all.
    known = steps if loose(mechanisms[0]) else steps[:1]
    by_step = [[text_of(engine, mechanism, step) for step in known] for mechanism in mechanisms]
    texts = [each[0] for each in by_step]
    first = texts[0]
    if any(each.text != told[0].text for told in by_step for each in told):
        raise ValueError("the text of a model depends on the step")
    if any((each.bodies, each.turns, each.springs) != (first.bodies, first.turns, first.springs) for each in texts):
        raise ValueError("the trees of a slider's places differ")
    parts, numbers = template([each.text for each in texts])
    return {
        "parts": parts,
        "numbers": [pool.number(each) for each in numbers],
        "changes": [[pool.number(each.changes) for each in told] for told in by_step],
        "velocity": [pool.number(each.velocity) for each in texts],
        "bodies": first.bodies,
        "turns": first.turns,
        "springs": first.springs,
    }


def template(texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """What stands between the numbers of all texts, and the numbers of each, between commas. Raises ValueError."""
    parts = [NUMBER.split(text) for text in texts]
    if any(each != parts[0] for each in parts):
        raise ValueError("the models of a slider's places differ in more than numbers")
    return parts[0], [",".join(NUMBER.findall(text)) for text in texts]


def _drawing(take: Take, mechanism: Mechanism, pose: NDArray[np.float64]) -> dict[str, Any]:
    left, bottom, width, height = drawn.box(mechanism, take, pose)
    return {
        "box": " ".join(drawn.number(value) for value in (left, -bottom - height, width, height)),
        "ground": drawn.ground(mechanism, take, pose),
        "bodies": [drawn.body_shape(mechanism, take, body.name) for body in mechanism.bodies],
        "size": mechanism.length_scale,
    }


MUNK = "packages/munk2d.js"
KNOWN = {MUNK: ("munk2d", "Munk2D"), "packages/mujoco.js": ("mujoco", "MuJoCo")}
# Places of the engines' sliders for documented settings: MuJoCo holds a time constant to two steps at least.
TUNED = {"integrator": 2, "timeConstant": 0, "impedance": 4, "tolerance": 2, "iterations": 6, "bias": 3}


def engine_files(source: Source, lessons: Iterable[Lesson]) -> tuple[dict[str, bytes], list[str]]:
    """The engines' files and the data of all live scenes, and a sentence for each engine that is missing."""
    lessons = [lesson for lesson in lessons if lesson.live]
    files: dict[str, bytes] = {}
    missing = []
    if not lessons:
        return files, missing
    try:
        content = fetched(MUJOCO, source.cache)
        files |= {name: content[path] for path, name in MUJOCO.files}
    except NotFetched as reason:
        missing.append(f"This site was built without MuJoCo: {reason}.")
    try:
        files[MUNK] = compiled(source.cache)
    except NotFetched as reason:
        missing.append(f"This site was built without Munk2D, the engine in pymunk: {reason}.")
    source.troubles += missing
    if files:
        known = {live.key: live for lesson in lessons for live in lesson.live}
        for key, live in known.items():
            told = json.dumps(data(live, source.answers), separators=(",", ":"), allow_nan=False)
            files[f"live/{key}.json"] = told.encode()
        scenes = dict.fromkeys(live.scene.name for live in known.values())
        rows = stored_rows(source.tables.get("errors.csv", ""), scenes)
        files["live/rows.json"] = json.dumps(rows, separators=(",", ":")).encode()
    return files, missing


def running_in(lesson: Lesson, files: dict[str, bytes], missing: list[str]) -> dict[str, object]:
    """What a lesson's page says of the engines that it can run."""
    there = [told for path, told in KNOWN.items() if path in files]
    return {
        "engines": [word for word, _ in there],
        "names": [name for _, name in there],
        "missing": missing,
        "live": lesson.live,
        "settings": sliders,
        "tuned": TUNED,
    }
