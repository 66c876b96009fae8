"""Motions of many mechanisms in one loop are those of single runs, and a mechanism that needs a single run gets one."""

from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import Batch, Lagrange, ParameterSweep, batch, loading, run_batch
from reference.checks import InvalidMechanism
from reference.joints import Body, Drive, Pin, Rod, Roll
from reference.mechanism import Mechanism
from reference.scenes.catalogue import scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.search.mechanisms import mechanism as random_mechanism
from reports.search.parts import ALL_KINDS
from tests.mechanisms import four_bar, pendulum

pytestmark = pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
DOP853 = Lagrange()


def largest_difference(found: Batch, number: int, mechanism: Mechanism, engine: Lagrange, dt: float) -> float:
    """The difference from a single run, in units of the mechanism's length and time scale."""
    samples = len(found.t) - 1
    every = round(found.t[1] / dt)
    run = engine.build(mechanism, dt)(samples, every)
    assert found.warnings.get(number, ()) == run.warnings
    pose = np.abs((found.pose[number] - run.pose) / mechanism.pose_unit).max()
    return float(
        max(pose, np.abs((found.twist[number] - run.twist) * mechanism.time_scale / mechanism.pose_unit).max())
    )


@pytest.fixture(autouse=True)
def small_groups_are_compiled(monkeypatch):
    monkeypatch.setattr(batch, "WORTH_COMPILING", 0.0)


@pytest.fixture
def no_mechanism_is_run_alone(monkeypatch):
    """A wrong program would open joints, and single runs would hide that."""
    run_alone = batch._Loop._run_alone

    def refuse(loop, mechanisms):
        assert not len(mechanisms)
        return run_alone(loop, mechanisms)

    monkeypatch.setattr(batch._Loop, "_run_alone", refuse)


@pytest.mark.usefixtures("no_mechanism_is_run_alone")
@pytest.mark.parametrize(
    "engine", [DOP853, Lagrange("rk4", "baumgarte"), Lagrange("euler", "none")], ids=lambda engine: engine.variant
)
def test_four_bars_of_random_sizes_move_as_in_single_runs(engine):
    random = np.random.default_rng(3)
    sizes = 1 + 0.05 * random.uniform(-1, 1, (21, 2))  # two full vectors and a part of a vector
    scenes = [FreeFourBar(crank=0.4 * a, rocker=1.1 * b) for a, b in sizes.tolist()]
    mechanisms = [scene.mechanism() for scene in scenes]
    found = run_batch(engine, mechanisms, 2e-3, 4, 5, workers=2)
    # A spring of Baumgarte divides rounding errors by the square of the step.
    allowed = 1e-10 if engine.stabilisation == "baumgarte" else 1e-12
    for number, mechanism in enumerate(mechanisms):
        assert largest_difference(found, number, mechanism, engine, 2e-3) < allowed


def test_mixed_random_mechanisms_move_as_in_single_runs(monkeypatch):
    mechanisms = [random_mechanism(21, number, ALL_KINDS) for number in range(12)]
    kinds = {type(joint).__name__ for mechanism in mechanisms for joint in mechanism.joints}
    assert {"Pin", "Slot", "Skate", "Rod", "Gear", "Weld", "Drive", "Roll"} <= kinds
    dt = 1e-3 * min(mechanism.time_scale for mechanism in mechanisms)
    alone, run_alone = [], batch._Loop._run_alone
    monkeypatch.setattr(batch._Loop, "_run_alone", lambda loop, own: alone.extend(own) or run_alone(loop, own))
    found = run_batch(Lagrange("rk4"), mechanisms, dt, 3, 2)
    assert all(any(isinstance(joint, Roll) for joint in mechanism.joints) for mechanism in alone)
    for number, mechanism in enumerate(mechanisms):
        assert largest_difference(found, number, mechanism, Lagrange("rk4"), dt) < 1e-12


@pytest.mark.usefixtures("no_mechanism_is_run_alone")
def test_a_sweep_moves_its_start_onto_the_joints_and_agrees_with_single_runs():
    mechanism = four_bar(crank_rate=3.0, drive=3.0)
    (crank,) = (joint for joint in mechanism.joints if isinstance(joint, Drive))
    pin = mechanism.joints[1]
    assert isinstance(pin, Pin)
    count = 11
    values = np.linspace(0.9, 1.1, count)
    point = np.array(pin.second_point) + np.outer(values - 1, [0.3, 0.1])
    numbers = {
        f"{mechanism.bodies[1].name}.mass": values,
        f"{pin.name}.second_point": point,
        f"{crank.name}.turning_rate": 3.0 * values,
        "gravity": np.outer(values, [1.0, -9.0]),
    }
    found = run_batch(DOP853, ParameterSweep(mechanism, numbers), 1e-2, 5)
    sweep = ParameterSweep(mechanism, numbers, found.pose[:, 0], found.twist[:, 0])
    for number in range(count):
        alone = sweep.alone(number, found.pose[number, 0], found.twist[number, 0])
        assert alone.gravity == (values[number], -9.0 * values[number])
        assert largest_difference(found, number, alone, DOP853, 1e-2) < 1e-12
    np.testing.assert_allclose(run_batch(DOP853, sweep, 1e-2, 5).pose, found.pose, rtol=0, atol=1e-14)


@pytest.mark.usefixtures("no_mechanism_is_run_alone")
def test_angles_in_all_quarters_and_after_many_turns_give_the_motion_of_a_single_run():
    bars = [pendulum(angle=quarter * np.pi / 2 + 0.3, rate=1.0) for quarter in range(4)]
    turned = [
        replace(bar, bodies=(replace(body, pose=(*body.pose[:2], body.pose[2] + 2 * np.pi * turns)),))
        for turns in (0, -3, 10_000)
        for bar in bars
        for body in bar.bodies
    ]
    found = run_batch(DOP853, turned, 1e-2, 10)
    for number, single in enumerate(turned):
        assert largest_difference(found, number, single, DOP853, 1e-2) < 1e-10  # the rounding of 62832 rad


@pytest.mark.usefixtures("no_mechanism_is_run_alone")
def test_mechanisms_of_very_different_sizes_are_closed_in_units_of_their_own_length():
    """Angles have the same unit at all sizes, so no body turns here."""
    sizes = np.array([1.0, 1e-9, 1e9])
    particles = [
        Mechanism(
            (Body("a", 1.0, s * s, (s, 0, 0), (0, -1.5 * s, 0)), Body("b", 1.0, s * s, (2 * s, 0, 0), (0, -5 * s, 0))),
            (Rod("A", None, "a", (0, 0), (0, 0), s), Rod("B", "a", "b", (0, 0), (0, 0), s)),
            (0, -9.81 * s),
        )
        for s in sizes.tolist()
    ]
    numbers = {"A.length": sizes, "B.length": sizes, "gravity": np.outer(sizes, [0, -9.81])}
    states = (np.array([getattr(mechanism, name) for mechanism in particles]) for name in ("pose", "twist"))
    for mechanisms in (particles, ParameterSweep(particles[0], numbers, *states)):
        found = run_batch(Lagrange("euler"), mechanisms, 0.05, 10)
        for number, mechanism in enumerate(particles):
            assert largest_difference(found, number, mechanism, Lagrange("euler"), 0.05) < 1e-13


def test_a_mechanism_in_a_singular_position_is_run_alone():
    parallelograms = scene("n_four_bar_10")
    mechanism, step = parallelograms.mechanism(), parallelograms.spacing / 64
    found = run_batch(DOP853, [mechanism, mechanism], step, 20, 64)
    single = DOP853.build(mechanism, step)(20, 64)
    assert single.warnings
    assert found.warnings == {0: single.warnings, 1: single.warnings}
    np.testing.assert_array_equal(found.pose, [single.pose, single.pose])


def test_mechanisms_of_different_sizes_and_adaptive_steps_have_arrays_of_their_own():
    mechanisms = [pendulum(), four_bar(crank_rate=3.0), pendulum(length=2.0)]
    for engine in (DOP853, Lagrange(tolerance=1e-9)):
        found = run_batch(engine, mechanisms, 1e-2, 3)
        assert [pose.shape for pose in found.pose] == [(4, 1, 3), (4, 3, 3), (4, 1, 3)]
        for number, mechanism in enumerate(mechanisms):
            assert largest_difference(found, number, mechanism, engine, 1e-2) < 1e-12


@pytest.mark.parametrize(
    ("numbers", "states", "words"),
    [
        ({}, {}, "it has no numbers"),
        ({"nobody.mass": [1.0]}, {}, "'nobody.mass' names no numbers; there are gravity, bar.mass"),
        ({"bar.mass": [[1.0]]}, {}, r"the shape \(1, 1\); it must be \(mechanisms,\)"),
        ({"bar.mass": [1.0, np.nan]}, {}, "not finite"),
        ({"bar.mass": [1.0, -1.0]}, {}, "mass"),
        ({"bar.mass": [1.0, 2.0], "gravity": [[0.0, 1.0]]}, {}, "different numbers of mechanisms"),
        ({"bar.mass": [1.0]}, {"pose": np.zeros((1, 2, 3))}, "2 bodies; the mechanism has 1"),
        ({"bar.mass": ["heavy"]}, {}, "no array of numbers"),
    ],
)
def test_a_wrong_sweep_is_refused(numbers, states, words):
    with pytest.raises(InvalidMechanism, match=words):
        ParameterSweep(pendulum(), numbers, **states)


@pytest.mark.parametrize(
    ("engine", "mechanisms", "samples", "words"),
    [
        ("lagrange", [pendulum()], 1, "engine is 'lagrange'; it must be a Lagrange"),
        (DOP853, pendulum(), 1, "mechanisms is Mechanism.*; it must be a ParameterSweep or"),
        (DOP853, [], 1, "there are no mechanisms"),
        (DOP853, [pendulum()] * 2, 2**30, "would take 5.15e[+]10 bytes"),
    ],
)
def test_a_wrong_batch_is_refused(engine, mechanisms, samples, words):
    with pytest.raises(InvalidMechanism, match=words):
        run_batch(engine, mechanisms, 1e-2, samples)


def test_a_start_that_does_not_satisfy_the_joints_is_refused():
    mechanism = four_bar()
    numbers = {f"{mechanism.bodies[0].name}.mass": [1.0, 2.0]}
    open_pose = np.array([mechanism.pose, mechanism.pose + 1e-3])
    with pytest.raises(InvalidMechanism, match="mechanism 1: its pose does not satisfy the joints"):
        run_batch(DOP853, ParameterSweep(mechanism, numbers, pose=open_pose), 1e-2, 1)
    far = {f"{mechanism.joints[0].name}.second_point": [(0.0, 0.0), (50.0, 0.0)]}
    with pytest.raises(InvalidMechanism, match="mechanism 1: its joints do not close"):
        run_batch(DOP853, ParameterSweep(mechanism, far), 1e-2, 1)
    with pytest.raises(InvalidMechanism, match="give `pose` and `twist`"):
        run_batch(Lagrange(tolerance=1e-9), ParameterSweep(mechanism, numbers), 1e-2, 1)
