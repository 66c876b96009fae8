"""The site in Chromium: every page loads, the engines in it give Python's numbers, and keys alone are enough.

Skipped where there is no Chromium, no playwright, or no packages of npm: `tests/tools/browser.sh` installs them.
"""

from __future__ import annotations

import re
import shutil
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engines import Unsupported, mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco.stiffness import STIFFEST, TiedToStep
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.cli.site import texts_of
from reports.model.tasks import answered
from reports.site.build import build, tasks
from reports.site.folder import compressed_size, server, write_site
from reports.site.lesson import SiteSource
from reports.site.lessons import LESSONS
from reports.site.lessons.skates import NAIVE
from reports.site.live.sliders import DOCUMENTED, ENGINES, INTEGRATORS, Live
from tests import RESULTS

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
if BROWSER is None:
    pytest.skip("no Chromium is installed: tests/tools/browser.sh installs it on Debian", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[browser]'")
pytest.importorskip("furo", reason="furo is not installed: pip install '.[site]'")

PHONE = {"width": 390, "height": 844}
TALL = {"width": 1200, "height": 8000}  # nothing scrolls, and so no other part comes to the middle and is shown
LONGEST = 300_000.0  # ms to wait for what never comes: a loaded machine may take any time for what does


# A linkage, a skate and bodies that roll; the slow tests open the other lessons too.
QUICK = ("four_bar", "skate", "rolling")


@pytest.fixture(scope="module")
def files(request):
    """The site with the quick lessons and those of the selected tests."""
    parameters = (vars(item).get("callspec") for item in request.session.items if item.path == request.path)
    wanted = {*QUICK, *(call.params.get("lesson") for call in parameters if call is not None)}
    answers = {motion: answered(motion) for motion in tasks(LESSONS[:1])}
    cache = Path(request.config.cache.mkdir("site"))
    source = SiteSource(**texts_of(RESULTS), answers=answers, cache=cache, foot="Made by a test.", api=False)
    return build(source, [lesson for lesson in LESSONS if lesson.name in wanted])


@pytest.fixture(scope="module")
def address(files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "site"
    write_site(folder, files)
    running = server(folder, 0)
    threading.Thread(target=running.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{running.server_address[1]}/"
    running.shutdown()
    running.server_close()


@pytest.fixture(scope="module")
def chromium():
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"], timeout=LONGEST)
        yield browser
        browser.close()


def new_page(chromium: Any, **options: Any) -> Any:
    context = chromium.new_context(**{"viewport": {"width": 1200, "height": 900}, **options})
    context.set_default_timeout(LONGEST)
    return context.new_page()


@pytest.fixture
def opened(chromium, address):
    """A function that opens a page in a new context; an error or a warning of the browser fails the test."""
    contexts: list[Any] = []
    complaints: list[str] = []

    def open_page(name: str, **options: Any) -> Any:
        page = new_page(chromium, **options)
        contexts.append(page.context)
        page.on(
            "console", lambda message: complaints.append(message.text) if message.type in ("error", "warning") else None
        )
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "response",
            lambda response: complaints.append(f"{response.status} {response.url}") if response.status >= 400 else None,
        )
        page.on("request", lambda request: complaints.append(request.url) if not local(request.url, address) else None)
        page.goto(address + name)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []


def local(url: str, address: str) -> bool:
    return url.startswith((address, "data:", "blob:"))


@pytest.fixture(scope="module")
def running(chromium, address, files):
    """A function that returns the page of a lesson with its engines loaded; each is opened once."""
    if not {"packages/mujoco.wasm", "packages/munk2d.js"} <= set(files):
        pytest.skip("the site was built without its engines: tests/tools/browser.sh installs npm and emscripten")
    pages: dict[str, Any] = {}

    def page_of(lesson: str) -> Any:
        if lesson not in pages:
            pages[lesson] = new_page(chromium)
            pages[lesson].goto(f"{address}lessons/{lesson}.html")
            pages[lesson].wait_for_selector("#lesson.ready")
        return pages[lesson]

    yield page_of
    for page in pages.values():
        page.context.close()


# Runs the engines of the page: indices of the controls, the others at their start values, and the pose of release.
ASKED = """async ([scene, places, start]) => {
  const { ask, form } = window.crosscheck;
  form.move(scene, places);
  const told = await ask({ setting: form.setting(start) });
  return { exact: { pose: [...told.exact.pose], missed: told.exact.missed }, lost: told.lost, idle: told.idle,
    motions: Object.fromEntries(told.motions.map(({ name, pose, twist, error, from, apart }) =>
      [name, { pose: [...pose], twist: [...twist], error, from, apart }])) };
}"""


def asked(page: Any, lesson: str, scene: str, values: dict[str, Any], start: list[float] | None = None) -> Any:
    """Return the motions of the engines in the page for a scene with these values of its controls."""
    live = BY_NAME[lesson].scene(scene)
    return page.evaluate(ASKED, [BY_NAME[lesson].scenes.index(live), live.located(values), start])


def python_of(live: Live, values: dict[str, Any]) -> tuple[Scene, dict[str, Any], float]:
    """Return the scene, pymunk and MuJoCo in Python (or a sentence) with these values, and the step [s]."""
    changed: Any = {name: value for name, value in values.items() if name in {slider.field for slider in live.sliders}}
    scene: Any = replace(live.scene, **changed)  # type: ignore[type-var]
    step = scene.duration / values.get("steps", live.steps[live.start])
    engines: dict[str, Any] = {
        name: next(engine for label, engine in live.ways(name) if label == values.get(name, live.ways(name)[0][0]))
        for name in ENGINES
    }
    fields = {"munk": {"iterations": "iterations", "bias": "error_bias"}, "mujoco": {"tolerance": "tolerance"}}
    for name, names in fields.items():
        settings = {field: values[name] for name, field in names.items() if name in values}
        if name == "mujoco" and "integrator" in values:
            settings["integrator"] = dict(INTEGRATORS)[values["integrator"]]
        if settings and not isinstance(engines[name], str):
            engines[name] = replace(engines[name], **settings)
    return scene, engines, step


BY_NAME = {lesson.name: lesson for lesson in LESSONS}


def marked(*arguments: Any) -> Any:
    """Return parameters that begin with the name of a lesson; marked slow unless it is in QUICK."""
    return pytest.param(*arguments, marks=() if arguments[0] in QUICK else pytest.mark.slow)


SCENES = [marked(lesson.name, live.word) for lesson in LESSONS for live in lesson.scenes]
# Largest difference of an engine in the page and in Python, relative to the size of the motion. Both do the same
# operations, but MuJoCo's releases differ, and compilers order some sums differently: measured are 1e-17 to 1e-13.
# Some motions amplify the last digits: a car on contacts at coarse steps (5e-8), a blade on contacts (2e-11), a crank
# with a heavy slider (8e-10), an ellipse on a stiff contact (4e-9), gears as polygons (3e-7). MuJoCo iterates for the
# contact of two ellipses until it moves by less than ccd_tolerance, 1e-6, and releases iterate differently (1.3e-2).
APART = {"gears": 5e-2, "rolling": 1e-7, "wheels": 1e-6, "skate": 1e-9, "slider_crank": 1e-8}
MUNK_APART = {"gears": 1e-5}


def moved(live: Live) -> dict[str, Any]:
    """Return other settings than the first ones: the last value of every slider."""
    way = {name: live.ways(name)[-1][0] for name in ENGINES} if len(live.munk) > 2 else {}
    engines = {"iterations": 20, "bias": 1e-6, "integrator": 3, "tolerance": 1e-15}
    return {"steps": live.steps[2], **engines, **way, **{slider.field: slider.values[-1] for slider in live.sliders}}


GIVEN = {
    "as shipped": lambda live: {},
    "documented": lambda live: dict.fromkeys(ENGINES, DOCUMENTED),
    "moved": moved,
}


@pytest.mark.parametrize("variant", GIVEN)
@pytest.mark.parametrize(("lesson", "word"), SCENES)
def test_the_engines_in_the_page_compute_the_motions_of_python(running, lesson, word, variant):
    live = BY_NAME[lesson].scene(word)
    values = GIVEN[variant](live)
    answer = asked(running(lesson), lesson, word, values)
    scene, engines, step = python_of(live, values)
    samples = live.samples(round(scene.duration / step))
    every = round(scene.duration / step) // samples
    truth = scene.motion(np.arange(samples + 1) * (scene.duration / samples)).pose
    size = max(1.0, float(np.abs(truth).max()))
    # The page estimates the error of its own integration, about ten times too large.
    missed = answer["exact"]["missed"] or 0.0
    assert np.abs(np.reshape(answer["exact"]["pose"], truth.shape) - truth).max() < missed + 1e-12 * size
    assert missed < 1e-5
    for name, method in engines.items():
        try:
            python = method.build(scene.mechanism(), step)(samples, every)
        except (Unsupported, AttributeError):  # a sentence builds nothing
            assert name in answer["lost"]
            continue
        if name in answer["lost"]:
            assert re.search("needs Python code in every step|writes rows while it steps", answer["lost"][name])
            continue
        page = np.reshape(np.array(answer["motions"][name]["pose"], dtype=float), python.pose.shape)
        is_missing = np.isnan(page)  # after MuJoCo has reset itself, or the motion has diverged
        is_compared = ~is_missing & np.isfinite(python.pose)
        assert np.array_equal(is_missing, ~np.isfinite(python.pose) | (np.abs(python.pose) > 1e6))
        difference = np.abs(page - python.pose)[is_compared].max() / max(
            1.0, float(np.abs(python.pose[is_compared]).max())
        )
        assert difference < (APART if name == "mujoco" else MUNK_APART).get(lesson, 1e-12)


EXPERIMENTS = [marked(lesson.name, number) for lesson in LESSONS for number, _ in enumerate(lesson.experiments)]


@pytest.mark.parametrize(("lesson", "number"), EXPERIMENTS)
def test_the_claims_of_an_experiment_hold_and_its_causes_too(running, lesson, number):
    experiment = BY_NAME[lesson].experiments[number]

    def errors(*changes: Any) -> dict[str, float]:
        answer = asked(
            running(lesson),
            lesson,
            experiment.scene,
            {name: value for change in changes for name, value in change.items()},
        )
        return {
            name: np.inf if motion["error"] is None else motion["error"] for name, motion in answer["motions"].items()
        }

    start, end = errors(experiment.before), errors(experiment.before, experiment.after)
    for claim in experiment.claims:
        assert claim.least <= end[claim.engine] / start[claim.engine] <= claim.most
    for change, claim in experiment.causes:
        without = errors(experiment.before, experiment.after, change)
        assert claim.least <= without[claim.engine] / end[claim.engine] <= claim.most, change


LET_GO = (("four_bar", "let go"), ("slider_crank", "let go"), ("pendulum", "two links"))


@pytest.mark.parametrize(("lesson", "word"), [marked(*each) for each in LET_GO])
def test_a_mechanism_released_elsewhere_moves_from_there_exactly_and_in_engines(running, lesson, word):
    page, live = running(lesson), BY_NAME[lesson].scene(word)
    mechanism = live.scene.mechanism()
    start = live.scene.motion([0.37 * live.scene.duration]).pose[0]
    answer = asked(page, lesson, word, {}, start.ravel().tolist())
    bodies = [
        replace(b, pose=tuple(p), twist=(0.0,) * 3) for b, p in zip(mechanism.bodies, start.tolist(), strict=True)
    ]
    released = Mechanism(tuple(bodies), mechanism.joints, mechanism.gravity)
    steps = live.steps[live.start]
    samples, step = live.samples(steps), live.scene.duration / steps
    exact = Lagrange("dop853", "projection").build(released, live.scene.duration / samples / 10)(samples, 10).pose
    assert np.abs(np.reshape(answer["exact"]["pose"], exact.shape) - exact).max() < 1e-8
    assert answer["exact"]["missed"] < 1e-8
    python = pymunk.DEFAULT.build(released, step)(samples, steps // samples).pose
    assert np.abs(np.reshape(answer["motions"]["munk"]["pose"], python.shape) - python).max() < 1e-9
    # The stiffness of a loop in MuJoCo depends on the pose in which the model is compiled, which differs here.
    tuned = asked(page, lesson, word, {"mujoco": DOCUMENTED}, start.ravel().tolist())
    assert np.abs(np.array(tuned["motions"]["mujoco"]["pose"][: start.size]) - start.ravel()).max() < 1e-12
    assert tuned["motions"]["mujoco"]["error"] < 0.01 < answer["motions"]["mujoco"]["error"] < 3


def test_a_joint_is_dragged_and_the_linkage_stays_closed(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")  # nothing plays by itself
    page.wait_for_selector("#lesson.ready")
    pin = page.locator(".motion.truth .body").nth(1).locator("circle").first.bounding_box()
    page.mouse.move(pin["x"] + pin["width"] / 2, pin["y"] + pin["height"] / 2)
    page.mouse.down()
    page.mouse.move(pin["x"] + 40, pin["y"] + 30, steps=5)
    page.mouse.up()
    page.wait_for_function("document.querySelector('.status').textContent.includes('computes this exact motion')")
    pose = page.evaluate("window.crosscheck.setting().start")
    assert np.abs(DrivenFourBar().mechanism().gap(np.reshape(pose, (3, 3)), 0.0)[:8]).max() < 1e-9


def test_the_first_step_of_pymunk_is_shown_by_iterations(running):
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
    # The last sweep is the step itself, and each adds less than the one before.
    assert answer["swept"][-1] == pytest.approx(answer["after"], rel=1e-9)
    added = np.linalg.norm(np.diff(answer["impulses"], axis=0), axis=1)
    assert added[-1] < added[0]


def test_springs_of_mujoco_follow_the_sliders_and_sliders_without_effect_are_disabled(running):
    live = BY_NAME["four_bar"].scene("driven")
    springs = {"integrator": 1, "timeConstant": 0.01, "impedance": STIFFEST[0]}
    answer = asked(running("four_bar"), "four_bar", "driven", springs)
    step = live.scene.duration / live.steps[live.start]
    engine = replace(mujoco.DEFAULT, integrator="RK4", stiffness=TiedToStep(0.01 / step))
    python = engine.build(live.scene.mechanism(), step)(live.frames, live.steps[live.start] // live.frames)
    assert np.abs(np.reshape(answer["motions"]["mujoco"]["pose"], python.pose.shape) - python.pose).max() < 1e-12
    assert answer["idle"] == []
    # pymunk has nothing there; the capsule has a solver and a spring.
    assert set(asked(running("skate"), "skate", "the sleigh", {})["idle"]) == {"iterations", "bias"}
    other = asked(running("skate"), "skate", "the sleigh", {"munk": NAIVE, "mujoco": DOCUMENTED})
    assert {"iterations", "bias", "integrator", "timeConstant"} <= set(other["idle"])


def test_the_address_stores_the_changes_of_the_reader_alone(opened):
    page = opened("lessons/four_bar.html", viewport=TALL)
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-2 .set").click()
    assert page.evaluate("location.hash") == ""
    page.locator("#part-1 .drag").first.focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("location.hash") == "#set&scene=0&0.coupler=2"
    linked = opened("lessons/four_bar.html#set&scene=0&0.coupler=2&steps=99&0.crank=77&nothing&=", viewport=TALL)
    linked.wait_for_selector("#lesson.ready")
    values = "Object.fromEntries(crosscheck.form.shown().map(i => [i.name, i.value]))"
    assert linked.evaluate(values) == page.evaluate(values)
    assert "up to" in linked.inner_text(".legend .method-1")


def test_a_guess_is_answered_with_measured_errors(opened):
    page = opened("lessons/four_bar.html", viewport=TALL, reduced_motion="reduce")
    page.wait_for_selector("#lesson.ready")
    page.locator("#part-5 .answers button").first.click()
    page.wait_for_selector("#part-5 .why[open]")
    text = page.inner_text("#part-5 .measured")
    assert text.startswith("Not so. pymunk: ")
    assert "times as large" in text
    assert page.locator("#part-5 [data-right].right").count() == 1
    # The legend has the settings of the picture, which comes after the answer.
    page.wait_for_function("document.querySelector('.legend .method-1').innerText.includes('iterations 1')")


@pytest.mark.parametrize("stride", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_every_page_loads_without_a_complaint_and_fits_a_phone(files, opened, stride):
    """Open every lesson, and each fourth of the other pages, which share templates; the slow test opens all."""
    names = sorted(name for name in files if name.endswith(".html") and not name.startswith("reference/"))
    lessons = [name for name in names if name.startswith("lessons/")]
    for name in dict.fromkeys([*lessons, *names[::stride]]):
        page = opened(name, viewport=PHONE)
        assert page.title()
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, f"{name} is wider than a phone by {wide} px"
        page.context.close()


def test_a_motion_is_played_moved_and_switched_by_keys(opened):
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


def test_texts_pictures_and_tables_need_no_script(opened):
    page = opened("lessons/four_bar.html", java_script_enabled=False)
    assert "Three bars and four pins" in page.inner_text("main")
    assert page.locator(".motion.truth .body").count() == 3
    assert page.locator(".controls").first.is_hidden()
    page.locator("#part-2 summary").first.click()
    assert "closes a tenth of a gap" in page.inner_text("#part-2")
    page = opened("results/four_bar.html", java_script_enabled=False)
    assert page.locator("table").count() > 3
    assert page.locator("img").first.evaluate("image => image.complete && image.naturalWidth > 0")


def test_tables_and_charts_are_sorted_and_filtered(opened):
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
    assert methods == {"as shipped", "documented settings", "with our code"}  # variants first
    page.locator("input[name=all]").check()
    page.reload()  # the address holds it
    page.wait_for_selector("html[data-ready]")
    assert "lagrange" in set(page.locator("#rows tbody td:nth-child(1)").all_inner_texts())
    page.locator("#rows th button").nth(5).click()
    errors = [
        float(cell) for cell in page.locator("#rows tbody td:nth-child(6)").all_inner_texts() if cell[0].isdigit()
    ]
    assert errors == sorted(errors)


def test_the_site_is_small(files):
    assert compressed_size(files) < 6_000_000
    engines = ("packages/munk2d", "packages/mujoco", "live/")  # they are loaded when a lesson is opened
    assert compressed_size({name: text for name, text in files.items() if not name.startswith(engines)}) < 2_500_000
