"""MuJoCo extended on mechanisms that nobody chose, against `lagrange` at tight tolerance; what all methods can build.

`reports.search.mechanisms` draws trees and loops of up to six bodies, of pins, slots, skates, rolls and drives. They
move for 0.2 s in steps of a millisecond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from engines import Unsupported
from engines.finer import Division
from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.solver_check import _lost
from engines.mujoco.stiffness import Hardened
from reference.joints import Slot
from reference.mechanism import Mechanism
from reports.search.mechanisms import mechanism
from reports.search.parts import EVERY
from tests.engines.claims import judged, row
from tests.present import present

DURATION, STEP, SAMPLES = 0.2, 1e-3, 2
# Contacts of curves that are not round cost the judge a hundred times as much as the other rows: they are the fewest.
HELD = ("pin", "slot", "skate", "drive")
ALL = (*HELD, "roll")

GOAL = 1e-7  # rad
# Of an error that the estimate should know: below there is rounding, as in all of the grid.
UNKNOWN = 1e-11


@dataclass(frozen=True)
class Miss:
    """How far a run is from the judge: angles [rad], its own estimate of it, and reactions relative to the largest."""

    angle: float
    estimate: float
    reaction: float
    warnings: tuple[str, ...]
    unresolved: bool


def miss(own: Mechanism, engine: MuJoCo = EXTENDED, step: float = STEP, divided: bool = True) -> Miss | None:
    """None where the motion ends in a singular position, at which the judge stops."""
    truth = TRUTH.build(own, DURATION / SAMPLES)(SAMPLES, 1)
    if not np.isfinite(truth.pose).all():
        return None
    run = engine.build(own, step)
    motion = (run if divided else replace(run, divided=None))(SAMPLES, round(DURATION / SAMPLES / step))
    assert motion.estimate is not None
    # What the heaviest body needs to follow the mechanism's own time, where nothing is held with force.
    usual = max(body.mass for body in own.bodies) * own.length_scale / own.time_scale**2
    return Miss(
        float(np.abs(motion.pose - truth.pose)[..., 2].max()),
        float(motion.estimate[..., 2].max()),
        float(np.abs(motion.reaction - truth.reaction).max() / max(np.abs(truth.reaction).max(), usual)),
        motion.warnings,
        motion.unresolved_at is not None,
    )


def assert_right(found: list[Miss | None]) -> None:
    misses = [one for one in found if one is not None]
    angles, reactions, estimates = (
        np.array([getattr(one, name) for one in misses]) for name in ("angle", "reaction", "estimate")
    )
    assert angles.max() < GOAL
    assert reactions.max() < 1e-3
    wild = angles > 10 * np.maximum(estimates, UNKNOWN)
    assert np.mean(wild) <= 1e-3, np.flatnonzero(wild)
    assert np.median(angles) < 1e-11
    assert np.median(reactions) < 1e-9


def test_forty_random_mechanisms_move_as_they_should_to_1e_7() -> None:
    assert_right([miss(mechanism(11, number, HELD)) for number in range(40)])


@pytest.mark.slow
def test_two_thousand_random_mechanisms_move_as_they_should_to_1e_7() -> None:
    found = [miss(mechanism(12, number, HELD)) for number in range(1850)]
    assert_right(found + [miss(mechanism(13, number, ALL)) for number in range(150)])


def test_twenty_mechanisms_of_all_kinds_are_right_or_say_that_they_are_not() -> None:
    found = [one for one in (miss(mechanism(3, number, EVERY)) for number in range(120, 140)) if one is not None]
    assert [one for one in found if not one.unresolved and one.angle > GOAL] == []
    assert sum(not one.unresolved for one in found) > 15


def test_an_error_above_the_claim_says_so_until_the_step_is_short() -> None:
    own = mechanism(3, 134, EVERY)  # a torsion spring with a time scale of 16 ms
    long, short = present(miss(own)), present(miss(own, step=2.5e-4))
    assert GOAL < long.angle < long.estimate
    assert long.unresolved
    assert any("unresolved from" in warning for warning in long.warnings)
    assert short.angle < short.estimate < GOAL
    assert not short.unresolved
    assert short.warnings == ()


def test_an_estimate_is_right_where_no_order_is_seen() -> None:
    # A damper stops a rod within three steps: double and half ones differ by 4 to 1, and not by 16 to 1.
    (own,), _ = judged(31, [49])
    found = row(EXTENDED, own, 1e-2, 1)
    assert GOAL < found.error < found.estimate < 2 * found.error
    assert not found.silent


def test_an_estimate_after_one_step_is_no_less_than_after_two() -> None:
    estimate = present(EXTENDED.build(mechanism(3, 120, EVERY), STEP)(3, 1).estimate)
    assert np.all(estimate[1] >= estimate[2])
    assert estimate[2].max() > 0


def test_a_motion_that_becomes_fast_takes_more_steps() -> None:
    own = mechanism(1, 479, HELD)  # rates rise fivefold within 10 ms, between two skates that are nearly in line
    coarse, fine = present(miss(own, divided=False)), present(miss(own, step=2.5e-4, divided=False))
    assert coarse.angle > 1e-4
    assert coarse.angle < coarse.estimate < 10 * coarse.angle
    assert fine.angle < coarse.angle / 100
    divided = present(miss(own))
    assert divided.angle < GOAL / 10
    assert divided.angle < 10 * divided.estimate


def test_every_run_that_decides_or_estimates_is_part_of_the_stepping(monkeypatch: pytest.MonkeyPatch) -> None:
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
    found = present(miss(own))
    assert found.angle < 1e-9
    assert found.reaction < 1e-8


def test_a_softness_that_is_asked_for_is_kept() -> None:
    own = mechanism(1, 130, HELD)
    asked, eased = (
        replace(EXTENDED, stiffness=Hardened(eased=eased)).model(own, STEP).compiled for eased in (False, True)
    )
    shipped = replace(EXTENDED, stiffness=Hardened(softening=1.0)).model(own, STEP).compiled
    assert np.allclose(asked.dof_invweight0, 1e-8 * shipped.dof_invweight0, rtol=1e-12, atol=0.0)
    assert np.all(eased.dof_invweight0 > 9 * asked.dof_invweight0)


def test_the_judges_own_error_is_far_below_the_goal() -> None:
    for number in range(3):
        own = mechanism(11, number, HELD)
        truth = TRUTH.build(own, DURATION / SAMPLES)(SAMPLES, 1)
        assert np.max(np.asarray(truth.estimate)) < GOAL / 100


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
            truth = TRUTH.build(own, DURATION / SAMPLES)(SAMPLES, 1)
            coarse, fine = (
                np.abs(TUNED.build(own, step)(SAMPLES, round(DURATION / SAMPLES / step)).pose - truth.pose).max()
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
    geared = next(own for own in (mechanism(15, number, ("pin", "drive")) for number in range(40)) if clocks(own))
    with pytest.raises(Unsupported, match="drives single ones, take 'inertia'"):
        servo.build(geared, STEP)


def clocks(own: Mechanism) -> bool:
    return bool(TUNED._tree(own).geared)
