"""Centrodes of motions whose curves are known, the round trip of a four-bar's coupler, shapes, what is refused."""

from __future__ import annotations

import csv
import io
import math
from xml.etree import ElementTree

import numpy as np
import pytest

from engines.lagrange import Lagrange
from reference.chapter.centrodes import (
    Centrodes,
    _assembled,
    _halved,
    centrode_error,
    centrodes,
    from_poses,
    instant_centre,
)
from reference.chapter.shapes import as_csv, as_dxf, as_svg, placed_body, poses_from_csv, shapes_of
from reference.checks import InvalidMechanism
from reference.rolling.closed_curves import Ellipse
from reference.rolling.kinematics import Rolling
from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.rolling.scenes import RollingDisc, RollingEllipse, RollingInRing
from reference.trajectory import Trajectory
from tests.present import present

LINKAGE = FourBar(0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), (1.2, 0.0))
# The coupler's rate vanishes at theta = 2.8006 and 5.9406 rad; these arcs of the crank stay away from there.
ARCS = {"coupler backward": (0.6, 2.4), "coupler forward": (3.5, 5.5)}


def coupler(low, high, count, rate=10.0):
    """Times, poses and twists of the coupler, its frame at B, for a constant rate of the crank [rad/s]."""
    theta = np.linspace(low, high, count)
    beta, _ = LINKAGE.angles(theta)
    beta_rate, _ = LINKAGE.rates(theta, rate)
    at_b, turning = 0.4 * np.stack([np.cos(theta), np.sin(theta)], axis=-1), np.asarray(beta_rate)[:, None]
    velocity = rate * np.stack([-at_b[:, 1], at_b[:, 0]], axis=-1)
    return (theta - low) / rate, np.column_stack([at_b, beta]), np.column_stack([velocity, turning])


def cardan(count=200, length=1.0):
    """A ladder sliding down a wall, its frame in its middle: circles of radius `length` and half of it."""
    t = np.linspace(0.2, 1.3, count)
    return t, np.column_stack([length / 2 * np.cos(t), length / 2 * np.sin(t), -t])


def test_the_instant_centre_has_no_velocity():
    rng = np.random.default_rng(0)
    pose, twist = rng.normal(size=(2, 30, 3))
    space, body = instant_centre(pose, twist)
    arm = space - pose[:, :2]
    velocity = twist[:, :2] + twist[:, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
    # The chapter's r_C = 0 (erratum 2) would put it in the origin.
    np.testing.assert_allclose(velocity, 0, atol=1e-14 * np.abs(arm).max())
    assert np.abs(space).max() > 0.1
    turned = np.stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])], axis=-1)
    back = np.column_stack(
        [turned[:, 0] * body[:, 0] - turned[:, 1] * body[:, 1], turned[:, 1] * body[:, 0] + turned[:, 0] * body[:, 1]]
    )
    np.testing.assert_allclose(back, arm, atol=1e-14 * np.abs(arm).max())


def test_a_ladders_centrodes_are_cardans_circles():
    motion = from_poses(*cardan())
    np.testing.assert_allclose(np.linalg.norm(motion.space, axis=-1), 1.0, atol=1e-11)
    np.testing.assert_allclose(np.linalg.norm(motion.body, axis=-1), 0.5, atol=1e-11)
    inner = slice(5, -5)  # at the very ends a spline's derivatives are those of extrapolation
    # Two derivatives of points that come from a derivative: rounding over the spacing cubed, 0.0055 rad.
    np.testing.assert_allclose(motion.space_curvature[inner], -1.0, atol=1e-7)
    np.testing.assert_allclose(motion.body_curvature[inner], 2.0, atol=1e-7)


def test_a_rolling_ellipses_centrodes_are_the_ellipse_and_the_ground():
    scene = RollingEllipse(start_rate=9.0, duration=1.0)  # fast enough to go over its tips
    truth = scene.motion(np.linspace(0, 1, 801))
    motion = centrodes(truth.t, truth.pose[:, 0], truth.twist[:, 0])
    theta = motion.theta[10:-10]
    contact = scene.motion_law.rolling.contact(theta)
    np.testing.assert_allclose(motion.space[:, 1], 0, atol=1e-14)
    shape = (motion.body[:, 0] / 0.5) ** 2 + (motion.body[:, 1] / 0.3) ** 2
    np.testing.assert_allclose(shape, 1, atol=1e-13)
    # Second derivatives by a spline of points 8 mm apart.
    np.testing.assert_allclose(motion.space_curvature[10:-10], 0, atol=1e-6)
    np.testing.assert_allclose(motion.body_curvature[10:-10], contact.body_curvature, rtol=1e-6)
    np.testing.assert_allclose(motion.rate[10:-10], contact.rate, rtol=1e-8)


def test_a_body_in_a_ring_has_centrodes_of_opposite_curvature():
    scene = RollingInRing(start_rate=1.0)
    truth = scene.motion(np.linspace(0, 0.1, 101))
    motion = centrodes(truth.t, truth.pose[:, 0], truth.twist[:, 0])
    np.testing.assert_allclose(motion.space_curvature[10:-10], -1 / 1.5, rtol=1e-5)


@pytest.mark.parametrize("arc", ARCS)
def test_rolling_the_couplers_curves_gives_its_motion_back(arc):
    t, pose, twist = coupler(*ARCS[arc], 401)
    between = coupler(ARCS[arc][0] + 1e-3, ARCS[arc][1] - 1e-3, 777)[1]
    for motion in (centrodes(t, pose, twist), from_poses(t, pose)):
        found = motion.rolling().pose(between[:, 2])
        # Asked: 1e-8. Splines of degree 7 at 400 points over 2 rad leave their eighth power, 1e-10 in the curves; a
        # point carried back is wrong by less, for the errors of the two curves are the same.
        np.testing.assert_allclose(found, between, rtol=0, atol=1e-11)
        assert 0 < motion.error < 1e-8


def test_the_round_trip_catches_a_body_curve_a_thousandth_too_large():
    t, pose, twist = coupler(*ARCS["coupler forward"], 401)
    right = centrodes(t, pose, twist)
    wrong = Centrodes(right.pose, right.space, right.body * 1.001, right.error)
    assert np.abs(wrong.rolling().pose(pose[50:-50, 2]) - pose[50:-50]).max() > 1e-5


def test_the_round_trip_catches_a_body_curve_mirrored():
    t, pose, twist = coupler(*ARCS["coupler forward"], 401)
    right = centrodes(t, pose, twist)
    wrong = Centrodes(right.pose, right.space, right.body * [1, -1], right.error)
    try:
        missed = np.abs(wrong.rolling().pose(pose[180:220, 2]) - pose[180:220]).max()
    except InvalidMechanism:
        return  # it may not even be possible to roll
    assert missed > 1e-3


@pytest.mark.parametrize("arc", ARCS)
def test_the_centres_way_per_radian_is_one_over_the_sum_of_the_curvatures(arc):
    motion = centrodes(*coupler(*ARCS[arc], 801))
    inner = slice(10, -10)
    total = motion.space_curvature + motion.body_curvature
    # Curvatures are second derivatives of a spline: its error 1e-12 over the spacing squared.
    np.testing.assert_allclose(motion.rate[inner] * total[inner], 1, atol=1e-8)
    assert np.abs(motion.rate * (motion.space_curvature - motion.body_curvature) - 1).max() > 0.1
    np.testing.assert_allclose(motion.space_arc, motion.body_arc, atol=1e-12)


def test_the_stated_error_is_above_the_true_one_and_falls_with_it():
    stated, true = [], []
    for count in (51, 101, 201):
        t, pose, _ = coupler(*ARCS["coupler forward"], count)
        motion = from_poses(t, pose)
        fine = coupler(3.5 + 1e-3, 5.5 - 1e-3, 999)
        exact = instant_centre(fine[1], fine[2])[0]
        true.append(float(np.linalg.norm(motion.space_curve.point_of(fine[1][:, 2]) - exact, axis=-1).max()))
        stated.append(motion.error)
    assert all(s > e for s, e in zip(stated, true, strict=True))
    assert true[0] > 30 * true[1] > 900 * true[2]


@pytest.mark.parametrize("worse", ["body", "space"])
def test_the_stated_error_is_that_of_the_worse_of_the_two_curves(worse):
    # A circle of 1 mm rolls on the outside of one of a metre, or inside it turns at its own centre's place: the curve
    # that runs round once a turn is resolved coarsely by eight places a turn, the other, of one gentle arc, well.
    t = np.linspace(0, 1, 65)
    small, angle = 1e-3 * np.exp(8j * np.pi * t), 4 * np.pi * t
    gentle = 1e-3 * np.exp(0.5j * t)
    space = small if worse == "space" else gentle
    body = gentle if worse == "space" else small
    pose = np.column_stack([np.zeros((65, 2)), angle])
    found = _assembled(pose, *(np.column_stack([z.real, z.imag]) for z in (space, body)))
    coarse, fine = (_halved(angle, np.column_stack([z.real, z.imag])) for z in (small, gentle))
    assert coarse > 1e3 * fine
    assert found.error == coarse


def test_neither_speed_nor_wrapping_nor_direction_of_the_table_changes_the_shapes():
    t, pose, _ = coupler(*ARCS["coupler forward"], 401)
    plain = from_poses(t, pose)
    wrapped = pose.copy()
    wrapped[:, 2] = np.remainder(pose[:, 2] - 1.2, 2 * np.pi) - np.pi + 1.2 - np.pi
    for times, poses in ((t**2 + t, pose), (t, pose[::-1]), (t, wrapped)):
        np.testing.assert_allclose(
            from_poses(times, poses).space_curvature[20:-20], plain.space_curvature[20:-20], 1e-4
        )


def test_an_engines_centrodes_are_wrong_by_its_velocity_error_over_its_rate():
    scene = RollingDisc()
    errors = []
    for every in (1, 2, 4):
        run = Lagrange("rk4", "none").build(scene.mechanism(), 0.02 / every)(50, every)
        errors.append(centrode_error(scene.motion(run.t), run).max())
    # Runge-Kutta's fourth order, seen in the velocities alone.
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 4, atol=0.5)
    truth = scene.motion([0.0, 0.1])
    shifted = Trajectory(truth.t, truth.pose, truth.twist + np.array([1e-3, 0, 0]), truth.reaction)
    np.testing.assert_allclose(centrode_error(truth, shifted), 1e-3 / truth.twist[:, 0, 2], rtol=1e-9)
    with pytest.raises(ValueError, match="different times"):
        centrode_error(truth, scene.motion([0.0, 0.2]))


def test_shapes_are_equally_long_and_touch_where_they_say():
    shapes = shapes_of(from_poses(*coupler(*ARCS["coupler forward"], 401)[:2]), points=300)
    lengths = [np.linalg.norm(np.diff(points, axis=0), axis=-1) for points in (shapes.space, shapes.body)]
    # Chords of 3 mm are shorter than their arcs by the cube of that over the radius squared.
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
    # Both to one scale: a chord of the one is as long as that of the other, to the four decimals written.
    np.testing.assert_allclose(
        *(np.linalg.norm(np.diff(drawn[name], axis=0), axis=-1) for name in ("space", "body")), atol=3e-3
    )
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.read(io.StringIO(as_dxf(shapes)))
    assert document.units == 6  # metres, in the format's own list
    lines = {line.dxf.layer: np.array([point[:2] for point in line.get_points()]) for line in document.modelspace()}
    np.testing.assert_allclose(lines["SPACE"], shapes.space, atol=1e-12)
    np.testing.assert_allclose(lines["BODY"], shapes.body, atol=1e-12)


def test_what_is_higher_in_the_world_is_higher_in_the_drawing():
    shapes = shapes_of(from_poses(*cardan()), points=60)
    root = ElementTree.fromstring(as_svg(shapes, width=150.0))
    text = next(present(path.get("d")) for path in root.iter() if path.get("id") == "space")
    drawn = np.array([[float(v) for v in pair.split(",")] for pair in text[1:].split(" L")])
    # SVG counts y downwards. One scale for both directions, to the four decimals written.
    scale = np.ptp(drawn[:, 0]) / np.ptp(shapes.space[:, 0])
    np.testing.assert_allclose(drawn[1:] - drawn[0], (shapes.space[1:] - shapes.space[0]) * [scale, -scale], atol=2e-4)


def test_a_table_of_poses_is_read_in_any_order_of_columns():
    t, pose = poses_from_csv("angle, x, t, y\n0.5,1,0,2\n0.6,1.5,0.1,2.5\n")
    np.testing.assert_array_equal(t, [0, 0.1])
    np.testing.assert_array_equal(pose, [[1, 2, 0.5], [1.5, 2.5, 0.6]])


T = np.arange(40) / 40
REFUSED = {
    "poses that don't rotate": (lambda: from_poses(T, np.column_stack([T, T**2, 0 * T])), "doesn't rotate"),
    "a rate that changes its sign": (
        lambda: from_poses(*coupler(0.6, 5.0, 401)[:2]),
        "changes its sign between t = 0.2",
    ),
    "a rate that vanishes at a sample": (lambda: from_poses(T, np.column_stack([T, T, T**2])), "vanishes at t = 0 s"),
    "a pure rotation": (lambda: from_poses(T, np.column_stack([np.cos(T), np.sin(T), T])), "only rotates about it"),
    "too few poses": (lambda: from_poses(T[:9], np.column_stack([T, T, T])[:9]), "too few"),
    "times that go back": (lambda: from_poses(-T, np.column_stack([T, T, T])), "not after"),
    "poses not finite": (lambda: from_poses(T, np.column_stack([T, T, T * np.nan])), "finite"),
    "twists of another length": (lambda: centrodes(T, np.column_stack([T, T, T]), np.ones((3, 3))), "one for each"),
    "pairs instead of poses": (lambda: from_poses(T, np.column_stack([T, T])), "of shape"),
    "a missing column": (lambda: poses_from_csv("t,x,y\n1,2,3\n"), "no column 'angle'"),
    "a word in a number's place": (lambda: poses_from_csv("t,x,y,angle\n0,1,2,3\n1,2,3,left\n"), "line 3"),
    "an empty table": (lambda: poses_from_csv(""), "no column"),
    "a curve of one point": (lambda: shapes_of(from_poses(*cardan()), points=1), "from 2 to"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_motion_without_curves_is_refused_with_the_instant(case):
    make, reason = REFUSED[case]
    with pytest.raises(InvalidMechanism, match=reason):
        make()


def test_the_round_trip_of_an_ellipse_on_its_twin():
    ellipse = Ellipse(0.5, 0.3)
    rolling = Rolling.at_arcs(ellipse, ellipse, 0.0, ellipse.length / 2)
    theta = np.linspace(0, 2.5, 500)
    motion = from_poses(theta, rolling.pose(theta))
    np.testing.assert_allclose(motion.space, rolling.contact(theta).point, atol=1e-10)
    inner = slice(20, -20)
    np.testing.assert_allclose(motion.space_curvature[inner], motion.body_curvature[inner], atol=1e-5)
    np.testing.assert_allclose(motion.rolling().pose(theta[inner]), rolling.pose(theta[inner]), atol=1e-11)


def test_the_stated_error_of_a_table_of_poses_is_above_that_of_its_differentiation():
    t = np.linspace(0, 1.2, 60)
    run, pace = t + 0.05 * np.sin(12 * t), 1 + 0.6 * np.cos(12 * t)  # the same curves, run through unsteadily
    pose = np.column_stack([0.3 * np.cos(2 * run), 0.1 * np.sin(3 * run), 3 * run + 0.02 * np.sin(5 * run)])
    twist = np.column_stack([-0.6 * np.sin(2 * run), 0.3 * np.cos(3 * run), 3 + 0.1 * np.cos(5 * run)]) * pace[:, None]
    found, exact = from_poses(t, pose), centrodes(t, pose, twist)
    wrong = np.linalg.norm(found.space - exact.space, axis=-1).max()
    # What the table leaves out between its poses is less than what its slopes are wrong by.
    assert exact.error < wrong < found.error
