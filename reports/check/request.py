"""A check as work for a supervised process: what is asked, and what comes back, both plain enough to be sent.

A user's script is run in that process: if it raises, ends the process or never ends, the command says so and goes on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from engines import Unsupported
from engines.importers import read_object
from reference.checks import InvalidMechanism
from reports.check.applying import Applied, applied
from reports.check.checked import Checked, Plan, check, read
from reports.check.telling import Section, answer, data, sections, verdict

USUAL_TOLERANCE = 1e-4  # of settings that are advised where nobody has asked for one


@dataclass(frozen=True)
class CheckRequest:
    """`word`: the model as on the command line, seen from `folder`; `notes`: a file that tells how far the work is.

    `tolerance`: None if nobody asked for one; `search`: for settings that meet it, until they are found; `apply`: the
    file that they are written into.
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
    search: bool = False
    apply: str = ""
    notes: str = ""

    @property
    def label(self) -> str:
        return self.word

    @property
    def plan(self) -> Plan:
        if not self.search:
            return Plan.usual(self.quick)
        return Plan.search(USUAL_TOLERANCE if self.tolerance is None else self.tolerance)


@dataclass(frozen=True, repr=False)
class CheckReport:
    """What was found, as the answer, as sections and as plain data; `trouble`: why nothing was written, if asked to."""

    request: CheckRequest
    verdict: str
    answer: Section
    sections: tuple[Section, ...]
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

    def told(words: str) -> None:
        if request.notes:
            Path(request.notes).write_text(words, encoding="utf-8")

    tolerance = USUAL_TOLERANCE if request.tolerance is None else request.tolerance
    try:
        told("reading")
        if model is None:
            reading = read(request.word, Path(request.folder), request.without, request.key, request.step)
        else:
            reading = read_object(model, request.without, request.step)
        name = reading.title or Path(request.word).name
        found = check(reading, name, request.duration, tolerance, told, request.plan)
    except (Unsupported, InvalidMechanism, ValueError) as reason:
        return Refused(_one_line(request, reason))
    written, trouble = None, ""
    if request.apply:
        told("writing the advised settings and running them")
        try:
            written = applied(found, Path(request.folder) / request.apply)
        except (Unsupported, InvalidMechanism, ValueError) as reason:
            trouble = _one_line(request, reason)
    return _report(request, found, written, trouble, told)


def _report(request: CheckRequest, found: Checked, written: Applied | None, trouble: str, told: Any) -> CheckReport:
    drawn = {}
    if request.pictures:
        told("drawing")
        from reports.check.picture_data import shown_of
        from reports.check.pictures import pictures  # a second of imports

        drawn = pictures(shown_of(found))
    asked = request.tolerance is not None
    first, *others = sections(found, drawn, asked)
    brief = answer(found, asked)
    if written is not None:
        notes = "".join(f"; {note}" for note in written.notes)
        fact = (
            "written",
            f"{written.file}: {written.words}; run from the file: off by {written.error:.2g}, at "
            f"{1e3 * written.cpu:.2g} ms of CPU time{notes}",
        )
        first, brief = (replace(each, facts=(*each.facts, fact)) for each in (first, brief))
    return CheckReport(request, verdict(found, asked), brief, (first, *others), data(found, asked, written), trouble)


def _one_line(request: CheckRequest, reason: Exception) -> str:
    sentence = " ".join(str(reason).split())
    return sentence if sentence.startswith(("--", request.word)) else f"{request.word}: {sentence}"
