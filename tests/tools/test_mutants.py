"""Tests that every entry of the list of mistakes fits the code and names an existing test."""

from __future__ import annotations

import ast

import pytest

from tests import ROOT
from tests.tools.mutants.mistakes import BadList, read_mistakes

MUTATIONS = read_mistakes()


@pytest.mark.parametrize("mistake", MUTATIONS, ids=lambda mistake: mistake.mistake.replace(" ", "-"))
def test_every_mistake_fits_the_code_and_names_a_test(mistake):
    file, wrong = mistake.locate()
    assert ast.dump(ast.parse(wrong)) != ast.dump(ast.parse((ROOT / file).read_bytes()))
    if not mistake.survives:
        path, *names = mistake.noticed_by.split("::")  # a file without a test, since the mistake breaks its import
        text = (ROOT / path).read_text(encoding="utf-8")
        assert not names or f"def {names[-1]}(" in text


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ('[["Drive.gap"]]\nmistake = "m"\nold = "1"', "missing 1 required positional argument: 'new'"),
        ('[["Drive.gap"]]\nmistake = "m"\nold = "1"\nnew = "2"\nodd = 3', "unexpected keyword argument 'odd'"),
        ('[["Drive.gap"]]\nmistake = "m"\nold = "not_there"\nnew = "2"', "occurs 0 times"),
        ('[["Drive.gap"]]\nmistake = "m"\nold = "t"\nnew = "1 +"', "not valid Python"),
    ],
)
def test_an_entry_that_does_not_fit_is_refused_by_its_reason(tmp_path, text, reason):
    (tmp_path / "list.toml").write_text(text)
    with pytest.raises(BadList, match=reason):
        _ = [mistake.locate() for mistake in read_mistakes(tmp_path / "list.toml")]
