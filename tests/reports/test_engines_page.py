"""The page of engines: what it claims of the two families is measured here, in the cells of its tables."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from engines import registry
from reports.model.cells import Cell
from reports.model.page import Material
from reports.pages.engines import page, tables
from reports.pages.engines.cells import CLOSED_AT, CORRECTED, FREE, MOVES, SPRUNG
from reports.pages.engines.experiments import ASKED, Capabilities

FIRST, SECOND = 0.1, 0.02  # rad: above and below these the two families are told apart


@cache
def miss(cell: Cell) -> float:
    """The largest angle error [rad]; a skip that names the package where it is missing."""
    if cell.engine.missing:
        pytest.skip(cell.engine.missing)
    run = cell.engine.build(FREE.mechanism(), cell.step)(cell.sample_count, cell.every)
    return float(np.abs(run.pose - FREE.motion(run.t).pose)[..., 2].max())


@pytest.mark.parametrize(("name", "before", "after"), [(name, *cells) for name, _, *cells in MOVES])
def test_one_setting_moves_each_engine(name, before, after):
    assert miss(after) < SECOND
    assert miss(before) > 2 * miss(after)
    if "the loop's pin" not in name:  # all pins can open
        assert miss(before) > FIRST


def test_of_pins_that_are_coordinates_less_error_is_left():
    assert miss(SPRUNG["tree", 20.0]) < 0.5 * miss(SPRUNG["free", 20.0])


def test_it_is_the_frequency_of_box2ds_pins_and_not_its_sweeps():
    """One sweep over the joints, in a step that is not divided: as shipped in the first family, else in the second."""
    assert miss(CLOSED_AT[1, 0.0]) > FIRST
    assert miss(CLOSED_AT[1, 0.25]) < SECOND


def test_gains_explain_other_numbers_that_are_told_of_pinocchio():
    """Gains of 100 and 20, and none: the numbers in engines/pinocchio."""
    told = {("rk4", 0.0): 5.6e-9, ("rk4", 10.0): 1.55e-9, ("euler", 0.0): 0.0703, ("euler", 10.0): 0.0515}
    for key, error in told.items():
        assert miss(CORRECTED[key]) == pytest.approx(error, rel=0.02)


def test_which_of_the_experiments_cells_a_table_reads_is_run():
    ran = {cell for failure in page.EXPERIMENTS for cell in failure.cells}
    read = {cell for _, _, *cells in MOVES for cell in cells} | {*CLOSED_AT.values(), *CORRECTED.values()}
    assert read <= ran


def test_every_kind_is_asked_of_an_engine_that_builds_all_but_one():
    told = Capabilities(next(engine for engine in registry.VARIANTS if engine.name == "lagrange")).run()
    assert [told[what] for what in ASKED] == ["yes"] * len(ASKED)
    for kind in ("rod", "weld", "gear", "spring", "damper", "torsion spring", "torsion damper", "force", "torque"):
        assert kind in ASKED


def test_tables_are_empty_without_rows():
    nothing = Material({})
    for table in (tables.moves_table, tables.frequency_table, tables.correction_table, tables.free_table):
        assert table(nothing) == ""
    assert tables.matrix({}) == ""
