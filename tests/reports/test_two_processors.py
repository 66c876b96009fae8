"""What another processor rounds otherwise is no change, and what a wrong model changes is one there too."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reference.scenes.wheels.cart import Cart
from reports.gate.change import Old, change
from reports.gate.theory import cases
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES, agrees
from tests import ROOT
from tests.wrong.mistakes import mistaken, mistakes

NAMES = tuple(quantity.name for quantity in QUANTITIES)


@cache
def told() -> list[dict[str, str]]:
    """Numbers that two processors gave; the file says which."""
    text = Path(__file__).with_name("two_processors.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


@cache
def amplified() -> dict[tuple[str, str], float]:
    return {(case.scene.name, case.method): case.amplified for case in cases(PAGES)}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("now", "before"), [("one", "other"), ("other", "one")])
def test_the_numbers_that_two_processors_give_agree_whichever_is_the_baseline(name, now, before):
    found = [line for line in told() if line["quantity"] == name]
    assert found
    for line in found:
        carried = amplified()[line["scene"], line["method"]]
        assert agrees(name, float(line[now]), float(line[before]), carried), line


# What lagrange, an engine in C and one in C++ do with a prescribed loop, a spring of a loop, and wheels.
CELLS = (
    Cell(DrivenSliderCrank(), Lagrange("rk4", "projection"), 3),
    Cell(DrivenFourBar(), pymunk.TUNED, 3),
    Cell(DrivenFourBar(), mujoco.EXTENDED, 10),
    Cell(Cart(), Lagrange("dop853", "projection"), 3),
)
# On x86-64 they leave out the newer instructions of OpenBLAS and of the C library; elsewhere they change nothing.
OLDER = {"OPENBLAS_CORETYPE": "Prescott", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F"}
PROGRAM = """
import json
from reports.model.measure import measure
from tests.reports.test_two_processors import CELLS
print(json.dumps([measure(cell, repeat=False).as_dict() for cell in CELLS]))
"""


@pytest.fixture(scope="module")
def elsewhere() -> list[Measurement]:
    """The rows of CELLS on an older processor."""
    made = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=ROOT,
        env={**os.environ, **OLDER},
        capture_output=True,
        text=True,
        check=True,
    )
    return [Measurement(**fields) for fields in json.loads(made.stdout.splitlines()[-1])]


def known(row: Measurement) -> Old:
    errors = {name: float(f"{getattr(row, name):.4g}") for name in NAMES}  # as a file has them
    return Old(Outcome(row.outcome), errors, row.reaction_rows)


@pytest.mark.parametrize("number", range(len(CELLS)), ids=lambda number: CELLS[number].label)
def test_an_older_processor_gives_the_same_rows_and_a_wrong_model_is_seen_there_too(elsewhere, number):
    cell, there = CELLS[number], elsewhere[number]
    here = measure(cell, repeat=False)
    carried = amplified()[cell.scene.name, f"{cell.engine.name} {cell.engine.variant}"]
    for one, other in ((here, there), (there, here)):
        assert [str(check) for check in change(one, known(other), amplified=carried) if not check.passed] == []
    length = next(mistake for mistake in mistakes(cell.scene.mechanism()) if mistake.kind == "length")
    wrong = measure(Cell(cell.scene, mistaken(cell.engine, length, 1e-4), cell.every), repeat=False)
    assert not all(check.passed for check in change(wrong, known(there), amplified=carried))
