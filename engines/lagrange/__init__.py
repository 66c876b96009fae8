"""Exact multipliers on the mechanism's own rows: the ideal constraint under ordinary numerics.

Differentiating J v = rate gives J a = -(dJ/dt) v, and Newton's law M a = f + J^T reaction then fixes the reactions: an
index-1 system that any integrator can take. It knows no scene, so it checks the scenes themselves; and on the charts it
shows what integration alone does to an ideal constraint, without stabilisation, with Baumgarte's (1972), and with
projection onto the joints after every step.

Stepping is in machine code where the extra `fast` (numba) is installed, and in numpy where it is not; both give the
same numbers up to rounding, and tests hold the one against the other.
"""

from engines.lagrange.engine import METHODS, VARIANTS, Integrator, Lagrange, Stabilisation
from engines.lagrange.judge import HELD, TRUTH, Judge

__all__ = ["HELD", "METHODS", "TRUTH", "VARIANTS", "Integrator", "Judge", "Lagrange", "Stabilisation"]
