"""A motion as an SVG file that moves by itself in any browser: every body is a line through its joints."""

from __future__ import annotations

from html import escape

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.charts.drawings import ground_points

Array = NDArray[np.float64]
WIDTH, HEIGHT = 640.0, 480.0
MARGIN = 30.0
STYLE = (
    "svg { background: #fdfdfc } polyline { fill: none; stroke: #1f2328; stroke-width: 4; stroke-linecap: round } "
    "circle { fill: #1f2328 } path { fill: #5d6670 } text { font: 14px sans-serif; fill: #1f2328 } "
    "@media (prefers-color-scheme: dark) { svg { background: #15191f } polyline { stroke: #e6eaef } "
    "circle { fill: #e6eaef } path { fill: #9aa4af } text { fill: #e6eaef } }"
)


def bars(mechanism: Mechanism, poses: Array) -> list[Array]:
    """World points (times, points, 2) [m] of each body: its joints, with its centre of mass where they are too few."""
    out = []
    for index, body in enumerate(mechanism.bodies):
        own = {
            getattr(joint, which)
            for joint in mechanism.joints
            for name, which in ((joint.first, "first_point"), (joint.second, "second_point"))
            if name == body.name and hasattr(joint, which)
        }
        points = np.array(sorted(own | ({(0.0, 0.0)} if len(own) < 2 else set())), dtype=float)
        x, y, angle = (poses[:, index, column, None] for column in range(3))
        cosine, sine = np.cos(angle), np.sin(angle)
        out.append(
            np.stack(
                [x + cosine * points[:, 0] - sine * points[:, 1], y + sine * points[:, 0] + cosine * points[:, 1]],
                axis=-1,
            )
        )
    return out


def animation(mechanism: Mechanism, motion: Trajectory, title: str) -> str:
    """The SVG's text; it takes as long as the motion, and begins anew."""
    drawn, ground = bars(mechanism, motion.pose), ground_points(mechanism)
    everything = np.concatenate([*(each.reshape(-1, 2) for each in drawn), ground])
    low, high = everything.min(axis=0), everything.max(axis=0)
    scale = min((WIDTH - 2 * MARGIN) / max(high[0] - low[0], 1e-9), (HEIGHT - 2 * MARGIN) / max(high[1] - low[1], 1e-9))
    middle = (low + high) / 2

    def place(points: Array) -> Array:
        return (points - middle) * [scale, -scale] + [WIDTH / 2, HEIGHT / 2]

    duration = f"{float(motion.t[-1]):.6g}s"
    parts = []
    for each in drawn:
        frames = [" ".join(f"{x:.1f},{y:.1f}" for x, y in frame) for frame in place(each)]
        moving = (
            f'<animate attributeName="points" dur="{duration}" repeatCount="indefinite" values="{";".join(frames)}"/>'
        )
        parts.append(f'<polyline points="{frames[0]}">{moving}</polyline>')
    for x, y in place(ground) if len(ground) else []:
        parts.append(f'<path d="M{x:.1f},{y:.1f} l-8,14 h16 z"/>')
    body = "\n".join(parts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" '
        f'height="{HEIGHT:g}" role="img"><title>{escape(title)}</title><style>{STYLE}</style>\n{body}\n'
        f'<text x="10" y="20">{escape(title)}</text>\n</svg>\n'
    )
