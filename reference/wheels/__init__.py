"""Ideal wheels seen from above: tows, trailers, casters, and vehicles that coast."""

from reference.wheels.car_and_trailer import CarAndTrailer
from reference.wheels.cart import Cart
from reference.wheels.casters import Casters
from reference.wheels.tractrix import Tow
from reference.wheels.trailers import CarWithTrailers, Convoy, Tricycle, towed

__all__ = [
    "CarAndTrailer",
    "CarWithTrailers",
    "Cart",
    "Casters",
    "Convoy",
    "Tow",
    "Tricycle",
    "towed",
]
