"""What fresh seeds found and an oracle had forgotten is no fault any more, and a mistake just above it still is one."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import math

import numpy as np
import pytest

from engines import Engine, lagrange, mujoco, pymunk
from engines.lagrange import TRUTH
from engines.lagrange.engine import _LagrangeRun
from engines.mujoco.model import Model
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search import motion_bounds, motions
from reports.search.law import NotAsked, lost_in_products
from reports.search.mechanisms import mechanism, recipe
from reports.search.parts import EVERY
from reports.search.recipe import build
from reports.search.relations import CHANGES, STEP, STEPS
from reports.search.subjects import Adapted
from tests.reports.test_search_in_mujoco import wrong
from tests.reports.test_search_oracles import Beside

DOP853 = lagrange.VARIANTS[-1]


@pytest.mark.parametrize(
    ("engine", "seed", "decades", "number"),
    [
        (DOP853, 430129182, 0, 16),  # a roll through a centre of mass, whose arm is a rounding
        (lagrange.VARIANTS[0], 1828094220, 4, 55),  # its finer steps warn, and still finer ones are right
        (mujoco.EXTENDED, 441980448, 2, 0),  # an open gap beside a radius of a centimetre, in a mechanism of 13 m
        (mujoco.EXTENDED, 441980448, 4, 2),  # the judge misses as much, as it says
        (mujoco.DEFAULT, 195484576, 4, 25),  # forces that were read before the solver went on
        (mujoco.TUNED, 923428352, 4, 4),  # a light body that carries a heavy one, 1800 km away
        (pymunk.TUNED, 195484576, 4, 28),  # a groove whose ends are a thousand lengths away
        (pymunk.TUNED, 796316743, 4, 1),  # a slide 100 m from the point of its slot, in a mechanism of 5 cm
        (mujoco.TUNED, 689539221, 4, 22),  # a force on a body of 50 t that a weld of 0.1 g passes on
        (pymunk.DEFAULT, 1828094220, 4, 21),  # forces of poses that are a radian off
        (pymunk.TUNED, 341051688, 2, 19),  # a weld's angle open by 2 mrad, in a mechanism of 6 micrometres
        (pymunk.TUNED, 1737682144, 2, 32),  # lost at three steps in which rows turn, and right at an eighth
    ],
)
def test_what_fresh_seeds_found_of_oracles_is_asked_and_no_fault(
    engine: Engine, seed: int, decades: int, number: int
) -> None:
    told = Adapted(engine).ask(recipe(seed, number, EVERY, decades), number, ("instant", "relations", "motions"))
    assert told.errors
    assert told.faults == ()


@pytest.mark.parametrize(("seed", "number", "decades"), [(163507254, 8, 2), (1240693234, 4, 2)])
def test_joints_of_a_tree_that_move_against_each_other_cost_digits_and_a_thousandth_of_an_inertia_is_found(
    seed: int, number: int, decades: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = recipe(seed, number, EVERY, decades)
    assert Adapted(mujoco.TUNED).ask(case, number, ("instant",)).faults == ()

    def heavier(model: Model) -> None:
        model.compiled.body_inertia[:] *= 1 + 1e-3

    wrong(monkeypatch, heavier)
    assert Adapted(mujoco.TUNED).ask(case, number, ("instant",)).faults[0] == "acceleration"


def test_where_products_lose_a_body_descriptions_differ_and_by_twice_as_much_it_is_found() -> None:
    """Of a body far from its joint, beside its radius of gyration, J M^-1 J^T keeps few digits of its mass."""
    case = recipe(31, 63, EVERY, 3)
    own = build(case)
    turned, _ = CHANGES["turned"](own)
    lost = max(lost_in_products(each, each.pose) for each in (own, turned))
    assert 1e-6 < lost < 1e-4
    told = Adapted(DOP853).ask(case, 63, ("relations",))
    assert "what it makes of rounding" in told.not_asked[0]
    twist = DOP853.build(own, STEP * own.time_scale)(1, STEPS).twist[-1]
    speed = 40 * lost * float(np.abs(twist * [1.0, 1.0, own.length_scale]).max())  # ten roundings are let pass
    assert Adapted(Beside(DOP853, speed=speed)).ask(case, 63, ("relations",)).faults == ("turned",)


def test_places_that_are_rounded_anew_turn_small_bodies_and_a_speed_beside_it_is_found() -> None:
    case, own = recipe(195484576, 12, EVERY, 4), mechanism(195484576, 12, EVERY, 4)
    told = Adapted(pymunk.TUNED).ask(case, 12, ("relations",))
    assert "what it makes of rounding" in told.not_asked[0]
    speed = 1e-5 * float(np.abs(own.twist[:, :2]).max())
    found = Adapted(Beside(pymunk.TUNED, speed=speed)).ask(case, 12, ("relations",))
    assert found.faults == ("in other lengths",)


def test_a_row_that_is_lost_beside_others_is_told_and_is_found_where_nothing_tells_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Arms of 460 m and a radius of gyration of 2.5 um: a row of the pin is lost as it is drawn, and not turned."""
    case = recipe(389370127, 7, EVERY, 4)
    assert "says itself that something is wrong" in Adapted(DOP853).ask(case, 7, ("relations",)).not_asked[0]
    monkeypatch.setattr(_LagrangeRun, "_slipped", lambda *_: ())
    assert Adapted(DOP853).ask(case, 7, ("relations",)).faults == ("turned",)


def test_sweeps_that_can_not_take_a_closed_gap_back_are_not_asked_until_steps_are_short() -> None:
    """As shipped, ten sweeps leave 0.98 of the slowest mode, and a hundredth of a gap may be closed in a step."""
    own = mechanism(1438770828, 10, EVERY, 4)
    truth, step = (
        motions.judged(own),
        motion_bounds.SPAN * own.time_scale / motion_bounds.SAMPLES / motion_bounds.COARSE,
    )
    with pytest.raises(NotAsked, match="leave more of an impulse"):
        motions._left_by_sweeps(pymunk.DEFAULT, own, truth, step / 64)
    assert 0.9 < motions._left_by_sweeps(pymunk.DEFAULT, own, truth, step / 2**20) < 1


def test_where_mujoco_resets_a_model_for_its_numbers_no_law_is_asked() -> None:
    told = Adapted(mujoco.EXTENDED).ask(recipe(430129182, 26, EVERY, 2), 26, ("instant",))
    assert "mjMAXVAL" in told.not_asked[0]


# --------------------------------------------------------------------------------------------------------- the judge


def over_its_own_time(own: Mechanism, seconds: float) -> Trajectory:
    return TRUTH.build(own, seconds)(4, 1)


def test_a_stage_that_goes_astray_asks_for_no_table_and_ends_no_motion() -> None:
    """A light body on two ellipses: a trial step asked for the contact 250,000 turns away, which took ten minutes."""
    own = mechanism(441980448, 0, EVERY, 2)
    truth = over_its_own_time(own, 0.1 * own.time_scale)
    assert truth.unresolved_at is None
    assert np.abs(truth.pose - own.pose).max() < 1


def test_the_judge_says_that_masses_too_far_apart_leave_a_joint_open() -> None:
    """A drive beside a gear, of 5e-10 and 5000 kg m^2: another tolerance leaves it open by the same 1e-6 rad."""
    own = mechanism(49269432, 0, EVERY, 4)
    truth = over_its_own_time(own, 0.1 * own.time_scale)
    assert np.abs(own.gap(truth.pose[-1], truth.t[-1])[0]) > 1e-7
    assert truth.unresolved_at is not None
    assert math.isclose(truth.unresolved_at, truth.t[1])
