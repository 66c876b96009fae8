"""The deliberate mistakes: each can be made in the code as it is, and what the tests say to it is told as it is."""

from __future__ import annotations

import ast
import json
import struct
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from tests.tools.mutants import __main__ as command
from tests.tools.mutants import by_hand, matrix, tracing
from tests.tools.mutants.generated import drawn, generated
from tests.tools.mutants.sources import ROOT, SOURCES, Mistake, Source
from tests.tools.mutants.tracing import Traced
from tests.tools.mutants.trial import Question, asked

HAND = by_hand.read()
AREA = '''"""Areas."""


def area(width: float, height: float) -> float:
    if width < 0:
        return 0.0
    return 2 * abs(width) * height
'''
TESTS = """import time
from area import area


def test_positive():
    assert area(2.0, 3.0) > 0


def test_product():
    assert area(2.0, 3.0) == 12.0
"""


def wrong(old: str, new: str) -> Mistake:
    start = AREA.index(old)
    return Mistake(f"{old} is {new}", "area.py", "area", 5, start, start + len(old), new)


@pytest.fixture
def tree(tmp_path) -> Path:
    (tmp_path / "tests").mkdir()
    (tmp_path / "area.py").write_text(AREA)
    (tmp_path / "tests" / "test_area.py").write_text(TESTS)
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\nmarkers = ['slow', 'crosscheck']\n")
    return tmp_path


@pytest.mark.parametrize("entry", HAND, ids=lambda entry: entry.mistake.replace(" ", "-"))
def test_every_mistake_by_hand_is_in_step_with_the_code(entry):
    found = by_hand.found(entry)
    assert ast.dump(ast.parse(found.text(ROOT))) != ast.dump(ast.parse((ROOT / found.file).read_bytes()))


def test_at_least_a_hundred_mistakes_are_kept_by_hand_and_hardly_any_survives():
    counts = Counter(by_hand.found(entry).file.split("/")[0] for entry in HAND)
    assert counts.total() >= 100
    assert min(counts[layer] for layer in matrix.LAYERS) >= 10
    reasons = [entry.survives for entry in HAND if entry.survives]
    assert len(reasons) <= command.ALLOWED * len(HAND)
    assert all(len(reason.split()) > 5 for reason in reasons)


@pytest.mark.parametrize(
    ("function", "old", "new", "telling"),
    [
        ("perpendicular", "return depth", "", "stands 0 times"),
        ("perpendicular", "vector", "0", "stands 2 times"),
        ("Pin.no_such_function", "vector", "0", "stands 0 times"),
        ("perpendicular", "vector[..., 0]", "(", "no Python"),
    ],
)
def test_a_mistake_by_hand_that_can_not_be_made_says_why(function, old, new, telling):
    with pytest.raises(by_hand.BadList, match=telling):
        by_hand.found(by_hand.Written(function, "some mistake", old, new))


def test_generated_mistakes_are_named_by_place_and_operator_and_not_by_line():
    def made(text: str) -> dict[str, str]:
        source = Source("area.py", text.encode(), ast.parse(text))
        return {m.name: text[: m.start] + m.new + text[m.end :] for m in generated(source)}

    found = made(AREA)
    assert {name.removeprefix("area:area:") for name in found} == {
        *("never:1", "turned:1", "factor:1", "abs:1", "constant:1"),
    }
    assert "return (abs(width)) * height" in found["area:area:factor:1"]
    assert "return 2 * (width) * height" in found["area:area:abs:1"]
    assert "if (width >= 0):" in found["area:area:turned:1"]
    assert set(made(AREA.replace("2 * abs(width) * height", "(\n        2 * abs(width) * height\n    )"))) == set(found)


def test_a_mistake_is_noticed_by_the_tests_that_fail_and_taken_back(tree):
    tests = ("tests/test_area.py",)
    mistakes = [None, wrong("2 * ", "-2 * "), wrong("width < 0", "width < -1")]
    answers = asked([Question(tests, mistake, first=False) for mistake in mistakes], [tree])
    positive, product = (f"tests/test_area.py::test_{name}" for name in ("positive", "product"))
    assert [answer.noticed for answer in answers] == [(), (positive, product), ()]
    assert (tree / "area.py").read_text() == AREA
    [first] = asked([Question(tests, mistakes[1])], [tree])
    assert first.noticed == (positive,)


def test_a_mistake_that_can_not_be_imported_or_never_ends_is_noticed(tree):
    endless, broken = wrong("if width < 0", "while True"), wrong("def area", "import nowhere\n\n\ndef area")
    [answer] = asked([Question(("tests/test_area.py",), endless, limit=3.0)], [tree])
    assert answer.end == "no end within 3 s" or answer.noticed
    [answer] = asked([Question(("tests/test_area.py",), broken)], [tree])
    assert answer.noticed == ("tests/test_area.py",)


def test_the_likely_tests_run_the_mistakes_own_block_and_the_most_particular_comes_first(tmp_path):
    file = "reference/plane.py"
    mistake = next(mistake for mistake in drawn("1", [file]) if mistake.function == "rotated")
    [body, *_] = (node.body for name, node in by_hand.named((file,))["rotated"] for node in [node])  # type: ignore[attr-defined]
    block = SOURCES.index(file) * tracing.MOST + tracing.named(body)
    (tmp_path / "hits").mkdir()
    (tmp_path / tracing.SEEN).write_text(json.dumps({each: tracing.digest(each) for each in SOURCES}))
    ran = {"tests/test_a.py::wide": [block, 1, 2, 3], "tests/test_b.py::narrow": [block], "tests/test_c.py::other": [1]}
    with (tmp_path / "results.jsonl").open("w") as results:
        for number, (test, blocks) in enumerate({**ran, "tests/test_d.py::failing": [block]}.items()):
            (tmp_path / "hits" / f"{number}.name").write_text(test)
            (tmp_path / "hits" / f"{number}").write_bytes(struct.pack(f"{len(blocks)}i", *blocks))
            print(json.dumps([test, "failed" if "failing" in test else "passed", 0.1]), file=results)
    assert Traced(tmp_path).likely(mistake, 10.0) == ("tests/test_b.py::narrow", "tests/test_a.py::wide")


@pytest.mark.parametrize(
    ("name", "test", "reason", "status"),
    [
        ("by hand", "test_positive", "", 1),
        ("by hand", "test_positive", "nobody looks", 0),
        ("area:area:factor:1", "test_positive", "", 1),
    ],
)
def test_the_status_tells_whether_all_is_as_it_should_be(tree, monkeypatch, name, test, reason, status):
    monkeypatch.chdir(tree)
    monkeypatch.setattr(Traced, "likely", lambda *_: (f"tests/test_area.py::{test}",))
    mistake = replace(wrong("2 * ", "3 * "), name=name)
    assert command.tried([(mistake, reason)], Traced(tree), [tree]) == status
    assert (name in (command.KEPT / "fates.md").read_text()) == (test == "test_positive")
