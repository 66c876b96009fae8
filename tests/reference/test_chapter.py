"""Tests of centrodes of known motions, and of shapes."""

from __future__ import annotations

import csv
import io
import math
from xml.etree import ElementTree

import numpy as np
import pytest

from engines.lagrange import Lagrange
from reference.chapter.centrodes import (
    as_csv,
    as_dxf,
    as_svg,
    centrode_error,
    centrodes,
    from_poses,
    instant_centre,
    placed_body,
    poses_from_csv,
    shapes_of,
)
from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.rolling.scenes import RollingDisc
from reference.trajectory import Trajectory
from tests.present import present

LINKAGE = FourBar(0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), (1.2, 0.0))
# Intervals without theta = 2.8006 and 5.9406 rad, where the coupler's rotation rate vanishes.
ARCS = {"coupler backward": (0.6, 2.4), "coupler forward": (3.5, 5.5)}


def coupler(low, high, count, rate=10.0):
    """Times, poses and twists of the coupler, from its end B, at a constant crank rate [rad/s]."""
    theta = np.linspace(low, high, count)
    beta, _ = LINKAGE.angles(theta)
    beta_rate, _ = LINKAGE.rates(theta, rate)
    at_b, turning = 0.4 * np.stack([np.cos(theta), np.sin(theta)], axis=-1), np.asarray(beta_rate)[:, None]
    velocity = rate * np.stack([-at_b[:, 1], at_b[:, 0]], axis=-1)
    return (theta - low) / rate, np.column_stack([at_b, beta]), np.column_stack([velocity, turning])


def cardan(count=200, length=1.0):
    """Times and poses of a ladder that slides down a wall; its centrodes are circles of radii `length` and length /
    2.
    """
    t = np.linspace(0.2, 1.3, count)
    return t, np.column_stack([length / 2 * np.cos(t), length / 2 * np.sin(t), -t])


def test_the_velocity_at_the_instant_centre_is_zero():
    rng = np.random.default_rng(0)
    pose, twist = rng.normal(size=(2, 30, 3))
    space, body = instant_centre(pose, twist)
    arm = space - pose[:, :2]
    velocity = twist[:, :2] + twist[:, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
    # By the chapter's r_C = 0 (erratum 2) the instant centre would be the origin.
    np.testing.assert_allclose(velocity, 0, atol=1e-14 * np.abs(arm).max())
    assert np.abs(space).max() > 0.1
    turned = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=-1)
    back = np.column_stack(
        [turned[:, 0] * body[:, 0] - turned[:, 1] * body[:, 1], turned[:, 1] * body[:, 0] + turned[:, 0] * body[:, 1]]
    )
    np.testing.assert_allclose(back, arm, atol=1e-14 * np.abs(arm).max())


def test_the_centrodes_of_a_sliding_ladder_are_cardans_circles():
    motion = from_poses(*cardan())
    np.testing.assert_allclose(np.linalg.norm(motion.space, axis=-1), 1.0, atol=1e-11)
    np.testing.assert_allclose(np.linalg.norm(motion.body, axis=-1), 0.5, atol=1e-11)
    inner = slice(5, -5)  # A spline's derivatives at the ends are extrapolated.
    # The curvature needs three derivatives of the poses, so its rounding error is eps / (0.0055 rad)^3.
    np.testing.assert_allclose(motion.space_curvature[inner], -1.0, atol=1e-7)
    np.testing.assert_allclose(motion.body_curvature[inner], 2.0, atol=1e-7)


@pytest.mark.parametrize("arc", ARCS)
def test_rolling_the_centrodes_of_a_coupler_reproduces_its_motion(arc):
    t, pose, twist = coupler(*ARCS[arc], 401)
    between = coupler(ARCS[arc][0] + 1e-3, ARCS[arc][1] - 1e-3, 777)[1]
    for motion in (centrodes(t, pose, twist), from_poses(t, pose)):
        found = motion.rolling().pose(between[:, 2])
        # A spline of degree 7 through 400 points over 2 rad has an error of 1e-10 in the curves. The errors of both
        # curves nearly cancel in the pose.
        np.testing.assert_allclose(found, between, rtol=0, atol=1e-11)
        assert 0 < motion.error < 1e-8


def test_the_centrode_error_is_the_velocity_error_over_the_rotation_rate():
    scene = RollingDisc()
    errors = []
    for every in (1, 2, 4):
        run = Lagrange("rk4", "none").build(scene.mechanism(), 0.02 / every)(50, every)
        errors.append(centrode_error(scene.motion(run.t), run).max())
    # Velocities by the Runge-Kutta method have errors of order 4.
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 4, atol=0.5)
    truth = scene.motion([0.0, 0.1])
    shifted = Trajectory(truth.t, truth.pose, truth.twist + np.array([1e-3, 0, 0]), truth.reaction)
    np.testing.assert_allclose(centrode_error(truth, shifted), 1e-3 / truth.twist[:, 0, 2], rtol=1e-9)
    with pytest.raises(ValueError, match="different times"):
        centrode_error(truth, scene.motion([0.0, 0.2]))


def test_shapes_have_equal_arc_lengths_and_touch_at_equal_indices():
    shapes = shapes_of(from_poses(*coupler(*ARCS["coupler forward"], 401)[:2]), points=300)
    lengths = [np.linalg.norm(np.diff(points, axis=0), axis=-1) for points in (shapes.space, shapes.body)]
    # A chord of 3 mm is shorter than the arc by about 3 mm cubed over the squared radius of curvature.
    np.testing.assert_allclose(lengths[0], lengths[1], atol=1e-6)
    for index in (0, 150, 299):
        np.testing.assert_allclose(placed_body(shapes, index)[index], shapes.space[index], atol=1e-13)


def test_shapes_can_be_read_back_from_csv_svg_and_dxf():
    shapes = shapes_of(from_poses(*cardan()), points=60)
    rows = list(csv.DictReader(io.StringIO(as_csv(shapes))))
    np.testing.assert_array_equal([[float(r["body_x"]), float(r["body_y"])] for r in rows], shapes.body)
    np.testing.assert_array_equal([[float(r["x"]), float(r["y"]), float(r["angle"])] for r in rows], shapes.pose)
    root = ElementTree.fromstring(as_svg(shapes, width=150.0))
    paths = {path.get("id"): present(path.get("d")) for path in root.iter("{http://www.w3.org/2000/svg}path")}
    drawn = {
        name: np.array([[float(v) for v in pair.split(",")] for pair in text[1:].split(" L")])
        for name, text in paths.items()
    }
    # Both curves have the same scale, so corresponding chords have equal lengths up to the rounding to four
    # decimals.
    np.testing.assert_allclose(
        *(np.linalg.norm(np.diff(drawn[name], axis=0), axis=-1) for name in ("space", "body")), atol=3e-3
    )
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.read(io.StringIO(as_dxf(shapes)))
    assert document.units == 6  # metres
    lines = {line.dxf.layer: np.array([point[:2] for point in line.get_points()]) for line in document.modelspace()}
    np.testing.assert_allclose(lines["SPACE"], shapes.space, atol=1e-12)
    np.testing.assert_allclose(lines["BODY"], shapes.body, atol=1e-12)


def test_a_table_of_poses_may_have_its_columns_in_any_order():
    t, pose = poses_from_csv("angle, x, t, y\n0.5,1,0,2\n0.6,1.5,0.1,2.5\n")
    np.testing.assert_array_equal(t, [0, 0.1])
    np.testing.assert_array_equal(pose, [[1, 2, 0.5], [1.5, 2.5, 0.6]])


def test_the_error_bound_of_centrodes_from_poses_is_above_their_true_error():
    t = np.linspace(0, 1.2, 60)
    run, pace = t + 0.05 * np.sin(12 * t), 1 + 0.6 * np.cos(12 * t)  # varying rate
    pose = np.column_stack([0.3 * np.cos(2 * run), 0.1 * np.sin(3 * run), 3 * run + 0.02 * np.sin(5 * run)])
    twist = np.column_stack([-0.6 * np.sin(2 * run), 0.3 * np.cos(3 * run), 3 + 0.1 * np.cos(5 * run)]) * pace[:, None]
    found, exact = from_poses(t, pose), centrodes(t, pose, twist)
    wrong = np.linalg.norm(found.space - exact.space, axis=-1).max()
    # Exact centrodes have a smaller error than centrodes by numerical differentiation.
    assert exact.error < wrong < found.error
