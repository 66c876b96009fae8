"""Measurements of `crosscheck bench site`: sizes, and pages in Chromium, also on a slow phone."""

from __future__ import annotations

import gzip
import io
import json
import shutil
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from reports.bench.times import Row
from reports.model.ending import BadInput
from reports.site.folder import MARKER, Quiet, compressed_size, server

VISITS = 3  # the least of these is printed
LESSON, SCENE, STEP = "lessons/four_bar.html", 1, 4e-3  # page, index of the scene, and step [s]
STEPPED = """async ([scene, step, turns]) => {
  const { ask, form } = window.crosscheck;
  form.move(scene, {});
  const setting = { ...form.setting(null), steps: Math.round(1 / step) };
  const spent = { munk: [], mujoco: [] };
  for (let turn = 0; turn < turns; turn++) {
    for (const { name, milliseconds } of (await ask({ setting })).motions) spent[name].push(milliseconds);
  }
  return spent;
}"""
# A slow phone, as Lighthouse has it: its window, its network (ms, bytes/s), and a processor that is four times slower.
PHONE = {"width": 390, "height": 844}
NETWORK = {"offline": False, "latency": 150, "downloadThroughput": 200_000, "uploadThroughput": 93_750}
SLOWED = 4
# Prints when the first picture is drawn [ms]; a browser calls for no frame before it can draw the page.
PICTURED = """requestAnimationFrame(function look() {
  const picture = document.querySelector('svg.stage .body, img');
  if (picture?.tagName === 'IMG' ? picture.complete : picture) {
    requestAnimationFrame(() => setTimeout(() => console.log(`pictured ${performance.now()}`)));
  } else requestAnimationFrame(look);
})"""
VISITED = """addEventListener('load', async () => {
  const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
  await pause(2000);
  for (const button of document.querySelectorAll('.set, .answers button:first-child')) {
    button.click();
    await pause(500);
  }
  console.log('visited');
})"""
VISIT_LIMIT = 120.0  # s


class Compressing(Quiet):
    """Sends compressed texts, as static hosts do."""

    def send_head(self) -> Any:
        path = Path(self.translate_path(self.path))
        if path.suffix not in (".html", ".css", ".js", ".svg", ".json") or not path.is_file():
            return super().send_head()
        content = gzip.compress(path.read_bytes())
        self.send_response(200)
        for name, value in {"Content-Type": self.guess_type(path), "Content-Length": len(content)}.items():
            self.send_header(name, str(value))
        self.send_header("Content-Encoding", "gzip")
        self.end_headers()
        return io.BytesIO(content)


def measure_site(folder: Path) -> Iterator[Row]:
    """Sizes of a site, loading times and longest tasks of its pages. Raises BadInput without a browser or a site."""
    if not (folder / MARKER).is_file():
        raise BadInput(f"{folder} has no site: `crosscheck site` writes one")
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    try:
        from playwright.sync_api import sync_playwright  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise BadInput("playwright is not installed: pip install -e '.[browser]'") from None
    if browser is None:
        raise BadInput("no Chromium is installed: tests/tools/browser.sh installs it on Debian")
    contents = {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    yield from [("files", float(len(contents)), "1"), ("compressed", compressed_size(contents) / 1e6, "MB")]
    running = server(folder, 0, Compressing)
    threading.Thread(target=running.serve_forever, daemon=True).start()
    lessons = sorted(f"lessons/{path.name}" for path in folder.glob("lessons/*.html"))
    try:
        with sync_playwright() as started:
            opened = started.chromium.launch(executable_path=browser, args=["--no-sandbox"])
            yield from _measure_pages(opened, f"http://127.0.0.1:{running.server_address[1]}/", lessons)
            opened.close()
    finally:
        running.shutdown()
        running.server_close()


def _measure_pages(browser: Any, address: str, lessons: Sequence[str]) -> Iterator[Row]:
    lesson = browser.new_page()
    lesson.goto(address + LESSON)
    lesson.wait_for_selector("#lesson.ready")
    yield "engines of a lesson ready", lesson.evaluate("performance.now()") / 1000, "s"
    for engine, times in lesson.evaluate(STEPPED, [SCENE, STEP, 25]).items():
        yield f"a second of the four-bar in steps of {1e3 * STEP:g} ms by {engine}", min(times), "ms"
    lesson.context.close()
    for page in ("index.html", *lessons):
        picture = min(_measure_first_picture(browser, address + page) for _ in range(VISITS))
        yield f"{page}: first picture on a slow phone", picture / 1000, "s"
    for page in lessons:
        task = min(_measure_longest_task(browser, address + page) for _ in range(VISITS))
        yield f"{page}: longest task, {SLOWED} times slower", SLOWED * task / 1000, "ms"


def _measure_first_picture(browser: Any, address: str) -> float:
    """Elapsed time [ms] until a slow phone with an empty cache shows the first picture of a page."""
    context = browser.new_context(viewport=PHONE)
    page = context.new_page()
    tools = context.new_cdp_session(page)
    tools.send("Network.emulateNetworkConditions", NETWORK)
    tools.send("Emulation.setCPUThrottlingRate", {"rate": SLOWED})
    page.add_init_script(PICTURED)
    with page.expect_console_message(lambda message: message.text.startswith("pictured ")) as message:
        page.goto(address, wait_until="commit")
    context.close()
    return float(message.value.text.split()[1])


def _measure_longest_task(browser: Any, address: str) -> float:
    """CPU time [us] of the longest task on the main thread, while a lesson loads and all its experiments are run.

    Other programs do not lengthen a CPU time, as they do the duration that the browser's own list of long tasks has.
    """
    context = browser.new_context(viewport=PHONE)
    page = context.new_page()
    page.add_init_script(VISITED)  # a call of the page from here would be a task of the page
    browser.start_tracing(page=page, categories=["disabled-by-default-devtools.timeline"])
    with page.expect_console_message(lambda message: message.text == "visited", timeout=1000 * VISIT_LIMIT):
        page.goto(address)
    events = json.loads(browser.stop_tracing())["traceEvents"]
    context.close()
    tasks: dict[tuple[int, int], list[int]] = {
        (event["pid"], event["tid"]): [] for event in events if event.get("args", {}).get("name") == "CrRendererMain"
    }
    for event in events:
        thread = event["pid"], event["tid"]
        if event["name"] == "RunTask" and thread in tasks:
            tasks[thread].append(event.get("tdur", 0))
    return max(max(tasks.values(), key=len))  # the browser keeps an idle process for the next page
