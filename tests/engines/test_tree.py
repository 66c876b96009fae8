"""Motions of a spanning tree: places, their rates and those of these, at many times and at one instant."""

from __future__ import annotations

import numpy as np
import pytest

from engines.tree import pushes, spanning_tree
from reference.scenes.andrews import Andrews
from reference.scenes.catalogue import SCENES
from reports.search.mechanisms import EVERY
from reports.search.mechanisms import mechanism as random_mechanism

# Random ones with every joint, and those of the scenes, where a slot's drive of rate zero keeps its block from turning.
MECHANISMS = (*(random_mechanism(21, number, EVERY) for number in range(12)), *(scene.mechanism() for scene in SCENES))


def test_the_mechanisms_have_every_kind_of_link():
    links = [link for mechanism in MECHANISMS for link in spanning_tree(mechanism).links]
    assert {(link.kind, link.turns) for link in links} == {
        ("free", True),
        ("hinge", True),
        ("hinge", False),
        ("slot", True),
        ("slot", False),
    }


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=range(len(MECHANISMS)))
def test_twists_and_accelerations_are_the_derivatives_of_the_poses(mechanism):
    tree = spanning_tree(mechanism)
    way, rate, gain = np.random.default_rng(5).normal(size=(3, tree.coordinates))
    h = 1e-4
    t = np.array([-h, 0.0, h])[:, None]
    pose, twist, change = tree.motion(way + rate * t + gain * t**2 / 2, rate + gain * t, np.tile(gain, (3, 1)))
    for values, derivative in ((pose, twist), (twist, change)):
        differences = (values[2] - values[0]) / (2 * h)
        # What the difference misses is h^2 times a third derivative: cubes of rates, which are sums over many links.
        np.testing.assert_allclose(differences, derivative[1], rtol=0, atol=1e-4 * np.abs(derivative).max())
    for found, expected in zip(tree.instant(way, rate), (pose[1], twist[1]), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_what_is_pushed_is_what_the_force_elements_do_there_and_nothing_where_a_coordinate_is_none():
    mechanism = Andrews().mechanism()
    tree = spanning_tree(mechanism)
    way, rate = np.zeros(tree.coordinates), tree.start_rates()
    pose, pushed = pushes(tree, way, rate)
    np.testing.assert_allclose(pose, mechanism.pose, rtol=0, atol=1e-15 * mechanism.length_scale)
    expected = mechanism.applied.on(mechanism.pose, mechanism.twist)
    np.testing.assert_allclose(pushed, expected, rtol=1e-14, atol=1e-14 * np.abs(expected).max())
    assert np.abs(pushed).max() > 0
    way[0] = np.inf
    assert np.isnan(pushes(tree, way, rate)[0]).all()
