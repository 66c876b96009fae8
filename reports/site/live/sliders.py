"""What a reader can change in a live part of a lesson: a mechanism's numbers, the step, how engines hold joints."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from engines import Engine, mujoco, pymunk
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.tasks import Motion

MOST = 125  # places of a scene's sliders: each has a model of each engine and a drawing in the page
# Settings of the engines that every live part has: values in the page, and what is written beside them. None stands
# for what the model has as shipped.
INTEGRATORS = ((0, "Euler, as shipped"), (3, "implicitfast"), (1, "RK4"))
TIME_CONSTANTS = ((0.002, "2 ms"), (0.005, "5 ms"), (0.01, "10 ms"), (None, "20 ms, as shipped"), (0.05, "50 ms"))
IMPEDANCES = ((None, "0.9 to 0.95, as shipped"), (0.9, "0.9"), (0.99, "0.99"), (0.999, "0.999"), (0.9999, "0.9999"))
SOLVER_ITERATIONS = ((1, "1"), (2, "2"), (5, "5"), (20, "20"), (100, "100, as shipped"))
TOLERANCES = ((1e-8, "1e-8, as shipped"), (1e-11, "1e-11"), (1e-15, "1e-15"))
SWEEPS = ((1, "1"), (2, "2"), (5, "5"), (10, "10, as shipped"), (20, "20"), (50, "50"), (100, "100"))
BIASES = ((0.5, "0.5"), (float(pymunk.SHIPPED_ERROR_BIAS), "0.0018, as shipped"), (1e-6, "1e-6"), (0.0, "0"))
TEMPOS = (0.25, 0.5, 1.0, 2.0, 4.0)
TEMPO_WORDS = ("a quarter", "half", "as in the scene", "twice", "four times")


@dataclass(frozen=True)
class Slider:
    """A field of the scene and the values that it takes; `texts` are written beside them, the values unless given."""

    field: str
    words: str
    values: tuple[Any, ...]
    texts: tuple[str, ...] = ()

    def start(self, scene: Scene) -> int:
        """The place at which the scene itself stands. Raises ValueError if no value is the scene's."""
        return self.values.index(getattr(scene, self.field))

    def told(self) -> tuple[str, ...]:
        """What is written beside each place."""
        return self.texts or tuple(f"{value:.3g}" for value in self.values)


@dataclass(frozen=True)
class Trap:
    """A button that moves sliders, by their places from 0, and what should then happen."""

    words: str
    places: Mapping[str, int]
    told: str


@dataclass(frozen=True)
class Live:
    """A scene that engines run in the page.

    frames: sampling intervals that are shown; steps: of the whole motion, each a multiple or a divisor of `frames`, the
    one at place `start` first. tempo: the whole motion can be had faster or slower, since nothing but speed sets its
    time. munk, mujoco: ways to hold the joints, each with its words.
    """

    word: str
    scene: Scene
    steps: tuple[int, ...]
    frames: int
    start: int
    sliders: tuple[Slider, ...] = ()
    tempo: bool = False
    munk: tuple[tuple[str, pymunk.Pymunk], ...] = (("as shipped", pymunk.DEFAULT),)
    mujoco: tuple[tuple[str, mujoco.MuJoCo], ...] = (("as shipped", mujoco.DEFAULT),)
    traps: tuple[Trap, ...] = ()
    ends: Mapping[str, tuple[tuple[float, float], ...]] = field(default_factory=dict)
    traces: tuple[tuple[str, tuple[float, float]], ...] = ()

    def __post_init__(self) -> None:
        for steps in self.steps:
            if steps % self.frames and self.frames % steps:
                raise ValueError(f"live {self.word!r}: {steps} steps don't fit {self.frames} frames")
        if len(list(self.places())) > MOST:
            raise ValueError(f"live {self.word!r}: more than {MOST} places of its sliders")

    @property
    def key(self) -> str:
        """The name of its file of data."""
        return f"{self.scene.name}-{self.word}".replace(" ", "-")

    def places(self) -> Iterator[Scene]:
        """The scene at every place of its sliders; the last slider changes first."""
        fields = [slider.field for slider in self.sliders]
        for values in itertools.product(*(slider.values for slider in self.sliders)):
            changed: Any = dict(zip(fields, values, strict=True))
            yield replace(self.scene, **changed)  # type: ignore[type-var]

    def samples(self, steps: int) -> int:
        """Sampling intervals of a motion of so many steps."""
        return min(self.frames, steps)

    def munk_words(self) -> list[tuple[int, str]]:
        """The ways of pymunk by their place."""
        return list(enumerate(words for words, _ in self.munk))

    def mujoco_words(self) -> list[tuple[int, str]]:
        """The ways of MuJoCo by their place."""
        return list(enumerate(words for words, _ in self.mujoco))

    def shipped(self) -> dict[str, Motion]:
        """The motions that Python's engines make of the scene itself, as the page first shows it."""
        steps = self.steps[self.start]
        samples = self.samples(steps)
        ways: Sequence[tuple[str, Engine]] = (("munk", self.munk[0][1]), ("mujoco", self.mujoco[0][1]))
        return {name: Motion(Cell(self.scene, engine, steps // samples, "failure", samples)) for name, engine in ways}


COARSE = Trap(
    "Break it: a step too large",
    {"steps": 0},
    "Much of a turn passes in a step. No method is accurate here, and no engine says so.",
)
ONE_SWEEP = Trap(
    "Break it: one sweep",
    {"iterations": 0, "bias": 3, "steps": 6},
    "All of the gap is closed in each step, by a single sweep. What it leaves grows as the step shrinks, so a smaller "
    "step is worse.",
)
