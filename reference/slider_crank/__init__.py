"""The slider-crank: its equations, and the scenes that use them."""

from reference.slider_crank.linkage import MovingSliderCrank, SliderCrank
from reference.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.slider_crank.singular_cases import PushedSliderCrank, RodEndInSlot, SliderAtDeadCentre
from reference.slider_crank.slotted_lever import SlottedLever

__all__ = [
    "DrivenSliderCrank",
    "FreeSliderCrank",
    "MovingSliderCrank",
    "PushedSliderCrank",
    "RodEndInSlot",
    "SliderAtDeadCentre",
    "SliderCrank",
    "SlottedLever",
]
