"""Findings are made small and written as scripts: each is run in a process that can't import this suite."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from engines import Engine, exudyn, mjx, mujoco, pymunk
from reports.search import mujoco_alone, relations
from reports.search.scripts import script
from reports.search.shrinking import shrunk
from reports.search.subjects import Adapted, Alone

SEED = 1
ALONE = """
import runpy, sys
for name in ("reports", "engines", "reference"):
    sys.modules[name] = None  # an import of it raises ImportError
runpy.run_path(sys.argv[1], run_name="__main__")
"""


def differences(text: str, folder: Path) -> list[float]:
    """What a script prints of itself, in order."""
    path = folder / "finding.py"
    path.write_text(text, encoding="utf-8")
    run = subprocess.run([sys.executable, "-c", ALONE, path], capture_output=True, text=True, check=False, cwd=folder)
    assert run.returncode == 0, run.stderr
    lines = [line for line in run.stdout.splitlines() if line.startswith("largest difference")]
    return [float(line.split()[-1]) for line in lines]


def script_of(engine: Engine, kinds: tuple[str, ...], check: str, number: int) -> str:
    """The script of the first case from `number` on that can be shown."""
    if engine.missing:
        pytest.skip(engine.missing)
    subject = Adapted(engine)
    cases = (subject.draw(SEED, each, kinds, 0) for each in range(number, number + 20))
    return next(
        text for case in cases if set(kinds) <= set(case.kinds) and (text := script(subject, case, check, number))
    )


@pytest.mark.parametrize(
    ("engine", "kinds", "falls"),  # by how much the error falls at least with half the step
    [
        (pymunk.DEFAULT, ("pin", "spring"), 1.4),
        (mujoco.TUNED, ("pin", "damper"), 4.0),
        pytest.param(mjx.DEFAULT, ("pin",), 1.4, marks=pytest.mark.slow),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_a_script_shows_an_engines_error_without_the_suite(
    engine: Engine, kinds: tuple[str, ...], falls: float, tmp_path: Path
) -> None:
    """At two steps; with smaller ones a right engine comes nearer to what an independent calculation gives."""
    coarse, fine = differences(script_of(engine, kinds, "motion", 0), tmp_path)
    assert fine < max(coarse / falls, 1e-9)
    assert coarse < 0.1


def test_a_script_of_two_descriptions_shows_both(tmp_path: Path) -> None:
    text = script_of(mujoco.TUNED, ("pin", "force"), "turned", relations.NAMES.index("turned"))
    assert "as it is" in text
    assert "turned: 5 steps" in text
    first, second = differences(text, tmp_path)
    assert second == pytest.approx(first, rel=1e-3, abs=1e-12)  # a right engine's error is the same in both


@pytest.mark.parametrize(
    ("engine", "kinds", "check", "most"),
    [
        (pymunk.LEAPFROG, ("pin", "slot"), "velocity", 1e-9),
        (mujoco.TUNED, ("pin", "weld", "spring", "torque"), "acceleration", 1e-9),
        pytest.param(mjx.TUNED, ("pin", "force"), "without velocity terms", 1e-9, marks=pytest.mark.slow),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_a_script_of_a_right_case_prints_what_the_law_asks_for(
    engine: Engine, kinds: tuple[str, ...], check: str, most: float, tmp_path: Path
) -> None:
    assert max(differences(script_of(engine, kinds, check, 3), tmp_path)) < most


def test_where_our_code_takes_part_in_every_step_there_is_no_script_nor_of_other_engines() -> None:
    for engine, kinds in ((mujoco.EXTENDED, ("pin", "skate")), (exudyn.TUNED, ("pin",))):
        subject = Adapted(engine)
        cases = (subject.draw(SEED, number, kinds, 0) for number in range(20))
        assert script(subject, next(case for case in cases if set(kinds) <= set(case.kinds)), "motion", 0) == ""


def test_curved_equalities_without_their_velocity_term_are_found_made_small_and_written_as_a_script(
    tmp_path: Path,
) -> None:
    """MuJoCo up to 4.0.1: polycoef beyond the slope. One body is left, and the script shows it without our code."""
    subject = Alone()
    models = ((n, mujoco_alone.model(SEED, n, ("joint",))) for n in range(20))
    number, case = next((n, model) for n, model in models if subject.ask(model, n, ("instant",)).faults)

    def still(smaller: mujoco_alone.Model) -> bool:
        try:
            return bool(subject.ask(smaller, number, ("instant",)).faults)
        except ValueError:
            return False

    small = shrunk(case, still, 20.0)
    assert len(small.links) <= 2
    assert len(small.equalities) == 1
    assert sum(abs(value) for link in small.links for value in (*link.offset, *link.centre, link.mass)) <= 1
    assert differences(script(subject, small, "acceleration", number), tmp_path)[0] > 1e-4  # of about 0.01
