"""Every page is written where some of our engines are not registered: nothing asks for one by its name in vain."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.tools.installations import ROOT

# Hides what we register of some engines, then writes every page from no rows at all. Pictures are drawn and not written
# as text: by then no engine is asked for.
WITHOUT = """
import sys
from engines import entry_points
from reports.plots.theme import FigureCanvasSVG

FigureCanvasSVG.print_svg = lambda self, out, **settings: out.write("<svg/>")

ours, hidden = entry_points._ours, sys.argv[1:]
entry_points._ours = lambda group: [point for point in ours(group) if not any(word in point[1] for word in hidden)]
from engines.registry import ENGINES
from reports.model.catalogue import PAGES, TROUBLES
from reports.model.page import Material
from reports.pages.index import render_index
from reports.pages.rendering import render_page

assert ENGINES and not {engine.name for engine in ENGINES} & set(sys.argv[1:])
assert TROUBLES == (), TROUBLES
materials = {page: Material({}) for page in PAGES}
for page, material in materials.items():
    render_page(page, material, "a test")
render_index(materials, "a test")
print(*[page.name for page in PAGES])
"""


def written_without(*engines):
    ended = subprocess.run([sys.executable, "-c", WITHOUT, *engines], cwd=ROOT, capture_output=True, text=True)
    assert ended.stderr == ""
    assert {"four_bar", "skate", "rolling", "errata"} <= set(ended.stdout.split())


def test_our_pages_are_written_where_two_engines_are_not_registered():
    """What asks for one of them by its name fails without both too; the slow test hides each alone."""
    written_without("pymunk", "mujoco")


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["pymunk", "mujoco", "lagrange"])
def test_our_pages_are_written_where_an_engine_is_not_registered(engine):
    written_without(engine)
