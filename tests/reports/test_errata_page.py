"""The errata's page and command: snippets that run and agree with it, engines that rule as the derivative does."""

from __future__ import annotations

import re
import runpy
from dataclasses import replace

import numpy as np
import pytest

from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS
from reference.chapter.errata.erratum import Values
from reference.chapter.errata.rolling_and_skates import rolling_acceleration
from reference.joints import Pin
from reports import __main__ as command_line
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.errata import experiments as referees
from reports.pages.errata.experiments import CONFIRMED, REFEREES, TASKS, Ruling, Window, rulings
from reports.pages.errata.page import PAGE, SNIPPETS, digits, table
from reports.pages.rendering import render_page
from reports.write.templates import TEMPLATES

IDS = [str(erratum.number) for erratum in ERRATA]


@pytest.fixture(scope="module")
def said() -> tuple[Ruling, ...]:
    return rulings((task, answered(task)) for task in TASKS)


@pytest.fixture(scope="module")
def text() -> str:
    return render_page(PAGE, Material({}), "the command")["errata.md"]


@pytest.mark.parametrize("erratum", ERRATA, ids=IDS)
def test_every_snippet_runs_and_finds_the_numbers_of_the_page(erratum, capsys):
    found = runpy.run_path(str(TEMPLATES / SNIPPETS / f"slip_{erratum.number:02}.py"))
    values = erratum.values()
    # Second derivatives by differences over 1e-3 s lose about 1e-10 to rounding; the others are exact to rounding.
    for name, expected in (("printed", values.printed), ("right", values.right), ("measured", values.decides)):
        assert found[name] == pytest.approx(expected, abs=1e-8), name
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_every_slip_has_a_snippet_and_is_refereed_by_several_engines(said):
    names = {path.name for path in (TEMPLATES / SNIPPETS).iterdir() if path.suffix == ".py"}
    assert names == {f"slip_{erratum.number:02}.py" for erratum in ERRATA}
    for erratum in ERRATA:
        engines = {ruling.method.split()[0] for ruling in said if ruling.number == erratum.number}
        assert len(engines) >= 2, erratum.number


def test_engines_rule_for_the_right_formula_and_against_the_printed_one(said):
    for ruling in said:
        if ruling.number == CONFIRMED:
            continue
        # Accelerations are differences of velocities over 1e-3 s, and engines are exact to 1e-9 and better here.
        assert ruling.values.agreement < 1e-6, (ruling.number, ruling.method)
        # An integration is off by its tolerance, 1e-3; every other slip by something of the motion's own size.
        least = 1e-3 if ruling.number == 19 else 0.1
        assert ruling.values.miss > least, (ruling.number, ruling.method)


def test_engines_confirm_the_rates_of_the_four_bar(said):
    found = [ruling.values.agreement for ruling in said if ruling.number == CONFIRMED]
    assert len(found) == len(REFEREES)
    assert max(found) < 1e-6  # of 7 rad/s


def test_a_motion_of_a_wrong_mechanism_is_told_apart(said):
    """A referee that could not fail would be none: with a centre of mass elsewhere, no formula fits the bars' ends."""
    engine = REFEREES[-1]
    mechanism = referees.double_pendulum()
    pins = [joint for joint in mechanism.joints if isinstance(joint, Pin)]
    moved = [replace(pin, second_point=(pin.second_point[0] * 1.01, 0.0)) for pin in pins]
    # The pins are moved by a hundredth of the bar, the bodies with them, so that the start still fits.
    first, second = mechanism.bodies
    along = [np.array([np.cos(body.pose[2]), np.sin(body.pose[2])]) for body in (first, second)]
    shift = 0.01 * abs(pins[0].second_point[0])

    def shifted(body, direction, rate):
        pose = (body.pose[0] + shift * direction[0], body.pose[1] + shift * direction[1], body.pose[2])
        twist = (body.twist[0] - shift * rate * direction[1], body.twist[1] + shift * rate * direction[0], rate)
        return replace(body, pose=pose, twist=twist)

    one, two = (shifted(b, d, b.twist[2]) for b, d in zip((first, second), along, strict=True))
    moved[1] = replace(moved[1], first_point=(moved[1].first_point[0] - shift, 0.0))
    wrong = replace(mechanism, bodies=(one, two), joints=tuple(moved))
    motion = engine.build(wrong, referees.SPACING)(referees.SAMPLES, 1)
    found = referees._pendulum(Window(motion.pose[-referees.POINTS :], motion.twist[-referees.POINTS :]))
    assert min(found[number].agreement for number in (23, 25)) > 1e-3


def test_the_motion_of_the_right_mechanism_agrees_with_every_corrected_formula_of_both_bars():
    motion = REFEREES[-1].build(referees.double_pendulum(), referees.SPACING)(referees.SAMPLES, 1)
    found = referees._pendulum(Window(motion.pose[-referees.POINTS :], motion.twist[-referees.POINTS :]))
    # Measured: 3.3e-8 for the angles, which are differentiated twice, and 7e-9; a wrong mechanism leaves above 1e-3.
    assert max(values.agreement for values in found.values()) < 1e-5


def test_the_acceleration_in_rolling_is_right_as_printed_and_not_with_the_other_normal():
    values = rolling_acceleration()
    assert values.agreement < 1e-12  # rounding over the circle's radius squared
    assert values.miss > 1  # twice the rolling term, 2 w^2 a b / (a + b)


def test_a_table_tells_by_how_much_each_formula_misses_what_decides_for_each_engine():
    erratum = ERRATA[0]
    computed = Values(np.array([3.0]), np.array([1.0]), np.array([1.25]))
    measured = Values(np.array([3.0]), np.array([1.0]), np.array([1.5]))
    lines = [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in table(erratum, computed, [Ruling(erratum.number, "toy", "a wheel", measured)]).splitlines()
    ]
    assert lines[0][1:] == [f"value [{erratum.unit}]", "the printed one misses by", "the right one misses by"]
    assert lines[2:] == [
        ["as printed", "3", "1.8", ""],
        ["as it must be", "1", "", "0.25"],
        [f"**decides**: {erratum.deciding}", "1.25", "", ""],
        ["toy: a wheel", "1.5", "1.5", "0.5"],
    ]


def test_the_page_quotes_every_slip(text):
    for erratum in ERRATA:
        for words in (erratum.quoted, erratum.corrected, digits(erratum.values().decides)):
            assert words in text
    assert all(f"**{slip.number}**" in text for slip in WORD_SLIPS)
    assert len(re.findall("```python", text)) == len(ERRATA)


def test_the_command_prints_every_slip_once(capfd):
    with pytest.raises(SystemExit) as ending:
        command_line.main(["errata"])
    out = capfd.readouterr().out
    assert ending.value.code == 0
    numbers = [int(found) for found in re.findall(r"^(\d+)\s", out, re.MULTILINE)]
    assert numbers == sorted(slip.number for slip in (*ERRATA, *WORD_SLIPS))
    assert digits(ERRATA[2].values().printed) in out


def test_an_unknown_slip_is_refused_in_one_line(capfd):
    with pytest.raises(SystemExit) as ending:
        command_line.main(["errata", "3"])
    out, err = capfd.readouterr()
    assert (ending.value.code, out, err.count("\n")) == (2, "", 1)
    assert "there are 1, 2, 10" in err
