"""Large mechanisms: one is built and checked in memory in proportion to its bodies, and what can't fit is refused."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from engines.registry import ENGINES
from reference.checks import LARGEST, InvalidMechanism, require_room
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


def test_twice_the_links_take_twice_the_memory():
    small, large = (peak(NFourBar(count).mechanism) for count in (500, 1000))
    assert large < 2.2 * small  # 2 and what numpy keeps in any case; quadratic would be 4


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


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: f"{engine.name} {engine.variant}")
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
