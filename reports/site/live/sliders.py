"""The controls of a page: parameters of the mechanism, the step, joint constructions and settings of the engines."""

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
MOST = 125  # limit of the number of slider positions of a scene, since the page loads data for each position
SHIPPED, DOCUMENTED = "as shipped", "documented settings"
# Settings of the engines as pairs (value, label). The value None stands for that of the chosen method.
OWN = (None, "the method's value")
INTEGRATORS = (OWN, (0, "Euler"), (3, "implicitfast"), (1, "RK4"))
TIME_CONSTANTS = (OWN, *((value, f"{1000 * value:g} ms") for value in (0.002, 0.005, 0.01, 0.02, 0.05)))
IMPEDANCES = (OWN, *((value, str(value)) for value in (0.9, 0.99, 0.999, 0.9999)))
SOLVER_ITERATIONS = (OWN, *((value, str(value)) for value in (1, 2, 5, 20, 100)))
TOLERANCES = (OWN, *((value, f"{value:g}") for value in (1e-8, 1e-11, 1e-15)))
SWEEPS = (OWN, *((value, str(value)) for value in (1, 2, 5, 10, 20, 50, 100)))
BIASES = (OWN, (0.5, "0.5"), (float(pymunk.SHIPPED_ERROR_BIAS), "0.0018"), (1e-6, "1e-6"), (0.0, "0"))
ENGINES: dict[Name, dict[str, tuple[str, tuple[tuple[Any, str], ...]]]] = {
    "munk": {
        "iterations": ("iterations: number in each step", SWEEPS),
        "bias": ("error_bias: residual gap after a second", BIASES),
    },
    "mujoco": {
        "integrator": ("integrator: method of a step", INTEGRATORS),
        "timeConstant": ("solref: time constant", TIME_CONSTANTS),
        "impedance": ("solimp: impedance", IMPEDANCES),
        "solverIterations": ("iterations of the solver", SOLVER_ITERATIONS),
        "tolerance": ("tolerance of the solver", TOLERANCES),
    },
}


@dataclass(frozen=True)
class Control:
    """The values of a slider, their labels, and the index of the start value."""

    values: tuple[Any, ...]
    texts: tuple[str, ...]
    start: int = 0


CONTROLS = {
    name: Control(tuple(value for value, _ in pairs), tuple(label for _, label in pairs))
    for settings in ENGINES.values()
    for name, (_, pairs) in settings.items()
}


@dataclass(frozen=True)
class Slider:
    """A slider that sets a field of the scene. `texts`: labels of the values; without labels, the values are shown."""

    field: str
    label: str
    values: tuple[Any, ...]
    texts: tuple[str, ...] = ()

    def control(self, scene: Scene) -> Control:
        """Return the control with the scene's value as start value. Raises ValueError if the slider lacks this
        value."""
        texts = self.texts or tuple(f"{value:.3g}" for value in self.values)
        return Control(self.values, texts, self.values.index(getattr(scene, self.field)))


@dataclass(frozen=True, kw_only=True)
class Look:
    """Additional elements of the drawing of a mechanism.

    ends: points of bodies [m]. curves: pairs of a body's name, or None for the ground, and points of a line [m] in this
    frame.
    axle: half the length [m] of an axle with two wheels, which is drawn for a skate. An axle of length 0 is drawn as a
    blade.
    """

    ends: Mapping[str, tuple[Point, ...]] = field(default_factory=dict)
    curves: tuple[tuple[str | None, tuple[Point, ...]], ...] = ()
    axle: float = 0.0


@dataclass(frozen=True)
class Live(Look):
    """A scene that engines run in the page.

    frames: number of sampling intervals. steps: choices for the number of steps of the whole motion, each a multiple or
    a divisor of `frames`. start: index of the initial choice. munk, mujoco: methods with labels. The first two methods
    have the default and the documented settings. A string instead of an engine is the reason why the method is
    missing. window: first and last frame that are played, or None for all frames. traces: pairs (body, point) of points
    with a drawn path. centre: the body whose instant centre can be shown.
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
            raise ValueError(f"live {self.word!r}: more than {MOST} positions of its sliders")

    @property
    def key(self) -> str:
        return f"{self.scene.name}-{self.word}".replace(" ", "-")

    def places(self) -> Iterator[Scene]:
        """Yield the scene at every position of its sliders. The last slider changes first."""
        fields = [slider.field for slider in self.sliders]
        for values in itertools.product(*(slider.values for slider in self.sliders)):
            changed: Any = dict(zip(fields, values, strict=True))
            yield replace(self.scene, **changed)  # type: ignore[type-var]

    def samples(self, steps: int) -> int:
        return min(self.frames, steps)

    def methods(self, name: Name) -> Sequence[tuple[str, Engine | str]]:
        return self.munk if name == "munk" else self.mujoco

    def controls(self) -> dict[str, Control]:
        steps = tuple(f"{1000 * self.scene.duration / count:.3g} ms" for count in self.steps)
        methods = {name: tuple(label for label, _ in self.methods(name)) for name in ENGINES}
        return {
            "steps": Control(self.steps, steps, self.start),
            **{slider.field: slider.control(self.scene) for slider in self.sliders},
            **{name: Control(labels, labels) for name, labels in methods.items()},
            **CONTROLS,
        }

    def words(self) -> dict[str, str]:
        """Return the name of each control for the reader."""
        engines = {f"{name}": f"joints in {word}" for name, word in NAMES.items()}
        own = {key: words for name in ENGINES for key, (words, _) in ENGINES[name].items()}
        return {"steps": "step", **engines, **own, **{slider.field: slider.label for slider in self.sliders}}

    def located(self, given: Mapping[str, Any]) -> dict[str, int]:
        """Return the index of each control's value. Raises ValueError for an unknown control or value."""
        controls = self.controls()
        for name, value in given.items():
            if name not in controls:
                raise ValueError(f"no control is named {name!r}; there are {', '.join(controls)}")
            if value not in (values := controls[name].values):
                raise ValueError(f"{name} has no value {value!r}; there are {', '.join(map(str, values))}")
        return {name: controls[name].values.index(value) for name, value in given.items()}

    def stored(self) -> dict[tuple[Name, int], Motion]:
        """Return the motions of Python's engines, by engine and index of the method.

        The page plays a stored motion if it cannot run the method. Otherwise it shows the difference from the stored
        motion.
        """
        steps = self.steps[self.start]
        samples = self.samples(steps)
        return {
            (name, index): Motion(Cell(self.scene, engine, steps // samples, "failure", samples))
            for name in ENGINES
            for index, (_, engine) in enumerate(self.methods(name))
            if not isinstance(engine, str)
        }
