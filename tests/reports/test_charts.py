"""Tests of charts and drawings by the contents of their axes. Charts of invented rows are compared with
tests/golden/charts.md."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from reference.chapter.centrodes import Centrodes
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.pages.centrodes.page import draw_centrodes, draw_rate
from reports.plots import looks as families
from reports.plots import mechanisms as drawings
from reports.plots import work_precision as charts
from reports.plots.plane_panels import Blades, Panel, PanelNote, Path, paths
from reports.plots.theme import LIGHT, add_legend, drawing
from tests.mechanisms import four_bar
from tests.rows import falling, row_of


def points(line: Line2D) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in np.asarray(line.get_xydata())]


ROLES = {to_hex(getattr(LIGHT, field.name)): field.name for field in fields(LIGHT)}
GUIDE = 0.8  # guides are left out, since their position depends on the limits of the axes


def described(figure: Figure) -> Iterator[str]:
    """Yield lines of text that describe the contents of each panel; colours have the names of their roles."""
    for panel in figure.axes:
        if not panel.get_visible():
            continue
        description = (
            panel.get_title(loc="left"),
            panel.get_xscale(),
            panel.get_xlabel(),
            panel.get_yscale(),
            panel.get_ylabel(),
        )
        yield f"### {' | '.join(description)}"
        for line in panel.get_lines():
            if line.get_linewidth() != GUIDE:
                numbers = " ".join(f"({round(x, 12):.4g}, {round(y, 12):.4g})" for x, y in points(line))
                yield f"- {look_of(line)} {line.get_drawstyle()}: {numbers}"
        for text in panel.texts:
            at = () if text.get_text().isdigit() else getattr(text, "xy", ())  # a text of digits belongs to a guide
            yield f"- {text.get_text()!r} {at}"
    for legend in figure.legends:
        lines = [handle for handle in legend.legend_handles if isinstance(handle, Line2D)]
        yield from (f"- {line.get_label()}: {look_of(line)}" for line in lines)


def look_of(line: Line2D) -> str:
    return f"{ROLES[to_hex(line.get_color())]} {line.get_linestyle()} {line.get_marker()}"


METHODS = {
    "pymunk default": (1.1e-2, 1.3e-3, 1.7e-4),
    "mujoco tuned": (1.9e-2, 2.3e-3),
    "mujoco extended": (3.7e-2, 4.1e-5),
}
FACTORS = {"one_scene": 1.0, "other": 7.0}


def rows():
    """Rows of two scenes and three methods with different numbers, and rows that must not be drawn."""
    results = []
    for scene, factor in FACTORS.items():
        for method, errors in METHODS.items():
            results += falling(method, tuple(factor * error for error in errors), scene=scene)
        results += falling("mujoco own", (2.9e-2, 3.1e-3), scene=scene)
        results.append(row_of("pymunk default", scene=scene, step=1e-4, angle=1e-9, outcome=Outcome.SATURATED))
        results.append(row_of("pymunk default", scene=scene, step=1e-5, angle=1e-9, purpose="map"))
        results.append(row_of("pymunk default", scene=scene, step=1e-6, angle=0.0))
        results.append(row_of("lagrange rk4", scene=scene, outcome=Outcome.TORN, angle=1e-9))
    return results[::-1]


def featured(row) -> bool:
    return row.variant != "own"


def compared() -> Figure:
    lines = {"as shipped": {"pymunk": [(1e-3, 1e-2), (1e-2, 1e-3)]}, "with our code": {"mujoco": [(5e-3, 1e-9)]}}
    absent = {"as shipped": {"no such joint": ["pymunk"]}}
    return charts.engines_compared(
        [
            charts.ComparedRow("four-bar", "angle", lines, {}),
            charts.ComparedRow("skate", "position", {"as shipped": {}, "with our code": {}}, absent),
        ]
    )


def posed() -> Figure:
    """Three poses, with a method that has an error in one pose and a method without errors."""
    mechanism = four_bar()
    truth = np.stack([mechanism.pose, mechanism.pose + 0.1, mechanism.pose - 0.1])
    other = truth + np.array([0.2, 0.0, 0.0]) * np.array([0, 1, 0])[:, None, None]
    methods: dict[str, Any] = {"wrong": (other, "first", "--"), "right": (truth, "second", ":")}
    return drawings.configurations(mechanism, truth, ["zero", "one", "two"], methods)


def planes() -> Figure:
    """A panel with two paths, a blade and a note, and a panel with a curve."""
    wrong = Path([[0.0, 0.0], [math.nan, 0.0], [9.0, 8.0]], "wrong", "first", "--", framed=False, dot=True)
    blades = Blades([[0.5, 0.5, math.pi / 2]], 0.2, "quiet")
    right = Path([[0.0, 0.0], [1.0, 2.0]], "truth")
    first = Panel("first", [right, wrong], [blades], [PanelNote((0.25, 1.5), "here", "center")])
    curve = Path([[1.0, 1e-3], [2.0, 1e-1]], "truth")
    second = Panel("second", [curve], plane=False, x_label="time [s]", y_label="m", logarithmic=True)
    return paths([first, second], columns=2)


def test_each_chart_has_its_numbers_with_the_look_of_their_method(golden):
    results = {
        "Error against CPU time": charts.work_precision(rows(), featured),
        "All methods as lines": charts.work_precision(rows()),
        "Error against step": charts.error_against_step(rows(), featured),
        "Engines at equal CPU time": compared(),
        "Configurations": posed(),
        "Paths in a plane": planes(),
    }
    golden(
        "charts.md", "\n".join(line for name, figure in results.items() for line in (f"## {name}", *described(figure)))
    )
    # A path that is not framed does not change the limits of the axes.
    panel = results["Paths in a plane"].axes[0]
    assert panel.get_xlim()[1] < 2
    assert panel.get_ylim() == (pytest.approx(-0.14), pytest.approx(2.14))
    assert len({(panel.get_xlim(), panel.get_ylim()) for panel in results["Engines at equal CPU time"].axes}) == 1
    failed = [row_of("pymunk default", outcome=outcome) for outcome in Outcome if not outcome.comparable]
    for draw in (charts.work_precision, charts.error_against_step):
        assert all(not panel.get_lines() for panel in draw(failed).axes)


def test_families_have_different_looks_and_the_looks_of_registered_families_are_fixed():
    strangers = [f"engine {number:02}" for number in range(50)]
    pairs = {name: (families.role(name, strangers), families.mark(name, strangers)) for name in ("mujoco", *strangers)}
    assert len(set(pairs.values())) == len(pairs)
    assert pairs["mujoco"] == (families.role("mujoco"), families.mark("mujoco"))
    assert pairs["engine 03"] == (families.role("engine 03", strangers[::-1]), families.mark("engine 03", strangers))
    assert len(set(families.MARKS)) == 9


def has(panel: Axes, wanted: Any) -> bool:
    lines = [np.asarray(line.get_xydata(), dtype=float) for line in panel.get_lines()]
    return any(line.shape == np.shape(wanted) and np.allclose(line, wanted, equal_nan=True) for line in lines)


def test_centrodes_are_drawn_with_the_pose_and_the_centre_of_their_own_sample():
    """A wheel of 0.5 m without a joint rolls on a line; another body has a pin."""
    bodies = (Body("wheel", 1.0, 1.0, (0.0, 1.0, 0.0)), Body("crank", 1.0, 1.0, (0.0, 0.0, 0.0)))
    mechanism = Mechanism(bodies, (Pin("A", None, "crank", (0.0, 0.0), (0.0, 0.0)),))
    theta = np.linspace(0.1, 1.1, 41)
    poses = np.zeros((len(theta), 2, 3))
    poses[:, 0] = np.stack([-0.5 * theta, 0 * theta + 0.5, theta], axis=-1)
    space = np.stack([-0.5 * theta, 0 * theta], axis=-1)
    body_curve = -0.5 * np.stack([np.sin(theta), np.cos(theta)], axis=-1)
    curves = Centrodes(poses[:, 0], space, body_curve, 0.0)
    for panel, index in zip(draw_centrodes(mechanism, poses, curves, (5, 30), 0).axes, (5, 30), strict=True):
        assert has(panel, space)
        assert has(panel, [space[index]])
        c, s = math.cos(theta[index]), math.sin(theta[index])
        assert has(panel, body_curve @ np.array([[c, s], [-s, c]]) + poses[index, 0, :2])
        assert has(panel, [[0.0, 0.0], space[index]])  # the line of the crank ends at the instant centre
    run, total = (np.array(points(line)) for line in draw_rate(curves).axes[0].get_lines())
    # The instant centre moves by 0.5 m per radian. Except near the ends, the error of the splines is below 1e-6.
    assert run[5:-5] == pytest.approx(np.column_stack([np.degrees(theta), np.full(41, 0.5)])[5:-5], abs=1e-6)
    assert total[:, 1] == pytest.approx(1 / (curves.space_curvature + curves.body_curvature))
    [missed] = draw_rate(replace(curves, body=2 * body_curve)).axes[1].get_lines()
    assert points(missed)[20][1] > 0.1


def test_the_band_ends_at_rounding_and_guides_have_their_slopes():
    errors = falling("pymunk default", (1e-2, 1e-3, 1e-4, 1e-5), "reaction")
    [panel] = charts.error_against_step(errors, field="reaction").axes
    [band] = panel.patches
    interval = band.get_path().get_extents(band.get_patch_transform()).intervaly
    assert tuple(interval) == pytest.approx((1e-16, quantity("reaction").rounding))
    guides = [points(line) for line in panel.get_lines() if line.get_marker() in (None, "None", "")]
    assert [text.get_text() for text in panel.texts] == ["1", "2", "4"]
    texts: list[Any] = list(panel.texts)
    for text, ((left_end, bottom), (right, top)) in zip(texts, guides, strict=True):
        assert math.log(top / bottom) / math.log(right / left_end) == pytest.approx(float(text.get_text()))
        assert text.xy == (pytest.approx(right), pytest.approx(top))
    assert panel.get_ylim()[0] == pytest.approx(1e-5 / 3)


@pytest.mark.parametrize(("letters", "columns"), [(10, 3), (30, 2), (60, 1), (300, 1)])
def test_a_legend_has_as_many_columns_as_fit_the_figure(letters, columns):
    with drawing(4.0) as figure:
        add_legend(figure, [Line2D([], [], label="m" * letters) for _ in range(4)], 3)
    (legend,) = figure.legends
    assert legend._ncols == columns  # pyright: ignore[reportAttributeAccessIssue] (matplotlib has no public name)
    assert letters == 300 or legend.get_window_extent().width <= figure.bbox.width
