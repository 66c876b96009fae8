"""Charts read back from their axes: which numbers are drawn, across and up, by which method, in which panel."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines import registry
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.model.scaling_fit import Point, Series, cost_exponent
from reports.pages.rolling import page as rolling_charts
from reports.pages.scaling.page import scaling_chart
from reports.plots import looks as families
from reports.plots import work_precision as charts
from reports.plots.looks import role
from reports.plots.theme import DARK, LIGHT, SERIES
from tests.drawn import annotation
from tests.rows import falling, row_of
from tests.toys import Toy

ENGINES = ("pymunk", "mujoco", "lagrange", "other")
# A stranger comes after all that are registered, installed or not.
FAMILIES = [*dict.fromkeys(each.family for each in (*registry.ENGINES, *registry.OTHERS)), "other"]


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


def rows():
    """Two scenes and three methods, another number in each point; failures, maps and zeros that must not be drawn."""
    found = []
    for scene, factor in (("one_scene", 1.0), ("other", 7.0)):
        found += falling("pymunk default", (1.1e-2, 1.3e-3, 1.7e-4), scene=scene)
        found += falling("mujoco tuned", (1.9e-2 * factor, 2.3e-3 * factor), scene=scene, position=5e-5)
        found += falling("mujoco extended", (3.7e-2 * factor, 4.1e-5), scene=scene)
        found += falling("mujoco own", (2.9e-2, 3.1e-3), scene=scene)
        found.append(row_of("pymunk default", scene=scene, step=1e-4, angle=1e-9, outcome=Outcome.SATURATED))
        found.append(row_of("pymunk default", scene=scene, step=1e-5, angle=1e-9, purpose="map"))
        found.append(row_of("pymunk default", scene=scene, step=1e-6, angle=0.0))
        found.append(row_of("lagrange rk4", scene=scene, outcome=Outcome.TORN, angle=1e-9))
    # Not in the order of steps, and the first scene's last.
    return found[::-1]


def featured(row) -> bool:
    return row.variant != "own"


def expected(scene: str, method: str, across: str) -> list[tuple[float, float]]:
    engine, variant = method.split()
    own = [
        row
        for row in rows()
        if (row.scene, row.engine, row.variant) == (scene, engine, variant)
        and row.purpose == "sweep"
        and row.outcome == "finished"
        and row.angle > 0
    ]
    own.sort(key=lambda row: -row.step)
    return [((1e3 * row.cpu if across == "cpu" else row.step), row.angle) for row in own]


@pytest.mark.parametrize(
    ("draw", "across", "label"),
    [
        (charts.work_precision, "cpu", "CPU time per simulated second [ms]"),
        (charts.error_against_step, "step", "step [s]"),
    ],
)
def test_each_method_is_drawn_with_its_numbers_in_its_scenes_panel(draw, across, label):
    figure = draw(rows(), featured)
    found = panels(figure)
    assert [panel.get_title(loc="left") for panel in found] == ["other", "one scene"]
    entries = legend(figure)
    methods = ("pymunk default", "mujoco tuned", "mujoco extended")
    for panel, scene in zip(found, ("other", "one_scene"), strict=True):
        drawn = series(panel)
        assert drawn == {
            entries[method]: [pytest.approx(point) for point in expected(scene, method, across)] for method in methods
        }
        assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")
        assert panel.get_xlabel() == label
    assert found[0].get_ylabel() == "largest angle error [rad]"
    assert found[1].get_ylabel() == ""  # it shares the axis of the one on its left
    assert set(entries) - {"nothing is better and cheaper", "other methods", "rounding"} == set(methods)


@pytest.mark.parametrize("draw", [charts.work_precision, charts.error_against_step])
def test_the_quantity_that_was_asked_for_is_drawn_with_its_unit(draw):
    figure = draw(falling("pymunk default", (1e-2, 1e-3), "position", angle=5.0), field="position")
    [panel] = panels(figure)
    [drawn] = series(panel).values()
    assert [y for _, y in drawn] == [1e-2, 1e-3]
    assert panel.get_ylabel() == "largest position error [m]"


def front(panel: Axes) -> list[tuple[float, float]]:
    [line] = [line for line in panel.get_lines() if line.get_drawstyle() == "steps-post"]
    return points(line)


def dots(panel: Axes) -> list[tuple[float, float]]:
    return [point for line in panel.get_lines() if line.get_marker() == "." for point in points(line)]


def test_the_front_is_of_all_methods_and_those_not_featured_are_dots():
    cheap = [
        row_of("mujoco own", step=1e-2, angle=1e-3, cpu=2e-3),
        row_of("mujoco own", step=1e-3, angle=5e-3, cpu=9e-3),
    ]
    shown = [
        row_of("pymunk default", step=1e-2, angle=1e-2, cpu=1e-3),
        row_of("pymunk default", step=1e-3, angle=1e-4, cpu=5e-3),
    ]
    never = [
        row_of("mujoco own", step=1e-4, angle=1e-9, cpu=1e-4, purpose="map"),
        row_of("mujoco own", step=1e-4, angle=1e-9, cpu=1e-4, outcome=Outcome.SATURATED),
    ]
    figure = charts.work_precision([*shown, *cheap, *never], featured)
    [panel] = panels(figure)
    assert front(panel) == [pytest.approx(point) for point in ((1.0, 1e-2), (2.0, 1e-3), (5.0, 1e-4))]
    assert dots(panel) == [pytest.approx(point) for point in ((2.0, 1e-3), (9.0, 5e-3))]
    assert {"nothing is better and cheaper", "other methods"} < set(legend(figure))
    figure = charts.work_precision(shown, featured)
    assert dots(panels(figure)[0]) == []
    assert "other methods" not in legend(figure)


def test_the_front_holds_what_nothing_beats_whatever_the_order():
    given = [(3.0, 5e-3), (5.0, 1e-9), (1.0, 1e-2), (4.0, 1e-3), (2.0, 1e-3)]
    for start in range(len(given)):
        rotated = given[start:] + given[:start]
        assert charts.pareto(rotated) == [(1.0, 1e-2), (2.0, 1e-3), (5.0, 1e-9)]
    assert charts.pareto([(1.0, 2.0), (1.0, 1.0)]) == [(1.0, 1.0)]
    assert charts.pareto([]) == []


def test_each_front_is_that_of_its_own_scene():
    rows = [
        row_of("pymunk default", scene="one", angle=1e-3, cpu=1e-3),
        row_of("pymunk default", scene="two", angle=1e-5, cpu=1e-4),
    ]
    first, second = panels(charts.work_precision(rows))
    assert front(first) == [pytest.approx((1.0, 1e-3))]
    assert front(second) == [pytest.approx((0.1, 1e-5))]


@pytest.mark.parametrize("field", ["angle", "reaction"])
def test_the_band_of_rounding_ends_where_rounding_does_and_guides_have_the_slopes_they_name(field):
    errors = falling("pymunk default", (1e-2, 1e-3, 1e-4, 1e-5), field)
    [panel] = panels(charts.error_against_step(errors, field=field))
    [band] = panel.patches
    low, high = band.get_path().get_extents(band.get_patch_transform()).intervaly
    assert (low, high) == (pytest.approx(1e-16), pytest.approx(quantity(field).rounding))
    guides = [points(line) for line in panel.get_lines() if line.get_marker() in (None, "None", "")]
    assert len(guides) == 3
    for text, ((left, bottom), (right, top)) in zip(panel.texts, guides, strict=True):
        assert math.log(top / bottom) / math.log(right / left) == pytest.approx(float(text.get_text()))
        assert annotation(text).xy == (pytest.approx(right), pytest.approx(top))
    assert [text.get_text() for text in panel.texts] == ["1", "2", "4"]
    assert panel.get_ylim()[0] == pytest.approx(1e-5 / 3)


@pytest.mark.parametrize("theme", [LIGHT, DARK])
def test_an_engine_is_a_colour_and_a_mark_and_a_variant_a_line_and_a_filling(theme):
    variants = ["default", "tuned", "extended", "fourth", "fifth"]
    shown: dict[str, list[str]] = dict.fromkeys(map(str, ENGINES), variants)
    looks = {(engine, v): families.look(engine, v, shown, theme) for engine in ENGINES for v in variants}
    for engine in ENGINES:
        own = [looks[engine, variant] for variant in variants]
        place = FAMILIES.index(engine)
        assert {look["color"] for look in own} == {getattr(theme, SERIES[place % len(SERIES)])}
        assert {look["marker"] for look in own} == {families.MARKS[place % len(families.MARKS)]}
        fillings = {(str(look["linestyle"]), look["fillstyle"], look["markerfacecolor"]) for look in own}
        assert len(fillings) == len(variants)
        assert len({str(look["linestyle"]) for look in own}) == len(variants)
    for variant in variants:
        assert len({str(looks[engine, variant]["linestyle"]) for engine in ENGINES}) == 1


def test_a_variant_looks_the_same_whichever_others_are_shown():
    def look(variant: str, *variants: str):
        return families.look("pymunk", variant, {"other": ["x"], "pymunk": variants}, LIGHT)

    assert look("tuned", "tuned") == look("tuned", "extended", "x", "tuned", "default")
    assert look("x", "x", "y")["linestyle"] == families.LINES[0]  # named methods alone
    assert look("x", "default", "x")["linestyle"] == families.LINES[3]


def test_any_number_of_families_are_told_apart_and_those_of_the_registry_keep_theirs():
    strangers = [f"engine {number:02}" for number in range(60)]
    pairs = {name: (families.role(name, strangers), families.mark(name, strangers)) for name in ("mujoco", *strangers)}
    assert len(set(pairs.values())) == len(pairs)
    assert pairs["mujoco"] == (families.role("mujoco"), families.mark("mujoco"))
    assert pairs["engine 03"] == (families.role("engine 03", strangers[::-1]), families.mark("engine 03", strangers))
    # The first nine differ in their marks alone, as on paper without colours.
    assert len(set(families.MARKS)) == 9


def test_engines_of_one_family_share_a_colour_and_differ_in_their_lines(monkeypatch):
    relatives = (Toy(name="wide"), Relative("tuned", name="narrow"))
    monkeypatch.setattr(families.registry, "ENGINES", (*families.registry.ENGINES, *relatives))
    shown = {"wide": ["default"], "narrow": ["default", "tuned"]}
    looks = [families.look(engine, v, shown, LIGHT) for engine, variants in shown.items() for v in variants]
    assert len({(look["color"], look["marker"]) for look in looks}) == 1
    assert len({str(look["linestyle"]) for look in looks}) == 3


class Relative(Toy):
    """Of the family of another engine."""

    @property
    def family(self) -> str:
        return "wide"


def test_a_chart_without_a_row_that_can_be_compared_is_empty_and_no_error():
    failed = [row_of("pymunk default", outcome=outcome) for outcome in Outcome if not outcome.comparable]
    for draw in (charts.work_precision, charts.error_against_step):
        assert all(not panel.get_lines() for panel in panels(draw(failed)))


def growth(method: str, *steps: float, errors=None) -> Series:
    engine, variant = method.split(" ", 1)
    errors = errors or [2 * step for step in steps]
    sizes = (1, 10, 100, 1000)
    return Series(
        engine, variant, tuple(Point(n, s, e, "finished") for n, s, e in zip(sizes, steps, errors, strict=False))
    )


def test_a_scaling_chart_has_costs_in_microseconds_and_errors_over_the_number_of_links():
    found = (
        growth("pymunk default", 1e-6, 3e-6, 7e-5, math.nan),
        growth("mujoco tuned", 2e-6, 5e-5, 5e-3, errors=[1e-3, math.nan, 0.0]),
    )
    figure = scaling_chart(found)
    cost, error = figure.axes
    entries = legend(figure)
    assert set(entries) == {"pymunk default", "mujoco tuned"}
    assert series(cost)[entries["pymunk default"]] == [pytest.approx(p) for p in ((1, 1.0), (10, 3.0), (100, 70.0))]
    assert series(cost)[entries["mujoco tuned"]] == [pytest.approx(p) for p in ((1, 2.0), (10, 50.0), (100, 5000.0))]
    assert series(error)[entries["pymunk default"]][:3] == [
        pytest.approx(p) for p in ((1, 2e-6), (10, 6e-6), (100, 1.4e-4))
    ]
    assert series(error)[entries["mujoco tuned"]] == [pytest.approx((1, 1e-3))]
    for panel, up in ((cost, "CPU time of a step [µs]"), (error, "largest angle error [rad]")):
        assert (panel.get_xlabel(), panel.get_ylabel()) == ("links", up)
        assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")


def test_each_slope_is_told_beside_its_line():
    found = (growth("pymunk default", 1e-6, 1e-5, 1e-4), growth("mujoco tuned", 1e-6, 1e-4, 1e-2))
    cost, error = scaling_chart(found).axes
    told = {text.get_text(): text.get_color() for text in cost.texts}
    assert told == {f"{cost_exponent(one)[0]:.1f}": getattr(LIGHT, role(one.engine)) for one in found}
    assert (set(told), len(error.texts)) == ({"1.0", "2.0"}, 0)


def test_plateaus_have_one_line_a_step_with_failed_runs_left_out():
    corners = [
        (8, row_of("pymunk a", step=1e-2, angle=0.3)),
        (32, row_of("pymunk b", step=1e-2, angle=0.2)),
        (8, row_of("pymunk a", step=1e-3, angle=0.25)),
        (32, row_of("pymunk b", step=1e-3, angle=0.9, outcome=Outcome.TORN)),
        (128, row_of("pymunk c", step=1e-3, angle=math.nan)),
    ]
    softness = [(2e-3, row_of("mujoco a", step=1e-3, angle=0.02)), (2e-2, row_of("mujoco b", step=1e-3, angle=0.06))]
    left, right = rolling_charts.draw_plateaus(corners, softness).axes
    assert {line.get_label(): points(line) for line in left.get_lines()} == {
        "step 1e-2 s": [(8, 0.3), (32, 0.2)],
        "step 1e-3 s": [(8, 0.25)],
    }
    assert {line.get_label(): points(line) for line in right.get_lines()} == {
        "step 1e-3 s": [(2e-3, 0.02), (2e-2, 0.06)]
    }
    assert (left.get_xlabel(), right.get_xlabel()) == ("corners", "contact's time constant [s]")
    with pytest.raises(ValueError, match="4 steps"):
        rolling_charts.draw_plateaus([(8, row_of("pymunk a", step=s)) for s in (1e-1, 1e-2, 1e-3, 1e-4)], softness)
