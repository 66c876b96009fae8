"""Written rows in machine code: where numba is installed, MuJoCo calls it in every stage, and Python takes no part.

The code is that of the rows themselves and of `chain_motion`, compiled as it stands, and what goes round them here is
the loop of `written_rows.row_writer` over arrays. It is compiled once and kept beside the sources by numba. What it has
to know of a mechanism, its `plan`, stands in the model as a custom numeric, which MuJoCo passes along. Where MuJoCo
keeps its arrays is a matter of its release, so it is looked up: a word of the structure that is an array's address.

Rows without a `Law` (those of rolling) are left to Python, and so is a model whose rows Python would write otherwise.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from inspect import getsource
from typing import Any

import mujoco
import numpy as np
from numba import carray, cfunc, njit, types  # pyright: ignore[reportPrivateImportUsage]
from numba.core import cgutils
from numba.extending import intrinsic

from engines.mujoco import chain_motion
from engines.mujoco.joints.rod_gear_weld import rod_row
from engines.mujoco.joints.skate.rows import skate_row
from engines.mujoco.joints.slot import slot_row
from engines.mujoco.written_rows import Law, WrittenJoint
from engines.tree import Tree

LAWS = (skate_row, slot_row, rod_row)
SKATE, SLOT, _ = range(3)
# Numbers of a plan: how many links and joints, the first row and the length of a row; of a link: where its parent
# stands, the columns of its slides and its rotation, its start, and what `hung` is told; of a joint: its law, where its
# bodies stand, and the law's numbers. Minus one for what is not there; the ground stands last.
HEADER, LINK, JOINT = 4, 13, 10
STATE, FREE = 12, -2
FARTHEST = 1000  # words; what is looked for stands before

_options: dict[str, Any] = {"error_model": "numpy", "cache": False}
_skate, _slot, _rod, _hung = (njit(**_options)(each) for each in (*LAWS, chain_motion.hung))


def planned(tree: Tree, needed: Sequence[int], address: Sequence[int], joints: Sequence[WrittenJoint]) -> list[float]:
    """The plan's links and joints; `needed` are the links, parents first. Empty where a row has no law of these."""
    place: dict[int | None, int] = {tree.links[index].body: own for own, index in enumerate(needed)} | {None: -1}
    out: list[float] = []
    for index in needed:
        link = tree.links[index]
        slide_x, slide_y, slide, rotation = chain_motion.columns_of(tree, index, address)
        first = slide if slide_x is None else slide_x
        columns = [-1 if column is None else column for column in (first, slide_y, rotation)]
        parent = FREE if link.kind == "free" else place[link.parent]
        out += [parent, *columns, *tree.mechanism.bodies[link.body].pose, *chain_motion.hanging(tree, index)]
    for joint in joints:
        if not isinstance(joint.rows, Law) or joint.rows.row not in LAWS:
            return []
        numbers = [*joint.rows.numbers, *[0.0] * (JOINT - 3)][: JOINT - 3]
        out += [LAWS.index(joint.rows.row), place[joint.first], place[joint.second], *numbers]
    return out


@intrinsic
def _pointer(_context, address):
    """A pointer to what stands at an address."""

    def generate(_target: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(address), generate


@cache
def writer() -> Any | None:
    """The callback for `mjcb_control`, a numba.CFunc; None where MuJoCo's arrays can't be found."""
    places = _places()
    return None if places is None else _compiled(*places, _digest())


def _digest() -> int:
    """Of all that is compiled with the callback: numba looks at this file alone."""
    sources = "".join(getsource(each) for each in (*LAWS, chain_motion.hung))
    return int(sha256(sources.encode()).hexdigest()[:12], 16)


def _places() -> tuple[int, int, int, int, int] | None:
    """Which words of mjModel and mjData point to numeric_data, and to qpos, qvel, efc_J and efc_aref."""
    found = []
    for bodies in (2, 3):
        model = mujoco.MjModel.from_xml_string(_example(bodies))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        wanted = [(model, model.numeric_data), *((data, each) for each in (data.qpos, data.qvel))]
        wanted += [(data, data.efc_J), (data, data.efc_aref)]
        found.append([_words(owner, array.ctypes.data) for owner, array in wanted])
    both = [sorted(set(one) & set(other)) for one, other in zip(*found, strict=True)]
    return None if not all(both) else tuple(words[-1] for words in both)  # type: ignore[return-value]


def _example(bodies: int) -> str:
    body = '<body><joint name="{0}" type="hinge"/><inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/></body>'
    return (
        f'<mujoco><option jacobian="dense"/><worldbody>{"".join(map(body.format, range(bodies)))}</worldbody><custom>'
        '<numeric name="plan" data="1 2 3"/></custom><equality><joint joint1="0" joint2="1"/></equality></mujoco>'
    )


def _words(owner: Any, target: int) -> list[int]:
    """The first words of a structure that are this address: it and the next few, where there are several."""
    address, size = getattr(owner, "_address", None), ctypes.sizeof(ctypes.c_size_t)
    if address is None:
        return []

    def holds(word: int) -> bool:
        return ctypes.c_size_t.from_address(address + size * word).value == target

    # Of mjData the statistics of solvers come first, many thousands of words.
    begin = (owner.energy.ctypes.data - address) // size if isinstance(owner, mujoco.MjData) else 0
    first = next((word for word in range(begin, begin + FARTHEST) if holds(word)), None)
    return [] if first is None else [word for word in range(first, first + 8) if holds(word)]


def _compiled(model_plan: int, at_q: int, at_v: int, at_jacobian: int, at_reference: int, digest: int) -> Any:
    make = _made(model_plan, at_q, at_v, at_jacobian, at_reference, digest)
    signature = types.void(types.voidptr, types.voidptr)
    try:
        return cfunc(signature, error_model="numpy", cache=True)(make)
    except RuntimeError:  # no folder that can be written to: each process compiles
        return cfunc(signature, error_model="numpy")(make)


@njit(**_options)
def _array(structure, word, size):
    """The array whose address is this word of a structure."""
    words = carray(structure, (word + 1,), np.intp)
    return carray(_pointer(words[word]), (size,), np.float64)  # pyright: ignore[reportCallIssue]


@njit(**_options)
def _there(structure, word):
    return carray(structure, (word + 1,), np.intp)[word] != 0


@njit(**_options)
def _motion(m):
    return m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11]


def _made(
    model_plan: int, at_q: int, at_v: int, at_jacobian: int, at_reference: int, digest: int
) -> Callable[[Any, Any], None]:
    def write(model, data):
        size = digest * 0 + HEADER  # (the digest is named here so that it counts among what is compiled)
        header = _array(model, model_plan, size)
        links, joints, first_row, width = int(header[0]), int(header[1]), int(header[2]), int(header[3])
        plan = _array(model, model_plan, HEADER + LINK * links + JOINT * joints)
        q, v = _array(data, at_q, width), _array(data, at_v, width)
        if not _there(data, at_jacobian):
            return  # MuJoCo has no room for its rows, and says so
        jacobian = _array(data, at_jacobian, (first_row + joints) * width)
        reference = _array(data, at_reference, first_row + joints)
        moving = np.zeros((links + 1, STATE))
        for own in range(links):
            at = HEADER + LINK * own
            parent, slide, across, rotation = int(plan[at]), int(plan[at + 1]), int(plan[at + 2]), int(plan[at + 3])
            turn, spin = (0.0, 0.0) if rotation < 0 else (q[rotation], v[rotation])
            if parent == FREE:
                x, y = plan[at + 4] + q[slide], plan[at + 5] + q[across]
                moved = (x, y, turn, v[slide], v[across], spin, 0.0, 0.0, x, y, 0.0, 0.0)
            else:
                along, speed = (0.0, 0.0) if slide < 0 else (q[slide], v[slide])
                told = (plan[at + 7], plan[at + 8], plan[at + 9], plan[at + 10], plan[at + 11], plan[at + 12])
                moved = _hung(_motion(moving[parent]), told, along, speed, turn, spin)
            for k in range(STATE):
                moving[own, k] = moved[k]
        for joint in range(joints):
            at = HEADER + LINK * links + JOINT * joint
            kind, ends = int(plan[at]), (int(plan[at + 1]), int(plan[at + 2]))
            n = plan[at + 3 : at + JOINT]
            m, angle = moving[ends[0]], 0.0 if ends[0] < 0 else plan[HEADER + LINK * ends[0] + 6]
            first = (m[0], m[1], angle + m[2], m[3], m[4], m[5])
            m, angle = moving[ends[1]], 0.0 if ends[1] < 0 else plan[HEADER + LINK * ends[1] + 6]
            second = (m[0], m[1], angle + m[2], m[3], m[4], m[5])
            if kind == SKATE:
                row = _skate((n[0], n[1], n[2], n[3]), first, second)
            elif kind == SLOT:
                row = _slot((n[0], n[1], n[2], n[3], n[4], n[5], n[6]), first, second)
            else:
                row = _rod((n[0], n[1], n[2], n[3], n[4], n[5], n[6]), first, second)
            line, right = (first_row + joint) * width, row[6]
            jacobian[line : line + width] = 0.0
            for k in range(2):
                if ends[k] < 0:
                    continue
                along_x, along_y, turning, m = row[3 * k], row[3 * k + 1], row[3 * k + 2], moving[ends[k]]
                right -= along_x * m[6] + along_y * m[7]
                own = ends[k]
                while own >= 0:
                    at, mover = HEADER + LINK * own, moving[own]
                    parent, slide, rotation = int(plan[at]), int(plan[at + 1]), int(plan[at + 3])
                    if parent == FREE:
                        jacobian[line + slide] += along_x
                        jacobian[line + int(plan[at + 2])] += along_y
                    elif slide >= 0:
                        jacobian[line + slide] += along_x * mover[10] + along_y * mover[11]
                    if rotation >= 0:
                        arm = along_y * (m[0] - mover[8]) - along_x * (m[1] - mover[9])
                        jacobian[line + rotation] += turning + arm
                    own = parent
            reference[first_row + joint] = right
        for joint in range(joints):
            if not math.isfinite(reference[first_row + joint]):
                # A motion that has blown up, see `written_rows.writing`.
                jacobian[first_row * width :] = 0.0
                reference[first_row:] = math.nan

    return write
