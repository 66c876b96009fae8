"""How functions are compiled that only compiled functions call.

Without the wrappers by which Python would call them, and with numpy's rule for a division by zero, which gives an
infinity or NaN and no exception: half of the time of compiling. No reordering of sums: the same numbers everywhere.
"""

from __future__ import annotations

from typing import Any

from numba import njit

OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inner = njit(**OPTIONS)
