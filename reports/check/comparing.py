"""Comparison of an engine's run with the ideal motion, with tables and figures for a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine, method_name, registry
from engines.imported_release import other_release
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory, ground_points
from reports.check import rendering
from reports.check.checked import COMPARED_SAMPLES
from reports.check.first_use import ideal_motion
from reports.check.judging import ERROR_UNITS, Errors, IdealMotion, measure_errors
from reports.check.pictures import draw_ideal, draw_plane, picture_data, pose_lines, render_pictures
from reports.check.rendering import Section
from reports.check.telling import number
from reports.plots.theme import LIGHT, new_figure, settings, svg


@dataclass(frozen=True)
class Picture:
    title: str
    svg: str

    def _repr_svg_(self) -> str:
        return self.svg

    def save(self, path: str | Path) -> None:
        Path(path).write_text(self.svg, encoding="utf-8")


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A run of an engine and the errors of the run. `print` shows a table, and a notebook also shows figures."""

    mechanism: Mechanism
    engine: Engine
    dt: float  # s
    judge: IdealMotion
    run: Trajectory
    errors: Errors

    @property
    def truth(self) -> Trajectory:
        return self.judge.trajectory

    @property
    def title(self) -> str:
        return f"{method_name(self.engine)} at {self.dt * 1e3:g} ms"

    def frame(self) -> Any:
        """The errors as a pandas.DataFrame with a row for each instant. Raises ImportError without pandas."""
        import pandas  # type: ignore[import-not-found]

        return pandas.DataFrame(dict(self.errors.of), index=pandas.Index(self.errors.t, name="t"))

    def figures(self) -> dict[str, Picture]:
        """The figures 'errors' (errors over time) and 'worst' (two poses at the time of the largest error)."""
        judge = measure_errors(self.mechanism, self.truth, self.judge.looser)
        displayed = picture_data(self.mechanism, self.judge, judge, self.run, self.errors, label=self.title)
        return {name: Picture(*drawing) for name, drawing in render_pictures(displayed).items()}

    def _section(self) -> Section:
        cost = f"{number(1e3 * self.run.stepping)} ms of CPU time"
        worst = self.errors.worst
        rows = tuple(
            (f"{name}, {unit}", number(worst[name]), number(float(self.errors.of[name][-1])))
            for name, unit in ERROR_UNITS.items()
        )
        return Section("", (cost, *self.run.warnings), header=("error", "largest", "at the end"), rows=rows)

    def __repr__(self) -> str:
        return f"{self.title}\n{rendering.plain([self._section()])}"

    def _repr_html_(self) -> str:
        drawing = [Section("", picture=(figure.title, figure.svg)) for figure in self.figures().values()]
        return rendering.html(self.title, [self._section(), *drawing], page=False)


def compare_with_ideal(mechanism: Mechanism, engine: Engine | str, dt: float, duration: float) -> Comparison:
    """See `planar_crosscheck.compare`."""
    if not (np.isfinite(dt) and np.isfinite(duration) and 0 < dt <= duration):
        raise ValueError(f"dt is {dt!r} s and duration {duration!r} s; both must be above zero, and dt the smaller")
    chosen = _engine_named(engine) if isinstance(engine, str) else engine
    if sentence := other_release([chosen]):
        raise ValueError(sentence)
    every = max(1, round(duration / COMPARED_SAMPLES / dt))
    samples = max(1, round(duration / (every * dt)))
    judge = ideal_motion(mechanism, samples, every * dt)
    run = chosen.build(mechanism, dt)(samples, every)
    return Comparison(mechanism, chosen, dt, judge, run, measure_errors(mechanism, judge.trajectory, run))


def _engine_named(name: str) -> Engine:
    engines = {method_name(engine): engine for engine in (*registry.ENGINES, *registry.OTHERS)}
    engine = engines.get(name) or engines.get(f"{name} default")
    if engine is None:
        variants = [method for method, other in engines.items() if name.startswith(f"{other.name} ")]
        known = variants or dict.fromkeys(other.name for other in engines.values())
        raise ValueError(f"no engine is called {name!r}; there are {', '.join(known)}")
    if engine.missing:
        raise ValueError(engine.missing)
    return engine


def draw_mechanism(mechanism: Mechanism, pose: Any = None) -> Picture:
    """See `planar_crosscheck.draw`."""
    with settings():
        figure = new_figure(3.4, LIGHT, width=4.6)
        panel = figure.subplots()
        poses = mechanism.pose if pose is None else np.asarray(pose, dtype=float)
        draw_plane(panel, LIGHT, ground_points(mechanism))
        draw_ideal(panel, LIGHT, pose_lines(mechanism, poses))
        for body, (x, y, _) in zip(mechanism.bodies, poses, strict=True):
            paper = {"facecolor": LIGHT.paper, "edgecolor": "none", "pad": 1.0}
            panel.annotate(body.name, (x, y), ha="center", va="center", color=LIGHT.ink, bbox=paper)
    title = f"A mechanism of {len(mechanism.bodies)} bodies"
    return Picture(title, svg(figure, title))
