"""`crosscheck search` from beginning to end: stored as it arrives, asked once, told, made small, written."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from reports.cli.options import SEARCH, STORE
from reports.model.ending import FINE, REFUSED
from tests.reports.test_command_line import call, one_line

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


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_findings_are_told_made_small_and_written_and_the_page_shows_them(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert call(*FEW) == FINE
    said = capfd.readouterr().out
    assert "mujoco alone" in said
    folder = here / "crosscheck-results" / SEARCH
    findings = sorted(folder.glob("*.json"))
    assert findings
    for path in findings:
        finding = json.loads(path.read_text())
        assert finding["error"] > finding["bound"]
        assert "mujoco.mj_forward" in path.with_suffix(".py").read_text()
    stored = (folder / STORE).stat().st_mtime_ns
    assert call(*FEW) == FINE  # everything is stored: nothing is asked again
    assert (folder / STORE).stat().st_mtime_ns == stored
    assert call("report") == FINE
    page = (here / "crosscheck-results" / "search.md").read_text()
    assert "| mujoco alone | joint | 1 | 4 |" in page
    assert "mujoco.MjModel.from_xml_string" in page
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
    assert "4 cases are stored" in told


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (("--seconds", "-1"), "--seconds"),
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
