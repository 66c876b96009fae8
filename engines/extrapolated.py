"""Richardson's extrapolation to zero step, around any engine: run it at several steps, keep what the steps agree on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Holder, Promise, Run, Size, Unpromised
from engines.contract import holder_within
from engines.finer import Division, Lasting, division, tells_itself
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reference.validation import Count, InvalidMechanism, Name, Numbers, Positive, Valid, validated

Array = NDArray[np.float64]

# Estimates below this part of the mechanism's length, or of a radian, are of no concern.
UNNOTICED = 1e-8
TOLD = 1e-4  # of the largest reaction: what may be a thousandth of it is told


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


@dataclass(frozen=True)
class Extrapolated(Valid):
    """An engine in the sense of `engines.Engine` that runs another one at steps dt / level, and extrapolates.

    A sample is the linear combination of the runs' poses, twists and reactions that is free of errors in the `powers`
    of the step (L. F. Richardson, 1911): they must be the powers that the inner engine's error really has, one fewer
    than `levels`. A sample is NaN wherever one of the runs is not finite. The cost is the sum of all. The `estimate` is
    the distance to the extrapolation without the coarsest run and without the highest power: the error of that simpler
    one, so cautious while the powers describe the error, and large when they don't; and the rounding of all steps.

    What it claims is to be nearer than its finest run. Where it moves by more than what that run seems to miss (the
    distance to the extrapolation of the two finest) if the coarsest run or the finest is left out, the runs are no
    series in the step: one has gone another way at a singular position, say. From there on the samples are those of the
    finest run, the estimate is the largest distance of another run from it, `unresolved_at` is the time, and a warning
    tells it. Two runs can't show it.

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

    @property
    def name(self) -> str:
        """The name of the engine inside."""
        return self.engine.name

    @property
    def packages(self) -> tuple[str, ...]:
        """Those of the engine inside."""
        return self.engine.packages

    @property
    def family(self) -> str:
        """That of the engine inside."""
        return self.engine.family

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
        """The same in a motion of `duration` [s]: see `engines.finer.Lasting`."""
        inner = self.engine
        lasting = isinstance(inner, Lasting)
        each = inner.step_cost_within(mechanism, duration) if lasting else inner.step_cost(mechanism)
        return sum(self.levels) * each

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Whoever holds it in the runs that are combined."""
        return self.engine.holder(joint, mechanism)

    @validated
    def holder_within(self, joint: Joint, mechanism: Mechanism, duration: Positive) -> Holder:
        """The same in a motion of `duration` [s]."""
        return holder_within(self.engine, joint, mechanism, duration)

    def softness(self, mechanism: Mechanism, dt: float) -> None:
        """Nothing is declared: a softness that is tied to the step is extrapolated too."""

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


class ExtrapolatedRun:
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
        self._runs, self._over = self._built(1), False
        self.size: Size = self._runs[0].size

    def _built(self, finer: int) -> tuple[Run, ...]:
        levels = self._method.levels
        return tuple(self._method.engine.build(self._mechanism, self._dt / (level * finer)) for level in levels)

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        if self._over:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._over = True
        found = self._combined(samples, every, 1)
        order = self._method.powers[-1] + 1.0
        if self._divided is None or tells_itself(found, self._mechanism, self._dt, order):
            return found
        needed = self._divided(samples * every * self._dt)
        spent = found.stepping + needed.seconds
        if needed.steps > 1:
            found = self._combined(samples, every, needed.steps)
            spent += found.stepping
        return replace(found, stepping=spent)

    def _combined(self, samples: int, every: int, finer: int) -> Trajectory:
        """What the runs of all levels say, with `every` steps of the method between samples, each divided."""
        levels, powers = self._method.levels, self._method.powers
        runs, every = self._runs if finer == 1 else self._built(finer), every * finer
        parts = [run(samples, every * level) for run, level in zip(runs, levels, strict=True)]
        weights = extrapolation_weights(levels, powers)
        poses, twists, reactions = (
            np.stack([getattr(part, name) for part in parts]) for name in ("pose", "twist", "reaction")
        )
        pose, twist = combine(poses, weights), combine(twists, weights)
        reaction, estimate = combine(reactions, weights), self._estimate(poses, pose, samples * every)
        t, warnings = parts[-1].t, [warning for part in parts for warning in part.warnings]
        lost = self._lost(poses, pose, estimate)
        if lost < len(t):
            pose[lost:], twist[lost:], reaction[lost:] = poses[-1, lost:], twists[-1, lost:], reactions[-1, lost:]
            with np.errstate(all="ignore"):
                estimate[lost:] = np.abs(poses[:-1, lost:] - poses[-1, lost:]).max(axis=0)
            warnings.append(f"ours: unresolved from {t[lost]:.4g} s on, the runs are no series in the step")
        elif len(levels) > 2:
            warnings += _told(
                reactions, reaction, combine(reactions[1:], extrapolation_weights(levels[1:], powers[:-1]))
            )
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
            unresolved_at=float(t[lost]) if lost < len(t) else None,
        )

    def _estimate(self, poses: Array, pose: Array, steps: int) -> Array:
        """(times, bodies, 3) [m, m, rad] for poses (levels, times, bodies, 3) and what they are extrapolated to."""
        levels, powers = self._method.levels, self._method.powers
        simpler = combine(poses[1:], extrapolation_weights(levels[1:], powers[:-1]))
        # Each step rounds a pose anew, and the combination carries that as many times as its weights are large.
        carried = np.abs(extrapolation_weights(levels, powers)).sum() * np.finfo(float).eps * steps * levels[-1]
        elapsed = np.linspace(0.0, 1.0, poses.shape[1])[:, None, None]
        with np.errstate(all="ignore"):
            return np.abs(pose - simpler) + carried * elapsed * np.maximum(np.abs(pose), self._scale)

    def _lost(self, poses: Array, pose: Array, estimate: Array) -> int:
        """The first sample at which the runs are no series in the step; the number of samples if there is none.

        Errors add up along a motion, so that what the finest run has missed before counts too: it may pass zero.
        """
        levels, powers = self._method.levels, self._method.powers
        if len(levels) < 3:
            return poses.shape[1]
        finer = combine(poses[-2:], extrapolation_weights(levels[-2:], powers[:1]))
        coarser = combine(poses[:-1], extrapolation_weights(levels[:-1], powers[:-1]))
        with np.errstate(all="ignore"):
            missed = (np.abs(finer - poses[-1]) / self._scale).max(axis=(1, 2))
            moved = (np.maximum(estimate, np.abs(pose - coarser)) / self._scale).max(axis=(1, 2))
        lost = (moved > np.maximum.accumulate(np.nan_to_num(missed, nan=0.0))) & (moved > UNNOTICED)
        return int(np.argmax(lost)) if lost.any() else len(lost)


def _told(runs: Array, reaction: Array, simpler: Array) -> list[str]:
    """What is to be said of reactions (times, rows): how far a simpler extrapolation is from them, if far."""
    with np.errstate(all="ignore"):
        largest = np.nanmax(np.abs(runs), initial=0.0)
        share = np.nanmax(np.abs(reaction - simpler), initial=0.0) / largest if largest > 0 else 0.0
    return [f"ours: reactions are resolved to {share:.0e} of the largest"] if share > TOLD else []


@validated
def combine(values: Numbers, weights: Array) -> Array:
    """sum of weights (levels,) times values (levels, ...), NaN wherever a level is not finite.

    Taken as the finest plus weighted differences from it: what all levels agree on, such as the start, comes out exact.
    """
    with np.errstate(all="ignore"):
        finest = values[-1]
        out = finest + np.tensordot(weights[:-1], values[:-1] - finest, axes=1)
    return np.where(np.all(np.isfinite(values), axis=0), out, np.nan)
