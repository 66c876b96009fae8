"""Tests of Drake's solver as documented in the adapter, and of runs that Drake aborts.

`test_promised`, `test_claims` and `test_conformance` test motions and refusals of all engines.
"""

from __future__ import annotations

import numpy as np
import pytest

from engines import Unsupported
from engines.drake import CENIC, DEFAULT, TUNED, DrakePlant
from engines.tree import spanning_tree
from reference.joints import Drive, Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import scene
from tests.engines.test_promised import installed

BAR = Body("bar", 1.0, 0.1, (0.5, 0.0, 0.0))
HINGE = Pin("hinge", None, "bar", (0.0, 0.0), (-0.5, 0.0))


@pytest.fixture(autouse=True)
def _with_drake() -> None:
    installed(DEFAULT)


def test_a_step_closes_half_of_a_gap():
    """In the solver SAP the relaxation time of a rigid constraint is the step."""
    plant = DrakePlant(spanning_tree(scene("free_four_bar").mechanism()), 1e-3, "discrete")
    plant.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    position = plant.plant.GetPositions(plant.context)
    position[plant.address[0]] += 1e-6
    plant.plant.SetPositions(plant.context, position)
    plant.plant.SetVelocities(plant.context, 0.0 * position)
    gaps = []
    for _ in range(2):
        pose = plant.tree.instant(*plant._state())[0]
        gaps.append(np.abs(plant.mechanism.gap(pose[None], np.zeros(1))[0]).max())
        plant._advance(1)
    assert gaps[1] / gaps[0] == pytest.approx(0.5, abs=1e-3)


def test_a_constraint_with_the_ground_is_one_with_a_welded_body():
    """Drake would end the process if the constraint used the body of the world."""
    swinging = Mechanism((BAR,), (Rod("rod", None, "bar", (0.0, 0.0), (0.5, 0.0), 1.0),), (0.0, -10.0))
    run = DEFAULT.build(swinging, 1e-3)(10, 10)
    assert np.abs(swinging.gap(run.pose, run.t)).max() < 1e-6


def test_a_run_that_drake_gives_up_ends_with_its_reason_and_keeps_the_samples_before():
    again = Pin("again", None, "bar", (0.0, 0.0), (-0.5, 0.0))
    run = DEFAULT.build(Mechanism((BAR,), (HINGE, again), (0.0, -10.0)), 1e-3)(2, 2)
    assert run.warnings[0].startswith("drake: The Hessian")
    assert np.isfinite(run.pose[0]).all()
    assert np.isnan(run.pose[1:]).all()


def test_what_continuous_time_does_not_move_is_refused_by_name():
    turning = Body("bar", 1.0, 0.1, (0.5, 0.0, 0.0), (0.0, 1.0, 2.0))
    driven = Mechanism((turning,), (HINGE, Drive("motor", None, "bar", 2.0, 0.0)))
    with pytest.raises(Unsupported, match=r"joint 'motor'.*no constraints and no PD gains"):
        TUNED.build(driven, 1e-3)
    with pytest.raises(Unsupported, match="drive 'motor': CENIC turns"):
        CENIC.build(driven, 1e-3)
    with pytest.raises(Unsupported, match="joint 'C'"):
        TUNED.build(scene("free_four_bar").mechanism(), 1e-3)
