"""Tests of the site in Chromium, which `tests/tools/browser.sh` installs."""

from __future__ import annotations

import base64
import itertools
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines import Unsupported, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco.stiffness import STIFFEST, TiedToStep
from reference.chapter.centrodes import instant_centre
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.site.folder import compressed_size
from reports.site.lesson import Claim
from reports.site.lessons import LESSONS
from reports.site.lessons.skates import NAIVE
from reports.site.live.sliders import DOCUMENTED, ENGINES, Live
from tests.reports.site_in_browser import (
    BY_NAME,
    PHONE,
    QUICK,
    TALL,
    address,
    chromium,
    files,
    new_page,
    number_of,
    opened,
    python_of,
    run_engines,
    running,
)

__all__ = ["address", "chromium", "files", "opened", "running"]


def marked(*arguments: Any) -> Any:
    """Return parameters of a test; it is marked slow unless the first parameter, a lesson, is in QUICK."""
    return pytest.param(*arguments, marks=() if arguments[0] in QUICK else pytest.mark.slow)


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
            assert re.search("needs (Python|our) code in every step", answer["lost"][name])
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
    for change, claim in experiment.causes:
        assert_claim(claim, end, numbers(running, lesson, number, experiment.after, change))


@pytest.mark.parametrize(("lesson", "number"), EXPERIMENTS)
def test_the_runs_contradict_every_wrong_answer_and_agree_with_the_right_one(running, lesson, number):
    experiment, part = BY_NAME[lesson].experiments[number], BY_NAME[lesson].parts[number]
    start, end = numbers(running, lesson, number), numbers(running, lesson, number, experiment.after)
    for (words, is_right), guess in zip(part.answers, experiment.guesses, strict=False):
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
    page.wait_for_selector("#lesson.ready")
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
    linked.wait_for_selector("#lesson.ready")
    assert linked.evaluate(first) == pose
    # Invalid poses are ignored.
    other = opened("lessons/four_bar.html#set&part=1&scene=0&start=9,9,9,9,9,9,9,9,9")
    other.wait_for_selector("#lesson.ready")
    assert other.evaluate(first) == pytest.approx(DrivenFourBar().mechanism().pose.ravel())


def test_a_mechanism_whose_motion_is_stored_is_dragged_along_this_motion(opened):
    page = opened("lessons/skate.html", reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
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
    other = run_engines(running("skate"), "skate", "the sleigh", {"munk": NAIVE, "mujoco": DOCUMENTED})
    assert {"iterations", "bias", "integrator", "timeConstant"} <= set(other["idle"])


def test_the_address_stores_only_changes_by_the_reader(opened):
    page = opened("lessons/four_bar.html", viewport=TALL)
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-2 .set").click()
    assert page.evaluate("location.hash") == ""
    page.locator("#part-1 .drag").first.focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("location.hash") == "#set&part=1&scene=0&0.coupler=2"
    linked = opened("lessons/four_bar.html#set&scene=0&0.coupler=2&steps=99&0.crank=77&nothing&=", viewport=TALL)
    linked.wait_for_selector("#lesson.ready")
    values = "Object.fromEntries(crosscheck.form.shown().map(i => [i.name, i.value]))"
    assert linked.evaluate(values) == page.evaluate(values)
    assert "up to" in linked.inner_text(".legend .method-1")
    # The sentence of the marked experiment has the linked number, also without the number of an experiment.
    assert linked.inner_text("#part-1.shown .drag[data-name=coupler]") == "0.65"
    linked = opened("lessons/four_bar.html#set&part=4&scene=1&1.steps=1", viewport=TALL)
    linked.wait_for_selector("#lesson.ready")
    steps = linked.text_content("#part-4.shown .drag[data-name=steps]")
    assert steps != linked.text_content("#part-5 .drag[data-name=steps]")
    assert steps == linked.evaluate("crosscheck.form.words('steps')")


@pytest.mark.parametrize("part", [4, 7])
def test_a_linked_experiment_stays_in_the_picture_of_a_phone(opened, part):
    """The page itself scrolls to the experiment, and scrolls again when it gets its height."""
    scene = BY_NAME["four_bar"].scenes.index(BY_NAME["four_bar"].scene(BY_NAME["four_bar"].experiments[part - 1].scene))
    page = opened(f"lessons/four_bar.html#set&part={part}&scene={scene}&{scene}.steps=1", viewport=PHONE)
    page.wait_for_selector("#lesson.ready")
    page.wait_for_timeout(300)  # later scroll events come within 100 ms
    shown = "document.querySelector('.part.shown').id"
    assert page.evaluate(shown) == f"part-{part}"
    page.mouse.move(195, 700)  # the text, which scrolls
    page.mouse.wheel(0, -1500)
    page.wait_for_function(f"{shown} !== 'part-{part}'")  # the reader's scrolling selects another one


def test_the_answer_to_a_guess_shows_its_own_run_beside_the_right_one(opened):
    page = opened("lessons/four_bar.html", viewport=TALL, reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")

    def rows(part, answer):
        page.locator(f"#part-{part} .answers button").nth(answer).click()
        page.wait_for_selector(f"#part-{part} .why[open] .compared:not([hidden])")
        cells = page.locator(f"#part-{part} .compared tbody tr").all()
        return [row.locator("th, td").all_inner_texts() for row in cells]

    assert [row[0] for row in rows(5, 0)] == ["before", "expected with your answer: The error grows a little", "now"]
    assert page.inner_text("#part-5 .measured").startswith("Not so.")
    assert page.locator("#part-5 [data-right].right").count() == 1
    before, own, right = rows(2, 0)
    assert own[0] == "your answer: Ten times as many iterations"
    assert own[1] == f"{before[1]}, as before"
    assert right[0].startswith("the right answer: One setting")
    assert "times smaller" in right[1]
    # The picture shows the run of the answer; a click on another run shows that run.
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('iterations 100')")
    page.locator("#part-2 .compared button").last.click()
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('error_bias 0 ')")


def test_an_answered_experiment_shows_its_run_again_when_the_reader_returns(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-3 .answers [data-right]").click()
    page.wait_for_selector("#part-3 .compared:not([hidden])")
    tenth = "document.querySelector('#part-3 .measured').textContent && crosscheck.form.words('steps') === '0.5 ms'"
    page.wait_for_function(tenth)
    page.mouse.move(300, 400)
    for part in (4, 3):
        for _ in range(60):
            away = page.locator(f"#part-{part} h2").bounding_box()["y"] - 120
            if abs(away) < 60:
                break
            page.mouse.wheel(0, np.clip(away, -150, 150))
            page.wait_for_timeout(50)
        page.wait_for_selector(f"#part-{part}.shown")
        assert page.evaluate(tenth) == (part == 3)
    # The keys Home and End select the first and the last value.
    number = page.locator("#part-3 .drag[data-name=timeConstant]")
    number.focus()
    page.keyboard.press("End")
    assert number.inner_text() == "50 ms"


@pytest.mark.parametrize(
    ("blocked", "place", "words"),
    [
        (
            "**/packages/mujoco.*",
            ".status",
            "MuJoCo: its file could not be loaded. Check the network or the browser's blocker, then reload the page. "
            "The picture shows the stored motion of Python.",
        ),
        (
            "**/live/*.json",
            ".status",
            "The engines could not be run: the data of this motion could not be loaded. Check",
        ),
        (
            "**/worker.js",
            ".status",
            "The engines could not be run: their script could not be loaded. Check the network",
        ),
    ],
)
def test_a_blocked_download_has_a_readable_message(chromium, address, blocked, place, words):
    page = new_page(chromium)
    page.route(blocked, lambda route: route.abort())
    page.goto(f"{address}lessons/four_bar.html")
    page.wait_for_function(
        "([place, words]) => document.querySelector(place).innerText.includes(words)", arg=[place, words]
    )
    text = page.inner_text("#lesson figure")
    assert "http" not in text
    assert "undefined" not in text
    page.context.close()


def test_numbers_and_the_legend_change_while_a_number_is_dragged(opened):
    page = opened("lessons/four_bar.html", viewport=TALL, reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-2 .set").click()
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('up to')")
    texts = page.evaluate(
        """() => {
          const number = document.querySelector('#part-2 .drag[data-name=bias]');
          number.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight' }));
          return [number.textContent, document.querySelector('.legend .method-1').innerText];
        }"""
    )
    assert texts[0] == "0.5"
    assert "error_bias 0.5" in texts[1]
    assert texts[1].endswith("…")


def test_an_exercise_accepts_its_answer_and_no_other_number(opened):
    page = opened("lessons/four_bar.html", viewport=TALL)
    page.wait_for_selector("#lesson.ready")
    exercise = page.locator("form[data-answer=rocker_angle]")
    for given, verdict in (("2,9", "Right. The page computes 2.9056."), ("-2.9", "The size is right"), ("3", "Not so")):
        exercise.locator("input").fill(given)
        exercise.locator("button").click()
        assert exercise.locator(".verdict").inner_text().startswith(verdict)


@pytest.mark.parametrize("lesson", [marked("parking")])
def test_the_keyboard_parks_the_skate_in_five_moves(opened, lesson):
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    page.locator(".lot").focus()
    for key, count in (("Left", 5), ("Up", 9), ("Right", 10), ("Down", 9), ("Left", 5)):
        for _ in range(count):
            page.keyboard.press(f"Arrow{key}")
    text = page.inner_text(".parking .count")
    assert text.startswith("Parked: 5 moves; turned by 100.0° and slid by 0.900 m in total.")
    assert "moves it by -0.042 m ahead and 0.190 m to the left in 4 moves" in text  # 0.45 m and 25 degrees
    linked = opened(f"lessons/{lesson}.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.inner_text(".parking .count") == text


# The points of both paths in the coordinates of the drawing, and its scale [m of the paper for each m].
SVG_POINTS = """() => {
  const root = document.documentElement;
  const points = (path) => path.getAttribute('d').slice(1, -1).split('L').slice(0, -1).map((pair) => {
    const [x, y] = pair.split(' ').map(Number);
    const { x: u, y: v } = new DOMPoint(x, y).matrixTransform(path.transform.baseVal.consolidate().matrix);
    return [u, v];
  });
  return [Object.fromEntries([...document.querySelectorAll('path')].map((path) => [path.id, points(path)])),
    root.width.baseVal.valueInSpecifiedUnits / 1000 / root.viewBox.baseVal.width];
}"""


@pytest.mark.parametrize("lesson", [marked("cam")])
def test_a_drawn_motion_gives_two_shapes_to_download(opened, lesson, tmp_path):
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    box = page.locator(".lot").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    for index in range(41):  # an ellipse that is drawn clockwise
        page.mouse.move(x + 80 * np.cos(index * np.pi / 20), y + 30 * np.sin(index * np.pi / 20))
        if index == 0:
            page.mouse.down()
    page.mouse.up()
    assert "The moving shape rolls on the fixed one" in page.inner_text(".cam .count")
    for index in range(41):  # a path without symmetry
        angle, radius = index * np.pi / 20, 80 + 12 * np.sin(index * np.pi / 10) + 6 * np.cos(3 * index * np.pi / 20)
        page.mouse.move(x + radius * np.cos(angle), y - radius * np.sin(angle))
        if index == 0:
            page.mouse.down()
    page.mouse.up()
    assert page.locator(".widget select").input_value() != "-1"
    assert "crosses itself" not in page.inner_text(".cam .count")
    linked = opened(f"lessons/{lesson}.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.inner_text(".cam .count") == page.inner_text(".cam .count")
    page.get_by_label("the body turns").select_option("once")
    page.locator("[data-motion=Ellipse]").click()
    for kind in ("svg", "dxf"):
        with page.expect_download() as download:
            page.locator(f"[data-file={kind}]").click()
        download.value.save_as(tmp_path / f"shapes.{kind}")
    t = np.linspace(0, 2 * np.pi, 361)
    pose = np.column_stack([0.5 * np.cos(t), 0.2 * np.sin(t), t])
    twist = np.column_stack([-0.5 * np.sin(t), 0.2 * np.cos(t), np.ones(361)])
    curves = dict(zip(("space", "body"), instant_centre(pose, twist), strict=True))
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed: pip install '.[dxf]'")
    lines = ezdxf.readfile(tmp_path / "shapes.dxf").modelspace()
    found = {line.dxf.layer.lower(): [(point.x, point.y) for point in line.points()] for line in lines}
    # The browser itself reads the SVG. Its transform keeps the shape and the scale: 1 m is 1000/10 mm = 100 mm.
    page.goto(f"data:image/svg+xml;base64,{base64.b64encode((tmp_path / 'shapes.svg').read_bytes()).decode()}")
    svg, viewed = page.evaluate(SVG_POINTS)
    assert viewed == pytest.approx(0.1)
    for name, curve in curves.items():
        one = curve[: {"space": 360, "body": 180}[name]]  # the body curve is traced twice in a turn
        assert np.abs(np.array(found[name]) - one).max() < 1e-6
        points = np.array(svg[name])
        assert np.abs((points - points[0]) * (1, -1) - (one - one[0])).max() < 1e-6


@pytest.mark.parametrize("lesson", [marked("cam")])
def test_a_motion_about_one_point_gives_no_shapes_and_a_wrong_link_changes_nothing(opened, lesson):
    page = opened(f"lessons/{lesson}.html#set&part=3&scene=0&state=0,0,0,1,0,0,0,0,1", viewport=TALL)
    assert "0.600 m wide" in page.inner_text(".cam .count")  # 2 (0.5 - 0.2) m, of the ellipse at the start
    page = opened(f"lessons/{lesson}.html", viewport=TALL)
    page.locator("[data-motion=Circle]").click()
    assert page.locator(".widget select").input_value() != "1"
    page.get_by_label("the body turns").select_option("once")  # the page has selected a number that gives two shapes
    assert "only turns about one fixed point" in page.inner_text(".cam .count")
    assert page.locator("[data-file=dxf]").is_disabled()


def test_a_link_restores_the_numbers_of_an_erratum(opened):
    page = opened("lessons/skate.html", viewport=TALL)
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-5 .why summary").click()
    values = page.locator("#part-5 tbody code")
    before = values.all_text_contents()
    page.locator("#part-5 .errata input[name=angle]").fill("2.5")
    page.wait_for_function("location.hash.includes('state=')")
    linked = opened(f"lessons/skate.html{page.evaluate('location.hash')}", viewport=TALL)
    assert linked.locator("#part-5 tbody code").all_text_contents() == values.all_text_contents() != before


@pytest.mark.parametrize("stride", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_every_page_loads_without_errors_and_fits_a_phone(files, opened, stride):
    """Open every lesson and every fourth of the other pages; the slow test opens all pages."""
    names = sorted(name for name in files if name.endswith(".html") and not name.startswith("reference/"))
    lessons = [name for name in names if name.startswith("lessons/")]
    for name in dict.fromkeys([*lessons, *names[::stride]]):
        page = opened(name, viewport=PHONE)
        assert page.title()
        page.evaluate("document.querySelectorAll('main details').forEach((each) => { each.open = true; })")
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, f"{name} is wider than a phone by {wide} px"
        page.context.close()


SMALL = """() => [...document.querySelectorAll('#lesson :is(button, select, input, summary, .drag)')]
  .flatMap((each) => {
  const target = each.matches('[type=checkbox]') ? each.closest('label') : each;
  const { height, width } = target.getBoundingClientRect();
  return width && height < 24 ? [`${target.outerHTML.slice(0, 80)}: ${height}`] : [];
})"""
UNNAMED = """() => [...document.querySelectorAll('#lesson .drag')].filter((each) => !['aria-label', 'aria-valuemin',
  'aria-valuenow', 'aria-valuetext'].every((name) => each.getAttribute(name)) ||
  each.getAttribute('aria-label') === each.dataset.name).map((each) => each.outerHTML)"""


@pytest.mark.parametrize("lesson", [marked(lesson.name) for lesson in LESSONS])
def test_controls_are_large_enough_for_fingers_and_the_picture_leaves_room_for_the_text(opened, lesson):
    page = opened(f"lessons/{lesson}.html", viewport=PHONE, reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    page.evaluate("document.querySelectorAll('#lesson details').forEach((each) => { each.open = true; })")
    assert page.evaluate(SMALL) == []
    assert page.evaluate(UNNAMED) == []
    assert page.locator(".stage-column").bounding_box()["height"] <= 0.4 * PHONE["height"]
    assert page.locator(".stage-column").evaluate("({ scrollWidth, clientWidth }) => scrollWidth - clientWidth") <= 0


def test_the_first_picture_enlarges_differences_that_are_too_small_to_be_seen(opened):
    page = opened("lessons/four_bar.html", viewport=PHONE, reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    lens = page.locator(".lens > svg").bounding_box()
    assert lens["y"] + lens["height"] < 0.4 * PHONE["height"]  # the magnifier is in the window
    assert "drawn 5 times as large" in page.inner_text(".remark >> nth=0")
    rocker = page.locator(".motion.method-1 .body").nth(2)
    angles = "element => element.getAttribute('transform').match(/rotate\\((.*)\\)/)[1] * Math.PI / 180"
    exact = page.locator(".motion.truth .body").nth(2).evaluate(angles)
    enlarged = rocker.evaluate(angles) - exact
    page.locator("input[value=enlarged]").uncheck()
    assert enlarged == pytest.approx(5 * (rocker.evaluate(angles) - exact), rel=1e-6)
    assert abs(enlarged) > 0.05


def test_the_keyboard_plays_a_motion_moves_the_time_and_switches_overlays(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    clock = page.locator(".clock")
    body = page.locator(".motion.truth .body").first
    page.locator(".play").focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Home")
    start = (clock.inner_text(), body.get_attribute("transform"))
    page.keyboard.press("ArrowRight")
    assert (clock.inner_text(), body.get_attribute("transform")) != start
    box = page.locator("input[value=paths]")
    box.focus()
    page.keyboard.press("Space")
    assert page.locator(".trace").first.is_hidden()
    page.locator(".play").focus()
    page.keyboard.press("Enter")
    page.wait_for_function("Number(document.querySelector('.time input').value) > 3")
    page.keyboard.press("Enter")
    page.locator(".frame").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_function("location.hash.includes('start=')")  # the mechanism is dragged


def test_texts_pictures_and_tables_are_shown_without_javascript(opened):
    page = opened("lessons/four_bar.html", java_script_enabled=False)
    assert "Three bars and four pins" in page.inner_text("main")
    assert page.locator(".motion.truth .body").count() == 3
    assert page.locator(".controls").first.is_hidden()
    page.locator("#part-2 summary").first.click()
    assert "closes a tenth of a gap" in page.inner_text("#part-2")
    page = opened("results/four_bar.html", java_script_enabled=False)
    assert page.locator("table").count() > 3
    assert page.locator("img").first.evaluate("image => image.complete && image.naturalWidth > 0")


@pytest.mark.parametrize("blocked", ["lesson.js", "motion.js"])
def test_controls_are_hidden_if_scripts_are_blocked(chromium, address, blocked):
    page = new_page(chromium)
    page.route(f"**/{blocked}", lambda route: route.abort())
    page.goto(f"{address}lessons/four_bar.html")
    page.wait_for_selector("html:not(.scripts)", state="attached")
    assert page.locator("button:visible:not(.scheme), input:visible, select:visible").count() == 0
    assert page.get_by_text("The engines in this page need JavaScript").is_visible()
    page.context.close()


@pytest.mark.parametrize("scene", ["free_four_bar", "driven_slider_crank"])  # close methods; twelve decades
def test_labels_of_a_chart_do_not_overlap_on_a_phone(opened, scene):
    page = opened(f"results/rows.html#scene={scene}", viewport=PHONE)
    page.wait_for_selector("html[data-ready]")
    labels = page.locator("#chart :is([aria-label=text], [aria-label='y-axis tick label']) text")
    boxes = [box for label in labels.all() if label.inner_html() and (box := label.bounding_box()) is not None]
    assert len(boxes) > 8
    assert max(box["x"] + box["width"] for box in boxes) <= PHONE["width"]
    for a, b in itertools.combinations(boxes, 2):
        aside = max(a["x"], b["x"]) - min(a["x"] + a["width"], b["x"] + b["width"])
        above = max(a["y"], b["y"]) - min(a["y"] + a["height"], b["y"] + b["height"])
        assert max(aside, above) > -0.01, (a, b)  # rounding of a label's place


def test_tables_are_sorted_and_filtered_and_the_address_stores_the_choice(opened):
    page = opened("results/index.html")
    table = page.locator("table").filter(has=page.locator("tbody tr:nth-child(6)")).first
    count = table.locator("tbody tr").count()
    page.locator(".filter input").first.fill(table.locator("tbody tr td").first.inner_text().split()[0])
    assert 0 < table.locator("tbody tr:visible").count() < count
    page.locator(".filter input").first.fill("")
    table.locator("th button").first.click()
    first = table.locator("tbody tr td:first-child").all_inner_texts()
    table.locator("th button").first.click()
    assert table.locator("tbody tr td:first-child").all_inner_texts() != first
    page = opened("results/rows.html")
    page.wait_for_selector("html[data-ready]")
    methods = set(page.locator("#rows tbody td:nth-child(2)").all_inner_texts())
    assert methods == {"as shipped", "documented settings", "with our code"}  # these methods are shown initially
    page.locator("input[name=all]").check()
    page.reload()
    page.wait_for_selector("html[data-ready]")
    assert "lagrange" in set(page.locator("#rows tbody td:nth-child(1)").all_inner_texts())
    page.locator("#rows th button").nth(5).click()
    errors = [
        float(cell) for cell in page.locator("#rows tbody td:nth-child(6)").all_inner_texts() if cell[0].isdigit()
    ]
    assert errors == sorted(errors)


def test_the_compressed_size_of_the_site_is_limited(files):
    assert compressed_size(files) < 6_000_000
    engines = ("packages/munk2d", "packages/mujoco", "live/")  # only lessons load these files
    assert compressed_size({name: text for name, text in files.items() if not name.startswith(engines)}) < 2_500_000
