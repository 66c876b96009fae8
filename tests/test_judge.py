"""The judge against what is known without it: the orders of its methods, and the sag of a spring under a weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from engines import Softness
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.pendulum.link import PointPendulum
from reference.pendulum.scenes import LinkPendulum
from reports.gate.judge import QUANTITY_NAMES, errors, in_numpy, integrate
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
    found = integrate(HeavyDisc(), 4, 2, Softness(2500.0, 100.0, 0.01, (True, True)))
    assert found.pose[-1, 0] == pytest.approx([0.0, -4e-5, 0.0], rel=1e-6)
    assert found.reaction[-1] == pytest.approx([0.0, 40.0], rel=1e-6)


def test_rows_that_do_not_give_way_hold_while_others_sag():
    found = integrate(HeavyDisc(), 4, 2, Softness(2500.0, 100.0, 0.01, (True, False)))
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
    found = integrate(TurningDisc(), 4, 2, Softness(2500.0, 100.0, 0.0, (True, True), complete))
    opened = np.hypot(*mechanism.gap(found.pose[-1], found.t[-1]))
    # The bias is the centripetal acceleration, 0.1 m * 4 rad^2/s^2, and without it the spring of 2500 s^-2 has to give.
    # Its damper resists too, as the gap turns with the disc: 2 rad/s * 100 s^-1 is 8 %, at right angles.
    assert opened == pytest.approx(0.0 if complete else 0.4 / np.hypot(2500, 200), rel=1e-2, abs=1e-7)
