"""The four-bar's closed form against the chapter's numbers, 50-digit arithmetic, identities, and wrong models."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.scenes.four_bar.linkage import FourBar
from tests.present import present

CHAPTER = FourBar(0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), (1.2, 0.0))
TURNED = FourBar(0.4, 1.1, 0.9, (-0.7, 0.9))
WINDING = FourBar(1.0, 0.9, 1.1, (0.3, -0.4))
WINDING_BACKWARD_GROUND = FourBar(2.0, 1.7, 1.5, (-0.6, 0.0))
ROCKING = FourBar(0.9, 0.4, 0.8, (0.2, 0.8))
EQUAL_CRANK_AND_GROUND = FourBar(1.0, 0.6, 0.9, (0.6, 0.8))
LINKAGES = (CHAPTER, TURNED, WINDING, WINDING_BACKWARD_GROUND, ROCKING, EQUAL_CRANK_AND_GROUND)
EPS = np.finfo(float).eps


def reachable(linkage, count, inside=0.02):
    """Crank angles spread over what is possible, away from its ends by a part of its width."""
    intervals = linkage.crank_limits() or ((-9.0, 9.0),)
    return np.concatenate(
        [np.linspace(low + inside * (high - low), high - inside * (high - low), count) for low, high in intervals]
    )


def gap(linkage, theta, beta, phi):
    loop = linkage.crank * np.exp(1j * theta) + linkage.coupler * np.exp(1j * beta)
    return np.abs(loop - linkage.rocker * np.exp(1j * phi) - complex(*linkage.ground))


def precise(linkage, theta, branch):
    """beta and phi at 50 digits by the intersection of two circles: another derivation, wrapped to (-pi, pi]."""
    crank, coupler, rocker = (mpmath.mpf(length) for length in linkage.lengths)
    b = crank * mpmath.expj(mpmath.mpf(float(theta)))
    d = mpmath.mpc(*linkage.ground)
    span = abs(d - b)
    foot = (coupler**2 - rocker**2 + span**2) / (2 * span)
    height = mpmath.sqrt(coupler**2 - foot**2)
    c = b + (d - b) / span * mpmath.mpc(foot, branch * height)
    return mpmath.arg(c - b), mpmath.arg(c - d)


def precise_six(linkage, theta, theta_dot, theta_ddot, branch):
    """All six by Taylor series at 50 digits: a small real step either side, on the angles alone."""
    step = mpmath.mpf(10) ** -12
    values = []
    for sign in (-1, 0, 1):
        shift = theta_dot * sign * step + theta_ddot * (sign * step) ** 2 / 2
        crank, coupler, rocker = (mpmath.mpf(length) for length in linkage.lengths)
        b = crank * mpmath.expj(mpmath.mpf(float(theta)) + shift)
        d = mpmath.mpc(*linkage.ground)
        span = abs(d - b)
        foot = (coupler**2 - rocker**2 + span**2) / (2 * span)
        c = b + (d - b) / span * mpmath.mpc(foot, branch * mpmath.sqrt(coupler**2 - foot**2))
        values.append((c - b, c - d))
    six = [[], [], []]
    for member in (0, 1):
        before, now, after = (pair[member] for pair in values)
        back, forth = mpmath.arg(before / now), mpmath.arg(after / now)
        six[0].append(float(mpmath.arg(now)))
        six[1].append(float((forth - back) / (2 * step)))
        six[2].append(float((forth + back) / step**2))
    return [value for pair in six for value in pair]


def wrapped(angle):
    return np.remainder(np.asarray(angle, dtype=float) + np.pi, 2 * np.pi) - np.pi


def test_the_chapter_starts_at_a_quarter_and_three_quarters_of_pi():
    beta, phi = CHAPTER.angles(math.pi / 2)
    assert abs(beta - math.pi / 4) < 4 * EPS
    assert abs(phi - 3 * math.pi / 4) < 4 * EPS


def test_the_chapter_rates_at_the_start_are_minus_five_and_two_and_a_half():
    assert np.allclose(CHAPTER.rates(math.pi / 2, 10.0), (-5.0, 2.5), rtol=8 * EPS, atol=0)


def test_rates_are_the_printed_formulas_with_phi_read_from_d_to_c():
    theta = reachable(CHAPTER, 200)
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


def test_the_rotation_rates_satisfy_the_velocity_equation_of_the_loop():
    rng = np.random.default_rng(5)
    theta = reachable(TURNED, 300)
    rate = rng.normal(size=theta.size)
    beta, phi = TURNED.angles(theta, -1)
    beta_dot, phi_dot = TURNED.rates(theta, rate, -1)

    def residual(coupler_rate):
        return np.abs(
            TURNED.crank * rate * np.exp(1j * theta)
            + TURNED.coupler * coupler_rate * np.exp(1j * beta)
            - TURNED.rocker * phi_dot * np.exp(1j * phi)
        )

    assert np.max(residual(beta_dot)) < 1e-14  # (18.69), terms of order one
    assert np.max(residual(-beta_dot)) > 0.1


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("linkage", LINKAGES)
def test_all_six_agree_with_fifty_digits(linkage, branch):
    theta = reachable(linkage, 9)
    rate, bend = -3.0, 7.0
    ours = np.array(linkage.kinematics(theta, rate, bend, branch)).T
    with mpmath.workdps(50):
        truth = np.array([precise_six(linkage, angle, rate, bend, branch) for angle in theta])
    difference = ours - truth
    difference[:, :2] = wrapped(difference[:, :2])
    # A fiftieth from an end rates are amplified some tens of times, accelerations by the cube of that.
    scale = np.array([1, 1, 30, 30, 3000, 3000])
    assert np.max(np.abs(difference) / scale) < 1e-12
    assert np.max(np.abs(difference[:, :2])) < 1e-13


@pytest.mark.parametrize("change", [{"coupler": 1e-3}, {"rocker": 1e-3}, {"crank": 1e-3}])
def test_a_length_off_by_a_millimetre_is_seen(change):
    wrong = replace(CHAPTER, **{name: getattr(CHAPTER, name) + extra for name, extra in change.items()})
    with mpmath.workdps(50):
        truth = [float(value) for value in precise(CHAPTER, 1.0, 1)]
    assert np.max(np.abs(np.array(CHAPTER.angles(1.0)) - truth)) < 1e-14
    assert np.max(np.abs(np.array(wrong.angles(1.0)) - truth)) > 1e-4


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


def test_random_linkages_close_in_both_branches_with_c_on_its_side_of_bd():
    classes = set()
    for linkage in random_linkages(300):
        classes.add(linkage.grashof())
        theta = reachable(linkage, 60, inside=1e-3)
        for branch in (1, -1):
            beta, phi = linkage.angles(theta, branch)
            assert np.max(gap(linkage, theta, beta, phi)) < 2e-14  # about 50 roundings of lengths up to 3 m
            b = linkage.crank * np.exp(1j * theta)
            side = np.conj(complex(*linkage.ground) - b) * np.exp(1j * beta)
            assert np.all(np.sign(side.imag) == branch)
    assert classes == {"crank-rocker", "double-crank", "double-rocker", "triple-rocker"}


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


def test_a_crank_rocker_does_not_wind():
    theta = np.linspace(-10, 10, 41)
    turned = np.array(CHAPTER.angles(theta + 20 * np.pi)) - CHAPTER.angles(theta)
    assert np.max(np.abs(turned)) < 1e-13


def test_the_mirror_image_has_the_mirrored_angles():
    mirror = replace(TURNED, ground=(TURNED.ground[0], -TURNED.ground[1]))
    theta = reachable(TURNED, 50)
    difference = np.array(mirror.angles(-theta, -1)) + np.array(TURNED.angles(theta, 1))
    assert np.max(np.abs(wrapped(difference))) < 1e-14


def test_huge_crank_angles_and_odd_multiples_of_pi_are_exact_to_the_angle_given():
    theta = np.array([np.pi, -np.pi, 3 * np.pi, 1e6 * np.pi, 12345678.9, 1e15])
    beta, phi = CHAPTER.angles(theta)
    with mpmath.workdps(50):
        truth = np.array([[float(value) for value in precise(CHAPTER, angle, 1)] for angle in theta]).T
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


def test_near_a_crank_limit_the_angle_error_is_rounding_over_the_root_of_the_distance():
    (low, _), *_ = present(ROCKING.crank_limits())
    for distance in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12):
        theta = low + distance
        with mpmath.workdps(50):
            truth = np.array([float(value) for value in precise(ROCKING, theta, 1)])
        error = np.max(np.abs(wrapped(np.array(ROCKING.angles(theta)) - truth)))
        # d angle / d theta is about 1 / sqrt(distance): it multiplies the rounding of the lengths.
        assert error < 20 * EPS / math.sqrt(distance)
    beta, _ = ROCKING.angles(low)
    other, _ = ROCKING.angles(low, -1)
    assert abs(wrapped(beta - other)) < 20 * math.sqrt(EPS)


def test_transmission_angle_is_that_of_the_triangle_and_its_extremes_are_reached():
    for linkage in (*LINKAGES, *random_linkages(50)):
        theta = reachable(linkage, 400, inside=0.0)
        angle = linkage.transmission_angle(theta)
        span = np.abs(linkage.crank * np.exp(1j * theta) - complex(*linkage.ground))
        sides = linkage.coupler**2 + linkage.rocker**2 - span**2
        assert np.max(np.abs(np.cos(angle) - sides / (2 * linkage.coupler * linkage.rocker))) < 1e-13
        low, high = linkage.transmission_extremes()
        # At a limit the angle is only known to the square root of rounding.
        assert low - 1e-6 <= np.min(angle)
        assert np.max(angle) <= high + 1e-6
        heading = np.arctan2(linkage.ground[1], linkage.ground[0])
        if linkage.crank_limits() is None:
            assert np.allclose(linkage.transmission_angle(heading + np.array([0, np.pi])), (low, high), atol=1e-12)
        assert np.allclose(linkage.transmission_angle(theta, -1), angle, atol=1e-6)


def test_a_coupler_point_across_lies_to_the_left_of_the_coupler():
    # At the start B = (0, 0.4) and C = (0.4, 0.8): along B -> C is up to the right, and left of that up to the left.
    diagonal = math.sqrt(0.5)
    np.testing.assert_allclose(
        CHAPTER.coupler_point(math.pi / 2, 0.3, 0.1), [0.2 * diagonal, 0.4 + 0.4 * diagonal], atol=1e-15
    )


def test_coupler_point_velocity_and_acceleration_are_its_derivatives():
    start, rate, bend, step = 0.7, -2.0, 3.0, 1e-3
    times = step * np.arange(-4, 5)
    theta = start + rate * times + bend * times**2 / 2
    motion = TURNED.coupler_motion(theta, rate + bend * times, bend, 0.3, -0.2, -1)
    assert np.array_equal(motion.position, TURNED.coupler_point(theta, 0.3, -0.2, -1))
    # The 9-point derivative has an error of step^8 = 1e-24 times the ninth derivative, and rounding over step.
    weights = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840 / step
    assert np.max(np.abs(weights @ motion.position - motion.velocity[4])) < 1e-11
    assert np.max(np.abs(weights @ motion.velocity - motion.acceleration[4])) < 1e-11
    assert np.max(np.abs(weights @ motion.velocity + motion.acceleration[4])) > 0.1
    corner = TURNED.coupler_point(start, TURNED.coupler, 0.0)
    assert abs(math.dist(corner, TURNED.ground) - TURNED.rocker) < 1e-15


def closed_in_sixty_digits(lengths, ground, theta, branch):
    """beta and phi by the triangle B C D, or None where it doesn't close."""
    with mpmath.workdps(60):
        crank, coupler, rocker = map(mpmath.mpf, lengths)
        x, y = map(mpmath.mpf, ground)
        there = x + 1j * y
        b = crank * mpmath.expj(mpmath.mpf(theta))
        across = there - b
        cosine = (abs(across) ** 2 + coupler**2 - rocker**2) / (2 * abs(across) * coupler)
        if abs(cosine) > 1:
            return None
        beta = mpmath.arg(across) + branch * mpmath.acos(cosine)
        return beta, mpmath.arg(b + coupler * mpmath.expj(beta) - there)


def missed(found, exact):
    return abs(float((mpmath.mpf(float(found)) - exact + mpmath.pi) % (2 * mpmath.pi) - mpmath.pi))


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("branch", [1, -1])
def test_angles_of_very_short_bars_far_from_the_pivot_keep_their_digits(short, branch):
    lengths, ground, theta = (1.0, short, short), (1.0 + short / 2, 0.0), short / 2
    found = FourBar(*lengths, ground).angles(theta, branch)
    for angle, exact in zip(found, present(closed_in_sixty_digits(lengths, ground, theta, branch)), strict=True):
        # The ground's own rounding, 1e-16 of a metre, turns bars of `short` metres by 1e-16 / short; no more than that.
        assert missed(angle, exact) < 4e-16 * (1 + 1e-3 / short)


def test_angles_of_random_four_bars_at_all_scales_are_those_of_sixty_digits():
    generator = np.random.default_rng(5)
    compared = 0
    for _ in range(600):
        lengths = (10 ** (generator.uniform(-1.5, 1.0, 3) + generator.uniform(-9, 9))).tolist()
        heading = generator.uniform(-math.pi, math.pi)
        size = max(lengths) * 10 ** generator.uniform(-1, 0.3)
        ground = (size * math.cos(heading), size * math.sin(heading))
        try:
            crank, coupler, rocker = lengths
            bar = FourBar(crank, coupler, rocker, ground)
        except InvalidMechanism:
            continue
        low, high = (bar.crank_limits() or ((-3.0, 3.0),))[0]
        theta = low + (high - low) * generator.uniform(0.02, 0.98)
        for branch in (1, -1):
            rates = bar.rates(theta, 1.0, branch)
            exact = present(closed_in_sixty_digits(lengths, ground, theta, branch))
            for angle, value, rate in zip(bar.angles(theta, branch), exact, rates, strict=True):
                # What the roundings of the crank angle and of the ground's heading cause by themselves, times 60.
                assert missed(angle, value) < 60 * 2.2e-16 * (1 + abs(rate) * (abs(theta) + abs(heading) + 1))
                compared += 1
    assert compared > 400
