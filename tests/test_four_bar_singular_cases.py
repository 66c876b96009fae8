"""Where the reference itself says that a motion is not unique, or is not there."""

from __future__ import annotations

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.scenes.four_bar.linkage import Unreachable
from reference.scenes.four_bar.scenes import OverdrivenFourBar, Parallelogram
from tests.present import present


def test_the_parallel_motion_closes_the_joints_through_both_change_points():
    scene = Parallelogram()
    mechanism, truth = scene.mechanism(), scene.motion(np.linspace(0, scene.duration, 101))
    assert np.max(np.abs(mechanism.gap(truth.pose, truth.t))) < 1e-14
    assert np.max(np.abs(mechanism.slip(truth.pose, truth.twist))) < 1e-13
    assert set(scene.branch_of(truth.pose)) >= {-1, 1}


def test_the_crossed_motion_closes_the_joints_too_so_the_position_does_not_decide():
    scene = Parallelogram()
    theta = np.linspace(np.pi + 0.1, 2 * np.pi - 0.1, 20)
    beta, phi = scene.four_bar.angles(theta, 1)  # C left of B -> D beyond the change point: the bars cross
    assert np.min(np.abs(np.sin(phi - theta))) > 0.01
    closure = 0.4 * np.exp(1j * theta) + 1.2 * np.exp(1j * beta) - 1.2 - 0.4 * np.exp(1j * phi)
    assert np.max(np.abs(closure)) < 1e-14


def test_a_freedom_appears_where_the_bars_are_in_line():
    scene = Parallelogram()
    mechanism = scene.mechanism()
    assert mechanism.degrees_of_freedom() == (0, 0)
    in_line = scene.motion([np.pi / 2 / scene.rate])
    assert mechanism.degrees_of_freedom(in_line.pose[0]) == (1, 1)
    assert np.all(np.isnan(in_line.reaction))


def test_the_parallelograms_reactions_agree_with_the_closed_form_where_the_branch_is_the_same():
    scene = Parallelogram()
    t = np.linspace(0.01, 0.13, 7)  # theta from pi/2 up to before pi
    forces = scene.four_bar.forces(scene.start + scene.rate * t, scene.rate)
    expected = np.concatenate([*forces[:4], forces.torque[:, None]], axis=-1)
    # Rounding over the sine of the transmission angle, 0.27 at least.
    np.testing.assert_allclose(scene.motion(t).reaction, expected, atol=1e-11)


def test_a_crank_is_refused_beyond_its_limit_and_not_before():
    scene = OverdrivenFourBar()
    assert scene.four_bar.grashof() == "triple-rocker"
    # |B - D| = coupler + rocker: 0.64 + 1.44 - 1.92 cos(theta) = 1
    assert scene.stopping_time == pytest.approx(np.arccos(0.5625) / 4, rel=1e-15)
    scene.motion([scene.stopping_time * (1 - 1e-9)])
    with pytest.raises(Unreachable, match="can't close; possible is"):
        scene.motion([scene.stopping_time * (1 + 1e-9)])


def test_the_limit_is_found_backwards_too_and_a_crank_that_turns_fully_has_none():
    assert OverdrivenFourBar(rate=-4.0).stopping_time == pytest.approx(OverdrivenFourBar().stopping_time, rel=1e-14)
    free = OverdrivenFourBar(crank=0.4, coupler=0.4 * np.sqrt(2), rocker=0.8 * np.sqrt(2), start=1.0)
    assert free.stopping_time == np.inf


@pytest.mark.parametrize("rate", [4.0, -4.0])
def test_the_way_to_the_limit_depends_on_the_sense_of_rotation(rate):
    scene = OverdrivenFourBar(start=0.3, rate=rate)
    (low, high), *_ = present(scene.four_bar.crank_limits())
    assert scene.stopping_time == pytest.approx((high - 0.3 if rate > 0 else 0.3 - low) / 4, rel=1e-14)
    scene.motion([scene.stopping_time * (1 - 1e-9)])
    with pytest.raises(Unreachable, match="can't close"):
        scene.motion([scene.stopping_time * (1 + 1e-9)])


def test_a_parallelogram_with_unequal_sides_is_refused():
    with pytest.raises(InvalidMechanism, match="must be equal"):
        Parallelogram(rocker=0.5)
