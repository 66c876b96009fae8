"""What `check` takes for a fall of the error, and how long it trusts the judge's motion."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reports.check.checked import parts_of
from reports.check.judging import judged
from tests.toys import Disc, turning

SPINNING = Disc(rate=1000.0).mechanism()


def tries(*errors: float) -> list[Any]:
    """Runs at smaller and smaller steps of a thousandth of a second and less."""
    return [SimpleNamespace(error=error, change=SimpleNamespace(dt=1e-3 / 2**n)) for n, error in enumerate(errors)]


@pytest.mark.parametrize(
    ("errors", "falling"), [((1.0, 0.7), True), ((1.0, 0.8), False), ((1.0, 0.1, 0.09), False), ((1.0,), False)]
)
def test_an_error_falls_that_loses_a_quarter_from_the_last_step_to_the_next(errors, falling):
    run = turning(SPINNING, np.linspace(0.0, 0.1, 11))
    reading: Any = SimpleNamespace(mechanism=SPINNING, model=SimpleNamespace(declares=False))
    found = parts_of(reading, run, run, tries(*errors))
    assert (found.rest, found.falling, found.divided) == (errors[-1], falling, False)
    assert found.smallest == 1e-3 / 2 ** (len(errors) - 1)


def test_a_disturbance_that_grows_as_the_time_is_no_chaos_however_fast_the_motion_is():
    # 3,000 radians: what the rate is off by at the start grows as many times, and so does what is allowed.
    found = judged(SPINNING, 300, 0.01)
    assert found.growth[-1] > 500
    assert found.horizon == pytest.approx(3.0, rel=1e-12)


def test_the_motion_of_a_chaotic_pendulum_is_trusted_for_a_part_of_it_alone():
    # Two links, let go from the horizontal.
    links = tuple(Body(f"link {n}", 1.0, 1 / 12, (n + 0.5, 0.0, 0.0)) for n in range(2))
    fixed = Pin("O", None, "link 0", (0.0, 0.0), (-0.5, 0.0))
    mechanism = Mechanism(links, (fixed, Pin("A", "link 0", "link 1", (0.5, 0.0), (-0.5, 0.0))), (0.0, -9.81))
    found = judged(mechanism, 400, 0.1)
    assert 1.0 < found.horizon < 39.0
    before = found.trajectory.t < found.horizon
    assert np.all(found.growth[before] <= 100 * (1 + found.trajectory.t[before] / mechanism.time_scale))
