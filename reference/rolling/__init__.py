"""Rolling of one curve on another: kinematics (18.66), the joint, bodies that roll under gravity, and the scenes.

What has the answer is loaded when it is asked for: scenes are made of mechanisms, mechanisms of joints, and the joint
`Roll` of this package's contact. Who imports a joint then loads no scene.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from reference.rolling.contact import Contact
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll

if TYPE_CHECKING:
    from reference.rolling.body import RollingBody
    from reference.rolling.elliptic_gears import EllipticGears
    from reference.rolling.scenes import (
        RollingCam,
        RollingDisc,
        RollingDownhill,
        RollingEllipse,
        RollingInRing,
        RollingOnCircle,
        RollingScene,
    )
    from reference.rolling.singular_cases import DiscInHole, SquareOnCatenaries
    from reference.rolling.spinning_ring import SpinningRing

__all__ = [
    "Contact",
    "DiscInHole",
    "EllipticGears",
    "Roll",
    "Rolling",
    "RollingBody",
    "RollingCam",
    "RollingDisc",
    "RollingDownhill",
    "RollingEllipse",
    "RollingInRing",
    "RollingOnCircle",
    "RollingScene",
    "SpinningRing",
    "SquareOnCatenaries",
]

LOADED_LATER = ("body", "scenes", "singular_cases", "elliptic_gears", "spinning_ring")


def __getattr__(name: str) -> Any:
    """A name of a module that is loaded later."""
    if name in __all__:
        for module in LOADED_LATER:
            if hasattr(found := import_module(f"{__name__}.{module}"), name):
                return getattr(found, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
