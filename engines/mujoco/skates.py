"""The skate's constructions as methods of their own, beside the variants that every scene is run in."""

from __future__ import annotations

from dataclasses import replace

from engines.mujoco.engine import EXTENDED, TUNED
from engines.mujoco.stiffness import Hardened

# The integrator's orders differ, so each construction stands beside the integrator that suits it.
METHODS = (
    replace(TUNED, variant="friction blade", skates="blade", integrator="Euler"),
    replace(TUNED, variant="thin wheel", skates="wheel", integrator="Euler"),
    replace(TUNED, variant="velocity servo", skates="servo", integrator="implicit"),
    replace(TUNED, variant="tendon friction", skates="tendon friction"),
    replace(TUNED, variant="tendon", skates="tendon"),
    replace(TUNED, variant="tendon RK4", skates="tendon", euler_for_skates=False),
    replace(EXTENDED, variant="leapfrog", skates="leapfrog", solvers=("Newton",), tolerance=1e-20, iterations=5),
    replace(TUNED, variant="applied force", skates="force"),
    replace(EXTENDED, variant="passive force", skates="passive"),
    replace(EXTENDED, variant="rows, shipped compliance", stiffness=Hardened(softening=1.0)),
)
"""Every way that people use to put an ideal skate into MuJoCo, from the least exact to the most."""
