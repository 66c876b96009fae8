"""Tests that declared orders and enforcement follow from the settings of an engine and from the mechanism."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

from engines import EXACT, ConvergenceOrder, Enforcement, Engine, NotDeclared, method_name, mujoco, pymunk
from engines.extrapolated import Extrapolated
from engines.lagrange import TRUTH, Lagrange
from engines.motions import is_prescribed, starts_at_rest, turns_steadily
from engines.mujoco import methods as of_mujoco
from engines.pymunk import methods as of_pymunk
from reference.forces import Torque, TorsionDamper
from reference.joints import Drive, Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer
from reports.gate.change import Altered
from reports.write.columns import describe_enforcement
from tests.mechanisms import four_bar
from tests.toys import Toy

FREE, DRIVEN, SKATE = four_bar(), four_bar(crank_rate=2.0, drive=2.0), ChaplyginSleigh().mechanism()
SPINNING = Mechanism(
    (Body("disc", 1.0, 0.5, (0.0, 0.0, 0.0), (0.0, 0.0, 2.0)),), (Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0)),)
)
SLIDER = DrivenSliderCrank().mechanism()


def slot_off_the_centre() -> Mechanism:
    """A slider in a slot. The force of the slot turns the slider, since it does not act at the centre of mass."""
    joints = [joint for joint in SLIDER.joints if not (isinstance(joint, Drive) and joint.turning_rate == 0)]
    moved = (replace(joint, second_point=(0.1, 0.0)) if isinstance(joint, Slot) else joint for joint in joints)
    return replace(SLIDER, joints=tuple(moved))


def blade_at_the_centre() -> Mechanism:
    (body,), (skate,) = SKATE.bodies, SKATE.joints
    turning = replace(body, twist=(0.0, 0.0, 1.0))
    return replace(SKATE, bodies=(turning,), joints=(replace(skate, second_point=(0.0, 0.0)),))


MECHANISMS = {
    "from rest": FREE,
    "moving": four_bar(crank_rate=2.0),
    "driven": DRIVEN,
    "hanging": BarPendulum().mechanism(),
    "spinning": SPINNING,
    "skate": SKATE,
    "car": CarAndTrailer().mechanism(),
    "roll": RollingEllipse().mechanism(),
    "gears": EllipticGears().mechanism(),
    "slider": SLIDER,
    "slot off the centre": slot_off_the_centre(),
    "damped": replace(FREE, forces=(TorsionDamper("damper", None, "rocker", 0.1),)),
    "blade at the centre": blade_at_the_centre(),
}
LAGRANGE = (
    *(Lagrange("euler", "projection"), Lagrange("rk4", "projection"), Lagrange("rk4", "none"), TRUTH),
    *(Lagrange("rk4", "baumgarte"), Lagrange("dop853", "baumgarte")),
)
ENGINES: tuple[Engine, ...] = (
    *(pymunk.DEFAULT, pymunk.TUNED, pymunk.LEAPFROG, pymunk.EXTENDED, of_pymunk.SKATE_PROJECTED),
    *mujoco.VARIANTS,
    *(engine for engine in mujoco.METHODS if engine.variant in ("stiff Euler", "extended, free coordinates")),
    *(*of_mujoco.SKATES, *of_mujoco.ROLLS),
    *LAGRANGE,
    Extrapolated(of_pymunk.SKATE_PROJECTED, "twice", (2, 4), (1,)),
    Extrapolated(pymunk.TUNED, "of powers that the error has not", (1, 2, 3), (2, 3)),
)


def words(engine: Engine, mechanism: Mechanism) -> str:
    """A declared order as text. Fields with default values are left out."""
    promise = engine.order(mechanism)
    if isinstance(promise, NotDeclared):
        return "no order"
    values = {field.name: (getattr(promise, field.name), field.default) for field in fields(promise)}
    return ", ".join(f"{name} {value:.4g}" for name, (value, default) in values.items() if value != default)


def lines() -> Iterator[str]:
    for engine in dict.fromkeys(ENGINES):
        yield method_name(engine)
        for name, mechanism in MECHANISMS.items():
            yield f"  {name}: {words(engine, mechanism)}; held by: {describe_enforcement(engine, mechanism)}"


def test_declared_orders_and_enforcement_of_all_methods(golden):
    golden("promises.txt", "\n".join(lines()) + "\n")


def test_properties_of_a_motion_follow_from_joints_loads_and_start():
    motions = [FREE, MECHANISMS["moving"], DRIVEN, SPINNING]
    assert [starts_at_rest(motion) for motion in motions] == [True, False, False, False]
    assert [is_prescribed(one) for one in (FREE, DRIVEN, SKATE, MECHANISMS["gears"])] == [False, True, False, True]
    # Two skates leave a body with one degree of freedom of velocity, which a drive removes. Poses are not prescribed.
    blades = (Skate("right", None, "body", (1.0, 0.0), 0.0), Skate("up", None, "body", (0.0, 1.0), math.pi / 2))
    body = Body("body", 1.0, 0.5, (0.0, 0.0, 0.0), (2.0, -2.0, 2.0))
    driven = Mechanism((body,), (*blades, Drive("drive", None, "body", 2.0, 0.0)))
    assert driven.degrees_of_freedom() == (2, 0)
    assert not is_prescribed(driven)
    lagrange = Lagrange("rk4", "projection")
    assert lagrange.order(driven) == lagrange.order(SKATE) != lagrange.order(DRIVEN)
    assert [turns_steadily(one) for one in (SPINNING, MECHANISMS["hanging"], SKATE)] == [True, False, False]
    assert not turns_steadily(replace(SPINNING, gravity=(0.0, -9.81)))
    assert not turns_steadily(replace(SPINNING, forces=(Torque("brake", None, "disc", -1.0),)))
    arm = Body("arm", 1.0, 0.5, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    rim = Pin("rim", "disc", "arm", (1.0, 0.0), (0.0, 0.0))
    assert not turns_steadily(replace(SPINNING, bodies=(*SPINNING.bodies, arm), joints=(*SPINNING.joints, rim)))


def test_a_wrong_engine_has_the_declared_order_of_the_unchanged_mechanism():
    inside = mujoco.DEFAULT
    altered = Altered(inside, lambda mechanism: replace(mechanism, joints=mechanism.joints[:2]))
    assert (
        altered.regularisation(FREE, 1e-3)
        == inside.regularisation(FREE, 1e-3)
        != inside.regularisation(altered.change(FREE), 1e-3)
    )
    assert altered.order(FREE) == inside.order(FREE) != inside.order(altered.change(FREE))


def test_an_extrapolation_declares_its_rounding_and_the_steps_of_reactions():
    promise = pymunk.EXTENDED.order(MECHANISMS["moving"])
    assert isinstance(promise, ConvergenceOrder)
    assert (promise.order, promise.reaction, promise.differences, promise.of("gap")) == (6, 4, 8, 6)
    assert ConvergenceOrder(1, gap=EXACT).of("gap") == EXACT


@dataclass(frozen=True)
class Divided(Toy):
    """An engine that enforces the first joint. Our rows enforce all other joints."""

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "engine" if joint == mechanism.joints[0] else "engine, our rows"


def test_joints_of_one_kind_with_different_enforcement_are_named():
    others = " and ".join(joint.name for joint in FREE.joints[1:])
    assert describe_enforcement(Divided(), FREE) == f"engine; {others}: engine, our equations"
