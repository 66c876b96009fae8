"""Nothing of a method with a claim is wrong without a word, on random mechanisms of all kinds, at any sampling."""

from __future__ import annotations

import pytest

from engines import bullet, exudyn, mujoco, pymunk
from tests.engines.claims import as_text, judged, rows, table

CLAIMING = pytest.mark.parametrize(
    "engine",
    [pymunk.EXTENDED, mujoco.EXTENDED, exudyn.EXTENDED, bullet.EXTENDED],
    ids=["pymunk", "mujoco", "exudyn", "bullet"],
)


@CLAIMING
def test_twenty_mechanisms_are_right_or_told(engine):
    if engine.missing:
        pytest.skip(engine.missing)
    cases, _ = judged(31, range(40, 60))
    found = table(rows(engine, cases))
    assert sum(line.silent for line in found) == 0, as_text(found)


@pytest.mark.slow
@CLAIMING
def test_a_thousand_mechanisms_are_right_or_told_and_at_most_two_in_a_hundred_are_told_for_nothing(engine):
    if engine.missing:
        pytest.skip(engine.missing)
    cases, unknown = judged(601, range(1000))
    assert len(unknown) < 20
    found = table(rows(engine, cases))
    assert sum(line.silent for line in found) == 0, as_text(found)
    assert sum(line.false for line in found) <= 0.02 * sum(line.tried for line in found), as_text(found)
