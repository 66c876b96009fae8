"""Faults of engines and slips of the book: scripts print what pages say, and engines rule as derivatives do."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import re
import runpy
from contextlib import redirect_stdout
from dataclasses import replace
from importlib import metadata
from io import StringIO

import numpy as np
import pytest

from engines import single_run
from engines.lagrange.engine import Lagrange
from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS
from reference.chapter.errata.erratum import Values
from reference.chapter.errata.rolling_and_skates import rolling_acceleration
from reference.joints import Pin, Slot
from reference.mechanism import Body, Mechanism
from reports import __main__ as command_line
from reports.cli.selection import page_tasks
from reports.gate.prediction import all_tasks
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.errata import experiments as referees
from reports.pages.errata.experiments import CONFIRMED, REFEREES, TASKS, Ruling, Window, rulings
from reports.pages.errata.page import PAGE as ERRATA_PAGE
from reports.pages.errata.page import SNIPPETS, digits, verdict
from reports.pages.faults import experiments, scripts
from reports.pages.faults.experiments import CASES, KINDS, Equalities, Grooves
from reports.pages.faults.page import FAULTS, PAGE, SCRIPTS
from reports.pages.faults.scripts import ASKED, LINE, OWN_TESTS, PATCHED, Found, found_with, recorded
from reports.pages.rendering import render_page
from reports.write.templates import TEMPLATES
from tests.committed_rows import answer_to

# A velocity or an acceleration by two routes of some twenty operations, with masses and arms over two decades.
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def material() -> Material:
    return Material({}, {task: answer_to(task) for task in all_tasks(PAGE)})


def not_here(name: str) -> str:
    """The sentence that names the extra which a script needs, if it is not installed."""
    engine = SCRIPTS[name].engine
    return engine.missing if engine is not None else ""


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_prints_what_its_task_keeps(name: str, material: Material, capsys: pytest.CaptureFixture[str]) -> None:
    if not_here(name):
        pytest.skip(not_here(name))
    answer = material.answers[SCRIPTS[name]]
    if name in scripts.MJX:  # it compiles for seconds, and JAX takes its settings from whoever imports it first
        assert re.search(r"expected \{expected!r\}, found \{float\(found\)!r\}", scripts.source(name).splitlines()[-1])
        return
    runpy.run_path(str(scripts.FOLDER / f"{name}.py"), run_name="__main__")
    printed = re.fullmatch(r"(?:MuJoCo|pymunk) [\d.]+: expected (\S+), found (\S+)\n", capsys.readouterr().out)
    assert printed is not None
    assert (float(printed[1]), float(printed[2])) == (answer.number("expected"), answer.number("found"))


@pytest.mark.parametrize("case", CASES)
def test_a_groove_drives_the_wrong_velocity_to_zero(case: str) -> None:
    answer = Grooves(case, 60).run()
    assert float(np.asarray(answer["missed"], dtype=float)) < ROUNDING
    # Right in one case of four only, and there to rounding.
    off = np.asarray(answer["off"], dtype=float)
    assert np.all(off < 1e-14) if case == "ground, centre" else np.all(off > experiments.WRONG)


def test_more_iterations_do_not_mend_a_groove() -> None:
    text = scripts.source("pymunk_groove").replace("space.step", "space.iterations = 1000\nspace.step")
    space: dict[str, float] = {}
    exec(text, space)
    assert space["found"] == scripts.said("pymunk_groove")[1]


@pytest.mark.parametrize("kind", KINDS)
def test_an_equality_obeys_one_of_two_formulas_to_rounding(kind: str) -> None:
    answer = Equalities(kind, 40).run()
    off, missed = (np.asarray(answer[name], dtype=float) for name in ("off", "missed"))
    if kind in ("joint, curved", "tendon"):
        assert missed.max() < ROUNDING
        assert np.median(off) > 1e-3
    else:
        # The connect's own anchors make its three rows nearly dependent in a stretched pose.
        assert off.max() < 10 * ROUNDING
    if kind == "connect":
        assert np.median(missed) > 1e-3


def recorded_of(name: str, version: str = "") -> list[Found]:
    return [row for row in recorded() if row.script == name and row.version.endswith(version)]


@pytest.mark.parametrize("name", ["mujoco_joint_equality_mended", "mujoco_tendon_equality_mended"])
def test_the_missing_term_written_by_a_callback_gives_the_exact_acceleration(name: str) -> None:
    expected, found = scripts.said(name)
    # A row 1e12 times as stiff as shipped, and the solver's own tolerance.
    assert found == pytest.approx(expected, rel=1e-12)
    assert recorded_of(name)[-1].found == pytest.approx(found, rel=1e-12)


def costs(text: str) -> dict[tuple[str, float], list[float]]:
    """Label and step -> errors, of a table that a script printed."""
    found = re.findall(r"^(\w.*?) +(\de-\d\d)((?: +\d\.\de[+-]\d\d)+)$", text, re.MULTILINE)
    return {(label, float(step)): [float(value) for value in rest.split()] for label, step, rest in found}


@pytest.mark.parametrize("name", ["mujoco_joint_equality_cost", "mujoco_tendon_equality_cost", "pymunk_groove_cost"])
def test_a_cost_is_what_the_installed_engine_prints(name: str) -> None:
    (row,) = (row for row in recorded_of(name) if not row.version.endswith(PATCHED))
    if row.version not in (metadata.version("pymunk"), metadata.version("mujoco-core")):
        pytest.skip(f"{row.package} {row.version} is not the one that is installed")
    now, kept = costs(scripts.printed(name)), costs(row.printed)
    assert set(now) == set(kept)
    assert len(kept) >= 4
    for key, values in kept.items():  # two digits are printed
        assert now[key] == pytest.approx(values, rel=0.1)


def test_no_smaller_step_mends_a_fault_as_shipped_and_the_missing_term_does() -> None:
    for name in ("mujoco_joint_equality_cost", "mujoco_tendon_equality_cost"):
        table = costs(recorded_of(name)[-1].printed)
        place, gap, *_ = range(4)
        assert table["as shipped", 1e-4][gap] == pytest.approx(table["as shipped", 1e-3][gap], rel=0.1)
        stiff, helped = "RK4, solref of 5 steps", "the same, with the term"
        assert table[stiff, 1e-4][gap] == pytest.approx(1e-2 * table[stiff, 1e-3][gap], rel=0.05)  # step squared
        for step in (1e-3, 1e-4):
            assert table[helped, step][place] < 1e-3 * table[stiff, step][place]


def test_our_build_of_pymunk_is_right_and_fails_no_test_but_the_one_that_pins_the_wrong_value() -> None:
    assert all(row.right for row in recorded() if row.version.endswith(PATCHED) and LINE.search(row.printed))
    before, after = (row.printed.splitlines() for row in recorded_of(OWN_TESTS))
    assert before[1].startswith("OK")
    assert (after[0], after[1]) == ("FAIL: test_kinetic_energy", before[0])
    assert after[2].startswith("FAILED (failures=1,")
    (row,) = recorded_of("pymunk_groove_random", PATCHED)
    for line in row.printed.splitlines()[1:]:
        assert float(line.split()[-1]) < 1e-14  # of velocities after some twenty operations
    plain, build = (costs(row.printed) for row in recorded_of("pymunk_groove_cost"))
    for (label, step), errors in plain.items():
        assert build[label, step][0] < 0.1 * errors[0]


def test_the_truth_of_a_cost_is_what_the_judge_computes() -> None:
    with redirect_stdout(StringIO()):
        groove = runpy.run_path(str(scripts.FOLDER / "pymunk_groove_cost.py"))
    start, arm = groove["START"], groove["L"]
    bar = Body("bar", 1.0, 1 / 12, pose=(0.0, -arm * np.cos(start), start))
    slot = Slot("groove", None, "bar", (0.0, 0.0), 0.0, (0.0, arm))
    judged = Lagrange("dop853", "projection").build(Mechanism((bar,), (slot,), (0.0, -9.81)), 1e-3)(20, 100)
    told = np.array(groove["exact"](2.0))[::100][-len(judged.t) :]
    # Runge and Kutta's error: (1e-3 s)^4 times the fifth derivative, about 6^5 a second, over 2 s and 5!.
    assert judged.pose[:, 0, 2] == pytest.approx(told[:, 0], abs=1e-9)
    assert np.abs(judged.reaction[:, 0]) == pytest.approx(told[:, 1], rel=1e-8)


def test_the_page_tells_what_was_run(material: Material) -> None:
    files = render_page(PAGE, material, "crosscheck run")
    text = files["faults.md"]
    assert len(text.split()) <= 2500
    for release, found in (("mujoco 3.6.0", "0.0"), ("mujoco-core 4.0.0", "-5.24161734893932")):  # the faulty one first
        assert re.search(rf"^{release}: expected \S+, found \*\*{found}\*\*. Mended in ", text, re.MULTILINE)
    assert text.count("100 of 100") == 3
    assert "Not run yet" not in text
    for fault in FAULTS:
        name = f"upstream/{fault.name}.md"
        assert f"]({name})" in text
        pasted = files[name]
        for each in (*fault.scripts, *fault.mended, *fault.costs):
            assert scripts.source(each) in pasted
        assert all(row.printed in pasted for each in fault.mended for row in recorded_of(each))
        assert pasted.startswith("# ")
        assert not re.search(r"\]\((?!https:)", pasted)  # a link to a page of ours leads nowhere in a tracker


def test_a_script_whose_extra_is_missing_is_not_asked_for_and_its_page_and_answer_name_the_extra(monkeypatch) -> None:
    monkeypatch.setattr(single_run, "_is_found", lambda module: module != "jax")
    sentence = not_here("mjx_loop")
    assert "'.[mjx]'" in sentence
    task = SCRIPTS["mjx_loop"]
    assert task not in page_tasks(PAGE)
    assert set(SCRIPTS.values()) - set(page_tasks(PAGE)) == {task}
    assert answered(task).sentence == sentence
    assert sentence in render_page(PAGE, Material({}), "crosscheck run")["faults.md"]


def test_what_releases_find_is_in_step_with_the_scripts(material: Material) -> None:
    rows = {(row.script, row.package, row.version): row for row in recorded()}
    assert set(rows) == {(name, package, version) for package, version, names in ASKED for name in names}
    for name, task in SCRIPTS.items():
        answer = material.answers[task]
        if not_here(name):
            continue
        own = [row for row in rows.values() if row.script == name and row.version == answer.values["version"]]
        for row in own:  # none if a newer release is installed than the newest that was recorded
            assert row.found == pytest.approx(answer.number("found"), rel=1e-12)


def test_each_fault_is_wrong_in_the_releases_that_the_page_names() -> None:
    def wrong(name: str) -> set[str]:
        return {row.version for row in recorded_of(name) if not row.right}

    every = {version for package, version, _ in ASKED if package in ("mujoco", "mujoco-core")}
    assert wrong("mujoco_loop") == {"3.3.0", "3.6.0"}
    assert wrong("mujoco_sparse") == {"4.0.0"}
    assert wrong("mujoco_joint_equality") == wrong("mujoco_tendon_equality") == every
    for name in ("pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy"):
        assert wrong(name) == {
            version for package, version, _ in ASKED if package == "pymunk" and PATCHED not in version
        }


@pytest.mark.slow
@pytest.mark.parametrize("release", ASKED, ids=lambda release: " ".join(release[:2]))
def test_releases_find_again_what_was_recorded(release: tuple[str, str, tuple[str, ...]]) -> None:
    kept = {row.script: row for row in recorded() if (row.package, row.version) == release[:2]}
    for row in found_with(*release):
        old = kept[row.script]
        if LINE.search(row.printed):
            assert row.found == pytest.approx(old.found, rel=1e-12)
        else:
            assert len(row.printed.splitlines()) == len(old.printed.splitlines())


IDS = [str(erratum.number) for erratum in ERRATA]


@pytest.fixture(scope="module")
def said() -> tuple[Ruling, ...]:
    return rulings((task, answer_to(task)) for task in TASKS)


@pytest.fixture(scope="module")
def text() -> str:
    return render_page(ERRATA_PAGE, Material({}), "the command")["errata.md"]


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


def test_a_verdict_tells_by_how_much_each_formula_misses_what_decides_and_engines():
    erratum = ERRATA[0]
    computed = Values(np.array([3.0]), np.array([1.0]), np.array([1.25]))
    measured = [Values(np.array([3.0]), np.array([1.0]), np.array([value])) for value in (1.5, 1.4)]
    told = verdict(erratum, computed, [Ruling(erratum.number, "toy", "a wheel", values) for values in measured])
    assert f": 1.25 {erratum.unit}. The printed formula misses it by 1.8, the right one by 0.25." in told
    assert told.endswith(
        "(toy; a wheel): the printed one misses their motion by 1.5 or more, the right one by 0.5 at most."
    )
    assert verdict(erratum, computed, []).endswith("by 0.25.")


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
