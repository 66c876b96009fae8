"""Rolling in MuJoCo: by contact as it comes and as it can be, by constraints, and where each of them ends."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.joints.roll import RollContact
from engines.mujoco.methods import ROLLS
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
    RollingScene,
)
from reference.trajectory import Trajectory

ELLIPSE, DISC = RollingEllipse(), RollingDisc()
(EULER,) = ROLLS


def run(engine: MuJoCo, scene: Any, dt: float) -> tuple[Trajectory, Trajectory]:
    every = max(1, round(scene.spacing / dt))
    motion = engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)
    return motion, scene.motion(motion.t)


def angle_error(engine: MuJoCo, scene: Any, dt: float) -> float:
    motion, truth = run(engine, scene, dt)
    return float(np.abs(motion.pose - truth.pose)[..., 2].max())


def disc_in_ring(clearance: float, rate: float = 1.0) -> Mechanism:
    """A disc smaller than its ring by this part of it, without gravity: it turns steadily, as its arm is fixed."""
    rolling = Rolling.at_angle(Circle(1 - clearance), Placed(Ring(1.0), turn=-math.pi / 2))
    x, y, angle = (float(value) for value in rolling.pose(0.0))
    vx, vy = (float(value) for value in rolling.velocity(0.0, rate))
    disc = Body("disc", 1.0, (1 - clearance) ** 2 / 2, (x, y, angle), (vx, vy, rate))
    return Mechanism((disc,), (Roll("contact", None, "disc", rolling),), (0.0, 0.0))


# Rows


def test_an_ellipse_that_is_a_thousandth_longer_would_be_noticed() -> None:
    motion, truth = run(EXTENDED, replace(ELLIPSE, along_x=ELLIPSE.along_x * 1.001), dt=5e-3)[0], ELLIPSE
    assert np.abs(motion.pose - truth.motion(motion.t).pose)[..., 2].max() > 1e-4


@pytest.mark.parametrize("coordinates", ["tree", "free"])
def test_two_moving_bodies_roll_on_each_other(coordinates: Any) -> None:
    gears = EllipticGears(duration=1.0)
    motion, truth = run(replace(EXTENDED, coordinates=coordinates), gears, dt=1e-3)
    known = np.isfinite(truth.reaction)
    assert np.abs(motion.pose - truth.pose).max() < 1e-8
    assert np.abs(motion.reaction - truth.reaction)[known].max() < 1e-5
    assert motion.warnings == ()


# Contact


def test_contact_as_shipped_is_off_by_hundredths_of_a_radian_whatever_the_step() -> None:
    coarse, fine = (angle_error(DEFAULT, ELLIPSE, dt) for dt in (1e-3, 2.5e-4))
    # A time constant of 0.02 s lets the contact sink and lag by some millimetres.
    assert fine > 0.02
    assert 0.7 < fine / coarse < 1.4


@pytest.mark.parametrize("scene", [ELLIPSE, DISC], ids=lambda scene: scene.name)
def test_contact_well_set_converges_with_the_first_power_of_the_step(scene: RollingScene) -> None:
    coarse, fine = (angle_error(TUNED, scene, dt) for dt in (1e-3, 1e-4))
    # A factor 10 of steps; the contact comes and goes, so the error jitters by some tens of a percent.
    assert 5 < coarse / fine < 20


@pytest.mark.parametrize(("cone", "rates"), [("pyramidal", {20.0}), ("elliptic", {20.0, 500.0})])
def test_upstream_friction_has_a_rate_of_its_own_in_the_elliptic_cone_only(cone: str, rates: set[float]) -> None:
    model = mujoco.MjModel.from_xml_string(
        f"""
        <mujoco>
          <option cone="{cone}"/>
          <worldbody>
            <geom name="ground" type="plane" size="1 1 1"/>
            <body pos="0 0 0.0999"><freejoint/><geom name="ball" size="0.1"/></body>
          </worldbody>
          <contact>
            <pair geom1="ground" geom2="ball" condim="3" solref="-100 -20" solreffriction="-1e-9 -500"/>
          </contact>
        </mujoco>
        """
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # MuJoCo divides both dampings by dmax, 0.95 as shipped.
    assert set(np.round(data.efc_KBIP[:, 1] * 0.95, 9)) == rates


@pytest.mark.parametrize("engine", [DEFAULT, TUNED], ids=lambda engine: engine.variant)
def test_reactions_by_newtons_law_are_the_contacts_forces(engine: MuJoCo) -> None:
    built = engine.build(RollingDownhill().mechanism(), 1e-3)
    motion = built(3, 10)
    force = np.zeros(6)  # in the contact's frame: normal first, from the ground to the body
    mujoco.mj_contactForce(built.model.compiled, built.data, 0, force)
    tangent, normal = motion.reaction[-1]
    # The reading leaves the last sample behind. Directions agree to the slip of 1e-3 m, that is 1e-3 rad.
    assert normal == pytest.approx(force[0], rel=5e-3)
    assert abs(tangent) == pytest.approx(float(np.hypot(force[1], force[2])), abs=5e-3 * normal)


def test_a_cylinder_rolls_as_a_sphere_does_with_twice_the_rows() -> None:
    sphere = EULER
    cylinder = replace(EULER, rolls=replace(EULER.rolls, round_shape="cylinder"))  # type: ignore[type-var]
    assert cylinder.build(DISC.mechanism(), 1e-3).size.solver_rows == 6
    one, two = (angle_error(engine, DISC, dt=1e-3) for engine in (sphere, cylinder))
    assert one == pytest.approx(two, rel=0.1)


def test_a_model_has_the_rows_that_rolling_needs() -> None:
    rows = {"default": 4, "tuned": 3, "extended": 2, EULER.variant: 3}
    for engine in (DEFAULT, TUNED, EXTENDED, *ROLLS):
        size = engine.build(DISC.mechanism(), 1e-3).size
        assert (size.bodies, size.coordinates, size.rows) == (1, 3, 2)
        # A contact has a normal row and two of friction, of which one points out of the plane and is empty, or four
        # edges of a pyramid.
        assert size.solver_rows == rows[engine.variant]


# Where methods end


def test_beyond_the_hop_and_only_there_real_contact_parts_from_the_ideal_one() -> None:
    hill = RollingOnCircle()
    assert hill.hop is not None
    motion, truth = run(TUNED, hill, dt=1e-3)
    error = np.abs(motion.pose - truth.pose)[:, 0, :2].max(axis=1)
    # MuJoCo's friction cone presses the body on where friction is asked of a vanishing normal force: some 0.06 s.
    assert error[motion.t < hill.hop].max() < 2e-3
    assert error[-1] > 0.05
    assert any("was lost" in warning for warning in motion.warnings)
    ideal, truth = run(EXTENDED, hill, dt=1e-3)
    assert np.abs(ideal.pose - truth.pose).max() < 1e-8
    assert ideal.warnings == ()


def test_too_little_friction_slips() -> None:
    slippery = replace(TUNED, rolls=RollContact(friction=0.2, steps=2.0, stick=True, cone="elliptic"))
    motion, truth = run(slippery, ELLIPSE, dt=1e-3)
    slip = ELLIPSE.motion_law.slip(0.2, ELLIPSE.duration)
    assert slip is not None
    error = np.abs(motion.pose - truth.pose)[:, 0, 2]
    assert error[motion.t < slip].max() < 3e-3  # of first order, as with much friction
    assert error[-1] > 0.05


def test_a_nearly_conformal_contact_is_followed_until_it_turns_by_a_tenth_of_a_radian_a_step() -> None:
    for step, error, doubted in ((2e-4, 1e-8, False), (5e-4, 1e-6, False), (4e-3, 1e-2, True)):
        motion = EXTENDED.build(disc_in_ring(0.01), step)(20, round(0.02 / step))
        assert np.abs(motion.pose[:, 0, 2] - motion.t).max() < error
        assert any("along its curves" in warning for warning in motion.warnings) == doubted
    lost = EXTENDED.build(disc_in_ring(1e-4), 2e-3)(20, 10)
    assert any("along its curves" in warning for warning in lost.warnings)
    assert not np.abs(lost.pose[:, 0, 2] - lost.t).max() < 1e-2


def test_a_body_that_reaches_a_corner_ends_the_run() -> None:
    rolling = Rolling.at_angle(Circle(0.1), Placed(Side(0.4), turn=math.pi))
    x, y, angle = (float(value) for value in rolling.pose(0.0))
    vx, vy = (float(value) for value in rolling.velocity(0.0, 4.0))
    disc = Body("disc", 1.0, 0.005, (x, y, angle), (vx, vy, 4.0))
    motion = EXTENDED.build(Mechanism((disc,), (Roll("contact", None, "disc", rolling),)), 1e-3)(60, 10)
    # At 4 rad/s the end of the side, 0.2 m away, comes after half a second.
    assert motion.reset_at == pytest.approx(0.5, abs=2e-3)
    assert np.all(np.isfinite(motion.pose[motion.t < 0.495]))
    assert np.all(np.isnan(motion.pose[motion.t > 0.505]))


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EULER], ids=lambda engine: engine.variant)
def test_shapes_that_mujoco_lacks_are_refused_with_a_sentence(engine: MuJoCo) -> None:
    with pytest.raises(Unsupported, match="no shape like a cam"):
        engine.build(RollingCam().mechanism(), 1e-3)
    with pytest.raises(Unsupported, match="no hollow side"):
        engine.build(RollingInRing().mechanism(), 1e-3)


def test_what_a_construction_can_not_do_is_refused_with_a_sentence() -> None:
    rolling = Rolling.at_arcs(Circle(0.1), Line())
    plank = Body("plank", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    disc = Body("disc", 1.0, 0.005, tuple(map(float, rolling.pose(rolling.theta))), (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    with pytest.raises(Unsupported, match="planes are fixed to the ground"):
        DEFAULT.build(Mechanism((plank, disc), (Roll("contact", "plank", "disc", rolling),)), 1e-3)


def test_settings_without_meaning_are_refused() -> None:
    for bad in (
        lambda: RollContact(friction=0.0),
        lambda: RollContact(steps=math.nan),
    ):
        with pytest.raises(ValueError, match="greater than zero"):
            bad()
    with pytest.raises(ValueError, match="elliptic cone only"):
        RollContact(stick=True)
    with pytest.raises(ValueError, match="rolls is"):
        MuJoCo("bad", rolls="contact")  # type: ignore[arg-type]
