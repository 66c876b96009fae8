"""Rolling of one curve on another: kinematics (18.66). Bodies that roll under gravity are in `body` and `scenes`."""

from reference.rolling.contact import Contact
from reference.rolling.kinematics import Rolling

__all__ = ["Contact", "Rolling"]
