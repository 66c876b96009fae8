"""What an engine builds: asked of it, mechanism by mechanism, and of one run what its numbers are like."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from engines import Unsupported
from engines.conformance.worlds import MOVING, WORLDS
from reports.grid.tasks import Values
from reports.pages.engines.asked import Asked

STEP = 1e-2  # s
# What is asked, and the conformance mechanism that asks it.
ASKED = {
    "hinge": "swinging bar",
    "loop": "swinging parallelogram",
    "drive": "driven crank",
    "slot": "sliding block",
    "slot in a loop": "trammel",
    "skate": "sleigh",
    "disc rolls on a line": "disc on a slope",
    "disc rolls in a ring": "disc in a hole",
}
WORLD = {world.name: world for world in (*WORLDS, *MOVING)}


@dataclass(frozen=True)
class Capabilities(Asked):
    """By the names in ASKED: "yes, by whom it is held", or the engine's sentence; `reaction` and `width` of a run."""

    what: ClassVar[str] = "what it builds"

    def run(self) -> Values:
        told: dict[str, str] = {}
        for what, name in ASKED.items():
            mechanism = WORLD[name].mechanism
            try:
                self.of.build(mechanism, STEP)
            except Unsupported as reason:
                told[what] = str(reason)
            else:
                told[what] = "yes"
                with suppress(ValueError):
                    held = {self.of.holder(joint, mechanism) for joint in mechanism.joints}
                    told[what] = "yes" if held == {"engine"} else "with code of ours"
        run = self.of.build(WORLD["swinging bar"].mechanism, STEP)(4, 1)
        known = [bool(np.isfinite(each).all()) for each in run.reaction]
        told["reactions"] = "yes" if all(known) else "but at the start" if all(known[1:]) else "no"
        velocity = run.twist[1:]
        # Velocities are the engine's own numbers, which poses of a tree or of angles are not.
        told["width"] = "32 bits" if np.array_equal(velocity, velocity.astype(np.float32)) else "64 bits"
        return told
