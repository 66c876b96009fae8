"""Tests that the lines on the page `your_loop` and the programs of recommended settings have the errors of the page."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
import re
from collections.abc import Callable

import mujoco
import numpy as np
import pymunk
import pytest
from pymunk.constraints import RotaryLimitJoint

from engines import method_name
from engines.mujoco.writers import MJCF
from engines.pymunk.written_script import SCRIPT
from reference.scene import Scene
from reports.model.convergence import judged
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.pages.your_loop import page
from reports.pages.your_loop.experiments import LINKAGES, MILLISECONDS_PER_SAMPLE, run_lines
from reports.write.page_tables import Program, advice, advised_programs
from tests.committed_rows import committed_rows, page_rows
from tests.reports.test_pages import MECHANISMS, run_program, texts, undrawn

STEP = 1e-3
LINES_AT_240_HZ = page.PYMUNK_LINES.replace("(space, 1e-3)", "(space, 1 / 240)")


def lines(name: str) -> str:
    return (page.LINE_FILES / f"{name}.txt").read_text(encoding="utf-8")


def error_of(scene: Scene, poses: Callable[[], list[tuple[float, float, float]]], advance: Callable[[], None]) -> float:
    """The largest angle error [rad] of a model over all samples. `advance` moves the model to the next sample."""
    truth = scene.motion(np.linspace(0, scene.duration, scene.samples + 1)).pose
    worst = 0.0
    for exact in truth[1:]:
        advance()
        difference = np.array(poses())[:, 2] - exact[:, 2]
        worst = max(worst, float(np.abs((difference + math.pi) % (2 * math.pi) - math.pi).max()))
    return worst


def in_mujoco(scene: Scene, text: str, pasted: str = "") -> float:
    model = mujoco.MjModel.from_xml_string(text)
    exec(pasted, {"model": model, "mujoco": mujoco})
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mechanism = scene.mechanism()

    def poses() -> list[tuple[float, float, float]]:
        mujoco.mj_forward(model, data)
        results = []
        for body in mechanism.bodies:
            first = data.body(body.name)
            w, _, _, z = first.xquat
            results.append((*first.xpos[:2], body.pose[2] + 2 * math.atan2(z, w)))
        return results

    assert model.opt.timestep == pytest.approx(STEP)
    return error_of(scene, poses, lambda: mujoco.mj_step(model, data, nstep=MILLISECONDS_PER_SAMPLE))


def in_pymunk(scene: Scene, pasted: str) -> float:
    names: dict = {"__name__": "a script"}
    exec(SCRIPT.write(scene.mechanism(), STEP, "default"), names)
    space = names["make"]()
    exec(pasted, {"space": space, "pymunk": pymunk})
    by_name = {body.name: body for body in space.bodies}
    ordered = [by_name[body.name] for body in scene.mechanism().bodies]

    def advance() -> None:
        for _ in range(MILLISECONDS_PER_SAMPLE):
            space.step(STEP)

    return error_of(scene, lambda: [(*body.position, body.angle) for body in ordered], advance)


def row(case, engine) -> float:
    (result,) = committed_rows([page.cell(case, engine)]).values()
    return result.angle


CASES = {case.scene.name: (case, other) for case, other in zip(page.MUJOCO_CASES, page.PYMUNK_CASES, strict=True)}


@pytest.mark.parametrize("scene", [page.LOOP, page.SLIDER, page.CHAIN], ids=lambda scene: scene.name)
def test_the_lines_for_a_compiled_mujoco_model_give_the_published_error(scene):
    case, _ = CASES[scene.name]
    shipped = MJCF.write(scene.mechanism(), STEP, "default")
    # The error of RK4 is far above the solver's tolerance and the rounding of numbers in the file.
    assert in_mujoco(scene, shipped, lines("compiled")) == pytest.approx(row(case, case.after), rel=0.02)


def test_the_xml_lines_give_the_published_error_for_joints_without_settings():
    case, _ = CASES[page.LOOP.name]
    shipped = re.sub(r' sol(ref|imp)="[^"]*"', "", MJCF.write(page.LOOP.mechanism(), STEP, "default"))
    assert in_mujoco(page.LOOP, shipped) > 0.005
    pasted = shipped.replace("</mujoco>", f"{lines('options')}</mujoco>")
    assert in_mujoco(page.LOOP, pasted) == pytest.approx(row(case, case.after), rel=0.02)


def test_the_contact_pair_of_a_rolling_disc_gives_the_published_error():
    case, _ = CASES[page.DISC.name]
    shipped = MJCF.write(page.DISC.mechanism(), STEP, "default")
    ground, wheel = re.findall(r'<geom name="(contact: \w+)"', shipped)[::-1]
    pasted = lines("rolling").replace('"ground"', f'"{ground}"').replace('"wheel"', f'"{wheel}"')
    text = re.sub(r"<contact>.*</contact>", "", shipped, flags=re.DOTALL).replace("</mujoco>", f"{pasted}</mujoco>")
    assert in_mujoco(page.DISC, text) == pytest.approx(row(case, case.after), rel=0.02)


@pytest.mark.parametrize("scene", [page.LOOP, page.SLIDER, page.CHAIN], ids=lambda scene: scene.name)
def test_the_lines_for_pymunk_give_the_published_error(scene):
    _, case = CASES[scene.name]
    shipped, closed = in_pymunk(scene, ""), in_pymunk(scene, page.PYMUNK_LINES)
    # The tolerance is 20 %, since the row and `choose` determine the number of iterations differently.
    assert closed == pytest.approx(row(case, case.after), rel=0.2)
    assert closed < shipped / 8


def state(space: pymunk.Space) -> list:
    bodies = [(body.position, body.angle, body.velocity, body.angular_velocity) for body in space.bodies]
    return [space.iterations, [joint.error_bias for joint in space.constraints], bodies]


def worst_gap(space: pymunk.Space, gaps: Callable, step: float, seconds: float = 10.0) -> float:
    worst = 0.0
    for _ in range(round(seconds / step)):
        space.step(step)
        worst = max(worst, *gaps(space))
    return worst


@pytest.mark.parametrize(  # the page's table has all linkages at 1/240 s
    ("linkage", "step"),
    [
        pytest.param(linkage, step, marks=() if step == 1 / 60 and number % 3 == 0 else pytest.mark.slow)
        for number, linkage in enumerate(LINKAGES)
        for step in (1 / 60, 1 / 240)
    ],
)
def test_the_lines_for_pymunk_increase_the_gaps_of_no_linkage(linkage, step):
    make = LINKAGES[linkage]
    space = make()
    names = run_lines(space, page.PYMUNK_LINES.replace("1e-3", repr(step)))
    if names["choose"](make(), step) is None:
        assert state(space) == state(make())
    else:
        # In the trials of `choose` the gaps fall to a quarter or less, but this motion is longer than the trials.
        assert worst_gap(space, names["gaps"], step) < worst_gap(make(), names["gaps"], step)


def test_the_lines_choose_more_than_eight_iterations_which_tear_a_walking_linkage():
    step, jansen = 1e-3, LINKAGES["two legs of Jansen on a crank"]
    torn = jansen()
    names = run_lines(jansen(), page.PYMUNK_LINES.replace("print(choose(space, 1e-3))", ""))
    names["close"](torn, step, 8)
    shipped = worst_gap(jansen(), names["gaps"], step, 1.0)
    assert worst_gap(torn, names["gaps"], step, 1.0) > 100 * shipped
    chosen = jansen()
    assert names["choose"](chosen, step) == chosen.iterations >= 100
    assert worst_gap(chosen, names["gaps"], step, 1.0) < shipped / 4


def test_the_lines_do_not_change_a_linkage_that_starts_open_or_cannot_be_copied():
    class Picture:
        def __deepcopy__(self, memo):
            raise TypeError("a picture of the screen")

    opened, pictured = LINKAGES["four-bar"](), LINKAGES["four-bar"]()
    next(iter(opened.bodies)).position += (0.05, 0)
    next(iter(pictured.bodies)).picture = Picture()
    earlier = state(opened), state(pictured)
    assert run_lines(opened, LINES_AT_240_HZ)["choose"](opened, 1 / 240) is None
    with pytest.raises(TypeError, match="picture"):
        run_lines(pictured, LINES_AT_240_HZ)
    assert (state(opened), state(pictured)) == earlier


def test_the_lines_do_not_change_limits_or_the_pose_of_a_body_with_an_offset_centre_of_gravity():
    space = LINKAGES["ragdoll that hangs by a hand"]()
    limits = [joint.error_bias for joint in space.constraints if isinstance(joint, RotaryLimitJoint)]
    run_lines(space, LINES_AT_240_HZ)
    assert [j.error_bias for j in space.constraints if isinstance(j, RotaryLimitJoint)] == limits
    off = pymunk.Space()
    body = pymunk.Body(1, 1)
    body.center_of_gravity, body.angle, body.position = (3, 1), 0.7, (5, 2)
    body.velocity, body.angular_velocity = (2, 1), 3
    off.add(body)
    run_lines(pymunk.Space(), LINES_AT_240_HZ)["close"](off, 1e-2, 16)
    assert (*body.position, body.angle) == pytest.approx((5, 2, 0.7), abs=1e-14)


def test_the_lines_reduce_gaps_and_angle_errors_of_a_four_bar_tenfold():
    values = next(task for task in page.BUILT if task.linkage == "four-bar").run()
    gap, angle = np.asarray(values["gap"]), np.asarray(values["angle"])
    assert gap[1] < gap[0] / 10
    assert angle[1] < angle[0] / 10


__all__ = ["undrawn"]

FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
named = pytest.mark.parametrize("page", MECHANISMS, ids=lambda page: page.name)


def advised(page: Page) -> tuple[list[Program], list]:
    """The programs of a page from the committed rows, and the rows of its scene."""
    scene = page.advised_scene
    assert scene is not None
    rows = [row for row in judged(Material(page_rows(page)).sweep([scene]), page.quantity) if row.scene == scene.name]
    methods = tuple(method_name(engine) for engine in page.engines_of(scene))
    result = advice(rows, page.quantity, methods)
    built = advised_programs(scene, result, methods)
    assert {item.method for item in built} == {item.row.method for item in result if item.row is not None}
    return built, rows


@named
def test_a_program_has_the_motion_of_its_method_and_at_most_the_error_of_its_row(page):
    scene = page.advised_scene
    engines = {method_name(engine): engine for engine in page.engines_of(scene)}
    built, rows = advised(page)
    for item in built:
        if not item.text:
            continue
        names, message = run_program(item.text)
        steps, duration = names["steps"], names["duration"]
        assert duration <= min(scene.duration, scene.horizon)
        trajectory = engines[item.method].build(scene.mechanism(), duration / steps)(1, steps)
        body, *end = re.findall(r"^(.*): x = (\S+) m, y = (\S+) m, angle = (\S+) rad$", message)[0]
        reported = re.findall(rf"^# Exact: {body}: x = (\S+) m, y = (\S+) m, angle = (\S+) rad$", item.text, re.M)[0]
        index = scene.mechanism().body_index(body)
        # Programs contain the scene's numbers with twelve digits; the difference grows to a few 1e-11 during the
        # motion.
        assert np.asarray(names["end"]) == pytest.approx(trajectory.pose[-1, index], abs=1e-9), item.file
        assert [float(value) for value in end] == pytest.approx(names["end"], abs=1e-10)
        exact = scene.motion([duration]).pose[0, index]
        assert [float(value) for value in reported] == pytest.approx(exact, abs=1e-10), item.file
        (row,) = [row for row in rows if row.method == item.method and row.step == pytest.approx(duration / steps)]
        far = np.abs(exact - names["end"])
        assert np.hypot(*far[:2]) <= 1.01 * row.position + 1e-9
        assert far[2] <= 1.01 * row.angle + 1e-9


@named
def test_a_pages_block_gives_the_error_of_the_row_of_each_method_without_a_program(page, undrawn):
    built, rows = advised(page)
    blocks = [source for _, source in FENCED.findall(texts(page)[page.document])]
    (block,) = [source for source in blocks if "for method, every in {" in source]
    message = {line.rpartition(": ")[0]: line.rpartition(": ")[2] for line in run_program(block)[1].splitlines()}
    requested = {item.method: item.every for item in built if not item.text}
    assert message.keys() == requested.keys()
    for method, every in requested.items():
        (row,) = [row for row in rows if row.method == method and row.every == every]
        error, unit = message[method].split()
        assert unit == quantity(page.quantity).unit
        assert float(error) == pytest.approx(getattr(row, page.quantity), rel=0.01, abs=1e-12), method
