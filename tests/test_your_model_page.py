"""The page of a user's own model: its sentences are what was found, and vanish where nothing was run."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from reports.model.page import Material
from reports.model.tasks import Answer, answered
from reports.pages.rendering import render_page
from reports.pages.your_model import page as others
from reports.pages.your_model.experiments import CART, FOUR_BAR, SWING, WALKS
from reports.pages.your_model.page import PAGE


@pytest.fixture(scope="module")
def answers():
    """The checks of shorter motions, which take a moment each, under the names of the page's own."""
    return {walk: answered(replace(walk, duration=0.3)) for walk in WALKS}


def found(answer: Answer):
    return json.loads(str(answer.values["found"]))


def page(answers) -> str:
    return render_page(PAGE, Material({}, answers), "the command")["your_model.md"]


def test_the_page_tells_what_was_found(answers):
    assert all(answer.finished for answer in answers.values())
    files = render_page(PAGE, Material({}, answers), "the command")
    text = files["your_model.md"]
    for walk, answer in answers.items():
        told = found(answer)
        assert walk.text.strip() in text
        assert told["advised"]["words"] in text
        for line in told["advised"]["lines"]:
            assert line in text
    assert len([name for name in files if name.endswith(".svg")]) == 6


def test_the_page_without_answers_says_that_nothing_was_checked():
    assert page({}).count("was not checked yet") == 3


def test_what_the_titles_claim_is_so(answers):
    soft, hard, swing = (found(answers[walk]) for walk in (FOUR_BAR, CART, SWING))
    assert soft["parts"]["softness"] > 1e-4
    assert hard["parts"]["softness"] == 0
    assert hard["parts"]["falling"]
    assert not swing["parts"]["divided"]
    assert {note["element"] for note in hard["notes"]} == {"actuator 'push'", "joint 'rail'"}


def test_an_answer_is_the_same_at_every_run(answers):
    again = answered(replace(CART, duration=0.3))
    assert again.values == answers[CART].values


def test_every_model_of_others_is_on_the_page_by_name(answers):
    text = page(answers)
    told = text[text.index("## Models that others ship") :]
    for row in others.rows():
        assert f"`{row['model']}`" in told
        assert row["reason"].replace("|", "\\|") in told
    assert "| Gymnasium | `half_cheetah` | read: 7 bodies, with `--without armature` |" in told
    assert len(others.rows()) >= 50
    assert len({(row["source"], row["model"]) for row in others.rows()}) == len(others.rows())
