"""Exact motions that are kept beside a store: the same to the last bit, found by other processes, never stale."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from engines.lagrange import Lagrange
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.model import truths
from reports.model.cells import Cell
from reports.model.measure import measure
from reports.model.truths import PARTS, kept_motion
from reports.run.running import run_into
from reports.run.store import Store
from tests.toys import Disc, ImpossibleDisc, Toy

T = np.linspace(0.0, 0.5, 6)
SCENE = LinkPendulum(links=2)


@pytest.fixture(autouse=True)
def all_are_kept(monkeypatch):
    monkeypatch.setattr(truths, "SHORT", -1.0)


def test_what_is_kept_is_the_motion_to_the_last_bit_and_is_not_worked_out_again(tmp_path, monkeypatch):
    first = kept_motion(SCENE, T, "name", tmp_path)
    monkeypatch.setattr(LinkPendulum, "_motion", None)
    second = kept_motion(SCENE, T, "name", tmp_path)
    for part in PARTS:
        np.testing.assert_array_equal(getattr(first, part), getattr(second, part))
    with pytest.raises(TypeError):  # other instants, another name: it is asked
        kept_motion(SCENE, T[:-1], "name", tmp_path)
    with pytest.raises(TypeError):
        kept_motion(SCENE, T, "other", tmp_path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"no archive at all", None, "packed otherwise"])
def test_a_damaged_file_is_made_anew(tmp_path, content):
    right = kept_motion(SCENE, T, "name", tmp_path)
    (file,) = tmp_path.iterdir()
    whole = file.read_bytes()
    if content == "packed otherwise":  # the compression's number of the first part, in the list of all parts at the end
        place = whole.index(b"PK\x01\x02") + 10
        content = whole[:place] + b"\x63" + whole[place + 1 :]
    file.write_bytes(whole[: len(whole) // 2] if content is None else content)
    np.testing.assert_array_equal(kept_motion(SCENE, T, "name", tmp_path).pose, right.pose)
    assert file.read_bytes() == whole


def test_a_folder_that_is_not_there_or_can_not_be_written_costs_nothing_but_time(tmp_path):
    file = tmp_path / "file"
    file.write_text("", encoding="utf-8")
    for folder in (None, tmp_path / "none", file):
        assert kept_motion(SCENE, T, "name", folder).pose.shape == (6, 2, 3)
    assert list(tmp_path.iterdir()) == [file]


def test_a_refusal_is_not_kept(tmp_path):
    for _ in range(2):
        with pytest.raises(ValueError, match="no such motion"):
            kept_motion(ImpossibleDisc(), T, "name", tmp_path)
    assert not list(tmp_path.iterdir())


@dataclass(frozen=True)
class OtherDisc(Disc):
    """The same numbers in another class."""


def test_the_name_of_a_truth_is_of_its_scene_and_its_sources_and_of_no_engine(monkeypatch):
    cell = Cell(Disc(), Toy(), 1)
    assert cell.truth == Cell(Disc(), Toy(factor=3.0), 7, "map", 5).truth
    names = {cell.truth, Cell(Disc(rate=3.0), Toy(), 1).truth, Cell(OtherDisc(), Toy(), 1).truth}
    monkeypatch.setattr("reports.model.cells.digest_of", lambda modules: "other files")
    assert len({*names, Cell(Disc(), Toy(), 1).truth}) == 4


def test_a_cell_is_measured_alike_with_and_without_them(tmp_path):
    cell = Cell(Disc(), Toy(), 1)
    plain = measure(cell, repeat=False)
    for _ in range(2):
        kept = measure(cell, repeat=False, truths=tmp_path)
        assert repr(replace(kept, cpu=0.0, build=0.0)) == repr(replace(plain, cpu=0.0, build=0.0))
    assert len(list(tmp_path.iterdir())) == 1


def test_a_run_keeps_them_beside_its_store_wherever_it_is_started(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cell = Cell(LinkPendulum(links=30, duration=0.3, horizon=0.3), Lagrange("rk4", "projection"), 1)
    with Store(Path("here/cells.sqlite")) as store:
        assert run_into(store, [cell]) == 1
    assert (tmp_path / "here" / truths.FOLDER).is_dir()
    kept = {file.suffix for file in (tmp_path / "here" / truths.FOLDER).iterdir()}
    assert kept == {".npz"}
