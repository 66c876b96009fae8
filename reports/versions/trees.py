"""Random trees of pins that branch and close across: what an engine's accelerations miss of ideal ones, at one instant.

No integration has a part in it, so that a fault of a release stands alone; and nobody chose these mechanisms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines import Engine, method_name
from engines.lagrange.dynamics import constrained_acceleration
from reference.checks import Count, InvalidMechanism
from reference.mechanism import Mechanism
from reports.model.tasks import Task, Values
from reports.search.parts import Link, Part, Recipe
from reports.search.recipe import build

Array = NDArray[np.float64]

# Of the mechanism's time scale: what a step costs is then about this share of the accelerations.
STEP = 1e-5
# The first step of engines that solve for velocities doesn't feel yet how joints turn; the second does.
STEPS = 2
# (bodies, loops, how many): small enough to be found again by hand; of these one in ten shows the fault that
# MuJoCo 4.0.0 has with sparse Jacobians.
SIZES = ((12, 4, 40),)


def of_trees(engine: str, variants: Sequence[Engine]) -> tuple[Engine, ...]:
    """MuJoCo's, with the factorisation that it takes by itself from 60 degrees of freedom on, here on small trees.

    Not as shipped: that is so soft that every tree is wrong. None of pymunk: so many loops need more sweeps than any
    of its versions has.
    """
    if engine != "mujoco":
        return ()
    from engines.mujoco.methods import EXTENDED

    # More than five of Newton's iterations bring nothing, and no tolerance would stop them.
    newton = replace(EXTENDED, solvers=("Newton",), iterations=5, tolerance=1e-20)
    return (*variants[1:], replace(newton, variant="extended, sparse", jacobian="sparse"))


@dataclass(frozen=True)
class Trees(Task):
    """The `count` first random trees of so many bodies and loops in an engine: how wrong each is, as in `miss`."""

    method: Engine
    bodies: Count = 8
    loops: Count = 2
    count: Count = 50

    seed: ClassVar[int] = 12

    @property
    def cost(self) -> float:
        return 1e-3 * self.count * self.bodies

    @property
    def label(self) -> str:
        return f"{self.count} trees of {self.bodies} bodies / {method_name(self.method)}"

    @property
    def engine(self) -> Engine:
        return self.method

    def run(self) -> Values:
        return {"miss": np.array([miss(self.method, drawn) for drawn in trees(self.bodies, self.loops, self.count)])}


@lru_cache(maxsize=4)
def trees(bodies: int, loops: int, count: int, seed: int = Trees.seed) -> tuple[Mechanism, ...]:
    """Random trees, each body on an earlier one or on the ground, with this many pins more that close loops.

    Lengths are about a metre, masses 0.1 to 10 kg; all move and fall. Those whose rows nearly depend are drawn anew.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, bodies, loops])))
    found: list[Mechanism] = []
    while len(found) < count:
        try:
            found.append(build(_recipe(random, bodies, loops)))
        except InvalidMechanism:
            continue
    return tuple(found)


def _recipe(random: np.random.Generator, bodies: int, loops: int) -> Recipe:
    def whole(most: int, count: int) -> tuple[int, ...]:
        return tuple(int(each) for each in random.integers(-most, most + 1, count))

    parts: list[Part] = []
    links: list[Link] = []
    for index in range(1, bodies + 1):
        parent = int(random.integers(min(1, index - 1), index))
        x, y, angle, mass = (*whole(8, 2), *whole(10, 1), *whole(3, 1))
        parts.append(Part(parent, (x, y), angle, mass=mass, gyration=-1, velocity=(*whole(4, 2), *whole(6, 1))))  # type: ignore[arg-type]
        links.append(Link("pin", parent, index, whole(6, 2)))  # type: ignore[arg-type]
    for _ in range(loops):
        first, second = sorted(int(each) for each in random.choice(np.arange(1, bodies + 1), 2, replace=False))
        links.append(Link("pin", first, second, whole(6, 2)))  # type: ignore[arg-type]
    return Recipe(tuple(parts), tuple(links), (0, -10))


def miss(engine: Engine, mechanism: Mechanism) -> float:
    """The largest difference of the accelerations over the second step, relative to the largest ideal one.

    Angular ones count by the mechanism's length. NaN where the engine gives no finite motion.
    """
    dt = STEP * mechanism.time_scale
    motion = engine.build(mechanism, dt)(STEPS, 1)
    ideal, _ = constrained_acceleration(mechanism, motion.pose[-1], motion.twist[-1])
    found = (motion.twist[-1] - motion.twist[-2]) / dt
    scale = mechanism.length_scale / mechanism.pose_unit
    if not np.all(np.isfinite(found)) or not np.all(np.isfinite(ideal)):
        return float("nan")
    return float(np.abs((found - ideal) * scale).max() / np.abs(ideal * scale).max())
