"""Pictures of mechanisms. A line connects the joint points of a body, and a circle marks a joint.

`configurations` has a panel for each pose, with methods drawn over the reference motion. `stroboscope` draws several
poses of a motion into one panel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.scene import Scene
from reference.trajectory import body_points, ground_points
from reports.plots.theme import LIGHT, add_legend, bare, drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Largest invisible error of a point as a fraction of the picture, which is the width of a line.
VISIBLE = 5e-3
JOINT_DOTS: dict[str, Any] = {"marker": "o", "markerfacecolor": LIGHT.paper, "markeredgecolor": LIGHT.ink}
INK: dict[str, Any] = {"color": LIGHT.ink, "linewidth": 2.2, "markersize": 4.5, "zorder": 2, **JOINT_DOTS}


def draw_pose(panel: Axes, mechanism: Mechanism, pose: Array, **line: Any) -> None:
    """Draw the bodies at a pose (bodies, 3); keyword arguments are those of `Axes.plot`."""
    for points in body_points(mechanism, pose).values():
        panel.plot(points[:, 0], points[:, 1], solid_capstyle="round", **line)


def draw_ground(panel: Axes, mechanism: Mechanism) -> None:
    points = ground_points(mechanism)
    if len(points):
        panel.plot(points[:, 0], points[:, 1], linestyle="none", marker="^", markersize=7, color=LIGHT.quiet, zorder=1)


def configurations(
    mechanism: Mechanism,
    truth: Array,
    titles: Sequence[str],
    others: Mapping[str, tuple[Array, str, Any]] | None = None,
    columns: int = 3,
) -> Figure:
    """A panel for each reference pose in `truth` (panels, bodies, 3). `others` maps a method to (poses (panels, bodies,
    3), role of the colour, dashes). A method is drawn in panels where its error is visible. The legend marks methods
    without a visible error."""
    from matplotlib.lines import Line2D

    others = others or {}
    looks = {
        name: {"color": getattr(LIGHT, colour), "linewidth": 1.4, "linestyle": dashes}
        for name, (_, colour, dashes) in others.items()
    }
    points = [points for pose in truth for points in body_points(mechanism, pose).values()]
    corners = np.concatenate([*points, ground_points(mechanism)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = float((high - low).max())
    margin = 0.08 * size
    width, height = high - low + 2 * margin
    lines = -(-len(truth) // columns)
    with drawing(lines * (9.2 / columns * float(height / width) + 0.15) + 0.5) as figure:
        panels = figure.subplots(lines, columns, squeeze=False).ravel()
        drawn: set[str] = set()
        for panel in panels:
            panel.set_axis_off()
        for index, (panel, pose, title) in enumerate(zip(panels, truth, titles, strict=False)):
            bare(panel, title)
            panel.set_xlim(low[0] - margin, high[0] + margin)
            panel.set_ylim(low[1] - margin, high[1] + margin)
            draw_ground(panel, mechanism)
            draw_pose(panel, mechanism, pose, **INK)
            for name, (poses, *_) in others.items():
                if visibly_off(mechanism, pose, poses[index], size):
                    drawn.add(name)
                    draw_pose(panel, mechanism, poses[index], zorder=3, **looks[name])
        labels = {name: name if name in drawn else f"{name}: no visible error" for name in others}
        handles = [Line2D([], [], color=LIGHT.ink, linewidth=2.2, label="exact")]
        handles += [Line2D([], [], label=labels[name], **look) for name, look in looks.items()]
        add_legend(figure, handles, 3)
    return figure


def visibly_off(mechanism: Mechanism, truth: Array, pose: Array, size: float) -> bool:
    """Whether the pose is finite and the error of a joint point exceeds VISIBLE times `size` [m]."""
    if not np.isfinite(pose).all():
        return False
    first, second = body_points(mechanism, truth), body_points(mechanism, pose)
    worst = max((float(np.abs(first[name] - second[name]).max()) for name in first if len(first[name])), default=0.0)
    return worst > VISIBLE * size


Points = tuple[tuple[float, float], ...]

LEAST_OPACITY = 0.12
LINE_BREAK = np.full((1, 2), np.nan)
BLOCK_SIZE = 0.045  # side of the square that shows a body with one joint point, as a fraction of the picture


@dataclass(frozen=True)
class Strip:
    """One panel: A panel with `count` poses of a scene's reference motion from `start` to `end` [s]. ends: points of
    bodies without a joint, such as a free end, in the body's frame [m]. spread: shift to the right between successive
    poses [m]. trace: a body and one of its points, whose path is drawn. floor: whether a line at y = 0 is drawn."""

    scene: Scene
    title: str
    count: int
    start: float = 0.0
    end: float | None = None
    ends: Mapping[str, Points] = field(default_factory=dict)
    spread: float = 0.0
    trace: tuple[str, tuple[float, float]] | None = None
    floor: bool = False

    def times(self) -> Array:
        return np.linspace(self.start, self.scene.duration if self.end is None else self.end, self.count)

    @property
    def caption(self) -> str:
        t = self.times()
        return f"{self.title}: every {t[1] - t[0]:.3g} s" if len(t) > 1 else f"{self.title}: {t[0]:.3g} s"


def outline(mechanism: Mechanism, pose: Array, ends: Mapping[str, Points]) -> dict[str, Array]:
    """Body -> its joint points and free ends (points, 2) [m] in the ground's frame, sorted along the body's x axis."""
    out = {}
    for name, points in body_points(mechanism, pose).items():
        x, y, angle = pose[mechanism.body_index(name)]
        free_ends = rotated(angle, np.array(ends.get(name, ()), dtype=float).reshape(-1, 2)) + np.array([x, y])
        points = np.concatenate([points, free_ends])
        out[name] = points[np.argsort((points - (x, y)) @ (np.cos(angle), np.sin(angle)), kind="stable")]
    return out


def path(scene: Scene, body: str, point: tuple[float, float], t: Array) -> Array:
    """The path (times, 2) [m] of a point of a body. `point` is in the body's frame [m]."""
    pose = scene.motion(t).pose[:, scene.mechanism().body_index(body)]
    return pose[:, :2] + rotated(pose[:, 2], np.array(point))


def stroboscope(strips: Sequence[Strip], columns: int = 2) -> Figure:
    """A panel for each strip with all its poses; the last pose is the darkest."""
    poses_of_strips = [_poses(strip) for strip in strips]
    boxes = [_box(strip, poses) for strip, poses in zip(strips, poses_of_strips, strict=True)]
    columns = min(columns, len(strips))
    lines = [range(i, min(i + columns, len(strips))) for i in range(0, len(strips), columns)]
    width = 9.2 / columns
    heights = [max(width * (boxes[i][3] - boxes[i][1]) / (boxes[i][2] - boxes[i][0]) for i in line) for line in lines]
    heights = [min(max(height, 1.0), 1.1 * width) for height in heights]
    with drawing(sum(heights) + 0.35 * len(lines)) as figure:
        panels = figure.subplots(len(lines), columns, squeeze=False, height_ratios=heights).ravel()
        for spare in panels[len(strips) :]:
            spare.set_visible(False)
        for panel, strip, poses, box in zip(panels, strips, poses_of_strips, boxes, strict=False):
            bare(panel, strip.caption)
            panel.set_xlim(box[0], box[2])
            panel.set_ylim(box[1], box[3])
            _draw(panel, strip, poses, max(box[2] - box[0], box[3] - box[1]))
    return figure


def _poses(strip: Strip) -> list[dict[str, Array]]:
    mechanism, out = strip.scene.mechanism(), []
    for index, pose in enumerate(strip.scene.motion(strip.times()).pose):
        bodies = outline(mechanism, pose, strip.ends)
        out.append({name: points + np.array([strip.spread * index, 0.0]) for name, points in bodies.items()})
    return out


def _box(strip: Strip, poses: list[dict[str, Array]]) -> tuple[float, float, float, float]:
    corners = np.concatenate([points for bodies in poses for points in bodies.values() if len(points)])
    if strip.floor:
        corners = np.concatenate([corners, [[corners[0, 0], 0.0]]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.06 * float((high - low).max())
    return low[0] - margin, low[1] - margin, high[0] + margin, high[1] + margin


def _draw(panel: Axes, strip: Strip, poses: list[dict[str, Array]], size: float) -> None:
    if strip.floor:
        panel.axhline(0.0, color=LIGHT.quiet, linewidth=1.0, zorder=1)
    elif not strip.spread:
        draw_ground(panel, strip.scene.mechanism())
    if strip.trace is not None:
        t = strip.times()
        body, point = strip.trace
        line = path(strip.scene, body, point, np.linspace(t[0], t[-1], 40 * len(t)))
        panel.plot(line[:, 0], line[:, 1], color=LIGHT.second, linewidth=0.9, zorder=2)
    few_bodies, is_film = max(len(bodies) for bodies in poses) < 20, bool(strip.spread)
    look: dict[str, Any] = {
        "color": LIGHT.ink,
        "solid_capstyle": "round",
        "linewidth": 2.0 if few_bodies else 1.3,
        "zorder": 3,
    }
    for index, bodies in enumerate(poses):
        is_separate = is_film or len(poses) == 1
        opacity = 1.0 if is_separate else LEAST_OPACITY + (1 - LEAST_OPACITY) * (index / (len(poses) - 1)) ** 1.5
        parts: list[Array] = []
        for points in bodies.values():
            if len(np.unique(points.round(12), axis=0)) == 1:
                corners = np.array([[-1, -0.6], [1, -0.6], [1, 0.6], [-1, 0.6], [-1, -0.6]])
                block = points[0] + BLOCK_SIZE * size / 2 * corners
                panel.plot(*block.T, color=LIGHT.ink, alpha=opacity, linewidth=1.4, zorder=3)
            else:
                parts += [points, LINE_BREAK]
        dots = {**JOINT_DOTS, "markersize": 3.0} if few_bodies and (is_film or index == len(poses) - 1) else {}
        panel.plot(*np.concatenate(parts).T, alpha=opacity, **look, **dots)
