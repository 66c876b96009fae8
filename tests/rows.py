"""Rows with different numbers in all fields, so that a test fails if code uses a wrong field."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome

# Errors, step and costs are two-digit primes times a power of ten, so that two printed digits identify the field.
# Counts are three-digit primes.
ROW = Measurement(
    key="the key",
    purpose="sweep",
    scene="disc",
    parameters="Disc(rate=2.0)",
    engine="toy",
    variant="default",
    settings="Toy(order=2.0)",
    every=101,
    samples=103,
    step=1.1e-2,
    outcome=Outcome.FINISHED,
    sentence="a sentence",
    position=1.3e-3,
    position_rms=1.7e-3,
    angle=1.9e-3,
    angle_rms=2.3e-3,
    angle_duration=2.9e-3,
    velocity=3.1e-3,
    rate=3.7e-3,
    gap=4.1e-3,
    drive_gap=4.3e-3,
    slip=4.7e-3,
    energy=5.3e-3,
    reaction=5.9e-3,
    reaction_rows=107,
    flips=109,
    estimate=6.1e-3,
    bodies=113,
    coordinates=127,
    rows=131,
    solver_rows=137,
    own_bodies=139,
    own_coordinates=149,
    own_rows=151,
    own_freedoms=157,
    cpu=6.7e-2,
    runs=163,
    build=7.1e-2,
    limit=7.3,
)


def row(**changes: Any) -> Measurement:
    """The row `ROW` with these fields changed."""
    return replace(ROW, **changes)


def row_of(method: str, **changes: Any) -> Measurement:
    """A row of the method "mujoco tuned", whose name has two words."""
    engine, variant = method.split(" ", 1)
    return row(engine=engine, variant=variant, **changes)


def falling(method: str, errors: Iterable[float], quantity: str = "angle", **changes: Any) -> list[Measurement]:
    """A sweep with these errors at steps of 1e-1, 1e-2, 1e-3 s and so on; smaller steps cost more."""
    return [
        row_of(method, **{"step": 10.0 ** -(i + 1), "every": 10**i, "cpu": 10.0 ** (i - 3), quantity: error, **changes})
        for i, error in enumerate(errors)
    ]


def table(text: str) -> list[list[str]]:
    """The cells of a Markdown table: the header, and the lines after the separator."""
    lines = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in text.splitlines()]
    return [lines[0], *lines[2:]]
