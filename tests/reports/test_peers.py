"""`crosscheck bench peers`: the cheapest settings, the four-bar in one coordinate, random loops, the page."""

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH, loading
from reference.scenes.four_bar.scenes import FreeFourBar, SpinningFourBar
from reports.bench import peers
from reports.bench.peers import SAMPLES, Ladder, Peer, Setting, cheapest, climb, measure_scene
from reports.bench.random_loops import RandomLoops
from reports.cli import bench as command
from reports.model.ending import BadInput
from reports.model.page import Material
from reports.pages.rendering import render_page
from reports.pages.speed.page import NO_REASON, PAGE, REASONS, page_of, reason_of, spread
from reports.pages.speed.table import (
    ABSENT,
    FILE,
    JUDGE,
    NOT_MEASURED,
    ONE_COORDINATE,
    REACHED,
    UNREACHED,
    UNSUPPORTED,
    SpeedRow,
    SpeedTable,
    as_csv,
    read,
)
from tests.toys import Disc

TRUE = Disc().motion(np.linspace(0, Disc().duration, SAMPLES + 1)).pose[..., 2]
LOOP = FreeFourBar()
needs_numba = pytest.mark.skipif(not loading.installed(), reason="compiled code needs numba")


def ladder(*pairs, expected=0.0):
    """A ladder of settings with these pairs of error [rad] and CPU time [s]."""

    def setting(error, seconds):
        return Setting(f"error {error:g}", lambda: (TRUE + error, seconds))

    return Ladder((setting(*pair) for pair in pairs), expected)


def peer(name, *ladders, missing=""):
    return Peer(name, lambda scene: ladders, missing)


def refusing(name):
    def ladders(scene):
        raise Unsupported("it has no pins")

    return Peer(name, ladders)


def test_a_ladder_ends_at_the_smallest_target_or_before_a_run_over_the_budget():
    pairs = (1e-2, 0.1), (1e-4, 0.2), (1e-10, 0.4), (1e-12, 0.8)
    assert [rung.seconds for rung in climb(ladder(*pairs), TRUE, (1e-3, 1e-9), 10.0)] == [0.1, 0.2, 0.4]
    assert [rung.seconds for rung in climb(ladder(*pairs), TRUE, (1e-3, 1e-9), 0.3)] == [0.1, 0.2]
    assert climb(ladder(*pairs, expected=0.31), TRUE, (1e-3,), 0.3) == []


def test_the_cheapest_setting_of_all_ladders_is_chosen_and_a_failed_motion_never():
    pairs = (math.nan, 0.01), (1e-4, 0.5), (1e-5, 0.3), (1e-7, 0.7)
    rungs = climb(ladder(*pairs), TRUE, (1e-9,), 10.0)
    chosen = [cheapest(rungs, target) for target in (1e-3, 1e-6, 1e-9)]
    assert [rung and rung.seconds for rung in chosen] == [0.3, 0.7, None]


def at(rows, engine, target) -> SpeedRow:
    row = SpeedTable(tuple(rows)).at("disc", engine, target)
    assert row is not None
    return row


def test_the_rows_of_a_scene_have_ratios_lower_bounds_refusals_and_missing_engines():
    own = peer(JUDGE, ladder((1e-4, 0.02), (1e-10, 0.05)))
    coarse = peer("coarse", ladder((1e-2, 0.1), (1e-5, 0.2), (1e-5, 0.4)), ladder((1e-4, 0.15)))
    others = coarse, refusing("bolts"), peer("absent", missing="absent needs a package"), refusing("pinocchio")
    rows = measure_scene("disc", Disc(), (own, *others), (1e-3, 1e-9), budget=0.5)
    found = at(rows, "coarse", 1e-3)
    assert (found.outcome, found.setting, found.words) == (REACHED, "error 0.0001", "7.5")
    missed = at(rows, "coarse", 1e-9)
    assert (missed.outcome, missed.words, missed.seconds) == (UNREACHED, "> 8", 0.4)
    assert missed.error == pytest.approx(1e-5)
    assert [at(rows, name, 1e-3).words for name in ("bolts", "absent")] == ["not built", ABSENT]
    assert at(rows, peers.PINOCCHIO_ALONE, 1e-3).note == "it has no pins"
    assert at(rows, JUDGE, 1e-9).seconds == 0.05


def test_the_budget_grows_with_the_run_of_the_judge():
    own = peer(JUDGE, ladder((1e-10, 0.1)))
    slow = peer("slow", ladder((1e-2, 4.0), (1e-4, 8.0), (1e-10, 11.0)))
    rows = measure_scene("disc", Disc(), (own, slow), (1e-9,), budget=1.0)
    assert [row.words for row in rows if row.engine == "slow"] == ["> 80"]


def test_a_ratio_is_unknown_where_the_judge_does_not_reach_the_error():
    rows = measure_scene(
        "disc", Disc(), (peer(JUDGE, ladder((1e-4, 0.1))), peer("good", ladder((1e-10, 1.0)))), (1e-9,)
    )
    assert [row.words for row in rows] == ["-", "-"]
    assert not any(row.is_behind for row in rows)


def test_the_judge_is_behind_below_five_times_and_beyond_twice_the_solution_in_one_coordinate():
    def row(engine, seconds, outcome=REACHED):
        return SpeedRow("four-bar", engine, 1e-3, outcome, "", 1e-4, seconds, 1.0)

    ahead = row("mujoco", 5.1), row(ONE_COORDINATE, 0.51), row(JUDGE, 1.0), row("drake", math.nan, UNSUPPORTED)
    assert not any(cell.is_behind for cell in ahead)
    assert all(
        cell.is_behind for cell in (row("mujoco", 4.9), row(ONE_COORDINATE, 0.49), row("mujoco", 4.9, UNREACHED))
    )


def test_the_part_of_pinocchio_in_cpp_is_its_evaluations_times_the_time_of_one(monkeypatch):
    monkeypatch.setattr(peers, "evaluation_in_cpp", lambda scene: lambda: 2e-6)
    rungs = climb(ladder((1e-4, 0.1)), TRUE, (1e-9,), 1.0)
    rungs = [replace(rung, setting=replace(rung.setting, evaluations=40)) for rung in rungs]
    (alone,) = peers.in_cpp_alone(Disc(), rungs)
    assert (alone.error, alone.seconds) == (rungs[0].error, pytest.approx(8e-5))
    assert alone.setting.run()[1] == pytest.approx(8e-5)


def test_each_evaluation_of_a_runge_kutta_method_of_pinocchio_counts():
    if peers.METHODS["pinocchio"][0].missing:
        pytest.skip("pinocchio is not installed")
    euler, rk4 = (next(peers.by_steps(engine, Disc()).settings) for engine in peers.METHODS["pinocchio"])
    assert (euler.evaluations, rk4.evaluations) == (SAMPLES, 4 * SAMPLES)
    assert all(peers._evaluations(scene, constrained)() > 0 for scene, constrained in ((Disc(), False), (LOOP, True)))


@needs_numba
@pytest.mark.parametrize(
    "scene",
    [FreeFourBar(), SpinningFourBar(), FreeFourBar(branch=-1, density=(1.0, 2.0, 0.5), gravity=(3.0, -9.0), rate=8.0)],
    ids=["free", "spinning", "other branch"],
)
def test_the_four_bar_in_one_coordinate_is_the_exact_motion(scene):
    from reports.bench.one_coordinate import motion

    angles, _ = motion(scene, 1e-14, SAMPLES)
    truth = scene.motion(np.linspace(0, scene.duration, SAMPLES + 1)).pose[..., 2]
    # The largest of the three errors is 2e-13 rad, a thousand roundings of a turn in a hundred steps.
    assert np.abs(angles - truth).max() < 1e-12


def test_the_reference_of_random_loops_agrees_with_the_judge():
    scene = RandomLoops()
    mechanism = scene.mechanism()
    assert len(mechanism.bodies) == 20
    assert mechanism.degrees_of_freedom() == (10, 10)
    assert mechanism.joints == RandomLoops().mechanism().joints
    truth = scene.motion(np.linspace(0, scene.duration, SAMPLES + 1))
    judged = TRUTH.build(mechanism, scene.spacing)(scene.samples, 1)
    at = np.searchsorted(judged.t, truth.t - 1e-9)
    # Measured: 1e-12. The smallest error in the table is 1e-9 rad.
    assert np.abs(judged.pose[at] - truth.pose).max() < 1e-11


@needs_numba
def test_the_operations_of_a_step_grow_with_the_links_and_with_the_stages():
    from engines.lagrange.compiled_model import CompiledModel
    from reference.scenes.pendulum.scenes import LongPendulum
    from reports.bench.roofline import step_work

    def work(mechanism, integrator):
        model = CompiledModel.of(mechanism)
        assert model is not None
        return np.array(step_work(model, integrator))

    short, long = (work(LongPendulum(links=links).mechanism(), "rk4") for links in (100, 200))
    assert long == pytest.approx(2 * short, rel=0.02)
    # A step by DOP853 has 12 stages, and one by RK4 has 4. Each has a projection, and sums of earlier stages.
    four_bar = FreeFourBar().mechanism()
    assert 2.4 < work(four_bar, "dop853")[0] / work(four_bar, "rk4")[0] < 2.6


ROWS = (
    SpeedRow("four-bar", JUDGE, 1e-3, REACHED, "dop853, step 1 ms", 2e-4, 1e-4, 1e-4),
    SpeedRow("four-bar", "mujoco", 1e-3, REACHED, "tuned, step 1 ms", 5e-4, 3e-4, 1e-4),
    SpeedRow("four-bar", "drake", 1e-3, UNREACHED, "default, step 1 ms", 5e-3, 0.1, 1e-4),
    SpeedRow("four-bar", "exudyn", 1e-3, UNSUPPORTED, note="it has no pins, and no slots"),
)
FACTS = {"date": "2026-11-28", "machine": "a machine", "versions": "numpy 2, scipy: 1", "budget": "2"}


def test_a_stored_table_is_read_as_it_was_and_another_file_is_refused(tmp_path):
    table = SpeedTable(ROWS, FACTS)
    (tmp_path / FILE).write_text(as_csv(table))
    again = read(tmp_path / FILE)
    assert (as_csv(again), again.facts, again.rows[:3]) == (as_csv(table), table.facts, ROWS[:3])
    for content in (b"scene,engine\nfour-bar,mujoco\n", b"\xff\xfe"):
        (tmp_path / FILE).write_bytes(content)
        with pytest.raises(BadInput, match=r"speed\.csv: "):
            read(tmp_path / FILE)


def test_a_reason_belongs_to_its_engine_scene_and_target():
    texts = [
        reason_of(SpeedRow(scene, engine, target, REACHED))
        for scene, engine, target in (
            *(("sleigh", "mujoco", 1e-3), ("rolling-ellipse", "mujoco", 1e-3), ("four-bar", "mujoco", 1e-3)),
            *(("sleigh", "mujoco", 1e-6), ("sleigh", "pinocchio", 1e-6)),
        )
    ]
    assert texts[3:] == [NO_REASON, NO_REASON]
    assert len({NO_REASON, *texts}) == 4


def test_each_reason_belongs_to_a_cell_of_the_published_table_and_names_its_scenes_and_engines():
    rows = read().rows
    found = {reason_of(row) for row in rows}
    for entry in REASONS:
        assert " ".join(entry["reason"].split()) in found
        assert set(entry) <= {"engines", "scenes", "targets", "reason"}
        for key, values in (
            ("engines", {row.engine for row in rows}),
            ("scenes", {row.scene for row in rows}),
            ("targets", {row.target for row in rows}),
        ):
            assert set(entry.get(key, ())) <= values


def test_new_rows_replace_those_of_their_scene_and_engine_and_rows_of_another_machine_are_not_kept():
    other = SpeedTable(ROWS, FACTS)
    table = SpeedTable((), FACTS | {"date": "2026-11-29"}).with_rows_of(other)
    better, order = replace(ROWS[1], seconds=2e-4), ("sleigh", "four-bar")
    new = table.with_new([better, SpeedRow("sleigh", "mujoco", 1e-3, REACHED)], order, peers.LINES)
    assert [(row.scene, row.engine) for row in new.rows[:2]] == [("sleigh", "mujoco"), ("four-bar", JUDGE)]
    assert new.at("four-bar", "mujoco", 1e-3) == better
    assert len(new.rows) == len(ROWS) + 1
    assert SpeedTable((), FACTS | {"machine": "another"}).with_rows_of(other).rows == ()


def test_the_page_of_a_table_has_its_ratios_and_reasons_and_says_if_nothing_was_run():
    text = render_page(page_of(SpeedTable(ROWS, FACTS)), Material({}), "crosscheck bench peers")["speed.md"]
    assert "| four-bar | 0.1 | 3 | > 1000 | not built |" in text
    assert "| exudyn | four-bar | it has no pins, and no slots |" in text
    assert "by a factor of 1 in the median and of 1 at" in text
    assert "| mujoco | four-bar at 1e-03: 3 | " in text
    assert "Nothing was run yet" in render_page(page_of(SpeedTable(())), Material({}), "")["speed.md"]


def test_the_spread_of_the_judges_time_is_that_between_rows_of_one_cell():
    rows = [replace(ROWS[0], judge_seconds=seconds) for seconds in (1e-4, 3e-4)]
    rows += [replace(ROWS[0], target=1e-6), replace(ROWS[2], judge_seconds=1.0)]
    assert spread(SpeedTable(tuple(rows))) == pytest.approx((2.0, 3.0))


def test_the_published_page_explains_each_cell_in_which_the_judge_misses_its_aim():
    table = read()
    not_measured = table.facts.get(NOT_MEASURED, "").split(", ")
    assert {*table.scenes, *filter(None, not_measured)} == set(peers.SCENES)
    assert table.targets == peers.TARGETS
    files = render_page(PAGE, Material({}), "make publish")
    assert set(files) == {"speed.md", "speed_ratios.svg"}
    assert NO_REASON not in files["speed.md"]
    assert "nan" not in files["speed.md"].lower().replace("resonan", "")


def test_the_command_writes_the_table_with_its_page_and_refuses_a_part_for_publication(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(peers, "measure_peers", lambda *_: iter([list(ROWS)]))
    monkeypatch.setattr(peers, "facts", lambda budget: FACTS | {"budget": f"{budget:g}"})
    monkeypatch.setattr(loading, "installed", lambda: True)
    command._compare_peers(["four-bar"], None, False, 3.0, tmp_path, False)
    assert {path.name for path in tmp_path.iterdir()} == {FILE, "speed.md", "speed_ratios.svg"}
    assert "error at most 1e-03 rad" in capsys.readouterr().out
    assert read(tmp_path / FILE).facts["budget"] == "3"
    with pytest.raises(BadInput, match="use --full"):
        command._compare_peers(["four-bar"], None, False, 3.0, tmp_path, True)
    with pytest.raises(BadInput, match="four-bar"):
        command._compare_peers(["fourbar"], None, False, 3.0, tmp_path, False)
