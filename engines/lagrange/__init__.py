"""Exact multipliers on the mechanism's own rows: the ideal constraint with ordinary numerical integration.

The rows J v = rate, differentiated, give J a = -(dJ/dt) v. With Newton's law M a = f + J^T reaction this determines the
reactions: an index-1 system for any integrator. It uses no scene, so it checks the scenes. In the charts it shows what
integration alone does to an ideal constraint: without stabilisation, with Baumgarte's (1972), and with a projection
onto the joints after each step.

Steps are machine code if the extra `fast` (numba) is installed, otherwise numpy. Both give the same numbers up to
rounding, which tests compare.
"""

from engines.lagrange.engine import METHODS, VARIANTS, Integrator, Lagrange, Stabilisation
from engines.lagrange.judge import JUDGE_CLAIM, TRUTH, Judge

__all__ = ["JUDGE_CLAIM", "METHODS", "TRUTH", "VARIANTS", "Integrator", "Judge", "Lagrange", "Stabilisation"]
