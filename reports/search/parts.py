"""A mechanism written in small whole numbers: bodies, the links between them, and how they are stored."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields, is_dataclass
from decimal import Decimal
from typing import Any, TypeVar, get_args, get_type_hints

Case = TypeVar("Case")

# The first kinds that were drawn. Their order stays, so that a seed gives the same mechanisms.
FIRST_KINDS = ("pin", "slot", "skate", "roll", "drive")
LINK_KINDS = ("rod", "gear", "weld")
FORCE_KINDS = ("spring", "damper", "torsion-spring", "torsion-damper", "force", "torque")
ALL_KINDS = (*FIRST_KINDS, *LINK_KINDS, *FORCE_KINDS)
# Drawn only if selected by name: their rows are nearly dependent.
TOGGLE, FOLD = "toggle", "fold"
SINGULAR_KINDS = (TOGGLE, FOLD)
RIM_SHAPES = ("line", "circle", "ring", "ellipse")

ANGLE_UNIT = Decimal("0.3")  # rad: no multiple of it but 0 is an angle that a formula is simple at
RATE_UNIT = Decimal("0.5")  # m/s, and rad/s


@dataclass(frozen=True)
class RecipeBody:
    """A body. `parent`: 0 is the ground, 1 the first body, and so on; it is earlier than the body itself.

    `offset`: from the parent's place, in tenths of the body's own `size`; `angle` in steps of 0.3 rad; `velocity` in
    steps of 0.5 m/s and rad/s. `size`, `mass` and `gyration` (a share of the size) are steps on the ladder ..., 0.5,
    1, 2, 5, 10, ...
    """

    parent: int = 0
    offset: tuple[int, int] = (0, 0)
    angle: int = 0
    size: int = 0
    mass: int = 0
    gyration: int = 0
    velocity: tuple[int, int, int] = (0, 0, 0)


@dataclass(frozen=True)
class Rim:
    """A curve that rolls: its `shape`; its `size` on the ladder, times that of the second body; and for an ellipse the
    `ratio` of its axes on the ladder, and where it touches, `place` in steps of 0.3 rad of its natural parameter.
    """

    shape: str = "circle"
    size: int = 0
    ratio: int = 0
    place: int = 0


@dataclass(frozen=True)
class RecipeLink:
    """A joint, or a force, of the bodies `first` (0: the ground) and `second`, at `at`: tenths of the second
    body's size from it.

    `turn`, in steps of 0.3 rad: the direction in the world of a slot, a blade, or the tangent of a contact, with the
    first body's material on its left. `more`: how far the slot's own point lies from there along it (tenths of the
    size), or the rate of a drive in steps of 0.5 rad/s. `rims`: the curves of the first and the second body of a roll.

    Rods, springs and dampers: `more` and `turn` are the distance and direction of the first body's point. Gears: half
    of `more` is the ratio. Forces (in the direction `turn`) and torques: half of `more` is the strength. All others:
    `strength` is a step on the ladder, and `rest` the deflection of a spring at the start: tenths, or steps of 0.3 rad.

    A toggle is a rod between points on both sides of `at`, where a pin holds the same bodies: `more` tenths and half of
    that away along `turn`, on a line that misses `at` by 10^-strength sizes.
    """

    kind: str
    first: int
    second: int
    at: tuple[int, int] = (0, 0)
    turn: int = 0
    more: int = 0
    rims: tuple[Rim, ...] = ()
    strength: int = 0
    rest: int = 0
    far: tuple[int, int] = (0, 0)


@dataclass(frozen=True)
class Recipe:
    """`gravity` in m/s^2; `decades` of the units of length, mass and time in which everything is written."""

    parts: tuple[RecipeBody, ...]
    links: tuple[RecipeLink, ...]
    gravity: tuple[int, int] = (0, 0)
    decades: tuple[int, int, int] = (0, 0, 0)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its joints and forces, each once, in the order of ALL_KINDS."""
        return tuple(kind for kind in (*ALL_KINDS, *SINGULAR_KINDS) if any(link.kind == kind for link in self.links))


def ladder(step: int) -> Decimal:
    """..., 0.2, 0.5, 1, 2, 5, 10, ... with 1 at step 0."""
    return Decimal((1, 2, 5)[step % 3]).scaleb(step // 3)


def case_to_json(case: Any) -> str:
    """A recipe, or another case of `parts` and `links`, as JSON without its default values."""

    def plain(value: Any) -> Any:
        if not is_dataclass(value):
            return [plain(item) for item in value] if isinstance(value, tuple) else value
        items = {field.name: (getattr(value, field.name), field.default) for field in fields(value)}
        return {name: plain(item) for name, (item, default) in items.items() if item != default}

    return json.dumps(plain(case), sort_keys=True)


def case_from_json(text: str, kind: type[Case]) -> Case:
    """The case of this kind that `case_to_json` wrote. Raises ValueError for other text."""

    def made(values: dict[str, Any], kind: type) -> Any:
        hints = get_type_hints(kind)
        return kind(**{name: frozen(value, hints[name]) for name, value in values.items()})

    def frozen(value: Any, hint: Any) -> Any:
        if not isinstance(value, list):
            return value
        item: Any = get_args(hint)[0]
        return tuple(
            made(member, item) if isinstance(item, type) and is_dataclass(item) else member for member in value
        )

    try:
        return made(json.loads(text), kind)
    except (TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"this is no {kind.__name__.lower()} ({error}); it must be what `as_text` writes") from None
