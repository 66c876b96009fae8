"""A user's own model, read: the mechanism that it describes, what was left out, and the model itself, ready to be run.

What `crosscheck check` asks of a reader, and nothing of one engine. A reader stands under the entry point group
`crosscheck.readers`. What it can't read it refuses by `Unsupported`, in a sentence that names the element.
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

# The judge solves dense rows at every step: more bodies than this take minutes.
MOST_BODIES = 200


@dataclass(frozen=True)
class Note:
    """An element of the user's model that the mechanism lacks, and why the check goes on without it."""

    element: str
    reason: str


@dataclass(frozen=True)
class Obstacle:
    """What a motion meets at `t` [s] that the mechanism lacks, in `words`; `remedy`: what helps but a shorter one."""

    t: float
    words: str
    remedy: str


@dataclass(frozen=True)
class Change:
    """Documented settings of an engine: what they are in `words`, the `lines` to copy, the step `dt` [s]."""

    words: str
    dt: float
    lines: tuple[str, ...]
    options: tuple[tuple[str, Any], ...] = ()  # for the model's own use


@dataclass(frozen=True, eq=False)
class Give:
    """How rows give way by the engine's own declaration: J a = bias - damping slip - stiffness gap - compliance F.

    `instead`: at the start, what stands in the place of the bias where the engine leaves it out; NaN elsewhere.
    Of the mechanism's rows; zero where a row holds exactly. stiffness (rows,) [1/s^2]; damping (rows,) [1/s];
    compliance (rows, rows) [1/kg, 1/(kg m^2)].
    """

    stiffness: Array
    damping: Array
    compliance: Array
    instead: Array


class OwnModel(Protocol):
    """A user's model as it is: it can be run from its start as often as one likes."""

    @property
    def engine(self) -> str: ...
    @property
    def dt(self) -> float:
        """The user's step [s]."""
        ...

    @property
    def assumed(self) -> str:
        """What the model doesn't say and the reader took instead, in words; empty if nothing."""
        ...

    @property
    def settings(self) -> Mapping[str, str]:
        """The engine's own settings in the model, in words."""
        ...

    @property
    def declares(self) -> bool:
        """Whether the engine declares a law of its joints that no step takes part in."""
        ...

    @property
    def softly_held(self) -> bool:
        """Whether that law lets some joints give way."""
        ...

    @property
    def own_twist(self) -> Array:
        """The user's velocities at t = 0 (bodies, 3) [m/s, rad/s], which the mechanism's joints may not allow."""
        ...

    def start(self) -> Array:
        """The engine's accelerations at t = 0 (bodies, 3) [m/s^2, rad/s^2], at the mechanism's velocities."""
        ...

    def give(self, gap: Array, pose: Array) -> Give:
        """How the joints give way where they are open by `gap` (rows,) [m, rad], at a pose (bodies, 3)."""
        ...

    def without(self, element: str) -> Array:
        """`start`, with one of `elements` switched off."""
        ...

    @property
    def elements(self) -> Sequence[str]:
        """What can be switched off, to find out what explains a difference."""
        ...

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        """The first of each kind that a motion of poses and twists (times, bodies, 3) meets, in the order of time.

        All that the reading took for granted is asked for here: contacts, limits of motions and of forces, sleep.
        """
        ...

    @property
    def suspects(self) -> Mapping[str, str]:
        """Elements that the engine holds by another law than an ideal joint's at any step, each with why."""
        ...

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        """Settings that the engine documents, with steps down to `smallest` [s]; the first is the user's own.

        `further`: all that may help if the usual ones do not.
        """
        ...

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        """What the reading has taken for something else, with its effect on a run of the user's own settings."""
        ...

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        """The user's model in motion: samples + 1 states, `every` of the user's steps apart."""
        ...


@dataclass(frozen=True, eq=False)
class Source:
    """The file of a user's model: `changed` gives its bytes with other settings, and `read` reads such a file in the
    way in which this one was read. Either raises Unsupported.
    """

    path: Path
    changed: Callable[[Change], bytes]
    read: Callable[[Path], Reading]


@dataclass(frozen=True, eq=False)
class Reading:
    """What a user's model describes: a mechanism, what was left out of it, and the model, as it is.

    `source`: the file that it was read from; None where it has no text.
    """

    mechanism: Mechanism
    model: OwnModel
    notes: tuple[Note, ...]
    title: str = ""
    source: Source | None = None

    @property
    def jumps(self) -> bool:
        """Whether the model starts with velocities that its joints do not allow, so that the ideal motion begins after
        an impulse."""
        return bool(np.any(self.model.own_twist != self.mechanism.twist))


@dataclass(frozen=True)
class ReadingTerms:
    """The terms on which a user's model is read.

    `without`: kinds of elements to switch off, in the user's model too; `key`: the name or number of a stored state;
    `step` [s]: the user's, instead of the model's own.
    """

    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None


AS_IT_IS = ReadingTerms()


class Reader(Protocol):
    """Under `crosscheck.readers`: it says what it reads, and reads it."""

    @property
    def words(self) -> str:
        """What it reads, for a message."""
        ...

    @property
    def elements(self) -> Mapping[str, str]:
        """What it reads, by the engine's own name, and as what: one table, from which the page is made."""
        ...

    def reads(self, word: str) -> bool:
        """Whether a word on the command line is a model for this reader."""
        ...

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
        """The model. Raises Unsupported, or ValueError where the file is no model."""
        ...


def refuse(element: str, reason: str) -> Unsupported:
    """The error for an element that has no ideal counterpart."""
    return Unsupported(f"{element}: {reason}")


def left_out(element: str) -> str:
    """The consequence of leaving out an element that acts in the motion: an option, and no advice."""
    return f"--without {element} judges your model without it, which moves otherwise"


def refuse_at_start(model: OwnModel, mechanism: Mechanism) -> None:
    """Raises Unsupported if the start itself meets what the mechanism lacks."""
    for each in model.obstacles(np.zeros(1), mechanism.pose[None], mechanism.twist[None]):
        reason = f"so it does at the start, and an ideal mechanism doesn't know it; {each.remedy}"
        raise refuse(each.words, reason)


class Names:
    """Names that differ: a model may call a joint and an equality alike, or nothing at all."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def new(self, wanted: str) -> str:
        """The name wanted, or the same with a number."""
        name, number = wanted, 2
        while name in self._taken:
            name, number = f"{wanted} ({number})", number + 1
        self._taken.add(name)
        return name
