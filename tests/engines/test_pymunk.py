"""Tests of the pymunk adapter: models, refusals, rolls by contacts and pivots, skates by grooves, declared orders.

`test_matrix` tests the errors and orders of each method in motion.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pymunk
import pytest
from numpy.typing import NDArray

from engines import Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, bare_loop, methods
from engines.pymunk.joints.roll import MovedPivot
from engines.pymunk.methods import SKATE_METHODS
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line, Placed, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingDisc, RollingEllipse, RollingOnCircle
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.trajectory import Trajectory
from tests.mechanisms import elbow, four_bar, rolling_disc

FREE, MOVING, DRIVEN = four_bar(), four_bar(10.0), four_bar(10.0, drive=10.0)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)


def largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values).max())


def test_the_default_settings_are_those_of_pymunk():
    assert DEFAULT.iterations == 10
    assert DEFAULT.error_bias == pytest.approx(0.9**60, rel=1e-5)  # pymunk rounds 0.1.


def test_prescribed_motions_need_no_constraints():
    # The crank and the angle of the block are prescribed. Only pins and a groove are constraints.
    for mechanism, rows in ((FREE, 8), (DRIVEN, 6), (DrivenSliderCrank().mechanism(), 5)):
        for method in (DEFAULT, EXTENDED):
            assert method.build(mechanism, 1e-3).size == Size(3, 9, rows, rows)
    assert DEFAULT.build(elbow(), 1e-3).size == Size(bodies=2, coordinates=6, rows=5, solver_rows=5)


@pytest.mark.parametrize("grounded_first", [True, False])
def test_a_crank_turns_about_its_pin_whichever_body_is_first(grounded_first):
    centre, rate, own_point = np.array([2.0, -1.0]), -3.0, (0.3, 0.1)
    angle = 0.7
    arm = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ own_point
    position, velocity = centre - arm, -rate * np.array([-arm[1], arm[0]])
    (x, y), (along, up) = map(float, position), map(float, velocity)
    body = Body("crank", 2.0, 0.5, (x, y, angle), (along, up, rate))
    joints = (
        (Pin("A", None, "crank", (2.0, -1.0), own_point), Drive("drive", None, "crank", rate, angle))
        if grounded_first
        else (Drive("drive", "crank", None, -rate, -angle), Pin("A", "crank", None, own_point, (2.0, -1.0)))
    )
    mechanism = Mechanism((body,), joints, (0.0, -9.81))
    for method in METHODS:
        trajectory = method.build(mechanism, 1e-2)(30, 3)
        # The bound is rounding. The angle is a sum of at most 720 steps, and extrapolation amplifies rounding up to
        # 100-fold.
        assert largest(mechanism.gap(trajectory.pose, trajectory.t)) < 1e-12
        assert largest(mechanism.slip(trajectory.pose, trajectory.twist)) < 1e-12
        # The pin carries weight and centripetal force. The drive carries the moment of the weight about the pin.
        swing = trajectory.pose[:, 0, :2] - centre
        sign = 1 if grounded_first else -1
        order = [0, 1, 2] if grounded_first else [1, 2, 0]
        force = sign * 2.0 * (-(rate**2) * swing + [0, 9.81])
        torque = sign * 2.0 * 9.81 * swing[:, 0]
        error = np.abs(trajectory.reaction[:, order] - np.column_stack([force, torque]))
        assert error[1:].max() < 1e-9  # This is rounding.
        # The first reaction is the reaction of the third step, at which the angle differs by 0.09 rad. LEAPFROG
        # extrapolates the reaction from the third and fourth steps, with an error of 6 (rate dt)^2. EXTENDED
        # extrapolates the reaction to step zero.
        assert error[0].max() < {DEFAULT: 0.09, TUNED: 0.09, LEAPFROG: 6e-3, EXTENDED: 1e-9}[method] * 2.0 * 9.81


@every_method
def test_an_unstable_motion_raises_no_exception(method):
    heavy = replace(MOVING, bodies=(*MOVING.bodies[:2], replace(MOVING.bodies[2], mass=1e-6, inertia=1e-9)))
    trajectory = method.build(heavy, 1e200)(20, 2)
    assert trajectory.pose.shape == (21, 3, 3)
    assert not np.all(np.isfinite(trajectory.pose))
    assert np.all(np.isnan(trajectory.reaction[~np.all(np.isfinite(trajectory.pose), axis=(1, 2))]))


def thrown(mass: float | None = None) -> Mechanism:
    """A sleigh with a velocity whose square overflows. With `mass`, two links with an extreme ratio of masses."""
    if mass is None:
        sled = ChaplyginSleigh().mechanism()
        return replace(sled, bodies=(replace(sled.bodies[0], twist=(1e150, 0.0, 0.0)),))
    links = LinkPendulum().mechanism()
    return replace(links, bodies=(links.bodies[0], replace(links.bodies[1], mass=mass, inertia=mass)))


@pytest.mark.parametrize(
    ("methods", "wild", "step"),
    [
        (METHODS, RollingEllipse().mechanism(), 1e200),
        (METHODS, RollingOnCircle().mechanism(), 1e200),
        (SKATE_METHODS, thrown(), 1e200),
        (METHODS[:3], thrown(1e-300), 1e-3),
        (METHODS[:2], thrown(1e300), 1e-3),
    ],
    ids=["ellipse", "hill", "sleigh", "light", "heavy"],
)
def test_an_unstable_motion_of_contacts_blades_or_extreme_masses_raises_no_exception(methods, wild, step):
    for method in methods:
        with np.errstate(all="ignore"):
            assert method.build(wild, step)(5, 2).pose.shape == (6, len(wild.bodies), 3)


@pytest.mark.parametrize(("engine", "levels"), [(TUNED, (1,)), (Extrapolated(TUNED, "two", (1, 3), (1,)), (1, 3))])
def test_the_bare_loop_makes_all_steps_of_a_run(engine, levels, monkeypatch):
    steps = []
    monkeypatch.setattr("engines.pymunk.repeat", lambda _, count: steps.append(count) or range(count))
    bare_loop(engine, FREE, 1e-4, 20)
    assert steps == [20 * level for level in levels]


ELLIPSE, DISC, HILL = RollingEllipse(), RollingDisc(), RollingOnCircle()
SLEIGH = ChaplyginSleigh()


def run(engine, scene: Scene, every: int) -> Trajectory:
    return engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)


@cache
def truth(scene: Scene) -> Trajectory:
    return scene.motion(np.arange(scene.samples + 1) * scene.spacing)


def angle_error(engine, scene: Scene, every: int) -> float:
    return largest(run(engine, scene, every).pose[..., 2] - truth(scene).pose[..., 2])


def test_a_pivot_is_placed_at_the_contact_after_the_drift_of_two_bodies():
    """The anchors are the same as for bodies that start at the poses after the drift."""
    joint = next(joint for joint in EllipticGears().mechanism().joints if isinstance(joint, Roll))

    def anchors(ahead: float, elapsed: float) -> list[float]:
        bodies = [pymunk.Body(1.0, 1.0) for _ in range(2)]
        for body, angle, rate in zip(bodies, (0.3, -0.4), (2.0, -1.5), strict=True):
            body.angle, body.angular_velocity = angle + elapsed * rate, rate
        pivot = MovedPivot(joint, bodies[0], bodies[1], ((0.0, 0.0), (0.0, 0.0)))
        pivot(ahead)
        return [*pivot.constraint.anchor_a, *pivot.constraint.anchor_b]

    assert anchors(0.1, 0.0) == pytest.approx(anchors(0.0, 0.1))
    assert anchors(0.1, 0.0) != pytest.approx(anchors(0.0, 0.0), rel=1e-3)


def test_the_error_of_a_polygon_falls_with_its_corners_and_not_with_the_step():
    plateaus = {}
    for vertices in (8, 32, 128, 512):
        engine = replace(methods.ROLL_POLYGON, contact=replace(methods.UNCORRECTED_OVERLAP, vertices=vertices))
        coarse, fine = (angle_error(engine, ELLIPSE, every) for every in (10, 30))
        plateaus[vertices] = fine
        if vertices == 128:
            assert fine == pytest.approx(coarse, rel=0.1)  # The step has little effect.
    assert plateaus[8] > plateaus[32] > plateaus[128] > plateaus[512] > 0.03
    assert plateaus[512] < 0.2


def test_a_round_body_leaves_the_hill_where_the_contact_force_becomes_zero():
    trajectory = run(TUNED, HILL, 30)
    gap = np.abs(HILL.mechanism().gap(trajectory.pose, trajectory.t))[:, 1]
    assert HILL.hop is not None
    before, after = trajectory.t < HILL.hop - 0.02, trajectory.t > HILL.hop + 0.1
    assert gap[before].max() < 2e-3
    assert gap[after].min() > 2e-3


def side_by_side(places, rates) -> Mechanism:
    """Discs that roll on the same straight ground. Every disc has a separate contact."""
    pairs = [
        rolling_disc(Rolling.at_angle(Circle(0.4), Line(through=(place, 0.0)), 0.0, 0.0), rate, f"disc {place}")
        for place, rate in zip(places, rates, strict=True)
    ]
    bodies, joints = zip(*pairs, strict=True)
    return Mechanism(bodies, joints, (0.0, -9.81))


def test_shapes_of_different_rolls_do_not_collide():
    for engine in METHODS:
        trajectory = engine.build(side_by_side((0.0, 0.4), (1.0, 2.0)), 1e-3)(10, 10)
        assert largest(trajectory.twist[:, :, 2] - [1.0, 2.0]) < 1e-2
        assert largest(trajectory.twist[:, :, 0] + [0.4, 0.8]) < 1e-2


def test_thirty_two_contacts_are_built_and_one_more_is_refused():
    assert DEFAULT.build(side_by_side(range(32), [0.0] * 32), 1e-3).size.rows == 64
    with pytest.raises(Unsupported, match="has 32 categories, one for each roll"):
        DEFAULT.build(side_by_side(range(33), [0.0] * 33), 1e-3)


def test_a_scaled_ellipse_turns_by_the_same_angles():
    """Lengths and gravity have the same factor. A constant thickness of the ground would cause an error of 1 rad."""
    scale = 1e5
    x, y = ELLIPSE.gravity
    large = replace(ELLIPSE, along_x=scale * 0.5, along_y=scale * 0.3, gravity=(scale * x, scale * y))
    own, other = (run(TUNED, scene, 10).pose[..., 2] for scene in (ELLIPSE, large))
    assert (ELLIPSE.along_x, ELLIPSE.along_y) == (0.5, 0.3)
    assert largest(own - other) < 1e-10


def test_a_run_ends_with_a_warning_where_the_curves_lose_contact():
    """A disc rolls over the end of a flat side. Beyond this end the curves have no contact for the pivot."""
    rolling = Rolling.at_arcs(Circle(0.4), Placed(Side(1.0), turn=math.pi), 0.0, 0.0)
    disc, roll = rolling_disc(rolling, 4.0)
    mechanism = Mechanism((disc,), (roll,))
    trajectory = LEAPFROG.build(mechanism, 1e-2)(50, 1)
    is_finite = np.isfinite(trajectory.pose[:, 0, 0])
    # The disc rolls at 1.6 m/s, and the distance of the corner is 0.5 m.
    assert trajectory.t[is_finite].max() == pytest.approx(0.5 / 1.6, abs=0.02)
    assert largest(trajectory.pose[is_finite, 0, 2] - disc.pose[2] - 4.0 * trajectory.t[is_finite]) < 1e-9
    assert any("could no longer be placed" in warning for warning in trajectory.warnings)


@pytest.mark.parametrize("step", [1e-3, 3e-4])
def test_the_first_force_of_a_contact_is_converged(step):
    run, truth = TUNED.build(DISC.mechanism(), step)(1, 1), DISC.motion(np.array([0.0]))
    # The error has order 1 and is 1.4e-3 of the force at a step of 1 ms. With five iterations the error would be half
    # of the force.
    assert largest(run.reaction[0] - truth.reaction[0]) < 3e-3 * largest(truth.reaction[0])


# Skates


def test_the_groove_of_a_blade_corrects_no_gap_and_adds_no_noise():
    # If a step of 1e-4 s corrected a rounding gap of 1e-16 m, reactions would change by 1e-6 N. Without this correction
    # the error is 2e-10 N.
    scene = ChaplyginSleigh(duration=3.0, horizon=3.0)
    trajectory = methods.SKATE_GROOVE_EXTRAPOLATED.build(scene.mechanism(), 1e-3)(100, 30)
    right = scene.motion(trajectory.t)
    assert largest(trajectory.reaction - right.reaction) < 1e-8
    assert largest(trajectory.twist - right.twist) < 1e-11
