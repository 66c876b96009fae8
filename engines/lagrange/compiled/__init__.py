"""The equations of motion and the steps as functions that numba compiles. Only `engines.lagrange.loading` calls them.

The functions change the arrays of a `records.System` and a `records.StepStorage`, and return numbers or booleans. They
receive these arrays as pointers of `run.BlockType`. A division by zero gives an infinity or NaN, as in numpy. Numba
does not reorder sums, so results are equal on all processors.

Reference counting is off (`_nrt`), since it would take longer than the computation; no function creates an array or
raises an exception. Functions have no wrappers for Python, which would double the compilation time. The decorators
affect only the speed of calls and of compilation:

- `inner`: compiled as a separate function
- `inlined`: inlined by LLVM, for short functions
- `merged`: inlined by numba before type inference, for functions with one caller, which reduces the compilation time

`unsigned(index)` avoids numba's test for a negative index, which takes a sixth of the time for a long chain.
"""

from typing import Any

from numba import njit
from numpy import uintp

_OPTIONS: dict[str, Any] = {
    "_nrt": False,
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
inner: Any = njit(**_OPTIONS)
inlined: Any = njit(forceinline=True, **_OPTIONS)
merged: Any = njit(inline="always", **_OPTIONS)
unsigned: Any = uintp
