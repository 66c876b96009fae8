"""Fixtures with a site in Chromium, and functions that run engines in the page and in Python;
`tests/tools/browser.sh` installs all."""

from __future__ import annotations

import functools
import os
import shutil
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reference.scene import Scene
from reports.cli.site import texts_of
from reports.model.tasks import answered
from reports.site.build import SiteSource, build, quantity_data, tasks
from reports.site.folder import server, write_site
from reports.site.lesson import Claim, LessonQuantity
from reports.site.lessons import LESSONS
from reports.site.live.sliders import ENGINES, INTEGRATORS, Live
from tests import RESULTS

# SITE_BROWSER=firefox: the Firefox that `playwright install firefox` downloads. Otherwise it is the system's Chromium.
KIND = os.environ.get("SITE_BROWSER", "chromium")
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
if BROWSER is None and KIND == "chromium":
    pytest.skip("no Chromium is installed: tests/tools/browser.sh installs it on Debian", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[browser]'")
pytest.importorskip("furo", reason="furo is not installed: pip install '.[site]'")

PHONE = {"width": 390, "height": 844}
TALL = {"width": 1200, "height": 8000}  # Without scrolling, the picture does not switch to another experiment.
LONGEST = 30_000.0  # Timeout [ms]. A lesson is ready after less than 1 s on a machine without load.

# Other lessons are used by slow tests only.
QUICK = ("four_bar", "skate", "rolling")


@functools.cache
def build_lessons(names: frozenset[str], cache: Path) -> Mapping[str, Any]:
    answers = {motion: answered(motion) for motion in tasks([BY_NAME["four_bar"]])}
    source = SiteSource(**texts_of(RESULTS), answers=answers, cache=cache, foot="Made by a test.", api=False)
    return build(source, [lesson for lesson in LESSONS if lesson.name in names])


@pytest.fixture(scope="module")
def files(request):
    """The site with the lessons in QUICK and with the lessons of the selected tests. A process builds it once."""
    items = (item for item in request.session.items if item.path.stem.endswith("_in_browser"))
    parameters = (vars(item).get("callspec") for item in items)
    names = {*QUICK, *(call.params.get("lesson", QUICK[0]) for call in parameters if call is not None)}
    return build_lessons(frozenset(names), Path(request.config.cache.mkdir("site")))


@pytest.fixture(scope="module")
def address(files, tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "site"
    write_site(folder, files)
    running = server(folder.parent, 0)  # the site is in a subfolder
    threading.Thread(target=running.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{running.server_address[1]}/site/"
    running.shutdown()
    running.server_close()


@pytest.fixture(scope="module")
def chromium():
    with playwright.sync_playwright() as started:
        options = {"executable_path": BROWSER, "args": ["--no-sandbox"]} if KIND == "chromium" else {}
        browser = getattr(started, KIND).launch(**options, timeout=LONGEST)
        yield browser
        browser.close()


def new_page(chromium: Any, **options: Any) -> Any:
    context = chromium.new_context(**{"viewport": {"width": 1200, "height": 900}, **options})
    context.set_default_timeout(LONGEST)
    return context.new_page()


@pytest.fixture
def opened(chromium, address):
    """A function that opens a page in a new context; an error or a warning of the browser fails the test. A lesson is
    returned when its data are loaded."""
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
        if name.startswith("lessons/") and options.get("java_script_enabled", True):
            page.wait_for_selector("#lesson.ready")
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert complaints == []


def local(url: str, address: str) -> bool:
    return url.startswith((address, "data:", "blob:"))


@pytest.fixture(scope="module")
def running(chromium, address, files):
    """A function that returns the page of a lesson with loaded engines. The function opens each page once."""
    if "packages/mujoco.wasm" not in files:
        pytest.skip("the site was built without MuJoCo: tests/tools/browser.sh installs npm")
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


FIXTURES = (address, chromium, files, opened, running)  # A test file assigns them to the names by which tests get them.
BY_NAME = {lesson.name: lesson for lesson in LESSONS}

# JavaScript that runs the engines of the page. `places`: indices of controls. `start`: initial pose, or null. `wanted`:
# quantities.
RUN_ENGINES = """async ([scene, places, start, wanted]) => {
  const { ask, form } = window.crosscheck;
  form.move(scene, places);
  const setting = form.setting(start);
  const answer = await ask({ setting, quantities: wanted });
  const missed = answer.exact.computed ? await ask({ kind: "check", setting }) : null;
  return { exact: { pose: [...answer.exact.pose], missed }, lost: answer.lost, idle: answer.idle,
    own: answer.own, quantities: Object.fromEntries(answer.quantities.map(({ kind, found }) => [kind, found])),
    motions: Object.fromEntries(answer.motions.map(({ name, pose, twist, error, why, apart }) =>
      [name, { pose: [...pose], twist: [...twist], error, why, apart }])) };
}"""


def run_engines(
    page: Any,
    lesson: str,
    scene: str,
    values: dict[str, Any],
    start: list[float] | None = None,
    quantities: Sequence[LessonQuantity] = (),
) -> Any:
    """Return the motions of the engines in the page for a scene with these values of its controls."""
    live = BY_NAME[lesson].scene(scene)
    wanted = [quantity_data(live, each) for each in quantities]
    return page.evaluate(RUN_ENGINES, [BY_NAME[lesson].scenes.index(live), live.located(values), start, wanted])


def number_of(answer: Any, claim: Claim) -> float:
    """Return the number of a run on which a claim is made; a lost motion has an infinite error."""
    if claim.of is not None:
        found = answer["quantities"][claim.of][claim.engine]
        assert found is not None
        return found[-1]
    error = answer["motions"][claim.engine]["error"]
    return error if error is not None and np.isfinite(error) else np.inf


def python_of(live: Live, values: dict[str, Any]) -> tuple[Scene, dict[str, Any], float]:
    """Return the scene, Python's engines and the step [s] for these values; a missing engine is a string."""
    changed: Any = {name: value for name, value in values.items() if name in {slider.field for slider in live.sliders}}
    scene: Any = replace(live.scene, **changed)  # type: ignore[type-var]
    step = scene.duration / values.get("steps", live.steps[live.start])
    engines: dict[str, Any] = {
        name: next(
            engine for label, engine in live.methods(name) if label == values.get(name, live.methods(name)[0][0])
        )
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


def marked(*arguments: Any) -> Any:
    """Return parameters of a test; it is marked slow unless the first parameter, a lesson, is in QUICK."""
    return pytest.param(*arguments, marks=() if arguments[0] in QUICK else pytest.mark.slow)
