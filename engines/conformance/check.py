"""A check is a named function that tests an engine, with or without a small mechanism."""

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

CHECK_STEP = 0.01  # Step of most runs [s].
CHECK_SAMPLES = 8  # Number of samples of most runs.
FEWEST_WORDS = 4  # Smallest number of words in a reason.


class Fails(AssertionError):
    """The engine violates the contract. The message states the finding, the expectation and the usual cause."""

    def __init__(self, found: str, expected: str, means: str) -> None:
        super().__init__(f"found {found}; expected {expected}. Usually: {means}")


class NotApplicable(Exception):
    """The check does not apply to this case; the message says why."""


def require(holds: bool | np.bool_, found: str, expected: str, means: str) -> None:
    if not holds:
        raise Fails(found, expected, means)


def require_a_sentence(text: str, subject: str) -> None:
    """Raise Fails unless the text is one line of at least FEWEST_WORDS words."""
    require(
        len(text.split()) >= FEWEST_WORDS and text.isprintable(),
        f"{text!r} for {subject}",
        f"one line of at least {FEWEST_WORDS} words",
        "it lacks the sentence that the report prints",
    )


class CheckedEngine:
    """An engine that is checked, with a cache of its runs."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._runs: dict[tuple[Any, ...], Trajectory] = {}

    def __str__(self) -> str:
        return method_name(self.engine)

    def build(self, mechanism: Mechanism, dt: float = CHECK_STEP) -> Run:
        """Raises Unsupported if the engine raises it, and Fails for any other exception."""
        try:
            return self.engine.build(copy.deepcopy(mechanism), dt)  # a copy, since an engine may change the mechanism
        except Unsupported:
            raise
        except Exception as error:
            raise Fails(
                f"{type(error).__name__}: {error} from build",
                "a run, or Unsupported with a sentence",
                "the engine does not refuse a mechanism before it builds it",
            ) from error

    def run(
        self, mechanism: Mechanism, dt: float = CHECK_STEP, samples: int = CHECK_SAMPLES, every: int = 1
    ) -> Trajectory:
        key = (mechanism, dt, samples, every)
        if key not in self._runs:
            self._runs[key] = stepped(self.build(mechanism, dt), samples, every)
        return self._runs[key]


def stepped(run: Run, samples: int, every: int) -> Trajectory:
    """The trajectory of a run; raises Fails for any exception."""
    try:
        return run(samples, every)
    except Exception as error:
        raise Fails(
            f"{type(error).__name__}: {error} from a run",
            "a Trajectory",
            "a diverged run raises an exception; its states have to be NaN from that sample on",
        ) from error


def finite(run: Trajectory) -> Trajectory:
    """Return the trajectory, or raise Fails if a pose or a twist is not finite."""
    for name, values in (("pose", run.pose), ("twist", run.twist)):
        valid = np.isfinite(values).all(axis=(1, 2))
        sample = int(np.argmin(valid))
        require(valid.all(), f"a {name} that is not finite at sample {sample}", "numbers", "the motion has diverged")
    return run


def projection(mechanism: Mechanism) -> Callable[[Array], Array]:
    """The projection of velocities (bodies, 3) on admissible velocities, in the norm of the masses."""
    root = np.sqrt(mechanism.inertias.reshape(-1))
    _, sizes, directions = np.linalg.svd(mechanism.rows(mechanism.pose) / root)
    free = directions[np.sum(sizes > 1e-9 * sizes[0]) :]
    return lambda velocities: free.T @ (free @ (root * velocities.reshape(-1)))


@dataclass(frozen=True)
class WorldMotion:
    """Poses, twists and accelerations (times, bodies, 3), and reactions (times, rows)."""

    pose: Array
    twist: Array
    acceleration: Array
    reaction: Array


@dataclass(frozen=True)
class World:
    name: str
    mechanism: Mechanism
    exact: Callable[[Array], WorldMotion]

    @property
    def kinds(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(type(joint).__name__.lower() for joint in self.mechanism.joints))


@dataclass(frozen=True)
class ConformanceCheck:
    """A check function and its mechanisms (`worlds`). The function's docstring begins with the requirement."""

    function: Callable[..., None]
    worlds: tuple[World, ...] = ()

    @property
    def name(self) -> str:
        return self.function.__name__

    @property
    def requirement(self) -> str:
        return (inspect.getdoc(self.function) or "").splitlines()[0]


@dataclass(frozen=True)
class ConformanceResult:
    """The status of a case, and the reason if the status is not "holds"."""

    status: Status
    sentence: str = ""


@dataclass(frozen=True)
class ConformanceCase:
    """One check of one engine, with or without a mechanism (`world`)."""

    subject: CheckedEngine
    check: ConformanceCheck
    world: World | None = None

    def __str__(self) -> str:
        parts = (str(self.subject), self.check.name, *(() if self.world is None else (self.world.name,)))
        return ": ".join(parts)

    def result(self) -> ConformanceResult:
        """Run the check and return the result; an exception in the check is a failure."""
        try:
            self.check.function(self.subject, *(() if self.world is None else (self.world,)))
        except Unsupported as reason:
            return ConformanceResult("not supported", str(reason))
        except NotApplicable as reason:
            return ConformanceResult("not asked", str(reason))
        except Fails as failure:
            return ConformanceResult("fails", f"{self.check.name}: {self.check.requirement} It {failure}")
        except Exception as error:
            return ConformanceResult("fails", f"{self.check.name}: {self.check.requirement} Its check raised {error!r}")
        return ConformanceResult("holds")
