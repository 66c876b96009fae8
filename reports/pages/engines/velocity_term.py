"""The velocity term of loops, by force: reactions at instants of the exact motion, and the law with it and without.

The mechanism is started anew at poses and velocities of the exact motion, where every gap and slip is zero. In the
tree's coordinates q a loop's rows are J q'' = -J' q'. Without the velocity term they are J q'' = 0. In the coordinates
of bodies, rows are then accelerated as they are where no coordinate of the tree is. Rows that an engine does not say to
be soft hold exactly. Both laws follow from the mechanism alone, and no step is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines.tree import spanning_tree
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.grid.tasks import Values
from reports.pages.engines.asked import Asked

Array = NDArray[np.float64]
INSTANTS = 12
STEP = 1e-3  # s, that a model is built for; none is compared


def started_anew(mechanism: Mechanism, pose: Array, twist: Array) -> Mechanism:
    """The mechanism with its bodies at these poses and twists (bodies, 3)."""
    bodies = tuple(
        replace(body, pose=tuple(place.tolist()), twist=tuple(speed.tolist()))
        for body, place, speed in zip(mechanism.bodies, pose, twist, strict=True)
    )
    return replace(mechanism, bodies=bodies)


def reactions_with(
    mechanism: Mechanism, soft: tuple[bool, ...], complete: bool, compliance: Array | float = 0.0
) -> Array:
    """The start's reactions (rows,) [N] if soft rows have their velocity term or not; `compliance` (rows,) [1/kg]."""
    rows = mechanism.rows(mechanism.pose)
    bias = mechanism.bias(mechanism.pose, mechanism.twist)
    if not complete:
        tree = spanning_tree(mechanism)
        still = np.zeros((1, tree.coordinates))
        _, _, carried = tree.motion(still, tree.start_rates()[None], still)
        bias = np.where(soft, rows @ carried.reshape(-1), bias)
    weight = 1 / mechanism.inertias.reshape(-1)
    right: Array = bias - rows @ mechanism.free_fall.reshape(-1)
    inverse = (rows * weight) @ rows.T + np.diag(np.broadcast_to(compliance, right.shape))
    return np.asarray(np.linalg.solve(inverse, right), dtype=np.float64)


@dataclass(frozen=True)
class VelocityTerm(Asked):
    """How far an engine's reactions (instants,) are from those with the velocity term and without, of the largest."""

    what: ClassVar[str] = "the velocity term of a loop"

    def run(self) -> Values:
        scene = FreeFourBar()
        described = scene.mechanism()
        softness = self.of.softness(described, STEP)
        if softness is None:
            raise ValueError(f"{self.of.name} {self.of.variant} declares no soft rows: its loops are exact")
        t = np.linspace(0.2, 1.0, INSTANTS) * scene.duration
        truth = scene.motion(t)
        found: dict[str, list[float]] = {"with": [], "without": []}
        for pose, twist in zip(truth.pose, truth.twist, strict=True):
            now = started_anew(described, pose, twist)
            told = self.of.build(now, STEP)(1, 1).reaction[0]
            for name, complete in (("with", True), ("without", False)):
                wanted = reactions_with(now, softness.rows, complete)
                found[name].append(float(np.abs(told - wanted).max() / np.abs(wanted).max()))
        return {"t": t, **{name: np.array(values) for name, values in found.items()}}
