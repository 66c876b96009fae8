"""The lines to paste, pasted into models as shipped: they err as the page says."""

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

from engines.mujoco.writers import MJCF
from engines.pymunk.written_script import SCRIPT
from reference.scene import Scene
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.guides.experiments import CUTS
from reports.pages.guides.page import PAGES
from reports.pages.rendering import render_page
from reports.pages.your_loop.page import CHAIN, DISC, EVERY, LINES, LOOP, MUJOCO, PYMUNK, SLIDER, aimed, cell, words
from reports.pages.your_model.experiments import MODELS
from reports.write.tables import number
from tests.committed_rows import committed_rows

STEP = 1e-3


def lines(name: str) -> str:
    return (LINES / f"{name}.txt").read_text(encoding="utf-8")


def error_of(scene: Scene, poses: Callable[[], list[tuple[float, float, float]]], advance: Callable[[], None]) -> float:
    """The largest angle error [rad] of a model that `advance` takes from sample to sample."""
    truth = scene.motion(np.linspace(0, scene.duration, scene.samples + 1)).pose
    worst = 0.0
    for exact in truth[1:]:
        advance()
        apart = np.array(poses())[:, 2] - exact[:, 2]
        worst = max(worst, float(np.abs((apart + math.pi) % (2 * math.pi) - math.pi).max()))
    return worst


def in_mujoco(scene: Scene, text: str, pasted: str = "") -> float:
    model = mujoco.MjModel.from_xml_string(text)
    exec(pasted, {"model": model, "mujoco": mujoco})
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mechanism = scene.mechanism()

    def poses() -> list[tuple[float, float, float]]:
        mujoco.mj_forward(model, data)
        found = []
        for body in mechanism.bodies:
            here = data.body(body.name)
            w, _, _, z = here.xquat
            found.append((*here.xpos[:2], body.pose[2] + 2 * math.atan2(z, w)))
        return found

    assert model.opt.timestep == pytest.approx(STEP)
    return error_of(scene, poses, lambda: mujoco.mj_step(model, data, nstep=EVERY))


def in_pymunk(scene: Scene, pasted: str) -> float:
    names: dict = {"__name__": "a script"}
    exec(SCRIPT.write(scene.mechanism(), STEP, "default"), names)
    space = names["make"]()
    exec(pasted, {"space": space, "pymunk": pymunk})
    by_name = {body.name: body for body in space.bodies}
    ordered = [by_name[body.name] for body in scene.mechanism().bodies]

    def advance() -> None:
        for _ in range(EVERY):
            space.step(STEP)

    return error_of(scene, lambda: [(*body.position, body.angle) for body in ordered], advance)


def row(case, engine) -> float:
    (found,) = committed_rows([cell(case, engine)]).values()
    return found.angle


CASES = {case.scene.name: (case, other) for case, other in zip(MUJOCO, PYMUNK, strict=True)}


@pytest.mark.parametrize("scene", [LOOP, SLIDER, CHAIN], ids=lambda scene: scene.name)
def test_the_lines_for_a_compiled_model_of_mujoco_give_the_error_of_the_page(scene):
    case, _ = CASES[scene.name]
    shipped = MJCF.write(scene.mechanism(), STEP, "default")
    # Of RK4 with as many digits in the file as there are: what the solver's tolerance and the file round is far below.
    assert in_mujoco(scene, shipped, lines("compiled")) == pytest.approx(row(case, case.after[0]), rel=0.02)


def test_the_lines_of_xml_give_the_same_on_joints_that_set_nothing_themselves():
    case, _ = CASES[LOOP.name]
    shipped = re.sub(r' sol(ref|imp)="[^"]*"', "", MJCF.write(LOOP.mechanism(), STEP, "default"))
    assert in_mujoco(LOOP, shipped) > 0.005
    pasted = shipped.replace("</mujoco>", f"{lines('options')}</mujoco>")
    assert in_mujoco(LOOP, pasted) == pytest.approx(row(case, case.after[0]), rel=0.02)


def test_the_lines_of_xml_are_taken_at_the_end_of_a_model_that_has_options_and_defaults_of_its_own():
    text = (MODELS / "four_bar.xml").read_text(encoding="utf-8").replace("</mujoco>", f"{lines('options')}</mujoco>")
    model = mujoco.MjModel.from_xml_string(text)
    assert model.eq_solref.tolist() == [[0.005, 1.0]]
    assert (model.opt.timestep, model.opt.integrator) == (1e-3, mujoco.mjtIntegrator.mjINT_RK4)


def test_the_pair_of_a_rolling_disc_gives_the_error_of_the_page():
    case, _ = CASES[DISC.name]
    shipped = MJCF.write(DISC.mechanism(), STEP, "default")
    ground, wheel = re.findall(r'<geom name="(contact: \w+)"', shipped)[::-1]
    pasted = lines("rolling").replace('"ground"', f'"{ground}"').replace('"wheel"', f'"{wheel}"')
    text = re.sub(r"<contact>.*</contact>", "", shipped, flags=re.DOTALL).replace("</mujoco>", f"{pasted}</mujoco>")
    assert in_mujoco(DISC, text) == pytest.approx(row(case, case.after[0]), rel=0.02)


@pytest.mark.parametrize("scene", [LOOP, SLIDER, CHAIN], ids=lambda scene: scene.name)
def test_the_lines_for_pymunk_give_the_error_of_the_page(scene):
    _, case = CASES[scene.name]
    joints = lines("joints")
    if scene is CHAIN:
        joints = joints.replace("space.iterations = 8 ", "space.iterations = 60 ")
    shipped, closed, ahead = in_pymunk(scene, ""), in_pymunk(scene, joints), in_pymunk(scene, joints + lines("start"))
    assert closed == pytest.approx(row(case, case.after[0]), rel=0.05)
    assert ahead < closed / 8 < shipped / 8  # of second order


def test_what_is_done_before_each_step_of_a_skate_is_what_its_program_does():
    for engine, stepped in (("mujoco", "mujoco.mj_step(model, data)"), ("pymunk", "space.step(dt)")):
        assert aimed(engine).endswith(f"    aim()\n    {stepped}")


def test_without_rows_there_are_lines_and_no_tables():
    told = words(Material({}))
    assert (told["mujoco"], told["pymunk"]) == ("", "")
    assert set(told["lines"]) == {"options", "compiled", "rolling", "joints", "start"}


PLAIN = (MODELS / "four_bar.xml").read_text(encoding="utf-8")


def pasted_into(text: str):
    return mujoco.MjModel.from_xml_string(text.replace("</mujoco>", f"{lines('options')}</mujoco>"))


@pytest.mark.parametrize("says", ['<joint damping="0.1"/>', '<equality solref="0.03 1"/>'])
def test_an_equality_of_a_class_keeps_the_values_that_its_class_began_with_as_the_page_says(says):
    """Even if the class sets none for equalities: it has copied its parent's before the lines come."""
    classy = PLAIN.replace("<worldbody>", f'<default><default class="own">{says}</default></default><worldbody>', 1)
    classy = classy.replace("<connect ", '<connect class="own" ')
    model = pasted_into(classy)
    kept = 0.03 if "equality" in says else 0.02
    assert model.eq_solref.tolist() == [[kept, 1.0]]
    exec(lines("compiled"), {"model": model, "mujoco": mujoco})
    assert model.eq_solref.tolist() == [[0.005, 1.0]]
    told = " ".join((LINES.parent / "page.md").read_text(encoding="utf-8").split())
    assert "or is of a class, even one that sets none, keeps" in told


def test_a_model_that_is_attached_keeps_its_stiff_loop_and_gets_the_options_of_its_parent():
    child = mujoco.MjSpec.from_string(PLAIN.replace("</mujoco>", f"{lines('options')}</mujoco>"))
    child.option.gravity = [0, 0, -1.6]
    parent = mujoco.MjSpec()
    frame = parent.worldbody.add_frame()
    parent.attach(child, prefix="a_", frame=frame)
    with pytest.warns(UserWarning, match="Attach conflict"):
        model = parent.compile()
    usual = mujoco.MjSpec().compile()
    assert model.eq_solref.tolist() == [[0.005, 1.0]]
    for option in ("timestep", "integrator", "tolerance"):
        assert getattr(model.opt, option) == getattr(usual.opt, option)
    assert model.opt.gravity.tolist() == usual.opt.gravity.tolist()


def test_the_place_where_a_loop_is_cut_changes_its_error_and_the_page_has_each():
    answers = {task: answered(task) for task in CUTS.values()}
    error = {place: answers[task].number("angle") for place, task in CUTS.items()}
    case, _ = CASES[LOOP.name]
    assert error["C", False] == pytest.approx(row(case, case.after[0]), rel=0.02)  # the tree of the page's own model
    usual = [error[pin, False] for pin in "ABCD"]
    assert max(usual) > 30 * min(usual)
    assert error["C", True] > 3 * error["C", False]
    (page,) = (page for page in PAGES if page.name == "settings")
    text = render_page(page, Material({}, answers), "the command")["settings.md"]
    for pin in "ABCD":
        assert f"| `connect` at pin {pin} | {number(error[pin, False])} | {number(error[pin, True])} |" in text
    assert "which is larger here, so that the loop is softer" in text
    assert "`connect` at pin" not in render_page(page, Material({}), "the command")["settings.md"]
