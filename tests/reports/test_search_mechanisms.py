"""Random mechanisms: the same from the same numbers, right at the start, as wide as they say."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import TRUTH
from reference.checks import InvalidMechanism
from reference.forces import Spring, TorsionSpring
from reference.joints import Slot
from reports.search.mechanisms import ALL, mechanism, recipe, renumbered
from reports.search.parts import EVERY, FORCES, KINDS, Link, Part, Recipe, Rim, as_text, from_text, ladder
from reports.search.recipe import LEAST_RANK, build

CASES = range(40)


def test_a_case_depends_on_its_own_numbers_alone():
    assert recipe(3, 41) == recipe(3, 41)
    assert len({as_text(recipe(seed, number)) for seed in (3, 4) for number in CASES}) == 2 * len(CASES)
    assert recipe(3, 41, ("slot", "pin")) == recipe(3, 41, ("pin", "slot"))


def test_the_numbers_of_a_case_are_those_of_every_machine():
    """Written down once: another generator, or another order of drawing, would change every published number."""
    assert as_text(recipe(1, 13, ("pin", "skate"))) == PUBLISHED


PUBLISHED = (
    '{"gravity": [9, 10], "links": [{"at": [4, -1], "first": 0, "kind": "pin", "second": 1, "turn": 3}, {'
    '"at": [3, -1], "first": 0, "kind": "skate", "second": 2, "turn": 8}], "parts": [{"angle": -10, "gyra'
    'tion": -1, "mass": -1, "offset": [-7, -6], "size": 1, "velocity": [2, -2, -6]}, {"angle": -9, "gyrat'
    'ion": -2, "mass": -3, "offset": [-3, -3], "velocity": [0, 3, 1]}]}'
)


def test_the_point_of_a_slots_line_lies_beside_the_slide():
    """Adapters meet lines whose own point is elsewhere: at `more` tenths of the size along it."""
    slot = build(Recipe((Part(offset=(3, 4)),), (Link("slot", 0, 1, (1, 2), turn=2, more=-8),), (0, -10))).joints[0]
    assert isinstance(slot, Slot)
    along = -0.8 * np.array([np.cos(0.6), np.sin(0.6)])
    assert slot.first_point == pytest.approx(np.array([0.4, 0.6]) + along, abs=1e-15)


@pytest.mark.parametrize("decades", [0, 2])
def test_every_start_fulfils_its_joints_and_none_hold_the_same(decades):
    for number in CASES:
        drawn = mechanism(5, number, decades=decades)  # a start off its joints is refused by Mechanism itself
        rows = drawn.rows(drawn.pose) / np.tile([1, 1, drawn.length_scale], len(drawn.bodies))
        sizes = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True), compute_uv=False)
        assert sizes[-1] >= 0.999 * LEAST_RANK * sizes[0]  # the last digits of the threshold
        assert drawn.twist.any() or np.hypot(*drawn.gravity) > 0


@pytest.mark.parametrize("kind", EVERY)
def test_kinds_are_those_asked_for(kind):
    assert {link.kind for number in CASES for link in recipe(5, number, (kind,)).links} == {kind}


def test_kinds_that_came_later_change_no_case_without_them():
    """What was published is drawn anew by the same words: the first five kinds are those of the beginning."""
    assert ALL == KINDS == EVERY[:5]
    assert as_text(recipe(1, 13)) == as_text(recipe(1, 13, KINDS))


def test_most_springs_are_stretched_or_pushed_at_the_start():
    """By `rest` tenths of their length, or so many steps of an angle: at rest no wrong stiffness would show."""
    stretched = 0
    for number in range(60):
        case = recipe(5, number, ("pin", "spring", "torsion-spring"))
        drawn = build(case)
        links = [link for link in case.links if "spring" in link.kind]
        for link, spring in zip(links, drawn.forces, strict=True):
            assert isinstance(spring, Spring | TorsionSpring)
            pull = np.abs(replace(drawn, forces=(spring,)).applied.on(drawn.pose, drawn.twist)).max()
            assert (pull > 1e-9 * spring.stiffness) == (link.rest != 0), link
            stretched += link.rest != 0
    assert stretched > 30


def test_rods_gears_welds_and_forces_all_come_up_between_bodies_and_on_the_ground():
    seen: Counter[str] = Counter()
    for number in range(300):
        drawn = recipe(6, number, EVERY)
        mechanism = build(drawn)  # a rod off its length, a damper without a direction are refused here
        assert len(mechanism.joints) + len(mechanism.forces) == len(drawn.links)
        for link in drawn.links:
            seen[f"{link.kind} on {'a body' if link.first else 'the ground'}"] += 1
    assert len(seen) == 2 * len(EVERY)
    assert min(seen.values()) >= 5, seen


@pytest.mark.parametrize("kind", FORCES)
def test_the_units_of_forces_are_units(kind):
    """In other units of length, mass and time a force element gives the same accelerations, scaled."""
    for number in range(12):
        drawn = recipe(8, number, ("pin", kind))
        plain, scaled = build(drawn), build(replace(drawn, decades=(-3, 2, 1)))
        before, after = (one.unconstrained(one.pose, one.twist) for one in (plain, scaled))
        size = np.array([1e-5, 1e-5, 1e-2])  # m/s^2 and rad/s^2: 1e-3 / 10^2, 1 / 10^2
        largest = np.abs(before).max(axis=(0, 1)) + np.abs(plain.twist).max() + 1
        assert np.allclose(after / size, before, rtol=1e-9, atol=1e-11 * largest)


def test_all_that_is_promised_comes_up():
    """In 400 cases of each spread: trees, loops, rest, motion, drives in a loop, skates and slots on moving bodies."""
    seen: Counter[str] = Counter()
    for number in range(400):
        drawn = recipe(6, number)
        seen["at rest"] += not any(any(part.velocity) for part in drawn.parts)
        seen["without gravity"] += not any(drawn.gravity)
        seen["loop"] += len({frozenset((link.first, link.second)) for link in drawn.links}) > len(drawn.parts)
        for link in drawn.links:
            seen[link.kind] += 1
            seen[f"{link.kind} on a moving body"] += link.first > 0
            seen[f"{link.kind} at the centre of mass"] += link.at == (0, 0)
            if link.rims:
                seen[" on ".join(rim.shape for rim in link.rims[::-1])] += 1
    assert min(seen.values()) >= 10, seen
    assert len(seen) == 3 + 3 * len(ALL) + 7, seen
    masses = [
        10 ** np.ptp([np.log10(float(ladder(part.mass))) for part in recipe(6, n, decades=3).parts]) for n in CASES
    ]
    assert max(masses) > 1e6


def test_a_shape_keeps_its_ratios_of_gears_and_gets_other_numbers_for_all_else():
    random = np.random.default_rng(3)
    shape = next(drawn for n in CASES if "gear" in (drawn := recipe(5, n, ("pin", "gear", "drive"))).kinds)
    others = [renumbered(shape, lambda low, high: int(random.integers(low, high + 1))) for _ in range(5)]
    for link, *changed in zip(shape.links, *(other.links for other in others), strict=True):
        assert {each.kind for each in changed} == {link.kind}
        assert ({each.more for each in changed} == {link.more}) == (link.kind == "gear" or not link.more)
    assert len({as_text(each) for each in (shape, *others)}) == 6


def test_a_recipe_survives_being_written():
    for number in CASES:
        drawn = recipe(7, number, decades=1)
        assert from_text(as_text(drawn)) == drawn


def test_units_are_units():
    """The same mechanism in millimetres, tonnes and minutes-like units: rows, masses and rates scale, nothing else."""
    for number in CASES:
        drawn = recipe(8, number)
        plain, scaled = build(drawn), build(replace(drawn, decades=(-3, 2, 1)))
        assert np.allclose(scaled.pose, plain.pose * [1e-3, 1e-3, 1], rtol=1e-12, atol=1e-15)
        # Velocities are solved for: rounding times the condition of the rows, of the largest.
        speed = np.abs(plain.twist[:, 2]).max() + np.abs(plain.twist[:, :2]).max() + 1
        assert np.allclose(scaled.twist, plain.twist * [1e-4, 1e-4, 0.1], rtol=1e-9, atol=1e-12 * speed)
        assert np.allclose(scaled.inertias, plain.inertias * [1e2, 1e2, 1e-4], rtol=1e-12)
        if plain.length_scale != 1:  # a metre stands for none at all
            assert scaled.time_scale == pytest.approx(10 * plain.time_scale, rel=1e-9)


def test_the_judge_runs_them():
    """Joints stay closed and nothing is lost, so that a gap in an engine is the engine's."""
    for number in range(6):
        drawn = mechanism(9, number)
        run = TRUTH.build(drawn, 1e-3)(1, 20)
        assert np.isfinite(run.pose).all()
        gap = np.nan_to_num(drawn.gap(run.pose, run.t))
        assert np.abs(gap).max() < 1e-11 * max(1.0, drawn.length_scale)  # projected to the rounding of the rows


@pytest.mark.parametrize(
    ("told", "why"),
    [
        (Recipe((Part(parent=1),), ()), "parent"),
        (Recipe((Part(),), (Link("pin", 1, 1),)), "differ"),
        (Recipe((Part(),), (Link("pin", 0, 2),)), "second from 1"),
        (Recipe((Part(),), (Link("glue", 0, 1),)), "one of pin"),
        (Recipe((Part(),), (Link("roll", 0, 1),)), "two rims"),
        (Recipe((Part(),), (Link("roll", 0, 1, rims=(Rim("square"), Rim())),)), "one of line"),
        (Recipe((Part(),), (Link("pin", 0, 1), Link("pin", 0, 1))), "dependent"),
        (Recipe((Part(),), (Link("roll", 0, 1, rims=(Rim("line"), Rim("line"))),)), "curvatures"),
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
        from_text('{"parts": [{"colour": 1}], "links": []}')
