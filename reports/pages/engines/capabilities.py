"""What an engine builds: asked of it, mechanism by mechanism, and of one run what its numbers are like."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from engines import Unsupported
from engines.conformance.moving import FORCES
from engines.conformance.worlds import MOVING, WORLDS
from reference.joints import Gear, Pin, Rod, Weld
from reference.mechanism import Body, Mechanism
from reports.grid.tasks import Values
from reports.pages.engines.asked import Asked

STEP = 1e-2  # s
WORLD = {world.name: world.mechanism for world in (*WORLDS, *MOVING)}
_WHEELS = tuple(Body(name, 1.0, 0.1, (x, 0.0, 0.0)) for name, x in (("first", 0.0), ("second", 1.0)))
_AXLES = tuple(Pin(f"axle of the {body.name}", None, body.name, body.pose[:2], (0.0, 0.0)) for body in _WHEELS)
_DOWN = (0.0, -10.0)
# What is asked, and the mechanism that asks it: of conformance, or the smallest that has the element.
ASKED = {
    "hinge": WORLD["swinging bar"],
    "loop": WORLD["swinging parallelogram"],
    "drive": WORLD["driven crank"],
    "slot": WORLD["sliding block"],
    "slot in a loop": WORLD["trammel"],
    "rod": Mechanism(_WHEELS[1:], (Rod("rod", None, "second", (0.0, 0.0), (0.0, 0.0), 1.0),), _DOWN),
    "weld": Mechanism(_WHEELS, (_AXLES[0], Weld("weld", "first", "second", (0.5, 0.0), (-0.5, 0.0))), _DOWN),
    "gear": Mechanism(_WHEELS, (*_AXLES, Gear("gear", "first", "second", -2.0))),
    **{force.name: Mechanism(_WHEELS[:1], _AXLES[:1], _DOWN, (replace(force, second="first"),)) for force in FORCES},
    "skate": WORLD["sleigh"],
    "disc rolls on a line": WORLD["disc on a slope"],
    "disc rolls in a ring": WORLD["disc in a hole"],
}


@dataclass(frozen=True)
class Capabilities(Asked):
    """By the names in ASKED: "yes, by whom it is held", or the engine's sentence; `reaction` and `width` of a run."""

    what: ClassVar[str] = "what it builds"

    def run(self) -> Values:
        told: dict[str, str] = {}
        for what, mechanism in ASKED.items():
            try:
                self.of.build(mechanism, STEP)
            except Unsupported as reason:
                told[what] = str(reason)
            else:
                told[what] = "yes"
                with suppress(ValueError):
                    held = {self.of.holder(joint, mechanism) for joint in mechanism.joints}
                    if mechanism.forces:
                        held.add(self.of.forces_by)
                    told[what] = "yes" if held == {"engine"} else "with code of ours"
        run = self.of.build(WORLD["swinging bar"], STEP)(4, 1)
        known = [bool(np.isfinite(each).all()) for each in run.reaction]
        told["reactions"] = "yes" if all(known) else "but at the start" if all(known[1:]) else "no"
        velocity = run.twist[1:]
        # Velocities are the engine's own numbers, which poses of a tree or of angles are not.
        told["width"] = "32 bits" if np.array_equal(velocity, velocity.astype(np.float32)) else "64 bits"
        return told
