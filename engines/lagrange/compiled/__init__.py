"""The equations of motion and the steps as functions that numba compiles. Only `engines.lagrange.loading` imports these
functions.

The functions change the arrays of a `records.System` and a `records.StepStorage`, and return numbers or booleans. A
division by zero gives an infinity or NaN, as in numpy. Numba does not reorder sums, so results are equal on all
processors.

Reference counting is off (`_nrt`), since it would take longer than the computation; no function creates an array. Inner
functions have no wrappers for Python, which would double the compilation time. The decorators affect only the speed of
calls and of compilation:

- `inner`: compiled as a separate function
- `inlined`: inlined by LLVM, for short functions, since passing a system as an argument is slow
- `merged`: inlined by numba before type inference, for functions with one caller, which reduces the compilation time
- `entry`: called by Python, compiled at the first call, and cached with copies of all functions that it calls

`unsigned(index)` avoids numba's test for a negative index, which takes a sixth of the time for a long chain.
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
