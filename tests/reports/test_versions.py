"""Rows of several versions of an engine: tables, what is worse or dearer between two, and the page of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from engines.lagrange import Lagrange
from engines.mujoco import DEFAULT
from reports.cli import compare
from reports.cli.terminal import Terminal
from reports.model.cells import Cell
from reports.model.measure import blank
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.pages.versions import page
from reports.versions.builds import BuildComparison, Side
from reports.versions.catalogue import RELEASES, changes_between
from reports.versions.column import VersionColumn
from reports.versions.comparison import compared, steps
from reports.versions.table import Entry, Table, as_csv, as_published, merged, read
from reports.versions.trees import miss, trees
from tests.toys import Disc


def entry(version, error, scene="disc", outcome="finished", quantity="angle", engine="mujoco"):
    return Entry(engine, version, scene, "tuned", 1e-3, quantity, error, outcome, 0.01, "")


def test_steps_are_found_in_the_errors_alone():
    nan = float("nan")
    line = [("3.9.0", 1e-3), ("3.10.0", 2.9e-3), ("4.0.0", 2.9e-2), ("4.0.1", 1e-3), ("3.1.0", nan)]
    own = [entry(v, e, outcome="unsupported" if e != e else "finished") for v, e in line]
    own += [entry("3.9.0", 1e-14, "exact"), entry("4.0.0", 9e-12, "exact")]  # both are rounding
    own += [entry("3.9.0", 1e-3, "breaks"), entry("4.0.0", nan, "breaks", "torn")]
    found = [(step.before.version, step.after.version, step.after.scene, step.worse) for step in steps(own)]
    assert found == [
        ("3.10.0", "4.0.0", "disc", True),
        ("3.9.0", "4.0.0", "breaks", True),
        ("4.0.0", "4.0.1", "disc", False),
    ]


def test_a_change_is_looked_up_between_two_versions():
    assert [each.version for each in changes_between("mujoco", "3.6.0", "4.0.1", worse=False)] == ["3.7.0", "4.0.1"]
    assert [each.version for each in changes_between("mujoco", "3.6.0", "4.0.1", worse=True)] == ["4.0.0"]
    assert changes_between("mujoco", "3.7.0", "3.17.0", worse=False) == ()
    assert changes_between("pymunk", "3.6.0", "4.0.0", worse=False) == ()
    assert all(each.source.startswith("https://") == bool(each.changed) for each in RELEASES)


def test_a_table_is_read_as_it_was_written_and_renewed_by_version(tmp_path):
    own = Table(
        (entry("3.6.0", 0.25), entry("4.0.0", float("nan"), outcome="torn")), {("mujoco", "3.6.0"): "it is: old"}
    )
    path = tmp_path / "versions.csv"
    path.write_text(as_csv(own))
    again = read(path)
    assert as_csv(again) == as_csv(own)
    assert again.marks == own.marks
    newer = merged(again, Table((entry("3.6.0", 0.5),), {}))
    assert [(each.version, each.error) for each in newer.entries if each.comparable] == [("3.6.0", 0.5)]
    assert newer.marks == {}
    path.write_text("scene\nx\n")
    with pytest.raises(ValueError, match="it is no table of versions"):
        read(path)


def row(angle, outcome=Outcome.FINISHED, every=1, cpu=1.0):
    made = blank(Cell(Disc(), Lagrange(), every), outcome)
    return replace(made, angle=angle, cpu=cpu)


def printed(before, after, form="text"):
    sides = Side("old==1", "mujoco", Path(), False), Side("new==2", "mujoco", Path(), False)
    columns = VersionColumn("1", tuple(before)), VersionColumn("2", tuple(after))
    compare.print_comparison(Terminal(compare.WIDTH, form), BuildComparison(sides, columns, compared(before, after)))


def ended(outcome):
    return [row(float("nan"), outcome)]


def test_worse_is_more_than_three_times_as_large_and_cost_and_orders_are_told():
    before = [row(1e-3), row(1e-4, every=10)]
    assert not compared(before, [row(2.9e-3, cpu=2.0), row(1e-4, every=10, cpu=2.0)]).differences
    found = compared(before, [row(3.1e-3, cpu=2.0), row(1e-5, every=10, cpu=2.0)])
    assert [(each.quantity, each.worse) for each in found.differences] == [("angle", True), ("angle", False)]
    assert (len(found.pairs), found.cost) == (2, 2.0)
    orders = compared([row(1e-2), row(1e-4, every=10)], [row(1e-2), row(1e-3, every=10)])
    assert [(round(turn.before), round(turn.after)) for turn in orders.turns] == [(2, 1)]


@pytest.mark.parametrize(
    ("before", "after", "verdict"),
    [
        (ended(Outcome.TORN), [row(1e-3)], "better"),
        (ended(Outcome.TORN), ended(Outcome.RESET), "other"),
        ([row(1e-3)], [row(1e-5)], "better"),
        ([row(1e-3)], ended(Outcome.TORN), "WORSE"),
        (ended(Outcome.TORN), ended(Outcome.ABORTED), "WORSE"),
    ],
)
def test_an_outcome_is_better_where_it_finishes_and_another_kind_of_end_is_none(capsys, before, after, verdict):
    printed(before, after)
    line = next(line for line in capsys.readouterr().out.splitlines() if before[0].scene in line)
    assert verdict in line.split()[-1]


def test_a_method_whose_numbers_stay_is_told_with_its_error_and_its_releases_and_units(capsys):
    both = [row(1e-3), row(1e-5, every=10)]
    printed(both, both, "markdown")
    head, _, line, *_ = (line for line in capsys.readouterr().out.splitlines() if line.startswith("|"))
    told = dict(zip(head.split(" | "), line.split(" | "), strict=True))
    assert (told["what changed most"], told["old==1"], told["new==2"]) == ("angle [rad]", "1e-5", "1e-5")
    assert "nothing changed" in line


def test_random_trees_tell_ideal_constraints_from_wrong_ones():
    drawn = trees(6, 2, 3)
    assert drawn == trees(6, 2, 3)
    assert len({each.pose.tobytes() for each in drawn}) == 3
    # Two formulations of the same law, apart by what a step of 1e-5 of the time scale costs.
    assert max(miss(Lagrange("rk4"), each) for each in drawn) < 1e-3
    # As shipped a joint gives way by a tenth of what would hold it.
    assert min(miss(DEFAULT, each) for each in drawn) > 1e-2


def test_the_page_reads_its_rows_and_names_their_steps(monkeypatch):
    own = (entry("3.6.0", 1e-2), entry("3.7.0", 1e-6), entry("4.0.1", 1e-6))
    table = Table((*own, entry("7.0.0", 1e-2, engine="pymunk")), {("mujoco", "3.6.0"): "it is old"})
    monkeypatch.setattr(page, "table", lambda: table)
    told = page.words(Material({}))["engines"]
    assert [each["name"] for each in told] == ["mujoco", "pymunk"]
    assert "3.6.0 to 3.7.0" in told[0]["steps"]
    assert "velocity term" in told[0]["steps"]
    assert "4.0.1" not in told[0]["steps"]
    assert told[1]["steps"] == ""
    drawn = {f"{name}_{kind}" for name in ("mujoco", "pymunk") for kind in ("heat", "cost")}
    assert set(page.figures(Material({}))) == drawn
    monkeypatch.setattr(page, "table", lambda: Table((), {}))
    assert page.words(Material({}))["engines"] == []


def test_a_published_number_keeps_its_text_within_rounding_and_a_time_within_a_tenth():
    before = read(page.DATA)
    known = [entry for entry in before.entries if entry.comparable and entry.quantity == "angle"][:20]
    before = replace(before, entries=tuple(known))
    moved = tuple(replace(entry, error=entry.error + 1e-12, cpu=1.09 * entry.cpu) for entry in known)
    assert as_csv(as_published(replace(before, entries=moved), before)) == as_csv(before)
    changed = tuple(replace(entry, error=1.01 * entry.error + 1e-10, cpu=1.11 * entry.cpu) for entry in known)
    assert as_published(replace(before, entries=changed), before).entries == changed
    gone = tuple(replace(entry, outcome=Outcome.TORN) for entry in moved)
    assert as_published(replace(before, entries=gone), before).entries == gone


def test_a_line_that_goes_to_and_fro_is_a_change_only_if_it_is_known_by_name(monkeypatch):
    nan = float("nan")
    edge = [("3.8.1", 0.015, "finished"), ("3.10.0", nan, "torn"), ("3.12.0", 0.015, "finished")]
    known = [("3.17.0", 1e-5, "finished"), ("4.0.0", 2.4, "finished"), ("4.0.1", 1e-5, "finished")]
    own = [entry(v, e, "edge", o) for v, e, o in edge] + [entry(v, e, "trees", o) for v, e, o in known]
    monkeypatch.setattr(page, "table", lambda: Table(tuple(own), {}))
    told = page.words(Material({}))["engines"][0]
    assert told["edges"] == ["edge, tuned"]
    assert "edge" not in told["steps"]
    assert "3.17.0 to 4.0.0" in told["steps"]
    assert "4.0.0 to 4.0.1" in told["steps"]
