"""The constructions of a skate, and experiments in which they fail."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from engines import Engine, method_name
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from engines.registry import VARIANTS
from reference.chapter.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.joints import Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates import ChaplyginSleigh, HeldBySkates, SkateOnSlope, SleighBackwards
from reports.model.cells import Cell
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Motion
from reports.pages.common import described, to_rounding
from reports.write.experiments import observe_each
from reports.write.tables import number

SKATE_CONSTRUCTIONS: tuple[Engine, ...] = (*pymunk_methods.SKATE_METHODS, *mujoco_methods.SKATES)
_KNOWN = {method_name(engine): engine for engine in (*VARIANTS, *SKATE_CONSTRUCTIONS)}


def known(names: Iterable[str]) -> dict[str, Engine]:
    return {name: _KNOWN[name] for name in names if name in _KNOWN}


WITHOUT_EULER: tuple[Engine, ...] = tuple(
    engine for engine in VARIANTS if engine.name != "lagrange" or engine.variant.startswith("rk4")
)

# Rates [rad/s] between which a small rotation grows as in the linearised motion. Both rates are far above the initial
# rate. The squares of both rates are less than a thousandth of the largest squared rate.
LINEAR_GROWTH = (2e-3, 4e-2)


def growth_of(t: np.ndarray, rate: np.ndarray) -> float:
    """The slope of log |rate| over time [1/s] between the rates of LINEAR_GROWTH, or NaN if a rate is not reached."""
    speed = np.abs(rate)
    late = int(np.argmax(speed > LINEAR_GROWTH[1])) if np.any(speed > LINEAR_GROWTH[1]) else 0
    chosen = (np.arange(len(t)) < late) & (speed > LINEAR_GROWTH[0])
    if chosen.sum() < 3:
        return float("nan")
    return float(np.polyfit(t[chosen], np.log(speed[chosen]), 1)[0])


BACKWARDS = SleighBackwards()
TURNING_ROUND = tuple(Cell(BACKWARDS, engine, 1) for engine in (*WITHOUT_EULER, *SKATE_CONSTRUCTIONS))


def backwards(material: Material) -> list[Observation]:
    """The growth of a small rotation, and the time at which the sleigh turns round."""
    t = np.linspace(0, BACKWARDS.duration, BACKWARDS.samples + 1)
    truth = BACKWARDS.motion(t).twist[:, 0, 2]
    return [
        Observation("linearised exact motion", "", rf"grows as $e^{{{BACKWARDS.growth_rate():.4g}\,t}}$"),
        Observation("exact motion", "", _grown(t, truth)),
        *observe_each(material, TURNING_ROUND, lambda cell, run: _grown(run.t, run.twist[:, 0, 2])),
    ]


def _grown(t: np.ndarray, rate: np.ndarray) -> str:
    grows, fastest = growth_of(t, rate), float(np.abs(rate).max())
    if np.isnan(grows):
        return f"does not turn round: at most {number(fastest)} rad/s"
    return f"{grows:.4f} per second; fastest, {fastest:.3f} rad/s, at {t[np.argmax(np.abs(rate))]:.2f} s"


def _body(*joints: Pin | Skate) -> Mechanism:
    return Mechanism((Body("body", 2.0, 0.3, (0.0, 0.0, 0.0)),), joints)


def _skate(name: str, point: tuple[float, float], angle: float = 0.0) -> Skate:
    return Skate(name, None, "body", point, angle)


COUNTED: tuple[tuple[str, Mechanism], ...] = (
    ("free body", _body()),
    ("pinned body (18.62)", _body(Pin("pin", None, "body", (-0.5, 0.0), (-0.5, 0.0)))),
    ("one skate (18.64)", _body(_skate("one", (-0.5, 0.0)))),
    ("two skates on one axle", _body(_skate("left", (-0.5, 0.2)), _skate("right", (-0.5, -0.2)))),
    ("two skates in one line", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0)))),
    ("two skates, one steered", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0), 0.4))),
    ("a pin and a skate off it", _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0)))),
    (
        "a pin and a skate square to it",
        _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0), np.pi / 2)),
    ),
    ("three skates", HeldBySkates().mechanism()),
)


def counting(material: Material) -> list[Observation]:
    """Observations on COUNTED: degrees of freedom by rank and by Lie brackets, and integrability of the constraints."""
    observations = []
    for name, mechanism in COUNTED:
        configuration, velocity = mechanism.degrees_of_freedom()
        reached = freedoms_by_brackets(mechanism)[-1] if velocity else 0
        kind = "integrable" if mechanism_is_integrable(mechanism) else "not integrable"
        result = f"({configuration}, {velocity}); {kind}: of {configuration} it can reach {reached}"
        if velocity == 0:
            result = f"({configuration}, {velocity}): no motion is possible from any pose"
        rows = f"{mechanism.row_count} row{'' if mechanism.row_count == 1 else 's'}"
        observations.append(Observation(name, rows, result))
    return observations


SKATE_QUANTITIES = ("position", "angle", "slip", "energy")
VELOCITY_CHANGES = known(
    f"pymunk skate: {name}" for name in ("centre's velocity zeroed", "point's velocity zeroed", "impulse at the blade")
)
LONG_DURATION = 1000.0  # s
CIRCLING = ChaplyginSleigh(offset=0.0, duration=LONG_DURATION, horizon=LONG_DURATION)
COASTING_SLEIGH = ChaplyginSleigh(duration=LONG_DURATION, horizon=LONG_DURATION)
STRAIGHT_BACK = SleighBackwards(turning_rate=0.0, start=(0.0, 0.0, 0.3), duration=60.0, horizon=60.0)
WRONG, SLOPE, TURNING = ChaplyginSleigh(), SkateOnSlope(), SkateOnSlope(turning_rate=2.0)

SKATE_EXPERIMENTS = described(
    __file__,
    to_rounding(
        "No slip at all, and a wholly wrong motion",
        WRONG,
        (1, 10, 100),
        SKATE_QUANTITIES,
        engines=VELOCITY_CHANGES.values(),
    ),
    Failure("The sleigh run backwards", tasks=tuple(map(Motion, TURNING_ROUND)), observations=backwards),
    to_rounding("Straight back, for a minute", STRAIGHT_BACK, (1,), SKATE_QUANTITIES, 600),
    to_rounding("Coasting for 1000 s", COASTING_SLEIGH, (20,), SKATE_QUANTITIES, 1000),
    to_rounding("Circling for 1000 s", CIRCLING, (20,), SKATE_QUANTITIES, 1000),
    Failure("Friction too low to hold"),
    to_rounding("At rest across a slope", SLOPE, (1, 10), ("position", "slip", "reaction")),
    to_rounding("Turning on a slope", TURNING, (1, 10), SKATE_QUANTITIES),
    Failure("Counting freedoms of skates on one body", observations=counting),
    to_rounding("Held by three skates on a slope", HeldBySkates(), (1, 10), ("position", "angle", "slip", "reaction")),
    growth=rf"{{{BACKWARDS.growth_rate():g}\,t}}",
    rounded=f"{np.log(1e17) / BACKWARDS.growth_rate():.0f}",
    growing=LINEAR_GROWTH,
    circled=f"{CIRCLING.turning_rate * LONG_DURATION:.0f}",
)
