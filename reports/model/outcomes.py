"""How a cell can end: the closed list, what each word means, and the one place where it is decided.

`of_motion` decides of a cell that gave a motion; `refusal`, `failure`, `out_of_time` and `of_lost_process` of others.
`converged` and `plateau` need a sweep (`reports.model.convergence`).
"""

from __future__ import annotations

import math
import signal
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from reports.model.ending import describe

if TYPE_CHECKING:
    from reference.mechanism import Mechanism
    from reference.trajectory import Trajectory
    from reports.model.measure import Measurement

TORN = 0.05  # of the mechanism's length: far above any softness, far below a link
BLOWN = 1e3  # of the mechanism's length
SATURATED = 0.5  # rad: the angle error's growth is no longer proportional to what causes it


class Outcome(StrEnum):
    """One cell ends in exactly one of these; `converged` and `plateau` are given by a sweep to a cell that finished."""

    FINISHED = "finished"
    CONVERGED = "converged"
    PLATEAU = "plateau"
    UNRESOLVED = "unresolved"
    SATURATED = "saturated"
    BRANCH_FLIP = "branch flip"
    TORN = "torn"
    DIVERGED = "diverged"
    RESET = "reset"
    REFUSED = "refused"
    UNSUPPORTED = "unsupported"
    ABORTED = "aborted"
    TIMED_OUT = "timed out"
    FAILED = "failed"
    LOST = "lost"  # never stored: it says nothing about the engine

    @property
    def meaning(self) -> str:
        """One clause for the legend of a page."""
        return MEANINGS[self]

    @property
    def letter(self) -> str:
        """One letter for a map, so that it can be read without colours."""
        return LETTERS[self]

    @property
    def comparable(self) -> bool:
        """Whether the errors of such a cell say how exact the method is (else they only say that it failed)."""
        return self in (Outcome.FINISHED, Outcome.CONVERGED, Outcome.PLATEAU)

    @property
    def wrong(self) -> bool:
        """Whether the cell ran and what it did is not the scene's motion."""
        return self in (Outcome.SATURATED, Outcome.BRANCH_FLIP, Outcome.TORN, Outcome.DIVERGED, Outcome.RESET)

    @property
    def grade(self) -> int:
        """How grave it is: 0 can be compared, 1 says itself that it has none, 2 is wrong, 3 gave nothing at all."""
        if self.comparable:
            return 0
        if self in (Outcome.UNRESOLVED, Outcome.REFUSED, Outcome.UNSUPPORTED):
            return 1
        return 2 if self.wrong else 3


MEANINGS = {
    Outcome.FINISHED: "ran to its end on the right branch with closed joints; the error may still be large",
    Outcome.CONVERGED: "the error falls with the step, to rounding or as far as it was followed",
    Outcome.PLATEAU: "the error stops falling while the step still does: the constraint is not the ideal one",
    Outcome.UNRESOLVED: "the method's own estimate of its error is above what it claims, and it says so",
    Outcome.SATURATED: f"an angle is wrong by more than {SATURATED:g} rad: nothing is left to compare",
    Outcome.BRANCH_FLIP: "went over to the other assembly mode",
    Outcome.TORN: f"a joint opened by more than {TORN:g} of the mechanism's length",
    Outcome.DIVERGED: f"a number stopped being finite, or a joint opened by {BLOWN:g} lengths",
    Outcome.RESET: "the engine started anew by itself",
    Outcome.REFUSED: "these numbers can't be, and a sentence says why",
    Outcome.UNSUPPORTED: "the engine has no such constraint, or our adapter builds none; a sentence says which",
    Outcome.ABORTED: "native code ended the process",
    Outcome.TIMED_OUT: "did not end within its time limit",
    Outcome.FAILED: "an unexpected exception, or an answer that is no motion at the instants asked for",
    Outcome.LOST: "its process was killed from outside, twice, or a module could not be imported there",
}

LETTERS = {
    Outcome.FINISHED: "·",
    Outcome.CONVERGED: "·",
    Outcome.PLATEAU: "p",
    Outcome.UNRESOLVED: "u",
    Outcome.SATURATED: "S",
    Outcome.BRANCH_FLIP: "B",
    Outcome.TORN: "T",
    Outcome.DIVERGED: "D",
    Outcome.RESET: "R",
    Outcome.REFUSED: "r",
    Outcome.UNSUPPORTED: "-",
    Outcome.ABORTED: "A",
    Outcome.TIMED_OUT: "L",
    Outcome.FAILED: "F",
    Outcome.LOST: "x",
}


@dataclass(frozen=True)
class Loss:
    """Why a cell has no result: what a supervised process leaves instead of one."""

    outcome: Outcome
    sentence: str


# Sent by somebody else: a user, a batch system at its own limits, the kernel for want of memory (SIGKILL). All other
# signals that end a process are raised by what runs in it. Windows has few of these names.
FROM_OUTSIDE = {
    getattr(signal, name)
    for name in ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT", "SIGXCPU", "SIGXFSZ")
    if hasattr(signal, name)
}


def from_outside(code: int | None) -> bool:
    """Whether a process with this exit code was ended by somebody else; None: nobody knows how it ended."""
    return code is None or -code in FROM_OUTSIDE


def describe_exit(code: int | None) -> str:
    """The words for a process that ended with this exit code; negative codes are signals."""
    if code is None:
        return "the process ended, nobody knows how"
    if code < 0:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = "unknown"
        how = "killed from outside" if from_outside(code) else "aborted"
        return f"{how} with signal {-code} ({name})"
    if code >= 2**31:  # Windows ends a process that does what it may not with such a status
        return f"aborted with status 0x{code:08X}"
    return f"the process ended by itself with exit status {code}"


def refusal(reason: Exception) -> Loss:
    """Of a cell that an engine or the reference can't do, in its own words: ValueError, or `engines.Unsupported`."""
    return Loss(Outcome.REFUSED if isinstance(reason, ValueError) else Outcome.UNSUPPORTED, str(reason))


def failure(error: BaseException) -> Loss:
    """Of a cell that raised anything else. An import that fails says nothing about the engine."""
    return Loss(Outcome.LOST if isinstance(error, ImportError) else Outcome.FAILED, describe(error))


def out_of_time(limit: float, wall: float | None = None) -> Loss:
    """Of a cell that used up its CPU time [s]; or, with `wall`, that slept longer than this [s]."""
    if wall is None:
        return Loss(Outcome.TIMED_OUT, f"did not end within {limit:g} s of CPU time")
    return Loss(Outcome.TIMED_OUT, f"did not end within {wall:g} s, and used less than {limit:g} s of CPU time")


def of_lost_process(code: int | None, words: str, earlier: str) -> Loss:
    """Of a cell whose process ended, with this exit code and in these words, at its second try. earlier: the first."""
    if from_outside(code):
        return Loss(Outcome.LOST, f"{words}, perhaps for want of memory; before that: {earlier}")
    return Loss(Outcome.ABORTED, words)


def of_motion(row: Measurement, mechanism: Mechanism, trajectory: Trajectory, count: int) -> tuple[Outcome, str]:
    """(one cell's outcome, the gravest first; the number that decided it): `count` samples of its motion are finite."""
    length = mechanism.length_scale
    if trajectory.reset_at is not None:
        return Outcome.RESET, f"started anew by itself at {trajectory.reset_at:.4g} s"
    if count < len(trajectory.t):
        return Outcome.DIVERGED, f"not finite from {trajectory.t[count]:.4g} s"
    if row.gap > BLOWN * length:
        return Outcome.DIVERGED, f"a joint opened by {row.gap:.2g} m"
    if row.gap > TORN * length:
        # Adapters begin their own findings with "ours:"; what counts here is whether the engine itself said anything.
        quiet = "" if any(not w.startswith("ours:") for w in trajectory.warnings) else ", without a warning"
        return Outcome.TORN, f"a joint opened by {row.gap:.2g} m in a mechanism of {length:.2g} m{quiet}"
    if row.drive_gap > SATURATED:
        return Outcome.TORN, f"the drive fell behind by {row.drive_gap:.2g} rad"
    if row.flips:
        return Outcome.BRANCH_FLIP, f"{row.flips} change{'s' if row.flips > 1 else ''} of assembly that the truth lacks"
    if row.angle > SATURATED:
        return Outcome.SATURATED, f"an angle is wrong by {row.angle:.2g} rad within the horizon"
    if trajectory.unresolved_at is not None:
        if math.isnan(row.estimate):
            return Outcome.UNRESOLVED, "its coarser run was lost, so it has no estimate"
        return Outcome.UNRESOLVED, f"its own estimate is {row.estimate:.2g} rad"
    if row.angle_duration > SATURATED:
        return Outcome.FINISHED, f"beyond the horizon an angle is wrong by {row.angle_duration:.2g} rad"
    return Outcome.FINISHED, ""
