"""The four-bar linkage: its equations (sample 18.15), and the scenes that use them."""

from reference.four_bar.limits import OverdrivenFourBar, Parallelogram
from reference.four_bar.linkage import FourBar, PointMotion, Unreachable
from reference.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.four_bar.sweep import Kinematics

__all__ = [
    "DrivenFourBar",
    "FourBar",
    "FreeFourBar",
    "Kinematics",
    "OverdrivenFourBar",
    "Parallelogram",
    "PointMotion",
    "SpinningFourBar",
    "Unreachable",
]
