"""Programs to copy: how a method is built in its engine alone, beside the page's words, for the scene that is advised.

A program is a file `programs/<method>.py` in the page's folder, with other characters than letters and digits as "_".
It says its `duration`, within the scene's horizon, and `steps`, and ends with the place and angle of one body in `end`,
which it prints. The tests run each as it is printed and hold it against the method's own run. A method without a file
is told by its settings.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.scene import Scene
from reports.model.cells import mechanism_of
from reports.model.measure import Measurement
from reports.model.page import Page
from reports.write.page_tables import Advice
from reports.write.tables import number

PAGES = Path(__file__).parents[1] / "pages"
DURATION = re.compile(r"^duration = ([\d.]+)", re.MULTILINE)
STEPS = re.compile(r"^steps = \d+$", re.MULTILINE)
PRINTS = re.compile(r'print\("([^:"]+): x = ')


@dataclass(frozen=True)
class Setting:
    """An advised method: its program with what it should print, or its settings where it has none."""

    method: str
    settings: str  # those that differ from the engine's own defaults
    program: str = ""
    body: str = ""
    exact: str = ""  # "x = ... m, y = ... m, angle = ... rad" of the body at the end


def advised_settings(
    scene: Scene, found: Iterable[Advice], engines: Mapping[str, Any], folder: Path | None = None
) -> list[Setting]:
    """The methods of some advice, each once, as they are to be copied; `engines` by method. `folder`: where programs
    for this scene are."""
    rows: dict[str, list[tuple[Measurement, Sequence[float]]]] = {}
    for each in found:
        if each.row is not None:
            rows.setdefault(each.row.method, []).append((each.row, each.targets))
    return [
        _setting(scene, method, own, engines.get(method), program(folder, method) if folder else "")
        for method, own in rows.items()
    ]


def _setting(
    scene: Scene, method: str, rows: Sequence[tuple[Measurement, Sequence[float]]], engine: Any, source: str
) -> Setting:
    first = rows[0][0]
    settings = compact(engine) if engine is not None else first.settings
    if not source:
        return Setting(method, settings)
    body, end = PRINTS.search(source), DURATION.search(source)
    if body is None or end is None:
        raise ValueError(f"{scene.name}: the program of {method} lacks its duration or does not print a place")
    duration = float(end[1])
    index = mechanism_of(scene).body_index(body[1])
    x, y, angle = _pose_at(scene, duration)[index]
    exact = f"x = {x:.10f} m, y = {y:.10f} m, angle = {angle:.10f} rad"
    counts = [round(duration / scene.spacing) * row.every for row, _ in rows]
    told = "; ".join(f"{count}: below {number(max(row[1]), 1)}" for count, row in zip(counts, rows, strict=True))
    text = STEPS.sub(f"steps = {counts[0]}" + (f"  # {told}" if len(rows) > 1 else ""), source)
    return Setting(method, settings, text, body[1], exact)


@cache
def _pose_at(scene: Scene, t: float) -> NDArray[np.float64]:
    """Exact poses (bodies, 3) at a time: worked out once, though several methods have a program of the scene."""
    return scene.motion([t]).pose[0]


def programs_of(page: Page) -> Path:
    """The folder of a page's programs: beside its template."""
    return (PAGES / page.name if page.template is None else page.template.parent) / "programs"


def program(folder: Path, method: str) -> str:
    """The program of a method; empty without one."""
    path = folder / f"{re.sub('[^a-z0-9]+', '_', method.lower())}.py"
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def compact(value: Any) -> str:
    """A dataclass as Python prints it, without the fields that have their defaults, and without `variant`."""
    if isinstance(value, tuple):
        return "(" + ", ".join(map(compact, value)) + ("," if len(value) == 1 else "") + ")"
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    told = []
    for field in fields(value):
        own = getattr(value, field.name)
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        if field.name != "variant" and field.repr and own != default:
            told.append(f"{field.name}={compact(own)}")
    return f"{type(value).__name__}({', '.join(told)})"
