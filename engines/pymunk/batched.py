"""States of a space's bodies, copied out in C: a quarter of a microsecond, where each attribute takes more than one."""

from __future__ import annotations

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib
from pymunk.batch import BodyFields, Buffer, get_space_bodies

Array = NDArray[np.float64]

VELOCITIES = BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY
STATES = BodyFields.POSITION | BodyFields.ANGLE | VELOCITIES
# C grows an array a little before it is full, and ours are not its own to grow.
SPARE = 64


class Recorder:
    """Copies the bodies of a space, in C, to the end of an array that is allocated before.

    `lib.cpSpaceEachBody(space, visitor, states)`, or with `velocities`, copies one record.
    """

    def __init__(self, space: pymunk.Space, bodies: tuple[pymunk.Body, ...], states: int, velocities: int) -> None:
        visited = visited_bodies(space)
        self._order = [visited.index(body.id) for body in bodies]
        self._count = len(visited)
        length = (6 * states + 3 * velocities) * self._count
        room = np.full(length + SPARE, np.nan)
        self.values = room[:length]
        floats = ffi.from_buffer("double[]", room)
        integers = ffi.new("pmIntArray *")
        target = ffi.new("pmFloatArray *", {"num": 0, "max": len(floats), "arr": floats})
        self._owned = (floats, integers, target)  # C holds bare pointers to these
        self.visitor = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self.states, self.velocities = (
            ffi.new("pmBatchedData *", {"intArray": integers, "floatArray": target, "fields": fields.value})
            for fields in (STATES, VELOCITIES)
        )

    def read(self, samples: int, with_velocities: bool) -> tuple[Array, Array]:
        """States (samples + 1, bodies, 6) and the velocities one step before each (samples, bodies, 3).

        In the array stands a state, then for every sample, if `with_velocities`, velocities and a state, else a state.
        """
        first, rest = np.split(self.values, [6 * self._count])
        rest = rest.reshape(samples, -1)
        split = 3 * self._count if with_velocities else 0
        states = np.concatenate([first[None], rest[:, split:]]).reshape(samples + 1, self._count, 6)
        before = rest[:, :split].reshape(samples, self._count, 3) if with_velocities else states[:-1, :, 3:]
        return states[:, self._order], before[:, self._order]


def visited_bodies(space: pymunk.Space) -> list[int]:
    """The ids of a space's bodies in the order in which C visits them, which is not the order of adding."""
    buffer = Buffer()
    get_space_bodies(space, BodyFields.BODY_ID, buffer)
    return list(memoryview(buffer.int_buf()).cast("P"))
