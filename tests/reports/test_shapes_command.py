"""Tests of `crosscheck shapes`: the files for a known motion, the example on the page, and refusals of bad input."""

from __future__ import annotations

import csv
import io
import re
import runpy
import shlex
import sys
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.filemanagement import readfile

from reports.write.templates import TEMPLATES
from tests.reports.test_command_line import call

HEADER = "t,x,y,angle"
EVERY_KIND = ("--kind", "csv", "--kind", "svg", "--kind", "dxf")


def ladder(count=101, low=0.2, high=1.3):
    """The motion of a ladder of 1 m that slides down a wall. The shapes of this motion are Cardan's circles with the
    radii 1 m and 0.5 m."""
    t = np.linspace(low, high, count)
    return np.column_stack([t, 0.5 * np.cos(t), 0.5 * np.sin(t), -t])


def as_text(table, header=HEADER):
    return "\n".join([header, *(",".join(repr(float(v)) for v in row) for row in table)]) + "\n"


def test_a_ladders_shapes_are_cardans_circles_in_every_kind_of_file(tmp_path, capfd):
    motion = tmp_path / "ladder.csv"
    motion.write_text(as_text(ladder()))
    assert call("shapes", motion, "--folder", tmp_path / "new" / "folder", "--points", 50, *EVERY_KIND) == 0
    folder = tmp_path / "new" / "folder"
    assert {path.name for path in folder.iterdir()} == {f"ladder_shapes.{kind}" for kind in ("csv", "svg", "dxf")}
    rows = list(csv.DictReader(io.StringIO((folder / "ladder_shapes.csv").read_text())))
    space = np.array([[float(row["space_x"]), float(row["space_y"])] for row in rows])
    body = np.array([[float(row["body_x"]), float(row["body_y"])] for row in rows])
    assert len(rows) == 50
    # The error of splines of degree 7 is 0.01**8 if poses are 0.01 rad apart. The error by rounding is larger; it is
    # 1e-11 in a first derivative.
    np.testing.assert_allclose(np.linalg.norm(space, axis=-1), 1.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(body, axis=-1), 0.5, rtol=0, atol=1e-9)
    layers = {line.dxf.layer: line for line in readfile(folder / "ladder_shapes.dxf").modelspace()}
    np.testing.assert_allclose(np.array(cast(LWPolyline, layers["SPACE"]).get_points("xy")), space, atol=1e-12)
    assert (folder / "ladder_shapes.svg").read_text().count("<path") == 2
    assert "gives the motion back" in capfd.readouterr().out


def test_existing_files_are_replaced_only_with_force_and_links_are_not_followed(tmp_path, capfd):
    motion, mine = tmp_path / "ladder.csv", tmp_path / "mine"
    motion.write_text(as_text(ladder()))
    mine.write_text("mine")
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "ladder_shapes.svg").write_text("old")
    (tmp_path / "linked").mkdir()
    (tmp_path / "linked" / "ladder_shapes.svg").symlink_to(mine)
    for name in ("there", "linked"):
        assert call("shapes", motion, "--folder", tmp_path / name, *EVERY_KIND) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert "--force" in err
        assert len(list((tmp_path / name).iterdir())) == 1
        assert call("shapes", motion, "--folder", tmp_path / name, "--force", *EVERY_KIND) == 0
        paths = list((tmp_path / name).iterdir())
        assert len(paths) == 3
        assert not any(path.is_symlink() for path in paths)
        capfd.readouterr()
    assert "<path" in (tmp_path / "there" / "ladder_shapes.svg").read_text()
    assert mine.read_text() == "mine"


def test_a_coarse_table_gives_a_warning_and_a_fine_one_does_not(tmp_path, capfd):
    for count, coarse in ((101, False), (17, True)):
        t = np.linspace(0, 1.2, count)
        # A wobble of 8 rad/s needs more than 17 poses.
        table = np.column_stack([t, 0.3 * np.cos(8 * t), 0.1 * np.sin(8 * t), -3 * t])
        (tmp_path / "motion.csv").write_text(as_text(table))
        assert call("shapes", tmp_path / "motion.csv", "--folder", tmp_path, "--force") == 0
        assert ("too far apart" in capfd.readouterr().out) is coarse


def test_dxf_is_not_a_default_and_is_refused_without_its_package(tmp_path, monkeypatch, capfd):
    motion = tmp_path / "ladder.csv"
    motion.write_text(as_text(ladder()))
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    assert call("shapes", motion, "--folder", tmp_path / "out", *EVERY_KIND) == 2
    assert "planar-crosscheck[dxf]" in capfd.readouterr().err
    assert not (tmp_path / "out").exists()
    assert call("shapes", motion, "--folder", tmp_path / "out") == 0
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".csv", ".svg"}


def altered(row, column, value):
    lines = as_text(ladder()).splitlines()
    cells = lines[row].split(",")
    cells[column] = value
    lines[row] = ",".join(cells)
    return "\n".join(lines)


def reversing():
    """A motion that reverses at t = 0.7531 s, between two samples."""
    t = np.linspace(0, 1.5, 151)
    return as_text(np.column_stack([t, np.cos(t), np.sin(t), (t - 0.7531) ** 2]))


TABLES = {
    "empty": ("", "no column 't'"),
    "wrong columns": (as_text(ladder(), "t,x,y,theta"), "no column 'angle'"),
    "not a number": (altered(5, 1, "nan"), "line 6"),
    "too few": (as_text(ladder(9)), "9 poses are too few"),
    "times go back": (altered(20, 0, "0"), "is not after the one before"),
    "no rotation": (as_text(ladder() * [1, 1, 1, 0]), "doesn't rotate"),
    "a fixed centre": (as_text(ladder() * [1, 0, 0, 1]), "the instant centre stays at"),
    "turns back": (reversing(), "between t = 0.75 and 0.76 s"),
}


@pytest.mark.parametrize("case", TABLES)
def test_a_table_without_shapes_is_refused_in_one_line(case, tmp_path, capfd):
    text, telling = TABLES[case]
    (tmp_path / "motion.csv").write_text(text)
    assert call("shapes", tmp_path / "motion.csv", "--folder", tmp_path / "out") == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert telling in err
    assert not (tmp_path / "out").exists()


def test_unreadable_files_and_wrong_options_are_refused_in_one_line(tmp_path, capfd):
    (tmp_path / "picture.csv").write_bytes(b"\x89PNG\r\n\xff\xfe\x00")
    good = tmp_path / "ladder.csv"
    good.write_text(as_text(ladder()))
    for text, telling in (
        ([tmp_path / "nowhere.csv"], "can't be read"),
        ([tmp_path / "picture.csv"], "no text"),
        ([good, "--folder", good], "can't be a folder"),
        ([good, "--points", "1"], "--points is 1"),
        ([good, "--kind", "png"], "csv, svg, dxf"),
    ):
        assert call("shapes", *text) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert len(err.strip().splitlines()) == 1
        assert telling in err.lower() or telling in err


def test_the_example_on_the_page_runs(tmp_path, monkeypatch, capfd):
    page = (TEMPLATES / "centrodes" / "page.md").read_text()
    [script] = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    [shell] = re.findall(r"```sh\n(.*?)```", page, re.DOTALL)
    (tmp_path / "coupler.py").write_text(script)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["coupler.py"])
    runpy.run_path("coupler.py")
    text = shlex.split(next(line for line in shell.splitlines() if line.startswith("crosscheck ")))[1:]
    assert call(*text) == 0
    assert {"coupler_shapes.svg", "coupler_shapes.dxf"} <= {p.name for p in Path().iterdir()}
    assert "gives the motion back" in capfd.readouterr().out
