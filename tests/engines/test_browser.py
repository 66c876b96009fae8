"""Tests of the engines in the browser: refusals, warnings of reduced velocities, and the child process."""

from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported
from engines.browser import VARIANTS, install
from engines.browser.engine import BrowserEngine, child_of, joint_requests
from reference.joints import Body, Drive, Pin, Slot
from reference.mechanism import Mechanism
from reference.scenes.catalogue import scene

DEFAULTS = [engine for engine in VARIANTS if isinstance(engine, BrowserEngine) and engine.variant == "default"]
AXLE = Pin("axle", None, "bar", (0.0, 0.0), (-0.5, 0.0))
GUIDE = Slot("guide", None, "bar", (0.0, 0.0), 0.0, (0.0, 0.0))


def bar(angle=0.0, x=0.0, twist=(0.0, 0.0, 0.0)):
    return Body("bar", 1.0, 1 / 12, (x, 0.0, angle), twist)


def shot(speed, rate):
    return Mechanism((bar(twist=(speed, 0.0, rate)),), ())


def engine_named(name: str, variant: str = "default") -> BrowserEngine:
    engine = next(engine for engine in VARIANTS if (engine.name, engine.variant) == (name, variant))
    assert isinstance(engine, BrowserEngine)
    if engine.missing:
        pytest.skip(engine.missing)
    return engine


DRIVE = Drive("drive", None, "bar", 1.0, 0.0)
REFUSED = {
    "a drive without a pin": (Mechanism((bar(twist=(0.0, 0.0, 1.0)),), (DRIVE,)), "jolt", "belongs to a pin"),
    "two drives of a pin": (
        Mechanism((bar(x=0.5, twist=(0.0, 0.5, 1.0)),), (AXLE, DRIVE, replace(DRIVE, name="again"))),
        "planck",
        "drive 'again': .* second drive",
    ),
    "a block that turns in a slot": (Mechanism((bar(twist=(0.0, 0.0, 1.0)),), (GUIDE, DRIVE)), "p2", "turns no block"),
    "a slot alone, in Jolt": (Mechanism((bar(),), (GUIDE,)), "jolt", "joint 'guide'"),
    "a slot with an angle, in Rapier": (
        Mechanism((bar(0.3),), (GUIDE, Drive("drive", None, "bar", 0.0, 0.3))),
        "rapier",
        "equal angles",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_the_adapter_refuses_by_name_a_drive_that_is_no_motor_and_a_slot_that_is_no_joint_of_the_engine(case):
    mechanism, engine, named = REFUSED[case]
    with pytest.raises(Unsupported, match=named):
        joint_requests(mechanism, engine)


def test_a_motor_has_the_sign_of_the_order_in_which_its_pin_names_the_bodies():
    motors = []
    for pin in (AXLE, Pin("axle", "bar", None, (-0.5, 0.0), (0.0, 0.0))):
        mechanism = Mechanism((bar(x=0.5, twist=(0.0, 0.5, 1.0)),), (pin, DRIVE))
        motors += [request["motor"] for request in joint_requests(mechanism, "planck")]
    assert motors == [1.0, -1.0]


@pytest.mark.parametrize(
    ("name", "variant", "mechanism", "is_cut"),
    [
        ("planck", "default", shot(3000.0, 0.0), True),
        ("planck", "default", shot(0.0, 2000.0), True),
        ("planck", "default", shot(1000.0, 1000.0), False),
        ("planck", "tuned", shot(3000.0, 2000.0), False),
        ("rapier", "default", shot(500.0, 0.0), True),
        ("rapier", "tuned", shot(0.0, 800.0), True),
        ("rapier", "default", shot(300.0, 400.0), False),
        ("p2", "default", shot(1e5, 1e5), False),
        ("jolt", "default", shot(1e5, 1e3), False),
    ],
)
def test_a_run_in_which_the_engine_reduces_a_velocity_has_a_warning(name, variant, mechanism, is_cut):
    run = engine_named(name, variant).build(mechanism, 1e-3)(4, 5)
    assert [getattr(warning, "kind", "") for warning in run.warnings] == ["rate limit"] * is_cut
    way = np.abs(run.pose[-1] - mechanism.pose - 0.02 * mechanism.twist).max()
    assert (way > 0.1) == is_cut


@pytest.mark.parametrize("name", [engine.name for engine in DEFAULTS])
def test_an_engine_runs_again_after_its_process_was_ended_from_outside(name):
    engine, mechanism = engine_named(name), scene("pendulum_1").mechanism()
    before = engine.build(mechanism, 1e-3)(3, 5)
    run = engine.build(mechanism, 1e-3)
    process = child_of(engine.name, engine.settings).process
    process.kill()
    process.wait()
    with pytest.raises((RuntimeError, OSError)):
        run(3, 5)
    assert np.array_equal(engine.build(mechanism, 1e-3)(3, 5).pose, before.pose)


def test_without_npm_the_installation_ends_with_one_line(monkeypatch, tmp_path):
    monkeypatch.setenv("PLANAR_CROSSCHECK_CACHE", str(tmp_path))
    monkeypatch.setenv("PATH", "")
    with pytest.raises(SystemExit, match="npm"):
        install()


# The first run of a process fails. Each later call returns its number as the CPU time [s].
FIRST_RUN_FAILS = """
let calls = 0;
process.cpuUsage = () => {
  if (++calls === 1) throw new Error("a run begins");
  return { user: 1e6 * calls, system: 0 };
};
"""


@pytest.mark.parametrize("name", [engine.name for engine in DEFAULTS])
def test_the_trial_runs_belong_to_the_first_run_which_is_refused_if_a_trial_fails(name, monkeypatch, tmp_path):
    """`crosscheck list` builds all scenes, so a build makes no steps."""
    (tmp_path / "first.cjs").write_text(FIRST_RUN_FAILS, encoding="utf-8")
    engine, mechanism = engine_named(name), scene("pendulum_1").mechanism()
    monkeypatch.setattr("engines.browser.engine._children", {})
    monkeypatch.setenv("NODE_OPTIONS", f"--require {tmp_path / 'first.cjs'}")
    run = engine.build(mechanism, 1e-3)
    with pytest.raises(Unsupported, match=r"^the engine refuses it: a run begins$"):
        run(3, 5)
    # The next run makes the trial runs again: calls 2 to 7 are of three trial runs, 8 and 9 of the run itself.
    assert engine.build(mechanism, 1e-3)(3, 5).stepping == 9
    child = child_of(engine.name, engine.settings)
    child.close()
    child.process.wait()
