"""pymunk on mechanisms that nobody chose: trees and loops of all kinds of joints, against exact multipliers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from engines import CLAIM, Engine, Unsupported
from engines.lagrange import TRUTH
from engines.pymunk import DEFAULT, EXTENDED, METHODS, TUNED
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import FreeSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reports.search.mechanisms import mechanism
from tests.claims import EVERIES, judged, rows

DURATION, STEP, SAMPLES = 0.2, 1e-3, 2
EVERY = round(DURATION / SAMPLES / STEP)
# Contacts of curves that are not round cost the judge a hundred times as much as the other rows: they are the fewest.
HELD = ("pin", "slot", "skate", "drive")
ALL = (*HELD, "roll")
GOAL = 1e-7  # rad


@dataclass(frozen=True)
class Case:
    """What an engine missed on one mechanism [rad, and a share of the largest force], and what it said of it."""

    number: int
    angle: float
    reaction: float
    estimate: float
    said: tuple[str, ...]

    @property
    def sound(self) -> bool:
        """As exact as a user may expect of an extrapolation with steps of 1e-3 s."""
        return self.angle < GOAL and self.reaction < 1e-3

    @property
    def told(self) -> bool:
        return bool(self.said)


def compared(engine: Engine, described: Mechanism, number: int) -> Case | None:
    """None where the engine has no such joint, or the motion ends in a singular position, where the judge stops."""
    truth = TRUTH.build(described, DURATION / SAMPLES)(SAMPLES, 1)
    if not np.isfinite(truth.pose).all():
        return None
    try:
        with np.errstate(all="ignore"):
            found = engine.build(described, STEP)(SAMPLES, EVERY)
    except Unsupported:
        return None
    # A torque counts as the force that it is at the mechanism's length. Where nothing is held with force, the heaviest
    # body's need at the mechanism's own time is the measure.
    arm = np.where(described.turning, described.length_scale, 1.0)
    usual = max(body.mass for body in described.bodies) * described.length_scale / described.time_scale**2
    estimate = np.nan if found.estimate is None else float(np.abs(found.estimate[..., 2]).max())
    return Case(
        number,
        float(np.abs(found.pose - truth.pose)[..., 2].max()),
        float(np.abs((found.reaction - truth.reaction) / arm).max() / max(np.abs(truth.reaction / arm).max(), usual)),
        estimate,
        found.warnings,
    )


def cases(engine: Engine, seed: int, count: int, kinds: tuple[str, ...]) -> list[Case]:
    drawn = ((number, mechanism(seed, number, kinds)) for number in range(count))
    found = (compared(engine, each, number) for number, each in drawn)
    return [case for case in found if case is not None]


def holds(found: list[Case], share: float) -> None:
    """So large a share is sound, the others say that they aren't, and hardly an estimate is ten times too small."""
    wrong = [case for case in found if not case.sound]
    assert len(wrong) <= (1 - share) * len(found), wrong
    assert all(case.told for case in wrong), [case for case in wrong if not case.told]
    # Below 1e-11 rad there is rounding, as in all of the grid.
    wild = [case for case in found if not case.angle <= max(10 * case.estimate, 1e-11)]
    assert len(wild) <= 1e-3 * len(found), wild
    assert np.median([case.angle for case in found]) < 1e-11


def test_extended_is_exact_on_forty_random_mechanisms_or_says_that_it_is_not():
    holds(cases(EXTENDED, 21, 40, HELD), 0.97)  # one of forty may miss it, where one in a hundred is expected to


def test_nothing_is_wrong_without_a_word_at_long_steps_and_sampling_changes_no_outcome():
    drawn, _ = judged(26, range(3, 13), HELD)
    found = {every: rows(EXTENDED, drawn, (1e-2,), (every,)) for every in EVERIES}
    for same in found.values():
        assert not [one for one in same if (one.error > CLAIM and not one.told) or one.reaction_silent]
        assert [one.outcome for one in same] == [one.outcome for one in found[1]]
    # The test would see a method that claims nothing.
    assert any(one.error > CLAIM for one in found[1])


@pytest.mark.slow
def test_extended_is_exact_on_two_thousand_random_mechanisms_or_says_that_it_is_not():
    holds(cases(EXTENDED, 22, 1850, HELD) + cases(EXTENDED, 23, 150, ALL), 0.99)


def test_rows_on_which_no_number_of_sweeps_converges_are_told():
    # Three slots, two pins and a skate on four bodies: a sweep leaves all but 6e-6 of the slowest mode.
    own = mechanism(22, 263, HELD)
    found = EXTENDED.build(own, STEP)(1, 10)
    assert any("not converged" in words for words in found.warnings)
    assert {EXTENDED.holder(joint, own) for joint in own.joints} <= {"engine", "engine, our rows"}


def test_a_blade_on_a_crank_is_where_the_description_says():
    # The origin of a crank is its pin in pymunk, and not its centre of mass: 0.07 rad, and nothing said so.
    found = compared(EXTENDED, mechanism(22, 483, HELD), 483)
    assert found is not None
    assert found.angle < 1e-10
    # Rounding: a step that is longer by 1e-15 of itself gives another 3e-6, as a change of velocity over 1e-4 s.
    assert found.reaction < 1e-5


def test_a_motion_that_becomes_fast_takes_more_steps():
    own = mechanism(22, 358, HELD)  # a slot on a crank runs along a rod: 3 rad/s become 20 within 0.2 s
    plain = replace(EXTENDED, pins=replace(EXTENDED.pins, divides=False))
    missed, found = compared(plain, own, 358), compared(EXTENDED, own, 358)
    assert missed is not None
    assert found is not None
    assert missed.angle > 1e-5
    assert missed.told
    assert found.angle < 1e-8


@pytest.mark.slow
def test_tuned_explodes_on_no_random_mechanism_on_which_the_default_does_not():
    default, tuned = ({case.number: case for case in cases(engine, 24, 300, HELD)} for engine in (DEFAULT, TUNED))
    for number in default.keys() & tuned.keys():
        assert tuned[number].angle < max(1.0, 2 * default[number].angle), number


def scaled(described: Mechanism, factor: float) -> Mechanism:
    """The same motion with all lengths, and gravity, times `factor`; forces are too, as masses stay."""
    bodies = tuple(
        replace(
            body,
            inertia=body.inertia * factor**2,
            pose=(body.pose[0] * factor, body.pose[1] * factor, body.pose[2]),
            twist=(body.twist[0] * factor, body.twist[1] * factor, body.twist[2]),
        )
        for body in described.bodies
    )
    joints = []
    for joint in described.joints:
        points = {name: getattr(joint, name) for name in ("first_point", "second_point") if hasattr(joint, name)}
        joints.append(replace(joint, **{name: (x * factor, y * factor) for name, (x, y) in points.items()}))
    x, y = described.gravity
    return Mechanism(bodies, tuple(joints), (x * factor, y * factor))


MOVED = {
    "four-bar": FreeFourBar().mechanism(),
    "slider-crank": FreeSliderCrank().mechanism(),
    "car": CarAndTrailer().mechanism(),
    "sleigh": ChaplyginSleigh().mechanism(),
}


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)
@pytest.mark.parametrize("described", [pytest.param(each, id=name) for name, each in MOVED.items()])
def test_a_millimetre_and_a_kilometre_move_alike(described, method):
    metre = method.build(described, STEP)(20, 10)
    # A power of two rounds nothing: a length of ours that stays as it is would be all the difference. Other numbers
    # round, and a reaction is a difference of velocities over the smallest step, of 1e-4 s.
    for factor, rounding in ((2.0**-10, 1e-9), (2.0**10, 1e-9), (1e-3, 1e-6), (1e3, 1e-6)):
        other = method.build(scaled(described, factor), STEP)(20, 10)
        unit = np.array([factor, factor, 1.0])
        arm = np.where(described.turning, factor**2, factor)
        for found, same, allowed in (
            (other.pose / unit, metre.pose, 1e-9),
            (other.twist / unit, metre.twist, 1e-9),
            (other.reaction / arm, metre.reaction, rounding),
        ):
            assert np.abs(found - same).max() < allowed * max(1.0, np.abs(same).max())
