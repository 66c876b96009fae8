"""Tests that the programs of recommended settings run and have the errors of the rows."""

from __future__ import annotations

import contextlib
import io
import re

import numpy as np
import pytest

from engines import method_name
from reports.model.convergence import judged
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.write.page_tables import Program, advice, advised_programs
from tests.committed_rows import page_rows
from tests.reports.test_pages import MECHANISMS, texts, undrawn

__all__ = ["undrawn"]

FENCED = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
named = pytest.mark.parametrize("page", MECHANISMS, ids=lambda page: page.name)


def run(source: str) -> tuple[dict, str]:
    """Run a program, and return its global names and its output."""
    names, printed = {"__name__": "__main__"}, io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(source, "a page", "exec"), names)
    return names, printed.getvalue()


def advised(page: Page) -> tuple[list[Program], list]:
    """The programs of a page from the committed rows, and the rows of its scene."""
    scene = page.advised_scene
    assert scene is not None
    rows = [row for row in judged(Material(page_rows(page)).sweep([scene]), page.quantity) if row.scene == scene.name]
    methods = tuple(method_name(engine) for engine in page.engines_of(scene))
    result = advice(rows, page.quantity, methods)
    built = advised_programs(scene, result, methods)
    assert {item.method for item in built} == {item.row.method for item in result if item.row is not None}
    return built, rows


@named
def test_a_program_has_the_motion_of_its_method_and_at_most_the_error_of_its_row(page):
    scene = page.advised_scene
    engines = {method_name(engine): engine for engine in page.engines_of(scene)}
    built, rows = advised(page)
    for item in built:
        if not item.text:
            continue
        names, message = run(item.text)
        steps, duration = names["steps"], names["duration"]
        assert duration <= min(scene.duration, scene.horizon)
        trajectory = engines[item.method].build(scene.mechanism(), duration / steps)(1, steps)
        body, *end = re.findall(r"^(.*): x = (\S+) m, y = (\S+) m, angle = (\S+) rad$", message)[0]
        reported = re.findall(rf"^# Exact: {body}: x = (\S+) m, y = (\S+) m, angle = (\S+) rad$", item.text, re.M)[0]
        index = scene.mechanism().body_index(body)
        # Programs contain the scene's numbers with twelve digits; the difference grows to a few 1e-11 during the
        # motion.
        assert np.asarray(names["end"]) == pytest.approx(trajectory.pose[-1, index], abs=1e-9), item.file
        assert [float(value) for value in end] == pytest.approx(names["end"], abs=1e-10)
        exact = scene.motion([duration]).pose[0, index]
        assert [float(value) for value in reported] == pytest.approx(exact, abs=1e-10), item.file
        (row,) = [row for row in rows if row.method == item.method and row.step == pytest.approx(duration / steps)]
        far = np.abs(exact - names["end"])
        assert np.hypot(*far[:2]) <= 1.01 * row.position + 1e-9
        assert far[2] <= 1.01 * row.angle + 1e-9


@named
def test_a_pages_block_gives_the_error_of_the_row_of_each_method_without_a_program(page, undrawn):
    built, rows = advised(page)
    blocks = [source for _, source in FENCED.findall(texts(page)[page.document])]
    (block,) = [source for source in blocks if "for method, every in {" in source]
    message = {line.rpartition(": ")[0]: line.rpartition(": ")[2] for line in run(block)[1].splitlines()}
    requested = {item.method: item.every for item in built if not item.text}
    assert message.keys() == requested.keys()
    for method, every in requested.items():
        (row,) = [row for row in rows if row.method == method and row.every == every]
        error, unit = message[method].split()
        assert unit == quantity(page.quantity).unit
        assert float(error) == pytest.approx(getattr(row, page.quantity), rel=0.01, abs=1e-12), method
