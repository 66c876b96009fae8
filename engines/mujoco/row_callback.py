"""The callback that writes a model's rows: in machine code where it can be, else in Python."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import Any

import mujoco
import numpy as np

from engines.mujoco.chain_motion import ancestry
from engines.mujoco.construction import Callback
from engines.mujoco.written_rows import (
    Law,
    Rows,
    WrittenJoint,
    equality_rows,
    installed,
    row_writer,
    scale_placeholders,
    writing,
    writing_free,
)
from engines.tree import Tree

PLAN = "plan of written rows"
# Of a row's largest number: the same sums of a few products, rounded alike.
SAME = 1e-12


@dataclass(frozen=True)
class Native:
    """A callback in machine code, and the one in Python that writes the same."""

    python: Callback
    native: Any  # a ctypes function, which MuJoCo calls without Python

    def __call__(self, model: Any, data: Any) -> None:
        self.python(model, data)


def reserve_plan(spec: Any, tree: Tree, joints: Sequence[WrittenJoint]) -> None:
    """Room in the model for what the machine code has to know of it, where there may be such code."""
    if machine_code() and hasattr(spec, "add_numeric") and all(isinstance(joint.rows, Law) for joint in joints):
        from engines.mujoco.native_rows import HEADER, JOINT, LINK

        room = HEADER + LINK * len(tree.links) + JOINT * len(joints)
        spec.add_numeric(name=PLAN, data=[0.0] * room)


def row_callback(
    compiled: Any, tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], softening: float
) -> Callback:
    """What writes the joints' rows, the last of the model's equalities, each made as soft as `softening` says.

    Warns where machine code would write other rows than Python does; then Python writes them.
    """
    rows, data = row_writer(tree, address, joints, compiled.nv), mujoco.MjData(compiled)
    scale_placeholders(compiled, data, rows, softening)
    before = equality_rows(compiled) - sum(joint.size for joint in joints)
    short = writing_free(tree, address, joints, before, compiled.nv)
    python = short or writing(rows, before, compiled.nv)
    native = _native(compiled, tree, address, joints, before) if compiled.nnumeric else None
    if native is None:
        return python
    if not _agree(compiled, data, native, rows, before):
        warnings.warn(
            f"machine code writes other rows into MuJoCo {mujoco.__version__} than Python does, which is a mistake of "
            "ours: the rows are written by Python, more slowly",
            stacklevel=2,
        )
        return python
    return Native(python, native)


def _native(
    compiled: Any, tree: Tree, address: Sequence[int], joints: Sequence[WrittenJoint], first_row: int
) -> Any | None:
    """The machine code, its plan laid into the model; None where a row is none that it knows."""
    from engines.mujoco.native_rows import planned, writer

    needed = ancestry(tree, [body for joint in joints for body in (joint.first, joint.second) if body is not None])
    plan = planned(tree, needed, address, joints)
    if not plan:
        return None
    told = [len(needed), len(joints), first_row, compiled.nv, *plan]
    compiled.numeric_data[: len(told)] = told
    code = writer()
    return None if code is None else code.ctypes


def _agree(compiled: Any, data: Any, native: Any, rows: Rows, first_row: int) -> bool:
    """Whether the machine code writes what Python does, in some state: it found MuJoCo's arrays by their addresses."""
    data.qpos[:], data.qvel[:] = 0.1 / np.arange(1, compiled.nq + 1), 1 / np.arange(1, compiled.nv + 1)
    with installed(native):
        mujoco.mj_forward(compiled, data)
    flat, reference = rows(0.0, data.qpos.tolist(), data.qvel.tolist())
    begin = first_row * compiled.nv
    for found, expected in ((data.efc_J[begin:], flat), (data.efc_aref[first_row:], reference)):
        there = found[: len(expected)]
        if not np.abs(there - expected).max() <= SAME * max(np.abs(expected).max(), 1.0):
            return False
    return True


@cache
def machine_code() -> bool:
    """Whether there is numba, which makes it; it is not imported."""
    return find_spec("numba") is not None
