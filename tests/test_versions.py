"""Versions of an engine beside one another: found, installed apart, run in a process of their own, compared."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engines.lagrange import Lagrange
from engines.mujoco import DEFAULT, EXTENDED, TUNED
from engines.mujoco import model as mujoco_model
from engines.mujoco.written_model import Written
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli import compare
from reports.cli.commands import invoke
from reports.cli.terminal import Terminal
from reports.model.cells import Cell
from reports.model.ending import BadInput, Broken
from reports.model.measure import blank
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.pages.versions import page
from reports.run import installed as installation
from reports.run.installed import built, cache_folder, distributions_in, environment, installed, nearest_versions
from reports.versions.catalogue import RELEASES, changes_between
from reports.versions.column import TreesRow, VersionRequest, column, modules_in
from reports.versions.comparison import compared, steps
from reports.versions.table import Entry, Table, as_csv, as_published, catalogued, entries, merged, read
from reports.versions.trees import miss, trees
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


def test_a_worse_build_is_told_and_what_it_prints_and_leaves_behind_is_contained(here, capfd):
    toy(here, "1.0", "def error(): return 1.0\n")
    loud = (
        "import os\nprint('noise')\nos.write(1, b'noise')\nopen('left.txt', 'w').write('x')\ndef error(): return 50.0\n"
    )
    toy(here, "2.0", loud)
    with pytest.raises(Broken, match=r"2\.0 .*is worse than toyengine 1\.0 .*in 3 numbers"):
        invoke(["compare", "1.0", "2.0", "--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"])
    out = capfd.readouterr().out
    assert "noise" not in out
    assert out.count("WORSE") == 3  # a line a step
    assert not list(here.rglob("left.txt"))
    assert not (here / "crosscheck-results").exists()  # a build may change: nothing is kept of it


def test_a_cost_sets_the_status_where_a_limit_is_given(here):
    toy(here, "1.0", "def error(): return 1.0\n")
    toy(here, "2.0", "def error(): return 1.0\n# another build\n")
    words = ["compare", "1.0", "2.0", "--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"]
    # A toy tells the same cost whatever it takes.
    assert invoke([*words, "--cost", "1.5"]) == 0
    with pytest.raises(Broken, match=r"toyengine default takes 1\.00 times the CPU time, and --cost is 0\.9"):
        invoke([*words, "--cost", "0.9"])
    with pytest.raises(BadInput, match="--cost is 0; give a number above 0"):
        invoke([*words, "--cost", "0"])


def test_two_builds_of_one_name_are_told_apart(here, capfd):
    for folder, error in (("old", 1.0), ("new", 50.0)):
        toy(here / folder, "1.0", f"def error(): return {error}\n")
    with pytest.raises(
        Broken, match=r"^B: toyengine 1\.0 \(1\.0\) is worse than A: toyengine 1\.0 \(1\.0\) in 3 numbers"
    ):
        invoke(["compare", "old/1.0", "new/1.0", "--engine", "adapter.py:ENGINE", "--scenes", "scene.py:DISC"])
    assert "From A: toyengine" in capfd.readouterr().out


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


@pytest.mark.parametrize("version", ["", "--pre", "3 6", "latest", "-r x"])
def test_what_is_no_version_is_refused_before_pip_sees_it(version, monkeypatch):
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: pytest.fail("pip was called"))
    with pytest.raises(BadInput, match="is no version"):
        installed(("pymunk",), version)


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


def test_of_versions_those_used_last_are_kept_and_one_that_can_not_be_had_leaves_no_folder(here, monkeypatch):
    monkeypatch.setattr(subprocess, "run", Pip({"pymunk==9.9": none_of("pymunk==9.9", "none")}))
    monkeypatch.setattr(installation, "MOST", 3)
    folders = []
    for minor in range(5):
        folders.append(installed(("pymunk",), f"7.{minor}").parent)
        os.utime(folders[-1], (minor, minor))
        installed(("pymunk",), "7.0")
    with pytest.raises(BadInput):
        installed(("pymunk",), "9.9")
    wheel = here / "broken.whl"
    wheel.write_bytes(b"no wheel")
    monkeypatch.setattr(subprocess, "run", Pip({str(wheel): "ERROR: no wheel\n"}))
    with pytest.raises(BadInput, match="no wheel"):
        built(wheel)
    assert set(folders[0].parent.iterdir()) == {folders[0], *folders[-2:]}


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
    assert not (here / "crosscheck-results").exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["versions"], "name an engine"),
        (["versions", "pymunk"], "name versions"),
        (["versions", "pymonk", "7.0.0"], "did you mean 'pymunk'"),
        (["versions", "mujoco", "--all"], "leave the engine out"),
        (["versions", "pymunk", "7.0.0", "--publish"], "--all"),
        (["compare", "nothing==1", "pymunk==7.0.0"], "no engine needs 'nothing'"),
        (["compare", "no/such.whl", "pymunk==7.0.0"], "no such folder or wheel"),
    ],
)
def test_words_that_mean_nothing_are_one_line(words, told, here, monkeypatch):
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: pytest.fail("pip was called"))
    with pytest.raises(BadInput, match=told):
        invoke(words)


def test_the_nearest_versions_are_in_their_own_order():
    offered = ["3.9.0", "3.10.0", "3.8.1", "3.11.0", "3.2.0", "4.0.0", "4.0.1", "3.7.0"]
    assert nearest_versions("3.9.5", offered) == ["3.7.0", "3.8.1", "3.9.0", "3.10.0", "3.11.0", "4.0.0"]


def test_the_cache_is_where_the_user_says(monkeypatch, tmp_path):
    monkeypatch.setenv(installation.CACHE, str(tmp_path))
    assert cache_folder() == tmp_path
    assert environment(tmp_path, (Path("x"),))["PYTHONPATH"].split(":" if sys.platform != "win32" else ";") == [
        str(tmp_path),
        "x",
    ]


def entry(version, error, scene="disc", outcome="finished", quantity="angle", engine="mujoco"):
    return Entry(engine, version, scene, "tuned", 1e-3, quantity, error, outcome, 0.01, "")


def test_steps_are_found_in_the_errors_alone():
    nan = float("nan")
    line = [("3.9.0", 1e-3), ("3.10.0", 2.9e-3), ("4.0.0", 2.9e-2), ("4.0.1", 1e-3), ("3.1.0", nan)]
    own = [entry(v, e, outcome="unsupported" if e != e else "finished") for v, e in line]
    own += [entry("3.9.0", 1e-14, "exact"), entry("4.0.0", 9e-12, "exact")]  # both are rounding
    own += [entry("3.9.0", 1e-3, "breaks"), entry("4.0.0", nan, "breaks", "torn")]
    found = [(step.before.version, step.after.version, step.after.scene, step.worse) for step in steps(own)]
    assert found == [
        ("3.10.0", "4.0.0", "disc", True),
        ("3.9.0", "4.0.0", "breaks", True),
        ("4.0.0", "4.0.1", "disc", False),
    ]


def test_a_change_is_looked_up_between_two_versions():
    assert [each.version for each in changes_between("mujoco", "3.6.0", "4.0.1", worse=False)] == ["3.7.0", "4.0.1"]
    assert [each.version for each in changes_between("mujoco", "3.6.0", "4.0.1", worse=True)] == ["4.0.0"]
    assert changes_between("mujoco", "3.7.0", "3.17.0", worse=False) == ()
    assert changes_between("pymunk", "3.6.0", "4.0.0", worse=False) == ()
    assert all(each.source.startswith("https://") == bool(each.changed) for each in RELEASES)


def test_a_table_is_read_as_it_was_written_and_renewed_by_version(tmp_path):
    own = Table(
        (entry("3.6.0", 0.25), entry("4.0.0", float("nan"), outcome="torn")), {("mujoco", "3.6.0"): "it is: old"}
    )
    path = tmp_path / "versions.csv"
    path.write_text(as_csv(own))
    again = read(path)
    assert as_csv(again) == as_csv(own)
    assert again.marks == own.marks
    newer = merged(again, Table((entry("3.6.0", 0.5),), {}))
    assert [(each.version, each.error) for each in newer.entries if each.comparable] == [("3.6.0", 0.5)]
    assert newer.marks == {}
    path.write_text("scene\nx\n")
    with pytest.raises(ValueError, match="it is no table of versions"):
        read(path)


def test_lines_of_releases_that_are_not_compared_any_more_go():
    own = (entry("3.1.0", 1e-3), entry("4.0.1", 1e-3), entry("1.0", 1e-3, engine="toy"))
    left = catalogued(Table(own, {("mujoco", "3.1.0"): "it is old"}))
    assert (left.entries, left.marks) == (own[1:], {})


def row(angle, outcome=Outcome.FINISHED, every=1, cpu=1.0):
    made = blank(Cell(Disc(), Lagrange(), every), outcome)
    return replace(made, angle=angle, cpu=cpu)


def ended(outcome):
    return [row(float("nan"), outcome)]


def test_a_cost_is_the_median_of_the_ratios_of_all_rows_and_of_each_methods():
    before = [row(1e-3, every=every) for every in (1, 3, 10)]
    after = [row(1e-3, every=every, cpu=cpu) for every, cpu in ((1, 1.0), (3, 2.0), (10, 9.0))]
    found = compared(before, after)
    assert found.cost == 2.0
    assert dict(found.costs) == {before[0].method: 2.0}


def test_what_grew_in_the_median_of_all_scenes_is_told_though_no_row_is_three_times_as_wrong():
    def of_scenes(angle):
        return [replace(row(angle), scene=f"scene {number}") for number in range(9)]

    found = compared(of_scenes(1e-3), of_scenes(2.9e-3))
    assert (found.differences, [check.quantity for check in found.grown]) == ((), ["angle"])
    assert compared(of_scenes(1e-3), of_scenes(1.2e-3)).grown == ()


def test_worse_is_more_than_three_times_as_large_and_cost_is_told():
    before = [row(1e-3), row(1e-4, every=10)]
    assert not compared(before, [row(2.9e-3, cpu=2.0), row(1e-4, every=10, cpu=2.0)]).differences
    found = compared(before, [row(3.1e-3, cpu=2.0), row(1e-5, every=10, cpu=2.0)])
    assert [(each.quantity, each.worse) for each in found.differences] == [("angle", True), ("angle", False)]
    assert (found.pairs, found.cost) == (2, 2.0)
    lost = compared(before, [row(1e-3, Outcome.TORN), row(1e-4, every=10)])
    assert [(each.quantity, each.worse) for each in lost.differences] == [("outcome", True)]
    assert [
        (each.quantity, each.worse) for each in compared(ended(Outcome.TORN), ended(Outcome.ABORTED)).differences
    ] == [("outcome", True)]
    assert [
        (each.quantity, each.worse) for each in compared(ended(Outcome.TORN), ended(Outcome.RESET)).differences
    ] == [("outcome", False)]
    orders = compared([row(1e-2), row(1e-4, every=10)], [row(1e-2), row(1e-3, every=10)])
    assert [(round(turn.before), round(turn.after)) for turn in orders.turns] == [(2, 1)]


@pytest.mark.parametrize(
    ("before", "after", "verdict"),
    [
        (ended(Outcome.TORN), [row(1e-3)], "better"),
        (ended(Outcome.TORN), ended(Outcome.RESET), "other"),
        ([row(1e-3)], [row(1e-5)], "better"),
        ([row(1e-3)], ended(Outcome.TORN), "WORSE"),
    ],
)
def test_an_outcome_is_better_where_it_finishes_and_another_kind_of_end_is_none(capsys, before, after, verdict):
    sides = [compare.Side(label, "mujoco", Path(), False) for label in ("old", "new")]
    compare._print(Terminal(compare.WIDTH), compared(before, after), sides)
    (line,) = (line for line in capsys.readouterr().out.splitlines() if before[0].scene in line)
    assert verdict in line.split()[-1]


def test_random_trees_tell_ideal_constraints_from_wrong_ones():
    drawn = trees(6, 2, 3)
    assert drawn == trees(6, 2, 3)
    assert len({each.pose.tobytes() for each in drawn}) == 3
    # Two formulations of the same law, apart by what a step of 1e-5 of the time scale costs.
    assert max(miss(Lagrange("rk4"), each) for each in drawn) < 1e-3
    # As shipped a joint gives way by a tenth of what would hold it.
    assert min(miss(DEFAULT, each) for each in drawn) > 1e-2


def test_trees_that_could_not_be_built_are_told():
    answered = TreesRow("mujoco", "tuned", 12, 4, "finished", "", (1e-5, float("nan"), 0.5))
    failed = TreesRow("mujoco", "extended", 12, 4, "failed", "AttributeError: no MjSpec")
    from reports.versions.column import VersionColumn

    found = entries("mujoco", VersionColumn("1", (), (answered, failed)), {})
    assert [(each.outcome, each.error, each.sentence[:8]) for each in found[:1]] == [("finished", np.inf, "2 of 3 b")]
    assert found[1].outcome == "unsupported"


@pytest.mark.parametrize("method", [DEFAULT, TUNED, EXTENDED], ids=lambda each: each.variant)
def test_a_model_as_text_moves_as_one_that_is_built(method, monkeypatch):
    for scene in SCENES:
        if scene.name not in ("driven_four_bar", "free_slider_crank", "sleigh", "rolling_ellipse", "pinned_body"):
            continue
        motions = []
        for made in (mujoco_model.new_specification, Written):
            monkeypatch.setattr(mujoco_model, "new_specification", made)
            motions.append(method.build(scene.mechanism(), scene.spacing)(5, 1).pose)
        # The same numbers, written with all digits; a quaternion is normalised once more while it is read.
        np.testing.assert_allclose(motions[1], motions[0], rtol=0, atol=1e-12)


def test_the_page_reads_its_rows_and_names_their_steps(monkeypatch):
    own = (entry("3.6.0", 1e-2), entry("3.7.0", 1e-6), entry("4.0.1", 1e-6))
    table = Table((*own, entry("7.0.0", 1e-2, engine="pymunk")), {("mujoco", "3.6.0"): "it is old"})
    monkeypatch.setattr(page, "table", lambda: table)
    told = page.words(Material({}))["engines"]
    assert [each["name"] for each in told] == ["mujoco", "pymunk"]
    assert "3.6.0 to 3.7.0" in told[0]["steps"]
    assert "velocity term" in told[0]["steps"]
    assert "4.0.1" not in told[0]["steps"]
    assert told[1]["steps"] == ""
    assert set(page.figures(Material({}))) == {
        f"{n}_{k}" for n in ("mujoco", "pymunk") for k in ("lines", "heat", "cost")
    }
    monkeypatch.setattr(page, "table", lambda: Table((), {}))
    assert page.words(Material({})) == {"engines": []}


def test_a_published_number_keeps_its_text_within_rounding_and_a_time_within_a_tenth():
    before = read(page.DATA)
    known = [entry for entry in before.entries if entry.comparable and entry.quantity == "angle"][:20]
    before = replace(before, entries=tuple(known))
    moved = tuple(replace(entry, error=entry.error + 1e-12, cpu=1.09 * entry.cpu) for entry in known)
    assert as_csv(as_published(replace(before, entries=moved), before)) == as_csv(before)
    changed = tuple(replace(entry, error=1.01 * entry.error + 1e-10, cpu=1.11 * entry.cpu) for entry in known)
    assert as_published(replace(before, entries=changed), before).entries == changed
    gone = tuple(replace(entry, outcome=Outcome.TORN) for entry in moved)
    assert as_published(replace(before, entries=gone), before).entries == gone


def test_the_published_rows_show_the_velocity_term_and_the_sparse_factor():
    own = page.table()
    found = [step for step in steps(own.entries) if step.after.engine == "mujoco"]
    better = {(s.before.version, s.after.version) for s in found if not s.worse and s.after.scene == "free_four_bar"}
    assert better == {("3.6.0", "3.7.0")}
    sparse = [(s.after.version, s.worse) for s in found if s.after.variant == "extended, sparse"]
    assert sparse == [("3.7.0", False), ("4.0.0", True), ("4.0.1", False)]
    assert all("known to be wrong" in own.marks["mujoco", version] for version in ("3.6.0", "4.0.0"))


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
