"""Large mechanisms take memory in proportion to their bodies; lengths and times of all mechanisms."""

from __future__ import annotations

import math
import tracemalloc
from itertools import product

import numpy as np
import pytest

from engines import method_name
from engines.registry import ENGINES
from reference.checks import LARGEST, InvalidMechanism, require_room
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.scales import convex_hull, diameter, length_scale, time_scale
from reference.scenes.many_links import LongPendulum
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from tests.mechanisms import four_bar

LINKS = 5_000
# Measured: 1.4 to 1.9 kB a link, in Python objects and in arrays of all of them. One dense matrix of the rows alone
# would be 48 N bytes a link: 240 kB with 5000 links.
BYTES_A_LINK = 4_000


def peak(build) -> int:
    """The largest number of bytes that `build` held at any time."""
    tracemalloc.start()
    try:
        build()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("scene", [LinkPendulum(links=LINKS), NFourBar(LINKS // 2)], ids=["open chain", "closed chain"])
def test_a_long_chain_is_built_and_its_start_checked_in_memory_in_proportion_to_its_links(scene):
    def build():
        mechanism = scene.mechanism()
        assert mechanism.length_scale == pytest.approx(scene.length)
        assert 0.1 < mechanism.time_scale < 1

    assert peak(build) < BYTES_A_LINK * LINKS


MECHANISMS = {
    "four-bar with a drive": four_bar(crank_rate=10.0, drive=10.0),
    "open chain": LinkPendulum(links=7).mechanism(),
    "closed chain": NFourBar(5).mechanism(),
    "skate": ChaplyginSleigh().mechanism(),
    "pins and skates": CarAndTrailer().mechanism(),
    "rolls, that are taken one by one": EllipticGears().mechanism(),
}


@pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS)
def test_velocities_joint_by_joint_are_those_of_the_dense_rows(mechanism):
    random = np.random.default_rng(8)
    pose = mechanism.pose + 1e-3 * random.normal(size=(4, *mechanism.pose.shape))
    twist = random.normal(size=pose.shape)
    flat = twist.reshape(len(twist), -1, 1)
    dense = (mechanism.rows(pose) @ flat)[..., 0] - mechanism.rate
    np.testing.assert_allclose(mechanism.slip(pose, twist), dense, rtol=0, atol=1e-14)  # sums in another order
    dense = -np.imag(mechanism.rows(pose + 1e-100j * twist) @ flat)[..., 0] / 1e-100
    np.testing.assert_allclose(mechanism.bias(pose, twist), dense, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(mechanism.slip(pose[0], twist), mechanism.slip(pose[[0] * 4], twist))


def test_reactions_of_one_pose_are_those_of_a_list_with_one():
    scene = NFourBar(20)
    mechanism = scene.mechanism()
    still = np.zeros_like(mechanism.pose)
    found = mechanism.reaction(mechanism.pose, still)
    np.testing.assert_array_equal(found, mechanism.reaction(mechanism.pose[None], still[None])[0])
    np.testing.assert_allclose(
        found,
        mechanism._dense_reaction(mechanism.pose, still - mechanism.free_fall, mechanism.inertias),
        rtol=0,
        atol=1e-9,
    )


def test_what_can_not_fit_is_refused_with_the_bytes_it_would_take():
    chain = LongPendulum(20_000).mechanism()
    with pytest.raises(InvalidMechanism, match=r"dense rows .* would take 1\.92e\+10 bytes; more than 2\.15e\+09"):
        chain.rows(chain.pose)
    loops = NFourBar(1000).mechanism()
    with pytest.raises(InvalidMechanism, match=r"the rank of rows .* would take 2\.88e\+08 bytes"):
        loops.degrees_of_freedom()
    with pytest.raises(InvalidMechanism, match=r"inertia matrix .* would take 3\.2e\+09 bytes"):
        _ = Chain((1.0,) * 20_000, (1.0,) * 20_000).inertia_matrix
    for scene in (NFourBar(5_000), LinkPendulum(links=10_000)):
        with pytest.raises(InvalidMechanism, match=r"a trajectory .* would take 2\.4e\+09 bytes"):
            scene.motion(np.zeros(10_000))


@pytest.mark.parametrize("engine", ENGINES, ids=method_name)
def test_no_engine_begins_a_run_whose_trajectory_can_not_fit(engine):
    run = engine.build(LinkPendulum(links=2).mechanism(), 1e-3)
    with pytest.raises(ValueError, match=r"a trajectory of the shape \(100000001, 2, 3\) would take 4\.8e\+09 bytes"):
        run(100_000_000, 1)


def test_room_is_counted_in_bytes():
    require_room("an array", (LARGEST // 8,))
    with pytest.raises(InvalidMechanism, match="an array of the shape"):
        require_room("an array", (LARGEST // 8 + 1,))
    with pytest.raises(InvalidMechanism, match="an array of the shape"):
        require_room("an array", (LARGEST // 8,), size=16)


RNG = np.random.default_rng(5)
TURN = 0.3  # rad: no side of a turned figure is parallel to an axis, and parallel sides are so up to rounding only


def ring(corners, turn=0.0):
    angle = 2 * np.pi * np.arange(corners) / corners + turn
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def turned(points):
    return points @ np.array([[math.cos(TURN), math.sin(TURN)], [-math.sin(TURN), math.cos(TURN)]])


GRID = np.array(list(product(range(5), range(4))), dtype=float)
FIGURES = {
    "one point": np.array([[0.4, -2.0]]),
    "two points": np.array([[0.4, -2.0], [1.0, 3.0]]),
    "a point twice": np.array([[1.0, 2.0], [1.0, 2.0]]),
    "points on a line": np.outer(RNG.uniform(-3, 3, 20), [0.3, 0.7]),
    "a square": np.array(list(product((0.0, 1.0), repeat=2))),
    "a grid": GRID,
    "a turned grid": turned(GRID),
    "a turned rectangle": turned(np.array(list(product((0.0, 3.0), (0.0, 1.0))))),
    # Far away its sides are parallel up to the rounding of the places, which decides what is opposite.
    "a thin parallelogram far away": np.array(
        [
            [1537.764128567019, 1459.6705384725906],
            [1538.4570513442366, 1458.427049168372],
            [1537.7614366163036, 1459.6716395237834],
            [1538.4543593935211, 1458.4281502195647],
        ]
    ),
    "a parallelogram": np.array([[0.0, 0.0], [4.0, 0.0], [5.0, 1.0], [1.0, 1.0]]),
    **{f"a ring of {n}": ring(n, 0.1 * n) for n in (3, 4, 7, 12)},
    **{f"a cloud {k}": RNG.normal(size=(40, 2)) * (1.0, 10.0**-k) for k in (0, 2, 5)},
}


@pytest.mark.parametrize("points", FIGURES.values(), ids=FIGURES.keys())
def test_the_diameter_is_the_largest_of_all_distances(points):
    own = [(float(x), float(y)) for x, y in points]
    largest = max(math.dist(p, q) for p in own for q in own)
    for _ in range(5):
        RNG.shuffle(own)
        assert diameter(own) == pytest.approx(largest, rel=1e-15)


def test_the_hull_goes_round_every_point_and_has_no_corner_too_many():
    points = [tuple(point) for point in RNG.normal(size=(200, 2)).tolist()]
    hull = np.array(convex_hull(points))
    side, towards = np.roll(hull, -1, axis=0) - hull, np.array(points)[:, None] - hull
    assert np.min(side[:, 0] * towards[..., 1] - side[:, 1] * towards[..., 0]) > -1e-14
    before = np.roll(side, 1, axis=0)
    assert np.all(before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0] > 0)
    assert sorted(convex_hull([(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (1.0, 1.0)])) == [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]


def test_a_body_with_many_joints_has_its_length_without_a_look_at_every_pair():
    # Twenty thousand joints: all pairs would be 4e8 distances, minutes of them.
    rim = ring(20_000).tolist()
    wheel = Body("wheel", 1.0, 1.0, (0.0, 0.0, 0.0))
    pins = tuple(Pin(f"pin {i}", None, "wheel", (x, y), (x, y)) for i, (x, y) in enumerate(rim))
    assert Mechanism((wheel,), pins).length_scale == pytest.approx(2.0, rel=1e-15)


BODY = Body("b", 2.0, 0.5, (0.0, 0.0, 0.0))
AT = (0.3, 0.4)  # half a metre from the centre: a force there feels 1/2 + 0.25/0.5 = 1 per kilogram


@pytest.mark.parametrize(
    ("force", "rate"),
    [
        (Spring("f", None, "b", (1.0, 1.0), AT, 9.0, 1.0), 3.0),
        (Damper("f", None, "b", (1.0, 1.0), AT, 7.0), 7.0),
        (TorsionSpring("f", None, "b", 8.0), 4.0),
        (TorsionDamper("f", None, "b", 3.0), 6.0),
        (Torque("f", None, "b", 2.0), 2.0),
        (Torque("f", None, "b", -2.0), 2.0),
        (Force("f", "b", AT, (0.0, -12.0)), 4.0),
    ],
    ids=lambda each: type(each).__name__ if not isinstance(each, float) else "",
)
def test_a_force_alone_sets_the_time_by_what_it_does_to_its_body(force, rate):
    assert time_scale(0.75, (0.0, 0.0), [BODY], [], [force]) == pytest.approx(1 / rate, rel=1e-14)


def test_two_bodies_of_a_spring_count_together_and_a_faster_start_more():
    pair = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0))]
    spring = Spring("f", "c", "b", (0.0, 0.0), AT, 8.0, 1.0)
    assert time_scale(0.75, (0.0, 0.0), pair, [], [spring]) == pytest.approx(1 / 4, rel=1e-14)  # 1 + 1 per kilogram
    turning = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0), (0.0, 0.0, -5.0))]
    assert time_scale(0.75, (0.0, 0.0), turning, [], [spring]) == pytest.approx(1 / 5, rel=1e-14)
    moving = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0), (-3.0, 4.0, 0.0))]
    assert time_scale(0.5, (0.0, 0.0), moving, [], [spring]) == pytest.approx(1 / 10, rel=1e-14)


def test_a_rod_is_as_long_as_the_mechanism_even_between_centres_of_mass():
    pair = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0))]
    rod = Rod("r", "b", "c", (0.0, 0.0), (0.0, 0.0), 3.0)
    assert length_scale(pair, [rod]) == 3.0
    assert length_scale(pair, [rod], [Spring("s", None, "b", (0.0, 0.0), (3.0, 4.0), 1.0)]) == 5.0
    assert length_scale(pair, [], [Spring("s", "b", "c", (0.0, 0.0), (0.0, 0.0), 1.0, 0.2)]) == 0.2
    assert length_scale(pair, []) == 1.0
