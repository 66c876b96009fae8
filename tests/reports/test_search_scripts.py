"""Findings as scripts: each is run as it is printed, in a process that can't import this suite."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engines import Engine, box2d, bullet, exudyn, mjx, mujoco, pinocchio, pymunk
from engines.lagrange import TRUTH, Lagrange
from reference.rolling.roll import Roll
from reports.search import instant_mujoco, mechanisms, motion_bounds, relations
from reports.search.independent import Motion
from reports.search.mechanisms import mechanism
from reports.search.parts import EVERY
from reports.search.recipe import build
from reports.search.scripts import script
from reports.search.subjects import Adapted

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
    told = subprocess.run([sys.executable, "-c", ALONE, path], capture_output=True, text=True, check=False, cwd=folder)
    assert told.returncode == 0, told.stderr
    lines = [line for line in told.stdout.splitlines() if line.startswith("largest difference")]
    return [float(line.split()[-1]) for line in lines]


def told_by(engine: Engine, kinds: tuple[str, ...], check: str, number: int) -> str:
    """The script of the first case from `number` on that can be shown."""
    subject = Adapted(engine)
    cases = (subject.draw(SEED, each, kinds, 0) for each in range(number, number + 20))
    return next(
        text for case in cases if set(kinds) <= set(case.kinds) and (text := script(subject, case, check, number))
    )


ENGINES: list[tuple[Engine, tuple[str, ...], float]] = [
    # with how much the error falls at least with half the step: its order, and a half for what is not yet asymptotic
    (exudyn.EXTENDED, ("pin", "rod", "spring"), 3.0),
    (exudyn.DEFAULT, ("pin", "slot", "force"), 3.0),
    (box2d.DEFAULT, ("pin", "spring"), 1.4),
    (bullet.DEFAULT, ("pin", "spring"), 1.4),
    (pymunk.DEFAULT, ("pin", "spring"), 1.4),
    (mujoco.TUNED, ("pin", "damper"), 4.0),
    (mjx.DEFAULT, ("pin",), 1.4),
    (Lagrange("euler", "projection"), ("pin", "slot", "spring"), 1.4),
    (Lagrange("rk4", "projection"), ("pin", "roll", "torsion-spring"), 8.0),
]


@pytest.mark.parametrize(("engine", "kinds", "falls"), ENGINES, ids=lambda value: getattr(value, "name", None))
def test_a_script_shows_an_engines_error_without_the_suite(
    engine: Engine, kinds: tuple[str, ...], falls: float, tmp_path: Path
) -> None:
    """At two steps; with smaller ones a right engine comes nearer to what an independent calculation gives."""
    if engine.missing:
        pytest.skip(engine.missing)
    coarse, fine = differences(told_by(engine, kinds, "motion", 0), tmp_path)
    assert fine < max(coarse / falls, 1e-9)
    assert coarse < 0.1


def test_a_script_for_pinocchio_prints_the_accelerations_of_the_law(tmp_path: Path) -> None:
    if pinocchio.TUNED.missing:
        pytest.skip(pinocchio.TUNED.missing)
    assert max(differences(told_by(pinocchio.TUNED, ("pin", "spring"), "motion", 0), tmp_path)) < 1e-9


def test_a_script_for_box2d_prints_the_velocities_that_its_joints_declare(tmp_path: Path) -> None:
    if box2d.DEFAULT.missing:
        pytest.skip(box2d.DEFAULT.missing)
    assert max(differences(told_by(box2d.DEFAULT, ("pin",), "velocity", 0), tmp_path)) < 1e-4  # of single precision


@pytest.mark.parametrize("engine", [exudyn.TUNED, mujoco.TUNED, Lagrange("rk4", "projection")], ids=lambda e: e.name)
def test_a_script_of_two_descriptions_shows_both(engine: Engine, tmp_path: Path) -> None:
    if engine.missing:
        pytest.skip(engine.missing)
    number = relations.NAMES.index("turned")
    text = told_by(engine, ("pin", "force"), "turned", number)
    assert "as it is" in text
    assert "turned: 5 steps" in text
    first, second = differences(text, tmp_path)
    assert second == pytest.approx(first, rel=1e-3, abs=1e-12)  # a right engine's error is the same in both


def test_a_script_prints_what_the_adapter_gives(tmp_path: Path) -> None:
    """The recorded calls are all that matters: the error is the adapter's own, to rounding."""
    engine = exudyn.TUNED
    if engine.missing:
        pytest.skip(engine.missing)
    subject = Adapted(engine)
    case = subject.draw(SEED, 3, ("pin", "slot", "weld", "drive", "damper"), 0)
    drawn, steps = build(case), motion_bounds.SAMPLES * motion_bounds.COARSE
    dt = motion_bounds.SPAN * drawn.time_scale / steps
    own = np.abs(engine.build(drawn, dt)(1, steps).pose[-1] - TRUTH.build(drawn, steps * dt)(1, 1).pose[-1]).max()
    assert differences(script(subject, case, "motion", 0), tmp_path)[0] == pytest.approx(own, rel=1e-6, abs=1e-13)


def test_a_script_for_pymunk_prints_what_the_joints_ask_for(tmp_path: Path) -> None:
    text = told_by(pymunk.LEAPFROG, ("pin", "slot"), "velocity", 3)
    assert differences(text, tmp_path)[0] < 1e-9  # a right case: expected is what is found


@pytest.mark.parametrize("engine", [mujoco.TUNED, mjx.TUNED], ids=lambda engine: engine.name)
def test_a_script_for_mujoco_and_mjx_prints_what_its_law_asks_for(engine: Any, tmp_path: Path) -> None:
    if engine.missing:
        pytest.skip(engine.missing)
    drawn = (Adapted(mujoco.TUNED).draw(SEED, number, ("pin", "weld", "spring", "torque"), 0) for number in range(20))
    # A tree: MJX leaves out the velocity term of loops.
    case = next(case for case in drawn if case.kinds[0] == "pin" and build(case).row_count <= 2 * len(case.parts))
    told = differences(script(Adapted(engine), case, "acceleration", 0), tmp_path)
    assert len(told) == 2  # at the start, and five steps later
    assert max(told) < 1e-9


@pytest.mark.slow
def test_a_script_for_mjx_shows_a_loops_missing_velocity_term_where_it_is_asked_for(tmp_path: Path) -> None:
    if mjx.DEFAULT.missing:
        pytest.skip(mjx.DEFAULT.missing)
    case = mechanisms.of_a_shape(mjx.DEFAULT, 456270850, 1, ("pin", "spring", "torsion-spring"), 0)
    told = {
        check: max(differences(script(Adapted(mjx.DEFAULT), case, check, 1), tmp_path))
        for check in ("acceleration", instant_mujoco.WITHOUT)
    }
    assert told[instant_mujoco.WITHOUT] < 1e-9 < 1e-3 * told["acceleration"]


def test_where_our_code_takes_part_in_every_step_there_is_no_script() -> None:
    subject = Adapted(mujoco.EXTENDED)
    cases = (subject.draw(SEED, number, ("pin", "skate"), 0) for number in range(20))
    case = next(each for each in cases if "skate" in each.kinds)
    assert script(subject, case, "motion", 0) == ""


@pytest.mark.parametrize("kinds", [EVERY, ("pin", "roll"), ("pin", "slot", "skate", "drive")])
def test_what_scripts_carry_along_agrees_with_the_judge(kinds: tuple[str, ...]) -> None:
    """Two calculations that share no code: without loops of stiff dampers both keep ten digits."""
    apart = []
    for number in range(12):
        drawn = mechanism(11, number, kinds)
        span = 0.1 * drawn.time_scale
        truth = TRUTH.build(drawn, span)(1, 1).pose[-1]
        rolls = [joint for joint in drawn.joints if isinstance(joint, Roll)]
        tangents = {roll.name: float(roll.rolling.ground.angle(roll.rolling.ground_arc)) for roll in rolls}
        found = Motion(drawn.bodies, drawn.joints, drawn.gravity, drawn.forces, tangents).after(span)
        apart.append(np.abs(found - truth).max() / max(np.abs(truth - drawn.pose).max(), 1e-9))
    assert max(apart) < 1e-10
