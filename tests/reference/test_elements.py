"""Rods, gears, welds and force elements: each against its potential, closed forms, and what it is another word for.

What engines make of them is asked by `tests/engines/test_matrix.py`.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import TRUTH, Lagrange
from reference.checks import InvalidMechanism
from reference.forces import Damper, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Gear, Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.link import Pendulum
from reference.trajectory import energy
from tests.all_elements import ALL, ALONE, DAMPED, DAMPERS, GRAVITY, PUSHES, SPRINGS, WELD

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
@pytest.mark.parametrize("method", [Lagrange("rk4", "none"), TRUTH], ids=lambda method: method.variant)
def test_compiled_code_gives_the_numbers_of_numpy(mechanism, method):
    one, other = (replace(method, compiled=compiled).build(mechanism, 0.02)(5, 2) for compiled in (True, False))
    allowed = 1e-11 if method is TRUTH else 1e-13  # a tolerance is held, and its steps differ by rounding
    for what, size in (("pose", 1.0), ("twist", 1.0), ("reaction", np.abs(other.reaction).max())):
        np.testing.assert_allclose(getattr(one, what), getattr(other, what), atol=30 * allowed * size)


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


def test_a_body_on_a_rod_is_a_point_pendulum():
    # The rod holds its centre of mass, so that nothing turns it.
    length, angle = 0.8, 1.1
    place = (length * np.sin(angle), -length * np.cos(angle))
    body = Body("b", 2.0, 0.3, (*place, 0.0))
    mechanism = Mechanism((body,), (Rod("r", None, "b", (0.0, 0.0), (0.0, 0.0), length),), GRAVITY)
    motion = TRUTH.build(mechanism, 0.1)(20, 1)
    exact, _ = Pendulum(np.sqrt(9.81 / length), angle).motion(motion.t)[:2]
    np.testing.assert_allclose(motion.pose[:, 0, 0], length * np.sin(exact), atol=1e-11)
    np.testing.assert_allclose(motion.pose[:, 0, 1], -length * np.cos(exact), atol=1e-11)
    np.testing.assert_allclose(motion.pose[:, 0, 2], 0.0, atol=1e-14)
    # It pulls, which is negative, by weight and centripetal force.
    rate = motion.twist[:, 0, :2]
    pull = 2.0 * (9.81 * np.cos(exact) + np.sum(rate**2, axis=1) / length)
    np.testing.assert_allclose(motion.reaction[:, 0], -pull, rtol=1e-9)


def test_a_gear_pair_has_one_freedom_and_the_inertia_of_both():
    inertias, ratio, torque = (0.3, 0.2), -2.5, 1.7
    bodies = tuple(Body(n, 1.0, i, (x, 0.0, 0.0)) for n, i, x in (("a", inertias[0], 0.0), ("b", inertias[1], 1.0)))
    pins = tuple(Pin(n.upper(), None, n, (x, 0.0), (0.0, 0.0)) for n, x in (("a", 0.0), ("b", 1.0)))
    mechanism = Mechanism(bodies, (*pins, Gear("g", "a", "b", ratio)), (0.0, 0.0), (Torque("t", None, "a", torque),))
    assert mechanism.degrees_of_freedom() == (1, 1)
    motion = TRUTH.build(mechanism, 0.1)(10, 1)
    gain = torque / (inertias[0] + ratio**2 * inertias[1])
    np.testing.assert_allclose(motion.pose[:, 0, 2], gain * motion.t**2 / 2, atol=1e-12)
    np.testing.assert_allclose(motion.pose[:, 1, 2], ratio * gain * motion.t**2 / 2, atol=1e-12)
    # The torque on the second body; the first feels -ratio times as much.
    np.testing.assert_allclose(motion.reaction[:, -1], inertias[1] * ratio * gain, rtol=1e-11)


@pytest.mark.parametrize(
    ("name", "freedoms"),
    [("rod to the ground", 2), ("rod", 3), ("gear", 4), ("weld", 2), ("weld to the ground", 1), ("weld in a loop", 1)],
)
def test_freedoms_are_counted_by_rank(name, freedoms):
    assert ALONE[name].degrees_of_freedom() == (freedoms, freedoms)


def test_rows_that_repeat_share_their_reactions():
    twice = ALONE["weld in a loop"]
    assert twice.row_count - (12 - twice.degrees_of_freedom()[0]) == 3
    motion = TRUTH.build(twice, 0.05)(4, 1)
    names = twice.row_names
    for label in ("x", "y", "torque"):
        one, other = names.index(f"weld {label}"), names.index(f"closing {label}")
        np.testing.assert_allclose(motion.reaction[:, one], motion.reaction[:, other], rtol=1e-6, atol=1e-7)


def test_a_gear_without_a_ratio_is_refused():
    with pytest.raises(InvalidMechanism, match=r"ratio is 0\.0; it must be a finite number other than zero"):
        Gear("g", "a", "b", 0.0)


def test_a_start_off_a_weld_is_refused():
    with pytest.raises(InvalidMechanism, match=r"row 'weld torque' is open by 0\.1 rad"):
        replace(ALL, joints=(*ALL.joints[:3], replace(WELD, angle=WELD.angle + 0.1)))
