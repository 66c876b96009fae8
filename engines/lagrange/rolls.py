"""Rolling pairs as arrays for compiled code: closed forms as constants, tables as a window of their cells.

Compiled code can't ask for cells that are not there: it stops and says so, and the window is moved. Where a table has
no cell at all, near an end of a curve or where the curves nearly fit, only the reference's own contact will do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from engines.rolling_table import BLOCK, FARTHEST, RoundOnLine, RoundOnRound, Table, rolled
from reference.rolling.kinematics import Rolling

ON_LINE, ON_ROUND, TABLE, NOT_TABULATED = range(4)
CONSTANTS = 7
CELL = 20  # complex numbers
# Of a window: 16 MB of cells. A motion beyond asks for another window, a table has as many cells as there are turns.
MOST_CELLS = 2**15


def form_of(rolling: Rolling) -> tuple[int, tuple[float, ...]]:
    """(the form, its constants) of a pair: see `rows.py` in the folder `compiled` for what each stands for."""
    try:
        fast = rolled(rolling)
    except (ValueError, ArithmeticError):  # curves that can't touch everywhere around the start
        return NOT_TABULATED, _numbers(())
    match fast:
        case RoundOnLine():
            return ON_LINE, _numbers(fast.constants)
        case RoundOnRound():
            return ON_ROUND, _numbers(fast.constants)
        case Table() if not fast.exact_only:
            return TABLE, _numbers((fast.width,))
    return NOT_TABULATED, _numbers(())


def _numbers(values: tuple[complex, ...]) -> tuple[float, ...]:
    """Complex numbers as two each, real ones too, filled up with zeros."""
    flat = [part for value in values for part in (complex(value).real, complex(value).imag)]
    return tuple(flat + [0.0] * (2 * CONSTANTS - len(flat)))


class Windows:
    """The cells of all tables of a mechanism that compiled code may use, around the rotations that it has met."""

    def __init__(self, rolls: Sequence[Rolling], records: NDArray[np.int64]) -> None:
        self._tables = [rolled(rolling) for rolling in rolls]
        self._records = records  # (rolls, 4), as `flat` describes them; written to
        self._parts = [np.zeros((0, CELL), dtype=complex) for _ in rolls]
        self.cells = np.zeros((0, CELL), dtype=complex)
        for which, rolling in enumerate(rolls):
            if records[which, 0] == TABLE:
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
