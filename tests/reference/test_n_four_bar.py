"""The N-four-bar: its period and singular instants, its forces there, its branch. Its motion: `laws`, `test_scenes`."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars

SCENES = [NFourBar(loops=1), NFourBar(), NFourBar(loops=3, length=0.7, mass=2.0, speed=-2.5), TenFourBars()]


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


def test_cranks_that_start_upright_at_rest_stay_there_for_ever():
    scene = NFourBar(speed=0.0, duration=1000.0)
    assert scene.period == math.inf
    assert scene.singular_times(1e6).size == 0
    motion = scene.motion([0.0, 50.0, 1000.0])
    assert np.abs(motion.pose - motion.pose[0]).max() == 0
    assert np.abs(motion.twist).max() == 0
