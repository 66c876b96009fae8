"""The judge: what a scene does to ideal and to soft joints, worked out from its mechanism and its truth alone.

It knows no engine. It integrates the mechanism with exact multipliers by two textbook methods, of order 2 and of order
4, and holds both against the truth. An error A (h / tau)^p has two unknowns, an amplitude A and a time scale tau, so
two orders give both, and with them what any order costs at any step in this scene. The same with joints that give way
as a spring of known compliance does tells what softness costs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism, solve_rows
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.errors import constraint_errors, motion_errors
from reports.quantities import QUANTITIES

Array = NDArray[np.float64]
QUANTITY_NAMES = tuple(quantity.name for quantity in QUANTITIES)


@dataclass(frozen=True)
class Softness:
    """A row that obeys J a = bias - damping slip - stiffness gap - compliance A reaction, A the row's inverse inertia.

    stiffness [1/s^2], damping [1/s], compliance: a pure number.
    """

    stiffness: float
    damping: float
    compliance: float


# Joints are compared at this softness and results scaled: what gives way is proportional to the compliance.
MEASURED = Softness(1 / 0.02**2, 2 / 0.02, 0.11)

TABLEAUS: dict[int, tuple[Array, Array]] = {
    2: (np.array([[0, 0], [0.5, 0]]), np.array([0.0, 1.0])),
    4: (np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]]), np.array([1, 2, 2, 1]) / 6),
}
NODES = {2: np.array([0, 0.5]), 4: np.array([0, 0.5, 0.5, 1])}


def multipliers(mechanism: Mechanism, pose: Array, twist: Array, t: float, soft: Softness | None) -> tuple[Array, Array]:
    """Accelerations (bodies, 3) and reactions (rows,) of ideal joints, or of soft ones; drives are never soft."""
    if not mechanism.row_count:
        return mechanism.free_fall, np.zeros(0)
    rows = mechanism.rows(pose)
    weighted = rows / mechanism.inertias.reshape(-1)
    matrix = weighted @ rows.T
    right = mechanism.bias(pose, twist) - rows @ mechanism.free_fall.reshape(-1)
    if soft is not None:
        gives = mechanism.rate == 0
        gap = np.nan_to_num(mechanism.gap(pose, t))
        right = right - gives * (soft.damping * mechanism.slip(pose, twist) + soft.stiffness * gap)
        matrix = matrix + soft.compliance * np.diag(gives * np.diag(matrix))
    reaction = solve_rows(matrix, right[:, None])[:, 0]
    return mechanism.free_fall + (weighted.T @ reaction).reshape(-1, 3), reaction


def projected(mechanism: Mechanism, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
    """The pose after one Newton step onto the joints, and the twist that they allow there: nearest by mass."""
    which = mechanism.holonomic
    for quantity in ("gap", "slip"):
        rows = mechanism.rows(pose)
        kept = rows[which] if quantity == "gap" else rows
        wrong = mechanism.gap(pose, t)[which] if quantity == "gap" else mechanism.slip(pose, twist)
        weighted = kept / mechanism.inertias.reshape(-1)
        back = (weighted.T @ solve_rows(weighted @ kept.T, wrong[:, None])).reshape(-1, 3)
        pose, twist = (pose - back, twist) if quantity == "gap" else (pose, twist - back)
    return pose, twist


def integrate(scene: Scene, order: int, every: int, soft: Softness | None = None, project: bool = False) -> Trajectory:
    """The scene's motion within its horizon by Runge and Kutta's method of this order, `every` steps a sample."""
    mechanism = scene.mechanism()
    (stages, weights), nodes = TABLEAUS[order], NODES[order]
    samples = max(1, math.floor(min(scene.horizon, scene.comparable_until) / scene.spacing * (1 + 1e-12)))
    dt = scene.spacing / every
    poses = np.full((samples + 1, *mechanism.pose.shape), np.nan)
    twists, reactions = np.full_like(poses, np.nan), np.full((samples + 1, mechanism.row_count), np.nan)
    pose, twist = mechanism.pose, mechanism.twist
    velocity = np.empty((len(weights), *pose.shape))
    acceleration = np.empty_like(velocity)
    for step in range(samples * every + 1):
        t = step * dt
        for i, node in enumerate(nodes):
            velocity[i] = twist + dt * np.tensordot(stages[i, :i], acceleration[:i], 1)
            at = pose + dt * np.tensordot(stages[i, :i], velocity[:i], 1)
            acceleration[i], reaction = multipliers(mechanism, at, velocity[i], t + node * dt, soft)
            if i == 0 and step % every == 0:
                poses[step // every], twists[step // every], reactions[step // every] = pose, twist, reaction
        pose = pose + dt * np.tensordot(weights, velocity, 1)
        twist = twist + dt * np.tensordot(weights, acceleration, 1)
        if project:
            pose, twist = projected(mechanism, pose, twist, t + dt)
    return Trajectory(np.arange(samples + 1) * scene.spacing, poses, twists, reactions)


def errors(
    scene: Scene, order: int, every: int, soft: Softness | None = None, project: bool = False
) -> Mapping[str, float]:
    """Largest errors of the judge's own run, by the name of the quantity; infinite ones where it failed."""
    mechanism = scene.mechanism()
    try:
        with np.errstate(all="ignore"):
            found = integrate(scene, order, every, soft, project)
            truth = scene.motion(found.t)
            told = constraint_errors(mechanism, found) | motion_errors(scene, mechanism, truth, found)
    except (ValueError, np.linalg.LinAlgError):
        return dict.fromkeys(QUANTITY_NAMES, math.inf)
    return {name: told[name] for name in QUANTITY_NAMES}


# The judge's own steps a sample: the coarsest at which its second-order run is within REACH [rad] of the truth.
REFINEMENTS = (1, 3)
REACH = 0.1


@dataclass(frozen=True)
class Prediction:
    """What order and softness cost in a scene: errors by quantity of ideal methods of order 2 and 4 at `step` [s], and
    of joints with the softness MEASURED; `length` [m] is the mechanism's.
    """

    scene: str
    step: float
    second: Mapping[str, float]
    fourth: Mapping[str, float]
    soft: Mapping[str, float]
    length: float

    def error(self, quantity: str, order: int, step: float) -> float:
        """A (step / tau)^order, A and tau from the two ideal methods; infinite where those failed."""
        second, fourth = self.second[quantity], self.fourth[quantity]
        if not (math.isfinite(second) and math.isfinite(fourth)):
            return math.nan if math.isnan(second) else math.inf
        if second == 0 or fourth == 0:
            return 0.0
        # At the judge's step the error falls by (step / tau)^2 from order 2 to order 4: by its root for each order.
        return second * (fourth / second) ** ((order - 2) / 2) * (step / self.step) ** order

    def give(self, quantity: str, softness: Softness | None) -> float:
        """What this softness costs, in proportion to what MEASURED does: a gap is compliance over stiffness."""
        if softness is None:
            return 0.0
        share = softness.compliance / MEASURED.compliance * MEASURED.stiffness / softness.stiffness
        return self.soft[quantity] * share

    def refused(self, quantity: str) -> float:
        """The error above which a run is no longer comparable, whatever the order promises."""
        scales = {"angle": 0.5, "gap": 0.05 * self.length, "position": 0.5 * self.length}
        return scales.get(quantity, math.inf)


@lru_cache(maxsize=None)
def prediction(scene: Scene) -> Prediction:
    """The scene's prediction, worked out once a process (seconds for a hundred bodies)."""
    second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    every = REFINEMENTS[0]
    for every in REFINEMENTS:
        for project in (False, True):
            second, fourth = (errors(scene, order, every, project=project) for order in (2, 4))
            if second["angle"] <= REACH:
                break
        else:
            continue
        break
    soft = errors(scene, 4, REFINEMENTS[0], MEASURED)
    length = scene.mechanism().length_scale
    return Prediction(scene.name, scene.spacing / every, second, fourth, soft, length)
