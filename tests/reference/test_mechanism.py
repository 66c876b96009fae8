"""Tests of rows, gaps, biases, reactions, force elements, scales and memory of mechanisms."""

from __future__ import annotations

import tracemalloc
from contextlib import nullcontext
from dataclasses import fields, is_dataclass, replace
from typing import Any

import mpmath
import numpy as np
import pytest

from engines import method_name
from engines.lagrange import TRUTH
from engines.registry import ENGINES
from reference.checks import InvalidMechanism, cached_readonly
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Pin, Rod, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.reactions import banded_reaction, rank, reactions, solve_symmetric, undetermined
from reference.scales import length_scale, time_scale
from reference.scenes.catalogue import SCENES
from reference.scenes.n_four_bar import NFourBar, TenFourBars
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, LongPendulum, TenLinks
from reference.trajectory import Trajectory, energy, joint_gap, slip
from tests.mechanisms import ALL, ALONE, DAMPED, DAMPERS, PUSHES, SPRINGS, four_bar, pendulum

RANDOM = np.random.default_rng(20)


PAIR = (Body("a", 1.0, 1.0, (0.0, 0.0, 0.0)), Body("b", 1.0, 1.0, (0.0, 0.0, 0.0)))
JOINTED = {
    "pins and a drive": four_bar(10.0, drive=10.0),
    "rods, a gear, a weld": ALL,
    "slot": Mechanism(PAIR, (Slot("slot", "a", "b", (0.3, -0.2), 0.0, (0.5, -0.2)),)),
    "skate": Mechanism(PAIR, (Skate("skate", "a", "b", (0.3, -0.4), 0.9),)),
}


@pytest.mark.parametrize("name", JOINTED)
def test_rows_are_derivatives_of_the_gap_and_the_bias_is_minus_the_rate_of_the_rows(name):
    mechanism, h = JOINTED[name], 1e-5
    poses, twists = RANDOM.normal(size=(2, 20, len(mechanism.bodies), 3))  # Random poses do not satisfy the joints.
    rows, step = mechanism.rows(poses), 1e-30  # Errors are roundings, since a complex step has no cancellation.
    for column in range(rows.shape[-1] if name != "skate" else 0):
        moved = poses.astype(complex).reshape(20, -1)
        moved[:, column] += 1j * step
        derivative = np.imag(mechanism.gap(moved.reshape(poses.shape), 0.0)) / step
        np.testing.assert_allclose(rows[..., column], derivative, rtol=1e-12, atol=1e-13)
    # Central differences of J v along q + t v do not use `bias` and have an error of about 1e-10.
    states = (poses + h * twists, poses - h * twists)
    ahead, behind = (np.einsum("trc,tc->tr", mechanism.rows(at), twists.reshape(20, -1)) for at in states)
    bias = mechanism.bias(poses, twists)
    np.testing.assert_allclose(bias, -(ahead - behind) / (2 * h), rtol=0, atol=1e-6 * np.abs(bias).max())


def test_reactions_are_computed_with_the_masses_and_gravity_of_the_engines_model():
    mechanism = pendulum()
    resting = np.zeros((1, 3))
    held = np.array([[3.0, 3.0, np.nan]])  # NaN is replaced by the mechanism's inertia
    found = mechanism.reaction(mechanism.pose, resting, held, np.array([0.0, -2.0]))
    own = mechanism.reaction(mechanism.pose, resting)
    heavy = replace(mechanism, bodies=(replace(mechanism.bodies[0], mass=3.0),), gravity=(0.0, -2.0))
    np.testing.assert_allclose(found, heavy.reaction(mechanism.pose, resting), atol=1e-14)
    assert np.abs(found - own).max() > 0.1


def test_energy_gap_and_slip_are_computed_without_a_reference_motion():
    mechanism = pendulum(angle=0.0, rate=2.0)
    start = Trajectory(np.zeros(1), mechanism.pose[None], mechanism.twist[None], np.zeros((1, 2)))
    # The kinetic energy is I omega^2 / 2 with I = 1/3 kg m^2 about the bar's end and omega = 2 rad/s.
    np.testing.assert_allclose(energy(mechanism, start), [2 / 3], rtol=1e-15)
    assert np.max(np.abs(joint_gap(mechanism, start))) == 0
    assert np.max(np.abs(slip(mechanism, start))) < 1e-15
    lifted = replace(start, pose=start.pose + np.array([5.0, 2.0, 1.0]))
    np.testing.assert_allclose(energy(mechanism, lifted), [2 / 3 + 9.81 * 2], rtol=1e-15)


def test_length_and_time_scales_follow_from_lengths_gravity_and_drives():
    assert four_bar().length_scale == pytest.approx(0.8 * np.sqrt(2))
    assert four_bar(10.0, drive=10.0).time_scale == pytest.approx(0.1)
    assert Mechanism((Body("still", 1, 1, (0, 0, 0)),), ()).time_scale == 1.0


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(("miss", "words"), [(1e-11, ""), (1e-8, "'pin x' is"), (1e-6, "'pin x' is")])
def test_the_tolerance_of_an_open_joint_is_relative_to_the_mechanisms_length_and_speed(unit, miss, words):
    def hung(open_by, slip):
        body = Body("bar", 1.0, unit**2, (unit, 0.0, 0.0), (slip * unit, unit, 1.0))
        return Mechanism((body,), (Pin("pin", None, "bar", (open_by * unit, 0.0), (-unit, 0.0)),))

    for wrong in ((miss, 0.0), (0.0, miss)):
        with pytest.raises(InvalidMechanism, match=words) if words else nullcontext():
            hung(*wrong)


def test_cached_arrays_of_a_mechanism_are_read_only():
    values = [
        getattr(SCENES[0].mechanism(), name)
        for name, member in vars(Mechanism).items()
        if isinstance(member, cached_readonly)
    ]
    values += [getattr(value, field.name) for value in values if is_dataclass(value) for field in fields(value)]
    arrays = [value for value in values if isinstance(value, np.ndarray)]
    assert len(arrays) > 5
    assert not any(array.flags.writeable for array in arrays)


RANDOM = np.random.default_rng(5)
POSES, TWISTS = RANDOM.normal(size=(2, 20, 4, 3))


def slopes(function: Any, at: np.ndarray) -> np.ndarray:
    """Derivatives (20, 12) of an analytic function by the coordinates (20, 4, 3), by complex steps."""
    steps = 1e-100j * np.eye(12).reshape(12, 4, 3)
    return np.stack([np.imag(function(at + step)) / 1e-100 for step in steps], axis=-1)


@pytest.mark.parametrize("force", [*SPRINGS, *PUSHES, *DAMPERS], ids=lambda force: force.name)
def test_forces_are_minus_the_gradient_of_the_potential_and_damper_forces_half_the_gradient_of_the_power(force):
    alone = replace(ALL, forces=(force,)).applied

    def power(twist):
        return np.sum(alone.on(POSES.astype(twist.dtype), twist) * twist, axis=(-2, -1))

    expected = slopes(power, TWISTS) / 2 if force in DAMPERS else -slopes(alone.potential, POSES)
    assert force not in DAMPERS or np.all(power(TWISTS) < 0)
    np.testing.assert_allclose(alone.on(POSES, TWISTS).reshape(20, 12), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("force", [SPRINGS[1], SPRINGS[2], SPRINGS[3], PUSHES[1], *DAMPERS[1:]], ids=lambda f: f.name)
def test_internal_forces_have_no_resultant_force_and_no_resultant_moment(force):
    forces = replace(ALL, forces=(force,)).applied.on(POSES, TWISTS)
    x, y, turning = np.moveaxis(forces, -1, 0)
    moment = turning + POSES[..., 0] * y - POSES[..., 1] * x
    for total in (x, y, moment):
        np.testing.assert_allclose(total.sum(axis=-1), 0, atol=1e-12)


def test_reactions_are_computed_with_springs_and_dampers_subtracted():
    motion = TRUTH.build(DAMPED, 0.05)(4, 1)
    forces = DAMPED.applied.on(motion.pose, motion.twist)
    rows = DAMPED.rows(motion.pose)
    pushed = np.einsum("trc,tr->tc", rows, motion.reaction).reshape(forces.shape)
    free = DAMPED.unconstrained(motion.pose, motion.twist)
    acceleration = free + pushed / DAMPED.inertias
    told = DAMPED.reaction(motion.pose, acceleration, twist=motion.twist)
    np.testing.assert_allclose(told, motion.reaction, atol=1e-9 * np.abs(motion.reaction).max())
    with pytest.raises(InvalidMechanism, match="twist is None; dampers need it"):
        DAMPED.reaction(motion.pose, acceleration)


@pytest.mark.parametrize(
    ("name", "freedoms"),
    [("rod to the ground", 2), ("rod", 3), ("gear", 4), ("weld", 2), ("weld to the ground", 1), ("weld in a loop", 1)],
)
def test_degrees_of_freedom_are_counted_by_the_rank_of_the_rows(name, freedoms):
    assert ALONE[name].degrees_of_freedom() == (freedoms, freedoms)


RNG = np.random.default_rng(7)


def in_fifty_digits(rows, inertias, excess):
    """The solution f of J M^-1 J^T f = J excess in fifty digits; the rows must be independent."""
    with mpmath.workdps(50):
        jacobian = mpmath.matrix(rows.tolist())
        weighted = mpmath.matrix(
            [[mpmath.mpf(v) / mpmath.mpf(m) for v, m in zip(row, inertias, strict=True)] for row in rows]
        )
        found = mpmath.lu_solve(weighted * jacobian.T, jacobian * mpmath.matrix(excess.tolist()))
        return np.array([float(value) for value in found])


@pytest.mark.parametrize("ratio", [1.0, 1e-9, 1e9])
def test_reactions_agree_with_fifty_digits_for_large_mass_ratios(ratio):
    rows = RNG.normal(size=(8, 9))
    inertias = np.array([1.0] * 3 + [ratio] * 3 + [1.0] * 3)
    forces = RNG.normal(size=8)
    excess = (rows.T @ forces) / inertias
    found = reactions(rows, inertias, excess, np.ones(8), 1.0)
    exact = in_fifty_digits(rows, inertias, excess)
    # Least squares amplify rounding by the square root of the mass ratio, and a solution with J M^-1 J^T by the ratio.
    assert np.abs(found - exact).max() < 1e-13 * max(ratio, 1 / ratio) ** 0.5 * np.abs(exact).max()


def test_a_nan_at_one_time_gives_nan_reactions_at_that_time_only():
    excess = np.array([[1.0] * 3, [np.nan, 1.0, 1.0], [1.0] * 3])
    found = reactions(np.stack([RNG.normal(size=(2, 3))] * 3), np.ones(3), excess, np.ones(2), 1.0)
    assert np.isnan(found[1]).all()
    assert found[0] == pytest.approx(found[2])


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_degrees_of_freedom_do_not_depend_on_the_unit_of_length(scale):
    body = Body("slider", 1.0, scale**2, (scale, 0.0, 0.0))
    arm = Body("arm", 1.0, scale**2, (0.0, 0.0, 0.0))
    joints = (
        Pin("pivot", None, "arm", (0.0, 0.0), (0.0, 0.0)),
        Pin("hinge", "arm", "slider", (scale, 0.0), (0.0, 0.0)),
        Drive("motor", None, "arm", 0.0, 0.0),
        Slot("guide", None, "slider", (scale, 0.0), 0.3, (0.0, 0.0)),
    )
    freedoms = [Mechanism((arm, body), joints[:count]).degrees_of_freedom() for count in (2, 3, 4)]
    assert freedoms == [(2, 2), (1, 1), (1, 1)]  # slot and motor are dependent, since the arm lies along x


def test_dependent_rows_are_undetermined_also_with_a_coefficient_of_a_thousandth():
    rows = np.zeros((4, 6))
    rows[0, 0] = rows[2, 1] = rows[3, 4] = 1.0  # Row 3 is independent.
    rows[1, :2] = 1.0, 1e-3  # Row 1 is row 0 plus a thousandth of row 2.
    several = undetermined(np.stack([rows, np.eye(6)[:4]]), 1.0)
    assert several.tolist() == [[True, True, True, False], [False] * 4]
    assert rank(rows, 1.0) == 3
    assert rank(np.zeros((0, 3)), 1.0) == 0
    assert rank(np.zeros((2, 3)), 1.0) == 0
    with pytest.raises(ValueError, match="SVD"):
        rank(np.array([[1.0, 0.0, 0.0], [np.nan, 1.0, 0.0]]), 1.0)
    for angle, expected in ((1e-6, 2), (1e-8, 2), (1e-10, 1)):  # the singular value decomposition decides
        assert rank(np.array([[1.0, 0.0, 0.0], [1.0, angle, 0.0]]), 1.0) == expected


def test_a_symmetric_system_is_solved_in_any_unit_and_a_singular_one_by_minimum_norm():
    matrix = np.array([[2e-12, 1e-12], [1e-12, 2e-12]])
    assert solve_symmetric(matrix, np.array([3e-12, 3e-12])) == pytest.approx([1.0, 1.0])
    assert solve_symmetric(np.ones((2, 2)), np.array([1.0, 1.0])) == pytest.approx([0.5, 0.5])


def pushed(mechanism: Mechanism) -> tuple[Any, Any, Any]:
    """Poses near the start, random forces (3, rows), and the accelerations that these forces cause."""
    random = np.random.default_rng(0)
    pose = mechanism.pose + 0.1 * random.normal(size=(3, *mechanism.pose.shape))
    forces = random.normal(size=(3, mechanism.row_count))
    return pose, forces, np.einsum("trc,tr->tc", mechanism.rows(pose), forces).reshape(pose.shape) / mechanism.inertias


@pytest.mark.parametrize("scene", [HundredLinks(), TenFourBars()], ids=["open chain", "closed chain"])
def test_the_band_solver_recovers_the_reactions_from_the_accelerations(scene: Any) -> None:
    mechanism = scene.mechanism()
    pose, forces, excess = pushed(mechanism)
    found = banded_reaction(mechanism.joint_rows, pose, excess, mechanism.inertias)
    # The system of a hundred links has a condition number of about 1e4.
    assert np.abs(found - forces).max() < 1e-11
    # The acceleration of free fall is added and subtracted, which causes a rounding error.
    assert np.abs(mechanism.reaction(pose, mechanism.free_fall + excess) - found).max() < 1e-11


def with_a_pin_beside_the_last(distance: float) -> Mechanism:
    """A chain of ten links with a second pin at this distance [m] from the last pin."""
    mechanism = TenLinks().mechanism()
    last = mechanism.joints[-1]
    assert isinstance(last, Pin)
    (x1, y1), (x2, y2) = last.first_point, last.second_point
    beside = replace(last, name="beside", first_point=(x1, y1 + distance), second_point=(x2, y2 + distance))
    return replace(mechanism, joints=(*mechanism.joints, beside))


def test_nearly_coincident_pins_are_solved_by_the_dense_system_and_share_the_force() -> None:
    for distance in (1e-6, 1e-11):
        twice = with_a_pin_beside_the_last(distance)
        pose, forces, excess = pushed(twice)
        assert np.isnan(banded_reaction(twice.joint_rows, pose, excess, twice.inertias)).any(axis=1).all()
        found = twice.reactions_of(pose, excess, twice.inertias)
        if distance == 1e-6:  # the rows' condition number of 6e7 causes an error of about 1e-8
            assert np.abs(found - forces).max() < 1e-6
        else:  # below the threshold of the rank both pins count as one pin, and minimum-norm forces are returned
            once = TenLinks().mechanism().reactions_of(pose, excess, twice.inertias)
            assert np.abs(found[:, -4:-2] + found[:, -2:] - once[:, -2:]).max() < 1e-6 * np.abs(once).max()
            assert np.abs(found).max() < 2 * np.abs(once).max()


LINKS = 2_000
# Objects and arrays take 1.4 to 1.9 kB per link (measured). A dense matrix would take 48 N bytes per link, or 96 kB for
# 2000 links.
BYTES_A_LINK = 4_000


def test_the_memory_for_building_and_checking_a_long_chain_is_proportional_to_its_links():
    tracemalloc.start()
    try:
        mechanism = NFourBar(LINKS // 2).mechanism()
        assert mechanism.length_scale == pytest.approx(1.0)
        assert 0.1 < mechanism.time_scale < 1
        assert tracemalloc.get_traced_memory()[1] < BYTES_A_LINK * LINKS
    finally:
        tracemalloc.stop()


def test_arrays_above_the_memory_limit_are_refused_with_their_size():
    chain = LongPendulum(8_000).mechanism()
    with pytest.raises(InvalidMechanism, match=r"dense rows .* would take 3\.07e\+09 bytes; more than 2\.15e\+09"):
        chain.rows(chain.pose)
    loops = NFourBar(1000).mechanism()
    with pytest.raises(InvalidMechanism, match=r"the rank of rows .* would take 2\.88e\+08 bytes"):
        loops.degrees_of_freedom()
    with pytest.raises(InvalidMechanism, match=r"inertia matrix .* would take 3\.2e\+09 bytes"):
        _ = Chain((1.0,) * 20_000, (1.0,) * 20_000).inertia_matrix
    for scene in (NFourBar(5_000), LinkPendulum(links=10_000)):
        with pytest.raises(InvalidMechanism, match=r"a trajectory .* would take 2\.4e\+09 bytes"):
            scene.motion(np.zeros(10_000))


@pytest.mark.parametrize("engine", ENGINES, ids=method_name)
def test_every_engine_refuses_a_trajectory_above_the_memory_limit(engine):
    run = engine.build(LinkPendulum(links=2).mechanism(), 1e-3)
    with pytest.raises(ValueError, match=r"a trajectory of the shape \(100000001, 2, 3\) would take 4\.8e\+09 bytes"):
        run(100_000_000, 1)


BODY = Body("b", 2.0, 0.5, (0.0, 0.0, 0.0))
AT = (0.3, 0.4)  # m; the inverse effective mass is 1/2 + 0.25/0.5 = 1 per kilogram


@pytest.mark.parametrize(
    ("force", "rate"),
    [
        (Spring("f", None, "b", (1.0, 1.0), AT, 9.0, 1.0), 3.0),
        (Damper("f", None, "b", (1.0, 1.0), AT, 7.0), 7.0),
        (TorsionSpring("f", None, "b", 8.0), 4.0),
        (TorsionDamper("f", None, "b", 3.0), 6.0),
        (Torque("f", None, "b", 2.0), 2.0),
        (Torque("f", None, "b", -2.0), 2.0),
        (Force("f", "b", AT, (0.0, -12.0)), 4.0),
    ],
    ids=lambda each: type(each).__name__ if not isinstance(each, float) else "",
)
def test_the_time_scale_of_one_force_is_the_inverse_of_its_fastest_rate(force, rate):
    assert time_scale(0.75, (0.0, 0.0), [BODY], [], [force]) == pytest.approx(1 / rate, rel=1e-14)


@pytest.mark.parametrize(("twist", "rate"), [((0.0, 0.0, 0.0), 4.0), ((0.0, 0.0, -5.0), 5.0), ((-4.5, 6.0, 0.0), 10.0)])
def test_the_time_scale_uses_both_bodies_of_a_spring_or_a_faster_start_velocity(twist, rate):
    spring = Spring("f", "c", "b", (0.0, 0.0), AT, 8.0, 1.0)  # the inverse effective mass is 1/kg for each body
    pair = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0), twist)]
    assert time_scale(0.75, (0.0, 0.0), pair, [], [spring]) == pytest.approx(1 / rate, rel=1e-14)


def test_the_length_scale_counts_rods_and_springs_between_centres_of_mass():
    pair = [BODY, Body("c", 1.0, 0.5, (3.0, 0.0, 0.0))]
    rod = Rod("r", "b", "c", (0.0, 0.0), (0.0, 0.0), 3.0)
    assert length_scale(pair, [rod]) == 3.0
    assert length_scale(pair, [rod], [Spring("s", None, "b", (0.0, 0.0), (3.0, 4.0), 1.0)]) == 5.0
    assert length_scale(pair, [], [Spring("s", "b", "c", (0.0, 0.0), (0.0, 0.0), 1.0, 0.2)]) == 0.2
    assert length_scale(pair, []) == 1.0
