"""The judge against what is known without it: the orders of its methods, and the sag of a spring under a weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from engines import Regularisation
from engines.lagrange.loading import installed
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.gate import judge
from reports.gate.judge import QUANTITY_NAMES, errors, errors_as_soft, giving_way, in_numpy, integrate, refined
from tests.toys import Disc

SWINGING = LinkPendulum(duration=0.3, horizon=0.3)


@pytest.mark.parametrize("order", [2, 4])
def test_every_error_of_the_judge_falls_with_the_order_of_its_method(order):
    coarse, fine = errors(SWINGING, order, 1), errors(SWINGING, order, 2)
    observed = {name: np.log2(coarse[name] / fine[name]) for name in QUANTITY_NAMES}
    # The next power of the step is a thirtieth of the leading one at a hundredth of a second.
    assert observed == pytest.approx(dict.fromkeys(QUANTITY_NAMES, order), abs=0.1)


def test_a_projection_leaves_the_joints_closed_and_the_motion_as_exact_as_before():
    alone, projected = errors(SWINGING, 4, 1), errors(SWINGING, 4, 1, project=True)
    # One Newton step squares a gap of 1e-8 m; the twist is projected with the rows of the pose after it.
    assert max(projected["gap"], projected["slip"]) < 1e-12
    assert projected["angle"] < 3 * alone["angle"]


def test_a_motion_that_is_lost_has_no_finite_error_and_is_not_stepped_to_its_end():
    # A step of half a second is a quarter of a period: a projection of second order throws the bob off for good.
    scene = PointPendulum()
    assert errors(scene, 2, 1, project=True) == dict.fromkeys(QUANTITY_NAMES, np.inf)
    with np.errstate(all="ignore"):
        found = in_numpy(scene.mechanism(), scene.samples, scene.spacing, 2, 1, None, True)
    finite = np.isfinite(found.pose).all(axis=(1, 2))
    last = int(finite.argmin())
    assert 0 < last < 100
    assert np.isnan(found.pose[last + 1 :]).all()


@dataclass(frozen=True)
class HeavyDisc(Disc):
    """Four kilograms at rest on a pin through the centre: a row there feels an inverse inertia of 1/4 kg."""

    rate: float = 0.0
    duration: float = 0.4
    horizon: float = 0.4

    def mechanism(self) -> Mechanism:
        pin = Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0))
        return Mechanism((Body("disc", 4.0, 0.5, (0.0, 0.0, 0.0)),), (pin,), (0.0, -10.0))


def test_a_soft_joint_sags_by_its_compliance_and_carries_the_weight():
    # At rest 0 = -stiffness gap - compliance A reaction: 0.01 * 40 N / 4 kg / 2500 s^-2, after twenty of its times.
    found = integrate(HeavyDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.01, (True, True)))
    assert found.pose[-1, 0] == pytest.approx([0.0, -4e-5, 0.0], rel=1e-6)
    assert found.reaction[-1] == pytest.approx([0.0, 40.0], rel=1e-6)


def test_rows_that_do_not_give_way_hold_while_others_sag():
    found = integrate(HeavyDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.01, (True, False)))
    assert found.pose[-1, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)


@dataclass(frozen=True)
class TurningDisc(HeavyDisc):
    """It turns at 2 rad/s on a pin 0.1 m beside its centre."""

    def mechanism(self) -> Mechanism:
        pin = Pin("axle", None, "disc", (0.0, 0.0), (-0.1, 0.0))
        return Mechanism((Body("disc", 1.0, 0.5, (0.1, 0.0, 0.0), (0.0, 0.2, 2.0)),), (pin,))


@pytest.mark.parametrize("complete", [True, False])
def test_a_joint_without_the_term_of_velocities_gives_way_to_what_turns_on_it(complete):
    mechanism = TurningDisc().mechanism()
    found = integrate(TurningDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.0, (True, True), complete))
    opened = np.hypot(*mechanism.gap(found.pose[-1], found.t[-1]))
    # The bias is the centripetal acceleration, 0.1 m * 4 rad^2/s^2, and without it the spring of 2500 s^-2 has to give.
    # Its damper resists too, as the gap turns with the disc: 2 rad/s * 100 s^-1 is 8 %, at right angles.
    assert opened == pytest.approx(0.0 if complete else 0.4 / np.hypot(2500, 200), rel=1e-2, abs=1e-7)


compiled = pytest.mark.skipif(not installed(), reason="numba, the extra 'fast', is not installed")


@compiled
def test_refined_steps_end_where_short_ones_of_one_length_do():
    soft = Regularisation(2500.0, 100.0, 0.01, (True,) * 4)
    found = refined(SWINGING.mechanism(), SWINGING.samples, SWINGING.spacing, soft)
    assert found is not None
    by_short = integrate(SWINGING, 4, 60, soft)
    # A third of the step changes a tenth of a sample by less than 1e-6, so what is kept is wrong by an eightieth of it.
    assert np.abs(found.pose - by_short.pose).max() < 1e-6
    assert np.abs(found.reaction - by_short.reaction).max() < 1e-4 * np.abs(by_short.reaction).max()


THROUGH = NFourBar(duration=1.0, horizon=1.0)  # the cranks lie along the couplers once, after 0.714 s


def spring(mechanism: Mechanism) -> Regularisation:
    """As an engine closes loops with pins of the first loop: the others hold."""
    gives = tuple(name.split()[-2] == "left" for name in mechanism.row_names)
    return Regularisation(4e4, 400.0, 1e-4, gives)


@compiled
def test_a_soft_motion_passes_a_singular_position_and_shorter_steps_change_it_little(monkeypatch):
    soft = spring(THROUGH.mechanism())
    assert 0 < sum(soft.rows) < len(soft.rows)
    found = errors_as_soft(THROUGH, soft)
    assert 1e-6 < found["angle"] < 1e-5  # 5.4e-6, as by steps of 1e-4 s throughout
    monkeypatch.setattr(judge, "SAME", judge.SAME / 10)
    monkeypatch.setattr(judge, "PARTS", 1)  # pieces of 0.01 s, which a third of does not pass
    finer = errors_as_soft(THROUGH, soft)
    assert dict(finer) == pytest.approx(dict(found), rel=0.1)
    # Steps of one length, with which the springs are stable, are thrown off there.
    assert errors(THROUGH, 4, 2, soft)["reaction"] > 100 * finer["reaction"]


@compiled
def test_a_soft_motion_that_takes_too_many_steps_is_lost(monkeypatch):
    monkeypatch.setattr(judge, "MOST", 100)
    assert errors_as_soft(THROUGH, spring(THROUGH.mechanism())) == dict.fromkeys(QUANTITY_NAMES, np.inf)


def test_declared_rows_give_way_and_a_drive_by_a_compliance_alone():
    mechanism = DrivenFourBar().mechanism()
    driven = mechanism.rate != 0
    declared = np.arange(mechanism.row_count) % 2 == 0
    for compliance in (0.0, 1e-3):
        gives = giving_way(mechanism, Regularisation(1e4, 2e2, compliance, tuple(declared.tolist())))
        assert gives.tolist() == (declared & (~driven | (compliance > 0))).tolist()
    assert driven.sum() == 1
