"""What MuJoCo's adapter refuses, and how it tells a solver that fails and a reset."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, EXTENDED, TUNED, Hardened
from engines.mujoco.solver_check import unsolved
from reference.forces import Torque
from reference.joints import Drive, Joint, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from tests.mechanisms import bar, four_bar

FREE = FreeFourBar()


def heavy_coupler(ratio: float) -> Mechanism:
    mechanism = four_bar(crank_rate=10.0)
    crank, coupler, rocker = mechanism.bodies
    coupler = replace(coupler, mass=coupler.mass * ratio, inertia=coupler.inertia * ratio)
    return replace(mechanism, bodies=(crank, coupler, rocker))


def arch(links: int, length: float = 0.02) -> Mechanism:
    """Bars along a half circle, pinned to the ground at both ends."""
    angle = np.linspace(np.pi, 0, links + 1)
    points = length / (2 * np.sin(np.pi / 2 / links)) * np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
    places = [(float(x), float(y)) for x, y in points]
    bodies = tuple(bar(f"bar {i}", places[i], places[i + 1]) for i in range(links))
    half = [body.mass / 2 for body in bodies]
    joints: list[Joint] = [Pin("left", None, "bar 0", places[0], (-half[0], 0.0))]
    for i in range(1, links):
        joints.append(Pin(f"pin {i}", f"bar {i - 1}", f"bar {i}", (half[i - 1], 0.0), (-half[i], 0.0)))
    joints.append(Pin("right", f"bar {links - 1}", None, (half[-1], 0.0), places[-1]))
    return Mechanism(bodies, tuple(joints), (1.0, -9.81))


@pytest.mark.parametrize("ratio", [1e-4, 1.0, 1e4])
def test_the_extended_variant_takes_a_solver_that_solves_whatever_the_mass_ratio(ratio: float) -> None:
    motion = EXTENDED.build(heavy_coupler(ratio), 1e-3)(30, 10)
    assert motion.warnings == ()
    assert np.abs(heavy_coupler(ratio).gap(motion.pose, motion.t)).max() < 1e-7


def test_a_solver_that_fails_is_reported_though_mujoco_says_nothing() -> None:
    motion = replace(EXTENDED, solvers=("PGS",)).build(heavy_coupler(1e4), 1e-3)(30, 10)
    assert any(warning.startswith("ours: the solver missed") for warning in motion.warnings)


def test_a_hundred_links_closed_by_one_loop_are_solved_by_the_first_solver_and_not_by_newton() -> None:
    chain = arch(100)
    built = EXTENDED.build(chain, 1e-3)
    assert built.model.compiled.opt.solver == mujoco.mjtSolver.mjSOL_PGS
    motion = built(2, 10)
    # Steps of a millisecond are 1/45 of its time scale: what it loses is the order's, and nothing the solver's.
    assert [warning for warning in motion.warnings if "unresolved" not in warning] == []
    assert np.abs(chain.gap(motion.pose, motion.t)).max() < 1e-8
    newton = replace(EXTENDED, solvers=("Newton",)).build(chain, 1e-3)
    assert unsolved(newton.model.compiled, newton.data) > 1e-3


def test_a_reset_is_noticed_and_the_samples_after_it_are_not_numbers(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    rate = 0.999e10  # rad/s: MuJoCo resets above 1e10, and a torque brings it there
    body = Body("bar", 1.0, 1 / 12, (0.5, 0.0, 0.0), (0.0, rate / 2, rate))
    torque = Torque("torque", None, "bar", 3e9)
    mechanism = Mechanism((body,), (Pin("A", None, "bar", (0.0, 0.0), (-0.5, 0.0)),), (0.0, 0.0), (torque,))
    motion = DEFAULT.build(mechanism, 1e-3)(4, 10)
    assert motion.reset_at == pytest.approx(2e-3)
    assert np.isnan(motion.pose[1:]).all()
    assert np.isnan(motion.twist[1:]).all()
    assert np.isnan(motion.reaction[1:]).all()
    assert any("QVEL" in warning for warning in motion.warnings)
    assert list(tmp_path.iterdir()) == []  # MuJoCo would write MUJOCO_LOG.TXT beside whatever it is run from


def test_a_reset_in_the_middle_of_a_run_keeps_what_came_before() -> None:
    # A spring that is faster than the step blows up: a direct time constant far below what the integrator can take.
    engine = replace(TUNED, stiffness=Hardened(share=1e-6, steps=0.2))
    motion = engine.build(four_bar(crank_rate=10.0), 1e-2)(100, 1)
    assert motion.reset_at is not None
    assert 0 < motion.reset_at < 1
    before = motion.t <= motion.reset_at
    assert np.isfinite(motion.pose[before]).all()
    assert np.isnan(motion.pose[~before]).all()


def test_a_run_can_not_be_repeated() -> None:
    built = DEFAULT.build(FREE.mechanism(), 1e-3)
    built(1, 1)
    with pytest.raises(RuntimeError, match="build it again"):
        built(1, 1)


def test_dense_and_sparse_factorisations_give_the_same_motion() -> None:
    dense, sparse = (replace(TUNED, jacobian=kind).build(arch(12), 1e-3)(10, 10) for kind in ("dense", "sparse"))
    # The same equations in another order: rounding, magnified by a stiff loop over a hundred steps.
    assert np.abs(dense.pose - sparse.pose).max() < 1e-9


def test_a_drive_over_two_coordinates_is_held_against_a_clock_and_a_servo_drives_only_one() -> None:
    mechanism = four_bar(crank_rate=10.0)
    drive = Drive("far", None, "coupler", -5.0, mechanism.bodies[1].pose[2])
    far = replace(mechanism, joints=(*mechanism.joints, drive))
    truth = TRUTH.build(far, 1e-2)(5, 1)
    built = EXTENDED.build(far, 1e-3)
    assert built.size.rows == 3
    motion = built(5, 10)
    assert np.abs(motion.pose - truth.pose).max() < 1e-7
    assert np.abs(motion.reaction - truth.reaction).max() < 1e-6 * np.abs(truth.reaction).max()
    with pytest.raises(Unsupported, match="'coupler' against the ground is a sum of coordinates"):
        replace(EXTENDED, drive="servo").build(far, 1e-3)
    assert replace(EXTENDED, coordinates="free").build(far, 1e-3).size.rows == 9


def test_two_drives_of_one_joint_are_unsupported() -> None:
    mechanism = four_bar(crank_rate=10.0, drive=10.0)
    second = replace(mechanism.joints[-1], name="again")
    with pytest.raises(Unsupported, match="another drive turns already"):
        EXTENDED.build(replace(mechanism, joints=(*mechanism.joints, second)), 1e-3)


@pytest.mark.parametrize(
    "wrong",
    [
        {"integrator": "rk4"},
        {"coordinates": "maximal"},
        {"drive": "motor"},
        {"solvers": ()},
        {"solvers": ("Jacobi",)},
        {"jacobian": "full"},
        {"iterations": 0},
        {"iterations": 1.5},
        {"tolerance": -1e-8},
        {"tolerance": float("nan")},
        {"armature": 0.0},
        {"servo_gain": float("inf")},
        {"stiffness": 0.02},
    ],
    ids=str,
)
def test_bad_settings_are_refused_in_a_sentence(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"MuJoCo: {next(iter(wrong))} is .* must be"):
        replace(EXTENDED, **wrong)


@pytest.mark.parametrize("dt", [0.0, -1e-3, float("nan"), float("inf")])
def test_bad_steps_are_refused(dt: float) -> None:
    with pytest.raises(ValueError, match="build: dt is"):
        DEFAULT.build(FREE.mechanism(), dt)
