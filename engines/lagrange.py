"""Exact multipliers on the mechanism's own rows: the ideal constraint under ordinary numerics.

Differentiating J v = rate gives J a = -(dJ/dt) v, and Newton's law M a = f + J^T reaction then fixes the reactions: an
index-1 system that any integrator can take. It knows no scene, so it checks the scenes themselves; and on the charts it
shows what integration alone does to an ideal constraint, without stabilisation, with Baumgarte's (1972), and with
projection onto the joints after every step.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, solve_ivp
from scipy.linalg import get_lapack_funcs

from engines import EXACT, Holder, Promise, Size, Softness, Unpromised
from engines.motions import is_prescribed, over_three
from reference.joints import Joint
from reference.kinds import Rule
from reference.mechanism import Mechanism
from reference.row_system import RANK_TOLERANCE
from reference.trajectory import Trajectory
from reference.validation import Count, InvalidMechanism, Positive, Valid, validated

Array = NDArray[np.float64]
Integrator = Literal["euler", "rk4", "dop853"]
Stabilisation = Literal["none", "baumgarte", "projection"]
Tolerance = Annotated[float, Rule(lambda value: 1e-14 <= value < 1, "from 1e-14 to below 1")]

ORDERS: dict[Integrator, int] = {"euler": 1, "rk4": 4, "dop853": 8}
# Baumgarte's correction dies out over this many steps, the same rule as the tuned MuJoCo variant's time constant.
BAUMGARTE_STEPS = 5.0
PROJECTION_ITERATIONS = 8

(_solve_positive,) = get_lapack_funcs(("posv",), dtype=np.float64)

_RK4 = (
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]]),
    np.array([1, 2, 2, 1]) / 6,
    np.array([0, 0.5, 0.5, 1]),
)
_TABLEAUS: dict[str, tuple[Array, Array, Array]] = {"rk4": _RK4, "dop853": (DOP853.A, DOP853.B, DOP853.C)}


class _Dynamics:
    """Accelerations and projections of one mechanism, arranged for speed: one call is one evaluation of the rows."""

    def __init__(self, mechanism: Mechanism, baumgarte: float) -> None:
        self.mechanism = mechanism
        self.baumgarte = baumgarte  # 1/s; 0 for none
        self.weight = 1 / mechanism.inertias.reshape(-1)
        self.free_fall = mechanism.free_fall.reshape(-1)
        self.holonomic = mechanism.holonomic
        # Redundant rows (two wheels on one axle) make the row system singular; then the smallest reactions are taken.
        rows = mechanism.rows(mechanism.pose)
        self.redundant = rows.size > 0 and np.linalg.matrix_rank(rows, tol=RANK_TOLERANCE) < rows.shape[0]

    def _solve(self, rows: Array, right: Array) -> Array:
        matrix = (rows * self.weight) @ rows.T
        if not self.redundant:
            _, solution, failed = _solve_positive(matrix, right, lower=True)
            if not failed:
                return solution
        if not np.all(np.isfinite(matrix)):
            return np.full_like(right, np.nan)
        return np.linalg.pinv(matrix, rcond=RANK_TOLERANCE, hermitian=True) @ right

    def acceleration(self, pose: Array, twist: Array, t: float) -> Array:
        """Accelerations (bodies, 3) under gravity and the joints' reactions."""
        if not self.mechanism.row_count:
            return self.mechanism.free_fall
        rows, reaction = self.reaction(pose, twist, t)
        return (self.free_fall + self.weight * (rows.T @ reaction)).reshape(-1, 3)

    def reaction(self, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
        """The rows (rows, 3 bodies), and their multipliers (rows,): the joints' reactions [N, N m]."""
        mechanism = self.mechanism
        rows = mechanism.rows(pose)
        right = mechanism.bias(pose, twist) - rows @ self.free_fall
        if self.baumgarte:
            slip = rows @ twist.reshape(-1) - mechanism.rate
            gap = np.where(self.holonomic, mechanism.gap(pose, t), 0.0)
            right -= self.baumgarte * (2 * slip + self.baumgarte * gap)
        return rows, self._solve(rows, right)

    def project(self, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
        """The nearest pose (Newton) and twist, in the metric of the mass matrix, that satisfy the joints."""
        mechanism = self.mechanism
        if not mechanism.row_count:
            return pose, twist
        if np.any(self.holonomic):
            for _ in range(PROJECTION_ITERATIONS):
                gap = mechanism.gap(pose, t)[self.holonomic]
                rows = mechanism.rows(pose)[self.holonomic]
                correction = self.weight * (rows.T @ self._solve(rows, gap))
                pose = pose - correction.reshape(-1, 3)
                # Newton is quadratic: after a correction this small the next would be lost in rounding.
                if not np.max(np.abs(correction)) > 1e-9:
                    break
        rows = mechanism.rows(pose)
        slip = rows @ twist.reshape(-1) - mechanism.rate
        return pose, twist - (self.weight * (rows.T @ self._solve(rows, slip))).reshape(-1, 3)


Step = Callable[[Array, Array, float, float], tuple[Array, Array]]


def _semi_implicit_euler(dynamics: _Dynamics) -> Step:
    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        twist = twist + dt * dynamics.acceleration(pose, twist, t)
        return pose + dt * twist, twist

    return step


def _runge_kutta(dynamics: _Dynamics, tableau: tuple[Array, Array, Array]) -> Step:
    stages, weights, nodes = tableau

    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        velocity = np.empty((len(weights), *pose.shape))
        acceleration = np.empty_like(velocity)
        for i, node in enumerate(nodes):
            velocity[i] = twist + dt * np.tensordot(stages[i, :i], acceleration[:i], 1)
            stage_pose = pose + dt * np.tensordot(stages[i, :i], velocity[:i], 1)
            acceleration[i] = dynamics.acceleration(stage_pose, velocity[i], t + node * dt)
        return pose + dt * np.tensordot(weights, velocity, 1), twist + dt * np.tensordot(weights, acceleration, 1)

    return step


def _adaptive(dynamics: _Dynamics, tolerance: float) -> Step:
    """One interval between samples by DOP853 with steps of its own choice."""

    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        def rates(at: float, state: Array) -> Array:
            own_pose, own_twist = state.reshape(2, -1, 3)
            return np.concatenate([state[own_pose.size :], dynamics.acceleration(own_pose, own_twist, at).reshape(-1)])

        start = np.concatenate([pose.reshape(-1), twist.reshape(-1)])
        end: Any = solve_ivp(rates, (t, t + dt), start, "DOP853", t_eval=[t + dt], rtol=tolerance, atol=tolerance)
        state = end.y[:, -1] if end.success else np.full_like(start, np.nan)
        return state.reshape(2, -1, 3)[0], state.reshape(2, -1, 3)[1]

    return step


@dataclass(frozen=True)
class Lagrange(Valid):
    """Ideal constraints by exact multipliers; raises ValueError for settings that don't exist.

    integrator: "euler" (semi-implicit, order 1), "rk4" (order 4), "dop853" (order 8), all with the given fixed step;
    stabilisation: "none" (the joints drift apart), "baumgarte" (a spring and damper tied to the step) or "projection".
    tolerance: for "dop853" alone, relative and absolute: the steps are then adapted between samples and dt only says
    where the samples stand.
    """

    integrator: Integrator = "dop853"
    stabilisation: Stabilisation = "projection"
    tolerance: Tolerance | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tolerance is not None and (self.integrator != "dop853" or self.stabilisation == "baumgarte"):
            raise InvalidMechanism(
                "lagrange: a tolerance goes with dop853, without baumgarte: only those adapt their steps"
            )

    @property
    def name(self) -> str:
        return "lagrange"

    @property
    def packages(self) -> tuple[str, ...]:
        return ("numpy", "scipy")

    @property
    def family(self) -> str:
        return "lagrange"

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """The integrator's; a projection leaves no gap, and all of the motion is its own where nothing is free.

        Baumgarte's spring is tied to the step, and turns a gap into an acceleration divided by the step squared: that
        costs two orders, and the reactions all.
        """
        if self.tolerance is not None:
            return Unpromised("its steps are its own: the error is that of its tolerance, whatever the step asked for")
        order = ORDERS[self.integrator]
        match self.stabilisation:
            case "projection":
                return Promise(EXACT) if is_prescribed(mechanism) else Promise(order, gap=EXACT, slip=EXACT)
            case "baumgarte" if order == 1:
                prescribed = Promise(2, rate=1, slip=1, energy=1, reaction=1)
                return prescribed if is_prescribed(mechanism) else Promise(1, gap=2)
            case "baumgarte" if order == 4:
                return Promise(2, rate=1, slip=1, energy=1, reaction=0)
            case "baumgarte":
                return Promise(order - 2)
        return Promise(order)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s], from how often the rows are evaluated."""
        return {"euler": 2e-4, "rk4": 6e-4, "dop853": 1.5e-3}[self.integrator] * over_three(mechanism)

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """This engine is nothing but the ideal constraint."""
        return "engine"

    @property
    def variant(self) -> str:
        return f"{self.integrator} {self.stabilisation}" + (" adaptive" if self.tolerance is not None else "")

    def softness(self, mechanism: Mechanism, dt: float) -> Softness | None:
        """Baumgarte's springs, which close what the integrator opens; nothing else gives way here."""
        if self.stabilisation != "baumgarte":
            return None
        rate = 1 / (BAUMGARTE_STEPS * dt)
        return Softness(rate**2, 2 * rate, 0.0, (True,) * mechanism.row_count)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> _LagrangeRun:
        """A run with steps of dt [s]; raises ValueError for a step that is not a finite time above zero."""
        return _LagrangeRun(self, mechanism, dt)


class _LagrangeRun:
    def __init__(self, engine: Lagrange, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt, self._over = engine, mechanism, dt, False
        baumgarte = 1 / (BAUMGARTE_STEPS * dt) if engine.stabilisation == "baumgarte" else 0.0
        self._dynamics = _Dynamics(mechanism, baumgarte)
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, mechanism.row_count)

    def _step(self) -> Step:
        if self._engine.tolerance is not None:
            return _adaptive(self._dynamics, self._engine.tolerance)
        if self._engine.integrator == "euler":
            return _semi_implicit_euler(self._dynamics)
        return _runge_kutta(self._dynamics, _TABLEAUS[self._engine.integrator])

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        if self._over:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._over = True
        dynamics, mechanism, step = self._dynamics, self._mechanism, self._step()
        steps, dt = (1, self._dt * every) if self._engine.tolerance is not None else (every, self._dt)
        project = self._engine.stabilisation == "projection"
        poses = np.full((samples + 1, *mechanism.pose.shape), np.nan)
        twists = np.full_like(poses, np.nan)
        pose, twist = mechanism.pose, mechanism.twist
        poses[0], twists[0] = pose, twist
        started = time.process_time()
        with np.errstate(all="ignore"):  # a diverging run is a result, told by its numbers
            for sample in range(samples):
                for i in range(steps):
                    t = (sample * steps + i) * dt
                    pose, twist = step(pose, twist, t, dt)
                    if project:
                        pose, twist = dynamics.project(pose, twist, t + dt)
                if not np.all(np.isfinite(pose)):
                    break
                poses[sample + 1], twists[sample + 1] = pose, twist
            stepping = time.process_time() - started
            t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
            return Trajectory(t, poses, twists, self._reactions(t, poses, twists), stepping)

    def _reactions(self, t: Array, poses: Array, twists: Array) -> Array:
        reactions = np.full((len(t), self._mechanism.row_count), np.nan)
        alive = np.all(np.isfinite(poses) & np.isfinite(twists), axis=(1, 2))
        if self._mechanism.row_count and np.any(alive):
            states = zip(t[alive], poses[alive], twists[alive], strict=True)
            reactions[alive] = [self._dynamics.reaction(pose, twist, at)[1] for at, pose, twist in states]
        return reactions


METHODS = tuple(
    Lagrange(integrator, stabilisation)
    for integrator in get_args(Integrator)
    for stabilisation in get_args(Stabilisation)
)
VARIANTS = (Lagrange("euler", "projection"), Lagrange("rk4", "projection"))  # for every scene: orders 1 and 4
TRUTH = Lagrange("dop853", "projection", tolerance=1e-13)
"""The tightest that double precision carries: what scenes are checked against."""
