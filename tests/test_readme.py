"""The readme keeps its promises: its example runs, it is short, and its table has a place."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from reports.overview import BEGIN, END, with_overview

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def test_the_python_example_runs_and_says_what_the_reader_expects(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(compile(example, "README.md", "exec"), {})
    said = capsys.readouterr().out
    assert re.fullmatch(r"largest angle error \d\.\de-\d\d rad after 1 s\n", said)
    # RK4 at a step of 1e-3 s with the stiffness tied to it: of the order of 1e-6.
    assert float(said.split()[3]) < 1e-4


def test_it_is_shorter_than_150_lines():
    assert len(README.splitlines()) < 150


def test_the_overview_stands_between_its_marks_and_nothing_else_changes():
    filled = with_overview(README, "| a table |")
    assert f"{BEGIN}\n| a table |\n{END}" in filled
    assert with_overview(filled, "| another |") == with_overview(README, "| another |")
    assert filled.split(BEGIN)[0] == README.split(BEGIN)[0]
    with pytest.raises(ValueError, match="lacks the marks"):
        with_overview("nothing here", "| a table |")
