"""The maps of the atlas: scenes with one varied parameter. Texts and ranges are in `subjects.toml`."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer

MIN_STEPS = 10  # number of steps of a run at the largest step


@dataclass(frozen=True)
class StabilityMap:
    """A map of outcomes over step and parameter. `subjects.toml` explains the fields that are missing here. make:
    parameter value -> scene. frequency: scene -> frequency of the fastest motion [rad/s], which predicts the step of
    failure."""

    name: str
    title: str
    parameter: str
    make: Callable[[float], Scene]
    values: tuple[float, float]
    frequency: Callable[[Any], float]
    fastest: str
    whole: bool = False
    doublings: float = 6.6
    page: str = ""
    remark: str = ""

    def at(self, points: int) -> tuple[float, ...]:
        """The parameter values: a geometric sequence, or for integers an arithmetic sequence without repetitions."""
        low, high = self.values
        if self.whole:
            return tuple(map(float, dict.fromkeys(np.linspace(low, high, points).round().tolist())))
        return tuple(float(f"{value:.4g}") for value in np.geomspace(low, high, points))

    def steps(self, points: int) -> tuple[tuple[int, int], ...]:
        """Pairs (samples, steps between samples) of at most `points` runs with decreasing steps [s]. A run has 10 to 20
        samples, so that the reference motion is evaluated at few instants."""
        by_count: dict[int, tuple[int, int]] = {}
        for doubling in np.linspace(0.0, self.doublings, points):
            every = 2 ** int(doubling)
            samples = round(MIN_STEPS * 2 ** (doubling - int(doubling)))
            by_count[samples * every] = (samples, every)
        return tuple(by_count[count] for count in sorted(by_count))


def near_the_largest_offset(gap: float) -> DrivenSliderCrank:
    """A driven slider-crank with the offset (1 - gap) times the largest possible offset."""
    plain = DrivenSliderCrank()
    return replace(plain, offset=(1 - gap) * (plain.rod - plain.crank), angle=math.pi / 2)


def rod_rate(scene: DrivenSliderCrank) -> float:
    """The largest rate of the rod during a turn of the crank [rad/s]. Sampled angles are dense near the upright rod."""
    angles = np.concatenate([np.linspace(0, 2 * math.pi, 721), math.pi / 2 * 3 + np.geomspace(1e-7, 0.1, 200)])
    return float(scene.rate * np.abs(scene.shape.rates(angles)[0]).max())


def short_trailer(length: float) -> CarAndTrailer:
    """A car and a trailer; the trailer has a drawbar of this length [m] and its centre of mass on the axle."""
    plain = CarAndTrailer()
    return replace(plain, length=length, centres=(plain.centres[0], 0.0), duration=2.0, horizon=2.0)


def ellipse(ratio: float) -> RollingEllipse:
    """An ellipse that starts on its flat side and is so slow that it keeps contact."""
    plain = RollingEllipse()
    return replace(plain, along_y=plain.along_x * ratio, start_rate=1.0, duration=1.0)


def rocking(scene: RollingEllipse) -> float:
    """The frequency of small oscillations about the flat side [rad/s]."""
    return scene.motion_law.small_frequency(scene.motion_law.rolling.theta)


def stiffest_hanging(scene: LinkPendulum) -> float:
    """The highest frequency of small oscillations about the hanging equilibrium [rad/s]."""
    return float(scene.chain.modes()[0][-1])


# Map -> (function that makes a scene from a parameter value, function that returns a scene's frequency). Motions of
# chains last 0.5 s, because chaos amplifies errors in longer motions.
SCENES_AND_FREQUENCIES: Mapping[str, tuple[Callable[[float], Scene], Callable[[Any], float]]] = {
    "coupler": (lambda x: FreeFourBar(density=(1.0, x, 1.0)), lambda scene: 1 / scene.mechanism().time_scale),
    "rate": (lambda x: DrivenFourBar(rate=x, revolutions=x * 0.5 / (2 * math.pi)), lambda scene: scene.rate),
    "tip": (lambda x: LinkPendulum(links=3, tip=x, duration=0.5, horizon=0.5), stiffest_hanging),
    "links": (lambda x: LinkPendulum(links=round(x), length=1 / round(x), duration=0.5, horizon=0.5), stiffest_hanging),
    "length": (
        lambda x: PointPendulum(length=x, duration=1.0, horizon=1.0),
        lambda scene: math.sqrt(9.81 / scene.length),
    ),
    "offset": (near_the_largest_offset, rod_rate),
    "sleigh": (lambda x: ChaplyginSleigh(offset=x, duration=1.0, horizon=1.0), lambda scene: abs(scene.turning_rate)),
    "drawbar": (short_trailer, lambda scene: scene.speed / scene.length),
    "ellipse": (ellipse, rocking),
    "loops": (lambda x: NFourBar(loops=round(x), duration=1.2, horizon=1.2), lambda scene: scene.pendulum.frequency),
}


def _read() -> Iterator[StabilityMap]:
    plans = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    for name, plan in plans.items():
        make, frequency = SCENES_AND_FREQUENCIES[name]
        plan |= {"values": tuple(plan["values"]), "remark": " ".join(plan.get("remark", "").split())}
        yield StabilityMap(name, make=make, frequency=frequency, **plan)


MAPS: tuple[StabilityMap, ...] = tuple(_read())
