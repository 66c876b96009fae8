"""The judge's own work beside the cells of a gate: it begins first, its answers are kept apart, its failure is told."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from reference.scenes.catalogue import SCENES
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.gate import walk
from reports.gate.judge import _samples, integrate
from reports.gate.prediction import prediction
from reports.gate.walk import JUDGE_LIMIT, Foretold, Judging
from reports.model.cells import Cell
from reports.model.outcomes import Outcome
from reports.run.queue import kin_of
from reports.run.running import run_cells
from tests.toys import Disc, FailingToy, Toy

NO_KINDS: frozenset[Any] = frozenset()


class Cut(Disc):
    """A scene whose motion can be compared for a part of its 0.2 s [s]."""

    name = "cut disc"
    until = 0.115

    @property
    def comparable_until(self) -> float:
        return self.until


class Brief(Cut):
    """Less than a sample."""

    until = 1e-4


@pytest.mark.parametrize("scene", [scene for scene in SCENES if scene.comparable_until >= scene.duration], ids=str)
def test_the_judge_runs_to_the_end_of_a_scene(scene):
    assert _samples(scene) == scene.samples


class Rounded(Cut):
    """27 samples of the 70 in 0.705 s: divided by their spacing a rounding below 27."""

    until = 27 * (0.705 / 70)


def test_the_judge_ends_at_the_last_sample_that_can_be_compared_and_takes_one_at_least():
    scene = Cut()
    assert _samples(scene) == 11
    assert integrate(scene, 2, 1).t[-1] == pytest.approx(0.11, rel=1e-12)
    assert _samples(Brief()) == 1
    assert _samples(Rounded(duration=0.705)) == 27


class Unknown(Disc):
    """A scene without a truth."""

    name = "unknown disc"

    def _motion(self, times: Any) -> Any:
        raise ValueError("nobody knows where it is")


def test_the_judge_beside_the_cells_changes_no_row_and_says_what_it_says_alone():
    cells = [Cell(Disc(), Toy(), 1), Cell(Disc(), Toy(), 2), Cell(Disc(), FailingToy("raise"), 1)]
    judging = Judging((Foretold(Disc(), NO_KINDS),), {})
    rows = {row.key: row for row in run_cells(cells, workers=2, timed=False, supervised=judging)}
    plain = {row.key: row for row in run_cells(cells, workers=2, timed=False)}
    assert rows.keys() == plain.keys() == {cell.key for cell in cells}
    assert {key: (row.outcome, row.sentence) for key, row in rows.items()} == {
        key: (row.outcome, row.sentence) for key, row in plain.items()
    }
    assert [rows[cell.key].angle for cell in cells[:2]] == [plain[cell.key].angle for cell in cells[:2]]
    assert judging.found == {Disc(): prediction(Disc(), NO_KINDS)}


def test_a_judge_that_fails_ends_the_gate_with_its_reason():
    judging = Judging((Foretold(Unknown(), NO_KINDS),), {})
    with pytest.raises(RuntimeError, match=r"no prediction for unknown disc: .*nobody knows where it is"):
        list(run_cells([Cell(Disc(), Toy(), 1)], workers=1, timed=False, supervised=judging))
    assert judging.found == {}


def test_the_judge_follows_the_scenes_of_the_cells_before_any_of_them_and_has_its_own_time(monkeypatch):
    given: list[tuple[list[Any], float, tuple[Any, ...]]] = []
    foretold = object()

    def supervise(function: Any, items: Any, limit: float, *terms: Any) -> Iterator[Any]:
        given.append((list(items), limit, terms))
        for item in given[0][0]:
            yield item, foretold if isinstance(item, Foretold) else Outcome.FINISHED, "a note"

    monkeypatch.setattr(walk, "supervise", supervise)
    without, chain = LinkPendulum(links=1), LinkPendulum(links=5)  # no cell is of the first
    asked = tuple(Foretold(scene, NO_KINDS) for scene in (without, Disc(), chain))
    judging = Judging(asked, {})
    cells = [Cell(chain, Toy(), 1), Cell(Disc(), Toy(), 1), Cell(chain, Toy(), 2)]
    assert list(judging(str, cells, 60.0, 3, None)) == [(cell, Outcome.FINISHED, "a note") for cell in cells]
    items, limit, terms = given[0]
    assert items == [asked[2], asked[1], asked[0], *cells]
    assert [kin_of(item) for item in items[:2]] == [chain, Disc()]  # each goes to the worker that has its cells
    assert (limit, terms) == (JUDGE_LIMIT, (3, None))
    assert judging.found == dict.fromkeys((without, Disc(), chain), foretold)
    list(judging(str, [], 2 * JUDGE_LIMIT))
    assert given[1][1] == 2 * JUDGE_LIMIT
