"""Tests of the code, claims and links in README, CONTRIBUTING and the lecture, and of the imports of help."""

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

from reports.cli.commands import COMMANDS, command
from reports.model.catalogue import PAGES
from reports.pages.four_bar.page import MOVING_PICTURE
from reports.pages.index import COMPARED_PICTURE
from reports.pages.your_loop.page import LINE_FILES
from tests import ROOT

README_TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_python_example_runs_and_prints_a_small_error(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", README_TEXT, re.DOTALL)
    exec(compile(example, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    # RK4 with a step of 1e-3 s has an error of 1e-6 to 1e-5.
    (angle,) = re.findall(r"^ *angle, rad +(\S+)", printed, re.MULTILINE)
    assert 0 < float(angle) < 1e-4


def test_the_readme_is_short_and_links_to_the_lines_to_paste_the_lecture_and_the_site():
    lines = README_TEXT.splitlines()
    assert len(lines) <= 160
    links = re.findall(r"\]\(([^)]+)\)", README_TEXT)
    assert links[0] == "reports/results/your_loop.md"
    first = "\n".join(lines[: len(lines) // 3])
    assert "](lecture.ipynb)" in first
    assert "`crosscheck site" in first
    written = {"index.md", COMPARED_PICTURE, MOVING_PICTURE, *(f"{page.name}.md" for page in PAGES)}
    local = {link.partition("#")[0] for link in links if "://" not in link}
    assert [
        link for link in local - {f"reports/results/{name}" for name in written} if not (ROOT / link).exists()
    ] == []
    for name in ("options", "close", "choose"):  # another test pastes these lines into a script
        assert (LINE_FILES / f"{name}.txt").read_text(encoding="utf-8").strip() in README_TEXT


@pytest.mark.parametrize("file", ["action.yml", "try.sh"])
def test_the_example_of_an_action_gives_compare_valid_options(file):
    text = (ROOT / "examples" / "compare_build" / file).read_text(encoding="utf-8")
    (line,) = re.findall(r"^ *crosscheck compare (.*) > comparison\.md$", text, re.MULTILINE)
    options = command("compare").make_context("compare", shlex.split(line.replace("$COST", "1.5"))).params
    assert (options["cost"], options["as_markdown"], list(options["scenes"])) == (1.5, True, [])


CONTRIBUTING_TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_contributing_is_short_and_names_files_groups_and_targets_that_exist():
    assert len(CONTRIBUTING_TEXT.splitlines()) < 120
    paths = set(re.findall(r"`((?:reports|reference|engines|tests)/[\w/.]+)", CONTRIBUTING_TEXT))
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(re.findall(r"`(crosscheck\.\w+)`", CONTRIBUTING_TEXT)) <= set(project["entry-points"])
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert all(f"\n{target}:" in makefile for target in re.findall(r"\bmake (\w+)", CONTRIBUTING_TEXT))


def test_commands_in_both_texts_exist():
    pairs = re.findall(r"^crosscheck ([a-z]+)\b|`crosscheck ([a-z]+)\b", README_TEXT + CONTRIBUTING_TEXT, re.MULTILINE)
    commands_named = {command for pair in pairs for command in pair if command}
    assert {"run", "report", "conform", "list", "show"} <= commands_named
    assert commands_named <= COMMANDS.keys()


NOTEBOOK_CELLS = json.loads((ROOT / "lecture.ipynb").read_text(encoding="utf-8"))["cells"]


@pytest.fixture(scope="module")
def lecture() -> Any:
    """The notebook as a module after all cells have run, and the printed text."""
    module, printed = ModuleType("lecture"), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(printed):
        patch.setitem(sys.modules, "lecture", module)
        matplotlib.use("agg")
        import matplotlib.pyplot as plt

        for number, cell in enumerate(NOTEBOOK_CELLS):
            if cell["cell_type"] == "code":
                assert cell["outputs"] == []
                exec(compile("".join(cell["source"]), f"cell {number}", "exec"), vars(module))
        plt.close("all")
    return module, printed.getvalue()


def test_every_cell_runs_and_its_claims_about_engines_are_right(lecture):
    module, printed = lecture
    assert "rows and coordinates: (8, 9)  freedoms of place and of velocity: (1, 1)" in printed
    assert max(module.apart, module.slip, module.gap, module.drift) < 1e-9
    # The shipped pymunk is of first order, the tuned MuJoCo of second order.
    assert module.slopes["pymunk default"] == pytest.approx(1.0, abs=0.35)
    assert module.slopes["mujoco tuned"] == pytest.approx(2.0, abs=0.35)
    # With RK4 the error has a plateau over thirty times as many steps. With the default integrator two errors cancel at
    # one step. Tuned settings reduce the error more than a step that is a tenth as long.
    plateau = module.swept["mujoco RK4"]
    assert plateau.min() > plateau.max() / 2
    assert module.swept["mujoco default"][-1] < plateau[-1]
    assert module.swept["mujoco tuned"][0] < plateau[2]
    # Two errors cancel at a step of 1 ms. At smaller steps the soft joint's error is ten times larger.
    errors = dict(zip(module.fine, module.lucky["default"], strict=True))
    assert errors[100] * 10 < errors[1000] < module.lucky["RK4"][-1] < 1.2 * errors[1000]
    assert module.astray > 1
    assert module.wrong > 0.01
    (some, rough), (many, good) = module.told[20], module.told[100]
    assert some == pytest.approx(many, rel=0.02)
    assert rough > 10 * good


def test_the_exercises_on_rolling_and_skates_have_the_known_answers(lecture):
    module, printed = lecture
    # The disc makes a / b + 1 turns outside, and a / b - 1 turns backwards inside; 2,000 points are sampled.
    assert module.turns == pytest.approx({"disc": 3.0, "hole": -1.0}, abs=1e-3)
    # The value is omega^2 / (1/b + kA) with kA = 1/a on the disc, 0 on flat ground and -1/a in the hole.
    assert module.starts == pytest.approx({"disc": 1 / 6, "flat": 1 / 4, "hole": 1 / 2}, rel=1e-12)
    assert "8: (Move(turn=1.57" in printed
    # Differences of second order over a millisecond have an error of about 1e-6.
    assert module.factor == pytest.approx(1.0, abs=1e-4)
    # The turning rate, a sech, begins at 1e-3 rad/s and has decayed at the end.
    assert module.turned == pytest.approx(math.pi * module.gyration / 0.5, rel=1e-3)


# Importing numpy takes as long as all imports of the help, and the remaining modules take ten times as long.
SLOW_TO_IMPORT = ("numpy", "scipy", "matplotlib", "pymunk", "mujoco", "numba", "reference.joints", "engines")


def test_the_list_of_commands_imports_nothing_that_only_a_run_needs():
    code = "import sys\nfrom reports.__main__ import main\nsys.argv[1:] = ['--help']\ntry:\n    main()\n"
    code += (
        f"except SystemExit:\n    print(*[name for name in {SLOW_TO_IMPORT!r} if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in done.stdout
    assert done.stderr.split() == []


def test_the_modules_of_scenes_and_pages_import_slow_packages_when_they_need_them():
    """`run` and `check` import all scenes and pages, and use few of them."""
    code = "import sys, reports.cli.run, reports.check.document, reports.check.telling\n"
    code += "print(*{'matplotlib', 'jinja2', 'scipy.linalg', 'scipy.special'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
