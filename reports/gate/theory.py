"""The gate of theory: measured errors against bounds from convergence order, regularisation and rounding.

A `Case` is one scene in one method with its declared order. The grid consists of all cases.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from engines import EXACT, ConvergenceOrder, Engine, NotDeclared, Regularisation, method_name
from engines.motions import is_prescribed
from reference.scene import Scene
from reports.gate.judge import errors_as_soft
from reports.gate.prediction import Prediction, kinds, prediction
from reports.model.cells import FULL, QUICK, Cell, mechanism_of, sweep_cells
from reports.model.checks import Check, Deviation
from reports.model.convergence import ENOUGH_POINTS, ROOM_SOFT, Verdict, fit
from reports.model.measure import Measurement
from reports.model.outcomes import SATURATED, Outcome
from reports.model.page import Page
from reports.model.quantities import QUANTITY

# The observed order may be lower than the declared order by this difference. At an error of 0.1 rad the next power of
# the step is a tenth of the leading term. At a step half a decade smaller the next power is a thirtieth. The next power
# changes the observed order by up to 0.1. A last point slightly above rounding changes the order by a similar amount.
BELOW = 0.4
# The observed order may be higher than the declared order by this difference. A difference below 1 ensures that a
# declared order that is too low by 1 fails.
ABOVE = 0.95
# Angle errors [rad] above this value are not proportional to their cause, so they are left out of the fit of an order.
PROPORTIONAL = 0.1
TOO_FEW = "fewer than three steps have an error above rounding and below a tenth of a radian"


def order(promise: ConvergenceOrder | NotDeclared, rows: Sequence[Measurement]) -> tuple[Check, ...]:
    """The check of the observed convergence order. There is no check without a declared order. The measured value is
    the difference to the declared order divided by the allowed difference. An error that levels off, grows or is
    erratic has the order 0. With fewer than three usable points the bound is infinite, and the sentence of the check
    gives the reason."""
    if isinstance(promise, NotDeclared) or promise.order == EXACT:
        return ()
    usable = [row for row in rows if Outcome(row.outcome).comparable and row.angle <= PROPORTIONAL]
    rounding = QUANTITY["angle"].rounding
    fitted = fit([row.step for row in usable], [row.angle for row in usable], rounding)
    above = [row for row in usable if row.angle > rounding]
    if len(above) < ENOUGH_POINTS:
        return (Check("order", "angle", 0.0, math.inf, sentence=f", {TOO_FEW}"),)
    flat = fitted.verdict in (Verdict.PLATEAU, Verdict.LEVELS, Verdict.GROWS, Verdict.ERRATIC)
    observed = 0.0 if flat or fitted.points < 2 else fitted.order
    short = promise.order - observed
    value = f" at {fitted.plateau:.2g} rad" if fitted.verdict is Verdict.PLATEAU else f", order {observed:.2f}"
    measured = short / BELOW if short > 0 else -short / ABOVE
    return (Check("order", "angle", measured, 1.0, sentence=f", {fitted.verdict}{value}"),)


# Safety factor on the judge's error of the same order. Methods of one order have different error constants. For
# example, the constant of a spring that closes a gap in five steps is 5^2 / 2 at order 2. The errors of correct methods
# in the grid are at most 10 times the judge's error.
ROOM = 20.0
# Safety factor on the error that is predicted from a method's coarser steps. The factor allows for the next power of
# the step, and for a largest error at another sample. With a factor below 10^0.5, an error that is equal at the two
# finest steps fails even at first order.
ROOM_OWN = 2.5
# This factor replaces ROOM_OWN in a prescribed motion. In such a motion errors do not propagate, and the largest error
# is at the same time for every step. The factor allows for the next power of the step, which contributes 6 % in the
# driven four-bar at the coarsest step.
ROOM_PRESCRIBED = 1.25
# Number of coarser steps that are needed to predict an error. At a single step two errors may cancel.
ENOUGH = 2
# Without a declared order an error may be this many times the difference between the errors at the method's steps. If
# the step has a smaller effect, the model has an error that does not depend on the step.
ROOM_UNPROMISED = 20.0
# An error without a declared order passes if it is below this fraction of the largest comparable error. Small errors at
# two steps may be equal by chance.
SMALL = 1e-3


def terms(
    quantity: str,
    prediction: Prediction,
    promise: ConvergenceOrder,
    softness: Regularisation | None,
    step: float,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[float, float, float]:
    """The errors of discretisation, regularisation and rounding without safety factors. as_soft: see `theory`."""
    velocity = QUANTITY["velocity"].rounding
    rounding = velocity if quantity == "slip" else QUANTITY[quantity].rounding
    if quantity in ("rate", "velocity"):
        # Rounding of the pose changes velocities, see `Prediction.error`.
        rounding = max(rounding, prediction.speed / prediction.length * QUANTITY["angle"].rounding)
    if quantity not in ("gap", "reaction"):
        rounding *= promise.amplified  # The weights of an extrapolation amplify rounding.
    if quantity == "reaction" and promise.differences:  # A reaction is a change of velocity over the step.
        rounding += velocity * promise.amplified * promise.differences / step / prediction.acceleration
    if promise.of(quantity) == EXACT:
        return 0.0, 0.0, rounding
    cost = prediction.error(quantity, promise.step(quantity), step)
    cost += prediction.gap_closing_error(quantity, prediction.error("gap", promise.step("gap"), step), softness)
    if quantity == "reaction" and promise.differences:
        cost += prediction.differencing_error(promise.of(quantity), step)
    soft = prediction.softness_error(quantity, softness) if as_soft is None else as_soft[quantity]
    if promise.integrator is not None:
        soft += prediction.spring_transient_error(quantity, softness)
    return cost, soft, rounding


def theory(
    prediction: Prediction,
    promise: ConvergenceOrder | NotDeclared,
    softness: Regularisation | None,
    row: Measurement,
    coarser: Sequence[Measurement] = (),
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """The checks of the outcome and of each quantity of a row.

    coarser: rows of the same method at larger steps. The errors of these rows, scaled by the declared order, give a
    second bound. This bound needs ENOUGH rows, or one row if the judge's run has diverged. Without a declared order the
    bound follows from the differences between the errors at the method's steps.
    as_soft: the judge's errors with this regularisation, if errors are not proportional to the compliance. NaN
    fails unless the engine declares it. A check that does not apply has an infinite bound and gives the reason.
    """
    outcome = Outcome(row.outcome)
    if outcome is Outcome.UNSUPPORTED:
        return ()
    checks = [Check("outcome", "outcome", 0.0 if outcome.comparable else math.inf, 1.0, sentence=f", {row.outcome}")]
    usable = [other for other in coarser if other.step > row.step and Outcome(other.outcome).comparable]
    for quantity, facts in QUANTITY.items():
        name, measured = facts.check, getattr(row, quantity)
        reason = _reason_not_applicable(quantity, outcome, prediction, promise)
        if reason and (math.isnan(measured) or not outcome.comparable):
            checks.append(Check(name, quantity, 0.0, math.inf, sentence=f", {reason}"))
            continue
        if isinstance(promise, NotDeclared):
            bound, parts = _without_promise(quantity, prediction, [*usable, row])
        else:
            bound, parts = _promised(quantity, prediction, promise, softness, row, usable, as_soft)
        sentence = (
            ", the error is NaN, and the engine does not declare its order as NaN" if math.isnan(measured) else ""
        )
        checks.append(Check(name, quantity, measured, bound, parts, sentence))
    return tuple(checks)


def _reason_not_applicable(
    quantity: str, outcome: Outcome, prediction: Prediction, promise: ConvergenceOrder | NotDeclared
) -> str:
    if not outcome.comparable:
        return "the run is not comparable, so its outcome alone is checked"
    if not prediction.is_defined(quantity):
        return "the scene does not have this quantity"
    is_undeclared = isinstance(promise, ConvergenceOrder) and math.isnan(promise.of(quantity))
    return "the engine declares that it does not report it" if is_undeclared else ""


Bound = tuple[float, tuple[tuple[str, float], ...]]


def _promised(
    quantity: str,
    prediction: Prediction,
    promise: ConvergenceOrder,
    softness: Regularisation | None,
    row: Measurement,
    usable: Sequence[Measurement],
    as_soft: Mapping[str, float] | None,
) -> Bound:
    cost, soft, rounding = terms(quantity, prediction, promise, softness, row.step, as_soft)
    cost, soft = ROOM * cost, ROOM_SOFT * soft
    order = promise.of(quantity)
    rigid = prediction.prescribed and softness is None
    if order < EXACT and len(usable) >= (ENOUGH if math.isfinite(cost + soft) else 1):
        # The coarsest steps are left out, since the next power of the step is largest for them.
        nearest = sorted(usable, key=lambda other: other.step)[: ENOUGH if rigid else None]
        known = [getattr(other, quantity) * (row.step / other.step) ** order for other in nearest]
        room = ROOM_PRESCRIBED if rigid else ROOM_OWN
        own = room * max((value for value in known if not math.isnan(value)), default=math.inf)
        # If the judge's regularised run has diverged, only the method's coarser steps give the bound.
        cost, soft = (min(cost, own), soft) if math.isfinite(soft) else (own, 0.0)
    if rigid and order == 1 and promise.order > 1 and (lag := QUANTITY[quantity].lag):
        cost = min(cost, ROOM_PRESCRIBED * lag * row.step * prediction.lag[quantity])
    return (
        min(cost + soft + rounding, prediction.largest_comparable(quantity)),
        (("step", cost), ("softness", soft), ("rounding", rounding)),
    )


def _without_promise(quantity: str, prediction: Prediction, rows: Sequence[Measurement]) -> Bound:
    known = [error for row in rows if not math.isnan(error := getattr(row, quantity))]
    most = SATURATED if quantity == "reaction" else prediction.largest_comparable(quantity)
    differ = ROOM_UNPROMISED * (max(known) - min(known)) if len(known) > ENOUGH else math.inf
    return min(max(differ, SMALL * most), most), (("own steps", differ), ("least", SMALL * most))


def count_vacuous(checks: Iterable[Check]) -> Counter[str]:
    """Reason -> number of checks that cannot fail, since their bound is infinite."""
    return Counter(check.sentence.removeprefix(", ") or "no bound" for check in checks if math.isinf(check.bound))


# Steps per sample. The last number is finer than those of the quick report, since the order of a fast motion is
# observed only for steps below its time scale.
STEPS = (*QUICK, 3 * QUICK[-1])
FINER = (*FULL, 1000)
COST_LIMIT = 0.5  # A cell is left out if its estimated CPU time [s] is longer.


@dataclass(frozen=True)
class Case:
    """A scene in a method, with the declared order and the known deviations by the name of the check."""

    scene: Scene
    engine: Engine
    promise: ConvergenceOrder | NotDeclared
    known: tuple[tuple[str, Deviation], ...] = ()

    @property
    def method(self) -> str:
        return method_name(self.engine)

    @property
    def label(self) -> str:
        return f"{self.scene.name}-{self.method}"

    @property
    def ours(self) -> bool:
        """Whether scene and engine belong to this suite, since only rows of this suite are published."""
        return {type(each).__module__.partition(".")[0] for each in (self.scene, self.engine)} <= {
            "reference",
            "engines",
        }

    @property
    def amplified(self) -> float:
        return self.promise.amplified if isinstance(self.promise, ConvergenceOrder) else 1.0

    def cells(self) -> tuple[Cell, ...]:
        """The cells of the case, coarse steps first. In a prescribed motion a wrong mass changes only the reactions.
        Reactions of first order need finer steps, since their error is their change in a step."""
        mechanism = mechanism_of(self.scene)
        alone = (
            is_prescribed(mechanism) and isinstance(self.promise, ConvergenceOrder) and self.promise.of("reaction") == 1
        )
        rigid = self.engine.regularisation(mechanism, self.scene.spacing) is None
        steps = FINER if alone and rigid else STEPS
        return sweep_cells((self.scene,), (self.engine,), steps, COST_LIMIT, math.inf)


def cases(pages: Iterable[Page]) -> tuple[Case, ...]:
    """The cases of the grid. The page of a scene may declare an order, else the engine's declared order is used."""
    return tuple(
        _case(page, scene, engine) for page in pages for scene in page.scenes for engine in page.engines_of(scene)
    )


def _case(page: Page, scene: Scene, engine: Engine) -> Case:
    method = method_name(engine)
    known = {check: value for (name, of, check), value in page.known.items() if (name, of) == (scene.name, method)}
    promise = page.orders.get((scene.name, method)) or engine.order(mechanism_of(scene))
    return Case(scene, engine, promise, tuple(known.items()))


def predictions(chosen: Iterable[Case]) -> dict[Scene, frozenset]:
    """Scene -> the kinds of regularisation that the judge runs for these cases."""
    by_scene: dict[Scene, list[Engine]] = {}
    for case in chosen:
        by_scene.setdefault(case.scene, []).append(case.engine)
    return {scene: kinds(scene, engines) for scene, engines in by_scene.items()}


def own_softness(case: Case, rows: Sequence[Measurement], judge: Prediction) -> Regularisation | None:
    """The regularisation of a case if the judge needs a run with exactly these values, else None. In motions through
    singular positions errors are not proportional to the compliance."""
    softness = case.engine.regularisation(mechanism_of(case.scene), rows[-1].step)
    wanted = isinstance(case.promise, ConvergenceOrder) and Outcome(rows[-1].outcome).comparable
    return softness if wanted and not math.isfinite(judge.softness_error("angle", softness)) else None


def checks(
    case: Case,
    rows: Sequence[Measurement],
    judge: Prediction | None = None,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """The checks of theory at the finest step, and of the order over all rows. An unsupported case has no checks. rows:
    from coarse to fine steps. judge: the prediction for the scene, computed here if None. as_soft: the judge's errors
    with `own_softness`, computed here if None."""
    if judge is None:
        judge = prediction(case.scene, kinds(case.scene, [case.engine]))
    finest = rows[-1]
    softness = case.engine.regularisation(mechanism_of(case.scene), finest.step)
    own = own_softness(case, rows, judge)
    if own is not None and as_soft is None:
        as_soft = errors_as_soft(case.scene, own)
    at_finest = theory(judge, case.promise, softness, finest, rows[:-1], as_soft)
    return (*at_finest, *order(case.promise, rows)) if at_finest else ()
