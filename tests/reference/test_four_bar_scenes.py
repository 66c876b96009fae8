"""The four-bar scenes: their truth against the mechanism's rows, energy, another formulation, wrong models, and
where the reference itself says that a motion is not unique, or is not there.
"""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference.checks import InvalidMechanism
from reference.scenes.catalogue import SCENES, scene
from reference.scenes.four_bar.linkage import Unreachable
from reference.scenes.four_bar.scenes import (
    DrivenFourBar,
    FreeFourBar,
    OverdrivenFourBar,
    Parallelogram,
    SpinningFourBar,
)
from reference.trajectory import energy, joint_gap, slip
from tests.present import present

# No bar of this one turns fully: released here, the crank runs into both of its limits within two seconds.
TRIPLE_ROCKER = FreeFourBar(crank=1.0, coupler=0.5, rocker=0.6, ground=(1.2, 0.1), start=0.2, duration=2.0)
TURNED = FreeFourBar(
    crank=0.5,
    coupler=0.9,
    rocker=0.8,
    ground=(-0.6, 0.7),
    branch=-1,
    rate=-4.0,
    density=(1.0, 3.0, 0.5),
    start=1.0,
    gravity=(3.0, -8.0),
)
FREE = (FreeFourBar(), SpinningFourBar(), TRIPLE_ROCKER, TURNED)
DRIVEN = (
    DrivenFourBar(),
    DrivenFourBar(rate=-7.0, branch=-1, revolutions=0.5),
    DrivenFourBar(crank=1.0, coupler=0.9, rocker=1.1, ground=(0.3, -0.4), revolutions=2.0, density=(1.0, 2.0, 3.0)),
)


def sampled(each):
    return np.linspace(0, each.duration, 51)


def accelerations(each, times):
    return each._bodies(each._angles(times))[2]


@cache
def moving(each):
    """Its motion and accelerations at `sampled`, integrated once for all tests; they may not be written into."""
    return each.motion(sampled(each)), accelerations(each, sampled(each))


@pytest.mark.parametrize("each", [*FREE, *DRIVEN])
def test_the_motion_starts_as_the_mechanism_and_keeps_every_joint(each):
    mechanism, (motion, _) = each.mechanism(), moving(each)
    assert np.array_equal(motion.pose[0], mechanism.pose)
    assert np.array_equal(motion.twist[0], mechanism.twist)
    # Rounding of angles up to 20 rad and of speeds up to 20 m/s.
    assert np.max(np.abs(joint_gap(mechanism, motion))) < 1e-14
    assert np.max(np.abs(slip(mechanism, motion))) < 1e-13
    assert mechanism.degrees_of_freedom() == ((0, 0) if isinstance(each, DrivenFourBar) else (1, 1))
    assert set(np.abs(each.branch_of(motion.pose))) == {1}
    assert each.branch_of(mechanism.pose) == each.branch


@pytest.mark.parametrize("each", [*FREE, *DRIVEN])
def test_accelerations_satisfy_the_rows_differentiated(each):
    mechanism, (motion, bend) = each.mechanism(), moving(each)
    left = (mechanism.rows(motion.pose) @ bend.reshape(-1, 9, 1))[..., 0]
    scale = 1 + np.max(np.abs(bend))
    assert np.max(np.abs(left - mechanism.bias(motion.pose, motion.twist))) < 1e-13 * scale
    assert np.max(np.abs(left + mechanism.bias(motion.pose, motion.twist))) > 0.1


@pytest.mark.parametrize("each", [*FREE, *DRIVEN])
def test_reactions_are_what_newton_needs(each):
    mechanism, (motion, bend) = each.mechanism(), moving(each)
    force = (np.swapaxes(mechanism.rows(motion.pose), -1, -2) @ motion.reaction[..., None])[..., 0]
    needed = mechanism.inertias * (bend - mechanism.free_fall)
    size = np.max(np.abs(motion.reaction))
    assert np.max(np.abs(force - needed.reshape(-1, 9))) < 1e-12 * size
    assert np.max(np.abs(force + needed.reshape(-1, 9))) > 0.1 * size
    assert motion.reaction.shape == (51, mechanism.row_count)


def test_the_driven_torque_and_pins_stand_in_the_order_of_the_rows():
    each = DrivenFourBar(density=(1.0, 2.0, 0.5))
    times = sampled(each)
    mechanism, motion = each.mechanism(), each.motion(times)
    assert mechanism.row_names == ("A x", "A y", "B x", "B y", "C x", "C y", "D x", "D y", "drive torque")
    by_rows = mechanism.reaction(motion.pose, accelerations(each, times))
    # The row system squares the condition of J, about 30.
    assert np.max(np.abs(by_rows - motion.reaction)) < 1e-12 * np.max(np.abs(by_rows))


def test_the_driven_crank_is_back_after_a_revolution():
    each = DrivenFourBar()
    motion = each.motion([0.0, each.duration])
    assert np.max(np.abs(motion.pose[1] - motion.pose[0] - [[0, 0, 2 * np.pi], [0, 0, 0], [0, 0, 0]])) < 1e-14
    assert np.allclose(motion.twist[0, :, 2], (10.0, -5.0, 2.5), rtol=1e-14)


def test_the_nine_configurations_of_the_figure_end_where_they_begin():
    # Erratum 20: nine times, the last of which is the first configuration again.
    each = DrivenFourBar()
    angle = each.motion(each.duration * np.arange(9) / 8).pose[:, :, 2]
    steps = np.diff(angle[:, 0])
    assert np.max(np.abs(steps - np.pi / 4)) < 1e-14
    assert np.max(np.abs(angle[8, 1:] - angle[0, 1:])) < 1e-14


def test_a_scene_is_sampled_every_hundredth_of_a_second():
    assert FreeFourBar(duration=1.0).samples == 100
    assert FreeFourBar(duration=1.0).spacing == 0.01
    # A duration that is no multiple: the samples stand as near to that as their number allows.
    assert DrivenFourBar().samples == round(0.2 * math.pi / 0.01)
    assert DrivenFourBar().spacing == pytest.approx(0.2 * math.pi / 63, rel=1e-15)
    assert FreeFourBar(duration=1e-3).samples == 1


@pytest.mark.parametrize("each", FREE)
def test_free_motion_keeps_its_energy_and_its_truth_error_is_rounding(each):
    mechanism, times = each.mechanism(), sampled(each)
    total = energy(mechanism, moving(each)[0])
    assert np.ptp(total) < 3e-14 * (1 + np.max(np.abs(total)) + 9.81 * sum(each.masses))
    # Rounding to double of angles of 10 rad and speeds of 20 m/s. Where longdouble is no longer than double, some
    # hundred steps' rounding, amplified by the motion, is added.
    assert each.truth_error(times).max() < (1e-14 if np.finfo(np.longdouble).eps < 1e-18 else 1e-12)


@pytest.mark.parametrize("each", [FreeFourBar(), SpinningFourBar(), TURNED])
def test_free_motion_agrees_with_the_crank_angle_as_the_coordinate(each):
    """Lagrange's equation in theta, inertia and potential by the closed form and their slopes by its derivatives."""
    four_bar, masses = each.four_bar, each.masses
    lengths = four_bar.lengths

    def slope(_, state):
        theta, rate = state
        unit = four_bar.kinematics(theta, 1.0, 0.0, each.branch)
        arms = [
            complex(length * np.exp(1j * a)) for length, a in zip(lengths, (theta, unit.beta, unit.phi), strict=True)
        ]
        turning, bends = (1.0, unit.beta_dot, unit.phi_dot), (0.0, unit.beta_ddot, unit.phi_ddot)
        ends = [1j * w * arm for w, arm in zip(turning, arms, strict=True)]
        curves = [(1j * k - w * w) * arm for k, w, arm in zip(bends, turning, arms, strict=True)]
        along = (ends[0] / 2, ends[0] + ends[1] / 2, ends[2] / 2)
        curving = (curves[0] / 2, curves[0] + curves[1] / 2, curves[2] / 2)
        inertia = slope_of_inertia = force = 0.0
        for m, length, v, a, w, k in zip(masses, lengths, along, curving, turning, bends, strict=True):
            inertia += m * (abs(v) ** 2 + length**2 / 12 * w**2)
            slope_of_inertia += 2 * m * ((v.conjugate() * a).real + length**2 / 12 * w * k)
            force += m * (each.gravity[0] * v.real + each.gravity[1] * v.imag)
        return [rate, (force - slope_of_inertia * rate**2 / 2) / inertia]

    times = np.linspace(0, each.duration, 11)
    other = solve_ivp(slope, (0, times[-1]), [each.start, each.rate], "DOP853", times, rtol=1e-12, atol=1e-12)
    motion = each.motion(times)
    # About a hundred steps of 1e-12, amplified by the motion, and DOP853's interpolation between its steps.
    assert np.max(np.abs(motion.pose[:, 0, 2] - other.y[0])) < 2e-9
    assert np.max(np.abs(motion.twist[:, 0, 2] - other.y[1])) < 2e-8
    for wrong in (replace(each, coupler=each.coupler + 1e-3), replace(each, gravity=(0.0, 9.81))):
        assert np.max(np.abs(wrong.motion(times).pose[:, 0, 2] - other.y[0])) > 1e-5


@pytest.mark.parametrize("each", FREE)
def test_twists_and_accelerations_are_derivatives_of_the_poses(each):
    step = 1e-3
    weights = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840 / step
    for middle in np.linspace(0.1, 0.9, 5) * each.duration:
        times = middle + step * np.arange(-4, 5)
        motion = each.motion(times)
        # step^8 = 1e-24 times a ninth derivative of up to (40/s)^9 = 3e14, and rounding over the step.
        assert np.max(np.abs(np.tensordot(weights, motion.pose, 1) - motion.twist[4])) < 1e-8
        assert np.max(np.abs(np.tensordot(weights, motion.twist, 1) - accelerations(each, times)[4])) < 1e-6


def test_a_triple_rocker_passes_its_crank_limits_and_changes_its_branch():
    each = TRIPLE_ROCKER
    assert each.four_bar.grashof() == "triple-rocker"
    times = np.linspace(0, each.duration, 2001)
    motion, bend = each.motion(times[::5]), accelerations(each, times[::5])
    (low, high), *_ = (
        interval for interval in present(each.four_bar.crank_limits()) if interval[0] <= each.start <= interval[1]
    )
    theta, branch = motion.pose[:, 0, 2], each.branch_of(motion.pose)
    assert np.min(theta) >= low - 1e-14
    assert np.max(theta) <= high + 1e-14
    assert set(branch) == {1, -1}
    for change in np.flatnonzero(np.diff(branch)):
        near = min(abs(theta[change] - low), abs(theta[change] - high))
        assert near < 0.05  # less than the crank turns between samples
        # No jolt: the speed changes by what the accelerations either side tell.
        pair = slice(change, change + 2)
        told = np.mean(bend[pair], axis=0) * np.diff(motion.t[pair])
        assert np.max(np.abs(np.diff(motion.twist[pair], axis=0)[0] - told)) < 0.1
    # Before and after, the angles are those of the closed form on the branch reported.
    beta, phi = each.four_bar.angles(np.clip(theta, low, high), branch)
    turns = np.array([beta, phi]) - motion.pose[:, 1:, 2].T
    assert np.max(np.abs(np.remainder(turns + 0.5, 2 * np.pi) - 0.5)) < 1e-6  # square root of rounding at a limit


def test_a_motion_does_not_depend_on_the_samples_asked_for():
    each = SpinningFourBar()
    times = np.linspace(0, 1, 21)
    whole = each.motion(times)
    shuffled = np.random.default_rng(1).permutation(21)
    mixed = each.motion(np.concatenate([times[shuffled], [0.5]]))
    assert np.max(np.abs(mixed.pose[:-1] - whole.pose[shuffled])) < 1e-14
    assert np.max(np.abs(mixed.twist[-1] - whole.twist[10])) < 1e-13
    assert np.max(np.abs(each.motion([1.0]).pose[0] - whole.pose[-1])) < 1e-14
    assert each.motion(0.0).pose.shape == (1, 3, 3)


@pytest.mark.parametrize("times", [[-0.1, 0.0], [math.nan], [math.inf], [[0.0, 1.0]]])
def test_times_that_are_none_are_refused(times):
    for each in (DrivenFourBar(), FreeFourBar()):
        with pytest.raises(ValueError, match=r"t is .*must be finite numbers in one row, none below zero"):
            each.motion(times)


def test_a_start_that_can_not_be_is_refused_in_a_sentence():
    triple = TRIPLE_ROCKER.four_bar
    (_, high), *_ = present(triple.crank_limits())
    with pytest.raises(Unreachable, match="possible is"):
        replace(TRIPLE_ROCKER, start=high + 0.1)
    with pytest.raises(InvalidMechanism, match="at its limit"):
        replace(TRIPLE_ROCKER, start=high, rate=1.0)
    with pytest.raises(InvalidMechanism, match="change point"):
        FreeFourBar(crank=0.4, coupler=1.2, rocker=0.4, start=0.0)
    with pytest.raises(InvalidMechanism, match="density"):
        FreeFourBar(density=-1.0)
    with pytest.raises(InvalidMechanism, match="duration"):
        FreeFourBar(duration=0.0)
    with pytest.raises(InvalidMechanism, match="revolutions"):
        DrivenFourBar(revolutions=-1.0)
    with pytest.raises(InvalidMechanism, match="rate is 0"):
        DrivenFourBar(rate=0.0)
    with pytest.raises(InvalidMechanism, match="branch is 0"):
        DrivenFourBar(branch=0)
    with pytest.raises(InvalidMechanism, match="start is nan"):
        FreeFourBar(start=math.nan)


def test_a_start_at_rest_at_a_crank_limit_moves_off_it():
    (_, high), *_ = present(TRIPLE_ROCKER.four_bar.crank_limits())
    each = replace(TRIPLE_ROCKER, start=high, duration=0.2)
    motion = each.motion(sampled(each))
    assert np.max(np.abs(joint_gap(each.mechanism(), motion))) < 1e-14
    assert np.max(np.abs(motion.twist[-1])) > 0.1


def test_driving_a_crank_beyond_its_limit_is_refused_by_the_reference():
    each = DrivenFourBar(crank=1.0, coupler=0.5, rocker=0.6, start=0.3, rate=1.0)
    with pytest.raises(Unreachable, match="crank angle"):
        each.motion(sampled(each))


def test_scenes_are_found_by_name_and_the_nearest_is_suggested():
    names = [each.name for each in SCENES]
    assert len(set(names)) == len(names)
    assert all(scene(name).name == name for name in names)
    assert scene("spinning_four_bar") == SpinningFourBar()
    with pytest.raises(ValueError, match="did you mean 'free_four_bar'"):
        scene("fre_fourbar")


def test_a_free_motion_that_comes_to_a_change_point_is_refused_by_name():
    scene = FreeFourBar(0.5, 1.2, 0.5, (1.2, 0.0), 1, 1.0, 8.0)
    with pytest.raises(ValueError, match="change point, beyond which two motions are possible"):
        scene.motion(1.0)


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
