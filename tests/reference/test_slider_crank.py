"""The slider-crank: formulas against complex derivatives, forces against the Mechanism, time against a quadrature."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from reference.checks import InvalidMechanism
from reference.joints import Slot
from reference.scenes.slider_crank.linkage import SliderCrank
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank, SliderAtDeadCentre
from reference.trajectory import energy, joint_gap, slip

STEP = 1e-30
THETA = np.linspace(0, 2 * math.pi, 37)
SHAPES = [SliderCrank(0.3, 1.0), SliderCrank(0.3, 1.0, 0.2), SliderCrank(0.5, 0.9, -0.3, -1), SliderCrank(1.0, 1.01)]
SCENES = [
    DrivenSliderCrank(),
    DrivenSliderCrank(offset=-0.3, branch=-1, rate=-4.0),
    FreeSliderCrank(),
    FreeSliderCrank(offset=0.2, rate=3.0, branch=-1),
]


def test_a_slot_row_is_the_derivative_of_its_gap() -> None:
    generator = np.random.default_rng(3)
    slot = Slot("guide", "a", "b", tuple(generator.normal(size=2)), 0.7, tuple(generator.normal(size=2)))
    poses = generator.normal(size=6)
    rows = slot.rows(poses[:3], poses[3:])[0]
    for column in range(6):
        moved = poses.astype(complex)
        moved[column] += 1j * STEP
        assert abs(slot.gap(moved[:3], moved[3:], 0.0)[0].imag / STEP - rows[column]) < 1e-15


def test_a_slot_gap_is_the_distance_from_the_line_and_ignores_sliding() -> None:
    slot = Slot("guide", None, "b", (1.0, 2.0), math.pi / 6, (0.5, 0.0))
    along, left = np.array([math.cos(math.pi / 6), 0.5]), np.array([-0.5, math.cos(math.pi / 6)])
    for slide in (-3.0, 0.0, 2.0):
        point = np.array([1.0, 2.0]) + slide * along + 0.25 * left
        pose = np.array([point[0] - 0.5 * math.cos(0.3), point[1] - 0.5 * math.sin(0.3), 0.3])
        assert slot.gap(np.zeros(3), pose, 0.0)[0] == pytest.approx(0.25, abs=1e-15)
    with pytest.raises(InvalidMechanism, match="line_angle"):
        Slot("guide", None, "b", (0.0, 0.0), math.nan, (0.0, 0.0))


@pytest.mark.parametrize("shape", SHAPES)
def test_rates_are_derivatives_of_the_positions(shape: SliderCrank) -> None:
    turn, slide = shape.rates(THETA)
    scale = np.abs(slide).max()
    assert np.abs(shape.position(THETA + 1j * STEP).imag / STEP - slide).max() < 1e-13 * scale
    along = -shape.crank * np.sin(THETA) - shape.rod * np.sin(shape.rod_angle(THETA)) * turn
    assert np.abs(along - slide).max() < 1e-13 * scale


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


def test_the_in_line_stroke_is_twice_the_crank() -> None:
    assert SliderCrank(0.3, 1.0).stroke() == pytest.approx(0.6, abs=1e-15)


@pytest.mark.parametrize("scene", SCENES)
def test_the_truth_satisfies_the_mechanism(scene: DrivenSliderCrank) -> None:
    mechanism = scene.mechanism()
    freedoms = 0 if scene.driven else 1
    assert mechanism.degrees_of_freedom() == (freedoms, freedoms)
    t = np.linspace(0, scene.duration, 101)
    motion = scene.motion(t)
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-14
    assert np.abs(slip(mechanism, motion)).max() < 1e-13
    assert np.all(scene.branch_of(motion.pose) == scene.branch)
    pose, twist, change = scene.placement(t)
    left = (mechanism.rows(pose) @ change.reshape(len(t), -1, 1))[..., 0]
    assert np.abs(left - mechanism.bias(pose, twist)).max() < 1e-12 * max(1, np.abs(change).max())
    # Newton's law with the reactions; for the free one this proves the reduced equation of motion.
    force = (np.swapaxes(mechanism.rows(pose), -1, -2) @ motion.reaction[..., None])[..., 0]
    excess = (mechanism.inertias * (change - mechanism.free_fall)).reshape(len(t), -1)
    assert np.abs(force - excess).max() < 1e-11 * np.abs(excess).max()


@pytest.mark.parametrize("scene", SCENES[:2])
def test_the_drive_does_the_work_that_the_energy_gains(scene: DrivenSliderCrank) -> None:
    t, names = np.linspace(0, scene.duration, 4001), scene.mechanism().row_names
    motion = scene.motion(t)
    work = np.trapezoid(motion.reaction[:, names.index("drive torque")] * scene.rate, t)
    total = energy(scene.mechanism(), motion)
    assert abs(work - (total[-1] - total[0])) < 1e-5  # trapezoids of a smooth function
    assert np.abs(motion.reaction[:, names.index("level torque")]).max() < 1e-12


def test_a_rod_too_long_is_caught() -> None:
    scene = DrivenSliderCrank()
    longer = replace(scene, rod=1.001).motion(np.linspace(0, scene.duration, 11))
    assert np.abs(joint_gap(scene.mechanism(), longer)).max() > 1e-4


@pytest.mark.parametrize("scene", SCENES[2:])
def test_the_free_motion_conserves_energy_and_shows_its_error(scene: FreeSliderCrank) -> None:
    t = np.linspace(0, scene.duration, 201)
    total = energy(scene.mechanism(), scene.motion(t))
    assert np.ptp(total) < 1e-12 * np.abs(total).max()
    assert scene.truth_error(t).max() < 1e-9


def test_the_free_motion_takes_the_time_that_energy_says() -> None:
    """dt = dtheta sqrt(J / 2(E - V)): a quadrature that integrates no equation of motion."""
    scene = FreeSliderCrank()
    masses = scene.mechanism().inertias.reshape(-1)

    def reduced(theta: float) -> tuple[float, float]:
        pose, tangent = scene.tangent(np.array([theta]))
        return float(masses @ tangent[:, 0] ** 2), float(scene.gravity * masses[::3] @ pose[:, 1])

    inertia, potential = reduced(scene.angle)
    total = inertia * scene.rate**2 / 2 + potential

    def slowness(theta: float) -> float:
        inertia, potential = reduced(theta)
        return math.sqrt(inertia / (2 * (total - potential)))

    for end in (1.0, 1.7):
        theta = float(scene.states([end])[0][0, 0])
        edges = np.linspace(scene.angle, theta, 21)
        time = sum(quad(slowness, a, b, epsabs=1e-14, epsrel=1e-14)[0] for a, b in pairwise(edges))
        assert abs(time - end) < 1e-11


def test_bad_slider_cranks_are_refused() -> None:
    for offset in (0.7, 0.8, -0.75):
        with pytest.raises(InvalidMechanism, match="offset is"):
            DrivenSliderCrank(offset=offset)
    wrong: dict[str, Any]
    for wrong in ({"crank": 0.0}, {"rod": math.nan}, {"slider_mass": 0.0}, {"branch": 0}, {"rate": math.inf}):
        with pytest.raises(InvalidMechanism, match=next(iter(wrong))):
            DrivenSliderCrank(**wrong)


@pytest.mark.parametrize("angle", [1e-5, 1e-3, 1.0, 4.0])
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
