"""Comparison of every engine with the judge. An element or configuration has the declared order, or is refused.

Tests of an engine that is not installed are skipped with the name of its extra. test_other_engines.py tests MJX.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from engines import EXACT, ConvergenceOrder, Engine, Unsupported, method_name, mujoco, pymunk, registry
from engines.lagrange import TRUTH
from reference.forces import Force, Torque, TorsionSpring
from reference.joints import Drive, Gear, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import SCENES, scene
from reports.model.cells import SLOW_TO_BUILD
from tests.mechanisms import ALL, ALONE, DAMPED, GRAVITY
from tests.reference.test_scenes import in_other_units

QUICKLY = tuple(engine for engine in registry.OTHERS if engine.build_time < SLOW_TO_BUILD)
ENGINES = (*registry.ENGINES, *QUICKLY)
FURTHER = tuple(engine for engine in QUICKLY if engine.variant != "default")


def installed(engine: Engine) -> Engine:
    """Return the engine, or skip the test with the name of the package."""
    if engine.missing:
        pytest.skip(engine.missing)
    return engine


def shipped(name: str) -> Engine:
    return installed(next(engine for engine in QUICKLY if engine.name == name))


def block(name: str, pose: tuple[float, float, float], twist: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Body:
    return Body(name, 1.0, 0.1, pose, twist)


HUNG = (Pin("hinge", None, "first", (0.0, 0.0), (-0.5, 0.0)), Pin("joint", "first", "second", (0.5, 0.0), (-0.5, 0.0)))
TWO = (block("first", (0.5, 0.0, 0.0)), block("second", (1.5, 0.0, 0.0), (0.0, -1.0, -2.0)))
WHEELS = (Body("a", 1.0, 0.3, (0.2, 0.0, 0.3)), Body("b", 1.0, 0.2, (1.1, 0.0, 0.5)))
AXLES = tuple(
    Pin(wheel.name.upper(), None, wheel.name, (x, 0.0), (away * np.cos(turned), -away * np.sin(turned)))
    for wheel, x, away, turned in zip(WHEELS, (0.0, 1.0), (-0.2, -0.1), (0.3, 0.5), strict=True)
)


def meshed(ratio: float, first: str = "a", second: str = "b") -> Mechanism:
    """Two eccentric wheels on the ground with a gear between them. A torque acts on one wheel."""
    angle = {"a": 0.3, "b": 0.5}
    gear = Gear("mesh", first, second, ratio, angle[second] - ratio * angle[first])
    return Mechanism(WHEELS, (*AXLES, gear), GRAVITY, (Torque("motor", None, "a", 1.7),))


# Further configurations: a drive or slot with bodies in the opposite order, an angle of more than a turn, two forces on
# one body, and speeds at which limits or the sleep of an engine could act.
CONFIGURATIONS = {
    "a drive against its pin": Mechanism(TWO, (*HUNG, Drive("motor", "second", "first", 2.0, 0.0)), GRAVITY),
    "a held angle against its slot": Mechanism(
        (TWO[0], block("second", (0.8, 0.0, 0.4))),
        (
            HUNG[0],
            Slot("guide", "first", "second", (0.3, 0.0), 0.0, (0.0, 0.0)),
            Drive("held", "second", "first", 0.0, -0.4),
        ),
        GRAVITY,
    ),
    "a spring wound up by more than a turn": Mechanism(
        (block("wheel", (0.0, 0.0, 0.0), (0.0, 0.0, 30.0)),),
        (Pin("hub", None, "wheel", (0.0, 0.0), (0.0, 0.0)),),
        (0.0, 0.0),
        (TorsionSpring("spring", None, "wheel", 0.1),),
    ),
    "gears on the ground": meshed(-2.5),
    "gears on the ground, named the other way": meshed(-0.4, "b", "a"),
    "a torque between two bodies": Mechanism(TWO, HUNG, (0.0, 0.0), (Torque("torque", "first", "second", 1.0),)),
    "two forces on a body": Mechanism(
        (TWO[0],),
        HUNG[:1],
        (0.0, 0.0),
        (Force("one", "first", (0.5, 0.0), (0.0, 2.0)), Force("other", "first", (0.2, 0.1), (1.0, -1.0))),
    ),
    "faster than any usual limit": Mechanism((block("shot", (0.0, 0.0, 0.0), (1000.0, 0.0, 0.0)),), ()),
    "too slow to stay awake": Mechanism((block("drifting", (0.0, 0.0, 0.0), (1e-3, 2e-3, 1e-3)),), ()),
    # Free and driven linkages, a linkage with a slider, and chains.
    **{name: scene(name).mechanism() for name in ("free_four_bar", "driven_slider_crank", "pendulum_2", "pendulum_10")},
    "weld that closes a loop": replace(
        ALONE["weld in a loop"], joints=tuple(joint for joint in ALONE["weld in a loop"].joints if joint.name != "weld")
    ),
}
MECHANISMS = {**ALONE, "all": ALL, "all damped": DAMPED, **CONFIGURATIONS}
# Sets of elements. BUILDS contains the elements that an engine or a method builds.
PINNED = {
    *("torsion spring", "torsion damper", "torque", "force", "weld", "weld to the ground", "two forces on a body")
}
PINNED |= {"pendulum_2", "pendulum_10", "a spring wound up by more than a turn", "a torque between two bodies"}
LOOPS = {"free_four_bar", "weld that closes a loop"}
UNFORCED = {"weld", "weld to the ground", "pendulum_2", "pendulum_10"}
FLYING = {"faster than any usual limit", "too slow to stay awake"}
GROUNDED_GEARS = {"gears on the ground", "gears on the ground, named the other way"}
DRIVEN = {"a drive against its pin", "a held angle against its slot", "driven_slider_crank"}
UNCONSTRAINED = PINNED | FLYING | {"spring", "damper", "a held angle against its slot"}
BUILDS = {
    "exudyn": {*MECHANISMS},
    "box2d": PINNED | FLYING | LOOPS | DRIVEN | {"spring", "damper", "rod", "rod to the ground"},
    "pinocchio": PINNED | LOOPS | FLYING | DRIVEN | {"spring", "damper"},
    "bullet": PINNED | LOOPS | DRIVEN | GROUNDED_GEARS,
    **{name: UNFORCED | LOOPS | FLYING | DRIVEN | {"rod", "rod to the ground"} for name in ("planck", "p2", "jolt")},
    "rapier": (UNFORCED | LOOPS | FLYING | DRIVEN) - {"a held angle against its slot"},
    "drake": {*MECHANISMS} - {"gear", "all", "all damped"},
    "drake tuned": UNCONSTRAINED,
    "drake cenic": UNCONSTRAINED | GROUNDED_GEARS,
}
SAMPLES, SPACING = 6, 0.05
# Engine -> error that does not fall with the step. Causes are the tolerance of the solver, the large inertia of drives,
# and single precision.
SMALL = {
    "exudyn": 1e-8,
    "box2d": 1e-4,
    "pinocchio": 1e-8,
    "bullet": 1e-8,
    "planck": 1e-8,
    **dict.fromkeys(("p2", "rapier", "jolt"), 1e-4),
    "drake": 1e-8,
    "mujoco": 1e-9,
    "pymunk": 1e-11,
    "lagrange": 1e-11,
}


def span(name: str) -> float:
    """Return a duration [s] in which errors grow at most linearly: a tenth of a scene's duration, or 0.3 s."""
    return 0.1 * scene(name).duration if name in {scene_.name for scene_ in SCENES} else SAMPLES * SPACING


@cache
def exact(name: str) -> np.ndarray:
    return TRUTH.build(MECHANISMS[name], span(name) / SAMPLES)(SAMPLES, 1).pose


def missed(engine: Engine, own: Mechanism, name: str, every: int) -> float:
    """The largest error of poses, in rad and in lengths of the mechanism."""
    run = engine.build(own, span(name) / SAMPLES / every)(SAMPLES, every)
    assert run.reset_at is None
    return float((np.abs(run.pose - exact(name)) / own.pose_unit).max())


# Extra engines need not solve loops with redundant rows. Daily tests run a third of the mechanisms in each engine, and
# a ninth in further variants of extra engines.
CELLS = [
    pytest.param(
        engine, name, marks=() if (place + number) % (9 if engine in FURTHER else 3) == 0 else pytest.mark.slow
    )
    for place, engine in enumerate(ENGINES)
    for number, name in enumerate(MECHANISMS)
    if name != "weld in a loop" or engine not in QUICKLY
    if (engine.name, name) != ("rapier", "faster than any usual limit")  # Rapier reduces velocities.
]


def label(value: Engine | str) -> str:
    return value if isinstance(value, str) else method_name(value)


@pytest.mark.parametrize(("engine", "name"), CELLS, ids=label)
def test_an_engine_has_its_declared_order_or_refuses_the_element_by_name(engine: Engine, name: str) -> None:
    installed(engine)
    linkage = MECHANISMS[name]
    if name not in BUILDS.get(method_name(engine), BUILDS.get(engine.name, MECHANISMS)):
        named = [repr(part.name) for part in (*linkage.joints, *linkage.bodies, *linkage.forces)]
        with pytest.raises(Unsupported) as refused:
            engine.build(linkage, 1e-3)
        assert any(element_name in str(refused.value) for element_name in named), str(refused.value)
        return
    # At these steps errors of order 1 are far larger than errors of order 2. Errors of fourth-order
    # methods are far above rounding.
    coarse, fine = (missed(engine, linkage, name, every) for every in (40, 80))
    way = np.abs(exact(name) - exact(name)[0]).max() / linkage.length_scale
    promise = engine.order(linkage)
    soft = [engine.regularisation(linkage, span(name) / SAMPLES / every) for every in (40, 80)]
    if not isinstance(promise, ConvergenceOrder) or (
        soft[0] is not None and soft[0] == soft[1] and soft[0].compliance > 1e-6
    ):
        assert fine < max(0.05, 0.1 * way)  # A constant compliance causes a plateau of the error.
        return
    order = promise.of("angle")
    assert fine < max(SMALL[engine.name] * max(1.0, way), 1.3 * coarse / 2 ** min(order, 4)) or order == EXACT
    assert fine < 0.1 * max(1.0, way)


# ------------------------------------------------------------------------------------------------------- other units


def in_units(engine: Engine, name: str, length: float = 1.0, mass: float = 1.0) -> list[np.ndarray]:
    """Run the scene in other units, and return poses, twists and reactions in metres and kilograms."""
    linkage = in_other_units(scene(name), (length, 1.0, mass)).mechanism()
    run = engine.build(linkage, 1e-3)(5, 10)
    unit, arm = np.array([length, length, 1.0]), np.where(linkage.is_angular, length**2, length)
    return [run.pose / unit, run.twist / unit, run.reaction / (mass * arm)]


# By default MuJoCo's impedance depends on the gap in metres, and the tolerance of its solver has the unit m/s^2.
OWN = (*pymunk.VARIANTS, mujoco.TUNED, mujoco.EXTENDED)
UNITS = [(2.0**-10, 1.0), (1.0, 1e6)]


@pytest.mark.parametrize("name", ["free_four_bar", "driven_slider_crank", "car_and_trailer"])
@pytest.mark.parametrize("engine", OWN, ids=label)
def test_methods_do_not_depend_on_units_of_length_and_mass(engine: Engine, name: str) -> None:
    linkage = in_units(engine, name)
    for length, mass in UNITS:
        # A stiff spring amplifies rounding. Reactions are changes of velocity over 1e-4 s, which also amplifies
        # rounding.
        for changed, right, allowed in zip(
            in_units(engine, name, length, mass), linkage, (1e-9, 1e-9, 1e-6), strict=True
        ):
            assert np.abs(changed - right).max() < allowed * max(1.0, np.abs(right).max())
