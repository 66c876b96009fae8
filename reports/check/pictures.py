"""Two pictures of a check: errors over time, and the mechanism at the moment when it is most wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reference.forces import Spring
from reference.joints import Rod, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reports.charts.drawings import ground_points
from reports.charts.theme import LIGHT, new_figure, settings, style_axes, svg
from reports.check.checked import Checked
from reports.check.comparing import QUANTITIES, UNITS
from reports.check.settings import Tried

Array = NDArray[np.float64]
LEAST = 1e-16


def pictures(found: Checked, advised: Tried | None = None) -> dict[str, tuple[str, str]]:
    """By 'errors' and 'worst': what each shows, and the SVG. `advised`: the settings beside the user's own."""
    advised = advised or found.advised
    named = {
        "errors": ("Errors of your settings over time, beside the judge's own error", _errors(found, advised)),
        "worst": (_worst_title(found), _worst(found)),
    }
    return {key: (title, svg(figure, title)) for key, (title, figure) in named.items()}


def _errors(found: Checked, advised: Tried | None) -> Figure:
    own, judge, theme = found.own_errors, found.judge_errors, LIGHT
    shown = [quantity for quantity in QUANTITIES if np.isfinite(own.of[quantity]).any()]
    with settings():
        figure = new_figure(5.4 if len(shown) > 2 else 3.1, theme)
        panels = figure.subplots(-(-len(shown) // 2), 2, squeeze=False).ravel()
        for panel in panels[len(shown) :]:
            panel.set_axis_off()
        for panel, quantity in zip(panels, shown, strict=False):
            style_axes(panel, theme)
            panel.set_yscale("log")
            lines = [(own, "your settings", theme.first, "-")]
            if advised is not None and not found.met:
                lines.append((advised.errors, "advised settings", theme.second, "--"))
            lines.append((judge, "the judge's own error", theme.quiet, ":"))
            for errors, label, colour, dashes in lines:
                values = np.maximum(errors.of[quantity], LEAST)
                panel.plot(errors.t[1:], values[1:], color=colour, linestyle=dashes, linewidth=1.5, label=label)
            if found.judge.horizon < found.duration:
                panel.axvline(found.judge.horizon, color=theme.third, linestyle="-.", label="errors grow exponentially")
            panel.set_title(f"{quantity} error, {UNITS[quantity]}", loc="left")
            panel.set_xlabel("time, s")
        handles, labels = panels[0].get_legend_handles_labels()
        legend = figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def _worst_sample(found: Checked) -> int:
    whole = np.where(np.isfinite(found.own_errors.whole), found.own_errors.whole, -1.0)
    return int(np.argmax(whole))


def _worst_title(found: Checked) -> str:
    sample = _worst_sample(found)
    return f"The mechanism at {found.own_errors.t[sample]:.3g} s, where your settings are most wrong"


def _worst(found: Checked) -> Figure:
    sample, mechanism, theme = _worst_sample(found), found.reading.mechanism, LIGHT
    truth, own = found.judge.trajectory.pose[sample], found.own.pose[sample]
    with settings():
        figure = new_figure(4.2, theme, width=6.2)
        panel = figure.subplots()
        style_axes(panel, theme)
        panel.set_aspect("equal", adjustable="datalim")
        points = ground_points(mechanism)
        if len(points):
            panel.plot(
                *points.T, linestyle="none", marker="^", markersize=8, color=theme.quiet, label="held to the ground"
            )
        _draw_links(panel, mechanism, truth, color=theme.ink, linewidth=1.0)
        _draw_links(panel, mechanism, own, color=theme.first, linewidth=0.8, linestyle="--")
        _draw(panel, mechanism, truth, "ideal joints", color=theme.ink, linewidth=3.0, markersize=6)
        _draw(panel, mechanism, own, "your settings", color=theme.first, linewidth=1.5, linestyle="--", markersize=4)
        panel.set_xlabel("x in the plane of motion, m")
        panel.set_ylabel("y, m")
        legend = figure.legend(loc="outside lower center", ncols=3, frameon=False)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


def _draw_links(panel: Any, mechanism: Mechanism, pose: Array, **line: Any) -> None:
    """Rods and springs as thin lines between their points, and lines that stand still on which something slides."""
    reach = 2 * max(mechanism.length_scale, float(np.ptp(mechanism.pose[:, :2], axis=0).max()))
    for joint in mechanism.joints:
        if isinstance(joint, Slot) and joint.first is None:
            way = 0.5 * reach * np.array([np.cos(joint.line_angle), np.sin(joint.line_angle)])
            place = _place(mechanism, pose, joint.second, joint.second_point)
            panel.plot(*np.array([place - way, place + way]).T, linewidth=0.6, color=line["color"], alpha=0.5)
    for link in (*mechanism.joints, *mechanism.forces):
        if isinstance(link, Rod | Spring):
            ends = [
                _place(mechanism, pose, name, point)
                for name, point in ((link.first, link.first_point), (link.second, link.second_point))
            ]
            if np.linalg.norm(ends[1] - ends[0]) < 3 * reach:  # not one that stands for a spring along a slide
                panel.plot(*np.array(ends).T, **line)


def _place(mechanism: Mechanism, pose: Array, name: str | None, point: tuple[float, float]) -> Array:
    """A body's own point in the world (2,) [m]."""
    if name is None:
        return np.array(point)
    x, y, angle = pose[mechanism.body_index(name)]
    return np.array([x, y]) + rotated(angle, np.array(point))


def _draw(panel: Any, mechanism: Mechanism, pose: Array, label: str, **line: Any) -> None:
    """Every body as a bar through its joints; one with a single joint reaches to its centre of mass."""
    for index, body in enumerate(mechanism.bodies):
        points = {
            getattr(joint, which)
            for joint in mechanism.joints
            for name, which in ((joint.first, "first_point"), (joint.second, "second_point"))
            if name == body.name and hasattr(joint, which)
        }
        if len(points) < 2:
            points.add((0.0, 0.0))
        world = np.array([_place(mechanism, pose, body.name, point) for point in sorted(points)])
        panel.plot(*world.T, marker="o", solid_capstyle="round", label=label if index == 0 else None, **line)
