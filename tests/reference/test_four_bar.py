"""The four-bar: the chapter's numbers, its range and its classes, its rates integrated, and where its scenes end.

Its angles and rates in fifty digits are asked by `laws`, its motions and forces by `test_scenes`.
"""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.scenes.catalogue import SCENES, scene
from reference.scenes.four_bar.linkage import FourBar, Unreachable
from reference.scenes.four_bar.scenes import (
    DrivenFourBar,
    FreeFourBar,
    OverdrivenFourBar,
    Parallelogram,
    SpinningFourBar,
)
from reference.trajectory import joint_gap
from tests.present import present
from tests.reference.laws.linkages import closed
from tests.reference.test_scenes import TRIPLE_ROCKER

CHAPTER = FourBar(0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), (1.2, 0.0))
TURNED = FourBar(0.4, 1.1, 0.9, (-0.7, 0.9))
WINDING = FourBar(1.0, 0.9, 1.1, (0.3, -0.4))
WINDING_BACKWARD_GROUND = FourBar(2.0, 1.7, 1.5, (-0.6, 0.0))
ROCKING = FourBar(0.9, 0.4, 0.8, (0.2, 0.8))
EPS = np.finfo(float).eps


def gap(linkage, theta, beta, phi):
    loop = linkage.crank * np.exp(1j * theta) + linkage.coupler * np.exp(1j * beta)
    return np.abs(loop - linkage.rocker * np.exp(1j * phi) - complex(*linkage.ground))


def wrapped(angle):
    return np.remainder(np.asarray(angle, dtype=float) + np.pi, 2 * np.pi) - np.pi


def random_linkages(count):
    rng = np.random.default_rng(18)
    while count:
        try:
            crank, coupler, rocker = rng.uniform(0.1, 2, 3)
            x, y = rng.uniform(-1.5, 1.5, 2)
            linkage = FourBar(crank, coupler, rocker, (x, y))
        except InvalidMechanism:
            continue
        count -= 1
        yield linkage


def test_the_chapter_starts_at_a_quarter_and_three_quarters_of_pi_with_rates_of_minus_five_and_two_and_a_half():
    beta, phi = CHAPTER.angles(math.pi / 2)
    assert abs(beta - math.pi / 4) < 4 * EPS
    assert abs(phi - 3 * math.pi / 4) < 4 * EPS
    assert np.allclose(CHAPTER.rates(math.pi / 2, 10.0), (-5.0, 2.5), rtol=8 * EPS, atol=0)


def test_rates_are_the_printed_formulas_with_phi_read_from_d_to_c():
    theta = np.linspace(-9.0, 9.0, 200)
    beta, phi = CHAPTER.angles(theta)
    l1, l2, l3 = CHAPTER.lengths
    printed = (
        l1 / l2 * np.sin(phi - theta) / np.sin(beta - phi) * 10.0,
        l1 / l3 * np.sin(beta - theta) / np.sin(beta - phi) * 10.0,
    )
    rates = CHAPTER.rates(theta, 10.0)
    # The printed quotient loses what sin(beta - phi), at least 0.3 here, multiplies.
    assert np.max(np.abs(np.array(rates) - printed)) < 1e-13
    # Erratum 16: rod "CD" read from C to D keeps the rates, but does not close the loop.
    assert np.min(gap(CHAPTER, theta, beta, phi + np.pi)) > 0.1


def test_angles_are_continuous_at_every_crank_angle_for_random_linkages():
    for linkage in random_linkages(80):
        for low, high in linkage.crank_limits() or ((-15.0, 15.0),):
            # Spaced so that the square-root ends are resolved; the largest jump must then be what the rates say.
            theta = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(1e-3, np.pi - 1e-3, 4000))
            for branch in (1, -1):
                values = np.array(linkage.angles(theta, branch))
                slopes = np.array(linkage.rates(theta, 1.0, branch))
                bound = np.maximum(np.abs(slopes[:, 1:]), np.abs(slopes[:, :-1])) * np.diff(theta)
                assert np.all(np.abs(np.diff(values)) < 2 * bound + 0.05)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("linkage", [WINDING, WINDING_BACKWARD_GROUND])
def test_a_double_crank_winds_with_its_crank(linkage, branch):
    assert linkage.grashof() == "double-crank"
    theta = np.linspace(-10, 10, 41)
    turned = np.array(linkage.angles(theta + 6 * np.pi, branch)) - linkage.angles(theta, branch)
    assert np.max(np.abs(turned - 6 * np.pi)) < 1e-13  # three turns, to the rounding of theta
    shuffled = np.random.default_rng(0).permutation(theta.size)
    assert np.array_equal(linkage.angles(theta[shuffled], branch)[0], linkage.angles(theta, branch)[0][shuffled])
    rocking = np.array(CHAPTER.angles(theta + 20 * np.pi)) - CHAPTER.angles(theta)
    assert np.max(np.abs(rocking)) < 1e-13  # a crank-rocker does not wind


def test_huge_crank_angles_and_odd_multiples_of_pi_are_exact_to_the_angle_given():
    theta = np.array([np.pi, -np.pi, 3 * np.pi, 1e6 * np.pi, 12345678.9, 1e15])
    beta, phi = CHAPTER.angles(theta)
    with mpmath.workdps(50):
        bars = [closed(*CHAPTER.lengths, *CHAPTER.ground, mpmath.mpf(float(angle)), 1) for angle in theta]
        truth = np.array([[float(mpmath.arg(bar)) for bar in bars[1:]] for bars in bars]).T
    assert np.max(np.abs(wrapped(np.array([beta, phi]) - truth))) < 1e-14


def test_arguments_broadcast_and_blocks_do_not_show():
    theta = np.linspace(0, 6, 20001)  # two whole blocks and a part
    whole = CHAPTER.kinematics(theta, 2.0, 1.0)
    single = CHAPTER.kinematics(theta[5000], 2.0, 1.0)
    assert all(abs(many[5000] - one) < 1e-13 for many, one in zip(whole, single, strict=True))
    table = TURNED.kinematics(theta[:4, None], np.array([1.0, -2.0, 3.0]), np.zeros(3), np.array([1, -1, 1]))
    assert table.beta.shape == (4, 3)
    one = TURNED.kinematics(theta[2], -2.0, 0.0, -1)
    assert all(abs(many[2, 1] - value) < 1e-13 for many, value in zip(table, one, strict=True))
    assert CHAPTER.angles(np.zeros((0, 3)))[0].shape == (0, 3)


def test_integrated_rates_at_the_common_tolerance_miss_by_two_hundredths_in_one_revolution():
    times = np.linspace(0, np.pi / 5, 401)
    run = CHAPTER.integrate_rates(times)  # RK45, rtol 1e-3, atol 1e-6
    beta, _ = CHAPTER.angles(run.theta)
    assert np.max(np.abs(run.beta - beta)) == pytest.approx(2.4e-2, rel=0.05)
    assert run.stopped == ""


def test_integrated_rates_drift_by_a_radian_in_a_hundred_revolutions():
    times = np.linspace(0, 100 * np.pi / 5, 1001)
    run = CHAPTER.integrate_rates(times)
    beta, _ = CHAPTER.angles(math.pi / 2 + 10 * times)
    error = np.abs(run.beta - beta)
    assert np.nanmax(error) > 0.5
    assert bool(run.stopped) == bool(np.any(np.isnan(run.beta)))
    assert run.evaluations < 100_100


# RK4's steps are longer: with Euler's its error is the rounding of thousands of steps.
@pytest.mark.parametrize(("method", "order", "steps"), [("euler", 1, (200, 400)), ("rk4", 4, (8, 16))])
def test_fixed_steps_have_their_order(method, order, steps):
    times = np.linspace(0, np.pi / 5, 21)
    beta, _ = CHAPTER.angles(math.pi / 2 + 10 * times)
    coarse, fine = (
        np.max(np.abs(CHAPTER.integrate_rates(times, method=method, every=every, limit=10**6).beta - beta))
        for every in steps
    )
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.2)


def test_integration_stops_and_says_so():
    for method in ("RK23", "DOP853", "Radau", "BDF", "LSODA"):
        found = CHAPTER.integrate_rates([0.0, 0.1], method=method, rtol=1e-7, atol=1e-9)
        assert abs(found.beta[-1] - CHAPTER.angles(found.theta)[0][-1]) < 1e-5  # some hundred steps of 1e-7
    times = np.linspace(0, 10, 11)
    for method in ("euler", "rk4", "RK45"):
        run = CHAPTER.integrate_rates(times, method=method, limit=15)
        assert "stopped at" in run.stopped
        assert np.isnan(run.beta[-1])
    with pytest.raises(ValueError, match="method is 'ode45'"):
        CHAPTER.integrate_rates(times, method="ode45")
    with pytest.raises(ValueError, match="increasing"):
        CHAPTER.integrate_rates([1.0, 0.0])


@pytest.mark.parametrize(("method", "cost"), [("euler", 1), ("rk4", 4)])
def test_a_limit_that_is_a_whole_number_of_steps_is_used_up(method, cost):
    run = CHAPTER.integrate_rates([0.0, 0.01, 0.02], method=method, every=10, limit=20 * cost)
    assert run.stopped == ""
    assert run.evaluations == 20 * cost
    short = CHAPTER.integrate_rates([0.0, 0.01, 0.02], method=method, every=10, limit=20 * cost - 1)
    assert short.evaluations == 19 * cost
    assert "stopped at" in short.stopped


# Which linkages and crank angles there are


def test_crank_limits_are_where_the_triangle_flattens_and_the_crank_is_refused_beyond():
    for linkage in random_linkages(200):
        limits = linkage.crank_limits()
        turns = linkage.grashof() == "double-crank" or (
            linkage.grashof() == "crank-rocker" and linkage.crank < linkage.rocker
        )
        assert (limits is None) == turns
        for low, high in limits or ():
            for end, outward in ((low, -1), (high, 1)):
                span = abs(linkage.crank * np.exp(1j * end) - complex(*linkage.ground))
                flat = (linkage.coupler + linkage.rocker, abs(linkage.coupler - linkage.rocker))
                assert min(abs(span - s) for s in flat) < 1e-14
                linkage.angles(end)
                with pytest.raises(Unreachable):
                    linkage.angles(end + outward * 1e-9)


def test_an_unreachable_angle_is_named_with_the_possible_range():
    (low, high), *_ = present(ROCKING.crank_limits())
    with pytest.raises(Unreachable, match=r"crank angle 4\.5 rad") as refusal:
        ROCKING.angles(np.array([(low + high) / 2, 4.5]))
    assert f"{low:.9g}" in str(refusal.value)
    assert f"{high:.9g}" in str(refusal.value)


@pytest.mark.parametrize(
    ("lengths", "ground", "name"),
    [
        ((1.0, 2.0, 2.5), (3.0, 0.0), "crank-rocker"),
        ((2.5, 2.0, 1.0), (3.0, 0.0), "crank-rocker"),  # the rocker turns
        ((2.0, 2.5, 3.0), (1.0, 0.0), "double-crank"),
        ((2.0, 1.0, 2.5), (3.0, 0.0), "double-rocker"),
        ((2.0, 2.2, 1.9), (3.0, 0.0), "triple-rocker"),
        ((0.1, 0.3, 0.1), (0.3, 0.0), "change-point"),
        ((0.1, 0.7, 0.2), (0.8, 0.0), "change-point"),  # 0.1 + 0.8 and 0.7 + 0.2 differ by rounding
        # A hundredth of a nanometre a metre is none: s + l - p - q for s = 1, l = 3, p = 1.5, q = 2.5 m.
        ((1.0, 1.5, 2.5 - 1e-11), (3.0, 0.0), "triple-rocker"),
        ((1.0, 1.5, 2.5 + 1e-11), (3.0, 0.0), "crank-rocker"),
    ],
)
def test_grashof_classes_by_name(lengths, ground, name):
    crank, coupler, rocker = lengths
    assert FourBar(crank, coupler, rocker, ground).grashof() == name


def test_a_parallelogram_keeps_its_digits_beside_its_change_point():
    parallelogram = FourBar(0.1, 0.3, 0.1, (0.3, 0.0))
    assert parallelogram.crank_limits() is None
    for theta in (1e-3, -1e-3, 1e-6, -1e-6, 1e-9, -1e-9, 1e-100, -1e-100):
        # One of the two branches is the parallelogram, whose coupler stays parallel to the ground.
        pairs = np.array([wrapped(parallelogram.angles(theta, branch)) for branch in (1, -1)])
        beta, phi = pairs[np.argmin(np.abs(pairs[:, 0]))]
        # The formulas lose nothing here, where a difference of squared lengths would leave eps / theta.
        assert abs(beta) < 4e-15
        assert abs(phi - theta) < 4e-15


def test_b_on_d_is_refused_where_c_is_not_determined():
    kite = FourBar(1.0, 0.5, 0.5, (0.6, 0.8))
    with pytest.raises(Unreachable, match="B lies on D"):
        FourBar(1.0, 0.5, 0.5, (1.0, 0.0)).angles([1.0, 0.0])
    theta = np.arctan2(0.8, 0.6) + np.array([-0.9, -1e-3, 1e-3, 0.9])
    assert np.max(gap(kite, theta, *kite.angles(theta))) < 1e-15


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ((1.0, 1.0, 1.0, (0.0, 0.0)), "other than"),
        ((1.0, 1.0, 1.0, (3.1, 0.0)), "can't be assembled"),
        ((5.0, 1.0, 1.0, (1.0, 0.0)), "can't be assembled"),
    ],
)
def test_impossible_linkages_are_refused_in_a_sentence(values, words):
    with pytest.raises(InvalidMechanism, match=words):
        FourBar(*values)


# Scenes


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


def test_a_triple_rocker_passes_its_crank_limits_and_changes_its_branch():
    each = TRIPLE_ROCKER
    accelerations = lambda times: each._bodies(each._angles(times))[2]  # noqa: E731
    assert each.four_bar.grashof() == "triple-rocker"
    times = np.linspace(0, each.duration, 2001)
    motion, bend = each.motion(times[::5]), accelerations(times[::5])
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


def test_a_start_that_can_not_be_is_refused_in_a_sentence():
    triple = TRIPLE_ROCKER.four_bar
    (_, high), *_ = present(triple.crank_limits())
    with pytest.raises(Unreachable, match="possible is"):
        replace(TRIPLE_ROCKER, start=high + 0.1)
    with pytest.raises(InvalidMechanism, match="at its limit"):
        replace(TRIPLE_ROCKER, start=high, rate=1.0)
    with pytest.raises(InvalidMechanism, match="change point"):
        FreeFourBar(crank=0.4, coupler=1.2, rocker=0.4, start=0.0)
    with pytest.raises(InvalidMechanism, match="rate is 0"):
        DrivenFourBar(rate=0.0)
    with pytest.raises(InvalidMechanism, match="must be equal"):
        Parallelogram(rocker=0.5)
    with pytest.raises(ValueError, match="change point, beyond which two motions are possible"):
        FreeFourBar(0.5, 1.2, 0.5, (1.2, 0.0), 1, 1.0, 8.0).motion(1.0)


def test_a_start_at_rest_at_a_crank_limit_moves_off_it():
    (_, high), *_ = present(TRIPLE_ROCKER.four_bar.crank_limits())
    each = replace(TRIPLE_ROCKER, start=high, duration=0.2)
    motion = each.motion(np.linspace(0, each.duration, 51))
    assert np.max(np.abs(joint_gap(each.mechanism(), motion))) < 1e-14
    assert np.max(np.abs(motion.twist[-1])) > 0.1


def test_scenes_are_found_by_name_and_the_nearest_is_suggested():
    names = [each.name for each in SCENES]
    assert len(set(names)) == len(names)
    assert all(scene(name).name == name for name in names)
    assert scene("spinning_four_bar") == SpinningFourBar()
    with pytest.raises(ValueError, match="did you mean 'free_four_bar'"):
        scene("fre_fourbar")


def test_a_freedom_appears_where_the_bars_are_in_line():
    scene = Parallelogram()
    mechanism = scene.mechanism()
    assert mechanism.degrees_of_freedom() == (0, 0)
    in_line = scene.motion([np.pi / 2 / scene.rate])
    assert mechanism.degrees_of_freedom(in_line.pose[0]) == (1, 1)
    assert np.all(np.isnan(in_line.reaction))
    assert set(scene.branch_of(scene.motion(np.linspace(0, scene.duration, 101)).pose)) >= {-1, 1}


@pytest.mark.parametrize("rate", [4.0, -4.0])
def test_the_way_to_the_limit_depends_on_the_sense_of_rotation(rate):
    scene = OverdrivenFourBar(start=0.3, rate=rate)
    (low, high), *_ = present(scene.four_bar.crank_limits())
    assert scene.stopping_time == pytest.approx((high - 0.3 if rate > 0 else 0.3 - low) / 4, rel=1e-14)
    scene.motion([scene.stopping_time * (1 - 1e-9)])
    with pytest.raises(Unreachable, match="can't close; possible is"):
        scene.motion([scene.stopping_time * (1 + 1e-9)])
    # |B - D| = coupler + rocker: 0.64 + 1.44 - 1.92 cos(theta) = 1
    assert OverdrivenFourBar().stopping_time == pytest.approx(np.arccos(0.5625) / 4, rel=1e-15)
    free = OverdrivenFourBar(crank=0.4, coupler=0.4 * np.sqrt(2), rocker=0.8 * np.sqrt(2), start=1.0)
    assert free.stopping_time == np.inf
