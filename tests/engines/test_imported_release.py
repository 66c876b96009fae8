"""Tests that compare the release of imported code with its metadata, for overwritten files, builds and modules."""

from __future__ import annotations

import base64
import hashlib
import sys
from dataclasses import dataclass

import mujoco
import pytest

import planar_crosscheck
from engines import imported_release, registry
from engines.imported_release import other_release
from reports.model.ending import REFUSED
from tests.reports.test_command_line import call, here, one_line  # noqa: F401 (here is a fixture)
from tests.toys import Toy

NAME = "crosscheck_toy_release"


@dataclass(frozen=True)
class Released(Toy):
    packages = (NAME,)


def distribution(folder, name, version, says, listed="__init__.py"):
    """Install a distribution with one module like pip, with files, metadata and a digest of each file."""
    package = folder / NAME
    package.mkdir(parents=True, exist_ok=True)
    (package / "__init__.py").write_text(f"__version__ = {says!r}\n")
    digest = base64.urlsafe_b64encode(hashlib.sha256((package / "__init__.py").read_bytes()).digest()).rstrip(b"=")
    info = folder / f"{name}-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    (info / "RECORD").write_text(f"{NAME}/{listed},sha256={digest.decode()},\n{info.name}/METADATA,,\n")


@pytest.fixture
def answer(monkeypatch):
    """A function that imports the module from folders and returns the sentence of `other_release`."""

    def asked(*folders, elsewhere=True):
        for folder in reversed(folders):
            monkeypatch.syspath_prepend(folder)
        __import__(NAME)
        return other_release([Released()], elsewhere)

    imported_release._difference_of.cache_clear()
    imported_release._modules.cache_clear()
    yield asked
    sys.modules.pop(NAME, None)
    imported_release._difference_of.cache_clear()
    imported_release._modules.cache_clear()


@pytest.mark.parametrize("says", ["2.0.1.dev3", "1999", None])
def test_a_module_with_unchanged_files_may_have_any_version(tmp_path, answer, says):
    distribution(tmp_path, NAME, "2.0.1", says)
    assert answer(tmp_path) == ""


def test_builds_and_additions_to_another_package_are_accepted(tmp_path, answer):
    # For example, mujoco-mjx adds the folder mujoco/mjx to the package of mujoco-core.
    distribution(tmp_path, NAME, "1.17.0", "2.0.1", listed="more/__init__.py")
    distribution(tmp_path, "core", "2.0.1+patched", "2.0.1")
    (tmp_path / NAME / "__init__.py").write_text("__version__ = '2.0.1' \n")  # The author has changed the file since.
    assert answer(tmp_path) == ""


def test_files_of_another_distribution_over_its_own_are_reported_with_a_remedy(tmp_path, answer):
    distribution(tmp_path, NAME, "2.0.1", "2.0.1")
    distribution(tmp_path, "bundle", "1.17.0", "1.17.0")
    sentence = answer(tmp_path, elsewhere=False)
    assert "bundle 1.17.0" in sentence
    assert sentence.endswith(f"pip install --force-reinstall --no-deps {NAME}==2.0.1")
    assert "\n" not in sentence


def test_a_folder_on_the_path_that_hides_an_installation_is_reported_unless_it_is_a_build(tmp_path, answer):
    distribution(tmp_path / "installed", NAME, "2.0.1", "2.0.1")
    build = tmp_path / "build" / NAME
    build.mkdir(parents=True)
    (build / "__init__.py").write_text("__version__ = '2.1.0'\n")
    sentence = answer(tmp_path / "build", tmp_path / "installed")
    assert "is 2.1.0" in sentence
    assert str(tmp_path / "build") in sentence
    assert other_release([Released()], elsewhere=False) == ""  # `compare` runs such builds.


@pytest.fixture
def overlaid(monkeypatch):
    """A release with overwritten files. For example, mujoco 3.17.0 overwrites files of mujoco-core."""
    imported_release._difference_of.cache_clear()
    monkeypatch.setattr(mujoco, "__version__", "3.17.0")
    monkeypatch.setattr(imported_release, "_is_changed", lambda file: True)
    yield
    imported_release._difference_of.cache_clear()


@pytest.mark.usefixtures("overlaid")
def test_no_command_runs_another_release_than_it_names(here, capfd):  # noqa: F811
    for text in (
        "run free_four_bar --engine mujoco --every 10",
        "search --engine mujoco --cases 2",
        "conform mujoco --variant default",
        "atlas",
    ):
        assert call(*text.split()) == REFUSED
        sentence = one_line(capfd.readouterr().err)
        assert "3.17.0" in sentence
        assert "pip install --force-reinstall --no-deps mujoco-core==" in sentence
        assert not list(here.glob("**/truths"))


@pytest.mark.usefixtures("overlaid")
def test_no_notebook_or_test_runs_another_release_than_it_names():
    default = next(engine for engine in registry.VARIANTS if engine.name == "mujoco")
    model = mujoco.MjModel.from_xml_string("<mujoco/>")  # pyright: ignore[reportAttributeAccessIssue]
    for function, argument in ((planar_crosscheck.check, model), (planar_crosscheck.conform, default)):
        with pytest.raises(ValueError, match=r"mujoco-core is .* by its metadata, and mujoco that is imported is 3.17"):
            function(argument)
