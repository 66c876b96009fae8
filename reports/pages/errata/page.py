"""The errata's page: every slip of the chapter by number, what decides, what engines say, and a snippet to run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.chapter.errata.catalogue import ERRATA, WORD_SLIPS, Erratum, Values
from reference.chapter.errata.rolling_and_skates import rolling_acceleration
from reports.model.page import Material, Page
from reports.pages.errata.experiments import CONFIRMED, QUESTIONS, TASKS, Ruling, rulings
from reports.write.tables import number

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
    verdict: str
    script: str  # its file


def verdict(erratum: Erratum, values: Values, said: Sequence[Ruling]) -> str:
    """By how much the printed and the right formula miss the derivative that decides, and each engine's own motion."""
    missed = f"The printed formula misses it by {number(values.miss)}, the right one by {number(values.agreement)}."
    if erratum.by_tolerance is not None:
        misses = erratum.by_tolerance().items()
        at_each = " and ".join(f"{number(miss)} at a relative tolerance of {number(each)}" for each, miss in misses)
        missed = (
            f"The closed form misses it by {number(values.agreement)}. The integration misses it by {at_each}: the "
            "tolerance is ours, since the chapter states none."
        )
    told = f"Decides ({erratum.deciding}): {digits(values.decides)} {erratum.unit}. {missed}"
    if not said:
        return told
    least, most = min(ruling.values.miss for ruling in said), max(ruling.values.agreement for ruling in said)
    methods, motions = (", ".join(dict.fromkeys(getattr(each, name) for each in said)) for name in ("method", "about"))
    if erratum.by_tolerance is not None:
        return f"{told} Engines ({methods}; {motions}): the closed form misses their motion by {number(most)} at most."
    return (
        f"{told} Engines ({methods}; {motions}): the printed one misses their motion by {number(least)} or more, "
        f"the right one by {number(most)} at most."
    )


def words(material: Material) -> Mapping[str, Any]:
    """Values of the formulas, which are computed at once, and what engines say, from their stored motions."""
    lost: list[str] = []
    said = rulings(material.answers.items(), lost)
    told = [
        Told(
            erratum,
            verdict(erratum, erratum.values(), [ruling for ruling in said if ruling.number == erratum.number]),
            f"reports/pages/{SNIPPETS}/slip_{erratum.number:02}.py",
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
    title="Errata of the chapter",
    lesson="Printed slips of section 18.5 of a textbook, *advanced kinematics of planar motion*: each decided by a "
    "derivative, by engines, and by a few lines to run.",
    scenes=(),
    engines=(),
    companions=tuple(question.companion for question in QUESTIONS.values()),
    words=words,
    tasks=TASKS,
)
