"""Rods, gears, welds and force elements in the engines that are extras: each as the judge moves it, or refused by name.

MJX compiles what MuJoCo's adapter builds; its own are slow tests, in tests/engines/test_mjx.py.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import Engine, Promise, Unsupported, registry
from engines.lagrange import TRUTH
from reference.forces import Torque, TorsionSpring
from reference.joints import Gear, Pin, Weld
from reference.mechanism import Body, Mechanism
from reference.scenes.andrews import Andrews
from tests.all_elements import ALL, ALONE, DAMPED, GRAVITY
from tests.engines.test_other_engines import QUICKLY, installed, shipped

SAMPLES, SPACING = 6, 0.05
MECHANISMS = {**ALONE, "all": ALL, "all damped": DAMPED}
# What each builds of them. A loop of rows that repeat is no matter of the vocabulary, and has a test of its own.
ELEMENTS = {*MECHANISMS} - {"weld in a loop"}
PINNED = {"torsion spring", "torsion damper", "torque", "force", "weld", "weld to the ground"}
BUILDS = {
    "exudyn": ELEMENTS,
    "box2d": ELEMENTS - {"gear", "all", "all damped"},
    "pinocchio": PINNED | {"spring", "damper"},
    "bullet": PINNED,  # and no body that hangs on nothing
}
each = pytest.mark.parametrize("engine", QUICKLY, ids=registry.method)


def missed(engine: Engine, mechanism: Mechanism, every: int) -> float:
    exact = TRUTH.build(mechanism, SPACING)(SAMPLES, 1)
    run = engine.build(mechanism, SPACING / every)(SAMPLES, every)
    return float(np.abs(run.pose - exact.pose).max())


@each
@pytest.mark.parametrize("name", sorted(ELEMENTS))
def test_each_element_moves_as_the_judge_moves_it_or_is_refused_by_name(engine, name):
    installed(engine)
    mechanism = MECHANISMS[name]
    if name not in BUILDS[engine.name]:
        named = [repr(part.name) for part in (*mechanism.joints, *mechanism.bodies, *mechanism.forces)]
        with pytest.raises(Unsupported) as refused:
            engine.build(mechanism, 1e-3)
        assert any(word in str(refused.value) for word in named)
        return
    errors = [missed(engine, mechanism, every) for every in (20, 40)]
    promise = engine.order(mechanism)
    order = min(promise.order, 4) if isinstance(promise, Promise) else 0
    # 1e-8: Newton's tolerance as shipped; of soft joints a tenth of a millimetre a millisecond of step is left.
    assert errors[1] < max(1e-8, 1.3 * errors[0] / 2**order, 2e-3 if not order else 0.0)
    assert errors[1] < 1e-2


@pytest.mark.parametrize("name", BUILDS)
def test_a_stiffer_spring_would_be_noticed(name):
    engine = shipped(name)
    spring = TorsionSpring("spring", "a", "b", 5.0, 0.4)
    mechanism = replace(ALONE["torsion spring"], forces=(spring,))
    exact = TRUTH.build(mechanism, SPACING)(SAMPLES, 1).pose
    stiffer = replace(mechanism, forces=(replace(spring, stiffness=6.0),))
    right, wrong = (
        np.abs(engine.build(one, SPACING / 200)(SAMPLES, 200).pose - exact).max() for one in (mechanism, stiffer)
    )
    assert wrong > 10 * right


def gears(first: str, second: str, ratio: float) -> Mechanism:
    """Two wheels on the ground, out of centre, in mesh; a torque turns one of them."""
    angle = {"a": 0.3, "b": 0.5}
    wheels = (Body("a", 1.0, 0.3, (0.2, 0.0, 0.3)), Body("b", 1.0, 0.2, (1.1, 0.0, 0.5)))
    pins = tuple(
        Pin(wheel.name.upper(), None, wheel.name, (x, 0.0), (away * np.cos(turned), -away * np.sin(turned)))
        for wheel, x, away, turned in zip(wheels, (0.0, 1.0), (-0.2, -0.1), (0.3, 0.5), strict=True)
    )
    gear = Gear("mesh", first, second, ratio, angle[second] - ratio * angle[first])
    return Mechanism(wheels, (*pins, gear), GRAVITY, (Torque("motor", None, "a", 1.7),))


@pytest.mark.parametrize(("first", "second"), [("a", "b"), ("b", "a")])
@pytest.mark.parametrize("engine", [one for one in QUICKLY if one.name in ("exudyn", "bullet")], ids=registry.method)
def test_gears_on_the_ground_turn_each_other_by_their_ratio(engine, first, second):
    installed(engine)
    mechanism = gears(first, second, -2.5)
    errors = [missed(engine, mechanism, every) for every in (10, 20)]
    assert errors[1] < max(1e-8, 1.3 * errors[0] / 2 ** min(engine.order(mechanism).order, 4))
    assert missed(engine, gears(first, second, -2.4), 20) < 1e-2
    exact = TRUTH.build(mechanism, SPACING)(SAMPLES, 1).reaction
    told = engine.build(mechanism, SPACING / 40)(SAMPLES, 40).reaction
    assert np.abs(told - exact)[2:].max() < 1e-2 * np.abs(exact).max()
    if engine.name == "bullet":
        hung = ALONE["weld"].bodies[1].name
        chained = replace(ALONE["torque"], joints=(*ALONE["torque"].joints, Gear("mesh", "a", hung, 2.0, 0.5 - 0.6)))
        with pytest.raises(Unsupported, match="joint 'mesh': a gear of bullet is between two of its joints"):
            engine.build(chained, 1e-3)


@pytest.mark.parametrize("name", BUILDS)
def test_a_weld_that_closes_a_loop_moves_as_the_judge_moves_it(name):
    engine = shipped(name)
    whole = ALONE["weld in a loop"]
    once = replace(whole, joints=tuple(joint for joint in whole.joints if joint.name != "weld"))
    assert sum(isinstance(joint, Weld) for joint in once.joints) == 1
    assert missed(engine, once, 200) < 1e-2  # soft joints as shipped; it turns by 0.1 rad


@each
def test_andrews_mechanism_is_built_and_followed(engine):
    """Its crank makes nine turns in 0.03 s: over the first fifth of them, where no engine has lost it yet."""
    installed(engine)
    scene = Andrews()
    samples = scene.samples // 5
    run = engine.build(scene.mechanism(), scene.spacing / 20)(samples, 20)
    miss = np.abs(run.pose - scene.motion(run.t).pose)[..., 2].max()
    turned = np.abs(run.pose[-1, 0, 2] - run.pose[0, 0, 2])
    promise = engine.order(scene.mechanism())
    assert miss < (0.1 if isinstance(promise, Promise) else 0.5) * turned
