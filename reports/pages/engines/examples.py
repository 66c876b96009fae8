"""Small mechanisms, each with an element that some engines don't have."""

from __future__ import annotations

from dataclasses import replace

from engines.conformance.moving import FORCE_EXAMPLES
from engines.conformance.worlds import MOVING, WORLDS
from reference.couplings import Coupling, Term
from reference.forces import CoupledForce
from reference.joints import Gear, Pin, Rod, Weld
from reference.mechanism import Body, Mechanism

WORLD = {world.name: world.mechanism for world in (*WORLDS, *MOVING)}
_WHEELS = tuple(Body(name, 1.0, 0.1, (x, 0.0, 0.0)) for name, x in (("first", 0.0), ("second", 1.0)))
_AXLES = tuple(Pin(f"axle of the {body.name}", None, body.name, body.pose[:2], (0.0, 0.0)) for body in _WHEELS)
_TURNS = (Term(None, "first", 1.0), Term(None, "second", 2.0))
_DOWN = (0.0, -10.0)
# Line of the table -> a mechanism with this element. There is an example of each class of joints and forces.
ELEMENT_EXAMPLES = {
    "hinge": WORLD["swinging bar"],
    "loop": WORLD["swinging parallelogram"],
    "drive": WORLD["driven crank"],
    "slot": WORLD["sliding block"],
    "slot in a loop": WORLD["trammel"],
    "rod": Mechanism(_WHEELS[1:], (Rod("rod", None, "second", (0.0, 0.0), (0.0, 0.0), 1.0),), _DOWN),
    "weld": Mechanism(_WHEELS, (_AXLES[0], Weld("weld", "first", "second", (0.5, 0.0), (-0.5, 0.0))), _DOWN),
    "gear": Mechanism(_WHEELS, (*_AXLES, Gear("gear", "first", "second", -2.0))),
    "coupling": Mechanism(_WHEELS, (*_AXLES, Coupling("coupling", _TURNS))),
    **{
        force.name: Mechanism(_WHEELS[:1], _AXLES[:1], _DOWN, (replace(force, second="first"),))
        for force in FORCE_EXAMPLES
    },
    "coupled force": Mechanism(_WHEELS, _AXLES, _DOWN, (CoupledForce("coupled force", _TURNS, force=1.0),)),
    "skate": WORLD["sleigh"],
    "disc rolls on a line": WORLD["disc on a slope"],
    "disc rolls in a ring": WORLD["disc in a hole"],
}
