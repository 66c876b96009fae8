"""Force elements: each against its potential, closed forms, the energy that it takes, and every engine."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import EXACT, Promise, registry
from engines.lagrange import TRUTH, Lagrange
from reference.checks import InvalidMechanism
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.trajectory import energy
from tests.all_elements import ALL, ALONE, DAMPED, DAMPERS, PUSHES, SPRINGS

TINY = 1e-100  # a complex step: no difference is taken, so no digit is lost
RANDOM = np.random.default_rng(5)
POSES, TWISTS = RANDOM.normal(size=(2, 20, 4, 3))


def one_body(*forces, mass=2.0, inertia=0.5, pose=(0.0, 0.0, 0.0), twist=(0.0, 0.0, 0.0), gravity=(0.0, 0.0)):
    return Mechanism((Body("b", mass, inertia, pose, twist),), (), gravity, forces)


def truth(mechanism: Mechanism, spacing: float, samples: int = 20):
    return TRUTH.build(mechanism, spacing)(samples, 1)


@pytest.mark.parametrize("force", [*SPRINGS, *PUSHES], ids=lambda force: force.name)
def test_a_force_is_minus_the_derivative_of_its_potential(force):
    alone = replace(ALL, forces=(force,)).applied
    for coordinate in range(12):
        step = np.zeros(12)
        step[coordinate] = TINY
        slope = np.imag(alone.potential(POSES + 1j * step.reshape(4, 3))) / TINY
        np.testing.assert_allclose(
            alone.on(POSES, TWISTS).reshape(20, 12)[:, coordinate], -slope, rtol=1e-12, atol=1e-12
        )


@pytest.mark.parametrize("damper", DAMPERS, ids=lambda damper: damper.name)
def test_a_damper_is_half_the_derivative_of_the_power_that_it_takes(damper):
    alone = replace(ALL, forces=(damper,)).applied

    def power(twist):
        return np.sum(alone.on(POSES.astype(twist.dtype), twist) * twist, axis=(-2, -1))

    assert np.all(power(TWISTS) < 0)
    for coordinate in range(12):
        step = np.zeros(12)
        step[coordinate] = TINY
        slope = np.imag(power(TWISTS + 1j * step.reshape(4, 3))) / TINY
        np.testing.assert_allclose(
            alone.on(POSES, TWISTS).reshape(20, 12)[:, coordinate], slope / 2, rtol=1e-12, atol=1e-12
        )


@pytest.mark.parametrize("force", [SPRINGS[1], SPRINGS[2], SPRINGS[3], PUSHES[1], *DAMPERS[1:]], ids=lambda f: f.name)
def test_what_acts_between_two_bodies_neither_pushes_nor_turns_both_together(force):
    forces = replace(ALL, forces=(force,)).applied.on(POSES, TWISTS)
    x, y, turning = np.moveaxis(forces, -1, 0)
    moment = turning + POSES[..., 0] * y - POSES[..., 1] * x
    for total in (x, y, moment):
        np.testing.assert_allclose(total.sum(axis=-1), 0, atol=1e-12)


def test_a_spring_oscillates_as_its_sine_says():
    stiffness, rest, stretched = 30.0, 0.7, 0.2
    mechanism = one_body(
        Spring("s", None, "b", (0.0, 0.0), (0.0, 0.0), stiffness, rest), pose=(rest + stretched, 0.0, 0.0)
    )
    motion = truth(mechanism, 0.1)
    expected = rest + stretched * np.cos(math.sqrt(stiffness / 2.0) * motion.t)
    np.testing.assert_allclose(motion.pose[:, 0, 0], expected, atol=1e-12)


def test_two_bodies_on_a_spring_oscillate_with_their_reduced_mass():
    bodies = (Body("a", 1.0, 1.0, (0.0, 0.0, 0.0)), Body("b", 3.0, 1.0, (1.5, 0.0, 0.0)))
    mechanism = Mechanism(bodies, (), (0.0, 0.0), (Spring("s", "a", "b", (0.0, 0.0), (0.0, 0.0), 12.0, 1.0),))
    motion = truth(mechanism, 0.1)
    apart = motion.pose[:, 1, 0] - motion.pose[:, 0, 0]
    np.testing.assert_allclose(apart, 1.0 + 0.5 * np.cos(4.0 * motion.t), atol=1e-12)


def test_a_torsion_pendulum_swings_with_its_inertia():
    mechanism = one_body(TorsionSpring("s", None, "b", 2.0, 0.3), pose=(0.0, 0.0, 1.3))
    motion = truth(mechanism, 0.1)
    np.testing.assert_allclose(motion.pose[:, 0, 2], 0.3 + np.cos(2.0 * motion.t), atol=1e-12)


@pytest.mark.parametrize("turning", [False, True])
def test_a_damped_oscillation_dies_out_as_its_exponential_says(turning):
    # x'' + 2 c x' + f^2 x = 0 with f = 3 and c = 1, of an inertia of 2.
    if turning:
        forces = (TorsionSpring("s", None, "b", 18.0), TorsionDamper("d", None, "b", 4.0))
        mechanism, column = one_body(*forces, inertia=2.0, pose=(0.0, 0.0, 0.2)), 2
    else:
        far = (-1.0, 0.0)
        forces = (Spring("s", None, "b", far, (0.0, 0.0), 18.0, 1.0), Damper("d", None, "b", far, (0.0, 0.0), 4.0))
        mechanism, column = one_body(*forces, pose=(0.2, 0.0, 0.0)), 0
    motion, rate = truth(mechanism, 0.1), math.sqrt(8.0)
    expected = 0.2 * np.exp(-motion.t) * (np.cos(rate * motion.t) + np.sin(rate * motion.t) / rate)
    np.testing.assert_allclose(motion.pose[:, 0, column], expected, atol=1e-12)


def test_constant_forces_and_torques_accelerate_steadily():
    forces = (Torque("t", None, "b", 0.5), Force("f", "b", (0.0, 0.0), (1.0, -3.0)))
    motion = truth(one_body(*forces, gravity=(0.0, 2.0)), 0.1)
    gains = np.array([0.5, -1.5 + 2.0, 1.0])
    np.testing.assert_allclose(motion.pose[:, 0], motion.t[:, None] ** 2 / 2 * gains, atol=1e-12)


def test_a_force_off_the_centre_is_a_pendulum_of_its_own():
    # The pull (0, -F) at a distance r of a body on a pin turns it as gravity turns a weight F / g there.
    pin = Pin("A", None, "b", (0.0, 0.0), (0.0, 0.0))
    pulled = replace(one_body(Force("f", "b", (0.4, 0.0), (0.0, -5.0))), joints=(pin,))
    spring = replace(one_body(Spring("s", None, "b", (0.0, -1e7), (0.4, 0.0), 5.0 / 1e7)), joints=(pin,))
    left, right = truth(pulled, 0.1).pose[:, 0, 2], truth(spring, 0.1).pose[:, 0, 2]
    # A spring of no rest length that hangs 1e7 m below pulls with the same force and direction, but for 1e-7.
    np.testing.assert_allclose(left, right, atol=1e-5)
    assert np.abs(left).max() > 1


def test_the_energy_stays_without_dampers_and_falls_by_what_they_take():
    kept = truth(ALL, 0.05)
    span = np.ptp(np.sum(ALL.inertias * kept.twist**2, axis=(1, 2))) / 2
    assert np.ptp(energy(ALL, kept)) < 1e-11 * span
    fine = truth(DAMPED, 0.0025, 400)
    taken = np.sum(DAMPED.applied.on(fine.pose, fine.twist) * fine.twist, axis=(1, 2))
    others = replace(DAMPED, forces=ALL.forces).applied.on(fine.pose, fine.twist)
    power = taken - np.sum(others * fine.twist, axis=(1, 2))
    work = np.sum(power[:-2:2] + 4 * power[1:-1:2] + power[2::2]) * 0.0025 / 3  # Simpson's, of order 4
    lost = energy(DAMPED, fine)[-1] - energy(DAMPED, fine)[0]
    assert work < -0.1
    assert lost == pytest.approx(work, rel=1e-7)


@pytest.mark.parametrize("mechanism", [ALL, DAMPED], ids=("kept", "damped"))
@pytest.mark.parametrize("method", [Lagrange("rk4"), Lagrange("rk4", "none"), TRUTH], ids=lambda method: method.variant)
def test_compiled_code_gives_the_numbers_of_numpy(mechanism, method):
    one, other = (replace(method, compiled=compiled).build(mechanism, 0.02)(5, 2) for compiled in (True, False))
    allowed = 1e-11 if method is TRUTH else 1e-13  # a tolerance is held, and its steps differ by rounding
    for what, size in (("pose", 1.0), ("twist", 1.0), ("reaction", np.abs(other.reaction).max())):
        np.testing.assert_allclose(getattr(one, what), getattr(other, what), atol=30 * allowed * size)


@pytest.mark.parametrize("name", [*ALONE, "all", "all damped"])
@pytest.mark.parametrize("engine", registry.ENGINES, ids=lambda engine: f"{engine.name}-{engine.variant}")
def test_every_engine_moves_by_forces_and_joints_with_the_order_it_promises(engine, name):
    mechanism = {**ALONE, "all": ALL, "all damped": DAMPED}[name]
    samples, spacing = 6, 0.05
    exact = truth(mechanism, spacing, samples)
    unit = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
    # Steps at which the first order is far above what the second leaves, and the fourth far above rounding.
    promised = engine.order(mechanism)
    assert isinstance(promised, Promise)
    errors = []
    for every in (40, 80):
        motion = engine.build(mechanism, spacing / every)(samples, every)
        errors.append(float((np.abs(motion.pose - exact.pose) / unit).max()))
        assert motion.reset_at is None
    softness = engine.softness(mechanism, spacing / 40)
    tied = engine.softness(mechanism, spacing / 80)
    if softness is not None and softness == tied and softness.compliance > 1e-6:
        assert errors[1] < 0.05  # a joint that gives way whatever the step: the error that its spring opens stays
        return
    order = promised.of("angle")
    floor = 1e-11  # of rounding, and of a compliance of 1e-8 that rows are given on purpose
    assert errors[1] < max(floor, 1.3 * errors[0] / 2 ** min(order, 4)) or order == EXACT
    assert errors[1] < 0.1


@pytest.mark.parametrize("engine", registry.ENGINES, ids=lambda engine: f"{engine.name}-{engine.variant}")
def test_a_stiffer_spring_would_be_noticed_in_every_engine(engine):
    mechanism = ALONE["spring"]
    stiffer = replace(mechanism, forces=(replace(mechanism.forces[0], stiffness=33.0),))
    exact = truth(mechanism, 0.05, 6).pose
    right, wrong = (np.abs(engine.build(each, 2.5e-4)(6, 200).pose - exact).max() for each in (mechanism, stiffer))
    assert wrong > 10 * right


def test_reactions_are_told_with_the_forces_that_act_beside_them():
    motion = truth(DAMPED, 0.05, 4)
    forces = DAMPED.applied.on(motion.pose, motion.twist)
    rows = DAMPED.rows(motion.pose)
    pushed = np.einsum("trc,tr->tc", rows, motion.reaction).reshape(forces.shape)
    free = DAMPED.unconstrained(motion.pose, motion.twist)
    acceleration = free + pushed / DAMPED.inertias
    told = DAMPED.reaction(motion.pose, acceleration, twist=motion.twist)
    np.testing.assert_allclose(told, motion.reaction, atol=1e-9 * np.abs(motion.reaction).max())
    with pytest.raises(InvalidMechanism, match="twist is None; dampers need it"):
        DAMPED.reaction(motion.pose, acceleration)


@pytest.mark.parametrize(
    ("forces", "sentence"),
    [
        ((Torque("t", None, "nobody", 1.0),), "force 't': no body is called 'nobody'"),
        ((Torque("t", "b", "b", 1.0),), "force 't': it joins 'b' with itself"),
        ((Torque("t", None, "b", 1.0), Torque("t", None, "b", 1.0)), "two forces are called 't'"),
        ((Spring("s", None, "b", (0.0, 0.0), (0.0, 0.0), 1.0, 0.5),), "its two points coincide"),
        ((Damper("s", None, "b", (0.0, 0.0), (0.0, 0.0), 1.0),), "its two points coincide"),
    ],
)
def test_a_force_that_can_not_be_is_refused(forces, sentence):
    with pytest.raises(InvalidMechanism, match=sentence):
        one_body(*forces)


def test_a_spring_without_rest_length_may_start_with_its_points_together():
    mechanism = one_body(Spring("s", None, "b", (0.0, 0.0), (0.0, 0.0), 8.0), twist=(1.0, 0.0, 0.0))
    motion = truth(mechanism, 0.1)
    np.testing.assert_allclose(motion.pose[:, 0, 0], np.sin(2.0 * motion.t) / 2, atol=1e-12)
