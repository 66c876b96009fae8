"""Skates in MuJoCo: written rows are the mechanism's own; every construction has its order, its floor, its price."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.joints import skate as skate_module
from engines.mujoco.joints.skate import skate_rows
from engines.mujoco.joints.slot import slot_rows
from engines.mujoco.methods import SKATES
from engines.mujoco.written_rows import GROUND, WrittenJoint, installed, row_writer, writing
from engines.tree import spanning_tree
from reference.joints import Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reference.trajectory import Trajectory, energy
from tests.mechanisms import bar, four_bar

SLEIGH = ChaplyginSleigh()
NAMED = {engine.variant: engine for engine in SKATES}
EVERY = (DEFAULT, TUNED, EXTENDED, *SKATES)


def run(engine: MuJoCo, scene: Any, dt: float) -> tuple[Trajectory, Trajectory]:
    samples = round(scene.duration / 0.05)
    motion = engine.build(scene.mechanism(), dt)(samples, round(0.05 / dt))
    return motion, scene.motion(motion.t)


def position_error(engine: MuJoCo, scene: Any, dt: float) -> float:
    motion, truth = run(engine, scene, dt)
    return float(np.abs(motion.pose - truth.pose)[..., :2].max())


def assert_ideal(engine: MuJoCo, scene: Any, dt: float, error: float) -> None:
    motion, truth = run(engine, scene, dt)
    mechanism, total = scene.mechanism(), energy(scene.mechanism(), motion)
    assert np.abs(motion.pose - truth.pose).max() < error
    assert np.abs(mechanism.slip(motion.pose, motion.twist)).max() < error
    assert np.abs(total - total[0]).max() < error * total[0]
    assert np.abs(motion.reaction - truth.reaction).max() < 1e-8 * np.abs(truth.reaction).max()
    assert motion.warnings == ()


def jumble() -> Mechanism:
    """An arm on the ground, a block in its slot, a bar on the block, and a body that flies; skates between them all."""
    bodies = (
        bar("arm", (0.0, 0.0), (1.0, 0.4)),
        Body("block", 0.7, 0.05, (0.5, 0.2, 0.3)),
        bar("tail", (0.5, 0.2), (0.9, -0.5)),
        Body("flyer", 1.1, 0.2, (2.0, 1.0, -0.4)),
    )
    half = bodies[0].mass / 2
    joints: tuple[Joint, ...] = (
        Pin("A", None, "arm", (0.0, 0.0), (-half, 0.0)),
        Slot("slot", "arm", "block", (0.0, 0.0), 0.0, (0.0, 0.0)),
        Pin("B", "block", "tail", (0.0, 0.0), (-bodies[2].mass / 2, 0.0)),
        Skate("tail skate", None, "tail", (0.1, 0.05), 0.3),
        Skate("arm skate", None, "arm", (-half, 0.0), 0.2),
        Skate("between", "tail", "flyer", (0.3, -0.2), -0.5),
        Skate("other", "flyer", "block", (0.2, 0.1), 1.5),
    )
    return Mechanism(bodies, joints, (0.0, -9.81))


def test_written_rows_are_the_mechanisms_rows_in_the_trees_coordinates() -> None:
    mechanism, random = jumble(), np.random.default_rng(0)
    tree = spanning_tree(mechanism)
    assert [link.kind for link in tree.links] == ["hinge", "slot", "hinge", "free"]
    assert tree.loops == ()
    index = {None: None, **{body.name: i for i, body in enumerate(mechanism.bodies)}}
    cross = Slot("cross", "tail", "flyer", (0.1, 0.2), 0.4, (0.3, -0.1))  # a slot as a row, for a pair no link joins
    skates = [joint for joint in mechanism.joints if isinstance(joint, Skate)]
    damping = 3.0
    written = [WrittenJoint(index[s.first], index[s.second], 1, skate_rows(s, damping)) for s in skates]
    written.append(WrittenJoint(index["tail"], index["flyer"], 1, slot_rows(cross, 5.0, damping)))
    rows = row_writer(tree, range(tree.coordinates), written, tree.coordinates)
    for _ in range(5):
        q, v, a = random.normal(size=(3, 1, tree.coordinates))
        pose, twist, change = tree.motion(q, v, a)
        flat, right = rows(0.0, q[0].tolist(), v[0].tolist())
        jacobian = np.array(flat).reshape(len(written), tree.coordinates)
        # The mechanism's own rows, by another path: maximal coordinates, and the bias by a complex step.
        both = [*skates, cross]
        for row, joint in enumerate(both):
            poses = [np.zeros(3) if n is None else pose[0, index[n]] for n in (joint.first, joint.second)]
            twists = [np.zeros(3) if n is None else twist[0, index[n]] for n in (joint.first, joint.second)]
            changes = [np.zeros(3) if n is None else change[0, index[n]] for n in (joint.first, joint.second)]
            velocity, step = np.concatenate(twists), 1e-100
            own = joint.rows(*poses)[0]
            turned = joint.rows(*(p + 1j * step * u for p, u in zip(poses, twists, strict=True)))[0].imag / step
            slip = own @ velocity
            wanted = -turned @ velocity - damping * slip
            if isinstance(joint, Slot):
                first, second = poses
                wanted -= 5.0 * joint.gap(first, second, 0.0)[0]
            assert jacobian[row] @ v[0] == pytest.approx(slip, rel=1e-12, abs=1e-12)
            # J a - right is the same number in both: tree coordinates accelerate, bodies do so besides by turning.
            assert jacobian[row] @ a[0] - right[row] == pytest.approx(
                own @ np.concatenate(changes) - wanted, rel=1e-11, abs=1e-11
            )


def test_the_extended_sleigh_is_ideal_to_1e_11_at_two_milliseconds() -> None:
    assert_ideal(EXTENDED, SLEIGH, 2e-3, 1e-11)


def test_the_extended_car_and_trailer_is_ideal_to_1e_10_at_five_milliseconds() -> None:
    assert_ideal(EXTENDED, CarAndTrailer(), 5e-3, 1e-10)


def test_the_exact_multiplier_as_a_passive_force_is_as_good_as_a_row() -> None:
    assert_ideal(NAMED["passive force"], SLEIGH, 2e-3, 1e-11)


def test_the_leapfrog_is_of_order_two_and_its_slip_is_rounding() -> None:
    leapfrog = NAMED["leapfrog"]
    assert position_error(leapfrog, SLEIGH, 1e-3) < 2e-7
    assert 3.5 < position_error(leapfrog, SLEIGH, 2e-3) / position_error(leapfrog, SLEIGH, 1e-3) < 4.5
    motion, truth = run(leapfrog, SLEIGH, 1e-3)
    assert np.abs(SLEIGH.mechanism().slip(motion.pose, motion.twist)).max() < 1e-14
    # Reflections flip the sign of a part of the force in every step; it cancels in the mean of two but for its growth.
    # A reading at another instant would be wrong by dt times about 2/s, 2e-3.
    assert np.abs(motion.reaction - truth.reaction).max() < 2e-4 * np.abs(truth.reaction).max()


def test_slip_alone_proves_nothing() -> None:
    # On a hinged chain the inertia depends on the pose: the leapfrog's alternating part grows until it is everything.
    motion, truth = run(NAMED["leapfrog"], Cart(), 1e-3)
    assert np.abs(Cart().mechanism().slip(motion.pose, motion.twist)).max() < 1e-12
    assert np.abs(motion.pose - truth.pose).max() > 0.1


@pytest.mark.parametrize(
    ("engine", "error"),
    [
        (TUNED, 1e-3),
        (NAMED["tendon"], 1e-3),
        (NAMED["tendon friction"], 1e-3),
        (NAMED["tendon RK4"], 2e-3),
        (NAMED["velocity servo"], 1e-3),
        (NAMED["applied force"], 1.5e-3),
    ],
    ids=lambda value: getattr(value, "variant", None),
)
def test_what_changes_once_a_step_is_of_order_one(engine: MuJoCo, error: float) -> None:
    # A speed of 1.6 m/s turns by 1.14 rad: a direction that is a whole step late costs 1.6 * 1.14 * 1e-3 s = 1.8e-3 m,
    # and half of it where it is late by half a step in the mean. The bounds are these, rounded upwards. Measured are
    # 7.9e-4 m at most with half a step and 1.79e-3 m with RK4, which is late by all of it; a force, 1.14e-3 m, is in
    # between.
    coarse, fine = position_error(engine, SLEIGH, 1e-3), position_error(engine, SLEIGH, 2.5e-4)
    assert coarse < error
    assert 3.5 < coarse / fine < 4.5


@pytest.mark.parametrize("variant", ["friction blade", "thin wheel"])
def test_friction_has_a_floor_that_no_step_removes(variant: str) -> None:
    # The blade's friction along it is MuJoCo's least, 1e-5 of the weight; the wheel has a mass of its own.
    coarse, fine = position_error(NAMED[variant], SLEIGH, 1e-3), position_error(NAMED[variant], SLEIGH, 1e-4)
    assert 1e-4 < fine < coarse < 5e-3
    assert coarse / fine < 4  # order one would give ten


def test_a_blade_as_shipped_creeps_whatever_the_step() -> None:
    # Friction's time constant of 0.02 s is a slip of that times u w, and it doesn't know the step.
    coarse, fine = position_error(DEFAULT, SLEIGH, 1e-3), position_error(DEFAULT, SLEIGH, 2.5e-4)
    assert 5e-3 < coarse < 5e-2
    assert fine > 0.8 * coarse


def test_a_thin_wheel_begins_rolling_at_the_blades_own_speed() -> None:
    mechanism = SLEIGH.mechanism()
    model = NAMED["thin wheel"].model(mechanism, 1e-3)
    wheel = model.compiled.joint("wheel skate").dofadr[0]
    # A tenth of the sleigh's length as radius, and the skate's speed of 1 m/s along its heading.
    assert model.start().qvel[wheel] == pytest.approx(SLEIGH.speed / (0.1 * mechanism.length_scale), rel=1e-12)


def test_without_hardening_written_rows_keep_the_compliance_as_their_floor() -> None:
    soft = NAMED["rows, shipped compliance"]
    assert position_error(soft, SLEIGH, 1e-3) > 0.8 * position_error(soft, SLEIGH, 2e-3) > 1e-6


@pytest.mark.parametrize("engine", EVERY, ids=lambda engine: engine.variant)
def test_the_start_is_the_mechanisms_own_and_the_forces_belong_to_their_samples(engine: MuJoCo) -> None:
    mechanism = SLEIGH.mechanism()
    motion, truth = run(engine, SLEIGH, 1e-3)
    assert np.abs(motion.pose[0] - mechanism.pose).max() < 1e-14
    assert np.abs(motion.twist[0] - mechanism.twist).max() < 1e-13
    # What acts on slip alone has none at the start, so its first force is zero; later ones lag by a step
    # or by friction's time constant of 0.02 s.
    lag = 0.1 if engine is DEFAULT else 5e-3
    assert np.abs(motion.reaction - truth.reaction)[1:].max() < lag * np.abs(truth.reaction).max()


@pytest.mark.parametrize("engine", EVERY, ids=lambda engine: engine.variant)
def test_two_wheels_on_one_axle_change_nothing_and_break_nothing(engine: MuJoCo) -> None:
    once, twice = Cart(duration=0.5), Cart(redundant=True, duration=0.5)
    dt = 1e-3
    single, double = (engine.build(scene.mechanism(), dt)(10, 50) for scene in (once, twice))
    # Where the constraint is exact its multiplicity can't matter; where it yields, two yield less than one: as much as
    # the construction errs by itself.
    allowed = 1e-8 if engine is EXTENDED or engine.variant in ("passive force", "leapfrog") else 5e-2
    assert np.abs(single.pose - double.pose).max() < allowed


def test_a_blade_a_thousandth_further_back_would_be_noticed() -> None:
    motion = EXTENDED.build(ChaplyginSleigh(offset=0.5005).mechanism(), 1e-2)(100, 1)
    truth = SLEIGH.motion(motion.t)
    moved = (motion.pose - motion.pose[0]) - (truth.pose - truth.pose[0])
    assert np.abs(moved).max() > 1e-4


def test_a_row_without_its_velocity_term_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    right = skate_module.skate_rows

    def without(skate: Skate, damping: float) -> Any:
        own = right(skate, 0.0)
        return lambda t, first, second: [(*row[:6], 0.0) for row in own(t, first, second)]

    monkeypatch.setattr(skate_module, "skate_rows", without)
    assert position_error(EXTENDED, SLEIGH, 1e-2) > 1e-2


def test_rows_work_beside_loops_and_drives() -> None:
    """A skate that a four-bar's motion satisfies already changes nothing, though it shares every force."""
    mechanism = four_bar(crank_rate=10.0)
    crank = mechanism.bodies[0]
    along = Skate("idle", None, "crank", (-crank.mass / 2, 0.0))  # at its pin, where nothing moves
    both = replace(mechanism, joints=(*mechanism.joints, along))
    plain, skated = EXTENDED.build(mechanism, 1e-3)(10, 10), EXTENDED.build(both, 1e-3)(10, 10)
    # The row has no inertia to act on in the tree: rounding.
    assert np.abs(plain.pose - skated.pose).max() < 1e-10


def test_callbacks_are_as_they_were_even_after_a_failure() -> None:
    assert mujoco.get_mjcb_control() is None

    def fail() -> None:
        with installed(lambda model, data: None):
            assert mujoco.get_mjcb_control() is not None
            raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        fail()
    assert mujoco.get_mjcb_control() is None
    EXTENDED.build(SLEIGH.mechanism(), 1e-2)(2, 1)
    NAMED["passive force"].build(SLEIGH.mechanism(), 1e-2)(2, 1)
    assert mujoco.get_mjcb_control() is None
    assert mujoco.get_mjcb_passive() is None


def test_rows_that_can_not_be_written_make_the_reference_no_number() -> None:
    def rows(t: float, position: list[float], velocity: list[float]) -> tuple[list[float], list[float]]:
        raise OverflowError("math range error")

    state = np.array([1.0, 2.0])
    data = SimpleNamespace(time=0.0, qpos=state, qvel=state, efc_J=np.ones(6), efc_aref=np.ones(3))
    writing(rows, 1, 2)(None, data)
    assert data.efc_aref[0] == 1  # a row before ours stays
    assert np.isnan(data.efc_aref[1:]).all()


def test_a_motion_that_blows_up_inside_a_callback_ends_as_a_reset() -> None:
    wild = Body("sleigh", 1.0, 1.0, (0.0, 0.0, 0.0), (1e9, 0.0, 1e9))
    mechanism = Mechanism((wild,), (Skate("skate", None, "sleigh", (0.0, 0.0)),))
    motion = EXTENDED.build(mechanism, 1e-1)(20, 10)
    assert motion.reset_at is not None
    assert motion.warnings != ()


def test_a_skate_on_a_moving_body_is_held_by_rows_and_tendons_and_refused_by_contacts() -> None:
    floor = Body("floor", 3.0, 1.0, (0.0, 0.0, 0.2), (0.3, 0.0, 0.5))
    rider = Body("rider", 1.0, 0.1, (0.4, 0.1, 0.7), (0.27, 0.2, -1.0))
    skate = Skate("blade", "floor", "rider", (-0.2, 0.0))
    # The rider moves with the floor and turns about the blade.
    arm = np.array([np.cos(0.7), np.sin(0.7)]) * 0.2
    point = np.array(rider.pose[:2]) - arm
    at = np.array([0.3, 0.0]) + 0.5 * np.array([-point[1], point[0]])
    twist = (*(at - 1.0 * np.array([-arm[1], arm[0]])).tolist(), -1.0)
    mechanism = Mechanism((floor, replace(rider, twist=twist)), (skate,))
    motion = EXTENDED.build(mechanism, 1e-3)(10, 50)
    total = energy(mechanism, motion)
    assert np.abs(mechanism.slip(motion.pose, motion.twist)).max() < 1e-11
    assert np.abs(total - total[0]).max() < 1e-11 * total[0]
    tendon = TUNED.build(mechanism, 1e-3)(10, 50)
    assert 1e-6 < np.abs(tendon.pose - motion.pose).max() < 1e-3
    for variant in ("friction blade", "thin wheel", "velocity servo"):
        with pytest.raises(Unsupported, match="runs on the body 'floor'"):
            NAMED[variant].build(mechanism, 1e-3)


@pytest.mark.parametrize("variant", ["leapfrog", "applied force", "passive force"])
def test_a_multiplier_of_ones_own_refuses_loops(variant: str) -> None:
    mechanism = four_bar(crank_rate=10.0)
    idle = Skate("idle", None, "crank", (-mechanism.bodies[0].mass / 2, 0.0))
    with pytest.raises(Unsupported, match="no loops"):
        NAMED[variant].build(replace(mechanism, joints=(*mechanism.joints, idle)), 1e-3)


@pytest.mark.parametrize("setting", [{"jacobian": "auto"}, {"jacobian": "sparse"}, {"islands": True}], ids=str)
def test_rows_are_not_written_where_the_solver_would_not_read_them(setting: dict[str, Any]) -> None:
    with pytest.raises(Unsupported, match="dense"):
        replace(EXTENDED, **setting).build(SLEIGH.mechanism(), 1e-3)


def test_an_unknown_construction_is_refused() -> None:
    with pytest.raises(ValueError, match="skates is 'glue'"):
        replace(TUNED, skates="glue")  # pyright: ignore[reportArgumentType]


def test_the_ground_moves_nothing() -> None:
    row = skate_rows(Skate("skate", None, "body", (0.0, 0.0)), 0.0)(0.0, GROUND, (1.0, 2.0, 0.0, 3.0, 0.0, 0.5))[0]
    assert row[3:6] == (0.0, 1.0, 0.0)
    assert row[6] == pytest.approx(0.5 * 3.0)  # turning at 0.5 rad/s while it slides at 3 m/s: v w to the left


def test_a_long_coast_ends_straight_and_raises_no_alarm() -> None:
    scene = ChaplyginSleigh(duration=100.0)
    motion, truth = run(EXTENDED, scene, 1e-2)
    # The heading is settled after about 5 s; its error then carries the sleigh 140 m.
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 2e-9
    assert np.abs(motion.pose - truth.pose).max() < 140 * 2e-9
    assert motion.warnings == ()


def test_the_softness_that_is_declared_of_a_written_row_is_what_it_slips_by():
    engine, mechanism = NAMED["rows, shipped compliance"], SLEIGH.mechanism()
    soft = engine.softness(mechanism, 1e-3)
    assert soft is not None
    found = engine.build(mechanism, 1e-3)(SLEIGH.samples, 10)
    rows = mechanism.rows(mechanism.pose)
    inverse = float(((rows / mechanism.inertias.reshape(-1)) @ rows.T)[0, 0])
    # slip' + damping slip = compliance A F: behind a force that rises and falls, the slip reaches half of its limit.
    limit = soft.compliance * inverse * np.abs(found.reaction).max() / soft.damping
    assert 0.3 * limit < np.abs(mechanism.slip(found.pose, found.twist)).max() < limit
