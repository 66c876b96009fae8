"""Lessons with scenes, experiments and texts, and the input of a site."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from reports.model.tasks import Answer, Motion
from reports.site.live.sliders import DOCUMENTED, ENGINES, Live, Name

FOLDER = Path(__file__).parent / "lessons"
BOTH: dict[str, Any] = dict.fromkeys(ENGINES, DOCUMENTED)
FORCES, CENTRE = ("reactions",), ("centre",)  # overlays


Kind = Literal["gap", "rates", "bend", "centre", "contact", "energy", "friction"]


@dataclass(frozen=True)
class LessonQuantity:
    """A number of a motion that is shown beside the errors; assets/quantities.js computes it.

    gap: the largest gap of a pin or slot [m]. rates: the least and the largest turning rate of a body [rad/s]. bend:
    the first time [s] at which the angle between two bodies is 1 rad. centre: the median distance of an engine's
    instant centre from the exact one [m]. contact: the largest change of the sum of the distances from the contact to
    the two pins of a pair of gears [m]. energy: the energy at the end minus that at the start [J]. friction: the
    largest friction coefficient that the exact motion requires [1].
    """

    kind: Kind
    words: str
    bodies: tuple[str, ...] = ()


@dataclass(frozen=True)
class Claim:
    """A claim: a change of settings multiplies an engine's error by `least` to `most`.

    of: a quantity of the experiment instead of the error; then `engine` may be "exact". is_value: the limits are those
    of the number after the change, and not of its ratio to the number before.
    """

    engine: Name | Literal["exact"]
    least: float = 0.0
    most: float = math.inf
    of: Kind | None = None
    is_value: bool = False


@dataclass(frozen=True)
class Guess:
    """The meaning of an answer: settings that it proposes, or the error that it predicts.

    change: the settings that are run for this answer; None for an answer about the change of the experiment. times: the
    predicted factor of each engine's error, or of the quantity `of`. claims: claims on the run of `change`.
    """

    change: Mapping[str, Any] | None = None
    times: Mapping[Name | Literal["exact"], float] = field(default_factory=dict)
    of: Kind | None = None
    claims: tuple[Claim, ...] = ()


@dataclass(frozen=True)
class Experiment:
    """Settings of a scene before a question, and the change of settings that answers it.

    before: values of controls; the other controls have their start values. after: the values that change. claims:
    claims on this change. causes: further changes, each with a claim relative to the errors after the first change;
    they test the cause that the text gives. overlays: names of overlays in addition to the paths. section: heading of
    the quoted section of the Markdown page. widget: name of a script in assets that draws below the text. guesses: the
    meanings of the answers in their order. quantities: numbers that are shown beside the errors.
    """

    scene: str
    before: Mapping[str, Any] = field(default_factory=dict)
    after: Mapping[str, Any] = field(default_factory=dict)
    claims: tuple[Claim, ...] = ()
    causes: tuple[tuple[Mapping[str, Any], Claim], ...] = ()
    overlays: tuple[str, ...] = ()
    section: str = ""
    widget: str = ""
    guesses: tuple[Guess, ...] = ()
    quantities: tuple[LessonQuantity, ...] = ()


@dataclass(frozen=True)
class Exercise:
    """An exercise; `answer` names the function of assets/exercises.js that computes the answer in `unit`."""

    heading: str
    answer: str
    unit: str
    text: str
    solution: str


@dataclass(frozen=True)
class Part:
    """The texts of an experiment. `after` is the explanation."""

    heading: str
    text: str
    question: str
    answers: tuple[tuple[str, bool], ...]  # pairs (text of an answer, whether it is right)
    after: str


@dataclass(frozen=True)
class Lesson:
    """A page on a mechanism with live scenes and experiments. The file lessons/`name`.md contains the texts."""

    name: str
    title: str
    page: str  # the Markdown page of the same mechanism
    scenes: tuple[Live, ...]
    experiments: tuple[Experiment, ...]

    def scene(self, word: str) -> Live:
        """Return the scene of this name. Raises StopIteration without such a scene."""
        return next(live for live in self.scenes if live.word == word)

    @cached_property
    def _texts(self) -> tuple[str, str]:
        """The text of the parts and the text of the exercises."""
        text, _, exercises = (FOLDER / f"{self.name}.md").read_text(encoding="utf-8").partition("\n## Exercises\n")
        return text, exercises

    @property
    def exercises(self) -> tuple[Exercise, ...]:
        """The exercises at the end of the lesson. Raises ValueError if their text has another form."""
        return tuple(exercise_of(text) for text in self._texts[1].split("\n### ")[1:])

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The texts of each experiment. Raises ValueError if the number of texts is wrong."""
        parts = tuple(part_of(part) for part in self._texts[0].split("\n## ")[1:])
        if len(parts) != len(self.experiments):
            raise ValueError(f"lesson {self.name!r}: words for {len(parts)} of {len(self.experiments)} experiments")
        return parts


def part_of(text: str) -> Part:
    """Parse the texts of an experiment: a heading, an introduction, and optionally a quotation and an explanation.

    The quotation contains a question and three answers; the right answer is bold. Raises ValueError if there are not
    three answers with one right answer.
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


def exercise_of(text: str) -> Exercise:
    """Parse the heading, the answer's name and unit, the text and the quoted solution of an exercise.

    Raises ValueError for other texts.
    """
    match = re.fullmatch(r"(.+): `(\w+)` \[(.+)\]\n\n(.+?)\n\n((?:>.*\n?)+)", text.strip(), re.DOTALL)
    if match is None:
        raise ValueError(f"{text.partition(chr(10))[0]!r}: an exercise has a heading, an answer, a unit and a solution")
    heading, answer, unit, question, solution = match.groups()
    return Exercise(heading, answer, unit, question, re.sub("^> ?", "", solution, flags=re.MULTILINE))


@dataclass
class SiteSource:
    """The input of a site. Files are given as name -> text."""

    pages: Mapping[str, str]
    pictures: Mapping[str, str]
    tables: Mapping[str, str]  # CSV files and programs
    answers: Mapping[Motion, Answer]
    cache: Path
    foot: str
    contributing: str = ""  # Text of CONTRIBUTING.md, from which pages quote; empty outside of a checkout.
    api: bool = True  # Whether the site has a reference from docstrings, which takes a minute to build.
    lecture: str = ""  # The notebook as JSON.
    troubles: list[str] = field(default_factory=list)  # A message for each missing file.
