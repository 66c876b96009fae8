"""The notebook of the lecture: its cells run one after another, and what it teaches is so."""

from __future__ import annotations

import io
import json
import re
import sys
from contextlib import redirect_stdout
from types import ModuleType
from typing import Any

import matplotlib
import pytest

from tests import ROOT

NOTEBOOK = ROOT / "lecture.ipynb"
CELLS = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]


@pytest.fixture(scope="module")
def given() -> Any:
    """What the cells leave behind, and what they print."""
    module = ModuleType("lecture")
    printed = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        patch.setitem(sys.modules, "lecture", module)
        matplotlib.use("agg")
        import matplotlib.pyplot as plt

        for number, cell in enumerate(CELLS):
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), f"cell {number}", "exec"), vars(module))
        plt.close("all")
    return module, printed.getvalue()


def test_every_cell_runs_and_the_two_ways_agree(given):
    module, printed = given
    assert "rows and coordinates: (8, 9)  freedoms of place and of velocity: (1, 1)" in printed
    assert module.apart < 1e-9
    assert len(module.figure.axes) == 1


def test_what_it_says_of_orders_and_the_plateau_is_so(given):
    module, _ = given
    # The first order of the engine as shipped; tuned, MuJoCo's follows the square of the step.
    assert module.slopes["pymunk default"] == pytest.approx(1.0, abs=0.35)
    assert module.slopes["mujoco tuned"] == pytest.approx(2.0, abs=0.35)
    # A plateau: thirty times as many steps, and hardly a smaller error.
    plateau = module.swept["mujoco RK4"]
    assert plateau.min() > plateau.max() / 2
    # With the integrator as shipped the two errors cancel at one step: it is below the plateau, which no order makes.
    assert module.swept["mujoco default"][-1] < plateau[-1]
    # Documented settings win more than a step a tenth as large.
    assert module.swept["mujoco tuned"][0] < plateau[2]


def test_it_holds_no_results_and_uses_what_everybody_may_use():
    text = "\n".join("".join(cell["source"]) for cell in CELLS if cell["cell_type"] == "code")
    assert all(cell["outputs"] == [] for cell in CELLS if cell["cell_type"] == "code")
    packages = set(re.findall(r"^\s*(?:from|import) ([\w.]+)", text, re.MULTILINE))
    assert packages == {
        "dataclasses",
        "numpy",
        "matplotlib.pyplot",
        "reference.scenes.four_bar.scenes",
        "engines.lagrange",
        "engines",
    }
