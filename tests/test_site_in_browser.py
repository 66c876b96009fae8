"""The site in Chromium: every page loads, the engines in it give Python's numbers, and keys alone are enough.

Skipped where there is no Chromium, no playwright, or no packages of npm: `tests/browser.sh` installs them on Debian.
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

from engines import mujoco, pymunk
from engines.mujoco.stiffness import STIFFEST, Shipped, TiedToStep
from reference.four_bar import FreeFourBar
from reports.grid.tasks import answered
from reports.site import live
from reports.site.build import Source, build
from reports.site.lessons import LESSONS
from reports.site.serving import server
from reports.site.writing import compressed_size, write_site

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
if BROWSER is None:
    pytest.skip("no Chromium is installed: tests/browser.sh installs it on Debian", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[browser]'")

RESULTS = Path(__file__).parents[1] / "reports" / "results"
PHONE = {"width": 390, "height": 844}
# Places of the sliders (indices): the chapter's, and another mechanism, in each engine's settings as shipped and tuned.
SHIPPED = {"steps": 3, "integrator": 0, "timeConstant": 4, "impedance": 0, "iterations": 3, "bias": 1}
TUNED = {"steps": 4, "integrator": 2, "timeConstant": 2, "impedance": 4, "tolerance": 2, "iterations": 5, "bias": 3}
OTHER = {"crank": 1, "coupler": 3, "ratio": 3, "speed": 3}
START = {"free": 0, "crank": 2, "coupler": 1, "ratio": 2, "speed": 2, "freeSteps": 3, "tolerance": 0}
PLACES = ({}, SHIPPED, TUNED, SHIPPED | OTHER, TUNED | OTHER, SHIPPED | {"free": 1}, TUNED | {"free": 1})


@pytest.fixture(scope="module")
def files(tmp_path_factory, request):
    texts = {suffix: {path.name: path.read_text("utf-8") for path in RESULTS.glob(f"*{suffix}")} for suffix in SUFFIXES}
    four_bar = LESSONS[0]
    answers = {
        motion: answered(motion) for name in ("driven", "large") for motion in four_bar.takes[name].motions().values()
    }
    cache = Path(request.config.cache.mkdir("site"))
    source = Source(texts[".md"], texts[".svg"], texts[".csv"], answers, cache, "Made by a test.", api=False)
    return build(source)


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
    """The page of the four-bar with its engines loaded."""
    if not {"packages/mujoco.wasm", "packages/munk2d.js"} <= set(files):
        pytest.skip("the site was built without its engines: tests/browser.sh installs npm and emscripten on Debian")
    page = chromium.new_context(viewport={"width": 1200, "height": 900}).new_page()
    page.goto(address + "lessons/four_bar.html")
    page.wait_for_selector("#live.ready")
    yield page
    page.context.close()


def move(page: Any, sliders: dict[str, int]) -> None:
    """Set sliders as a user does, all in one change."""
    page.evaluate(
        """(places) => {
          const form = document.querySelector("#live form");
          for (const [name, place] of Object.entries(places)) form.elements[name].value = String(place);
          form.dispatchEvent(new Event("input", { bubbles: true }));
        }""",
        sliders,
    )


def values(page: Any) -> dict[str, Any]:
    """What the sliders stand for, and what the engines made of it."""
    return page.evaluate(
        """() => {
          const { live, engines, setting, truth, runMujoco, runMunk } = window.crosscheckLive;
          const now = setting();
          return { setting: now, truth: [...truth(live, now)], mujoco: [...runMujoco(engines.mujoco, live, now)],
            munk: [...runMunk(engines.munk, live, now)],
            errors: JSON.parse(document.getElementById("live").dataset.errors) };
        }"""
    )


def python_of(setting: dict[str, Any]) -> tuple[Any, Any, Any, int, int]:
    """The scene, both engines in Python with the same settings, samples and steps between them."""
    if setting["free"]:
        scene: Any = FreeFourBar()
    else:
        scene = live.with_sliders(
            live.CRANKS[setting["crank"]],
            live.COUPLERS[setting["coupler"]],
            live.RATIOS[setting["ratio"]],
            10.0 * setting["speed"],
        )
    samples = setting["steps"] // setting["every"]
    step = scene.duration / setting["steps"]
    shipped = Shipped()
    assert shipped.reference(scene.mechanism(), step) == (0.02, 1.0)
    tied = TiedToStep(setting["timeConstant"] / step)
    stiffness: Any = tied if setting["impedance"] > 0 else shipped
    if setting["impedance"] > 0:
        assert setting["impedance"] == STIFFEST[0]
    integrator: Any = {0: "Euler", 1: "RK4", 3: "implicitfast"}[setting["integrator"]]
    first = mujoco.MuJoCo("x", integrator, stiffness, tolerance=setting["tolerance"], jacobian="auto")
    second = replace(pymunk.DEFAULT, iterations=setting["iterations"], error_bias=setting["bias"])
    return scene, first, second, samples, setting["every"]


@pytest.mark.parametrize("sliders", PLACES)
def test_the_engines_in_the_page_give_what_python_gives(running, sliders):
    move(
        running, {"free": 0, "crank": 2, "coupler": 1, "ratio": 2, "speed": 2, "freeSteps": 3, "tolerance": 0} | sliders
    )
    found = values(running)
    scene, first, second, samples, every = python_of(found["setting"])
    truth = scene.motion(np.arange(samples + 1) * (scene.duration / samples)).pose
    own = np.reshape(found["truth"], truth.shape)
    turns = np.round((own - truth)[0, :, 2] / (2 * np.pi)) * 2 * np.pi
    assert np.abs(own - truth - [[0, 0, turn] for turn in turns]).max() < 1e-12
    step = scene.duration / samples / every
    for name, engine, least in (("mujoco", first, MUJOCO_APART), ("munk", second, MUNK_APART)):
        python = engine.build(scene.mechanism(), step)(samples, every)
        page = np.reshape(found[name], python.pose.shape)
        assert np.abs(page - python.pose - [[0, 0, turn] for turn in turns]).max() < least, name
        error = np.abs(python.pose - truth)[..., 2].max()
        assert found["errors"][("munk", "mujoco").index(name)] == pytest.approx(error, rel=1e-6, abs=1e-9)


MUJOCO_APART = 1e-12
MUNK_APART = 1e-12


def test_a_smaller_step_has_a_smaller_error_and_one_sweep_a_larger(running):
    base = START | SHIPPED
    found = []
    for step in (1, 3, 6):
        move(running, base | {"steps": step})
        found.append(values(running)["errors"])
    munk, engine = zip(*found, strict=True)
    assert munk[0] > 3 * munk[1] > 9 * munk[2]
    assert engine[0] > engine[1] > engine[2]
    move(running, base | {"bias": 3, "iterations": 5})
    many = values(running)["errors"][0]
    move(running, base | {"bias": 3, "iterations": 0})
    assert values(running)["errors"][0] > 3 * many


def test_a_link_holds_the_sliders(running, opened):
    move(running, {"free": 0, "crank": 4, "steps": 1, "iterations": 6})
    link = running.evaluate("location.hash")
    page = opened("lessons/four_bar.html" + link)
    page.wait_for_selector("#live.ready")
    held = page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#live form input')].map(i => [i.name, i.value]))"
    )
    assert (held["crank"], held["steps"], held["iterations"]) == ("4", "1", "6")
    assert page.evaluate("document.getElementById('live').dataset.errors") == running.evaluate(
        "document.getElementById('live').dataset.errors"
    )


def test_presets_and_traps_move_the_sliders_and_say_what_should_happen(running):
    move(running, START | SHIPPED)
    running.get_by_role("button", name="Break it: a step too large").click()
    assert "No method is accurate here" in running.inner_text("#live .expected")
    assert min(json.loads(running.evaluate("document.getElementById('live').dataset.errors"))) > 0.01
    running.get_by_role("button", name="Tuned").click()
    assert json.loads(running.evaluate("document.getElementById('live').dataset.errors"))[1] < 1e-4


def test_every_page_loads_without_a_complaint_and_fits_a_phone(files, opened):
    for name in sorted(each for each in files if each.endswith(".html") and not each.startswith("reference/")):
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


def test_a_trap_shows_another_motion(opened):
    page = opened("lessons/four_bar.html", reduced_motion="reduce")
    assert page.locator("#figure-5 .legend li").count() == 5
    page.get_by_role("button", name="Driven towards a dead centre").click()
    assert page.locator("#figure-5 .legend li").count() == 3  # the truth, and two that were not run
    assert "not run" in page.inner_text("#figure-5 .legend")


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


def test_dark_and_light_can_be_chosen_and_are_kept(opened):
    page = opened("index.html", color_scheme="light", reduced_motion="reduce")
    paper = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(paper)
    page.get_by_role("button", name="between light and dark").click()
    dark = page.evaluate(paper)
    assert dark != light
    page.reload()
    assert page.evaluate(paper) == dark


def test_words_stand_out_from_the_paper(opened):
    ratio = """() => {
      const level = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).map(Number).map((v) => {
        const u = v / 255; return u <= 0.03928 ? u / 12.92 : ((u + 0.055) / 1.055) ** 2.4; });
        return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
      const paper = level(getComputedStyle(document.body).backgroundColor);
      return [...document.querySelectorAll("p, a, h1, h2, li, button, figcaption, legend, output")].map((e) => {
        const ink = level(getComputedStyle(e).color);
        return (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05); });
    }"""
    for scheme in ("light", "dark"):
        page = opened("lessons/four_bar.html", color_scheme=scheme)
        assert min(page.evaluate(ratio)) > 4.5


def test_the_site_is_small(files):
    assert compressed_size(files) < 6_000_000
    first = [
        name
        for name in files
        if name in ("index.html", "site.css", "colours.css", "player.js", "motion.js", "chart.js")
    ]
    assert compressed_size({name: files[name] for name in first}) < 100_000
