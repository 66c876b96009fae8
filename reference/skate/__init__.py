"""Skates (box 18.3): rows, given paths, the Chaplygin sleigh, parking, and the test of integrability."""

from reference.skate.path import SkatePath, pin_constants, pin_rows, pinned_pose, skate_row
from reference.skate.pinned_body import FreelyPinnedBody, PinnedBody
from reference.skate.sleigh import ChaplyginSleigh, SleighBackwards

__all__ = [
    "ChaplyginSleigh",
    "FreelyPinnedBody",
    "PinnedBody",
    "SkatePath",
    "SleighBackwards",
    "pin_constants",
    "pin_rows",
    "pinned_pose",
    "skate_row",
]
