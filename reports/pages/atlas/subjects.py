"""The maps of the atlas, whose texts and ranges are in `subjects.toml`: a scene, the parameter that breaks it, and the
frequency of the motion that explains it."""

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

FEWEST = 10  # steps of a run: the largest step is a tenth of the duration


@dataclass(frozen=True)
class Subject:
    """A picture of the atlas; `subjects.toml` explains its fields.

    make: the scene at a value of the parameter. frequency: that of the fastest motion there [rad/s].
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
        """So many values, evenly in their logarithm; whole ones evenly, as many as there are."""
        low, high = self.values
        if self.whole:
            return tuple(map(float, dict.fromkeys(np.linspace(low, high, points).round().tolist())))
        return tuple(float(f"{value:.4g}") for value in np.geomspace(low, high, points))

    def steps(self, points: int) -> tuple[tuple[int, int], ...]:
        """(samples, steps a sample) of about so many steps, evenly in their logarithm, the largest first.

        Only ten numbers of samples are used, so that few instants have to be known of the truth.
        """
        found: dict[int, tuple[int, int]] = {}
        for doubling in np.linspace(0.0, self.doublings, points):
            every = 2 ** int(doubling)
            samples = round(FEWEST * 2 ** (doubling - int(doubling)))
            found[samples * every] = (samples, every)
        return tuple(found[count] for count in sorted(found))


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
    """A metre of chain, for half a second: it has come down, and has not yet lost the digits that chaos takes."""
    return LinkPendulum(links=round(links), length=1 / round(links), duration=0.5, horizon=0.5)


def stiffest_hanging(scene: LinkPendulum) -> float:
    """The highest frequency of small swings about the links that hang at rest [rad/s].

    In absolute angles M a + K angle = 0. A bar's middle, half of its own length and all of those above it, has its
    mass; M_ij sums m l_i l_j of all middles that both angles move, and K_ii the weight that each angle lifts.
    """
    chain = scene.chain
    lengths, masses = np.array(chain.lengths), np.array(chain.masses)
    arms = np.tril(np.broadcast_to(lengths, (chain.links, chain.links)), -1) + np.diag(lengths / 2)
    inertia = arms.T @ (masses[:, None] * arms) + np.diag(chain.inertia)
    stiffness = np.diag(chain.gravity * (masses @ arms))
    return float(math.sqrt(eigh(stiffness, inertia, eigvals_only=True)[-1]))


def near_the_largest_offset(gap: float) -> DrivenSliderCrank:
    """Driven, the slot short of the largest offset by this part of it, so that the rod nearly stands up once a turn."""
    plain = DrivenSliderCrank()
    return replace(plain, offset=(1 - gap) * (plain.rod - plain.crank), angle=math.pi / 2)


def rod_rate(gap: float) -> float:
    """The largest rate of that rod [rad/s], over a whole turn of the crank."""
    scene = near_the_largest_offset(gap)
    angles = np.concatenate([np.linspace(0, 2 * math.pi, 721), math.pi / 2 * 3 + np.geomspace(1e-7, 0.1, 200)])
    return float(scene.rate * np.abs(scene.shape.rates(angles)[0]).max())


def driven(rate: float) -> DrivenFourBar:
    """For half a second, whatever the rate."""
    return DrivenFourBar(rate=rate, revolutions=rate * 0.5 / (2 * math.pi))


def short_trailer(length: float) -> CarAndTrailer:
    """A drawbar of this length, with the trailer's mass over its axle and a straight car."""
    plain = CarAndTrailer()
    return replace(plain, length=length, centres=(plain.centres[0], 0.0), duration=2.0, horizon=2.0)


def ellipse(ratio: float) -> RollingEllipse:
    """On its flat side, slowly enough to stay on the ground."""
    plain = RollingEllipse()
    return replace(plain, along_y=plain.along_x * ratio, start_rate=1.0, duration=1.0)


def rocking(ratio: float) -> float:
    """Of small swings about that side [rad/s]."""
    law = ellipse(ratio).motion_law
    return law.small_frequency(law.rolling.theta)


# By the map's name: the scene at a value, and the frequency [rad/s] of the motion that the map names.
MOTIONS: Mapping[str, tuple[Callable[[float], Scene], Callable[[float], float]]] = {
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


def _read() -> Iterator[Subject]:
    plans = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    for name, plan in plans.items():
        make, frequency = MOTIONS[name]
        plan |= {"values": tuple(plan["values"]), "remark": " ".join(plan.get("remark", "").split())}
        yield Subject(name, make=make, frequency=frequency, **plan)


SUBJECTS: tuple[Subject, ...] = tuple(_read())
