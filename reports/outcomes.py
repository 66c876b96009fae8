"""How a cell can end: the closed list, and what each word means."""

from __future__ import annotations

import signal
from enum import StrEnum


class Outcome(StrEnum):
    """One cell ends in exactly one of these; `converged` and `plateau` are given by a sweep to a cell that finished."""

    FINISHED = "finished"
    CONVERGED = "converged"
    PLATEAU = "plateau"
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


MEANINGS = {
    Outcome.FINISHED: "ran to its end on the right branch with closed joints; too few steps to say more",
    Outcome.CONVERGED: "the error falls with the step, to rounding or as far as it was followed",
    Outcome.PLATEAU: "the error stops falling while the step still does: the constraint is not the ideal one",
    Outcome.SATURATED: "an angle is wrong by more than half a radian: nothing is left to compare",
    Outcome.BRANCH_FLIP: "went over to the other assembly mode",
    Outcome.TORN: "a joint opened by more than a twentieth of the mechanism's length",
    Outcome.DIVERGED: "a number stopped being finite, or a joint opened by a thousand lengths",
    Outcome.RESET: "the engine started anew by itself",
    Outcome.REFUSED: "a sentence said why the numbers can't be",
    Outcome.UNSUPPORTED: "the engine has no such constraint",
    Outcome.ABORTED: "native code ended the process",
    Outcome.TIMED_OUT: "did not end within its time limit",
    Outcome.FAILED: "an unexpected exception",
}

LETTERS = {
    Outcome.FINISHED: "·",
    Outcome.CONVERGED: "·",
    Outcome.PLATEAU: "p",
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
}


def describe_exit(code: int) -> str:
    """The words for a process that ended with this exit code; negative codes are signals."""
    if code < 0:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = "unknown"
        return f"aborted with signal {-code} ({name})"
    return f"the process ended by itself with exit status {code}"
