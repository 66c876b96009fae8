"""The N-four-bar: its symmetric motion against the Mechanism, its period and singular instants, its forces, its
branch.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from reference.checks import InvalidMechanism
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.scenes.pendulum.link import Pendulum
from reference.trajectory import energy, joint_gap, slip

SCENES = [NFourBar(loops=1), NFourBar(), NFourBar(loops=3, length=0.7, mass=2.0, speed=-2.5), TenFourBars()]


@pytest.mark.parametrize("scene", [*SCENES, FortyFourBars()])
def test_the_truth_satisfies_the_mechanism(scene: NFourBar) -> None:
    mechanism = scene.mechanism()
    n = scene.loops
    assert len(mechanism.bodies) == 2 * n + 1
    assert mechanism.degrees_of_freedom() == (1, 1)
    t = np.linspace(0, 10, 23)
    motion = scene.motion(t)
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-15 * (10 + n)
    assert np.abs(slip(mechanism, motion)).max() < 1e-13
    assert np.ptp(energy(mechanism, motion)) < 1e-12 * scene.mass * scene.gravity * scene.length * (2 * n + 1)
    # Newton and Euler for every body with the closed-form forces: they prove the one equation, and the forces.
    pose, twist, change = scene._placement(*scene.pendulum.motion(t))
    force = (np.swapaxes(mechanism.rows(pose), -1, -2) @ motion.reaction[..., None])[..., 0]
    excess = (mechanism.inertias * (change - mechanism.free_fall)).reshape(len(t), -1)
    largest = np.abs(motion.reaction).max(axis=1)
    assert (np.abs(force - excess).max(axis=1) / largest).max() < 1e-12
    left = (mechanism.rows(pose) @ change.reshape(len(t), -1, 1))[..., 0]
    assert np.abs(left - mechanism.bias(pose, twist)).max() < 1e-12 * np.abs(change).max()
    # Away from the singular positions the rows have one solution; its condition number grows like 1 / cos^2 and N^2.
    solved = mechanism.reaction(pose, change)
    assert (np.abs(motion.reaction - solved).max(axis=1) / largest).max() < 1e-10


def test_a_bar_longer_by_a_thousandth_and_a_wrong_inertia_are_caught() -> None:
    scene = NFourBar()
    t = np.linspace(0, 2, 9)
    longer = replace(scene, length=1.001)
    assert np.abs(joint_gap(scene.mechanism(), longer.motion(t))).max() > 1e-4
    n = scene.loops
    wrong = Pendulum(math.sqrt(3 * (3 * n + 1) * 9.81 / (2 * (4 * n + 2))), math.pi, -1.0)
    mechanism = scene.mechanism()
    pose, twist, _ = scene._placement(*wrong.motion(t))
    kinetic = 0.5 * np.sum(mechanism.inertias * twist**2, axis=(-2, -1))
    potential = -np.sum(mechanism.inertias * mechanism.free_fall * pose, axis=(-2, -1))
    assert np.ptp(kinetic + potential) > 0.1


@pytest.mark.parametrize("scene", [*SCENES, FortyFourBars()])
def test_the_period_is_the_time_that_energy_says(scene: NFourBar) -> None:
    n, size = scene.loops, scene.length
    square = 3 * (3 * n + 1) * scene.gravity / (2 * (4 * n + 1) * size)
    start = (scene.speed / size) ** 2
    # Upright start: phi'^2 = start + 2 f^2 (1 - cos(angle from the top)).
    total = sum(
        quad(
            lambda a: 1 / math.sqrt(start + 4 * square * math.sin(a / 2) ** 2), lower, lower + math.pi / 8, epsrel=1e-13
        )[0]
        for lower in np.arange(0, 2 * math.pi - 1e-9, math.pi / 8)
    )
    assert scene.period == pytest.approx(total, rel=1e-12)


@pytest.mark.parametrize("scene", SCENES)
def test_at_the_singular_instants_n_more_freedoms_open(scene: NFourBar) -> None:
    mechanism = scene.mechanism()
    times = scene.singular_times(3 * scene.period)
    assert len(times) == 6  # twice a turn
    motion = scene.motion(times)
    for pose in motion.pose:
        assert abs(math.cos(pose[0, 2]) ** 2 - 1) < 1e-14
        assert mechanism.degrees_of_freedom(pose) == (scene.loops + 1, scene.loops + 1)
    between = scene.motion((times[1:] + times[:-1]) / 2)
    for pose in between.pose:
        assert mechanism.degrees_of_freedom(pose) == (1, 1)


def test_forces_have_no_limit_at_a_singular_position_unless_there_is_one_loop() -> None:
    before = np.array([1e-2, 1e-3, 1e-4])
    for loops, grows in ((1, False), (2, True), (10, True)):
        scene = NFourBar(loops=loops)
        largest = np.abs(scene.motion(scene.singular_times(2.0)[0] - before).reaction).max(axis=1)
        # cos(angle) = rate * time left: ten times nearer, ten times larger, once the finite part is left behind.
        ratio = largest[2] / largest[1]
        assert (7 < ratio < 11) if grows else (0.9 < ratio < 1.1)


def test_the_branch_tells_parallelograms_from_folded_loops() -> None:
    scene = NFourBar()
    motion = scene.motion(np.linspace(0, 10, 501))
    assert np.all(scene.branch_of(motion.pose) == 1)
    assert np.all(scene.branch_of(scene.motion(scene.singular_times(10.0)).pose) == 1)
    # Fold the first loop on its left: crank 0 along the ground, coupler 0 on crank 1; the rest stays.
    folded = scene.motion([0.3]).pose[0].copy()
    crank = folded[1, 2]
    folded[0], folded[3] = (0.5, 0.0, 0.0), (1 + 0.5 * math.cos(crank), 0.5 * math.sin(crank), crank)
    assert np.abs(scene.mechanism().gap(folded, 0.0)).max() < 1e-14  # a branch too
    assert scene.branch_of(folded) == -1
    # And the second on its right: crank 2 along the ground to pivot 1, coupler 1 back along crank 1; while crank 1
    # stands upright, and while it lies to the left, where a parallelogram is nearer than the first way to fold.
    for t in (0.3, 1.25):
        folded = scene.motion([t]).pose[0].copy()
        crank = folded[1, 2]
        folded[2] = (1.5, 0.0, math.pi)
        folded[4] = (1 + 0.5 * math.cos(crank), 0.5 * math.sin(crank), crank + math.pi)
        assert np.abs(scene.mechanism().gap(folded, 0.0)).max() < 1e-14
        assert scene.branch_of(folded) == -1
    assert math.cos(crank) < -1 / 2


def test_the_benchmark_starts_upright_with_one_metre_a_second() -> None:
    for scene, loops, duration in ((NFourBar(), 2, 10.0), (TenFourBars(), 10, 10.0), (FortyFourBars(), 40, 20.0)):
        mechanism = scene.mechanism()
        assert (scene.loops, scene.duration) == (loops, duration)
        assert np.abs(mechanism.pose[0] - [0, 0.5, math.pi / 2]).max() < 1e-15
        assert np.abs(mechanism.twist[0] - [0.5, 0, -1]).max() < 1e-15
    assert FortyFourBars().samples == 100


def test_bad_chains_are_refused() -> None:
    wrong: dict[str, Any]
    for wrong in ({"loops": 0}, {"loops": 1.5}, {"length": 0.0}, {"mass": math.nan}, {"speed": math.inf}):
        with pytest.raises(InvalidMechanism, match=next(iter(wrong))):
            NFourBar(**wrong)


def test_cranks_that_start_upright_at_rest_stay_there_for_ever():
    scene = NFourBar(speed=0.0, duration=1000.0)
    assert scene.period == math.inf
    assert scene.singular_times(1e6).size == 0
    motion = scene.motion([0.0, 50.0, 1000.0])
    assert np.abs(motion.pose - motion.pose[0]).max() == 0
    assert np.abs(motion.twist).max() == 0
