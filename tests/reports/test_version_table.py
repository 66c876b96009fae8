"""Tests of the table of versions, of the comparison of two versions, and of the page."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engines.lagrange import Lagrange
from engines.mujoco import DEFAULT
from reports.cli import compare
from reports.cli.terminal import Terminal
from reports.model.cells import Cell
from reports.model.measure import blank
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Answer
from reports.pages.versions import page
from reports.run.installed import numbers
from reports.versions.builds import Build, BuildComparison
from reports.versions.column import VersionColumn, with_known_names
from reports.versions.comparison import compared
from reports.versions.table import (
    RELEASES,
    Entry,
    ReleaseTable,
    as_csv,
    as_published,
    changes,
    changes_between,
    entries,
    merged,
    read,
    released,
    wrong_trees,
)
from reports.versions.trees import Trees, miss, trees
from tests.toys import Disc

NAN = float("nan")


def entry(version, error, scene="disc", outcome="finished", quantity="angle", engine="mujoco"):
    return Entry(engine, version, scene, "tuned", 1e-3, quantity, error, outcome, 0.01, "")


def test_changes_between_versions_are_found_from_the_errors():
    line = [("3.9.0", 1e-3), ("3.10.0", 2.9e-3), ("4.0.0", 9e-3), ("4.0.1", 1e-3), ("3.1.0", NAN)]
    entries = [entry(v, e, outcome="unsupported" if e != e else "finished") for v, e in line]
    entries += [entry("3.9.0", 1e-14, "exact"), entry("4.0.0", 9e-12, "exact")]  # both errors are at rounding
    entries += [entry("3.9.0", 1e-3, "breaks"), entry("4.0.0", NAN, "breaks", "torn")]
    assert [(earlier.version, later.version, later.scene, label) for earlier, later, label in changes(entries)] == [
        ("3.9.0", "4.0.0", "breaks", "WORSE"),
        ("3.10.0", "4.0.0", "disc", "WORSE"),
        ("4.0.0", "4.0.1", "disc", "better"),
    ]
    known = RELEASES["mujoco"]
    assert changes_between("mujoco", "3.6.0", "4.0.1") == [known[version] for version in ("3.7.0", "4.0.0", "4.0.1")]
    assert changes_between("mujoco", "3.7.0", "3.17.0") == changes_between("pymunk", "3.6.0", "4.0.0") == []
    assert all(change["source"].startswith("https://") for change in changes_between("mujoco", "0", "99"))
    for versions in RELEASES.values():
        assert list(versions) == sorted(versions, key=numbers)


def test_a_table_is_read_as_it_was_written_and_renewed_by_version(tmp_path):
    table = ReleaseTable(
        (entry("3.6.0", 0.25), entry("4.0.0", NAN, outcome="torn")), {("mujoco", "3.6.0"): "it is: old"}
    )
    path = tmp_path / "versions.csv"
    path.write_text(as_csv(table))
    again = read(path)
    assert (as_csv(again), again.marks) == (as_csv(table), table.marks)
    newer = merged(again, ReleaseTable((entry("3.6.0", 0.5),), {}))
    assert [(item.version, item.error) for item in newer.entries if item.comparable] == [("3.6.0", 0.5)]
    assert newer.marks == {}
    path.write_text("scene\nx\n")
    with pytest.raises(ValueError, match="it is no table of versions"):
        read(path)


def test_a_published_number_keeps_its_text_within_rounding_and_a_time_within_a_tenth():
    expected = [entry for entry in released().entries if entry.comparable and entry.quantity == "angle"][:20]
    earlier = ReleaseTable(tuple(expected), {})
    moved = tuple(replace(entry, error=entry.error + 1e-12, cpu=1.09 * entry.cpu) for entry in expected)
    assert as_csv(as_published(ReleaseTable(moved, {}), earlier)) == as_csv(earlier)
    changed = tuple(replace(entry, error=1.01 * entry.error + 1e-10, cpu=1.11 * entry.cpu) for entry in expected)
    assert as_published(ReleaseTable(changed, {}), earlier).entries == changed
    torn = tuple(replace(entry, outcome=Outcome.TORN) for entry in moved)
    assert as_published(ReleaseTable(torn, {}), earlier).entries == torn


def row(angle, outcome=Outcome.FINISHED, every=1, cpu=1.0):
    return replace(blank(Cell(Disc(), Lagrange(), every), outcome), angle=angle, cpu=cpu)


def test_an_error_three_times_as_large_is_worse_and_costs_and_orders_are_compared():
    earlier = [row(1e-3), row(1e-4, every=10)]
    assert not compared(earlier, [row(2.9e-3, cpu=2.0), row(1e-4, every=10, cpu=2.0)]).differences
    comparison = compared(earlier, [row(3.1e-3, cpu=2.0), row(1e-5, every=10, cpu=2.0)])
    differences = comparison.differences
    assert [(difference.quantity, difference.worse) for difference in differences] == [
        ("angle", True),
        ("angle", False),
    ]
    assert (len(comparison.pairs), comparison.cost) == (2, 2.0)
    orders = compared([row(1e-2), row(1e-4, every=10)], [row(1e-2), row(1e-3, every=10)]).orders
    assert [(round(difference.before), round(difference.after)) for difference in orders] == [(2, 1)]


def printed(before, after, form="text"):
    sides = Build("old==1", "mujoco", Path(), False), Build("new==2", "mujoco", Path(), False)
    columns = VersionColumn("1", tuple(before)), VersionColumn("2", tuple(after))
    compare.print_comparison(Terminal(compare.WIDTH, form), BuildComparison(sides, columns, compared(before, after)))


@pytest.mark.parametrize(
    ("before", "after", "verdict"),
    [
        (row(NAN, Outcome.TORN), row(1e-3), "better"),
        (row(NAN, Outcome.TORN), row(NAN, Outcome.RESET), "other"),
        (row(1e-3), row(1e-5), "better"),
        (row(1e-3), row(NAN, Outcome.TORN), "WORSE"),
        (row(NAN, Outcome.TORN), row(NAN, Outcome.ABORTED), "WORSE"),
        (replace(row(1e-3), reaction_rows=2), row(1e-3), "WORSE"),
        (row(1e-3), row(1e-3), "nothing changed"),
    ],
)
def test_the_verdict_on_a_method_follows_its_outcome_before_its_error(capsys, before, after, verdict):
    printed([before], [after], "markdown")
    head, _, line, *_ = (line for line in capsys.readouterr().out.splitlines() if line.startswith("|"))
    cells = dict(zip(head.split(" | "), line.split(" | "), strict=True))
    assert verdict in line.split(" | ")[-1]
    if verdict == "nothing changed":
        assert (cells["what changed most"], cells["old==1"], cells["new==2"]) == ("angle [rad]", "1e-3", "1e-3")


def test_random_trees_distinguish_ideal_constraints_from_wrong_ones():
    three_trees = trees(6, 2, 3)
    assert len({tree.pose.tobytes() for tree in three_trees}) == 3
    # Two formulations of ideal joints differ only by the error of a step, which is 1e-5 of the time scale.
    assert max(miss(Lagrange("rk4"), tree) for tree in three_trees) < 1e-3
    # With default settings the error of a constraint's acceleration is about a tenth of the ideal acceleration.
    assert min(miss(DEFAULT, tree) for tree in three_trees) > 1e-2


def test_an_adapter_that_uses_a_name_that_the_version_lacks_does_not_support_it():
    lost = with_known_names(lambda name: getattr(np, name), "no_such_name")
    assert (lost.outcome, "no_such_name" in lost.sentence) == (Outcome.UNSUPPORTED, True)
    answers = Answer(*vars(lost).values()), Answer(Outcome.FINISHED, values={"miss": np.array([1.0, 0.0, NAN])})
    failed, finished = entries("mujoco", VersionColumn("1", (), tuple((Trees(DEFAULT), a) for a in answers)), {})
    assert (failed.outcome, wrong_trees(failed), wrong_trees(finished)) == ("unsupported", (0, 0), (2, 3))


def test_the_page_counts_changes_and_names_the_documented_ones(monkeypatch):
    entries = (entry("3.6.0", 1e-2), entry("3.7.0", 1e-6), entry("4.0.1", 1e-2))
    table = ReleaseTable((*entries, entry("7.0.0", 1e-2, engine="pymunk")), {("mujoco", "3.6.0"): "it is old"})
    monkeypatch.setattr(page, "released", lambda: table)
    mujoco, pymunk = page.context(Material({}))["engines"]
    _, _, first, second, third = mujoco["table"].splitlines()
    assert first == "| 3.6.0 | - | - | - | 1.00 |"
    assert second.startswith("| 3.7.0 | `connect` and `weld` got the velocity term")
    assert second.endswith("| 1 | - | 1.00 |")
    assert third.startswith("| 4.0.1 | the sparse Cholesky factor")
    assert third.endswith("| - | **1** | 1.00 |")
    assert (pymunk["name"], len(pymunk["table"].splitlines())) == ("pymunk", 3)
    assert set(page.figures(Material({}))) == {"mujoco_heat", "pymunk_heat"}
    monkeypatch.setattr(page, "released", lambda: ReleaseTable((), {}))
    assert page.context(Material({}))["engines"] == []
