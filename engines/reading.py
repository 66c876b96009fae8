"""The contract of readers: a reader turns a user's own model into a mechanism.

A reader is an entry point of the group `crosscheck.readers`. `crosscheck check` uses only these members of a reader. If
a reader cannot read a model, it raises `Unsupported` with a sentence that names the element.
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

# Limit on the number of bodies, since a check of more bodies takes minutes.
MOST_BODIES = 200


@dataclass(frozen=True)
class Note:
    """A difference between the user's model and the mechanism that does not stop the check, with its reason."""

    element: str
    reason: str


@dataclass(frozen=True)
class Obstacle:
    """An event in the user's model at the time `t` [s], such as a contact, that an ideal mechanism does not have.

    `words`: the event in a message; `remedy`: what the user can do about it.
    """

    t: float
    words: str
    remedy: str


@dataclass(frozen=True)
class Change:
    """Documented settings of an engine.

    words: description of the settings.
    dt: step [s].
    lines: lines that a user can copy.
    options: settings of the model by name.
    """

    words: str
    dt: float
    lines: tuple[str, ...]
    options: tuple[tuple[str, Any], ...] = ()


@dataclass(frozen=True, eq=False)
class RowRegularisation:
    """Regularised rows by the engine's law: J a = bias - damping slip - stiffness gap - compliance F.

    stiffness (rows,) [1/s^2]; damping (rows,) [1/s]; compliance (rows, rows) [1/kg, 1/(kg m^2)]. All are zero for an
    exact row. If the engine's law omits `bias` in a row, `initial_bias` (rows,) replaces it at t = 0; otherwise it is
    NaN.
    """

    stiffness: Array
    damping: Array
    compliance: Array
    initial_bias: Array


class OwnModel(Protocol):
    """A user's model with the user's settings, which can be run from t = 0 any number of times."""

    @property
    def engine(self) -> str: ...
    @property
    def dt(self) -> float:
        """The user's step [s]."""
        ...

    @property
    def assumed(self) -> str:
        """A description of values that the model does not state and the reader assumed; may be empty."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """Descriptions of the engine's settings in the model."""
        ...

    @property
    def declares(self) -> bool:
        """Whether the engine declares a law of its joints that is independent of the step."""
        ...

    @property
    def has_soft_joints(self) -> bool:
        """Whether the declared law regularises joints."""
        ...

    @property
    def start_twist(self) -> Array:
        """The user's velocities at t = 0 (bodies, 3) [m/s, rad/s], which may violate the joints."""
        ...

    def start(self) -> Array:
        """The engine's accelerations at t = 0 (bodies, 3) [m/s^2, rad/s^2] with the mechanism's velocities."""
        ...

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        """The regularisation of the joints at gaps (rows,) [m, rad] and a pose (bodies, 3)."""
        ...

    def without(self, element: str) -> Array:
        """The accelerations at t = 0 (bodies, 3) with this kind of `elements` switched off."""
        ...

    @property
    def elements(self) -> Sequence[str]:
        """The kinds of elements that the check can switch off to find the cause of a difference."""
        ...

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        """The first event of each kind in a motion with poses and twists (times, bodies, 3), sorted by time.

        Events are contacts, limits of motions, limits of forces, and sleep.
        """
        ...

    @property
    def suspects(self) -> Mapping[str, str]:
        """Reasons by element why the engine's law differs from the ideal law at all steps."""
        ...

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        """Documented settings with steps down to `smallest` [s], beginning with the user's settings.

        `further`: include settings for models that the common settings do not improve.
        """
        ...

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        """Notes on approximations by the reader, with their effect on a run with the user's settings."""
        ...

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        """Run the user's model; successive states (samples + 1) are `every` of the user's steps apart."""
        ...


@dataclass(frozen=True, eq=False)
class Source:
    """The file of a user's model.

    `changed` returns the bytes of the file with other settings. `read` reads a file on the same terms. Both functions
    raise Unsupported.
    """

    path: Path
    changed: Callable[[Change], bytes]
    read: Callable[[Path], Reading]


@dataclass(frozen=True, eq=False)
class Reading:
    """A user's model and the mechanism that it describes, with notes on elements that were left out.

    `source`: the file of the model, or None if the model was built in Python.
    """

    mechanism: Mechanism
    model: OwnModel
    notes: tuple[Note, ...]
    title: str = ""
    source: Source | None = None

    @property
    def jumps(self) -> bool:
        """Whether the model's velocities violate the joints; the ideal motion then begins with an impulse."""
        return bool(np.any(self.model.start_twist != self.mechanism.twist))


@dataclass(frozen=True)
class ReadingTerms:
    """Options for reading a user's model.

    without: kinds of elements to switch off in the mechanism and in the user's model.
    key: the name or number of a stored state.
    step: step [s] that replaces the model's step.
    """

    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None


AS_IT_IS = ReadingTerms()


class Reader(Protocol):
    """A reader of one engine's models, as an entry point of `crosscheck.readers`."""

    @property
    def words(self) -> str:
        """The kind of model that this reader accepts, in messages."""
        ...

    @property
    def elements(self) -> Mapping[str, str]:
        """The ideal counterpart of an engine's element, by the engine's name of the element."""
        ...

    def reads(self, word: str) -> bool:
        """Whether a word of the command line names a model for this reader."""
        ...

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
        """Read a model; raises ValueError for a file that is no model, and Unsupported."""
        ...


def refuse(element: str, reason: str) -> Unsupported:
    return Unsupported(f"{element}: {reason}")


def left_out(element: str) -> str:
    """The message that `--without` changes the motion."""
    return f"--without {element} judges your model without it, which moves otherwise"


def refuse_at_start(model: OwnModel, mechanism: Mechanism) -> None:
    for obstacle in model.obstacles(np.zeros(1), mechanism.pose[None], mechanism.twist[None]):
        reason = f"so it does at the start, and an ideal mechanism doesn't know it; {obstacle.remedy}"
        raise refuse(obstacle.words, reason)


class Names:
    """A generator of unique names for elements of a model, whose names may be equal or missing."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def new(self, wanted: str) -> str:
        name, number = wanted, 2
        while name in self._taken:
            name, number = f"{wanted} ({number})", number + 1
        self._taken.add(name)
        return name
