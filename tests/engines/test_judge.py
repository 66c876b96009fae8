"""Tests of the gate's judge: convergence orders, and displacements and motions of regularised joints."""

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
def test_all_errors_have_the_order_of_the_method(order):
    coarse, fine = errors(SWINGING, order, 1), errors(SWINGING, order, 2)
    observed = {name: np.log2(coarse[name] / fine[name]) for name in QUANTITY_NAMES}
    # At a step of 0.01 s the next power of the step contributes a thirtieth of the error.
    assert observed == pytest.approx(dict.fromkeys(QUANTITY_NAMES, order), abs=0.1)


def test_a_projection_closes_the_joints_without_loss_of_accuracy():
    alone, projected = errors(SWINGING, 4, 1), errors(SWINGING, 4, 1, project=True)
    # One Newton step squares a gap of 1e-8 m. The twist is projected with the rows of the new pose.
    assert max(projected["gap"], projected["slip"]) < 1e-12
    assert projected["angle"] < 3 * alone["angle"]


def test_a_diverged_motion_has_no_finite_error_and_ends_early():
    # The motion diverges at a step of 0.5 s, which is a quarter of a period.
    scene = PointPendulum()
    assert errors(scene, 2, 1, project=True) == dict.fromkeys(QUANTITY_NAMES, np.inf)
    with np.errstate(all="ignore"):
        run = in_numpy(scene.mechanism(), scene.samples, scene.spacing, 2, 1, None, True)
    finite = np.isfinite(run.pose).all(axis=(1, 2))
    last = int(finite.argmin())
    assert 0 < last < 100
    assert np.isnan(run.pose[last + 1 :]).all()


@dataclass(frozen=True)
class HeavyDisc(Disc):
    """A disc of 4 kg at rest on a pin through its centre. The inverse inertia A of the rows is 1/(4 kg)."""

    rate: float = 0.0
    duration: float = 0.4
    horizon: float = 0.4

    def mechanism(self) -> Mechanism:
        pin = Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0))
        return Mechanism((Body("disc", 4.0, 0.5, (0.0, 0.0, 0.0)),), (pin,), (0.0, -10.0))


def test_the_gap_of_a_regularised_joint_follows_from_compliance_and_weight():
    # At rest stiffness gap = -compliance A reaction. So the gap is 0.01 * 40 N / 4 kg / 2500 s^-2 = 4e-5 m.
    run = integrate(HeavyDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.01, (True, True)))
    assert run.pose[-1, 0] == pytest.approx([0.0, -4e-5, 0.0], rel=1e-6)
    assert run.reaction[-1] == pytest.approx([0.0, 40.0], rel=1e-6)


def test_rigid_rows_have_no_gap_beside_regularised_rows():
    run = integrate(HeavyDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.01, (True, False)))
    assert run.pose[-1, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)


@dataclass(frozen=True)
class TurningDisc(HeavyDisc):
    """A disc that turns at 2 rad/s on a pin. The distance of the pin from the centre is 0.1 m."""

    def mechanism(self) -> Mechanism:
        pin = Pin("axle", None, "disc", (0.0, 0.0), (-0.1, 0.0))
        return Mechanism((Body("disc", 1.0, 0.5, (0.1, 0.0, 0.0), (0.0, 0.2, 2.0)),), (pin,))


@pytest.mark.parametrize("complete", [True, False])
def test_without_bias_a_regularised_joint_has_the_gap_of_the_centripetal_acceleration(complete):
    mechanism = TurningDisc().mechanism()
    run = integrate(TurningDisc(), 4, 2, Regularisation(2500.0, 100.0, 0.0, (True, True), complete))
    opened = np.hypot(*mechanism.gap(run.pose[-1], run.t[-1]))
    # The centripetal acceleration is 0.1 m * 4 rad^2/s^2. Without the bias the spring of 2500 s^-2 causes this
    # acceleration. The gap turns with the disc at 2 rad/s, so the damper of 100 s^-1 acts perpendicular to it with 8 %
    # of the stiffness.
    assert opened == pytest.approx(0.0 if complete else 0.4 / np.hypot(2500, 200), rel=1e-2, abs=1e-7)


compiled = pytest.mark.skipif(not installed(), reason="numba, the extra 'fast', is not installed")


@compiled
def test_refined_steps_agree_with_shorter_fixed_steps():
    soft = Regularisation(2500.0, 100.0, 0.01, (True,) * 4)
    run = refined(SWINGING.mechanism(), SWINGING.samples, SWINGING.spacing, soft)
    assert run is not None
    short_steps = integrate(SWINGING, 4, 60, soft)
    # A third of the step changes the state by less than 1e-6. So at order 4 the error is below 1e-6 / 80.
    assert np.abs(run.pose - short_steps.pose).max() < 1e-6
    assert np.abs(run.reaction - short_steps.reaction).max() < 1e-4 * np.abs(short_steps.reaction).max()


THROUGH = NFourBar(duration=1.0, horizon=1.0)  # The motion passes a singular position after 0.714 s.


def spring(mechanism: Mechanism) -> Regularisation:
    """A regularisation of the rows of the joints with the name "left". All other rows are rigid."""
    rows = tuple(name.split()[-2] == "left" for name in mechanism.row_names)
    return Regularisation(4e4, 400.0, 1e-4, rows)


@compiled
def test_a_regularised_motion_through_a_singular_position_converges(monkeypatch):
    soft = spring(THROUGH.mechanism())
    assert 0 < sum(soft.rows) < len(soft.rows)
    coarse = errors_as_soft(THROUGH, soft)
    assert 1e-6 < coarse["angle"] < 1e-5  # Fixed steps of 1e-4 s give 5.4e-6.
    monkeypatch.setattr(judge, "SAME", judge.SAME / 10)
    monkeypatch.setattr(judge, "PARTS", 1)  # intervals of 0.01 s
    finer = errors_as_soft(THROUGH, soft)
    assert dict(finer) == pytest.approx(dict(coarse), rel=0.1)
    # Fixed steps that are short enough for the springs diverge at the singular position.
    assert errors(THROUGH, 4, 2, soft)["reaction"] > 100 * finer["reaction"]


@compiled
def test_a_regularised_motion_with_too_many_steps_has_infinite_errors(monkeypatch):
    monkeypatch.setattr(judge, "MOST_TRIED", 100)
    assert errors_as_soft(THROUGH, spring(THROUGH.mechanism())) == dict.fromkeys(QUANTITY_NAMES, np.inf)


def test_only_a_compliance_regularises_the_row_of_a_drive():
    mechanism = DrivenFourBar().mechanism()
    driven = mechanism.rate != 0
    declared = np.arange(mechanism.row_count) % 2 == 0
    for compliance in (0.0, 1e-3):
        gives = giving_way(mechanism, Regularisation(1e4, 2e2, compliance, tuple(declared.tolist())))
        assert gives.tolist() == (declared & (~driven | (compliance > 0))).tolist()
    assert driven.sum() == 1
