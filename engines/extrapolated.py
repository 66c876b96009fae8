"""Richardson's extrapolation to zero step, around any engine: run it at several steps, keep what the steps agree on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, ConvergenceOrder, Engine, EngineWrapper, NotDeclared, OneShot, Run, Size
from engines.constraint_error import closing, reaction_doubts
from engines.contract import unresolved
from engines.richardson import (
    LEAST,
    combine,
    decided_error,
    differences,
    expected_error,
    extrapolation_weights,
    further_level,
)
from reference.checks import Count, InvalidMechanism, Name, Positive, Valid, validated
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

# Share of the claim from which a motion whose estimate passes the claim is unresolved. Fitted with richardson.LEAST.
EARLY = 1 / 30
# Multiples of the claim between which the estimate does not decide, and one more run does (`further_level`).
OPEN = (0.1, 30.0)
# Factor on the displacement that closes the joints. The displacement was 0.4 to 1.1 of the whole error in 57 motions of
# random mechanisms, near singular positions too.
RELEASED = 1.5
# rad: a line of a spring, damper or rod that turns further in one step of the coarsest run may be missed by all runs.
TURNED = 0.5
# Poses of bodies in each run that are compared at most: all steps of nearly every run.
WATCHED = 300_000


@runtime_checkable
class Watched(Protocol):
    """A run that can leave reactions out: NaN at all samples but each `each`-th."""

    def watched(self, samples: Count, every: Count, each: Count) -> Trajectory: ...


@runtime_checkable
class Settling(Protocol):
    """An engine with a start-up phase. It must last the same time at every level, else no error expansion exists."""

    def settled_for(self, steps: Count) -> Engine: ...


@dataclass(frozen=True)
class Extrapolated(EngineWrapper, Valid):
    """An engine in the sense of `engines.Engine` that runs another one at steps dt / level, and extrapolates.

    A sample is the linear combination of the runs' poses, twists and reactions that is free of errors in the `powers`
    of the step (L. F. Richardson, 1911): the powers that the inner engine's error has, one fewer than `levels`. A
    sample is NaN where one of the runs is not finite. The cost is the sum of all runs.

    The `estimate` is the larger of two: `expected_error` of the differences between successive columns of Richardson's
    table, with the rounding of all steps; and the displacement that would close the joints' gaps
    (`engines.constraint_error`), which shows errors that all runs share. Where the former is near `engines.CLAIM`, or
    where the last difference is far smaller than the ones before predict, one more run decides.

    The estimate is computed at every step of dt, independent of the sampling. Where it exceeds the claim, the motion is
    unresolved from the time `unresolved_at` at which it exceeds EARLY of the claim, with a warning. If a damper stops a
    motion within one step of the coarsest run, all runs may miss it, and the motion is unresolved from t = 0. Reactions
    with a large estimate of their own get a warning.

    Where the estimate exceeds the apparent error of the finest run (the distance to the extrapolation of the two
    finest), the runs have no error expansion: for example, one took another branch at a singular position. From there
    on the samples are those of the finest run, and the estimate is the largest distance of another run from it.

    Raises ValueError for levels that are not rising whole numbers or powers that do not fit them.
    """

    engine: Engine
    variant: Name
    levels: tuple[Count, ...]
    powers: tuple[Count, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, values in (("levels", self.levels), ("powers", self.powers)):
            if not (values and all(low < high for low, high in pairwise(values))):
                raise InvalidMechanism(
                    f"extrapolated: {name} are {values!r}; they must be whole numbers from 1, rising"
                )
        if len(self.levels) != len(self.powers) + 1:
            raise InvalidMechanism(
                f"extrapolated: {len(self.levels)} levels remove {len(self.levels) - 1} powers, "
                f"but powers are {self.powers!r}; give one power fewer than levels"
            )

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The power after those removed; rounding grows by the sum of the weights' sizes.

        Reactions that are a change of velocity over a step use the steps of the finest run. Their error has additional
        powers, so only twice the inner order is promised of them.
        """
        inner = self.engine.order(mechanism)
        if isinstance(inner, NotDeclared):
            return inner
        if inner.order != self.powers[0]:
            return NotDeclared(
                f"the engine inside has an error of order {inner.order:g} here, and this removes powers "
                f"from {self.powers[0]} on"
            )
        # Powers rise evenly: by one, or by two for a method that is symmetric in time.
        rises = [high - low for low, high in pairwise(self.powers)]
        return ConvergenceOrder(
            self.powers[-1] + (rises[-1] if rises else 1),
            reaction=2 * inner.order if inner.differences else None,
            differences=inner.differences * self.levels[-1],
            amplified=float(np.abs(extrapolation_weights(self.levels, self.powers)).sum()),
        )

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """All steps of all levels [s]."""
        return sum(self.levels) * self.engine.step_cost(mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> None:
        """Nothing is declared: a softness that is tied to the step is extrapolated too."""

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """One run a level."""
        return tuple(1 / level for level in self.levels)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Build the engine once a level; raises whatever it raises."""
        return ExtrapolatedRun(self, mechanism, dt)


class ExtrapolatedRun(OneShot):
    """The built models of all levels, ready to be stepped once; see `engines.Run`."""

    def __init__(self, method: Extrapolated, mechanism: Mechanism, dt: float) -> None:
        self._method, self._mechanism, self._dt = method, mechanism, dt
        self._levels, self._powers, self._unit = method.levels, method.powers, mechanism.pose_unit
        self._further = further_level(method.levels)
        self._runs = tuple(self._build_at(level) for level in method.levels)
        self.size: Size = self._runs[0].size

    def _build_at(self, level: int) -> Run:
        inner = self._method.engine
        engine = inner.settled_for(level) if isinstance(inner, Settling) else inner
        return engine.build(self._mechanism, self._dt / level)

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        self.begin()
        watched = _watched_every(samples, every, len(self._mechanism.bodies))
        stride = every // watched
        count, runs = samples * stride, zip(self._runs, self._levels, strict=True)
        parts = [_part(run, count, watched * level, stride) for run, level in runs]
        whole = self._combined(parts, watched, stride)
        spent = whole.stepping
        if not whole.warnings_of("unconverged") and self._is_open(whole, parts):
            further = _part(self._build_at(self._further), count, watched * self._further, stride)
            spent += further.stepping
            whole = self._combined(parts, watched, stride, further)
        sampled = {name: getattr(whole, name)[::stride] for name in ("t", "pose", "twist", "reaction", "estimate")}
        return replace(whole, **sampled, stepping=spent)

    def _is_open(self, whole: Trajectory, parts: list[Trajectory]) -> bool:
        """Whether another run decides: where the estimate is near the claim, where lines turn far in a step of the
        coarsest run, and where the last difference may be small by chance: at the ratio of the two before it, it would
        be near the claim.
        """
        low, high = OPEN
        if len(self._levels) < 3 or whole.estimate is None:
            return False
        largest = float(self._largest(whole.estimate)[-1])
        if whole.unresolved_at is None and largest < low * CLAIM:
            poses = np.stack([part.pose for part in parts]) / self._unit
            sizes = [float(difference.max()) for difference in differences(poses, self._levels, self._powers)]
            return len(sizes) > 2 and LEAST * sizes[-2] ** 2 > low * CLAIM * sizes[-3]
        return largest < high * CLAIM

    def _combined(
        self, parts: list[Trajectory], every: int, stride: int, further: Trajectory | None = None
    ) -> Trajectory:
        """The extrapolation of these runs, with `every` steps of dt between their times; `further`: the run that
        decides the estimate. Reactions are known at each `stride`-th time.
        """
        levels, powers = self._levels, self._powers
        weights = extrapolation_weights(levels, powers)
        poses, twists, reactions = (
            np.stack([getattr(part, name) for part in parts]) for name in ("pose", "twist", "reaction")
        )
        t, steps = parts[-1].t, (len(parts[-1].t) - 1) * every
        pose, twist, reaction = (combine(values, weights) for values in (poses, twists, reactions))
        estimate = self._estimate(poses, pose, steps)
        lost = (self._largest(estimate) > CLAIM) & self._has_no_expansion(poses, self._largest(estimate))
        if lost.any():
            since = int(np.argmax(lost))
            pose[since:], twist[since:], reaction[since:] = poses[-1, since:], twists[-1, since:], reactions[-1, since:]
            with np.errstate(all="ignore"):
                estimate[since:] = np.abs(poses[:-1, since:] - poses[-1, since:]).max(axis=0)
        elif further is not None:
            decided = decided_error(poses, pose, further.pose, levels, powers) + self._rounding(pose, steps)
            above = self._largest(estimate)[-1] > CLAIM
            estimate = decided if above else np.fmax(decided, estimate)
        estimate = np.maximum(estimate, RELEASED * np.abs(closing(self._mechanism, t, pose)))
        finest = (poses[-1, ::stride], twists[-1, ::stride], reactions[-1, ::stride])
        warnings = [warning for part in parts for warning in part.warnings]
        warnings += reaction_doubts(self._mechanism, *finest, expected_error(reactions[:, ::stride], levels, powers))
        missed = any(warning.time == 0 for part in parts for warning in part.warnings_of("unresolved"))
        coarsest = every * levels[0 if further is None else 1]
        unresolved_at = 0.0 if missed else self._unresolved_at(t, estimate, poses[-1], coarsest)
        if unresolved_at is not None:
            reason = "the runs are no series in the step" if lost.any() else "its own estimate is not below its claim"
            warnings.append(unresolved(unresolved_at, reason))
        resets = [part.reset_at for part in parts if part.reset_at is not None]
        return Trajectory(
            t=t,
            pose=pose,
            twist=twist,
            reaction=reaction,
            stepping=sum(part.stepping for part in parts),
            warnings=tuple(dict.fromkeys(warnings)),
            reset_at=min(resets, default=None),
            estimate=estimate,
            unresolved_at=unresolved_at,
        )

    def _unresolved_at(self, t: Array, estimate: Array, finest: Array, coarsest: int) -> float | None:
        """The first time [s] at which the claim is not held; None if there is none.

        `finest` are the finest run's poses; the coarsest run makes so many steps between two times.
        """
        if self._mechanism.applied.dissipate and self._dt / self._levels[0] > self._mechanism.time_scale:
            return 0.0
        largest = self._largest(estimate)
        turned = self._turned(finest) / coarsest > TURNED
        flags = ([largest > EARLY * CLAIM] if (largest > CLAIM).any() else []) + ([turned] if turned.any() else [])
        return min((float(t[np.argmax(flag)]) for flag in flags), default=None)

    def _estimate(self, poses: Array, pose: Array, steps: int) -> Array:
        """(times, bodies, 3) [m, m, rad] for poses (levels, times, bodies, 3) and what they are extrapolated to."""
        # The coarsest run may have another error in its first step than in all others: a gap is closed a step late, for
        # example. If that run alone is off, the extrapolation is off by the whole last difference.
        least = np.full(poses.shape[1], LEAST)
        least[: 2 if steps < len(least) else 1] = 1.0
        error = expected_error(poses / self._unit, self._levels, self._powers, least) * self._unit
        return error + self._rounding(pose, steps)

    def _rounding(self, pose: Array, steps: int) -> Array:
        """Each step rounds a pose, by half a unit at most, and the combination carries that with its weights."""
        weights = extrapolation_weights(self._levels, self._powers)
        carried = np.abs(weights) @ self._levels * np.finfo(float).eps / 2 * steps
        elapsed = np.linspace(0.0, 1.0, len(pose))[:, None, None]
        with np.errstate(all="ignore"):
            return carried * elapsed * np.maximum(np.abs(pose), self._unit)

    def _largest(self, estimate: Array) -> Array:
        """(times,) the largest so far, of a radian or of the mechanism's length: an error may pass zero later."""
        with np.errstate(all="ignore"):
            return np.fmax.accumulate((estimate / self._unit).max(axis=(1, 2)))

    def _has_no_expansion(self, poses: Array, largest: Array) -> NDArray[np.bool_]:
        """(times,) where the estimate exceeds the finest run's largest error so far. Two runs cannot show it."""
        if len(self._levels) < 3:
            return np.zeros(len(largest), dtype=bool)
        finer = combine(poses[-2:], extrapolation_weights(self._levels[-2:], self._powers[:1]))
        return largest > self._largest(np.abs(finer - poses[-1]))

    def _turned(self, pose: Array) -> Array:
        """(times,) by how much the line of any spring, damper or rod turns up to the next of these poses [rad]."""
        mechanism, out = self._mechanism, np.zeros(len(pose))
        lines = [part for part in (*mechanism.forces, *mechanism.joints) if part.acts_along_line]
        for line in lines:
            along = np.zeros(len(pose), dtype=complex)
            for (name, (x, y)), sign in zip(line.points, (-1.0, 1.0), strict=True):
                body = pose[:, mechanism.body_index(name)] if name else np.zeros((1, 3))
                with np.errstate(all="ignore"):
                    along += sign * (body[:, 0] + 1j * body[:, 1] + np.exp(1j * body[:, 2]) * complex(x, y))
            out[:-1] = np.fmax(out[:-1], np.abs(np.angle(along[1:] * np.conj(along[:-1]))))
        return out


def _watched_every(samples: int, every: int, bodies: int) -> int:
    """The steps between the instants that are compared: one, unless these are too many to be kept."""
    least = max(1, -(-samples * every * bodies // WATCHED))  # every / divisor <= WATCHED / (samples bodies)
    return next((part for part in range(least, every) if every % part == 0), every)


def _part(run: Run, samples: int, every: int, stride: int) -> Trajectory:
    """One level's run, with reactions at every `stride`-th sample: to compute them takes longer than to step."""
    return run.watched(samples, every, stride) if isinstance(run, Watched) else run(samples, every)
