"""How a cell can end: the closed list, and what each word means."""

from __future__ import annotations

import signal
from dataclasses import dataclass
from enum import StrEnum


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
    Outcome.SATURATED: "an angle is wrong by more than half a radian: nothing is left to compare",
    Outcome.BRANCH_FLIP: "went over to the other assembly mode",
    Outcome.TORN: "a joint opened by more than a twentieth of the mechanism's length",
    Outcome.DIVERGED: "a number stopped being finite, or a joint opened by a thousand lengths",
    Outcome.RESET: "the engine started anew by itself",
    Outcome.REFUSED: "these numbers can't be, and a sentence says why",
    Outcome.UNSUPPORTED: "the engine has no such constraint",
    Outcome.ABORTED: "native code ended the process",
    Outcome.TIMED_OUT: "did not end within its time limit",
    Outcome.FAILED: "an unexpected exception, or an answer that is no motion at the instants asked for",
    Outcome.LOST: "its process was killed from outside, twice",
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
