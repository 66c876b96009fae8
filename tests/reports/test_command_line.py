"""The exit status, the message and the forms of output of the program, and cells that a quick run leaves out."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from contextlib import closing
from pathlib import Path
from unittest.mock import Mock

import pytest

from engines import registry
from engines.lagrange import Lagrange
from reference.scenes.four_bar.scenes import FreeFourBar
from reports import __main__ as program
from reports.cli import commands, selection
from reports.cli import report as report_command
from reports.cli.commands import invoke
from reports.cli.selection import choose_cells, left_out
from reports.cli.terminal import print_table, telling
from reports.model import catalogue
from reports.model.catalogue import with_scenes
from reports.model.cells import QUICK, Cell
from reports.model.ending import FINE, INTERRUPTED, REFUSED, UNREAD, BadInput, Broken
from reports.model.measure import blank, measure
from reports.model.outcomes import Outcome
from reports.pages import index, rendering
from reports.run import files
from reports.run.files import write_whole
from reports.run.store import Store
from reports.write.csv_files import as_csv
from tests import ROOT
from tests.reports.test_reports import PAGE
from tests.rows import row
from tests.toys import Disc, Toy

REFUSALS = Path(__file__).with_name("refusals.toml")
ONE_CELL = ("free_four_bar", "--engine", "lagrange", "--variant", "euler baumgarte", "--every", "1")


def call(*words):
    """Run a command in this process and return its exit status."""
    with pytest.raises(SystemExit) as ending:
        program.main([str(label) for label in words])
    return ending.value.code


def environment():
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def one_line(err):
    err = re.sub(r"^compiling the judge's machine code.*\n", "", err, flags=re.MULTILINE)
    assert len(err.strip().splitlines()) == 1, err
    assert err.startswith("crosscheck: ")
    return err


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_stored_cells_are_not_run_again_and_a_damaged_store_is_renamed(here, capfd):
    one_stored(here)
    assert call("run", *ONE_CELL) == FINE
    assert "0 of 1 cells run" in capfd.readouterr().out
    (here / "crosscheck-results" / "cells.sqlite").write_text("no results\n" * 1000)
    for text in (("report",), ("show", ONE_CELL[0])):
        assert call(*text) == REFUSED
        assert "is damaged" in one_line(capfd.readouterr().err)
    assert call("run", *ONE_CELL) == FINE
    out, err = capfd.readouterr()
    assert "cells.sqlite.damaged-1" in one_line(err)
    assert "1 of 1 cells run" in out
    assert call("show", ONE_CELL[0]) == FINE
    remaining = {"cells.sqlite", "cells.sqlite.damaged-1", "truths"}
    assert {path.name for path in (here / "crosscheck-results").iterdir()} == remaining
    assert {path.name for path in here.iterdir()} == {"crosscheck-results"}


@pytest.mark.parametrize("words", [("show", "free_four_bar"), ("report",), ("report", "--publish")])
def test_commands_that_only_read_create_no_store(words, here, capfd):
    assert call(*words) == REFUSED
    assert "crosscheck run" in one_line(capfd.readouterr().err)
    assert call(*words, "--results", "my results") == REFUSED
    assert "--results 'my results'" in capfd.readouterr().err
    assert list(here.iterdir()) == []


def one_stored(folder):
    with Store(folder / "crosscheck-results" / "cells.sqlite") as store:
        store.put(blank(Cell(FreeFourBar(), Lagrange("euler", "baumgarte"), 1), Outcome.FINISHED))


def checkout(folder, monkeypatch):
    """Write files of a checkout and make it the checkout of the report; return path -> text."""
    texts = {"README.md": "a readme", "reports/results/index.md": "an index"}
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.setattr(report_command, "CHECKOUT", folder)
    return texts


def test_an_incomplete_grid_is_not_published(here, monkeypatch, capfd):
    texts = checkout(here / "checkout", monkeypatch)
    one_stored(here)
    assert call("report", "--publish") == REFUSED
    message = one_line(capfd.readouterr().err)
    stored, total = (int(message.split()[position]) for position in (4, 6))
    assert 0 < total - stored <= 1
    assert message.endswith("crosscheck run --full\n")
    assert {name: (here / "checkout" / name).read_text() for name in texts} == texts
    assert {path.name for path in (here / "crosscheck-results").iterdir()} == {"cells.sqlite"}


def test_nothing_is_published_if_an_engine_of_published_rows_is_not_installed(here, monkeypatch, capfd):
    """Cells of an engine that is not installed do not count as missing, so their published rows would be deleted."""
    texts = checkout(here / "checkout", monkeypatch)
    texts["reports/results/errors.csv"] = as_csv(
        [row(engine=name) for name in ("bullet", "pymunk", "mjx")], timings=False
    )
    (here / "checkout/reports/results/errors.csv").write_text(texts["reports/results/errors.csv"])
    absent = {"bullet": "bullet needs pybullet", "mjx": "mjx needs jax", "exudyn": "it is in no row"}
    monkeypatch.setattr(registry, "ABSENT", absent)
    one_stored(here)
    assert call("report", "--publish") == REFUSED
    message = one_line(capfd.readouterr().err)
    assert "bullet needs pybullet; mjx needs jax" in message
    assert "exudyn" not in message
    assert {name: (here / "checkout" / name).read_text() for name in texts} == texts


def test_only_publish_writes_into_the_checkout(here, monkeypatch):
    """The grid is replaced by one cell, and the pages by one short page."""
    checkout(here / "checkout", monkeypatch)
    cell = Cell(Disc(), Toy(), 1)
    monkeypatch.setattr(catalogue, "PAGES", (PAGE,))
    monkeypatch.setattr(selection, "page_cells", lambda page: (cell,))
    monkeypatch.setattr(
        rendering, "render_all", lambda material, command, further, made: {"index.md": f"made by {command}"}
    )
    monkeypatch.setattr(index, "render_readme", lambda text, material: f"{text}, with a table")
    with Store(here / "crosscheck-results" / "cells.sqlite") as store:
        store.put(measure(cell, repeat=False))
    assert call("report") == FINE
    assert (here / "checkout" / "README.md").read_text() == "a readme"
    assert (here / "checkout/reports/results/index.md").read_text() == "an index"
    assert (here / "crosscheck-results/index.md").read_text() == "made by crosscheck report"
    (here / "crosscheck-results/index.md").unlink()
    assert call("report", "--publish") == FINE
    assert (here / "checkout" / "README.md").read_text() == "a readme, with a table"
    assert (here / "checkout/reports/results/index.md").read_text() == "made by make publish"
    assert not (here / "crosscheck-results/index.md").exists()


def test_all_files_are_replaced_or_none(tmp_path, monkeypatch):
    old = {tmp_path / name: "old" for name in ("a.md", "b.md", "c.md")}
    new = dict.fromkeys(old, "new\n")
    for path, text in old.items():
        path.write_text(text)
    full = OSError(28, "No space left on device")

    def texts():
        return {path: path.read_text() for path in tmp_path.iterdir()}

    for ends, reported in (
        ([None, None, full], pytest.raises(files.FileTrouble, match=r"c\.md can't be written \(No space.*make room")),
        ([KeyboardInterrupt], pytest.raises(KeyboardInterrupt)),
    ):
        with monkeypatch.context() as patched, reported:
            patched.setattr(files.os, "fsync", Mock(side_effect=ends))
            write_whole(new, "make room")
        assert texts() == old
    (tmp_path / "d.md").mkdir()
    with pytest.raises(files.FileTrouble, match=r"d\.md can't be written \(a folder has its name\)"):
        write_whole({**new, tmp_path / "d.md": "new"}, "make room")
    (tmp_path / "d.md").rmdir()
    assert texts() == old
    write_whole(new, "make room")
    assert texts() == new


def test_output_into_a_pipe_does_not_replace_the_pipe(tmp_path, capfd):
    """Otherwise a program with root rights could replace /dev/null by a file."""
    pipe = tmp_path / "a.gif"
    os.mkfifo(pipe)
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_whole({pipe: "new", tmp_path / "page.md": "new"}, "")
        assert os.read(reading, 10) == b"new"
    finally:
        os.close(reading)
    assert call("animate", "sleigh", "--to", "gif", "--force", "--output", str(pipe)) == REFUSED
    assert "is no file" in one_line(capfd.readouterr().err)
    assert pipe.is_fifo()


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (Broken("3 cells are lost"), 1, "crosscheck: 3 cells are lost\n"),
        (files.FileTrouble("two\nlines"), 2, "crosscheck: two lines\n"),
        (BadInput("bad"), 2, "crosscheck: bad\n"),
        (OSError(24, "Too many open files"), 2, "crosscheck: Too many open files\n"),
        (PermissionError(13, "Permission denied", "a.csv"), 2, "crosscheck: a.csv: Permission denied\n"),
        (BrokenPipeError(), UNREAD, ""),
        (KeyboardInterrupt(), INTERRUPTED, ""),
    ],
)
def test_each_exception_has_its_exit_status_and_its_message(error, status, line, monkeypatch, capfd):
    monkeypatch.setattr(commands, "invoke", Mock(side_effect=error))
    assert call("list") == status
    assert capfd.readouterr() == ("", line)


@pytest.mark.parametrize(("words", "part"), tomllib.loads(REFUSALS.read_text(encoding="utf-8"))["refused"])
def test_bad_input_is_refused_in_one_line_and_no_file_is_written(words, part, here, capfd):
    (here / "a.xml").write_text("mine")
    assert call(*shlex.split(words)) == REFUSED
    out, err = capfd.readouterr()
    assert part in one_line(err)
    assert err[:-1].isprintable()
    assert out == ""
    assert [(path.name, path.read_text()) for path in here.iterdir()] == [("a.xml", "mine")]


def ended(words, **streams):
    return subprocess.run([sys.executable, "-m", "reports", *words], env=environment(), text=True, **streams)


def test_a_full_output_device_is_reported_in_one_line_on_stderr():
    if not Path("/dev/full").is_char_device():
        pytest.skip("only Linux has /dev/full")
    with open("/dev/full", "w", encoding="utf-8") as full:
        process = ended(["--help"], stdout=full, stderr=subprocess.PIPE)
        assert process.returncode == REFUSED
        assert "No space left on device" in one_line(process.stderr)
        process = ended(["nonsense"], stdout=subprocess.PIPE, stderr=full)
        assert (process.returncode, process.stdout) == (REFUSED, "")


def test_a_closed_pipe_ends_the_program_without_a_message():
    reading, writing = os.pipe()
    os.close(reading)
    try:
        process = ended(["--help"], stdout=writing, stderr=subprocess.PIPE)
    finally:
        os.close(writing)
    assert (process.returncode, process.stderr) == (UNREAD, "")


def test_the_program_runs_with_closed_standard_streams(tmp_path):
    """A file that is opened with the descriptor of a closed stream would be overwritten by output."""
    text = [sys.executable, "-m", "reports", "run", *ONE_CELL, "--results", str(tmp_path)]
    process = subprocess.run(["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *text], env=environment())
    assert process.returncode == FINE
    with closing(Store(tmp_path / "cells.sqlite")._connection) as connection:
        assert connection.execute("select count(*) from results").fetchone() == (1,)


def test_a_run_in_which_every_cell_failed_has_exit_status_1(here, capfd):
    (here / "mine.py").write_text("from tests.toys import FailingToy, Toy\nBAD, GOOD = FailingToy('raise'), Toy()\n")
    (here / "disc.py").write_text("from tests.toys import Disc\nDISC = Disc()\n")
    assert call("run", "disc.py", "--engine", "mine.py:BAD", "--every", "1") == 1
    assert "none of 1 cells gave a motion" in one_line(capfd.readouterr().err)


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
