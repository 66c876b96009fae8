"""Models for MuJoCo alone, written as its own XML by the search itself: what `reports.search.raw_law` judges.

No adapter of ours takes part, so that what is found is MuJoCo's own, in whatever release is imported. A model is a tree
of slides and hinges in the plane; `connect`, `weld`, `joint` and `tendon` equalities close it.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

from reports.search.parts import ladder

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
