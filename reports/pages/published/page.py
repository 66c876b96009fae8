"""The page of published problems, which are Andrews' mechanism and three benchmarks.

The published numbers of Andrews' mechanism are copied from the Test set for initial value problem solvers by Mazzia and
Magherini, release 2.4, II-17.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Engine
from engines.registry import VARIANTS, method_name
from reference.scene import Scene
from reference.scenes.andrews import Andrews
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reports.model.cells import FULL, sweep_cells
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Answer
from reports.pages.common import scene_page
from reports.pages.pendulum.page import PHASE
from reports.pages.published.experiments import (
    ACROBOT_START,
    ACROBOT_STEPS,
    NEWTON_BOUNDS,
    NEWTON_STEPS,
    PUBLISHED,
    Acrobot,
    DirectRK4,
    NewtonBounds,
)
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import Rows
from reports.write.tables import milliseconds

# The coordinates of the test set are angles of bodies and differences of angles.
ANGLE_NAMES = ("K1", "K2 - K1", "K3", "K4 - K5", "K5", "K6 - K7", "K7")
END_TIME = 0.03  # s
END_ANGLES = (15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948)
END_ANGLES += (0.5244099658805304, 0.5347301163226948, 1.048080741042263)  # rad.
START_ACCELERATIONS = (14222.4439199541138705911625887, -10666.8329399655854029433719415)  # rad/s^2.
START_MULTIPLIERS = (98.5668703962410896057654982170, -6.12268834425566265503114393122)  # N.


def relative(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The test set's coordinates (..., 7) from the angles of the bodies (..., 7). Derivatives of the angles give
    derivatives of the coordinates."""
    k1, k2, k3, k4, k5, k6, k7 = np.moveaxis(angles, -1, 0)
    return np.stack([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7], axis=-1)


def compared(scene: Andrews) -> list[dict[str, Any]]:
    """Computed and published numbers: angles at END_TIME, and accelerations and multipliers at t = 0 that are not zero.
    A multiplier of the test set is minus our reaction. The test set has the equation M q'' = f - G^T lambda, and our
    mechanism M a = f + J^T reaction. The rows of the joint P have the same sign in both equations."""
    motion, mechanism = scene.motion([0.0, END_TIME]), scene.mechanism()
    free = mechanism.unconstrained(motion.pose[0], motion.twist[0])
    pushed = mechanism.rows(motion.pose[0]).T @ motion.reaction[0]
    accelerations = relative((free + pushed.reshape(free.shape) / mechanism.inertias)[:, 2])
    names = mechanism.row_names
    multipliers = [-motion.reaction[0, names.index(f"P3 {axis}")] for axis in "xy"]
    blocks = (
        (f"angle of {{}} at {END_TIME:g} s [rad]", ANGLE_NAMES, END_ANGLES, relative(motion.pose[1, :, 2])),
        ("acceleration of {} at 0 [rad/s²]", ANGLE_NAMES[:2], START_ACCELERATIONS, accelerations[:2]),
        ("multiplier of P, {}, at 0 [N]", "xy", START_MULTIPLIERS, multipliers),
    )
    return [
        {
            "what": label.format(name),
            "published": published,
            "found": float(ours),
            "difference": float(ours) - published,
        }
        for label, *columns in blocks
        for name, published, ours in zip(*columns, strict=True)
    ]


ANDREWS = Andrews()
# Low and high precision from A01_specification.xml and A02_specification.xml of the IFToMM library. The library bounds
# relative errors of a point's coordinates; this page bounds the largest angle error [rad].
IFTOMM_PRECISIONS = (1e-1, 1e-3)
IFTOMM_CELLS = (*PHASE, *sweep_cells((NFourBar(),), VARIANTS, FULL))
DIRECT_RK4 = DirectRK4()
ACROBOTS = tuple(Acrobot(engine) for engine in VARIANTS)
NEWTONS = tuple(NewtonBounds(engine) for engine in VARIANTS)


def costs(rows: Rows, scene: Scene, engine: Engine) -> list[str]:
    """The least CPU time [ms] of a whole motion for each precision in IFTOMM_PRECISIONS."""
    of_method = rows.of(scene.name, method_name(engine), "")
    if not of_method:
        return ["not run"] * len(IFTOMM_PRECISIONS)
    timed = [row for row in of_method.known("cpu") if not Outcome(row.outcome).wrong]
    least = [min((row.cpu for row in timed if row.angle < tolerance), default=nan) for tolerance in IFTOMM_PRECISIONS]
    return [milliseconds(cpu * scene.duration, unknown="\N{EN DASH}") for cpu in least]


def largest_step(answer: Answer, name: str) -> float | None:
    """The largest step [s] in NEWTON_STEPS that meets a bound together with all smaller steps, or None."""
    largest = None
    for step, measure in sorted(zip(NEWTON_STEPS, answer.array(name), strict=True)):
        if not measure < NEWTON_BOUNDS[name]:
            break
        largest = step
    return largest


def bounds(material: Material) -> list[dict[str, Any]]:
    return [
        {"method": method_name(task.method), "steps": {name: largest_step(answer, name) for name in NEWTON_BOUNDS}}
        for task in NEWTONS
        if (answer := material.finished(task)) is not None
    ]


def drifts(material: Material) -> list[dict[str, Any]]:
    """The drifts of Acrobot's energy at ACROBOT_STEPS by RK4, by RK4 with states in 32 bits, and by each engine."""
    named = [("RK4 in the two angles", DIRECT_RK4, "drift"), ("the same states in 32 bits", DIRECT_RK4, "rounded")]
    named += [(method_name(engine), Acrobot(engine), "drift") for engine in VARIANTS]
    return [
        {"method": title, "drift": answer.array(name)}
        for title, task, name in named
        if (answer := material.finished(task)) is not None
    ]


def figures(material: Material) -> dict[str, str]:
    strips = Strip(ANDREWS, "From rest", 7, end=0.012), Strip(ANDREWS, "Fast", 7, start=0.04, end=0.046)
    return {"stroboscope": svg(stroboscope(strips), "Andrews' squeezing mechanism in motion")}


def context(material: Material) -> Mapping[str, Any]:
    rows = Rows([*material.sweep((ANDREWS,)), *material.of(IFTOMM_CELLS)])
    problems = (PointPendulum(), NFourBar(), ANDREWS)
    by_method = [
        {"method": method_name(engine), "costs": [cost for scene in problems for cost in costs(rows, scene, engine)]}
        for engine in VARIANTS
    ]
    return {
        "compared": compared(ANDREWS),
        "by_method": by_method,
        "tolerances": IFTOMM_PRECISIONS,
        "bounds": bounds(material),
        "limits": NEWTON_BOUNDS,
        "drifts": drifts(material),
        "by_hand": material.finished(DIRECT_RK4) is not None,
        "published_drift": PUBLISHED,
        "acrobot": {"start": ACROBOT_START, "steps": ACROBOT_STEPS},
        "time": ANDREWS.mechanism().time_scale,
    }


PAGE = scene_page(
    "published",
    title="Problems that others published",
    lesson="Andrews' squeezing mechanism against published digits, and the cost of three benchmarks.",
    scenes=(ANDREWS,),
    engines=VARIANTS,
    borrowed=IFTOMM_CELLS,
    figures=figures,
    context=context,
    tasks=(DIRECT_RK4, *ACROBOTS, *NEWTONS),
)
