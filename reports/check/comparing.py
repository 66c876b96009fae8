"""A run of the user's model beside the judge's motion: errors over time, joints that open, and the start."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.reading import Reading
from reference.mechanism import Mechanism
from reference.rows import undetermined
from reference.trajectory import Trajectory, energy
from reports.check.judging import apart
from reports.check.law import accelerations

Array = NDArray[np.float64]
# Of the largest acceleration: rounding of equations that are solved twice, with room for badly scaled masses.
AGREE = 1e-6
QUANTITIES = ("angle", "position", "reaction", "energy")
UNITS = {"angle": "rad", "position": "m", "reaction": "of the largest", "energy": "of the largest kinetic"}


@dataclass(frozen=True, eq=False)
class Errors:
    """Of one run over its samples (times,); NaN where it gave up, or where there is nothing to compare."""

    t: Array
    of: dict[str, Array]  # by QUANTITIES
    whole: Array  # the larger of angles [rad] and places in lengths of the mechanism: what a tolerance is for
    finished: bool

    @property
    def largest(self) -> float:
        """Infinite for a run that gave up."""
        return float(np.nanmax(self.whole)) if self.finished else float("inf")

    def worst(self, quantity: str) -> float:
        values = self.of[quantity]
        return float(np.nanmax(values)) if np.isfinite(values).any() else float("nan")


def errors(mechanism: Mechanism, truth: Trajectory, run: Trajectory) -> Errors:
    """Of a run at the judge's instants."""
    difference = run.pose - truth.pose
    angle = np.abs(difference[..., 2]).max(axis=1)
    position = np.hypot(difference[..., 0], difference[..., 1]).max(axis=1)
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1))
    span = float(kinetic.max())
    drift = (
        np.abs(energy(mechanism, run) - energy(mechanism, truth)) / span if span > 0 else np.full_like(angle, np.nan)
    )
    of = {"angle": angle, "position": position, "reaction": _reaction(mechanism, truth, run), "energy": drift}
    finished = bool(np.isfinite(run.pose).all())
    return Errors(run.t, of, apart(mechanism, run.pose, truth.pose), finished)


def _reaction(mechanism: Mechanism, truth: Trajectory, run: Trajectory) -> Array:
    """The largest error of the rows that rigid bodies determine (times,), in the largest true one of its kind."""
    out = np.full(len(run.t), np.nan)
    if not mechanism.row_count:
        return out
    told = ~undetermined(mechanism.rows(mechanism.pose), mechanism.length_scale)
    for rows in (mechanism.turning & told, ~mechanism.turning & told):
        true = truth.reaction[:, rows]
        scale = float(np.abs(true).max()) if true.size else 0.0
        if scale > 0:
            # A row whose force an engine does not know, such as that of a prescribed crank, hides no other.
            off = np.fmax.reduce(np.abs(run.reaction[:, rows] - true), axis=1) / scale
            out = np.fmax(out, off)
    return out


@dataclass(frozen=True)
class Opening:
    """The joint that opens most, by how much [m or rad], and when [s]."""

    row: str
    gap: float
    unit: str
    t: float


def opening(mechanism: Mechanism, run: Trajectory) -> Opening | None:
    """Of a run; None where no joint has a gap."""
    if not mechanism.row_count:
        return None
    gap = np.abs(mechanism.gap(run.pose, run.t))
    scaled = np.nan_to_num(np.where(mechanism.turning, gap, gap / mechanism.length_scale))
    sample, row = np.unravel_index(int(np.argmax(scaled)), scaled.shape)
    unit = "rad" if mechanism.turning[row] else "m"
    return Opening(mechanism.row_names[row], float(gap[sample, row]), unit, float(run.t[sample]))


def refuse_disagreement(reading: Reading) -> float:
    """The start's accelerations in the engine and by the judge, relative to the largest, if they agree.

    The engine's declared softness is part of the comparison. Raises Unsupported, with the element that explains a
    disagreement if one does.
    """
    mechanism, model = reading.mechanism, reading.model
    give = model.give(np.zeros(mechanism.row_count)) if model.softly_held else None
    expected = accelerations(mechanism, mechanism.pose, mechanism.twist, 0.0, give)
    found = model.start()
    off = _apart(mechanism, found, expected)
    if off <= AGREE:
        return off
    for element in model.elements:
        if _apart(mechanism, model.without(element), expected) <= AGREE:
            raise Unsupported(
                f"at t = 0 the accelerations differ from those of the ideal mechanism by {off:.1g} of themselves, and "
                f"agree without '{element}': it acts at the start, and in no ideal joint; give --without {element}"
            )
    for element, reason in model.suspects.items():
        raise Unsupported(f"{element}: {reason}; at t = 0 the accelerations are wrong by {off:.1g} of themselves")
    size = np.abs(found - expected) * [1.0, 1.0, mechanism.length_scale]
    body = mechanism.bodies[int(np.argmax(size.max(axis=1)))].name
    raise Unsupported(
        f"at t = 0 the accelerations of {model.engine} differ from those of the ideal mechanism by {off:.1g} of "
        f"themselves, most of all at {body!r}, and no single kind of element explains it"
    )


def _apart(mechanism: Mechanism, found: Array, expected: Array) -> float:
    unit = np.array([1.0, 1.0, mechanism.length_scale])
    size = max(float(np.abs(expected * unit).max()), mechanism.length_scale / mechanism.time_scale**2)
    return float(np.abs((found - expected) * unit).max()) / size
