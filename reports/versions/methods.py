"""The methods that random trees are run in: an engine's variants, and settings that no scene of ours needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from engines import Engine


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
