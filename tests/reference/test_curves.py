"""Curves by arc length against 30-digit quadrature of their parametric form, over many turns, and what they refuse."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.numerics.roots import solve_increasing
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.open_curves import Catenary, LogSpiral, Parabola
from reference.rolling.traced import Traced

COSINES, SINES = (0.05, 0.02, 0.01), (0.0, 0.03)


def support(nu, order=0):
    """The support function or its first derivative."""
    waves = zip((1, 2, 3), COSINES, (*SINES, 0.0), strict=True)
    constant = mp.mpf(0.4) if order == 0 else mp.mpf(0)
    phase = order * mp.pi / 2
    return constant + sum(k**order * (c * mp.cos(k * nu + phase) + s * mp.sin(k * nu + phase)) for k, c, s in waves)


def cam_point(nu):
    height, slope = support(nu), support(nu, 1)
    return height * mp.cos(nu) - slope * mp.sin(nu), height * mp.sin(nu) + slope * mp.cos(nu)


# Curve, parametric form in the direction of traversal, parameter at arc 0, range of parameters to try.
CASES = {
    "line": (Line(1.1, (0.2, 0.3)), lambda u: (0.2 + u * mp.cos(1.1), 0.3 + u * mp.sin(1.1)), 0, (-9, 9)),
    "side": (Side(2.0), lambda u: (u, mp.mpf(-1)), 0, (-1, 1)),
    "circle": (Circle(0.4, (0.1, 0.2)), lambda u: (0.1 + 0.4 * mp.cos(u), 0.2 + 0.4 * mp.sin(u)), 0, (-9, 9)),
    "ring": (Ring(0.7, (0.1, 0.2)), lambda u: (0.1 + 0.7 * mp.cos(u), 0.2 - 0.7 * mp.sin(u)), 0, (-9, 9)),
    "ellipse": (Ellipse(0.5, 0.3), lambda u: (0.5 * mp.cos(u), 0.3 * mp.sin(u)), 0, (-9, 9)),
    "upright ellipse": (Ellipse(0.3, 0.5), lambda u: (0.3 * mp.cos(u), 0.5 * mp.sin(u)), 0, (-9, 9)),
    "parabola": (Parabola(0.3), lambda u: (u, u * u / (4 * mp.mpf(0.3))), 0, (-3, 3)),
    "catenary": (Catenary(0.4), lambda u: (u, 0.4 * mp.cosh(u / mp.mpf(0.4))), 0, (-1, 1)),
    "cam": (Cam(0.4, COSINES, SINES), cam_point, 0, (-4, 4)),
    "spiral": (
        LogSpiral(0.5, 0.3),
        lambda u: (0.5 * mp.exp(0.3 * u) * mp.cos(u), 0.5 * mp.exp(0.3 * u) * mp.sin(u)),
        -mp.inf,
        (-4, 4),
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_curve_is_its_parametric_form_by_arc_length(case):
    curve, form, start, (low, high) = CASES[case]
    with mp.workdps(30):

        def velocity(p):
            # A central difference of 1e-12 is wrong by 1e-24; of the 60 digits it leaves 48.
            with mp.workdps(60):
                h = mp.mpf("1e-12")
                (x, y), (before_x, before_y) = form(p + h), form(p - h)
                return (x - before_x) / (2 * h), (y - before_y) / (2 * h)

        def speed(p):
            return mp.hypot(*velocity(p))

        # From the start outwards, each arc from the place before it.
        places = [mp.mpf(float(u)) for u in np.random.default_rng(4).uniform(low, high, 4)]
        begin = mp.mpf(-5) if start == -mp.inf else mp.mpf(start)
        arc_of: dict[Any, Any] = {begin: mp.quad(speed, [start, begin]) if start == -mp.inf else mp.mpf(0)}
        for side in (sorted(u for u in places if u > begin), sorted((u for u in places if u < begin), reverse=True)):
            for before, u in pairwise((begin, *side)):
                # Pieces of about a radian, so that Gauss-Legendre reaches its digits.
                pieces = mp.linspace(before, u, 2 + int(abs(u - before)))
                arc_of[u] = arc_of[before] + mp.quad(speed, pieces)
        for u in places:
            along = float(arc_of[u])
            vx, vy = velocity(u)
            ax, ay = mp.diff(lambda q: form(q)[0], u, 2), mp.diff(lambda q: form(q)[1], u, 2)
            # Rounding of the arc moves the point along; a few units in the last place of the curve's own size.
            size = 1 + abs(along)
            np.testing.assert_allclose(curve.point(along), [float(c) for c in form(u)], rtol=0, atol=4e-15 * size)
            direction = math.remainder(float(curve.angle(along)) - float(mp.atan2(vy, vx)), 2 * math.pi)
            bend = (vx * ay - vy * ax) / speed(u) ** 3
            # An error of one rounding of the arc turns the tangent by the curvature times that.
            assert abs(direction) < 2e-15 * size * (1 + abs(float(bend)))
            assert float(curve.curvature(along)) == pytest.approx(float(bend), rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("axes", [(0.5, 0.3), (0.3, 0.5), (1.0, 0.01), (0.01, 1.0), (1.0, 1.0), (1.0, 1 - 1e-9)])
def test_the_ellipses_arc_is_the_elliptic_integral_over_many_turns(axes):
    a, b = axes
    curve = Ellipse(a, b)
    u = np.concatenate([np.random.default_rng(1).uniform(-40, 40, 30), np.pi / 2 * np.arange(-9, 10)])
    with mp.workdps(30):
        exact = [float(mp.mpf(b) * mp.ellipe(mp.mpf(float(v)), 1 - (mp.mpf(a) / mp.mpf(b)) ** 2)) for v in u]
    # One rounding of the largest arc, about 40 of these axes.
    np.testing.assert_allclose(curve.arc_of(u), exact, rtol=0, atol=1e-14)
    np.testing.assert_allclose(curve.arc_of(curve.parameter(exact)), exact, rtol=0, atol=1.5e-14)


@pytest.mark.parametrize("case", ["circle", "ring", "ellipse", "upright ellipse", "cam"])
def test_nothing_jumps_over_many_turns(case):
    curve = CASES[case][0]
    arc = np.linspace(-7 * curve.length, 7 * curve.length, 5001)
    step = arc[1] - arc[0]
    steepest = max(map(abs, curve.curvature_range))
    assert np.abs(np.diff(curve.angle(arc))).max() <= 1.001 * steepest * step
    assert np.abs(np.diff(curve.point(arc), axis=0)).max() <= 1.001 * step
    np.testing.assert_allclose(curve.arc(curve.angle(arc)), arc, rtol=0, atol=1e-13)
    turned = curve.angle(arc + curve.length) - curve.angle(arc)
    np.testing.assert_allclose(turned, math.copysign(2 * np.pi, steepest * curve.curvature_range[0]), atol=1e-13)


@pytest.mark.parametrize("case", ["parabola", "catenary", "spiral"])
def test_an_open_curve_finds_the_place_of_a_direction(case):
    curve = CASES[case][0]
    arc = np.random.default_rng(2).uniform(0.05, 9, 200)
    # Near the vertical the direction hardly changes with the arc: the inverse loses in proportion.
    np.testing.assert_allclose(curve.arc(curve.angle(arc)), arc, rtol=1e-13 / float(curve.curvature(9.0)))


@pytest.mark.parametrize("case", CASES)
def test_material_is_on_the_left_where_curvature_is_positive(case):
    curve = CASES[case][0]
    arc = np.linspace(0.1, 0.9, 5)
    middle = (curve.point(arc + 1e-3) + curve.point(arc - 1e-3)) / 2 - curve.point(arc)
    left = np.stack([-np.sin(curve.angle(arc)), np.cos(curve.angle(arc))], axis=-1)
    # The chord's middle lies by curvature h^2 / 2 on the side to which the curve bends.
    bend = 2 * np.sum(middle * left, axis=-1) / 1e-6
    np.testing.assert_allclose(bend, curve.curvature(arc), rtol=1e-3, atol=1e-6)


def test_a_placed_curve_is_moved_as_a_rigid_body():
    curve, placed = Ellipse(0.5, 0.3), Placed(Ellipse(0.5, 0.3), (1.0, 2.0), 0.7)
    arc = np.linspace(-5, 5, 50)
    x, y = curve.point(arc).T
    moved = np.stack([1 + np.cos(0.7) * x - np.sin(0.7) * y, 2 + np.sin(0.7) * x + np.cos(0.7) * y], axis=-1)
    np.testing.assert_allclose(placed.point(arc), moved, atol=1e-15)
    np.testing.assert_allclose(placed.arc(placed.angle(arc)), arc, atol=1e-14)


def test_a_traced_ellipse_is_the_ellipse_in_pieces():
    u = np.linspace(0, 2, 200)
    traced, exact = Traced(u, np.stack([0.5 * np.cos(u), 0.3 * np.sin(u)], axis=-1)), Ellipse(0.5, 0.3)
    arc = np.linspace(0.01, traced.limits[1] - 0.01, 37)
    # Spacing 0.01: (0.01)^8 for points, two powers less for the curvature; then rounding over the spacing.
    np.testing.assert_allclose(traced.point(arc), exact.point(arc), atol=1e-14)
    np.testing.assert_allclose(traced.angle(arc), exact.angle(arc), atol=1e-12)
    np.testing.assert_allclose(traced.curvature(arc), exact.curvature(arc), rtol=1e-9)
    np.testing.assert_allclose(traced.arc(traced.angle(arc)), arc, atol=1e-12)


def test_the_narrowest_bend_of_a_random_cam_is_found():
    rng = np.random.default_rng(8)
    for _ in range(20):
        curve = Cam(1.0, tuple(rng.uniform(-0.01, 0.01, 4)), tuple(rng.uniform(-0.01, 0.01, 4)))
        everywhere = 1 / curve.speed_of(np.linspace(0, 2 * np.pi, 4001))
        low, high = curve.curvature_range
        # A grid of 1.6 mrad misses an extremum by its square times the second derivative, below 1e-5.
        assert everywhere.max() <= high * (1 + 1e-14)
        assert everywhere.max() == pytest.approx(high, rel=1e-5)
        assert everywhere.min() == pytest.approx(low, rel=1e-5)


REFUSED = {
    "a cam that isn't convex": (lambda: Cam(0.4, (0.0, 0.0, 0.06)), "not convex"),
    "a corner of a square": (lambda: Side(1.0).point(0.6), "corners of infinite curvature"),
    "the pole of a spiral": (lambda: LogSpiral(0.5, 0.3).curvature(0.0), "infinite curvature"),
    "a needle of an ellipse": (lambda: Ellipse(1.0, 1e-4), "infinite curvature"),
    "a negative radius": (lambda: Circle(-1.0), "greater than zero"),
    "a radius not finite": (lambda: Ring(math.nan), "finite"),
    "a heading not finite": (lambda: Line(math.inf), "finite"),
    "harmonics not finite": (lambda: Cam(0.4, (math.nan,)), "finite"),
    "the place of a straight line's direction": (lambda: Line().arc(1.0), "straight"),
    "a parabola standing upright": (lambda: Parabola(0.3).arc(1.6), "within"),
    "too few points": (lambda: Traced(np.arange(5.0), np.zeros((5, 2))), "at least 16"),
    "a point instead of a curve": (lambda: Traced(np.arange(20.0), np.ones((20, 2))), "stands still"),
    "a cusp": (lambda: Traced(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41)[:, None] ** [2, 3]), "cusp"),
    "parameters that go back": (lambda: Traced(np.zeros(20), np.ones((20, 2))), "not greater"),
    "beyond the last point": (
        lambda: Traced(np.arange(20.0), np.arange(20.0)[:, None] * [1, 2]).point(99.0),
        "where its points end",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_curve_is_refused_with_a_reason(case):
    make, reason = REFUSED[case]
    with pytest.raises(InvalidMechanism, match=reason):
        make()


def test_a_root_out_of_reach_is_an_error_and_not_a_number():
    with pytest.raises(ArithmeticError, match="no root"):
        solve_increasing(lambda x: (np.tanh(x), 1 / np.cosh(np.clip(x, -300, 300)) ** 2), [2.0], [0.0], 1.0)
    with pytest.raises(ArithmeticError, match="finite"):
        solve_increasing(lambda x: (x, np.ones_like(x)), [np.nan], [0.0], 1.0)


@pytest.mark.parametrize("ratio", [1.5, 30.0, 257.0, 1000.0])
@pytest.mark.parametrize("tall", [False, True])
def test_slender_ellipses_keep_their_digits_at_their_sharp_ends(ratio, tall):
    axes = (1.0, ratio) if tall else (ratio, 1.0)
    ellipse = Ellipse(*axes)
    arcs = np.array([-0.0009810452078227172, 1e-12, 1e-6, 1e-3, 0.3, 0.2 * ellipse.length, -0.9 * ellipse.length])
    angles = ellipse.angle(arcs)
    with mp.workdps(40):
        a, b = map(mp.mpf, axes)
        half = 2 * b * mp.ellipe(1 - (a / b) ** 2)
        for arc, angle in zip(arcs, angles, strict=True):
            turns = mp.nint(mp.mpf(float(arc)) / half)
            rest = mp.mpf(float(arc)) - turns * half

            def missing(u, rest=rest):
                return b * mp.ellipe(u, 1 - (a / b) ** 2) - rest

            u = mp.findroot(missing, (-mp.pi / 2, mp.pi / 2), solver="anderson", tol=1e-70, maxsteps=300)
            curvature = a * b / mp.sqrt((a * mp.sin(u)) ** 2 + (b * mp.cos(u)) ** 2) ** 3
            exact = mp.atan2(b * mp.cos(u), -a * mp.sin(u))
            off = abs((mp.mpf(float(angle)) - exact) / mp.pi % 1)
            # The rounding of the arc itself turns the tangent by curvature x arc x 1e-16.
            assert float(min(off, 1 - off) * mp.pi) < 8 * 2.2e-16 * (2 + float(curvature) * abs(float(arc)))
