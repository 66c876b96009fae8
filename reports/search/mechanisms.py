"""Random planar mechanisms, each defined by a seed and a number.

    from reports.search.mechanisms import mechanism, recipe
    for number in range(2000):
        drawn = mechanism(seed=1, number=number)                          # kinds: FIRST_KINDS
        wide = mechanism(1, number, kinds=("pin", "slot", "skate"), decades=2)
        whole = mechanism(1, number, kinds=ALL_KINDS)                     # also rods, gears, welds, forces

A case depends only on its seed, number, kinds and decades. The integers of a case are drawn by numpy's PCG64, so they
are the same on every machine. A mechanism has 1 to 6 bodies. Most bodies are connected to an earlier body or to the
ground by a joint of the selected kinds. Up to three more joints close loops. Every mechanism has gravity or moves at
the start.
The rows of the joints are independent (`recipe.DEPENDENCE_LIMIT`). The mechanism has a degree of freedom or a drive.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from typing import Annotated

from engines import Engine, Unsupported
from reference.checks import LARGEST_COUNT, InvalidMechanism, validated
from reference.mechanism import Mechanism
from reference.validators import from_to
from reports.search.parts import (
    ALL_KINDS,
    FIRST_KINDS,
    FOLD,
    FORCE_KINDS,
    SINGULAR_KINDS,
    TOGGLE,
    Integers,
    Recipe,
    RecipeBody,
    RecipeLink,
    Rim,
)
from reports.search.recipe import Held, Standing, build

DRAWN_BODIES, DRAWN_LOOPS = 6, 3
DECADES_LIMIT = 6
# Pairs of shapes (first rim, second rim) that can roll with rims of any size.
RIM_PAIRS = (
    ("line", "circle"),
    ("line", "ellipse"),
    ("circle", "circle"),
    ("circle", "ellipse"),
    ("ellipse", "circle"),
    ("ellipse", "ellipse"),
    ("ring", "circle"),
)

Seed = Annotated[int, from_to(0, LARGEST_COUNT)]
Decades = Annotated[int, from_to(0, DECADES_LIMIT)]
Kinds = Sequence[str]


@validated
def mechanism(seed: Seed, number: Seed, kinds: tuple[str, ...] = FIRST_KINDS, decades: Decades = 0) -> Mechanism:
    return build(recipe(seed, number, kinds, decades))


@validated
def recipe(seed: Seed, number: Seed, kinds: tuple[str, ...] = FIRST_KINDS, decades: Decades = 0) -> Recipe:
    """Case `number` of a seed, with joints and forces of these `kinds`. The order of `kinds` has no effect. Masses are
    from 0.1 to 10 kg, and lengths from 0.1 m to some metres. `decades` is the number of powers of ten by which both
    ranges are extended at both ends. The units of length, mass and time change by up to the same number of powers.
    Raises InvalidMechanism for unknown kinds or for no kinds."""
    if not kinds or not {*kinds} <= {*ALL_KINDS, *SINGULAR_KINDS}:
        raise InvalidMechanism(f"recipe: kinds is {kinds!r}; give one or some of {', '.join(ALL_KINDS)}")
    draw = _Draw([seed, number, decades], kinds, decades)
    while True:
        drawn_recipe = draw.recipe()
        if drawn_recipe is not None:
            return drawn_recipe


class _Draw(Integers):
    def __init__(self, seed: Sequence[int], kinds: Kinds, decades: int) -> None:
        super().__init__(seed)
        self._decades = decades
        self._kinds = tuple(kind for kind in (*ALL_KINDS, *SINGULAR_KINDS) if kind in kinds)

    def recipe(self) -> Recipe | None:
        """Draw a recipe. The result is None if the recipe has no links, or if it has neither gravity nor a motion."""
        count = self.whole(1, DRAWN_BODIES)
        moving = not self.chance(4)
        pull = self.two(10) if not moving or self.chance(2) else (0, 0)
        wide = 3 * self._decades
        parts = tuple(
            RecipeBody(
                parent=self.whole(0, index),
                offset=self.two(8),
                angle=self.whole(-10, 10),
                size=self.whole(-1 - wide, 1 + wide),
                mass=self.whole(-3 - wide, 3 + wide),
                gyration=self.whole(-3, 0),
                velocity=(*self.two(4), self.whole(-6, 6)) if moving else (0, 0, 0),
            )
            for index in range(count)
        )
        length, mass, time = (self.whole(-self._decades, self._decades) for _ in range(3))
        decades = length, mass, time
        links = [self._link(part.parent, index) for index, part in enumerate(parts, start=1)]
        for _ in range(self.whole(0, DRAWN_LOOPS)):
            links.append(self._link(*self._pair(count)))
        links = [part for link in links for part in _with_pins(link)]
        standing = Standing(Recipe(parts, (), pull, decades))
        kept_links, held_joints = self._independent(standing, links)
        moved = kept_links and (any(pull) or standing.allowed(held_joints).any())
        return Recipe(parts, kept_links, pull, decades) if moved else None

    def _independent(
        self, standing: Standing, links: Sequence[RecipeLink]
    ) -> tuple[tuple[RecipeLink, ...], Sequence[Held]]:
        """The links that are kept, and their joints. These joints are independent and leave a degree of freedom or a
        drive."""
        held_joints: list[Held] = []
        kept_links: list[RecipeLink] = []
        freedom = 3 * len(standing.bodies)
        for link in links:
            if link.kind in FORCE_KINDS:
                kept_links.append(link)
                continue
            try:
                joints = [*held_joints, standing.held(link, len(kept_links) + 1)]
            except InvalidMechanism:  # these curves can't roll on each other
                continue
            freedom_left = freedom - len(joints[-1].rows)
            driven = any(kept_link.kind == "drive" for kept_link in (*kept_links, link))
            if freedom_left >= (0 if driven else 1) and standing.independent(joints):
                held_joints, freedom = joints, freedom_left
                kept_links.append(link)
        return tuple(kept_links), held_joints

    def _pair(self, count: int) -> tuple[int, int]:
        first, second = self.whole(0, count), self.whole(1, count)
        return (first, second) if first != second else (0, second)

    def _link(self, first: int, second: int) -> RecipeLink:
        # Pins are drawn more often, since they connect the bodies to trees.
        more_pins = ["pin"] * max(1, len(self._kinds) // 3)
        choice = (*self._kinds, *more_pins) if "pin" in self._kinds else self._kinds
        kind = choice[self.whole(0, len(choice) - 1)]
        link = RecipeLink(kind, first, second, self.two(6), self.whole(-10, 10))
        if self.chance(6):
            link = replace(link, at=(0, 0))  # many adapters treat the centre of mass as a special case
        if kind == "roll":
            return replace(link, rims=self._rims())
        if kind in ("drive", "slot"):
            most = 6 if kind == "drive" else 8
            return replace(link, more=self.whole(-most, most))
        return link if kind in FIRST_KINDS else self._further(link)

    def _rims(self) -> tuple[Rim, Rim]:
        pair = RIM_PAIRS[self.whole(0, len(RIM_PAIRS) - 1)]
        first, second = (Rim(shape, self.whole(-3, 0), self.whole(-2, 2), self.whole(-10, 10)) for shape in pair)
        if first.shape == "ring":
            first = Rim("ring", second.size + self.whole(1, 3))
        first, second = (rim if rim.shape == "ellipse" else Rim(rim.shape, rim.size) for rim in (first, second))
        return first, second

    def _further(self, link: RecipeLink) -> RecipeLink:
        """Draw a link of a kind outside of FIRST_KINDS; its distance, ratio or force is not zero."""
        amount = self.whole(1, 8) * (1 if self.chance(2) else -1)
        strength, rest = self.whole(-2, 4), self.whole(-10, 10)
        kind = link.kind
        if kind == "weld":
            return replace(link, turn=0)
        link = replace(link, more=amount)
        if kind in ("rod", "gear", "force", "torque"):
            return link
        if kind == FOLD and link.first:
            parallel = self.chance(2)
            strength, far = self.whole(2, 5), self.two(6)
            return replace(link, turn=0, strength=strength, rest=0 if parallel else rest, far=far)
        if kind in SINGULAR_KINDS:
            return replace(link, kind=TOGGLE, strength=self.whole(3, 5))
        return replace(link, strength=strength, rest=rest if "spring" in kind else 0)


def _with_pins(link: RecipeLink) -> tuple[RecipeLink, ...]:
    if link.kind == FOLD:
        return RecipeLink("pin", 0, link.first, link.far), RecipeLink("pin", 0, link.second, link.at), link
    return (RecipeLink("pin", link.first, link.second, link.at), link) if link.kind == TOGGLE else (link,)


SHAPE_COUNT = 6  # Number of shapes for a seed and kinds; every second shape has a loop.
CASES_PER_SHAPE = 10  # Number of consecutive cases with the same shape.
SHAPE_TRIALS = 400  # Number of recipes that are tried as shapes.

Whole = Callable[[int, int], int]


def recipe_of_shape(engine: Engine, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> Recipe:
    """Case `number` of a seed. Its shape is one of the first SHAPE_COUNT shapes that the engine can build."""
    shapes = _shapes(engine, seed, kinds, decades)
    if not shapes:
        return recipe(seed, number, kinds, decades)
    whole = Integers([seed, number, decades, SHAPE_COUNT]).whole
    return renumber(shapes[number // CASES_PER_SHAPE % len(shapes)], whole)


@lru_cache(maxsize=8)
def _shapes(engine: Engine, seed: int, kinds: tuple[str, ...], decades: int) -> tuple[Recipe, ...]:
    shapes: list[Recipe] = []
    for number in range(SHAPE_TRIALS):
        candidate = recipe(seed, number, kinds, decades)
        joints = [link for link in candidate.links if link.kind not in FORCE_KINDS]
        if len(shapes) % 2 and len(joints) <= len(candidate.parts):
            continue
        mechanism = build(candidate)
        with suppress(Unsupported):
            engine.build(mechanism, mechanism.time_scale)
            shapes.append(candidate)
        if len(shapes) == SHAPE_COUNT:
            break
    return tuple(shapes)


def renumber(shape: Recipe, whole: Whole) -> Recipe:
    """A recipe of the same shape with new numbers. `whole(low, high)` draws an integer from `low` to `high`. Zero stays
    zero, since engines build a drive at rest differently from a turning drive. The ratio of a gear does not change,
    since it is a constant of the compiled model."""

    def part(old: RecipeBody) -> RecipeBody:
        velocity = (whole(-4, 4), whole(-4, 4), whole(-6, 6)) if moving else (0, 0, 0)
        offset, angle, gyration = (whole(-8, 8), whole(-8, 8)), whole(-10, 10), whole(-3, 0)
        size, mass = old.size + whole(-1, 1), old.mass + whole(-1, 1)
        return replace(old, offset=offset, angle=angle, size=size, mass=mass, gyration=gyration, velocity=velocity)

    def link(old: RecipeLink) -> RecipeLink:
        new = {"turn": whole(-10, 10) or 1, "strength": whole(-2, 4) or 1, "rest": whole(-10, 10) or 1}
        new |= {"more": whole(1, 8) * (1 if whole(0, 1) else -1)} if old.kind != "gear" else {}
        changed = {name: value for name, value in new.items() if getattr(old, name)}
        return replace(old, at=(whole(-6, 6), whole(-6, 6)), **changed)

    while True:
        moving = whole(1, 4) > 1
        pull = (whole(-10, 10), whole(-10, 10)) if not moving or whole(0, 1) else (0, 0)
        parts, links = tuple(map(part, shape.parts)), tuple(map(link, shape.links))
        candidate = replace(shape, parts=parts, links=links, gravity=pull)
        try:
            mechanism = build(candidate)
        except InvalidMechanism:  # the rows are nearly dependent
            continue
        if any(pull) or mechanism.twist.any():
            return candidate
