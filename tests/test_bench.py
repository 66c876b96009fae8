"""`crosscheck bench`: what it compares is the same motion, and what is missing is told."""

import sys

import pytest

from engines import mujoco, pymunk
from reports.bench.four_bar import floor_ratio, pylinkage_ratio
from reports.bench.loops import loop_costs
from tests.toys import Disc, Toy


def test_the_bench_times_the_same_motion_as_pylinkage():
    pytest.importorskip("pylinkage")
    result = pylinkage_ratio(count=1000)
    # pylinkage adds up its crank angle step by step: a thousand roundings.
    assert result["difference"] < 1e-12
    assert result["ratio"] == result["pylinkage"] / result["ours"]


def test_the_bench_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "pylinkage", None)
    with pytest.raises(RuntimeError, match="'bench' extra"):
        pylinkage_ratio(count=1000)
    assert floor_ratio(count=1000)["floor"] > 0


def test_an_engine_is_compared_with_the_loop_that_is_declared_for_its_name():
    scene = Disc()
    found = loop_costs([Toy(), pymunk.TUNED, mujoco.TUNED], scene.mechanism(), 1e-3, 2, 2)
    assert [cost.engine for cost in found] == [pymunk.TUNED, mujoco.TUNED]  # nobody declares one for the toy
    assert all(cost.steps == 4 and cost.bare > 0 for cost in found)
