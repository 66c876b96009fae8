"""Every table and CSV file from rows by hand: each column takes its own field; and what is printed of versions."""

from __future__ import annotations

import csv
import hashlib
import math
import os
import platform
from dataclasses import fields
from importlib import metadata

import pytest

from engines.lagrange import loading
from reports.model.convergence import Sweep, Verdict
from reports.model.measure import TIMINGS, Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity
from reports.pages.index import foot
from reports.write import csv_files, provenance, tables
from reports.write.provenance import machine, still_installed, versions
from tests.rows import falling, row, row_of, table

NAN = math.nan


@pytest.mark.parametrize(
    ("value", "text", "digits"),
    [
        (0.0, "0", 2),
        (1.234e-7, "1.2e-7", 2),
        (0.01, "0.01", 2),
        (0.00999, "0.01", 2),
        (99.6, "100", 2),
        (100.0, "100", 2),
        (9999.0, "9999", 2),
        (math.nan, "-", 2),
        (math.inf, "∞", 2),
        (1.26e-4, "1e-4", 1),
        (0.1256, "0.126", 3),
    ],
)
def test_numbers_are_printed_with_as_many_digits_as_asked(value, text, digits):
    assert tables.number(value, digits) == text


def test_a_text_table_is_aligned_by_the_width_on_a_terminal():
    lines = tables.text_table(["case", "error"], [["四節", "1e-3"], ["θ", "12"]], 1, (" ┃ ", " │ "), ("━", "━╇━"))
    assert lines == ["case ┃ error", "━━━━━╇━━━━━━", "四節 │  1e-3", "θ    │    12"]
    assert tables.text_table(["a", "b"], [["wide", "-"]]) == ["a     b", "wide  -"]


def test_an_error_table_has_each_quantity_under_its_name():
    head, [line] = tables.ERROR_HEADER, tables.error_rows([row()])
    assert dict(zip(head, line, strict=True)) == {
        "method": "toy default",
        "outcome": "finished",
        "step": "11 ms",
        "position [m]": "1.3e-3",
        "angle [rad]": "1.9e-3",
        "velocity [m/s]": "3.1e-3",
        "rate [rad/s]": "3.7e-3",
        "gap [m]": "4.1e-3",
        "slip [m/s]": "4.7e-3",
        "energy [relative]": "5.3e-3",
        "reaction [relative]": "5.9e-3",
        "CPU [ms/s]": "67",
    }


def sweep(verdict: Verdict, order: float = NAN, points: int = 0, plateau: float = NAN, best: float = 1.7e-5) -> Sweep:
    return Sweep("s", "toy", "default", quantity("angle"), verdict, order, points, 0.13, plateau, 1e-7, best, 1e-3)


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (sweep(Verdict.FALLS, 1.994, 4), "1.99 (±0.13, 4 points)"),
        (sweep(Verdict.FALLS), "falls, 1.7e-5"),
        (sweep(Verdict.PLATEAU, 1.1, 3, 2.3e-5), "1.10 (±0.13, 3 points), plateau **2.3e-5**"),
        (sweep(Verdict.ROUNDING, 3.9, 3), "3.90 (±0.13, 3 points), then rounding"),
        (sweep(Verdict.LEVELS, 1.1, 3), "1.10 (±0.13, 3 points), **levels off at the finest step**"),
        (sweep(Verdict.GROWS), "**grows as the step shrinks**"),
        (sweep(Verdict.ERRATIC), "**erratic**"),
        (sweep(Verdict.TOO_FEW, best=NAN), "-"),
    ],
)
def test_a_sweep_is_told_in_words(found, words):
    assert tables.sweep_words(found) == words
    lost = tables.sweep_words(found, "torn")
    assert lost.endswith("at the finest step **torn**") if math.isfinite(found.best) else lost == words


def test_an_outcome_grid_has_every_step_and_each_cell_under_its_own():
    rows = [
        row_of("a x", step=1e-3, angle=1.3e-5),
        row_of("a x", step=1e-1, outcome=Outcome.TORN, gap=1.7e-2),
        row_of("b x", step=1e-2, outcome=Outcome.SATURATED),
        row_of("b x", step=1e-3, outcome=Outcome.TORN, gap=NAN),
        row_of("b x", step=1e-1, outcome=Outcome.PLATEAU, angle=2.3e-4),
    ]
    assert table(tables.outcome_grid(rows)) == [
        ["method", "100 ms", "10 ms", "1 ms"],
        ["a x", "**torn** 0.017 m", "", "1.3e-5 rad"],
        ["b x", "2.3e-4 rad", "**saturated**", "**torn**"],
    ]


def test_two_rows_that_would_stand_in_one_place_are_refused():
    with pytest.raises(ValueError, match=r"two rows of 'a x' at a step of 10 ms"):
        tables.outcome_grid([row_of("a x", step=1e-2), row_of("a x", step=1e-2, angle=1.0)])


def test_a_summary_has_each_number_under_its_name():
    rows = [
        *falling("toy default", (1e-2, 1e-4, 1e-6)),
        row_of("toy default", step=1e-4, angle=1e-9, outcome=Outcome.TORN),
        *falling("toy soft", (1e-2, 3e-5, 3e-5, 3e-5)),
        *falling("toy exact", (1e-3, 1e-13)),
        row_of("toy lost", outcome=Outcome.DIVERGED),
    ]
    lines = [dict(zip(tables.SUMMARY_HEADER, line, strict=True)) for line in tables.summary_rows(rows)]
    assert lines[0] == {
        "method": "toy default",
        "angle error [rad]": "1e-6",
        "at step": "1 ms",
        "CPU [ms/s]": "100",
        "order": "2.0 (3)",
        "plateau [rad]": "-",
        "outcomes": "finished, torn",
    }
    assert lines[1]["plateau [rad]"] == "3e-5"
    assert lines[2]["plateau [rad]"] == "rounding"
    assert list(lines[3].values()) == ["toy lost", "-", "-", "-", "-", "-", "diverged"]


def read(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def test_each_column_of_the_errors_is_its_field_and_none_is_missing():
    [found] = read(csv_files.as_csv([row()], timings=False))
    told = {f.name for f in fields(Measurement)} - {"key", "limit", *TIMINGS}
    assert set(found) == told
    for name in told - set(csv_files.DESCRIPTIONS):
        value = getattr(row(), name)
        assert found[name] == (f"{value:.4g}" if isinstance(value, float) else str(value)), name
    assert found["parameters"] == hashlib.sha256(b"Disc(rate=2.0)").hexdigest()[:8]
    assert found["settings"] == hashlib.sha256(b"Toy(order=2.0)").hexdigest()[:8]


def test_rows_stand_in_the_same_order_in_both_files_whatever_order_they_came_in():
    rows = [row_of(f"{engine} x", scene=scene, every=every) for engine in "ba" for scene in "dc" for every in (3, 1)]
    for timings in (False, True):
        text = csv_files.as_csv(rows, timings)
        assert text == csv_files.as_csv(rows[::-1], timings)
        found = [(r["scene"], r["engine"], r["every"]) for r in read(text)]
        assert found == sorted((r.scene, r.engine, str(r.every)) for r in rows)


def test_descriptions_have_each_digest_once_with_its_text_and_what_it_is_of():
    rows = [row(), row(angle=1.0), row(settings="Toy(order=4.0)")]
    found = read(csv_files.descriptions_csv(rows))
    assert [(line["of"], line["description"]) for line in found] == [
        ("parameters", "Disc(rate=2.0)"),
        ("settings", "Toy(order=2.0)"),
        ("settings", "Toy(order=4.0)"),
    ]
    assert all(line["digest"] == csv_files.digest(line["description"], csv_files.SHORT) for line in found)


@pytest.fixture
def other_versions(monkeypatch):
    """Versions are looked up once in a process: here they change, and are those of this installation afterwards."""
    provenance._version.cache_clear()
    yield monkeypatch
    provenance._version.cache_clear()


def test_the_versions_are_those_of_the_packages_they_stand_beside(other_versions):
    numbers = {"numpy": "1.1", "scipy": "2.2", "pymunk": "3.3"}

    def version(name):
        if name not in numbers:
            raise metadata.PackageNotFoundError(name)
        return numbers[name]

    other_versions.setattr(metadata, "version", version)
    other_versions.setattr(platform, "python_version", lambda: "3.99")
    compiled = ", numba not installed" if loading.installed() else ""
    assert versions() == f"Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed{compiled}"
    assert still_installed("Python 3.99, scipy 2.2")
    assert still_installed("Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed")
    assert not still_installed("Python 3.99, scipy 2.3")
    assert not still_installed("Python 3.99, scipy 2.2, another 1.0")
    assert foot("a command") == f"Made by `a command` with {versions()}; timings on {machine()}."


def test_a_machine_is_told_without_its_name_or_a_path(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 97)
    monkeypatch.setattr(platform, "machine", lambda: "an architecture")
    told = machine()
    assert told.startswith("an architecture, 97 processors, ")
    assert platform.node() not in told
    assert "/" not in told.replace("w/", "")


def test_bars_and_line_ends_do_not_break_a_table():
    assert tables.markdown(["a", "b"], [["1|2", "3\n4"]], left=1) == "| a | b |\n| --- | --: |\n| 1\\|2 | 3 4 |"
