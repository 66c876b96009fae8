"""What the atlas maps: a scene, the parameter that breaks it, the values it takes, and the motion that explains it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer

FEWEST = 10  # steps of a run: the largest step is a tenth of the duration


@dataclass(frozen=True)
class Subject:
    """A picture of the atlas.

    make: the scene at a value of the parameter. values: from, to; whole: only whole numbers between. doublings: the
    smallest step is so often half of the largest. frequency: of what turns or swings fastest there [rad/s]; `fastest`
    says what that is, for the line that stands for it. page: of the mechanism. remark: what the map teaches.
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


SUBJECTS: tuple[Subject, ...] = (
    Subject(
        "coupler",
        "A free four-bar with a light or a heavy coupler",
        "mass of the coupler per metre, relative to the other bars'",
        lambda ratio: FreeFourBar(density=(1.0, ratio, 1.0)),
        (1e-5, 1e5),
        lambda ratio: 1 / FreeFourBar(density=(1.0, ratio, 1.0)).mechanism().time_scale,
        "the bars' swing",
        page="four_bar",
        remark=(
            "Sweeps over the joints have most trouble with a bar that is much lighter than its neighbours: "
            "each joint undoes what the last one did. MuJoCo as shipped tears at the lightest and the "
            "heaviest coupler, whatever the step: its loop's spring is too soft for them. MuJoCo tuned has "
            "reduced coordinates, a stiff spring and one exact solution a step. It gets through everywhere "
            "once the step is small enough."
        ),
    ),
    Subject(
        "rate",
        "A four-bar driven fast",
        "rate of the crank [rad/s]",
        driven,
        (1.0, 1e3),
        lambda rate: rate,
        "the crank's turning",
        page="four_bar",
    ),
    Subject(
        "tip",
        "A pendulum of three links with a heavy tip",
        "tip's mass over a link's",
        heavy_tip,
        (1e-2, 1e3),
        lambda ratio: stiffest_hanging(heavy_tip(ratio)),
        "the stiffest mode about hanging",
        page="pendulum",
        remark="A heavy tip is hard for sweeps and for large steps of a tree alike.",
    ),
    Subject(
        "links",
        "Chains of many links",
        "links in a metre",
        chain_of,
        (1, 40),
        lambda links: stiffest_hanging(chain_of(links)),
        "the stiffest mode about hanging",
        whole=True,
        doublings=5.0,
        page="pendulum",
    ),
    Subject(
        "length",
        "A short pendulum",
        "length [m]",
        lambda length: PointPendulum(length=length, duration=1.0, horizon=1.0),
        (1e-4, 10.0),
        lambda length: math.sqrt(9.81 / length),
        "the small swing",
        page="pendulum",
    ),
    Subject(
        "offset",
        "A slider-crank whose rod nearly stands up",
        "what lacks to the largest offset, relative to it",
        near_the_largest_offset,
        (1e-7, 1.0),
        rod_rate,
        "the rod at its fastest",
        page="slider_crank",
        remark=(
            "At the largest offset the rod stands upright once a turn, and the two assemblies meet. Near it "
            "the slider is fast, and the forces are large for a moment. MuJoCo's soft loop as shipped lets "
            "the rod through to the other assembly, and so does pymunk's. pymunk tuned gets through "
            "at every value once the step is small enough; of MuJoCo tuned some value flips or tears at each step."
        ),
    ),
    Subject(
        "sleigh",
        "A sleigh with its centre of mass far ahead",
        "offset of the centre of mass [m]",
        lambda offset: ChaplyginSleigh(offset=offset, duration=1.0, horizon=1.0),
        (1e-3, 1e3),
        lambda offset: abs(ChaplyginSleigh(offset=offset).turning_rate),
        "the turning at the start",
        page="skate",
        remark=(
            "For a method that holds the row the offset matters little. The naive zeroing (`pymunk naive`) "
            "is right only where the centre of mass is nearly on the skate."
        ),
    ),
    Subject(
        "drawbar",
        "A trailer on a short drawbar",
        "length of the drawbar [m]",
        short_trailer,
        (2e-2, 10.0),
        lambda length: CarAndTrailer().speed / length,
        "the trailer's settling",
        page="wheels",
    ),
    Subject(
        "ellipse",
        "An ellipse that rolls, ever thinner",
        "short semi-axis over the long one",
        ellipse,
        (0.03, 0.99),
        rocking,
        "rocking on the flat side",
        page="rolling",
    ),
    Subject(
        "loops",
        "Many four-bars in a row, through one singular position",
        "loops",
        lambda loops: NFourBar(loops=round(loops), duration=1.2, horizon=1.2),
        (1, 20),
        lambda loops: NFourBar(loops=round(loops)).pendulum.frequency,
        "the cranks' swing",
        whole=True,
        doublings=5.0,
        page="n_four_bar",
        remark=(
            "With a single loop the line is a parallelogram's change point. Each further loop adds a freedom there."
        ),
    ),
)
