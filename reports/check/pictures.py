"""The two pictures of a check: the errors over time, and the mechanism at the time of the largest error."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reference.joints import Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.trajectory import Trajectory, body_points, ground_points
from reports.check.checked import CheckResult, SettingRun
from reports.check.judging import ERROR_UNITS, Errors, IdealMotion
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Lines = list[list[list[float]]]  # (line, point, coordinate) [m].
Curves = dict[str, list[float]]  # Quantity -> errors over time, in the unit of the quantity.
SMALLEST_DRAWN = 1e-16  # A smaller error is drawn at this value, since the axis is logarithmic.
BAR_STYLE: dict[str, Any] = {"marker": "o", "solid_capstyle": "round"}


@dataclass(frozen=True)
class Pose:
    bars: Lines  # For each body, a polygon through its joints.
    links: Lines  # Rods and springs.
    rails: Lines  # Guides of slides on the ground.


@dataclass(frozen=True)
class PictureData:
    t: list[float]  # s.
    own: Curves  # Errors of the user's settings at `t`.
    judge_t: list[float]
    judge: Curves  # Errors of the judge at `judge_t`.
    advised_t: list[float]
    advised: Curves | None  # Errors of the advised settings at `advised_t`, or None without advised settings.
    horizon: float | None  # Time [s] after which errors grow exponentially, or None if they do not.
    moment: float  # Time of the largest error of the user's settings [s].
    ground: list[list[float]]  # Ground points (points, 2) [m].
    ideal: Pose  # Pose at `moment` with ideal joints.
    found: Pose  # Pose at `moment` with the user's settings.
    label: str = "your settings"

    def as_text(self) -> str:
        return json.dumps(asdict(self), sort_keys=True)


def picture_data_from_text(text: str) -> PictureData:
    data = json.loads(text)
    return PictureData(**{**data, "ideal": Pose(**data["ideal"]), "found": Pose(**data["found"])})


def picture_data_of(result: CheckResult, advised: SettingRun | None = None) -> PictureData:
    """The data of a check. advised: the run with the second settings in the picture, by default the advised ones."""
    advised = advised or result.advised
    other = None if advised is None or result.met else advised.errors
    mechanism = result.reading.mechanism
    return picture_data(mechanism, result.judge, result.judge_errors, result.own, result.own_errors, other)


def picture_data(
    mechanism: Mechanism,
    ideal: IdealMotion,
    judge: Errors,
    run: Trajectory,
    own: Errors,
    other: Errors | None = None,
    label: str = PictureData.label,
) -> PictureData:
    """The data of a run. own: errors of this run. other: errors of a run with the advised settings."""
    quantities = [quantity for quantity in ERROR_UNITS if np.isfinite(own.of[quantity]).any()]
    sample = int(np.argmax(np.where(np.isfinite(own.whole), own.whole, -1.0)))

    def curves(errors: Errors) -> Curves:
        return {quantity: errors.of[quantity].tolist() for quantity in quantities}

    return PictureData(
        own.t.tolist(),
        curves(own),
        judge.t.tolist(),
        curves(judge),
        [] if other is None else other.t.tolist(),
        None if other is None else curves(other),
        ideal.horizon if ideal.horizon < ideal.trajectory.t[-1] else None,
        float(own.t[sample]),
        ground_points(mechanism).tolist(),
        pose_lines(mechanism, ideal.trajectory.pose[sample]),
        pose_lines(mechanism, run.pose[sample]),
        label,
    )


def pose_lines(mechanism: Mechanism, pose: Array) -> Pose:
    """The lines of a pose (bodies, 3) [m, m, rad]. A body with one joint is a line from joint to centre of mass."""

    def point(name: str | None, local: tuple[float, float]) -> Array:
        if name is None:
            return np.array(local)
        x, y, angle = pose[mechanism.body_index(name)]
        return np.array([x, y]) + rotated(angle, np.array(local))

    extent = 2 * max(mechanism.length_scale, float(np.ptp(mechanism.pose[:, :2], axis=0).max()))
    rails, links, bars = [], [], []
    for joint in mechanism.joints:
        if isinstance(joint, Slot) and joint.first is None:
            half = 0.5 * extent * np.array([np.cos(joint.line_angle), np.sin(joint.line_angle)])
            middle = point(joint.second, joint.second_point)
            rails.append([(middle - half).tolist(), (middle + half).tolist()])
    for link in (*mechanism.joints, *mechanism.forces):
        if link.acts_along_line:
            first, second = (point(*end) for end in link.points)
            if np.linalg.norm(second - first) < 3 * extent:  # A longer line is not drawn.
                links.append([first.tolist(), second.tolist()])
    for name, points in body_points(mechanism, pose).items():
        centre = pose[mechanism.body_index(name)][:2]
        bars.append((points if len(points) > 1 else np.vstack([points, centre])).tolist())
    return Pose(bars, links, rails)


def render_pictures(shown: PictureData) -> dict[str, tuple[str, str]]:
    """Name ('errors' or 'worst') -> (title, SVG)."""
    named = {
        "errors": (f"Errors of {shown.label} over time, beside the judge's own error", _errors(shown)),
        "worst": (f"The mechanism at {shown.moment:.3g} s, where the error of {shown.label} is largest", _worst(shown)),
    }
    return {key: (title, svg(figure, title)) for key, (title, figure) in named.items()}


def _errors(shown: PictureData) -> Figure:
    theme, quantities = LIGHT, list(shown.own)
    lines = [(shown.t, shown.own, shown.label, theme.first, "-")]
    if shown.advised is not None:
        lines.append((shown.advised_t, shown.advised, "advised settings", theme.second, "--"))
    lines.append((shown.judge_t, shown.judge, "the judge's own error", theme.quiet, ":"))
    with settings():
        figure = new_figure(5.4 if len(quantities) > 2 else 3.1, theme)
        panels = figure.subplots(-(-len(quantities) // 2), 2, squeeze=False).ravel()
        for panel in panels[len(quantities) :]:
            panel.set_axis_off()
        for panel, quantity in zip(panels, quantities, strict=False):
            style_axes(panel, theme)
            panel.set_yscale("log")
            for t, errors, label, colour, dashes in lines:
                values = np.maximum(errors[quantity], SMALLEST_DRAWN)
                panel.plot(t[1:], values[1:], color=colour, linestyle=dashes, linewidth=1.5, label=label)
            if shown.horizon is not None:
                panel.axvline(shown.horizon, color=theme.third, linestyle="-.", label="errors grow exponentially")
            panel.set_title(f"{quantity} error, {ERROR_UNITS[quantity]}", loc="left")
            panel.set_xlabel("time, s")
        _legend(figure, theme, 4, *panels[0].get_legend_handles_labels())
    return figure


def _worst(shown: PictureData) -> Figure:
    theme = LIGHT
    with settings():
        figure = new_figure(4.2, theme, width=6.2)
        panel = figure.subplots()
        draw_plane(panel, theme, shown.ground, "held to the ground")
        draw_ideal(panel, theme, shown.ideal, "ideal joints")
        dashed: dict[str, Any] = {"color": theme.first, "linestyle": "--"}
        _draw(panel, shown.found.rails, linewidth=0.6, color=theme.first, alpha=0.5)
        _draw(panel, shown.found.links, linewidth=0.8, **dashed)
        _draw(panel, shown.found.bars, shown.label, linewidth=1.5, markersize=4, **dashed, **BAR_STYLE)
        _legend(figure, theme, 3)
    return figure


def _legend(figure: Figure, theme: Theme, columns: int, *entries: Any) -> None:
    legend = figure.legend(*entries, loc="outside lower center", ncols=columns, frameon=False)
    for text in legend.get_texts():
        text.set_color(theme.ink)


def draw_plane(panel: Any, theme: Theme, ground: Any, label: str | None = None) -> None:
    """Draw the axes and the ground points (points, 2) [m]."""
    style_axes(panel, theme)
    panel.set_aspect("equal", adjustable="datalim")
    panel.set_xlabel("x in the plane of motion, m")
    panel.set_ylabel("y, m")
    if len(ground):
        panel.plot(*np.array(ground).T, linestyle="none", marker="^", markersize=8, color=theme.quiet, label=label)


def draw_ideal(panel: Any, theme: Theme, pose: Pose, label: str | None = None) -> None:
    _draw(panel, pose.rails, linewidth=0.6, color=theme.ink, alpha=0.5)
    _draw(panel, pose.links, linewidth=1.0, color=theme.ink)
    _draw(panel, pose.bars, label, color=theme.ink, linewidth=3.0, markersize=6, **BAR_STYLE)


def _draw(panel: Any, lines: Lines, label: str | None = None, **look: Any) -> None:
    for index, line in enumerate(lines):
        panel.plot(*np.array(line).T, label=label if index == 0 else None, **look)
