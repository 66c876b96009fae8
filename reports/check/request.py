"""A check as work for a supervised process: what is asked, and what comes back, both plain enough to be sent.

A user's script is run in that process: if it raises, ends the process or never ends, the command says so and goes on.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from engines import Unsupported
from reference.validation import InvalidMechanism
from reports.check.checked import check, read
from reports.check.telling import Section, data, sections, verdict


@dataclass(frozen=True)
class CheckRequest:
    """`word`: the model as on the command line, seen from `folder`; `notes`: a file that tells how far the work is."""

    word: str
    folder: str
    duration: float
    tolerance: float
    without: tuple[str, ...] = ()
    key: str = ""
    step: float | None = None
    pictures: bool = True
    notes: str = ""

    @property
    def label(self) -> str:
        return self.word


@dataclass(frozen=True)
class CheckReport:
    """What was found, as sections and as plain data."""

    met: bool
    verdict: str
    sections: tuple[Section, ...]
    data: dict[str, Any]
    seconds: float


@dataclass(frozen=True)
class Refused:
    """One sentence that says why there is no answer."""

    sentence: str


def answered(request: CheckRequest) -> CheckReport | Refused:
    """In a worker: the check, or why there is none."""
    begin = time.monotonic()

    def told(words: str) -> None:
        if request.notes:
            Path(request.notes).write_text(words, encoding="utf-8")

    try:
        told("reading")
        reading = read(request.word, Path(request.folder), request.without, request.key, request.step)
        found = check(reading, reading.title or Path(request.word).name, request.duration, request.tolerance, told)
        drawn = {}
        if request.pictures:
            told("drawing")
            from reports.check.picture_data import shown_of
            from reports.check.pictures import pictures  # a second of imports

            drawn = pictures(shown_of(found))
    except (Unsupported, InvalidMechanism, ValueError) as reason:
        return Refused(_one_line(request, reason))
    told_sections = tuple(sections(found, drawn))
    return CheckReport(found.met, verdict(found), told_sections, data(found), time.monotonic() - begin)


def _one_line(request: CheckRequest, reason: Exception) -> str:
    sentence = " ".join(str(reason).split())
    return sentence if sentence.startswith(("--", request.word)) else f"{request.word}: {sentence}"
