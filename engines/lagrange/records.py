"""The data of a mechanism for compiled functions, as records whose types are the same for every mechanism.

Bodies are numbered as in `Mechanism.bodies`, and the ground has the last number. Vectors of coordinates have three
entries for each body, and three zeros for the ground.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism

Reals = NDArray[np.float64]
Records = NDArray[np.void]


class JointKind(IntEnum):
    PIN, SLOT, SKATE, ROLL, DRIVE, ROD, GEAR, WELD, COUPLING = range(9)


class ForceKind(IntEnum):
    SPRING, DAMPER, TORSION_SPRING, TORSION_DAMPER, TORQUE, FORCE, COUPLED_FORCE = range(7)


class RollingForm(IntEnum):
    ON_LINE, ON_ROUND, TABULATED, NOT_TABULATED = range(4)


class CompiledTask(IntEnum):
    FIXED_STEPS, ADAPTIVE_STEPS, EVALUATION = range(3)


class RowLaw(IntEnum):
    """The regularisation of the rows, by springs and dampers with or without compliance."""

    IDEAL, SPRINGS, COMPLIANT = range(3)


class RowSelection(IntEnum):
    ALL, HOLONOMIC, RIGID = range(3)


# Newton's method stops after a correction of this size, in units of the mechanism's length. The method converges
# quadratically, so the next correction would be below rounding.
CLOSED = 1e-9
# Smallest inverse inertia of a soft row under the constraints of the rigid rows, relative to the inverse inertia of the
# row alone. The limit is used if the soft row depends on the rigid rows.
LEAST_INVERSE_INERTIA = 0.1
CELL_SIZE = 20  # Number of complex numbers in a cell of `engines.rolling_table`.
MOST_STAGES = 16  # Largest number of stages of a method, including those for dense output.


def _record(integers: str, reals: str = "", complexes: str = "", unsigned: str = "") -> np.dtype[np.void]:
    names = ((integers, np.int64), (reals, np.float64), (complexes, np.complex128), (unsigned, np.uintp))
    return np.dtype([(name, kind) for text, kind in names for name in text.split()])


# Points [m] in the frames of the first and of the second body.
POINT_FIELDS = "first_x first_y second_x second_y "
# Fields have the units of `reference.joints`, `reference.forces` and `reference.couplings`.
# `dependent`: whether rows are dependent at the start; `regularised`: a RowLaw; `inverse_length`: of the length scale.
CONSTANT_RECORD = _record("dependent regularised holonomic_rows", "gravity_x gravity_y inverse_length")
# Inverse inertias and state of a body at the last call of `set_bodies`.
BODY_RECORD = _record("", "inverse_mass inverse_inertia x y angle cos sin vx vy omega")
JOINT_RECORD = _record("kind first second row roll", POINT_FIELDS + "angle length ratio offset rate")
FORCE_RECORD = _record("kind first second first_term term_count", POINT_FIELDS + "x y stiffness rest damping load")
TERM_RECORD = _record("row first second first_end second_end sliding", "factor line_angle offset " + POINT_FIELDS)
# The factor's entries of a row begin at `begin`: the diagonal, and the couplings with `count` - 1 later rows.
ROW_RECORD = _record("first second holonomic begin count")
# State and regularisation of a row, which has no bias if `without_bias` is 1.
EQUATION_RECORD = _record("", "gap bias rate stiffness damping compliance without_bias inverse_inertia")
# Derivatives of a row by the coordinates of a body.
END_RECORD = _record("", "x y turn")
# An end of a row with more than two bodies.
FURTHER_END_RECORD = _record("row body end")
# Two ends on one body; their product is added to an entry of the matrix.
PRODUCT_RECORD = _record("", unsigned="entry end other body")
# Constants of a closed form in `engines.rolling_table`, or a table's window of cells.
ROLLING_RECORD = _record(
    "form first second first_cell cell_count cell_begin", "start angle turning width", "origin along radius middle"
)
# Results of calls; the time of an event is NaN if the event did not happen.
# missing_roll: number of a roll whose table has no cell at the rotation `missing_angle` [rad], or -1.
# selection: RowSelection of the last factorisation.
# smallest_pivot: smallest pivot relative to the diagonal since the beginning of a step.
# factor_pivot: smallest pivot relative to the diagonal in the last factorisation.
# stopped_at: time [s] at which steps became too small or too many.
# stiff_from: time [s] from which the motion is stiff.
# open_from: time [s] of the first projection that did not converge.
# singular_at: time [s] of the first projection with a pivot below NEARLY_SINGULAR.
# rounding: change of speeds by rounding, in units of the mechanism's speed.
STATUS_RECORD = _record(
    "missing_roll accepted_steps selection",
    "missing_angle smallest_pivot factor_pivot stopped_at stiff_from rounding open_from singular_at",
)


class System(NamedTuple):
    """The records of a mechanism, the arrays of its row system, and the status of the calls."""

    constants: Any  # A CONSTANT_RECORD.
    status: Any  # A STATUS_RECORD.
    bodies: Records  # (bodies + 1,).
    joints: Records
    forces: Records
    terms: Records  # terms of couplings, then terms of coupled forces
    rolls: Records
    cells: NDArray[np.complex128]  # cells (cells, CELL_SIZE) of all tables
    rows: Records
    equations: Records  # (rows,).
    ends: Records  # Two ends of each row, further ends of couplings, and one unused end.
    further_ends: Records
    products: Records
    matrix: Reals  # J M^-1 J^T in its envelope, overwritten by its factor.
    columns: NDArray[np.uintp]  # The later row of each entry of the matrix.
    inverse_pivots: Reals  # (rows,).
    right: Reals  # (rows,) right side.
    reaction: Reals  # (rows,).
    residual: Reals  # (rows,).
    change: Reals  # M^-1 J^T reaction (coordinates,).


class StepStorage(NamedTuple):
    """Arrays of a step: units and states (coordinates,), and the velocities and accelerations of the stages."""

    pose_unit: Reals
    twist_unit: Reals
    pose: Reals
    twist: Reals
    stage_pose: Reals
    stage_twist: Reals
    new_pose: Reals
    new_twist: Reals
    acceleration: Reals
    velocities: Reals  # (MOST_STAGES, coordinates)
    accelerations: Reals


class Samples(NamedTuple):
    """States (samples, coordinates without the ground's), and reactions (samples, rows) and accelerations of states."""

    poses: Reals
    twists: Reals
    reactions: Reals
    accelerations: Reals


NO_RESULTS: Reals = np.zeros((0, 0))
# Types of numbers in arrays for compiled functions, which read the memory of another type as wrong numbers.
NUMBER_TYPES = {np.dtype(kind) for kind in (np.float64, np.complex128, np.uintp)}


def block_of(arrays: Iterable[Any]) -> ctypes.Array[ctypes.c_int64]:
    """The addresses and shapes of contiguous arrays, for compiled functions. The caller must keep the arrays.

    Raises TypeError for numbers of another type, for example of single precision.
    """
    words = list[int]()
    for array in arrays:
        if array.dtype.names is None and array.dtype not in NUMBER_TYPES:
            raise TypeError(f"an array for compiled code has the type {array.dtype}; convert its numbers to float64")
        if array.ndim == 0:  # a record
            address = array.__array_interface__["data"][0]
        else:  # ValueError if the array is not contiguous
            address = ctypes.addressof(ctypes.c_char.from_buffer(array)) if array.size else 0
        words += (address, *array.shape)
    return (ctypes.c_int64 * len(words))(*words)


def new_status() -> Any:
    status = np.zeros(1, STATUS_RECORD)[0]
    status["missing_roll"], status["smallest_pivot"] = -1, 1.0
    status["stopped_at"] = status["stiff_from"] = status["open_from"] = status["singular_at"] = np.nan
    return status


def new_storage(mechanism: Mechanism) -> StepStorage:
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies) + 1)
    names = ("pose", "twist", "stage_pose", "stage_twist", "new_pose", "new_twist", "acceleration")
    states = {name: np.zeros_like(unit) for name in names}
    velocities, accelerations = np.zeros((2, MOST_STAGES, len(unit)))
    return StepStorage(unit, unit / mechanism.time_scale, **states, velocities=velocities, accelerations=accelerations)
