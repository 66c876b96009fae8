"""MuJoCo alone, on models in its own XML that the search writes: the accelerations that it gives, against the law.

No adapter of ours takes part, so that what is found is MuJoCo's own, in whatever release is imported. A model is a tree
of slides and hinges in the plane; `connect`, `weld`, `joint` and `tendon` equalities close it. The judge describes the
bodies by pins, slots and drives, and takes from MuJoCo nothing but how far each constraint gives way (`efc_R`).
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.constrained import constrained
from reference.checks import InvalidMechanism
from reference.joints import Drive, Joint, Pin, Slot
from reference.mechanism import Body, Mechanism
from reports.search.parts import ladder
from reports.search.recipe import LEAST_RANK, NO_MOTION

Array = NDArray[np.float64]

# "gear": a joint equality that is a straight line; "joint" and "tendon" are curved.
KINDS = ("connect", "weld", "gear", "joint", "tendon")


@dataclass(frozen=True)
class RawBody:
    """A body. `parent`: 0 is the world, 1 the first body. `offset`: tenths of a metre in the parent's frame; `angle` in
    steps of 0.3 rad against it. It has so many `slides` (0 to 2: along the x and y of its own frame as it starts) and
    then, if it `turns`, a hinge at its frame's origin. `centre`: its centre of mass in tenths of a metre; `mass` and
    `inertia` (about the centre) on the ladder of `recipe`. `velocity`: of its slides and hinge, in halves per second.
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


@dataclass(frozen=True)
class Equality:
    """`first` and `second`: bodies (0: the world, the second's alone), or for the other kinds coordinates from 0.

    `anchor` of a connect: tenths of a metre in the first body's frame. `curve`: slope and curvature, in halves, of the
    first coordinate or tendon as a function of the second. A tendon is the sum of a coordinate and the one before it.
    """

    kind: str
    first: int
    second: int
    anchor: tuple[int, int] = (0, 0)
    curve: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Model:
    """`gravity` in m/s^2; `sparse`: which Jacobian MuJoCo is told to use."""

    links: tuple[RawBody, ...]
    equalities: tuple[Equality, ...]
    gravity: tuple[int, int] = (0, 0)
    sparse: bool = False

    @property
    def kinds(self) -> tuple[str, ...]:
        return tuple(kind for kind in KINDS if any(each.kind == kind for each in self.equalities))


def coordinates(model: Model) -> list[tuple[int, str]]:
    """(body from 1, 'slide 0', 'slide 1' or 'hinge') of each, as MuJoCo orders them: depth first."""
    children: dict[int, list[int]] = {}
    for body, link in enumerate(model.links, start=1):
        children.setdefault(link.parent, []).append(body)

    def below(body: int) -> list[tuple[int, str]]:
        own = [(body, f"slide {number}") for number in range(model.links[body - 1].slides)] if body else []
        own += [(body, "hinge")] if body and model.links[body - 1].turns else []
        return own + [each for child in children.get(body, ()) for each in below(child)]

    return below(0)


def xml(model: Model) -> str:
    """The model in MuJoCo's format, version 3.6 and later."""

    def number(value: float) -> str:
        return f"{value:.12g}"

    def body(index: int, depth: int) -> list[str]:
        link, pad = model.links[index - 1], "  " * depth
        out = [
            f'{pad}<body name="b{index}" pos="{number(link.offset[0] / 10)} {number(link.offset[1] / 10)} 0" '
            f'axisangle="0 0 1 {number(link.angle * 0.3)}">'
        ]
        for slide in range(link.slides):
            out.append(f'{pad}  <joint name="b{index} slide {slide}" type="slide" axis="{("1 0 0", "0 1 0")[slide]}"/>')
        if link.turns:
            out.append(f'{pad}  <joint name="b{index} hinge" type="hinge" axis="0 0 1"/>')
        spin = number(float(ladder(link.inertia)))
        x, y = link.centre
        out.append(
            f'{pad}  <inertial pos="{number(x / 10)} {number(y / 10)} 0" mass="{number(float(ladder(link.mass)))}" '
            f'diaginertia="{spin} {spin} {spin}"/>'
        )
        for child, other in enumerate(model.links, start=1):
            if other.parent == index:
                out += body(child, depth + 1)
        return [*out, f"{pad}</body>"]

    names = [f"b{index} {what}" for index, what in coordinates(model)]
    bodies = [line for index, link in enumerate(model.links, 1) if not link.parent for line in body(index, 2)]
    tendons, equalities = [], []
    for count, each in enumerate(model.equalities):
        slope, bend = (number(value / 2) for value in each.curve)
        curve = f'polycoef="0 {slope} {bend} 0 0"'
        if each.kind == "connect":
            anchor = " ".join(number(value / 10) for value in each.anchor)
            other = f'body2="b{each.second}" ' if each.second else ""
            equalities.append(f'<connect body1="b{each.first}" {other}anchor="{anchor} 0"/>')
        elif each.kind == "weld":
            other = f'body2="b{each.second}"' if each.second else ""
            equalities.append(f'<weld body1="b{each.first}" {other}/>')
        elif each.kind in ("gear", "joint"):
            equalities.append(f'<joint joint1="{names[each.first]}" joint2="{names[each.second]}" {curve}/>')
        else:
            for side, which in (("first", each.first), ("second", each.second)):
                wraps = "".join(f'<joint joint="{names[one]}" coef="1"/>' for one in wrapped(which))
                tendons.append(f'<fixed name="t{count} {side}">{wraps}</fixed>')
            equalities.append(f'<tendon tendon1="t{count} first" tendon2="t{count} second" {curve}/>')
    x, y = model.gravity
    parts = [
        '<mujoco><compiler angle="radian"/>',
        f'<option gravity="{x} {y} 0" jacobian="{"sparse" if model.sparse else "dense"}" tolerance="1e-20"/>',
        "<worldbody>",
        *bodies,
        "</worldbody>",
        *([] if not tendons else ["<tendon>", *(f"  {line}" for line in tendons), "</tendon>"]),
        *([] if not equalities else ["<equality>", *(f"  {line}" for line in equalities), "</equality>"]),
        "</mujoco>",
    ]
    return "\n".join(parts)


def wrapped(coordinate: int) -> tuple[int, ...]:
    """The coordinates whose sum the tendon of a coordinate is."""
    return (coordinate - 1, coordinate) if coordinate else (0,)


def as_text(model: Model) -> str:
    """JSON."""
    return json.dumps(asdict(model), sort_keys=True)


def from_text(text: str) -> Model:
    """What `as_text` wrote. Raises ValueError for other text."""
    try:
        told = json.loads(text)

        def plain(values: dict[str, Any]) -> dict[str, Any]:
            return {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}

        links = tuple(RawBody(**plain(each)) for each in told.pop("links"))
        equalities = tuple(Equality(**plain(each)) for each in told.pop("equalities"))
        return Model(links, equalities, **plain(told))
    except (TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"model: this is no model ({error}); it must be what `as_text` writes") from None


@dataclass(frozen=True, eq=False)
class IdealModel:
    """A model as the judge sees it: rows of the tree, of the coordinates, and of each equality; all (rows, 3 bodies).

    `right` are the values of J a of each, and `bent` what the curve of an equality adds to its own; `rates`
    (coordinates,) a motion that the equalities allow.
    """

    mechanism: Mechanism
    tree: tuple[Array, Array]
    own: tuple[Array, Array]
    equalities: tuple[tuple[Array, Array], ...]
    bent: tuple[float, ...]
    rates: Array

    @property
    def directions(self) -> Array:
        """Twists (3 bodies, coordinates) of the coordinates' unit velocities."""
        held = len(self.tree[0])
        return np.asarray(np.linalg.inv(np.vstack([self.tree[0], self.own[0]]))[:, held:], dtype=np.float64)

    def expected(self, give: Array, bent: bool = True) -> Array:
        """Accelerations of the coordinates, where the equalities' rows give way (rows, any) to their forces.

        Without `bent` those of MuJoCo up to 4.0.1, which leaves out the velocity term of curved equalities.
        """
        rows = np.vstack([self.tree[0], *(rows for rows, _ in self.equalities)])
        added = zip(self.equalities, self.bent, strict=True)
        right = np.concatenate([self.tree[1], *(right if bent else right - more for (_, right), more in added)])
        soft = np.vstack([np.zeros((len(self.tree[0]), give.shape[1])), give])
        law = constrained(rows, right, self.mechanism.inertias, self.mechanism.free_fall, soft)
        return self.own[0] @ law.motion.reshape(-1) - self.own[1]


@lru_cache(maxsize=4)  # the same model is drawn, judged, and asked of MuJoCo
def judged(model: Model) -> IdealModel:
    """Raises InvalidMechanism where rows are nearly dependent, or something is joined with itself."""
    frames: list[tuple[float, float, float]] = [(0.0, 0.0, 0.0)]
    bodies, tree = [], []
    own: dict[tuple[int, str], Joint] = {}

    def placed(frame: tuple[float, float, float], x: float, y: float) -> tuple[float, float]:
        cosine, sine = math.cos(frame[2]), math.sin(frame[2])
        return frame[0] + cosine * x - sine * y, frame[1] + sine * x + cosine * y

    for index, link in enumerate(model.links, start=1):
        base, parent = frames[link.parent], f"b{link.parent}" if link.parent else None
        at = placed(base, link.offset[0] / 10, link.offset[1] / 10)
        frame = (*at, base[2] + link.angle * 0.3)
        frames.append(frame)
        centre = (link.centre[0] / 10, link.centre[1] / 10)
        name, origin = f"b{index}", (-centre[0], -centre[1])
        bodies.append(
            Body(name, float(ladder(link.mass)), float(ladder(link.inertia)), (*placed(frame, *centre), frame[2]))
        )
        arm = (link.offset[0] / 10, link.offset[1] / 10)
        if link.parent:
            before = model.links[link.parent - 1].centre
            arm = (arm[0] - before[0] / 10, arm[1] - before[1] / 10)
        for slide in range(link.slides):  # the coordinate is the distance across a line a quarter turn before it
            line = link.angle * 0.3 + slide * math.pi / 2 - math.pi / 2
            own[index, f"slide {slide}"] = Slot(f"{name} slide {slide}", parent, name, arm, line, origin)
        if link.turns:
            own[index, "hinge"] = Drive(f"{name} hinge", parent, name, 0.0, link.angle * 0.3)
        else:
            tree.append(Drive(f"{name} angle", parent, name, 0.0, link.angle * 0.3))
        if link.slides == 0:
            tree.append(Pin(f"{name} pin", parent, name, arm, origin))
        elif link.slides == 1:
            tree.append(Slot(f"{name} line", parent, name, arm, link.angle * 0.3, origin))

    loops: list[Joint] = []
    for number, each in enumerate(model.equalities):
        if each.kind in ("connect", "weld"):
            if not 0 < each.first <= len(bodies) or not 0 <= each.second <= len(bodies) or each.first == each.second:
                raise InvalidMechanism(f"model: equality {number} joins bodies {each.first} and {each.second}")
            anchor = each.anchor if each.kind == "connect" else (0, 0)
            x, y = placed(frames[each.first], anchor[0] / 10, anchor[1] / 10)
            ends = [None if body == 0 else f"b{body}" for body in (each.second, each.first)]
            points = [_seen(bodies, body, x, y) for body in (each.second, each.first)]
            loops.append(Pin(f"{number} pin", ends[0], ends[1], points[0], points[1]))
            if each.kind == "weld":
                turn = frames[each.first][2] - frames[each.second][2]
                loops.append(Drive(f"{number} angle", ends[0], ends[1], 0.0, turn))
    order = coordinates(model)
    joints = [*tree, *(own[each] for each in order), *loops]
    still = Mechanism(tuple(bodies), tuple(joints), (float(model.gravity[0]), float(model.gravity[1])))
    return _moving(model, still, sum(joint.size for joint in tree), len(order))


def _seen(bodies: list[Body], body: int, x: float, y: float) -> tuple[float, float]:
    if body == 0:
        return x, y
    at_x, at_y, angle = bodies[body - 1].pose
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * (x - at_x) + sine * (y - at_y), cosine * (y - at_y) - sine * (x - at_x)


def _moving(model: Model, still: Mechanism, held: int, count: int) -> IdealModel:
    """With velocities that all rows allow, and the terms that they bring."""
    rows = still.rows(still.pose)
    own = slice(held, held + count)

    def equalities(all_rows: Array, right: Array, rates: Array) -> list[tuple[Array, Array, float]]:
        out, begin = [], own.stop
        for each in model.equalities:
            if each.kind in ("connect", "weld"):
                part = slice(begin, begin + (2 if each.kind == "connect" else 3))
                begin = part.stop
                out.append((all_rows[part], right[part], 0.0))
                continue
            slope, bend = each.curve[0] / 2, each.curve[1]  # the second derivative is twice the coefficient
            if not (0 <= each.first < count and 0 <= each.second < count and each.first != each.second):
                raise InvalidMechanism(f"model: an equality of coordinates {each.first} and {each.second} is none")
            sums = [list(wrapped(one)) if each.kind == "tendon" else [one] for one in (each.first, each.second)]
            (first, first_right), (second, second_right) = (
                (all_rows[own][one].sum(axis=0), right[own][one].sum()) for one in sums
            )
            more = bend * rates[sums[1]].sum() ** 2
            ends = np.array([first_right - slope * second_right + more])
            out.append(((first - slope * second)[None], ends, float(more)))
        return out

    loops = np.vstack(
        [np.zeros((0, rows.shape[1])), *(row for row, _, _ in equalities(rows, np.zeros(len(rows)), np.zeros(count)))]
    )
    whole = np.vstack([rows[:held], loops])
    norm = np.linalg.norm(whole, axis=1)
    if not np.all(norm > 0) or len(whole) > whole.shape[1]:
        raise InvalidMechanism("model: an equality holds nothing, or there are too many")
    sizes = np.linalg.svd(whole / norm[:, None], compute_uv=False)
    if len(sizes) and sizes[-1] < LEAST_RANK * sizes[0]:
        raise InvalidMechanism("model: the equalities' rows are nearly dependent")
    wanted = np.linalg.solve(np.vstack([rows[:held], rows[own]]), np.concatenate([np.zeros(held), _wanted(model)]))
    twist = wanted - np.linalg.pinv(whole / norm[:, None]) @ ((whole @ wanted) / norm)
    twist = twist - np.linalg.pinv(whole / norm[:, None]) @ ((whole @ twist) / norm)
    if np.abs(twist).max() <= NO_MOTION * np.abs(wanted).max():
        twist = np.zeros_like(twist)
    right = still.bias(still.pose, twist.reshape(-1, 3))
    rates = rows[own] @ twist
    told = equalities(rows, right, rates)
    pairs, bent = tuple((row, value) for row, value, _ in told), tuple(more for _, _, more in told)
    return IdealModel(still, (rows[:held], right[:held]), (rows[own], right[own]), pairs, bent, rates)


def _wanted(model: Model) -> Array:
    place = {"slide 0": 0, "slide 1": 1, "hinge": 2}
    return np.array([model.links[body - 1].velocity[place[what]] / 2 for body, what in coordinates(model)])


# Of curved equalities, whose velocity term MuJoCo leaves out (the page of faults), and what else is wrong with them.
CURVED, BESIDE = "acceleration, a known fault", "beside the known fault"


def errors(model: Model) -> dict[str, float]:
    """By what MuJoCo's accelerations miss the law, relative to the largest; see `found_and_expected`.

    Where the velocity term of a curved equality makes a difference, BESIDE tells by what they miss the nearer of the
    law and the law without it.
    """
    judge = judged(model)
    missed = _missed(model, judge, bent=True)
    if not any(judge.bent):
        return {"acceleration": missed}
    return {CURVED: missed, BESIDE: min(missed, _missed(model, judge, bent=False))}


def _missed(model: Model, judge: IdealModel, bent: bool) -> float:
    found, expected = found_and_expected(model, judge, bent)
    # Sizes that the accelerations come from: gravity, and the square of the rates.
    size = max(np.abs(expected).max(), np.hypot(*model.gravity), np.abs(judge.rates).max() ** 2)
    error = float(np.abs(found - expected).max())
    if not np.isfinite(error):
        return np.inf
    return error / size if size > 0 else (np.inf if error > 0 else 0.0)


def found_and_expected(model: Model, judge: IdealModel, bent: bool = True) -> tuple[Array, Array]:
    """Accelerations (coordinates,) of MuJoCo, and of the law that it declares."""
    import mujoco  # of the release that is asked

    from engines.mujoco.declared import jacobian

    compiled = mujoco.MjModel.from_xml_string(xml(model))
    data = mujoco.MjData(compiled)
    data.qvel[:] = judge.rates
    mujoco.mj_forward(compiled, data)
    directions = judge.directions
    count = sum(len(right) for _, right in judge.equalities)
    give, begin = np.zeros((count, count)), 0
    lines = jacobian(compiled, data)
    for number, (rows, right) in enumerate(judge.equalities):
        own = [row for row in range(data.nefc) if data.efc_id[row] == number and np.linalg.norm(lines[row]) > 1e-12]
        in_tree = rows @ directions
        factors = np.linalg.lstsq(in_tree.T, lines[own].T, rcond=None)[0].T
        part = slice(begin, begin + len(right))
        begin = part.stop
        give[part, part] = np.linalg.solve(factors, np.diag(np.sqrt(data.efc_R[own])))
    return data.qacc.copy(), judge.expected(give, bent)


MOST_BODIES, MOST_EQUALITIES = 9, 3
HINGED = ("connect", "weld", "gear")


def model(seed: int, number: int, kinds: tuple[str, ...]) -> Model:
    """Case `number` of a seed with equalities of these kinds; the same on every machine.

    With connects, welds and gears alone every body is hinged, else some slide.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, number, len(kinds)])))
    while True:
        drawn = _drawn(random, kinds)
        if drawn.equalities and (any(drawn.gravity) or judged(drawn).rates.any()):
            return drawn


def _drawn(random: np.random.Generator, kinds: tuple[str, ...]) -> Model:
    def whole(low: int, high: int) -> int:
        return int(random.integers(low, high + 1))

    def two(most: int) -> tuple[int, int]:
        return whole(-most, most), whole(-most, most)

    count = whole(2, MOST_BODIES)
    hinged = {*kinds} <= {*HINGED}
    links = []
    for index in range(count):
        slides = 0 if hinged else (0, 0, 1, 2)[whole(0, 3)]
        links.append(
            RawBody(
                parent=whole(0, index) if whole(1, 4) == 1 else whole(min(1, index), index),  # few trees, which branch
                offset=two(8),
                angle=whole(-10, 10),
                slides=slides,
                turns=slides != 1 or whole(0, 1) == 1,
                centre=two(4),
                mass=whole(-3, 3),
                inertia=whole(-6, 0),
                velocity=(*two(4), whole(-6, 6)),
            )
        )
    moving = whole(1, 4) > 1
    if not moving:
        links = [RawBody(*(*vars(link).values(),)[:-1]) for link in links]
    out = Model(tuple(links), (), two(10), sparse=whole(0, 1) == 1)
    size = len(coordinates(out))
    for _ in range(whole(1, MOST_EQUALITIES)):
        kind = kinds[whole(0, len(kinds) - 1)]
        if kind in ("gear", "joint", "tendon"):
            slope, bend = two(4)
            new = Equality(kind, whole(0, size - 1), whole(0, size - 1), curve=(slope, 0 if kind == "gear" else bend))
        else:
            new = Equality(kind, whole(1, count), whole(0, count), two(6) if kind == "connect" else (0, 0))
        more = Model(out.links, (*out.equalities, new), out.gravity, out.sparse)
        try:
            judged(more)
        except InvalidMechanism:
            continue
        out = more
    return out
