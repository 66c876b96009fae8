"""Programs to copy: each cheapest setting that a page names, as a file that runs as it is and prints a number.

With an engine alone, a program is a file `programs/<method>.py` in the page's folder, other characters than letters and
digits as "_". It says its `duration`, within the scene's horizon, and `steps`, and ends with the place and angle of one
body in `end`, which it prints. A method without such a file is a program that calls this suite. The tests run each as
it is printed and hold it against the method's own row.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Engine
from reference.scene import Scene
from reports.model.cells import mechanism_of
from reports.model.measure import Measurement
from reports.model.page import Page
from reports.model.quantities import quantity
from reports.write.page_tables import Advice
from reports.write.tables import number

PAGES = Path(__file__).parents[1] / "pages"
FOLDER = "programs"  # beside the pages that are written
DURATION = re.compile(r"^duration = ([\d.]+)", re.MULTILINE)
STEPS = re.compile(r"^steps = \d+$", re.MULTILINE)
PRINTS = re.compile(r'print\("([^:"]+): x = ')


@dataclass(frozen=True)
class Program:
    """A method at the step of its row: `file` below the results; `alone` if it needs its engine and nothing of ours."""

    method: str
    file: str
    text: str
    alone: bool


def advised_programs(page: Page, scene: Scene, found: Iterable[Advice], engines: Mapping[str, Engine]) -> list[Program]:
    """The methods of some advice for a scene of the page, each once; `engines` by method."""
    rows: dict[str, list[tuple[Measurement, Sequence[float]]]] = {}
    for each in found:
        if each.row is not None and each.row.method in engines:
            rows.setdefault(each.row.method, []).append((each.row, each.targets))
    made = []
    for method, own in rows.items():
        source = program(programs_of(page), method) if scene is page.advised_scene else ""
        text = _alone(scene, method, own, source) if source else _with_suite(scene, engines[method], own, page.quantity)
        made.append(Program(method, f"{FOLDER}/{slug(scene.name)}_{slug(method)}.py", text, bool(source)))
    return made


def _alone(scene: Scene, method: str, rows: Sequence[tuple[Measurement, Sequence[float]]], source: str) -> str:
    body, end = PRINTS.search(source), DURATION.search(source)
    if body is None or end is None:
        raise ValueError(f"{scene.name}: the program of {method} lacks its duration or does not print a place")
    duration = float(end[1])
    x, y, angle = _pose_at(scene, duration)[mechanism_of(scene).body_index(body[1])]
    counts = [round(duration / scene.spacing) * row.every for row, _ in rows]
    told = "; ".join(f"{count}: below {number(min(row[1]), 1)}" for count, row in zip(counts, rows, strict=True))
    text = STEPS.sub(f"steps = {counts[0]}" + (f"  # {told}" if len(rows) > 1 else ""), source)
    return f"{text}# Exact: {body[1]}: x = {x:.10f} m, y = {y:.10f} m, angle = {angle:.10f} rad\n"


@cache
def _pose_at(scene: Scene, t: float) -> NDArray[np.float64]:
    """Exact poses (bodies, 3) at a time: worked out once, though several methods have a program of the scene."""
    return scene.motion([t]).pose[0]


def _with_suite(
    scene: Scene, engine: Engine, rows: Sequence[tuple[Measurement, Sequence[float]]], compared: str
) -> str:
    row, targets = rows[0]
    told = quantity(compared)
    module, name, expression = named(engine)
    made = type(scene)
    imports = sorted({f"from {module} import {name}", f"from {made.__module__} import {made.__qualname__}"})
    numbers = ["import numpy as np", ""] if compared == "position" else []
    until = "[trajectory.t <= scene.horizon]" if scene.horizon < scene.duration else ""
    apart = f"(trajectory.pose - truth.pose){until}"
    error = f"np.hypot(*{apart}[..., :2].T).max()" if compared == "position" else f"abs({apart})[..., 2].max()"
    further = "; ".join(f"{each.every}: below {number(min(below), 1)}" for each, below in rows[1:])
    lines = [
        f'"""{scene.name} by the method {row.method}, with this suite: below {number(min(targets), 1)} {told.unit}."""',
        "",
        *numbers,
        *imports,
        "",
        f"scene = {compact(scene)}",
        f"every = {row.every}" + (f"  # {further}" if further else ""),
        f"run = {expression}.build(scene.mechanism(), dt=scene.spacing / every)",
        "trajectory = run(samples=scene.samples, every=every)",
        "truth = scene.motion(trajectory.t)",
        *(["# Beyond its horizon the motion's own errors grow exponentially."] if until else []),
        f"error = {error}",
        f'print(f"largest {told.label} error: {{error:.1e}} {told.unit}")',
        f"# {getattr(row, compared):.1e} {told.unit} when this was written",
    ]
    return "\n".join(lines) + "\n"


@cache
def named(engine: Engine) -> tuple[str, str, str]:
    """(module, name to import, expression) of a method: a constant, an instance of plain settings, a tuple's member."""
    own, kind = type(engine).__module__, type(engine).__name__
    package = ".".join(own.split(".")[:2])
    members: list[tuple[str, str, str]] = []
    for module in (package, f"{package}.methods"):
        try:
            values = vars(importlib.import_module(module))
        except ModuleNotFoundError:
            continue
        for name, value in values.items():
            if name.isupper() and value == engine:
                return module, name, name
            if name.isupper() and isinstance(value, tuple) and engine in value:
                members.append((module, name, f"{name}[{value.index(engine)}]"))
    made = compact(engine)
    plain = (package if hasattr(importlib.import_module(package), kind) else own), kind, made
    return members[0] if members and made.count("(") > 1 else plain


def programs_of(page: Page) -> Path:
    """The folder of a page's programs: beside its template."""
    return (PAGES / page.name if page.template is None else page.template.parent) / "programs"


def slug(method: str) -> str:
    return re.sub("[^a-z0-9]+", "_", method.lower())


def program(folder: Path, method: str) -> str:
    """The program of a method; empty without one."""
    path = folder / f"{slug(method)}.py"
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def compact(value: Any) -> str:
    """A dataclass as Python makes it, without the fields that have their defaults, and without `variant`."""
    if isinstance(value, tuple):
        return "(" + ", ".join(map(compact, value)) + ("," if len(value) == 1 else "") + ")"
    if isinstance(value, str):
        return f'"{value}"'
    if not is_dataclass(value) or isinstance(value, type):
        return repr(value)
    told = []
    for field in fields(value):
        own = getattr(value, field.name)
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        if field.name != "variant" and field.repr and own != default:
            told.append(f"{field.name}={compact(own)}")
    return f"{type(value).__name__}({', '.join(told)})"
