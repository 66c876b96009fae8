"""Who holds a joint is told for each method, and a joint that our code holds is never called the engine's."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from engines import Holder, Unpromised, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from reference.joints import Drive, Joint, Slot
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reports.write.holders import held_by
from tests.mechanisms import four_bar
from tests.toys import Toy

SKATE, ROLL, PINS = ChaplyginSleigh().mechanism(), RollingEllipse().mechanism(), DrivenFourBar().mechanism()
SLIDER, CAR, GEARS = DrivenSliderCrank().mechanism(), CarAndTrailer().mechanism(), EllipticGears().mechanism()
SHARED = "engine, our rows"


@pytest.mark.parametrize(
    ("engine", "skate", "car", "roll", "gears", "slider"),
    [
        (pymunk.DEFAULT, "ours", "engine; skate: ours", "engine", "engine", "engine"),
        (pymunk.TUNED, SHARED, f"engine; skate: {SHARED}", "engine", "engine", "engine"),
        (pymunk.EXTENDED, SHARED, f"engine; skate: {SHARED}", SHARED, f"engine; roll: {SHARED}", "engine"),
        (mujoco.DEFAULT, "engine", "engine", "engine", "engine", "engine"),
        (mujoco.TUNED, SHARED, f"engine; skate: {SHARED}", "engine", "engine", "engine"),
        (mujoco.EXTENDED, SHARED, f"engine; skate: {SHARED}", SHARED, f"engine; roll: {SHARED}", "engine"),
        (Lagrange("rk4"), "engine", "engine", "engine", "engine", "engine"),
    ],
    ids=lambda value: value if isinstance(value, str) else f"{value.name} {value.variant}",
)
def test_every_variant_says_who_holds_skates_contacts_and_slots(engine, skate, car, roll, gears, slider):
    found = [held_by(engine, mechanism) for mechanism in (SKATE, CAR, ROLL, GEARS, SLIDER)]
    assert found == [skate, car, roll, gears, slider]
    assert held_by(engine, PINS) == "engine"


def test_every_construction_of_a_skate_says_who_holds_it():
    ours = {"skate: centre's velocity zeroed", "skate: point's velocity zeroed", "skate: impulse at the blade"}
    engines = {"friction blade"}
    for engine in (*pymunk_methods.SKATES, *mujoco_methods.SKATES):
        expected = "ours" if engine.variant in ours else "engine" if engine.variant in engines else SHARED
        assert held_by(engine, SKATE) == expected, engine.variant


def test_every_construction_of_a_rolling_contact_says_who_holds_it():
    assert {held_by(engine, ROLL) for engine in (pymunk.DEFAULT, *pymunk_methods.ROLL_FACETED)} == {"engine"}
    assert {held_by(engine, ROLL) for engine in (pymunk.EXTENDED, pymunk_methods.ROLL_PIVOT)} == {SHARED}
    assert [held_by(engine, ROLL) for engine in mujoco_methods.ROLLS] == ["engine"]


def test_a_slot_that_no_groove_holds_exactly_is_aimed_by_our_rows():
    # The slotted point off the centre of mass of a slider that may turn: a push across the slot turns it.
    slot = next(joint for joint in SLIDER.joints if isinstance(joint, Slot))
    moved = replace(slot, second_point=(0.1, 0.0))
    turning = [joint for joint in SLIDER.joints if not (isinstance(joint, Drive) and joint.turning_rate == 0)]
    joints = tuple(moved if joint == slot else joint for joint in turning)
    mechanism = replace(SLIDER, joints=joints)
    assert held_by(pymunk.TUNED, mechanism) == f"engine; slot: {SHARED}"
    naive = replace(pymunk.DEFAULT, slot="groove")
    assert held_by(naive, mechanism) == "engine"
    assert isinstance(naive.order(mechanism), Unpromised)


def test_an_overwritten_crank_is_ours():
    servo, overwritten = mujoco_methods.DRIVES
    assert held_by(servo, PINS) == "engine"
    assert held_by(overwritten, PINS) == "engine; drive: ours"


@dataclass(frozen=True)
class Divided(Toy):
    """Holds the first joint by itself, the others by our rows."""

    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return "engine" if joint == mechanism.joints[0] else "engine, our rows"


def test_joints_of_one_kind_that_differ_are_told_by_name():
    mechanism = four_bar()
    others = " and ".join(joint.name for joint in mechanism.joints[1:])
    assert held_by(Divided(), mechanism) == f"engine; {others}: engine, our rows"


def test_free_bodies_have_no_joints_to_hold():
    assert held_by(pymunk.DEFAULT, Mechanism(SKATE.bodies, ())) == "no joints"
