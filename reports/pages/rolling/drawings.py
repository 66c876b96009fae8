"""Drawings of rolling bodies: roulettes, contacts, elliptic gears, acceleration, friction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from reference.plane import rotated
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring, Side, Vector
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary, Parabola
from reference.rolling.roll import Roll
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingScene
from reference.validators import Array
from reports.plots.theme import LIGHT, bare, drawing, note, style_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

POINTS_PER_CURVE = 241


@dataclass(frozen=True)
class Roulette:
    """A rolling body and the path of one of its points. point: coordinates in the body's frame [m]. path: rotations
    [rad] of the body at the ends of the path. shown: rotations [rad] at which the body is drawn. ground, body: arcs [m]
    between which the curves are drawn, or None for the whole body."""

    title: str
    rolling: Rolling
    point: Vector
    path: tuple[float, float]
    shown: tuple[float, ...]
    ground: tuple[float, float]
    body: tuple[float, float] | None = None


def roulettes() -> tuple[Roulette, ...]:
    turn, focus, ring = 2 * math.pi, (0.4, 0.0), Ring(0.6)
    disc, ellipse = Circle(0.4), Ellipse(0.5, 0.3)
    on_line = ((-turn, 0.0), (-turn, -4.2, -2.1, 0.0), (-2.9, 0.4))
    twins = Rolling.at_arcs(ellipse, Placed(ellipse, turn=math.pi / 2), 0.0, 0.0)
    inside = Rolling.at_arcs(Circle(0.45), ring)
    # The parabola's material is above the curve, so its convex side rolls on the line.
    parabola = Rolling.at_arcs(Parabola(0.3), Line())
    low, high, angles_shown = parabola.theta - 1.1, parabola.theta + 1.1, parabola.theta + np.array([-0.8, 0.0, 0.8])
    square, eighth = Rolling.at_arcs(Side(1.0), Placed(Catenary(0.5), turn=math.pi)), math.pi / 4
    around = (0.0, 2 * turn), (math.pi, math.pi + 2.2, math.pi + 4.3), (0.0, ellipse.length)
    hypocycloid = "a point of a rim in a ring of 4/3 its radius: hypocycloid"
    level = "a square on catenaries: its centre stays level"
    return (
        Roulette("a point of a rim on a line: cycloid", Rolling.at_angle(disc, Line()), (0.0, -0.4), *on_line),
        Roulette("focus of an ellipse on a line", Rolling.at_angle(ellipse, Line()), focus, *on_line),
        Roulette("focus of an ellipse on its twin: a circle", twins, focus, *around),
        Roulette(hypocycloid, inside, (0.45, 0.0), (-turn, 0.0), (-1.4, -0.7, 0.0), (0.0, ring.length)),
        Roulette(
            *("focus of a parabola on a line: catenary", parabola, (0.0, 0.3)),
            *((low, high), tuple(angles_shown.tolist()), (-1.4, 1.4), (-0.9, 0.9)),
        ),
        Roulette(level, square, (0.0, 0.0), (-eighth, eighth), (-eighth, 0.0, eighth), (-0.5, 0.5)),
    )


def outline(curve: Curve, arcs: tuple[float, float] | None = None) -> Array:
    """Points (n, 2) [m] of a boundary between two arcs. Without arcs, the points are on the whole boundary, which is a
    square for a Side."""
    if isinstance(curve, Side) and arcs is None:
        half = curve.side / 2
        return half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]], dtype=float)
    low, high = arcs or (0.0, curve.length)
    return curve.point(np.linspace(low, high, POINTS_PER_CURVE))


def placed(points: Array, pose: Array) -> Array:
    """Points (n, 2) [m] of a body with the pose (3,), in the frame of the ground."""
    return rotated(np.asarray(pose[2]), points) + pose[:2]


def draw_roulettes(chosen: Sequence[Roulette], columns: int = 2) -> Figure:
    rows = -(-len(chosen) // columns)
    with drawing(2.75 * rows) as figure:
        for panel, roulette in zip(figure.subplots(rows, columns, squeeze=False).ravel(), chosen, strict=False):
            bare(panel, roulette.title)
            ground = outline(roulette.rolling.ground, roulette.ground)
            panel.plot(*ground.T, color=LIGHT.ink, linewidth=1.8)
            body = outline(roulette.rolling.body, roulette.body)
            for theta in roulette.shown:
                pose = roulette.rolling.pose(theta)
                panel.plot(*placed(body, pose).T, color=LIGHT.quiet, linewidth=1.0)
                arm = roulette.rolling.position(theta, roulette.point)
                panel.plot(*np.stack([roulette.rolling.contact(theta).point, arm]).T, color=LIGHT.quiet, linewidth=0.8)
                panel.plot(*arm, "o", color=LIGHT.first, markersize=4.5, zorder=4)
            path = roulette.rolling.position(np.linspace(*roulette.path, 2 * POINTS_PER_CURVE), roulette.point)
            panel.plot(*path.T, color=LIGHT.first, linewidth=2.0, zorder=3)
    return figure


def draw_contact() -> Figure:
    """An ellipse on a hill, on flat ground and in a hole, with the contact C, its unit vectors and the circle of
    curvature."""
    body = Ellipse(0.5, 0.3)
    hill, hole = Placed(Circle(0.8), turn=math.pi / 2), Placed(Ring(1.1), turn=-math.pi / 2)
    grounds: tuple[tuple[str, Curve], ...] = (("on a hill", hill), ("on flat ground", Line()), ("in a hole", hole))
    theta = 0.35
    with drawing(3.5) as figure:
        for panel, (where, ground) in zip(figure.subplots(1, 3), grounds, strict=True):
            rolling = Rolling.at_angle(body, ground, theta)
            contact = rolling.contact(theta)
            a, b = float(contact.ground_curvature), float(contact.body_curvature)
            curvatures = f"$\\kappa_A$ = {a:.2f}, $\\kappa_B$ = {b:.2f} 1/m"
            bare(panel, f"{where}: {curvatures}\n$ds/d\\theta$ = {contact.rate:.3f} m/rad")
            near = np.linspace(-0.75, 0.75, POINTS_PER_CURVE) + float(contact.ground_arc)
            panel.plot(*ground.point(near).T, color=LIGHT.ink, linewidth=2.0)
            panel.plot(*placed(outline(body), rolling.pose(theta)).T, color=LIGHT.quiet, linewidth=1.6)
            point, tangent, normal = contact.point, contact.tangent, contact.normal
            turn = np.linspace(0, 2 * math.pi, POINTS_PER_CURVE)
            circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
            panel.plot(*(point + normal / b + circle / b).T, color=LIGHT.fourth, linewidth=1.2, linestyle=":")
            for vector, name, colour in ((tangent, "$e_t$", LIGHT.first), (normal, "$e_n$", LIGHT.second)):
                tip = point + 0.45 * vector
                arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.8}
                panel.annotate("", tip, point, arrowprops=arrow, zorder=5)
                # The label of e_t is above the arrow, except in the hole, where the ground rises.
                above = (0.09 if a >= 0 else -0.09) * normal if vector is tangent else 0.0
                panel.annotate(name, point + 0.53 * vector + above, color=colour, ha="center", va="center", fontsize=11)
            panel.plot(*point, "o", color=LIGHT.ink, markersize=4, zorder=6)
            middle = rolling.pose(theta)[:2] + 0.08 * tangent
            for letter, point_of_letter, colour in (
                ("C", point - 0.09 * normal, LIGHT.ink),
                ("A", point - 0.3 * normal, LIGHT.ink),
                ("B", middle, LIGHT.quiet),
            ):
                panel.annotate(letter, point_of_letter, color=colour, ha="center", va="center")
            panel.set_xlim(point[0] - 0.85, point[0] + 0.85)
            panel.set_ylim(point[1] + 0.3 - 0.62, point[1] + 0.3 + 0.72)
    return figure


def draw_gears(scene: EllipticGears) -> Figure:
    turn = 2 * math.pi / scene.turning_rate
    times = (0.15 + np.arange(4)) * turn / 4
    with drawing(4.6) as figure:
        grid = figure.add_gridspec(2, 4, height_ratios=[1.0, 1.1])
        truth = scene.motion(times)
        [roll] = [joint for joint in scene.mechanism().joints if isinstance(joint, Roll)]
        rim = outline(roll.rolling.body)
        for index in range(4):
            panel = figure.add_subplot(grid[0, index])
            bare(panel, f"t = {times[index]:.2f} s")
            for gear, colour in ((0, LIGHT.first), (1, LIGHT.second)):
                pose = truth.pose[index, gear]
                panel.plot(*placed(rim, pose).T, color=colour, linewidth=1.8)
                panel.plot(2 * scene.major * gear, 0.0, "^", color=LIGHT.ink, markersize=6)
                spoke = np.stack([[2 * scene.major * gear, 0.0], pose[:2]])
                panel.plot(*spoke.T, color=colour, linewidth=1.0)
            reach = 1.06 * scene.major * (1 + scene.eccentricity)
            panel.set_xlim(-reach, 2 * scene.major + reach)
            panel.set_ylim(-reach, reach)
        panel = figure.add_subplot(grid[1, :])
        style_axes(panel)
        t = np.linspace(0, 2 * turn, 400)
        rates = scene.motion(t).twist[:, :, 2]
        panel.plot(t, rates[:, 0], color=LIGHT.first, linewidth=1.8)
        panel.plot(t, rates[:, 1], color=LIGHT.second, linewidth=1.8)
        note(panel, "first gear", (t[-1], rates[-1, 0]), (-4, 5), LIGHT.first, ha="right")
        low = int(np.argmin(rates[:, 1]))
        note(panel, "second gear", (t[low], rates[low, 1]), (28, 4), LIGHT.second)
        panel.set_xlabel("time [s]")
        panel.set_ylabel("rate [rad/s]")
    return figure


FRICTION_COEFFICIENTS = (0.2, 0.5, 1.0)


def draw_acceleration() -> Figure:
    """Two terms of the acceleration, from rolling and from rotation about a pin at C, for an ellipse and for discs."""
    with drawing(3.6) as figure:
        left_panel, right = figure.subplots(1, 2)
        rolling = Rolling.at_angle(Ellipse(0.5, 0.3), Line())
        theta = np.linspace(0, math.pi, 400)
        pinned = np.linalg.norm(rolling.pinned_acceleration(theta, 1.0, 0.0), axis=-1)
        term = np.linalg.norm(rolling.rolling_acceleration(theta, 1.0), axis=-1)
        for values, name, colour, index in (
            (pinned, "pinned at C: $\\omega^2 r$", LIGHT.second, 200),
            (term, "rolling: $\\omega^2/(\\kappa_A+\\kappa_B)$", LIGHT.first, 30),
        ):
            left_panel.plot(np.degrees(theta), values, color=colour, linewidth=2)
            note(left_panel, name, (np.degrees(theta[index]), values[index]), (4, 6), colour)
        _axes(
            left_panel,
            "an ellipse on flat ground, its centre",
            "rotation [degrees]",
            "acceleration at 1 rad/s [m/s$^2$]",
        )
        left_panel.set_xticks([0, 45, 90, 135, 180])
        fit = np.geomspace(1e-3, 30, 200)  # ratio (kappa_A + kappa_B) / kappa_B of a disc
        right.plot(fit, 1 / fit, color=LIGHT.first, linewidth=2)
        right.axhline(1.0, color=LIGHT.second, linewidth=2)
        note(right, "as if pinned at C", (1.3e-2, 1.0), (0, -12), LIGHT.second)
        note(right, "rolling term", (2e-3, 500), (12, 2), LIGHT.first)
        for ratio, label, height in ((1.0, "flat", 0.025), (10.0, "sharp", 4.0), (0.01, "hole 1 %\nlarger", 0.025)):
            right.axvline(ratio, color=LIGHT.quiet, linewidth=0.8, linestyle=":")
            note(right, label, (ratio, height), (3, 0), LIGHT.quiet, va="bottom")
        right.set_xscale("log")
        right.set_yscale("log")
        right.set_ylim(0.02, 2e3)
        across, up = "$(\\kappa_A+\\kappa_B)/\\kappa_B$", "parts of $\\omega^2 r$"
        _axes(right, "a disc's centre, against how well the curves fit", across, up)
    return figure


def draw_friction(scenes: Sequence[RollingScene]) -> Figure:
    """The ratio |T|/N of contact forces over time, and the instants at which contacts slip or hop."""
    with drawing(3.6) as figure:
        for index, (panel, scene) in enumerate(zip(figure.subplots(1, len(scenes), sharey=True), scenes, strict=True)):
            law, end = scene.motion_law, scene.hop or scene.duration
            t = np.linspace(0, end * (1 - 1e-9), 800)
            panel.plot(t, law.required_friction(t), color=LIGHT.ink, linewidth=1.8)
            for friction in FRICTION_COEFFICIENTS:
                panel.axhline(friction, color=LIGHT.second, linewidth=1.0, linestyle="--")
                # The label is beside the panel, because within the panel it may cover the curve.
                beside = {"xycoords": ("axes fraction", "data"), "va": "center", "annotation_clip": False}
                note(panel, f"$\\mu$ = {friction:g}", (1.0, friction), (3, 0), LIGHT.second, fontsize=8, **beside)
                if (slip := law.slip(friction, scene.duration)) is not None:
                    panel.plot(slip, friction, "o", color=LIGHT.first, markersize=6, zorder=4)
                    offset, side = ((7, -11), "left") if slip < 0.3 * scene.duration else ((-7, 4), "right")
                    note(panel, f"slips {slip:.3f} s", (slip, friction), offset, LIGHT.first, fontsize=8, ha=side)
            if scene.hop is not None:
                panel.axvline(scene.hop, color=LIGHT.first, linewidth=1.4)
                label = f"hops {scene.hop:.3f} s"
                note(panel, label, (scene.hop, 1.45), (-14, 0), LIGHT.first, fontsize=8, ha="right")
            panel.set_ylim(0, 1.6)
            panel.set_xlim(0, scene.duration)
            up = "friction demanded, |T| / N" if index == 0 else ""
            _axes(panel, scene.name.replace("_", " "), "time [s]", up)
    return figure


def _axes(panel: Axes, title: str, across: str, up: str) -> None:
    style_axes(panel)
    panel.set_title(title, loc="left", fontsize=9.5, color=LIGHT.ink)
    panel.set_xlabel(across)
    panel.set_ylabel(up)
