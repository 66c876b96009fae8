"""Tests of extra engines: properties of single engines, files, output, and messages about missing packages.

`test_promised` tests orders, elements and configurations of all engines. `test_claims` tests random mechanisms.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from engines import Size, Unsupported, registry, single_run
from engines.lagrange import TRUTH
from engines.mjx import DEFAULT as MJX
from engines.mjx import NO_VELOCITY_TERM
from engines.mjx import VARIANTS as MJX_VARIANTS
from engines.pinocchio import PinocchioModel
from engines.units import counted_in
from reference.forces import Torque
from reference.joints import Drive, Gear, Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.scenes.catalogue import scene
from reference.scenes.four_bar.scenes import OverdrivenFourBar
from reports.cli.selection import choose_engines
from reports.model.catalogue import SCENES
from reports.model.ending import BadInput
from reports.search import motions
from reports.search.mechanisms import mechanism
from reports.search.parts import ALL_KINDS
from reports.search.recipe import build
from reports.search.subjects import Adapted
from tests.engines.test_promised import QUICKLY, installed, meshed, shipped
from tests.mechanisms import ALONE

NAMES = tuple(dict.fromkeys(engine.name for engine in QUICKLY))


@pytest.mark.parametrize("name", NAMES)
def test_a_run_prints_nothing_and_leaves_no_file(name, capfd, tmp_path, monkeypatch):
    engine = shipped(name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    engine.build(scene("free_four_bar").mechanism(), 1e-2)(5, 1)
    assert os.listdir(tmp_path) == []
    assert capfd.readouterr() == ("", "")


def test_the_start_of_box2d_is_the_mechanisms_to_single_precision():
    # The engine's function for the angle of a body would have an error of up to 3e-5 rad.
    described = scene("free_four_bar").mechanism()
    run = shipped("box2d").build(described, 1e-6)(2, 1)
    assert np.abs(run.pose[1] - described.pose).max() < 1e-5


def test_a_rod_shorter_than_box2ds_slop_is_refused():
    # The random search found a mechanism that diverged in units of millimetres.
    engine = shipped("box2d")
    import pyb2d3

    world = pyb2d3.World(gravity=(0.0, 0.0))
    ends = {"body_a": world.create_static_body(position=(0.0, 0.0)), "local_anchor_a": (0.0, 0.0)}
    ends |= {"body_b": world.create_dynamic_body(position=(0.002, 0.0)), "local_anchor_b": (0.0, 0.0)}
    assert world.create_distance_joint(**ends, length=0.002).length == pytest.approx(0.005)
    body = Body("bob", 1.0, 1e-6, (0.002, 0.0, 0.0))
    with pytest.raises(Unsupported, match=r"'rod'.*0\.002 m"):
        engine.build(Mechanism((body,), (Rod("rod", None, "bob", (0.0, 0.0), (0.0, 0.0), 0.002),)), 1e-3)


@pytest.mark.parametrize(("speed", "rate", "told"), [(1e7, 78.0, False), (0.0, 79.0, True)])
def test_box2d_reduces_only_rates_above_an_eighth_of_a_turn_in_a_step(speed, rate, told):
    # An eighth of a turn in a step is a rate of 78.5 rad/s. An earlier limit reduced speeds above 1e6 m/s.
    body = Body("free", 1.0, 1.0, (0.0, 0.0, 0.0), (speed, 0.0, rate))
    run = shipped("box2d").build(Mechanism((body,), ()), 1e-2)(3, 1)
    assert run.twist[-1, 0, 0] == pytest.approx(speed, rel=1e-6)
    assert (run.twist[-1, 0, 2] == pytest.approx(rate, rel=1e-6)) != told
    assert bool(run.warnings) == told


@pytest.mark.parametrize("sample", [1, 2])
def test_the_warning_of_a_diverged_run_has_its_time(sample):
    states = np.zeros((3, 1, 3))
    states[sample, 0, 0] = np.nan
    body = Mechanism((Body("body", 1.0, 1.0, (0.0, 0.0, 0.0)),), ())
    recorded = single_run.Recorded(states, states, states, 0.0, body.inertias, np.zeros(2))
    run = single_run.SingleRun(body, 0.5, Size(1, 3, 0, 0), lambda samples, every: recorded)(2, 1)
    assert run.warnings == (f"ours: at {0.5 * sample:g} s the engine holds no numbers any more",)
    np.testing.assert_array_equal(np.isnan(run.pose).all(axis=(1, 2)), np.arange(3) >= sample)


def test_exudyns_reactions_need_consistent_accelerations_at_the_start():
    # With default settings the trapezoidal rule never reduces the initial error of the acceleration.
    from engines.exudyn import TUNED

    shipped("exudyn")
    sleigh = scene("sleigh")
    right, wrong = (
        replace(TUNED, consistent=consistent).build(sleigh.mechanism(), sleigh.spacing)(100, 1)
        for consistent in (True, False)
    )
    truth = sleigh.motion(right.t).reaction
    assert np.abs(right.reaction - truth).max() < 1e-3 * np.abs(truth).max()
    assert np.isnan(wrong.reaction).all()
    assert any("ignore velocity constraints" in warning for warning in wrong.warnings)


def test_exudyns_motion_does_not_depend_on_units():
    # By default Exudyn takes no step below 1e-8 s and rounds sample times to 1e-10 s, which changed the poses.
    from engines.exudyn import TUNED

    shipped("exudyn")
    linkage = mechanism(5, 1, ("pin", "damper", "torque"))
    dt = 0.01 * linkage.time_scale
    right = TUNED.build(linkage, dt)(5, 1)
    for time in (2.0**-40, 2.0**40):
        run = TUNED.build(counted_in(linkage, 2.0**-40, time), dt / time)(5, 1)
        assert np.array_equal(run.pose, right.pose)
        assert np.array_equal(run.twist / time, right.twist)


def test_exudyns_error_does_not_depend_on_the_mass_ratio():
    # A body of 2e-11 kg m^2 on a body of 0.8 kg m^2 had an error of 6e-7, since the forces were below the tolerance.
    from engines.exudyn import EXTENDED

    shipped("exudyn")
    linkage = build(Adapted(EXTENDED).draw(1140375381, 29, ALL_KINDS, 2))
    answer = motions.motion_errors(EXTENDED, linkage)
    assert isinstance(answer, dict)
    error, bound = answer["estimate"]
    assert error <= bound < 1e-7


def test_the_torque_of_a_motor_of_bullet_is_not_limited():
    # With a torque limit of 1e10 N m, the rate of a body of a million tonnes had an error of a third.
    from engines.bullet import DEFAULT

    shipped("bullet")
    drive = Drive("drive", None, "wheel", 25.0, 0.0)
    wheel = Body("wheel", 1e9, 1e9, (0.5, 0.0, 0.0), (0.0, 12.5, 25.0))
    forces = (Torque("torque", None, "wheel", -1e11),)
    driven = Mechanism((wheel,), (Pin("pin", None, "wheel", (0.0, 0.0), (-0.5, 0.0)), drive), (0.0, 0.0), forces)
    run = DEFAULT.build(driven, 1e-3)(10, 10)
    assert np.abs(run.pose[:, 0, 2] - 25.0 * run.t).max() < 1e-12


def test_a_disc_rolls_on_a_moving_body_in_exudyn():
    # The random search found that the engine refuses a plane if its origin is not the body's centre of mass.
    engine = next(engine for engine in QUICKLY if (engine.name, engine.variant) == ("exudyn", "tuned"))
    linkage = mechanism(5, 3, ("pin", "roll"))
    assert any(isinstance(joint, Roll) and joint.first and any(joint.first_point) for joint in linkage.joints)
    spacing = 0.01 * linkage.time_scale
    pose, truth = (method.build(linkage, spacing)(20, 1).pose for method in (installed(engine), TRUTH))
    # The error at order 2 is (step / time scale)^2.
    assert np.abs(pose - truth).max() < 1e-3 * np.abs(truth - truth[0]).max()


def test_the_message_for_a_missing_package_names_the_extra(monkeypatch):
    monkeypatch.setattr(single_run, "_is_found", lambda module: False)
    monkeypatch.setattr(shutil, "which", lambda program: None)
    for engine in registry.OTHERS:
        sentence = engine.missing
        if engine.steps_in_child:
            assert sentence == f"{engine.name} needs Node, which is not installed, and then: python -m engines.browser"
            continue
        assert sentence.startswith(f"{engine.name} needs the package ")
        assert f"pip install -e '.[{engine.name}]'" in sentence
        assert "\n" not in sentence
        inner = getattr(engine, "engine", engine)
        pins = scene("pendulum_1").mechanism()
        with pytest.raises(Unsupported, match="needs the package"):
            inner.build(pins, 1e-2)


@pytest.mark.skipif(sys.platform != "linux", reason="the library is one of Linux")
def test_the_message_for_a_missing_shared_library_names_it(monkeypatch):
    # On a small Debian system Exudyn can be installed but not imported.
    monkeypatch.setattr(single_run, "_is_loaded", lambda library: False)
    engine = shipped("box2d")  # needs no library
    assert not engine.missing
    monkeypatch.setattr(single_run, "_is_found", lambda module: True)
    lacking = next(engine_ for engine_ in registry.OTHERS if engine_.name == "exudyn")
    assert lacking.missing.startswith("exudyn needs the shared library libGL.so.1")
    with pytest.raises(Unsupported, match=r"apt-get install libgl1"):
        lacking.build(scene("pendulum_1").mechanism(), 1e-2)


def test_a_missing_engine_is_refused_by_name_in_one_line(monkeypatch):
    monkeypatch.setattr(registry, "ABSENT", {"exudyn": "exudyn needs the package exudyn: pip install -e '.[exudyn]'"})
    with pytest.raises(BadInput, match=r"pip install -e '\.\[exudyn\]'"):
        choose_engines("exudyn", None, registry.ENGINES)
    with pytest.raises(BadInput) as refused:
        choose_engines("exodyn", None, registry.ENGINES)
    sentence = registry.ABSENT["exudyn"]
    assert str(refused.value) == f"unknown engine 'exodyn': did you mean 'exudyn'? {sentence}"
    with pytest.raises(BadInput, match=r"did you mean 'pymunk'\?$"):
        choose_engines("pymunkk", None, registry.ENGINES)


def test_samples_after_exudyn_has_stopped_are_nan():
    overdriven = OverdrivenFourBar()
    linkage = overdriven.mechanism()
    run = shipped("exudyn").build(linkage, 1e-2)(200, 1)
    assert any("gave up" in warning for warning in run.warnings)
    is_finite = np.all(np.isfinite(run.pose), axis=(1, 2))
    count = int(is_finite.sum())
    assert is_finite[:count].all()
    # The last sample that the engine has written is not used either.
    assert 20 < count < np.ceil(overdriven.stopping_time / 1e-2)
    assert np.abs(linkage.gap(run.pose[:count], run.t[:count])).max() < 1e-6


def test_pinocchio_returns_no_inertia_of_welded_bodies():
    inertia = SimpleNamespace(mass=2.0, inertia=np.diag([0.0, 0.0, 0.3]))
    model = SimpleNamespace(joint_of=[1, 2, 2, 0], model=SimpleNamespace(inertias=[inertia] * 3))
    inertias = PinocchioModel._inertias(model)  # type: ignore[arg-type]
    assert inertias[0] == pytest.approx([2.0, 2.0, 0.3])
    assert np.isnan(inertias[1:]).all()


@pytest.mark.parametrize(("first", "second"), [("a", "b"), ("b", "a")])
@pytest.mark.parametrize("name", ["exudyn", "bullet"])
def test_gears_on_the_ground_return_their_reactions(name, first, second):
    engine, linkage = shipped(name), meshed(-2.5, first, second)
    exact = TRUTH.build(linkage, 0.05)(6, 1).reaction
    run = engine.build(linkage, 0.05 / 40)(6, 40).reaction
    assert np.abs(run - exact)[2:].max() < 1e-2 * np.abs(exact).max()
    if name == "bullet":
        hung = ALONE["weld"].bodies[1].name
        chained = replace(ALONE["torque"], joints=(*ALONE["torque"].joints, Gear("mesh", "a", hung, 2.0, 0.5 - 0.6)))
        with pytest.raises(Unsupported, match="joint 'mesh': a gear of bullet is between two of its joints"):
            engine.build(chained, 1e-3)


# ------------------------------------------------------------------------------- MJX

BY_NAME = {scene.name: scene for scene in SCENES}


@pytest.fixture
def with_mjx() -> None:
    installed(MJX)


@pytest.fixture(autouse=True)
def _programs_forgotten():
    """Clear the compiled programs after each test. JAX crashes after some hundreds of programs."""
    yield
    if "jax" in sys.modules:
        sys.modules["jax"].clear_caches()


NO_DEVICE = """
from engines import Unsupported
from engines.mjx import DEFAULT as MJX
from reference.scenes.catalogue import SCENES
scene = next(each for each in SCENES if each.name == "pendulum_2")
try:
    MJX.build(scene.mechanism(), 1e-2)
except Unsupported as reason:
    print(reason)
"""


@pytest.mark.slow
@pytest.mark.usefixtures("with_mjx")
def test_a_missing_device_is_refused_in_one_line():
    environment = {**os.environ, "JAX_PLATFORMS": "cuda"}
    run = subprocess.run([sys.executable, "-c", NO_DEVICE], capture_output=True, text=True, env=environment, check=True)
    assert run.stdout == "JAX finds no device to run on here: JAX_PLATFORMS is 'cuda'\n"


def geared(arm: float, light: float, wheel: float, gravity: tuple[float, float]) -> Mechanism:
    """A pendulum of 2 g with a gear to a free body of 20 t. `light` and `wheel` are the inertias [kg m^2]."""
    bodies = Body("pendulum", 2e-3, light, (0.0, 0.0, 0.0)), Body("free", 2e4, wheel, (0.0, 0.0, 0.0))
    pin = Pin("pin", None, "pendulum", (arm, -arm), (arm, -arm))
    return Mechanism(bodies, (pin, Gear("gear", "pendulum", "free", 2.0, 0.0)), gravity=gravity)


@pytest.mark.slow
@pytest.mark.usefixtures("with_mjx")
def test_a_residual_of_the_solver_is_a_warning():
    # The default tolerance is relative to the sum of inertias, so a wheel of 1e-6 kg m^2 has no effect.
    run = MJX.build(geared(500.0, 500.0, 1e-6, (-1e-3, 9e-4)), 12.0)(4, 10)
    assert [warning.startswith("ours: the solver missed the accelerations") for warning in run.warnings] == [True]
    mended = replace(MJX, settings=replace(MJX.settings, tolerance=1e-28))
    assert mended.build(geared(500.0, 500.0, 1e-6, (-1e-3, 9e-4)), 12.0)(4, 10).warnings == ()


# One element for each construction in the model, such as tendons, actuators and equalities, and a tree.
COMPILED = ("spring", "torsion spring", "force", "gear", "rod", "weld", "pendulum_2")


@pytest.mark.slow
@pytest.mark.usefixtures("with_mjx")
@pytest.mark.parametrize("name", COMPILED)
def test_elements_move_as_in_mujoco(name):
    mechanism = ALONE[name] if name in ALONE else BY_NAME[name].mechanism()
    exact = TRUTH.build(mechanism, 0.05)(6, 1)
    for engine in MJX_VARIANTS if name == "pendulum_2" else (MJX,):
        first, second = (method.build(mechanism, 2e-3)(6, 25) for method in (engine, engine.settings))
        np.testing.assert_allclose(first.pose, second.pose, rtol=0, atol=1e-11)
        np.testing.assert_allclose(first.reaction, second.reaction, rtol=0, atol=1e-8)
        # The mechanism with the gear has a rod.
        assert first.warnings == ((NO_VELOCITY_TERM,) if name in ("rod", "gear") else ())
        assert np.abs(first.pose - exact.pose).max() < 1e-2
