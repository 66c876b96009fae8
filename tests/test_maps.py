"""Stability maps read back: each cell stands at its value and its step, and says what became of its own row."""

from __future__ import annotations

import math

import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from reports.model.outcomes import Outcome
from reports.plots.stability import HATCHES, outcome_colour, stability_map
from reports.plots.theme import LIGHT
from tests.drawn import handles
from tests.rows import row_of

ROWS = [
    (5.0, row_of("a x", step=1e-1, angle=3e-2)),
    (0.2, row_of("a x", step=1e-3, outcome=Outcome.TORN)),
    (1.0, row_of("b y", step=1e-3, angle=2e-9)),
    (0.2, row_of("b y", step=1e-2, outcome=Outcome.SATURATED, angle=1e-7)),
    (1.0, row_of("a x", step=1e-2, angle=0.0)),
    (5.0, row_of("b y", step=1e-1, outcome=Outcome.RESET)),
    (5.0, row_of("b y", step=1e-3, angle=math.nan)),
]


def told(panel: Axes, left: Axes) -> dict[tuple[float, float], str]:
    """(value, step) -> label, read with the panel's ticks and those of the panel on its left, whose axis it shares."""
    values = dict(zip(panel.get_xticks(), (text.get_text() for text in panel.get_xticklabels()), strict=True))
    steps = dict(zip(left.get_yticks(), (text.get_text() for text in left.get_yticklabels()), strict=True))
    assert panel.get_ylim() == left.get_ylim()
    return {
        (float(values[text.get_position()[0]]), float(steps[text.get_position()[1]])): text.get_text()
        for text in panel.texts
    }


def painted(panel: Axes) -> dict[tuple[float, float], tuple[str, str | None]]:
    """Middle of a cell -> its colour and hatch."""
    cells = [patch for patch in panel.patches if isinstance(patch, Rectangle)]
    return {
        (c.get_x() + 0.5, c.get_y() + 0.5): (to_hex(c.get_facecolor()), c.get_hatch())
        for c in cells
        if (c.get_width(), c.get_height()) == (1, 1)
    }


def test_each_cell_is_labelled_at_its_value_and_step_in_its_methods_panel():
    first, second = stability_map(ROWS, "mass ratio").axes
    assert [panel.get_title(loc="left") for panel in (first, second)] == ["a x", "b y"]
    assert told(first, first) == {(5.0, 0.1): "-2", (0.2, 1e-3): "T", (1.0, 1e-2): "·"}
    assert told(second, first) == {(1.0, 1e-3): "-9", (0.2, 1e-2): "S", (5.0, 0.1): "R", (5.0, 1e-3): "·"}
    # Values grow to the right and steps upwards.
    assert [float(text.get_text()) for text in first.get_xticklabels()] == [0.2, 1.0, 5.0]
    assert [float(text.get_text()) for text in first.get_yticklabels()] == [1e-3, 1e-2, 1e-1]
    assert (first.get_xlim(), first.get_ylim()) == ((0, 3), (0, 3))
    assert (first.get_xlabel(), first.get_ylabel()) == ("mass ratio", "step [s]")
    assert (second.get_xlabel(), second.get_ylabel()) == ("mass ratio", "")


def test_the_label_of_a_step_is_the_step():
    [panel] = stability_map([(1.0, row_of("a x", step=s)) for s in (1.7e-3, 1e-5, 1 / 60)], "v").axes
    assert [text.get_text() for text in panel.get_yticklabels()] == ["1.0e-5", "1.7e-3", "0.017"]


def test_each_cell_has_the_colour_and_hatch_of_its_own_outcome():
    for panel, own in zip(stability_map(ROWS, "v").axes, ("a x", "b y"), strict=True):
        values, steps = (0.2, 1.0, 5.0), (1e-3, 1e-2, 1e-1)
        assert painted(panel) == {
            (values.index(value) + 0.5, steps.index(row.step) + 0.5): (
                outcome_colour(Outcome(row.outcome), LIGHT),
                HATCHES.get(Outcome(row.outcome)),
            )
            for value, row in ROWS
            if row.method == own
        }


def test_the_legend_names_each_outcome_that_was_met_with_its_letter_and_its_look():
    figure = stability_map(ROWS, "v")
    [legend] = figure.legends
    words = [text.get_text() for text in legend.get_texts()]
    assert words == ["finished: its angle error's power of ten", "S  saturated", "T  torn", "R  reset"]
    met = (Outcome.FINISHED, Outcome.SATURATED, Outcome.TORN, Outcome.RESET)
    for handle, outcome in zip(handles(legend), met, strict=True):
        assert to_hex(handle.get_facecolor()) == outcome_colour(outcome, LIGHT)
        assert handle.get_hatch() == HATCHES.get(outcome)
    failed = stability_map([(1.0, row_of("a x", outcome=Outcome.TORN))], "v")
    assert [text.get_text() for text in failed.legends[0].get_texts()] == ["T  torn"]


@pytest.mark.parametrize(("angle", "label"), [(9.99e-3, "-3"), (1e-3, "-3"), (0.5, "-1"), (1.5, "0"), (12.0, "1")])
def test_a_cell_that_finished_tells_the_power_of_ten_of_its_angle_error(angle, label):
    [panel] = stability_map([(1.0, row_of("a x", angle=angle))], "v").axes
    assert [text.get_text() for text in panel.texts] == [label]


def test_no_two_failures_look_and_read_alike():
    failed = [outcome for outcome in Outcome if not outcome.comparable]
    assert len({outcome.letter for outcome in failed}) == len(failed)
    assert not {outcome_colour(o, LIGHT) for o in failed} & {outcome_colour(Outcome.FINISHED, LIGHT)}
    assert len(set(HATCHES.values())) == len(HATCHES)
    assert {o: outcome_colour(o, LIGHT) for o in Outcome} == {
        **dict.fromkeys((Outcome.FINISHED, Outcome.CONVERGED), LIGHT.good),
        **dict.fromkeys((Outcome.PLATEAU, Outcome.UNRESOLVED, Outcome.SATURATED, Outcome.BRANCH_FLIP), LIGHT.middling),
        **dict.fromkeys((Outcome.TORN, Outcome.DIVERGED, Outcome.RESET), LIGHT.bad),
        **dict.fromkeys((Outcome.UNSUPPORTED, Outcome.REFUSED), LIGHT.grid),
        **dict.fromkeys((Outcome.ABORTED, Outcome.TIMED_OUT, Outcome.FAILED, Outcome.LOST), LIGHT.worse),
    }


def test_panels_have_axis_names_at_the_edges_of_the_picture_only():
    rows = [(1.0, row_of(f"{name} x")) for name in "abcde"]
    shown = stability_map(rows, "v", columns=2).axes
    assert [panel.get_visible() for panel in shown] == [True] * 5 + [False]
    assert [panel.get_xlabel() for panel in shown[:5]] == ["", "", "", "v", "v"]
    assert [panel.get_ylabel() for panel in shown[:5]] == ["step [s]", "", "step [s]", "", "step [s]"]


def test_two_rows_that_would_stand_in_one_cell_are_refused():
    with pytest.raises(ValueError, match=r"2 rows of 'a x' at 1 and a step of 0\.011 s"):
        stability_map([(1.0, row_of("a x")), (1.0, row_of("a x", angle=1.0))], "v")
