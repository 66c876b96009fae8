"""The ideal motion in a new installation. Numpy computes the motion if this is faster than compiling the judge's code.

The judge's machine code takes COMPILE_SECONDS of CPU time. A short motion of a few bodies takes a few seconds in numpy.
So numpy computes the first motions. The code is compiled as soon as the times of all motions in numpy, including
the next motion, exceed the time of compilation.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from engines.lagrange import TRUTH
from engines.lagrange.loading import COMPILING_NOTE, add_numpy_seconds, is_cold, numpy_seconds
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reports.check.judging import LOOSER_JUDGE, IdealMotion, reference_motion

# CPU time [s] of compilation, measured twice with numba 0.62 and 0.68 on two shared processors: 29.3 and 29.8.
COMPILE_SECONDS = 30.0
PROBE_SHARE = 0.1  # The time in numpy is measured for this share of the motion.
# CPU time of the reference motion divided by the time of a run with the looser tolerance. The reference motion consists
# of five runs. Measured ratios are 5 to 8.
MOTION_PER_RUN = 8.0


def ideal_motion(
    mechanism: Mechanism,
    samples: int,
    spacing: float,
    tolerance: float = np.inf,
    on_progress: Callable[[str], None] = lambda stage: None,
) -> IdealMotion:
    """The result of `reference_motion`, in numpy if this is faster than compilation, else in machine code. A motion
    from numpy is accepted only if the judge resolves the whole motion without a warning. So every motion has the
    accuracy that the judge claims."""
    on_progress("following the ideal motion")
    if is_cold():
        begin = time.process_time()
        motion = _motion_in_numpy(mechanism, samples, spacing, tolerance)
        add_numpy_seconds(time.process_time() - begin)
        if motion is not None:
            return motion
        on_progress(f"{COMPILING_NOTE}, before the ideal motion is followed")
    return reference_motion(mechanism, samples, spacing, tolerance)


def _motion_in_numpy(mechanism: Mechanism, samples: int, spacing: float, tolerance: float) -> IdealMotion | None:
    """The motion in numpy, or None if numpy would take longer than compilation or does not resolve the motion."""
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
