"""The four-bar's formulas: the chapter's numbers, identities, wrong models, its forces, and its rates integrated."""

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


def test_the_drive_torque_is_the_rate_of_work_of_all_bars():
    density, gravity, rate, step = (1.0, 2.5, 0.4), (1.5, -9.81), -3.0, 1e-3

    def work(theta):  # kinetic plus potential energy
        motion = TURNED.kinematics(theta, rate, 0.0, -1)
        mass = np.array(density) * TURNED.lengths
        b = TURNED.crank * np.exp(1j * theta)
        arm, follower = TURNED.coupler / 2 * np.exp(1j * motion.beta), TURNED.rocker / 2 * np.exp(1j * motion.phi)
        centres = (b / 2, b + arm, complex(*TURNED.ground) + follower)
        speeds = (b / 2 * rate, b * rate + arm * motion.beta_dot, follower * motion.phi_dot)
        turning = (rate, motion.beta_dot, motion.phi_dot)
        total = 0
        for m, length, c, v, w in zip(mass, TURNED.lengths, centres, speeds, turning, strict=True):
            total += m * (np.abs(v) ** 2 + length**2 / 12 * w**2) / 2
            total -= m * (gravity[0] * c.real + gravity[1] * c.imag)
        return total

    weights = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840 / step
    for theta in (0.3, 2.0, 4.4):
        power = weights @ work(theta + rate * step * np.arange(-4, 5))
        torque = TURNED.forces(theta, rate, 0.0, -1, density, gravity).torque
        assert abs(torque * rate - power) < 1e-10  # energies of 20 J, rounded, over the step
        wrong = TURNED.forces(theta, rate, 0.0, -1, density, (gravity[0], -gravity[1])).torque
        assert abs(wrong * rate - power) > 1e-2


def test_a_linkage_at_rest_without_weight_needs_no_force():
    forces = CHAPTER.forces(np.linspace(0, 6, 20), 0.0, gravity=(0.0, 0.0))
    assert max(np.max(np.abs(force)) for force in forces) == 0


def test_the_ground_carries_the_weight_at_rest():
    at_a, _, _, at_d = CHAPTER.forces(np.linspace(0, 6, 20), 0.0)[:4]
    weight = 9.81 * sum(CHAPTER.lengths)
    assert np.max(np.abs(at_a + at_d - (0.0, weight))) < 1e-13


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


@pytest.mark.parametrize("method", ["RK23", "DOP853", "Radau", "BDF", "LSODA"])
def test_every_adaptive_method_reaches_a_tight_tolerance(method):
    times = np.linspace(0, np.pi / 5, 11)
    run = CHAPTER.integrate_rates(times, method=method, rtol=1e-7, atol=1e-9)
    assert np.max(np.abs(run.beta - CHAPTER.angles(run.theta)[0])) < 1e-4  # global error, some 1000 steps of 1e-7


def test_integration_stops_and_says_so():
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
