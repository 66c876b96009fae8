"""A mechanism in an engine beside exact multipliers, to be looked at in a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from engines import Engine, registry
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory, ground_points
from reports.check.checked import SAMPLES
from reports.check.judging import QUANTITIES, UNITS, Errors, IdealMotion, errors, judged
from reports.check.picture_data import pose_of
from reports.check.pictures import beside, ideal, plane
from reports.check.telling import number
from reports.plots.theme import LIGHT, new_figure, settings, style_axes, svg

Array = NDArray[np.float64]
LEAST = 1e-16


@dataclass(frozen=True, eq=False)
class Drawing:
    """A figure of matplotlib's, which a notebook shows."""

    figure: Figure
    title: str

    def _repr_svg_(self) -> str:
        return svg(self.figure, self.title)

    def save(self, path: str | Path) -> None:
        """Write it as SVG."""
        Path(path).write_text(self._repr_svg_(), encoding="utf-8")


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """A run of an engine at a step `dt` [s], the truth at the same times, and the run's errors.

    `judge`: the ideal motion, and how fast neighbouring starts part. `print` shows a line an error, a notebook a table
    and a figure.
    """

    mechanism: Mechanism
    engine: Engine
    dt: float
    judge: IdealMotion
    run: Trajectory
    errors: Errors

    @property
    def truth(self) -> Trajectory:
        """The ideal motion at the times of the run."""
        return self.judge.trajectory

    @property
    def title(self) -> str:
        return f"{registry.method(self.engine)} at {self.dt * 1e3:g} ms"

    def rows(self) -> list[dict[str, Any]]:
        """A dict a quantity: its largest error, in which unit, and its error at the end."""
        return [
            {
                "quantity": name,
                "unit": UNITS[name],
                "largest": self.errors.worst(name),
                "at the end": float(self.errors.of[name][-1]),
            }
            for name in QUANTITIES
        ]

    def frame(self) -> Any:
        """The errors over time as a pandas.DataFrame, an instant a row. Raises ImportError without pandas."""
        import pandas  # type: ignore[import-not-found]

        return pandas.DataFrame(dict(self.errors.of), index=pandas.Index(self.errors.t, name="t"))

    def figure(self) -> Drawing:
        """The mechanism where the run is most wrong, beside the truth there; and the errors over time."""
        with settings():
            figure = new_figure(3.4, LIGHT)
            left, right = figure.subplots(1, 2)
            whole = np.where(np.isfinite(self.errors.whole), self.errors.whole, -1.0)
            worst = int(np.argmax(whole))
            plane(left, LIGHT, ground_points(self.mechanism))
            left.set_title(f"at {self.errors.t[worst]:.3g} s", loc="left")
            ideal(left, LIGHT, pose_of(self.mechanism, self.truth.pose[worst]), "truth")
            beside(left, LIGHT, pose_of(self.mechanism, self.run.pose[worst]), registry.method(self.engine))
            style_axes(right, LIGHT)
            for name, dashes in (("angle", "-"), ("position", "--")):
                values = np.maximum(self.errors.of[name][1:], LEAST)
                right.semilogy(self.errors.t[1:], values, dashes, color=LIGHT.first, label=f"{name}, {UNITS[name]}")
            if self.judge.horizon < self.errors.t[-1]:
                right.axvline(self.judge.horizon, color=LIGHT.third, linestyle="-.", label="starts part exponentially")
            right.set_xlabel("time, s")
            right.set_title("error", loc="left")
            for panel in (left, right):
                for text in panel.legend(frameon=False).get_texts():
                    text.set_color(LIGHT.ink)
        return Drawing(figure, f"{self.title} beside the truth")

    def __repr__(self) -> str:
        lines = [f"{self.title}: {number(1e3 * self.run.stepping)} ms of CPU time", *self.run.warnings]
        lines += [
            f"{each['quantity']}: {number(each['largest'])} {each['unit']} off at most, "
            f"{number(each['at the end'])} at the end"
            for each in self.rows()
        ]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        head = "<tr><th>error</th><th>unit</th><th>largest</th><th>at the end</th></tr>"
        body = "".join(
            f"<tr><td>{row['quantity']}</td><td>{row['unit']}</td><td>{number(row['largest'])}</td>"
            f"<td>{number(row['at the end'])}</td></tr>"
            for row in self.rows()
        )
        words = f"<p>{escape(self.title)}: {number(1e3 * self.run.stepping)} ms of CPU time"
        words += "".join(f"; {escape(warning)}" for warning in self.run.warnings)
        return f"{words}</p><table>{head}{body}</table>{self.figure()._repr_svg_()}"


def compared(mechanism: Mechanism, engine: Engine | str, dt: float, duration: float) -> Comparison:
    """See `planar_crosscheck.compare`."""
    if not (np.isfinite(dt) and np.isfinite(duration) and 0 < dt <= duration):
        raise ValueError(f"dt is {dt!r} s and duration {duration!r} s; both must be above zero, and dt the smaller")
    chosen = _named(engine) if isinstance(engine, str) else engine
    every = max(1, round(duration / SAMPLES / dt))
    samples = max(1, round(duration / (every * dt)))
    judge = judged(mechanism, samples, every * dt)
    run = chosen.build(mechanism, dt)(samples, every)
    return Comparison(mechanism, chosen, dt, judge, run, errors(mechanism, judge.trajectory, run))


def _named(name: str) -> Engine:
    """By "engine" or "engine variant". Raises ValueError."""
    known = {registry.method(engine): engine for engine in registry.ENGINES}
    found = known.get(name) or known.get(f"{name} default")
    if found is None:
        raise ValueError(f"no engine is called {name!r}; there are {', '.join(known)}")
    return found


def drawn(mechanism: Mechanism, pose: Any = None) -> Drawing:
    """See `planar_crosscheck.draw`."""
    with settings():
        figure = new_figure(3.4, LIGHT, width=4.6)
        panel = figure.subplots()
        shown = mechanism.pose if pose is None else np.asarray(pose, dtype=float)
        plane(panel, LIGHT, ground_points(mechanism))
        ideal(panel, LIGHT, pose_of(mechanism, shown))
        for body, (x, y, _) in zip(mechanism.bodies, shown, strict=True):
            paper = {"facecolor": LIGHT.paper, "edgecolor": "none", "pad": 1.0}
            panel.annotate(body.name, (x, y), ha="center", va="center", color=LIGHT.ink, bbox=paper)
    return Drawing(figure, f"A mechanism of {len(mechanism.bodies)} bodies")
