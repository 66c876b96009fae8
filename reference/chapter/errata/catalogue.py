"""The chapter's printed slips as computations: the printed formula taken literally, the right one, and what decides.

Nothing is left to opinion: what decides is the derivative of a position (for a skate, of a velocity), taken
numerically without any of the formulas in question (`reference.numerics.calculus`).
"""

from __future__ import annotations

from dataclasses import dataclass

from reference.chapter.errata.erratum import Erratum, Values
from reference.chapter.errata.linkages import FOUR_BAR_ERRATA, PENDULUM_ERRATA
from reference.chapter.errata.rolling_and_skates import ROLLING_ERRATA, SKATE_ERRATA
from reference.numerics.calculus import derivative

ERRATA: tuple[Erratum, ...] = (*ROLLING_ERRATA, *SKATE_ERRATA, *FOUR_BAR_ERRATA, *PENDULUM_ERRATA)


@dataclass(frozen=True)
class WordSlip:
    """A slip in words, in which there is nothing to compute."""

    number: int
    where: str
    printed: str
    right: str
    reason: str


WORD_SLIPS = (
    WordSlip(
        10,
        "body curve and space curve, names",
        'the space curve and the body curve (or "polohodie" and "herpolhodie")',
        "herpolhode and polhode, in this order",
        "names exchanged and misspelled: the polhode is the body's curve, the herpolhode the ground's",
    ),
    WordSlip(
        18,
        "sample 18.15, before the equations",
        "to be able to find thetadot, beta(t) and phi(t)",
        "to be able to find theta(t), beta(t) and phi(t)",
        "thetadot is given; its integral is what is found with the other two",
    ),
)

__all__ = ["ERRATA", "WORD_SLIPS", "Erratum", "Values", "WordSlip", "derivative"]
