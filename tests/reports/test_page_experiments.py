"""Tests of the experiments of pages (reference motions, observations, claims), and of capabilities of engines."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from engines import mujoco, pymunk, registry
from engines.lagrange import Lagrange
from engines.pymunk import methods as pymunk_methods
from reference.checks import InvalidMechanism
from reference.forces import FORCES
from reference.joints import JOINTS
from reference.scenes.pendulum.scenes import SpinningRing
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse, RollingOnCircle, SquareOnCatenaries
from reference.scenes.skates import ChaplyginSleigh, HeldBySkates, SkateOnSlope, SleighBackwards
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.measure import Measurement, measure, stopped_where_it_ends
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material
from reports.model.tasks import Answer, Motion, Task, trajectory_of
from reports.pages import claims, common
from reports.pages.centrodes import page as centrodes
from reports.pages.engines.examples import ELEMENT_EXAMPLES
from reports.pages.engines.page import (
    HAS_NONE,
    MATRIX,
    NOT_BUILT,
    TOO_OLD,
    Capabilities,
    reason_key,
    refusals_of,
)
from reports.pages.engines.page import PAGE as ENGINES_PAGE
from reports.pages.four_bar import page as four_bar
from reports.pages.index import glance_table, sentences
from reports.pages.n_four_bar import page as n_four_bar
from reports.pages.rolling import page as rolling
from reports.pages.skate import experiments as skate
from reports.pages.slider_crank import page as slider_crank
from reports.pages.wheels import page as wheels
from tests.committed_rows import answer_to
from tests.rows import falling


def row(scene, engine, every: int, samples: int | None = None) -> Measurement:
    return measure(Cell(scene, engine, every, "failure", samples), repeat=False)


# --- reference motions of the scenes of experiments ---


def test_an_impossible_scene_is_refused():
    two = ((0.5, 0.0), (-0.5, 0.0))
    for reason, build in (
        ("links is 2", lambda: SpinningRing(links=2)),
        ("skate_on_slope", lambda: SkateOnSlope().motion([-1.0])),
        ("2 points and 3 angles", lambda: HeldBySkates(points=two)),
        # Two skates never fix a body. A body with three skates can turn about a point in which all axles meet.
        ("leave 1 freedom", lambda: HeldBySkates(points=two, angles=(0.5, -0.5))),
        ("leave 1 freedom", lambda: HeldBySkates(points=(*two, (0.0, 0.4)), angles=(math.pi / 2, math.pi / 2, 0.0))),
    ):
        with pytest.raises(InvalidMechanism, match=reason):
            build()


def test_a_square_reaches_its_corner_at_the_time_that_energy_determines_and_methods_stop_there():
    scene = SquareOnCatenaries()
    # The motion ends at the corner, so the last step of the integration is shortened.
    corner = scene.motion([scene.corner * (1 - 1e-9)])
    assert corner.pose[0, 0, 2] == pytest.approx(math.pi / 4, abs=1e-8)
    np.testing.assert_allclose(corner.pose[0, 0, 1], 0.0, atol=1e-12)
    # the scene's `comparable_until` assumes that friction is sufficient here
    assert abs(corner.reaction[0, 0]) < corner.reaction[0, 1]
    with pytest.raises(ValueError, match="can't turn to"):
        scene.motion([scene.corner * 1.01])
    for engine in (pymunk_methods.ROLL_PIVOT, mujoco.EXTENDED, Lagrange("rk4", "projection")):
        result = row(scene, engine, 1)
        assert not Outcome(result.outcome).comparable
        assert result.sentence
        assert math.isnan(result.angle) or result.angle < 1e-3


def test_errors_of_the_gears_leave_out_undetermined_forces():
    assert row(EllipticGears(), mujoco.EXTENDED, 10).reaction < 1e-2
    assert np.isnan(EllipticGears().motion([0.0]).reaction).any()


def test_round_trip_and_rate_of_centrodes_are_exact_for_the_right_curves_only():
    _, curves = centrodes.exact()
    # Splines of degree 7 at 400 points over 2 rad give an error of 1e-10 in the curves, and of 1e-8 in the motion.
    assert max(centrodes.round_trip(curves), centrodes.agreement(curves)) < 1e-8
    wrong = replace(curves, body=curves.body * 1.001)
    assert min(centrodes.round_trip(wrong), centrodes.agreement(wrong)) > 1e-5


# --- engines in these scenes ---


SKATE = (Path(skate.__file__).parent / "page.md").read_text(encoding="utf-8")


# The programs have the orders 2 and 4 and the step 1e-3 s.
@pytest.mark.parametrize(
    ("program", "bound"), list(zip(re.findall(r"```python\n(.*?)```", SKATE, re.DOTALL), (1e-6, 1e-10), strict=True))
)
def test_programs_of_the_skate_have_the_accuracy_that_the_page_states(program, bound):
    names = common.run_script("skate.md", program)
    pose = names["data"].qpos + np.array([0.5, 0.0, 0.0])  # coordinates are relative to the initial position
    error = np.abs(pose - ChaplyginSleigh().motion([3.0]).pose[0, 0]).max()
    assert error < 3 * bound
    assert error > bound / 100 or bound == 1e-10  # the program of order 4 reaches rounding


def test_a_comparison_ends_with_ideal_rolling_and_ignores_a_later_reset():
    scene, flat = RollingOnCircle(), RollingEllipse()
    result = row(scene, mujoco.TUNED, 100)
    assert Outcome(result.outcome).comparable
    assert f"compared until {scene.comparable_until:.4g} s only" in result.sentence
    total, other = (trajectory_of(answer_to(Motion(Cell(item, mujoco.EXTENDED, 1)))) for item in (scene, flat))
    shortened, note = stopped_where_it_ends(scene, total)
    assert shortened.t[-1] <= scene.comparable_until < total.t[len(shortened.t)]
    assert note
    for reset, expected in ((1.1, None), (0.5, 0.5)):
        assert stopped_where_it_ends(scene, replace(total, reset_at=reset))[0].reset_at == expected
    assert stopped_where_it_ends(flat, other) == (other, "")


def test_a_contact_is_absent_at_samples_without_a_normal_force():
    cell = Cell(RollingOnCircle(), mujoco.EXTENDED, 10)
    truth = cell.scene.motion(np.linspace(0, cell.scene.comparable_until, 11))
    assert rolling.absent_contact(cell, truth) == 0.0
    reaction = truth.reaction * (np.arange(11) % 2)[:, None]  # zero at five of the ten samples after t = 0
    assert rolling.absent_contact(cell, replace(truth, reaction=reaction)) == 0.5


# --- observations and claims ---


@pytest.mark.parametrize("page", [four_bar, slider_crank, n_four_bar], ids=lambda page: page.PAGE.name)
def test_observations_of_a_page_have_finite_numbers(page):
    material = Material({}, {task: answer_to(task) for failure in page.PAGE.failures for task in failure.tasks})
    lines = [seen for failure in page.PAGE.failures if failure.observations for seen in failure.observations(material)]
    assert lines
    assert all(seen.outcome and "nan" not in seen.outcome for seen in lines)


def test_observations_on_skates_and_wheels_agree_with_the_reference():
    scene = SleighBackwards()
    t = np.linspace(0, scene.duration, scene.samples + 1)
    rate = scene.motion(t).twist[:, 0, 2]
    # The relative error of the linearised motion is (0.04 / 1.6)^2, where 1.6 rad/s is the largest rate.
    assert skate.growth_of(t, rate) == pytest.approx(scene.growth_rate(), rel=1e-3)
    assert math.isnan(skate.growth_of(t, np.full_like(t, 1e-3)))
    lines = {seen.method: seen.outcome for seen in skate.counting(Material({}))}
    assert lines["pinned body (18.62)"].startswith("(1, 1); integrable")
    assert (
        lines["two skates on one axle"] == lines["one skate (18.64)"] == "(3, 2); not integrable: of 3 it can reach 3"
    )
    assert lines["two skates in one line"] == "(3, 1); integrable: of 3 it can reach 1"
    reference = Material({}, {wheels.REFERENCE: answer_to(wheels.REFERENCE)})
    lines = {seen.method: seen.outcome for seen in wheels.folding(reference) if not seen.setting}
    assert lines["closed form, at a constant speed"] == lines["the reference, driven at a constant speed"]
    assert lines["the drawbar, pushed along this distance"] == f"bent by {math.pi / 2:.4f} rad"


ROWS = [*falling("pymunk a", (8e-2, 4e-2, 1e-2)), *falling("pymunk b", (2e-2, 1.8e-2, 1.7e-2), outcome="torn")]
SETS = replace(common.cells(four_bar.PAGE.scenes[1], [pymunk.DEFAULT], (1,))[0], samples=7)
HOLD = (
    'falls("pymunk a", 1.9)',
    'stays("pymunk b")',
    'ratio("pymunk a") == 0.25',
    'above("pymunk a", "pymunk b", 0.5)',
    'share("torn") == 0.5 and share("torn", without="pymunk a") == 1',
    'comparable("pymunk b") == [false, false, false] and ends("pymunk a")[0] == "finished"',
    'smallest("angle", "pymunk a") < smallest("angle", "pymunk b") < largest("angle", "pymunk a")',
    'at("pymunk a", 1e-2).angle == times',
    'alike("disc", "angle", "pymunk a")',
)
FAIL = (
    'falls("pymunk a")',
    'falls("pymunk c")',  # there are no rows of this method
    'stays("pymunk a")',
    'above("pymunk a", "pymunk b")',
    'not unresolved("pymunk a") or silent() or estimated("pymunk a")',
    'alike("another", "angle", "pymunk a")',
)


def test_a_claim_that_rows_contradict_or_that_lacks_rows_is_reported():
    cells = [replace(SETS, every=every) for every in range(1, 7)]
    failure = Failure("Falls", cells=tuple(cells), claims=(*HOLD, *FAIL), context=lambda material: {"times": 4e-2})
    page = replace(four_bar.PAGE, name="toy", failures=(failure,))
    wrong = claims.contradicted({page: Material(dict(zip(cells, ROWS, strict=True)))})
    assert wrong == [f"toy, Falls: {claim}" for claim in FAIL]


def test_each_claim_of_our_pages_is_evaluated_and_fails_without_rows():
    wrong = claims.contradicted({page: Material({}) for page in PAGES})
    written = sum(len(failure.claims) for page in PAGES for failure in page.failures)
    assert len(wrong) >= written > 40


# --- capabilities of engines ---


def test_the_table_of_engines_has_a_line_for_each_joint_and_force_and_the_judge_builds_all():
    elements = {
        type(element) for example in ELEMENT_EXAMPLES.values() for element in (*example.joints, *example.forces)
    }
    assert elements == {*JOINTS, *FORCES}
    lagrange = next(engine for engine in registry.VARIANTS if engine.name == "lagrange")
    answers = Capabilities(lagrange).run()
    assert [answers[kind] for kind in ELEMENT_EXAMPLES] == ["yes"] * len(ELEMENT_EXAMPLES)


def test_the_table_of_engines_follows_from_the_capability_tables_whatever_a_build_answered():
    answers = {task: Answer(Outcome.FINISHED, values=dict.fromkeys(ELEMENT_EXAMPLES, "yes")) for task in MATRIX}
    words = {(engine, line): (word, reason) for engine, line, word, reason in refusals_of(answers)}
    sentence = "joint 'gear': box2d has no gears since version 3 (https://box2d.org/documentation/group__joint.html)"
    assert words["box2d", "gear"] == (HAS_NONE, sentence)
    assert words["bullet", "slot in a loop"] == (
        NOT_BUILT,
        "joint 'upright': our adapter of bullet builds no slot that closes a loop",
    )
    refused = {
        (task.method.name, line)
        for task in MATRIX
        for line, example in ELEMENT_EXAMPLES.items()
        if task.method.capability and task.method.capability.refusal(example)
    }
    assert {*words} == refused
    assert {engine for engine, _ in refused} == {task.method.name for task in MATRIX} - {"lagrange"}


def test_an_element_that_a_table_allows_and_a_build_refuses_is_not_built():
    built = {task.method.name: task.run() for task in MATRIX if not task.method.missing and task.method.build_time < 1}
    assert built["pymunk"]["disc rolls in a ring"] == NOT_BUILT
    assert "hollow" in str(built["pymunk"][reason_key("disc rolls in a ring")])
    for answers in built.values():
        for line in ELEMENT_EXAMPLES:
            word, reason = answers[line], str(answers[reason_key(line)])
            assert (word == HAS_NONE) == ("https://" in reason)
            assert (word in (HAS_NONE, NOT_BUILT)) == bool(reason)
    lines = ("loop", "disc rolls on a line", "skate")
    assert [built["pymunk"][line] for line in lines] == ["yes", "by contact", "with our code"]


def test_a_release_that_lacks_a_function_of_the_adapter_is_too_old(monkeypatch):
    engine = next(engine for engine in registry.VARIANTS if engine.name == "lagrange")
    build = type(engine).build

    def old(self, mechanism, dt):
        if len(mechanism.joints) == 1 and mechanism.forces:
            raise AttributeError("no such member")
        return build(self, mechanism, dt)

    monkeypatch.setattr(type(engine), "build", old)
    answers = Capabilities(engine).run()
    assert (answers["spring"], answers["hinge"]) == (TOO_OLD, "yes")


def test_the_table_at_a_glance_has_a_row_and_a_sentence_for_each_engine_and_an_empty_table_without_answers():
    answers: dict[Task, Answer] = {
        task: Answer(
            Outcome.FINISHED, values={**dict.fromkeys(ELEMENT_EXAMPLES, "yes"), "reactions": "yes", "width": "64"}
        )
        for task in MATRIX
    }
    page, scenes = ENGINES_PAGE, {"free_four_bar": "four-bar"}
    table = glance_table({page: Material({}, answers)}, [], scenes).splitlines()
    names = {engine.name for engine in (*registry.VARIANTS, *registry.OTHERS)}
    assert {line.split("|")[1].strip() for line in table[2:]} == names == {*sentences()["engines"]}
    assert glance_table({page: Material({})}, [], scenes) == ""
