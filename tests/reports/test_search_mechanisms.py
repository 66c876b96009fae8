"""Random mechanisms: the same from the same numbers, right at the start, as wide as they say."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.joints import Slot
from reports.search.mechanisms import mechanism, recipe, renumber
from reports.search.parts import (
    ALL_KINDS,
    FIRST_KINDS,
    FORCE_KINDS,
    SINGULAR_KINDS,
    Recipe,
    RecipeBody,
    RecipeLink,
    Rim,
    case_from_json,
    case_to_json,
)
from reports.search.recipe import DEPENDENCE_LIMIT, SINGULAR_LIMIT, build, dependence

CASES = range(40)
# The digest of the recipes below. It changes with any change of the drawing: seeds in documents would then name other
# mechanisms.
DIGEST = "a70ba875a1348f267414ef4ca0cc7f05393aa4b0745440069cc1fdfeeff82ed7"


def test_a_seed_and_a_number_give_the_same_mechanism_for_ever():
    drawing = [
        case_to_json(recipe(seed, number, kinds, decades))
        for seed in (3, 1001)
        for number in range(20)
        for kinds in (FIRST_KINDS, ALL_KINDS, ("pin", *SINGULAR_KINDS))
        for decades in (0, 2, 4)
    ]
    assert hashlib.sha256("\n".join(drawing).encode()).hexdigest() == DIGEST
    assert recipe(3, 41, ("slot", "pin")) == recipe(3, 41, ("pin", "slot"))


def test_the_point_of_a_slots_line_lies_beside_the_slide():
    """Adapters meet lines whose own point is elsewhere: at `more` tenths of the size along it."""
    slot = build(
        Recipe((RecipeBody(offset=(3, 4)),), (RecipeLink("slot", 0, 1, (1, 2), turn=2, more=-8),), (0, -10))
    ).joints[0]
    assert isinstance(slot, Slot)
    along = -0.8 * np.array([np.cos(0.6), np.sin(0.6)])
    assert slot.first_point == pytest.approx(np.array([0.4, 0.6]) + along, abs=1e-15)


@pytest.mark.parametrize("decades", [0, 2])
def test_every_start_fulfils_its_joints_and_none_hold_the_same(decades):
    for number in CASES:
        drawing = mechanism(5, number, decades=decades)  # a start off its joints is refused by Mechanism itself
        rows = drawing.rows(drawing.pose) / np.tile([1, 1, drawing.length_scale], len(drawing.bodies))
        sizes = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True), compute_uv=False)
        assert sizes[-1] >= 0.999 * DEPENDENCE_LIMIT * sizes[0]  # the last digits of the threshold
        assert drawing.twist.any() or np.hypot(*drawing.gravity) > 0


def test_a_toggle_holds_its_bodies_together_by_rows_that_nearly_depend_on_each_other():
    """A rod that misses the pin of its bodies by d of their length: its moment is d, beside a force of 1."""
    seen = 0
    for number in range(30):
        drawing = recipe(5, number, ("pin", "toggle"))
        mechanism = build(drawing)
        rows = mechanism.rows(mechanism.pose) / np.tile([1, 1, mechanism.length_scale], len(mechanism.bodies))
        assert dependence(rows) >= 0.999 * SINGULAR_LIMIT
        seen += "toggle" in drawing.kinds and dependence(rows) < DEPENDENCE_LIMIT
    assert seen > 10
    assert "toggle" not in {link.kind for number in CASES for link in recipe(5, number, ALL_KINDS).links}


@pytest.mark.parametrize("kind", ["all", *FORCE_KINDS])
def test_units_are_units(kind):
    """In other units of length, mass and time rows, masses, rates and accelerations scale, and nothing else changes."""
    for number in CASES if kind == "all" else range(12):
        drawing = recipe(8, number, FIRST_KINDS if kind == "all" else ("pin", kind))
        plain, scaled = build(drawing), build(replace(drawing, decades=(-3, 2, 1)))
        assert np.allclose(scaled.pose, plain.pose * [1e-3, 1e-3, 1], rtol=1e-12, atol=1e-15)
        # Velocities are solved for: rounding times the condition of the rows, of the largest.
        speed = np.abs(plain.twist[:, 2]).max() + np.abs(plain.twist[:, :2]).max() + 1
        assert np.allclose(scaled.twist, plain.twist * [1e-4, 1e-4, 0.1], rtol=1e-9, atol=1e-12 * speed)
        assert np.allclose(scaled.inertias, plain.inertias * [1e2, 1e2, 1e-4], rtol=1e-12)
        earlier, later = (single.unconstrained(single.pose, single.twist) for single in (plain, scaled))
        size = np.array([1e-5, 1e-5, 1e-2])  # m/s^2 and rad/s^2: 1e-3 / 10^2, 1 / 10^2
        largest = np.abs(earlier).max(axis=(0, 1)) + np.abs(plain.twist).max() + 1
        assert np.allclose(later / size, earlier, rtol=1e-9, atol=1e-11 * largest)
        if plain.length_scale != 1:  # a length scale of 1 m is the default without lengths
            assert scaled.time_scale == pytest.approx(10 * plain.time_scale, rel=1e-9)


def test_a_shape_keeps_its_ratios_of_gears_and_gets_other_numbers_for_all_else():
    random = np.random.default_rng(3)
    shape = next(drawing for n in CASES if "gear" in (drawing := recipe(5, n, ("pin", "gear", "drive"))).kinds)
    others = [renumber(shape, lambda low, high: int(random.integers(low, high + 1))) for _ in range(5)]
    for link, *changed in zip(shape.links, *(other.links for other in others), strict=True):
        assert {item.kind for item in changed} == {link.kind}
        assert ({item.more for item in changed} == {link.more}) == (link.kind == "gear" or not link.more)
    assert len({case_to_json(item) for item in (shape, *others)}) == 6


def test_a_recipe_survives_being_written():
    for number in CASES:
        drawing = recipe(7, number, decades=1)
        assert case_from_json(case_to_json(drawing), Recipe) == drawing


@pytest.mark.parametrize(
    ("told", "why"),
    [
        (Recipe((RecipeBody(parent=1),), ()), "parent"),
        (Recipe((RecipeBody(),), (RecipeLink("pin", 1, 1),)), "differ"),
        (Recipe((RecipeBody(),), (RecipeLink("pin", 0, 2),)), "second from 1"),
        (Recipe((RecipeBody(),), (RecipeLink("glue", 0, 1),)), "one of pin"),
        (Recipe((RecipeBody(),), (RecipeLink("roll", 0, 1),)), "two rims"),
        (Recipe((RecipeBody(),), (RecipeLink("roll", 0, 1, rims=(Rim("square"), Rim())),)), "one of line"),
        (Recipe((RecipeBody(),), (RecipeLink("pin", 0, 1), RecipeLink("pin", 0, 1))), "dependent"),
        (Recipe((RecipeBody(),), (RecipeLink("roll", 0, 1, rims=(Rim("line"), Rim("line"))),)), "curvatures"),
    ],
)
def test_a_recipe_that_is_none_is_refused(told, why):
    with pytest.raises(InvalidMechanism, match=why):
        build(told)


def test_kinds_that_are_none_are_refused():
    with pytest.raises(InvalidMechanism, match="glue"):
        recipe(0, 0, ("pin", "glue"))
    with pytest.raises(InvalidMechanism, match="one or some of"):
        recipe(0, 0, ())
    with pytest.raises(ValueError, match="no recipe"):
        case_from_json('{"parts": [{"colour": 1}], "links": []}', Recipe)
