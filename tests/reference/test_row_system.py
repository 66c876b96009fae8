"""Rank and reactions of constraint rows, held against the same systems solved in 50 digits, at scales of all sizes."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from reference.joints import Drive, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.rows import rank, reactions, solve_symmetric, undetermined
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.slider_crank.scenes import DrivenSliderCrank

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


def forces_of(scene, t):
    mechanism = scene.mechanism()
    motion = scene.motion([t])
    return mechanism, motion.pose[0], motion.reaction[0]


@pytest.mark.parametrize("ratio", [1.0, 1e-3, 1e-6, 1e-9, 1e6, 1e9])
def test_forces_are_those_of_fifty_digits_however_different_the_masses_are(ratio):
    rows = RNG.normal(size=(8, 9))
    inertias = np.array([1.0] * 3 + [ratio] * 3 + [1.0] * 3)
    forces = RNG.normal(size=8)
    excess = (rows.T @ forces) / inertias
    found = reactions(rows, inertias, excess, np.ones(8))
    exact = in_fifty_digits(rows, inertias, excess)
    # The square root of the ratio is what least squares lose; the product J M^-1 J^T would lose the ratio itself.
    assert np.abs(found - exact).max() < 1e-13 * max(ratio, 1 / ratio) ** 0.5 * np.abs(exact).max()


@pytest.mark.parametrize("inertia", [1.0, 1e-6, 1e-9, 1e-12, 1e6])
def test_a_slider_that_never_turns_has_the_same_forces_whatever_its_inertia(inertia):
    usual = DrivenSliderCrank().motion([0.1]).reaction[0]
    assert DrivenSliderCrank(slider_inertia=inertia).motion([0.1]).reaction[0] == pytest.approx(usual, rel=1e-9)


@pytest.mark.parametrize("scale", [1e-9, 1e-5, 1e-3, 1e3, 1e6, 1e9])
def test_forces_of_a_scaled_four_bar_follow_its_scale(scale):
    # Lengths times s and gravity times s at the same rates: accelerations scale with s, masses (per length) with s too.
    usual = DrivenFourBar()
    scaled = DrivenFourBar(
        crank=usual.crank * scale,
        coupler=usual.coupler * scale,
        rocker=usual.rocker * scale,
        ground=(usual.ground[0] * scale, usual.ground[1] * scale),
        gravity=(usual.gravity[0] * scale, usual.gravity[1] * scale),
    )
    times = [0.0, 0.1, 0.37]
    forces, torque = usual.motion(times).reaction[:, :-1], usual.motion(times).reaction[:, -1:]
    found = scaled.motion(times).reaction
    assert found[:, :-1] / scale**2 == pytest.approx(forces, rel=1e-9, abs=1e-9 * np.abs(forces).max())
    assert found[:, -1:] / scale**3 == pytest.approx(torque, rel=1e-9, abs=1e-9 * np.abs(torque).max())


@pytest.mark.parametrize("density", [(1.0, 1.0, 1e8), (1e8, 1.0, 1.0), (1.0, 1e-8, 1.0), (1e-6, 1.0, 1e6)])
def test_the_free_four_bars_forces_are_those_of_fifty_digits_whatever_its_densities(density):
    scene = FreeFourBar(density=density)
    mechanism, pose, reaction = forces_of(scene, 0.1)
    exact = in_fifty_digits(
        mechanism.rows(pose), mechanism.inertias.reshape(-1), excess_of(mechanism, pose, scene.motion([0.1]).twist[0])
    )
    assert np.abs(reaction - exact).max() < 1e-9 * np.abs(exact).max()


def excess_of(mechanism, pose, twist):
    """Accelerations less free fall, from the mechanism alone and in 50 digits: M a = f + J^T r with J a = bias."""
    rows, inertias = mechanism.rows(pose), mechanism.inertias.reshape(-1)
    right = mechanism.bias(pose, twist) - rows @ mechanism.free_fall.reshape(-1)
    with mpmath.workdps(50):
        jacobian = mpmath.matrix(rows.tolist())
        light = mpmath.diag([1 / mpmath.mpf(value) for value in inertias])
        forces = mpmath.lu_solve(jacobian * light * jacobian.T, mpmath.matrix(right.tolist()))
        return np.array([float(value) for value in light * jacobian.T * forces])


def test_of_redundant_rows_the_smallest_forces_are_given_in_any_unit_of_length():
    body = Body("load", 2.0, 3.0, (0.0, 0.0, 0.0))
    pins = tuple(Pin(name, None, "load", (0.0, 0.0), (0.0, 0.0)) for name in ("one", "other"))
    doubled = Mechanism((body,), pins, (0.0, -10.0))
    assert doubled.reaction(doubled.pose, np.zeros((1, 3))) == pytest.approx([0.0, 10.0, 0.0, 10.0])
    assert doubled.degrees_of_freedom() == (1, 1)


def test_what_is_not_finite_gives_forces_that_are_no_numbers_and_harms_no_other_time():
    rows = np.stack([RNG.normal(size=(2, 3))] * 3)
    excess = np.ones((3, 3))
    excess[1, 0] = np.nan
    found = reactions(rows, np.ones(3), excess, np.ones(2))
    assert np.isnan(found[1]).all()
    assert np.isfinite(found[[0, 2]]).all()
    assert found[0] == pytest.approx(found[2])


@pytest.mark.parametrize("scale", [1e-9, 1e-6, 1.0, 1e6, 1e9])
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


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_the_driven_four_bar_has_no_freedom_in_any_unit(scale):
    usual = DrivenFourBar()
    scene = DrivenFourBar(
        crank=usual.crank * scale,
        coupler=usual.coupler * scale,
        rocker=usual.rocker * scale,
        ground=(usual.ground[0] * scale, usual.ground[1] * scale),
    )
    assert scene.mechanism().degrees_of_freedom() == (0, 0)


@pytest.mark.parametrize("scale", [1e-5, 1.0, 1e5])
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
