"""Curves by arc length, each with its own material on its left."""

from reference.curves.cam import Cam
from reference.curves.circles_lines import Circle, Line, Ring, Side
from reference.curves.curve import ByArc, Curve, Placed
from reference.curves.ellipse import Ellipse
from reference.curves.open import Catenary, LogSpiral, Parabola
from reference.curves.traced import Traced

__all__ = [
    "ByArc",
    "Cam",
    "Catenary",
    "Circle",
    "Curve",
    "Ellipse",
    "Line",
    "LogSpiral",
    "Parabola",
    "Placed",
    "Ring",
    "Side",
    "Traced",
]
