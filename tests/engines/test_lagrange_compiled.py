"""Comparison of compiled code with numpy, and tests of tables, windows and warnings of the compiled code."""

from __future__ import annotations

import cmath
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from engines import Regularisation
from engines.lagrange import METHODS, Lagrange, loading
from engines.lagrange.compiled_model import CompiledModel
from engines.lagrange.dynamics import Dynamics
from engines.lagrange.methods import RK4
from engines.lagrange.system import FORCE_FIELDS, JOINT_FIELDS, system_of
from reference.couplings import Coupling
from reference.forces import CoupledForce, Damper, TorsionDamper
from reference.joints import Body, Pin, Rod
from reference.mechanism import Mechanism
from reference.scenes.catalogue import scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.pendulum.scenes import HundredLinks, LongPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reference.trajectory import joint_gap, slip
from reports.gate.judge import in_numpy, integrate
from reports.search.mechanisms import mechanism as random_mechanism
from reports.search.parts import ALL_KINDS
from tests.mechanisms import four_bar, pendulum
from tests.present import present

pytestmark = pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")


def differences(mechanism: Mechanism, method: Lagrange, dt: float, every: int = 2) -> tuple[float, float]:
    """The largest differences of poses and twists between compiled code and numpy, in units of the mechanism."""
    unit = mechanism.pose_unit
    runs = [replace(method, compiled=compiled).build(mechanism, dt)(2, every) for compiled in (True, False)]
    pose, twist = (np.abs((getattr(runs[0], name) - getattr(runs[1], name)) / unit).max() for name in ("pose", "twist"))
    return float(pose), float(twist * mechanism.time_scale)


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)
def test_compiled_methods_equal_numpy_to_rounding(method):
    # Baumgarte's spring divides rounding errors by the square of 5e-3 s, and a step multiplies them by 1e-3 s.
    allowed = 1e-11 if method.stabilisation == "baumgarte" else 1e-13
    assert max(differences(four_bar(crank_rate=3.0), method, 1e-3, 5)) < allowed


@pytest.mark.parametrize("number", range(12))
def test_compiled_motions_of_random_mechanisms_equal_numpy(number):
    mechanism = random_mechanism(21, number, ALL_KINDS)
    # The largest difference in the first 150 mechanisms is 1.2e-14.
    assert max(differences(mechanism, Lagrange("rk4"), 1e-3 * mechanism.time_scale)) < 1e-12


@pytest.mark.parametrize("number", range(12))
def test_compiled_accelerations_equal_numpy_in_states_that_violate_joints(number):
    # The states violate the joints, since some terms of the bias vanish without slip.
    mechanism, random = random_mechanism(21, number, ALL_KINDS), np.random.default_rng(number)
    pose = mechanism.pose + 1e-2 * mechanism.pose_unit * random.normal(size=mechanism.pose.shape)
    twist = mechanism.twist + mechanism.pose_unit / mechanism.time_scale * random.normal(size=pose.shape)
    _, acceleration = present(CompiledModel.of(mechanism)).reactions(1.0, pose[None], twist[None])
    expected = Dynamics(mechanism).acceleration(pose, twist, 0.0)
    size = np.abs(expected / mechanism.pose_unit).max()
    assert np.abs((acceleration[0] - expected) / mechanism.pose_unit).max() < 1e-10 * size


def test_the_random_mechanisms_have_all_compiled_joints_and_forces():
    mechanisms = [random_mechanism(21, number, ALL_KINDS) for number in range(12)]
    kinds = {type(part) for mechanism in mechanisms for part in (*mechanism.joints, *mechanism.forces)}
    assert kinds == {*JOINT_FIELDS, *FORCE_FIELDS} - {Coupling, CoupledForce}  # see test_couplings.py


def test_redundant_rows_do_not_change_the_motion_and_share_the_reaction():
    mechanism = four_bar(crank_rate=3.0)
    twice = replace(mechanism, joints=(*mechanism.joints, replace(mechanism.joints[2], name="C again")))
    once, again = (Lagrange("rk4").build(m, 1e-3)(10, 2) for m in (mechanism, twice))
    np.testing.assert_allclose(again.pose, once.pose, rtol=0, atol=1e-13)
    # In the minimum-norm solution each of the two pins carries half of the load.
    np.testing.assert_allclose(again.reaction[:, 4:6], once.reaction[:, 4:6] / 2, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(again.reaction[:, 8:], once.reaction[:, 4:6] / 2, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("links", [100, 1000])
def test_the_matrix_of_a_long_chain_has_a_narrow_envelope(links):
    scene = LongPendulum(links=links)
    system, _ = system_of(scene.mechanism())
    assert len(system.matrix) < 4 * len(system.rows)  # Rows of neighbouring pins are coupled.
    run = Lagrange("rk4").build(scene.mechanism(), 1e-4)(2, 2)
    truth = scene.motion(run.t)
    # The chain has hardly moved after 2e-4 s, so the rates of the links are compared.
    assert np.max(np.abs(run.twist - truth.twist)) < 1e-9 * links


def test_the_matrix_of_a_tree_with_a_loop_has_few_entries_and_its_motion_equals_numpy():
    starts, angles = [0j], [0.4 * k % 1.3 for k in range(41)]
    for k in range(1, 41):  # two bars hang at the end of each earlier bar
        starts.append(starts[(k - 1) // 2] + cmath.rect(1.0, angles[(k - 1) // 2]))
    centres = [start + cmath.rect(0.5, angle) for start, angle in zip(starts, angles, strict=True)]
    bars = tuple(Body(f"bar {k}", 1.0, 0.1, (z.real, z.imag, angles[k])) for k, z in enumerate(centres))
    pins = [Pin("pin 0", None, "bar 0", (0.0, 0.0), (-0.5, 0.0))]
    pins += [Pin(f"pin {k}", f"bar {(k - 1) // 2}", f"bar {k}", (0.5, 0.0), (-0.5, 0.0)) for k in range(1, 41)]
    loop = Rod("loop", "bar 13", "bar 40", (0.0, 0.0), (0.0, 0.0), abs(centres[40] - centres[13]))
    for joints, most in (((*pins,), 4.5), ((*pins, loop), 7.0)):
        mechanism = Mechanism(bars, joints, (3.0, -9.81))
        system, _ = system_of(mechanism)
        assert len(system.matrix) < most * len(system.rows)
        assert max(differences(mechanism, Lagrange("rk4"), 1e-3)) < 1e-12


def test_a_projection_with_an_older_factor_removes_the_slip():
    mechanism = HundredLinks().mechanism()
    run = Lagrange("euler").build(mechanism, 1e-3)(4, 25)
    # Without the correction for the older factor the slip would be 3e-12 m/s.
    assert np.abs(slip(mechanism, run)).max() < 1e-13
    assert np.abs(joint_gap(mechanism, run)).max() < 1e-13


def test_the_window_of_a_table_moves_with_the_rotation():
    mechanism = RollingEllipse().mechanism()
    model = present(CompiledModel.of(mechanism))
    steps = model.empty_samples(10), model.empty_samples(10)
    model.fixed_steps(RK4, 8, 1e-3, 2, 0, *steps[0])
    model.windows.cells[:] = np.nan  # The table has no cells at this rotation.
    model.system.rolls["first_cell"] = model.system.rolls["cell_count"] = 0
    model.fixed_steps(RK4, 8, 1e-3, 2, 0, *steps[1])
    np.testing.assert_array_equal(steps[0], steps[1])


def test_numpy_completes_a_run_if_a_table_has_no_cell(monkeypatch):
    mechanism = RollingEllipse().mechanism()
    expected = Lagrange("rk4", compiled=False).build(mechanism, 1e-3)(4, 2)
    monkeypatch.setattr("engines.lagrange.compiled_model.CellWindows.move", lambda self, which, theta: False)
    run = Lagrange("rk4").build(mechanism, 1e-3)(4, 2)
    np.testing.assert_array_equal(run.pose, expected.pose)
    np.testing.assert_array_equal(run.reaction, expected.reaction)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_run_ends_with_a_warning_if_the_tolerance_needs_too_many_steps(compiled, monkeypatch):
    monkeypatch.setattr("engines.lagrange.dynamics.MOST_NUMPY_STEPS", 200)  # Numpy ends sooner.
    # A bar of 1e-12 m under a large gravity has a very short period, so many steps are needed.
    fast = replace(pendulum(length=1e-12), gravity=(0.0, -1e6))
    hopeless = Lagrange(tolerance=1e-14, compiled=compiled).build(fast, 1.0)(2, 1)
    assert np.isnan(hopeless.pose[-1]).all()
    assert "can't be held beyond" in hopeless.warnings[0]


REGULARISATIONS = (
    Regularisation(2500.0, 100.0, 0.01, (True,) * 8),
    Regularisation(2500.0, 100.0, 0.0, (True,) * 8, complete=False),
    Regularisation(2500.0, 100.0, 0.01, (True, True, False, False, True, True, False, True)),
)


@pytest.mark.parametrize("soft", [None, *REGULARISATIONS])
@pytest.mark.parametrize("project", [False, True])
def test_the_gates_judge_in_compiled_code_equals_numpy(soft, project):
    scene = FreeFourBar(duration=0.05)
    run = integrate(scene, 4, 4, soft, project)
    expected = in_numpy(scene.mechanism(), len(run.t) - 1, scene.spacing, 4, 4, soft, project)
    np.testing.assert_allclose(run.pose, expected.pose, rtol=0, atol=1e-13)
    np.testing.assert_allclose(run.reaction, expected.reaction, rtol=0, atol=1e-10 * np.abs(expected.reaction).max())


def test_a_command_without_steps_does_not_import_numba():
    program = "import sys, reports.cli.commands, engines.registry as r; r.ENGINES; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False"]


def test_a_stiff_motion_is_reported():
    # The time constant of the damper is a millionth of the time scale, so stability limits explicit steps.
    scene = FreeFourBar()
    damped = replace(
        scene.mechanism(),
        forces=(Damper("stop", None, scene.mechanism().bodies[2].name, (3.0, 0.0), (0.0, 0.0), 1e5),),
    )
    run = Lagrange(tolerance=1e-8).build(damped, 0.01)(10, 1)
    assert any("stability and not accuracy sets the steps" in warning for warning in run.warnings)
    turned = replace(damped, forces=(TorsionDamper("stop", None, damped.bodies[2].name, 1e5),))
    assert Lagrange(tolerance=1e-8).build(turned, 0.01)(10, 1).warnings
    assert Lagrange(tolerance=1e-8).build(scene.mechanism(), 0.01)(10, 1).warnings == ()


def test_fixed_steps_that_end_beside_a_singular_position_have_a_warning():
    parallelograms = scene("n_four_bar_10")
    for steps_per_sample, is_near in ((4, False), (64, True)):
        step = parallelograms.spacing / steps_per_sample
        run = Lagrange("dop853").build(parallelograms.mechanism(), step)(20, steps_per_sample)
        assert any("beside a singular position" in warning for warning in run.warnings) == is_near
