"""Tests of the three output formats, of cells that are left out, and of the pages from a small store."""

from __future__ import annotations

import json
import re

import pytest

from engines.lagrange.engine import Lagrange
from reports.cli.commands import invoke
from reports.cli.selection import choose_cells, left_out
from reports.cli.terminal import print_table, telling
from reports.model.catalogue import with_scenes
from reports.model.cells import QUICK
from reports.model.ending import BadInput, Broken
from tests.toys import Disc

HEADER, ROWS = ("scene", "angle [rad]", "steps"), [("disc | a", 1.2e-4, 10), ("disc b", float("nan"), 3)]


def printed(capsys, **form) -> str:
    with telling(140, form.get("json", False), form.get("markdown", False)) as console:
        console.say("on the way")
        print_table(console, "Errors", HEADER, ROWS, 1)
        console.tell("Two of them.")
    return capsys.readouterr().out


def test_a_table_is_text_markdown_or_json_and_progress_is_only_in_text(capsys):
    text = printed(capsys)
    assert "on the way" in text
    assert re.search(r"^disc \| a +│ +1\.2e-4 +│ +10$", text, re.MULTILINE)
    markdown = printed(capsys, markdown=True)
    assert "on the way" not in markdown
    assert r"| disc \| a | 1.2e-4 | 10 |" in markdown
    document = json.loads(printed(capsys, json=True))
    assert document["tables"][0]["rows"] == [
        {"scene": "disc | a", "angle [rad]": 1.2e-4, "steps": 10},
        {"scene": "disc b", "angle [rad]": None, "steps": 3},
    ]
    assert (document["sentences"], document["status"], document["message"]) == (["Two of them."], 0, "")


def test_a_document_has_the_error_message_and_two_forms_at_once_are_refused(capsys):
    with pytest.raises(Broken), telling(140, True, False):
        raise Broken("the second is worse")
    document = json.loads(capsys.readouterr().out)
    assert (document["status"], document["message"]) == (1, "the second is worse")
    with pytest.raises(BadInput, match="give one of them"), telling(140, True, True):
        pass


class Slow(Lagrange):
    name = "slow"

    def step_cost(self, mechanism) -> float:
        return 1.0


def test_a_slow_engine_that_is_named_runs_the_largest_step_and_other_steps_are_reported_with_the_reason():
    scene, slow = Disc(), Slow("rk4", "projection")
    pages = with_scenes((), (scene,), (slow,))
    assert choose_cells([scene], [slow], pages, full=False) == ()
    named = choose_cells([scene], [slow], pages, full=False, named=True)
    assert [cell.every for cell in named] == [QUICK[0]]
    omitted = left_out([scene], [slow], pages, False, named)
    assert [cell.every for cell, _ in omitted] == list(QUICK[1:])
    for cell, reason in omitted:
        assert re.fullmatch(rf"step_cost says {scene.samples * cell.every} s, and a run may take 0\.8 s", reason)


def test_a_small_store_gives_only_pages_with_rows_and_no_dead_links(tmp_path, capfd):
    options = ["--results", str(tmp_path)]
    assert invoke(["run", "free_four_bar", "--engine", "pymunk", "--variant", "tuned", "--every", "1", *options]) == 0
    assert invoke(["report", *options]) == 0
    pages = {path.name for path in tmp_path.glob("*.md")}
    assert {"index.md", "four_bar.md"} <= pages
    assert not {"pendulum.md", "skate.md", "wheels.md", "faults.md"} & pages
    for page in pages:
        text = (tmp_path / page).read_text(encoding="utf-8")
        assert set(re.findall(r"\]\((\w+\.md)", text)) <= pages, page
    assert invoke(["show", "free_four_bar", *options, "--json"]) == 0
    out = capfd.readouterr().out
    (row,) = json.loads(out[out.index("\n{") :])["rows"]
    assert (row["method"] if "method" in row else row["engine"], row["every"]) == ("pymunk", 1)
