"""The page of problems that others published: Andrews' mechanism, and what three benchmarks cost to a tolerance.

Published numbers are copied digit by digit. Those of Andrews' mechanism: F. Mazzia, C. Magherini, Test set for initial
value problem solvers, release 2.4, II-17.
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
from reports.model.page import Material, Page
from reports.model.tasks import Answer
from reports.pages.common import deviations
from reports.pages.pendulum.page import PHASE
from reports.pages.published.experiments import (
    ACROBOT_STEPS,
    BOUNDS,
    NEWTON_STEPS,
    PUBLISHED,
    START,
    Acrobot,
    ByHand,
    Newton,
)
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import Rows, lookups
from reports.write.tables import milliseconds

# Angles of one body against another, as the test set has them, by the names of the bodies.
ANGLES = ("K1", "K2 - K1", "K3", "K4 - K5", "K5", "K6 - K7", "K7")
INSTANT = 0.03  # s
END = (15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948)
END += (0.5244099658805304, 0.5347301163226948, 1.048080741042263)  # rad, at that instant
ACCELERATIONS = (14222.4439199541138705911625887, -10666.8329399655854029433719415)  # rad/s^2, at the start
MULTIPLIERS = (98.5668703962410896057654982170, -6.12268834425566265503114393122)  # N, at the start


def relative(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The test set's coordinates (..., 7) of the bodies' angles (..., 7) [rad], or of their derivatives."""
    k1, k2, k3, k4, k5, k6, k7 = np.moveaxis(angles, -1, 0)
    return np.stack([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7], axis=-1)


def compared(scene: Andrews) -> list[dict[str, Any]]:
    """The end, and the accelerations and multipliers at the start that are not zero, beside the published numbers.

    The test set has M q'' = f - G^T lambda, with rows that are the rod's end less that of body 3. Ours have the rod
    second too, and M a = f + J^T reaction: so a multiplier is minus the force on the rod.
    """
    motion, mechanism = scene.motion([0.0, INSTANT]), scene.mechanism()
    free = mechanism.unconstrained(motion.pose[0], motion.twist[0])
    pushed = mechanism.rows(motion.pose[0]).T @ motion.reaction[0]
    first = relative((free + pushed.reshape(free.shape) / mechanism.inertias)[:, 2])
    names = mechanism.row_names
    multipliers = [-motion.reaction[0, names.index(f"P3 {axis}")] for axis in "xy"]
    blocks = (
        (f"angle of {{}} at {INSTANT:g} s [rad]", ANGLES, END, relative(motion.pose[1, :, 2])),
        ("acceleration of {} at 0 [rad/s²]", ANGLES[:2], ACCELERATIONS, first[:2]),
        ("multiplier of P, {}, at 0 [N]", "xy", MULTIPLIERS, multipliers),
    )
    return [
        {"what": what.format(name), "published": theirs, "found": float(ours), "difference": float(ours) - theirs}
        for what, *columns in blocks
        for name, theirs, ours in zip(*columns, strict=True)
    ]


NAME = "published"
SCENES = (Andrews(),)
# The low and the high precision of the library's problems A01 and A02, by their specifications (A01_specification.xml,
# A02_specification.xml). Theirs are errors of a point's coordinates beside their size; here they are taken in rad, of
# the largest angle error over the whole problem.
TOLERANCES = (1e-1, 1e-3)
BORROWED = (*PHASE, *sweep_cells((NFourBar(),), VARIANTS, FULL))
BY_HAND = ByHand()
ACROBOTS = tuple(Acrobot(engine) for engine in VARIANTS)
NEWTONS = tuple(Newton(engine) for engine in VARIANTS)


def costs(rows: Rows, scene: Scene, engine: Engine) -> list[str]:
    """CPU time of the whole problem [ms] by an engine's cheapest row in a scene, for each tolerance [rad], in words."""
    of_method = rows.of(scene.name, method_name(engine), "")
    if not of_method:
        return ["not run"] * len(TOLERANCES)
    timed = [row for row in of_method.known("cpu") if not Outcome(row.outcome).wrong]
    least = [min((row.cpu for row in timed if row.angle < tolerance), default=nan) for tolerance in TOLERANCES]
    return [milliseconds(cpu * scene.duration, unknown="\N{EN DASH}") for cpu in least]


def largest_step(answer: Answer, name: str) -> float | None:
    """The largest of Newton's steps [s] at which a bound is met, and at all smaller ones too; None for none."""
    passed = None
    for step, measure in sorted(zip(NEWTON_STEPS, answer.array(name), strict=True)):
        if not measure < BOUNDS[name]:
            break
        passed = step
    return passed


def bounds(material: Material) -> list[dict[str, Any]]:
    """Of every method that was run, the largest step within each of Newton's bounds."""
    return [
        {"method": method_name(task.method), "steps": {name: largest_step(answer, name) for name in BOUNDS}}
        for task in NEWTONS
        if (answer := material.finished(task)) is not None
    ]


def drifts(material: Material) -> list[dict[str, Any]]:
    """Acrobot's loss of energy at its three steps: of RK4 by hand, of the same seen in 32 bits, of every method."""
    named = [("RK4 in the two angles", BY_HAND, "drift"), ("the same, seen in 32 bits", BY_HAND, "rounded")]
    named += [(method_name(engine), Acrobot(engine), "drift") for engine in VARIANTS]
    return [
        {"method": words, "drift": answer.array(name)}
        for words, task, name in named
        if (answer := material.finished(task)) is not None
    ]


def figures(material: Material) -> dict[str, str]:
    """Stroboscopic pictures of the truth: the crank's first half turn, and a whole turn when it is fast."""
    scene = Andrews()
    strips = Strip(scene, "From rest", 7, end=0.012), Strip(scene, "Fast", 7, start=0.04, end=0.046)
    return {"stroboscope": svg(stroboscope(strips), "Andrews' squeezing mechanism in motion")}


def context(material: Material) -> Mapping[str, Any]:
    """Published numbers beside ours; `by_method`: the costs of three benchmarks by tolerance; `bounds`."""
    rows = Rows([*material.sweep(SCENES), *material.of(BORROWED)])
    problems = (PointPendulum(), NFourBar(), SCENES[0])
    by_method = [
        {"method": method_name(engine), "costs": [words for scene in problems for words in costs(rows, scene, engine)]}
        for engine in VARIANTS
    ]
    return {
        **lookups(material, SCENES),
        "compared": compared(SCENES[0]),
        "by_method": by_method,
        "tolerances": TOLERANCES,
        "bounds": bounds(material),
        "limits": BOUNDS,
        "drifts": drifts(material),
        "by_hand": material.finished(BY_HAND) is not None,
        "published_drift": PUBLISHED,
        "acrobot": {"start": START, "steps": ACROBOT_STEPS},
        "time": SCENES[0].mechanism().time_scale,
    }


PAGE = Page(
    name=NAME,
    title="Problems that others published",
    lesson="Andrews' squeezing mechanism against digits that nobody here wrote, and what three benchmarks cost.",
    scenes=SCENES,
    engines=VARIANTS,
    borrowed=BORROWED,
    figures=figures,
    context=context,
    tasks=(BY_HAND, *ACROBOTS, *NEWTONS),
    known=deviations("published"),
)
