"""The readme and the lecture keep their promises: what they show runs and is so; help loads no more than it needs."""

from __future__ import annotations

import io
import json
import math
import re
import shlex
import subprocess
import sys
import tomllib
from contextlib import redirect_stdout
from types import ModuleType
from typing import Any

import matplotlib
import pytest
from typer.main import get_command

from reports.cli.commands import app
from reports.model.catalogue import PAGES
from reports.pages.comparison import PICTURE
from reports.pages.four_bar.page import MOVING_PICTURE
from reports.pages.your_loop.page import LINES
from tests import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_python_example_runs_and_says_what_the_reader_expects(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(compile(example, "README.md", "exec"), {})
    said = capsys.readouterr().out
    # RK4 at a step of 1e-3 s with the stiffness tied to it: of the order of 1e-6 to 1e-5.
    (angle,) = re.findall(r"^ *angle, rad +(\S+)", said, re.MULTILINE)
    assert 0 < float(angle) < 1e-4


def test_the_readme_is_short_and_leads_to_the_lines_to_paste_to_the_lecture_and_to_the_site():
    told = README.splitlines()
    assert len(told) <= 160
    links = re.findall(r"\]\(([^)]+)\)", README)
    assert links[0] == "reports/results/your_loop.md"
    first = "\n".join(told[: len(told) // 3])
    assert "](lecture.ipynb)" in first
    assert "`crosscheck site" in first
    pages = {
        f"reports/results/{name}"
        for name in ("index.md", PICTURE, MOVING_PICTURE, *(f"{page.name}.md" for page in PAGES))
    }
    own = {link.partition("#")[0] for link in links if "://" not in link} - pages
    assert [link for link in own if not (ROOT / link).exists()] == []


def test_the_lines_in_the_readme_are_those_that_a_test_pastes():
    for name in ("options", "close", "choose"):
        assert (LINES / f"{name}.txt").read_text(encoding="utf-8").strip() in README


@pytest.mark.parametrize("file", ["action.yml", "try.sh"])
def test_the_example_of_an_action_gives_compare_words_that_it_knows(file):
    text = (ROOT / "examples" / "compare_build" / file).read_text(encoding="utf-8")
    (line,) = re.findall(r"^ *crosscheck compare (.*) > comparison\.md$", text, re.MULTILINE)
    known = get_command(app).commands["compare"]  # pyright: ignore[reportAttributeAccessIssue]
    given = known.make_context("compare", shlex.split(line.replace("$COST", "1.5"))).params
    assert (given["cost"], given["as_markdown"], list(given["scenes"])) == (1.5, True, [])


CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_contributing_is_short_and_names_files_groups_and_targets_that_are_there():
    assert len(CONTRIBUTING.splitlines()) < 120
    paths = set(re.findall(r"`((?:reports|reference|engines|tests)/[\w/.]+)", CONTRIBUTING))
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(re.findall(r"`(crosscheck\.\w+)`", CONTRIBUTING)) <= set(project["entry-points"])
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert all(f"\n{target}:" in makefile for target in re.findall(r"\bmake (\w+)", CONTRIBUTING))


def test_their_commands_are_the_programs():
    told = set(re.findall(r"^crosscheck ([a-z]+)\b|`crosscheck ([a-z]+)\b", README + CONTRIBUTING, re.MULTILINE))
    words = {word for pair in told for word in pair if word}
    assert {"run", "report", "conform", "list", "show"} <= words
    helping = [sys.executable, "-m", "reports", "--help"]
    said = subprocess.run(helping, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert words <= set(re.findall(r"^  ([a-z]+)  ", said, re.MULTILINE))


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


def test_its_best_claims_are_what_its_charts_and_cells_show(given):
    module, _ = given
    errors = dict(zip(module.fine, module.lucky["default"], strict=True))
    # Luck at 1 ms, from which the error comes back by ten times and more, to the plateau of the spring alone.
    assert errors[100] * 10 < errors[1000] < module.lucky["RK4"][-1] < 1.2 * errors[1000]
    assert max(module.slip, module.gap, module.drift) < 1e-9
    assert module.astray > 1
    assert module.wrong > 0.01
    (few, rough), (many, good) = module.told[20], module.told[100]
    assert few == pytest.approx(many, rel=0.02)
    assert rough > 10 * good


def test_the_exercises_on_rolling_and_skates_have_the_answers_that_are_known_otherwise(given):
    module, printed = given
    # a / b + 1 outside and a / b - 1 inside, the other way round than the centre goes; by 2,000 points of a round.
    assert module.turns == pytest.approx({"disc": 3.0, "hole": -1.0}, abs=1e-3)
    # omega^2 / (1/b + kA): kA = 1/a on the disc, 0 on flat ground, -1/a in the hole.
    assert module.starts == pytest.approx({"disc": 1 / 6, "flat": 1 / 4, "hole": 1 / 2}, rel=1e-12)
    assert "8: (Move(turn=1.57" in printed
    # Differences of second order over a millisecond: an error of 1e-6 times rates near 1.
    assert module.factor == pytest.approx(1.0, abs=1e-4)
    # The solution's sech has died away; a turning rate of 1e-3 rad/s at the start is its first part.
    assert module.turned == pytest.approx(math.pi * module.gyration / 0.5, rel=1e-3)


def test_it_holds_no_results_and_uses_what_everybody_may_use():
    text = "\n".join("".join(cell["source"]) for cell in CELLS if cell["cell_type"] == "code")
    assert all(cell["outputs"] == [] for cell in CELLS if cell["cell_type"] == "code")
    packages = set(re.findall(r"^\s*(?:from|import) ([\w.]+)", text, re.MULTILINE))
    assert packages == {
        "dataclasses",
        "numpy",
        "matplotlib.pyplot",
        "reference.scenes.four_bar.scenes",
        "reference.scenes.person",
        "reference.scenes.skates.sleigh",
        "reference.rolling.curves",
        "reference.rolling.kinematics",
        "reference.chapter.parking",
        "engines.lagrange",
        "engines.pymunk.methods",
        "engines",
    }


# numpy alone takes as long to load as all that help needs; what follows from it, ten times as long.
HEAVY = ("numpy", "scipy", "matplotlib", "pymunk", "mujoco", "numba", "reference.joints", "engines")


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"]])
def test_help_loads_nothing_that_a_run_needs(words):
    code = f"import sys\nfrom reports.__main__ import main\nsys.argv = ['crosscheck', *{words!r}]\ntry:\n    main()\n"
    code += f"except SystemExit:\n    print(*[name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in done.stdout
    assert done.stderr.split() == []
