"""What an engine promises, and who holds a joint, follows from its settings and the mechanism: no scene is asked."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import pytest

from engines import EXACT, Holder, Promise, Unpromised, method_name, mujoco, pymunk
from engines.extrapolated import Extrapolated
from engines.lagrange import TRUTH, Lagrange
from engines.motions import is_prescribed, starts_at_rest, turns_steadily
from engines.mujoco.methods import DRIVES, ROLLS, SKATES
from engines.pymunk.methods import SKATE_PROJECTED
from reference.forces import Torque
from reference.joints import Drive, Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reports.gate.change import Altered
from reports.write.columns import held_by
from tests.mechanisms import four_bar
from tests.toys import Toy

FREE, MOVING, DRIVEN = four_bar(), four_bar(crank_rate=2.0), four_bar(crank_rate=2.0, drive=2.0)
HANGING = BarPendulum().mechanism()
SKATE, CAR = ChaplyginSleigh().mechanism(), CarAndTrailer().mechanism()
ROLL, GEARS = RollingEllipse().mechanism(), EllipticGears().mechanism()
SPINNING = Mechanism(
    (Body("disc", 1.0, 0.5, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0)),), (Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0)),)
)
EULER, RK4 = Lagrange("euler", "projection"), Lagrange("rk4", "projection")
SLIDER, SHARED = DrivenSliderCrank().mechanism(), "engine, our rows"


def told(engine, mechanism) -> dict[str, float]:
    """What a promise says beyond what it says by itself."""
    promise = engine.order(mechanism)
    assert isinstance(promise, Promise)
    return {f.name: value for f in fields(promise) if (value := getattr(promise, f.name)) != f.default}


def test_a_motion_is_known_by_its_joints_loads_and_start():
    assert [starts_at_rest(each) for each in (FREE, MOVING, DRIVEN, SPINNING)] == [True, False, False, False]
    assert [is_prescribed(each) for each in (FREE, MOVING, DRIVEN, SKATE, GEARS)] == [False, False, True, False, True]
    # Two blades leave a body one velocity, about the point where they meet across, and a drive none.
    # Its poses are free.
    blades = (Skate("right", None, "body", (1.0, 0.0), 0.0), Skate("up", None, "body", (0.0, 1.0), math.pi / 2))
    body = Body("body", 1.0, 0.5, (0.0, 0.0, 0.0), (2.0, -2.0, 2.0))
    driven = Mechanism((body,), (*blades, Drive("drive", None, "body", 2.0, 0.0)))
    assert driven.degrees_of_freedom() == (2, 0)
    assert not is_prescribed(driven)
    lagrange = Lagrange("rk4", "projection")
    assert lagrange.order(driven) == lagrange.order(SKATE) != lagrange.order(DRIVEN)
    assert [turns_steadily(each) for each in (SPINNING, HANGING, MOVING, SKATE)] == [True, False, False, False]
    assert not turns_steadily(replace(SPINNING, gravity=(0.0, -9.81)))
    assert not turns_steadily(replace(SPINNING, forces=(Torque("brake", None, "disc", -1.0),)))
    arm, rim = (
        Body("arm", 1.0, 0.5, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)),
        Pin("rim", "disc", "arm", (1.0, 0.0), (0.0, 0.0)),
    )
    assert not turns_steadily(replace(SPINNING, bodies=(*SPINNING.bodies, arm), joints=(*SPINNING.joints, rim)))


def test_an_altered_engine_is_held_to_what_is_promised_of_the_mechanism_as_it_is():
    inside = mujoco.DEFAULT
    altered = Altered(inside, lambda mechanism: replace(mechanism, joints=mechanism.joints[:2]))
    assert altered.softness(FREE, 1e-3) == inside.softness(FREE, 1e-3) != inside.softness(altered.change(FREE), 1e-3)
    assert altered.order(FREE) == inside.order(FREE) != inside.order(altered.change(FREE))


@pytest.mark.parametrize(
    ("mechanism", "expected"),
    [
        (FREE, {"order": 1, "rate": 2, "gap": 2, "slip": 1, "differences": 1}),
        (MOVING, {"order": 1, "gap": 2, "differences": 1}),
        (DRIVEN, {"order": 2, "rate": 1, "slip": 1, "energy": 1, "reaction": 1, "differences": 1}),
        (SPINNING, {"order": 2, "rate": 1, "slip": 1, "reaction": 1, "differences": 1}),
        (SKATE, {"order": 1, "gap": 2, "slip": EXACT, "differences": 1}),
        (CAR, {"order": 1, "gap": 2, "differences": 1}),
        (ROLL, {"order": 1, "differences": 1}),
    ],
)
def test_pymunk_tuned_promises_by_how_a_motion_starts_and_what_drives_it(mechanism, expected):
    assert told(pymunk.TUNED, mechanism) == expected


def test_pymunks_other_constructions_promise_their_own():
    # As shipped a tenth of a gap is closed in a sixtieth of a second; a naive skate off the centre promises nothing.
    assert all(told(pymunk.DEFAULT, each) == {"order": 1, "differences": 1} for each in (FREE, DRIVEN, SPINNING, ROLL))
    assert all(isinstance(pymunk.DEFAULT.order(each), Unpromised) for each in (SKATE, CAR))
    assert told(pymunk.LEAPFROG, MOVING) == {"order": 2, "differences": 1}
    assert told(pymunk.LEAPFROG, SKATE)["order"] == 1
    assert told(SKATE_PROJECTED, SKATE)["slip"] == EXACT


def test_an_extrapolation_promises_the_next_power_and_more_rounding():
    promise = pymunk.EXTENDED.order(MOVING)
    assert isinstance(promise, Promise)
    assert (promise.order, promise.reaction, promise.differences) == (6, 4, 8)
    assert promise.amplified == pytest.approx(16.5, abs=0.01)
    assert told(Extrapolated(SKATE_PROJECTED, "twice", (2, 4), (1,)), SKATE)["order"] == 2
    assert told(pymunk.EXTENDED, CAR)["order"] == 5


def test_an_extrapolation_of_powers_that_the_error_has_not_promises_nothing():
    wrong = Extrapolated(pymunk.TUNED, "wrong", (1, 2, 3), (2, 3)).order(MOVING)
    assert isinstance(wrong, Unpromised)
    assert "order 1" in wrong.reason
    inside = Extrapolated(replace(mujoco.TUNED, drive="overwrite"), "overwritten", (1, 2), (4,)).order(DRIVEN)
    assert isinstance(inside, Unpromised)
    assert "overwritten" in inside.reason


@pytest.mark.parametrize(
    ("mechanism", "default", "tuned", "extended"),
    [
        (HANGING, *({"order": order, "gap": EXACT, "slip": EXACT} for order in (1, 4, 4))),
        (SPINNING, *({"order": EXACT} for _ in range(3))),
        (
            MOVING,
            {"order": 1},
            {"order": 2, "rate": 1, "slip": 1, "energy": 1, "reaction": 1, "integrator": 4},
            {"order": 4},
        ),
        (SKATE, {"order": 1, "gap": EXACT}, {"order": 1, "gap": EXACT, "slip": 2}, {"order": 4, "gap": EXACT}),
        (CAR, {"order": 1, "gap": EXACT}, {"order": 1, "gap": EXACT, "slip": 2}, {"order": 4, "gap": EXACT}),
        (ROLL, {"order": 1}, {"order": 1}, {"order": 4}),
    ],
)
def test_mujoco_promises_its_integrators_order_unless_a_row_knows_less(mechanism, default, tuned, extended):
    found = [told(engine, mechanism) for engine in (mujoco.DEFAULT, mujoco.TUNED, mujoco.EXTENDED)]
    assert found == [default, tuned, extended]


def test_mujocos_other_constructions_promise_their_own():
    stiff = next(engine for engine in mujoco.METHODS if engine.variant == "stiff Euler")
    assert told(stiff, MOVING) == {"order": 1, "gap": 2}
    assert told(stiff, DRIVEN) == {"order": 2, "rate": 1, "slip": 1, "energy": 1, "reaction": 1}
    free = next(engine for engine in mujoco.METHODS if engine.variant == "extended, free coordinates")
    assert told(free, HANGING) == {"order": 4}
    assert [told(engine, SKATE)["order"] for engine in SKATES] == [1]
    assert [told(engine, ROLL)["order"] for engine in ROLLS] == [1]
    for engine in DRIVES:
        assert isinstance(engine.order(DRIVEN), Unpromised)
        assert isinstance(engine.order(MOVING), Promise)


def test_exact_multipliers_promise_their_integrators_order_less_what_a_spring_costs():
    assert told(RK4, MOVING) == {"order": 4, "gap": EXACT, "slip": EXACT}
    assert told(EULER, DRIVEN) == told(RK4, DRIVEN) == {"order": EXACT}
    assert told(Lagrange("rk4", "none"), DRIVEN) == {"order": 4}
    assert told(Lagrange("rk4", "baumgarte"), MOVING)["order"] == 2
    assert told(Lagrange("dop853", "baumgarte"), MOVING) == {"order": 6}
    assert isinstance(TRUTH.order(MOVING), Unpromised)


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
    ids=lambda value: value if isinstance(value, str) else method_name(value),
)
def test_every_variant_says_who_holds_skates_contacts_and_slots(engine, skate, car, roll, gears, slider):
    found = [held_by(engine, mechanism) for mechanism in (SKATE, CAR, ROLL, GEARS, SLIDER)]
    assert found == [skate, car, roll, gears, slider]
    assert held_by(engine, DRIVEN) == "engine"


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


@dataclass(frozen=True)
class Divided(Toy):
    """Holds the first joint by itself, the others by our rows."""

    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return "engine" if joint == mechanism.joints[0] else "engine, our rows"


def test_joints_of_one_kind_that_differ_are_told_by_name():
    mechanism = four_bar()
    others = " and ".join(joint.name for joint in mechanism.joints[1:])
    assert held_by(Divided(), mechanism) == f"engine; {others}: engine, our rows"
