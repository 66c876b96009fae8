"""Engines that are extras: each is held to the contract, to its order, to the judge, and to leaving nothing behind.

What is not installed is skipped with the sentence that says which extra installs it. A model of MJX takes tens of
seconds to compile, so its tests are slow ones, in tests/test_mjx.py.
"""

from __future__ import annotations

import os
import sys
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from engines import Engine, Promise, Size, Unpromised, Unsupported, mjx, registry, single_run
from engines.conformance.worlds import WORLDS
from engines.lagrange.engine import TRUTH
from engines.pinocchio import Model
from reference.forces import Force, Torque, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reports.cli.selection import choose_cells, choose_engines
from reports.model.catalogue import PAGES, SCENES
from reports.model.cells import QUICK, SLOW_TO_BUILD, beside_cells
from reports.model.ending import BadInput
from reports.search.mechanisms import mechanism
from reports.search.parts import FORCES, LINKS
from tests import mechanisms
from tests.present import present

QUICKLY = tuple(engine for engine in registry.OTHERS if engine.building < SLOW_TO_BUILD)
NAMES = tuple(dict.fromkeys(engine.name for engine in QUICKLY))
BY_NAME = {scene.name: scene for scene in SCENES}
HANGING = present(next((world for world in WORLDS if world.name == "hanging bar"), None))

each = pytest.mark.parametrize("engine", QUICKLY, ids=registry.method)


def installed(engine: Engine) -> Engine:
    """The engine, or a skip that names its package."""
    if engine.missing:
        pytest.skip(engine.missing)
    return engine


def shipped(name: str) -> Engine:
    return installed(next(engine for engine in QUICKLY if engine.name == name))


# Free, driven, with a slider, and chains; a span in which an error grows no faster than linearly.
ORDERED = ("free_four_bar", "driven_four_bar", "driven_slider_crank", "pendulum_2", "pendulum_10")
SPAN = 0.1  # of a scene's duration
# Of the rates of bodies over the span: what is this small is rounding, or Newton's tolerance as shipped.
SMALL = 1e-8
ROOM = 0.35  # below the promised power: the next power of the step still counts at these steps


@each
@pytest.mark.parametrize("name", ORDERED)
def test_errors_of_poses_fall_with_the_promised_power(engine, name):
    installed(engine)
    scene = BY_NAME[name]
    described = scene.mechanism()
    promise = engine.order(described)
    if isinstance(promise, Unpromised):
        assert promise.reason
        return
    errors = []
    for every in (6, 12, 24):
        samples = max(2, round(SPAN * scene.samples))
        run = engine.build(described, scene.spacing / every)(samples, every)
        errors.append(float(np.abs(run.pose - scene.motion(run.t).pose).max()))
    for coarse, fine in pairwise(errors):
        assert fine < SMALL or np.log2(coarse / fine) > min(promise.order, 4) - ROOM, errors


@each
def test_reactions_carry_a_body_that_hangs(engine):
    installed(engine)
    run = engine.build(HANGING.mechanism, 1e-2)(20, 2)
    told = run.reaction[1:]  # a change of velocity can't be told at the start
    assert np.isfinite(told).all()
    weight = HANGING.exact(run.t[1:]).reaction
    # A soft joint that has just been loaded gives way a little; single precision is 1e-7 of 10 m/s over 1e-2 s.
    exact = isinstance(engine.order(HANGING.mechanism), Promise)
    assert np.abs(told - weight)[-1].max() < (1e-6 if exact else 2e-2) * np.abs(weight).max()


# What each engine takes of random mechanisms: most draws of all kinds are refused by those with few joints.
DRAWN = {
    "exudyn": ("pin", "slot", "skate", "drive", *LINKS, *FORCES),
    "box2d": ("pin", "rod", "weld", *FORCES),
    "pinocchio": ("pin", "drive", "weld", *FORCES),
    "bullet": ("pin", "weld", *FORCES),
}


def drawn(engine: Engine, count: int) -> list[Mechanism]:
    """The first mechanisms of a seed that the engine builds."""
    found: list[Mechanism] = []
    for number in range(40):
        one = mechanism(12, number, kinds=DRAWN[engine.name])
        try:
            engine.build(one, 1e-3)
        except Unsupported:
            continue
        found.append(one)
        if len(found) == count:
            break
    return found


# Of the way that bodies go in a fifth of the mechanism's time, in 180 steps: about the order's constant for order 1 and
# 2; of Box2D's soft joints what was met over thirty draws, where a wrong lever or sign is off by the whole way.
JUDGED = {1: 2e-2, 2: 1e-5, 4: 1e-9}
SOFT = 0.3


@each
def test_random_mechanisms_move_as_the_judge_moves_them(engine):
    installed(engine)
    found = drawn(engine, 3)
    assert len(found) == 3
    for one in found:
        spacing = 0.01 * one.time_scale
        truth = TRUTH.build(one, spacing)(20, 1)
        run = engine.build(one, spacing / 9)(20, 9)
        way = np.abs(truth.pose - truth.pose[0]).max()
        promise = engine.order(one)
        bound = SOFT if isinstance(promise, Unpromised) else JUDGED.get(int(min(promise.order, 4)), 1e-9)
        assert np.abs(run.pose - truth.pose).max() < bound * way, (engine, one)


@pytest.mark.parametrize("name", NAMES)
def test_what_an_engine_lacks_is_refused_in_a_sentence_that_names_the_joint(name):
    engine = shipped(name)
    refused: list[bool] = []
    for scene in SCENES:
        described = scene.mechanism()
        named = [repr(part.name) for part in (*described.joints, *described.bodies, *described.forces)]
        try:
            engine.build(described, scene.spacing)
        except Unsupported as reason:
            refused.append(any(word in str(reason) for word in named))
    assert refused
    assert all(refused)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_printed_and_no_file_is_left(name, capfd, tmp_path, monkeypatch):
    engine = shipped(name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    engine.build(BY_NAME["free_four_bar"].mechanism(), 1e-2)(5, 1)
    assert os.listdir(tmp_path) == []
    assert capfd.readouterr() == ("", "")


def test_single_precision_rounds_the_start_and_nothing_worse():
    """Box2D's own functions between angles and rotations are off by 1.6e-3; what it is given and told is not."""
    engine = shipped("box2d")
    described = BY_NAME["pendulum_10"].mechanism()
    run = engine.build(described, 1e-6)(2, 1)
    assert np.abs(run.pose[1] - described.pose).max() < 1e-5


def test_a_rod_shorter_than_box2ds_slop_is_refused_since_it_would_be_longer():
    """Found by the search: the same mechanism in millimetres blew up. The engine's own joint tells its length."""
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
def test_box2d_slows_no_body_down_but_one_that_turns_by_more_than_an_eighth_of_a_turn_in_a_step(speed, rate, told):
    """That is 78.5 rad/s. Found by the search: speeds above 1e6 m/s were cut by our own limit."""
    body = Body("free", 1.0, 1.0, (0.0, 0.0, 0.0), (speed, 0.0, rate))
    run = shipped("box2d").build(Mechanism((body,), ()), 1e-2)(3, 1)
    assert run.twist[-1, 0, 0] == pytest.approx(speed, rel=1e-6)
    assert (run.twist[-1, 0, 2] == pytest.approx(rate, rel=1e-6)) != told
    assert bool(run.warnings) == told


def test_an_engine_that_loses_its_numbers_says_when():
    lost = np.array([[[0.0, 0.0, 0.0]], [[np.nan, 0.0, 0.0]], [[0.0, 0.0, 0.0]]])
    body = Mechanism((Body("body", 1.0, 1.0, (0.0, 0.0, 0.0)),), ())
    found = single_run.Recorded(lost, lost, lost, 0.0, body.inertias, np.zeros(2))
    run = single_run.SingleRun(body, 0.5, Size(1, 3, 0, 0), lambda samples, every: found)(2, 1)
    assert any("0.5 s" in warning for warning in run.warnings)
    assert np.isnan(run.pose[1:]).all()


def test_accelerations_given_at_the_start_are_what_exudyns_reactions_need():
    """As shipped the trapezoidal rule keeps a wrong acceleration of the start for good; see engines/exudyn."""
    from dataclasses import replace

    from engines.exudyn import TUNED, Exudyn

    shipped("exudyn")
    scene = BY_NAME["sleigh"]
    truth = scene.motion(np.arange(101) * scene.spacing)
    errors = {}
    for consistent in (True, False):
        engine = replace(TUNED, consistent=consistent)
        assert isinstance(engine, Exudyn)
        run = engine.build(scene.mechanism(), scene.spacing)(100, 1)
        errors[consistent] = run
    largest = np.abs(truth.reaction).max()
    assert np.abs(errors[True].reaction - truth.reaction).max() < 1e-3 * largest
    assert np.isnan(errors[False].reaction).all()
    assert any("ignore velocity constraints" in each for each in errors[False].warnings)


def test_a_disc_rolls_on_a_line_in_a_body_that_moves_in_exudyn_too():
    """Found by the search: the engine takes no plane that is away from the body's centre of mass, and raised."""
    engine = next(engine for engine in QUICKLY if (engine.name, engine.variant) == ("exudyn", "tuned"))
    installed(engine)
    rolling = [
        one
        for one in (mechanism(5, number, ("pin", "roll")) for number in range(80))
        if any(isinstance(joint, Roll) and joint.first and any(joint.first_point) for joint in one.joints)
    ]
    run = 0
    for one in rolling:
        try:
            found = engine.build(one, 0.01 * one.time_scale)(20, 1)
        except Unsupported:  # another curve
            continue
        truth = TRUTH.build(one, 0.01 * one.time_scale)(20, 1)
        way = np.abs(truth.pose - truth.pose[0]).max()
        assert np.abs(found.pose - truth.pose).max() < 1e-3 * way  # of second order: (a step / the time scale)^2
        run += 1
    assert run >= 3


def test_an_engine_whose_package_is_missing_names_the_extra(monkeypatch):
    monkeypatch.setattr(single_run, "_is_found", lambda module: False)
    for engine in registry.OTHERS:
        told = engine.missing
        assert told.startswith(f"{engine.name} needs the package ")
        assert f"pip install -e '.[{engine.name}]'" in told
        assert "\n" not in told
        inner = getattr(engine, "engine", engine)
        pins = BY_NAME["pendulum_1"].mechanism()
        with pytest.raises(Unsupported, match="needs the package"):
            inner.build(pins, 1e-2)


@pytest.mark.skipif(sys.platform != "linux", reason="the library is one of Linux")
def test_an_engine_whose_shared_library_is_missing_names_it(monkeypatch):
    """As on a small Debian, where Exudyn is installed and can't be imported."""
    monkeypatch.setattr(single_run, "_is_loaded", lambda library: False)
    engine = shipped("box2d")  # which needs none
    assert not engine.missing
    monkeypatch.setattr(single_run, "_is_found", lambda module: True)
    lacking = next(each for each in registry.OTHERS if each.name == "exudyn")
    assert lacking.missing.startswith("exudyn needs the shared library libGL.so.1")
    with pytest.raises(Unsupported, match=r"apt-get install libgl1"):
        lacking.build(BY_NAME["pendulum_1"].mechanism(), 1e-2)


def test_a_missing_engine_is_refused_by_name_in_one_line(monkeypatch):
    monkeypatch.setattr(registry, "ABSENT", {"exudyn": "exudyn needs the package exudyn: pip install -e '.[exudyn]'"})
    with pytest.raises(BadInput, match=r"pip install -e '\.\[exudyn\]'"):
        choose_engines("exudyn", None, registry.ENGINES)
    with pytest.raises(BadInput, match="unknown engine 'exodyn'"):
        choose_engines("exodyn", None, registry.ENGINES)


def test_extras_stand_beside_the_grid_at_its_quick_steps_and_never_in_it():
    scenes = (BY_NAME["free_four_bar"],)
    cells = choose_cells(scenes, (*registry.ENGINES, *registry.INSTALLED), PAGES, full=True)
    # What takes long to build is there only where a page asks for it.
    own = [cell for cell in cells if cell.engine in QUICKLY and cell.scene in scenes]
    assert {cell.purpose for cell in own} <= {"beside"}
    assert {cell.every for cell in own} <= {*QUICK}
    assert {cell.engine for cell in own} == {engine for engine in QUICKLY if not engine.missing}
    assert not beside_cells(scenes, [engine for engine in registry.OTHERS if engine not in QUICKLY])


def test_whole_turns_are_taken_back_by_what_rates_predict():
    t = np.arange(50) * 0.1
    angle = (3.0 * np.sin(2 * t) + 50 * t)[:, None]
    rate = (6.0 * np.cos(2 * t) + 50)[:, None]
    wrapped = np.arctan2(np.sin(angle), np.cos(angle))
    np.testing.assert_allclose(single_run.unwrapped(wrapped, rate, angle[0], 0.1), angle, atol=1e-12)


def test_exudyns_explicit_integrators_take_no_joint():
    """So that none of them is a variant; see engines/exudyn. If this fails, a release has changed it."""
    from engines.exudyn import Exudyn

    shipped("exudyn")
    for name in ("RK44", "VelocityVerlet"):
        explicit = Exudyn("explicit")
        object.__setattr__(explicit, "integrator", name)  # no value of the field: see `Integrator`
        run = explicit.build(BY_NAME["pendulum_1"].mechanism(), 1e-3)(3, 1)
        assert np.isnan(run.pose[1:]).all()
        assert any("gave up" in each for each in run.warnings)


def test_a_name_like_that_of_a_missing_engine_is_answered_with_its_extra(monkeypatch):
    told = "bullet needs the package pybullet: pip install -e '.[bullet]'"
    monkeypatch.setattr(registry, "ABSENT", {"bullet": told})
    with pytest.raises(BadInput) as refused:
        choose_engines("bullett", None, registry.ENGINES)
    assert str(refused.value) == f"unknown engine 'bullett': did you mean 'bullet'? {told}"
    with pytest.raises(BadInput, match=r"did you mean 'pymunk'\?$"):
        choose_engines("pymunkk", None, registry.ENGINES)


def bar(name: str, pose: tuple[float, float, float], twist: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Body:
    return Body(name, 1.0, 0.1, pose, twist)


# What a second configuration shows: a drive or a slot named from the other body than the joint beside it, an angle
# beyond a turn, two forces on one body, a speed that an engine's own limits stop or put to sleep. Durations [s].
HUNG = (Pin("hinge", None, "first", (0.0, 0.0), (-0.5, 0.0)), Pin("joint", "first", "second", (0.5, 0.0), (-0.5, 0.0)))
TWO = (bar("first", (0.5, 0.0, 0.0)), bar("second", (1.5, 0.0, 0.0), (0.0, -1.0, -2.0)))
CONFIGURATIONS = {
    "a drive against its pin": (
        Mechanism(TWO, (*HUNG, Drive("motor", "second", "first", 2.0, 0.0)), (0.0, -9.81)),
        0.3,
    ),
    "a held angle against its slot": (
        Mechanism(
            (TWO[0], bar("second", (0.8, 0.0, 0.4))),
            (
                HUNG[0],
                Slot("guide", "first", "second", (0.3, 0.0), 0.0, (0.0, 0.0)),
                Drive("held", "second", "first", 0.0, -0.4),
            ),
            (0.0, -9.81),
        ),
        0.3,
    ),
    "a spring wound up by more than a turn": (
        Mechanism(
            (bar("wheel", (0.0, 0.0, 0.0), (0.0, 0.0, 10.0)),),
            (Pin("hub", None, "wheel", (0.0, 0.0), (0.0, 0.0)),),
            (0.0, 0.0),
            (TorsionSpring("spring", None, "wheel", 0.1),),
        ),
        1.5,
    ),
    "a gear that turns half as fast, the other way": (
        Mechanism(
            (bar("first", (0.5, 0.0, 0.0)), bar("second", (2.5, 0.0, 0.0))),
            (
                HUNG[0],
                Pin("other hinge", None, "second", (2.0, 0.0), (-0.5, 0.0)),
                Gear("gear", "first", "second", -0.5, 0.0),
            ),
            (0.0, -9.81),
        ),
        0.3,
    ),
    "a torque between two bodies": (
        Mechanism(TWO, HUNG, (0.0, 0.0), (Torque("torque", "first", "second", 1.0),)),
        0.3,
    ),
    "two forces on a body": (
        Mechanism(
            (TWO[0],),
            HUNG[:1],
            (0.0, 0.0),
            (Force("one", "first", (0.5, 0.0), (0.0, 2.0)), Force("other", "first", (0.2, 0.1), (1.0, -1.0))),
        ),
        0.3,
    ),
    "faster than any usual limit": (Mechanism((bar("shot", (0.0, 0.0, 0.0), (1000.0, 0.0, 0.0)),), ()), 0.1),
    "too slow to stay awake": (Mechanism((bar("drifting", (0.0, 0.0, 0.0), (1e-3, 2e-3, 1e-3)),), ()), 1.5),
}


@each
@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_a_second_configuration_moves_as_the_judge_moves_it(engine, name):
    installed(engine)
    own, duration = CONFIGURATIONS[name]
    truth = TRUTH.build(own, duration / 10)(10, 1)
    try:
        run = engine.build(own, duration / 300)(10, 30)
    except Unsupported:
        pytest.skip(f"{engine.name} has no such joint")
    way = np.abs(truth.pose - truth.pose[0]).max()
    promise = engine.order(own)
    bound = SOFT if isinstance(promise, Unpromised) else 2 * JUDGED.get(int(min(promise.order, 4)), 1e-6)
    assert np.abs(run.pose - truth.pose).max() < bound * way


def test_where_exudyn_gives_up_its_last_samples_are_no_numbers():
    engine = shipped("exudyn")
    # Coupler and rocker are 0.57 m each, and the crank's end would have to be 1.29 m from the rocker's pin.
    rate, b, c, d = 2.0, (0.0, 0.4), (0.4, 0.8), (0.8, 0.4)
    bars = (
        mechanisms.bar("crank", (0.0, 0.0), b, rate=rate),
        mechanisms.bar("coupler", b, c, velocity=(-0.4 * rate, 0.0), rate=-rate / 2),
        mechanisms.bar("rocker", d, c, rate=rate / 2),
    )
    half = [body.mass / 2 for body in bars]
    joints = (
        Pin("A", None, "crank", (0.0, 0.0), (-half[0], 0.0)),
        Pin("B", "crank", "coupler", (half[0], 0.0), (-half[1], 0.0)),
        Pin("C", "coupler", "rocker", (half[1], 0.0), (half[2], 0.0)),
        Pin("D", None, "rocker", d, (-half[2], 0.0)),
        Drive("motor", None, "crank", rate, np.pi / 2),
    )
    own = Mechanism(bars, joints)
    run = engine.build(own, 1e-2)(200, 1)
    assert any("gave up" in each for each in run.warnings)
    known = np.all(np.isfinite(run.pose), axis=(1, 2))
    count = int(known.sum())
    assert known[:count].all()
    # The crank gets there after 0.927 rad, and the last sample that the engine wrote before is left out too.
    assert 30 < count < np.ceil(0.927 / rate / 1e-2)
    assert np.abs(own.gap(run.pose[:count], run.t[:count])).max() < 1e-6


def test_pinocchios_euler_drifts_with_the_new_velocity():
    # x'' = -x by hand: half a second of steps of 0.1 s keep an energy that the explicit method doubles.
    model = SimpleNamespace(acceleration=lambda q, v: -q)
    q, v = Model._euler(model, np.array([1.0]), np.array([0.0]), 0.1)  # type: ignore[arg-type]
    assert (q[0], v[0]) == pytest.approx((0.99, -0.1))


def test_pinocchio_tells_no_inertia_of_bodies_that_are_welded_together():
    held = SimpleNamespace(mass=2.0, inertia=np.diag([0.0, 0.0, 0.3]))
    model = SimpleNamespace(_own=[1, 2, 2, 0], model=SimpleNamespace(inertias=[held] * 3))
    told = Model._inertias(model)  # type: ignore[arg-type]
    assert told[0] == pytest.approx([2.0, 2.0, 0.3])
    assert np.isnan(told[1:]).all()


@pytest.mark.parametrize(("joint", "told"), [(None, False), (Rod("rod", None, "bob", (0, 0), (0, 0), 1.0), True)])
def test_mjx_says_what_it_lacks_where_it_lacks_it(monkeypatch, joint, told):
    """Without its compiler: what a run says is decided by the mechanism alone."""
    still = SimpleNamespace(qpos=np.zeros(3), qvel=np.zeros(3), qacc=np.zeros(3))
    device = SimpleNamespace(put_model=lambda model: model, put_data=lambda model, data: still)
    still.qpos = still.qpos.view(Ready)
    monkeypatch.setattr(mjx, "_programs", lambda: (device, lambda held, now, count: now, lambda held, now: now))
    monkeypatch.setattr(mjx.Mjx, "require", lambda self: None)
    own = Mechanism((Body("bob", 1.0, 0.1, (1.0, 0.0, 0.0)),), (joint,) if joint else ())
    run = mjx.DEFAULT.build(own, 1e-2)(2, 1)
    assert run.warnings == ((mjx.NO_VELOCITY_TERM,) if told else ())


class Ready(np.ndarray):
    """An array of JAX that has been worked out."""

    def block_until_ready(self) -> Ready:
        return self
