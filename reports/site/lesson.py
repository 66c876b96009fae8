"""What a lesson is made of, motions that were kept, five steps of words and pictures; and what a site is built from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from engines import Engine
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.tasks import Answer, Motion
from reports.site.live.sliders import Live

Point = tuple[float, float]

FRAMES = 100  # of a moving picture, at most: what an eye can tell in six seconds
FOLDER = Path(__file__).parent / "lessons"
STEPS = 5


@dataclass(frozen=True)
class Take:
    """One motion that a picture shows: the truth of a scene, and methods over it.

    methods: (how it is called in the legend, engine, steps between samples). samples: of the scene unless given. ends:
    points of bodies [m] that are drawn beside their joints. traces: (body, point) whose paths are drawn. centre: the
    body whose instant centre can be shown. curves: closed or open lines in a body's frame, or the ground's (None).
    """

    scene: Scene
    methods: tuple[tuple[str, Engine, int], ...] = ()
    samples: int | None = None
    ends: Mapping[str, tuple[Point, ...]] = field(default_factory=dict)
    traces: tuple[tuple[str, Point], ...] = ()
    centre: str | None = None
    curves: tuple[tuple[str | None, tuple[Point, ...]], ...] = ()
    start: int = 0  # the first sample that is shown
    end: int | None = None  # the sample after the last one

    @property
    def sample_count(self) -> int:
        """Sampling intervals of the motion."""
        return self.scene.samples if self.samples is None else self.samples

    def motions(self) -> dict[str, Motion]:
        """What has to be run for it, by the word of the legend."""
        return {
            word: Motion(Cell(self.scene, engine, every, "failure", self.samples))
            for word, engine, every in self.methods
        }

    @property
    def shown(self) -> slice:
        """The samples that the picture shows: at most about FRAMES."""
        last = self.sample_count + 1 if self.end is None else self.end
        return slice(self.start, last, max(1, -(-(last - self.start) // (FRAMES + 1))))


@dataclass(frozen=True)
class Step:
    """One step of a lesson: which take it shows, and what is switched on: paths, reactions, centre, gaps.

    section: (page, heading) of the Markdown page that says more, quoted below the picture.
    """

    take: str
    switched_on: frozenset[str] = frozenset()
    section: tuple[str, str] | None = None
    broken: tuple[tuple[str, str, str], ...] = ()  # (words of the button, take, what the reference says)


@dataclass(frozen=True)
class Lesson:
    """A mechanism's page: its words stand in lessons/`name`.md, one part a step."""

    name: str
    title: str
    page: str  # the Markdown page of the same mechanism
    takes: Mapping[str, Take]
    steps: tuple[Step, ...]
    live: tuple[Live, ...] = ()  # scenes that the engines can run in the page

    @cached_property
    def words(self) -> list[tuple[str, str]]:
        """(heading, text) of each step. Raises ValueError unless there are as many as steps."""
        text = (FOLDER / f"{self.name}.md").read_text(encoding="utf-8")
        parts = [part.partition("\n") for part in text.split("\n## ")[1:]]
        if len(parts) != len(self.steps) or len(parts) != STEPS:
            raise ValueError(f"lesson {self.name!r}: {len(parts)} parts of words for {len(self.steps)} steps")
        return [(heading.strip(), body.strip()) for heading, _, body in parts]

    def tasks(self) -> tuple[Motion, ...]:
        """All motions that have to be run."""
        own = [motion for take in self.takes.values() for motion in take.motions().values()]
        return (*own, *(motion for live in self.live for motion in live.shipped().values()))


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
    api: bool = True  # whether pdoc makes the reference, which takes some ten seconds
    troubles: list[str] = field(default_factory=list)  # what could not be built, and why, a sentence each
