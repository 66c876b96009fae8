"""The engine MuJoCo, with planar joints as a kinematic tree and with loops as soft equality constraints."""

from __future__ import annotations

from engines.mujoco.engine import MuJoCo, bare_loop
from engines.mujoco.methods import DEFAULT, EXTENDED, METHODS, TUNED, VARIANTS
from engines.mujoco.stiffness import Hardened, Shipped, TiedToStep

__all__ = ["DEFAULT", "EXTENDED", "METHODS", "TUNED", "VARIANTS"]
__all__ += ["Hardened", "MuJoCo", "Shipped", "TiedToStep", "bare_loop"]
