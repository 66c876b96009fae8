"""The error of an engine's accelerations in random trees of bodies with pin joints and closed loops.

Accelerations have no error of time integration, so they show faults of a release.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from engines import Engine
from engines.lagrange.dynamics import constrained_acceleration
from reference.checks import Count, InvalidMechanism
from reference.mechanism import Mechanism
from reports.model.tasks import Task, Values
from reports.search.parts import Recipe, RecipeBody, RecipeLink
from reports.search.recipe import build

TREE_STEP = 1e-5  # Step relative to the mechanism's time scale. The relative error of finite differences is similar.
TREE_STEPS = 2  # Two steps, since the first step of a velocity-level solver lacks the velocity term of the joints.
TREE_SEED = 12


def engines_for_trees(engine: str, variants: Sequence[Engine]) -> tuple[Engine, ...]:
    """MuJoCo's variants, and a variant with the sparse factorisation, which MuJoCo uses from 60 degrees of freedom on.
    The default variant is left out, since every tree would be wrong with its soft joints. The result is empty for
    pymunk, which would need too many iterations for these loops."""
    if engine != "mujoco":
        return ()
    from engines.mujoco.methods import EXTENDED

    # Five iterations of Newton's method suffice. The tolerance is so small that all five are made.
    newton = replace(EXTENDED, solvers=("Newton",), iterations=5, tolerance=1e-20)
    return (*variants[1:], replace(newton, variant="extended, sparse", jacobian="sparse"))


@dataclass(frozen=True)
class Trees(Task):
    """The task that computes `miss` for `count` random trees in an engine. Trees of 12 bodies can be analysed by hand.
    One tree in ten shows the fault of MuJoCo 4.0.0 with sparse Jacobians."""

    method: Engine
    bodies: Count = 12
    loops: Count = 4
    count: Count = 40

    words: ClassVar[str] = "{0.count} trees of {0.bodies} bodies / {0.method.name} {0.method.variant}"

    @property
    def engine(self) -> Engine:
        return self.method

    def run(self) -> Values:
        return {"miss": np.array([miss(self.method, tree) for tree in trees(self.bodies, self.loops, self.count)])}


@lru_cache(maxsize=4)
def trees(bodies: int, loops: int, count: int) -> tuple[Mechanism, ...]:
    """Random trees. A pin connects each body to an earlier body or to the ground, and `loops` further pins close loops.
    Lengths are about 1 m, and masses are 0.1 to 10 kg. Trees with nearly dependent rows are not used."""
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([TREE_SEED, bodies, loops])))
    drawn: list[Mechanism] = []
    while len(drawn) < count:
        try:
            drawn.append(build(_recipe(random, bodies, loops)))
        except InvalidMechanism:
            continue
    return tuple(drawn)


def _recipe(random: np.random.Generator, bodies: int, loops: int) -> Recipe:
    def whole(most: int, count: int) -> tuple[int, ...]:
        return tuple(int(number) for number in random.integers(-most, most + 1, count))

    parts: list[RecipeBody] = []
    links: list[RecipeLink] = []
    for index in range(1, bodies + 1):
        parent = int(random.integers(min(1, index - 1), index))
        x, y, angle, mass = (*whole(8, 2), *whole(10, 1), *whole(3, 1))
        parts.append(RecipeBody(parent, (x, y), angle, mass=mass, gyration=-1, velocity=(*whole(4, 2), *whole(6, 1))))  # type: ignore[arg-type]
        links.append(RecipeLink("pin", parent, index, whole(6, 2)))  # type: ignore[arg-type]
    for _ in range(loops):
        first, second = sorted(int(body) for body in random.choice(np.arange(1, bodies + 1), 2, replace=False))
        links.append(RecipeLink("pin", first, second, whole(6, 2)))  # type: ignore[arg-type]
    return Recipe(tuple(parts), tuple(links), (0, -10))


def miss(engine: Engine, mechanism: Mechanism) -> float:
    """The largest error of the mean accelerations in the last step, relative to the largest ideal acceleration. Angular
    accelerations are multiplied by the length of the mechanism. The result is NaN if a value is not finite."""
    dt = TREE_STEP * mechanism.time_scale
    motion = engine.build(mechanism, dt)(TREE_STEPS, 1)
    ideal, _ = constrained_acceleration(mechanism, motion.pose[-1], motion.twist[-1])
    acceleration = (motion.twist[-1] - motion.twist[-2]) / dt
    scale = mechanism.length_scale / mechanism.pose_unit
    if not np.all(np.isfinite(acceleration)) or not np.all(np.isfinite(ideal)):
        return float("nan")
    return float(np.abs((acceleration - ideal) * scale).max() / np.abs(ideal * scale).max())
