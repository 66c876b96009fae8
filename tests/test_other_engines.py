"""Engines that are extras: each is held to the contract, to its order, to the judge, and to leaving nothing behind.

What is not installed is skipped with the sentence that says which extra installs it. A model of MJX takes tens of
seconds to compile, so its tests are slow ones, in tests/test_mjx.py.
"""

from __future__ import annotations

import os
import sys
from itertools import pairwise

import numpy as np
import pytest

from engines import Engine, Promise, Size, Unpromised, Unsupported, registry, single_run
from engines.conformance import cases
from engines.conformance.worlds import WORLDS
from engines.lagrange.engine import TRUTH
from reference.joints import Rod
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reports.cli.selection import choose_cells, choose_engines
from reports.grid.cells import QUICK, SLOW_TO_BUILD, beside_cells
from reports.grid.ending import BadInput
from reports.pages.catalogue import PAGES, SCENES
from reports.search.mechanisms import mechanism
from reports.search.parts import FORCES, LINKS
from tests.present import present

QUICKLY = tuple(engine for engine in registry.OTHERS if getattr(engine, "building", 0.0) < SLOW_TO_BUILD)
NAMES = tuple(dict.fromkeys(engine.name for engine in QUICKLY))
BY_NAME = {scene.name: scene for scene in SCENES}
HANGING = present(next((world for world in WORLDS if world.name == "hanging bar"), None))

each = pytest.mark.parametrize("engine", QUICKLY, ids=registry.method)


def installed(engine: Engine) -> Engine:
    """The engine, or a skip that names its package."""
    if registry.missing(engine):
        pytest.skip(registry.missing(engine))
    return engine


def shipped(name: str) -> Engine:
    return installed(next(engine for engine in QUICKLY if engine.name == name))


@each
def test_an_engine_keeps_the_contract(engine):
    installed(engine)
    failed = [
        f"{case}: {result.sentence}"
        for case, result in ((case, case.result()) for case in cases(engine))
        if result.status == "fails"
    ]
    assert not failed, failed


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
        told = registry.missing(engine)
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
    assert not registry.missing(engine)
    monkeypatch.setattr(single_run, "_is_found", lambda module: True)
    lacking = next(each for each in registry.OTHERS if each.name == "exudyn")
    assert registry.missing(lacking).startswith("exudyn needs the shared library libGL.so.1")
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
    assert {cell.engine for cell in own} == {engine for engine in QUICKLY if not registry.missing(engine)}
    assert not beside_cells(scenes, [engine for engine in registry.OTHERS if engine not in QUICKLY])


def test_whole_turns_are_taken_back_by_what_rates_predict():
    t = np.arange(50) * 0.1
    angle = (3.0 * np.sin(2 * t) + 20 * t)[:, None]
    rate = (6.0 * np.cos(2 * t) + 20)[:, None]
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
