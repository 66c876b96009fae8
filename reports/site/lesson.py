"""Lessons. A lesson is a Markdown file with its texts, its exercises, and the settings of each experiment in TOML.

The file begins with the title and a TOML block with `page`, the Markdown page of the same mechanism, and `scenes`, the
keys of scenes in reports/site/live/scenes.py. Each heading `##` begins an experiment: a TOML block with the fields of
`Experiment`, an introduction, a quotation with a question and three answers, of which the right one is bold, and an
explanation. The heading `## Exercises` is last.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from reports.site.live.sliders import OWN, Live

ASSETS = Path(__file__).parent / "assets"
TEXTS = ("heading", "text", "question", "answers", "after_words")  # fields of an experiment outside of its TOML block
Kind = Literal["gap", "rates", "bend", "centre", "contact", "energy", "friction"]
Subject = Literal["munk", "mujoco", "exact"]
Settings = Mapping[str, Any]  # Control -> value.


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

    engine: Subject
    least: float = 0.0
    most: float = math.inf
    of: Kind | None = None
    is_value: bool = False


@dataclass(frozen=True)
class Cause(Claim):
    """A further change of settings, and a claim relative to the number after the change of the experiment."""

    change: Settings = field(default_factory=dict)


@dataclass(frozen=True)
class Guess:
    """The meaning of an answer: settings that it proposes, or the error that it predicts.

    change: the settings that are run for this answer; None for an answer about the change of the experiment. times: the
    predicted factor of each engine's error, or of the quantity `of`. claims: claims on the run of `change`.
    """

    change: Settings | None = None
    times: Mapping[Subject, float] = field(default_factory=dict)
    of: Kind | None = None
    claims: tuple[Claim, ...] = ()


@dataclass(frozen=True)
class Experiment:
    """Settings of a scene before a question, the change of settings that answers it, and their texts.

    before: values of controls; the other controls have their start values. after: the values that change. claims:
    claims on this change. causes: tests of the cause that the text gives. overlays: names of overlays in addition to
    the paths. section: heading of the quoted section of the Markdown page. widget: name of a script in assets that
    draws below the text. guesses: the meanings of the answers in their order. quantities: numbers that are shown beside
    the errors. answers: pairs (text, whether it is right). after_words: the explanation.
    """

    scene: str
    before: Settings = field(default_factory=dict)
    after: Settings = field(default_factory=dict)
    claims: tuple[Claim, ...] = ()
    causes: tuple[Cause, ...] = ()
    overlays: tuple[Literal["reactions", "centre", "friction"], ...] = ()
    section: str = ""
    widget: str = ""
    guesses: tuple[Guess, ...] = ()
    quantities: tuple[LessonQuantity, ...] = ()
    heading: str = ""
    text: str = ""
    question: str = ""
    answers: tuple[tuple[str, bool], ...] = ()
    after_words: str = ""


@dataclass(frozen=True)
class Exercise:
    """An exercise; `answer` names the function of assets/exercises.js that computes the answer in `unit`."""

    heading: str
    answer: str
    unit: str
    text: str
    solution: str


@dataclass(frozen=True)
class Lesson:
    """A page on a mechanism with live scenes, experiments and exercises."""

    name: str
    title: str
    page: str  # the Markdown page of the same mechanism
    scenes: tuple[Live, ...]
    experiments: tuple[Experiment, ...]
    exercises: tuple[Exercise, ...]

    def scene(self, word: str) -> Live:
        """Return the scene of this name. Raises ValueError without such a scene."""
        words = [live.word for live in self.scenes]
        if word not in words:
            raise ValueError(f"the lesson has no scene {word!r}; its scenes are {', '.join(map(repr, words))}")
        return self.scenes[words.index(word)]


def read_lesson(path: Path, scenes: Mapping[str, Live]) -> Lesson:
    """Read a lesson from a Markdown file; `scenes` has all scenes by key.

    Raises ValueError with the file, the heading and the reason if the file has another form, or an unknown name.
    """
    text, _, exercises = path.read_text(encoding="utf-8").partition("\n## Exercises\n")
    heading, *parts = re.split("^#{1,2} ", text, flags=re.MULTILINE)[1:] or [""]
    place = "the title"
    try:
        title, head, lines = split_part(heading)
        if set(head) != {"page", "scenes"}:
            raise ValueError(f"the first TOML block has {', '.join(head) or 'nothing'} instead of page and scenes")
        page, keys = _value(str, head["page"], "page"), _value(tuple[str, ...], head["scenes"], "scenes")
        if unknown := [key for key in keys if key not in scenes]:
            raise ValueError(f"no scene has the key {unknown[0]!r}")
        if lines:
            raise ValueError("text stands before the heading of the first experiment")
        lesson = Lesson(path.stem, title, page, tuple(scenes[key] for key in keys), (), ())
        experiments, solved = [], []
        for part in parts:
            place = part.partition("\n")[0]
            experiments.append(experiment_of(part, lesson))
        place = "Exercises"
        before, *others = exercises.split("\n### ")
        if before.strip():
            raise ValueError("text stands before the heading of the first exercise")
        for part in others:
            place = part.partition("\n")[0]
            solved.append(exercise_of(part))
    except ValueError as reason:
        raise ValueError(f"{path.name}, {place!r}: {reason}") from None
    return replace(lesson, experiments=tuple(experiments), exercises=tuple(solved))


def split_part(part: str) -> tuple[str, dict[str, Any], list[str]]:
    """Return the heading, the TOML block and the other lines of a part. Raises ValueError for wrong TOML."""
    match = re.fullmatch(r"(.+)\n\n```toml\n(.*?)^```\n(.*)", part, re.DOTALL | re.MULTILINE)
    if match is None:
        raise ValueError("a block ```toml must follow the heading")
    return match[1].strip(), tomllib.loads(match[2]), match[3].strip().splitlines()


def experiment_of(part: str, lesson: Lesson) -> Experiment:
    """Parse the settings and the texts of an experiment. Raises ValueError for wrong or unknown settings, and if there
    are not three answers with one right answer.
    """
    heading, settings, lines = split_part(part)
    quoted = [index for index, line in enumerate(lines) if line.startswith(">")] or [len(lines)]
    quotation = [line.removeprefix(">").strip() for line in lines[quoted[0] : quoted[-1] + 1]]
    if len(quotation) > len(quoted):
        raise ValueError("a part has one quotation, with a question and its answers")
    answers = [line.removeprefix("- ") for line in quotation if line.startswith("- ")]
    if answers and (len(answers) != 3 or sum(answer.startswith("**") for answer in answers) != 1):
        raise ValueError("a question has three answers, one of them right")
    texts = {
        "heading": heading,
        "text": "\n".join(lines[: quoted[0]]).strip(),
        "question": " ".join(line for line in quotation if line and not line.startswith("- ")),
        "answers": [[answer.strip("*"), answer.startswith("**")] for answer in answers],
        "after_words": "\n".join(lines[quoted[-1] + 1 :]).strip(),
    }
    if given := set(settings) & set(TEXTS):
        raise ValueError(f"{min(given)} stands below the TOML block")
    experiment: Experiment = _value(Experiment, settings | texts, "the experiment")
    live = lesson.scene(experiment.scene)
    changes = [each.change for each in (*experiment.causes, *experiment.guesses) if each.change is not None]
    for change in (experiment.before, experiment.after, *changes):
        live.located(change)
    if experiment.widget and not (ASSETS / f"{experiment.widget}.js").is_file():
        raise ValueError(f"the widget {experiment.widget!r} has no script in assets")
    if experiment.guesses and len(experiment.guesses) != len(answers):
        raise ValueError(f"{len(experiment.guesses)} guesses for {len(answers)} answers")
    return experiment


def _value(kind: Any, value: Any, place: str) -> Any:
    """Return a value of TOML as the type `kind` of the field `place`.

    A list becomes a tuple, a table becomes a dataclass, and in settings the label of OWN becomes None. Raises
    ValueError for another type, and for an unknown or missing field.
    """
    origin, args = get_origin(kind), get_args(kind)
    if kind is Any:
        return tuple(value) if isinstance(value, list) else None if value == OWN[1] else value
    if NoneType in args:
        return _value(args[0], value, place)
    if origin is Literal:
        if value not in args:
            raise ValueError(f"{place} is {value!r}; there are {', '.join(args)}")
        return value
    if is_dataclass(kind) and isinstance(value, dict):
        hints = get_type_hints(kind)
        if wrong := set(value) - set(hints) or {each.name for each in fields(kind) if _is_missing(each, value)}:
            raise ValueError(f"{place} has an unknown field, or lacks a field: {min(wrong)}")
        return kind(**{name: _value(hints[name], each, name) for name, each in value.items()})  # type: ignore[operator]
    if origin is tuple and isinstance(value, list):
        kinds = args[:1] * len(value) if args[-1] is Ellipsis else args
        return tuple(_value(each, part, place) for each, part in zip(kinds, value, strict=True))
    if origin is Mapping and isinstance(value, dict):
        return {_value(args[0], name, place): _value(args[1], each, place) for name, each in value.items()}
    if kind is float and type(value) in (int, float):
        return float(value)
    if kind in (str, bool) and type(value) is kind:
        return value
    raise ValueError(f"{place} is {value!r}, which has a wrong type")


def _is_missing(each: Field, value: Mapping[str, Any]) -> bool:
    return each.name not in value and each.default is MISSING and each.default_factory is MISSING


def exercise_of(text: str) -> Exercise:
    """Parse the heading, the answer's name and unit, the text and the quoted solution of an exercise.

    Raises ValueError for other texts.
    """
    match = re.fullmatch(r"(.+): `(\w+)` \[(.+)\]\n\n(.+?)\n\n((?:>.*\n?)+)", text.strip(), re.DOTALL)
    if match is None:
        raise ValueError("an exercise has a heading, an answer, a unit and a solution")
    heading, answer, unit, question, solution = match.groups()
    return Exercise(heading, answer, unit, question, re.sub("^> ?", "", solution, flags=re.MULTILINE))
