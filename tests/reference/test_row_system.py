"""Rank and reactions of constraint rows: in 50 digits, at scales of all sizes, by their band, and where rows depend."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

from reference.joints import Drive, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.rows import banded_reaction, rank, reactions, solve_symmetric, undetermined
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.n_four_bar import TenFourBars
from reference.scenes.pendulum.scenes import HundredLinks, TenLinks
from reference.scenes.rolling.elliptic_gears import EllipticGears

RNG = np.random.default_rng(7)


def in_fifty_digits(rows, inertias, excess):
    """J M^-1 J^T f = J excess, without rounding; the rows must be independent."""
    with mpmath.workdps(50):
        jacobian = mpmath.matrix(rows.tolist())
        weighted = mpmath.matrix(
            [[mpmath.mpf(v) / mpmath.mpf(m) for v, m in zip(row, inertias, strict=True)] for row in rows]
        )
        found = mpmath.lu_solve(weighted * jacobian.T, jacobian * mpmath.matrix(excess.tolist()))
        return np.array([float(value) for value in found])


@pytest.mark.parametrize("ratio", [1.0, 1e-9, 1e9])
def test_forces_are_those_of_fifty_digits_however_different_the_masses_are(ratio):
    rows = RNG.normal(size=(8, 9))
    inertias = np.array([1.0] * 3 + [ratio] * 3 + [1.0] * 3)
    forces = RNG.normal(size=8)
    excess = (rows.T @ forces) / inertias
    found = reactions(rows, inertias, excess, np.ones(8), 1.0)
    exact = in_fifty_digits(rows, inertias, excess)
    # The square root of the ratio is what least squares lose; the product J M^-1 J^T would lose the ratio itself.
    assert np.abs(found - exact).max() < 1e-13 * max(ratio, 1 / ratio) ** 0.5 * np.abs(exact).max()


@pytest.mark.parametrize("density", [(1.0, 1.0, 1e8), (1e8, 1.0, 1.0), (1.0, 1e-8, 1.0), (1e-6, 1.0, 1e6)])
def test_the_free_four_bars_forces_are_those_of_fifty_digits_whatever_its_densities(density):
    scene = FreeFourBar(density=density)
    mechanism, motion = scene.mechanism(), scene.motion([0.1])
    pose = motion.pose[0]
    excess = excess_of(mechanism, pose, motion.twist[0])
    exact = in_fifty_digits(mechanism.rows(pose), mechanism.inertias.reshape(-1), excess)
    assert np.abs(motion.reaction[0] - exact).max() < 1e-9 * np.abs(exact).max()


def excess_of(mechanism, pose, twist):
    """Accelerations less free fall, from the mechanism alone and in 50 digits: M a = f + J^T r with J a = bias."""
    rows, inertias = mechanism.rows(pose), mechanism.inertias.reshape(-1)
    right = mechanism.bias(pose, twist) - rows @ mechanism.free_fall.reshape(-1)
    with mpmath.workdps(50):
        jacobian = mpmath.matrix(rows.tolist())
        light = mpmath.diag([1 / mpmath.mpf(value) for value in inertias])
        forces = mpmath.lu_solve(jacobian * light * jacobian.T, mpmath.matrix(right.tolist()))
        return np.array([float(value) for value in light * jacobian.T * forces])


def test_what_is_not_finite_gives_forces_that_are_no_numbers_and_harms_no_other_time():
    rows = np.stack([RNG.normal(size=(2, 3))] * 3)
    excess = np.ones((3, 3))
    excess[1, 0] = np.nan
    found = reactions(rows, np.ones(3), excess, np.ones(2), 1.0)
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2]]).all()
    assert found[0] == pytest.approx(found[2])


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_freedoms_do_not_depend_on_the_unit_of_length(scale):
    body = Body("slider", 1.0, scale**2, (scale, 0.0, 0.0))
    arm = Body("arm", 1.0, scale**2, (0.0, 0.0, 0.0))
    joints = (
        Pin("pivot", None, "arm", (0.0, 0.0), (0.0, 0.0)),
        Pin("hinge", "arm", "slider", (scale, 0.0), (0.0, 0.0)),
        Drive("motor", None, "arm", 0.0, 0.0),
        Slot("guide", None, "slider", (scale, 0.0), 0.3, (0.0, 0.0)),
    )
    freedoms = [Mechanism((arm, body), joints[:count]).degrees_of_freedom() for count in (2, 3, 4)]
    assert freedoms == [(2, 2), (1, 1), (1, 1)]  # the arm stands along x: a slot at 0.3 rad holds it, as the motor does


@pytest.mark.parametrize("scale", [1e-5, 1e5])
def test_which_forces_of_two_gears_are_undetermined_does_not_depend_on_their_size(scale):
    usual = EllipticGears()
    reaction = EllipticGears(major=usual.major * scale).motion([0.1]).reaction[0]
    assert np.isnan(reaction).tolist() == np.isnan(usual.motion([0.1]).reaction[0]).tolist()


def test_rows_that_repeat_are_undetermined_and_others_are_not():
    rows = np.array([[1.0, 0.0, 0.3], [2.0, 0.0, 0.6], [0.0, 1.0, 0.0]])
    assert undetermined(rows, 1.0).tolist() == [True, True, False]
    assert rank(rows, 1.0) == 2
    assert rank(np.zeros((0, 3)), 1.0) == 0
    assert rank(np.zeros((2, 3)), 1.0) == 0


def test_a_symmetric_system_is_solved_in_any_unit_and_shared_equally_where_it_is_singular():
    matrix = np.array([[2e-12, 1e-12], [1e-12, 2e-12]])
    assert solve_symmetric(matrix, np.array([3e-12, 3e-12])) == pytest.approx([1.0, 1.0])
    assert solve_symmetric(np.ones((2, 2)), np.array([1.0, 1.0])) == pytest.approx([0.5, 0.5])


def test_a_row_that_takes_a_thousandth_part_in_idle_forces_is_undetermined_too():
    rows = np.zeros((4, 6))
    rows[0, 0] = 1.0
    rows[1, :2] = 1.0, 1e-3
    rows[2, 1] = 1.0  # the second is the first and a thousandth of the third
    rows[3, 4] = 1.0  # and this one stands alone
    assert undetermined(rows, 1.0).tolist() == [True, True, True, False]
    assert undetermined(np.stack([rows, np.eye(6)[:4]]), 1.0).tolist() == [[True, True, True, False], [False] * 4]


def displaced(mechanism: Mechanism) -> tuple[Any, Any]:
    random = np.random.default_rng(0)
    pose = mechanism.pose + 0.1 * random.normal(size=(3, *mechanism.pose.shape))
    return pose, random.normal(size=pose.shape)


@pytest.mark.parametrize("scene", [HundredLinks(), TenFourBars()], ids=["open chain", "closed chain"])
def test_the_band_gives_the_forces_that_make_the_accelerations(scene: Any) -> None:
    mechanism = scene.mechanism()
    pose, _ = displaced(mechanism)
    # Made from forces that are known: M a = f + J^T reaction, read backwards again.
    given = np.random.default_rng(1).normal(size=(3, mechanism.row_count))
    pull = np.einsum("trc,tr->tc", mechanism.rows(pose), given).reshape(pose.shape)
    found = banded_reaction(mechanism.joint_rows, pose, pull / mechanism.inertias, mechanism.inertias)
    # The condition of a hundred links' system is about 1e4: that many roundings.
    assert np.abs(found - given).max() < 1e-11
    # Free fall, added and taken away again, leaves a rounding of the accelerations.
    whole = mechanism.reaction(pose, mechanism.free_fall + pull / mechanism.inertias)
    assert np.abs(whole - found).max() < 1e-11


def test_a_pin_given_twice_falls_back_to_the_smallest_forces() -> None:
    mechanism = TenLinks().mechanism()
    last = mechanism.joints[-1]
    assert isinstance(last, Pin)
    again = [replace(last, name="again"), replace(last, name="and again")]
    redundant = replace(mechanism, joints=(*mechanism.joints, *again))
    pose, acceleration = displaced(redundant)
    assert np.isnan(banded_reaction(redundant.joint_rows, pose, acceleration, redundant.inertias)).any(axis=1).all()
    once, shared = mechanism.reaction(pose, acceleration), redundant.reaction(pose, acceleration)
    # Of three equal rows each carries a third; the smallest singular values are cut at 1e-9.
    assert np.abs(shared[:, -2:] - shared[:, -6:-4]).max() < 1e-8 * np.abs(once).max()
    assert np.abs(3 * shared[:, -2:] - once[:, -2:]).max() < 1e-6 * np.abs(once).max()


def with_a_pin_beside_the_last(distance: float) -> Mechanism:
    """Ten links, the last on two pins this far apart [m]: their rows differ by as much where the angles do."""
    mechanism = TenLinks().mechanism()
    last = mechanism.joints[-1]
    assert isinstance(last, Pin)
    (x1, y1), (x2, y2) = last.first_point, last.second_point
    beside = replace(last, name="beside", first_point=(x1, y1 + distance), second_point=(x2, y2 + distance))
    return replace(mechanism, joints=(*mechanism.joints, beside))


def test_two_pins_a_micrometre_apart_fall_back_to_the_dense_system_which_keeps_their_digits() -> None:
    nearly = with_a_pin_beside_the_last(1e-6)
    pose, _ = displaced(nearly)
    given = np.random.default_rng(1).normal(size=(3, nearly.row_count))
    pull = np.einsum("trc,tr->tc", nearly.rows(pose), given).reshape(pose.shape)
    # The band's factorisation would end, with pivots of 1e-12: the product J M^-1 J^T has the rows' condition squared.
    assert np.isnan(banded_reaction(nearly.joint_rows, pose, pull / nearly.inertias, nearly.inertias)).any(axis=1).all()
    # The rows' own condition is 6e7: that many roundings are 1e-8, and the product would leave no digit at all.
    assert np.abs(nearly.reactions_of(pose, pull / nearly.inertias, nearly.inertias) - given).max() < 1e-6


def test_two_pins_closer_than_the_rank_can_tell_share_the_force() -> None:
    dependent = with_a_pin_beside_the_last(1e-11)
    pose, acceleration = displaced(dependent)
    assert np.isnan(banded_reaction(dependent.joint_rows, pose, acceleration, dependent.inertias)).any(axis=1).all()
    once, shared = TenLinks().mechanism().reaction(pose, acceleration), dependent.reaction(pose, acceleration)
    assert np.abs(shared).max() < 2 * np.abs(once).max()
    assert np.abs(shared[:, -4:-2] + shared[:, -2:] - once[:, -2:]).max() < 1e-6 * np.abs(once).max()
