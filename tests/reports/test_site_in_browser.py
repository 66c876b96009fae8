"""The site in Chromium: every page loads, the engines in it give Python's numbers, and keys alone are enough.

Skipped where there is no Chromium, no playwright, or no packages of npm: `tests/tools/browser.sh` installs them.
"""

from __future__ import annotations

import json
import shutil
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engines import Engine, Unsupported, mujoco
from engines.mujoco.stiffness import STIFFEST, TiedToStep
from reference.scene import Scene
from reports.model.tasks import answered
from reports.site.build import build
from reports.site.drawn import measure_of
from reports.site.folder import compressed_size, server, write_site
from reports.site.lesson import Source
from reports.site.lessons import LESSONS
from reports.site.live.sliders import BIASES, IMPEDANCES, INTEGRATORS, SWEEPS, TIME_CONSTANTS, TOLERANCES, Live
from tests import RESULTS

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
if BROWSER is None:
    pytest.skip("no Chromium is installed: tests/tools/browser.sh installs it on Debian", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[browser]'")

PHONE = {"width": 390, "height": 844}


# A linkage, a skate and bodies that roll; the slow tests open the other lessons too.
QUICK = ("four_bar", "skate", "rolling")


@pytest.fixture(scope="module")
def files(request):
    """The site with the quick lessons and with those that a test that was selected asks for."""
    given = (vars(item).get("callspec") for item in request.session.items)
    wanted = {*QUICK, *(each.params.get("lesson") for each in given if each is not None)}
    texts = {suffix: {path.name: path.read_text("utf-8") for path in RESULTS.glob(f"*{suffix}")} for suffix in SUFFIXES}
    texts[".csv"] |= {f"programs/{path.name}": path.read_text("utf-8") for path in RESULTS.glob("programs/*.py")}
    four_bar = LESSONS[0]
    answers = {
        motion: answered(motion) for name in ("driven", "large") for motion in four_bar.takes[name].motions().values()
    } | {motion: answered(motion) for live in four_bar.live for motion in live.shipped().values()}
    cache = Path(request.config.cache.mkdir("site"))
    source = Source(texts[".md"], texts[".svg"], texts[".csv"], answers, cache, "Made by a test.", api=False)
    return build(source, [lesson for lesson in LESSONS if lesson.name in wanted])


SUFFIXES = (".md", ".svg", ".csv")


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
        browser = started.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def opened(chromium, address):
    """Opens a page in a new context; what the browser complains of is in `complaints`, and fails the test."""
    contexts: list[Any] = []
    complaints: list[str] = []

    def open_page(name: str, **given: Any) -> Any:
        contexts.append(chromium.new_context(viewport=given.pop("viewport", {"width": 1200, "height": 900}), **given))
        page = contexts[-1].new_page()
        page.on("console", lambda said: complaints.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("response", lambda got: complaints.append(f"{got.status} {got.url}") if got.status >= 400 else None)
        page.on("request", lambda asked: complaints.append(asked.url) if not local(asked.url, address) else None)
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
    """Gives the page of a lesson with its engines loaded, each opened once."""
    if not {"packages/mujoco.wasm", "packages/munk2d.js"} <= set(files):
        pytest.skip("the site was built without its engines: tests/tools/browser.sh installs npm and emscripten")
    pages: dict[str, Any] = {}

    def page_of(lesson: str) -> Any:
        if lesson not in pages:
            pages[lesson] = chromium.new_context(viewport={"width": 1200, "height": 900}).new_page()
            pages[lesson].goto(f"{address}lessons/{lesson}.html")
            pages[lesson].wait_for_selector("#live.ready")
        return pages[lesson]

    yield page_of
    for page in pages.values():
        page.context.close()


def choose(page: Any, scene: int, places: dict[str, int]) -> dict[str, Any]:
    """Choose a scene and set sliders as a user does, the others as shipped; what the page then ran."""
    return page.evaluate(
        """([scene, places]) => {
          const { engines, form, truth, runMujoco, runMunk } = window.crosscheckLive;
          form.choice.value = String(scene);
          form.move(places, true);
          form.form.dispatchEvent(new Event("input", { bubbles: true }));
          const now = form.setting();
          const { steps, every, tempo } = now;
          const can = (name) => !("why" in now.scene[name][now[name]]);
          return { steps, every, tempo, truth: [...truth(now)],
            mujoco: can("mujoco") ? [...runMujoco(engines.mujoco, now)] : null,
            munk: can("munk") ? [...runMunk(engines.munk, now)] : null,
            errors: JSON.parse(document.getElementById("live").dataset.errors) };
        }""",
        [scene, places],
    )


def errors_of(page: Any) -> dict[str, float]:
    return json.loads(page.evaluate("document.getElementById('live').dataset.errors"))


def last(live: Live) -> dict[str, int]:
    """The last place of every slider of a scene: another mechanism than the first one."""
    return {slider.field: len(slider.values) - 1 for slider in live.sliders}


def python_of(live: Live, places: dict[str, int]) -> tuple[Scene, Engine, Engine, float]:
    """The scene, pymunk and MuJoCo in Python as these places of the sliders ask for, and the step [s]."""
    values: Any = {each.field: each.values[places[each.field]] for each in live.sliders if each.field in places}
    scene: Any = replace(live.scene, **values)  # type: ignore[type-var]
    step = scene.duration / live.steps[places.get("steps", live.start)]
    munk = live.munk[places.get("munk", 0)][1]
    munk = replace(munk, iterations=SWEEPS[places.get("iterations", 3)][0], error_bias=BIASES[places.get("bias", 1)][0])
    integrator: Any = INTEGRATORS[places.get("integrator", 0)][1].split(",")[0]
    tolerance = TOLERANCES[places.get("tolerance", 0)][0]
    engine = replace(live.mujoco[places.get("mujoco", 0)][1], integrator=integrator, tolerance=tolerance)
    return scene, munk, engine, step


BY_NAME = {lesson.name: lesson for lesson in LESSONS}


def marked(*asked: Any) -> Any:
    """Parameters that begin with the name of a lesson: slow unless it is a quick one."""
    return pytest.param(*asked, marks=() if asked[0] in QUICK else pytest.mark.slow)


LIVE = [
    marked(lesson.name, index)
    for lesson in LESSONS
    for index, _ in enumerate(lesson.live)
    if lesson.name != "centrodes"
]
# By how much an engine in the page may differ from the same one in Python, relative to the motion's size. Both do the
# same operations, though MuJoCo's releases differ, and compilers round some sums in another order: measured are 1e-17
# to 1e-13. Coarse steps of a car that stands on contacts (5e-8), of a blade that does (2e-11), and of a crank with a
# heavy slider (8e-10) multiply last digits. The contact of two ellipses (3e-4) is searched for until it moves by less
# than 1e-6, MuJoCo's ccd_tolerance, which releases do not do alike.
APART = {"gears": 1e-2, "wheels": 1e-6, "skate": 1e-9, "slider_crank": 1e-8}


@pytest.mark.parametrize("other", [True, pytest.param(False, marks=pytest.mark.slow)], ids=["moved", "as shipped"])
@pytest.mark.parametrize(("lesson", "index"), LIVE)
def test_the_engines_in_the_page_give_what_python_gives(running, lesson, index, other):
    live = BY_NAME[lesson].live[index]
    places = {"steps": 2, "iterations": 4, "bias": 2, "integrator": 1, "tolerance": 2, **last(live)} if other else {}
    if other and len(live.munk) > 1:
        places["munk"] = 1
    if other and len(live.mujoco) > 1:
        places["mujoco"] = 1
    found = choose(running(lesson), index, places)
    scene, munk, engine, step = python_of(live, places)
    samples = found["steps"] // found["every"]
    truth = scene.motion(np.arange(samples + 1) * (scene.duration / samples)).pose
    assert np.abs(np.reshape(found["truth"], truth.shape) - truth).max() < 1e-12 * max(1.0, float(np.abs(truth).max()))
    for name, method in (("munk", munk), ("mujoco", engine)):
        try:
            python = method.build(scene.mechanism(), step)(samples, found["every"])
        except Unsupported:
            assert found[name] is None
            continue
        page = np.reshape(np.array(found[name], dtype=float), python.pose.shape)
        lost = np.isnan(python.pose)  # MuJoCo started anew, and what follows is no motion
        assert np.array_equal(np.isnan(page), lost)
        apart = np.abs(page - python.pose)[~lost].max() / max(1.0, float(np.abs(python.pose[~lost]).max()))
        assert apart < (APART.get(lesson, 1e-12) if name == "mujoco" else 1e-12)
        measure = slice(2, 3) if measure_of(scene.mechanism()) == "angle" else slice(0, 2)
        error = np.linalg.norm((page - truth)[..., measure], axis=-1).max()
        assert found["errors"][name] == (pytest.approx(error, rel=1e-6) if np.isfinite(error) else None)


def test_springs_of_mujoco_are_those_of_the_sliders(running):
    live = BY_NAME["four_bar"].live[0]
    found = choose(running("four_bar"), 0, {"integrator": 2, "timeConstant": 2, "impedance": 4})
    step = live.scene.duration / live.steps[live.start]
    engine = replace(mujoco.DEFAULT, integrator="RK4", stiffness=TiedToStep(TIME_CONSTANTS[2][0] / step))
    assert IMPEDANCES[4][0] == STIFFEST[0]
    python = engine.build(live.scene.mechanism(), step)(live.samples(found["steps"]), found["every"])
    assert np.abs(np.reshape(found["mujoco"], python.pose.shape) - python.pose).max() < 1e-12
    shipped = choose(running("four_bar"), 0, {"integrator": 2})
    assert found["errors"]["mujoco"] < 0.5 * shipped["errors"]["mujoco"]


def test_a_link_holds_the_sliders(running, opened):
    page = running("skate")
    choose(page, 0, {"offset": 1, "steps": 1, "iterations": 6, "munk": 1})
    linked = opened("lessons/skate.html" + page.evaluate("location.hash"))
    linked.wait_for_selector("#live.ready")
    held = linked.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#live form input')].map(i => [i.name, i.value]))"
    )
    assert (held["0.offset"], held["0.steps"], held["iterations"], held["0.munk"]) == ("1", "1", "6", "1")
    assert errors_of(linked) == errors_of(page)


def test_a_link_chooses_the_motion_and_a_wrong_one_does_no_harm(opened):
    page = opened("lessons/four_bar.html#live&scene=1&1.crank=0&steps=99&0.crank=77&nothing&=")
    page.wait_for_selector("#live.ready")
    assert page.evaluate("document.querySelector('#live select').value") == "1"
    assert page.evaluate("document.querySelector('[name=\"1.crank\"]').value") == "0"
    assert page.evaluate("document.querySelector('[name=\"0.crank\"]').value") == "2"


@pytest.mark.parametrize("lesson", [marked(lesson.name) for lesson in LESSONS if lesson.live])
def test_buttons_move_the_sliders_and_say_what_should_happen(running, lesson):
    page = running(lesson)
    for index, live in enumerate(BY_NAME[lesson].live):
        before = choose(page, index, {})["errors"]
        for trap in live.traps:
            page.locator(f"#live button[data-of='{index}']", has_text=trap.words).click()
            assert page.inner_text("#live .expected") == trap.told
            after = errors_of(page)
            assert after != before
        page.get_by_role("button", name="As shipped").click()
        assert errors_of(page) == before
        assert page.locator("#live .expected").inner_text() == ""


@pytest.mark.parametrize("each", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_every_page_loads_without_a_complaint_and_fits_a_phone(files, opened, each):
    """Every lesson, and of the others each fourth: pages of one kind have one template; the slow test opens all."""
    names = sorted(name for name in files if name.endswith(".html") and not name.startswith("reference/"))
    lessons = [name for name in names if name.startswith("lessons/")]
    for name in dict.fromkeys([*lessons, *names[::each]]):
        page = opened(name, viewport=PHONE)
        assert page.title()
        wide = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        assert wide <= 0, f"{name} is wider than a phone by {wide} px"
        page.context.close()


def test_a_motion_is_played_dragged_and_switched_by_keys_alone(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    clock = page.locator("#figure-1 .clock")
    body = page.locator("#figure-1 .motion.truth .body").first
    start = (clock.inner_text(), body.get_attribute("transform"))
    for _ in range(60):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.matches('#figure-1 .play')"):
            break
    else:
        pytest.fail("no key leads to the button of the first picture")
    page.keyboard.press("Tab")
    page.keyboard.press("End")
    assert (clock.inner_text(), body.get_attribute("transform")) != start
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.value") == "paths"
    page.keyboard.press("Space")
    assert page.locator("#figure-1 .trace").first.is_hidden()
    page.locator("#figure-1 .play").focus()
    page.keyboard.press("Enter")
    page.wait_for_function("Number(document.querySelector('#figure-1 .time input').value) > 3")
    page.keyboard.press("Enter")


def test_without_a_script_words_pictures_and_tables_are_there(opened):
    page = opened("lessons/four_bar.html", java_script_enabled=False)
    assert "Three bars and four pins" in page.inner_text("main")
    assert page.locator("#figure-1 .motion.truth .body").count() == 3
    assert page.locator(".controls").first.is_hidden()
    assert "Driven towards a dead centre." in page.inner_text("#step-5")
    page = opened("results/four_bar.html", java_script_enabled=False)
    assert page.locator("table").count() > 3
    assert page.locator("img").first.evaluate("image => image.complete && image.naturalWidth > 0")


def test_a_table_is_sorted_and_filtered(opened):
    page = opened("results/index.html")
    table = page.locator("table").filter(has=page.locator("tbody tr:nth-child(6)")).first
    before = table.locator("tbody tr").count()
    word = table.locator("tbody tr td").first.inner_text().split()[0]
    page.locator(".filter input").first.fill(word)
    shown = table.locator("tbody tr:visible").count()
    assert 0 < shown < before
    page.locator(".filter input").first.fill("")
    head = table.locator("th button").first
    head.click()
    first = table.locator("tbody tr td:first-child").all_inner_texts()
    head.click()
    assert table.locator("tbody tr td:first-child").all_inner_texts() != first
    assert table.locator("th").first.get_attribute("aria-sort") == "descending"


def test_the_site_is_small(files):
    assert compressed_size(files) < 6_000_000
    first = [
        name
        for name in files
        if name in ("index.html", "site.css", "colours.css", "player.js", "motion.js", "chart.js")
    ]
    assert compressed_size({name: files[name] for name in first}) < 100_000
