"""What sweeps leave, taken out exactly: velocities projected after every step, where sweeps won't do or take longer.

A sweep leaves rho of its slowest mode, and where rows nearly depend on each other rho is so near 1 that a million of
them change nothing (`engines.pymunk.contraction`). Impulses of joints move velocities only in the directions that the
rows span, so whatever the sweeps have done, what they would end at is the nearest velocity that the rows allow, in the
metric of the masses. It is found here in one go, and closes all of a gap in a step, as joints do with an error_bias of
zero. The engine's own joints stay as they are, and their warm start is stable: it sees neither a gap nor a slip.

Compiled (`engines.pymunk.marching`) it is the same to rounding in a fiftieth of the time; numpy is its check, and does
what is rare, rolling contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib
from scipy.linalg import cho_solve

from engines.lagrange.loading import installed
from engines.pymunk.marching import Marching
from reference.joints import Drive, Roll
from reference.mechanism import Mechanism
from reference.row_system import RANK_TOLERANCE

Array = NDArray[np.float64]

COST = 1e-7  # s a row, compiled
# A row of length one leaves this of itself to the pivot, the square of what it has of its own: below, the rounding of
# the row system's product is felt in spite of corrections.
NEARLY = 1e-9
# Sweeps times joints: 6.5 us a step, three times what a projection takes. Where Python does something else before every
# step the projection is called from there too, and takes 15 us; with rolling contacts all of it is numpy's, 400 us.
DEAR, DEAR_AIMED, DEAR_ROLLING = 500, 2000, 40_000


class Projection:
    """Takes gaps and slips out of the velocities of a model's bodies, as the steps of `dt` [s] can.

    `origins` (bodies, 2) [m] are the engine's in the mechanism's body frames. Velocities that no impulse changes, of
    bodies whose motion is prescribed, are left alone.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        space: pymunk.Space,
        bodies: Sequence[pymunk.Body],
        origins: Array,
        dt: float,
        unit: float,
    ) -> None:
        """`unit` [s] is the model's second."""
        self._rows, self._rate = mechanism.joint_rows, mechanism.rate
        self._bodies = [(body._body, x, y) for body, (x, y) in zip(bodies, origins.tolist(), strict=True)]
        self._unit = unit
        # A motor knows a rate and no angle, and a skate has no gap.
        closing = [joint.holonomic and not isinstance(joint, Drive) for joint in mechanism.joints]
        sizes = [joint.size for joint in mechanism.joints]
        self._closed = np.repeat(np.where(closing, 1 / dt, 0.0), sizes)
        root = 1 / np.sqrt(mechanism.inertias)
        moved: list[tuple[int, Any, bool]] = []
        for index, body in enumerate(bodies):
            dynamic, turns = body.body_type == pymunk.Body.DYNAMIC, np.isfinite(body.moment)
            root[index] *= (dynamic, dynamic, dynamic and turns)
            if dynamic:
                moved.append((index, body._body, bool(turns)))
        self._root, self._moved = root.reshape(-1), moved
        # A contact's tables are not read there.
        by_machine = installed() and not any(isinstance(joint, Roll) for joint in mechanism.joints)
        self.marching = (
            Marching(mechanism, space, bodies, origins, self._closed, self._root, unit) if by_machine else None
        )

    def __call__(self) -> None:
        if self.marching is not None:
            self.marching.project()
            return
        state = self._state()
        change = self._change(state)
        if change is None:
            return
        twist = (state[:, 3:] + change) * self._unit
        for index, body, turns in self._moved:
            x, y, rate = twist[index].tolist()
            lib.cpBodySetVelocity(body, (x, y))
            if turns:
                lib.cpBodySetAngularVelocity(body, rate)

    def _change(self, state: Array) -> Array | None:
        """What is added to twists (bodies, 3) in a state (bodies, 6); None if it has blown up."""
        pose, twist = state[:, :3], state[:, 3:]
        matrix = self._rows.dense(pose)
        wanted = self._rate - self._closed * np.nan_to_num(self._rows.gap(pose, _START)) - matrix @ twist.reshape(-1)
        if not (np.isfinite(wanted).all() and np.isfinite(matrix).all()):
            return None
        matrix *= self._root
        # Rows of equal length, so that no unit of theirs decides which of them depend on others.
        norm = np.sqrt(np.einsum("ij,ij->i", matrix, matrix))
        moved = norm > 0
        change = _least_change(matrix[moved] / norm[moved, None], wanted[moved] / norm[moved])
        return (change * self._root).reshape(twist.shape)

    def _state(self) -> Array:
        """(bodies, 6): poses [m, m, rad] and twists [m/s, m/s, rad/s] of the centres of mass."""
        values = []
        for body, x, y in self._bodies:
            place, velocity = lib.cpBodyGetPosition(body), lib.cpBodyGetVelocity(body)
            angle, rate = lib.cpBodyGetAngle(body), lib.cpBodyGetAngularVelocity(body)
            out_x, out_y = x * cos(angle) - y * sin(angle), x * sin(angle) + y * cos(angle)
            moving = velocity.x + rate * out_y, velocity.y - rate * out_x, rate
            values.append((place.x - out_x, place.y - out_y, angle, *moving))
        state = np.array(values)
        state[:, 3:] /= self._unit
        return state


def _least_change(matrix: Array, wanted: Array) -> Array:
    """The least x (columns,) with matrix (rows, columns) x = wanted (rows,), for rows of length one.

    By Cholesky's factor of the row system and one correction; where its pivots tell that rows nearly depend on others,
    by singular values.
    """
    system = matrix @ matrix.T
    try:
        factor = np.linalg.cholesky(system)
    except np.linalg.LinAlgError:
        factor = np.zeros_like(system)
    if not (np.diag(factor) ** 2 > NEARLY).all():
        return np.asarray(np.linalg.lstsq(matrix, wanted, rcond=RANK_TOLERANCE)[0], dtype=np.float64)
    out = matrix.T @ cho_solve((factor, True), wanted)
    return out + matrix.T @ cho_solve((factor, True), wanted - matrix @ out)


_START = np.asarray(0.0)  # s: only drives ask for the time, and their gap is not closed
