"""Tests of planar_crosscheck, the importers and the fixtures in notebooks, scripts and users' tests."""

from __future__ import annotations

import math
import re
import sys
import xml.etree.ElementTree as xml
from types import SimpleNamespace

import mujoco
import numpy as np
import pymunk
import pytest

import engines.conformance
import planar_crosscheck
from engines import importers, method_name
from engines.conformance import CHECKS, conform
from engines.pymunk import DEFAULT
from engines.registry import OTHERS
from reference.checks import InvalidMechanism
from reference.linkage import linkage
from reference.scenes.four_bar.scenes import FreeFourBar
from tests.reports.test_check import FOUR_BAR, PENDULUM

POINTS = {"A": (0, 0), "B": (0, 0.3), "C": (0.8, 0.6), "D": (0.7, 0)}
BARS = {"crank": "AB", "coupler": "BC", "rocker": "DC"}


def test_the_example_in_the_module_docstring_runs(tmp_path, monkeypatch):
    (tmp_path / "model.xml").write_text(FOUR_BAR)
    monkeypatch.chdir(tmp_path)
    lines = re.findall(r"^    (.*)$", str(planar_crosscheck.__doc__), re.MULTILINE)
    assert len(lines) <= 12
    values = {}
    exec("\n".join(lines), values)
    assert values["found"].data["met"] is False
    assert values["mechanism"].degrees_of_freedom() == (1, 1)
    assert {row.outcome for row in values["rows"]} == {"finished"}
    assert planar_crosscheck.run("free_four_bar", "pymunk", every=[100]) == values["rows"]  # stored
    assert planar_crosscheck.report().is_file()
    displayed = values["beside"]._repr_html_()
    for text in ("mujoco default at 2 ms", "<th>largest</th>", "data:image/svg+xml"):
        assert text in displayed


def test_a_linkage_has_its_bars_between_the_given_points():
    result = linkage(POINTS, BARS, "AD")
    for body, (first, second) in zip(result.bodies, BARS.values(), strict=True):
        x, y, angle = body.pose
        length = math.dist(POINTS[first], POINTS[second])
        assert body.mass == pytest.approx(length)
        assert body.inertia == pytest.approx(length**3 / 12)
        ends = np.array([x, y]) + np.outer([-length / 2, length / 2], [math.cos(angle), math.sin(angle)])
        np.testing.assert_allclose(ends, [POINTS[first], POINTS[second]], atol=1e-15)
    assert result.degrees_of_freedom() == (1, 1)
    # The point C connects three bars, and the bar "arm" hangs freely.
    extra = linkage({**POINTS, "E": (1.5, 0.6)}, {**BARS, "arm": "CE"}, "AD")
    assert [joint.name for joint in extra.joints] == ["A", "B", "D", "C", "C 2"]
    assert extra.degrees_of_freedom() == (2, 2)
    drawings = [
        planar_crosscheck.draw(extra, pose)._repr_svg_()
        for pose in (None, extra.pose, extra.pose + np.array([0.3, 0, 1]))
    ]
    xml.fromstring(drawings[0])
    assert drawings[0] == drawings[1] != drawings[2]


@pytest.mark.parametrize(
    ("points", "bars", "ground", "sentence"),
    [
        (POINTS, {"crank": "AX"}, "A", "no point is called 'X'; there are A, B, C, D"),
        ({**POINTS, "B": 3}, BARS, "AD", "point 'B' is 3; it must be two numbers, x and y [m]"),
        (POINTS, {"crank": "A"}, "A", "bar 'crank': its ends are 'A'; give the names of two different points"),
        ({**POINTS, "E": (0, 0)}, {"crank": "AE"}, "A", "at the same point"),
    ],
)
def test_an_invalid_linkage_is_refused_in_a_sentence(points, bars, ground, sentence):
    with pytest.raises(InvalidMechanism, match=re.escape(sentence)):
        linkage(points, bars, ground)


def test_a_comparison_has_the_run_of_the_engine_and_the_exact_motion(monkeypatch):
    scene = FreeFourBar()
    result = planar_crosscheck.compare(scene.mechanism(), "pymunk tuned", dt=1e-3, duration=0.5)
    assert len(result.run.t) == 251  # not exactly SAMPLES, since there is a whole number of steps between samples
    assert planar_crosscheck.compare(scene.mechanism(), "pymunk", 0.1, 0.1).title == "pymunk default at 100 ms"
    truth = scene.motion(result.run.t)
    assert np.abs(result.truth.pose - truth.pose).max() < 1e-9
    off = np.abs(result.run.pose - truth.pose)[..., 2].max()
    assert result.errors.worst["angle"] == pytest.approx(off, rel=1e-6)
    with pytest.raises(ValueError, match="no engine is called 'pymunky'; there are pymunk, mujoco"):
        planar_crosscheck.compare(scene.mechanism(), "pymunky", 1e-3)
    with pytest.raises(ValueError, match="no engine is called 'pymunk fine'; there are pymunk default, pymunk tuned"):
        planar_crosscheck.compare(scene.mechanism(), "pymunk fine", 1e-3)
    for extra in OTHERS:
        if extra.missing:
            with pytest.raises(ValueError, match=re.escape(extra.missing)):
                planar_crosscheck.compare(scene.mechanism(), method_name(extra), 1e-3)
    with pytest.raises(ValueError, match="dt is 3 s and duration"):
        planar_crosscheck.compare(scene.mechanism(), DEFAULT, 3, 1.0)
    # A substitute for pandas, which is optional, returns its arguments.
    pandas = SimpleNamespace(DataFrame=lambda data, index: (data, index), Index=lambda values, name: tuple(values))
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    columns, index = result.frame()
    assert {len(column) for column in columns.values()} == {len(index)}
    assert {len(column) for column in result.run.table().values()} == {len(result.run.t)}
    np.testing.assert_array_equal(result.run.table()["angle 2"], result.run.pose[:, 2, 2])
    assert result.run._repr_html_().count("<tr>") == 7


def test_models_are_read_as_files_and_as_objects(tmp_path):
    (tmp_path / "model.xml").write_text(FOUR_BAR)
    (tmp_path / "swing.py").write_text(PENDULUM)
    from_file = importers.mujoco.read(tmp_path / "model.xml")
    assert importers.mujoco.read(mujoco.MjModel.from_xml_string(FOUR_BAR)) == from_file  # type: ignore[attr-defined]
    values: dict = {}
    exec(PENDULUM, values)
    space = values["make"]()
    assert isinstance(space, pymunk.Space)
    assert importers.pymunk.read(space) == importers.pymunk.read(f"{tmp_path / 'swing.py'}:make")
    result = planar_crosscheck.check(space, duration=0.2, step=0.01, quick=True)
    assert result.data["step"] == 0.01
    assert "<svg" not in result._repr_html_()  # pictures are <img> elements
    assert "data:image/svg+xml" in result._repr_html_()
    with pytest.raises(ValueError, match=r"it is dict; give a file, a mujoco\.MjModel or a pymunk\.Space"):
        planar_crosscheck.check({})


def test_a_search_returns_its_cases_and_stores_them(tmp_path, at_home):
    cases = planar_crosscheck.search("lagrange", "rk4 projection", cases=2, seed=1, results=tmp_path)
    assert [case.number for case in cases] == [0, 1]
    assert (tmp_path / "search" / "cells.sqlite").is_file()


FEW = ("reactions_have_sign_and_size", "has_a_name")
THEIRS = """
import pytest

def test_right(crosscheck):
    assert crosscheck.check("model.xml", tolerance=0.1, duration=0.1, quick=True).data["met"]

def test_wrong(crosscheck):
    crosscheck.check("model.xml", tolerance=1e-7, duration=0.1, quick=True)

def test_missing(crosscheck):
    crosscheck.check("nothing.xml")

def test_engine(crosscheck):
    from tests.wrong.adapters import Wrong
    crosscheck.conform(Wrong("reactions have the other sign"))
"""


def test_the_pytest_fixture_passes_or_fails_with_advised_lines_or_a_reason(pytester, monkeypatch):
    monkeypatch.setattr(engines.conformance, "CHECKS", tuple(check for check in CHECKS if check.name in FEW))
    pytester.makeconftest('pytest_plugins = ["planar_crosscheck_pytest"]')
    folder = pytester.mkdir("sub")
    (folder / "test_mine.py").write_text(THEIRS)
    (folder / "model.xml").write_text(FOUR_BAR)
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-q")
    result.assert_outcomes(passed=1, failed=3)
    result.stdout.fnmatch_lines(["four bar in MuJoCo is off by*; the tolerance of 1e-7 is missed."])
    result.stdout.fnmatch_lines(["*<option timestep=*", "nothing.xml: there is no such file"])
    result.stdout.fnmatch_lines(["wrong reactions have the other sign does not conform:"])
    assert "During handling" not in result.stdout.str()


# ------------------------------------------------------------------------------------------------------ conformance


@pytest.mark.parametrize(
    ("expected", "sentence"),
    [
        ({}, "reactions_have_sign_and_size: .*: reactions_have_sign_and_size: "),
        ({"reactions_have_sign_and_size": "bug 12"}, ""),
        ({"reactions_have_sign_and_size: hanging bar": "bug 12"}, "reactions_have_sign_and_size: (?!hanging bar)"),
        (
            {"reactions_have_sign_and_size": "bug 12", "has_a_name": "bug 13"},
            r"has_a_name: .*\(bug 13\), and it does not",
        ),
        ({"reactions_have_sign_and_size": "bug 12", "has_a_nose": "bug 14"}, "'has_a_nose' is no check; there are"),
    ],
)
def test_an_expected_failure_that_does_not_occur_fails(monkeypatch, expected, sentence):
    from tests.wrong.adapters import Wrong

    monkeypatch.setattr(engines.conformance, "CHECKS", tuple(check for check in CHECKS if check.name in FEW))
    engine = Wrong("reactions have the other sign")
    if not sentence:
        results = conform(engine, expected)
        assert {case.check.name for case, _ in results} == set(FEW)
        return
    with pytest.raises(AssertionError, match=sentence) as raised:
        planar_crosscheck.conform(engine, expected)
    assert str(raised.value).startswith("wrong reactions have the other sign does not conform:\n")
