"""Numbers that differ only by rounding or timing noise keep their published text."""

from __future__ import annotations

import csv
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from reports.gate.theory import cases
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.ending import BadInput
from reports.model.outcomes import Outcome
from reports.model.quantities import OF, QUANTITIES, agrees, quantity
from reports.write import csv_files
from reports.write.provenance import machine
from tests.rows import ROW
from tests.toys import Disc, Toy

NAMES = tuple(quantity.name for quantity in QUANTITIES)
CELL = Cell(Disc(), Toy(), 1)


@cache
def numbers_of_two_processors() -> list[dict[str, str]]:
    text = Path(__file__).with_name("two_processors.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


@cache
def amplified() -> dict[tuple[str, str], float]:
    return {(case.scene.name, case.method): case.amplified for case in cases(PAGES)}


def test_the_numbers_of_two_processors_agree_with_either_as_the_baseline():
    assert {line["quantity"] for line in numbers_of_two_processors()} == {*NAMES}
    for line in numbers_of_two_processors():
        name, factor = line["quantity"], amplified()[line["scene"], line["method"]]
        first, second = float(line["one"]), float(line["other"])
        assert agrees(name, first, second, factor), line
        assert agrees(name, second, first, factor), line


@pytest.fixture
def before(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "errors.csv").write_text(csv_files.as_csv([ROW], timings=False))
    (tmp_path / "timings.csv").write_text(csv_files.as_csv([ROW], timings=True, header=f"a date\n{machine()}"))
    published = csv_files.read_published(tmp_path)
    assert (published.machine, published.engines) == (machine(), ("toy",))
    (texts,) = published.rows.values()
    return dict(texts)


@pytest.mark.parametrize("name", csv_files.ERROR_COLUMNS)
def test_an_error_keeps_its_published_text_only_within_rounding(name, before):
    published, rounding = getattr(ROW, name), quantity(OF.get(name, name)).rounding
    assert (
        getattr(
            csv_files.with_published_numbers(replace(ROW, **{name: published + 0.9 * rounding}), before, True), name
        )
        == published
    )
    changed = getattr(
        csv_files.with_published_numbers(replace(ROW, **{name: published * 1.0123456}), before, True), name
    )
    assert changed == float(f"{published * 1.0123456:.4g}") != published


@pytest.mark.parametrize(("name", "noise"), csv_files.TIMING_NOISE.items())
def test_a_time_is_kept_within_noise_and_on_the_same_machine(name, noise, before):
    published = getattr(ROW, name)
    within, beyond = (replace(ROW, **{name: published * factor}) for factor in (0.99 * noise, 1.01 * noise))
    for where, same in ((machine(), True), ("another machine", False)):
        of_run = csv_files.Published(
            {tuple(csv_files.cell_text(ROW, column) for column in csv_files.IDENTITY_COLUMNS): before}, where
        )
        assert (getattr(csv_files.as_published({CELL: within}, of_run)[CELL], name) == published) == same
    assert getattr(csv_files.with_published_numbers(beyond, before, True), name) != published


def test_a_new_row_or_a_changed_outcome_does_not_get_published_numbers(before):
    moved = replace(ROW, position=ROW.position * (1 + 1e-12), cpu=1.01 * ROW.cpu)
    torn = csv_files.with_published_numbers(replace(moved, outcome=Outcome.TORN), before, True)
    assert torn.cpu == csv_files.with_published_numbers(moved, {}, True).cpu == float(f"{1.01 * ROW.cpu:.4g}")
    assert torn.outcome == Outcome.TORN


def test_a_file_without_the_columns_of_rows_is_refused_by_name(tmp_path):
    (tmp_path / "errors.csv").write_text("scene,engine\na,b\n")
    with pytest.raises(BadInput, match=r"errors\.csv has no column 'variant'"):
        csv_files.read_published(tmp_path)
    assert not csv_files.read_published(tmp_path / "nowhere").rows
