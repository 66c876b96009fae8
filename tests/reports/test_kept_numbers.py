"""What is published again keeps its text where nothing but rounding or noise differs, and pages with it."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from pathlib import Path

import pytest

from reports.model.ending import BadInput
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import OF, quantity
from reports.pages.four_bar.page import PAGE
from reports.write import kept_numbers
from reports.write.csv_files import as_csv
from reports.write.kept_numbers import ERRORS, NOISE, as_published, kept
from reports.write.provenance import machine
from tests.committed_rows import RESULTS, page_rows
from tests.rows import ROW


@pytest.fixture
def before(tmp_path: Path) -> dict[str, str]:
    """The published texts of a row."""
    (tmp_path / "errors.csv").write_text(as_csv([ROW], timings=False))
    (tmp_path / "timings.csv").write_text(as_csv([ROW], timings=True, header=f"a date\n{machine()}"))
    found = kept_numbers.read(tmp_path)
    assert (found.machine, found.engines) == (machine(), ("toy",))
    (texts,) = found.rows.values()
    return dict(texts)


def test_every_number_of_a_row_is_an_error_or_a_time():
    numbers = {field.name for field in fields(Measurement) if str(field.type) == "float"}
    assert numbers - {"step", "limit"} == {*ERRORS, *NOISE}


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
    assert getattr(kept(within, before, True), name) == published
    assert getattr(kept(within, before, False), name) != published
    assert getattr(kept(beyond, before, True), name) != published


def test_how_often_a_time_was_taken_goes_with_it(before):
    again = replace(ROW, runs=7)
    assert kept(again, before, True).runs == ROW.runs
    assert kept(replace(again, cpu=2 * ROW.cpu), before, True).runs == 7


def test_nothing_is_kept_of_another_outcome_or_of_a_row_that_is_new(before):
    moved = replace(ROW, position=ROW.position * (1 + 1e-12), cpu=1.01 * ROW.cpu)
    torn = kept(replace(moved, outcome=Outcome.TORN), before, True)
    assert torn.cpu == kept(moved, {}, True).cpu == float(f"{1.01 * ROW.cpu:.4g}")
    assert torn.outcome == Outcome.TORN


def test_no_number_becomes_a_number_and_the_other_way_round(before):
    assert math.isnan(kept(replace(ROW, gap=math.nan), before, True).gap)
    assert kept(ROW, {**before, "gap": "nan"}, True).gap == ROW.gap


def test_published_rows_that_rounding_has_moved_are_published_as_they_were():
    rows = dict(list(page_rows(PAGE).items())[::20])
    published = kept_numbers.read(RESULTS)
    moved = {cell: replace(row, angle=row.angle + 1e-12, rate=row.rate * (1 + 1e-13)) for cell, row in rows.items()}
    assert len(rows) > 10
    found = as_published(moved, published)
    assert as_csv(found.values(), timings=False) == as_csv(rows.values(), timings=False)


def test_a_file_that_is_no_table_of_rows_is_named(tmp_path):
    (tmp_path / "errors.csv").write_text("scene,engine\na,b\n")
    with pytest.raises(BadInput, match=r"errors\.csv has no column 'variant'"):
        kept_numbers.read(tmp_path)
    assert not kept_numbers.read(tmp_path / "nowhere").rows
