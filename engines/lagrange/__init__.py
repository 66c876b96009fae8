"""Ideal constraints with exact Lagrange multipliers and explicit integrators.

The derivative of the rows J v = rate is J a = -(dJ/dt) v. This equation and Newton's law M a = f + J^T reaction
determine the reactions (an index-1 system). The engine uses only the mechanism, so its results are independent of the
scenes' closed forms. The engine shows the integration error of ideal constraints without stabilisation, with
Baumgarte's stabilisation (1972), and with a projection onto the joints after each step.

With the extra `fast`, numba compiles the steps; otherwise numpy computes them. Compiled steps and numpy give the same
results up to rounding. `run_batch` steps many mechanisms in one compiled loop.
"""

from engines.lagrange.batch import Batch, run_batch
from engines.lagrange.engine import METHODS, VARIANTS, Integrator, Lagrange, Stabilisation
from engines.lagrange.judge import JUDGE_CLAIM, TRUTH, Judge
from engines.lagrange.sweep import ParameterSweep

__all__ = [
    "JUDGE_CLAIM",
    "METHODS",
    "TRUTH",
    "VARIANTS",
    "Batch",
    "Integrator",
    "Judge",
    "Lagrange",
    "ParameterSweep",
    "Stabilisation",
    "run_batch",
]
