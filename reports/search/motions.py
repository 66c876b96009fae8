"""Convergence check. A short motion and its reactions are compared with the judge's at two or more steps.

The step is halved, at most to 1/FINEST_DIVISION, until poses and reactions converge with the engine's declared order.
Divergence at a long step is accepted if the motion converges at shorter steps. An error that does not converge is a
fault, unless it is noise (`reports.search.law`) or comes from the declared compliance. It is no fault either if a
textbook method of the same order does not converge.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, ConvergenceOrder, Engine, NotDeclared
from engines.constraint_error import FORCES, largest_force
from engines.lagrange import JUDGE_CLAIM, TRUTH
from engines.lagrange.dynamics import inverse_inertia
from engines.remembered import by_identity
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.gate.judge import TABLEAUS, giving_way, in_numpy, stepped
from reports.search.law import (
    CACHED_MECHANISMS,
    NOISE_MARGIN,
    CheckSkipped,
    Errors,
    Fault,
    difference,
    driving_force,
    force_difference,
    iter_nudged,
    turned_in_a_step,
)
from reports.search.relations import ESTIMATE_MARGIN

Array = NDArray[np.float64]
Floors = dict[str, float]

# Duration in units of the mechanism's time scale, which is too short for exponential growth of errors.
MOTION_SPAN = 0.4
MOTION_SAMPLES, COARSE_STEPS = 4, 10  # COARSE_STEPS is the number of steps between two samples.
# Largest ratio of an error to the error that the declared order predicts from the run with twice the step. The margin
# covers terms of higher order, and errors that are known at few samples (as in `engines.conformance.moving`).
ORDER_MARGIN = 2.5
# Smallest tolerances, relative to the motion. These tolerances cover rounding in combined runs and in drives of large
# inertias.
ERROR_FLOORS = {"motion": 1e-8, "reactions": 1e-5}
FINEST_DIVISION = 64
DIVERGED_ERROR = 10.0  # A run with a larger error, relative to the motion, has diverged.
DISTANT_POSE = 0.1  # Reactions are not compared if the pose error relative to the length scale is larger.
RIGID_COMPLIANCE = 1e-10  # A joint with a smaller compliance, in units of the squared time scale, counts as ideal.
ENGINE_WARNED = CheckSkipped("the engine warns that something is wrong")


@by_identity(CACHED_MECHANISMS)
def judge_motion(mechanism: Mechanism) -> Trajectory:
    return TRUTH.build(mechanism, MOTION_SPAN * mechanism.time_scale / MOTION_SAMPLES)(MOTION_SAMPLES, 1)


@by_identity(CACHED_MECHANISMS)
def _largest_turn(mechanism: Mechanism, dt: float) -> float:
    """The largest result of `turned_in_a_step` at the samples of the judge's motion."""
    truth = judge_motion(mechanism)
    return max(turned_in_a_step(mechanism, dt, *state) for state in zip(truth.pose, truth.twist, strict=True))


def motion_errors(engine: Engine, mechanism: Mechanism) -> Errors | CheckSkipped:
    """Check -> (error at the finest step, tolerance). The check "estimate" needs a run with an error estimate. Raises
    Fault if a run diverges without a warning."""
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.uses_contacts:
        return CheckSkipped("shapes in contact may separate, and a polygon does not roll like its curve")
    dt = MOTION_SPAN * mechanism.time_scale / MOTION_SAMPLES / COARSE_STEPS
    coarse = _run(engine, mechanism, dt, 1)
    promise = engine.order(mechanism)
    if isinstance(promise, NotDeclared):
        return CheckSkipped(f"the engine declares no order: {promise.reason}")
    if _has_lasting_compliance(engine, mechanism, dt):
        return CheckSkipped("joints give way by the declared compliance, at every step")
    truth = judge_motion(mechanism)
    if not np.isfinite(truth.pose).all():
        return CheckSkipped("the judge finds no motion")
    if truth.unresolved_at is not None:
        return CheckSkipped(f"the judge does not reach its tolerance of {JUDGE_CLAIM:g}")
    if _largest_turn(mechanism, dt) > 1:
        return CheckSkipped("something turns by more than a radian in a step, so no order is visible")
    case = _Case(engine, mechanism, promise, truth, dt)
    halved = case.halved(coarse)
    if isinstance(halved, CheckSkipped):
        return halved
    run, parts, out = halved
    reason = case.excuse(run, parts, out) if _fails(out) else None
    if reason is not None:
        return reason
    if run.estimate is not None:
        out["estimate"] = case.of_estimate(run, parts)
    return out


def _run(engine: Engine, mechanism: Mechanism, dt: float, parts: int) -> Trajectory:
    run = engine.build(mechanism, dt / parts)(MOTION_SAMPLES, parts * COARSE_STEPS)
    if run.estimate is not None and not run.warnings and not np.isfinite(run.pose).all():
        raise Fault(f"at a step of {dt / parts:.3g} s the motion diverged, and the error estimate gives no warning")
    return run


def _has_lasting_compliance(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether the compliance of the joints is large enough to matter and does not fall with the step."""
    coarse, fine = (engine.regularisation(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    at_coarse, at_fine = (soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine))
    return at_fine > RIGID_COMPLIANCE and 2 * at_fine > at_coarse


def _fails(found: Errors) -> bool:
    return any(not error <= bound for error, bound in found.values())


def _tolerance_for(promise: ConvergenceOrder, name: str, coarser: float, floor: float) -> float:
    order = promise.of("angle" if name == "motion" else "reaction")
    return min(max(ORDER_MARGIN * coarser * 0.5 ** min(order, 20.0), ERROR_FLOORS[name], floor), DIVERGED_ERROR)


@dataclass(frozen=True, eq=False)
class _Case:
    """A mechanism in an engine, with the judge's motion. `dt`: the largest step [s]."""

    engine: Engine
    mechanism: Mechanism
    promise: ConvergenceOrder
    truth: Trajectory
    dt: float

    @cached_property
    def size(self) -> float:
        """The largest displacement [m] with or without joints, but so large that rounding is below ERROR_FLOORS."""
        mechanism, arm = self.mechanism, np.array([1.0, 1.0, self.mechanism.length_scale])
        moved = float(np.abs((self.truth.pose - mechanism.pose) * arm).max())
        pulled = float(np.abs(mechanism.unconstrained(mechanism.pose, mechanism.twist) * arm).max())
        far = max(mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
        rounding = NOISE_MARGIN * np.finfo(float).eps * far / ERROR_FLOORS["motion"]
        return max(moved, pulled * (MOTION_SPAN * mechanism.time_scale) ** 2 / 2, rounding)

    @cached_property
    def forces(self) -> tuple[Array, ...]:
        acting = max(driving_force(self.mechanism, twist) for twist in self.truth.twist)
        arms = np.where(self.mechanism.is_angular, self.mechanism.length_scale, 1.0)
        return np.nan_to_num(self.truth.reaction), arms * max(acting, np.finfo(float).tiny)

    def apart(self, run: Trajectory, other: Trajectory | None = None) -> Floors:
        """Relative differences of a run from another run or from the judge's motion."""
        other = other or self.truth
        moved = run.pose[1:] - self.mechanism.pose, other.pose[1:] - self.mechanism.pose
        return {
            "motion": difference(self.mechanism, *moved, (np.array([[self.size, 0.0, 0.0]]),)),
            "reactions": force_difference(self.mechanism, run.reaction[1:], other.reaction[1:], self.forces),
        }

    def halved(self, run: Trajectory) -> tuple[Trajectory, int, dict[str, tuple[float, float]]] | CheckSkipped:
        """The run at the smallest step, its number of steps in `dt`, and (error, tolerance) by the declared order."""
        out: dict[str, tuple[float, float]] = {}
        parts, warned, silent, longest, coarse = 1, False, 0, 0, run
        while parts < FINEST_DIVISION and (not out or _fails(out)):
            parts *= 2
            finer = _run(self.engine, self.mechanism, self.dt, parts)
            if not out and (coarse.warnings or finer.warnings):
                return ENGINE_WARNED
            if finer.warnings:
                warned, silent = True, 0
                continue
            silent += 1
            longest = max(longest, silent)
            coarser, errors, run = self.apart(run), self.apart(finer), finer
            far = errors["motion"] * self.size > DISTANT_POSE * self.mechanism.length_scale
            for name, error in errors.items():
                floor = DIVERGED_ERROR if far and name == "reactions" else ERROR_FLOORS[name]
                is_comparable = floor < DIVERGED_ERROR and (coarser[name] < DIVERGED_ERROR or parts == FINEST_DIVISION)
                if is_comparable and (name not in out or not out[name][0] <= out[name][1]):
                    out[name] = (error, _tolerance_for(self.promise, name, coarser[name], floor))
        # An engine counts as silent only after two successive runs without a warning.
        if warned and longest < 2 and (_fails(out) or not np.isfinite(run.pose).all()):
            return ENGINE_WARNED
        return run, parts, out

    def excuse(self, run: Trajectory, parts: int, out: dict[str, tuple[float, float]]) -> CheckSkipped | None:
        """Add noise and declared compliance to the tolerances. Return a reason if the case must be skipped."""
        if not np.isfinite(run.pose).all():
            stricter = self.engine.stricter(self.mechanism)
            if stricter is not None and np.isfinite(_run(stricter, self.mechanism, self.dt, parts).pose).all():
                return CheckSkipped("the motion diverges, but not with a smaller tolerance of the solver")
            raise Fault(f"at a step of {self.dt / parts:.3g} s the motion diverged without a warning")
        noise = self.noise(run, parts)
        out |= {
            name: (error, max(bound, min(NOISE_MARGIN * noise[name], DIVERGED_ERROR)))
            for name, (error, bound) in out.items()
        }
        if _fails(out) and run.estimate is not None:
            out["motion"] = (out["motion"][0], max(out["motion"][1], self.estimated(run)))
        if _fails(out):
            out |= self.as_declared(run, parts)
        if _fails(out) and not self.resolved(parts):
            return CheckSkipped("a textbook method shows no order at these steps either")
        return None

    def noise(self, run: Trajectory, parts: int) -> Floors:
        """The largest changes by rounding, in the run and in the judge's motion, and by a smaller solver tolerance in
        the run."""
        pairs: list[tuple[Trajectory, Trajectory]] = []
        for nudged, back in iter_nudged(self.mechanism):
            truth = judge_motion.__wrapped__(nudged)  # pyright: ignore[reportFunctionMemberAccess]
            for plain, other in ((run, _run(self.engine, nudged, self.dt, parts)), (self.truth, truth)):
                pose, twist, reaction = back(other)
                pairs.append((replace(other, pose=pose, twist=twist, reaction=reaction), plain))
        stricter = self.engine.stricter(self.mechanism)
        if stricter is not None:
            pairs.append((_run(stricter, self.mechanism, self.dt, parts), run))
        differences = [self.apart(*pair) for pair in pairs]
        return {name: max(pair_difference[name] for pair_difference in differences) for name in ERROR_FLOORS}

    def resolved(self, parts: int) -> bool:
        """Whether a textbook method of the declared order (at most 4) has this order while the step is halved twice. No
        method converges, for example, if the length of a spring passes zero within a step and reverses its force."""
        usual = ConvergenceOrder(max((order for order in TABLEAUS if order <= self.promise.order), default=1))
        spacing, parts = MOTION_SPAN * self.mechanism.time_scale / MOTION_SAMPLES, max(4, parts)
        textbook = in_numpy if usual.order == 1 else stepped  # compiled code has no method of order 1
        try:
            runs = [
                textbook(self.mechanism, MOTION_SAMPLES, spacing, int(usual.order), n * COARSE_STEPS, None, True)
                for n in (parts // 4, parts // 2, parts)
            ]
        except ValueError:  # the curves have no contact at this pose
            return False
        differences = [self.apart(run) for run in runs]
        return not any(
            _fails({name: (fine[name], _tolerance_for(usual, name, coarse[name], ERROR_FLOORS[name])) for name in fine})
            for coarse, fine in pairwise(differences)
        )

    def as_declared(self, run: Trajectory, parts: int) -> dict[str, tuple[float, float]]:
        """Check -> (error, tolerance), from a run of the judge with the regularisation that the engine declares at this
        step.

        If the compliance depends on the step, its effect has the declared order only while the compliance is small. The
        judge is therefore run with the compliance and the steps of the engine. The tolerance is ORDER_MARGIN times the
        larger of two changes of the judge's run.
        The first change is that with doubled steps, since the engine integrates other coordinates. For the second
        change, the compliance is multiplied by the largest ratio of inverse inertias along the motion. The judge
        evaluates the inverse inertia at each pose, and MuJoCo only at the start.
        """
        mechanism, spacing = self.mechanism, MOTION_SPAN * self.mechanism.time_scale / MOTION_SAMPLES
        softness = self.engine.regularisation(mechanism, self.dt / parts)
        if softness is None or not softness.compliance:
            return {}
        order, gives = int(self.promise.step("angle")), giving_way(mechanism, softness)

        def run_judge(compliance: float, every: int) -> Trajectory:
            soft = replace(softness, compliance=compliance * softness.compliance)
            samples = MOTION_SAMPLES * COARSE_STEPS  # the largest ratio of inertias needs many samples
            return in_numpy(mechanism, samples, spacing / COARSE_STEPS, order, every, soft, least=0.0)

        try:
            right = run_judge(1.0, parts)
            products = [(rows / mechanism.inertias.reshape(-1)) @ rows.T for rows in mechanism.rows(right.pose)]
            share = np.array([inverse_inertia(product, gives, 0.0)[gives] for product in products])
            ratio = float((share.max(axis=0) / share.min(axis=0)).max())
            runs = right, run_judge(1.0, max(1, parts // 2)), run_judge(ratio, parts)
        except ValueError:  # the curves have no contact at this pose
            return {}
        names = ("t", "pose", "twist", "reaction")
        right, *others = (
            replace(soft, **{name: getattr(soft, name)[::COARSE_STEPS] for name in names}) for soft in runs
        )
        changes = [self.apart(other, right) for other in others]
        bounds = {
            name: max(least, ORDER_MARGIN * max(change[name] for change in changes))
            for name, least in ERROR_FLOORS.items()
        }
        return {name: (error, bounds[name]) for name, error in self.apart(run, right).items()}

    def estimated(self, run: Trajectory) -> float:
        """Tolerance from the error estimates of a run and of the judge, relative to the motion."""
        arm = np.array([1.0, 1.0, self.mechanism.length_scale])
        estimates = [
            np.abs(estimate * arm).max() for estimate in (run.estimate, self.truth.estimate) if estimate is not None
        ]
        return ESTIMATE_MARGIN * float(max(estimates)) / self.size + ERROR_FLOORS["motion"]

    def of_estimate(self, run: Trajectory, parts: int) -> tuple[float, float]:
        bound, missed = self.estimated(run), self.apart(run)["motion"]
        if missed > bound:
            bound = max(bound, NOISE_MARGIN * self.noise(run, parts)["motion"])
        return missed, min(bound, DIVERGED_ERROR)


CLAIM_SPAN = 2.0  # Duration in units of the mechanism's time scale.
# Choices for the number of steps in CLAIM_SPAN and for the steps between samples; the case's number selects one.
CLAIM_STEPS, SAMPLE_INTERVALS = (40, 100, 200), (1, 2, 5)
CLAIMED_POSES, CLAIMED_REACTIONS, NEEDLESS_REPORT = "claimed", "claimed of reactions", "reported, though right"


def claim_errors(engine: Engine, mechanism: Mechanism, number: int) -> Errors | CheckSkipped:
    """Errors of a method with an error estimate and the bounds that it claims, over a longer motion at usual steps.

    Until `unresolved_at` a method claims an error of at most CLAIM for poses, relative to a radian or the length scale.
    The claim for reactions is an error of at most FORCES, relative to the largest force, unless the method warns of
    reactions. Any other warning withdraws the claims for poses and for reactions. NEEDLESS_REPORT is 1 if a method
    warns although all poses are within the claim, else 0. A needless report is not a fault.
    """
    steps = CLAIM_STEPS[number % len(CLAIM_STEPS)]
    every = SAMPLE_INTERVALS[number // len(CLAIM_STEPS) % len(SAMPLE_INTERVALS)]
    dt = CLAIM_SPAN * mechanism.time_scale / steps
    run = engine.build(mechanism, dt)(steps // every, every)
    if run.estimate is None:
        return CheckSkipped("the method has no error estimate")
    truth = _long_judge_motion(mechanism)
    if truth.unresolved_at is not None or truth.warnings or not np.isfinite(truth.pose).all():
        return CheckSkipped(f"the judge does not reach its tolerance of {JUDGE_CLAIM:g}")
    return check_claims(mechanism, run, truth)


def check_claims(mechanism: Mechanism, run: Trajectory, truth: Trajectory) -> dict[str, tuple[float, float]]:
    """Check -> (error, claim). The judge's motion must contain the samples of the run."""
    at = np.linspace(0, len(truth.t) - 1, len(run.t)).round().astype(int)
    length, arm = mechanism.length_scale, np.where(mechanism.is_angular, mechanism.length_scale, 1.0)
    missed = np.nan_to_num(np.abs(run.pose - truth.pose[at]) / [length, length, 1.0], nan=np.inf).max(axis=(1, 2))
    until = run.t < (np.inf if run.unresolved_at is None else run.unresolved_at)
    of_reactions = run.warnings_of("reactions")
    has_reported = run.unresolved_at is not None or len(of_reactions) < len(run.warnings)
    out = {}
    if run.unresolved_at is not None or not has_reported:
        out[CLAIMED_POSES] = (float(missed[until].max(initial=0.0)), CLAIM)
    if missed.max() <= CLAIM:
        out[NEEDLESS_REPORT] = (float(has_reported), 1.0)
    if mechanism.row_count and not has_reported and not of_reactions:
        off = np.nan_to_num(run.reaction[1:] - truth.reaction[at][1:]) / arm
        largest = largest_force(mechanism, truth.pose[at], truth.twist[at], truth.reaction[at])
        out[CLAIMED_REACTIONS] = (float(np.abs(off).max()) / largest, FORCES)
    return out


@by_identity(CACHED_MECHANISMS)
def _long_judge_motion(mechanism: Mechanism) -> Trajectory:
    samples = int(np.lcm.reduce(CLAIM_STEPS))
    return TRUTH.build(mechanism, CLAIM_SPAN * mechanism.time_scale / samples)(samples, 1)
