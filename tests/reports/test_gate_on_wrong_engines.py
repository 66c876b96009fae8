"""Wrong engines under another name, asked as a new engine is: by theory alone, in a motion that drives prescribe."""

from __future__ import annotations

from functools import cache
from typing import cast

import pytest

from engines import Engine, box2d, mujoco, pymunk
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.gate.prediction import prediction
from reports.gate.theory import Case, checks, kinds
from reports.model.checks import Check
from reports.model.measure import measure
from tests.wrong.adapters import MISTAKES, SMALL, Wrong

SCENE = DrivenFourBar()
ENGINES: dict[str, Engine] = {"pymunk": pymunk.TUNED, "mujoco": mujoco.TUNED, "box2d": box2d.VARIANTS[1]}
ASKED = (
    *SMALL,
    "velocities are half a step late",
    "velocities are of the step before",
    "reactions are twice as large",
    "reactions have the other sign",
)

# What can't be told from the method's own error there, in rad, m, rad/s or parts of the largest reaction.
SYMMETRIC = (
    "its own velocities are half a step early, so a step before they are half a step late: 7.6e-4 rad/s at 1e-5 s"
)
ROUGH = "no order is promised, and at its finest step a reaction is wrong by 0.07 and a rate by 0.024 rad/s; "
UNSEEN: dict[tuple[str, str], str] = {
    ("pymunk", "velocities are of the step before"): SYMMETRIC,
    ("box2d", "a mass is 1 % off"): ROUGH + "the mistake makes 0.004 of a reaction",
    ("box2d", "a mass is 0.1 % off"): ROUGH + "the mistake makes 0.0004 of a reaction",
    ("box2d", "an inertia is 10 % off"): ROUGH + "the mistake makes 0.008 of a reaction",
    ("box2d", "gravity is 9.80"): ROUGH + "the mistake makes 0.0003 of a reaction",
    ("box2d", "velocities are 1.001 times as large"): ROUGH + "the mistake makes 0.01 rad/s",
    ("box2d", "poses are of single precision"): "its own numbers are of single precision",
    ("box2d", "reactions are 1.01 times as large"): ROUGH + "the mistake makes 0.01 of a reaction",
    ("box2d", "reactions are 1.1 times as large"): ROUGH + "the mistake makes 0.1 of it, and half is let through",
    ("box2d", "velocities are half a step late"): ROUGH + "the mistake makes 0.025 rad/s",
    ("box2d", "velocities are of the step before"): ROUGH + "the mistake makes 0.05 rad/s",
}


@cache
def found(name: str, mistake: str) -> tuple[Check, ...]:
    """The checks that an engine with this mistake fails."""
    engine = cast(Engine, Wrong(mistake, ENGINES[name]))
    if ENGINES[name].missing:
        pytest.skip(ENGINES[name].missing)
    case = Case(SCENE, engine, engine.order(SCENE.mechanism()))
    rows = [measure(cell, repeat=False) for cell in case.cells()]
    judge = prediction(SCENE, kinds(SCENE, [engine]))
    return tuple(check for check in checks(case, rows, judge) if not check.passed)


@pytest.mark.parametrize("name", ENGINES)
def test_a_right_engine_passes_under_another_name(name: str) -> None:
    assert found(name, "nothing") == ()


@pytest.mark.parametrize("mistake", ASKED)
@pytest.mark.parametrize("name", ENGINES)
def test_a_wrong_engine_fails_unless_the_mistake_is_below_the_methods_own_error(name: str, mistake: str) -> None:
    assert bool(found(name, mistake)) is ((name, mistake) not in UNSEEN), UNSEEN.get((name, mistake))


def test_every_reason_is_of_a_mistake_that_is_made() -> None:
    assert {mistake for _, mistake in UNSEEN} <= {*ASKED} <= {*SMALL, *MISTAKES}
    assert {name for name, _ in UNSEEN} <= {*ENGINES}
