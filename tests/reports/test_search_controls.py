"""Positive controls: a fault that is planted in the adapter of an extra engine is found by the search.

Faults are of a ten-thousandth, or a sign. An engine that promises an order is held to the judge's motion, in the
variant whose own error is the least: what falls with the step must hide nothing. Box2D is held to the law of its first
step, and MJX to that of one instant.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np
import pytest

from engines import Engine, Unsupported, box2d, bullet, exudyn, mjx, pinocchio
from engines.conformance.same import Isometry
from reference.checks import InvalidMechanism
from reports.gate.change import Altered
from reports.search import instant_mujoco, relations
from reports.search.mechanisms import RUN, SHAPES, of_a_shape
from reports.search.recipe import build
from reports.search.subjects import Adapted, Told
from tests.wrong.mistakes import FORCES, plant, planted

SEED = 1
SMALL = 1e-4


def asked(engine: Engine, kinds: tuple[str, ...], cases: int, oracle: str) -> Iterator[Told]:
    subject = Adapted(engine)
    for number in range(cases):
        try:
            told = subject.ask(subject.draw(SEED, number, kinds, 0), number, (oracle,))
        except (InvalidMechanism, np.linalg.LinAlgError):  # the planted fault makes no mechanism of this one
            continue
        if told.errors:
            yield told


def is_found(engine: Engine, kinds: tuple[str, ...], cases: int, oracle: str) -> bool:
    return any({*told.faults} - {"raised"} for told in asked(engine, kinds, cases, oracle))


# By kind of joint: what an engine takes, in the variant that hides least.
LEAST = {
    "exudyn": (exudyn.EXTENDED, ("pin", "slot", "rod", "weld", "gear", "skate", "roll", "drive", "inertia", *FORCES)),
    # What force elements do to these two is worked out by one function for all kinds.
    "bullet": (bullet.EXTENDED, ("pin", "weld", "gear", "inertia", "spring", "force")),
    "pinocchio": (pinocchio.TUNED, ("pin", "weld", "inertia", "damper", "force")),
}
PLANTED = [(engine, kind) for engine, kinds in LEAST.values() for kind in kinds]


@pytest.mark.parametrize(("engine", "kind"), PLANTED, ids=lambda value: getattr(value, "name", value))
def test_a_planted_fault_is_found_in_the_motion(engine: Engine, kind: str) -> None:
    if engine.missing:
        pytest.skip(engine.missing)
    kinds = ("pin",) if kind in ("pin", "inertia") else ("pin", kind)
    # The first that shows it ends this; gears of Bullet are between bodies on the ground alone, so most are refused.
    assert is_found(Altered(engine, planted(kind, SMALL)), kinds, 60, "motions")
    right = list(islice(asked(engine, kinds, 40, "motions"), 2))
    assert right
    assert not [told for told in right if told.faults]


@pytest.mark.parametrize("kind", ["pin", "slot", "rod", "weld", "inertia", *FORCES])
def test_a_planted_fault_of_a_thousandth_is_found_in_single_precision(kind: str, monkeypatch: Any) -> None:
    """Ten times as large as elsewhere: of 60 mechanisms of pins an inertia off by 1e-3 is found in 26, by 1e-4 in 5."""
    engine = box2d.DEFAULT
    if engine.missing:
        pytest.skip(engine.missing)
    kinds = ("pin",) if kind in ("pin", "inertia") else ("pin", kind)
    right = list(asked(engine, kinds, 40, "instant"))
    assert len(right) >= 4  # of slots, whose bodies seldom have no other joint
    assert not [told for told in right if told.faults]
    plant(monkeypatch, planted(kind, 1e-3))
    assert is_found(engine, kinds, 40, "instant")


def test_what_box2d_rounds_grows_with_the_distance() -> None:
    """So that differences of two descriptions are rounded places, and nothing that the shift itself does."""
    engine = box2d.DEFAULT
    if engine.missing:
        pytest.skip(engine.missing)
    subject = Adapted(engine)
    growth = []
    for number in (7, 20, 31, 44, 60):
        right = build(subject.draw(3, number, ("pin", "slot", "rod", "weld", "spring", "force", "torque"), 0))
        apart = []
        for far in (100.0, 1000.0):
            changed, back = Isometry(shift=(0.37 * far, -0.29 * far))(right)
            step = relations.STEP * right.time_scale
            runs = [engine.build(each, step)(1, relations.STEPS) for each in (right, changed)]
            apart.append(np.abs(back(runs[1])[1][-1] - runs[0].twist[-1]).max())
        growth.append(apart[1] / apart[0])
    assert 3 < np.median(growth) < 30  # ten, as the distance


# ---------------------------------------------------------------------------------------------------------------- MJX


@pytest.fixture
def compiled() -> None:
    if mjx.DEFAULT.missing:
        pytest.skip(mjx.DEFAULT.missing)


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_mjx_lacks_the_velocity_term_of_loops_and_nothing_else() -> None:
    told = [
        each
        for first in range(RUN, SHAPES * RUN, 2 * RUN)  # those with loops
        for number in range(first, first + 3)
        for each in [Adapted(mjx.TUNED).ask(_shaped(number), number, ("instant",))]
    ]
    assert sum("acceleration" in each.faults for each in told) >= 3
    assert not [each for each in told if instant_mujoco.WITHOUT in each.faults]


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("kind", ["inertia", "force"])
def test_a_fault_planted_in_mjx_is_found(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    plant(monkeypatch, planted(kind, SMALL))
    found = {
        check for number in range(4) for check in Adapted(mjx.TUNED).ask(_shaped(number), number, ("instant",)).faults
    }
    assert instant_mujoco.WITHOUT in found


def _shaped(number: int) -> Any:
    return of_a_shape(mjx.TUNED, SEED, number, ("pin", "force"), 0)


def test_cases_of_a_shape_differ_in_numbers_alone() -> None:
    if mjx.DEFAULT.missing:
        pytest.skip(mjx.DEFAULT.missing)
    cases = [_shaped(number) for number in range(SHAPES * RUN)]
    shapes = {tuple((link.kind, link.first, link.second) for link in case.links) for case in cases}
    assert len(shapes) <= SHAPES
    assert len({*cases}) == len(cases)
    for case in cases[::RUN]:
        try:
            mjx.TUNED.build(build(case), 1e-3)
        except Unsupported as reason:
            pytest.fail(str(reason))
