"""Tests of the engines in lessons, in Chromium, which `tests/tools/browser.sh` installs."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines import Unsupported, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco.stiffness import STIFFEST, TiedToStep
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.site.lesson import Claim
from reports.site.lessons import LESSONS
from reports.site.live.models import PYTHON_ONLY
from reports.site.live.sliders import DOCUMENTED, ENGINES, Live
from tests.reports.site_in_browser import BY_NAME, FIXTURES, marked, number_of, python_of, run_engines

address, chromium, files, opened, running = FIXTURES

SCENES = [marked(lesson.name, live.word) for lesson in LESSONS for live in lesson.scenes]
# Largest difference between an engine in the page and in Python, relative to the size of the motion. Differences are
# below 1e-13 unless a motion amplifies rounding. The largest measured difference is 3e-7, in polygonal gears. With two
# ellipses the difference is 1.3e-2, because MuJoCo's collision iteration ends at ccd_tolerance (1e-6).
APART = {"gears": 5e-2, "rolling": 1e-7, "wheels": 1e-6, "skate": 1e-9, "slider_crank": 1e-8}
MUNK_APART = {"gears": 1e-5}


def moved(live: Live) -> dict[str, Any]:
    """Return settings with the last value of every slider."""
    methods = {name: live.methods(name)[-1][0] for name in ENGINES} if len(live.munk) > 2 else {}
    engines = {"iterations": 20, "bias": 1e-6, "integrator": 3, "tolerance": 1e-15}
    return {
        "steps": live.steps[2],
        **engines,
        **methods,
        **{slider.field: slider.values[-1] for slider in live.sliders},
    }


GIVEN = {"as shipped": lambda live: {}, "documented": lambda live: dict.fromkeys(ENGINES, DOCUMENTED), "moved": moved}


@pytest.mark.parametrize("variant", GIVEN)
@pytest.mark.parametrize(("lesson", "word"), SCENES)
def test_the_engines_in_the_page_compute_the_motions_of_python(running, lesson, word, variant):
    live = BY_NAME[lesson].scene(word)
    values = GIVEN[variant](live)
    answer = run_engines(running(lesson), lesson, word, values)
    scene, engines, step = python_of(live, values)
    samples = live.samples(round(scene.duration / step))
    every = round(scene.duration / step) // samples
    truth = scene.motion(np.arange(samples + 1) * (scene.duration / samples)).pose
    size = max(1.0, float(np.abs(truth).max()))
    # The page overestimates the error of its integration by a factor of about ten.
    missed = answer["exact"]["missed"] or 0.0
    assert np.abs(np.reshape(answer["exact"]["pose"], truth.shape) - truth).max() < missed + 1e-12 * size
    assert missed < 1e-5
    for name, method in engines.items():
        try:
            python = method.build(scene.mechanism(), step)(samples, every)
        except (Unsupported, AttributeError):  # AttributeError means that the engine is a string
            assert name in answer["lost"]
            continue
        if name in answer["lost"]:
            assert answer["lost"][name] == PYTHON_ONLY
            continue
        page = np.reshape(np.array(answer["motions"][name]["pose"], dtype=float), python.pose.shape)
        is_missing = np.isnan(page)  # NaN means that MuJoCo has reset the motion or that it diverged
        is_compared = ~is_missing & np.isfinite(python.pose)
        assert np.array_equal(is_missing, ~np.isfinite(python.pose) | (np.abs(python.pose) > 1e6))
        difference = np.abs(page - python.pose)[is_compared].max() / max(
            1.0, float(np.abs(python.pose[is_compared]).max())
        )
        assert difference < (APART if name == "mujoco" else MUNK_APART).get(lesson, 1e-12)


EXPERIMENTS = [marked(lesson.name, number) for lesson in LESSONS for number, _ in enumerate(lesson.experiments)]


def numbers(running: Any, lesson: str, number: int, *changes: Any) -> Any:
    """Return the answer of the page for an experiment with changes of its settings."""
    experiment = BY_NAME[lesson].experiments[number]
    values = {name: value for change in (experiment.before, *changes) for name, value in change.items()}
    return run_engines(running(lesson), lesson, experiment.scene, values, None, experiment.quantities)


def assert_claim(claim: Claim, before: Any, after: Any) -> None:
    value = number_of(after, claim) if claim.is_value else number_of(after, claim) / number_of(before, claim)
    assert claim.least <= value <= claim.most, (claim, value)


@pytest.mark.parametrize(("lesson", "number"), EXPERIMENTS)
def test_the_claims_and_the_causes_of_an_experiment_hold(running, lesson, number):
    experiment = BY_NAME[lesson].experiments[number]
    start, end = numbers(running, lesson, number), numbers(running, lesson, number, experiment.after)
    for claim in experiment.claims:
        assert_claim(claim, start, end)
    for cause in experiment.causes:
        assert_claim(cause, end, numbers(running, lesson, number, experiment.after, cause.change))


@pytest.mark.parametrize(("lesson", "number"), EXPERIMENTS)
def test_the_runs_contradict_every_wrong_answer_and_agree_with_the_right_one(running, lesson, number):
    experiment = BY_NAME[lesson].experiments[number]
    start, end = numbers(running, lesson, number), numbers(running, lesson, number, experiment.after)
    for (words, is_right), guess in zip(experiment.answers, experiment.guesses, strict=False):
        run = end if guess.change is None else numbers(running, lesson, number, guess.change)
        for claim in guess.claims:
            assert_claim(claim, start, run)
        claims = [Claim(engine, of=guess.of) for engine in guess.times]
        measured = [number_of(run, claim) / number_of(start, claim) for claim in claims]
        close = 1.5 if guess.of else 3.0  # errors vary more than other quantities
        pairs = zip(guess.times.values(), measured, strict=True)
        agrees = [expected / close < value < close * expected for expected, value in pairs]
        if guess.times:
            assert all(agrees) == is_right, (words, measured)


LET_GO = (("four_bar", "let go"), ("slider_crank", "let go"), ("pendulum", "two links"))


@pytest.mark.parametrize(("lesson", "word"), [marked(*each) for each in LET_GO])
def test_a_mechanism_that_the_reader_releases_moves_as_in_python(running, lesson, word):
    page, live = running(lesson), BY_NAME[lesson].scene(word)
    mechanism = live.scene.mechanism()
    start = live.scene.motion([0.37 * live.scene.duration]).pose[0]
    answer = run_engines(page, lesson, word, {}, start.ravel().tolist())
    bodies = [
        replace(b, pose=tuple(p), twist=(0.0,) * 3) for b, p in zip(mechanism.bodies, start.tolist(), strict=True)
    ]
    released = Mechanism(tuple(bodies), mechanism.joints, mechanism.gravity)
    steps = live.steps[live.start]
    samples, step = live.samples(steps), live.scene.duration / steps
    exact = Lagrange("dop853", "projection").build(released, live.scene.duration / samples / 10)(samples, 10).pose
    error = np.abs(np.reshape(answer["exact"]["pose"], exact.shape) - exact).max()
    assert error < 1e-8
    # The page states the difference from a motion with a tolerance that is a hundred times as large.
    assert error < answer["exact"]["missed"] + 1e-12 < 1e-6
    python = pymunk.DEFAULT.build(released, step)(samples, steps // samples).pose
    assert np.abs(np.reshape(answer["motions"]["munk"]["pose"], python.shape) - python).max() < 1e-9
    # The stiffness of MuJoCo's loops depends on the pose at which a model is compiled, so Python's motion differs.
    tuned = run_engines(page, lesson, word, {"mujoco": DOCUMENTED}, start.ravel().tolist())
    assert np.abs(np.array(tuned["motions"]["mujoco"]["pose"][: start.size]) - start.ravel()).max() < 1e-12
    assert tuned["motions"]["mujoco"]["error"] < 0.01 < answer["motions"]["mujoco"]["error"] < 3


def test_a_dragged_linkage_stays_closed(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")  # the animation does not start
    pin = page.locator(".motion.truth .body").nth(1).locator("circle").first.bounding_box()
    page.mouse.move(pin["x"] + pin["width"] / 2, pin["y"] + pin["height"] / 2)
    page.mouse.down()
    page.mouse.move(pin["x"] + 40, pin["y"] + 30, steps=5)
    page.mouse.up()
    page.wait_for_function("document.querySelector('.status').textContent.includes('with an error of at most')")
    first = "crosscheck.ask({ setting: crosscheck.setting() }).then(({ exact }) => [...exact.pose.slice(0, 9)])"
    pose = page.evaluate(first)
    assert np.abs(pose - DrivenFourBar().mechanism().pose.ravel()).max() > 0.01
    assert np.abs(DrivenFourBar().mechanism().gap(np.reshape(pose, (3, 3)), 0.0)[:8]).max() < 1e-9
    # The address stores what was dragged.
    linked = opened(f"lessons/four_bar.html{page.evaluate('location.hash')}")
    assert linked.evaluate(first) == pose
    # Invalid poses are ignored.
    other = opened("lessons/four_bar.html#set&part=1&scene=0&start=9,9,9,9,9,9,9,9,9")
    assert other.evaluate(first) == pytest.approx(DrivenFourBar().mechanism().pose.ravel())


def test_a_mechanism_whose_motion_is_stored_is_dragged_along_this_motion(opened):
    page = opened("lessons/skate.html", reduced_motion="reduce")
    body, slider = page.locator(".motion.truth .body"), page.locator("figure .time input")

    def place():
        box = body.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    slider.press("Home")
    targets = []
    for _ in range(2):
        for _ in range(6):
            slider.press("ArrowRight")
        targets.append((place(), slider.input_value()))
    slider.press("Home")
    page.mouse.move(*place())
    page.mouse.down()
    for target, frame in targets:
        page.mouse.move(*target, steps=3)
        assert abs(int(slider.input_value()) - int(frame)) <= 1  # a box is not centred at the centre of mass
    page.mouse.up()
    assert abs(int(slider.input_value()) - int(targets[-1][1])) <= 1


def test_the_last_iteration_of_a_pymunk_step_is_the_result_of_the_step(running):
    answer = running("four_bar").evaluate(
        """async () => {
          const { ask, form } = window.crosscheck;
          form.move(1, { steps: 1 });
          const setting = form.setting(null);
          const { found, whole } = await ask({ kind: "sweeps", setting, frame: 1 });
          const { motions } = await ask({ setting });
          const impulses = found.map((each) => [...each.impulses.slice(0, 8)]);
          return { whole, impulses, swept: found.map(({ twist }) => [...twist]),
            after: [...motions[0].twist.slice(9, 18)] };
        }"""
    )
    assert answer["whole"] == len(answer["swept"]) == pymunk.SHIPPED_ITERATIONS
    assert answer["swept"][-1] == pytest.approx(answer["after"], rel=1e-9)
    added = np.linalg.norm(np.diff(answer["impulses"], axis=0), axis=1)
    assert added[-1] < added[0]


def test_springs_of_mujoco_follow_the_sliders_and_sliders_without_effect_are_disabled(running):
    live = BY_NAME["four_bar"].scene("driven")
    springs = {"integrator": 1, "timeConstant": 0.01, "impedance": STIFFEST[0]}
    answer = run_engines(running("four_bar"), "four_bar", "driven", springs)
    step = live.scene.duration / live.steps[live.start]
    engine = replace(mujoco.DEFAULT, integrator="RK4", stiffness=TiedToStep(0.01 / step))
    python = engine.build(live.scene.mechanism(), step)(live.frames, live.steps[live.start] // live.frames)
    assert np.abs(np.reshape(answer["motions"]["mujoco"]["pose"], python.pose.shape) - python.pose).max() < 1e-12
    assert answer["idle"] == []
    # pymunk's settings have no effect, since its default can't build a skate. MuJoCo's settings affect a contact.
    assert set(run_engines(running("skate"), "skate", "the sleigh", {})["idle"]) == {"iterations", "bias"}
    naive = BY_NAME["skate"].scene("the sleigh").munk[2][0]
    other = run_engines(running("skate"), "skate", "the sleigh", {"munk": naive, "mujoco": DOCUMENTED})
    assert {"iterations", "bias", "integrator", "timeConstant"} <= set(other["idle"])
