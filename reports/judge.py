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
from scipy.linalg import get_lapack_funcs

from engines import Softness
from reference.mechanism import RANK_TOLERANCE, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.errors import constraint_errors, largest, motion_errors
from reports.measure import SATURATED
from reports.promises import EXACT
from reports.quantities import QUANTITIES

Array = NDArray[np.float64]
QUANTITY_NAMES = tuple(quantity.name for quantity in QUANTITIES)


(_positive,) = get_lapack_funcs(("posv",), dtype=np.float64)

REDUNDANT = 0.1

# Joints are compared at these, MuJoCo's as shipped but for a smaller compliance, and results scaled: what gives way is
# proportional to the compliance and to the inverse stiffness, or to the time 1 / damping by which slip lags.
STIFFNESS, DAMPING, COMPLIANCE = 1 / 0.02**2, 2 / 0.02, 0.01

TABLEAUS: dict[int, tuple[Array, Array]] = {
    2: (np.array([[0, 0], [0.5, 0]]), np.array([0.0, 1.0])),
    4: (np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]]), np.array([1, 2, 2, 1]) / 6),
}
NODES = {2: np.array([0, 0.5]), 4: np.array([0, 0.5, 0.5, 1])}


def solved(matrix: Array, right: Array) -> Array:
    """The solution of a symmetric system, the smallest one where rows depend on each other."""
    factor, solution, failed = _positive(matrix, right, lower=True)
    # Cholesky's pivots show dependence: their ratio squared is at least the matrix' condition.
    pivots = np.diag(factor)
    if not failed and pivots.min() ** 2 > RANK_TOLERANCE * pivots.max() ** 2:
        return solution
    if not np.all(np.isfinite(matrix)):
        return np.full_like(right, np.nan)
    return np.linalg.pinv(matrix, rcond=RANK_TOLERANCE, hermitian=True) @ right


def own_inertia(matrix: Array, gives: NDArray[np.bool_]) -> Array:
    """What each soft row feels while the rigid ones hold: the diagonal of the Schur complement (rows,)."""
    out = np.diag(matrix).copy()
    if not gives.all():
        rigid, soft = np.flatnonzero(~gives), np.flatnonzero(gives)
        coupled = matrix[np.ix_(rigid, soft)]
        answer = np.linalg.lstsq(matrix[np.ix_(rigid, rigid)], coupled, rcond=RANK_TOLERANCE)[0]
        out[soft] -= np.einsum("ij,ij->j", coupled, answer)
    # Of a row that others hold already nothing would be left; engines take an estimate that knows no others.
    return np.maximum(out, REDUNDANT * np.diag(matrix))


def multipliers(mechanism: Mechanism, pose: Array, twist: Array, t: float, soft: Softness | None) -> tuple[Array, Array]:
    """Accelerations (bodies, 3) and reactions (rows,) of ideal joints, or of soft ones; drives are never soft."""
    if not mechanism.row_count:
        return mechanism.free_fall, np.zeros(0)
    rows = mechanism.rows(pose)
    weighted = rows / mechanism.inertias.reshape(-1)
    matrix = weighted @ rows.T
    right = mechanism.bias(pose, twist) - rows @ mechanism.free_fall.reshape(-1)
    if soft is not None:
        gives = np.array(soft.rows) & ~np.isnan(mechanism.rate) & (mechanism.rate == 0)
        if not soft.complete:
            right = np.where(gives, -rows @ mechanism.free_fall.reshape(-1), right)
        gap = np.nan_to_num(mechanism.gap(pose, t))
        right = right - gives * (soft.damping * mechanism.slip(pose, twist) + soft.stiffness * gap)
        matrix = matrix + soft.compliance * np.diag(gives * own_inertia(matrix, gives))
    reaction = solved(matrix, right)
    return mechanism.free_fall + (weighted.T @ reaction).reshape(-1, 3), reaction


def projected(mechanism: Mechanism, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
    """The pose after one Newton step onto the joints, and the twist that they allow there: nearest by mass."""
    which = mechanism.holonomic
    for quantity in ("gap", "slip"):
        rows = mechanism.rows(pose)
        kept = rows[which] if quantity == "gap" else rows
        wrong = mechanism.gap(pose, t)[which] if quantity == "gap" else mechanism.slip(pose, twist)
        if not len(kept):
            continue
        weighted = kept / mechanism.inertias.reshape(-1)
        back = (weighted.T @ solved(weighted @ kept.T, wrong)).reshape(-1, 3)
        pose, twist = (pose - back, twist) if quantity == "gap" else (pose, twist - back)
    return pose, twist


def integrate(scene: Scene, order: int, every: int, soft: Softness | None = None, project: bool = False) -> Trajectory:
    """The scene's motion by Runge and Kutta's method of this order, `every` steps a sample."""
    mechanism = scene.mechanism()
    (stages, weights), nodes = TABLEAUS[order], NODES[order]
    samples = max(1, math.floor(min(scene.duration, scene.comparable_until) / scene.spacing * (1 + 1e-12)))
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
# Samples of the truth between which its derivatives are taken.
DIFFERENCES = 1000


@dataclass(frozen=True)
class Prediction:
    """What order and softness cost in a scene: errors by quantity of ideal methods of order 2 and 4 at `step` [s], and
    the mechanism's `length` [m]; of the truth the largest `speed` [m/s] and `acceleration` [m/s^2], and by how much of
    themselves reactions are `changing`: their first two derivatives [1/s, 1/s^2] over the largest.
    """

    of: Scene
    step: float
    second: Mapping[str, float]
    fourth: Mapping[str, float]
    length: float
    speed: float
    acceleration: float
    changing: tuple[float, float]

    def error(self, quantity: str, order: float, step: float) -> float:
        """A (step / tau)^order, A and tau from the two ideal methods; infinite where those failed, NaN if unknown.

        A pose that is wrong by this much is wrong in its velocities too, by as much as the motion takes it on; and what
        is wrong in its velocities may show as a slip.
        """
        own = self._power(quantity, order, step)
        pace = self.speed / self.length
        match quantity:
            case "rate":
                return max(own, pace * self._power("angle", order, step))
            case "velocity":
                return max(own, pace * self._power("position", order, step))
            case "slip":
                return max(own, self._power("velocity", order, step))
        return own

    def _power(self, quantity: str, order: float, step: float) -> float:
        second, fourth = self.second[quantity], self.fourth[quantity]
        if order == EXACT:
            return 0.0
        if not (math.isfinite(second) and math.isfinite(fourth)):
            return math.nan if math.isnan(second) else math.inf
        if second == 0 or fourth == 0:
            return 0.0
        # At the judge's step the error falls by (step / tau)^2 from order 2 to order 4: by its root for each order.
        return second * (fourth / second) ** ((order - 2) / 2) * (step / self.step) ** order

    def give(self, quantity: str, softness: Softness | None) -> float:
        """What this softness costs, in proportion to what the judge's own does."""
        if softness is None:
            return 0.0
        stiff = STIFFNESS / softness.stiffness
        found = 0.0
        if softness.compliance > 0:
            found += softened(self.of, softness.rows, True)[quantity] * softness.compliance / COMPLIANCE * stiff
        if not softness.complete:
            lag = stiff if quantity == "gap" else max(DAMPING / softness.damping, stiff)
            found += softened(self.of, softness.rows, False)[quantity] * lag
        return found

    def closing(self, quantity: str, gap: float, softness: Softness | None) -> float:
        """What a spring costs that closes a gap [m] of the step's: it moves at gap times damping, which is a slip."""
        if softness is None or not softness.complete or math.isnan(gap):
            return 0.0
        speed = gap * softness.damping
        scales = {"slip": 1.0, "velocity": 1.0, "rate": 1 / self.length, "energy": 2 / self.speed}
        return scales.get(quantity, 0.0) * speed

    def differenced(self, order: float, step: float) -> float:
        """The relative error of a reaction that is read as a change of velocity over a step: what it changes in it."""
        return self.changing[order > 1] * step ** min(order, 2)

    def refused(self, quantity: str) -> float:
        """The error above which a run is no longer comparable, whatever the order promises."""
        scales = {"angle": 0.5, "gap": 0.05 * self.length, "position": 0.5 * self.length}
        return scales.get(quantity, math.inf)


def _worse(one: Mapping[str, float], other: Mapping[str, float]) -> Mapping[str, float]:
    """By quantity the larger of two errors that are finite, infinite without any; NaN where neither is known."""
    out = {}
    for name in QUANTITY_NAMES:
        known = [value for value in (one[name], other[name]) if not math.isnan(value)]
        out[name] = max((v for v in known if math.isfinite(v)), default=math.inf) if known else math.nan
    return out


@lru_cache(maxsize=None)
def prediction(scene: Scene) -> Prediction:
    """The scene's prediction, worked out once a process (seconds for a hundred bodies).

    Joints are left alone and projected: where the motion is prescribed a projection leaves nothing of the error, and at
    singular positions rows left alone drift off. The worse of the two is taken.
    """
    second = fourth = dict.fromkeys(QUANTITY_NAMES, math.inf)
    every = REFINEMENTS[0]
    for every in REFINEMENTS:
        second, fourth = (_judged(scene, order, every) for order in (2, 4))
        if second["angle"] <= REACH:
            break
    return Prediction(scene, scene.spacing / every, second, fourth, scene.mechanism().length_scale, *_motion(scene))


def _motion(scene: Scene) -> tuple[float, float, tuple[float, float]]:
    """Speed, acceleration and the change of reactions of the truth; see Prediction."""
    mechanism = scene.mechanism()
    until = min(scene.horizon, scene.comparable_until)
    dt = until / DIFFERENCES
    truth = scene.motion(np.arange(DIFFERENCES + 1) * dt)
    length = mechanism.length_scale
    twist, reaction = truth.twist, truth.reaction
    speed = max(largest(np.hypot(twist[..., 0], twist[..., 1])), length * largest(twist[..., 2]))
    change = np.diff(twist, axis=0) / dt
    acceleration = max(largest(np.hypot(change[..., 0], change[..., 1])), math.hypot(*mechanism.gravity))
    scale = largest(reaction)
    first, second = largest(np.diff(reaction, axis=0)) / dt, largest(np.diff(reaction, 2, axis=0)) / dt**2
    changing = (first / scale, second / scale) if scale > 0 else (0.0, 0.0)
    return speed, acceleration, changing


@lru_cache(maxsize=None)
def softened(scene: Scene, rows: tuple[bool, ...], complete: bool) -> Mapping[str, float]:
    """Errors by quantity of joints that give way as the judge's own do: by compliance, or, incomplete, by their lag."""
    every = max(1, math.ceil(scene.spacing * DAMPING / 2))
    found: Mapping[str, float] = {}
    # Where this much softness loses the motion, a thousandth of it is tried, and a thousandth of that.
    for less in (1.0, 1e3, 1e6):
        soft = Softness(STIFFNESS, DAMPING, COMPLIANCE / less, rows, complete)
        found = {name: value * less for name, value in errors(scene, 4, every, soft).items()}
        if not complete or found["angle"] / less <= SATURATED:
            break
    return found


def _judged(scene: Scene, order: int, every: int) -> Mapping[str, float]:
    """The worse of both treatments of the joints, without one that lost the motion (an error above half a radian)."""
    found = [errors(scene, order, every, project=project) for project in (False, True)]
    kept = [told for told in found if told["angle"] <= SATURATED] or found
    return _worse(kept[0], kept[-1])
