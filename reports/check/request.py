"""The request and the report of a check, which can be pickled since a check runs in a supervised process.

The supervised process runs the user's script, so the command continues if the script raises, exits or never ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reports.check.checked import SweepPlan
    from reports.check.rendering import Section

DEFAULT_TOLERANCE = 1e-4  # Tolerance for the advised settings if the user gives none.
MAX_DURATION = 1000.0  # Longest duration of a motion [s].


@dataclass(frozen=True)
class CheckRequest:
    """The options of `crosscheck check` and of `planar_crosscheck.check`. `without`, `key` and `step` are described in
    `ReadingTerms`, `quick` and `everything` in `SweepPlan`."""

    word: str  # The model as on the command line; a path is relative to `folder`.
    folder: str
    duration: float = 2.0  # s.
    tolerance: float | None = None  # None: not given.
    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None
    pictures: bool = False
    quick: bool = False
    everything: bool = False
    search: bool = False  # Try smaller steps until a setting meets the tolerance.
    apply: str = ""  # Path of the file to write with the advised settings.
    notes: str = ""  # Path of the file to which the progress is written.

    def refuse_bad(self) -> CheckRequest:
        """Return the request. Raises BadInput if a number is out of range."""
        tolerance = "fix-to" if self.search else "tolerance"
        for name, value, most in (("duration", self.duration, MAX_DURATION), (tolerance, self.tolerance, 1.0)):
            if value is not None and not 0 < value <= most:
                raise BadInput(f"--{name} is {value:g}; it must be greater than zero and at most {most:g}")
        if self.step is not None and not 0 < self.step <= self.duration:
            limits = f"greater than zero and at most the duration, {self.duration:g}"
            raise BadInput(f"--step is {self.step:g}; it must be {limits}")
        return self

    @property
    def label(self) -> str:
        return self.word

    @property
    def plan(self) -> SweepPlan:
        from reports.check.checked import SEARCH_BUDGET, SWEEP_BUDGET, SweepPlan

        if not self.search:
            return SweepPlan(SWEEP_BUDGET, quick=self.quick, everything=self.everything)
        return SweepPlan(SEARCH_BUDGET, DEFAULT_TOLERANCE if self.tolerance is None else self.tolerance)


@dataclass(frozen=True, repr=False)
class CheckReport:
    request: CheckRequest
    verdict: str
    answer: Section  # the first screen
    sections: tuple[Section, ...]
    line: tuple[str, ...]  # The row in the table of a folder.
    data: dict[str, Any]  # The JSON document.
    trouble: str = ""  # The reason if --apply has written no file.

    @property
    def fine(self) -> bool:
        """Whether the user gave no tolerance, or settings of the user, of --fix-to or of --apply meet it."""
        mended = (self.request.search or self.data["applied"] is not None) and self.data["advised"] is not None
        return self.request.tolerance is None or self.data["met"] or mended

    def __repr__(self) -> str:
        from reports.check.rendering import plain

        return f"{self.verdict}\n{plain([self.answer])}"

    def _repr_html_(self) -> str:
        from reports.check.rendering import html

        return html(self.verdict, self.sections, page=False)


@dataclass(frozen=True)
class Refused:
    """The reason why a model was not checked."""

    sentence: str


def run_check(request: CheckRequest, model: Any = None) -> CheckReport | Refused:
    """Run the check in this process. model: a model object that replaces the file."""
    # A command that only makes requests does not need these imports.
    from engines import Unsupported
    from engines.importers import read_object
    from engines.reading import ReadingTerms
    from engines.registry import mislabelled
    from reports.check.checked import apply_advised, check, read_user_model
    from reports.check.document import check_data
    from reports.check.telling import answer_section, report_sections, summary_row

    def note(words: str) -> None:
        if request.notes:
            Path(request.notes).write_text(words, encoding="utf-8")

    def refusal(reason: Exception) -> str:
        sentence = " ".join(str(reason).split())
        return sentence if sentence.startswith(("--", request.word)) else f"{request.word}: {sentence}"

    if sentence := mislabelled():
        return Refused(sentence)
    tolerance = DEFAULT_TOLERANCE if request.tolerance is None else request.tolerance
    trouble, svg_pictures = "", {}
    try:
        note("reading")
        reading_terms = ReadingTerms(tuple(request.without), request.key, request.step)
        reading = (
            read_user_model(request.word, Path(request.folder), reading_terms)
            if model is None
            else read_object(model, reading_terms)
        )
        name = reading.title or Path(request.word).name
        result = check(reading, name, request.duration, tolerance, note, request.plan, request.tolerance is not None)
    except (Unsupported, ValueError) as reason:  # This includes InvalidMechanism.
        return Refused(refusal(reason))
    if request.apply:
        note("writing the advised settings and running them")
        try:
            result = replace(result, applied=apply_advised(result, Path(request.folder) / request.apply))
        except (Unsupported, ValueError) as reason:
            trouble = refusal(reason)
    if request.pictures:
        note("drawing")
        from reports.check.pictures import picture_data_of, render_pictures  # Importing this module takes a second.

        svg_pictures = render_pictures(picture_data_of(result))
    report_parts = answer_section(result), report_sections(result, svg_pictures), summary_row(result)
    return CheckReport(request, result.verdict, *report_parts, check_data(result), trouble)
