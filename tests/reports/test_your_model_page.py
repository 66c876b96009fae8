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
    """The page's text; each text is made once, since its pictures take their time."""
    name = str(sorted(walk.key for walk in answers))
    if name not in PAGES:
        PAGES[name] = render_page(PAGE, Material({}, answers), "the command")["your_model.md"]
    return PAGES[name]


PAGES: dict[str, str] = {}


def test_the_page_tells_what_was_found(answers):
    assert all(answer.finished for answer in answers.values())
    text = page(answers)
    for walk, answer in answers.items():
        advised = found(answer)["advised"]
        assert all(words in text for words in (walk.text.strip(), advised["words"], *advised["lines"]))
    assert text.count(".svg)") == 6
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
    told = page(answers).partition("## Models that others ship")[2]
    for row in others.rows():
        assert f"`{row['model']}`" in told
        assert row["reason"].replace("|", "\\|") in told
    assert len({(row["source"], row["model"]) for row in others.rows()}) == len(others.rows()) >= 50
