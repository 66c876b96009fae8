"""A person of rigid segments on one foot (an open chain) and on two (a closed one)."""

from reference.person.one_foot import OneFoot
from reference.person.segments import Segment
from reference.person.swaying import SwayingOnOneFoot, modes_upright
from reference.person.two_feet import TwoFeet

__all__ = [
    "OneFoot",
    "Segment",
    "SwayingOnOneFoot",
    "TwoFeet",
    "modes_upright",
]
