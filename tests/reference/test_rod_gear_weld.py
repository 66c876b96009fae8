"""Rods, gears and welds: rows against derivatives, closed forms, and the mechanisms that they are another word for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import registry
from engines.lagrange import TRUTH, Lagrange
from engines.mujoco.methods import DEFAULT, EXTENDED
from engines.tree import spanning_tree
from reference.checks import InvalidMechanism
from reference.forces import Torque
from reference.joints import Gear, Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.link import Pendulum
from tests.all_elements import ALL, ALONE, GEAR, GRAVITY, WELD

TINY = 1e-100
RANDOM = np.random.default_rng(7)
POSES, TWISTS = RANDOM.normal(size=(2, 20, 4, 3))


def test_rows_are_the_derivative_of_the_gap():
    rows = ALL.rows(POSES)
    for coordinate in range(12):
        step = np.zeros(12)
        step[coordinate] = TINY
        slope = np.imag(ALL.gap(POSES + 1j * step.reshape(4, 3), 0.0)) / TINY
        np.testing.assert_allclose(rows[..., coordinate], slope, rtol=1e-12, atol=1e-13)


def test_the_bias_is_what_the_rows_lack_along_a_motion():
    # Central differences of J v along q + t v: an error of about 1e-10, by a formula that shares nothing.
    step = 1e-5
    ahead, behind = (
        np.einsum("trc,tc->tr", ALL.rows(POSES + s * TWISTS), TWISTS.reshape(20, 12)) for s in (step, -step)
    )
    bias = ALL.bias(POSES, TWISTS)
    np.testing.assert_allclose(bias, -(ahead - behind) / (2 * step), atol=1e-6 * np.abs(bias).max())


@pytest.mark.parametrize("name", ["rod", "rod to the ground", "gear", "weld", "weld to the ground", "weld in a loop"])
def test_compiled_rows_and_biases_are_those_of_numpy_in_a_fast_motion(name):
    mechanism = ALONE[name]
    moving = TRUTH.build(mechanism, 0.3)(1, 1)
    bodies = tuple(
        replace(body, pose=tuple(pose), twist=tuple(twist))
        for body, pose, twist in zip(mechanism.bodies, moving.pose[1], moving.twist[1], strict=True)
    )
    fast = replace(mechanism, bodies=bodies)
    one, other = (Lagrange("rk4", "none", compiled=compiled).build(fast, 1e-3)(3, 1) for compiled in (True, False))
    np.testing.assert_allclose(one.pose, other.pose, atol=1e-13)
    np.testing.assert_allclose(one.twist, other.twist, atol=1e-12)
    np.testing.assert_allclose(one.reaction, other.reaction, atol=1e-11 * np.abs(other.reaction).max())


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


def test_a_rod_is_a_light_bar_with_pins_at_both_ends():
    whole = ALONE["rod"]
    rod = next(joint for joint in whole.joints if isinstance(joint, Rod))
    (x1, y1), (x2, y2) = ((1.0 + 0.1 * np.cos(0.3), 0.1 * np.sin(0.3)), (2.0 - 0.2 * np.sin(0.5), 0.2 * np.cos(0.5)))
    angle, half = float(np.arctan2(y2 - y1, x2 - x1)), rod.length / 2
    errors = []
    for mass in (1e-3, 1e-5):
        bar = Body("bar", mass, mass * rod.length**2 / 12, ((x1 + x2) / 2, (y1 + y2) / 2, angle))
        pins = (
            Pin("one", "a", "bar", rod.first_point, (-half, 0.0)),
            Pin("two", "bar", "b", (half, 0.0), rod.second_point),
        )
        barred = Mechanism((*whole.bodies, bar), (whole.joints[0], *pins), GRAVITY)
        one, other = (TRUTH.build(each, 0.1)(6, 1) for each in (whole, barred))
        errors.append(np.abs(one.pose - other.pose[:, :2]).max())
    assert errors[0] / errors[1] == pytest.approx(100, rel=0.1)  # by as much as the bar weighs
    assert errors[1] < 1e-5


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


def test_a_welded_pair_is_one_body():
    pair = ALONE["weld"]
    a, b, c = pair.bodies
    mass = b.mass + c.mass
    centre = (b.mass * np.array(b.pose[:2]) + c.mass * np.array(c.pose[:2])) / mass
    inertia = sum(body.inertia + body.mass * float(np.sum((centre - body.pose[:2]) ** 2)) for body in (b, c))
    shift = centre - np.array(b.pose[:2])
    cosine, sine = np.cos(b.pose[2]), np.sin(b.pose[2])
    own = np.array([cosine * shift[0] + sine * shift[1], -sine * shift[0] + cosine * shift[1]])
    merged = Body("b", mass, inertia, (float(centre[0]), float(centre[1]), b.pose[2]))
    hung = pair.joints[1]
    assert isinstance(hung, Pin)
    moved = replace(hung, second_point=tuple((np.array(hung.second_point) - own).tolist()))
    single = Mechanism((a, merged), (pair.joints[0], moved), GRAVITY)
    one, other = (TRUTH.build(each, 0.05)(12, 1) for each in (pair, single))
    np.testing.assert_allclose(one.pose[:, 0], other.pose[:, 0], atol=1e-11)
    np.testing.assert_allclose(one.pose[:, 1, 2], other.pose[:, 1, 2], atol=1e-11)
    np.testing.assert_allclose(one.reaction[:, :4], other.reaction, atol=1e-9 * np.abs(other.reaction).max())


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


def test_a_weld_is_no_coordinate_of_mujocos_tree():
    tree = spanning_tree(ALONE["weld"])
    assert tree.coordinates == 2
    assert not tree.loops
    assert [joint.name for joint in spanning_tree(ALONE["weld in a loop"]).loops].count("closing") == 1


def test_who_holds_a_rod_is_told():
    mechanism = ALONE["rod"]
    rod = mechanism.joints[1]
    assert DEFAULT.holder(rod, mechanism) == "engine"
    assert EXTENDED.holder(rod, mechanism) == "engine, our rows"
    assert EXTENDED.holder(WELD, ALL) == "engine"


def test_a_rod_of_mujocos_own_lacks_the_velocity_term_and_ours_has_it():
    # A rod that turns at 2 rad/s without gravity: its centripetal acceleration is nothing but -(dJ/dt) v.
    body = Body("b", 1.0, 1.0, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    mechanism = Mechanism((body,), (Rod("r", None, "b", (0.0, 0.0), (0.0, 0.0), 1.0),))
    pulls = {
        engine.rods: engine.build(mechanism, 1e-3)(1, 1).reaction[0, 0]
        for engine in (EXTENDED, replace(EXTENDED, rods="tendon"))
    }
    assert pulls["rows"] == pytest.approx(-4.0, rel=1e-6)
    assert (
        abs(pulls["tendon"]) < 1e-6
    )  # upstream: if this fails, the release has the term, and rods need no rows of ours


@pytest.mark.parametrize(
    "wrong",
    [
        {"length": 0.0},
        {"length": -1.0},
    ],
)
def test_a_rod_without_length_is_refused(wrong):
    with pytest.raises(InvalidMechanism, match=r"length is .*; it must be a finite number greater than zero"):
        Rod("r", None, "b", (0.0, 0.0), (1.0, 0.0), **wrong)


def test_a_gear_without_a_ratio_is_refused():
    with pytest.raises(InvalidMechanism, match=r"ratio is 0\.0; it must be a finite number other than zero"):
        Gear("g", "a", "b", 0.0)


def test_a_start_off_a_weld_is_refused():
    with pytest.raises(InvalidMechanism, match=r"row 'weld torque' is open by 0\.1 rad"):
        replace(ALL, joints=(*ALL.joints[:3], replace(WELD, angle=WELD.angle + 0.1)))


@pytest.mark.parametrize("engine", registry.ENGINES, ids=lambda engine: f"{engine.name}-{engine.variant}")
def test_a_wrong_ratio_would_be_noticed_in_every_engine(engine):
    mechanism = ALONE["gear"]
    exact = TRUTH.build(mechanism, 0.05)(6, 1).pose
    wrong = replace(mechanism, joints=(replace(GEAR, ratio=-1.8, phase=0.5 + 1.8 * 0.3), mechanism.joints[1]))
    missed = [
        np.abs(engine.build(each, 5e-4)(6, 100).pose[..., 2] - exact[..., 2]).max() for each in (mechanism, wrong)
    ]
    assert missed[1] > 5 * missed[0]
