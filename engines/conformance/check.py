"""What a check is: a named question to an engine, asked of it alone or of it in one small mechanism."""

from __future__ import annotations

import copy
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from engines import Engine, Run, Unsupported, method_name
from engines.conformance.worlds import World
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Status = Literal["holds", "fails", "not supported", "not asked"]

STEP = 0.01  # s, of the runs that most checks look at: a sixth of a radian of the fastest motion
SAMPLES = 8
FEWEST_WORDS = 4  # of a sentence that says what can't be and why


class Fails(AssertionError):
    """What was found, what was expected, and what it usually means that they differ."""

    def __init__(self, found: str, expected: str, means: str) -> None:
        super().__init__(f"found {found}; expected {expected}. Usually: {means}")


class NotAsked(Exception):
    """The check has nothing to hold the engine to here; the message says why."""


class Subject:
    """An engine that is being checked; what it has run once is kept."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._kept: dict[tuple[Any, ...], Trajectory] = {}

    def __str__(self) -> str:
        return method_name(self.engine)

    def build(self, mechanism: Mechanism, dt: float = STEP) -> Run:
        """Raises Unsupported if the engine does, Fails for any other exception."""
        own = copy.deepcopy(mechanism)  # an engine that writes into it spoils this check alone
        try:
            return self.engine.build(own, dt)
        except Unsupported:
            raise
        except Exception as error:
            raise Fails(
                f"{type(error).__name__}: {error} from build",
                "a run, or Unsupported with a sentence",
                "a mechanism that can't be built is not looked for before it is built",
            ) from error

    def fresh(self, mechanism: Mechanism, dt: float = STEP, samples: int = SAMPLES, every: int = 1) -> Trajectory:
        """Built anew and run."""
        return stepped(self.build(mechanism, dt), samples, every)

    def run(self, mechanism: Mechanism, dt: float = STEP, samples: int = SAMPLES, every: int = 1) -> Trajectory:
        """The same numbers, run the first time that they are asked for."""
        key = (mechanism, dt, samples, every)
        if key not in self._kept:
            self._kept[key] = self.fresh(mechanism, dt, samples, every)
        return self._kept[key]


def stepped(run: Run, samples: int, every: int) -> Trajectory:
    """A run called; Fails for any exception."""
    try:
        return run(samples, every)
    except Exception as error:
        raise Fails(
            f"{type(error).__name__}: {error} from a run",
            "a Trajectory",
            "what a run can't go on from is an exception instead of NaN from that sample on",
        ) from error


def require_a_sentence(text: str, what: str) -> None:
    """Fails unless it is one line of some words."""
    if len(text.split()) < FEWEST_WORDS or not text.isprintable():
        raise Fails(
            f"{text!r} for {what}",
            f"one line of at least {FEWEST_WORDS} words",
            "it is raised without the sentence that a reader of the report gets to see",
        )


def finite(run: Trajectory) -> Trajectory:
    """The run, which Fails if a pose or a twist in it is no number."""
    for name, values in (("pose", run.pose), ("twist", run.twist)):
        if not np.all(np.isfinite(values)):
            where = int(np.argwhere(~np.isfinite(values))[0, 0])
            raise Fails(f"a {name} that is not finite at sample {where}", "numbers", "the motion has blown up")
    return run


@dataclass(frozen=True)
class Check:
    """A question with a name; its first line says what is asked. `worlds`: what it is asked of, () for none."""

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
    """What came of a case, and the sentence that says why where it does not hold."""

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
        """Asked now. Never raises: what goes wrong within a check is a failure of it."""
        try:
            if self.world is None:
                self.check.function(self.subject)
            else:
                self.check.function(self.subject, self.world)
        except Unsupported as reason:
            return Result("not supported", str(reason))
        except NotAsked as reason:
            return Result("not asked", str(reason))
        except Fails as failure:
            return Result("fails", f"{self.check.name}: {self.check.asks} It {failure}")
        except Exception as error:
            return Result("fails", f"{self.check.name}: {self.check.asks} Looking at it raised {error!r}")
        return Result("holds")
