"""How the loops of a user's model give way, as MuJoCo declares it, and what can be changed in the model and its file.

A row obeys a + b v + k d r = -R f. R is (1 - d) / d times a diagonal for the inverse inertia, and the impedance d grows
with the gap ("Computation: Constraint model" and "Modeling: Solver parameters" in MuJoCo's documentation).
"""

from __future__ import annotations

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
LEAST_IMPEDANCE, MOST_IMPEDANCE = 1e-4, 0.9999  # mjMINIMP and mjMAXIMP


@dataclass(frozen=True, eq=False)
class _Held:
    """An equality, and the indices `places` of its ideal rows. `blocks`: the MuJoCo rows (slice) that are multiples
    (rows, places) of some of the ideal ones (slice); `factors` (places,): the lengths of these multiples.
    """

    equality: int
    places: list[int]
    blocks: tuple[tuple[slice, slice, Array], ...]
    factors: Array
    shape: Array  # solimp (5,)
    stiffness: float
    damping: float


def declared(
    scene: PlanarModel, mechanism: Mechanism, directions: Array, drift: Array, moved: Callable[[Array], Any]
) -> Callable[[Array, Array], RowRegularisation]:
    """How each row gives way at a gap (rows,) [m, rad] and a pose (bodies, 3).

    directions (3 bodies, nv): how MuJoCo's coordinates move the bodies at the start, where its rows are compared with
    the mechanism's: a row that is a multiple of ours has a compliance of another size. drift (3 bodies,): the bodies'
    accelerations there with MuJoCo's coordinates at a steady rate: an equality of a tendon, which has no term of
    velocities (up to 4.0.1), holds these steady. moved: returns a mujoco.MjData at a pose, after mj_fwdPosition; used
    with the flag `diagexact` alone, whose diagonal is that of the pose. Without it the diagonal is an estimate of
    the compiler's, the same at all poses.
    """
    begin = np.cumsum([0, *(joint.size for joint in mechanism.joints)])
    places = {joint.name: list(range(at, at + joint.size)) for joint, at in zip(mechanism.joints, begin, strict=False)}
    rows, instead = mechanism.rows(mechanism.pose), np.full(mechanism.row_count, np.nan)
    for joint in mechanism.joints:
        if isinstance(joint, Rod):
            instead[places[joint.name]] = rows[places[joint.name]] @ drift
    ours, theirs = rows @ directions, jacobian(scene.model, scene.data)
    held = [
        _held(scene, index, [place for joint in joints for place in places[joint.name]], ours, theirs)
        for index, joints in scene.held.items()
        if joints and len(equality_rows(scene.data, index))
    ]
    is_exact = bool(scene.model.opt.enableflags & int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT))

    def give(gap: Array, pose: Array) -> RowRegularisation:
        stiffness, damping = np.zeros((2, mechanism.row_count))
        compliance = np.zeros((mechanism.row_count, mechanism.row_count))
        data = moved(pose) if is_exact else scene.data
        for one in held:
            d = impedance_of(one.shape, float(np.linalg.norm(one.factors * gap[one.places])))
            stiffness[one.places], damping[one.places] = one.stiffness * d, one.damping
            diagonal = _diagonal(data, one.equality)
            for of_mujoco, which, multiples in one.blocks:
                # R f = a_ref - a in MuJoCo's rows, which are these multiples of ours.
                stiff = multiples.T @ (multiples / diagonal[of_mujoco, None])
                compliance[np.ix_(one.places[which], one.places[which])] = (1 - d) / d * np.linalg.inv(stiff)
        return RowRegularisation(stiffness, damping, compliance, instead)

    return give


def _held(scene: PlanarModel, equality: int, places: list[int], ours: Array, theirs: Array) -> _Held:
    rows, blocks, factors = equality_rows(scene.data, equality), [], np.ones(len(places))
    if len(places) > 1:  # a connect, or the first rows of a weld: along the axes of the world
        blocks.append((slice(0, 3), slice(0, 2), scene.frame.both.T))
    if len(places) != 2:
        own, turning = ours[places[-1]], slice(3 if len(places) > 1 else 0, len(rows))
        length = float(own @ own)
        multiple = theirs[rows[turning]] @ own / length if length else np.ones(len(rows[turning]))
        blocks.append((turning, slice(len(places) - 1, len(places)), multiple[:, None]))
        factors[-1] = np.linalg.norm(multiple)
    stiffness, damping, _ = (float(value) for value in scene.data.efc_KBIP[rows[0]][:3])
    return _Held(equality, places, tuple(blocks), factors, scene.model.eq_solimp[equality], stiffness, damping)


def _diagonal(data: Any, equality: int) -> Array:
    """The diagonal (rows,) that stands for the inverse inertia in the rows of an equality."""
    rows = equality_rows(data, equality)
    impedance = data.efc_KBIP[rows, 2]
    return data.efc_R[rows] * impedance / (1 - impedance)


def impedance_of(shape: Array, gap: float) -> float:
    """The impedance of a row that is open by this [m or rad], for a solimp (5,)."""
    low, high = (float(np.clip(value, LEAST_IMPEDANCE, MOST_IMPEDANCE)) for value in shape[:2])
    width, middle, power = (float(value) for value in shape[2:5])
    part = min(gap / width, 1.0) if width > 0 else 1.0
    if power <= 1:
        rise = part
    elif part <= middle:
        rise = part**power / middle ** (power - 1)
    else:
        rise = 1 - (1 - part) ** power / (1 - middle) ** (power - 1)
    return low + rise * (high - low)


# The kinds of elements that a flag of MuJoCo's switches off, and those that none does.
ELEMENTS = ("contact", "limit", "frictionloss", "equality", "actuation", "spring", "damper", "gravity")
OTHERS = ("armature", "fluid", "forcelimit", "sleep")
TIED_STEPS = 5.0  # time constant of the stiffer loops, in steps: the same rule as the tuned variant's
SHIPPED = ((0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0))  # solref and solimp of an equality about which nothing is said
HALVINGS, FURTHER = 6, 11  # how many steps are tried, each half of the one before


def switch_off(model: Any, element: str) -> None:
    """Change a model so that this kind of element no longer acts. Raises ValueError for a word that is none."""
    if element == "armature":
        model.dof_armature[:] = 0.0
    elif element == "forcelimit":
        for limited in (model.actuator_forcelimited, model.jnt_actfrclimited, model.tendon_actfrclimited):
            limited[:] = 0
    elif element == "sleep":
        model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    elif element == "fluid":
        model.opt.density = model.opt.viscosity = 0.0
    elif element in ELEMENTS:
        model.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{element.upper()}"))
    else:
        raise ValueError(f"--without is {element!r}; it must be one of {', '.join((*ELEMENTS, *OTHERS))}")


def tied_values(dt: float) -> dict[str, str]:
    """solref and solimp of loops that are as stiff as a step [s] bears."""
    return {"solref": f"{TIED_STEPS * dt:.9g} 1", "solimp": " ".join(f"{value:g}" for value in STIFFEST)}


def changes(
    model: Any, soft: bool, smallest: float, urdf: bool = False, classes: bool = False, further: bool = False
) -> list[Change]:
    """Steps down to `smallest` [s], by the model's own integrator and RK4; `soft`: loops as they are, and stiffer.

    `urdf`: the lines to copy bring the element in which a URDF file holds MuJoCo's options. `classes`: the
    file has classes, which have copied what their parent had before. `further`: more halvings.
    """
    own_step = float(model.opt.timestep)
    by_hand = np.any(model.eq_solref != SHIPPED[0]) or np.any(model.eq_solimp != SHIPPED[1])  # a default can't reach it
    integrators = list(dict.fromkeys([spelled(mujoco.mjtIntegrator(model.opt.integrator)), "RK4"]))
    out = []
    for tied in (False, True) if soft else (False,):
        for integrator in integrators:
            for halving in range(FURTHER if further else HALVINGS):
                dt = own_step / 2**halving
                if dt < smallest:
                    break
                words = f"{integrator}, step {dt * 1e3:.4g} ms" + (", stiff loops" if tied else "")
                option = f'<option timestep="{dt!r}" integrator="{integrator}"/>'
                lines = [f"<mujoco>{option}</mujoco>" if urdf else option]
                if tied:
                    values = " ".join(f'{name}="{value}"' for name, value in tied_values(dt).items())
                    lines.append(f"<default><equality {values}/></default>")
                    if classes or by_hand:
                        lines.append(
                            "<!-- an equality of a class, or with its own values, needs these values there -->"
                        )
                out.append(Change(words, dt, tuple(lines), (("integrator", integrator), ("tied", tied))))
    return out


Tag = tuple[tuple[str, ...], int, int]  # the path of an element, and where its start tag begins and ends


def rewritten(source: bytes, change: Change) -> bytes:
    """The file with these settings. What an included file says is out of reach. Raises Unsupported if it is no XML."""
    options = dict(change.options)
    option = {"timestep": f"{change.dt!r}", "integrator": options["integrator"]}
    tags = _tags(source)
    root = tags[0]
    home = root if root[0] == ("mujoco",) else next((tag for tag in tags if tag[0] == (root[0][0], "mujoco")), None)
    there = [] if home is None else [tag for tag in tags if tag[0] == (*home[0], "option")]
    edits = [(begin, end, _with(source[begin:end], option)) for _, begin, end in there]
    if not there:
        words = b"<option " + b" ".join(f'{name}="{value}"'.encode() for name, value in option.items()) + b"/>"
        if home is None:  # a URDF file without an element of MuJoCo's
            end = source.rindex(b"</")
            edits.append((end, end, b"  <mujoco>" + words + b"</mujoco>\n"))
        elif source[home[1] : home[2]].endswith(b"/>"):
            edits.append((home[1], home[2], b"<mujoco>" + words + b"</mujoco>"))
        else:
            edits.append((home[2], home[2], b"\n  " + words))
    if options["tied"]:
        values = tied_values(change.dt)
        held = (tag for tag in tags if len(tag[0]) == 3 and tag[0][:2] == ("mujoco", "equality"))
        edits += [(begin, end, _with(source[begin:end], values)) for _, begin, end in held]
    for begin, end, text in sorted(edits, reverse=True):
        source = source[:begin] + text + source[end:]
    return source


def _tags(source: bytes) -> list[Tag]:
    """Every element, in the order of the file."""
    parser, path, found = expat.ParserCreate(), list[str](), list[Tag]()

    def begins(name: str, attributes: dict[str, str]) -> None:
        path.append(name)
        begin = parser.CurrentByteIndex
        tag = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(source, begin)
        assert tag is not None
        found.append((tuple(path), begin, tag.end()))

    parser.StartElementHandler = begins
    parser.EndElementHandler = lambda name: path.pop()
    try:
        parser.Parse(source, True)
    except expat.ExpatError as error:  # MuJoCo's own reader forgives more
        raise refuse("the file", f"it is not well-formed XML ({error}), so nothing can be written into it") from None
    return found


def _with(tag: bytes, values: dict[str, str]) -> bytes:
    """A start tag with these attributes."""
    for name, value in values.items():
        attribute = f'{name}="{value}"'.encode()
        tag, count = re.subn(rf"(?<=\s){name}\s*=\s*(\"[^\"]*\"|'[^']*')".encode(), attribute, tag)
        if not count:
            tag = re.sub(rb"\s*(/?>)$", lambda end, own=attribute: b" " + own + end[1], tag)
    return tag
