"""Random trees of pins that branch and close across: the error of an engine's accelerations at one instant.

No integration has a part in it, so that a fault of a release stands alone; and nobody chose these mechanisms.
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

STEP = 1e-5  # of the mechanism's time scale: the relative error of a difference over it is about as large
STEPS = 2  # the first step of engines that solve for velocities has no velocity term of the joints yet
SEED = 12


def engines_for_trees(engine: str, variants: Sequence[Engine]) -> tuple[Engine, ...]:
    """MuJoCo's, and one with the sparse factorisation that it takes by itself from 60 degrees of freedom on.

    Not as shipped, which is so soft that every tree is wrong. None of pymunk, none of whose versions does the sweeps
    that so many loops need.
    """
    if engine != "mujoco":
        return ()
    from engines.mujoco.methods import EXTENDED

    # More than five of Newton's iterations bring nothing, and no tolerance would stop them.
    newton = replace(EXTENDED, solvers=("Newton",), iterations=5, tolerance=1e-20)
    return (*variants[1:], replace(newton, variant="extended, sparse", jacobian="sparse"))


@dataclass(frozen=True)
class Trees(Task):
    """`miss` of the first random trees of so many bodies and loops in an engine.

    They are small enough to be analysed by hand; one in ten shows the fault that MuJoCo 4.0.0 has with sparse
    Jacobians.
    """

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
    """Random trees, each body on an earlier one or on the ground, with this many pins more that close loops.

    Lengths are about a metre, masses 0.1 to 10 kg; all move and fall. Those with nearly dependent rows are drawn again.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([SEED, bodies, loops])))
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
    """The largest error of the accelerations over the second step, relative to the largest ideal one.

    Angular ones count by the mechanism's length. NaN where the engine gives no finite motion.
    """
    dt = STEP * mechanism.time_scale
    motion = engine.build(mechanism, dt)(STEPS, 1)
    ideal, _ = constrained_acceleration(mechanism, motion.pose[-1], motion.twist[-1])
    acceleration = (motion.twist[-1] - motion.twist[-2]) / dt
    scale = mechanism.length_scale / mechanism.pose_unit
    if not np.all(np.isfinite(acceleration)) or not np.all(np.isfinite(ideal)):
        return float("nan")
    return float(np.abs((acceleration - ideal) * scale).max() / np.abs(ideal * scale).max())
