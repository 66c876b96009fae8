"""The description of a mechanism: rows, gaps, biases, reactions, freedoms, and what it refuses."""

from __future__ import annotations

import dataclasses
import math
from contextlib import nullcontext
from dataclasses import replace
from functools import cached_property

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.joints import Drive, Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.rolling.traced import Traced
from reference.scenes.catalogue import SCENES
from reference.trajectory import Trajectory, energy, joint_gap, slip
from tests.mechanisms import bar, four_bar, pendulum

RANDOM = np.random.default_rng(20)


@pytest.fixture(scope="module")
def driven() -> Mechanism:
    return four_bar(crank_rate=10.0, drive=10.0)


def test_rows_are_the_derivative_of_the_gap(driven):
    pose = driven.pose + RANDOM.normal(size=driven.pose.shape)
    rows = driven.rows(pose)
    step = 1e-30  # a complex step has no subtraction, so the comparison is at rounding level
    for column in range(pose.size):
        moved = pose.astype(complex).reshape(-1)
        moved[column] += 1j * step
        derivative = driven.gap(moved.reshape(pose.shape), 0.0).imag / step
        np.testing.assert_allclose(rows[:, column], derivative, rtol=0, atol=1e-14)


def test_the_bias_is_minus_the_rate_of_the_rows_times_the_velocity(driven):
    pose, twist = driven.pose, RANDOM.normal(size=driven.twist.shape)
    h = 1e-5  # central difference: error h^2 times the third derivative of a cosine, about 1e-10 times |v|^3
    difference = (driven.rows(pose + h * twist) - driven.rows(pose - h * twist)) / (2 * h)
    np.testing.assert_allclose(driven.bias(pose, twist), -difference @ twist.reshape(-1), atol=1e-8)


def test_the_printed_rates_of_the_chapter_satisfy_the_rows_and_a_flipped_sign_does_not(driven):
    assert np.max(np.abs(driven.slip(driven.pose, driven.twist))) < 1e-14
    wrong = driven.twist.copy()
    wrong[2, 2] *= -1
    assert np.max(np.abs(driven.slip(driven.pose, wrong))) > 1


def test_everything_broadcasts_over_times(driven):
    poses = driven.pose + RANDOM.normal(size=(5, *driven.pose.shape))
    twists = RANDOM.normal(size=poses.shape)
    times = np.linspace(0, 1, 5)
    for i, t in enumerate(times):
        np.testing.assert_array_equal(driven.rows(poses)[i], driven.rows(poses[i]))
        np.testing.assert_array_equal(driven.gap(poses, times)[i], driven.gap(poses[i], t))
        np.testing.assert_array_equal(driven.bias(poses, twists)[i], driven.bias(poses[i], twists[i]))


def test_reactions_read_from_accelerations_obey_newtons_law(driven):
    rows = driven.rows(driven.pose)
    reaction = RANDOM.normal(size=driven.row_count)
    weight = 1 / driven.inertias.reshape(-1)
    acceleration = (driven.free_fall.reshape(-1) + weight * (rows.T @ reaction)).reshape(-1, 3)
    # Rounding of 1e-16 times the condition of the row system, about 1e3 here.
    np.testing.assert_allclose(driven.reaction(driven.pose, acceleration), reaction, atol=1e-12)


def test_a_hanging_bar_at_rest_loads_its_pin_with_its_weight_upwards():
    mechanism = pendulum(angle=-np.pi / 2)
    np.testing.assert_allclose(mechanism.reaction(mechanism.pose, np.zeros((1, 3))), [0, 9.81], atol=1e-14)


def test_redundant_rows_share_the_reaction_equally():
    mechanism = pendulum(angle=-np.pi / 2)
    twice = replace(mechanism, joints=(*mechanism.joints, replace(mechanism.joints[0], name="A again")))
    np.testing.assert_allclose(twice.reaction(twice.pose, np.zeros((1, 3))), [0, 9.81 / 2, 0, 9.81 / 2], atol=1e-12)


def test_an_engine_with_other_masses_and_gravity_has_applied_other_reactions():
    mechanism = pendulum()
    resting = np.zeros((1, 3))
    held = np.array([[3.0, 3.0, np.nan]])  # it has no number for the inertia: the mechanism's counts
    found = mechanism.reaction(mechanism.pose, resting, held, np.array([0.0, -2.0]))
    own = mechanism.reaction(mechanism.pose, resting)
    heavy = replace(mechanism, bodies=(replace(mechanism.bodies[0], mass=3.0),), gravity=(0.0, -2.0))
    np.testing.assert_allclose(found, heavy.reaction(mechanism.pose, resting), atol=1e-14)
    assert np.abs(found - own).max() > 0.1


def test_freedoms_are_counted_by_rank_so_a_repeated_pin_changes_nothing():
    assert four_bar().degrees_of_freedom() == (1, 1)
    assert four_bar(10.0, drive=10.0).degrees_of_freedom() == (0, 0)
    mechanism = pendulum()
    assert mechanism.degrees_of_freedom() == (1, 1)
    twice = replace(mechanism, joints=(*mechanism.joints, replace(mechanism.joints[0], name="A again")))
    assert twice.degrees_of_freedom() == (1, 1)
    assert Mechanism((mechanism.bodies[0],), ()).degrees_of_freedom() == (3, 3)


def test_energy_gap_and_slip_need_no_reference():
    mechanism = pendulum(angle=0.0, rate=2.0)
    start = Trajectory(np.zeros(1), mechanism.pose[None], mechanism.twist[None], np.zeros((1, 2)))
    # A bar of 1 kg and 1 m turning about its end at 2 rad/s: (1/3) 2^2 / 2.
    np.testing.assert_allclose(energy(mechanism, start), [2 / 3], rtol=1e-15)
    assert np.max(np.abs(joint_gap(mechanism, start))) == 0
    assert np.max(np.abs(slip(mechanism, start))) < 1e-15
    lifted = replace(start, pose=start.pose + np.array([5.0, 2.0, 1.0]))
    np.testing.assert_allclose(energy(mechanism, lifted), [2 / 3 + 9.81 * 2], rtol=1e-15)


def test_scales_come_from_the_description():
    assert four_bar().length_scale == pytest.approx(0.8 * np.sqrt(2))
    assert four_bar(10.0, drive=10.0).time_scale == pytest.approx(0.1)
    assert Mechanism((Body("still", 1, 1, (0, 0, 0)),), ()).time_scale == 1.0


def test_a_body_that_only_slides_sets_the_time_scale_by_its_length():
    # 3 and 4 m/s along a blade whose point is 2 m ahead: the length is 2 m, the speed 5 m/s.
    body = Body("sled", 1, 1, (0, 0, math.atan2(4, 3)), (3, 4, 0))
    sliding = Mechanism((body,), (Skate("blade", None, "sled", (2.0, 0.0)),))
    assert sliding.length_scale == 2
    assert sliding.time_scale == pytest.approx(2 / 5)


@pytest.mark.parametrize(("miss", "taken"), [(1e-11, True), (1e-8, False), (1e-6, False)])
def test_a_start_off_a_joint_by_more_than_rounding_is_refused(miss, taken):
    sound = pendulum(angle=-np.pi / 2, rate=1.0)
    (body,) = sound.bodies
    apart = replace(body, pose=(body.pose[0] + miss, *body.pose[1:]))
    sliding = replace(body, twist=(body.twist[0] + miss, *body.twist[1:]))
    for wrong in (apart, sliding):
        with nullcontext() if taken else pytest.raises(InvalidMechanism, match="'A x' is"):
            replace(sound, bodies=(wrong,))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Body("b", 0.0, 1, (0, 0, 0)), "mass is 0.0; it must be a finite number greater than zero"),
        (lambda: Body("b", 1, -1.0, (0, 0, 0)), "inertia is -1.0"),
        (lambda: Body("b", 1, 1, (0, float("nan"), 0)), "pose"),
        (lambda: Body("b", 1, 1, (0, 0, 0), (0, 0, float("inf"))), "twist"),
        (lambda: Body("b", 1, 1, (0, 0)), "it must be a tuple of 3 values"),  # pyright: ignore[reportArgumentType]
        (lambda: Mechanism((), ()), "no bodies"),
        (lambda: Mechanism((bar("b", (0, 0), (1, 0)),) * 2, ()), "two bodies are called 'b'"),
        (
            lambda: Mechanism((bar("b", (0, 0), (1, 0)),), (Pin("A", None, "c", (0, 0), (0, 0)),)),
            "no body is called 'c'; there are 'b'",
        ),
        (lambda: Mechanism((bar("b", (0, 0), (1, 0)),), (Pin("A", "b", "b", (0, 0), (0, 0)),)), "with itself"),
        (
            lambda: Mechanism((bar("b", (0, 0), (1, 0)),), (Pin("A", None, "b", (0.1, 0), (-0.5, 0)),)),
            "'A x' is open by 0.1",
        ),
        (lambda: four_bar(crank_rate=10.0, drive=9.0), "'drive torque' is moving apart at 1"),
        (lambda: Drive("d", None, "b", float("nan"), 0.0), "turning_rate"),
        (lambda: replace(four_bar(), gravity=(0.0, float("inf"))), "gravity"),
    ],
)
def test_what_cannot_be_is_refused_with_a_sentence(make, says):
    with pytest.raises(InvalidMechanism, match=r".") as refusal:
        make()
    assert says in str(refusal.value)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e6, 1e9])
def test_a_start_off_a_joint_is_judged_by_the_mechanisms_own_size(scale):
    def hung(open_by):
        body = Body("bar", 1.0, scale**2, (scale, 0.0, 0.0))
        return Mechanism((body,), (Pin("pin", None, "bar", (open_by * scale, 0.0), (-scale, 0.0)),))

    for open_by in (1e-6, 1e-8):
        with pytest.raises(InvalidMechanism, match="row 'pin x' is open by"):
            hung(open_by)
    assert hung(1e-11).row_count == 2


@pytest.mark.parametrize("speed", [1e-9, 1.0, 1e9])
def test_a_start_that_slips_is_judged_by_its_own_speed(speed):
    def turning(slip):
        body = Body("bar", 1.0, 1.0, (1.0, 0.0, 0.0), (slip * speed, speed, speed))
        return Mechanism((body,), (Pin("pin", None, "bar", (0.0, 0.0), (-1.0, 0.0)),))

    with pytest.raises(InvalidMechanism, match="row 'pin x' is moving apart at"):
        turning(1e-7)
    assert turning(1e-12).row_count == 2


def arrays_of(value, path, seen, depth=0):
    """Every array that somebody can reach from a value through public names, with the way there."""
    if isinstance(value, np.ndarray):
        yield path, value
    elif isinstance(value, tuple):
        for index, each in enumerate(value):
            yield from arrays_of(each, f"{path}[{index}]", seen, depth + 1)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type) and id(value) not in seen and depth < 8:
        seen.add(id(value))
        kept = [
            name for cls in type(value).__mro__ for name, each in vars(cls).items() if isinstance(each, cached_property)
        ]
        for name in {*(field.name for field in dataclasses.fields(value)), *kept}:
            if not name.startswith("_"):
                yield from arrays_of(getattr(value, name, None), f"{path}.{name}", seen, depth + 1)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_no_array_that_is_kept_for_all_can_be_written(scene):
    found = [*arrays_of(scene.mechanism(), "mechanism", set()), *arrays_of(scene, "scene", set())]
    assert len(found) > 5
    assert [path for path, array in found if array.flags.writeable] == []


def test_what_is_made_of_an_array_does_not_change_with_it():
    points = np.column_stack([np.cos(np.linspace(0, 1, 20)), np.sin(np.linspace(0, 1, 20))])
    curve = Traced(np.linspace(0, 1, 20), points)
    before = curve.point_of(0.5).copy()
    points += 1.0
    assert abs(curve.points).max() <= 1.0
    np.testing.assert_array_equal(curve.point_of(0.5), before)
    with pytest.raises(ValueError, match="read-only"):
        curve.points[0] = 0.0
