"""What a reader can change: a mechanism's numbers, the step, how engines hold joints, the engines' own settings."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from engines import Engine, mujoco, pymunk
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.tasks import Motion

Name = Literal["munk", "mujoco"]
Point = tuple[float, float]
NAMES: dict[Name, str] = {"munk": "pymunk", "mujoco": "MuJoCo"}
MOST = 125  # places of a scene's sliders: each has a model of each engine and a drawing in the page
SHIPPED, DOCUMENTED = "as shipped", "documented settings"
# Settings of the engines: values in the page, and what is written beside them. None: as the method has it.
OWN = (None, "as the method has it")
INTEGRATORS = (OWN, (0, "Euler"), (3, "implicitfast"), (1, "RK4"))
TIME_CONSTANTS = (OWN, *((value, f"{1000 * value:g} ms") for value in (0.002, 0.005, 0.01, 0.02, 0.05)))
IMPEDANCES = (OWN, *((value, str(value)) for value in (0.9, 0.99, 0.999, 0.9999)))
SOLVER_ITERATIONS = (OWN, *((value, str(value)) for value in (1, 2, 5, 20, 100)))
TOLERANCES = (OWN, *((value, f"{value:g}") for value in (1e-8, 1e-11, 1e-15)))
SWEEPS = (OWN, *((value, str(value)) for value in (1, 2, 5, 10, 20, 50, 100)))
BIASES = (OWN, (0.5, "0.5"), (float(pymunk.SHIPPED_ERROR_BIAS), "0.0018"), (1e-6, "1e-6"), (0.0, "0"))
ENGINES: dict[Name, dict[str, tuple[str, tuple[tuple[Any, str], ...]]]] = {
    "munk": {
        "iterations": ("iterations: sweeps over the joints", SWEEPS),
        "bias": ("error_bias: left of a gap after a second", BIASES),
    },
    "mujoco": {
        "integrator": ("integrator", INTEGRATORS),
        "timeConstant": ("solref: time constant", TIME_CONSTANTS),
        "impedance": ("solimp: impedance", IMPEDANCES),
        "solverIterations": ("iterations of the solver", SOLVER_ITERATIONS),
        "tolerance": ("tolerance of the solver", TOLERANCES),
    },
}


@dataclass(frozen=True)
class Control:
    """The values of a slider, what is written beside each, and the place at which it stands at first."""

    values: tuple[Any, ...]
    texts: tuple[str, ...]
    start: int = 0


CONTROLS = {
    name: Control(tuple(value for value, _ in pairs), tuple(words for _, words in pairs))
    for each in ENGINES.values()
    for name, (_, pairs) in each.items()
}


@dataclass(frozen=True)
class Slider:
    """A field of the scene and the values that it takes; `texts` are written beside them, the values unless given."""

    field: str
    words: str
    values: tuple[Any, ...]
    texts: tuple[str, ...] = ()

    def control(self, scene: Scene) -> Control:
        """At first the scene's own value. Raises ValueError if it is none of the slider's."""
        texts = self.texts or tuple(f"{value:.3g}" for value in self.values)
        return Control(self.values, texts, self.values.index(getattr(scene, self.field)))


@dataclass(frozen=True, kw_only=True)
class Look:
    """What is drawn of a mechanism beside its joints.

    ends: points of bodies [m]. curves: closed or open lines in a body's frame, or the ground's (None) [m]. axle: half
    of it [m], where a skate is drawn as an axle with two wheels.
    """

    ends: Mapping[str, tuple[Point, ...]] = field(default_factory=dict)
    curves: tuple[tuple[str | None, tuple[Point, ...]], ...] = ()
    axle: float = 0.0


@dataclass(frozen=True)
class Live(Look):
    """A scene that engines run in the page.

    frames: sampling intervals that are shown; steps: of the whole motion, each a multiple or a divisor of `frames`, the
    one at place `start` first. munk, mujoco: ways to hold the joints, each with its words, those as shipped and with
    documented settings first; a sentence instead of an engine says why there is none. window: the frames that are
    played, all unless given. traces: (body, point) whose paths are drawn. centre: the body whose instant centre can be
    shown.
    """

    word: str
    scene: Scene
    steps: tuple[int, ...]
    frames: int
    start: int
    sliders: tuple[Slider, ...] = ()
    munk: tuple[tuple[str, pymunk.Pymunk | str], ...] = ((SHIPPED, pymunk.DEFAULT), (DOCUMENTED, pymunk.TUNED))
    mujoco: tuple[tuple[str, mujoco.MuJoCo | str], ...] = ((SHIPPED, mujoco.DEFAULT), (DOCUMENTED, mujoco.TUNED))
    traces: tuple[tuple[str, Point], ...] = ()
    centre: str | None = None
    window: tuple[int, int] | None = None

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

    def ways(self, name: Name) -> Sequence[tuple[str, Engine | str]]:
        """The ways of an engine."""
        return self.munk if name == "munk" else self.mujoco

    def controls(self) -> dict[str, Control]:
        """Every control, by its name."""
        steps = tuple(f"{1000 * self.scene.duration / each:.3g} ms" for each in self.steps)
        ways = {name: tuple(words for words, _ in self.ways(name)) for name in ENGINES}
        return {
            "steps": Control(self.steps, steps, self.start),
            **{slider.field: slider.control(self.scene) for slider in self.sliders},
            **{name: Control(words, words) for name, words in ways.items()},
            **CONTROLS,
        }

    def located(self, given: Mapping[str, Any]) -> dict[str, int]:
        """Places of controls from their values; raises ValueError for a value, KeyError for a control it has not."""
        known = self.controls()
        return {name: known[name].values.index(value) for name, value in given.items()}

    def stored(self) -> dict[tuple[Name, int], Motion]:
        """The motions that Python's engines make of the scene itself, by engine and way: page and Python are compared,
        and where the page has no engine for a way, its motion is shown.
        """
        steps = self.steps[self.start]
        samples = self.samples(steps)
        return {
            (name, index): Motion(Cell(self.scene, engine, steps // samples, "failure", samples))
            for name in ENGINES
            for index, (_, engine) in enumerate(self.ways(name))
            if not isinstance(engine, str)
        }
