"""Tests of fast contacts of rolling pairs and of motions of spanning trees, which several adapters use."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from engines import rolling_table
from engines.rolling_table import Table, rolled
from engines.tree import pushes, spanning_tree
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.andrews import Andrews
from reference.scenes.catalogue import SCENES
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    DiscInHole,
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reports.search.mechanisms import ALL_KINDS
from reports.search.mechanisms import mechanism as random_mechanism


def rolling_of(scene: Scene) -> Rolling:
    return next(joint.rolling for joint in scene.mechanism().joints if isinstance(joint, Roll))


# Centres and frames are displaced, so that no constant in the formulas is zero.
DISC = Placed(Circle(0.25, (0.05, -0.02)), turn=0.7, shift=(0.03, 0.04))
HILL = Placed(Circle(0.9, (0.2, 0.1)), turn=-0.4, shift=(0.5, 1.0))
PAIRS = {
    **{
        scene.name: rolling_of(scene)
        for scene in (
            *(RollingEllipse(), RollingDisc(), RollingCam(), RollingDownhill(), RollingInRing(), RollingOnCircle()),
            *(EllipticGears(), DiscInHole(clearance=0.2)),
        )
    },
    "placed disc on a slope": Rolling.at_angle(DISC, Placed(Line(math.pi + 0.2, (1.0, 2.0)), turn=0.1), 0.3, -0.6),
    "placed disc on a placed hill": Rolling.at_angle(DISC, HILL, 1.1, 0.4),
    "placed disc in a hole": Rolling.at_angle(DISC, Ring(0.8, (0.1, 0.2)), -0.5, 0.7),
    "ring round a disc": Rolling.at_angle(Ring(0.8, (0.1, 0.2)), Circle(0.3), 0.2, 0.1),
    "ellipse on a disc": Rolling.at_angle(Ellipse(0.5, 0.45), Circle(1.0), 0.0, 0.2),
    "disc on an ellipse": Rolling.at_angle(Circle(0.1), Ellipse(0.5, 0.3), 0.0, 0.2),
}
every_pair = pytest.mark.parametrize("rolling", PAIRS.values(), ids=PAIRS.keys())


def as_complex(vectors: np.ndarray) -> np.ndarray:
    return vectors[..., 0] + 1j * vectors[..., 1]


def far_and_back(rolling: Rolling) -> np.ndarray:
    """Rotations [rad] in both directions, with jumps, that reach far beyond the first cells of a table."""
    theta = rolling.theta + np.concatenate([np.linspace(-9.0, 9.0, 203), [7.3, -2.0, 4.0]])
    low, high = rolling.limits
    return theta[(low < theta) & (theta < high)]


@every_pair
def test_poses_contacts_and_arms_equal_the_reference_to_rounding(rolling: Rolling) -> None:
    theta = far_and_back(rolling)
    place, first, second = np.array(list(map(rolled(rolling).place, theta.tolist()))).T
    rate = np.ones_like(theta)
    # The tolerances are several rounding errors of lengths of about 1 m. In a hole the contact turns up to four times
    # as fast as the body, and the reference computes the contact iteratively to 1e-14.
    assert np.abs(place - as_complex(rolling.pose(theta))).max() < 2e-14
    assert np.abs(first - as_complex(rolling.velocity(theta, rate))).max() < 1e-13
    assert np.abs(second - as_complex(rolling.acceleration(theta, rate, 0 * rate))).max() < 5e-13
    fast, exact = rolled(rolling), rolling.contact(theta)
    for angle, point, arm in zip(theta.tolist(), as_complex(exact.point), as_complex(exact.arm), strict=True):
        ground, on_body = fast.contact(angle)
        assert abs(ground - point) < 1e-13  # rounding of an arc of several metres [m]
        assert abs(fast.arm(angle) - arm) < 1e-13
        assert abs(on_body + arm * cmath.rect(1.0, -angle)) < 1e-13


def test_a_pair_without_an_accurate_table_uses_exact_contacts(monkeypatch: pytest.MonkeyPatch) -> None:
    rolling = PAIRS["disc on an ellipse"]
    table = Table(rolling)
    monkeypatch.setattr(rolling_table, "POOR", 0.0)
    exact = Table(rolling)
    assert not exact._cells
    for theta in (0.0, 1.0, 4.0):
        assert np.allclose(exact.place(theta), table.place(theta), rtol=0, atol=1e-12)
        assert np.allclose(exact.contact(theta), table.contact(theta), rtol=0, atol=1e-13)
        assert abs(exact.arm(theta) - table.arm(theta)) < 1e-13


def test_beyond_the_end_of_a_curve_there_is_no_contact() -> None:
    rolling = Rolling.at_angle(Circle(0.1), Placed(Side(0.4), turn=math.pi))
    low, high = rolling.limits
    fast = rolled(rolling)
    assert abs(high - 2.0) < 1e-12  # an arc of 0.2 m on a radius of 0.1 m
    assert abs(fast.place(high - 1e-9)[0] - complex(*rolling.pose(high - 1e-9)[:2])) < 1e-15
    for beyond in (low - 1e-3, high + 1e-3, math.inf, math.nan):
        assert math.isnan(fast.place(beyond)[0].real)
        with pytest.raises(ValueError, match=r"rolling|theta"):
            fast.arm(beyond)
        with pytest.raises(ValueError, match=r"rolling|theta"):
            fast.contact(beyond)


# Random mechanisms with all kinds of joints, and mechanisms of scenes.
MECHANISMS = (
    *(random_mechanism(21, number, ALL_KINDS) for number in range(6)),
    *(scene.mechanism() for scene in SCENES[::2] if len(scene.mechanism().bodies) < 20),
)


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=range(len(MECHANISMS)))
def test_twists_and_accelerations_are_the_derivatives_of_the_poses(mechanism):
    tree = spanning_tree(mechanism)
    position, rate, change = np.random.default_rng(5).normal(size=(3, tree.coordinates))
    h = 1e-4
    t = np.array([-h, 0.0, h])[:, None]
    positions = position + rate * t + change * t**2 / 2
    pose, twist, acceleration = tree.motion(positions, rate + change * t, np.tile(change, (3, 1)))
    for values, derivative in ((pose, twist), (twist, acceleration)):
        differences = (values[2] - values[0]) / (2 * h)
        # The error of the difference is h^2 / 6 times the third derivative, which contains cubes of sums of rates.
        np.testing.assert_allclose(differences, derivative[1], rtol=0, atol=1e-4 * np.abs(derivative).max())
    for value, expected in zip(tree.instant(position, rate), (pose[1], twist[1]), strict=True):
        np.testing.assert_allclose(value, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_pushes_are_the_loads_of_the_force_elements_and_nan_for_infinite_coordinates():
    mechanism = Andrews().mechanism()
    tree = spanning_tree(mechanism)
    position, rate = np.zeros(tree.coordinates), tree.start_rates()
    pose, loads = pushes(tree, position, rate)
    np.testing.assert_allclose(pose, mechanism.pose, rtol=0, atol=1e-15 * mechanism.length_scale)
    expected = mechanism.applied.on(mechanism.pose, mechanism.twist)
    np.testing.assert_allclose(loads, expected, rtol=1e-14, atol=1e-14 * np.abs(expected).max())
    assert np.abs(loads).max() > 0
    position[0] = np.inf
    assert np.isnan(pushes(tree, position, rate)[0]).all()
