"""Tests of versions and builds of an engine: installation, runs in separate processes, and comparison."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from engines.mujoco import DEFAULT
from reports.cli.commands import invoke
from reports.model.ending import BadInput, Broken
from reports.model.outcomes import Outcome
from reports.run import installed as installation
from reports.run.installed import installed
from reports.versions import builds
from reports.versions.builds import compare_builds
from reports.versions.column import VersionRequest, column, modules_in
from tests.toys import Disc

ADAPTER = """
from dataclasses import dataclass
from tests.toys import Toy
try:
    import toyengine
except ImportError:
    toyengine = None

@dataclass(frozen=True)
class ToyAdapter(Toy):
    name: str = "toyengine"

    def build(self, mechanism, dt):
        return Toy(factor=toyengine.error()).build(mechanism, dt)

ENGINE = ToyAdapter("default")
"""
LOUD = "import os\nprint('noise')\nos.write(1, b'noise')\nopen('left.txt', 'w').write('x')\ndef error(): return 50.0\n"
WITH_ADAPTER = ["--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"]


def toy(folder: Path, version: str, source: str) -> Path:
    """Write an installed package of a toy engine. The toy's error is `error()` of `source` times the step squared."""
    index = folder / version
    (index / "toyengine").mkdir(parents=True)
    (index / "toyengine" / "__init__.py").write_text(source)
    (index / f"toyengine-{version}.dist-info").mkdir()
    metadata = f"Metadata-Version: 2.1\nName: toyengine\nVersion: {version}\n"
    (index / f"toyengine-{version}.dist-info" / "METADATA").write_text(metadata)
    return index


@pytest.fixture
def here(tmp_path, monkeypatch):
    (tmp_path / "adapter.py").write_text(ADAPTER)
    (tmp_path / "scene.py").write_text("from tests.toys import Disc\nDISC = Disc()\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(installation.CACHE, str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "path", list(sys.path))
    for name in ("adapter", "scene"):  # another test may have imported modules with these names
        monkeypatch.delitem(sys.modules, name, raising=False)
    yield tmp_path
    for name in ("adapter", "scene"):
        sys.modules.pop(name, None)


@pytest.fixture
def once(monkeypatch):
    """Cache the rows of each build, since a test compares it several times."""
    run, expected = builds.column, {}

    def column(label, request, *others):
        if request.location not in expected:
            expected[request.location] = run(label, request, *others)
        return expected[request.location]

    monkeypatch.setattr(builds, "column", column)


@pytest.mark.usefixtures("once")
def test_a_worse_or_slower_build_is_reported_and_its_output_is_contained(here, capfd):
    toy(here, "1.0", "def error(): return 1.0\n")
    toy(here, "2.0", LOUD)
    with pytest.raises(Broken, match=r"2\.0 .*is worse than toyengine 1\.0 .*in 3 numbers"):
        invoke(["compare", "1.0", "2.0", *WITH_ADAPTER])
    out = capfd.readouterr().out
    assert "noise" not in out
    assert out.count("WORSE") == 1  # each method has one line
    assert len(re.findall(r"^disc .* angle \[rad\]", out.partition("outcomes that are worse")[2], re.MULTILINE)) == 3
    with pytest.raises(Broken):
        invoke(["compare", "1.0", "2.0", *WITH_ADAPTER, "--json"])
    document = json.loads(capfd.readouterr().out)
    (line,) = document["tables"][0]["rows"]
    earlier, later = (next(line[key] for key in line if key.startswith(f"toyengine {version}")) for version in "12")
    assert later == pytest.approx(50 * earlier)
    assert (line["verdict"], document["status"]) == ("WORSE", 1)
    assert "is worse than" in document["message"]
    assert not list(here.rglob("left.txt"))
    assert not (here / "crosscheck-results").exists()  # The build may change, so its rows are not stored.
    comparison = compare_builds("2.0", "1.0", "adapter.py:ENGINE", scenes=[Disc()])  # A notebook calls this function.
    assert [column.trouble for column in comparison.columns] == ["", ""]
    assert comparison.complaint == ""
    # The ratio of CPU times is 1, since the toy returns a constant cost.
    assert invoke(["compare", "2.0", "1.0", *WITH_ADAPTER, "--cost", "1.5"]) == 0
    with pytest.raises(Broken, match=r"toyengine default takes 1\.00 times the CPU time, and --cost is 0\.9"):
        invoke(["compare", "2.0", "1.0", *WITH_ADAPTER, "--cost", "0.9"])


def test_a_version_that_crashes_while_it_is_imported_gives_rows(here):
    index = toy(here, "3.0", "import os\nos.abort()\n")
    request = VersionRequest((Disc(),), "adapter.py:ENGINE", modules_in(index), index, here / "s.sqlite", folder=here)
    result = column("3.0", request, [DEFAULT])
    assert [row.outcome for row in result.rows] == [Outcome.ABORTED]
    assert "aborted with signal" in result.trouble


class Pip:
    """A substitute for pip, which prints the text for a requirement or writes the folder."""

    def __init__(self, answers):
        self.answers, self.calls = answers, []

    def __call__(self, command, **_):
        requirement = command[-1]
        self.calls.append(requirement)
        if requirement in self.answers:
            return subprocess.CompletedProcess(command, 1, "", self.answers[requirement])
        Path(command[command.index("--target") + 1]).mkdir()
        return subprocess.CompletedProcess(command, 0, "", "")


def none_of(name, offered):
    return (
        f"ERROR: Could not find a version that satisfies the requirement {name} (from versions: {offered})\n"
        f"ERROR: No matching distribution found for {name}\n"
    )


def test_a_version_is_installed_once_under_the_first_name_that_has_it(here, monkeypatch):
    pip = Pip({"mujoco-core==3.6.0": none_of("mujoco-core==3.6.0", "4.0.0, 4.0.1")})
    monkeypatch.setattr(subprocess, "run", pip)
    first = installed(("mujoco-core", "mujoco"), "3.6.0")
    assert installed(("mujoco-core", "mujoco"), "3.6.0") == first
    assert pip.calls == ["mujoco-core==3.6.0", "mujoco==3.6.0"]
    assert first.is_relative_to(here / "cache")
    # in a folder of this name, the key of a row has the version instead of the files
    assert first.name == "site-packages"
    assert [path.name for path in first.parents[1].iterdir()] == ["mujoco-3.6.0"]


@pytest.mark.parametrize(
    ("printed", "reason"),
    [
        (none_of("pymunk==7.2.5", "7.0.0, 7.1.0, 7.2.0, 7.3.0"), "there are 7.0.0, 7.1.0, 7.2.0, 7.3.0"),
        (none_of("pymunk==7.2.5", "none"), "the package index knows none"),
        ("WARNING: Retrying: NewConnectionError\n" + none_of("pymunk==7.2.5", "none"), "no connection"),
        ("ERROR: No space left on device\n", "No space left"),
    ],
)
def test_a_version_that_can_not_be_installed_is_refused_in_one_line(printed, reason, here, monkeypatch, capfd):
    monkeypatch.setattr(subprocess, "run", Pip({"pymunk==7.2.5": printed}))
    with pytest.raises(BadInput, match=reason) as refused:
        invoke(["versions", "pymunk", "7.2.5", "--scenes", "free_four_bar"])
    assert "\n" not in str(refused.value)
    assert refused.value.status == 2
    assert "pymunk 7.2.5: installed by pip" in capfd.readouterr().err  # the line is printed before pip runs
    assert not (here / "crosscheck-results").exists()


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["versions"], "name an engine"),
        (["versions", "pymunk", "--", "--pre"], "is no version"),
        (["versions", "pymonk", "7.0.0"], "did you mean 'pymunk'"),
        (["versions", "pymunk", "7.0.0", "--publish"], "--all"),
        (["compare", "nothing==1", "pymunk==7.0.0"], "no engine needs 'nothing'"),
        (["compare", "pymunk==7.0.0", "pymunk==7.1.0", "--cost", "0"], "--cost is 0; give a number above 0"),
        (["compare", "broken.whl", "broken.whl", *WITH_ADAPTER], r"broken\.whl can't be installed: .*broken\.whl"),
    ],
)
def test_invalid_arguments_are_refused_in_one_line(words, reason, here, monkeypatch):
    (here / "broken.whl").write_text("no archive")
    monkeypatch.setattr(subprocess, "run", Pip({str(here / "broken.whl"): "ERROR: broken.whl is no wheel"}))
    with pytest.raises(BadInput, match=reason) as refused:
        invoke(words)
    assert "\n" not in str(refused.value)


def wheel(folder: Path, version: str, error: float) -> Path:
    built = toy(folder / "built", version, f"def error(): return {error}\n")
    info = built / f"toyengine-{version}.dist-info"
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: by hand\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
    files = [path for path in sorted(built.rglob("*")) if path.is_file()]
    (info / "RECORD").write_text("".join(f"{path.relative_to(built).as_posix()},,\n" for path in files))
    index = folder / f"toyengine-{version}-py3-none-any.whl"
    with zipfile.ZipFile(index, "w") as archive:
        for path in [*files, info / "RECORD"]:
            archive.write(path, path.relative_to(built).as_posix())
    return index


@pytest.mark.slow
def test_wheels_are_compared_and_a_worse_one_ends_with_status_1(here, capfd):
    first, second = str(wheel(here, "1.0", 1.0)), str(wheel(here, "2.0", 50.0))
    with pytest.raises(Broken, match=r"toyengine 2\.0 \(wheel\) is worse than toyengine 1\.0 \(wheel\)") as refused:
        invoke(["compare", first, second, *WITH_ADAPTER])
    assert refused.value.status == 1
    assert invoke(["compare", first, str(here / "built" / "1.0"), *WITH_ADAPTER]) == 0  # a wheel and a folder
    assert "WORSE" in capfd.readouterr().out


@pytest.mark.slow
def test_real_versions_are_installed_and_differ_as_their_changelogs_say(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(installation.CACHE, str(tmp_path / "cache"))
    with pytest.raises(Broken, match="is worse than"):
        invoke(["compare", "mujoco==4.0.1", "mujoco==3.6.0", "--scenes", "free_four_bar"])
    assert invoke(["compare", "pymunk==7.0.0", "pymunk==7.3.1", "--scenes", "free_four_bar"]) == 0
    out = capfd.readouterr().out
    assert "0 numbers are worse" in out
    assert "mujoco==3.6.0: MuJoCo 3.6.0 is known to be wrong" in out
    assert "free_four_bar" in out
