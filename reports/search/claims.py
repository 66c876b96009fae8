"""What a method with an estimate of its own claims, against the judge: over a longer motion, at steps as users take.

Poses are right to CLAIM until `unresolved_at`, and reactions to FORCES of the largest force, unless it warns of them. A
warning of another kind takes the claim back.
"""

from __future__ import annotations

import numpy as np

from engines import CLAIM, Engine
from engines.constraint_error import FORCES, largest_force
from engines.lagrange import HELD, TRUTH
from engines.remembered import by_identity
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.law import Errors, Skip

LASTS = 2.0  # times the mechanism's own time scale
STEPS, EVERY = (40, 100, 200), (1, 2, 5)  # in that time, and between samples: in turn, by the case's number
CLAIMED, REACTIONS, REPORTED = "claimed", "claimed of reactions", "reported, though right"
ASKED = 16  # motions of the judge that are kept, as all engines are asked of one mechanism after the other


def errors(engine: Engine, mechanism: Mechanism, number: int) -> Errors | Skip:
    """(error, claim) of poses, in radians or parts of the length, and of reactions, in parts of the largest force.

    REPORTED, which is 1 or 0, of motions alone that are right from beginning to end: no fault, but counted.
    """
    steps, every = STEPS[number % len(STEPS)], EVERY[number // len(STEPS) % len(EVERY)]
    dt = LASTS * mechanism.time_scale / steps
    run = engine.build(mechanism, dt)(steps // every, every)
    if run.estimate is None:
        return Skip("it has no estimate of its own error")
    truth = _judged(mechanism)
    if truth.unresolved_at is not None or truth.warnings or not np.isfinite(truth.pose).all():
        return Skip(f"the judge itself does not hold {HELD:g}, as it says")
    return compared(mechanism, run, truth)


def compared(mechanism: Mechanism, run: Trajectory, truth: Trajectory) -> dict[str, tuple[float, float]]:
    """The same of a run, whose samples are among those of the judge."""
    at = np.linspace(0, len(truth.t) - 1, len(run.t)).round().astype(int)
    length, arm = mechanism.length_scale, np.where(mechanism.turning, mechanism.length_scale, 1.0)
    missed = np.nan_to_num(np.abs(run.pose - truth.pose[at]) / [length, length, 1.0], nan=np.inf).max(axis=(1, 2))
    until = run.t < (np.inf if run.unresolved_at is None else run.unresolved_at)
    of_reactions = [words for words in run.warnings if "reactions are" in words]
    told = run.unresolved_at is not None or len(of_reactions) < len(run.warnings)
    out = {}
    if run.unresolved_at is not None or not told:
        out[CLAIMED] = (float(missed[until].max(initial=0.0)), CLAIM)
    if missed.max() <= CLAIM:
        out[REPORTED] = (float(told), 1.0)
    if mechanism.row_count and not told and not of_reactions:
        off = np.nan_to_num(run.reaction[1:] - truth.reaction[at][1:]) / arm
        largest = largest_force(mechanism, truth.pose[at], truth.twist[at], truth.reaction[at])
        out[REACTIONS] = (float(np.abs(off).max()) / largest, FORCES)
    return out


@by_identity(ASKED)
def _judged(mechanism: Mechanism) -> Trajectory:
    """The judge's motion, at all instants at which any run is sampled."""
    samples = int(np.lcm.reduce(STEPS))
    return TRUTH.build(mechanism, LASTS * mechanism.time_scale / samples)(samples, 1)
