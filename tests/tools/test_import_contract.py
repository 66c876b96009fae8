"""The layers hold, and an adapter that reaches for a closed form, directly or through another module, is found."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import ROOT

pytest.importorskip("importlinter", reason="import-linter comes with the extra `develop`")


def checked(folder: Path) -> subprocess.CompletedProcess[str]:
    """What the import linter says of the packages in a folder."""
    command = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
    return subprocess.run(
        [sys.executable, "-c", command, "--no-cache"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        env={"PYTHONPATH": str(folder), "PATH": ""},
    )


@pytest.fixture
def copy(tmp_path):
    """The packages and the contract, to be spoiled."""
    for package in ("reference", "engines", "reports"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("results", "__pycache__"))
    (tmp_path / "tests" / "tools").mkdir(parents=True)
    for name in ("__init__.py", "tools/__init__.py", "tools/import_contract.py"):
        shutil.copy(ROOT / "tests" / name, tmp_path / "tests" / name)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_packages_keep_their_contracts(copy):
    told = checked(copy)
    assert told.returncode == 0, told.stdout


@pytest.mark.parametrize(
    "line",
    [
        "from reference.scenes.four_bar.linkage import FourBar",
        "from reference.scenes.pendulum.link import Pendulum",
        "from reference.scenes.catalogue import SCENES",
        "from engines.conformance.worlds import WORLDS",
    ],
)
def test_a_closed_form_in_an_adapter_is_refused(copy, line):
    (copy / "engines/extrapolated.py").write_text(f"{line}\n", encoding="utf-8")
    told = checked(copy)
    assert told.returncode == 1
    assert line.split()[1] in told.stdout


def test_a_closed_form_behind_another_module_is_refused(copy):
    roll = copy / "reference/rolling/roll.py"
    roll.write_text(f"import reference.scenes.rolling.body\n{roll.read_text(encoding='utf-8')}", encoding="utf-8")
    told = checked(copy)
    assert told.returncode == 1
    assert "reference.scenes.rolling.body" in told.stdout


def test_a_report_in_the_reference_breaks_the_layers(copy):
    (copy / "reference/mechanism.py").write_text("import reports.model.page\n", encoding="utf-8")
    assert checked(copy).returncode == 1
