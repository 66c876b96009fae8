"""Models that others ship, and what became of each: a table, which a test holds against them."""

from __future__ import annotations

import csv
from pathlib import Path

from reports.write.tables import markdown

TABLE = Path(__file__).parent / "models" / "of_others.csv"
SOURCES = {
    "mujoco": "MuJoCo's package",
    "gymnasium": "Gymnasium",
    "dm_control": "dm_control's suite",
    "pymunk": "pymunk's examples",
}
HEADER = ("from", "model", "what became of it")


def rows() -> list[dict[str, str]]:
    """Every model that was tried, by its name."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def told() -> dict[str, object]:
    """How many were tried and read, as they are and with something switched off, and the table."""
    found = rows()
    read = [row for row in found if row["bodies"]]
    body = [[SOURCES[row["source"]], f"`{row['model']}`", _sentence(row)] for row in found]
    return {
        "count": len(found),
        "as_is": sum(not row["without"] for row in read),
        "switched": sum(bool(row["without"]) for row in read),
        "table": markdown(list(HEADER), body),
    }


def _sentence(row: dict[str, str]) -> str:
    off = "".join(f" `--without {word}`" for word in row["without"].split())
    if row["bodies"]:
        bodies = f"read: {row['bodies']} {'body' if row['bodies'] == '1' else 'bodies'}"
        return f"{bodies}, with{off}" if off else bodies
    return f"refused{f', with{off} too' if off else ''}: {row['reason']}"
