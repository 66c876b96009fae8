"""A scene: the numbers of one experiment, read by engines as a mechanism and by the textbook as a motion."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

# Samples stand about this far apart [s]; every step of a sweep divides the distance: all steps meet the same instants.
SAMPLE_SPACING = 1e-2


class Scene(ABC):
    """Subclasses are frozen dataclasses, and their fields are the only place where a number is written.

    `name` is the scene's key, `page` the page that teaches it, `source` where the chapter has it. `duration` [s] is how
    long it runs; until `horizon` [s] an error grows no faster than about linearly, so that orders can be fitted.
    """

    name: ClassVar[str]
    page: ClassVar[str]
    source: ClassVar[str]
    duration: float
    horizon: float

    def __getstate__(self) -> dict[str, Any]:
        """Its numbers alone, so that a scene travels to another process without what it has worked out."""
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]

    @abstractmethod
    def mechanism(self) -> Mechanism:
        """The bodies and joints at t = 0."""

    @abstractmethod
    def motion(self, t: ArrayLike) -> Trajectory:
        """The truth at times t (times,) [s]: poses, twists, reactions."""

    def branch(self, pose: NDArray[np.float64]) -> NDArray[np.int_]:
        """The assembly mode (...,) of poses (..., bodies, 3): +1, -1; 0 where a scene has only one."""
        return np.zeros(np.shape(pose)[:-2], dtype=int)

    @property
    def comparable_until(self) -> float:
        """Up to when a body could do what the ideal motion asks of it [s]; beyond, no comparison with it is valid."""
        return math.inf

    @property
    def samples(self) -> int:
        """Sampling intervals over the duration."""
        return max(1, round(self.duration / SAMPLE_SPACING))

    @property
    def spacing(self) -> float:
        """The time between samples [s]."""
        return self.duration / self.samples
