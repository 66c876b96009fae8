"""The maps of the atlas: scenes with one varied parameter. Texts and ranges are in `subjects.toml`."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer

MIN_STEPS = 10  # steps of a run at the largest step


@dataclass(frozen=True)
class StabilityMap:
    """A map of outcomes over step and parameter. `subjects.toml` explains the fields that are not explained here.

    make: parameter value -> scene
    frequency: parameter value -> frequency of the fastest motion [rad/s], which predicts the step of failure
    """

    name: str
    title: str
    parameter: str
    make: Callable[[float], Scene]
    values: tuple[float, float]
    frequency: Callable[[float], float]
    fastest: str
    whole: bool = False
    doublings: float = 6.6
    page: str = ""
    remark: str = ""

    def at(self, points: int) -> tuple[float, ...]:
        """The values form a geometric sequence. Integers form an arithmetic one, without repetitions."""
        low, high = self.values
        if self.whole:
            return tuple(map(float, dict.fromkeys(np.linspace(low, high, points).round().tolist())))
        return tuple(float(f"{value:.4g}") for value in np.geomspace(low, high, points))

    def steps(self, points: int) -> tuple[tuple[int, int], ...]:
        """(samples, steps between samples) of at most `points` runs; their steps [s] form a decreasing sequence.

        A run has 10 to 20 samples, so that the reference motion is evaluated at few instants.
        """
        by_count: dict[int, tuple[int, int]] = {}
        for doubling in np.linspace(0.0, self.doublings, points):
            every = 2 ** int(doubling)
            samples = round(MIN_STEPS * 2 ** (doubling - int(doubling)))
            by_count[samples * every] = (samples, every)
        return tuple(by_count[count] for count in sorted(by_count))


def coupler(ratio: float) -> FreeFourBar:
    return FreeFourBar(density=(1.0, ratio, 1.0))


def short_pendulum(length: float) -> PointPendulum:
    return PointPendulum(length=length, duration=1.0, horizon=1.0)


def sleigh(offset: float) -> ChaplyginSleigh:
    return ChaplyginSleigh(offset=offset, duration=1.0, horizon=1.0)


def loops_in_a_row(loops: float) -> NFourBar:
    return NFourBar(loops=round(loops), duration=1.2, horizon=1.2)


def heavy_tip(ratio: float) -> LinkPendulum:
    return LinkPendulum(links=3, tip=ratio, duration=0.5, horizon=0.5)


def chain_of(links: float) -> LinkPendulum:
    """A chain of 1 m for 0.5 s: it falls, but chaos has not yet amplified errors much."""
    return LinkPendulum(links=round(links), length=1 / round(links), duration=0.5, horizon=0.5)


def stiffest_hanging(scene: LinkPendulum) -> float:
    """The highest frequency of small oscillations about the hanging equilibrium [rad/s].

    M angle'' + K angle = 0 in absolute angles, with M = L^T diag(m) L + diag(I) and K = g diag(L^T m). The arm L_ij,
    by which link j moves the centre of mass of link i, is the length of link j for j < i, half of it for j = i, else 0.
    """
    chain = scene.chain
    lengths, masses = np.array(chain.lengths), np.array(chain.masses)
    arms = np.tril(np.broadcast_to(lengths, (chain.links, chain.links)), -1) + np.diag(lengths / 2)
    inertia = arms.T @ (masses[:, None] * arms) + np.diag(chain.inertia)
    stiffness = np.diag(chain.gravity * (masses @ arms))
    return float(math.sqrt(eigh(stiffness, inertia, eigvals_only=True)[-1]))


def near_the_largest_offset(gap: float) -> DrivenSliderCrank:
    """A driven slider-crank whose offset is (1 - gap) times the largest possible one."""
    plain = DrivenSliderCrank()
    return replace(plain, offset=(1 - gap) * (plain.rod - plain.crank), angle=math.pi / 2)


def rod_rate(gap: float) -> float:
    """The largest rate of the rod of `near_the_largest_offset` over a turn of the crank [rad/s]."""
    scene = near_the_largest_offset(gap)
    angles = np.concatenate([np.linspace(0, 2 * math.pi, 721), math.pi / 2 * 3 + np.geomspace(1e-7, 0.1, 200)])
    return float(scene.rate * np.abs(scene.shape.rates(angles)[0]).max())


def driven(rate: float) -> DrivenFourBar:
    """The four-bar, driven with this rate [rad/s] for 0.5 s."""
    return DrivenFourBar(rate=rate, revolutions=rate * 0.5 / (2 * math.pi))


def short_trailer(length: float) -> CarAndTrailer:
    """A car and a trailer with a drawbar of this length [m] and its centre of mass on the axle."""
    plain = CarAndTrailer()
    return replace(plain, length=length, centres=(plain.centres[0], 0.0), duration=2.0, horizon=2.0)


def ellipse(ratio: float) -> RollingEllipse:
    """An ellipse that starts on its flat side, so slowly that it keeps contact."""
    plain = RollingEllipse()
    return replace(plain, along_y=plain.along_x * ratio, start_rate=1.0, duration=1.0)


def rocking(ratio: float) -> float:
    """The frequency of small oscillations of `ellipse` about its flat side [rad/s]."""
    law = ellipse(ratio).motion_law
    return law.small_frequency(law.rolling.theta)


# Map -> its `make` and `frequency`.
SCENES_AND_FREQUENCIES: Mapping[str, tuple[Callable[[float], Scene], Callable[[float], float]]] = {
    "coupler": (coupler, lambda ratio: 1 / coupler(ratio).mechanism().time_scale),
    "rate": (driven, lambda rate: rate),
    "tip": (heavy_tip, lambda ratio: stiffest_hanging(heavy_tip(ratio))),
    "links": (chain_of, lambda links: stiffest_hanging(chain_of(links))),
    "length": (short_pendulum, lambda length: math.sqrt(9.81 / length)),
    "offset": (near_the_largest_offset, rod_rate),
    "sleigh": (sleigh, lambda offset: abs(sleigh(offset).turning_rate)),
    "drawbar": (short_trailer, lambda length: CarAndTrailer().speed / length),
    "ellipse": (ellipse, rocking),
    "loops": (loops_in_a_row, lambda loops: loops_in_a_row(loops).pendulum.frequency),
}


def _read() -> Iterator[StabilityMap]:
    plans = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    for name, plan in plans.items():
        make, frequency = SCENES_AND_FREQUENCIES[name]
        plan |= {"values": tuple(plan["values"]), "remark": " ".join(plan.get("remark", "").split())}
        yield StabilityMap(name, make=make, frequency=frequency, **plan)


MAPS: tuple[StabilityMap, ...] = tuple(_read())
