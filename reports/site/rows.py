"""Stored rows as the page of charts wants them, from errors.csv and timings.csv."""

from __future__ import annotations

import math
from typing import Any

from engines.lagrange import Lagrange
from reports.plots.looks import family_of, role
from reports.write.columns import VARIANTS
from reports.write.csv_files import read_lines

COLUMNS = ("scene", "engine", "variant", "outcome", "settings", "step")
NUMBERS = ("position", "angle", "velocity", "gap", "energy", "reaction")


def explored(errors: str, timings: str, descriptions: str) -> dict[str, Any]:
    """All rows of sweeps for the page of charts: {columns, rows}; a number that is missing is None.

    `cpu` is CPU time per simulated second [s], from timings.csv; settings are told in words, from descriptions.csv.
    looks: the role of the colour of each engine, its place in the palette, and whether it solves the equations as they
    are: such solvers are shown when they are asked for. headings: what the variants are called.
    """
    key = ("scene", "engine", "variant", "purpose", "parameters", "settings", "samples", "every")
    spent = {tuple(row[name] for name in key): row for row in read_lines(timings)[1]} if timings else {}
    words = {row["digest"]: row["description"] for row in read_lines(descriptions)[1]} if descriptions else {}
    rows = []
    for row in read_lines(errors)[1] if errors else []:
        if row["purpose"] != "sweep":
            continue
        cost = spent.get(tuple(row[name] for name in key), {}).get("cpu", "nan")
        told = {**row, "settings": words.get(row["settings"], "")}
        rows.append(
            [*(told[name] for name in COLUMNS[:-1]), float(row["step"])]
            + [_number(row[name]) for name in NUMBERS]
            + [_number(cost)]
        )
    names = sorted({row[1] for row in rows})
    looks = {name: {"role": role(family_of(name), names), "exact": name == Lagrange.name} for name in names}
    headings = {name: column.value for name, column in VARIANTS.items()}
    return {"columns": [*COLUMNS, *NUMBERS, "cpu"], "rows": rows, "looks": looks, "headings": headings}


def _number(text: str) -> float | None:
    value = float(text or "nan")
    return value if math.isfinite(value) else None
