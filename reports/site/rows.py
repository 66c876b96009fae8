"""Stored rows as the page's charts want them: series of points, from errors.csv and timings.csv."""

from __future__ import annotations

import csv
import io
from typing import Any

BESIDE_SLIDERS = ("driven_four_bar", "free_four_bar")
SERIES = (("pymunk", "default", 1), ("pymunk", "tuned", 3), ("mujoco", "default", 2), ("mujoco", "tuned", 4))


def read(text: str) -> list[dict[str, str]]:
    """The rows of a CSV text by column; lines that begin with # are its header's remarks."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return list(csv.DictReader(io.StringIO("\n".join(lines))))


def stored_rows(errors: str) -> list[dict[str, Any]]:
    """Angle errors against steps of the scenes with sliders: one series a scene and method; `mark` is its colour."""
    rows = [row for row in read(errors) if row["purpose"] == "sweep" and row["outcome"] == "finished"]
    found = []
    for scene in BESIDE_SLIDERS:
        for engine, variant, mark in SERIES:
            own = [row for row in rows if (row["scene"], row["engine"], row["variant"]) == (scene, engine, variant)]
            points = [[float(row["step"]), float(row["angle"])] for row in own if float(row["angle"]) > 0]
            if points:
                found.append({"scene": scene, "method": f"{engine} {variant}", "mark": mark, "points": points})
    return found
