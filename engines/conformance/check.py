"""A check: a named function that tests an engine alone, or in one small mechanism."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Run, Unsupported, method_name
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
Status = Literal["holds", "fails", "not supported", "not asked"]

STEP = 0.01  # s, the step of most runs: a sixth of a radian of the fastest motion
SAMPLES = 8
FEWEST_WORDS = 4  # in a reason


class Fails(AssertionError):
    """The engine breaks the contract: the finding, the expectation, and the usual cause of the difference."""

    def __init__(self, found: str, expected: str, means: str) -> None:
        super().__init__(f"found {found}; expected {expected}. Usually: {means}")


class NotAsked(Exception):
    """The check does not apply to this case; the message says why."""


def require(holds: bool | np.bool_, found: str, expected: str, means: str) -> None:
    """Raises Fails unless the requirement holds."""
    if not holds:
        raise Fails(found, expected, means)


def require_a_sentence(text: str, what: str) -> None:
    """Raises Fails unless the text is one line of FEWEST_WORDS words."""
    require(
        len(text.split()) >= FEWEST_WORDS and text.isprintable(),
        f"{text!r} for {what}",
        f"one line of at least {FEWEST_WORDS} words",
        "it is raised without the sentence that a reader of the report gets to see",
    )


class Subject:
    """An engine that is being checked, with the runs that it has made."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._runs: dict[tuple[Any, ...], Trajectory] = {}

    def __str__(self) -> str:
        return method_name(self.engine)

    def build(self, mechanism: Mechanism, dt: float = STEP) -> Run:
        """Raises Unsupported if the engine does, Fails for any other exception."""
        try:
            return self.engine.build(copy.deepcopy(mechanism), dt)  # an engine may write into it
        except Unsupported:
            raise
        except Exception as error:
            raise Fails(
                f"{type(error).__name__}: {error} from build",
                "a run, or Unsupported with a sentence",
                "a mechanism that can't be built is not looked for before it is built",
            ) from error

    def fresh(self, mechanism: Mechanism, dt: float = STEP, samples: int = SAMPLES, every: int = 1) -> Trajectory:
        """A run of a new model."""
        return stepped(self.build(mechanism, dt), samples, every)

    def run(self, mechanism: Mechanism, dt: float = STEP, samples: int = SAMPLES, every: int = 1) -> Trajectory:
        """The run of these numbers, made once."""
        key = (mechanism, dt, samples, every)
        if key not in self._runs:
            self._runs[key] = self.fresh(mechanism, dt, samples, every)
        return self._runs[key]


def stepped(run: Run, samples: int, every: int) -> Trajectory:
    """The trajectory of a run; raises Fails for any exception."""
    try:
        return run(samples, every)
    except Exception as error:
        raise Fails(
            f"{type(error).__name__}: {error} from a run",
            "a Trajectory",
            "what a run can't go on from is an exception instead of NaN from that sample on",
        ) from error


def finite(run: Trajectory) -> Trajectory:
    """Return the trajectory unchanged. Raises Fails if a pose or a twist is not finite."""
    for name, values in (("pose", run.pose), ("twist", run.twist)):
        sound = np.isfinite(values).all(axis=(1, 2))
        where = int(np.argmin(sound))
        require(sound.all(), f"a {name} that is not finite at sample {where}", "numbers", "the motion has blown up")
    return run


@dataclass(frozen=True)
class Motion:
    """Poses, twists and accelerations (times, bodies, 3), and reactions (times, rows)."""

    pose: Array
    twist: Array
    acceleration: Array
    reaction: Array


@dataclass(frozen=True)
class World:
    """A mechanism and its exact motion."""

    name: str
    mechanism: Mechanism
    exact: Callable[[Array], Motion]

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its joints, each once, in the order of the mechanism."""
        return tuple(dict.fromkeys(type(joint).__name__.lower() for joint in self.mechanism.joints))


@dataclass(frozen=True)
class Check:
    """A function whose docstring begins with the requirement. `worlds`: its mechanisms, () for none."""

    function: Callable[..., None]
    worlds: tuple[World, ...] = ()

    @property
    def name(self) -> str:
        return self.function.__name__

    @property
    def asks(self) -> str:
        """One sentence."""
        return (inspect.getdoc(self.function) or "").splitlines()[0]


@dataclass(frozen=True)
class Result:
    """The status of a case, and the reason where it does not hold."""

    status: Status
    sentence: str = ""


@dataclass(frozen=True)
class Case:
    """One check of one engine, in one world or in none."""

    subject: Subject
    check: Check
    world: World | None = None

    def __str__(self) -> str:
        parts = (str(self.subject), self.check.name, *(() if self.world is None else (self.world.name,)))
        return ": ".join(parts)

    def result(self) -> Result:
        """Run the check. Never raises: an exception within a check is its failure."""
        try:
            self.check.function(self.subject, *(() if self.world is None else (self.world,)))
        except Unsupported as reason:
            return Result("not supported", str(reason))
        except NotAsked as reason:
            return Result("not asked", str(reason))
        except Fails as failure:
            return Result("fails", f"{self.check.name}: {self.check.asks} It {failure}")
        except Exception as error:
            return Result("fails", f"{self.check.name}: {self.check.asks} Looking at it raised {error!r}")
        return Result("holds")
