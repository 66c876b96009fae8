"""The kept mistakes: each is in step with the code, and a mistake's fate is told as it is."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from tests.mutants import __main__ as command
from tests.mutants.__main__ import ALLOWED, chosen, table
from tests.mutants.catalogue import BadList, Mutant, faults, read, wider_tests
from tests.mutants.trial import Fate, Verdict, ask, copy_tree, trial

MUTANTS = read()

# A package of one function, with tests that see its sign, its factor, and not its name.
AREA = '''"""Areas."""


def area(width: float, height: float) -> float:
    label = "area"
    return width * height
'''
TESTS = """from shapes.area import area


def test_an_area_is_positive():
    assert area(2.0, 3.0) > 0


def test_an_area_is_the_product():
    assert area(2.0, 3.0) == 6.0
"""
POSITIVE = "tests/test_area.py::test_an_area_is_positive"
SOUND = Mutant("sign", "shapes/area.py", "the sign is wrong", "return width", "return -width", (POSITIVE,))


@pytest.fixture
def tree(tmp_path) -> Path:
    """A copy of a small tree, as mistakes are made in."""
    root = tmp_path / "root"
    for name, text in (("shapes/__init__.py", ""), ("shapes/area.py", AREA), ("tests/test_area.py", TESTS)):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    (root / "pyproject.toml").write_text("[tool.pytest.ini_options]\npythonpath = ['.']\n")
    return copy_tree(root, tmp_path / "copy")


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_every_mistake_is_in_step_with_the_code_and_names_tests_that_exist(mutant):
    assert faults(mutant) == []


def test_at_least_two_hundred_mistakes_are_kept_in_all_three_packages():
    counts = Counter(mutant.file.split("/")[0] for mutant in MUTANTS)
    assert counts.total() >= 200
    assert min(counts[name] for name in ("reference", "engines", "reports")) >= 60


def test_no_more_than_a_twentieth_may_survive_and_each_says_why():
    reasons = [mutant.survives for mutant in MUTANTS if mutant.survives]
    assert len(reasons) <= ALLOWED * len(MUTANTS)
    assert all(len(reason.split()) > 5 for reason in reasons)


def test_a_mistake_is_caught_by_the_test_named_beside_it_and_taken_back(tree):
    verdict = trial(SOUND, tree)
    assert (verdict.fate, verdict.by) == (Fate.CAUGHT, POSITIVE)
    assert (tree / "shapes/area.py").read_text() == AREA
    assert ask(tree, SOUND.tests, 60).passed


def test_what_the_named_test_lets_through_is_looked_for_by_the_others_of_the_package(tree):
    double = replace(SOUND, name="factor", new="return 2 * width")
    (tree / "tests" / "test_volume.py").write_text("def test_nothing():\n    assert True\n")
    assert wider_tests(double, tree) == ("tests/test_area.py",)
    verdict = trial(double, tree)
    assert (verdict.fate, verdict.by) == (Fate.ELSEWHERE, "tests/test_area.py::test_an_area_is_the_product")


def test_a_survivor_is_good_with_a_reason_only_and_a_reason_that_is_not_needed_is_told(tree):
    unseen = replace(SOUND, name="label", old='"area"', new='"volume"', tests=("tests/test_area.py",))
    assert trial(unseen, tree).fate is Fate.SURVIVED
    assert trial(replace(unseen, survives="nobody reads the label"), tree).fate is Fate.KNOWN
    assert trial(replace(SOUND, survives="signs are a matter of taste"), tree).fate is Fate.NEEDLESS


def test_a_mistake_that_can_not_be_imported_or_never_ends_is_caught(tree, monkeypatch):
    assert trial(replace(SOUND, old="def area", new="import nowhere\n\n\ndef area"), tree).fate is Fate.CAUGHT
    monkeypatch.setattr("tests.mutants.trial.LIMIT", 1.0)
    endless = trial(replace(SOUND, old='    label = "area"', new="    while True:\n        pass"), tree)
    assert (endless.fate, endless.by) == (Fate.CAUGHT, "no end within 1 s")


@pytest.mark.parametrize(
    ("change", "telling"),
    [
        ({"old": "return depth"}, "stands 0 times"),
        ({"old": "width"}, "stands 2 times"),
        ({"file": "shapes/volume.py"}, "stands 0 times in shapes/volume.py"),
        ({"new": "return ("}, "no Python"),
        ({"new": "return width"}, "equal"),
        ({"tests": ("tests/test_area.py::test_an_area_is_blue",)}, "there is no test"),
        ({"tests": ("tests/test_volume.py",)}, "there is no test"),
    ],
)
def test_a_mistake_that_can_not_be_made_is_not_applicable_and_says_why(tree, change, telling):
    verdict = trial(replace(SOUND, **change), tree)
    assert verdict.fate is Fate.STALE
    assert telling in verdict.by


@pytest.mark.parametrize(
    ("text", "telling"),
    [
        ('[a]\nfile = "x"\nmistake = "y"\nold = "1"\nnew = "2"\n', "a: it has no tests"),
        ('[a]\nfile = "x"\nmistake = "y"\nold = "1"\nnew = "2"\ntests = []\n', "a: it names no test"),
        ('[a]\nfile = "x"\nmistake = "y"\nold = "1"\nnew = "2"\ntests = ["t"]\nodd = 1\n', "a: odd is no field"),
    ],
)
def test_a_list_that_lacks_something_is_refused_with_the_name_of_the_mistake(tmp_path, text, telling):
    (tmp_path / "list.toml").write_text(text)
    with pytest.raises(BadList, match=telling):
        read([tmp_path / "list.toml"])


def test_mistakes_are_chosen_by_name_or_by_the_beginning_of_their_file():
    other = replace(SOUND, name="other", file="engines/lagrange/engine.py")
    assert chosen((SOUND, other), []) == (SOUND, other)
    assert chosen((SOUND, other), ["engines/"]) == (other,)
    assert chosen((SOUND, other), ["sign"]) == (SOUND,)
    assert chosen((SOUND, other), ["volume"]) == ()


def test_the_status_tells_whether_all_is_as_it_should_be(tree, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "ROOT", tree)
    told = {}
    for name, mutants in (
        ("caught", (SOUND,)),
        ("stale", (SOUND, replace(SOUND, name="moved", old="return depth"))),
        ("survived", (replace(SOUND, old='"area"', new='"volume"'),)),
        ("too many", (SOUND, replace(SOUND, name="label", old='"area"', new='"volume"', survives="nobody reads it"))),
    ):
        monkeypatch.setattr(command, "read", lambda mutants=mutants: mutants)
        told[name] = (command.main([]), capsys.readouterr())
    assert {name: status for name, (status, _) in told.items()} == {
        "caught": 0,
        "stale": 1,
        "survived": 1,
        "too many": 1,
    }
    assert "moved: its text stands 0 times in shapes/area.py" in told["stale"][1].out
    assert "| label |" in (tmp_path / "crosscheck-results" / "mutants.md").read_text()
    assert command.main(["nowhere/"]) == 2
    assert "nowhere/" in capsys.readouterr().err


def test_tests_that_fail_without_a_mistake_stop_everything(tree, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(command, "ROOT", tree)
    (tree / "shapes" / "area.py").write_text(AREA.replace("return width", "return -1 + 0 * width"))
    monkeypatch.setattr(command, "read", lambda: (replace(SOUND, old="return -1", new="return -2"),))
    assert command.main([]) == 2
    assert f"without any mistake, {POSITIVE} fails already" in capsys.readouterr().err


def test_the_table_begins_with_what_is_not_as_it_should_be():
    verdicts = [Verdict(SOUND, Fate.CAUGHT, "t", 1.0), Verdict(replace(SOUND, name="other"), Fate.SURVIVED, "", 2.0)]
    text = table(verdicts, 90.0)
    assert "2 mistakes in 1.5 minutes" in text
    wrong, _, everything = text.partition("## All")
    assert "| other |" in wrong
    assert "| sign |" not in wrong
    assert "| sign |" in everything
