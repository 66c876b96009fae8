"""A check as work for a supervised process: what is asked, and what comes back, both plain enough to be sent.

A user's script is run in that process: if it raises, ends the process or never ends, the command says so and goes on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from reports.check.checked import Plan
    from reports.check.rendering import Section

USUAL_TOLERANCE = 1e-4  # of settings that are advised where nobody has asked for one


@dataclass(frozen=True)
class CheckRequest:
    """`word`: the model as on the command line, seen from `folder`; `notes`: a file that tells how far the work is.

    `tolerance`: None if nobody asked for one; `quick`, `everything`: see `Plan`; `search`: for settings that meet it,
    until they are found; `apply`: the file that they are written into.
    """

    word: str
    folder: str
    duration: float
    tolerance: float | None = None
    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None
    pictures: bool = False
    quick: bool = False
    everything: bool = False
    search: bool = False
    apply: str = ""
    notes: str = ""

    @property
    def label(self) -> str:
        return self.word

    @property
    def plan(self) -> Plan:
        from reports.check.checked import PATIENCE, SEARCH, Plan

        if not self.search:
            return Plan(PATIENCE, quick=self.quick, everything=self.everything)
        return Plan(SEARCH, USUAL_TOLERANCE if self.tolerance is None else self.tolerance)


@dataclass(frozen=True, repr=False)
class CheckReport:
    """What was found, as the answer, as sections, as a line of a table and as plain data; `trouble`: why nothing was
    written, if asked to.
    """

    request: CheckRequest
    verdict: str
    answer: Section
    sections: tuple[Section, ...]
    line: tuple[str, ...]
    data: dict[str, Any]
    trouble: str = ""

    @property
    def fine(self) -> bool:
        """Whether a tolerance that was asked for is met, by the user's settings or by those that were looked for."""
        mended = (self.request.search or self.data["applied"] is not None) and self.data["advised"] is not None
        return self.request.tolerance is None or self.data["met"] or mended

    def __repr__(self) -> str:
        from reports.check.rendering import plain

        return f"{self.verdict}\n{plain([self.answer])}"

    def _repr_html_(self) -> str:
        from reports.check.rendering import body

        return body(self.verdict, self.sections)


@dataclass(frozen=True)
class Refused:
    """One sentence that says why there is no answer."""

    sentence: str


def answered(request: CheckRequest, model: Any = None) -> CheckReport | Refused:
    """In a worker: the check, or why there is none. `model`: an engine's own object, in the place of a file."""

    # Here: who only asks is sooner there.
    from engines import Unsupported
    from engines.importers import read_object
    from engines.registry import mislabelled
    from reference.checks import InvalidMechanism
    from reports.check.applying import applied
    from reports.check.checked import check, read
    from reports.check.document import data
    from reports.check.telling import answer, line, sections

    def told(words: str) -> None:
        if request.notes:
            Path(request.notes).write_text(words, encoding="utf-8")

    tolerance = USUAL_TOLERANCE if request.tolerance is None else request.tolerance
    if sentence := mislabelled():
        return Refused(sentence)
    try:
        told("reading")
        if model is None:
            reading = read(request.word, Path(request.folder), request.without, request.key, request.step)
        else:
            reading = read_object(model, request.without, request.step)
        name = reading.title or Path(request.word).name
        found = check(reading, name, request.duration, tolerance, told, request.plan, request.tolerance is not None)
    except (Unsupported, InvalidMechanism, ValueError) as reason:
        return Refused(_one_line(request, reason))
    trouble, drawn = "", {}
    if request.apply:
        told("writing the advised settings and running them")
        try:
            found = replace(found, applied=applied(found, Path(request.folder) / request.apply))
        except (Unsupported, InvalidMechanism, ValueError) as reason:
            trouble = _one_line(request, reason)
    if request.pictures:
        told("drawing")
        from reports.check.picture_data import shown_of
        from reports.check.pictures import pictures  # a second of imports

        drawn = pictures(shown_of(found))
    return CheckReport(request, found.verdict, answer(found), sections(found, drawn), line(found), data(found), trouble)


def _one_line(request: CheckRequest, reason: Exception) -> str:
    sentence = " ".join(str(reason).split())
    return sentence if sentence.startswith(("--", request.word)) else f"{request.word}: {sentence}"
