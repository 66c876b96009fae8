"""Drawings read back: poses at their instants, points at their places, what is off over what is right."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from reference import trajectory as outlines
from reference.chapter.centrodes import Centrodes
from reference.joints import Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse, RollingOnCircle
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reports.pages.centrodes.page import draw_centrodes, draw_rate
from reports.pages.rolling import drawings as rolling_drawings
from reports.pages.rolling import page as rolling_charts
from reports.plots import mechanisms as drawings
from reports.plots.mechanisms import PALEST, Strip, outline, path, stroboscope
from reports.plots.plane_panels import Blades, Note, Panel, Path, paths
from reports.plots.theme import LIGHT
from tests.drawn import annotation, handles
from tests.mechanisms import four_bar, pendulum
from tests.present import present
from tests.toys import Disc


def lines(panel: Axes) -> list[np.ndarray]:
    return [np.asarray(line.get_xydata(), dtype=float) for line in panel.get_lines()]


def has(panel: Axes, points) -> bool:
    """Whether one line of a panel goes through these points and no others."""
    wanted = np.asarray(points, dtype=float)
    return any(found.shape == wanted.shape and np.allclose(found, wanted, equal_nan=True) for found in lines(panel))


def colours(panel: Axes) -> list[str]:
    return [to_hex(line.get_color()) for line in panel.get_lines()]


def test_a_bodys_points_are_its_joints_turned_and_moved():
    mechanism = four_bar()
    found = outlines.body_points(mechanism, mechanism.pose)
    # A = (0, 0), B = (0, 0.4), C = (0.4, 0.8), D = (1.2, 0).
    assert found["crank"] == pytest.approx(np.array([[0.0, 0.0], [0.0, 0.4]]), abs=1e-12)
    assert found["coupler"] == pytest.approx(np.array([[0.0, 0.4], [0.4, 0.8]]), abs=1e-12)
    assert found["rocker"] == pytest.approx(np.array([[0.4, 0.8], [1.2, 0.0]]), abs=1e-12)
    assert outlines.ground_points(mechanism) == pytest.approx(np.array([[0.0, 0.0], [1.2, 0.0]]))
    # A slot in the ground holds to a line: its point is no support.
    crank = DrivenSliderCrank(offset=0.1).mechanism()
    assert any(isinstance(joint, Slot) and joint.first is None for joint in crank.joints)
    assert outlines.ground_points(crank) == pytest.approx(np.zeros((1, 2)))


def test_a_method_is_visibly_off_by_its_worst_joint_and_never_where_it_is_not_finite():
    mechanism = pendulum()
    pose = mechanism.pose
    shifted = pose + np.array([0.0, 0.01, 0.0])
    assert drawings.visibly_off(mechanism, pose, shifted, 1.0)
    assert not drawings.visibly_off(mechanism, pose, shifted, 3.0)  # a two-hundredth of the picture is 0.015 m there
    assert not drawings.visibly_off(mechanism, pose, shifted * np.nan, 1e-9)
    disc = Disc().mechanism()
    assert not drawings.visibly_off(disc, disc.pose, disc.pose, 1.0)


def test_configurations_have_each_pose_under_its_title_and_methods_over_them_where_they_differ():
    mechanism = four_bar()
    truth = np.stack([mechanism.pose, mechanism.pose + 0.1, mechanism.pose - 0.1])
    other = truth + np.array([0.2, 0.0, 0.0]) * np.array([0, 1, 0])[:, None, None]
    figure = drawings.configurations(
        mechanism, truth, ["zero", "one", "two"], {"wrong": (other, "first", "--"), "right": (truth, "second", ":")}
    )
    panels = figure.axes[:3]
    assert [panel.get_title(loc="left") for panel in panels] == ["zero", "one", "two"]
    for index, panel in enumerate(panels):
        assert all(has(panel, bar) for bar in outlines.body_points(mechanism, truth[index]).values())
        assert (to_hex(LIGHT.first) in colours(panel)) == (index == 1)
        assert to_hex(LIGHT.second) not in colours(panel)
    assert all(has(panels[1], bar) for bar in outlines.body_points(mechanism, other[1]).values())
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["truth", "wrong", "right: not visibly off"]


def test_an_outline_has_further_points_in_order_along_the_body_and_a_path_those_of_the_truth():
    mechanism = pendulum(angle=math.pi / 2)  # from the origin straight up, one metre
    found = outline(mechanism, mechanism.pose, {"bar": ((0.5, 0.0), (0.0, 0.1))})["bar"]
    assert found == pytest.approx(np.array([[0.0, 0.0], [-0.1, 0.5], [0.0, 1.0]]), abs=1e-12)
    found = path(Disc(rate=2.0), "disc", (1.0, 0.5), np.array([0.0, math.pi / 4]))
    assert found == pytest.approx(np.array([[1.0, 0.5], [-0.5, 1.0]]), abs=1e-12)


def test_a_strip_takes_its_poses_at_equal_times_and_says_so():
    strip = Strip(Disc(duration=2.0), "Turning", 5, start=0.5, end=1.5)
    assert strip.times() == pytest.approx([0.5, 0.75, 1.0, 1.25, 1.5])
    assert strip.caption == "Turning: every 0.25 s"
    assert Strip(Disc(duration=2.0), "Turning", 3).times() == pytest.approx([0.0, 1.0, 2.0])
    assert Strip(Disc(), "Once", 1, start=0.125).caption == "Once: 0.125 s"
    strips = [
        Strip(Disc(duration=end), name, 2, ends={"disc": ((1.0, 0.0),)}) for end, name in ((1.0, "One"), (3.0, "Two"))
    ]
    assert [panel.get_title(loc="left") for panel in stroboscope(strips).axes] == [each.caption for each in strips]


def test_a_stroboscope_has_every_pose_of_its_scene_the_last_in_full_ink():
    ends = {"disc": ((1.0, 0.0),)}
    strip = Strip(Disc(rate=2.0, duration=1.0), "Turning", 3, ends=ends, trace=("disc", (0.0, 1.0)))
    [panel] = stroboscope((strip,), columns=1).axes
    bars = [line for line in panel.get_lines() if line.get_color() == LIGHT.ink]
    for line, angle in zip(bars, (0.0, 1.0, 2.0), strict=True):
        points = np.asarray(line.get_xydata(), dtype=float)
        assert points[:2] == pytest.approx(np.array([[0, 0], [math.cos(angle), math.sin(angle)]]), abs=1e-12)
    strengths = [present(line.get_alpha()) for line in bars]
    assert strengths == sorted(strengths)
    assert (strengths[0], strengths[-1]) == (PALEST, 1.0)
    [trace] = [line for line in panel.get_lines() if line.get_color() == LIGHT.second]
    points = np.asarray(trace.get_xydata(), dtype=float)
    assert points[[0, -1]] == pytest.approx(np.array([[0.0, 1.0], [-math.sin(2.0), math.cos(2.0)]]))


def test_a_film_moves_each_pose_to_the_right_and_stands_on_its_floor():
    strip = Strip(Disc(rate=0.0, duration=1.0), "Film", 3, ends={"disc": ((1.0, 0.0),)}, spread=1.5, floor=True)
    [panel] = stroboscope((strip,), columns=1).axes
    bars = [line for line in panel.get_lines() if line.get_color() == LIGHT.ink]
    assert [np.asarray(line.get_xydata())[0, 0] for line in bars] == pytest.approx([0.0, 1.5, 3.0])
    assert all(line.get_alpha() == 1.0 for line in bars)
    floors = [line for line in panel.get_lines() if line.get_color() == LIGHT.quiet]
    assert any(set(np.asarray(line.get_ydata())) == {0.0} for line in floors)


def test_paths_are_drawn_through_their_finite_points_in_their_panel_with_their_colour():
    near = [[0.0, 0.0], [1.0, 2.0]]
    wrong = [[0.0, 0.0], [math.nan, 0.0], [9.0, 8.0]]
    blades = Blades([[0.5, 0.5, math.pi / 2]], 0.2, "quiet")
    first = Panel(
        "first", [Path(near, "truth"), Path(wrong, "wrong", "first", "--", framed=False, dot=True)], [blades],
        [Note((0.25, 1.5), "here", "center")],
    )  # fmt: skip
    second = Panel(
        "second", [Path([[1.0, 1e-3], [2.0, 1e-1]], "truth")], plane=False, across="time [s]", up="m", logarithmic=True
    )
    left, right = paths([first, second], columns=2).axes
    assert [panel.get_title(loc="left") for panel in (left, right)] == ["first", "second"]
    assert has(left, near)
    assert has(left, [[0.0, 0.0], [9.0, 8.0]])
    assert has(left, [[9.0, 8.0]])  # the dot at its end
    assert has(left, [[0.5, 0.4], [0.5, 0.6]])  # a blade of 0.2 m upright about its middle
    assert [(text.get_text(), annotation(text).xy) for text in left.texts] == [("here", (0.25, 1.5))]
    assert (right.get_xlabel(), right.get_ylabel(), right.get_yscale()) == ("time [s]", "m", "log")
    assert has(right, [[1.0, 1e-3], [2.0, 1e-1]])
    assert [to_hex(handle.get_color()) for handle in handles(left.figure.legends[0])] == [
        to_hex(LIGHT.ink),
        to_hex(LIGHT.first),
    ]
    # What is not framed does not stretch the picture.
    assert left.get_xlim()[1] < 2
    assert left.get_ylim() == (pytest.approx(-0.14), pytest.approx(2.14))


def test_friction_is_that_of_the_scenes_law_with_each_limits_instant():
    scenes = (RollingEllipse(), RollingOnCircle())
    for panel, scene in zip(rolling_charts.draw_friction(scenes).axes, scenes, strict=True):
        demanded = lines(panel)[0]
        assert demanded[5:50, 1] == pytest.approx(scene.motion_law.required_friction(demanded[5:50, 0]))
        assert demanded[-1, 0] == pytest.approx(scene.hop or scene.duration)
        slips = {mu: scene.motion_law.slip(mu, scene.duration) for mu in rolling_charts.COEFFICIENTS}
        marked = [tuple(line[0]) for line in lines(panel) if len(line) == 1]
        assert marked == [(pytest.approx(slip), mu) for mu, slip in slips.items() if slip is not None]
        told = sorted(text.get_text() for text in panel.texts if "s " in text.get_text())
        hops = [] if scene.hop is None else [f"hops {scene.hop:.3f} s"]
        assert told == sorted([*hops, *(f"slips {s:.3f} s" for s in slips.values() if s is not None)])
        assert panel.get_xlim() == (0, scene.duration)


def test_accelerations_are_drawn_in_their_units():
    left, right = rolling_charts.draw_acceleration().axes
    pinned, term = lines(left)[:2]
    # An ellipse of 0.5 and 0.3 m on a line: pinned, 1 rad/s times the height; rolling, a^2/b at the flat side.
    assert pinned[[0, -1], 1] == pytest.approx([0.3, 0.3])
    assert term[0] == pytest.approx([0.0, 0.5**2 / 0.3], rel=1e-6)
    assert term[-1, 0] == pytest.approx(180.0)
    fit = lines(right)[0]
    assert fit[:, 0] * fit[:, 1] == pytest.approx(np.ones(len(fit)))


def test_gears_stand_at_the_instants_that_their_titles_tell_and_turn_at_the_truths_rates():
    scene = EllipticGears()
    *pictures, rates = rolling_drawings.draw_gears(scene).axes
    turn = 2 * math.pi / scene.turning_rate
    for index, panel in enumerate(pictures):
        t = (0.15 + index) * turn / 4
        assert panel.get_title(loc="left") == f"t = {t:.2f} s"
        for gear, pose in enumerate(scene.motion([t]).pose[0]):
            assert has(panel, [[2 * scene.major * gear, 0.0], pose[:2]])
    first, second = lines(rates)
    truth = scene.motion(first[:, 0]).twist[:, :, 2]
    assert first[:, 1] == pytest.approx(truth[:, 0])
    assert second[:, 1] == pytest.approx(truth[:, 1])


def test_roulettes_have_their_point_on_their_path():
    chosen = rolling_drawings.roulettes()[:2]
    for panel, one in zip(rolling_drawings.draw_roulettes(chosen).axes, chosen, strict=True):
        assert panel.get_title(loc="left") == one.title
        dots = [line[0] for line in lines(panel) if len(line) == 1]
        assert dots == [pytest.approx(one.rolling.position(theta, one.point)) for theta in one.shown]
        path_drawn = lines(panel)[-1]
        assert path_drawn[0] == pytest.approx(one.rolling.position(one.path[0], one.point))
        assert path_drawn[-1] == pytest.approx(one.rolling.position(one.path[1], one.point))


def test_centrodes_are_drawn_with_the_pose_and_the_centre_of_their_own_sample():
    """A wheel of 0.5 m that rolls on a line, held by no joint but a pin of another body."""
    bodies = (Body("wheel", 1.0, 1.0, (0.0, 1.0, 0.0)), Body("crank", 1.0, 1.0, (0.0, 0.0, 0.0)))
    mechanism = Mechanism(bodies, (Pin("A", None, "crank", (0.0, 0.0), (0.0, 0.0)),))
    theta = np.linspace(0.1, 1.1, 41)
    poses = np.zeros((len(theta), 2, 3))
    poses[:, 0] = np.stack([-0.5 * theta, 0 * theta + 0.5, theta], axis=-1)
    space = np.stack([-0.5 * theta, 0 * theta], axis=-1)
    own = -0.5 * np.stack([np.sin(theta), np.cos(theta)], axis=-1)
    curves = Centrodes(poses[:, 0], space, own, 0.0)
    for panel, index in zip(draw_centrodes(mechanism, poses, curves, (5, 30), 0).axes, (5, 30), strict=True):
        assert has(panel, space)
        assert has(panel, [space[index]])
        c, s = math.cos(theta[index]), math.sin(theta[index])
        assert has(panel, own @ np.array([[c, s], [-s, c]]) + poses[index, 0, :2])
        assert has(panel, [[0.0, 0.0], space[index]])  # the crank's line, produced to the centre
    above, _ = draw_rate(curves).axes
    run, total = lines(above)
    assert run[:, 0] == pytest.approx(np.degrees(theta))
    # The centre runs its radius in a radian; splines of the curves know that to 1e-6 away from their ends.
    assert run[5:-5, 1] == pytest.approx(np.full(31, 0.5), abs=1e-6)
    assert total == pytest.approx(
        np.column_stack([np.degrees(theta), 1 / (curves.space_curvature + curves.body_curvature)])
    )
    wrong = replace(curves, body=2 * own)
    (run, total), [missed] = lines(draw_rate(wrong).axes[0]), lines(draw_rate(wrong).axes[1])
    assert missed[5:-5, 1] == pytest.approx(np.abs(total / run - 1)[5:-5, 1])
    assert missed[20, 1] > 0.1
