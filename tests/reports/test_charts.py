"""Charts and drawings read back from their axes: which numbers and poses are drawn, where, and by which method."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reference import trajectory as outlines
from reference.chapter.centrodes import Centrodes
from reference.joints import Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.slider_crank import DrivenSliderCrank
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.pages.centrodes.page import draw_centrodes, draw_rate
from reports.plots import looks as families
from reports.plots import mechanisms as drawings
from reports.plots import work_precision as charts
from reports.plots.engines_compared import Compared, engines_compared
from reports.plots.plane_panels import Blades, Note, Panel, Path, paths
from reports.plots.theme import LIGHT
from tests.mechanisms import four_bar, pendulum
from tests.rows import falling, row_of
from tests.toys import Disc


def points(line: Line2D) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in np.asarray(line.get_xydata())]


def series(panel: Axes) -> dict[tuple[str, str], list[tuple[float, float]]]:
    """What is drawn with a mark, by colour and line style: the methods."""
    return {
        (to_hex(line.get_color()), str(line.get_linestyle())): points(line)
        for line in panel.get_lines()
        if line.get_marker() in families.MARKS
    }


def legend(figure: Figure) -> dict[str, tuple[str, str]]:
    """Its entries: label -> colour and line style."""
    [found] = figure.legends
    lines = [handle for handle in found.legend_handles if isinstance(handle, Line2D)]
    assert [text.get_text() for text in found.get_texts()] == [line.get_label() for line in lines]
    return {str(line.get_label()): (to_hex(line.get_color()), str(line.get_linestyle())) for line in lines}


def panels(figure: Figure) -> list[Axes]:
    return [panel for panel in figure.axes if panel.get_visible()]


METHODS = {
    "pymunk default": (1.1e-2, 1.3e-3, 1.7e-4),
    "mujoco tuned": (1.9e-2, 2.3e-3),
    "mujoco extended": (3.7e-2, 4.1e-5),
}
FACTORS = {"one_scene": 1.0, "other": 7.0}


def rows():
    """Two scenes and three methods, another number in each point; failures, maps and zeros that must not be drawn."""
    found = []
    for scene, factor in FACTORS.items():
        for method, errors in METHODS.items():
            found += falling(method, tuple(factor * error for error in errors), scene=scene)
        found += falling("mujoco own", (2.9e-2, 3.1e-3), scene=scene)
        found.append(row_of("pymunk default", scene=scene, step=1e-4, angle=1e-9, outcome=Outcome.SATURATED))
        found.append(row_of("pymunk default", scene=scene, step=1e-5, angle=1e-9, purpose="map"))
        found.append(row_of("pymunk default", scene=scene, step=1e-6, angle=0.0))
        found.append(row_of("lagrange rk4", scene=scene, outcome=Outcome.TORN, angle=1e-9))
    # Not in the order of steps, and the first scene's last.
    return found[::-1]


def featured(row) -> bool:
    return row.variant != "own"


@pytest.mark.parametrize(
    ("draw", "across", "label"),
    [
        (charts.work_precision, "cpu", "CPU time per simulated second [ms]"),
        (charts.error_against_step, "step", "step [ms]"),
    ],
)
def test_each_method_is_drawn_with_its_numbers_in_its_scenes_panel(draw, across, label):
    figure = draw(rows(), featured)
    found = panels(figure)
    assert [panel.get_title(loc="left") for panel in found] == ["other", "one scene"]
    entries = legend(figure)
    for panel, scene in zip(found, ("other", "one_scene"), strict=True):
        expected = {
            method: [(1e3 * getattr(row, across), FACTORS[scene] * row.angle) for row in falling(method, errors)]
            for method, errors in METHODS.items()
        }
        drawn = series(panel)
        assert drawn == {entries[method]: [pytest.approx(p) for p in points] for method, points in expected.items()}
        assert (panel.get_xscale(), panel.get_yscale(), panel.get_xlabel()) == ("log", "log", label)
    assert [panel.get_ylabel() for panel in found] == ["largest angle error [rad]", ""]  # the second shares the axis
    assert set(entries) - {"nothing is better and cheaper", "other methods", "rounding"} == set(METHODS)


def front(panel: Axes) -> list[tuple[float, float]]:
    [line] = [line for line in panel.get_lines() if line.get_drawstyle() == "steps-post"]
    return points(line)


def dots(panel: Axes) -> list[tuple[float, float]]:
    return [point for line in panel.get_lines() if line.get_marker() == "." for point in points(line)]


def test_the_front_is_of_all_methods_and_those_not_featured_are_dots():
    def of(method: str, *numbers: tuple[float, float, float], **changes: Any) -> list[Any]:
        return [row_of(method, step=step, angle=angle, cpu=cpu, **changes) for step, angle, cpu in numbers]

    shown = of("pymunk default", (1e-2, 1e-2, 1e-3), (1e-3, 1e-4, 5e-3))
    cheap = of("mujoco own", (1e-2, 1e-3, 2e-3), (1e-3, 5e-3, 9e-3))
    never = of("mujoco own", (1e-4, 1e-9, 1e-4), purpose="map")
    never += of("mujoco own", (1e-4, 1e-9, 1e-4), outcome=Outcome.SATURATED)
    figure = charts.work_precision([*shown, *cheap, *never], featured)
    [panel] = panels(figure)
    assert front(panel) == [pytest.approx(point) for point in ((1.0, 1e-2), (2.0, 1e-3), (5.0, 1e-4))]
    assert dots(panel) == [pytest.approx(point) for point in ((2.0, 1e-3), (9.0, 5e-3))]
    assert {"nothing is better and cheaper", "other methods"} < set(legend(figure))
    figure = charts.work_precision(shown, featured)
    assert (dots(panels(figure)[0]), "other methods" in legend(figure)) == ([], False)
    failed = [row_of("pymunk default", outcome=outcome) for outcome in Outcome if not outcome.comparable]
    for draw in (charts.work_precision, charts.error_against_step):
        assert all(not panel.get_lines() for panel in panels(draw(failed)))


def test_a_series_never_runs_backwards_in_cpu_time():
    steps = ((1e-2, 12.0), (3e-3, 9.0), (1e-3, 9.0), (3e-4, 30.0), (1e-4, 20.0))
    rough = [row_of("mujoco extended", step=step, angle=step, cpu=cpu) for step, cpu in steps]
    assert [row.step for row in charts.forwards(rough[::-1])] == [1e-3, 1e-4]
    plain = falling("pymunk default", METHODS["pymunk default"])
    assert charts.forwards(plain) == plain


def test_all_engines_share_one_look_and_one_scale_in_every_panel_and_what_is_absent_is_named():
    lines = {"as shipped": {"pymunk": [(1e-3, 1e-2), (1e-2, 1e-3)]}, "with our code": {"mujoco": [(5e-3, 1e-9)]}}
    rows = [
        Compared("four-bar", "angle", lines, {}),
        Compared(
            "skate", "position", {"as shipped": {}, "with our code": {}}, {"as shipped": {"no such joint": ["pymunk"]}}
        ),
    ]
    figure = engines_compared(rows)
    first, second, third, _ = panels(figure)
    assert series(first) != series(second)
    assert points(first.get_lines()[0]) == [pytest.approx(point) for point in ((1.0, 1e-2), (10.0, 1e-3))]
    assert {panel.get_xlim() for panel in panels(figure)} == {first.get_xlim()}
    assert {panel.get_ylim() for panel in panels(figure)} == {first.get_ylim()}
    assert "no such joint: pymunk" in [text.get_text() for text in third.texts]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["pymunk", "MuJoCo"]


def test_any_number_of_families_are_told_apart_and_those_of_the_registry_keep_theirs():
    strangers = [f"engine {number:02}" for number in range(60)]
    pairs = {name: (families.role(name, strangers), families.mark(name, strangers)) for name in ("mujoco", *strangers)}
    assert len(set(pairs.values())) == len(pairs)
    assert pairs["mujoco"] == (families.role("mujoco"), families.mark("mujoco"))
    assert pairs["engine 03"] == (families.role("engine 03", strangers[::-1]), families.mark("engine 03", strangers))
    # The first nine differ in their marks alone, as on paper without colours.
    assert len(set(families.MARKS)) == 9


def words_at(panel: Axes) -> list[tuple[str, Any]]:
    """Texts with the places at which they point."""
    texts: list[Any] = list(panel.texts)
    return [(text.get_text(), text.xy) for text in texts]


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


def test_paths_are_drawn_through_their_finite_points_in_their_panel_with_their_colour():
    near = [[0.0, 0.0], [1.0, 2.0]]
    wrong = Path([[0.0, 0.0], [math.nan, 0.0], [9.0, 8.0]], "wrong", "first", "--", framed=False, dot=True)
    blades = Blades([[0.5, 0.5, math.pi / 2]], 0.2, "quiet")
    first = Panel("first", [Path(near, "truth"), wrong], [blades], [Note((0.25, 1.5), "here", "center")])
    curve = [[1.0, 1e-3], [2.0, 1e-1]]
    second = Panel("second", [Path(curve, "truth")], plane=False, across="time [s]", up="m", logarithmic=True)
    figure = paths([first, second], columns=2)
    left, right = figure.axes
    assert [panel.get_title(loc="left") for panel in (left, right)] == ["first", "second"]
    # The path, what is finite of the wrong one, the dot at its end, and a blade of 0.2 m upright about its middle.
    for points in (near, [[0.0, 0.0], [9.0, 8.0]], [[9.0, 8.0]], [[0.5, 0.4], [0.5, 0.6]]):
        assert has(left, points)
    assert words_at(left) == [("here", (0.25, 1.5))]
    assert (right.get_xlabel(), right.get_ylabel(), right.get_yscale()) == ("time [s]", "m", "log")
    assert has(right, curve)
    assert legend(figure) == {"truth": (to_hex(LIGHT.ink), "-"), "wrong": (to_hex(LIGHT.first), "--")}
    assert left.get_xlim()[1] < 2  # what is not framed does not stretch the picture
    assert left.get_ylim() == (pytest.approx(-0.14), pytest.approx(2.14))


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
    run, total = lines(draw_rate(curves).axes[0])
    # The centre runs its radius in a radian; splines of the curves know that to 1e-6 away from their ends.
    assert run[5:-5] == pytest.approx(np.column_stack([np.degrees(theta), np.full(41, 0.5)])[5:-5], abs=1e-6)
    assert total[:, 1] == pytest.approx(1 / (curves.space_curvature + curves.body_curvature))
    [missed] = lines(draw_rate(replace(curves, body=2 * own)).axes[1])
    assert missed[20, 1] > 0.1


def test_the_band_of_rounding_ends_where_rounding_does_and_guides_have_the_slopes_they_name():
    errors = falling("pymunk default", (1e-2, 1e-3, 1e-4, 1e-5), "reaction")
    [panel] = panels(charts.error_against_step(errors, field="reaction"))
    [band] = panel.patches
    interval = band.get_path().get_extents(band.get_patch_transform()).intervaly
    assert tuple(interval) == pytest.approx((1e-16, quantity("reaction").rounding))
    guides = [points(line) for line in panel.get_lines() if line.get_marker() in (None, "None", "")]
    assert [text.get_text() for text in panel.texts] == ["1", "2", "4"]
    for (slope, place), ((left, bottom), (right, top)) in zip(words_at(panel), guides, strict=True):
        assert math.log(top / bottom) / math.log(right / left) == pytest.approx(float(slope))
        assert place == (pytest.approx(right), pytest.approx(top))
    assert panel.get_ylim()[0] == pytest.approx(1e-5 / 3)


def test_an_outline_has_further_points_in_order_and_a_strip_its_poses_at_equal_times():
    mechanism = pendulum(angle=math.pi / 2)  # from the origin straight up, one metre
    found = drawings.outline(mechanism, mechanism.pose, {"bar": ((0.5, 0.0), (0.0, 0.1))})["bar"]
    assert found == pytest.approx(np.array([[0.0, 0.0], [-0.1, 0.5], [0.0, 1.0]]), abs=1e-12)
    strip = drawings.Strip(Disc(duration=2.0), "Turning", 5, start=0.5, end=1.5)
    assert strip.times() == pytest.approx([0.5, 0.75, 1.0, 1.25, 1.5])
