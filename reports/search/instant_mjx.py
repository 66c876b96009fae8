"""MJX's accelerations at one instant, against the law that MuJoCo's model declares, with and without velocity terms.

MJX runs the same compiled model, so how far a row gives way is what MuJoCo says of it (`instant_mujoco`). The later
instant is one that MuJoCo steps to: what is asked is not how MJX steps, and a second program would have to be compiled.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from engines.mjx import Mjx
from reference.mechanism import Mechanism
from reports.search import instant_mujoco
from reports.search.instant_mujoco import ROUNDED, STEP, STEPS, Instant, refuse_without_a_law
from reports.search.law import NotAsked

WITHOUT = "without velocity terms"  # the check that says what MJX computes instead
LAW = 1e-8  # where MJX's solver ends by itself, whatever the tolerance: 1.7e-9 at most, of 60 mechanisms


def bound(engine: Mjx) -> float:
    """The error, relative to the largest acceleration, above which something is wrong."""
    return max(LAW, instant_mujoco.bound(engine.settings))


def errors(engine: Mjx, mechanism: Mechanism) -> dict[str, float]:
    """By what accelerations miss the law, relative to the largest, and the law without the velocity terms of rows.

    Raises NotAsked where no law is declared, Fault for a row that is lacking, and Unsupported.
    """
    dt = STEP * mechanism.time_scale
    # What a solver leaves within the tolerance that is declared is no fault, so none is left.
    tolerance = min(engine.settings.tolerance, ROUNDED**2)
    engine = replace(engine, settings=replace(engine.settings, tolerance=tolerance))
    model, held = engine.model(mechanism, dt)
    refuse_without_a_law(engine.settings, mechanism, dt)
    if model.halves:
        raise NotAsked("a body that is cut into halves is another mechanism at one instant")
    run = engine.settings.build(mechanism, dt)
    told = run(1, STEPS)
    if not np.isfinite(told.pose).all():
        raise NotAsked("MuJoCo itself lost the motion")
    if any("the solver missed" in warning for warning in told.warnings):
        raise NotAsked("with these settings MuJoCo says itself that its solver ends too early")
    softness = engine.softness(mechanism, dt)
    out = {"acceleration": 0.0, WITHOUT: 0.0}
    for data in (model.start(), run.data):
        mujoco.mj_forward(model.compiled, data)
        here, found = Instant.of(mechanism, model, data, softness), engine.accelerations(model, held, data)
        misses = {"acceleration": here.missed(found), WITHOUT: here.missed(found, here.law(velocity_term=False))}
        out = {name: max(out[name], value) for name, value in misses.items()}
    return out
