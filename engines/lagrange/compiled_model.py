"""A mechanism for compiled code: calls of compiled functions, cells of rolling tables, and warnings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Regularisation
from engines.lagrange.dynamics import PROJECTION_ITERATIONS
from engines.lagrange.loading import compiled
from engines.lagrange.methods import ADAPTIVE_DOP853, NO_STAGES, Tableau
from engines.lagrange.records import (
    CELL_SIZE,
    NO_RESULTS,
    CompiledTask,
    Records,
    RollingForm,
    RowLaw,
    Samples,
    StepStorage,
    System,
    block_of,
    new_storage,
)
from engines.lagrange.system import FORCE_FIELDS, JOINT_FIELDS, system_of
from engines.rolling_table import CELLS_IN_BLOCK, FARTHEST, Table, rolled
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.rolling.kinematics import Rolling
from reference.trajectory import RunWarning

Array = NDArray[np.float64]

# Tolerance of a step relative to the tolerance of the run. The sum of the steps' errors is then about the run's
# tolerance.
STEP_SHARE = 0.1
# Smallest tolerance of a step, about ten rounding errors.
LEAST_STEP_TOLERANCE = 2e-15
# Largest number of moves of a table's window per sample. Only a diverged motion needs more moves.
MOST_MOVES = 8
# Largest number of cells in the window of a table (10 MB).
MOST_CELLS = 2**15


class CellWindows:
    """Windows of cells in the rolling tables, for compiled code.

    Compiled code stops at a rotation outside the window, and then the window is moved. Near the end of a curve a table
    has no cells, and only the exact contacts of `reference.rolling` can be used.
    """

    def __init__(self, rolls: Sequence[Rolling], records: Records) -> None:
        self._tables = [rolled(rolling) for rolling in rolls]
        self._records = records  # (rolls,) of ROLLING_RECORD, whose windows are updated here
        self._parts = [np.zeros((0, CELL_SIZE), dtype=complex) for _ in rolls]
        self.cells = np.zeros((0, CELL_SIZE), dtype=complex)
        for number, rolling in enumerate(rolls):
            if records[number]["form"] == RollingForm.TABULATED:
                self.move(number, rolling.theta)

    def move(self, number: int, theta: float) -> bool:
        """Move a roll's window to a rotation [rad]; return whether the table has a cell at this rotation."""
        table, record = self._tables[number], self._records[number]
        if not isinstance(table, Table) or not abs(theta) < FARTHEST:
            return False
        cell = math.floor(theta / table.width)
        first, count = int(record["first_cell"]), int(record["cell_count"])
        if first <= cell < first + count:  # the cell is outside the limits of rolling
            return False
        if abs(cell - first) * table.width > 2 * math.pi:  # the motion has diverged
            count = 0
        # The first window has a block on both sides of the rotation. Each move doubles the width.
        half_width = min(max(CELLS_IN_BLOCK, count), MOST_CELLS // 2)
        low, high = cell - half_width, cell + half_width
        if count and high - low + count <= MOST_CELLS:
            low, high = min(low, first), max(high, first + count)
        try:
            cells = table.cells(low, high - low)
        except (ValueError, ArithmeticError):  # at some rotation in the window the curves cannot touch
            return False
        if np.isnan(cells[cell - low, 0].real):
            return False
        self._parts[number] = cells
        record["first_cell"], record["cell_count"] = low, high - low
        ends = np.cumsum([0, *map(len, self._parts)])
        self._records["cell_begin"] = ends[:-1]
        self.cells = np.concatenate(self._parts)
        return True


def stopped_warning(tolerance: float | None, t: float) -> RunWarning:
    """The warning of a run that stopped at t [s]; `tolerance` is None for fixed steps."""
    if tolerance is None:
        text = f"lagrange: the motion is lost at {t:.6g} s; give a shorter step, or end the run there"
    else:
        text = (
            f"lagrange: the tolerance {tolerance:g} can't be held beyond {t:.6g} s: "
            "steps become too small or too many; give a larger tolerance, or end the run there"
        )
    return RunWarning(text, "lost", time=t)


def open_warning(t: float) -> RunWarning:
    """The warning of a run in which the projection at t [s] did not converge."""
    text = (
        f"lagrange: at {t:.6g} s the projection onto the joints does not converge: "
        "the step is too long, or they are in a singular position"
    )
    return RunWarning(text, "gap", time=t)


def singular_warning(t: float) -> RunWarning:
    """The warning of a run with fixed steps in which a step ended near a singular position at t [s]."""
    text = (
        f"lagrange: a step ends beside a singular position at {t:.6g} s, where rounding becomes motion; "
        "a longer step may have a smaller error"
    )
    return RunWarning(text, "rank", time=t)


@dataclass
class CompiledModel:
    """The records of a mechanism, and calls of the compiled function that uses them."""

    mechanism: Mechanism
    system: System
    storage: StepStorage
    positions: NDArray[np.int64]  # (rows,) rows of the system by row of the mechanism
    windows: CellWindows

    def __post_init__(self) -> None:
        self._storage_block, self._tableau, self._tableau_block = block_of(self.storage), NO_STAGES, block_of(NO_STAGES)
        self._set_cells()

    def __reduce__(self) -> tuple[type[CompiledModel], tuple[Any, ...]]:
        """A copy builds its own blocks, since these contain addresses of its arrays."""
        return type(self), tuple(getattr(self, entry.name) for entry in fields(self))

    def _set_cells(self) -> None:
        self.system = self.system._replace(cells=self.windows.cells)
        self._system_block = block_of(self.system)

    @classmethod
    def of(cls, mechanism: Mechanism) -> CompiledModel | None:
        """The compiled model of a mechanism.

        None if a joint or a force element has no compiled function, or if a rolling pair has no accurate table.
        """
        if not {*map(type, mechanism.joints)} <= {*JOINT_FIELDS}:
            return None
        if not {*map(type, mechanism.forces)} <= {*FORCE_FIELDS}:
            return None
        system, positions = system_of(mechanism)
        if np.any(system.rolls["form"] == RollingForm.NOT_TABULATED):
            return None
        rolls = [joint.rolling for joint in mechanism.joints if isinstance(joint, Roll)]
        windows = CellWindows(rolls, system.rolls)
        return cls(mechanism, system, new_storage(mechanism), positions, windows)

    def regularise(self, regularisation: Regularisation, rows: NDArray[np.bool_]) -> None:
        system, selected = self.system, self.positions[rows]
        system.constants["regularised"] = RowLaw.COMPLIANT if regularisation.compliance > 0 else RowLaw.SPRINGS
        for name in ("stiffness", "damping", "compliance"):
            system.equations[name][selected] = getattr(regularisation, name)
        system.equations["without_bias"][selected] = not regularisation.complete

    @property
    def has_dependent_rows(self) -> bool:
        return bool(self.system.constants["dependent"])

    @property
    def lacks_contact(self) -> bool:
        """Whether the last call ended at a rotation without a cell."""
        return bool(self.system.status["missing_roll"] >= 0)

    @property
    def smallest_pivot(self) -> float:
        return float(self.system.status["smallest_pivot"])

    def warnings(self, tolerance: float | None) -> tuple[RunWarning, ...]:
        status = self.system.status
        warnings = [] if np.isnan(status["open_from"]) else [open_warning(float(status["open_from"]))]
        if tolerance is None:
            return (*warnings, *([] if np.isnan(status["singular_at"]) else [singular_warning(status["singular_at"])]))
        if not np.isnan(status["stopped_at"]):
            warnings.append(stopped_warning(tolerance, float(status["stopped_at"])))
        if not np.isnan(status["stiff_from"]):
            text = f"lagrange: stiff from {status['stiff_from']:.6g} s on: stability and not accuracy sets the steps"
            warnings.append(RunWarning(text, "stiff", time=float(status["stiff_from"])))
        if status["rounding"] > 10 * tolerance:
            text = (
                "lagrange: rows are so nearly dependent that rounding alone changes speeds by "
                f"{status['rounding']:.1g} of the mechanism's own, more than the tolerance {tolerance:g}"
            )
            warnings.append(RunWarning(text, "rank"))
        return tuple(warnings)

    def empty_samples(self, samples: int) -> tuple[Array, Array]:
        """Poses and twists (samples + 1, bodies, 3) with the start, and NaN at later samples."""
        poses, twists = np.full((2, samples + 1, *self.mechanism.pose.shape), np.nan)
        poses[0], twists[0] = self.mechanism.pose, self.mechanism.twist
        return poses, twists

    def fixed_steps(
        self, tableau: Tableau, iterations: int, dt: float, every: int, begin: int, poses: Array, twists: Array
    ) -> int:
        """Fill the samples after `begin` by `every` steps of dt [s] per sample; return the last completed sample.

        iterations: largest number of Newton iterations of a projection.
        poses, twists: contiguous arrays (samples, bodies, 3).
        A run stops early if a contact has no cell or if the motion diverges.
        """
        samples = _flat(poses, twists)
        return self._call(CompiledTask.FIXED_STEPS, tableau, samples, begin, iterations, every, dt, 0.0)

    def adaptive_steps(self, tolerance: float, spacing: float, begin: int, poses: Array, twists: Array) -> int:
        """Fill the samples, which are `spacing` [s] apart, by adaptive steps; see `fixed_steps`."""
        step_tolerance = max(STEP_SHARE * tolerance, LEAST_STEP_TOLERANCE)
        self.system.status["accepted_steps"] = 0
        samples = _flat(poses, twists)
        settings = begin, PROJECTION_ITERATIONS, 1, spacing, step_tolerance
        return self._call(CompiledTask.ADAPTIVE_STEPS, ADAPTIVE_DOP853, samples, *settings)

    def reactions(self, dt: float, poses: Array, twists: Array) -> tuple[Array, Array]:
        """Reactions (samples, rows) and accelerations (samples, bodies, 3) of states dt [s] apart; NaN if unknown."""
        reactions = np.full((len(poses), len(self.positions)), np.nan)
        accelerations = np.full((len(poses), 3 * len(self.mechanism.bodies)), np.nan)
        samples = _flat(poses, twists, reactions, accelerations)
        self._call(CompiledTask.EVALUATION, self._tableau, samples, 0, 0, 1, dt, 0.0)
        return reactions[:, self.positions], accelerations.reshape(poses.shape)

    def _call(self, task: CompiledTask, tableau: Tableau, samples: Samples, begin: int, *settings: float) -> int:
        """Run a task; after each move of a window, run it again from the last completed sample.

        settings: iterations, every, dt and tolerance of `compiled.run.run`.
        """
        if tableau is not self._tableau:
            self._tableau, self._tableau_block = tableau, block_of(tableau)
        run, status, states = compiled(), self.system.status, block_of(samples)
        done, moves = begin, 0
        while True:
            status["missing_roll"] = -1
            blocks = self._system_block, self._storage_block, self._tableau_block, states
            begin, done = done, run(task, *blocks, done, *settings)
            moves = moves + 1 if done == begin else 0
            roll = int(status["missing_roll"])
            if roll < 0 or moves > MOST_MOVES or not self.windows.move(roll, float(status["missing_angle"])):
                return done
            self._set_cells()


def _flat(poses: Array, twists: Array, reactions: Array = NO_RESULTS, accelerations: Array = NO_RESULTS) -> Samples:
    """The samples as arrays (samples, coordinates) on the same memory."""
    if not (poses.flags.c_contiguous and twists.flags.c_contiguous):
        raise ValueError("poses and twists are not contiguous arrays; copy them, since the function fills them")
    return Samples(poses.reshape(len(poses), -1), twists.reshape(len(twists), -1), reactions, accelerations)
