"""Skates (box 18.3): rows, given paths, the Chaplygin sleigh, parking, and the test of integrability."""

from reference.skate.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.skate.parking import Move, commutator, commutator_displacement, park, sidestep, stops, trace
from reference.skate.path import SkatePath, pin_constants, pin_rows, pinned_pose, skate_row
from reference.skate.pinned_body import FreelyPinnedBody, PinnedBody
from reference.skate.sleigh import ChaplyginSleigh, SleighBackwards
from reference.skate.slopes import HeldBySkates, SkateOnSlope

__all__ = [
    "ChaplyginSleigh",
    "FreelyPinnedBody",
    "HeldBySkates",
    "Move",
    "PinnedBody",
    "SkateOnSlope",
    "SkatePath",
    "SleighBackwards",
    "commutator",
    "commutator_displacement",
    "freedoms_by_brackets",
    "mechanism_is_integrable",
    "park",
    "pin_constants",
    "pin_rows",
    "pinned_pose",
    "sidestep",
    "skate_row",
    "stops",
    "trace",
]
