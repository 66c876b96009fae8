"""Rolling in MuJoCo: by contact as it comes and as it can be, by constraints, and where each of them ends."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.joints.roll import CompletedContact, RollContact, RollEquality, RollRows, contact
from engines.mujoco.joints.roll.rows import roll_rows
from engines.mujoco.methods import ROLLS
from engines.rolling_table import rolled
from reference.mechanism import Body, Mechanism
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring, Side
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
EULER, EQUALITY, COMPLETED = ROLLS


@dataclass(frozen=True)
class EllipseOnHill(RollingEllipse):
    """Rocking on top of a round hill: convex on convex."""

    name: ClassVar[str] = "ellipse_on_hill"

    along_x: float = 0.25
    along_y: float = 0.2
    start_angle: float = math.pi / 2
    start_rate: float = 1.0
    duration: float = 0.6

    def ground_curve(self) -> Curve:
        return Placed(Circle(1.0), turn=math.pi / 2)


@dataclass(frozen=True)
class DiscOnEllipse(RollingDisc):
    """On top of an elliptic hill: of an ellipsoid and a sphere MuJoCo names the sphere first, though it is the body."""

    name: ClassVar[str] = "disc_on_ellipse"

    radius: float = 0.2
    eccentricity: float = 0.0
    start_rate: float = 1.0
    duration: float = 0.5

    def ground_curve(self) -> Curve:
        return Placed(Ellipse(0.8, 1.0), turn=math.pi / 2)


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


def test_written_rows_are_those_of_the_joint_and_its_velocity_term() -> None:
    gears = EllipticGears()
    roll = next(joint for joint in gears.mechanism().joints if isinstance(joint, Roll))
    mechanism = Mechanism(gears.mechanism().bodies, (roll,))
    law = roll_rows(rolled(roll.rolling), 100.0, 20.0)
    pose, twist, _ = gears.kinematics(np.linspace(0.0, 1.7, 12))
    # The joint's rows are along e_t and e_n, ours along x and y: the same two conditions, turned.
    contact = roll.rolling.contact(pose[:, 1, 2] - pose[:, 0, 2])
    angle = contact.tangent_angle + pose[:, 0, 2]
    for i in range(len(pose)):
        first, second = ((*pose[i, body].tolist(), *twist[i, body].tolist()) for body in (0, 1))
        ours = np.array(law(0.0, first, second))
        basis = np.array([[np.cos(angle[i]), np.sin(angle[i])], [np.sin(angle[i]), -np.cos(angle[i])]])
        # Exact motion has neither gap nor slip, so that only rounding times the gain of 100 / s^2 is added.
        assert np.abs(basis @ ours[:, :6] - mechanism.rows(pose[i])).max() < 1e-13
        assert np.abs(basis @ ours[:, 6] - mechanism.bias(pose[i], twist[i])).max() < 1e-11


@pytest.mark.parametrize("scene", [ELLIPSE, DISC, RollingCam(), RollingInRing()], ids=lambda scene: scene.name)
def test_rows_hold_rolling_to_a_billionth_at_a_millisecond(scene: RollingScene) -> None:
    motion, truth = run(EXTENDED, scene, dt=1e-3)
    mechanism = scene.mechanism()
    # Order 4: about (omega dt)^4 t = (7e-3)^4 * 2 rad = 5e-9 and less. Measured 1.3e-9 at most, in the ring; rounding
    # changes a thousandth of it, so that half as much again is room for another release.
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 2e-9
    assert np.abs(motion.reaction - truth.reaction).max() < 1e-6
    assert np.abs(mechanism.gap(motion.pose, motion.t)).max() < 1e-9
    assert np.abs(mechanism.slip(motion.pose, motion.twist)).max() < 1e-8
    assert motion.warnings == ()


@pytest.mark.parametrize("scene", [ELLIPSE, DISC], ids=lambda scene: scene.name)
def test_rows_hold_rolling_to_rounding_at_a_fifth_of_a_millisecond(scene: RollingScene) -> None:
    motion, truth = run(EXTENDED, scene, dt=2e-4)
    # 5^4 below a millisecond is 2e-12; a compliance of 1e-8 * 1e-4 / kg under 10 N leaves 1e-11 m/s^2, 1e-12 rad.
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 5e-12
    assert np.abs(motion.reaction - truth.reaction).max() < 5e-9


def test_rows_have_the_order_of_their_integrator() -> None:
    ratio = angle_error(EXTENDED, ELLIPSE, dt=2e-3) / angle_error(EXTENDED, ELLIPSE, dt=1e-3)
    assert 2**3.5 < ratio < 2**4.5


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
    # 3.4e-4 rad for the disc, of which a contact that comes or goes earlier changes some tens of a percent.
    assert fine < 5e-4
    # A factor 10 of steps; the contact comes and goes, so the error jitters by some tens of a percent.
    assert 5 < coarse / fine < 20


def test_a_joint_equality_lacks_the_velocity_term_and_so_is_of_first_order() -> None:
    coarse, fine = (angle_error(EQUALITY, DISC, dt) for dt in (2e-3, 5e-4))
    assert 3 < coarse / fine < 5
    # The gap is not what suffers: it falls as the square, because its time constant is two steps.
    gaps = []
    for dt in (2e-3, 5e-4):
        motion, _ = run(EQUALITY, DISC, dt)
        gaps.append(np.abs(DISC.mechanism().gap(motion.pose, motion.t))[:, 1].max())
    assert 10 < gaps[0] / gaps[1] < 20


@pytest.mark.parametrize("scene", [ELLIPSE, DISC, RollingDownhill()], ids=lambda scene: scene.name)
def test_real_contact_is_exact_once_its_velocity_term_is_added(scene: RollingScene) -> None:
    motion, truth = run(COMPLETED, scene, dt=1e-3)
    # As of written rows: 1.3e-9 rad for the disc.
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 2e-9
    assert np.abs(motion.reaction - truth.reaction).max() < 1e-6
    assert motion.warnings == ()
    ratio = angle_error(COMPLETED, scene, dt=2e-3) / angle_error(COMPLETED, scene, dt=1e-3)
    assert 2**3.4 < ratio < 2**4.6


def test_real_contact_without_the_term_is_wrong_by_a_millionfold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact, "_missing", lambda *_: lambda *_: 0j)
    # The missing acceleration of about 10 m/s^2 moves the contact by 10 / k, k = 1 / (0.04 s)^2: 16 mm.
    assert angle_error(COMPLETED, ELLIPSE, dt=1e-3) > 1e-3


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


def test_convex_on_convex_is_as_exact_as_the_search_for_their_contact() -> None:
    scene = EllipseOnHill()
    assert angle_error(COMPLETED, scene, dt=1e-3) < 1e-8
    assert angle_error(TUNED, scene, dt=1e-3) < 1e-3
    # The small disc turns five times as far for the same miss of the contact.
    assert angle_error(COMPLETED, DiscOnEllipse(), dt=1e-3) < 5e-8


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, COMPLETED], ids=lambda engine: engine.variant)
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
    rows = {"default": 4, "tuned": 3, "extended": 2, EULER.variant: 3, EQUALITY.variant: 2, COMPLETED.variant: 3}
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
    for engine, before in ((TUNED, 2e-3), (COMPLETED, 1e-8)):
        motion, truth = run(engine, hill, dt=1e-3)
        error = np.abs(motion.pose - truth.pose)[:, 0, :2].max(axis=1)
        # MuJoCo's friction cone presses the body on where friction is asked of a vanishing normal force: some 0.06 s.
        assert error[motion.t < hill.hop].max() < before
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


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EULER, COMPLETED], ids=lambda engine: engine.variant)
def test_shapes_that_mujoco_lacks_are_refused_with_a_sentence(engine: MuJoCo) -> None:
    with pytest.raises(Unsupported, match="no shape like a cam"):
        engine.build(RollingCam().mechanism(), 1e-3)
    with pytest.raises(Unsupported, match="no hollow side"):
        engine.build(RollingInRing().mechanism(), 1e-3)


def test_what_a_construction_can_not_do_is_refused_with_a_sentence() -> None:
    with pytest.raises(Unsupported, match="free body on the ground"):
        EQUALITY.build(EllipticGears().mechanism(), 1e-3)
    with pytest.raises(Unsupported, match="hangs on another body"):
        COMPLETED.build(EllipticGears().mechanism(), 1e-3)
    rolling = Rolling.at_arcs(Circle(0.1), Line())
    plank = Body("plank", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    disc = Body("disc", 1.0, 0.005, tuple(map(float, rolling.pose(rolling.theta))), (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    with pytest.raises(Unsupported, match="planes are fixed to the ground"):
        DEFAULT.build(Mechanism((plank, disc), (Roll("contact", "plank", "disc", rolling),)), 1e-3)


def test_settings_without_meaning_are_refused() -> None:
    for bad in (
        lambda: RollContact(friction=0.0),
        lambda: RollContact(steps=math.nan),
        lambda: CompletedContact(margin=-1.0),
    ):
        with pytest.raises(ValueError, match="greater than zero"):
            bad()
    with pytest.raises(ValueError, match="elliptic cone only"):
        RollContact(stick=True)
    with pytest.raises(ValueError, match="rolls is"):
        MuJoCo("bad", rolls="contact")  # type: ignore[arg-type]
    assert isinstance(EXTENDED.rolls, RollRows)
    assert isinstance(EQUALITY.rolls, RollEquality)
