"""The subjects of a search, which are engines with adapters and MuJoCo alone."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import ClassVar

import numpy as np

from engines import Engine, EngineWrapper, Unsupported
from reference.mechanism import Mechanism
from reports.search import mechanisms, motions, mujoco_alone, relations
from reports.search.law import CACHED_MECHANISMS, LAW_TOLERANCE, CheckSkipped, Errors, Fault, instant_errors
from reports.search.mechanisms import recipe_of_shape
from reports.search.parts import ALL_KINDS, Recipe
from reports.search.recipe import build
from reports.search.release import BESIDE_CURVED, CURVED, check_accelerations

OUR_ERROR = "our own error"  # name of the check for an exception outside of the engine


@dataclass(frozen=True)
class OracleResult:
    """The result of a case. `errors`: check -> (error, tolerance). `skipped`: reasons why oracles did not apply."""

    errors: dict[str, tuple[float, float]]
    skipped: tuple[str, ...] = ()
    words: str = ""  # message of a fault without a numerical error

    @property
    def faults(self) -> tuple[str, ...]:
        """The checks that fail; the worst check is first."""
        over = {
            name: error / bound if bound > 0 else np.inf
            for name, (error, bound) in self.errors.items()
            if not error <= bound
        }
        return tuple(sorted(over, key=lambda name: -over[name]))


@dataclass(frozen=True)
class Adapted:
    engine: Engine
    case: ClassVar[type] = Recipe
    kinds: ClassVar[tuple[str, ...]] = ALL_KINDS

    @property
    def name(self) -> str:
        return f"{self.engine.name} {self.engine.variant}"

    def draw(self, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> Recipe:
        if is_shaped(self):
            return recipe_of_shape(self.engine, seed, number, kinds, decades)
        return _cached_recipe(seed, number, kinds, decades)

    def ask(self, case: Recipe, number: int, oracles: Sequence[str]) -> OracleResult:
        """Run these oracles on one case. Raises InvalidMechanism for an invalid case."""
        arguments = self.engine, _cached_mechanism(case), case, number
        runs = {name: partial(oracle.errors, *arguments) for name, oracle in ORACLES.items() if name in oracles}
        return _run_oracles(runs, self.engine)


@dataclass(frozen=True)
class Alone:
    """MuJoCo without an adapter, with models in MuJoCo's format (`mujoco_alone`). `release`: a version such as "3.6.0",
    or "" for the installed release."""

    release: str = ""
    case: ClassVar[type] = mujoco_alone.RawModel
    kinds: ClassVar[tuple[str, ...]] = mujoco_alone.EQUALITY_KINDS

    @property
    def name(self) -> str:
        return f"mujoco alone {self.release}".strip()

    def draw(self, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> mujoco_alone.RawModel:
        return mujoco_alone.draw_model(seed, number, kinds)

    def ask(self, case: mujoco_alone.RawModel, number: int, oracles: Sequence[str]) -> OracleResult:
        def instant() -> Errors:
            errors = check_accelerations(case, self.release)["errors"]
            return {name: (error, LAW_TOLERANCE) for name, error in errors.items()}

        mujoco_alone.start_equations(case)  # raises InvalidMechanism for an invalid case
        return _run_oracles({"instant": instant} if "instant" in oracles else {}, None)


Subject = Adapted | Alone
# Mechanisms are cached, so that all engines share the tables of rolling curves and the judge's motion.
_cached_recipe = lru_cache(CACHED_MECHANISMS)(mechanisms.recipe)
_cached_mechanism = lru_cache(CACHED_MECHANISMS)(build)


def is_shaped(subject: Subject) -> bool:
    """Whether the engine compiles a model for each shape; its cases then have few shapes."""
    return isinstance(subject, Adapted) and subject.engine.build_time > 0


def _run_oracles(oracles: Mapping[str, Callable[[], Errors | CheckSkipped]], engine: Engine | None) -> OracleResult:
    """Run oracles. An exception gives the fault "raised" if code of the engine raised it, otherwise the fault
    OUR_ERROR.

    `engine`: the engine, or None for MuJoCo alone.
    """
    errors: dict[str, tuple[float, float]] = {}
    skipped: list[str] = []
    messages: list[str] = []
    with np.errstate(all="ignore"):
        for name, oracle in oracles.items():
            try:
                answer = oracle()
            except Unsupported as reason:
                return OracleResult(errors, (f"unsupported: {reason}",), "; ".join(messages))
            except Fault as reason:
                errors[name] = (np.inf, 0.0)
                messages.append(str(reason))
            except ImportError:  # a missing module is no fault of an engine
                raise
            except Exception as error:
                blamed = engine is not None and _passed_through(error, engine)
                errors["raised" if blamed else OUR_ERROR] = (np.inf, 0.0)
                messages.append(f"{'' if blamed else 'ours: '}{type(error).__name__}: {error}"[:300])
            else:
                if isinstance(answer, CheckSkipped):
                    skipped.append(f"{name}: {answer.reason}")
                else:
                    errors.update(answer)
    return OracleResult(errors, tuple(skipped), "; ".join(messages))


def _passed_through(error: Exception, engine: Engine) -> bool:
    """Whether the traceback of an exception contains code of the engine or of its wrappers."""
    modules = [type(engine).__module__]
    while isinstance(engine, EngineWrapper):
        engine = engine.engine
        modules.append(type(engine).__module__)
    # An engine is a package, or it is a single module of the package `engines`.
    owners = {module if module.count(".") < 2 else module.rpartition(".")[0] for module in modules}
    called = [frame.f_globals.get("__name__", "") for frame, _ in traceback.walk_tb(error.__traceback__)]
    return any(name == owner or name.startswith(f"{owner}.") for name in called for owner in owners)


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
        (*LAW_CHECKS, "reaction", BESIDE_CURVED),
    ),
    "relations": Oracle(
        "description",
        "is the motion independent of the description of the mechanism?",
        relations.relation_errors,
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
