"""Richardson's extrapolation to zero step, around any engine: run it at several steps, keep what the steps agree on."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Holder, Promise, Run, Size, Unpromised
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reference.validation import Count, InvalidMechanism, Name, Numbers, Positive, Valid, validated

Array = NDArray[np.float64]


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
    one, so cautious while the powers describe the error, and large when they don't.

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
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """Whoever holds it in the runs that are combined."""
        return self.engine.holder(joint, mechanism)

    def softness(self, mechanism: Mechanism, dt: float) -> None:
        """Nothing is declared: a softness that is tied to the step is extrapolated too."""

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Build the engine once a level; raises whatever it raises."""
        return ExtrapolatedRun(self, tuple(self.engine.build(mechanism, dt / level) for level in self.levels))


class ExtrapolatedRun:
    """The built models of all levels, ready to be stepped once; see `engines.Run`."""

    def __init__(self, method: Extrapolated, runs: tuple[Run, ...]) -> None:
        self._method, self._runs = method, runs
        self.size: Size = runs[0].size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        levels, powers = self._method.levels, self._method.powers
        parts = [run(samples, every * level) for run, level in zip(self._runs, levels, strict=True)]
        weights = extrapolation_weights(levels, powers)
        poses = np.stack([part.pose for part in parts])
        pose = combine(poses, weights)
        simpler = combine(poses[1:], extrapolation_weights(levels[1:], powers[:-1]))
        with np.errstate(all="ignore"):
            estimate = np.abs(pose - simpler)
        resets = [part.reset_at for part in parts if part.reset_at is not None]
        return Trajectory(
            t=parts[-1].t,
            pose=pose,
            twist=combine(np.stack([part.twist for part in parts]), weights),
            reaction=combine(np.stack([part.reaction for part in parts]), weights),
            stepping=sum(part.stepping for part in parts),
            warnings=tuple(dict.fromkeys(warning for part in parts for warning in part.warnings)),
            reset_at=min(resets, default=None),
            estimate=estimate,
        )


@validated
def combine(values: Numbers, weights: Array) -> Array:
    """sum of weights (levels,) times values (levels, ...), NaN wherever a level is not finite.

    Taken as the finest plus weighted differences from it: what all levels agree on, such as the start, comes out exact.
    """
    with np.errstate(all="ignore"):
        finest = values[-1]
        out = finest + np.tensordot(weights[:-1], values[:-1] - finest, axes=1)
    return np.where(np.all(np.isfinite(values), axis=0), out, np.nan)
