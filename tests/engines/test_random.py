"""Methods with a claim on mechanisms that nobody chose: right or told, at any sampling; against exact multipliers.

`reports.search.mechanisms` draws trees and loops of up to six bodies, of pins, slots, skates, rolls, drives and all
elements of force.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from engines import CLAIM, Engine, Unpromised, Unsupported, bullet, exudyn, method_name, pymunk
from engines.finer import Division
from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, EXTENDED, TUNED
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.solver_check import _lost
from engines.mujoco.stiffness import Hardened
from reference.joints import Slot
from reference.mechanism import Mechanism
from reports.search.mechanisms import mechanism
from reports.search.parts import EVERY, FORCES, LINKS
from tests.engines.claims import EVERIES, REACTION, STEPS, Case, Row, judged, row, rows
from tests.engines.test_promised import QUICKLY, installed
from tests.present import present

CLAIMING = pytest.mark.parametrize(
    "engine",
    [pymunk.EXTENDED, EXTENDED, exudyn.EXTENDED, bullet.EXTENDED],
    ids=["pymunk", "mujoco", "exudyn", "bullet"],
)
OURS = pytest.mark.parametrize("engine", [pymunk.EXTENDED, EXTENDED], ids=["pymunk", "mujoco"])
# Contacts of curves that are not round cost the judge a hundred times as much as the other rows: they are the fewest.
HELD = ("pin", "slot", "skate", "drive")
ALL = (*HELD, "roll")
STEP = 1e-3


@cache
def known(seed: int, numbers: range, kinds: tuple[str, ...]) -> list[Case]:
    """Cases as the judge has them, for all engines that are asked."""
    return judged(seed, numbers, kinds)[0]


def silent(found: list[Row]) -> list[Row]:
    """Wrong by more than is claimed, at a time at which nothing was told."""
    return [one for one in found if one.silent or one.reaction_silent]


@CLAIMING
def test_twenty_mechanisms_are_right_or_told(engine):
    """At every step, and each mechanism at another sampling; the slow test asks all samplings of each."""
    cases = known(31, range(40, 60), EVERY)
    found = [
        each
        for number, every in enumerate(EVERIES)
        for each in rows(installed(engine), cases[number::4], STEPS, (every,))
    ]
    assert silent(found) == []


@pytest.mark.slow
@CLAIMING
def test_a_thousand_mechanisms_are_right_or_told_and_at_most_two_in_a_hundred_are_told_for_nothing(engine):
    installed(engine)
    cases, unknown = judged(601, range(1000))
    assert len(unknown) < 20
    found = rows(engine, cases)
    assert silent(found) == []
    false = [one.told and one.error <= CLAIM for one in found]
    false += [one.reaction_told and one.reaction <= REACTION for one in found]
    assert np.mean(false) <= 0.02


def asked(engine: Engine, seed: int, numbers: range, kinds: tuple[str, ...] = HELD) -> list[Row]:
    """Runs of a millisecond a step; none where the engine has no such joint, or the judge stops."""
    return rows(engine, known(seed, numbers, kinds), (STEP,), (10,))


def holds(found: list[Row], share: float) -> None:
    """So large a share is sound, the others say that they aren't, and hardly an estimate is ten times too small."""
    wrong = [one for one in found if one.error > CLAIM or one.reaction > 1e-3]
    assert len(wrong) <= (1 - share) * len(found), wrong
    assert silent(wrong) == []
    # Below 1e-11 rad there is rounding, as in all of the grid.
    wild = [one for one in found if not one.error <= max(10 * one.estimate, 1e-11)]
    assert len(wild) <= 1e-3 * len(found), wild
    assert np.median([one.error for one in found]) < 1e-11
    assert np.median([one.reaction for one in found]) < 1e-7


@OURS
def test_forty_random_mechanisms_move_as_they_should_or_say_that_they_do_not(engine):
    holds(asked(engine, 21, range(40)), 0.97)  # one of forty may miss it, where one in a hundred is expected to


@pytest.mark.slow
@OURS
def test_two_thousand_random_mechanisms_move_as_they_should_or_say_that_they_do_not(engine):
    holds(asked(engine, 22, range(1850)) + asked(engine, 23, range(150), ALL), 0.99)


def test_nothing_is_wrong_without_a_word_at_long_steps_and_sampling_changes_no_outcome():
    drawn, _ = judged(26, range(3, 13), HELD)
    found = {every: rows(pymunk.EXTENDED, drawn, (1e-2,), (every,)) for every in (1, 2, 3, 10)}
    for same in found.values():
        assert not [one for one in same if (one.error > CLAIM and not one.told) or one.reaction_silent]
        assert [one.outcome for one in same] == [one.outcome for one in found[1]]
    # The test would see a method that claims nothing.
    assert any(one.error > CLAIM for one in found[1])


def test_what_the_first_step_alone_misses_is_told_too():
    """Two loops of Bullet, 1.05e-7 off after a step, where the estimate was 6.7e-8, and 2e-9 after the next."""
    (row,) = rows(installed(bullet.EXTENDED), known(7001, range(245, 246), EVERY), (1e-2,), (1,))
    assert row.error > CLAIM
    assert row.estimate > row.error
    assert not row.silent


def test_rows_on_which_no_number_of_sweeps_converges_are_told():
    # Three slots, two pins and a skate on four bodies: a sweep leaves all but 6e-6 of the slowest mode.
    own = mechanism(22, 263, HELD)
    found = pymunk.EXTENDED.build(own, STEP)(1, 10)
    assert any("not converged" in words for words in found.warnings)
    assert {pymunk.EXTENDED.holder(joint, own) for joint in own.joints} <= {"engine", "engine, our rows"}


def one(engine: Engine, seed: int, number: int, kinds: tuple[str, ...] = HELD, step: float = STEP) -> Row:
    (case,), _ = judged(seed, [number], kinds)
    return row(engine, case, step, round(1e-2 / step))


def test_a_blade_on_a_crank_is_where_the_description_says():
    # The origin of a crank is its pin in pymunk, and not its centre of mass: 0.07 rad, and nothing said so.
    found = one(pymunk.EXTENDED, 22, 483)
    assert found.error < 1e-10
    # Rounding: a step that is longer by 1e-15 of itself gives another 3e-6, as a change of velocity over 1e-4 s.
    assert found.reaction < 1e-5


def test_an_error_above_the_claim_says_so_until_the_step_is_short() -> None:
    # A torsion spring with a time scale of 16 ms.
    long, short = (one(EXTENDED, 3, 134, EVERY, step) for step in (STEP, 2.5e-4))
    assert CLAIM < long.error < long.estimate
    assert long.outcome == "unresolved"
    assert any("unresolved from" in warning for warning in long.warnings)
    assert short.error < short.estimate < CLAIM
    assert short.outcome == "finished"
    assert short.warnings == ()


def test_an_estimate_is_right_where_no_order_is_seen() -> None:
    # A damper stops a rod within three steps: double and half ones differ by 4 to 1, and not by 16 to 1. The estimate
    # is three times the difference to half steps, which is most of the error.
    (own,), _ = judged(31, [49])
    found = row(EXTENDED, own, 1e-2, 1)
    assert CLAIM < found.error < found.estimate < 3 * found.error
    assert not found.silent


def test_an_estimate_after_one_step_is_no_less_than_after_two() -> None:
    estimate = present(EXTENDED.build(mechanism(3, 120, EVERY), STEP)(3, 1).estimate)
    assert np.all(estimate[1] >= (1 - 1e-3) * estimate[2])  # rounding of gaps, which is added, is of 1e-19 here
    assert estimate[2].max() > 0


def test_a_motion_that_becomes_fast_takes_more_steps_in_pymunk():
    own = mechanism(22, 358, HELD)  # a slot on a crank runs along a rod: 3 rad/s become 20 within 0.2 s
    plain = replace(pymunk.EXTENDED, pins=replace(pymunk.EXTENDED.pins, divides=False))
    truth = TRUTH.build(own, 0.1)(2, 1).pose
    missed, found = (engine.build(own, STEP)(2, 100) for engine in (plain, pymunk.EXTENDED))
    assert np.abs(missed.pose - truth)[..., 2].max() > 1e-5
    assert missed.warnings
    assert np.abs(found.pose - truth)[..., 2].max() < 1e-8


def test_a_motion_that_becomes_fast_takes_more_steps_in_mujoco() -> None:
    own = mechanism(1, 479, HELD)  # rates rise fivefold within 10 ms, between two skates that are nearly in line
    truth = TRUTH.build(own, 0.1)(2, 1).pose

    def missed(step: float, divided: bool) -> tuple[float, float]:
        run = EXTENDED.build(own, step)
        found = (run if divided else replace(run, divided=None))(2, round(0.1 / step))
        return float(np.abs(found.pose - truth)[..., 2].max()), float(present(found.estimate)[..., 2].max())

    (coarse, told), (fine, _), (divided, estimate) = missed(STEP, False), missed(2.5e-4, False), missed(STEP, True)
    assert coarse > 1e-4
    assert coarse < told < 10 * coarse
    assert fine < coarse / 100
    assert divided < min(CLAIM / 10, 10 * estimate)


def test_in_mujoco_every_run_that_decides_or_estimates_is_part_of_the_stepping(monkeypatch: pytest.MonkeyPatch) -> None:
    own, slow = mechanism(11, 0, HELD), mechanism(3, 134, EVERY)
    monkeypatch.setattr("engines.mujoco.engine.division", lambda *_, **__: Division(1, 700.0))
    # A run that tells by its own estimate that its steps are short enough needs no rough one.
    assert EXTENDED.build(own, STEP)(2, 100).stepping < 700.0
    monkeypatch.setattr("engines.mujoco.running.tells_itself", lambda *_: False)
    assert EXTENDED.build(own, STEP)(2, 100).stepping > 700.0
    # As many seconds as steps: 200 and, twice as long, 100; where these can't tell, 400 of half the length.
    monkeypatch.setattr("engines.mujoco.engine.division", lambda *_, **__: Division(1, 0.0))
    stepped = MuJoCoRun._step
    monkeypatch.setattr(MuJoCoRun, "_step", lambda run, counts: (*stepped(run, counts)[:3], float(counts[-1])))
    assert EXTENDED.build(own, STEP)(2, 100).stepping == 300.0
    assert EXTENDED.build(slow, STEP)(2, 100).stepping == 700.0
    # And what was run before the steps were divided.
    monkeypatch.setattr("engines.mujoco.engine.division", lambda *_, **__: Division(2, 0.0))
    divided = EXTENDED.build(own, STEP)(2, 100)
    assert divided.stepping == 300.0 + 600.0
    plain = replace(EXTENDED.build(own, STEP / 2), divided=None)(2, 200)
    assert np.array_equal(divided.pose, plain.pose)


@pytest.mark.parametrize("number", [120, 134], ids=["usual", "unresolved"])
def test_how_often_somebody_samples_changes_neither_motion_nor_estimate_nor_outcome(number: int) -> None:
    own = mechanism(3, number, EVERY)
    often = EXTENDED.build(own, STEP)(90, 1)
    for every in (2, 3, 10, 45, 90):
        seldom = EXTENDED.build(own, STEP)(90 // every, every)
        for name in ("pose", "twist", "reaction", "estimate"):
            assert np.array_equal(getattr(seldom, name), getattr(often, name)[::every]), (name, every)
        assert seldom.warnings == often.warnings
        assert seldom.unresolved_at == often.unresolved_at
    assert (often.unresolved_at is None) == (number == 120)


def test_a_light_body_that_carries_a_heavy_one_makes_rows_softer_and_loses_nothing() -> None:
    own = mechanism(1, 130, HELD)  # 5 kg slide in a body of 0.1 kg, and a drive spans both
    model = EXTENDED.model(own, STEP)
    # 1e-8 of MuJoCo's own would leave Newton's iterations without effect: 4e-4 rad, and nobody said so.
    assert _lost(model.compiled, model.start()) < 0.1
    found = one(EXTENDED, 1, 130)
    assert found.error < 1e-9
    assert found.reaction < 1e-8


def test_a_softness_that_is_asked_for_is_kept() -> None:
    own = mechanism(1, 130, HELD)
    asked, eased = (
        replace(EXTENDED, stiffness=Hardened(eased=eased)).model(own, STEP).compiled for eased in (False, True)
    )
    shipped = replace(EXTENDED, stiffness=Hardened(softening=1.0)).model(own, STEP).compiled
    assert np.allclose(asked.dof_invweight0, 1e-8 * shipped.dof_invweight0, rtol=1e-12, atol=0.0)
    assert np.all(eased.dof_invweight0 > 9 * asked.dof_invweight0)


def test_every_slot_is_built_by_public_settings_and_halving_the_step_quarters_its_error() -> None:
    built = 0
    for number in range(40):
        own = mechanism(14, number, ("pin", "slot"))
        if not any(isinstance(joint, Slot) for joint in own.joints):
            continue
        DEFAULT.build(own, STEP)
        model = TUNED.model(own, STEP)
        built += bool(model.halves)
        assert np.allclose(model.loads()[0], own.inertias, rtol=1e-14, atol=0.0)
        if model.halves and built < 5:
            truth = TRUTH.build(own, 0.1)(2, 1)
            coarse, fine = (
                np.abs(TUNED.build(own, step)(2, round(0.1 / step)).pose - truth.pose).max()
                for step in (STEP / 2, STEP / 4)
            )
            assert fine < coarse / 3 or fine < 1e-9
    assert built > 5


def test_drives_between_any_two_bodies_are_built() -> None:
    for number in range(40):
        own = mechanism(15, number, ("pin", "drive"))
        for engine in (DEFAULT, TUNED, EXTENDED):
            try:
                engine.build(own, STEP)
            except Unsupported as reason:
                pytest.fail(f"{number}: {reason}")
    servo = replace(TUNED, drive="servo")
    geared = next(
        own for own in (mechanism(15, number, ("pin", "drive")) for number in range(40)) if TUNED._tree(own).geared
    )
    with pytest.raises(Unsupported, match="drives single ones, take 'inertia'"):
        servo.build(geared, STEP)


@pytest.mark.slow
def test_tuned_explodes_on_no_random_mechanism_on_which_the_default_does_not():
    default, tuned = (
        {one.number: one for one in asked(engine, 24, range(300))} for engine in (pymunk.DEFAULT, pymunk.TUNED)
    )
    for number in default.keys() & tuned.keys():
        assert tuned[number].error < max(1.0, 2 * default[number].error), number


# What each extra takes of random mechanisms: most draws of all kinds are refused by those with few joints.
DRAWN = {
    "exudyn": ("pin", "slot", "skate", "drive", *LINKS, *FORCES),
    "box2d": ("pin", "rod", "weld", *FORCES),
    "pinocchio": ("pin", "drive", "weld", *FORCES),
    "bullet": ("pin", "weld", *FORCES),
}
# Of the way that bodies go in a fifth of the mechanism's time, in 180 steps: about the order's constant for order 1 and
# 2; of Box2D's soft joints what was met over thirty draws, where a wrong lever or sign is off by the whole way.
JUDGED = {1: 2e-2, 2: 1e-5, 4: 1e-9}
SOFT = 0.3


def drawn(engine: Engine, count: int) -> list[Mechanism]:
    """The first mechanisms of a seed that the engine builds."""
    found: list[Mechanism] = []
    for number in range(40):
        own = mechanism(12, number, kinds=DRAWN[engine.name])
        try:
            engine.build(own, 1e-3)
        except Unsupported:
            continue
        found.append(own)
    return found[:count]


@pytest.mark.parametrize("engine", QUICKLY, ids=method_name)
def test_random_mechanisms_move_in_extras_as_the_judge_moves_them(engine):
    found = drawn(installed(engine), 3)
    assert len(found) == 3
    for own in found:
        spacing = 0.01 * own.time_scale
        truth = TRUTH.build(own, spacing)(20, 1)
        run = engine.build(own, spacing / 9)(20, 9)
        way = np.abs(truth.pose - truth.pose[0]).max()
        promise = engine.order(own)
        bound = SOFT if isinstance(promise, Unpromised) else JUDGED.get(int(min(promise.order, 4)), 1e-9)
        assert np.abs(run.pose - truth.pose).max() < bound * way, (engine, own)
