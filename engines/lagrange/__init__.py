"""Ideal constraints with exact Lagrange multipliers and explicit integrators.

The derivative of the rows J v = rate is J a = -(dJ/dt) v. Together with Newton's law M a = f + J^T reaction it
determines the reactions (an index-1 system). The engine uses only the mechanism, so it checks the scenes independently.
It shows the integration error of ideal constraints without stabilisation, with Baumgarte's stabilisation (1972), and
with a projection onto the joints after each step.

Steps are compiled by numba if the extra `fast` is installed, and otherwise computed in numpy. The results are equal to
rounding.
"""

from engines.lagrange.engine import METHODS, VARIANTS, Integrator, Lagrange, Stabilisation
from engines.lagrange.judge import JUDGE_CLAIM, TRUTH, Judge

__all__ = ["JUDGE_CLAIM", "METHODS", "TRUTH", "VARIANTS", "Integrator", "Judge", "Lagrange", "Stabilisation"]
