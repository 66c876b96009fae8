"""Recipes, which describe mechanisms by small integers, and their JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from decimal import Decimal
from typing import Any, TypeVar, get_args, get_type_hints

import numpy as np

Case = TypeVar("Case")

# The order of the kinds is fixed, so that a seed gives the same mechanisms.
FIRST_KINDS = ("pin", "slot", "skate", "roll", "drive")
LINK_KINDS = ("rod", "gear", "weld")
FORCE_KINDS = ("spring", "damper", "torsion-spring", "torsion-damper", "force", "torque")
ALL_KINDS = (*FIRST_KINDS, *LINK_KINDS, *FORCE_KINDS)
# Kinds with nearly dependent rows, which are drawn only if the user selects them.
TOGGLE, FOLD = "toggle", "fold"
SINGULAR_KINDS = (TOGGLE, FOLD)
RIM_SHAPES = ("line", "circle", "ring", "ellipse")

ANGLE_UNIT = Decimal("0.3")  # rad; its only multiple with rational sine and cosine is 0.
RATE_UNIT = Decimal("0.5")  # m/s and rad/s.


@dataclass(frozen=True)
class RecipeBody:
    """A body of a recipe, described by integers. `parent`: number of an earlier body, or 0 for the ground. `offset`:
    position relative to the parent, in tenths of `size`. `angle` is in steps of 0.3 rad. `velocity` is in steps of 0.5
    m/s and 0.5 rad/s. `size`, `mass` and `gyration` are steps of `ladder`. `gyration` is the radius of gyration
    relative to the size."""

    parent: int = 0
    offset: tuple[int, int] = (0, 0)
    angle: int = 0
    size: int = 0
    mass: int = 0
    gyration: int = 0
    velocity: tuple[int, int, int] = (0, 0, 0)


@dataclass(frozen=True)
class Rim:
    """A rolling curve of a recipe, described by integers.

    `size`: step of `ladder`, relative to the size of the second body. Only an ellipse has `ratio` and `place`. `ratio`:
    ratio of the axes as a step of `ladder`. `place`: parameter of the contact point in steps of 0.3 rad.
    """

    shape: str = "circle"
    size: int = 0
    ratio: int = 0
    place: int = 0


@dataclass(frozen=True)
class RecipeLink:
    """A joint or a force element of a recipe, described by integers.

    `first`, `second`: numbers of the bodies, where `first` may be the ground, 0. `at`: position relative to the second
    body, in tenths of that body's size. Other lengths are in the same unit. `rims`: the curves of both bodies of a
    roll.

    `turn`: a direction in the world, in steps of 0.3 rad. Slots, blades, forces and tangents of contacts have this
    direction. The first body's material is to the left of the tangent. `more`: the distance from `at` to the point that
    defines the slot's line, or the rate of a drive in steps of 0.5 rad/s. For gears, forces and torques, half of `more`
    is the ratio or the strength. For rods, springs and dampers, `more` and `turn` are the distance and the direction of
    the point on the first body. `strength` of a spring or damper is a step of `ladder`. `rest` of a spring is the
    deflection at the start, in tenths of the length or in steps of 0.3 rad.

    A toggle is a rod between two points on opposite sides of `at`, where a pin connects the same bodies. The distances
    from `at` along `turn` are `more` and half of `more`. The line of the rod misses `at` by 10^-strength sizes. The
    bodies of a fold are pinned to the ground, the first at `far` and the second at `at`.
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
    """A mechanism, described by integers. `gravity` is in m/s^2. `decades`: the units of length, mass and time as
    powers of ten."""

    parts: tuple[RecipeBody, ...]
    links: tuple[RecipeLink, ...]
    gravity: tuple[int, int] = (0, 0)
    decades: tuple[int, int, int] = (0, 0, 0)

    @property
    def kinds(self) -> tuple[str, ...]:
        return tuple(kind for kind in (*ALL_KINDS, *SINGULAR_KINDS) if any(link.kind == kind for link in self.links))


class Integers:
    """Random integers from a seed, the same on every machine."""

    def __init__(self, seed: Sequence[int]) -> None:
        self._random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))

    def whole(self, low: int, high: int) -> int:
        return int(self._random.integers(low, high + 1))

    def two(self, most: int) -> tuple[int, int]:
        return self.whole(-most, most), self.whole(-most, most)

    def chance(self, one_in: int) -> bool:
        return self.whole(1, one_in) == 1


def ladder(step: int) -> Decimal:
    """The number at this step in the sequence 0.2, 0.5, 1, 2, 5, 10, which is continued at both ends; step 0 is 1."""
    return Decimal((1, 2, 5)[step % 3]).scaleb(step // 3)


def case_to_json(case: Any) -> str:
    def plain(value: Any) -> Any:
        if not is_dataclass(value):
            return [plain(item) for item in value] if isinstance(value, tuple) else value
        items = {field.name: (getattr(value, field.name), field.default) for field in fields(value)}
        return {name: plain(item) for name, (item, default) in items.items() if item != default}

    return json.dumps(plain(case), sort_keys=True)


def case_from_json(text: str, kind: type[Case]) -> Case:
    """The inverse of `case_to_json` for a case of this kind. Raises ValueError for other text."""

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
        raise ValueError(
            f"this is no {kind.__name__.lower()} ({error}); it must be written by `case_to_json`"
        ) from None
