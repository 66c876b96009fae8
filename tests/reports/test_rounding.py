"""What rounding or noise alone moves is no change and published as it was; what a wrong model changes is one."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from engines import method_name, mujoco
from engines.lagrange import Lagrange
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.wheels.cart import Cart
from reports.gate.change import Old, change
from reports.gate.theory import cases
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.ending import BadInput
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.quantities import OF, QUANTITIES, agrees, quantity
from reports.write.csv_files import ERRORS, IDENTITY, NOISE, Published, as_csv, as_published, kept, read_published
from reports.write.csv_files import told as cell_text
from reports.write.provenance import machine
from tests import ROOT
from tests.rows import ROW
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


def test_the_numbers_that_two_processors_give_agree_whichever_is_the_baseline():
    assert {line["quantity"] for line in told()} == {*NAMES}
    for line in told():
        name, carried = line["quantity"], amplified()[line["scene"], line["method"]]
        one, other = float(line["one"]), float(line["other"])
        assert agrees(name, one, other, carried), line
        assert agrees(name, other, one, carried), line


# An engine in C, and one of ours with wheels.
CELLS = (Cell(DrivenFourBar(), mujoco.EXTENDED, 10), Cell(Cart(), Lagrange("dop853", "projection"), 3))
# On x86-64 they leave out the newer instructions of OpenBLAS and of the C library; elsewhere they change nothing.
OLDER = {"OPENBLAS_CORETYPE": "Prescott", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F"}
PROGRAM = """
import json
from reports.model.measure import measure
from tests.reports.test_rounding import CELLS
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
    carried = amplified()[cell.scene.name, method_name(cell.engine)]
    for one, other in ((here, there), (there, here)):
        assert [str(check) for check in change(one, known(other), amplified=carried) if not check.passed] == []
    length = next(mistake for mistake in mistakes(cell.scene.mechanism()) if mistake.kind == "length")
    wrong = measure(Cell(cell.scene, mistaken(cell.engine, length, 1e-4), cell.every), repeat=False)
    assert not all(check.passed for check in change(wrong, known(there), amplified=carried))


@pytest.fixture
def before(tmp_path: Path) -> dict[str, str]:
    """The published texts of a row."""
    (tmp_path / "errors.csv").write_text(as_csv([ROW], timings=False))
    (tmp_path / "timings.csv").write_text(as_csv([ROW], timings=True, header=f"a date\n{machine()}"))
    found = read_published(tmp_path)
    assert (found.machine, found.engines) == (machine(), ("toy",))
    (texts,) = found.rows.values()
    return dict(texts)


@pytest.mark.parametrize("name", ERRORS)
def test_an_error_keeps_its_text_within_rounding_alone(name, before):
    published, rounding = getattr(ROW, name), quantity(OF.get(name, name)).rounding
    assert getattr(kept(replace(ROW, **{name: published + 0.9 * rounding}), before, True), name) == published
    changed = getattr(kept(replace(ROW, **{name: published * 1.0123456}), before, True), name)
    assert changed == float(f"{published * 1.0123456:.4g}") != published


@pytest.mark.parametrize(("name", "noise"), NOISE.items())
def test_a_time_is_kept_within_noise_and_on_the_same_machine(name, noise, before):
    published = getattr(ROW, name)
    within, beyond = (replace(ROW, **{name: published * factor}) for factor in (0.99 * noise, 1.01 * noise))
    for where, same in ((machine(), True), ("another machine", False)):
        of_run = Published({tuple(cell_text(ROW, column) for column in IDENTITY): before}, where)
        assert (getattr(as_published({CELLS[0]: within}, of_run)[CELLS[0]], name) == published) == same
    assert getattr(kept(beyond, before, True), name) != published


def test_nothing_is_kept_of_another_outcome_or_of_a_row_that_is_new(before):
    moved = replace(ROW, position=ROW.position * (1 + 1e-12), cpu=1.01 * ROW.cpu)
    torn = kept(replace(moved, outcome=Outcome.TORN), before, True)
    assert torn.cpu == kept(moved, {}, True).cpu == float(f"{1.01 * ROW.cpu:.4g}")
    assert torn.outcome == Outcome.TORN


def test_a_file_that_is_no_table_of_rows_is_named(tmp_path):
    (tmp_path / "errors.csv").write_text("scene,engine\na,b\n")
    with pytest.raises(BadInput, match=r"errors\.csv has no column 'variant'"):
        read_published(tmp_path)
    assert not read_published(tmp_path / "nowhere").rows
