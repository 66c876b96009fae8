"""The page of centrodes: a four-bar's coupler as rolling, and the instant centre as a measure of engines."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from engines.registry import VARIANTS
from reference.chapter.centrodes import Centrodes, centrode_error, centrodes, from_poses
from reference.checks import fixed
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory
from reports.charts.theme import svg
from reports.grid.cells import Cell
from reports.grid.tasks import Motion
from reports.pages.centrodes import drawings as centrode_drawings
from reports.pages.page import Material, Page
from reports.text.tables import markdown, number

COUPLER = 1  # its place among the bodies
# Crank angles [rad] between which the coupler turns one way, and well: its rate vanishes at 2.80 and 5.94 rad.
ARC = (3.5, 5.5)
SAMPLES = 401
# Away from the arc's ends, where a spline's second derivative loses most.
INNER = slice(20, -20)
STEPS = (1, 10)  # per sample of the scene
CELLS = tuple(Cell(DrivenFourBar(), engine, every) for engine in VARIANTS for every in STEPS)


def times(count: int) -> np.ndarray:
    """Times (count,) [s] at which the crank passes the arc."""
    scene = DrivenFourBar()
    return np.linspace((ARC[0] - scene.start) / scene.rate, (ARC[1] - scene.start) / scene.rate, count)


@cache
def exact() -> tuple[Trajectory, Centrodes]:
    """The motion over the arc and both curves of the coupler."""
    truth = fixed(DrivenFourBar().motion(times(SAMPLES)))
    return truth, centrodes(truth.t, truth.pose[:, COUPLER], truth.twist[:, COUPLER])


def figures(material: Material) -> dict[str, str]:
    """The mechanism with both curves, and how far the centre runs in a radian."""
    truth, curves = exact()
    mechanism = DrivenFourBar().mechanism()
    # The curves run by growing rotation; so must the poses beside them.
    poses = truth.pose if truth.pose[-1, COUPLER, 2] > truth.pose[0, COUPLER, 2] else truth.pose[::-1]
    drawn = centrode_drawings.draw_centrodes(mechanism, poses, curves, (SAMPLES // 4, 3 * SAMPLES // 4), COUPLER)
    return {
        "mechanism": svg(drawn, "The four-bar with the centrodes of its coupler"),
        "rate": svg(centrode_drawings.draw_rate(curves), "How far the instant centre runs in a radian"),
    }


def round_trip(curves: Centrodes) -> float:
    """How far rolling the curves is from the exact motion, between the samples they were made of [m]."""
    between = DrivenFourBar().motion(times(2 * SAMPLES)[1:-1]).pose[:, COUPLER]
    rolling = curves.rolling()
    low, high = rolling.limits
    between = between[(between[:, 2] > low) & (between[:, 2] < high)]
    apart = rolling.pose(between[:, 2]) - between
    return float(np.linalg.norm(apart[:, :2], axis=-1).max())


def agreement(curves: Centrodes) -> float:
    """Largest relative difference between ds/dtheta and 1/(kappa_A + kappa_B), away from the ends."""
    total = curves.space_curvature + curves.body_curvature
    return float(np.abs(curves.rate * total - 1)[INNER].max())


def measured(material: Material) -> list[tuple[Cell, float, float, float]]:
    """(cell, centre error [m], angle error [rad], rate error [rad/s]) of each method, where it ran."""
    scene = DrivenFourBar()
    found = material.motions(CELLS)
    low, high = times(2)
    out = []
    for cell, run in found.items():
        truth = scene.motion(run.t)
        within = (run.t >= low) & (run.t <= high)
        apart = np.abs(run.pose - truth.pose)[within, COUPLER, 2], np.abs(run.twist - truth.twist)[within, COUPLER, 2]
        centre = centrode_error(truth, run, COUPLER)[within]
        # Where a body hardly turns its centre is not defined; where a run broke off, nothing is.
        out.append((cell, largest(centre[np.isfinite(centre)]), largest(apart[0]), largest(apart[1])))
    return out


def largest(values: np.ndarray) -> float:
    """NaN if there is none, or one is NaN."""
    return float(values.max()) if values.size else math.nan


def words(material: Material) -> Mapping[str, Any]:
    truth, curves = exact()
    position, table = round_trip(curves), round_trip(from_poses(truth.t, truth.pose[:, COUPLER]))
    rows = measured(material)
    body = [
        [f"{cell.engine.name} {cell.engine.variant}", *map(number, (cell.step, centre, angle, rate))]
        for cell, centre, angle, rate in rows
    ]
    header = ["method", "step [s]", "centre off by [m]", "angle [rad]", "rate [rad/s]"]
    return {
        "arc": ARC,
        "samples": SAMPLES,
        "agreement": agreement(curves),
        "returned": {"position": position, "table": table},
        "table": markdown(header, body) if rows else "Nothing ran.",
        "lesson": _lesson(rows),
    }


def _lesson(rows: list[tuple[Cell, float, float, float]]) -> str:
    """The method whose angle flatters it most: that with the largest ratio of centre error to angle error."""
    known = [
        (centre / angle, cell, centre, angle) for cell, centre, angle, _ in rows if angle > 0 and math.isfinite(centre)
    ]
    if not known:
        return ""
    _, cell, centre, angle = max(known, key=lambda each: each[0])
    return (
        f"An angle can be right while the velocities are not. {cell.engine.name} {cell.engine.variant} at a step of "
        f"{number(cell.step)} s has the angle to {number(angle)} rad and the centre to {number(centre)} m."
    )


PAGE = Page(
    name="centrodes",
    title="Centrodes: any motion as rolling",
    lesson="Every plane motion is one curve rolling on another, and the instant centre shows errors of velocity.",
    scenes=(),
    engines=(),
    companions=(DrivenFourBar(),),
    figures=figures,
    words=words,
    tasks=tuple(map(Motion, CELLS)),
)
