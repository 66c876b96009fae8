"""The ideal motion in a new installation: in numpy while that takes less time than compiling the judge's code.

The judge's machine code takes COMPILE_SECONDS of CPU time. A short motion of a few bodies takes a few seconds in numpy.
So the first motions are computed in numpy. The code is compiled as soon as the time that numpy has taken in all
processes, with the time that it would take now, exceeds the time of compilation.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from engines.lagrange import TRUTH
from engines.lagrange.loading import add_numpy_seconds, is_cold, numpy_seconds
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reports.check.judging import LOOSER_JUDGE, IdealMotion, reference_motion

COMPILE_SECONDS = 12.0  # CPU time of compilation, measured on one processor [s].
PROBE_SHARE = 0.1  # Of the motion: its time in numpy is measured.
# CPU time of the reference motion divided by that of a run with the looser tolerance. The motion is a run of the judge,
# its second run at twice as many samples, two runs of disturbed mechanisms, and one looser run. Measured: 5 to 8.
MOTION_PER_RUN = 8.0
COMPILING_NOTE = "compiling the judge's machine code, once for this installation: up to two minutes"


def ideal_motion(
    mechanism: Mechanism,
    samples: int,
    spacing: float,
    tolerance: float = np.inf,
    on_progress: Callable[[str], None] = lambda stage: None,
) -> IdealMotion:
    """`reference_motion` in numpy if that is faster than compiling, and otherwise in machine code.

    A motion from numpy is accepted only if the judge resolves all of it without a warning. So both have the accuracy
    that the judge claims.
    """
    on_progress("following the ideal motion")
    if is_cold(adaptive=True):
        begin = time.process_time()
        motion = _motion_in_numpy(mechanism, samples, spacing, tolerance)
        add_numpy_seconds(time.process_time() - begin)
        if motion is not None:
            return motion
        on_progress(f"{COMPILING_NOTE}, before the ideal motion is followed")
    return reference_motion(mechanism, samples, spacing, tolerance)


def _motion_in_numpy(mechanism: Mechanism, samples: int, spacing: float, tolerance: float) -> IdealMotion | None:
    """The motion in numpy; None if it would take longer than compiling, or if numpy does not resolve it."""
    spent = numpy_seconds()
    if spent > COMPILE_SECONDS:
        return None
    with suppress(InvalidMechanism):
        count = max(1, round(PROBE_SHARE * samples))
        probe = replace(LOOSER_JUDGE, compiled=False).build(mechanism, spacing)(count, 1)
        if spent + probe.stepping * (samples / count) * MOTION_PER_RUN > COMPILE_SECONDS:
            return None
        motion = reference_motion(mechanism, samples, spacing, tolerance, replace(TRUTH, compiled=False))
        if motion.trajectory.unresolved_at is None and not motion.trajectory.warnings and not motion.cut:
            return motion
    return None
