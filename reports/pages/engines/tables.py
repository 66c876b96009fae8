"""The tables of the page of engines: each from rows or answers, and empty where there are none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Answer
from reports.pages.engines.cells import (
    CLOSED_AT,
    CLOSING,
    CORRECTED,
    CORRECTIONS,
    FEW,
    FREE,
    FREQUENCIES,
    MILLISECOND,
    MOVES,
    SHARES,
)
from reports.pages.engines.experiments import ASKED, CODE, CONTACT, TOO_OLD, YES, Capabilities
from reports.write.provenance import told_versions
from reports.write.tables import NOTHING, markdown, milliseconds, number


def rows_of(material: Material, scenes: Iterable[str]) -> list[Measurement]:
    """The rows of these scenes in all engines, those beside the grid as if they were of it."""
    names = {*scenes}
    found = (row for cell, row in material.rows.items() if cell.scene.name in names and cell.purpose != "failure")
    return [replace(row, purpose="sweep") for row in found if row.purpose in ("sweep", "beside")]


def missed(row: Measurement, field: str) -> float:
    return getattr(row, field) if Outcome(row.outcome).comparable and getattr(row, field) > 0 else float("inf")


def line_of(material: Material, cells: Mapping[float, Any]) -> list[tuple[float, float]]:
    return [
        (share, material.rows[cell].angle)
        for share, cell in cells.items()
        if cell in material.rows and missed(material.rows[cell], "angle") < float("inf")
    ]


def matrix(answers: Mapping[Capabilities, Answer]) -> str:
    """A column an engine, from what it built; empty where nothing was asked yet."""
    engines = [task.of for task in answers]
    body = [[what, *(verdict(str(answer.values[what])) for answer in answers.values())] for what in ASKED]
    body += [[what, *(str(answer.values[what]) for answer in answers.values())] for what in ("reactions", "width")]
    body.append(["version", *(told_versions([engine]) for engine in engines)])
    return markdown(["", *(engine.name for engine in engines)], body, left=len(engines) + 1) if engines else ""


def verdict(told: str) -> str:
    """The word of a cell. The engine lacks a thing only where the sentence names a place in its documentation."""
    if told in (YES, CONTACT, CODE):
        return told
    if told.startswith(TOO_OLD):
        return "too old"
    return "**has none**" if "https://" in told else "not built"


def sentences(answers: Mapping[Capabilities, Answer]) -> list[tuple[str, str, str, str]]:
    """(engine, what, the word, the sentence) of what is not built."""
    return [
        (task.of.name, what, verdict(told), told)
        for task, answer in answers.items()
        for what in ASKED
        if (told := str(answer.values[what])) not in (YES, CONTACT, CODE)
    ]


def free_table(material: Material) -> str:
    """Every variant on the free four-bar at a step of a millisecond; empty without rows."""
    rows = [row for row in rows_of(material, [FREE.name]) if row.every == MILLISECOND]
    body = [
        [
            row.method,
            number(row.angle) if Outcome(row.outcome).comparable else f"**{row.outcome}**",
            *(number(getattr(row, name)) for name in ("gap", "energy", "reaction")),
            milliseconds(row.cpu) if row.cpu > 0 else NOTHING,
        ]
        for row in sorted(rows, key=lambda row: missed(row, "angle"), reverse=True)
    ]
    header = ["method", "angle error [rad]", "gap [m]", "energy [relative]", "reaction [relative]", "CPU [ms/s]"]
    return markdown(header, body) if body else ""


def share_table(material: Material) -> str:
    lines = {name: dict(line_of(material, cells)) for name, cells in CLOSING.items()}
    body = [[number(share), *(number(lines[name].get(share, float("nan"))) for name in lines)] for share in SHARES]
    header = ["share closed in a step", *(f"{name}: angle error [rad]" for name in lines)]
    return markdown(header, body, left=0) if any(lines.values()) else ""


def experiment_table(material: Material, cells: Mapping[Any, Any], head: str, said: Mapping[Any, str]) -> str:
    body = [
        [said[key], number(row.angle), number(row.gap), number(row.energy)]
        for key, cell in cells.items()
        if (row := material.rows.get(cell)) is not None
    ]
    return markdown([head, "angle error [rad]", "gap [m]", "energy [relative]"], body) if body else ""


def _told(row: Measurement | None) -> str:
    """The angle error, or what became of the run."""
    if row is None:
        return NOTHING
    return number(row.angle) if Outcome(row.outcome).comparable else f"**{row.outcome}**"


def moves_table(material: Material) -> str:
    """What moves each engine: as it was, and with one setting turned; lines that were not run are left out."""
    body = [
        [engine, what, _told(material.rows.get(before)), _told(material.rows.get(after))]
        for engine, what, before, after in MOVES
        if before in material.rows or after in material.rows
    ]
    header = ["engine", "what is turned", "angle error before [rad]", "after [rad]"]
    return markdown(header, body, left=2) if body else ""


def frequency_table(material: Material) -> str:
    """Errors by the frequency of pins, for few sub-steps; empty without rows."""

    def cells(share: float) -> list[str]:
        rows = [material.rows.get(CLOSED_AT[count, share]) for count in FEW]
        return [told for row in rows for told in (_told(row), NOTHING if row is None else number(row.gap))]

    body = [["as shipped" if share == 0 else f"{share:g}", *cells(share)] for share in FREQUENCIES]
    names = {1: "one sub-step", 4: "four sub-steps"}
    header = ["frequency x sub-step"]
    header += [f"{names[count]}: {what}" for count in FEW for what in ("angle error [rad]", "gap [m]")]
    return markdown(header, body) if any(cell in material.rows for cell in CLOSED_AT.values()) else ""


def correction_table(material: Material) -> str:
    """Errors of both integrators by the correction of loops; empty without rows."""
    names = {"euler": "Euler", "rk4": "Runge-Kutta"}
    body = [[f"{rate:g}", *(_told(material.rows.get(CORRECTED[each, rate])) for each in names)] for rate in CORRECTIONS]
    header = ["correction [1/s]", *(f"{name}: angle error [rad]" for name in names.values())]
    return markdown(header, body, left=0) if any(cell in material.rows for cell in CORRECTED.values()) else ""
