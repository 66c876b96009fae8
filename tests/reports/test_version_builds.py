"""Builds and released versions of an engine: found, installed apart, run in a process of their own, or refused."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from engines.mujoco import DEFAULT
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli.commands import invoke
from reports.model.ending import BadInput, Broken
from reports.model.outcomes import Outcome
from reports.run import installed as installation
from reports.run.installed import built, distributions_in, installed
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
class Mine(Toy):
    name: str = "toyengine"

    def build(self, mechanism, dt):
        return Toy(factor=toyengine.error()).build(mechanism, dt)

ENGINE = Mine("default")
"""


def toy(folder: Path, version: str, source: str) -> Path:
    """A folder as pip makes it, with a version of an engine whose error is `error()` times the step squared."""
    place = folder / version
    (place / "toyengine").mkdir(parents=True)
    (place / "toyengine" / "__init__.py").write_text(source)
    (place / f"toyengine-{version}.dist-info").mkdir()
    metadata = f"Metadata-Version: 2.1\nName: toyengine\nVersion: {version}\n"
    (place / f"toyengine-{version}.dist-info" / "METADATA").write_text(metadata)
    return place


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with an adapter and a scene, from which commands are given."""
    (tmp_path / "adapter.py").write_text(ADAPTER)
    (tmp_path / "scene.py").write_text("from tests.toys import Disc\nDISC = Disc()\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(installation.CACHE, str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "path", list(sys.path))
    for name in ("adapter", "scene"):  # of another test's folder
        monkeypatch.delitem(sys.modules, name, raising=False)
    yield tmp_path
    for name in ("adapter", "scene"):
        sys.modules.pop(name, None)


@pytest.fixture
def once(monkeypatch):
    """Each build is run once a test, however often it is compared."""
    asked, known = builds.column, {}

    def column(label, request, *others):
        if request.place not in known:
            known[request.place] = asked(label, request, *others)
        return known[request.place]

    monkeypatch.setattr(builds, "column", column)


@pytest.mark.usefixtures("once")
def test_a_worse_build_is_told_and_a_dearer_one_where_a_limit_is_given_and_what_it_does_is_contained(here, capfd):
    toy(here, "1.0", "def error(): return 1.0\n")
    toy(here, "1.1", "def error(): return 1.0\n# another build\n")
    loud = (
        "import os\nprint('noise')\nos.write(1, b'noise')\nopen('left.txt', 'w').write('x')\ndef error(): return 50.0\n"
    )
    toy(here, "2.0", loud)
    words = ["--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"]
    with pytest.raises(Broken, match=r"2\.0 .*is worse than toyengine 1\.0 .*in 3 numbers"):
        invoke(["compare", "1.0", "2.0", *words])
    out = capfd.readouterr().out
    assert "noise" not in out
    assert out.count("WORSE") == 1  # a line a method
    assert len(re.findall(r"^disc .* angle \[rad\]", out.partition("outcomes that are worse")[2], re.MULTILINE)) == 3
    with pytest.raises(Broken):
        invoke(["compare", "1.0", "2.0", *words, "--json"])
    document = json.loads(capfd.readouterr().out)
    (line,) = document["tables"][0]["rows"]
    before, after = (next(line[key] for key in line if key.startswith(f"toyengine {version}")) for version in "12")
    assert after == pytest.approx(50 * before)
    assert (line["verdict"], document["status"]) == ("WORSE", 1)
    assert "is worse than" in document["message"]
    assert not list(here.rglob("left.txt"))
    assert not (here / "crosscheck-results").exists()  # a build may change: nothing is kept of it
    found = compare_builds("1.0", "2.0", "adapter.py:ENGINE", scenes=[Disc()])  # as from a notebook
    assert [column.trouble for column in found.columns] == ["", ""]
    assert "is worse than toyengine 1.0" in found.complaint
    assert compare_builds("1.0", "1.1", "adapter.py:ENGINE", scenes=[Disc()]).complaint == ""
    # A toy has the same cost whatever it takes.
    assert invoke(["compare", "1.0", "1.1", *words, "--cost", "1.5"]) == 0
    with pytest.raises(Broken, match=r"toyengine default takes 1\.00 times the CPU time, and --cost is 0\.9"):
        invoke(["compare", "1.0", "1.1", *words, "--cost", "0.9"])


def test_a_version_that_crashes_while_it_is_imported_gives_rows(here):
    place = toy(here, "3.0", "import os\nos.abort()\n")
    given = VersionRequest((Disc(),), "adapter.py:ENGINE", modules_in(place), place, here / "s.sqlite", folder=here)
    engine = replace(DEFAULT)
    found = column("3.0", given, [engine])
    assert [row.outcome for row in found.rows] == [Outcome.ABORTED]
    assert "aborted with signal" in found.trouble


def test_a_folder_is_known_by_its_metadata_and_not_by_its_own_word(tmp_path):
    place = toy(tmp_path, "7.0.0", "version = '2.0.0'\n")
    assert distributions_in(place) == {"toyengine": "7.0.0"}
    assert modules_in(place) == ("toyengine",)
    assert built(place) == place


class Pip:
    """What pip would do, without network: it says `text`, or makes the folder."""

    def __init__(self, answers):
        self.answers, self.calls = answers, []

    def __call__(self, command, **_):
        what = command[-1]
        self.calls.append(what)
        if what in self.answers:
            return subprocess.CompletedProcess(command, 1, "", self.answers[what])
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
    assert first.name == "site-packages"  # so that rows depend on its version, and not on its files
    assert [path.name for path in first.parents[1].iterdir()] == ["mujoco-3.6.0"]


@pytest.mark.parametrize(
    ("said", "told"),
    [
        (none_of("pymunk==7.2.5", "7.0.0, 7.1.0, 7.2.0, 7.3.0"), "there are 7.0.0, 7.1.0, 7.2.0, 7.3.0"),
        (none_of("pymunk==7.2.5", "none"), "the package index knows none"),
        ("WARNING: Retrying: NewConnectionError\n" + none_of("pymunk==7.2.5", "none"), "no connection"),
        ("ERROR: No space left on device\n", "No space left"),
    ],
)
def test_a_version_that_can_not_be_had_is_one_line(said, told, here, monkeypatch, capfd):
    monkeypatch.setattr(subprocess, "run", Pip({"pymunk==7.2.5": said}))
    with pytest.raises(BadInput, match=told) as refused:
        invoke(["versions", "pymunk", "7.2.5", "--scenes", "free_four_bar"])
    assert "\n" not in str(refused.value)
    assert refused.value.status == 2
    assert "pymunk 7.2.5: installed by pip" in capfd.readouterr().err  # before the wait
    assert not (here / "crosscheck-results").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["versions"], "name an engine"),
        (["versions", "pymunk", "--", "--pre"], "is no version"),
        (["versions", "pymonk", "7.0.0"], "did you mean 'pymunk'"),
        (["versions", "pymunk", "7.0.0", "--publish"], "--all"),
        (["compare", "nothing==1", "pymunk==7.0.0"], "no engine needs 'nothing'"),
        (["compare", "pymunk==7.0.0", "pymunk==7.1.0", "--cost", "0"], "--cost is 0; give a number above 0"),
    ],
)
def test_words_that_mean_nothing_are_one_line(words, told, here, monkeypatch):
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: pytest.fail("pip was called"))
    with pytest.raises(BadInput, match=told):
        invoke(words)


def wheel(folder: Path, version: str, error: float) -> Path:
    """A wheel of the toy engine, as a build of it makes one."""
    built = toy(folder / "built", version, f"def error(): return {error}\n")
    info = built / f"toyengine-{version}.dist-info"
    (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: by hand\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
    files = [path for path in sorted(built.rglob("*")) if path.is_file()]
    (info / "RECORD").write_text("".join(f"{path.relative_to(built).as_posix()},,\n" for path in files))
    place = folder / f"toyengine-{version}-py3-none-any.whl"
    with zipfile.ZipFile(place, "w") as archive:
        for path in [*files, info / "RECORD"]:
            archive.write(path, path.relative_to(built).as_posix())
    return place


def status_of(first: Path, second: Path) -> int:
    return invoke(["compare", str(first), str(second), "--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"])


@pytest.mark.slow
def test_wheels_are_compared_and_a_worse_one_ends_with_status_1(here, capfd):
    first, second = wheel(here, "1.0", 1.0), wheel(here, "2.0", 50.0)
    with pytest.raises(Broken, match=r"toyengine 2\.0 \(wheel\) is worse than toyengine 1\.0 \(wheel\)") as refused:
        status_of(first, second)
    assert refused.value.status == 1
    assert status_of(first, here / "built" / "1.0") == 0  # a wheel and a folder
    assert "WORSE" in capfd.readouterr().out


def test_a_file_that_is_no_wheel_is_one_line_and_status_2(here):
    broken = here / "toyengine-3.0-py3-none-any.whl"
    broken.write_text("no archive")
    with pytest.raises(BadInput, match=r"toyengine-3\.0-py3-none-any\.whl can't be installed") as refused:
        status_of(broken, broken)
    assert refused.value.status == 2
    assert "\n" not in str(refused.value)


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
    assert FreeFourBar().name in out
