"""Tests of faults and errata: scripts print the documented output, and derivatives confirm the right formulas."""

from __future__ import annotations

import re
from dataclasses import replace
from importlib import metadata

import numpy as np
import pytest

from engines import single_run
from reference.chapter import errata
from reports.cli.selection import page_tasks
from reports.model.ending import FINE, REFUSED
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Answer, answered
from reports.pages.errata import page as referees
from reports.pages.faults.page import (
    OFFSETS,
    PAGE,
    RESULT,
    SCRIPTS,
    UPSTREAM,
    is_right,
    measured_across,
    predicted_across,
    printed_apart,
    scripts,
)
from reports.pages.rendering import render_page
from tests.committed_rows import answer_to
from tests.reports.test_command_line import call, one_line
from tests.wrong.mistakes import mistaken, mistakes

TABLE = re.compile(r"^(\w.*?) +(\de-\d\d)((?: +\d\.\de[+-]\d\d)+)$", re.MULTILINE)
CORRECTED = {"mujoco_loop", "mujoco_sparse"}  # scripts of faults that the installed releases do not have


def documented(name: str) -> list[str]:
    """The outputs of a script in its document; the first line of an output states the release."""
    (text,) = (text for path in UPSTREAM.iterdir() if f"{name}.py" in (text := path.read_text(encoding="utf-8")))
    if "_cost" not in name:
        later = text.partition(f"`{name}.py`")[2]
        return [later.partition("```text\n")[2].partition("\n```")[0]]
    earlier = text.partition(f"<summary>{name}.py")[0].partition("## Cost")[2]
    return re.findall(r"```text\n(.*?)\n```", earlier.rpartition("</details>")[2], re.DOTALL)


@pytest.mark.parametrize("name", sorted(scripts()))
def test_the_output_of_a_script_agrees_with_its_document(name):
    if name.startswith("mjx"):  # MJX compiles for seconds
        assert all(re.search(r"expected|step", output) for output in documented(name))
        return
    package = "mujoco-core" if name.startswith("mujoco") else "pymunk"
    printed = printed_apart(name)
    if name in CORRECTED:
        assert all(is_right(float(expected), float(result)) for expected, result in RESULT.findall(printed))
    same = [output for output in documented(name) if re.search(rf" {metadata.version(package)}\b(?! with)", output)]
    for output in same:  # the list is empty unless the document has an output of the installed release
        numbers, earlier = (np.array(RESULT.findall(text), dtype=float) for text in (printed, output))
        assert numbers == pytest.approx(earlier, rel=1e-12)
        now = {row[:2]: list(map(float, row[2].split())) for row in TABLE.findall(printed)}
        displayed = {row[:2]: list(map(float, row[2].split())) for row in TABLE.findall(output)}
        assert now.keys() == displayed.keys()
        for key, values in displayed.items():  # two digits are printed
            assert now[key] == pytest.approx(values, rel=0.1)
    if not same:
        assert name.removesuffix("_cost") in CORRECTED or metadata.version(package) not in ("7.3.1", "4.0.1")


def test_a_groove_drives_the_wrong_velocity_to_zero():
    for offset in OFFSETS.offsets:
        assert measured_across(offset) == pytest.approx(predicted_across(offset), rel=1e-12)


def test_a_fault_is_right_only_in_releases_that_corrected_it():
    for name, task in SCRIPTS.items():
        answer = answer_to(task)
        if answer.finished:
            assert is_right(answer.number("expected"), answer.number("found")) == (name in CORRECTED)


def test_a_script_whose_extra_is_missing_is_not_run_and_its_page_and_answer_name_the_extra(monkeypatch):
    monkeypatch.setattr(single_run, "_is_found", lambda module: module != "jax")
    task = SCRIPTS["mjx_loop"]
    assert task.engine is not None
    sentence = task.engine.missing
    assert "'.[mjx]'" in sentence
    assert set(PAGE.tasks) - set(page_tasks(PAGE)) == {task}
    assert answered(task).sentence == sentence
    assert sentence in render_page(PAGE, Material({}), "crosscheck run")["faults.md"]


# Smallest expected error of a printed formula by slip. Slip 19 is an integration with the tolerance 1e-3.
LEAST = {19: 1e-3}


@pytest.fixture(scope="module")
def ruled() -> tuple[referees.Ruling, ...]:
    return referees.rulings((task, answer_to(task)) for task in referees.TASKS)[0]


def test_the_correction_is_the_derivative_and_the_printed_formula_is_not():
    assert [slip.number for slip in referees.ERRATA] == [1, 2, 11, 19, 23, 24, 25, 26, 27, 28]
    assert [slip.number for slip in referees.WORD_SLIPS] == [10, 18]
    rolling = errata.rolling_acceleration()
    for number, values in {0: rolling, **{slip.number: slip.values for slip in referees.ERRATA}}.items():
        # The values are 1 to 10, and Cauchy's integral formula multiplies rounding by 1/radius^2 = 16.
        assert values.agreement < 1e-12, number
        assert values.miss > LEAST.get(number, 0.1), number


def test_engines_check_the_formulas_of_the_scripts():
    by_number = {erratum.number: erratum.values for erratum in referees.ERRATA}
    for number, (bar, printed) in errata.PENDULUM_SLIPS.items():
        state = errata.BarState(errata.BAR, errata.PHI[bar], errata.PHI_RATE[bar], errata.PHI_ACCELERATION[bar])
        assert printed(state) == pytest.approx(by_number[number].printed, abs=1e-12), number
        assert errata.right(state) == pytest.approx(by_number[number].right, abs=1e-12), number


def test_two_engines_or_more_confirm_each_right_formula_and_contradict_the_printed_one(ruled):
    for number in (referees.CONFIRMED, *(slip.number for slip in referees.ERRATA)):
        of_slip = [ruling for ruling in ruled if ruling.number == number]
        assert len({ruling.method.split()[0] for ruling in of_slip}) >= 2, number
        # Accelerations are differences of velocities over 1e-3 s, and the errors of these velocities are below 1e-9.
        assert max(ruling.values.agreement for ruling in of_slip) < 1e-6, number
        # The rates of the four-bar are right as printed.
        assert number == referees.CONFIRMED or min(ruling.values.miss for ruling in of_slip) > LEAST.get(number, 0.1), (
            number
        )


def test_the_motion_of_a_wrong_mechanism_contradicts_the_right_formula():
    """A bar is 1 % too long, so neither formula agrees with the accelerations of the bars' ends."""
    mechanism = referees.double_pendulum()
    length = next(mistake for mistake in mistakes(mechanism) if mistake.kind == "length")
    motion = mistaken(referees.REFEREES[-1], length, 1e-2).build(mechanism, referees.WINDOW_SPACING)(
        referees.RUN_SAMPLES, 1
    )
    result = referees._pendulum(
        referees.SampleWindow(motion.pose[-referees.POINTS :], motion.twist[-referees.POINTS :])
    )
    assert max(result[number].agreement for number in (23, 25)) > 1e-3


def test_an_engine_that_fails_is_reported_and_the_others_decide():
    first, other = referees.TASKS[0], referees.TASKS[-1]
    aborted = Answer(Outcome.ABORTED, "no such thing")
    ruled, missing = referees.rulings(
        [(first, aborted), (other, answer_to(other)), (other, Answer(Outcome.UNSUPPORTED))]
    )
    assert missing == ["pymunk extended where a disc rolls off a round hill: **aborted**: no such thing"]
    assert {ruling.about for ruling in ruled} == {other.question}
    poses = np.full_like(answer_to(first).array("pose"), np.nan)
    _, missing = referees.rulings([(first, replace(answer_to(first), values={"pose": poses, "twist": poses}))])
    assert missing == ["pymunk extended where a disc rolls off a round hill: its motion is not finite"]


def test_the_command_prints_every_slip_once_and_refuses_an_unknown_one(capfd):
    assert call("errata") == FINE
    out = capfd.readouterr().out
    numbers = [int(result) for result in re.findall(r"^(\d+)\s", out, re.MULTILINE)]
    assert numbers == sorted(slip.number for slip in (*referees.ERRATA, *referees.WORD_SLIPS))
    assert referees.digits(referees.ERRATA[2].values.printed) in out
    assert call("errata", "3") == REFUSED
    assert "there are 1, 2, 10" in one_line(capfd.readouterr().err)
