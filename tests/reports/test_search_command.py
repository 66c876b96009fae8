"""`crosscheck search` from beginning to end: stored as it arrives, asked once, told, made small, written."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from engines import method_name
from engines.registry import INSTALLED, VARIANTS
from reports.cli.options import SEARCH, STORE
from reports.model.ending import FINE, REFUSED
from reports.run.store import Store
from reports.search import plan
from tests.reports.test_command_line import call, here, one_line

__all__ = ["here"]
FEW = ("search", "--engine", "mujoco", "--variant", "alone", "--kinds", "joint", "--cases", "4", "--workers", "1")
FATAL = '''
import os
from dataclasses import dataclass
from engines.lagrange import Lagrange

@dataclass(frozen=True)
class Fatal(Lagrange):
    """Ends its process where three bodies or more hang together."""

    def build(self, mechanism, dt):
        if len(mechanism.bodies) > 2:
            os.abort()
        return super().build(mechanism, dt)

ENGINE = Fatal("euler", "projection")
'''


def test_findings_are_told_made_small_and_written_and_the_page_shows_them(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert call(*FEW, "--seed", "1") == FINE
    said = capfd.readouterr().out
    assert "mujoco alone" in said
    assert re.search(r"4 cases were asked in \d+ s\. The first finding came after [\d.]+ s, within 4 cases\.", said)
    assert re.search(
        r"mujoco alone │ acceleration, a known fault │ .* │ +1 │ +0 │ +[0-3] │ +joint", said
    )  # what draws a finding again
    folder = here / "crosscheck-results" / SEARCH
    findings = sorted(folder.glob("*.json"))
    assert findings
    for path in findings:
        finding = json.loads(path.read_text())
        assert finding["error"] > finding["bound"]
        assert "mujoco.mj_forward" in path.with_suffix(".py").read_text()
    stored = (folder / STORE).stat().st_mtime_ns
    assert call(*FEW, "--seed", "1") == FINE  # everything is stored: nothing is asked again
    assert (folder / STORE).stat().st_mtime_ns == stored
    assert call("report") == FINE
    page = (here / "crosscheck-results" / "search.md").read_text()
    assert re.search(r"^\| mujoco alone \| 4 \| 0 \| 4, \*\*\d wrong\*\* \|", page, re.MULTILINE)
    assert "`crosscheck search --engine mujoco --variant alone --seed 1 --kinds joint --cases" in page
    assert "search_errors.svg" in page
    assert (here / "crosscheck-results" / "search_errors.svg").read_text().startswith("<?xml")


def test_a_case_that_ends_its_process_is_found_and_the_others_are_kept(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (here / "fatal.py").write_text(FATAL)
    words = ("search", "--engine", "fatal.py", "--kinds", "pin", "--cases", "4", "--oracles", "relations")
    assert call(*words, "--workers", "1") == FINE
    told = capfd.readouterr().out
    assert re.search(r"aborted +│ +[1-4] ", told), told
    assert "4 cases were asked" in told
    assert "4 cases are stored" in told


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (("--seconds", "-1"), "--seconds"),
        (("--fresh",), "--seconds"),
        (("--fresh", "--seconds", "5", "--seed", "3"), "--seed"),
        (("--kinds", "pin,glue"), "--kinds"),
        (("--oracles", "tea"), "--oracles"),
        (("--engine", "havok"), "havok"),
        (("--release", "3.6.0", "--engine", "pymunk"), "--release"),
        (("--release", "latest"), "latest"),
    ],
)
def test_wrong_values_are_refused_in_a_line(
    words: tuple[str, ...], names: str, here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert call("search", "--cases", "1", *words) == REFUSED
    assert names in one_line(capfd.readouterr().err)
    assert not (here / "crosscheck-results").exists()


def test_fresh_seeds_are_drawn_until_the_time_is_over_and_told(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    words = ("--engine", "mujoco", "--variant", "alone", "--cases", "3", "--seconds", "0.1", "--workers", "1")
    assert call("search", "--fresh", *words) == FINE
    assert "cases were asked" in capfd.readouterr().out
    with Store.read(here / "crosscheck-results" / SEARCH / STORE) as store:
        seeds = {json.loads(words)[1] for words in store.remembered()}
    assert seeds
    assert not seeds & {*plan.seeds()}


def test_seeds_are_those_of_the_last_commit_and_without_git_of_the_sources(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    for name in [name for name in os.environ if name.startswith("GIT_")]:  # of a hook of git's that runs the tests
        monkeypatch.delenv(name)
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", os.devnull)  # a user's may ask for signatures
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "-C", str(tmp_path)]
    monkeypatch.setattr(plan, "ROOT", tmp_path)
    (tmp_path / "reports").mkdir()
    origins, seeds = [], []
    for made in (None, "init", "commit"):
        if made:
            subprocess.run(
                [*git, *{"init": ["init", "-q"], "commit": ["commit", "-q", "--allow-empty", "-mx"]}[made]], check=True
            )
        (tmp_path / "reports" / "source.py").write_text(f"{made}\n")
        plan.origin.cache_clear()
        origins.append(plan.origin())
        seeds.append(plan.seeds())
    plan.origin.cache_clear()
    assert [rule for rule, _ in origins] == [plan.SOURCES, plan.SOURCES, plan.COMMIT]
    assert len({*seeds}) == 3
    head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    assert origins[2][1] == head
    assert seeds[2][0] == int(hashlib.sha256(f"{head} 1".encode()).hexdigest()[:8], 16) // 2


def test_what_is_published_is_drawn_from_seeds_that_nobody_chose() -> None:
    pieces = plan.published()
    assert {piece.seed for piece in pieces} == {*plan.seeds()}
    assert {piece.decades for piece in pieces} == {*plan.DECADES}
    names = {piece.subject.name for piece in pieces}
    assert {method_name(engine) for engine in (*VARIANTS, *INSTALLED)} < names
    assert any("toggle" in piece.kinds for piece in pieces)
