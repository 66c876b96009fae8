"""The contract of readers: a user's own model as a mechanism, the elements that were left out, and the model itself.

`crosscheck check` uses nothing else of an engine's reader. A reader is an entry point of the group
`crosscheck.readers`. It raises `Unsupported`, in a sentence that names the element, for a model that it can't read.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from engines.contract import Unsupported
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

# A check of more bodies takes minutes.
MOST_BODIES = 200


@dataclass(frozen=True)
class Note:
    """An element of the user's model that the mechanism lacks, and why the check goes on without it."""

    element: str
    reason: str


@dataclass(frozen=True)
class Obstacle:
    """An event of the user's model at `t` [s] of a motion that the mechanism lacks, such as a contact.

    `words`: the event, for a message; `remedy`: an alternative to a shorter motion
    """

    t: float
    words: str
    remedy: str


@dataclass(frozen=True)
class Change:
    """Documented settings of an engine: a description (`words`), the `lines` to copy, and the step `dt` [s].

    `options`: the settings by name, for the model.
    """

    words: str
    dt: float
    lines: tuple[str, ...]
    options: tuple[tuple[str, Any], ...] = ()


@dataclass(frozen=True, eq=False)
class RowRegularisation:
    """Regularisation of the rows as the engine declares it: J a = bias - damping slip - stiffness gap - compliance F.

    stiffness (rows,) [1/s^2]; damping (rows,) [1/s]; compliance (rows, rows) [1/kg, 1/(kg m^2)]; all are zero for a row
    that holds exactly. `initial_bias` (rows,): the value at the start in place of `bias`, for an engine that leaves the
    bias out; NaN elsewhere.
    """

    stiffness: Array
    damping: Array
    compliance: Array
    initial_bias: Array


class OwnModel(Protocol):
    """A user's model with its own settings, which can be run from its start any number of times."""

    @property
    def engine(self) -> str: ...
    @property
    def dt(self) -> float:
        """The user's step [s]."""
        ...

    @property
    def assumed(self) -> str:
        """The values that the reader assumed because the model does not state them, in words; empty if none."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """The engine's settings in the model, in words."""
        ...

    @property
    def declares(self) -> bool:
        """Whether the engine declares a law of its joints that does not depend on the step."""
        ...

    @property
    def has_soft_joints(self) -> bool:
        """Whether the declared law regularises joints."""
        ...

    @property
    def start_twist(self) -> Array:
        """The user's velocities at t = 0 (bodies, 3) [m/s, rad/s], which need not satisfy the mechanism's joints."""
        ...

    def start(self) -> Array:
        """The engine's accelerations at t = 0 (bodies, 3) [m/s^2, rad/s^2], at the mechanism's velocities."""
        ...

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        """The regularisation of the joints at gaps (rows,) [m, rad] and a pose (bodies, 3)."""
        ...

    def without(self, element: str) -> Array:
        """The accelerations at t = 0 (bodies, 3) with one of `elements` switched off."""
        ...

    @property
    def elements(self) -> Sequence[str]:
        """The kinds of elements that can be switched off, to find the cause of a difference."""
        ...

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        """The first event of each kind in a motion of poses and twists (times, bodies, 3), in the order of time.

        Events are all effects that the mechanism lacks: contacts, limits of motions and of forces, and sleep.
        """
        ...

    @property
    def suspects(self) -> Mapping[str, str]:
        """Elements whose law in the engine differs from the ideal law at all steps, with the reason."""
        ...

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        """Documented settings with steps down to `smallest` [s]; the first are the user's settings.

        `further`: include settings for models that the common settings do not improve.
        """
        ...

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        """The approximations of the reading, with their effect on a run with the user's settings."""
        ...

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        """A run of the user's model: samples + 1 states, `every` of the user's steps apart."""
        ...


@dataclass(frozen=True, eq=False)
class Source:
    """The file of a user's model.

    `changed` returns the bytes of the file with other settings. `read` reads such a file on the same terms. Both raise
    Unsupported.
    """

    path: Path
    changed: Callable[[Change], bytes]
    read: Callable[[Path], Reading]


@dataclass(frozen=True, eq=False)
class Reading:
    """The mechanism that a user's model describes, notes on elements that were left out, and the model itself.

    `source`: the file of the model, or None if the model was built in Python
    """

    mechanism: Mechanism
    model: OwnModel
    notes: tuple[Note, ...]
    title: str = ""
    source: Source | None = None

    @property
    def jumps(self) -> bool:
        """Whether the model's velocities violate its joints, so that the ideal motion begins with an impulse."""
        return bool(np.any(self.model.start_twist != self.mechanism.twist))


@dataclass(frozen=True)
class ReadingTerms:
    """The terms on which a user's model is read.

    without: kinds of elements to switch off in the mechanism and in the user's model
    key: the name or number of a stored state
    step: a step that replaces the model's [s]
    """

    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None


AS_IT_IS = ReadingTerms()


class Reader(Protocol):
    """A reader of the models of one engine, as an entry point of `crosscheck.readers`."""

    @property
    def words(self) -> str:
        """The kind of model that this reader reads, for a message."""
        ...

    @property
    def elements(self) -> Mapping[str, str]:
        """The ideal counterpart of each element of the engine, by the engine's name, for messages and the page."""
        ...

    def reads(self, word: str) -> bool:
        """Whether a word of the command line is a model for this reader."""
        ...

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
        """The reading of a model. Raises Unsupported, or ValueError if the file is no model."""
        ...


def refuse(element: str, reason: str) -> Unsupported:
    return Unsupported(f"{element}: {reason}")


def left_out(element: str) -> str:
    """The consequence of `--without` for an element that acts in the motion, for a message."""
    return f"--without {element} judges your model without it, which moves otherwise"


def refuse_at_start(model: OwnModel, mechanism: Mechanism) -> None:
    for obstacle in model.obstacles(np.zeros(1), mechanism.pose[None], mechanism.twist[None]):
        reason = f"so it does at the start, and an ideal mechanism doesn't know it; {obstacle.remedy}"
        raise refuse(obstacle.words, reason)


class Names:
    """A source of unique names for elements of a model, which may have the same name or none."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def new(self, wanted: str) -> str:
        name, number = wanted, 2
        while name in self._taken:
            name, number = f"{wanted} ({number})", number + 1
        self._taken.add(name)
        return name
