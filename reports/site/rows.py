"""Stored rows as the page's charts want them: series of points, from errors.csv and timings.csv."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from reports.write.csv_files import read_lines

MEASURES = ("angle", "position")
SERIES = (("pymunk", "default", 1), ("pymunk", "tuned", 3), ("mujoco", "default", 2), ("mujoco", "tuned", 4))


def stored_rows(errors: str, scenes: Iterable[str]) -> list[dict[str, Any]]:
    """Errors against steps of these scenes: one series a scene and method; `mark` is its colour.

    `points`: (step [s], largest error) by what is measured, "angle" [rad] and "position" [m].
    """
    rows = [row for row in read_lines(errors)[1] if row["purpose"] == "sweep" and row["outcome"] == "finished"]
    found = []
    for scene in scenes:
        for engine, variant, mark in SERIES:
            own = [row for row in rows if (row["scene"], row["engine"], row["variant"]) == (scene, engine, variant)]
            points = {
                measure: [[float(row["step"]), float(row[measure])] for row in own if float(row[measure]) > 0]
                for measure in MEASURES
            }
            if own:
                found.append({"scene": scene, "method": f"{engine} {variant}", "mark": mark, "points": points})
    return found


COLUMNS = ("scene", "engine", "variant", "outcome", "settings", "step")
NUMBERS = ("position", "angle", "velocity", "gap", "energy", "reaction")


def explored(errors: str, timings: str, descriptions: str) -> dict[str, Any]:
    """All rows of sweeps for the page of charts: {columns, rows}; a number that is missing is None.

    `cpu` is CPU time per simulated second [s], from timings.csv; settings are told in words, from descriptions.csv.
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
    return {"columns": [*COLUMNS, *NUMBERS, "cpu"], "rows": rows}


def _number(text: str) -> float | None:
    value = float(text or "nan")
    return value if math.isfinite(value) else None
