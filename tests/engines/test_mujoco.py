"""MuJoCo as an engine: the right model, the right instants, the right forces, and no silent trouble."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import DEFAULT, DRIVES, EXTENDED, METHODS, TUNED, MuJoCo, Shipped, bare_loop
from reference.joints import Drive, Pin
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.trajectory import Trajectory, energy
from tests.mechanisms import four_bar, pendulum

FREE, DRIVEN = FreeFourBar(), DrivenFourBar()


def run(engine: MuJoCo, scene: Any, every: int) -> tuple[Trajectory, Trajectory]:
    dt = scene.spacing / every
    motion = engine.build(scene.mechanism(), dt)(scene.samples, every)
    return motion, scene.motion(motion.t)


def angle_error(engine: MuJoCo, scene: Any, every: int) -> float:
    motion, truth = run(engine, scene, every)
    return float(np.abs(motion.pose - truth.pose)[..., 2].max())


@pytest.mark.parametrize("engine", METHODS + DRIVES, ids=lambda engine: engine.variant)
@pytest.mark.parametrize("scene", [FREE, DRIVEN], ids=["free", "driven"])
def test_the_start_is_the_mechanisms_own_to_rounding(engine: MuJoCo, scene: Any) -> None:
    mechanism = scene.mechanism()
    motion = engine.build(mechanism, 1e-3)(1, 1)
    # A few roundings of numbers of about 10; a velocity at the wrong time level would miss by a dt = 1e-2.
    assert np.abs(motion.pose[0] - mechanism.pose).max() < 1e-14
    assert np.abs(motion.twist[0] - mechanism.twist).max() < 1e-14
    assert np.abs(mechanism.slip(motion.pose[0], motion.twist[0])).max() < 1e-14
    assert np.abs(mechanism.gap(motion.pose[0], 0.0)).max() < 1e-14


def test_the_targets_of_the_tuned_variant_hold_at_a_millisecond() -> None:
    assert angle_error(TUNED, FREE, every=10) < 1e-6
    assert angle_error(TUNED, DRIVEN, every=10) < 1e-6


def test_the_targets_of_the_extended_variant_hold_at_a_millisecond() -> None:
    for scene in (FREE, DRIVEN):
        motion, truth = run(EXTENDED, scene, every=10)
        assert np.abs(motion.pose - truth.pose)[..., 2].max() < 1e-8
        assert np.abs(motion.reaction - truth.reaction).max() < 1e-6 * np.abs(truth.reaction).max()
        assert motion.warnings == ()


def test_the_targets_of_the_extended_variant_hold_at_a_tenth_of_a_millisecond() -> None:
    motion, truth = run(EXTENDED, FREE, every=100)
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 1e-11
    total = energy(FREE.mechanism(), motion)
    assert np.abs(total - total[0]).max() < 1e-11
    assert angle_error(EXTENDED, DRIVEN, every=100) < 1e-11


def test_a_crank_that_is_one_thousandth_longer_would_be_noticed() -> None:
    wrong = FreeFourBar(crank=FREE.crank * 1.001)
    truth = FREE.motion(np.linspace(0.0, 0.1, 11)).pose[..., 2]
    motion = EXTENDED.build(wrong.mechanism(), 1e-3)(10, 10).pose[..., 2]
    assert np.abs(motion - truth).max() > 1e-5


def test_the_default_error_stays_as_the_step_shrinks_and_the_tuned_one_falls_as_its_square() -> None:
    # The shipped time constant of 0.02 s and impedance of 0.9 are a soft loop at any step: a plateau.
    assert angle_error(DEFAULT, FREE, every=100) > 0.5 * angle_error(DEFAULT, FREE, every=10)
    # With a time constant of five steps the softness falls as dt^2: a factor of 16 from four times the steps.
    ratio = angle_error(TUNED, FREE, every=10) / angle_error(TUNED, FREE, every=40)
    assert 8 < ratio < 32


def test_the_extended_variant_has_the_order_four_of_its_integrator() -> None:
    # 2^4 = 16 between steps that resolve the time constant well; the bounds are orders 3.5 and 4.5.
    ratio = angle_error(EXTENDED, FREE, every=10) / angle_error(EXTENDED, FREE, every=20)
    assert 2**3.5 < ratio < 2**4.5


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EXTENDED], ids=lambda engine: engine.variant)
def test_reactions_by_newtons_law_are_the_forces_that_the_engine_applied(engine: MuJoCo) -> None:
    mechanism = four_bar(crank_rate=10.0)
    built = engine.build(mechanism, 1e-3)
    motion = built(10, 10)
    compiled, data = built.model.compiled, built.data  # left at the last sample by the reading
    mujoco.mj_rnePostConstraint(compiled, data)
    rows = dict(zip(mechanism.row_names, motion.reaction[-1], strict=True))
    unit = built.model.unit  # of masses, and so of forces, in the model
    loop = unit * data.efc_force[:2]
    # Both are sums of forces of about 100 N: a hundred roundings. The hinges differ from the loop by the whole chain.
    largest = np.abs(motion.reaction[-1]).max()
    assert np.abs(loop - [rows["C x"], rows["C y"]]).max() < 1e-9 * largest
    for pin, body in (("A", "crank"), ("B", "coupler"), ("D", "rocker")):
        number = compiled.body(f"body {mechanism.body_index(body)}").id
        assert np.abs(unit * data.cfrc_int[number, 3:5] - [rows[f"{pin} x"], rows[f"{pin} y"]]).max() < 1e-9 * largest


def test_the_drive_torque_does_not_contain_the_armature() -> None:
    motion, truth = run(EXTENDED, DRIVEN, every=10)
    torque = list(DRIVEN.mechanism().row_names).index("drive torque")
    assert np.abs(motion.reaction - truth.reaction)[:, torque].max() < 1e-6 * np.abs(truth.reaction[:, torque]).max()


def test_a_drive_between_two_hinged_bodies_turns_the_one_against_the_other() -> None:
    mechanism = four_bar(crank_rate=10.0)
    # Relative to the crank the coupler turns at -15 rad/s at the start; a two-bar chain has no loop to disagree.
    bodies, joints = mechanism.bodies[:2], mechanism.joints[:2]
    for first, second, sign in (("crank", "coupler", 1.0), ("coupler", "crank", -1.0)):
        offset = sign * (mechanism.pose[1, 2] - mechanism.pose[0, 2])
        drive = Drive("elbow", first, second, sign * -15.0, float(offset))
        chain = Mechanism(bodies, (*joints, drive), (0.0, -9.81))
        motion = EXTENDED.build(chain, 1e-3)(10, 10)
        assert np.abs(chain.gap(motion.pose, motion.t)).max() < 1e-11
        total = energy(chain, motion)
        assert np.ptp(total) > 1e-2  # the drive works


def test_free_coordinates_give_the_same_motion_with_every_pin_a_constraint() -> None:
    engine = replace(EXTENDED, coordinates="free")
    assert angle_error(engine, FREE, every=10) < 1e-7
    size = engine.build(FREE.mechanism(), 1e-3).size
    assert (size.bodies, size.coordinates, size.rows, size.solver_rows) == (3, 9, 8, 12)


def test_a_pin_between_a_body_and_the_ground_is_the_same_whichever_is_named_first() -> None:
    mechanism = FREE.mechanism()
    turned = tuple(
        replace(pin, first=pin.second, second=None, first_point=pin.second_point, second_point=pin.first_point)
        if isinstance(pin, Pin) and pin.first is None
        else pin
        for pin in mechanism.joints
    )
    engine = replace(EXTENDED, coordinates="free")
    motions = [engine.build(m, 1e-3)(20, 10) for m in (mechanism, replace(mechanism, joints=turned))]
    # The rows are the negative ones, and the anchor is rounded in another frame.
    assert np.abs(motions[0].pose - motions[1].pose).max() < 1e-9
    grounded = [name.startswith(("A", "D")) for name in mechanism.row_names]
    signs = np.where(grounded, -1.0, 1.0)
    assert np.abs(motions[0].reaction - signs * motions[1].reaction).max() < 1e-6


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EXTENDED], ids=lambda engine: engine.variant)
def test_the_solvers_tolerance_is_measured_by_what_is_not_driven(engine: MuJoCo) -> None:
    compiled = engine.model(DRIVEN.mechanism(), 1e-3).compiled
    inertias = sorted(compiled.dof_M0)
    assert inertias[-1] > 1e6 * inertias[-2]  # the driven crank's armature
    # What MuJoCo compares with its tolerance is divided by the sum of all.
    assert compiled.opt.tolerance * sum(inertias) == pytest.approx(engine.tolerance * sum(inertias[:-1]), rel=1e-12)
    assert engine.model(FREE.mechanism(), 1e-3).compiled.opt.tolerance == engine.tolerance


def test_no_armature_lets_the_solver_end_before_it_has_begun() -> None:
    whole = four_bar(crank_rate=0.1)
    (crank, coupler), pins = whole.bodies[:2], whole.joints[:2]
    # Driven against the ground, the outer bar's rotation is a sum of two coordinates: a clock beside the tree turns it.
    drive = Drive("drive", None, "coupler", coupler.twist[2], coupler.pose[2])
    model = DEFAULT.model(Mechanism((crank, coupler), (*pins, drive), (0.0, -0.1)), 1e-3)
    found = model.start().qacc
    model.compiled.opt.tolerance = 0.0
    exact = model.start().qacc
    # Newton's iteration solves a linear row at once, and leaves rounding.
    assert np.abs(found - exact).max() < 1e-12 * np.abs(exact).max()
    model.compiled.opt.tolerance = DEFAULT.tolerance
    assert np.abs(model.start().qacc - exact).max() > 1e-3 * np.abs(exact).max()


def test_who_listened_to_mujocos_warnings_before_a_run_does_so_afterwards() -> None:
    def own(message: str) -> None:
        """Hears nothing."""

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(own)
    try:
        DEFAULT.build(pendulum(), 1e-3)(2, 1)
        assert mujoco.get_mju_user_warning() is own
    finally:
        mujoco.set_mju_user_warning(before)


def test_a_tree_closes_only_the_loops() -> None:
    size = EXTENDED.build(FREE.mechanism(), 1e-3).size
    assert (size.bodies, size.coordinates, size.rows, size.solver_rows) == (3, 3, 2, 3)


def test_a_body_that_no_pin_reaches_flies_freely_and_carries_its_own_tree() -> None:
    mechanism = four_bar()
    crank, coupler = (replace(body, twist=(1.0, 2.0, 0.0)) for body in mechanism.bodies[:2])
    flying = Mechanism((crank, coupler), (mechanism.joints[1],), (0.0, -9.81))
    built = EXTENDED.build(flying, 1e-3)
    motion = built(10, 10)
    assert built.size.coordinates == 4
    fall = np.array([1.0, 2.0, 0.0]) * motion.t[:, None, None] + flying.free_fall / 2 * motion.t[:, None, None] ** 2
    assert np.abs(motion.pose - flying.pose - fall).max() < 1e-13
    assert np.abs(motion.reaction).max() < 1e-12  # nothing pulls on the pin of a body in free fall


def test_angles_are_never_wrapped() -> None:
    motion = EXTENDED.build(pendulum(rate=100.0), 1e-3)(20, 50)
    assert motion.pose[-1, 0, 2] > 90


def test_a_servo_lags_and_an_overwritten_crank_tears_the_loop_at_any_step() -> None:
    mechanism = DRIVEN.mechanism()
    servo, _ = run(replace(TUNED, drive="servo"), DRIVEN, every=10)
    lag = np.abs(mechanism.gap(servo.pose, servo.t)[:, -1]).max()
    assert lag > 1e-2
    # The solver believes that an overwritten crank is free to accelerate, so the loop is wrong by a time constant's
    # worth of its acceleration, however small the step.
    gaps = []
    for every in (10, 40):
        motion, _ = run(replace(DEFAULT, drive="overwrite"), DRIVEN, every)
        gaps.append(np.abs(mechanism.gap(motion.pose, motion.t)[:, :8]).max())
        # The crank itself is where it is put: at the angle of the sample's own time.
        assert np.abs(mechanism.gap(motion.pose, motion.t)[:, 8]).max() < 1e-12
        assert any(warning.startswith("ours:") for warning in motion.warnings)
    assert gaps[1] > 0.5 * gaps[0] > 5e-3


@pytest.mark.parametrize("scene", [FREE, DRIVEN], ids=["free", "driven"])
@pytest.mark.parametrize("every", [1, 1000])
def test_the_extended_rule_holds_from_large_steps_to_small_ones(scene: Any, every: int) -> None:
    dt = scene.spacing / every
    motion = EXTENDED.build(scene.mechanism(), dt)(5, every)
    truth = scene.motion(motion.t)
    # 1e-2 s: five steps are longer than the motion's own time constant, and order 4 leaves about 1e-5.
    assert np.abs(motion.pose - truth.pose).max() < (1e-4 if every == 1 else 1e-11)


def test_two_runs_of_the_same_model_are_equal_to_the_last_bit() -> None:
    first, second = (EXTENDED.build(FREE.mechanism(), 1e-3)(10, 10) for _ in range(2))
    assert np.array_equal(first.pose, second.pose)
    assert np.array_equal(first.reaction, second.reaction)


def test_the_bare_loop_takes_all_steps_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    step, times = mujoco.mj_step, []
    monkeypatch.setattr(mujoco, "mj_step", lambda model, data: (step(model, data), times.append(data.time)))
    bare_loop(DEFAULT, FREE.mechanism(), 1e-3, 200)
    assert times == pytest.approx(np.arange(1, 201) * 1e-3)


ONE_OF_EACH = """
<mujoco>
  <option timestep="1e-3" integrator="{integrator}"><flag refsafe="{refsafe}"/></option>
  <worldbody>
    <geom name="ground" type="plane" size="1 1 1"/>
    <body pos="0 0 0.0999"><joint type="slide" axis="0 0 1"/><geom name="ball" size="0.1"/></body>
    <body name="held" pos="3 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1" conaffinity="0"/></body>
  </worldbody>
  <contact><pair geom1="ground" geom2="ball" solref="{constant} 1" solimp="0.9 0.9 0.001"/></contact>
  <equality>
    <connect body1="world" body2="held" anchor="3 0 1" solref="{constant} 1" solimp="{impedance}"/>
  </equality>
</mujoco>
"""


@pytest.mark.parametrize("refsafe", ["enable", "disable"])
@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast", "discrete"])
def test_upstream_short_time_constants_are_clamped_at_two_steps_but_not_all_by_the_discrete_integrator(
    integrator: str, refsafe: str
) -> None:
    text = ONE_OF_EACH.format(integrator=integrator, refsafe=refsafe, constant=1e-4, impedance="0.9 0.9 0.001")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert equality.any()
    assert not equality.all()
    # The damping of a row is 2 / (dmax timeconst).
    constant = 2 / 0.9 / data.efc_KBIP[:, 1]
    of_equality = of_contact = 2e-3
    if integrator == "discrete":
        of_equality, of_contact = 1e-4, 1e-3 / 0.9**0.5  # the contact's stiffness is then 1 / dt^2
    if refsafe == "disable":
        of_equality = of_contact = 1e-4
    assert constant[equality] == pytest.approx(of_equality)
    assert constant[~equality] == pytest.approx(of_contact)


def test_upstream_the_shipped_impedance_grows_with_the_gap_from_nine_tenths() -> None:
    impedance = " ".join(map(str, Shipped().impedance))
    text = ONE_OF_EACH.format(integrator="Euler", refsafe="enable", constant=0.02, impedance=impedance)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    found = []
    for gap in (0.0, 5e-4, 1e-3, 1e-2):
        data.qpos[1] = gap
        mujoco.mj_forward(model, data)
        equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        found.append(data.efc_KBIP[equality, 2].max())
    assert found == pytest.approx([0.9, 0.925, 0.95, 0.95])


def test_an_overwritten_crank_converges_in_a_stiff_loop_only() -> None:
    scene = DrivenFourBar()
    coarse, fine = 1e-3, 1e-4

    def error(base: MuJoCo, dt: float) -> float:
        engine = replace(base, variant="overwritten", drive="overwrite")
        every = round(scene.spacing / dt)
        motion = engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)
        return float(np.abs(motion.pose - scene.motion(motion.t).pose)[..., 2].max())

    assert error(DEFAULT, fine) == pytest.approx(error(DEFAULT, coarse), rel=0.1)
    assert 60 < error(TUNED, coarse) / error(TUNED, fine) < 150  # second order: 100
