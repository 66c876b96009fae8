"""Tests of the compiled Munk2D: it was compiled from the current sources and computes the motions of Python's
pymunk."""

from __future__ import annotations

import gzip
from dataclasses import replace
from importlib.metadata import version

import numpy as np
import pytest

from reports.site.lessons import LESSONS
from reports.site.live.data import data
from reports.site.munk2d import COMPILED, SHIM, compiled_from, source_digest
from tests.reports.page_scripts import run_in_node

COMPILED_RELEASE, COMPILED_DIGEST = compiled_from(COMPILED.read_text("utf-8"))
LIVES = {f"{lesson.name}, {live.word}": live for lesson in LESSONS for live in lesson.scenes}
# Largest relative difference from Python's pymunk. Polygonal gears amplify rounding; the measured difference is 3e-7.
APART = {"gears, two gears": 1e-5}
# Program for Node that runs each of the page's methods of pymunk. Node gets the objects `window` and `document` of a
# browser.
NODE = """
globalThis.window = globalThis;
globalThis.document = {};
const { runMunk } = await import("./live_engines.js");
const { runOf, modelOf } = await import("./live_data.js");
const munk = await (await import("./munk2d.js")).default({});
const scene = JSON.parse((await import("node:fs")).readFileSync(0, "utf8"));
const motions = scene.munk.map((method, munkPlace) => {
  const own = { start: null, iterations: null, bias: null };
  const setting = { place: 0, stepPlace: 0, steps: STEPS, munk: munkPlace, ...own };
  const run = runOf(setting, scene);
  return "why" in method ? null : [...runMunk(munk, run).pose].map((value) => (Number.isFinite(value) ? value : null));
});
console.log(JSON.stringify(motions));
"""


def test_the_compiled_munk2d_is_from_the_present_sources_and_small():
    assert source_digest(COMPILED_RELEASE) == COMPILED_DIGEST, (
        f"{SHIM.name} has changed: python -m reports.site.munk2d compiles it"
    )
    assert source_digest("1.0") != COMPILED_DIGEST
    assert len(gzip.compress(COMPILED.read_bytes(), 9)) < 100_000
    assert compiled_from("no header") == ("", "")


@pytest.mark.skipif(version("pymunk") != COMPILED_RELEASE, reason="another release of pymunk is installed")
@pytest.mark.parametrize("name", LIVES)
def test_the_compiled_munk2d_computes_the_motions_of_python(name, tmp_path):
    live = replace(LIVES[name], sliders=())
    steps = live.steps[live.start]
    script = NODE.replace("STEPS", str(steps))
    pages = run_in_node(tmp_path, script, data(live, {}))
    compared = 0
    for page, (_, engine) in zip(pages, live.munk, strict=True):
        if page is None:
            continue
        assert not isinstance(engine, str)
        samples = live.samples(steps)
        python = engine.build(live.scene.mechanism(), live.scene.duration / steps)(samples, steps // samples).pose
        pose = np.reshape(np.array(page, dtype=float), python.shape)
        size = max(1.0, float(np.abs(python).max()))
        assert np.abs(pose - python).max() < APART.get(name, 1e-12) * size
        compared += 1
    assert compared > 0
