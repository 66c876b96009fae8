"""Curves in fifty digits: each as arc, direction, point and curvature of its natural parameter, from its definition."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Curve, Ring
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola
from tests.reference.laws.law import Law, Outside, decades


@dataclass(frozen=True)
class Exact:
    """Functions of the natural parameter: arc [m], direction of traversal [rad], point, and d arc / d parameter [m]."""

    arc: Callable[[Any], Any]
    angle: Callable[[Any], Any]
    point: Callable[[Any], Any]
    speed: Callable[[Any], Any]
    curvature: Callable[[Any], Any]


def ellipse(a: Any, b: Any) -> Exact:
    """As in `reference.rolling.closed_curves`, by Legendre's integral."""
    if max(a / b, b / a) > 999:
        raise Outside

    def excess(u: Any) -> Any:  # over a circle's direction: less than a quarter turn
        return mp.atan2((a - b) * mp.sin(u) * mp.cos(u), a * mp.sin(u) ** 2 + b * mp.cos(u) ** 2)

    def speed(u: Any) -> Any:
        return mp.sqrt((a * mp.sin(u)) ** 2 + (b * mp.cos(u)) ** 2)

    return Exact(
        lambda u: b * mp.ellipe(u, 1 - (a / b) ** 2),
        lambda u: u + mp.pi / 2 + excess(u),
        lambda u: mp.mpc(a * mp.cos(u), b * mp.sin(u)),
        speed,
        lambda u: a * b / speed(u) ** 3,
    )


def parabola(focal: Any) -> Exact:
    """In asinh of the slope."""
    return Exact(
        lambda p: focal * (p + mp.sinh(2 * p) / 2),
        lambda p: mp.atan(mp.sinh(p)),
        lambda p: focal * mp.mpc(2 * mp.sinh(p), mp.sinh(p) ** 2),
        lambda p: 2 * focal * mp.cosh(p) ** 2,
        lambda p: 1 / (2 * focal * mp.cosh(p) ** 3),
    )


def catenary(scale: Any) -> Exact:
    """In its arc."""
    return Exact(
        lambda s: s,
        lambda s: mp.atan(s / scale),
        lambda s: scale * mp.asinh(s / scale) + mp.j * mp.sqrt(scale**2 + s**2),
        lambda s: mp.mpf(1),
        lambda s: scale / (scale**2 + s**2),
    )


def spiral(radius: Any, growth: Any) -> Exact:
    """In the polar angle."""
    stretch = mp.sqrt(1 + growth**2) / growth

    def arc(p: Any) -> Any:
        return stretch * radius * mp.exp(growth * p)

    return Exact(
        arc,
        lambda p: p + mp.atan2(1, growth),
        lambda p: radius * mp.exp(mp.mpc(growth, 1) * p),
        lambda p: growth * arc(p),
        lambda p: 1 / (growth * arc(p)),
    )


def round_curve(sense: int) -> Callable[..., Exact]:
    """A disc or a hole, in its arc."""

    def made(radius: Any, x: Any, y: Any) -> Exact:
        return Exact(
            lambda s: s,
            lambda s: sense * (s / radius + mp.pi / 2),
            lambda s: mp.mpc(x, y) + radius * mp.expj(sense * s / radius),
            lambda s: mp.mpf(1),
            lambda s: sense / radius,
        )

    return made


def cam(radius: Any, *harmonics: Any) -> Exact:
    """In the direction of the normal; `harmonics`: cosine and sine of the first, of the second, of the third."""

    def series(nu: Any, order: int) -> Any:
        out = mp.mpf(0)
        for k in range(1, 1 + len(harmonics) // 2):
            phase = k * nu + order * mp.pi / 2
            out += mp.mpf(k) ** order * (harmonics[2 * k - 2] * mp.cos(phase) + harmonics[2 * k - 1] * mp.sin(phase))
        return out

    def whole(nu: Any) -> Any:
        return radius * nu + series(nu, -1) + series(nu, 1)

    def speed(nu: Any) -> Any:
        return radius + series(nu, 0) + series(nu, 2)

    return Exact(
        lambda nu: whole(nu) - whole(mp.mpf(0)),
        lambda nu: nu + mp.pi / 2,
        lambda nu: mp.expj(nu) * mp.mpc(radius + series(nu, 0), series(nu, 1)),
        speed,
        lambda nu: 1 / speed(nu),
    )


def our_cam(radius: float, *harmonics: float) -> Cam:
    return Cam(radius, tuple(harmonics[::2]), tuple(harmonics[1::2]))


def place_of(curve: Exact, arc: Any, low: Any, high: Any) -> Any:
    """The parameter of an arc, by Newton's method between two that enclose it."""
    x = (low + high) / 2
    for _ in range(400):
        miss = curve.arc(x) - arc
        low, high = (low, x) if miss > 0 else (x, high)
        following = x - miss / curve.speed(x)
        if not low <= following <= high:
            following = (low + high) / 2
        if abs(following - x) <= abs(x) * mp.mpf(10) ** (4 - mp.mp.dps) + mp.mpf(10) ** (-2 * mp.mp.dps):
            return following
        x = following
    raise AssertionError("no place was found")


def values(curve: Exact, place: Any) -> list[Any]:
    """Direction, point and curvature: what `ours_at` gives."""
    point = curve.point(place)
    return [curve.angle(place), point.real, point.imag, curve.curvature(place)]


def ours_at(curve: Curve, place: float) -> list[Any]:
    """The same of a curve of the reference at a parameter."""
    return [curve.angle_of(place), *curve.point_of(place), curve.curvature_of(place)]


def by_parameter(name: str, exact: Callable[..., Exact], ours: Callable[..., Curve], draw: Any) -> Law:
    """Arc, direction, point and curvature at a parameter, the last argument."""
    return Law(
        f"{name} at a parameter",
        draw,
        lambda *numbers: [ours(*numbers[:-1]).arc_of(numbers[-1]), *ours_at(ours(*numbers[:-1]), numbers[-1])],
        lambda *numbers: [exact(*numbers[:-1]).arc(numbers[-1]), *values(exact(*numbers[:-1]), numbers[-1])],
        vectors=(slice(2, 4),),
    )


def by_arc(name: str, exact: Callable[..., Exact], ours: Callable[..., Curve], draw: Any, enclose: Any) -> Law:
    """Parameter, direction, point and curvature at an arc, the last argument."""

    def truth(*numbers: Any) -> list[Any]:
        curve = exact(*numbers[:-1])
        place = place_of(curve, numbers[-1], *enclose(*numbers))
        return [place, *values(curve, place)]

    def found(*numbers: float) -> list[Any]:
        curve = ours(*numbers[:-1])
        place = float(curve.parameter(numbers[-1]))
        point = curve.point(numbers[-1])
        return [place, curve.angle(numbers[-1]), *point, curve.curvature(numbers[-1])]

    return Law(
        f"{name} at an arc", draw, found, truth, vectors=(slice(2, 4),), quick=0 if name == "ellipse" else 12, many=300
    )


def drawn_ellipse(rng: np.random.Generator) -> tuple[float, ...]:
    a = decades(rng)
    b = a * (decades(rng, -2.9, 2.9) if rng.random() < 0.5 else 1 + decades(rng, -14, 0))
    return a, b


def at(draw: Any, last: Callable[[np.random.Generator, tuple[float, ...]], float]) -> Any:
    """A draw of a curve's numbers, and then of a place that may depend on them."""

    def drawn(rng: np.random.Generator) -> tuple[float, ...]:
        numbers = draw(rng)
        return (*numbers, last(rng, numbers))

    return drawn


def turned(rng: np.random.Generator, numbers: tuple[float, ...]) -> float:
    """Up to a few turns, often next to an end of an axis."""
    if rng.random() < 0.5:
        return float(rng.uniform(-20, 20))
    return float(rng.integers(-4, 5)) * math.pi / 2 + float(rng.choice([-1, 1])) * decades(rng, -12, 0)


def drawn_cam(rng: np.random.Generator) -> tuple[float, ...]:
    """Convex: radius above the sum of (k^2 - 1) c_k; at times nearly not."""
    radius, spread = decades(rng), (0.1 if rng.random() < 0.7 else 0.35)
    c = [radius * float(rng.uniform(-1, 1)) for _ in range(2)]
    return radius, *c, *(radius * spread * float(rng.uniform(-1, 1)) / share for share in (3, 3, 8, 8))


def either_way(rng: np.random.Generator, size: float) -> float:
    return float(rng.choice([-1, 1])) * size * decades(rng, -9, 3)


CURVES = (
    by_parameter("ellipse", ellipse, Ellipse, at(drawn_ellipse, turned)),
    by_arc(
        "ellipse",
        ellipse,
        Ellipse,
        at(drawn_ellipse, lambda rng, n: math.hypot(*n) * turned(rng, n)),
        lambda a, b, arc: sorted((mp.mpf(0), arc * mp.pi / 2 / min(a, b))),
    ),
    by_parameter("cam", cam, our_cam, at(drawn_cam, turned)),
    by_arc(
        "parabola",
        parabola,
        Parabola,
        at(lambda rng: (decades(rng),), lambda rng, n: either_way(rng, n[0])),
        lambda focal, arc: sorted((mp.mpf(0), mp.sign(arc) * mp.log1p(4 * abs(arc) / focal))),
    ),
    by_arc(
        "catenary",
        catenary,
        Catenary,
        at(lambda rng: (decades(rng),), lambda rng, n: either_way(rng, n[0])),
        lambda scale, arc: sorted((mp.mpf(0), 2 * arc)),
    ),
    by_parameter(
        "logarithmic spiral",
        spiral,
        LogSpiral,
        at(lambda rng: (decades(rng), decades(rng, -3, 2)), lambda rng, n: either_way(rng, 1 / n[1]) % (30 / n[1])),
    ),
    *(
        by_parameter(
            name,
            round_curve(sense),
            lambda radius, x, y, kind=kind: kind(radius, (x, y)),
            at(
                lambda rng: (decades(rng), float(rng.normal()) * decades(rng), float(rng.normal()) * decades(rng)),
                lambda rng, n: n[0] * turned(rng, n),
            ),
        )
        for name, sense, kind in (("disc", 1, Circle), ("hole", -1, Ring))
    ),
)
