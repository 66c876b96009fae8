"""What the closed-form four-bar costs for many crank angles, beside pylinkage and beside its own floor."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from reference.scenes.four_bar.linkage import FourBar
from reference.scenes.four_bar.scenes import DrivenFourBar

REPEATS = 5
# Without numba pylinkage's path is interpreted, some 30 us an angle: then fewer angles are timed, and the time scaled.
INTERPRETED_COUNT = 20_000


def pylinkage_ratio(count: int = 1_000_000) -> dict[str, Any]:
    """CPU seconds for `count` crank angles with rates and accelerations, and pylinkage's time over ours.

    The same linkage, the chapter's, and the fastest path that pylinkage has for it, `step_fast_with_kinematics`, which
    numba compiles if it is installed ("compiled" says so). "difference" [m] is the largest distance between the two
    libraries' C. "timed" is the number of angles that pylinkage was timed on. Raises RuntimeError without pylinkage.
    """
    try:
        import pylinkage as pl  # type: ignore[import-not-found]
        from pylinkage._numba_compat import HAS_NUMBA  # type: ignore[import-not-found]
    except ImportError as missing:
        raise RuntimeError("the comparison needs pylinkage; install the project's 'bench' extra") from missing
    scene = DrivenFourBar()
    four_bar, step = scene.four_bar, 2 * np.pi / count
    timed = count if HAS_NUMBA else min(count, INTERPRETED_COUNT)

    # A fresh linkage for each run: the path leaves the linkage where it ended.
    def other() -> Callable[[], Any]:
        beta, _ = four_bar.angles(scene.start, scene.branch)
        joint = scene.crank * np.exp(1j * scene.start) + scene.coupler * np.exp(1j * beta)
        ground, far = pl.Ground(0.0, 0.0, name="A"), pl.Ground(*scene.ground, name="D")
        crank = pl.Crank(anchor=ground, radius=scene.crank, angular_velocity=step, initial_angle=scene.start, name="B")
        coupler = pl.RRRDyad(
            anchor1=crank.output, anchor2=far, distance1=scene.coupler, distance2=scene.rocker, name="C"
        )
        coupler.x, coupler.y = float(joint.real), float(joint.imag)
        linkage = pl.Linkage([ground, far, crank, coupler], name="four-bar")
        linkage.set_input_velocity(crank, omega=scene.rate, alpha=0.0)
        linkage.compile()
        return lambda: linkage.step_fast_with_kinematics(iterations=timed, dt=1.0)

    theirs, (position, _, _) = _least_time(other)
    theta = scene.start + step * np.arange(1, count + 1)
    ours, motion = _least_time(lambda: lambda: four_bar.kinematics(theta, scene.rate, 0.0, scene.branch))
    corner = scene.crank * np.exp(1j * theta) + scene.coupler * np.exp(1j * motion.beta)
    distance = np.abs(corner[:timed] - (position[:, 3, 0] + 1j * position[:, 3, 1]))
    theirs *= count / timed
    return {
        "count": count,
        "ours": ours,
        "pylinkage": theirs,
        "ratio": theirs / ours,
        "compiled": HAS_NUMBA,
        "timed": timed,
        "difference": float(np.max(distance)),
    }


def floor_ratio(count: int = 1_000_000) -> dict[str, Any]:
    """CPU seconds of all six outputs for `count` crank angles, of one tan and two arctan2 on as many; the ratio."""
    scene = DrivenFourBar()
    four_bar: FourBar = scene.four_bar
    theta = scene.start + 2 * np.pi / count * np.arange(count)
    ours, _ = _least_time(lambda: lambda: four_bar.kinematics(theta, scene.rate, 0.0, scene.branch))

    def floor() -> Any:
        half = np.tan(0.5 * theta)
        return np.arctan2(half, theta), np.arctan2(theta, half)

    least, _ = _least_time(lambda: floor)
    return {"count": count, "ours": ours, "floor": least, "ratio": ours / least}


def _least_time(prepare: Callable[[], Callable[[], Any]]) -> tuple[float, Any]:
    """The least CPU time [s] of several runs, the first discarded, and the last run's result."""
    times, result = [], None
    for _ in range(REPEATS + 1):
        run = prepare()
        start = time.process_time()
        result = run()
        times.append(time.process_time() - start)
    return min(times[1:]), result
