"""The gate of theory: what a method's order, its softness and rounding may cost in a scene, against what it cost.

`Case` is one scene in one method, with what is promised of it; the grid is all of them.
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
from reports.model.convergence import ENOUGH as ENOUGH_POINTS
from reports.model.convergence import ROOM_SOFT, Verdict, fit
from reports.model.measure import Measurement
from reports.model.outcomes import SATURATED, Outcome
from reports.model.page import Page
from reports.model.quantities import QUANTITIES

# An observed order may lie this much below the promised one: at a tenth of a radian the next power is a tenth of the
# leading one, half a decade on a thirtieth, and 10^0.5 in steps turns that into 0.1; the sign of it is unknown. A last
# point a few times above rounding takes about as much again.
BELOW = 0.4
# And this much above it: a promise that is one too low is noticed.
ABOVE = 0.95
# Errors above this [rad] are not proportional to what causes them, so no order is read from them.
PROPORTIONAL = 0.1
TOO_FEW = "fewer than three steps have an error above rounding and below a tenth of a radian"


def order(promise: ConvergenceOrder | NotDeclared, rows: Sequence[Measurement]) -> tuple[Check, ...]:
    """The check of one method's rows, if they can tell: three points that are above rounding and small enough. With
    fewer it can't fail, and says so.

    measured: how far the observed order is from the promised one, in multiples of what it may be. An error that levels
    off, grows or jumps about has the order 0.
    """
    if isinstance(promise, NotDeclared) or promise.order == EXACT:
        return ()
    usable = [row for row in rows if Outcome(row.outcome).comparable and row.angle <= PROPORTIONAL]
    found = fit([row.step for row in usable], [row.angle for row in usable], ROUNDING["angle"])
    above = [row for row in usable if row.angle > ROUNDING["angle"]]
    if len(above) < ENOUGH_POINTS:
        return (Check("order", "angle", 0.0, math.inf, sentence=f", {TOO_FEW}"),)
    flat = found.verdict in (Verdict.PLATEAU, Verdict.LEVELS, Verdict.GROWS, Verdict.ERRATIC)
    observed = 0.0 if flat or found.points < 2 else found.order
    short = promise.order - observed
    value = f" at {found.plateau:.2g} rad" if found.verdict is Verdict.PLATEAU else f", order {observed:.2f}"
    told = f", {found.verdict}{value}"
    return (Check("order", "angle", short / BELOW if short > 0 else -short / ABOVE, 1.0, sentence=told),)


ROUNDING = {quantity.name: quantity.rounding for quantity in QUANTITIES}
CHECK_OF = {quantity.name: quantity.check for quantity in QUANTITIES}


# Room above the judge's own error of the same order. Methods of one order differ in their constants: a spring of five
# steps has 5^2 / 2 at second order, and the grid's right methods lie within a decade of the judge, most within a third
# of one. It is narrow enough only because a method's own coarser steps bound it too.
ROOM = 20.0
# Room above what a method's own coarser steps let expect of a finer one: their constant is known, and what is left is
# the next power of the step, and that a largest error over samples is met at another one. It is below the three of half
# a decade, so that an error that stays is seen between the two finest steps even at first order.
ROOM_OWN = 2.5
# The same where the motion is prescribed: nothing carries an early error on, so an error is what its own instant makes
# of the step, and the largest is met at the same instant at every step. What is left is the next power: in the driven
# four-bar 6 % of the first at the coarsest step, by the judge's two orders, and less at finer ones.
ROOM_PRESCRIBED = 1.25
# Where a motion is prescribed a pose has no error of the first order, so the velocity that led to it is the mean one of
# its step: that of half a step earlier. Energies are of these velocities, slips and reactions of an instant within the
# step. Parts of a step.
MIDDLE = {"rate": 0.5, "velocity": 0.5, "energy": 0.5, "slip": 1.0, "reaction": 1.0}
# Coarser steps that tell what a method costs: at a single one two errors may cancel by luck.
ENOUGH = 2
# A method without a promise. Room above what its own steps differ by: where no step changes an error by a twentieth of
# it the model is another one. Errors below this part of what there is are let through, since two may be equal by luck;
# and half of the largest reaction is as much as half a radian.
ROOM_UNPROMISED = 20.0
SMALL = 1e-3


def terms(
    quantity: str,
    prediction: Prediction,
    promise: ConvergenceOrder,
    softness: Regularisation | None,
    step: float,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[float, float, float]:
    """What step, softness and rounding cost in a quantity, before any room is given; `as_soft`: see `theory`."""
    rounding = ROUNDING["velocity" if quantity == "slip" else quantity]
    if quantity in ("rate", "velocity"):
        # What is rounded in a pose shows in velocities as the motion takes it on; see `Prediction.error`.
        rounding = max(rounding, prediction.speed / prediction.length * ROUNDING["angle"])
    if quantity not in ("gap", "reaction"):
        # The weights of a combination of runs carry the rounding of poses as they carry that of velocities.
        rounding *= promise.amplified
    if quantity == "reaction" and promise.differences:
        # A change of velocity: a combination of runs carries its rounding as it carries that of velocities.
        carried = ROUNDING["velocity"] * promise.amplified
        rounding += carried * promise.differences / step / prediction.acceleration
    if promise.of(quantity) == EXACT:
        return 0.0, 0.0, rounding
    cost = prediction.error(quantity, promise.step(quantity), step)
    cost += prediction.closing(quantity, prediction.error("gap", promise.step("gap"), step), softness)
    if quantity == "reaction" and promise.differences:
        cost += prediction.differenced(promise.of(quantity), step)
    soft = prediction.give(quantity, softness) if as_soft is None else as_soft[quantity]
    if promise.integrator is not None:
        soft += prediction.settling(quantity, softness)
    return cost, soft, rounding


def theory(
    prediction: Prediction,
    promise: ConvergenceOrder | NotDeclared,
    softness: Regularisation | None,
    row: Measurement,
    coarser: Sequence[Measurement] = (),
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """The checks of one row, one for each quantity; a run that can't be compared fails by its outcome alone.

    `coarser`: the same method's rows at larger steps. What they cost, scaled by the promised order, bounds the row too
    where they are ENOUGH, or where the judge itself has lost the motion. Where no order is promised, what the method's
    steps change in an error bounds it.
    `as_soft`: the judge's errors with this very softness, where no other tells of it in proportion.
    A number that is none fails, unless the engine says that it can't tell it. Checks that can't fail have an infinite
    bound and say why; `idle` counts them.
    """
    outcome = Outcome(row.outcome)
    if outcome is Outcome.UNSUPPORTED:
        return ()
    checks = [Check("outcome", "outcome", 0.0 if outcome.comparable else math.inf, 1.0, sentence=f", {row.outcome}")]
    usable = [other for other in coarser if other.step > row.step and Outcome(other.outcome).comparable]
    for quantity in (each.name for each in QUANTITIES):
        name, measured = CHECK_OF[quantity], getattr(row, quantity)
        reason = _reason_not_applicable(quantity, outcome, prediction, promise)
        if reason and (math.isnan(measured) or not outcome.comparable):
            checks.append(Check(name, quantity, 0.0, math.inf, sentence=f", {reason}"))
            continue
        if isinstance(promise, NotDeclared):
            bound, parts = _without_promise(quantity, prediction, [*usable, row])
        else:
            bound, parts = _promised(quantity, prediction, promise, softness, row, usable, as_soft)
        sentence = ", no number: who can't tell it promises NaN of it" if math.isnan(measured) else ""
        checks.append(Check(name, quantity, measured, bound, parts, sentence))
    return tuple(checks)


def _reason_not_applicable(
    quantity: str, outcome: Outcome, prediction: Prediction, promise: ConvergenceOrder | NotDeclared
) -> str:
    """Why there need not be a number that a check could hold; "" where there has to be one."""
    if not outcome.comparable:
        return "the run can't be compared, so its outcome alone is held"
    if not prediction.has(quantity):
        return "the scene has no such number"
    untold = isinstance(promise, ConvergenceOrder) and math.isnan(promise.of(quantity))
    return "the engine says that it can't tell it" if untold else ""


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
        # The next power has its largest share in the coarsest steps.
        nearest = sorted(usable, key=lambda other: other.step)[: ENOUGH if rigid else None]
        known = [getattr(other, quantity) * (row.step / other.step) ** order for other in nearest]
        room = ROOM_PRESCRIBED if rigid else ROOM_OWN
        own = room * max((value for value in known if not math.isnan(value)), default=math.inf)
        # Where the judge's soft run lost the motion, the method's own steps are all that is known.
        cost, soft = (min(cost, own), soft) if math.isfinite(soft) else (own, 0.0)
    if rigid and order == 1 and promise.order > 1:
        cost = min(cost, ROOM_PRESCRIBED * MIDDLE[quantity] * row.step * prediction.earlier[quantity])
    return (
        min(cost + soft + rounding, prediction.refused(quantity)),
        (("step", cost), ("softness", soft), ("rounding", rounding)),
    )


def _without_promise(quantity: str, prediction: Prediction, rows: Sequence[Measurement]) -> Bound:
    """By what the method's own steps differ: a smaller one is what a larger one is wrong against."""
    known = [error for row in rows if not math.isnan(error := getattr(row, quantity))]
    most = SATURATED if quantity == "reaction" else prediction.refused(quantity)
    differ = ROOM_UNPROMISED * (max(known) - min(known)) if len(known) > ENOUGH else math.inf
    return min(max(differ, SMALL * most), most), (("own steps", differ), ("least", SMALL * most))


def idle(checks: Iterable[Check]) -> Counter[str]:
    """How many checks can't fail, by the reason: those with an infinite bound."""
    return Counter(check.sentence.removeprefix(", ") or "no bound" for check in checks if math.isinf(check.bound))


# The report's quick steps, and one finer where it is cheap (COST_LIMIT: one run's estimated seconds): the order of a
# fast motion shows only below its time scale.
STEPS = (*QUICK, 3 * QUICK[-1])
FINER = (*FULL, 1000)
COST_LIMIT = 0.5


@dataclass(frozen=True)
class Case:
    """One scene in one method: what is promised, and which checks (by name) are known to be missed."""

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
        """Whether scene and engine are those of this suite, whose rows are published."""
        return {type(each).__module__.partition(".")[0] for each in (self.scene, self.engine)} <= {
            "reference",
            "engines",
        }

    @property
    def amplified(self) -> float:
        """How many times the usual rounding of velocities the method carries."""
        return self.promise.amplified if isinstance(self.promise, ConvergenceOrder) else 1.0

    def cells(self) -> tuple[Cell, ...]:
        """What is run of it, coarse steps first.

        In a motion that is prescribed a wrong mass shows in the reactions alone, so those of first order, which are
        wrong by as much as they change in a step, need finer ones.
        """
        mechanism = mechanism_of(self.scene)
        alone = (
            is_prescribed(mechanism) and isinstance(self.promise, ConvergenceOrder) and self.promise.of("reaction") == 1
        )
        rigid = self.engine.regularisation(mechanism, self.scene.spacing) is None
        steps = FINER if alone and rigid else STEPS
        return sweep_cells((self.scene,), (self.engine,), steps, COST_LIMIT, math.inf)


def cases(pages: Iterable[Page]) -> tuple[Case, ...]:
    """The grid: what an engine promises of a scene's mechanism, unless the page knows better of that motion."""
    return tuple(
        _case(page, scene, engine) for page in pages for scene in page.scenes for engine in page.engines_of(scene)
    )


def _case(page: Page, scene: Scene, engine: Engine) -> Case:
    method = method_name(engine)
    known = {check: value for (name, own, check), value in page.known.items() if (name, own) == (scene.name, method)}
    promise = page.orders.get((scene.name, method)) or engine.order(mechanism_of(scene))
    return Case(scene, engine, promise, tuple(known.items()))


def predictions(chosen: Iterable[Case]) -> dict[Scene, frozenset]:
    """Scene -> the kinds of softness that these cases ask the judge for."""
    by_scene: dict[Scene, list[Engine]] = {}
    for case in chosen:
        by_scene.setdefault(case.scene, []).append(case.engine)
    return {scene: kinds(scene, engines) for scene, engines in by_scene.items()}


def own_softness(case: Case, rows: Sequence[Measurement], judge: Prediction) -> Regularisation | None:
    """The softness of a case whose cost no other softness tells of, so that the judge has to run with it; else None.

    Through singular positions nothing is in proportion to softness.
    """
    softness = case.engine.regularisation(mechanism_of(case.scene), rows[-1].step)
    wanted = isinstance(case.promise, ConvergenceOrder) and Outcome(rows[-1].outcome).comparable
    return softness if wanted and not math.isfinite(judge.give("angle", softness)) else None


def checks(
    case: Case,
    rows: Sequence[Measurement],
    judge: Prediction | None = None,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """Theory at the finest step and the order over all, of a case's rows from coarse to fine; none if unsupported.

    `judge`: the scene's prediction, `as_soft`: its errors with `own_softness`; worked out here unless they are given.
    """
    if judge is None:
        judge = prediction(case.scene, kinds(case.scene, [case.engine]))
    finest = rows[-1]
    softness = case.engine.regularisation(mechanism_of(case.scene), finest.step)
    own = own_softness(case, rows, judge)
    if own is not None and as_soft is None:
        as_soft = errors_as_soft(case.scene, own)
    found = theory(judge, case.promise, softness, finest, rows[:-1], as_soft)
    return (*found, *order(case.promise, rows)) if found else ()
