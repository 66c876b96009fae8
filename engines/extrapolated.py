"""Richardson's extrapolation to zero step: runs of any engine at several steps are combined."""

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

# If the estimate exceeds the claim, `unresolved_at` is the time at which the estimate exceeds this share of the claim.
# The value was fitted together with richardson.LEAST.
EARLY = 1 / 30
# If the estimate is between these multiples of the claim, a further run decides it (`further_level`).
OPEN = (0.1, 30.0)
# Factor on the displacement that closes the joints. In 57 motions of random mechanisms, also near singular positions,
# the displacement was 0.4 to 1.1 of the whole error.
RELEASED = 1.5
# Largest resolved rotation [rad] of a spring, damper or rod in a step of the coarsest run. All runs may miss a faster
# motion.
TURNED = 0.5
# Largest number of body poses that are compared in a run. Most runs have fewer poses and are compared at all steps.
WATCHED = 300_000


@runtime_checkable
class Watched(Protocol):
    """A run that can skip reactions: it computes them at every `each`-th sample, and the others are NaN."""

    def watched(self, samples: Count, every: Count, each: Count) -> Trajectory: ...


@runtime_checkable
class Settling(Protocol):
    """An engine with a start-up phase.

    An error expansion exists only if this phase takes the same time at every level.
    """

    def settled_for(self, steps: Count) -> Engine: ...


@dataclass(frozen=True)
class Extrapolated(EngineWrapper, Valid):
    """An engine that runs another engine at steps dt / level and extrapolates the runs to zero step.

    Poses, twists and reactions are linear combinations of those of the runs (L. F. Richardson, 1911). The combination
    removes the `powers` of the step from the inner engine's error. There is one power fewer than `levels`. A result is
    NaN if a run is not finite.

    The `estimate` is the larger of two errors. One error is the `expected_error` from the differences in Richardson's
    table, with the rounding of all steps. The other error is the displacement that would close the joints' gaps
    (`engines.constraint_error`), since all runs may have the same gaps. A further run decides if the `expected_error`
    is near `engines.CLAIM`, or if the last difference is far smaller than the earlier differences predict.

    The estimate does not depend on the sampling. If it exceeds the claim, the run has a warning, and `unresolved_at` is
    the time at which the estimate exceeds EARLY times the claim. If a damper stops a motion within one step of the
    coarsest run, all runs may miss the motion, which is then unresolved from t = 0. The run also has a warning if the
    estimated error of reactions is large.

    The apparent error of the finest run is its difference from the extrapolation of the two finest runs. If the
    estimate exceeds the apparent error, the runs have no error expansion; for example, a run took another branch at a
    singular position. From then on the result is the finest run, and the estimate is its largest difference from
    another run.
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
        """The order is the first power that is not removed; rounding grows by the sum of the absolute weights.

        If reactions are changes of velocity, their error has more powers of the step. The declared order of reactions
        is therefore only twice the inner order.
        """
        inner = self.engine.order(mechanism)
        if isinstance(inner, NotDeclared):
            return inner
        if inner.order != self.powers[0]:
            return NotDeclared(
                f"the engine inside has an error of order {inner.order:g} here, and this removes powers "
                f"from {self.powers[0]} on"
            )
        # Powers increase by one, or by two for a method that is symmetric in time.
        rises = [high - low for low, high in pairwise(self.powers)]
        return ConvergenceOrder(
            self.powers[-1] + (rises[-1] if rises else 1),
            reaction=2 * inner.order if inner.differences else None,
            differences=inner.differences * self.levels[-1],
            amplified=float(np.abs(extrapolation_weights(self.levels, self.powers)).sum()),
        )

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        return sum(self.levels) * self.engine.step_cost(mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> None:
        """None, since a regularisation that depends on the step is extrapolated to zero step."""

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        return tuple(1 / level for level in self.levels)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        return ExtrapolatedRun(self, mechanism, dt)


class ExtrapolatedRun(OneShot):
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
        spacing = _steps_between_compared(samples, every, len(self._mechanism.bodies))
        stride = every // spacing
        count = samples * stride
        runs = [_run(run, count, spacing * level, stride) for run, level in zip(self._runs, self._levels, strict=True)]
        extrapolated = self._extrapolated(runs, spacing, stride)
        stepping = extrapolated.stepping
        if not extrapolated.warnings_of("unconverged") and self._needs_further_run(extrapolated, runs):
            further = _run(self._build_at(self._further), count, spacing * self._further, stride)
            stepping += further.stepping
            extrapolated = self._extrapolated(runs, spacing, stride, further)
        fields = ("t", "pose", "twist", "reaction", "estimate")
        sampled = {name: getattr(extrapolated, name)[::stride] for name in fields}
        return replace(extrapolated, **sampled, stepping=stepping)

    def _needs_further_run(self, extrapolated: Trajectory, runs: list[Trajectory]) -> bool:
        """Whether a further run decides the error.

        A further run is needed if the estimate is near the claim. The last difference may be small by chance. A further
        run is therefore also needed if the ratio of the two earlier differences predicts a last difference near the
        claim.
        """
        low, high = OPEN
        if len(self._levels) < 3 or extrapolated.estimate is None:
            return False
        largest = float(self._largest(extrapolated.estimate)[-1])
        if extrapolated.unresolved_at is None and largest < low * CLAIM:
            poses = np.stack([run.pose for run in runs]) / self._unit
            sizes = [float(difference.max()) for difference in differences(poses, self._levels, self._powers)]
            return len(sizes) > 2 and LEAST * sizes[-2] ** 2 > low * CLAIM * sizes[-3]
        return largest < high * CLAIM

    def _extrapolated(
        self, runs: list[Trajectory], every: int, stride: int, further: Trajectory | None = None
    ) -> Trajectory:
        """The extrapolation of runs with `every` steps of dt between their times.

        Reactions are known at every `stride`-th time. A run `further` decides the estimate.
        """
        levels, powers = self._levels, self._powers
        weights = extrapolation_weights(levels, powers)
        poses, twists, reactions = (
            np.stack([getattr(run, name) for run in runs]) for name in ("pose", "twist", "reaction")
        )
        t, steps = runs[-1].t, (len(runs[-1].t) - 1) * every
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
        warnings = [warning for run in runs for warning in run.warnings]
        warnings += reaction_doubts(self._mechanism, *finest, expected_error(reactions[:, ::stride], levels, powers))
        missed = any(warning.time == 0 for run in runs for warning in run.warnings_of("unresolved"))
        coarsest = every * levels[0 if further is None else 1]
        unresolved_at = 0.0 if missed else self._unresolved_at(t, estimate, poses[-1], coarsest)
        if unresolved_at is not None:
            reason = "the runs are no series in the step" if lost.any() else "its own estimate is not below its claim"
            warnings.append(unresolved(unresolved_at, reason))
        resets = [run.reset_at for run in runs if run.reset_at is not None]
        return Trajectory(
            t=t,
            pose=pose,
            twist=twist,
            reaction=reaction,
            stepping=sum(run.stepping for run in runs),
            warnings=tuple(dict.fromkeys(warnings)),
            reset_at=min(resets, default=None),
            estimate=estimate,
            unresolved_at=unresolved_at,
        )

    def _unresolved_at(self, t: Array, estimate: Array, finest: Array, coarsest: int) -> float | None:
        """The first time [s] at which the error may exceed the claim, or None.

        finest (times, bodies, 3): poses of the finest run.
        coarsest: number of steps of the coarsest run between two times.
        """
        if self._mechanism.applied.dissipate and self._dt / self._levels[0] > self._mechanism.time_scale:
            return 0.0
        largest = self._largest(estimate)
        turned = self._line_rotation(finest) / coarsest > TURNED
        flags = ([largest > EARLY * CLAIM] if (largest > CLAIM).any() else []) + ([turned] if turned.any() else [])
        return min((float(t[np.argmax(flag)]) for flag in flags), default=None)

    def _estimate(self, poses: Array, pose: Array, steps: int) -> Array:
        # In its first step the coarsest run may have an unusually large error; for example, it closes a gap one step
        # late. If the coarsest run alone is wrong, the last difference is the whole error of the extrapolation.
        least = np.full(poses.shape[1], LEAST)
        least[: 2 if steps < len(least) else 1] = 1.0
        error = expected_error(poses / self._unit, self._levels, self._powers, least) * self._unit
        return error + self._rounding(pose, steps)

    def _rounding(self, pose: Array, steps: int) -> Array:
        """The sum of the steps' rounding errors, half a unit in the last place of a pose, times the weights."""
        weights = extrapolation_weights(self._levels, self._powers)
        carried = np.abs(weights) @ self._levels * np.finfo(float).eps / 2 * steps
        elapsed = np.linspace(0.0, 1.0, len(pose))[:, None, None]
        with np.errstate(all="ignore"):
            return carried * elapsed * np.maximum(np.abs(pose), self._unit)

    def _largest(self, estimate: Array) -> Array:
        """The largest estimate up to each time (times,) [rad, mechanism's lengths], since errors may cross zero."""
        with np.errstate(all="ignore"):
            return np.fmax.accumulate((estimate / self._unit).max(axis=(1, 2)))

    def _has_no_expansion(self, poses: Array, largest: Array) -> NDArray[np.bool_]:
        if len(self._levels) < 3:
            return np.zeros(len(largest), dtype=bool)
        finer = combine(poses[-2:], extrapolation_weights(self._levels[-2:], self._powers[:1]))
        return largest > self._largest(np.abs(finer - poses[-1]))

    def _line_rotation(self, pose: Array) -> Array:
        """The largest rotation of a spring, damper or rod between each pose and the next one (times,) [rad]."""
        mechanism, out = self._mechanism, np.zeros(len(pose))
        for line in (element for element in (*mechanism.forces, *mechanism.joints) if element.acts_along_line):
            along = np.zeros(len(pose), dtype=complex)
            for (name, (x, y)), sign in zip(line.points, (-1.0, 1.0), strict=True):
                body = pose[:, mechanism.body_index(name)] if name else np.zeros((1, 3))
                with np.errstate(all="ignore"):
                    along += sign * (body[:, 0] + 1j * body[:, 1] + np.exp(1j * body[:, 2]) * complex(x, y))
            out[:-1] = np.fmax(out[:-1], np.abs(np.angle(along[1:] * np.conj(along[:-1]))))
        return out


def _steps_between_compared(samples: int, every: int, bodies: int) -> int:
    least = max(1, -(-samples * every * bodies // WATCHED))
    return next((count for count in range(least, every) if every % count == 0), every)


def _run(run: Run, samples: int, every: int, stride: int) -> Trajectory:
    return run.watched(samples, every, stride) if isinstance(run, Watched) else run(samples, every)
