"""Tests of the four-bar, the slider-crank and Andrews' mechanism."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from engines.lagrange import TRUTH
from reference.checks import InvalidMechanism
from reference.scenes.andrews import Andrews
from reference.scenes.four_bar.linkage import FourBar, Unreachable
from reference.scenes.four_bar.scenes import OverdrivenFourBar, Parallelogram
from reference.scenes.slider_crank import SliderCrank
from tests.present import present
from tests.reference.formulas import closed
from tests.reference.test_scenes import TRIPLE_ROCKER

CHAPTER = FourBar(0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), (1.2, 0.0))
TURNED = FourBar(0.4, 1.1, 0.9, (-0.7, 0.9))
WINDING = FourBar(1.0, 0.9, 1.1, (0.3, -0.4))
WINDING_BACKWARD_GROUND = FourBar(2.0, 1.7, 1.5, (-0.6, 0.0))


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


def test_angles_of_random_linkages_are_continuous_at_every_crank_angle():
    for linkage in random_linkages(15):
        for low, high in linkage.crank_limits() or ((-15.0, 15.0),):
            # Chebyshev spacing resolves the square-root behaviour at the ends of the interval.
            theta = (low + high) / 2 - (high - low) / 2 * np.cos(np.linspace(2e-3, np.pi - 2e-3, 2000))
            for branch in (1, -1):
                values = np.array(linkage.angles(theta, branch))
                slopes = np.array(linkage.rates(theta, 1.0, branch))
                bound = np.maximum(np.abs(slopes[:, 1:]), np.abs(slopes[:, :-1])) * np.diff(theta)
                assert np.all(np.abs(np.diff(values)) < 2 * bound + 0.05)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("linkage", [WINDING, WINDING_BACKWARD_GROUND])
def test_the_bars_of_a_double_crank_turn_fully_with_the_crank(linkage, branch):
    assert linkage.grashof() == "double-crank"
    theta = np.linspace(-10, 10, 41)
    turned = np.array(linkage.angles(theta + 6 * np.pi, branch)) - linkage.angles(theta, branch)
    assert np.max(np.abs(turned - 6 * np.pi)) < 1e-13  # after three turns theta has a rounding error
    shuffled = np.random.default_rng(0).permutation(theta.size)
    assert np.array_equal(linkage.angles(theta[shuffled], branch)[0], linkage.angles(theta, branch)[0][shuffled])
    rocking = np.array(CHAPTER.angles(theta + 20 * np.pi)) - CHAPTER.angles(theta)
    assert np.max(np.abs(rocking)) < 1e-13  # coupler and rocker of a crank-rocker do not turn fully


def test_huge_crank_angles_and_multiples_of_pi_are_accurate_to_rounding():
    theta = np.array([np.pi, -np.pi, 3 * np.pi, 1e6 * np.pi, 12345678.9, 1e15])
    beta, phi = CHAPTER.angles(theta)
    with mpmath.workdps(50):
        bars = [closed(*CHAPTER.lengths, *CHAPTER.ground, mpmath.mpf(float(angle)), 1) for angle in theta]
        truth = np.array([[float(mpmath.arg(bar)) for bar in bars[1:]] for bars in bars]).T
    assert np.max(np.abs(wrapped(np.array([beta, phi]) - truth))) < 1e-14


@pytest.mark.parametrize(
    ("method", "steps", "order"), [("euler", (200, 400), 1), ("rk4", (8, 16), 4), ("RK45", (1e-3,), 2.4e-2)]
)
def test_integrated_rates_have_the_convergence_order_of_their_method(method, steps, order):
    times = np.linspace(0, np.pi / 5, 21)
    beta, _ = CHAPTER.angles(math.pi / 2 + 10 * times)
    if method == "RK45":  # with scipy's default tolerance the error after one revolution is 0.024 rad
        run = CHAPTER.integrate_rates(np.linspace(0, np.pi / 5, 401))
        assert np.max(np.abs(run.beta - CHAPTER.angles(run.theta)[0])) == pytest.approx(order, rel=0.05)
        assert run.stopped == ""
    else:
        coarse, fine = (
            np.max(np.abs(CHAPTER.integrate_rates(times, method=method, every=every, limit=10**6).beta - beta))
            for every in steps
        )
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.2)
    short = CHAPTER.integrate_rates(np.linspace(0, 10, 11), method=method, limit=15)
    assert "stopped at" in short.stopped
    assert np.isnan(short.beta[-1])


def test_coupler_and_rocker_are_in_line_at_crank_limits_and_angles_beyond_are_refused():
    for linkage in random_linkages(60):
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


@pytest.mark.parametrize(
    ("lengths", "ground", "name"),
    [
        ((1.0, 2.0, 2.5), (3.0, 0.0), "crank-rocker"),
        ((2.5, 2.0, 1.0), (3.0, 0.0), "crank-rocker"),  # the rocker turns
        ((2.0, 2.5, 3.0), (1.0, 0.0), "double-crank"),
        ((2.0, 1.0, 2.5), (3.0, 0.0), "double-rocker"),
        ((2.0, 2.2, 1.9), (3.0, 0.0), "triple-rocker"),
        ((0.1, 0.3, 0.1), (0.3, 0.0), "change-point"),
        ((0.1, 0.7, 0.2), (0.8, 0.0), "change-point"),  # 0.1 + 0.8 and 0.7 + 0.2 differ by rounding.
        # A linkage with s + l - p - q = 1e-11 m is no change-point.
        ((1.0, 1.5, 2.5 - 1e-11), (3.0, 0.0), "triple-rocker"),
        ((1.0, 1.5, 2.5 + 1e-11), (3.0, 0.0), "crank-rocker"),
    ],
)
def test_grashof_classes_by_name(lengths, ground, name):
    crank, coupler, rocker = lengths
    assert FourBar(crank, coupler, rocker, ground).grashof() == name


def test_a_parallelogram_is_accurate_next_to_its_change_point():
    parallelogram = FourBar(0.1, 0.3, 0.1, (0.3, 0.0))
    assert parallelogram.crank_limits() is None
    for theta in (1e-3, -1e-3, 1e-6, -1e-6, 1e-9, -1e-9, 1e-100, -1e-100):
        # On one branch the coupler is parallel to the ground.
        pairs = np.array([wrapped(parallelogram.angles(theta, branch)) for branch in (1, -1)])
        beta, phi = pairs[np.argmin(np.abs(pairs[:, 0]))]
        # Formulas with a difference of squared lengths would have an error of eps / theta.
        assert abs(beta) < 4e-15
        assert abs(phi - theta) < 4e-15


def test_a_free_triple_rocker_changes_its_branch_at_crank_limits_without_a_jolt():
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
        assert near < 0.05
        # The change of the speed agrees with the mean of the accelerations at two samples.
        pair = slice(change, change + 2)
        told = np.mean(bend[pair], axis=0) * np.diff(motion.t[pair])
        assert np.max(np.abs(np.diff(motion.twist[pair], axis=0)[0] - told)) < 0.1
    # At all samples the angles agree with the closed form for the branch from `branch_of`.
    beta, phi = each.four_bar.angles(np.clip(theta, low, high), branch)
    turns = np.array([beta, phi]) - motion.pose[:, 1:, 2].T
    assert np.max(np.abs(np.remainder(turns + 0.5, 2 * np.pi) - 0.5)) < 1e-6  # root of rounding


def test_a_parallelogram_has_one_more_freedom_with_its_bars_in_line():
    scene = Parallelogram()
    mechanism = scene.mechanism()
    assert mechanism.degrees_of_freedom() == (0, 0)
    in_line = scene.motion([np.pi / 2 / scene.rate])
    assert mechanism.degrees_of_freedom(in_line.pose[0]) == (1, 1)
    assert np.all(np.isnan(in_line.reaction))
    assert set(scene.branch_of(scene.motion(np.linspace(0, scene.duration, 101)).pose)) >= {-1, 1}


@pytest.mark.parametrize("rate", [4.0, -4.0])
def test_the_stopping_time_depends_on_the_sense_of_rotation(rate):
    scene = OverdrivenFourBar(start=0.3, rate=rate)
    (low, high), *_ = present(scene.four_bar.crank_limits())
    assert scene.stopping_time == pytest.approx((high - 0.3 if rate > 0 else 0.3 - low) / 4, rel=1e-14)
    scene.motion([scene.stopping_time * (1 - 1e-9)])
    with pytest.raises(Unreachable, match="can't close; possible is"):
        scene.motion([scene.stopping_time * (1 + 1e-9)])
    # |B - D|^2 = 0.64 + 1.44 - 1.92 cos(theta) is (coupler + rocker)^2 = 1
    assert OverdrivenFourBar().stopping_time == pytest.approx(np.arccos(0.5625) / 4, rel=1e-15)
    free = OverdrivenFourBar(crank=0.4, coupler=0.4 * np.sqrt(2), rocker=0.8 * np.sqrt(2), start=1.0)
    assert free.stopping_time == np.inf


SHAPES = [SliderCrank(0.3, 1.0), SliderCrank(0.3, 1.0, 0.2), SliderCrank(0.5, 0.9, -0.3, -1), SliderCrank(1.0, 1.01)]


@pytest.mark.parametrize("shape", [*SHAPES, SliderCrank(0.3, 1.0, 0.2, -1)])
def test_the_slider_has_no_speed_at_dead_centres_and_the_stroke_is_their_distance(shape: SliderCrank) -> None:
    stretched, folded = (shape.position(np.array(angle)) for angle in shape.dead_centres())
    assert np.abs(shape.rates(np.array(shape.dead_centres()))[1]).max() < 1e-13
    assert abs(abs(stretched - folded) - shape.stroke()) < 1e-14
    fine = shape.position(np.linspace(0, 2 * math.pi, 200_001))
    assert abs(np.ptp(fine) - shape.stroke()) < 1e-8  # the error on a grid is of second order in its spacing
    assert abs(abs(stretched) - math.sqrt((shape.rod + shape.crank) ** 2 - shape.offset**2)) < 1e-14


SCENE = Andrews()
END = (  # at 0.03 s
    *(0.1581077119629904e2, -0.1575637105984298e2, 0.4082224013073101e-1, -0.5347301163226948),
    *(0.5244099658805304, 0.5347301163226948, 0.1048080741042263e1),
)
ACCELERATIONS = (14222.4439199541138705911625887, -10666.8329399655854029433719415, 0.0, 0.0, 0.0, 0.0, 0.0)
MULTIPLIERS = (98.5668703962410896057654982170, -6.12268834425566265503114393122, 0.0, 0.0, 0.0, 0.0)


def of_the_test_set(angles: np.ndarray) -> np.ndarray:
    """The test set's seven angles from the bodies' angles (..., 7)."""
    k1, k2, k3, k4, k5, k6, k7 = np.moveaxis(angles, -1, 0)
    return np.stack([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7], axis=-1)


def test_the_final_angles_of_andrews_mechanism_agree_with_the_test_set():
    # The test set's numbers have an error of about 1.4e-9. Two formulations of this suite agree to 1e-12.
    ends = SCENE.motion(0.03).pose[0, :, 2]
    by_multipliers = TRUTH.build(SCENE.mechanism(), 0.03)(1, 1).pose[1, :, 2]
    np.testing.assert_allclose(of_the_test_set(ends), END, atol=1e-8)
    np.testing.assert_allclose(of_the_test_set(by_multipliers), END, atol=1e-8)
    np.testing.assert_allclose(ends, by_multipliers, atol=1e-12)


@pytest.mark.parametrize("source", ["scene", "judge"])
def test_the_initial_accelerations_and_multipliers_of_andrews_mechanism_agree_with_the_test_set(source):
    mechanism = SCENE.mechanism()
    motion = SCENE.motion(0.0) if source == "scene" else TRUTH.build(mechanism, 1e-4)(1, 1)
    # The test set has M q'' = f - G^T lambda with the rod's end minus the end of body 3, 4 or 6 as constraint. This
    # suite has M a = f + J^T reaction with the rod K2 as second body, so a multiplier is minus the reaction.
    names = [f"{pin} {direction}" for pin in ("P3", "P4", "P6") for direction in "xy"]
    found = [-motion.reaction[0, mechanism.row_names.index(name)] for name in names]
    np.testing.assert_allclose(found, MULTIPLIERS, rtol=1e-11, atol=1e-9)
    pushed = mechanism.rows(mechanism.pose).T @ motion.reaction[0]
    newton = mechanism.unconstrained(mechanism.pose, mechanism.twist) + pushed.reshape(7, 3) / mechanism.inertias
    np.testing.assert_allclose(of_the_test_set(newton[:, 2]), ACCELERATIONS, rtol=1e-11, atol=1e-7)


def test_a_folded_pair_of_bars_has_the_branch_minus_one():
    pose = SCENE.mechanism().pose.copy()
    pose[4, 2], pose[3, 2] = pose[3, 2] - np.pi / 2, pose[4, 2] + np.pi / 2
    assert SCENE.branch_of(pose) == -1
