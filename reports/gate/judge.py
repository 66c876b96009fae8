"""The judge of the gate: a mechanism with ideal or regularised joints, integrated by textbook methods.

The judge uses the compiled rows and steps of `engines.lagrange`. Without numba the judge uses numpy and is a hundred
times slower. `tests/engines/test_judge.py` compares the judge with the exact motions of scenes and with the sag of a
spring. `tests/engines/test_judge_witness.py` compares the judge with an independent implementation in random
mechanisms.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from engines import Regularisation
from engines.lagrange.compiled_model import CompiledModel
from engines.lagrange.dynamics import (
    LEAST_INVERSE_INERTIA,
    PROJECTION_ITERATIONS,
    Dynamics,
    runge_kutta,
    semi_implicit_euler,
)
from engines.lagrange.loading import installed
from engines.lagrange.methods import RK4, Tableau
from reference.checks import freeze
from reference.mechanism import Mechanism
from reference.reactions import RANK_TOLERANCE
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.errors import constraint_errors, motion_errors
from reports.model.quantities import QUANTITIES

Array = NDArray[np.float64]
QUANTITY_NAMES = tuple(quantity.name for quantity in QUANTITIES)

PARTS = 10  # Number of intervals of `refined` between two samples.
# Largest change by a third of the step in `refined`. With 1e-7 instead, errors change by less than 10 %.
SAME = 1e-6
MOST_TRIED = 200_000  # Largest number of steps in `refined`, which take half a minute for 60 rows.

TABLEAUS: dict[int, Tableau] = {
    1: Tableau(np.zeros((1, 1)), np.array([1.0]), np.zeros(1)),
    2: Tableau(np.array([[0, 0], [0.5, 0]]), np.array([0.0, 1.0]), np.array([0, 0.5])),
    4: RK4,
}


def giving_way(mechanism: Mechanism, soft: Regularisation) -> NDArray[np.bool_]:
    """The mask (rows,) of the regularised rows. A drive is regularised only if its row has a compliance. A drive
    without a compliance prescribes only the rate, and no spring acts on the angle."""
    return np.array(soft.rows) & ((mechanism.rate == 0) | (soft.compliance > 0))


def dynamics_of(
    mechanism: Mechanism, soft: Regularisation | None = None, least: float = LEAST_INVERSE_INERTIA
) -> Dynamics:
    """The dynamics of a mechanism with ideal or regularised joints. Reactions are the minimum-norm solution."""
    gives = None if soft is None else giving_way(mechanism, soft)
    return Dynamics(mechanism, soft, gives, least, RANK_TOLERANCE)


def integrate(
    scene: Scene, order: int, every: int, soft: Regularisation | None = None, project: bool = False
) -> Trajectory:
    """The motion of a scene, computed by a Runge-Kutta method of this order with `every` steps per sample."""
    return stepped(scene.mechanism(), _samples(scene), scene.spacing, order, every, soft, project)


def stepped(
    mechanism: Mechanism,
    samples: int,
    spacing: float,
    order: int,
    every: int,
    soft: Regularisation | None = None,
    project: bool = False,
) -> Trajectory:
    """The motion of a mechanism, computed by compiled steps if possible, else by `in_numpy`. Compiled steps need numba,
    independent ideal rows and a motion without divergence. Regularised rows may be dependent, since their compliances
    make the system regular, but compiled steps do not project regularised joints."""
    machine = _machine(mechanism, soft)
    if machine is not None and not (project if soft is not None else machine.has_dependent_rows):
        poses, twists = machine.empty_samples(samples)
        iterations = PROJECTION_ITERATIONS if project else 0
        if machine.fixed_steps(TABLEAUS[order], iterations, spacing / every, every, 0, poses, twists) == samples:
            reactions, _ = machine.reactions(spacing, poses, twists)
            if np.all(np.isfinite(reactions)) and machine.smallest_pivot >= RANK_TOLERANCE:
                t = np.arange(samples + 1, dtype=np.float64) * spacing
                return Trajectory(t, poses, twists, reactions)
    return in_numpy(mechanism, samples, spacing, order, every, soft, project)


def _samples(scene: Scene) -> int:
    return max(1, math.floor(min(scene.duration, scene.comparable_until) / scene.spacing * (1 + 1e-12)))


def _machine(mechanism: Mechanism, soft: Regularisation | None) -> CompiledModel | None:
    machine = CompiledModel.of(mechanism) if installed() else None
    if machine is not None and soft is not None:
        machine.regularise(soft, giving_way(mechanism, soft))
    return machine


def refined(mechanism: Mechanism, samples: int, spacing: float, soft: Regularisation) -> Trajectory | None:
    """A regularised motion at samples `spacing` [s] apart, computed by the method of order 4 with step control. The
    time between two samples is divided into PARTS intervals. An interval is repeated with a third of the step until the
    result changes by less than SAME, relative to the mechanism's length and speed. So the integration passes singular
    positions, where spring forces are large. Returns None without numba, and after MOST_TRIED steps."""
    machine = _machine(mechanism, soft)
    if machine is None:
        return None
    poses, twists = machine.empty_samples(samples * PARTS)
    length = spacing / PARTS
    taken, steps = 0, 1

    def stepped(part: int, count: int) -> tuple[Array, Array] | None:
        own = poses[: part + 2], twists[: part + 2]
        done = machine.fixed_steps(RK4, 0, length / count, count, part, *own)
        return (own[0][-1].copy(), own[1][-1].copy()) if done > part else None

    for part in range(samples * PARTS):
        coarse = stepped(part, steps)
        while True:
            taken += 4 * steps
            if taken > MOST_TRIED:
                return None
            fine = stepped(part, 3 * steps)
            if coarse is not None and fine is not None:
                away = np.abs(np.subtract(fine, coarse)) / mechanism.pose_unit
                if max(away[0].max(), away[1].max() * mechanism.time_scale) < SAME:
                    break
            coarse, steps = fine, 3 * steps
        steps = max(1, steps // 3)
    reactions, _ = machine.reactions(length, poses, twists)
    t = np.arange(samples + 1, dtype=np.float64) * spacing
    return Trajectory(t, poses[::PARTS], twists[::PARTS], reactions[::PARTS])


def in_numpy(
    mechanism: Mechanism,
    samples: int,
    spacing: float,
    order: int,
    every: int,
    soft: Regularisation | None = None,
    project: bool = False,
    least: float = LEAST_INVERSE_INERTIA,
) -> Trajectory:
    """The motion of a mechanism at samples `spacing` [s] apart, computed in numpy. The method of order 1 is
    semi-implicit Euler, which moves poses by the new velocities. This method is not compiled."""
    dt, dynamics = spacing / every, dynamics_of(mechanism, soft, least)
    step = semi_implicit_euler(dynamics) if order == 1 else runge_kutta(dynamics, TABLEAUS[order])
    poses = np.full((samples + 1, *mechanism.pose.shape), np.nan)
    twists, reactions = np.full_like(poses, np.nan), np.full((samples + 1, mechanism.row_count), np.nan)
    pose, twist = mechanism.pose, mechanism.twist
    for number in range(samples * every + 1):
        if not (np.isfinite(pose).all() and np.isfinite(twist).all()):
            break
        if number % every == 0:
            poses[number // every], twists[number // every] = pose, twist
            if mechanism.row_count:
                reactions[number // every] = dynamics.reaction(pose, twist, number * dt)[1]
        pose, twist = step(pose, twist, number * dt, dt)
        if project:
            pose, twist = dynamics.project(pose, twist, (number + 1) * dt)
    return Trajectory(np.arange(samples + 1, dtype=np.float64) * spacing, poses, twists, reactions)


@lru_cache(maxsize=1)
def _truth(scene: Scene, instants: bytes) -> Trajectory:
    """The cached motion of a scene at instants [s] given as bytes. A prediction needs the same motion a dozen times."""
    return freeze(scene.motion(np.frombuffer(instants)))


def errors(
    scene: Scene, order: int, every: int, soft: Regularisation | None = None, project: bool = False
) -> Mapping[str, float]:
    """Quantity -> largest error of the judge's run. Errors are infinite if the run failed."""
    return _largest_errors(scene, lambda: integrate(scene, order, every, soft, project))


def errors_as_soft(scene: Scene, soft: Regularisation) -> Mapping[str, float]:
    """Quantity -> largest error of `refined` with this regularisation, or infinity if `refined` returns None."""
    return _largest_errors(scene, lambda: refined(scene.mechanism(), _samples(scene), scene.spacing, soft))


def _largest_errors(scene: Scene, run: Callable[[], Trajectory | None]) -> Mapping[str, float]:
    mechanism = scene.mechanism()
    try:
        with np.errstate(all="ignore"):
            found = run()
            if found is None or not np.isfinite(found.pose).all():
                return dict.fromkeys(QUANTITY_NAMES, math.inf)
            truth = _truth(scene, found.t.tobytes())
            largest_errors = constraint_errors(mechanism, found) | motion_errors(scene, mechanism, truth, found)
    except (ValueError, np.linalg.LinAlgError):
        return dict.fromkeys(QUANTITY_NAMES, math.inf)
    return {name: largest_errors[name] for name in QUANTITY_NAMES}
