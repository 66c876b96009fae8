"""Rolling in pymunk: by a moved pivot and by contact; what each reaches and where it stops."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from engines import Unsupported
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, Contact, Pymunk, methods
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line, Placed, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
)
from reference.trajectory import Trajectory

ELLIPSE, DISC, RING, HILL = RollingEllipse(), RollingDisc(), RollingInRing(), RollingOnCircle()
SCENES = (ELLIPSE, DISC, RING, HILL, RollingCam(), RollingDownhill())
every_scene = pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)


def largest(values) -> float:
    return float(np.abs(values).max())


def run(engine, scene: Scene, every: int) -> Trajectory:
    return engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)


@cache
def truth(scene: Scene) -> Trajectory:
    return scene.motion(np.arange(scene.samples + 1) * scene.spacing)


def angle_error(engine, scene: Scene, every: int) -> float:
    return largest(run(engine, scene, every).pose[..., 2] - truth(scene).pose[..., 2])


def order(engine, scene: Scene, every: int) -> float:
    coarse, fine = (angle_error(engine, scene, n) for n in (every, 4 * every))
    return float(np.log2(coarse / fine) / 2)


def roll_of(scene: Scene) -> Roll:
    return next(joint for joint in scene.mechanism().joints if isinstance(joint, Roll))


# By constraint


@every_scene
def test_extended_rolling_is_exact_to_rounding_with_forces(scene):
    trajectory = run(EXTENDED, scene, 3)
    exact = truth(scene)
    assert largest(trajectory.pose - exact.pose) < 1e-11
    mechanism = scene.mechanism()
    assert largest(mechanism.gap(trajectory.pose, trajectory.t)) < 1e-11
    missed = np.abs(trajectory.reaction - exact.reaction).max(axis=1) / largest(exact.reaction)
    # The first samples have what is left of the first steps, which is no series in the step.
    assert missed[:2].max() < 1e-6
    assert missed[2:].max() < 1e-8


@every_scene
def test_a_pivot_at_the_predicted_contact_is_of_second_order(scene):
    assert order(methods.ROLL_PIVOT, scene, 10) == pytest.approx(2, abs=0.2)  # in the ring the next power still shows


def test_two_gears_that_move_roll_on_each_other():
    scene = EllipticGears()
    trajectory = run(LEAPFROG, scene, 30)
    assert largest(trajectory.pose - truth(scene).pose) < 1e-3
    # Pins and contact say one thing twice (four rows for three freedoms); they are held together all the same.
    assert largest(scene.mechanism().gap(trajectory.pose, trajectory.t)) < 1e-3


def test_gears_that_both_turn_are_exact_to_a_tenth_of_a_nanometre():
    # 3e-11 here; 7e-10 if the contact is foreseen as on a ground that rests.
    assert largest(run(EXTENDED, EllipticGears(), 10).pose - truth(EllipticGears()).pose) < 1e-10


# By contact


def test_a_round_body_by_contact_is_of_first_order_whatever_the_settings():
    for engine in (DEFAULT, TUNED):
        assert order(engine, DISC, 10) == pytest.approx(1, abs=0.1)
    assert angle_error(DEFAULT, DISC, 100) < 6e-3  # rad at a tenth of a millisecond


def test_a_polygon_stays_away_from_the_ellipse_by_its_corners_however_small_the_step():
    plateaus = {}
    for engine in methods.ROLL_FACETED:
        coarse, fine = (angle_error(engine, ELLIPSE, every) for every in (10, 30))
        plateaus[engine.contact.vertices] = fine
        if engine.contact.vertices in (32, 128):
            assert fine == pytest.approx(coarse, rel=0.1)  # the step is not what is wrong
    assert plateaus[8] > plateaus[32] > plateaus[128] > plateaus[512] > 0.03
    assert plateaus[512] < 0.2


def test_upstream_on_ground_without_thickness_a_fine_polygon_stops_dead():
    """At some contact the wrong normal is found; on a segment with a radius, whose surface is the same, it never is."""
    fine = methods.ROLL_FACETED[-1]
    on_thin_ground = replace(fine, contact=replace(fine.contact, thickness=0.0))
    thin, thick = (run(engine, ELLIPSE, 10).twist[5, 0, 2] for engine in (on_thin_ground, fine))
    assert abs(thin) < 0.1
    assert thick == pytest.approx(truth(ELLIPSE).twist[5, 0, 2], rel=0.05)


def test_a_round_body_leaves_the_hill_where_the_contact_would_have_to_pull():
    trajectory = run(TUNED, HILL, 30)
    gap = np.abs(HILL.mechanism().gap(trajectory.pose, trajectory.t))[:, 1]
    assert HILL.hop is not None
    before, after = trajectory.t < HILL.hop - 0.02, trajectory.t > HILL.hop + 0.1
    assert gap[before].max() < 2e-3
    assert gap[after].min() > 2e-3


def test_low_friction_lets_the_body_slide():
    held = run(Pymunk("mine", contact=Contact()), DISC, 10)
    slides = run(Pymunk("mine", contact=Contact(friction=0.1)), DISC, 10)
    mechanism = DISC.mechanism()
    assert largest(mechanism.slip(held.pose, held.twist)[:, 0]) < 1e-6
    assert largest(mechanism.slip(slides.pose, slides.twist)[:, 0]) > 0.1


def test_a_hole_has_no_shape_and_is_refused_in_a_sentence():
    for engine in (DEFAULT, TUNED):
        with pytest.raises(Unsupported, match="a Ring is hollow"):
            engine.build(RING.mechanism(), 1e-3)


def test_shapes_of_different_contacts_do_not_see_each_other():
    """Two discs on one line, the second reaching half into the first: each rolls as if alone."""
    bodies, joints = [], []
    for name, rate, place in (("a", 1.0, 0.0), ("b", 2.0, 0.4)):
        disc = Rolling.at_angle(Circle(0.4), Line(through=(place, 0.0)), 0.0, 0.0)
        x, y, _ = (float(value) for value in disc.pose(0.0))
        bodies.append(Body(name, 1.0, 0.08, (x, y, 0.0), (-0.4 * rate, 0.0, rate)))
        joints.append(Roll(f"{name} rolls", None, name, disc))
    mechanism = Mechanism(tuple(bodies), tuple(joints), (0.0, -9.81))
    for engine in METHODS:
        trajectory = engine.build(mechanism, 1e-3)(10, 10)
        assert largest(trajectory.twist[:, :, 2] - [1.0, 2.0]) < 1e-2
        assert largest(trajectory.twist[:, :, 0] + [0.4, 0.8]) < 1e-2


def rolling_side_by_side(count: int) -> Mechanism:
    """Discs that roll on one straight ground, each with a contact of its own, a metre apart."""
    bodies, joints = [], []
    for number in range(count):
        disc = Rolling.at_angle(Circle(0.4), Line(through=(float(number), 0.0)), 0.0, 0.0)
        x, y, angle = (float(value) for value in disc.pose(0.0))
        bodies.append(Body(f"disc {number}", 1.0, 0.08, (x, y, angle)))
        joints.append(Roll(f"roll {number}", None, f"disc {number}", disc))
    return Mechanism(tuple(bodies), tuple(joints), (0.0, -9.81))


def test_thirty_two_contacts_are_told_apart_and_one_more_is_refused():
    assert DEFAULT.build(rolling_side_by_side(32), 1e-3).size.rows == 64
    with pytest.raises(Unsupported, match="tells 32 pairs apart"):
        DEFAULT.build(rolling_side_by_side(33), 1e-3)


@pytest.mark.parametrize("engine", [TUNED, methods.ROLL_FACETED[1]], ids=lambda engine: engine.variant)
def test_an_ellipse_a_hundred_thousand_times_as_large_turns_by_the_same_angles(engine):
    """In gravity as much stronger. Ground of a fixed thickness turns the tuned one by a radian otherwise."""
    scale = 1e5
    x, y = ELLIPSE.gravity
    large = replace(ELLIPSE, along_x=scale * 0.5, along_y=scale * 0.3, gravity=(scale * x, scale * y))
    own, other = (run(engine, scene, 10).pose[..., 2] for scene in (ELLIPSE, large))
    assert (ELLIPSE.along_x, ELLIPSE.along_y) == (0.5, 0.3)
    assert largest(own - other) < 1e-10


# What it refuses


@pytest.mark.parametrize(
    "given",
    [{"slop": -0.1}, {"slop": float("nan")}, {"bias": 1.5}, {"friction": -1.0}, {"vertices": 2}, {"thickness": -1.0}],
)
def test_contact_settings_that_would_abort_the_process_are_refused(given):
    with pytest.raises(ValueError, match=next(iter(given))):
        Contact(**given)


@pytest.mark.parametrize("engine", METHODS, ids=lambda each: each.variant)
@pytest.mark.parametrize("scene", [ELLIPSE, HILL], ids=lambda scene: scene.name)
def test_rolling_that_blows_up_is_a_result_and_not_an_exception(engine, scene):
    trajectory = engine.build(scene.mechanism(), 1e200)(10, 2)
    assert trajectory.pose.shape == (11, 1, 3)


def test_a_pair_that_cannot_roll_on_is_stopped_with_a_warning():
    """A flat side under a disc ends: beyond its corner there is no contact to aim a pivot at."""
    rolling = Rolling.at_arcs(Circle(0.4), Placed(Side(1.0), turn=math.pi), 0.0, 0.0)
    x, y, angle = (float(value) for value in rolling.pose(rolling.theta))
    vx, vy = (float(value) for value in rolling.velocity(rolling.theta, 4.0))
    disc = Body("disc", 1.0, 0.08, (x, y, angle), (vx, vy, 4.0))
    mechanism = Mechanism((disc,), (Roll("rolls", None, "disc", rolling),))
    for engine in (LEAPFROG, EXTENDED):
        trajectory = engine.build(mechanism, 1e-2)(50, 1)
        there = np.isfinite(trajectory.pose[:, 0, 0])
        # It rolls at 1.6 m/s and the corner is 0.5 m away.
        assert trajectory.t[there].max() == pytest.approx(0.5 / 1.6, abs=0.02)
        assert largest(trajectory.pose[there, 0, 2] - angle - 4.0 * trajectory.t[there]) < 1e-9
        assert any("could no longer be placed" in warning for warning in trajectory.warnings)


@pytest.mark.parametrize("step", [1e-3, 3e-4])
def test_the_first_force_of_a_contact_is_swept_until_its_points_agree(step):
    found, truth = TUNED.build(DISC.mechanism(), step)(1, 1), DISC.motion(np.array([0.0]))
    # First order in the step: 1.4e-3 of the force at a millisecond. With five sweeps a whole force is missing.
    assert largest(found.reaction[0] - truth.reaction[0]) < 3e-3 * largest(truth.reaction[0])
