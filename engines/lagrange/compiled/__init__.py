"""The equations of motion and the steps as functions that numba compiles; imported by `engines.lagrange.loading` only.

They change the arrays of a `records.System` and a `records.StepStorage`, and return numbers or booleans. A division by
zero gives an infinity or NaN, as in numpy. Sums are not reordered, so that results are the same on every processor.

No function counts references (`_nrt`), since counting those of the twenty arrays of a system at each call would take
longer than the work; none of them creates an array. Inner functions have no wrappers for Python, which would double
the time of compiling. The decorators differ in the speed of calls and of compiling, not in results:

- `inner`: a function of its own;
- `inlined`: LLVM puts it into its callers, since passing a system costs as much as a short function;
- `merged`: numba puts it into its caller before types are inferred: less to compile where there is one caller;
- `entry`: called by Python; compiled at its first call, and cached with copies of all functions that it calls.

`unsigned(index)` spares numba's test for a negative index, which costs a sixth of the time of a long chain.
"""

from typing import Any

from numba import njit
from numpy import uintp

_COMMON: dict[str, Any] = {"_nrt": False, "error_model": "numpy"}
_INNER: dict[str, Any] = _COMMON | {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
inner: Any = njit(**_INNER)
inlined: Any = njit(forceinline=True, **_INNER)
merged: Any = njit(inline="always", **_INNER)
entry: Any = njit(**_COMMON, nogil=True, cache=True)
unsigned: Any = uintp
