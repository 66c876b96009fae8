"""The errata's page: every slip of the chapter by number, what decides, what engines say, and a snippet to run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS, Erratum, Values
from reference.chapter.errata.rolling_and_skates import rolling_acceleration
from reports.model.page import Material, Page
from reports.pages.errata.experiments import CONFIRMED, QUESTIONS, TASKS, Ruling, rulings
from reports.write.tables import markdown, number

NAME = "errata"
SNIPPETS = "errata/snippets"


def digits(values: Iterable[float]) -> str:
    """'(-2.2203, 1.5005)': a vector as it is printed; a single number without brackets."""
    told = [f"{value:.5g}" for value in np.where(np.abs(list(values)) < 1e-12, 0.0, list(values))]
    return f"({', '.join(told)})" if len(told) > 1 else told[0]


@dataclass(frozen=True)
class Told:
    """A slip ready for the template."""

    erratum: Erratum
    table: str
    snippet: str  # file beside the template


def table(erratum: Erratum, values: Values, said: Iterable[Ruling]) -> str:
    """The formulas against the derivative that decides, and against each engine's own motion."""
    body = [
        ["as printed", digits(values.printed), number(values.miss), ""],
        ["as it must be", digits(values.right), "", number(values.agreement)],
        [f"**decides**: {erratum.deciding}", digits(values.decides), "", ""],
    ]
    for ruling in said:
        found = ruling.values
        body.append(
            [f"{ruling.method}: {ruling.about}", digits(found.decides), number(found.miss), number(found.agreement)]
        )
    header = ["", f"value [{erratum.unit}]", "the printed one misses by", "the right one misses by"]
    return markdown(header, body)


def words(material: Material) -> Mapping[str, Any]:
    """Values of the formulas, which are computed at once, and what engines say, from their stored motions."""
    lost: list[str] = []
    said = rulings(material.answers.items(), lost)
    told = [
        Told(
            erratum,
            table(erratum, erratum.values(), [ruling for ruling in said if ruling.number == erratum.number]),
            f"{SNIPPETS}/slip_{erratum.number:02}.py",
        )
        for erratum in ERRATA
    ]
    rates = [(r.method, r.values.agreement) for r in said if r.number == CONFIRMED]
    return {
        "errata": told,
        "word_slips": WORD_SLIPS,
        "blind": [erratum.number for erratum in ERRATA if not erratum.dimensions],
        "seen": [erratum.number for erratum in ERRATA if erratum.dimensions],
        "rates": rates,
        "lost": lost,
        "rolling": rolling_acceleration(),
    }


PAGE = Page(
    name=NAME,
    title="Errata",
    lesson="The chapter's printed slips, each decided by a derivative, by engines, and by a few lines to run.",
    scenes=(),
    engines=(),
    companions=tuple(question.companion for question in QUESTIONS.values()),
    words=words,
    tasks=TASKS,
)
