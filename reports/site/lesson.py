"""The types of lessons (scenes, experiments and their texts) and of the input of a site."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from reports.model.tasks import Answer, Motion
from reports.site.live.sliders import DOCUMENTED, ENGINES, Live, Name

FOLDER = Path(__file__).parent / "lessons"
BOTH: dict[str, Any] = dict.fromkeys(ENGINES, DOCUMENTED)
FORCES, CENTRE = ("reactions",), ("centre",)  # overlays


@dataclass(frozen=True)
class Claim:
    """A claim on the effect of a change of settings: an engine's error becomes `least` to `most` times as large."""

    engine: Name
    least: float = 0.0
    most: float = math.inf


@dataclass(frozen=True)
class Experiment:
    """The settings before a question, and the change of them that answers it.

    `before`: values of controls of the scene called `scene`, the others have their start values; `after`: the values
    that change then. claims: errors after the change relative to those before. causes: further changes, each with a
    claim relative to the errors after the change, so that a text that names a cause is tested without that cause.
    overlays: names of overlays beside the paths. section: the heading of a part of the Markdown page that is quoted.
    """

    scene: str
    before: Mapping[str, Any] = field(default_factory=dict)
    after: Mapping[str, Any] = field(default_factory=dict)
    claims: tuple[Claim, ...] = ()
    causes: tuple[tuple[Mapping[str, Any], Claim], ...] = ()
    overlays: tuple[str, ...] = ()
    section: str = ""


@dataclass(frozen=True)
class Part:
    """The texts of an experiment: heading, introduction, question, answers with the right one marked, explanation."""

    heading: str
    text: str
    question: str
    answers: tuple[tuple[str, bool], ...]  # (words, whether it is right)
    after: str


@dataclass(frozen=True)
class Lesson:
    """A mechanism's page: scenes that engines run in it, experiments on these, and their words in lessons/`name`.md."""

    name: str
    title: str
    page: str  # the Markdown page of the same mechanism
    scenes: tuple[Live, ...]
    experiments: tuple[Experiment, ...]

    def scene(self, word: str) -> Live:
        """Return the scene of this name. Raises StopIteration without one."""
        return next(live for live in self.scenes if live.word == word)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The texts of each experiment. Raises ValueError where their number differs from that of the experiments."""
        text = (FOLDER / f"{self.name}.md").read_text(encoding="utf-8")
        parts = tuple(part_of(part) for part in text.split("\n## ")[1:])
        if len(parts) != len(self.experiments):
            raise ValueError(f"lesson {self.name!r}: words for {len(parts)} of {len(self.experiments)} experiments")
        return parts


def part_of(text: str) -> Part:
    """Parse a part: a heading, text, and optionally a quotation with a question and three answers, the right one bold.

    Raises ValueError for another number of answers.
    """
    heading, _, body = text.partition("\n")
    lines = body.strip().splitlines()
    quoted = [index for index, line in enumerate(lines) if line.startswith(">")] or [len(lines)]
    introduction, explanation = lines[: quoted[0]], lines[quoted[-1] + 1 :]
    quotation = [line.removeprefix(">").strip() for line in lines[quoted[0] : quoted[-1] + 1]]
    answers = [line.removeprefix("- ") for line in quotation if line.startswith("- ")]
    if answers and (len(answers) != 3 or sum(answer.startswith("**") for answer in answers) != 1):
        raise ValueError(f"{heading!r}: a question has three answers, one of them right")
    return Part(
        heading.strip(),
        "\n".join(introduction).strip(),
        " ".join(line for line in quotation if line and not line.startswith("- ")),
        tuple((answer.strip("*"), answer.startswith("**")) for answer in answers),
        "\n".join(explanation).strip(),
    )


@dataclass
class SiteSource:
    """The input of a site: Markdown pages and pictures by file name, and the answers to the lessons' tasks."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files, and programs to copy, by name
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # CONTRIBUTING.md, parts of which are quoted; empty outside of a checkout
    api: bool = True  # whether docstrings become a reference, which takes a minute
    lecture: str = ""  # the notebook, as JSON
    troubles: list[str] = field(default_factory=list)  # a sentence for each part that could not be built
