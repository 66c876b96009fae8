"""The skate's and the wheels' pages: their experiments' reference, their runnable lines, and what they print."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

import reports.pages
from engines.lagrange import Lagrange
from reference.checks import InvalidMechanism
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.scenes.skates.slopes import HeldBySkates, SkateOnSlope
from reports.cli.selection import choose_cells, known_engines
from reports.model.cells import Cell
from reports.model.measure import measure
from reports.model.page import Material
from reports.model.tasks import Motion, answered
from reports.pages.skate import methods
from reports.pages.skate import page as skate
from reports.pages.skate.experiments import counting
from reports.pages.wheels import experiments as wheels_failures
from reports.pages.wheels import page as wheels
from reports.plots.theme import svg
from tests.present import present

TEMPLATE = Path(reports.pages.__file__).parent / "skate" / "page.md"
BLOCKS = re.findall(r"```python\n(.*?)```", TEMPLATE.read_text(encoding="utf-8"), re.DOTALL)

# What each block's method promises at its step of 1e-3 s: of first order the step, of second its square, of fourth its
# fourth power; times the 3 s and 2.6 J / 2 kg of the motion, and room for constants. Exact ones end in rounding.
PROMISED = (1e-3, 1e-3, 1e-6, 1e-10)


def kept(tasks):
    """What there is when these tasks were run."""
    return Material({}, {task: answered(task) for task in tasks})


@pytest.mark.parametrize(("block", "bound"), tuple(zip(BLOCKS, PROMISED, strict=True)))
def test_the_pages_lines_run_and_are_as_exact_as_the_page_says(block, bound):
    names: dict = {}
    exec(compile(block, "skate.md", "exec"), names)
    truth = ChaplyginSleigh().motion([3.0]).pose[0, 0]
    if "body" in names:
        pose = np.array([*names["body"].position, names["body"].angle])
    else:
        pose = names["data"].qpos + np.array([0.5, 0.0, 0.0])  # coordinates count from where the body starts
    error = np.abs(pose - truth).max()
    assert error < 3 * bound
    # A bound that ten times the order's error would pass proves nothing.
    assert error > bound / 100 or bound == PROMISED[-1]


@pytest.mark.parametrize(
    "scene",
    [
        SkateOnSlope(),
        SkateOnSlope(turning_rate=2.0),
        SkateOnSlope(turning_rate=-0.3, heading=1.0, speed=0.4),
        SkateOnSlope(turning_rate=1e-9, heading=0.7),
        HeldBySkates(),
    ],
)
def test_skates_on_a_slope_agree_with_multipliers(scene):
    row = measure(Cell(scene, Lagrange("dop853", "projection", tolerance=1e-13), 1, samples=50), repeat=False)
    # Rounding of an integration to 1e-13 over some metres.
    assert row.position < 1e-11
    assert row.angle < 1e-11
    assert row.reaction < 1e-10


def test_a_turning_skate_on_a_slope_stands_as_high_as_before_after_each_turn():
    turns = 2 * math.pi * np.arange(4)
    pose = SkateOnSlope(turning_rate=1.0, speed=0.5).motion(turns).pose[:, 0]
    assert np.abs(pose[:, 1]).max() < 1e-12
    # And goes sideways by half the pull times the square of the time of a radian, each radian.
    assert pose[:, 0] == pytest.approx(0.5 * turns, abs=1e-12)


def test_bad_skates_on_a_slope_are_refused():
    with pytest.raises(InvalidMechanism, match="skate_on_slope"):
        SkateOnSlope().motion([-1.0])
    with pytest.raises(InvalidMechanism, match="2 points and 3 angles"):
        HeldBySkates(points=((0.5, 0.0), (-0.5, 0.0)))
    # Two skates never hold a body, and three do not whose axles all go through the centre of mass: it turns about it.
    for points, angles in (
        (((0.5, 0.0), (-0.5, 0.0)), (0.5, -0.5)),
        (((0.5, 0.0), (-0.5, 0.0), (0.0, 0.4)), (math.pi / 2, math.pi / 2, 0.0)),
    ):
        with pytest.raises(InvalidMechanism, match="leave 1 freedom"):
            HeldBySkates(points=points, angles=angles)


def test_the_exact_sleigh_grows_at_its_linear_rate_and_a_wrong_rate_is_told_apart():
    scene = SleighBackwards()
    t = np.linspace(0, scene.duration, scene.samples + 1)
    rate = scene.motion(t).twist[:, 0, 2]
    # The square of 0.04 over the largest rate 1.6 is what the linear motion leaves out.
    assert methods.growth_of(t, rate) == pytest.approx(scene.growth_rate(), rel=1e-3)
    assert methods.growth_of(t, rate) != pytest.approx(1.01 * scene.growth_rate(), rel=1e-3)
    assert math.isnan(methods.growth_of(t, np.full_like(t, 1e-3)))


def test_the_lateral_force_passes_a_limit_when_the_reference_says():
    scene, limit = methods.BACKWARDS, list(methods.LIMITED)[1]
    when = methods.first_beyond(scene, limit)
    assert when is not None
    before, after = np.abs(scene.lateral_force([when - 2e-3, when]))
    assert before < limit <= after
    assert methods.first_beyond(scene, 1.01 * methods.PEAK) is None


def test_friction_slips_soon_after_the_exact_force_passes_its_limit_and_not_before():
    cells = [cell for own in methods.LIMITED.values() for cell in own]
    told = {(o.method, o.setting): o.outcome for o in methods.slipping(kept(map(Motion, cells)))}
    for limit in methods.LIMITED:
        exact = told["exact lateral force", f"{limit:g} N"]
        for method in ("pymunk groove with max_force", "mujoco tendon with friction loss"):
            outcome = told[method, f"{limit:g} N"]
            if "never" in exact:
                assert outcome == "holds"
                continue
            times = [float(present(re.search(r"at ([\d.]+) s", words)).group(1)) for words in (exact, outcome)]
            # Slip starts from zero with the force's excess: a few tenths of a second until it shows.
            assert 0 <= times[1] - times[0] < 0.3


def test_the_trailer_folds_in_the_kinematics_when_the_closed_form_says():
    told = {o.method: o.outcome for o in wheels_failures.folding(kept([wheels_failures.REFERENCE])) if not o.setting}
    closed, driven = told["closed form, at an even speed"], told["the reference, driven at an even speed"]
    assert closed == driven
    assert told["the drawbar pushed along by that way"] == f"bent by {math.pi / 2:.4f} rad"
    # A coasting car gives speed to the trailer's turning, or gets some from it: another instant.
    assert told["the reference, coasting"] != closed


def test_counting_tells_what_the_rows_leave():
    told = {o.method: o.outcome for o in counting(Material({}))}
    assert told["pinned body (18.62)"].startswith("(1, 1); integrable")
    assert told["one skate (18.64)"].startswith("(3, 2); not integrable")
    assert told["two skates on one axle"] == told["one skate (18.64)"]
    assert told["two skates in one line"] == "(3, 1); integrable: of 3 it can reach 1"
    assert told["three skates"].startswith("(3, 0)")
    assert "| car_and_trailer | 5 | (4, 1) | 1 | integrable |" in wheels.counted(wheels.SCENES)


def test_a_run_has_the_named_methods_of_a_page_and_those_of_its_experiments():
    engines = known_engines((skate.PAGE,))
    cells = choose_cells(skate.SCENES, engines, (skate.PAGE,), full=False)
    swept = {(cell.scene.name, cell.engine.variant) for cell in cells if cell.purpose == "sweep"}
    assert ("sleigh", "skate: groove, extrapolated") in swept
    # Nothing constructs a skate where there is none.
    assert ("pinned_body", "skate: groove, extrapolated") not in swept
    everything = choose_cells(skate.SCENES, engines, (skate.PAGE,), full=True)
    assert {cell for failure in skate.PAGE.failures for cell in failure.cells} <= set(everything)
    assert set(cells) < set(everything)


def test_pictures_of_the_reference_are_drawn_and_the_same_each_time():
    for picture in (skate.parking, wheels.tows, wheels.casters, wheels.reversing):
        assert picture().axes
    assert svg(skate.slope(), "a picture") == svg(skate.slope(), "a picture")
