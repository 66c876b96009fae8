"""Tests of `crosscheck check`: it writes advised settings into a user's file, searches for settings, and checks
folders."""

from __future__ import annotations

import json
import subprocess
import sys
import xml.etree.ElementTree as xml
from types import SimpleNamespace

import pytest

from engines.mujoco.reading.settings import rewritten
from engines.pymunk.reading.script import BEGIN, END
from engines.reading import Change
from reports.check.request import CheckReport, CheckRequest, run_check
from reports.check.settings import _is_dominated
from tests.reports.test_check import FOUR_BAR, PENDULUM
from tests.reports.test_command_line import call, here

__all__ = ["here"]
STEPS_ITSELF = PENDULUM.replace("def make():", "if True:").replace("    return space", "").replace("make()", "")
LOOP = f"{STEPS_ITSELF}\nfor _ in range(30):\n    space.step(0.01)\nprint(bob.position.x, bob.position.y)\n"
INSIDE = f"{PENDULUM}\ndef main():\n    world = make()\n    for _ in range(30):\n        world.step(0.01)\n"


def checked(folder, word, **terms) -> CheckReport:
    check = run_check(CheckRequest(word, str(folder), 0.5, **terms))
    assert isinstance(check, CheckReport), check
    return check


def test_apply_changes_only_the_advised_settings_and_the_written_model_has_the_expected_error(tmp_path):
    text = FOUR_BAR.replace("<worldbody>", "<!-- mine: <option> > -->\n<worldbody>")
    (tmp_path / "model.xml").write_text(text)
    result = checked(tmp_path, "model.xml", tolerance=1e-4, apply="new.xml")
    advised, written = result.data["advised"], result.data["applied"]
    assert result.fine
    assert not result.data["met"]
    assert written["error"] == pytest.approx(advised["error"], rel=1e-6)
    written = (tmp_path / "new.xml").read_text()
    assert advised["lines"][0] in written
    for tag in ("<option", "<connect"):  # All other text is unchanged.
        old, new = (
            next(line for line in document.splitlines() if tag in line and "--" not in line)
            for document in (text, written)
        )
        written = written.replace(new, old)
    assert written == text


@pytest.mark.parametrize(("text", "word"), [(LOOP, "x.py"), (LOOP, "x.py:space"), (INSIDE, "x.py:main")])
def test_settings_are_inserted_before_the_first_step_of_a_script(tmp_path, text, word):
    (tmp_path / "x.py").write_text(text)
    result = checked(tmp_path, word, tolerance=3e-3, apply="y.py")
    assert result.data["step"] == 0.01
    assert result.data["assumed"] == ""
    assert any("stopped before the first step" in note["reason"] for note in result.data["notes"])
    assert result.data["applied"]["error"] == pytest.approx(result.data["advised"]["error"], rel=1e-6)
    # With a smaller tolerance, the advised lines in the written file are replaced.
    other = checked(tmp_path, word.replace("x.py", "y.py"), tolerance=1e-3, search=True, apply="y.py")
    assert other.data["applied"]["error"] <= 1e-3
    text_before, block = (tmp_path / "y.py").read_text().split(BEGIN)
    assert f"{text_before.rstrip(' ')}{block.split(END)[1][1:]}" == text
    if text is LOOP:  # The script still runs with the same times.
        places = [
            [float(part) for part in subprocess.check_output([sys.executable, tmp_path / name]).split()]
            for name in ("x.py", "y.py")
        ]
        # The tolerance 0.1 is ten times the step of x.py, since the error is of first order.
        assert places[1] == pytest.approx(places[0], abs=0.1)
        assert places[1] != places[0]


def test_a_constant_force_on_a_body_acts_in_every_part_of_a_divided_step(tmp_path):
    push = PENDULUM.replace("    return space", "    bob.force = (0, 4)\n    return space")
    (tmp_path / "x.py").write_text(push)
    result = checked(tmp_path, "x.py:make", tolerance=1e-3, search=True, apply="y.py")
    assert result.data["applied"]["error"] <= 1e-3
    space = "import y; space = y.make(); space.step(1 / 60); print(*[body.velocity.y for body in space.bodies])"
    speeds = [
        float(subprocess.check_output([sys.executable, "-c", code], cwd=tmp_path).split()[-1])
        for code in (space, space.replace(" y;", " x as y;"))
    ]
    # Dividing the step changes the speed by a quarter, which the tolerance allows.
    assert speeds[0] == pytest.approx(speeds[1], rel=0.3)


@pytest.mark.parametrize(
    ("source", "wanted"),
    [
        (
            b"<mujoco><worldbody/></mujoco>",
            b'<mujoco>\n  <option timestep="0.001" integrator="RK4"/><worldbody/></mujoco>',
        ),
        (
            b"<mujoco><option gravity='0 0 -1' timestep = '.1'><flag/></option></mujoco>",
            b'<mujoco><option gravity=\'0 0 -1\' timestep="0.001" integrator="RK4"><flag/></option></mujoco>',
        ),
        (b"<robot></robot>", b'<robot>  <mujoco><option timestep="0.001" integrator="RK4"/></mujoco>\n</robot>'),
        (b"<robot><mujoco/></robot>", b'<robot><mujoco><option timestep="0.001" integrator="RK4"/></mujoco></robot>'),
    ],
)
def test_existing_options_are_replaced_and_missing_ones_are_inserted(source, wanted):
    change = Change("", 0.001, (), (("integrator", "RK4"), ("tied", False)))
    assert rewritten(source, change) == wanted
    assert rewritten(wanted, change) == wanted


@pytest.mark.parametrize(
    ("errors", "cost", "tolerance", "dominated"),
    [
        ((0.4, 0.2), 2.0, 0.02, True),  # order 1 predicts 0.1, which is far above 0.01
        (
            (0.4, 0.2),
            2.0,
            0.005,
            False,
        ),  # the setting with 0.01 can't be advised, and errors can fall faster than before
        ((0.4, 0.2), 0.5, 0.02, False),  # cheaper than the setting with 0.01
        ((0.2, 0.002), 2.0, 0.02, False),
        ((4.0, 0.2), 2.0, 0.02, False),  # nothing follows from a saturated error
        ((0.2,), 2.0, 0.02, False),
    ],
)
def test_a_setting_is_left_out_only_if_a_cheaper_one_is_advised_and_better(errors, cost, tolerance, dominated):
    def setting(error, dt):
        return SimpleNamespace(error=error, cost=1.0, change=SimpleNamespace(dt=dt))

    same_options = [setting(error, 2.0**-number) for number, error in enumerate(errors)]
    table = [setting(0.01, 1.0), *same_options]
    found = _is_dominated(table, same_options, 2.0 ** -len(errors), cost, tolerance)  # pyright: ignore[reportArgumentType]
    assert found == dominated


def test_quick_tries_four_settings_and_all_tries_all_with_the_same_causes(tmp_path):
    (tmp_path / "model.xml").write_text(FOUR_BAR)
    option_sets = ({"quick": True}, {}, {"everything": True})
    quick, total, every = (checked(tmp_path, "model.xml", tolerance=1e-4, **term).data for term in option_sets)
    assert len(quick["tried"]) == 1 + 4
    # With --quick the motion with the declared softness is computed with a relative error of 1e-3.
    assert quick["parts"]["softness"] == pytest.approx(total["parts"]["softness"], rel=1e-3)
    assert {setting["words"] for setting in total["tried"]} < {setting["words"] for setting in every["tried"]}
    # The advised settings depend on measured times, but both are accurate enough.
    assert max(data["advised"]["error"] for data in (total, every)) <= 1e-4
    assert total["next_decade"] is not None
    assert quick["error"] == total["error"]
    assert (total["error"], total["parts"]) == (every["error"], every["parts"])


def test_the_search_for_settings_ends_at_the_goal_or_with_the_last_documented_setting(tmp_path, monkeypatch):
    monkeypatch.setattr("reports.check.checked.SEARCH_BUDGET", 2.0)
    (tmp_path / "swing.py").write_text(PENDULUM)
    for goal, result in ((1e-3, True), (1e-9, False)):  # The goal 1e-9 would need a step of 4 ns.
        answer = checked(tmp_path, "swing.py:make", tolerance=goal, search=True)
        assert answer.fine == result
        assert (answer.data["advised"] is not None) == result
        assert ("none of the" in dict(answer.answer.facts)["advice"]) != result
        # The search ends with the first sufficient setting.
        assert sum(item["error"] <= goal for item in answer.data["tried"]) == result


def test_only_a_given_tolerance_changes_the_exit_status(here, capfd, at_home):
    (here / "model.xml").write_text(FOUR_BAR)
    text = ("check", "model.xml", "--duration", 0.2, "--quick")
    for extra, status in (((), 0), (("--tolerance", 1e-5), 1), (("--tolerance", 0.5), 0), (("--fix-to", 1e-3), 0)):
        assert call(*text, *extra) == status
    capfd.readouterr()
    assert call(*text, "--tolerance", 1e-12, "--apply", "new.xml") == 2
    assert "nothing was written" in capfd.readouterr().err
    assert not (here / "new.xml").exists()
    assert call(*text, "--apply", "model.xml", "--force") == 0
    assert (here / "model.xml").read_text() != FOUR_BAR
    assert call(*text, "--apply", "new.txt") == 2
    assert "it must end in .xml" in capfd.readouterr().err
    assert call("check", "--schema") == 0
    assert json.loads(capfd.readouterr().out)["title"] == "crosscheck check --json"


def test_a_folder_of_models_gives_one_table_and_a_junit_test_for_each_model(here, capfd, at_home):
    for name, text in (("a.xml", FOUR_BAR), ("b.py", PENDULUM), ("c.xml", "<mujoco/>"), ("other.xml", "<svg/>")):
        for folder in (here / ".models", here / ".models" / ".old"):  # Hidden files in a folder are left out.
            folder.mkdir(exist_ok=True)
            (folder / name).write_text(text)
    command = ("check", ".models", "--duration", 0.2, "--quick", "--tolerance", 1e-4, "--json")
    assert call(*command, "--junit", "r.xml", "--markdown", "t.md") == 1
    out, err = capfd.readouterr()
    assert "1 of 3 models miss 0.0001: .models/a.xml" in err.splitlines()[-1]
    reports_by_model = {check_report["model"]: check_report for check_report in json.loads(out)}
    assert list(reports_by_model) == [".models/a.xml", ".models/b.py", ".models/c.xml"]
    assert reports_by_model[".models/a.xml"]["found"]["met"] is False
    assert "give the name of the space, or of a function" in reports_by_model[".models/b.py"]["refused"]
    suite = xml.parse(here / "r.xml").getroot()[0]
    assert (suite.get("tests"), suite.get("failures"), suite.get("skipped")) == ("3", "1", "2")
    assert [child.tag for case in suite for child in case] == ["failure", "skipped", "skipped"]
    assert "| .models/a.xml | " in (here / "t.md").read_text()
    assert call("check", ".models", "--apply", "x.xml") == 2
    assert "--apply is for one model" in capfd.readouterr().err
