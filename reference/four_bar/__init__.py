"""The four-bar linkage: its equations (sample 18.15), and the scenes that use them."""

from reference.four_bar.closed_form import Kinematics
from reference.four_bar.forces import Forces
from reference.four_bar.linkage import FourBar, PointMotion, Unreachable
from reference.four_bar.moving import MovingFourBar
from reference.four_bar.scenes import DrivenFourBar, FreeFourBar, SpinningFourBar
from reference.four_bar.singular_cases import OverdrivenFourBar, Parallelogram

__all__ = [
    "DrivenFourBar",
    "Forces",
    "FourBar",
    "FreeFourBar",
    "Kinematics",
    "MovingFourBar",
    "OverdrivenFourBar",
    "Parallelogram",
    "PointMotion",
    "SpinningFourBar",
    "Unreachable",
]
