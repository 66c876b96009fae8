"""Andrews' squeezing mechanism: seven bodies, three loops through one point, a spring and a torque."""

from reference.andrews.dyad import Dyad, Moving
from reference.andrews.scene import Andrews

__all__ = ["Andrews", "Dyad", "Moving"]
