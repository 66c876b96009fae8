"""What a lesson is made of: scenes, experiments on them and their words; and what a site is built from."""

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
    """What a change of settings does to an engine's error: it becomes `least` to `most` times as large."""

    engine: Name
    least: float = 0.0
    most: float = math.inf


@dataclass(frozen=True)
class Experiment:
    """A setting to start from, and what is changed after the reader has guessed what will happen.

    `before`, `after`: values of the controls of the scene called `scene`, the others as they come; `after` is a change
    of `before`. claims: of the errors after, in those before. causes: further changes with what they do to the error
    after, so that a sentence that names a cause can be checked by switching it off. shown: overlays beside the paths.
    """

    scene: str
    before: Mapping[str, Any] = field(default_factory=dict)
    after: Mapping[str, Any] = field(default_factory=dict)
    claims: tuple[Claim, ...] = ()
    causes: tuple[tuple[Mapping[str, Any], Claim], ...] = ()
    shown: tuple[str, ...] = ()
    section: str = ""  # the heading of what the Markdown page of the same mechanism says of it


@dataclass(frozen=True)
class Part:
    """The words of an experiment: a heading, what to see, a question with answers of which one is right, and why."""

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
        """The scene of this name. Raises StopIteration if there is none."""
        return next(live for live in self.scenes if live.word == word)

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The words of each experiment. Raises ValueError unless there are as many as experiments."""
        text = (FOLDER / f"{self.name}.md").read_text(encoding="utf-8")
        parts = tuple(part_of(part) for part in text.split("\n## ")[1:])
        if len(parts) != len(self.experiments):
            raise ValueError(f"lesson {self.name!r}: words for {len(parts)} of {len(self.experiments)} experiments")
        return parts


def part_of(text: str) -> Part:
    """Read one: a heading, words, and perhaps a quotation: a question, a list of answers, the right one in bold."""
    heading, _, body = text.partition("\n")
    lines = body.strip().splitlines()
    quoted = [index for index, line in enumerate(lines) if line.startswith(">")] or [len(lines)]
    before, after = lines[: quoted[0]], lines[quoted[-1] + 1 :]
    told = [line.removeprefix(">").strip() for line in lines[quoted[0] : quoted[-1] + 1]]
    answers = [line.removeprefix("- ") for line in told if line.startswith("- ")]
    if answers and (len(answers) != 3 or sum(answer.startswith("**") for answer in answers) != 1):
        raise ValueError(f"{heading!r}: a question has three answers, one of them right")
    return Part(
        heading.strip(),
        "\n".join(before).strip(),
        " ".join(line for line in told if line and not line.startswith("- ")),
        tuple((answer.strip("*"), answer.startswith("**")) for answer in answers),
        "\n".join(after).strip(),
    )


@dataclass
class Source:
    """What a site is built from: Markdown pages and pictures by file name, and the answers to the lessons' tasks."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files, and programs to copy, by name
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # CONTRIBUTING.md, of which how-to pages quote parts; empty outside of a checkout
    api: bool = True  # whether docstrings become a reference, which takes a minute
    lecture: str = ""  # the notebook, as JSON
    troubles: list[str] = field(default_factory=list)  # what could not be built, and why, a sentence each
