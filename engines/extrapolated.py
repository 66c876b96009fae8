"""Richardson's extrapolation to zero step, around any engine: run it at several steps, keep what the steps agree on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, isqrt
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Around, Engine, OneShot, Promise, Run, Size, Unpromised
from engines.constraint_error import closing, reaction_doubts
from engines.finer import Division, division, tells_itself
from reference.checks import Count, InvalidMechanism, Name, Numbers, Positive, Valid, validated
from reference.forces import Damper, Spring
from reference.joints import Rod
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

# How many times the next difference that successive ones let expect counts as the error; what of the last difference
# counts at least; and from which share of the claim on poses are unresolved where an estimate passes it, as errors rise
# before it does. LEAST and EARLY are fitted on 1300 random mechanisms of all kinds with three steps each (seeds 7001,
# 31153099 and 601) in pymunk, Exudyn and Bullet.
CAUTION, LEAST, EARLY = 4, 0.5, 1 / 30
# Between these multiples of the claim the estimate does not decide: a run with shorter steps than all others does, in
# the place of the coarsest one, at half of the cost of them all. That extrapolation is better by the ratio of their
# steps, six, so that the difference is the error but for a fifth: DECIDED allows for more than twice that.
OPEN, DECIDED = (0.1, 30.0), 1.5
# How many times the displacement that closes joints counts as an error. It was 0.4 to 1.1 of the whole in 57 motions of
# random mechanisms with errors above 1e-9, near singular positions too.
RELEASED = 1.5
# A series in the step needs steps that are short against what happens. Where the line of a spring, a damper or a rod
# turns by more than this [rad] in a step of the coarsest run, all runs may miss alike.
UNRESOLVED = "ours: unresolved from 0 s on"
# How the warning of a run begins whose solver iterations leave a part of the slowest mode at every step: shorter steps,
# and more runs, leave it too.
UNCONVERGED = "ours: not converged"
TURNED = 0.5
# Poses of bodies, in each run, that are held against each other at most: all steps of nearly every run.
WATCHED = 300_000


@validated
def extrapolation_weights(levels: tuple[Count, ...], powers: tuple[Count, ...]) -> Array:
    """Weights w (levels,) of runs at steps dt / level: sum w = 1, and sum w level^-power = 0 for every power."""
    if len(set(levels)) != len(levels) or len(set(powers)) != len(powers) or len(levels) != len(powers) + 1:
        raise InvalidMechanism(
            f"extrapolation: levels are {levels!r} and powers {powers!r}; all must differ, with one power fewer"
        )
    steps = levels[0] / np.array(levels, dtype=float)
    matrix = np.array([steps**power for power in (0, *powers)])
    return np.linalg.solve(matrix, np.eye(len(levels))[0])


@runtime_checkable
class Watched(Protocol):
    """A run that can leave reactions out: NaN at all samples but each `each`-th."""

    def watched(self, samples: Count, every: Count, each: Count) -> Trajectory: ...


@runtime_checkable
class Settling(Protocol):
    """An engine whose first steps differ from the others. What is left when they end is a series in the step only if
    they last as long in all runs.
    """

    def settled_for(self, steps: Count) -> Engine: ...


@dataclass(frozen=True)
class Extrapolated(Around, Valid):
    """An engine in the sense of `engines.Engine` that runs another one at steps dt / level, and extrapolates.

    A sample is the linear combination of the runs' poses, twists and reactions that is free of errors in the `powers`
    of the step (L. F. Richardson, 1911): they must be the powers that the inner engine's error really has, one fewer
    than `levels`. A sample is NaN wherever one of the runs is not finite. The cost is the sum of all.

    The `estimate` is the larger of two: `expected_error` of the differences between successive columns of Richardson's
    table, with the rounding of all steps; and the displacement that would close the joints' gaps
    (`engines.constraint_error`), which shows errors that all runs have alike. Where the former is near `engines.CLAIM`,
    of a radian or of the mechanism's length, one more run decides: its extrapolation with all but the coarsest run is
    better by the ratio of their steps, so that the difference is the error. It is made too where the last difference is
    far smaller than those before it let expect, as differences may pass zero.

    The estimate is worked out at every step of dt, whichever of them are sampled, and where it is above the claim the
    motion is unresolved, with a warning: `unresolved_at` is the time from which it is above EARLY of that. So it is
    from the start where a damper is so strong that it ends a motion within a step of the coarsest run: all runs may
    miss alike what it does then, and of random mechanisms some were wrong by 5e-5 with an estimate of 4e-9. Reactions
    whose own estimate is large are reported as well.

    Where the estimate is more than what the finest run seems to miss (the distance to the extrapolation of the two
    finest), the runs are no series in the step: one has gone another way at a singular position, say. From there on the
    samples are those of the finest run, and the estimate is the largest distance of another run from it. Two runs can't
    show it.

    `divides`: where a motion becomes faster than its start lets expect, all levels take more steps (`engines.finer`).
    A run whose own estimate does not rule that out makes rough runs to find out; their time is part of its `stepping`.

    Raises ValueError for levels that are not rising whole numbers or powers that do not fit them.
    """

    engine: Engine
    variant: Name
    levels: tuple[Count, ...]
    powers: tuple[Count, ...]
    divides: bool = False

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
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """The power after those removed; rounding grows by the sum of the weights' sizes.

        Reactions that are a change of velocity over a step are read over the steps of the finest run. Their error has
        powers of its own beside those of the motion, so only twice the inner order is promised of them.
        """
        inner = self.engine.order(mechanism)
        if isinstance(inner, Unpromised):
            return inner
        if inner.order != self.powers[0]:
            return Unpromised(
                f"the engine inside has an error of order {inner.order:g} here, and this removes powers "
                f"from {self.powers[0]} on"
            )
        # Powers rise evenly: by one, or by two for a method that is symmetric in time.
        rises = [high - low for low, high in pairwise(self.powers)]
        return Promise(
            self.powers[-1] + (rises[-1] if rises else 1),
            reaction=2 * inner.order if inner.differences else None,
            differences=inner.differences * self.levels[-1],
            amplified=float(np.abs(extrapolation_weights(self.levels, self.powers)).sum()),
        )

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """All steps of all levels [s]."""
        return sum(self.levels) * self.engine.step_cost(mechanism)

    @validated
    def step_cost_within(self, mechanism: Mechanism, duration: Positive) -> float:
        """The same in a motion of `duration` [s]."""
        return sum(self.levels) * self.engine.step_cost_within(mechanism, duration)

    def softness(self, mechanism: Mechanism, dt: float) -> None:
        """Nothing is declared: a softness that is tied to the step is extrapolated too."""

    def steps_of_runs(self, mechanism: Mechanism) -> tuple[float, ...]:
        """One run a level."""
        return tuple(1 / level for level in self.levels)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Build the engine once a level; raises whatever it raises."""
        if not self.divides or len(self.levels) < 3 or isinstance(self.order(mechanism), Unpromised):
            return ExtrapolatedRun(self, mechanism, dt)
        plain, order = replace(self, divides=False), self.powers[-1] + 1.0
        return ExtrapolatedRun(
            self,
            mechanism,
            dt,
            lambda lasts: division(plain, lambda own: plain.build(mechanism, own), mechanism, lasts, order),
        )


class ExtrapolatedRun(OneShot):
    """The built models of all levels, ready to be stepped once; see `engines.Run`."""

    def __init__(
        self,
        method: Extrapolated,
        mechanism: Mechanism,
        dt: float,
        divided: Callable[[float], Division] | None = None,
    ) -> None:
        """`divided` tells into how many steps each has to be divided in a motion of so many seconds."""
        self._method, self._mechanism, self._dt, self._divided = method, mechanism, dt, divided
        # What differences of poses are measured by [m, m, rad].
        self._scale = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
        self._runs = self._built(1)
        self.size: Size = self._runs[0].size

    def _built(self, finer: int) -> tuple[Run, ...]:
        return tuple(self._built_at(level, finer) for level in self._method.levels)

    def _built_at(self, level: int, finer: int) -> Run:
        inner = self._method.engine
        engine = inner.settled_for(level) if isinstance(inner, Settling) else inner
        return engine.build(self._mechanism, self._dt / (level * finer))

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        self.begin()
        asked = every
        every = _watched(samples, asked, len(self._mechanism.bodies))
        samples, each = samples * (asked // every), asked // every
        plan = samples, every, each
        parts = self._parts(self._runs, *plan, 1)
        found = self._combined(parts, *plan, 1)
        order = self._method.powers[-1] + 1.0
        spent, finer = found.stepping, 1
        converged = not any(words.startswith(UNCONVERGED) for words in found.warnings)
        if self._divided is not None and converged and not tells_itself(found, self._mechanism, self._dt, order):
            needed = self._divided(samples * every * self._dt)
            spent, finer = spent + needed.seconds, needed.steps
            if finer > 1:
                parts = self._parts(self._built(finer), *plan, finer)
                found = self._combined(parts, *plan, finer)
                spent += found.stepping
        if converged and self._is_open(found, parts):
            further = _part(self._built_at(self._further, finer), samples, every * self._further * finer, each)
            spent += further.stepping
            found = self._combined(parts, *plan, finer, further)
        sampled = {name: getattr(found, name)[::each] for name in ("t", "pose", "twist", "reaction", "estimate")}
        return replace(found, **sampled, stepping=spent)

    def _parts(self, runs: tuple[Run, ...], samples: int, every: int, each: int, finer: int) -> list[Trajectory]:
        """The runs of all levels, with `every` steps of the method between samples, each divided into `finer`.

        Reactions are those of every `each`-th sample, and NaN in between.
        """
        counts = [every * finer * level for level in self._method.levels]
        return [_part(run, samples, count, each) for run, count in zip(runs, counts, strict=True)]

    def _is_open(self, found: Trajectory, parts: list[Trajectory]) -> bool:
        """Whether another run decides.

        So it does where the estimate is near the claim; where lines turn far in a step of the coarsest run; and where
        the last of the differences may be small by chance: falling as the two before it do, it would be near the claim.
        """
        levels, (low, high) = self._method.levels, OPEN
        if len(levels) < 3 or found.estimate is None:
            return False
        largest = float(self._largest(found.estimate)[-1])
        if found.unresolved_at is None and largest < low * CLAIM:
            poses = np.stack([part.pose for part in parts]) / self._scale
            sizes = [float(apart.max()) for apart in _differences(poses, levels, self._method.powers)]
            return len(sizes) > 2 and LEAST * sizes[-2] ** 2 > low * CLAIM * sizes[-3]
        return largest < high * CLAIM

    def _combined(
        self,
        parts: list[Trajectory],
        samples: int,
        every: int,
        each: int,
        finer: int,
        further: Trajectory | None = None,
    ) -> Trajectory:
        """The extrapolation of these parts; `further`: a run by which the estimate is decided."""
        levels, powers = self._method.levels, self._method.powers
        weights = extrapolation_weights(levels, powers)
        poses, twists, reactions = (
            np.stack([getattr(part, name) for part in parts]) for name in ("pose", "twist", "reaction")
        )
        t, pose, twist = parts[-1].t, combine(poses, weights), combine(twists, weights)
        steps = samples * every * finer
        stiff = self._mechanism.applied.dissipate and self._dt / (levels[0] * finer) > self._mechanism.time_scale
        reaction, estimate = combine(reactions, weights), self._estimate(poses, pose, steps)
        warnings = [warning for part in parts for warning in part.warnings]
        lost = (self._largest(estimate) > CLAIM) & self._is_no_series(poses, self._largest(estimate))
        if lost.any():
            since = int(np.argmax(lost))
            pose[since:], twist[since:], reaction[since:] = poses[-1, since:], twists[-1, since:], reactions[-1, since:]
            with np.errstate(all="ignore"):
                estimate[since:] = np.abs(poses[:-1, since:] - poses[-1, since:]).max(axis=0)
        elif further is not None:
            decided = self._decided(poses, pose, further.pose) + self._rounding(pose, steps)
            above = self._largest(estimate)[-1] > CLAIM
            estimate = decided if above else np.fmax(decided, estimate)
        estimate = np.maximum(estimate, RELEASED * np.abs(closing(self._mechanism, t, pose)))
        finest = (poses[-1, ::each], twists[-1, ::each], reactions[-1, ::each])
        warnings += reaction_doubts(self._mechanism, *finest, expected_error(reactions[:, ::each], levels, powers))
        largest = self._largest(estimate)
        early = largest > EARLY * CLAIM
        unresolved_at = float(t[np.argmax(early)]) if (largest > CLAIM).any() else None
        turned = self._turned(poses[-1]) / (every * finer * levels[0 if further is None else 1]) > TURNED
        if turned.any():
            at = float(t[np.argmax(turned)])
            unresolved_at = at if unresolved_at is None else min(at, unresolved_at)
        if stiff or any(words.startswith(UNRESOLVED) for words in warnings):  # of a part, or all miss it alike
            unresolved_at = 0.0
        if unresolved_at is not None:
            reason = "the runs are no series in the step" if lost.any() else "its own estimate is not below its claim"
            warnings.append(f"ours: unresolved from {unresolved_at:.4g} s on, {reason}")
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

    def _decided(self, poses: Array, pose: Array, further: Array) -> Array:
        """The error (times, bodies, 3) of extrapolated poses, by the extrapolation with `further` for the coarsest."""
        weights = extrapolation_weights((*self._method.levels[1:], self._further), self._method.powers)
        with np.errstate(all="ignore"):
            return DECIDED * np.abs(combine(np.concatenate([poses[1:], further[None]]), weights) - pose)

    @property
    def _further(self) -> int:
        """The level of the run that decides: it has half as many more steps as the finest."""
        return ceil(1.5 * self._method.levels[-1])

    def _estimate(self, poses: Array, pose: Array, steps: int) -> Array:
        """(times, bodies, 3) [m, m, rad] for poses (levels, times, bodies, 3) and what they are extrapolated to."""
        levels, powers = self._method.levels, self._method.powers
        # The coarsest run may miss otherwise in its first step than in all others: a gap is closed a step late, say. If
        # that run alone is out of the series, it puts the extrapolation off by the whole last difference.
        least = np.full(poses.shape[1], LEAST)
        least[: 2 if steps < len(least) else 1] = 1.0
        return _expected_error(poses / self._scale, levels, powers, least) * self._scale + self._rounding(pose, steps)

    def _rounding(self, pose: Array, steps: int) -> Array:
        """Each step rounds a pose anew, by half a unit at most, and the combination carries that with its weights."""
        levels, powers = self._method.levels, self._method.powers
        carried = np.abs(extrapolation_weights(levels, powers)) @ levels * np.finfo(float).eps / 2 * steps
        elapsed = np.linspace(0.0, 1.0, len(pose))[:, None, None]
        with np.errstate(all="ignore"):
            return carried * elapsed * np.maximum(np.abs(pose), self._scale)

    def _largest(self, estimate: Array) -> Array:
        """(times,) the largest so far, of a radian or of the mechanism's length: what was missed once may pass zero."""
        with np.errstate(all="ignore"):
            return np.fmax.accumulate((estimate / self._scale).max(axis=(1, 2)))

    def _is_no_series(self, poses: Array, largest: Array) -> NDArray[np.bool_]:
        """(times,) where the estimate is more than what the finest run has missed so far."""
        levels, powers = self._method.levels, self._method.powers
        if len(levels) < 3:
            return np.zeros(len(largest), dtype=bool)
        finer = combine(poses[-2:], extrapolation_weights(levels[-2:], powers[:1]))
        return largest > self._largest(np.abs(finer - poses[-1]))

    def _turned(self, pose: Array) -> Array:
        """(times,) by how much the line of any spring, damper or rod turns up to the next of these poses [rad]."""
        own, out = self._mechanism, np.zeros(len(pose))
        lines = [each for each in (*own.forces, *own.joints) if isinstance(each, Spring | Damper | Rod)]
        for each in lines:
            along = np.zeros(len(pose), dtype=complex)
            for name, (x, y), sign in ((each.first, each.first_point, -1.0), (each.second, each.second_point, 1.0)):
                place = pose[:, own.body_index(name)] if name else np.zeros((1, 3))
                with np.errstate(all="ignore"):
                    along += sign * (place[:, 0] + 1j * place[:, 1] + np.exp(1j * place[:, 2]) * complex(x, y))
            out[:-1] = np.fmax(out[:-1], np.abs(np.angle(along[1:] * np.conj(along[:-1]))))
        return out


def _watched(samples: int, every: int, bodies: int) -> int:
    """How many steps lie between the instants that are watched: one, unless these are too many to be kept."""
    parts = [part for part in range(1, isqrt(every) + 1) if every % part == 0]
    divisors = sorted({*parts, *(every // part for part in parts)})
    return next((each for each in divisors if samples * (every // each) * bodies <= WATCHED), every)


def _part(run: Run, samples: int, every: int, each: int) -> Trajectory:
    """One level's run, with reactions where they are asked for: they take longer to read than poses take to step."""
    return run.watched(samples, every, each) if isinstance(run, Watched) else run(samples, every)


@validated
def expected_error(values: Numbers, levels: tuple[Count, ...], powers: tuple[Count, ...]) -> Array:
    """An estimate (times, ...) of the error of values (levels, times, ...) that are extrapolated, all in one unit.

    The differences between the extrapolations of k + 1 and of the k finest runs fall from one k to the next while the
    runs are a series in the step. The last of them is the error of the extrapolation without the coarsest run; what is
    left is smaller by the factor that it fell by, or by the one that the last two factors lead to, as in asymptotic
    series factors rise. That is taken CAUTION times. It is no less than LEAST of the last difference, as that may just
    pass zero, and no more than a single run that is out of the series puts the extrapolation off. Factors are those of
    the largest differences so far.
    """
    return _expected_error(values, levels, powers, LEAST)


def _expected_error(values: Array, levels: tuple[int, ...], powers: tuple[int, ...], least: float | Array) -> Array:
    """`expected_error` with the least part (times,) of the last difference that counts."""
    apart = _differences(values, levels, powers)
    with np.errstate(all="ignore"):
        sizes = [np.fmax.accumulate(np.fmax.reduce(each.reshape(len(each), -1), axis=1, initial=0.0)) for each in apart]
        ratios = [np.nan_to_num(finer / rough, nan=0.0) for rough, finer in pairwise(sizes[-3:])]
        rising = [np.nan_to_num(last**2 / before, nan=0.0) for before, last in pairwise(ratios)]
        weights = extrapolation_weights(levels, powers)
        fewer = np.array([0.0, *extrapolation_weights(levels[1:], powers[:-1])])
        most = np.abs(weights / (weights - fewer)).max()
        expected = CAUTION * np.max([ratios[-1], *rising], axis=0) if ratios else most
        factor = np.clip(expected, np.minimum(least, most), most)
        return apart[-1] * np.reshape(factor, (-1, *(1,) * (apart[-1].ndim - 1)))


@validated
def combine(values: Numbers, weights: Array) -> Array:
    """sum of weights (levels,) times values (levels, ...), NaN wherever a level is not finite.

    Taken as the finest plus weighted differences from it: what all levels agree on, such as the start, comes out exact.
    """
    with np.errstate(all="ignore"):
        finest = values[-1]
        out = finest + np.tensordot(weights[:-1], values[:-1] - finest, axes=1)
    return np.where(np.all(np.isfinite(values), axis=0), out, np.nan)


def _differences(values: Array, levels: tuple[int, ...], powers: tuple[int, ...]) -> list[Array]:
    """The distances (times, ...) from the extrapolation of k finest runs (k from 1) to that of one more."""
    parts = [
        combine(values[-count:], extrapolation_weights(levels[-count:], powers[: count - 1]))
        for count in range(1, len(levels) + 1)
    ]
    with np.errstate(all="ignore"):
        return [np.abs(more - fewer) for fewer, more in pairwise(parts)]
