"""A mechanism stepped by compiled code: the calls, the windows of tables, and what compiled code leaves to numpy."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Regularisation
from engines.lagrange import arrays as ix
from engines.lagrange.arrays import Arrays, arrays_of
from engines.lagrange.dynamics import ADAPTIVE_DOP853, NONE, PROJECTION_ITERATIONS, Tableau
from engines.lagrange.loading import compiled
from engines.rolling_table import BLOCK, FARTHEST, Table, rolled
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.rolling.kinematics import Rolling

Array = NDArray[np.float64]
STEP_SHARE, LEAST_TOLERANCE = 0.1, 2e-15
MOST_MOVES = 8  # of windows, for one sample


# Of a window: 16 MB of cells. A motion beyond asks for another window, a table has as many cells as there are turns.
MOST_CELLS = 2**15


class CellWindows:
    """The cells of all tables of a mechanism that compiled code may use, around the rotations that it has met.

    Compiled code can't ask for cells that are not there: it stops and says so, and the window is moved. Where a table
    has no cell at all, near an end of a curve or where the curves nearly fit, only the reference's own contact will do.
    """

    def __init__(self, rolls: Sequence[Rolling], records: NDArray[np.int64]) -> None:
        self._tables = [rolled(rolling) for rolling in rolls]
        self._records = records  # (rolls, ROLL_RECORD); written to
        self._parts = [np.zeros((0, ix.CELL), dtype=complex) for _ in rolls]
        self.cells = np.zeros((0, ix.CELL), dtype=complex)
        for which, rolling in enumerate(rolls):
            if records[which, 0] == ix.TABLE:
                self.move(which, rolling.theta)

    def move(self, which: int, theta: float) -> bool:
        """Have a roll's cells around a rotation [rad]; False where there is none: only exact contacts will do there."""
        table = self._tables[which]
        if not isinstance(table, Table) or not abs(theta) < FARTHEST:
            return False
        wanted = math.floor(theta / table.width)
        first, count = int(self._records[which, 1]), int(self._records[which, 2])
        if first <= wanted < first + count:  # it was there, so it is a cell without numbers
            return False
        if abs(wanted - first) * table.width > 2 * math.pi:  # a motion that is lost asks far away, and never again
            count = 0
        # A block on either side at first, then twice as far each time: cells take longer to make than short motions do.
        about = min(max(BLOCK, count), MOST_CELLS // 2)
        low, high = wanted - about, wanted + about
        if count and high - low + count <= MOST_CELLS:
            low, high = min(low, first), max(high, first + count)
        try:
            self._parts[which] = table.cells(low, high - low)
        except (ValueError, ArithmeticError):  # somewhere in it the curves can't touch
            return False
        if np.isnan(self._parts[which][wanted - low, 0].real):
            return False
        self._records[which, 1], self._records[which, 2] = low, high - low
        begin = np.cumsum([0, *map(len, self._parts)])
        self._records[:, 3] = begin[:-1]
        self.cells = np.concatenate(self._parts)
        return True


def not_held(tolerance: float | None, t: float) -> str:
    """What a run says that stopped at t [s]; None: its steps are of one length."""
    if tolerance is None:
        return f"lagrange: the motion is lost at {t:.6g} s; give a shorter step, or end the run there"
    return (
        f"lagrange: the tolerance {tolerance:g} can't be held beyond {t:.6g} s: "
        "steps become too small or too many; give a larger tolerance, or end the run there"
    )


def left_open(t: float) -> str:
    """What a run says of which a projection at t [s] did not close the joints."""
    return (
        f"lagrange: at {t:.6g} s the projection onto the joints does not converge: "
        "the step is too long, or they are in a singular position"
    )


@dataclass
class Machine:
    """A mechanism's arrays and the compiled function that steps them."""

    mechanism: Mechanism
    arrays: Arrays
    windows: CellWindows
    run: Callable[..., int] = field(default_factory=compiled)

    @classmethod
    def of(cls, mechanism: Mechanism) -> Machine | None:
        """None where numpy has to evaluate the reference's own laws: for a pair of curves that no table holds, and for
        a kind of joint or force that machine code does not know.
        """
        if not {*map(type, mechanism.joints)} <= {*ix.KINDS} or not {*map(type, mechanism.forces)} <= {*ix.FORCE_KINDS}:
            return None
        arrays = arrays_of(mechanism)
        rolls = [joint.rolling for joint in mechanism.joints if isinstance(joint, Roll)]
        records = arrays.rolls
        if np.any(records[:, 0] == ix.NOT_TABULATED):
            return None
        return cls(mechanism, arrays, CellWindows(rolls, records))

    def soften(self, softness: Regularisation, gives: NDArray[np.bool_]) -> None:
        """Let the rows that `gives` (rows,) names give way by springs, dampers and a compliance."""
        whole, real, place = self.arrays.whole, self.arrays.real, self.arrays.rows[gives]
        whole[ix.SOFT] = 2 if softness.compliance > 0 else 1
        real[whole[ix.STIFFNESS] + place], real[whole[ix.DAMPING] + place] = softness.stiffness, softness.damping
        real[whole[ix.COMPLIANCE] + place], real[whole[ix.LACKING] + place] = softness.compliance, not softness.complete

    @property
    def dependent(self) -> bool:
        """Whether some rows follow from others at the start."""
        return bool(self.arrays.whole[ix.DEPENDENT])

    @property
    def left_to_numpy(self) -> bool:
        """Whether the last call ended at a contact that no table holds."""
        return self.status(ix.WANTED_ROLL) >= 0

    def warnings(self, tolerance: float | None) -> tuple[str, ...]:
        """What projections and the control of steps have to say after a run."""
        found = [] if np.isnan(self.status(ix.UNCLOSED)) else [left_open(self.status(ix.UNCLOSED))]
        if tolerance is None:
            return tuple(found)
        if not np.isnan(self.status(ix.STOPPED)):
            found.append(not_held(tolerance, self.status(ix.STOPPED)))
        if not np.isnan(self.status(ix.STIFF)):
            found.append(
                f"lagrange: stiff from {self.status(ix.STIFF):.6g} s on: stability and not accuracy sets the steps"
            )
        if self.status(ix.ROUNDED) > 10 * tolerance:
            found.append(
                "lagrange: rows are so nearly dependent that rounding alone changes speeds by "
                f"{self.status(ix.ROUNDED):.1g} of the mechanism's own, more than the tolerance {tolerance:g}"
            )
        return tuple(found)

    def status(self, what: int) -> float:
        """One of the numbers that compiled code leaves behind."""
        return float(self.arrays.real[self.arrays.whole[ix.STATUS] + what])

    def empty(self, samples: int) -> tuple[Array, Array]:
        """Poses and twists (samples + 1, columns), the first as at the start, the others NaN."""
        whole, real, columns = self.arrays.whole, self.arrays.real, int(self.arrays.whole[ix.COLUMNS])
        poses, twists = np.full((2, samples + 1, columns), np.nan)
        poses[0] = real[whole[ix.START_POSE] : whole[ix.START_POSE] + columns]
        twists[0] = real[whole[ix.START_TWIST] : whole[ix.START_TWIST] + columns]
        return poses, twists

    def march(
        self, tableau: Tableau, project: int, dt: float, every: int, begin: int, poses: Array, twists: Array
    ) -> int:
        """Steps of dt [s] from a sample on; the last sample that is done, before one that only numpy can do."""
        return self._repeated(
            lambda at: self._call(ix.MARCH, tableau, project, 0.0, dt, every, at, poses, twists), begin
        )

    def control(self, tolerance: float, spacing: float, begin: int, poses: Array, twists: Array) -> int:
        """Steps of their own size between samples `spacing` [s] apart; as `march`.

        A step is allowed a tenth of the tolerance, since errors add up: so the result about holds it.
        """
        tolerance = max(STEP_SHARE * tolerance, LEAST_TOLERANCE)
        self.arrays.real[self.arrays.whole[ix.STATUS] + ix.STEPS] = 0.0
        return self._repeated(
            lambda at: self._call(
                ix.CONTROL, ADAPTIVE_DOP853, PROJECTION_ITERATIONS, tolerance, spacing, 1, at, poses, twists
            ),
            begin,
        )

    def reactions(self, dt: float, poses: Array, twists: Array) -> tuple[Array, Array]:
        """Reactions (samples, rows) and accelerations (samples, bodies, 3) of states dt apart; NaN where not known."""
        whole = self.arrays.whole
        out = np.full((len(poses), whole[ix.ROWS] + whole[ix.COLUMNS]), np.nan)

        def call(at: int) -> int:
            return self._call(ix.REACT, NONE, 0, 0.0, dt, 1, at, poses, twists, out)

        if len(poses):
            self._repeated(call, 0)
        return out[:, self.arrays.rows], out[:, whole[ix.ROWS] : -3].reshape(len(poses), -1, 3)

    def _repeated(self, call: Callable[[int], int], begin: int) -> int:
        """Call, and again after each move of a window, for as long as that helps."""
        whole, real = self.arrays.whole, self.arrays.real
        done, moves = begin, 0
        while True:
            real[whole[ix.STATUS] + ix.WANTED_ROLL] = -1.0
            before, done = done, call(done)
            moves = moves + 1 if done == before else 0
            wanted = int(self.status(ix.WANTED_ROLL))
            # A body that turns through more than a window between two samples has lost its way.
            if wanted < 0 or moves > MOST_MOVES or not self.windows.move(wanted, self.status(ix.WANTED_ANGLE)):
                return done

    def _call(
        self,
        task: int,
        tableau: Any,
        project: int,
        tolerance: float,
        dt: float,
        every: int,
        begin: int,
        poses: Array,
        twists: Array,
        out: Array | None = None,
    ) -> int:
        estimates, whole, real = ADAPTIVE_DOP853, self.arrays.whole, self.arrays.real
        # Nothing of a run that was lost: NaN times the ground's mobility, zero, would stay in its acceleration.
        real[whole[ix.ACCELERATION] : whole[ix.STATUS]] = 0.0
        return self.run(
            *(task, whole, real, self.windows.cells),
            *(tableau.stages, tableau.weights, tableau.nodes, estimates.third, estimates.fifth, estimates.dense),
            *(project, tolerance, dt, every, begin, poses, twists, poses if out is None else out),
        )
