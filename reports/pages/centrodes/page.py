"""The page of centrodes: a coupler's motion as the rolling of two curves, and errors of instant centres in engines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from engines import method_name
from engines.registry import VARIANTS
from reference.chapter.centrodes import Centrodes, centrode_error, centrodes, from_poses
from reference.checks import InvalidMechanism, freeze
from reference.joints import Pin
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory
from reference.validators import Array
from reports.model.cells import Cell
from reports.model.page import Material, Page
from reports.model.tasks import Motion
from reports.plots.mechanisms import draw_ground, draw_pose
from reports.plots.theme import LIGHT, bare, drawing, note, style_axes, svg
from reports.write.tables import markdown, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_POSES_CHECKED = 101


def returned(curves: Centrodes) -> tuple[float, float]:
    """The largest distance [m] of the rolling body's origin from the poses, and the checked range of rotation [rad].
    Raises InvalidMechanism if the curves can't roll on each other."""
    rolling = curves.rolling()
    low, high = rolling.limits
    inside = np.flatnonzero((curves.theta >= low) & (curves.theta <= high))
    if not inside.size:
        raise InvalidMechanism("round trip: no pose lies within the rotations at which the curves touch")
    inside = inside[:: max(1, len(inside) // MAX_POSES_CHECKED)]
    pose: Array = curves.pose[inside]
    distance = np.linalg.norm(rolling.pose(pose[:, 2])[:, :2] - pose[:, :2], axis=-1)
    return float(distance.max()), float(np.ptp(pose[:, 2]))


def draw_centrodes(mechanism: Mechanism, poses: Array, curves: Centrodes, indices: Sequence[int], body: int) -> Figure:
    """A panel for each sample in `indices`. `poses` (samples, bodies, 3) and `curves` have the same samples."""
    from matplotlib.lines import Line2D

    with drawing(4.4) as figure:
        for panel, index in zip(figure.subplots(1, len(indices), sharex=True, sharey=True), indices, strict=True):
            bare(panel, "")
            pose, centre = poses[index], curves.space[index]
            coupler = mechanism.bodies[body].name
            for joint in mechanism.joints:
                # The lines of crank and rocker, extended to the instant centre.
                if isinstance(joint, Pin) and joint.first is None and joint.second != coupler:
                    line = np.stack([np.asarray(joint.first_point), centre])
                    panel.plot(*line.T, color=LIGHT.grid, linewidth=1.2, zorder=0)
            panel.plot(*curves.space.T, color=LIGHT.first, linewidth=2, zorder=1)
            moved = rotated(np.asarray(pose[body, 2]), curves.body) + pose[body, :2]
            panel.plot(*moved.T, color=LIGHT.second, linewidth=2, linestyle="--", zorder=2)
            draw_ground(panel, mechanism)
            draw_pose(panel, mechanism, pose, color=LIGHT.ink, linewidth=2, marker="o", markersize=4.5,
                      markerfacecolor=LIGHT.paper, markeredgecolor=LIGHT.ink, zorder=3)  # fmt: skip
            panel.plot(*centre, "o", color=LIGHT.fourth, markersize=6, zorder=4)
            _letters(panel, mechanism, pose)
        handles = [
            Line2D([], [], color=LIGHT.first, linewidth=2, label="fixed centrode"),
            Line2D([], [], color=LIGHT.second, linewidth=2, linestyle="--", label="moving centrode"),
            Line2D([], [], color=LIGHT.fourth, marker="o", linestyle="none", label="instant centre"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _letters(panel: Axes, mechanism: Mechanism, pose: Array) -> None:
    """Write the names of pins. The name of a ground pin is beyond the bar's end, and other names are outside of the
    linkage."""
    pins, bars = {}, {}
    for joint in mechanism.joints:
        if isinstance(joint, Pin) and joint.second is not None:
            x, y, angle = pose[mechanism.body_index(joint.second)]
            bars[joint] = np.array([x, y])
            pins[joint] = rotated(angle, np.asarray(joint.second_point)) + bars[joint]
    middle = np.mean(list(pins.values()), axis=0)
    for joint, point in pins.items():
        direction = point - (middle if joint.first is not None else bars[joint])
        direction = direction if np.any(direction) else np.array([0.0, 1.0])
        offset_x, offset_y = 11 * direction / np.linalg.norm(direction)
        box = {"facecolor": LIGHT.paper, "edgecolor": "none", "pad": 0.0}
        note(panel, joint.name, point, (offset_x, offset_y), LIGHT.ink, ha="center", va="center", zorder=5, bbox=box)


def draw_rate(curves: Centrodes) -> Figure:
    """A chart of ds/dtheta by two formulas, from the path of the instant centre and from both curvatures."""
    total = 1 / (curves.space_curvature + curves.body_curvature)
    degrees = np.degrees(curves.theta)
    with drawing(4.0) as figure:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
        above.plot(degrees, curves.rate, color=LIGHT.first, linewidth=4, alpha=0.5, label="ds/dθ, path of the centre")
        above.plot(degrees, total, color=LIGHT.ink, linewidth=1.2, label="1/($\\kappa_A+\\kappa_B$), both curvatures")
        below.semilogy(degrees, np.maximum(np.abs(total / curves.rate - 1), 1e-17), color=LIGHT.ink, linewidth=1)
        for panel, label in ((above, "m/rad"), (below, "relative\ndifference")):
            style_axes(panel)
            panel.set_ylabel(label)
        above.legend()
        below.set_xlabel("angle of the coupler [degrees]")
    return figure


COUPLER_INDEX = 1
# Range of crank angles [rad] without a zero of the coupler's rate; its zeros are at 2.80 and 5.94 rad.
ARC = (3.5, 5.5)
ARC_SAMPLES = 401
# Samples without the ends of the arc, where the second derivative of a spline is least accurate.
INNER = slice(20, -20)
CENTRODE_STEPS = (1, 10)  # steps between samples of the scene
CENTRODE_CELLS = tuple(Cell(DrivenFourBar(), engine, every) for engine in VARIANTS for every in CENTRODE_STEPS)


def times(count: int) -> np.ndarray:
    """Equally spaced times (count,) [s] at which the crank is within ARC."""
    scene = DrivenFourBar()
    return np.linspace((ARC[0] - scene.start) / scene.rate, (ARC[1] - scene.start) / scene.rate, count)


@cache
def exact() -> tuple[Trajectory, Centrodes]:
    """The reference motion within ARC, and the centrodes of the coupler."""
    truth = freeze(DrivenFourBar().motion(times(ARC_SAMPLES)))
    return truth, centrodes(truth.t, truth.pose[:, COUPLER_INDEX], truth.twist[:, COUPLER_INDEX])


def figures(material: Material) -> dict[str, str]:
    truth, curves = exact()
    mechanism = DrivenFourBar().mechanism()
    # The curves are sorted by rotation; the poses must have the same order.
    poses = truth.pose if truth.pose[-1, COUPLER_INDEX, 2] > truth.pose[0, COUPLER_INDEX, 2] else truth.pose[::-1]
    picture = draw_centrodes(mechanism, poses, curves, (ARC_SAMPLES // 4, 3 * ARC_SAMPLES // 4), COUPLER_INDEX)
    return {
        "mechanism": svg(picture, "The four-bar with the centrodes of its coupler"),
        "rate": svg(draw_rate(curves), "How far the instant centre moves in a radian"),
    }


def round_trip(curves: Centrodes) -> float:
    """The largest distance [m] between the motion of the rolling curves and the exact motion, also between the
    samples."""
    between = DrivenFourBar().motion(times(2 * ARC_SAMPLES)[1:-1]).pose[:, COUPLER_INDEX]
    rolling = curves.rolling()
    low, high = rolling.limits
    between = between[(between[:, 2] > low) & (between[:, 2] < high)]
    difference = rolling.pose(between[:, 2]) - between
    return float(np.linalg.norm(difference[:, :2], axis=-1).max())


def agreement(curves: Centrodes) -> float:
    """The largest relative difference between ds/dtheta and 1/(kappa_A + kappa_B) within INNER."""
    total = curves.space_curvature + curves.body_curvature
    return float(np.abs(curves.rate * total - 1)[INNER].max())


def measured(material: Material) -> list[tuple[Cell, float, float, float]]:
    """Rows (cell, centre error [m], angle error [rad], rate error [rad/s]) for the cells with a stored motion."""
    low, high = times(2)
    rows = []
    for cell, run in material.motions(CENTRODE_CELLS).items():
        truth, within = DrivenFourBar().motion(run.t), (run.t >= low) & (run.t <= high)
        angle, rate = (
            np.abs(ours - exact)[within, COUPLER_INDEX, 2]
            for ours, exact in ((run.pose, truth.pose), (run.twist, truth.twist))
        )
        centre = centrode_error(truth, run, COUPLER_INDEX)[within]
        # The centre is NaN for a body that hardly turns, and after the end of a run.
        rows.append((cell, largest(centre[np.isfinite(centre)]), largest(angle), largest(rate)))
    return rows


def largest(values: np.ndarray) -> float:
    """The largest value. The result is NaN for an empty array or if a value is NaN."""
    return float(values.max()) if values.size else math.nan


def context(material: Material) -> Mapping[str, Any]:
    truth, curves = exact()
    position, table = round_trip(curves), round_trip(from_poses(truth.t, truth.pose[:, COUPLER_INDEX]))
    rows = measured(material)
    body = [
        [method_name(cell.engine), *map(number, (cell.step, centre, angle, rate))] for cell, centre, angle, rate in rows
    ]
    header = ["method", "step [s]", "centre error [m]", "angle error [rad]", "rate error [rad/s]"]
    return {
        "arc": ARC,
        "samples": ARC_SAMPLES,
        "agreement": agreement(curves),
        "returned": {"position": position, "table": table},
        "table": markdown(header, body) if rows else "Nothing ran.",
        "lesson": _lesson(rows),
    }


def _lesson(rows: list[tuple[Cell, float, float, float]]) -> str:
    ratios = [(centre / angle, row) for row in rows if (angle := row[2]) > 0 and math.isfinite(centre := row[1])]
    if not ratios:
        return ""
    _, (cell, centre, angle, _) = max(ratios, key=lambda pair: pair[0])
    return (
        f"An angle can be right while the velocities are not. {method_name(cell.engine)} at a step of "
        f"{number(cell.step)} s has an angle error of {number(angle)} rad and a centre error of {number(centre)} m."
    )


PAGE = Page(
    name="centrodes",
    title="Centrodes: any motion as rolling",
    lesson="Every plane motion is one curve rolling on another, and the instant centre shows errors of velocity.",
    companions=(DrivenFourBar(),),
    figures=figures,
    context=context,
    tasks=tuple(map(Motion, CENTRODE_CELLS)),
)
