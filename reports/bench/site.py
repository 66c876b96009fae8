"""What the site costs who reads it: sizes, the first picture, and a second of the four-bar in both engines."""

from __future__ import annotations

import shutil
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reports.site.folder import MARKER, compressed_size, server

SIZE, FIRST, SECOND = 6.0, 1.0, 16.0  # MB, s, ms: what the site is to stay below
STEP = 4e-3  # s
TURNS = 25
LESSON, SCENE = "lessons/four_bar.html", 1  # the linkage that is let go, which moves for a second
# The first drawing of a page that has something in it, as the browser tells it [ms].
PAINTED = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? null"
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


@dataclass(frozen=True)
class SiteSize:
    """Of a site, each file compressed by itself: all files [MB], and how many there are."""

    megabytes: float
    files: int


@dataclass(frozen=True)
class Times:
    """Until the first picture of the first page, and until the engines of a lesson are ready [s]; the least of TURNS
    times [ms] of a second of the four-bar in steps of STEP, by engine."""

    painted: float
    ready: float
    stepped: dict[str, float]


def size_of(folder: Path) -> SiteSize:
    """Raises ValueError where no site is."""
    if not (folder / MARKER).is_file():
        raise ValueError(f"{folder} has no site: `crosscheck site` writes one")
    contents = {
        path.name + str(number): path.read_bytes() for number, path in enumerate(folder.rglob("*")) if path.is_file()
    }
    return SiteSize(compressed_size(contents) / 1e6, len(contents))


def times_of(folder: Path) -> Times:
    """In Chromium, without a screen. Raises ValueError where it, or playwright, is not installed."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser")
    try:
        from playwright.sync_api import sync_playwright  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise ValueError("playwright is not installed: pip install -e '.[browser]'") from None
    if browser is None:
        raise ValueError("no Chromium is installed: tests/tools/browser.sh installs it on Debian")
    running = server(folder, 0)
    threading.Thread(target=running.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{running.server_address[1]}/"
    try:
        with sync_playwright() as started:
            return _times(started.chromium.launch(executable_path=browser, args=["--no-sandbox"]), address)
    finally:
        running.shutdown()
        running.server_close()


def _times(browser: Any, address: str) -> Times:
    try:
        page = browser.new_page()
        page.goto(address + "index.html")
        page.wait_for_function(f"({PAINTED}) !== null")
        painted = page.evaluate(PAINTED) / 1000
        lesson = browser.new_page()
        lesson.goto(address + LESSON)
        lesson.wait_for_selector("#lesson.ready")
        ready = lesson.evaluate("performance.now()") / 1000
        spent = lesson.evaluate(STEPPED, [SCENE, STEP, TURNS])
        return Times(painted, ready, {name: min(values) for name, values in spent.items()})
    finally:
        browser.close()
