"""Steps of pymunk and projections between them without Python: compiled code calls the engine's own functions.

From Python a state is read and set body by body, which takes longer than the step and the projection together. In C,
`pymunk.batch` copies all of it at once, and its functions take nothing but pointers, so compiled code can call them.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib

from engines.lagrange.flat import MOBILITY, flat
from engines.lagrange.loading import compiled
from engines.lagrange.rolls import CELL
from engines.pymunk.batched import SPARE, STATES, VELOCITIES, visited_bodies
from reference.mechanism import Mechanism

Array = NDArray[np.float64]


class Marching:
    """A space whose velocities compiled code projects: see `engines.pymunk.projection.Projection`."""

    def __init__(
        self,
        mechanism: Mechanism,
        space: pymunk.Space,
        bodies: Sequence[pymunk.Body],
        origins: Array,
        closed: Array,
        root: Array,
        unit: float,
    ) -> None:
        """`closed` (rows) [1/s] as they close their gaps, `root` (columns) of the inverse inertias that take part."""
        visited = visited_bodies(space)
        arrays, calls = flat(mechanism), import_module("engines.pymunk.compiled.calls")
        mobility = int(arrays.whole[MOBILITY])
        arrays.real[mobility : mobility + len(root)] = root**2
        in_order = np.empty_like(closed)
        in_order[arrays.rows] = closed
        # Rows of zeros, between bodies that no impulse moves.
        felt = (mechanism.rows(mechanism.pose) * root != 0).any(axis=1)
        self._run = compiled(_entry)
        state, read, getter = _buffer(6 * len(visited), STATES)
        velocities, written, setter = _buffer(3 * len(visited), VELOCITIES)
        data = (
            *(space._space, ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched"), getter[0]),
            *(ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched"), setter[0]),
        )
        self._owned = (space, getter, setter)  # C holds bare pointers to these
        self._arguments = (
            *(arrays.whole, arrays.real, np.zeros((0, CELL), dtype=complex), in_order, int((~felt).sum())),
            np.array([visited.index(body.id) for body in bodies], dtype=np.int64),
            *(np.ascontiguousarray(origins, dtype=float), unit),
            calls.Called(_address(ffi.addressof(lib, "cpSpaceStep")), calls.STEP),
            calls.Called(_address(ffi.addressof(lib, "cpSpaceEachBody")), calls.VISIT),
            np.array([_address(each) for each in data], dtype=np.int64),
            *(state, velocities, read, written),
        )

    def project(self) -> bool:
        """Project the velocities that the space has now; whether they were finite."""
        return self._run(*self._arguments, 0.0, 0, 1, np.zeros(0)) == 0

    def march(self, dt: float, samples: int, every: int, values: Array) -> None:
        """Take all steps of dt [units of time], and fill the values of a `Recorder`."""
        self._run(*self._arguments, dt, samples, every, values)


def _entry() -> Any:
    return import_module("engines.pymunk.compiled.entry")


def _address(pointer: Any) -> int:
    return int(ffi.cast("intptr_t", pointer))


def _buffer(length: int, fields: Any) -> tuple[Array, NDArray[np.int32], tuple[Any, ...]]:
    """Numbers (length,) that C reads or writes one after the other; (1,) how many it has; and what it is given."""
    room = np.zeros(length + SPARE)
    floats, integers = ffi.from_buffer("double[]", room), ffi.new("pmIntArray *")
    target = ffi.new("pmFloatArray *", {"num": 0, "max": len(floats), "arr": floats})
    data = ffi.new("pmBatchedData *", {"intArray": integers, "floatArray": target, "fields": fields.value})
    place = ffi.offsetof("pmFloatArray", "num")
    count = np.frombuffer(ffi.buffer(target), dtype=np.int32, count=1, offset=place)
    return room[:length], count, (data, target, integers, floats)
