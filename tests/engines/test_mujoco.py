"""Tests of MuJoCo: models, reactions and stiffness, and warnings of failures and faulty releases.

`test_matrix` tests the order and the error of each construction.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import DEFAULT, EXTENDED, TUNED, Hardened, MuJoCo, Shipped, TiedToStep
from engines.mujoco.methods import SLOTS
from engines.mujoco.releases import known_fault
from engines.mujoco.solver_check import solver_residual
from reference.forces import Torque
from reference.joints import Drive, Pin, Rod, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.pendulum.scenes import HundredLinks
from reference.scenes.rolling.scenes import RollingDisc
from reference.scenes.slider_crank import FreeSliderCrank, SlottedLever
from reference.trajectory import KNOWN_WRONG, energy
from tests.engines.test_matrix import FREE_COORDINATES, far_drive
from tests.mechanisms import bar, four_bar

FREE, DRIVEN = FreeFourBar(), DrivenFourBar()


def heavy_coupler(ratio: float) -> Mechanism:
    mechanism = four_bar(crank_rate=10.0)
    crank, coupler, rocker = mechanism.bodies
    coupler = replace(coupler, mass=coupler.mass * ratio, inertia=coupler.inertia * ratio)
    return replace(mechanism, bodies=(crank, coupler, rocker))


def arch(links: int, length: float = 0.02) -> Mechanism:
    """A chain of bars along a half circle, with both ends pinned to the ground."""
    angle = np.linspace(np.pi, 0, links + 1)
    points = length / (2 * np.sin(np.pi / 2 / links)) * np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
    places = [(float(x), float(y)) for x, y in points]
    bodies = tuple(bar(f"bar {i}", places[i], places[i + 1]) for i in range(links))
    ends = [(body.name, (-body.mass / 2, 0.0), (body.mass / 2, 0.0)) for body in bodies]
    first, last = (None, places[0], places[0]), (None, places[-1], places[-1])
    pins = zip((first, *ends), (*ends, last), strict=True)
    joints = tuple(Pin(f"pin {i}", a[0], b[0], a[2], b[1]) for i, (a, b) in enumerate(pins))
    return Mechanism(bodies, joints, (1.0, -9.81))


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EXTENDED], ids=lambda engine: engine.variant)
def test_reactions_by_newtons_law_are_the_forces_that_the_engine_applied(engine: MuJoCo) -> None:
    mechanism = four_bar(crank_rate=10.0)
    built = engine.build(mechanism, 1e-3)
    motion = built(10, 10)
    compiled, data = built.model.compiled, built.data  # The state is that of the last sample.
    mujoco.mj_rnePostConstraint(compiled, data)
    rows = dict(zip(mechanism.row_names, motion.reaction[-1], strict=True))
    unit = built.model.unit  # The unit of masses and forces in the model.
    loop = unit * data.efc_force[:2]
    # Both reactions are sums of forces of about 100 N. The tolerance is the rounding of some hundred operations.
    largest = np.abs(motion.reaction[-1]).max()
    assert np.abs(loop - [rows["C x"], rows["C y"]]).max() < 1e-9 * largest
    for pin, body in (("A", "crank"), ("B", "coupler"), ("D", "rocker")):
        number = compiled.body(f"body {mechanism.body_index(body)}").id
        assert np.abs(unit * data.cfrc_int[number, 3:5] - [rows[f"{pin} x"], rows[f"{pin} y"]]).max() < 1e-9 * largest


def test_the_solver_converges_with_the_armature_of_a_drive() -> None:
    linkage = four_bar(crank_rate=0.1)
    (crank, coupler), pins = linkage.bodies[:2], linkage.joints[:2]
    # The rotation of the outer bar relative to the ground is a sum of two coordinates. A clock drives this sum.
    clocked = Drive("drive", None, "coupler", coupler.twist[2], coupler.pose[2])
    driven = Drive("drive", None, "crank", 0.1, crank.pose[2])
    for mechanism in (
        Mechanism((crank, coupler), (*pins, clocked), (0.0, -0.1)),
        replace(linkage, joints=(*linkage.joints, driven), gravity=(0.0, -0.1)),
    ):
        model = DEFAULT.model(mechanism, 1e-3)
        solved = model.start().qacc
        model.compiled.opt.tolerance = 0.0
        exact = model.start().qacc
        # For linear rows one iteration of Newton's method gives the solution to rounding.
        assert np.abs(solved - exact).max() < 1e-12 * np.abs(exact).max()
        model.compiled.opt.tolerance = DEFAULT.tolerance
        assert np.abs(model.start().qacc - exact).max() > 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("engine", "own", "size"),
    [
        (EXTENDED, FREE.mechanism(), (3, 3, 2, 3)),  # Only the pin that closes the loop is a constraint.
        (FREE_COORDINATES, FREE.mechanism(), (3, 9, 8, 12)),
        (EXTENDED, FreeSliderCrank().mechanism(), (3, 3, 2, 3)),  # A slider that keeps its angle is one coordinate.
        # Four pins and the slot have rows. The angle of the slider is driven at rate zero by an armature.
        (FREE_COORDINATES, FreeSliderCrank().mechanism(), (3, 9, 8, 10)),
        (EXTENDED, far_drive(), (4, 4, 3, 4)),  # A clock drives the sum of two coordinates.
        # A contact has four rows for the edges of a pyramid, or a normal row and two friction rows. One friction row is
        # zero, since it is normal to the plane of motion.
        *((engine, RollingDisc().mechanism(), (1, 3, 2, n)) for engine, n in ((DEFAULT, 4), (TUNED, 3), (EXTENDED, 2))),
        (TUNED, SlottedLever().mechanism(), (3, 4, 4, 6)),  # A body is split, and a weld joins its parts.
        (SLOTS[0], SlottedLever().mechanism(), (2, 2, 2, 1)),
    ],
)
def test_the_numbers_of_bodies_coordinates_and_rows(engine: MuJoCo, own: Mechanism, size: tuple[int, ...]) -> None:
    built = engine.build(own, 1e-3).size
    assert (built.bodies, built.coordinates, built.rows, built.solver_rows) == size


def test_a_pin_between_a_body_and_the_ground_is_the_same_whichever_is_named_first() -> None:
    mechanism = FREE.mechanism()
    turned = tuple(
        replace(pin, first=pin.second, second=None, first_point=pin.second_point, second_point=pin.first_point)
        if isinstance(pin, Pin) and pin.first is None
        else pin
        for pin in mechanism.joints
    )
    motions = [FREE_COORDINATES.build(m, 1e-3)(20, 10) for m in (mechanism, replace(mechanism, joints=turned))]
    # The signs of the rows differ, and the anchors are rounded in different frames.
    assert np.abs(motions[0].pose - motions[1].pose).max() < 1e-9
    grounded = [name.startswith(("A", "D")) for name in mechanism.row_names]
    signs = np.where(grounded, -1.0, 1.0)
    assert np.abs(motions[0].reaction - signs * motions[1].reaction).max() < 1e-6


def test_a_slot_on_a_fixed_line_holds_the_centre_of_a_free_body() -> None:
    angle, along = 0.6, np.array([np.cos(0.6), np.sin(0.6)])
    bead = Body("bead", 2.0, 0.1, (0.2, 0.3, 0.0), (0.5 * along[0], 0.5 * along[1], 3.0))
    slot = Slot("wire", None, "bead", (0.2, 0.3), angle, (0.0, 0.0))
    mechanism = Mechanism((bead,), (slot,), (0.0, -9.81))
    motion = FREE_COORDINATES.build(mechanism, 1e-3)(20, 10)
    distance = 0.5 * motion.t - 9.81 * along[1] * motion.t**2 / 2
    # The gap is the weight across the wire divided by the stiffness of the spring.
    assert np.abs(motion.pose[:, 0, :2] - [0.2, 0.3] - distance[:, None] * along).max() < 1e-7
    assert np.abs(motion.pose[:, 0, 2] - 3.0 * motion.t).max() < 1e-9


def test_a_tendon_rod_has_no_velocity_term_and_a_user_row_has_it() -> None:
    # The acceleration of a rod that turns at 2 rad/s without gravity is the velocity term -(dJ/dt) v.
    body = Body("b", 1.0, 1.0, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    mechanism = Mechanism((body,), (Rod("r", None, "b", (0.0, 0.0), (0.0, 0.0), 1.0),))
    ours, tendon = (replace(EXTENDED, rods=rods).build(mechanism, 1e-3)(1, 1) for rods in ("rows", "tendon"))
    assert ours.reaction[0, 0] == pytest.approx(-4.0, rel=1e-6)
    # If this fails, MuJoCo now computes the velocity term, and rods need no user rows.
    assert abs(tendon.reaction[0, 0]) < 1e-6


def test_a_hundred_links_keep_their_energy() -> None:
    mechanism = HundredLinks().mechanism()
    total = energy(mechanism, EXTENDED.build(mechanism, 5e-4)(2, 200))
    # The potential energy can change by 5e4 J, which is m g L times the sum of heights.
    assert np.abs(total - total[0]).max() < 2e-8


@pytest.mark.parametrize("stiffness", [Shipped(), TiedToStep(), TiedToStep(1.0), Hardened()])
def test_every_spring_of_a_row_is_critically_damped(stiffness: Any) -> None:
    mechanism, dt = four_bar(crank_rate=10.0), 1e-3
    spring, damper = stiffness.gains(mechanism, dt)
    assert damper**2 == pytest.approx(4 * spring, rel=1e-14)
    first, second = stiffness.reference(mechanism, dt)
    # Negative numbers are stiffness and damping. Positive numbers are a time constant and a damping ratio.
    if first < 0:
        assert (-first, -second) == pytest.approx((spring, damper), rel=1e-14)
    else:
        assert (max(first, 2 * dt), second) == pytest.approx((2 / damper, 1.0), rel=1e-14)


# Failures and their warnings


@pytest.mark.parametrize("ratio", [1e-4, 1.0, 1e4])
def test_the_extended_variant_chooses_a_solver_that_converges_for_any_mass_ratio(ratio: float) -> None:
    motion = EXTENDED.build(heavy_coupler(ratio), 1e-3)(30, 10)
    assert motion.warnings == ()
    assert np.abs(heavy_coupler(ratio).gap(motion.pose, motion.t)).max() < 1e-7


def test_a_solver_that_fails_causes_a_warning() -> None:
    motion = replace(EXTENDED, solvers=("PGS",)).build(heavy_coupler(1e4), 1e-3)(30, 10)
    assert any(warning.startswith("ours: the solver missed") for warning in motion.warnings)


def test_a_loop_of_a_hundred_links_is_solved_by_pgs_and_not_by_newton() -> None:
    chain = arch(100)
    built = EXTENDED.build(chain, 1e-3)
    assert built.model.compiled.opt.solver == mujoco.mjtSolver.mjSOL_PGS
    motion = built(2, 10)
    # The step of 1 ms is 1/45 of the time scale, so the integrator causes the error, and not the solver.
    assert [warning for warning in motion.warnings if "unresolved" not in warning] == []
    assert np.abs(chain.gap(motion.pose, motion.t)).max() < 1e-8
    newton = replace(EXTENDED, solvers=("Newton",)).build(chain, 1e-3)
    assert solver_residual(newton.model.compiled, newton.data) > 1e-3


def test_samples_after_a_reset_are_nan(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    rate = 0.999e10  # A torque increases the rate [rad/s] to 1e10, at which MuJoCo resets the state.
    body = Body("bar", 1.0, 1 / 12, (0.5, 0.0, 0.0), (0.0, rate / 2, rate))
    torque = Torque("torque", None, "bar", 3e9)
    mechanism = Mechanism((body,), (Pin("A", None, "bar", (0.0, 0.0), (-0.5, 0.0)),), (0.0, 0.0), (torque,))
    motion = DEFAULT.build(mechanism, 1e-3)(4, 10)
    assert motion.reset_at == pytest.approx(2e-3)
    assert np.isnan(motion.pose[1:]).all()
    assert np.isnan(motion.twist[1:]).all()
    assert np.isnan(motion.reaction[1:]).all()
    assert any("QVEL" in warning for warning in motion.warnings)
    assert list(tmp_path.iterdir()) == []  # MuJoCo would write MUJOCO_LOG.TXT.


@pytest.mark.parametrize(("version", "reason"), [("3.6.0", "velocity term"), ("4.0.0", "Hessian")])
def test_a_release_with_a_known_fault_causes_a_warning(
    monkeypatch: pytest.MonkeyPatch, version: str, reason: str
) -> None:
    monkeypatch.setattr(mujoco, "__version__", version)
    scene = FreeFourBar()
    motion = DEFAULT.build(scene.mechanism(), scene.spacing)(1, 1)
    [fault] = [warning for warning in motion.warnings if KNOWN_WRONG in warning]
    assert fault.startswith("ours: ")
    assert reason in fault
    assert version in fault
    assert [known_fault(right) for right in ("3.7.0", "3.10.0", "4.0.1")] == [""] * 3
