"""Random models in MuJoCo's format, and their equations of motion at the start.

No adapter is used, so a finding is a fault of MuJoCo. A model is a planar tree of slides and hinges with `connect`,
`weld`, `joint` and `tendon` equalities. The equations are written in the coordinates of the tree. Complex steps give
derivatives without truncation error. Only the compliance (`efc_R`) of the constraints comes from MuJoCo.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from engines.constrained import constrained
from reference.checks import InvalidMechanism
from reports.search.parts import Integers, ladder
from reports.search.recipe import DEPENDENCE_LIMIT, MOTION_ROUNDING

Array = NDArray[np.float64]
Numbers = Any  # an array, real or complex

# The kind "gear" is a linear joint equality, and the kinds "joint" and "tendon" are quadratic.
EQUALITY_KINDS = ("connect", "weld", "gear", "joint", "tendon")
HINGED_KINDS = ("connect", "weld", "gear")
RAW_BODIES, RAW_EQUALITIES = 9, 3
DERIVATIVE_STEP = 1e-30  # imaginary step of a derivative


@dataclass(frozen=True)
class RawBody:
    """A body of a model, described by integers.

    `parent`: number of an earlier body, or 0 for the world. `offset`: position in the parent's frame, in tenths of a
    metre. `angle`: angle relative to the parent, in steps of 0.3 rad. `slides`: number of slides along the axes x and y
    of the body's frame. `turns`: whether the body has a hinge at the origin of its frame. `centre`: position of the
    centre of mass, in tenths of a metre. `mass`, `inertia`: mass and moment of inertia about the centre as steps of
    `parts.ladder`. `velocity`: rates of both slides in steps of 0.5 m/s, and of the hinge in steps of 0.5 rad/s.
    """

    parent: int = 0
    offset: tuple[int, int] = (0, 0)
    angle: int = 0
    slides: int = 0
    turns: bool = True
    centre: tuple[int, int] = (0, 0)
    mass: int = 0
    inertia: int = 0
    velocity: tuple[int, int, int] = (0, 0, 0)

    @property
    def rates(self) -> dict[str, float]:
        """The velocity of each coordinate [m/s, rad/s]."""
        names = [*("slide 0", "slide 1")[: self.slides], *(["hinge"] if self.turns else [])]
        return {name: self.velocity[("slide 0", "slide 1", "hinge").index(name)] / 2 for name in names}


@dataclass(frozen=True)
class Equality:
    """An equality constraint of a model, described by integers.

    `first`, `second`: numbers of the bodies. With "connect" and "weld", `second` may be the world, 0. Other kinds
    couple the last coordinates of both bodies. `at`: anchor of a "connect" in the first body's frame, in tenths of a
    metre. `curve`: integers (a, b) of the condition first = a/2 second + b/2 second^2 for both coordinates or tendons.
    A tendon is the sum of a coordinate and the previous coordinate.
    """

    kind: str
    first: int
    second: int
    at: tuple[int, int] = (0, 0)
    curve: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class RawModel:
    """A model, described by integers. `gravity` is in m/s^2. `sparse`: whether MuJoCo uses a sparse Jacobian."""

    parts: tuple[RawBody, ...]
    links: tuple[Equality, ...]
    gravity: tuple[int, int] = (0, 0)
    sparse: bool = False

    @property
    def kinds(self) -> tuple[str, ...]:
        return tuple(kind for kind in EQUALITY_KINDS if any(link.kind == kind for link in self.links))


def coordinates(model: RawModel) -> list[tuple[int, str]]:
    """The coordinates in MuJoCo's depth-first order, as pairs of a body's number and "slide 0", "slide 1" or
    "hinge"."""

    def below(body: int) -> list[tuple[int, str]]:
        mine = [(body, name) for name in model.parts[body - 1].rates] if body else []
        children = [child for child, part in enumerate(model.parts, start=1) if part.parent == body]
        return mine + [coordinate for child in children for coordinate in below(child)]

    return below(0)


def coupled_coordinates(model: RawModel, link: Equality) -> tuple[list[int], list[int]]:
    """Indices of two sets of coordinates; an equality couples their sums. Raises InvalidMechanism for a body without
    coordinates."""
    bodies = [body for body, _ in coordinates(model)]
    if link.first == link.second or not {link.first, link.second} <= {*bodies}:
        raise InvalidMechanism(f"model: bodies {link.first} and {link.second} have no coordinates to couple")
    first, second = (len(bodies) - 1 - bodies[::-1].index(body) for body in (link.first, link.second))
    if link.kind != "tendon":
        return [first], [second]
    return [*range(max(first - 1, 0), first + 1)], [*range(max(second - 1, 0), second + 1)]


def to_mjcf(model: RawModel) -> str:
    """The model in MuJoCo's format, version 3.6 and later."""

    def text(*values: float) -> str:
        return " ".join(f"{value:.12g}" for value in values)

    root = ET.Element("mujoco")
    ET.SubElement(root, "compiler", angle="radian")
    jacobian = "sparse" if model.sparse else "dense"
    ET.SubElement(root, "option", gravity=text(*model.gravity, 0), jacobian=jacobian, tolerance="1e-20")
    elements = [ET.SubElement(root, "worldbody")]
    for number, part in enumerate(model.parts, start=1):
        position, turn = text(*np.divide(part.offset, 10), 0), text(0, 0, 1, part.angle * 0.3)
        body = ET.SubElement(elements[part.parent], "body", name=f"b{number}", pos=position, axisangle=turn)
        elements.append(body)
        for name in part.rates:
            axis = {"slide 0": "1 0 0", "slide 1": "0 1 0", "hinge": "0 0 1"}[name]
            ET.SubElement(body, "joint", name=f"b{number} {name}", type=name.split()[0], axis=axis)
        mass, spin = text(float(ladder(part.mass))), text(*[float(ladder(part.inertia))] * 3)
        ET.SubElement(body, "inertial", pos=text(*np.divide(part.centre, 10), 0), mass=mass, diaginertia=spin)
    tendons, equalities = ET.SubElement(root, "tendon"), ET.SubElement(root, "equality")
    names = [f"b{body} {name}" for body, name in coordinates(model)]
    for number, link in enumerate(model.links):
        if link.kind in ("connect", "weld"):
            ends = {"body1": f"b{link.first}"} | ({"body2": f"b{link.second}"} if link.second else {})
            anchor = {"anchor": text(*np.divide(link.at, 10), 0)} if link.kind == "connect" else {}
            ET.SubElement(equalities, link.kind, ends | anchor)
            continue
        curve, pair = text(0, link.curve[0] / 2, link.curve[1] / 2, 0, 0), coupled_coordinates(model, link)
        if link.kind == "tendon":
            for side, summed in zip(("first", "second"), pair, strict=True):
                tendon = ET.SubElement(tendons, "fixed", name=f"t{number} {side}")
                for coordinate in summed:
                    ET.SubElement(tendon, "joint", joint=names[coordinate], coef="1")
            ends = {"tendon1": f"t{number} first", "tendon2": f"t{number} second"}
            ET.SubElement(equalities, "tendon", ends, polycoef=curve)
        else:
            ends = {"joint1": names[pair[0][0]], "joint2": names[pair[1][0]]}
            ET.SubElement(equalities, "joint", ends, polycoef=curve)
    for empty in [group for group in (tendons, equalities) if not len(group)]:
        root.remove(empty)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")


def _turned(angle: Any, vector: Any) -> Numbers:
    return np.array(
        [np.cos(angle) * vector[0] - np.sin(angle) * vector[1], np.sin(angle) * vector[0] + np.cos(angle) * vector[1]]
    )


def _across(vector: Numbers) -> Numbers:
    return np.array([-vector[1], vector[0]])


Frame = tuple[Numbers, Any, Numbers, Any]  # position (2,) [m], angle [rad], and the rates of both


def _frames(model: RawModel, q: Numbers, v: Numbers) -> list[Frame]:
    """The frames of the world and of each body at coordinates q (coordinates,) with rates v."""
    values = {name: (q[number], v[number]) for number, name in enumerate(coordinates(model))}
    frames: list[Frame] = [(np.zeros(2), 0.0, np.zeros(2), 0.0)]
    for number, part in enumerate(model.parts, start=1):
        position, angle, speed, rate = frames[part.parent]
        angle = angle + part.angle * 0.3
        slides = [values.get((number, name), (0.0, 0.0)) for name in ("slide 0", "slide 1")]
        hinge = values.get((number, "hinge"), (0.0, 0.0))
        arm = _turned(angle - part.angle * 0.3, np.divide(part.offset, 10)) + _turned(angle, [s for s, _ in slides])
        speed = speed + rate * _across(arm) + _turned(angle, [ds for _, ds in slides])
        frames.append((position + arm, angle + hinge[0], speed, rate + hinge[1]))
    return frames


def _velocities(model: RawModel, q: Numbers, v: Numbers) -> Numbers:
    out = []
    for part, (_, angle, speed, rate) in zip(model.parts, _frames(model, q, v)[1:], strict=True):
        out += [*(speed + rate * _across(_turned(angle, np.divide(part.centre, 10)))), rate]
    return np.array(out)


def _slips(model: RawModel, q: Numbers, v: Numbers) -> list[Numbers]:
    """The velocity error (rows,) of each equality. Anchors are defined at the start, where q is 0."""
    start_frames, frames = _frames(model, 0.0 * q.real, 0.0 * q.real), _frames(model, q, v)
    out: list[Numbers] = []
    for link in model.links:
        if link.kind in ("connect", "weld"):
            if not 0 < link.first < len(frames) or not 0 <= link.second < len(frames) or link.first == link.second:
                raise InvalidMechanism(f"model: an equality joins bodies {link.first} and {link.second}")
            anchor = _turned(start_frames[link.first][1], np.divide(link.at, 10)) + start_frames[link.first][0]
            speeds = []
            for body in (link.first, link.second):
                _, angle, speed, rate = frames[body]
                arm = _turned(angle - start_frames[body][1], anchor - start_frames[body][0])
                speeds.append([*(speed + rate * _across(arm)), rate][: 2 if link.kind == "connect" else 3])
            out.append(np.subtract(*speeds))
        else:
            first, second = coupled_coordinates(model, link)
            slope, bend = link.curve[0] / 2, link.curve[1]  # the second derivative is twice the quadratic coefficient
            along = slope + bend * q[second].sum()
            out.append(np.array([v[first].sum() - along * v[second].sum()]))
    return out


@dataclass(frozen=True, eq=False)
class StartEquations:
    """The equations of motion of a model at the start. `root` (coordinates, coordinates): a root S of the mass matrix
    S^T S. `free`: the product of S and the accelerations without equalities. `rows`: the Jacobian J of each equality.
    `right`: the product of J and the accelerations. `bent`: the part of `right` that comes from the curve of an
    equality. `rates` (coordinates,): velocities that satisfy the equalities."""

    root: Array
    free: Array
    rows: tuple[Array, ...]
    right: tuple[Array, ...]
    bent: tuple[Array, ...]
    rates: Array

    def expected(self, give: Array, bent: bool = True) -> Array:
        """Accelerations of the coordinates. `give` (rows, any): compliance of the equalities' rows. bent: whether to
        include the velocity term of curved equalities, which MuJoCo up to 4.0.1 omits."""
        rows: Any = np.linalg.solve(self.root.T, np.vstack([np.zeros((0, len(self.free))), *self.rows]).T).T
        right = [item if bent else item - curve for item, curve in zip(self.right, self.bent, strict=True)]
        law = constrained(rows, np.concatenate([[], *right]), np.ones(len(self.free)), self.free, give)
        return np.asarray(np.linalg.solve(self.root, law.motion), dtype=np.float64)


@lru_cache(maxsize=4)  # a model is drawn, compared and run in succession
def start_equations(model: RawModel) -> StartEquations:
    """The equations of a model. Raises InvalidMechanism for nearly dependent rows or if a body is joined to itself."""
    order = coordinates(model)
    count, zeros = len(order), np.zeros(len(order))
    slips = [_slips(model, zeros, unit) for unit in np.eye(count)]
    rows = tuple(np.array([slip[number] for slip in slips]).T for number in range(len(model.links)))
    rates = np.array([model.parts[body - 1].rates[name] for body, name in order])
    if rows:
        all_rows = np.vstack(rows)
        sizes = np.linalg.svd(all_rows, compute_uv=False)
        if len(all_rows) > count or not sizes[-1] > DEPENDENCE_LIMIT * sizes[0]:
            raise InvalidMechanism("model: a row of an equality is zero, or the equalities' rows are nearly dependent")
        wanted, inverse = rates, np.linalg.pinv(all_rows)
        for _ in range(2):  # the second pass corrects the rounding of the first
            rates = rates - inverse @ (all_rows @ rates)
        if np.abs(rates).max(initial=0.0) <= MOTION_ROUNDING * np.abs(wanted).max(initial=0.0):
            rates = np.zeros(count)
    ahead = 1j * DERIVATIVE_STEP * rates
    change = _velocities(model, ahead, rates).imag / DERIVATIVE_STEP
    right = tuple(-slip.imag / DERIVATIVE_STEP for slip in _slips(model, ahead, rates))
    bent = tuple(
        np.zeros_like(item) if link.kind in HINGED_KINDS else item
        for link, item in zip(model.links, right, strict=True)
    )
    directions = np.array([_velocities(model, zeros, unit) for unit in np.eye(count)]).T.reshape(-1, count)
    weights = np.sqrt([w for p in model.parts for w in (*[float(ladder(p.mass))] * 2, float(ladder(p.inertia)))])
    orthogonal, root = np.linalg.qr(weights[:, None] * directions)
    free = orthogonal.T @ (weights * (np.tile([*model.gravity, 0.0], len(model.parts)) - change))
    return StartEquations(root, free, rows, right, bent, rates)


def draw_model(seed: int, number: int, kinds: tuple[str, ...]) -> RawModel:
    """Case `number` of a seed with equalities of these kinds. The case is the same on every machine. No body has slides
    if all kinds are among HINGED_KINDS."""
    random = Integers([seed, number, len(kinds)])
    while True:
        candidate = _draw_once(random, kinds)
        if candidate.links and (any(candidate.gravity) or start_equations(candidate).rates.any()):
            return candidate


def _draw_once(random: Integers, kinds: tuple[str, ...]) -> RawModel:
    whole, two = random.whole, random.two
    count, hinged, moving = whole(2, RAW_BODIES), {*kinds} <= {*HINGED_KINDS}, whole(1, 4) > 1
    parts = []
    for index in range(count):
        slides = 0 if hinged else (0, 0, 1, 2)[whole(0, 3)]
        part = RawBody(
            # few bodies are children of the world
            parent=whole(0, index) if whole(1, 4) == 1 else whole(min(1, index), index),
            offset=two(8),
            angle=whole(-10, 10),
            slides=slides,
            turns=slides != 1 or whole(0, 1) == 1,
            centre=two(4),
            mass=whole(-3, 3),
            inertia=whole(-6, 0),
            velocity=(*two(4), whole(-6, 6)) if moving else (0, 0, 0),
        )
        parts.append(part)
    out = RawModel(tuple(parts), (), two(10), sparse=whole(0, 1) == 1)
    for _ in range(whole(1, RAW_EQUALITIES)):
        kind = kinds[whole(0, len(kinds) - 1)]
        first, second = whole(1, count), whole(0 if kind in ("connect", "weld") else 1, count)
        at, curve = two(6) if kind == "connect" else (0, 0), (0, 0)
        if kind not in ("connect", "weld"):
            slope, bend = two(4)
            curve = (slope, 0 if kind == "gear" else bend)
        extended = replace(out, links=(*out.links, Equality(kind, first, second, at, curve)))
        try:
            start_equations(extended)
        except InvalidMechanism:
            continue
        out = extended
    return out
