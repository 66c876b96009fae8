"""Many mechanisms from one of them and arrays of what differs: the same numbers as made one by one; what is refused."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import Lagrange, batch, differing, loading, stacked, varied
from reference.checks import InvalidMechanism
from reference.forces import Spring
from reference.joints import Drive, Pin, Roll, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reports.bench.judge import four_bars
from reports.search.mechanisms import mechanism as random_mechanism
from reports.search.parts import EVERY
from tests.mechanisms import four_bar


def numbers_of(parts: list[Any]) -> dict[str, np.ndarray]:
    """Every number of a joint or force, from many of them."""
    values = parts[0].__dict__.items()
    return {
        name: np.array([getattr(part, name) for part in parts]) for name, value in values if differing.is_number(value)
    }


def given(made: list[Mechanism]) -> dict[str, Any]:
    """All numbers of mechanisms of one shape, as `varied` takes them."""
    usual = made[0]
    groups = {
        kind: {
            part.name: numbers_of([getattr(m, kind)[index] for m in made])
            for index, part in enumerate(getattr(usual, kind))
            if not isinstance(part, Roll)
        }
        for kind in ("joints", "forces")
    }
    arrays = {name: np.array([getattr(m, name) for m in made]) for name in ("pose", "twist", "gravity")}
    inertias = np.array([m.inertias for m in made])
    return {**arrays, "mass": inertias[..., 0], "inertia": inertias[..., 2], **groups}


def larger(mechanism: Mechanism, factor: float) -> Mechanism:
    """With all lengths, speeds, masses, gravity and stiffnesses other ones, and the joints as well closed."""

    def scaled(part: Any, names: tuple[str, ...]) -> Any:
        there = {name: getattr(part, name) for name in names if hasattr(part, name)}
        return replace(
            part,
            **{n: tuple(factor * x for x in v) if isinstance(v, tuple) else factor * v for n, v in there.items()},
        )

    bodies = tuple(
        replace(
            body,
            mass=body.mass * factor,
            inertia=body.inertia * factor**3,
            pose=(*(factor * x for x in body.pose[:2]), body.pose[2]),
            twist=(*(factor * x for x in body.twist[:2]), body.twist[2]),
        )
        for body in mechanism.bodies
    )
    joints = tuple(
        part if isinstance(part, Roll) else scaled(part, ("first_point", "second_point", "length"))
        for part in mechanism.joints
    )
    forces = tuple(
        scaled(part, ("first_point", "second_point", "rest_length", "stiffness", "damping", "torque", "force"))
        for part in mechanism.forces
    )
    fall = mechanism.gravity
    return Mechanism(bodies, joints, (factor * fall[0], factor * fall[1]), forces)


WITHOUT_ROLLS = tuple(kind for kind in EVERY if kind != "roll")


@pytest.mark.parametrize("number", range(12))
def test_all_numbers_of_random_mechanisms_are_those_of_mechanisms_made_one_by_one(number):
    usual = random_mechanism(41, number, WITHOUT_ROLLS)
    made = [larger(usual, factor) for factor in (1.0, 0.5, 3.0)]
    found, expected = varied(made[0], **given(made)), stacked(tuple(made))
    np.testing.assert_array_equal(found.numbers, expected.numbers)
    np.testing.assert_array_equal(found.arrays.whole, expected.arrays.whole)


def test_what_is_not_given_stays_as_it_was():
    usual = four_bar(crank_rate=2.0)
    found = varied(usual, gravity=np.array([(0.0, -9.81), (1.0, 0.0)]))
    expected = stacked((replace(usual, gravity=(0.0, -9.81)), replace(usual, gravity=(1.0, 0.0))))
    np.testing.assert_array_equal(found.numbers, expected.numbers)


def test_drives_may_turn_at_rates_of_their_own():
    body = Body("wheel", 1.0, 0.5, (0.0, 0.0, 0.3), (0.0, 0.0, 2.0))
    axle, drive = Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0)), Drive("drive", None, "wheel", 2.0, 0.3)
    usual = Mechanism((body,), (axle, drive))
    rate = np.array([2.0, -5.0])
    twist = np.zeros((2, 1, 3))
    twist[:, 0, 2] = rate
    found = varied(usual, twist=twist, joints={"drive": {"turning_rate": rate}})
    other = replace(
        usual,
        bodies=(replace(body, twist=(0.0, 0.0, -5.0)),),
        joints=(axle, Drive("drive", None, "wheel", -5.0, 0.3)),
    )
    np.testing.assert_array_equal(found.numbers, stacked((usual, other)).numbers)


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_four_bars_from_arrays_move_as_scenes_of_the_same_lengths():
    usual = FreeFourBar(duration=1.0)
    crank, rocker = usual.crank * np.array([1.0, 0.97, 1.04]), usual.rocker * np.array([1.0, 1.03, 0.98])
    found = batch(four_bars(usual, crank, rocker), 0.05, 4, 1e-11)
    for number, (a, b) in enumerate(zip(crank.tolist(), rocker.tolist(), strict=True)):
        alone = Lagrange(tolerance=1e-11).build(replace(usual, crank=a, rocker=b).mechanism(), 0.05)(4, 1)
        # Starts are rounded in other ways; a tolerance of 1e-11 is what a motion of a quarter of a second keeps.
        np.testing.assert_allclose(found.pose[number], alone.pose, rtol=0, atol=1e-11)


PENDULUM = BarPendulum().mechanism()
JOINT = PENDULUM.joints[0].name


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "the arrays are of no mechanisms"),
        ({"mass": np.ones((2, 3))}, "mass is of 3 bodies; the mechanism has 1"),
        ({"mass": np.ones((2, 1)), "gravity": np.zeros((3, 2))}, "the arrays are of 2 and 3 mechanisms"),
        ({"mass": np.array([[1.0], [-1.0]])}, "greater than zero"),
        ({"joints": {"nobody": {}}}, "no joint is called 'nobody'"),
        ({"forces": {"nobody": {}}}, "no force is called 'nobody'; there are none"),
        ({"joints": 3}, "joints is 3; it must be names"),
        ({"joints": {JOINT: {"colour": [1.0]}}}, "has no number 'colour'; there are first_point, second_point"),
        ({"joints": {JOINT: {"first_point": [1.0, 2.0]}}}, r"of shape \(mechanisms, 2\)"),
        ({"joints": {JOINT: {"first_point": np.array([(0.0, 0.0), (0.0, 0.1)])}}}, "of mechanism 1 is open by 0.1 m"),
        ({"twist": np.array([[[0.0, 0.0, 0.0]], [[0.0, 0.3, 0.0]]])}, "of mechanism 1 is moving apart at 0.3 m/s"),
    ],
)
def test_numbers_that_do_not_fit_are_refused_by_name(arguments, words):
    with pytest.raises(InvalidMechanism, match=words):
        varied(PENDULUM, **arguments)


def test_the_mechanism_that_does_not_close_is_told_by_its_number_in_a_large_batch(monkeypatch):
    monkeypatch.setattr(import_module("engines.lagrange.varied"), "AT_A_TIME", 4)
    points = np.zeros((11, 2))  # where the ground's point of the usual pendulum is
    points[9, 0] = 0.25
    with pytest.raises(InvalidMechanism, match=r"of mechanism 9 is open by 0\.25 m"):
        varied(PENDULUM, joints={JOINT: {"first_point": points}})


def test_a_number_that_its_joint_would_refuse_is_refused():
    spring = Spring("spring", None, "bar", (3.0, 0.0), (0.0, 0.0), 2.0, 1.0)
    bar = replace(PENDULUM.bodies[0], name="bar")
    usual = Mechanism((bar,), (), (0.0, -9.81), (spring,))
    with pytest.raises(
        InvalidMechanism, match=r"stiffness of mechanism 1 is -2\.0; it must be a finite number greater than"
    ):
        varied(usual, forces={"spring": {"stiffness": [1.0, -2.0]}})
    here = np.array([(3.0, 0.0), bar.pose[:2]])
    with pytest.raises(InvalidMechanism, match="'spring' of mechanism 1: at t = 0 its two points coincide"):
        varied(usual, forces={"spring": {"first_point": here}})


def test_rows_that_are_dependent_in_one_mechanism_alone_are_refused():
    """A block between two slots, which are parallel in the second mechanism: then both hold the same."""
    block = Body("block", 1.0, 1.0, (0.0, 0.0, 0.0))
    slots = tuple(Slot(name, None, "block", (0.0, 0.0), angle, (0.0, 0.0)) for name, angle in (("a", 0.0), ("b", 1.0)))
    with pytest.raises(InvalidMechanism, match="the rows of mechanism 1 are dependent"):
        varied(Mechanism((block,), slots), joints={"b": {"line_angle": [1.0, 0.0]}})


def test_rolls_that_are_not_round_are_refused():
    with pytest.raises(Unsupported, match="only discs and rings"):
        varied(RollingEllipse().mechanism(), gravity=np.zeros((2, 2)))
