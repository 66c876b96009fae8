"""What is under test: the one list of engines. A new engine is its own file and a line or two here."""

from __future__ import annotations

from engines import Engine, lagrange, mujoco, pymunk

# Every engine as shipped, tuned by documented settings, and extended around; and ideal constraints under ordinary
# integrators of order 1 and 4. Every scene is run in these.
VARIANTS: tuple[Engine, ...] = (
    *(pymunk.DEFAULT, pymunk.TUNED, pymunk.EXTENDED),
    *(mujoco.DEFAULT, mujoco.TUNED, mujoco.EXTENDED),
    *(lagrange.Lagrange("euler", "projection"), lagrange.Lagrange("rk4", "projection")),
)

# These and the methods between them, which show what each setting buys.
ENGINES: tuple[Engine, ...] = (*pymunk.METHODS, *mujoco.METHODS, *lagrange.METHODS)
