"""Tests of `crosscheck search`: storing, printing and reducing results, and the scripts of findings."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from engines import Engine, exudyn, method_name, mjx, mujoco, pymunk
from engines.registry import INSTALLED, VARIANTS
from reports.cli.options import SEARCH, STORE
from reports.model.ending import FINE
from reports.run.store import Store
from reports.search import mujoco_alone, plan, relations
from reports.search.parts import Recipe
from reports.search.scripts import write_script
from reports.search.shrinking import shrink_case
from reports.search.subjects import Adapted, Alone
from tests.reports.test_command_line import call, here

__all__ = ["here"]
FEW = ("search", "--engine", "mujoco", "--variant", "alone", "--kinds", "joint", "--cases", "4", "--workers", "1")
FATAL = '''
import os
from dataclasses import dataclass
from engines.lagrange import Lagrange

@dataclass(frozen=True)
class Fatal(Lagrange):
    """An engine that ends its process for three or more bodies."""

    def build(self, mechanism, dt):
        if len(mechanism.bodies) > 2:
            os.abort()
        return super().build(mechanism, dt)

ENGINE = Fatal("euler", "projection")
'''


def test_findings_are_printed_reduced_written_and_shown_on_the_page(here, capfd):
    assert call(*FEW, "--seed", "1") == FINE
    message = capfd.readouterr().out
    assert "mujoco alone" in message
    assert re.search(r"4 cases were asked in \d+ s\. The first finding came after [\d.]+ s, within 4 cases\.", message)
    # The columns are seed, decades, case and kinds.
    assert re.search(r"mujoco alone │ acceleration, a known fault │ .* │ +1 │ +0 │ +[0-3] │ +joint", message)
    folder = here / "crosscheck-results" / SEARCH
    findings = sorted(folder.glob("*.json"))
    assert findings
    for path in findings:
        finding = json.loads(path.read_text())
        assert finding["error"] > finding["bound"]
        assert "mujoco.mj_forward" in path.with_suffix(".py").read_text()
    stored = (folder / STORE).stat().st_mtime_ns
    assert call(*FEW, "--seed", "1") == FINE
    assert (folder / STORE).stat().st_mtime_ns == stored
    assert call("report") == FINE
    page = (here / "crosscheck-results" / "search.md").read_text()
    assert re.search(r"^\| mujoco alone \| 4 \| 0 \| 4, \*\*\d wrong\*\* \|", page, re.MULTILINE)
    assert "`crosscheck search --engine mujoco --variant alone --seed 1 --kinds joint --cases" in page
    assert "search_errors.svg" in page
    assert (here / "crosscheck-results" / "search_errors.svg").read_text().startswith("<?xml")


def test_a_case_that_ends_its_process_is_a_finding_and_the_other_results_are_stored(here, capfd):
    (here / "fatal.py").write_text(FATAL)
    text = ("search", "--engine", "fatal.py", "--kinds", "pin", "--cases", "4", "--oracles", "relations")
    assert call(*text, "--workers", "1") == FINE
    reported = capfd.readouterr().out
    assert re.search(r"aborted +│ +[1-4] ", reported), reported
    assert "4 cases were asked" in reported
    assert "4 cases are stored" in reported


def test_fresh_seeds_are_drawn_until_the_time_limit_and_stored(here, capfd):
    command = ("--engine", "mujoco", "--variant", "alone", "--cases", "3", "--seconds", "0.1", "--workers", "1")
    assert call("search", "--fresh", *command) == FINE
    assert "cases were asked" in capfd.readouterr().out
    with Store.read(here / "crosscheck-results" / SEARCH / STORE) as store:
        seeds = {json.loads(reference)[1] for reference in store.load_references()}
    assert seeds
    assert not seeds & {*plan.published_seeds()}


def test_published_seeds_depend_on_the_last_commit_or_without_git_on_the_sources(tmp_path, monkeypatch):
    (tmp_path / "reports").mkdir()
    monkeypatch.setattr(plan, "ROOT", tmp_path)
    results = []
    for text in ("a", "b"):
        (tmp_path / "reports" / "source.py").write_text(text)
        plan.seed_origin.cache_clear()
        results.append((plan.seed_origin()[0], plan.published_seeds()))
    (tmp_path / ".git").mkdir()
    git = subprocess.CompletedProcess([], 0, "0123abcd\n")
    monkeypatch.setattr(plan.subprocess, "run", lambda *_, **__: git)
    plan.seed_origin.cache_clear()
    results.append((plan.seed_origin()[0], plan.published_seeds()))
    plan.seed_origin.cache_clear()
    assert [rule for rule, _ in results] == [plan.SOURCES_RULE, plan.SOURCES_RULE, plan.COMMIT_RULE]
    assert len({seeds for _, seeds in results}) == 3
    assert results[2][1][0] == int(hashlib.sha256(b"0123abcd 1").hexdigest()[:8], 16) // 2


def test_the_published_chunks_have_the_published_seeds_and_every_installed_method(monkeypatch):
    monkeypatch.setattr(plan, "supported_kinds", lambda engine: ("pin", "rod", "spring"))  # it builds a thousand models
    chunks = plan.published_chunks()
    assert {chunk.seed for chunk in chunks} == {*plan.published_seeds()}
    assert {chunk.decades for chunk in chunks} == {*plan.SEED_DECADES}
    names = {chunk.subject.name for chunk in chunks}
    assert {method_name(engine) for engine in (*VARIANTS, *INSTALLED)} < names
    assert any("toggle" in chunk.kinds for chunk in chunks)


SEED = 1
ALONE = """
import runpy, sys
for name in ("reports", "engines", "reference"):
    sys.modules[name] = None  # an import of it raises ImportError
runpy.run_path(sys.argv[1], run_name="__main__")
"""


def differences(text: str, folder: Path) -> list[float]:
    path = folder / "finding.py"
    path.write_text(text, encoding="utf-8")
    run = subprocess.run([sys.executable, "-c", ALONE, path], capture_output=True, text=True, check=False, cwd=folder)
    assert run.returncode == 0, run.stderr
    lines = [line for line in run.stdout.splitlines() if line.startswith("largest difference")]
    return [float(line.split()[-1]) for line in lines]


def script_of(engine: Engine, kinds: tuple[str, ...], check: str, number: int) -> str:
    """The script of the first case, from `number` on, that has all these kinds and for which a script can be
    written."""
    if engine.missing:
        pytest.skip(engine.missing)
    texts = (write_script(Adapted(engine), case, check, number) for case in cases_with(engine, kinds, number))
    return next(text for text in texts if text)


def cases_with(engine: Engine, kinds: tuple[str, ...], first: int = 0) -> list[Recipe]:
    """Of twenty cases from `first` on, the cases that have all these kinds."""
    drawn = [Adapted(engine).draw(SEED, number, kinds, 0) for number in range(first, first + 20)]
    return [case for case in drawn if set(kinds) <= set(case.kinds)]


@pytest.mark.parametrize(
    ("engine", "kinds", "falls"),  # `falls`: least factor by which half the step reduces the error
    [
        (pymunk.DEFAULT, ("pin", "spring"), 1.4),
        (mujoco.TUNED, ("pin", "damper"), 4.0),
        pytest.param(mjx.DEFAULT, ("pin",), 1.4, marks=pytest.mark.slow),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_the_difference_that_a_script_prints_falls_with_the_step(engine, kinds, falls, tmp_path):
    coarse, fine = differences(script_of(engine, kinds, "motion", 0), tmp_path)
    assert fine < max(coarse / falls, 1e-9)
    assert coarse < 0.1


def test_a_script_of_a_relation_prints_the_same_error_for_both_descriptions(tmp_path):
    text = script_of(mujoco.TUNED, ("pin", "force"), "turned", relations.RELATIONS.index("turned"))
    assert "original" in text
    assert "turned: 5 steps" in text
    first, second = differences(text, tmp_path)
    assert second == pytest.approx(first, rel=1e-3, abs=1e-12)


@pytest.mark.parametrize(
    ("engine", "kinds", "check"),
    [
        (pymunk.LEAPFROG, ("pin", "slot"), "velocity"),
        (mujoco.TUNED, ("pin", "weld", "spring", "torque"), "acceleration"),
        pytest.param(mjx.TUNED, ("pin", "force"), "without velocity terms", marks=pytest.mark.slow),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_a_script_of_a_case_without_a_fault_prints_a_difference_at_rounding(engine, kinds, check, tmp_path):
    assert max(differences(script_of(engine, kinds, check, 3), tmp_path)) < 1e-9


def test_a_method_with_our_code_in_every_step_and_an_engine_without_scripts_give_an_empty_script():
    for engine, kinds in ((mujoco.EXTENDED, ("pin", "skate")), (exudyn.TUNED, ("pin",))):
        assert write_script(Adapted(engine), cases_with(engine, kinds)[0], "motion", 0) == ""


def test_the_missing_velocity_term_of_curved_equalities_is_found_reduced_and_written_as_a_script(tmp_path):
    """MuJoCo up to 4.0.1 omits the velocity term. The reduced model has one equality and at most two bodies."""
    subject = Alone()
    models = ((n, mujoco_alone.draw_model(SEED, n, ("joint",))) for n in range(20))
    number, case = next((n, model) for n, model in models if subject.ask(model, n, ("instant",)).faults)

    def still(smaller: mujoco_alone.RawModel) -> bool:
        try:
            return bool(subject.ask(smaller, number, ("instant",)).faults)
        except ValueError:
            return False

    small = shrink_case(case, still, 20.0)
    assert len(small.parts) <= 2
    assert len(small.links) == 1
    assert sum(abs(value) for part in small.parts for value in (*part.offset, *part.centre, part.mass)) <= 1
    assert differences(write_script(subject, small, "acceleration", number), tmp_path)[0] > 1e-4
