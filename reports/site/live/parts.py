"""The files with which pages run engines themselves, and what the pages' templates say of them."""

from __future__ import annotations

import json
from collections.abc import Iterable

from reports.site.lesson import Lesson
from reports.site.live import sliders
from reports.site.live.data import data
from reports.site.munk2d.compiling import compiled
from reports.site.packages import NotFetched, fetched
from reports.site.packages_used import MUJOCO
from reports.site.rows import stored_rows
from reports.site.source import Source

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
