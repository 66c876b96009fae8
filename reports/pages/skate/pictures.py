"""Pictures of a skate from the reference alone: parallel parking, the commutator, and an ideal skate on a slope."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from reference.chapter.parking import Move, commutator, commutator_displacement, park, sidestep, stops, trace
from reference.joints import Triple
from reference.scenes.skates.slopes import SkateOnSlope
from reports.charts.plane_panels import Blades, Note, Panel, Path, paths

BLADE = 0.35  # m
GAP = (0.0, 1.0, 0.0)  # the pose that is asked for: straight sideways of the start


def parking() -> Figure:
    """From a pose to the one beside it: with all the room, within a lane, and by ever smaller commutators."""
    start: Triple = (0.0, 0.0, 0.0)
    panels = [
        _manoeuvre("turn, slide, turn", start, park(start, GAP)),
        _manoeuvre("sidestep, at most 0.6 rad", start, sidestep(GAP[1], 0.5, 0.6)),
        _manoeuvre("the commutator: 0.8 rad, 1 m", start, commutator(0.8, 1.0)),
    ]
    sizes = np.geomspace(1.0, 1e-3, 60)
    moved = commutator_displacement(sizes, sizes) / sizes[:, None] ** 2
    panels.append(
        Panel(
            "the commutator's way, over the product of its moves",
            [
                Path(np.column_stack([sizes, moved[:, 1]]), "sideways, towards 1", "third"),
                Path(np.column_stack([sizes, moved[:, 0]]), "along, towards 0", "first", "--"),
            ],
            plane=False,
            across="size of both moves [rad, m]",
            logarithmic_across=True,
        )
    )
    return paths(panels, columns=2, height=2.6)


def _manoeuvre(title: str, start: Triple, moves: tuple[Move, ...]) -> Panel:
    way, poses = trace(start, moves), stops(start, moves)
    return Panel(
        title,
        [Path(way[:, :2], "path of C", "second", "-", 1.6)],
        [Blades(poses[1:-1], BLADE, "quiet", 1.6), Blades(poses[[0, -1]], BLADE, "ink", 3.4)],
        [
            Note((poses[0][0], poses[0][1] - 0.16), "from", "center"),
            Note((poses[-1][0], poses[-1][1] + 0.16), "to", "center"),
        ],
    )


def slope() -> Figure:
    """An ideal skate that turns on an incline: it goes sideways in cycloids, and never down."""
    t = np.linspace(0, 2 * math.pi, 721)
    panels = []
    for title, scene in (
        ("turning at 1 rad/s from rest, blade across the slope", SkateOnSlope(turning_rate=1.0)),
        ("the same with a push of 0.5 m/s", SkateOnSlope(turning_rate=1.0, speed=0.5)),
    ):
        poses = scene.motion(t).pose[:, 0]
        panels.append(
            Panel(
                title,
                [Path(poses[:, :2], "path of C; down the slope is down", "second", "-", 1.6, dot=True)],
                [Blades(poses[::60], BLADE, "ink", 2.2)],
            )
        )
    return paths(panels, columns=2)
