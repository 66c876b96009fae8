"""Functions of C as arguments of compiled code, and those that it calls."""

from __future__ import annotations

from typing import Any

from numba import types

# cpSpaceStep(space, dt), and cpSpaceEachBody(space, visitor, data); pointers are whole numbers.
STEP = types.FunctionType(types.void(types.intp, types.float64))
VISIT = types.FunctionType(types.void(types.intp, types.intp, types.intp))


class Called(types.WrapperAddressProtocol):
    """A function of C by its address; numba knows its types by the argument that it stands for."""

    def __init__(self, address: int, kind: Any) -> None:
        self._address, self._signature = address, kind.signature

    def __wrapper_address__(self) -> int:
        return self._address

    def signature(self) -> Any:
        return self._signature
