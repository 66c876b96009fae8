"""The oracles of the search, in one table: a new one is a function and an entry here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from engines import Engine
from reference.mechanism import Mechanism
from reports.search import motions, relations
from reports.search.law import CheckSkipped, Errors, instant_errors
from reports.search.parts import Recipe
from reports.search.release import BESIDE_CURVED, CURVED

LAW_CHECKS = ("acceleration", CURVED, "velocity", "without velocity terms")


@dataclass(frozen=True)
class Oracle:
    """`errors` of an engine in a case: (error, tolerance) by check, or the reason why the oracle does not apply.

    `column`: the word of the page's table, which counts all `checks` of the oracle together; the checks of the oracle
    of motions are all others. `question`: the sentence of the page. `is_default`: used without the option --oracles.
    """

    column: str
    question: str
    errors: Callable[[Engine, Mechanism, Recipe, int], Errors | CheckSkipped]
    checks: tuple[str, ...] = ()
    is_default: bool = True


MOTION_ORACLE = "motions"
ORACLES: Mapping[str, Oracle] = {
    "instant": Oracle(
        "instant",
        "does the engine solve the equations that its settings stand for?",
        lambda engine, mechanism, recipe, number: instant_errors(engine, mechanism),
        (*LAW_CHECKS, "reaction", "as its groove pushes", BESIDE_CURVED),
    ),
    "relations": Oracle(
        "description",
        "is the motion the same where the same mechanism is described otherwise?",
        lambda engine, mechanism, recipe, number: relations.relation_errors(engine, recipe, number),
        relations.RELATIONS,
    ),
    MOTION_ORACLE: Oracle(
        "motion",
        "is it the motion of the exact judge, but for what the engine's order and softness admit?",
        lambda engine, mechanism, recipe, number: motions.motion_errors(engine, mechanism),
    ),
    "claims": Oracle(  # by its name alone: runs are as long as a user's, and cost as much
        "claim",
        "is an error that a method reports the error that it has?",
        lambda engine, mechanism, recipe, number: motions.claim_errors(engine, mechanism, number),
        (motions.CLAIMED_POSES, motions.CLAIMED_REACTIONS, motions.NEEDLESS_REPORT),
        is_default=False,
    ),
}
DEFAULT_ORACLES = tuple(name for name, oracle in ORACLES.items() if oracle.is_default)


def column_of(check: str) -> str:
    """The column in which the page counts a check."""
    named = (oracle.column for oracle in ORACLES.values() if check in oracle.checks)
    return next(named, ORACLES[MOTION_ORACLE].column)
