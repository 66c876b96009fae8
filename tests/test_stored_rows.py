"""The store gives back what was put in, each row for its own cell."""

from __future__ import annotations

import math
from dataclasses import fields, replace

from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.run.store import Store
from tests.rows import row
from tests.toys import Disc, Toy

CELLS = [Cell(Disc(), Toy(), every) for every in (1, 2, 3)]


def test_every_field_of_a_row_comes_back(tmp_path):
    stored = row(key=CELLS[0].key, energy=math.nan, gap=math.inf)
    with Store(tmp_path / "cells.sqlite") as store:
        store.put(stored)
    with Store(tmp_path / "cells.sqlite") as store:
        found = store.get(CELLS)
    assert list(found) == CELLS[:1]
    told = found[CELLS[0]]
    assert math.isnan(told.energy)
    assert replace(told, energy=0.0) == replace(stored, energy=0.0)
    kinds = {"str": str, "int": int, "float": float}
    assert all(isinstance(getattr(told, f.name), kinds[str(f.type)]) for f in fields(Measurement))
