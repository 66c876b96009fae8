"""The possible outcomes of a cell, and the functions that determine the outcome.

`of_motion` determines the outcome of a motion, but `converged` and `plateau` follow from a sweep.
"""

from __future__ import annotations

import math
import signal
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Self

from reports.model.ending import describe

if TYPE_CHECKING:
    from reference.mechanism import Mechanism
    from reference.trajectory import Trajectory
    from reports.model.measure import Measurement

TORN = 0.05  # A larger gap, relative to the mechanism's length, is a torn joint. Softness causes much smaller gaps.
BLOWN = 1e3  # A larger gap, relative to the mechanism's length, means that the run has diverged.
SILENT = "without a warning"  # These words are in the sentence of a torn joint if the engine has no warning.
SATURATED = 0.5  # A larger angle error [rad] is not proportional to its cause.


class Outcome(StrEnum):
    meaning: str  # A clause for pages.
    letter: str  # Letter in maps.
    grade: int  # 0: comparable errors, 1: no result by declaration, 2: wrong motion, 3: no motion.
    colour: str  # Colour in maps, a field of `reports.plots.theme.Theme`.
    hatch: str  # Hatching in maps.

    def __new__(cls, word: str, letter: str, grade: int, colour: str, hatch: str, meaning: str) -> Self:
        outcome = str.__new__(cls, word)
        outcome._value_ = word
        outcome.letter, outcome.grade, outcome.colour = letter, grade, colour
        outcome.hatch, outcome.meaning = hatch, meaning
        return outcome

    FINISHED = (
        *("finished", "·", 0, "middling", ""),
        "ran to its end on the right branch with closed joints; the error may still be large",
    )
    CONVERGED = (
        *("converged", "·", 0, "middling", ""),
        "the error falls with the step, to rounding or as far as it was followed",
    )
    PLATEAU = (
        *("plateau", "p", 0, "middling", ""),
        "the error stops falling while the step still does: the constraint is not the ideal one",
    )
    UNRESOLVED = (
        *("unresolved", "u", 1, "middling", "oo"),
        "the method's own estimate of its error is above what it claims, and it says so",
    )
    SATURATED = (
        *("saturated", "S", 2, "bad", ".."),
        f"an angle is wrong by more than {SATURATED:g} rad: nothing is left to compare",
    )
    BRANCH_FLIP = ("branch flip", "B", 2, "bad", "\\\\\\", "went over to the other assembly mode")
    TORN = ("torn", "T", 2, "bad", "///", f"a joint opened by more than {TORN:g} of the mechanism's length")
    DIVERGED = (
        *("diverged", "D", 2, "bad", "xx"),
        f"a number stopped being finite, or a joint opened by {BLOWN:g} lengths",
    )
    RESET = ("reset", "R", 2, "bad", "--", "the engine started anew by itself")
    REFUSED = ("refused", "r", 1, "grid", "", "these numbers can't be, and a sentence says why")
    UNSUPPORTED = (
        *("unsupported", "-", 1, "grid", ""),
        "the engine has no such constraint, or our adapter builds none; a sentence says which",
    )
    ABORTED = ("aborted", "A", 3, "worse", "++", "native code ended the process")
    TIMED_OUT = ("timed out", "L", 3, "worse", "||", "did not end within its time limit")
    FAILED = (
        *("failed", "F", 3, "worse", ""),
        "an unexpected exception, or an answer that is no motion at the instants asked for",
    )
    # This outcome is not stored, since it does not depend on the engine.
    LOST = (
        *("lost", "x", 3, "worse", ""),
        "its process was killed from outside, twice, or a module could not be imported there",
    )

    @property
    def comparable(self) -> bool:
        """Whether errors of cells with this outcome measure the accuracy of the method."""
        return self.grade == 0

    @property
    def wrong(self) -> bool:
        return self.grade == 2


@dataclass(frozen=True)
class Loss:
    outcome: Outcome
    sentence: str


# These signals are sent to a process by a user, a batch system, or the kernel if memory is short. Other signals that
# end a process are caused by the code of the process. Windows defines only few of these names.
FROM_OUTSIDE = {
    getattr(signal, name)
    for name in ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT", "SIGXCPU", "SIGXFSZ")
    if hasattr(signal, name)
}


def from_outside(code: int | None) -> bool:
    """Whether the exit code is unknown (None), or means that another process has ended this process."""
    return code is None or -code in FROM_OUTSIDE


def describe_exit(code: int | None) -> str:
    """A clause about a process with this exit code. Negative codes are signals."""
    if code is None:
        return "the process ended with an unknown exit status"
    if code < 0:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = "unknown"
        how = "killed from outside" if from_outside(code) else "aborted"
        return f"{how} with signal {-code} ({name})"
    if code >= 2**31:  # Windows uses such a status for a forbidden operation.
        return f"aborted with status 0x{code:08X}"
    return f"the process ended by itself with exit status {code}"


def refusal(reason: Exception) -> Loss:
    """The result of a cell if the engine or the reference raises ValueError or `engines.Unsupported`."""
    return Loss(Outcome.REFUSED if isinstance(reason, ValueError) else Outcome.UNSUPPORTED, str(reason))


def failure(error: BaseException) -> Loss:
    """The result of a cell that raises any other exception. After an ImportError the outcome is LOST."""
    return Loss(Outcome.LOST if isinstance(error, ImportError) else Outcome.FAILED, describe(error))


def out_of_time(limit: float, wall: float | None = None) -> Loss:
    """The result of a cell that exceeds its CPU time [s], or, if `wall` is given, this wall time [s]."""
    if wall is None:
        return Loss(Outcome.TIMED_OUT, f"did not end within {limit:g} s of CPU time")
    return Loss(Outcome.TIMED_OUT, f"did not end within {wall:g} s, and used less than {limit:g} s of CPU time")


def of_motion(row: Measurement, mechanism: Mechanism, trajectory: Trajectory, count: int) -> tuple[Outcome, str]:
    """(the gravest outcome that applies, a sentence with the reason). count: number of finite samples."""
    length = mechanism.length_scale
    if trajectory.reset_at is not None:
        return Outcome.RESET, f"started anew by itself at {trajectory.reset_at:.4g} s"
    if count < len(trajectory.t):
        return Outcome.DIVERGED, f"not finite from {trajectory.t[count]:.4g} s"
    if row.gap > BLOWN * length:
        return Outcome.DIVERGED, f"a joint opened by {row.gap:.2g} m"
    if row.gap > TORN * length:
        # Warnings of the engine count, but warnings of our adapters do not.
        quiet = "" if trajectory.has_engine_warning else f", {SILENT}"
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
