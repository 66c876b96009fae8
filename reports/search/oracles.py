"""The table of the search's oracles."""

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
    """A kind of check. `errors` returns (error, tolerance) by check, or the reason why the oracle does not apply.
    `column`: heading of a column on the page, which counts the cases of all `checks` together. `question`: sentence on
    the page. `is_default`: whether a search without the option --oracles uses the oracle. Checks that no oracle lists
    belong to MOTION_ORACLE.
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
        "does the engine solve the equations that it declares for its settings?",
        lambda engine, mechanism, recipe, number: instant_errors(engine, mechanism),
        (*LAW_CHECKS, "reaction", "as its groove pushes", BESIDE_CURVED),
    ),
    "relations": Oracle(
        "description",
        "is the motion independent of the description of the mechanism?",
        lambda engine, mechanism, recipe, number: relations.relation_errors(engine, recipe, number),
        relations.RELATIONS,
    ),
    MOTION_ORACLE: Oracle(
        "motion",
        "does the motion converge to the judge's motion with the declared order and compliance?",
        lambda engine, mechanism, recipe, number: motions.motion_errors(engine, mechanism),
    ),
    "claims": Oracle(  # not a default oracle, since its runs are long
        "claim",
        "is the error of a method within the bound that the method claims?",
        lambda engine, mechanism, recipe, number: motions.claim_errors(engine, mechanism, number),
        (motions.CLAIMED_POSES, motions.CLAIMED_REACTIONS, motions.NEEDLESS_REPORT),
        is_default=False,
    ),
}
DEFAULT_ORACLES = tuple(name for name, oracle in ORACLES.items() if oracle.is_default)


def column_of(check: str) -> str:
    named = (oracle.column for oracle in ORACLES.values() if check in oracle.checks)
    return next(named, ORACLES[MOTION_ORACLE].column)
