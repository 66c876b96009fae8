"""MuJoCo's declared regularisation of loops in a user's model, and changes of settings in the model and file.

A row obeys a + b v + k d r = -R f, where r is its gap and f its force. R is (1 - d) / d times a diagonal matrix for the
inverse inertia. The impedance d grows with the gap. MuJoCo documents the law in the sections "Constraint model" and
"Solver parameters".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from xml.parsers import expat

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.declared import jacobian
from engines.mujoco.reading.elements import equality_rows
from engines.mujoco.reading.frame import PlanarModel
from engines.mujoco.releases import spelled
from engines.mujoco.stiffness import STIFFEST
from engines.reading import Change, RowRegularisation, refuse
from reference.joints import Rod
from reference.mechanism import Mechanism

Array = NDArray[np.float64]
MIN_IMPEDANCE, MAX_IMPEDANCE = 1e-4, 0.9999  # mjMINIMP and mjMAXIMP


@dataclass(frozen=True, eq=False)
class _EqualityRows:
    """The rows of an equality, and the rows of the mechanism that the equality enforces.

    An entry of `blocks` has a slice of the equality's rows, a slice of `ideal`, and a matrix.
    """

    equality: int
    ideal: list[int]  # indices of the mechanism's rows
    blocks: tuple[tuple[slice, slice, Array], ...]
    lengths: Array  # The norms (ideal,) of the columns of the matrices.
    solimp: Array  # (5,).
    stiffness: float
    damping: float


def declared(
    planar: PlanarModel, mechanism: Mechanism, directions: Array, drift: Array, moved: Callable[[Array], Any]
) -> Callable[[Array, Array], RowRegularisation]:
    """The regularisation of the rows as a function of gaps (rows,) [m, rad] and a pose (bodies, 3).

    `directions` (3 bodies, nv) are the twists at t = 0 due to unit velocities of MuJoCo's coordinates. `drift` (3
    bodies,) are the accelerations at t = 0 for zero accelerations of the coordinates, which replace the velocity term
    that equalities of tendons lack (up to 4.0.1). `moved(pose)` is a mujoco.MjData at a pose, after mj_fwdPosition.
    `moved` is needed only with the flag `diagexact`, for which the diagonal depends on the pose.
    """
    begin = np.cumsum([0, *(joint.size for joint in mechanism.joints)])
    rows_of = {joint.name: list(range(at, at + joint.size)) for joint, at in zip(mechanism.joints, begin, strict=False)}
    rows, initial_bias = mechanism.rows(mechanism.pose), np.full(mechanism.row_count, np.nan)
    for joint in mechanism.joints:
        if isinstance(joint, Rod):
            initial_bias[rows_of[joint.name]] = rows[rows_of[joint.name]] @ drift
    ours, theirs = rows @ directions, jacobian(planar.model, planar.data)
    equalities = [
        _equality_rows(planar, index, [row for joint in joints for row in rows_of[joint.name]], ours, theirs)
        for index, joints in planar.held.items()
        if joints and len(equality_rows(planar.data, index))
    ]
    is_exact = bool(planar.model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT))
    mobilities_at_start = [_mobility(planar.data, rows, mechanism.row_count) for rows in equalities]

    def regularisation(gap: Array, pose: Array) -> RowRegularisation:
        stiffness, damping = np.zeros((2, mechanism.row_count))
        compliance = np.zeros((mechanism.row_count, mechanism.row_count))
        mobilities = mobilities_at_start
        if is_exact:
            data = moved(pose)
            mobilities = [_mobility(data, rows, mechanism.row_count) for rows in equalities]
        for rows, mobility in zip(equalities, mobilities, strict=True):
            d = impedance_of(rows.solimp, math.hypot(*(rows.lengths * gap[rows.ideal]).tolist()))
            stiffness[rows.ideal], damping[rows.ideal] = rows.stiffness * d, rows.damping
            compliance += (1 - d) / d * mobility
        return RowRegularisation(stiffness, damping, compliance, initial_bias)

    return regularisation


def _mobility(data: Any, rows: _EqualityRows, count: int) -> Array:
    """The inverse inertia (count, count) of the mechanism's rows by MuJoCo's estimate, zero for other equalities."""
    diagonal, out = _diagonal(data, rows.equality), np.zeros((count, count))
    for of_mujoco, of_ideal, multiples in rows.blocks:
        # MuJoCo's rows are multiples of ours and satisfy R f = a_ref - a.
        inverse = multiples.T @ (multiples / diagonal[of_mujoco, None])
        out[np.ix_(rows.ideal[of_ideal], rows.ideal[of_ideal])] = np.linalg.inv(inverse)
    return out


def _equality_rows(planar: PlanarModel, equality: int, ideal: list[int], ours: Array, theirs: Array) -> _EqualityRows:
    """The rows of an equality; the rows for the point of a connect or a weld are along the world's axes."""
    rows, blocks, lengths = equality_rows(planar.data, equality), [], np.ones(len(ideal))
    holds_point = len(ideal) > 1
    if holds_point:
        blocks.append((slice(0, 3), slice(0, 2), planar.frame.both.T))
    if len(ideal) != 2:
        last, others = ours[ideal[-1]], slice(3 if holds_point else 0, len(rows))
        square = float(last @ last)
        multiple = theirs[rows[others]] @ last / square if square else np.ones(len(rows[others]))
        blocks.append((others, slice(len(ideal) - 1, len(ideal)), multiple[:, None]))
        lengths[-1] = np.linalg.norm(multiple)
    stiffness, damping, _ = (float(value) for value in planar.data.efc_KBIP[rows[0]][:3])
    solimp = planar.model.eq_solimp[equality]
    return _EqualityRows(equality, ideal, tuple(blocks), lengths, solimp, stiffness, damping)


def _diagonal(data: Any, equality: int) -> Array:
    rows = equality_rows(data, equality)
    impedance = data.efc_KBIP[rows, 2]
    return data.efc_R[rows] * impedance / (1 - impedance)


def impedance_of(solimp: Array, gap: float) -> float:
    """The impedance of a row at a gap [m or rad] for `solimp` (5,)."""
    *limits, width, middle, power = solimp.tolist()
    low, high = (min(max(value, MIN_IMPEDANCE), MAX_IMPEDANCE) for value in limits)
    part = min(gap / width, 1.0) if width > 0 else 1.0
    if power <= 1:
        rise = part
    elif part <= middle:
        rise = part**power / middle ** (power - 1)
    else:
        rise = 1 - (1 - part) ** power / (1 - middle) ** (power - 1)
    return low + rise * (high - low)


FLAGGED_ELEMENTS = ("contact", "limit", "frictionloss", "equality", "actuation", "spring", "damper", "gravity")
UNFLAGGED_ELEMENTS = ("armature", "fluid", "forcelimit", "sleep")
TIED_STEPS = 5.0  # Time constant of stiff loops in steps, as in the method TUNED.
DEFAULT_EQUALITY = ((0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0))  # MuJoCo's default solref and solimp.
STEP_COUNT, FURTHER_STEP_COUNT = 6, 11  # Numbers of step sizes that are tried, each half of the previous one.


def switch_off(model: Any, element: str) -> None:
    if element == "armature":
        model.dof_armature[:] = 0.0
    elif element == "forcelimit":
        for limited in (model.actuator_forcelimited, model.jnt_actfrclimited, model.tendon_actfrclimited):
            limited[:] = 0
    elif element == "sleep":
        model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    elif element == "fluid":
        model.opt.density = model.opt.viscosity = 0.0
    elif element in FLAGGED_ELEMENTS:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{element.upper()}"))
    else:
        raise ValueError(
            f"--without is {element!r}; it must be one of {', '.join((*FLAGGED_ELEMENTS, *UNFLAGGED_ELEMENTS))}"
        )


def tied_values(dt: float) -> dict[str, str]:
    return {"solref": f"{TIED_STEPS * dt:.9g} 1", "solimp": " ".join(f"{value:g}" for value in STIFFEST)}


def changes(
    model: Any, soft: bool, smallest: float, urdf: bool = False, classes: bool = False, further: bool = False
) -> list[Change]:
    """Changes to steps of at least `smallest` [s], with the model's integrator and with RK4.

    `soft`: whether the model has loops, for which a larger stiffness is also tried. `urdf`, `classes`: see `OwnMuJoCo`.
    `further`: whether to try even smaller steps.
    """
    own_step = float(model.opt.timestep)
    solref, solimp = DEFAULT_EQUALITY
    has_own_values = np.any(model.eq_solref != solref) or np.any(model.eq_solimp != solimp)
    integrators = list(dict.fromkeys([spelled(mujoco.mjtIntegrator(model.opt.integrator)), "RK4"]))
    out = []
    for tied in (False, True) if soft else (False,):
        for integrator in integrators:
            for halving in range(FURTHER_STEP_COUNT if further else STEP_COUNT):
                dt = own_step / 2**halving
                if dt < smallest:
                    break
                words = f"{integrator}, step {dt * 1e3:.4g} ms" + (", stiff loops" if tied else "")
                option = f'<option timestep="{dt!r}" integrator="{integrator}"/>'
                lines = [f"<mujoco>{option}</mujoco>" if urdf else option]
                if tied:
                    values = " ".join(f'{name}="{value}"' for name, value in tied_values(dt).items())
                    lines.append(f"<default><equality {values}/></default>")
                    if classes or has_own_values:
                        lines.append(
                            "<!-- an equality of a class, or with its own values, needs these values there -->"
                        )
                out.append(Change(words, dt, tuple(lines), (("integrator", integrator), ("tied", tied))))
    return out


Tag = tuple[tuple[str, ...], int, int]  # path of an element, and begin and end of its start tag


def rewritten(source: bytes, change: Change) -> bytes:
    """The file with other settings; included files are not changed. Raises Unsupported if the file is no XML."""
    options = dict(change.options)
    option = {"timestep": f"{change.dt!r}", "integrator": options["integrator"]}
    tags = _tags(source)
    root = tags[0]
    parent = root if root[0] == ("mujoco",) else next((tag for tag in tags if tag[0] == (root[0][0], "mujoco")), None)
    existing = [] if parent is None else [tag for tag in tags if tag[0] == (*parent[0], "option")]
    edits = [(begin, end, _with(source[begin:end], option)) for _, begin, end in existing]
    if not existing:
        element = b"<option " + b" ".join(f'{name}="{value}"'.encode() for name, value in option.items()) + b"/>"
        if parent is None:  # a URDF file without an element for MuJoCo
            end = source.rindex(b"</")
            edits.append((end, end, b"  <mujoco>" + element + b"</mujoco>\n"))
        elif source[parent[1] : parent[2]].endswith(b"/>"):
            edits.append((parent[1], parent[2], b"<mujoco>" + element + b"</mujoco>"))
        else:
            edits.append((parent[2], parent[2], b"\n  " + element))
    if options["tied"]:
        values = tied_values(change.dt)
        equalities = (tag for tag in tags if len(tag[0]) == 3 and tag[0][:2] == ("mujoco", "equality"))
        edits += [(begin, end, _with(source[begin:end], values)) for _, begin, end in equalities]
    for begin, end, text in sorted(edits, reverse=True):
        source = source[:begin] + text + source[end:]
    return source


def _tags(source: bytes) -> list[Tag]:
    parser, path, tags = expat.ParserCreate(), list[str](), list[Tag]()

    def on_start(name: str, attributes: dict[str, str]) -> None:
        path.append(name)
        begin = parser.CurrentByteIndex
        tag = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(source, begin)
        assert tag is not None
        tags.append((tuple(path), begin, tag.end()))

    parser.StartElementHandler = on_start
    parser.EndElementHandler = lambda name: path.pop()
    try:
        parser.Parse(source, True)
    except expat.ExpatError as error:  # MuJoCo's parser accepts more
        raise refuse("the file", f"it is not well-formed XML ({error}), so nothing can be written into it") from None
    return tags


def _with(tag: bytes, values: dict[str, str]) -> bytes:
    for name, value in values.items():
        attribute = f'{name}="{value}"'.encode()
        tag, count = re.subn(rf"(?<=\s){name}\s*=\s*(\"[^\"]*\"|'[^']*')".encode(), attribute, tag)
        if not count:
            tag = re.sub(rb"\s*(/?>)$", lambda end, attribute=attribute: b" " + attribute + end[1], tag)
    return tag
