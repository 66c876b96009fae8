"""Four-bar and slider-crank in fifty digits: closure as complex numbers, forces as each body's own balance."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np

from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.slider_crank.scenes import SliderCrank
from tests.reference.laws.law import Law, Outside, angle, decades


def root(square: Any) -> Any:
    """The square root, of a number that must not be negative."""
    if square < 0:
        raise Outside
    return mp.sqrt(square)


def solved(rows: list[list[Any]], right: list[Any]) -> list[Any]:
    """x of rows x = right."""
    return list(mp.lu_solve(mp.matrix(rows), mp.matrix(right)))


def closed(crank: Any, coupler: Any, rocker: Any, x: Any, y: Any, theta: Any, branch: int) -> tuple[Any, ...]:
    """The bars as complex numbers."""
    bar, ground = crank * mp.expj(theta), mp.mpc(x, y)
    span = abs(ground - bar)
    foot = (span**2 + coupler**2 - rocker**2) / (2 * span)
    out = (ground - bar) / span * mp.mpc(foot, branch * root(coupler**2 - foot**2))
    return bar, out, bar + out - ground


def four_bar(branch: int):
    def exact(crank, coupler, rocker, x, y, theta, rate, acceleration):
        a, b, c = closed(crank, coupler, rocker, x, y, theta, branch)
        rows = [[-b.imag, c.imag], [b.real, -c.real]]
        once = solved(rows, [a.imag * rate, -a.real * rate])
        rest = a * (1j * acceleration - rate**2) - b * once[0] ** 2 + c * once[1] ** 2
        return [mp.arg(b), mp.arg(c), *once, *solved(rows, [-rest.real, -rest.imag])]

    def ours(crank, coupler, rocker, x, y, theta, rate, acceleration):
        return FourBar(crank, coupler, rocker, (x, y)).kinematics(theta, rate, acceleration, branch)

    return exact, ours


def drawn_four_bar(rng: np.random.Generator) -> tuple[float, ...]:
    """Lengths and a crank angle that close; half of the times nearly stretched or nearly folded."""
    scale, theta = decades(rng), angle(rng)
    crank, ground, heading = decades(rng, -2, 2), decades(rng, -2, 2), rng.uniform(-math.pi, math.pi)
    if rng.random() < 0.3:
        heading = 0.0
    x, y = ground * math.cos(heading), ground * math.sin(heading)
    span = abs(complex(x, y) - crank * complex(math.cos(theta), math.sin(theta)))
    if rng.random() < 0.5:  # coupler and rocker are longer than the span by little or by much
        whole, part = span * (1 + decades(rng, -14, 1)), rng.random()
        coupler, rocker = whole * part, whole * (1 - part)
        if abs(coupler - rocker) > span:
            coupler = rocker = whole / 2
    else:
        coupler = span * (0.5 + decades(rng, -1, 2))
        rocker = abs(coupler + float(rng.choice([-1, 1])) * span * (1 - decades(rng, -14, 0)))
    return (
        *(scale * value for value in (crank, coupler, rocker, x, y)),
        *(theta, float(rng.normal()) * decades(rng), float(rng.normal()) * decades(rng)),
    )


def limits(crank, coupler, rocker, x, y):
    """The crank's ends by the cosine rule, from the direction of the ground, where U and where W vanish."""
    ground = mp.hypot(x, y)

    def end(reach):
        cosine = (crank**2 + ground**2 - reach**2) / (2 * crank * ground)
        if abs(cosine) >= 1:
            raise Outside
        return mp.acos(cosine)

    return [end(coupler + rocker)]


def our_limits(crank, coupler, rocker, x, y):
    linkage = FourBar(crank, coupler, rocker, (x, y))
    intervals = linkage.crank_limits()
    if intervals is None or len(intervals) != 1:
        raise ValueError
    return [(intervals[0][1] - intervals[0][0]) / 2]


def drawn_limits(rng: np.random.Generator) -> tuple[float, ...]:
    scale = decades(rng)
    crank, ground = decades(rng, -2, 2), decades(rng, -2, 2)
    # From |crank - ground|, where the range is a point, to crank + ground, where it is a whole turn.
    low, high = abs(crank - ground), crank + ground
    part = decades(rng, -14, -0.3)
    reach = low + (high - low) * (part if rng.random() < 0.5 else 1 - part)
    share = rng.uniform(0.3, 0.7)
    return tuple(scale * value for value in (crank, reach * share, reach * (1 - share), ground, 0.0))


def slider_crank(branch: int):
    def positions(crank, rod, offset, theta):
        sine = (offset - crank * mp.sin(theta)) / rod
        cosine = branch * root((1 - sine) * (1 + sine))
        return sine, cosine, crank * mp.cos(theta) + rod * cosine

    def exact(crank, rod, offset, theta, rate, acceleration):
        sine, cosine, x = positions(crank, rod, offset, theta)
        first = -crank * mp.cos(theta) / (rod * cosine)
        second = (crank * mp.sin(theta) + rod * sine * first**2) / (rod * cosine)
        turn, pull = first * rate, first * acceleration + second * rate**2
        arm = rod * mp.mpc(cosine, sine)
        slider = crank * mp.expj(theta) * (1j * acceleration - rate**2) + arm * (1j * pull - turn**2)
        along = (1j * crank * mp.expj(theta) + 1j * arm * first).real
        return [x, along, slider.real, mp.atan2(sine, cosine), first, second]

    def ours(crank, rod, offset, theta, rate, acceleration):
        shape = SliderCrank(crank, rod, offset, branch)
        turn, slide = shape.rates(theta)
        bend, gain = (each.imag / 1e-100 for each in shape.rates(theta + 1e-100j))
        return [
            *(shape.position(theta), slide, gain * rate**2 + slide * acceleration),
            *(shape.rod_angle(theta), turn, bend),
        ]

    return exact, ours


def drawn_slider_crank(rng: np.random.Generator) -> tuple[float, ...]:
    """Crank and rod over decades; the rod often so short that it nearly turns back."""
    scale, clock = decades(rng), decades(rng)
    crank = decades(rng, -2, 2)
    rod = crank * (1 + decades(rng, -12, 2))
    offset = (rod - crank) * float(rng.uniform(-1, 1))
    return (
        *(scale * crank, scale * rod, scale * offset, angle(rng)),
        *(float(rng.normal()) / clock, float(rng.normal()) / clock**2),
    )


LINKAGES = (
    *(
        Law(f"four-bar, branch {branch:+d}", drawn_four_bar, ours, exact, angles=(0, 1))
        for branch in (1, -1)
        for exact, ours in [four_bar(branch)]
    ),
    Law("four-bar, limit of the crank", drawn_limits, our_limits, limits),
    *(
        Law(f"slider-crank, branch {branch:+d}", drawn_slider_crank, ours, exact, angles=(3,))
        for branch in (1, -1)
        for exact, ours in [slider_crank(branch)]
    ),
)
