"""The slider-crank: its loop in both branches, dead centres and strokes, the work of its drive, time by a quadrature.

Its rates in fifty digits are asked by `laws`, its motions and forces by `test_scenes`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from reference.checks import InvalidMechanism
from reference.joints import Slot
from reference.scenes.slider_crank.linkage import SliderCrank
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, SliderAtDeadCentre
from reference.trajectory import energy

THETA = np.linspace(0, 2 * math.pi, 37)
SHAPES = [SliderCrank(0.3, 1.0), SliderCrank(0.3, 1.0, 0.2), SliderCrank(0.5, 0.9, -0.3, -1), SliderCrank(1.0, 1.01)]


def test_a_slot_gap_is_the_distance_from_the_line_and_ignores_sliding() -> None:
    slot = Slot("guide", None, "b", (1.0, 2.0), math.pi / 6, (0.5, 0.0))
    along, left = np.array([math.cos(math.pi / 6), 0.5]), np.array([-0.5, math.cos(math.pi / 6)])
    for slide in (-3.0, 0.0, 2.0):
        point = np.array([1.0, 2.0]) + slide * along + 0.25 * left
        pose = np.array([point[0] - 0.5 * math.cos(0.3), point[1] - 0.5 * math.sin(0.3), 0.3])
        assert slot.gap(np.zeros(3), pose, 0.0)[0] == pytest.approx(0.25, abs=1e-15)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_loop_closes_in_both_branches(shape: SliderCrank) -> None:
    for each in (shape, replace(shape, branch=-shape.branch)):
        beta = each.rod_angle(THETA)
        assert np.abs(each.crank * np.sin(THETA) + each.rod * np.sin(beta) - each.offset).max() < 1e-14
        assert np.abs(each.crank * np.cos(THETA) + each.rod * np.cos(beta) - each.position(THETA)).max() < 1e-14
        assert np.all(np.sign(np.cos(beta)) == each.branch)


@pytest.mark.parametrize("shape", [*SHAPES, SliderCrank(0.3, 1.0, 0.2, -1)])
def test_the_slider_stands_still_at_the_dead_centres_and_the_stroke_lies_between(shape: SliderCrank) -> None:
    stretched, folded = (shape.position(np.array(angle)) for angle in shape.dead_centres())
    assert np.abs(shape.rates(np.array(shape.dead_centres()))[1]).max() < 1e-13
    assert abs(abs(stretched - folded) - shape.stroke()) < 1e-14
    fine = shape.position(np.linspace(0, 2 * math.pi, 200_001))
    assert abs(np.ptp(fine) - shape.stroke()) < 1e-8  # a grid misses an extremum by the square of its spacing
    assert abs(abs(stretched) - math.sqrt((shape.rod + shape.crank) ** 2 - shape.offset**2)) < 1e-14


@pytest.mark.parametrize("scene", [DrivenSliderCrank(), DrivenSliderCrank(offset=-0.3, branch=-1, rate=-4.0)])
def test_the_drive_does_the_work_that_the_energy_gains(scene: DrivenSliderCrank) -> None:
    t, names = np.linspace(0, scene.duration, 4001), scene.mechanism().row_names
    motion = scene.motion(t)
    work = np.trapezoid(motion.reaction[:, names.index("drive torque")] * scene.rate, t)
    total = energy(scene.mechanism(), motion)
    assert abs(work - (total[-1] - total[0])) < 1e-5  # trapezoids of a smooth function
    assert np.abs(motion.reaction[:, names.index("level torque")]).max() < 1e-12


def test_bad_slider_cranks_are_refused() -> None:
    for offset in (0.7, 0.8, -0.75):
        with pytest.raises(InvalidMechanism, match="offset is"):
            DrivenSliderCrank(offset=offset)


@pytest.mark.parametrize("angle", [1e-5, 1.0])
def test_a_slider_leaves_its_dead_centre_when_its_energy_says(angle: float) -> None:
    """The time to an angle is a quadrature, t = int sqrt(J / 2 (V_0 - V)) dtheta, here without any difference of nearly
    equal numbers: with theta = theta_0 cosh(u), what the start's millionth of a radian loses is nothing.
    """
    scene = SliderAtDeadCentre()
    crank, rod, at_start = scene.crank, scene.rod, scene.angle

    def root(theta: float) -> float:
        return math.sqrt(rod**2 - (crank * math.sin(theta)) ** 2)

    def inertia(theta: float) -> float:
        turn = -crank * math.cos(theta) / root(theta)
        slide = crank * math.sin(theta) * (turn - 1)
        centre = ((slide - crank * math.sin(theta)) / 2) ** 2 + (crank * math.cos(theta) / 2) ** 2
        own = scene.crank_mass * crank**2 / 3 + scene.rod_mass * (centre + (rod * turn) ** 2 / 12)
        return own + scene.slider_mass * slide**2

    def integrand(u: float) -> float:
        theta, apart, mean = (at_start * part for part in (math.cosh(u), math.sinh(u / 2) ** 2, math.cosh(u / 2) ** 2))
        fallen = crank * 2 * math.sin(mean) * math.sin(apart)  # of the crank pin, cos(theta_0) - cos(theta)
        back = crank**2 * math.sin(2 * mean) * math.sin(2 * apart) / (root(at_start) + root(theta))
        moments = (
            (scene.crank_mass + scene.rod_mass) * fallen,
            (scene.rod_mass + 2 * scene.slider_mass) * (fallen + back),
        )
        work = scene.gravity * sum(moments) / 2
        return at_start * math.sinh(u) * math.sqrt(inertia(theta) / (2 * work))

    ends = np.linspace(0.0, math.acosh(angle / at_start), 9)
    time = sum(quad(integrand, low, high, epsabs=0, epsrel=1e-13)[0] for low, high in pairwise(ends))
    # An angle that grows by a factor e in 0.09 s: of the time's rounding it shows tenfold.
    assert scene.motion([time]).pose[0, 0, 2] == pytest.approx(angle, rel=1e-12, abs=0)
